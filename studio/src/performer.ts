// The performer: the camera's pictures out, what is seen of them drawn over.

import { find } from "./dom";
import type { Packet } from "./packet";

const QUALITY = 0.8;
const STATES = { waiting: "Looking for a face at rest", following: "Following", lost: "The face is lost" };
/** Width over height of the screen, at least and at most. */
const SLIM = 1;
const BROAD = 1.78;

export class Performer {
  private readonly video = find<HTMLVideoElement>("video");
  private readonly picture = find<HTMLImageElement>("picture");
  private readonly overlay = find<HTMLCanvasElement>("overlay");
  private readonly shutter = document.createElement("canvas");
  private stream?: MediaStream;
  private shown?: string;
  private sized: [number, number] = [0, 0];

  constructor(private readonly send: (time: number, picture: ArrayBuffer) => void) {}

  /** Starts the camera. Throws where there is none, or it may not be used. */
  async film(): Promise<void> {
    this.stream = await navigator.mediaDevices.getUserMedia({ video: { width: 640, height: 480, frameRate: 30 } });
    this.video.srcObject = this.stream;
    await this.video.play();
    const each = () => {
      if (!this.stream) return;
      this.snap();
      this.video.requestVideoFrameCallback(each);
    };
    this.video.requestVideoFrameCallback(each);
  }

  /** Stops the camera and clears the screen. */
  rest(): void {
    this.stream?.getTracks().forEach((track) => track.stop());
    this.stream = undefined;
    this.video.srcObject = null;
    this.picture.removeAttribute("src");
    this.picture.hidden = true;
    this.overlay.getContext("2d")?.clearRect(0, 0, this.overlay.width, this.overlay.height);
    this.tell("", "Nobody yet", "");
    find("crowd").hidden = true;
    find("veil").classList.remove("on");
  }

  /** What the screen says while there is nothing to see. */
  invite(source: string): void {
    find("invitation").hidden = source !== "none";
    this.video.hidden = !this.stream;
  }

  see(packet: Packet): void {
    if (packet.picture) {
      if (this.shown) URL.revokeObjectURL(this.shown);
      this.shown = URL.createObjectURL(packet.picture);
      this.picture.src = this.shown;
    }
    this.picture.hidden = !packet.picture;
    const words = packet.picture || this.stream ? STATES[packet.state] : "A take, without pictures";
    this.tell(packet.state, words, packet.picture || this.stream ? `${packet.late.toFixed(0)} ms` : "");
    find("veil").classList.toggle("on", packet.state === "lost" && this.stream !== undefined);
    const crowd = find("crowd");
    crowd.hidden = packet.faces < 2;
    crowd.textContent = `Follows one of ${packet.faces} faces`;
    this.draw(packet);
  }

  private tell(state: string, words: string, late: string): void {
    const line = find("state");
    line.dataset.state = state;
    // A status that says the same again would be read aloud again.
    if (line.firstElementChild!.textContent !== words) line.firstElementChild!.textContent = words;
    line.lastElementChild!.textContent = late;
  }

  /** Width and height of what is shown; a take without pictures shows its points in a square. */
  private size(packet: Packet): [number, number] {
    if (this.stream) return [this.video.videoWidth, this.video.videoHeight];
    if (!packet.picture) return [1, 1];
    // A picture that is not decoded yet is as large as the one before.
    if (this.picture.naturalWidth) this.sized = [this.picture.naturalWidth, this.picture.naturalHeight];
    return this.sized;
  }

  private draw(packet: Packet): void {
    const [width, height] = this.size(packet);
    if (!width || !height) return;
    const canvas = this.overlay;
    canvas.parentElement!.style.aspectRatio = String(Math.min(Math.max(width / height, SLIM), BROAD));
    const pixels = Math.min(devicePixelRatio, 2);
    canvas.width = canvas.clientWidth * pixels;
    canvas.height = canvas.clientHeight * pixels;
    const pen = canvas.getContext("2d");
    if (!pen) return;
    const scale = Math.min(canvas.width / width, canvas.height / height);
    const x = (share = 0) => (canvas.width - width * scale) / 2 + share * width * scale;
    const y = (share = 0) => (canvas.height - height * scale) / 2 + share * height * scale;
    pen.fillStyle = pen.strokeStyle = packet.state === "lost" ? "#ff7a59" : "#7ef0c0";
    pen.lineWidth = 1.5 * pixels;
    pen.lineJoin = "round";
    for (const curve of packet.curves) {
      pen.beginPath();
      for (let i = 0; i + 1 < curve.length; i += 2) pen.lineTo(x(curve[i]), y(curve[i + 1]));
      pen.stroke();
    }
    const wire = packet.wire ?? [];
    pen.lineWidth = 0.5 * pixels;
    pen.beginPath();
    for (let i = 0; i + 3 < wire.length; i += 4) {
      pen.moveTo(x(wire[i]), y(wire[i + 1]));
      pen.lineTo(x(wire[i + 2]), y(wire[i + 3]));
    }
    pen.stroke();
    const points = packet.points ?? [];
    for (let i = 0; i + 1 < points.length; i += 2) {
      pen.beginPath();
      pen.arc(x(points[i]), y(points[i + 1]), 1.3 * pixels, 0, 2 * Math.PI);
      pen.fill();
    }
  }

  private snap(): void {
    const { videoWidth: width, videoHeight: height } = this.video;
    if (!width) return;
    this.shutter.width = width;
    this.shutter.height = height;
    this.shutter.getContext("2d")?.drawImage(this.video, 0, 0);
    const time = performance.now() / 1000;
    this.shutter.toBlob((blob) => void blob?.arrayBuffer().then((data) => this.send(time, data)), "image/jpeg", QUALITY);
  }
}

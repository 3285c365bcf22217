// The performer: the camera's pictures out, what is seen of them drawn over.

import type { Packet } from "./packet";

const QUALITY = 0.8;
const find = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

export class Performer {
  private readonly video = find<HTMLVideoElement>("video");
  private readonly picture = find<HTMLImageElement>("picture");
  private readonly overlay = find<HTMLCanvasElement>("overlay");
  private readonly invitation = find("invitation");
  private readonly shutter = document.createElement("canvas");
  private stream?: MediaStream;
  private shown?: string;

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
    this.overlay.getContext("2d")?.clearRect(0, 0, this.overlay.width, this.overlay.height);
  }

  invite(wanted: boolean): void {
    this.invitation.hidden = !wanted;
    this.video.hidden = !this.stream;
  }

  see(packet: Packet): void {
    if (packet.picture) {
      if (this.shown) URL.revokeObjectURL(this.shown);
      this.shown = URL.createObjectURL(packet.picture);
      this.picture.src = this.shown;
    }
    this.picture.hidden = !packet.picture;
    this.draw(packet.points, packet.state === "lost");
  }

  private draw(points: Float32Array | undefined, lost: boolean): void {
    const source = this.stream ? this.video : this.picture;
    const width = this.stream ? this.video.videoWidth : this.picture.naturalWidth;
    const height = this.stream ? this.video.videoHeight : this.picture.naturalHeight;
    const canvas = this.overlay;
    const pixels = Math.min(devicePixelRatio, 2);
    canvas.width = canvas.clientWidth * pixels;
    canvas.height = canvas.clientHeight * pixels;
    const pen = canvas.getContext("2d");
    if (!pen || !points || !width || !height || !source) return;
    const scale = Math.min(canvas.width / width, canvas.height / height);
    const left = (canvas.width - width * scale) / 2;
    const top = (canvas.height - height * scale) / 2;
    pen.fillStyle = lost ? "#ff7a59" : "#7ef0c0";
    for (let i = 0; i + 1 < points.length; i += 2) {
      pen.beginPath();
      const x = left + (points[i] ?? 0) * width * scale;
      const y = top + (points[i + 1] ?? 0) * height * scale;
      pen.arc(x, y, 1.4 * pixels, 0, 2 * Math.PI);
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

// The socket to the server: messages both ways, pictures out, frames in. It comes back by itself.

import type { FromPage, ToPage } from "./messages";
import { unpack, type Packet } from "./packet";

const MOST_WAITING = 300_000;

export class Line {
  private socket?: WebSocket;

  constructor(
    private readonly told: (message: ToPage) => void,
    private readonly frame: (packet: Packet) => void,
    private readonly open: (there: boolean) => void,
  ) {
    this.connect();
  }

  say(message: FromPage): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Sends a picture, unless earlier ones still wait: the newest is the one that counts. */
  show(time: number, picture: ArrayBuffer): void {
    if (this.socket?.readyState !== WebSocket.OPEN || this.socket.bufferedAmount > MOST_WAITING) return;
    const message = new Uint8Array(8 + picture.byteLength);
    new DataView(message.buffer).setFloat64(0, time, true);
    message.set(new Uint8Array(picture), 8);
    this.socket.send(message);
  }

  private connect(): void {
    const address = new URL("live", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.open(true);
    socket.onmessage = (event) => {
      if (typeof event.data === "string") this.told(JSON.parse(event.data) as ToPage);
      else this.frame(unpack(event.data as ArrayBuffer));
    };
    socket.onclose = () => {
      this.open(false);
      setTimeout(() => this.connect(), 1500);
    };
    this.socket = socket;
  }
}

// The frames the server sends: see packet.py, which says how they are laid out.

export const STATES = ["waiting", "following", "lost"] as const;

/** What one character does at one moment. */
export interface Acting {
  head: [number, number, number, number];
  place: [number, number, number];
  eyes: [[number, number, number, number], [number, number, number, number]];
  weights: Float32Array;
}

export interface Packet {
  time: number;
  late: number;
  state: (typeof STATES)[number];
  faces: number;
  playing?: { place: number; length: number };
  held?: number;
  points?: Float32Array;
  curves: Float32Array[];
  wire?: Float32Array;
  picture?: Blob;
  actors: Map<number, Acting>;
}

const four = (f: Float32Array, at: number) => Array.from(f.subarray(at, at + 4)) as Acting["head"];

export function unpack(buffer: ArrayBuffer): Packet {
  const view = new DataView(buffer);
  const packet: Packet = { time: 0, late: 0, state: "waiting", faces: 1, curves: [], actors: new Map() };
  for (let at = 8; at < buffer.byteLength; ) {
    const tag = String.fromCharCode(...new Uint8Array(buffer, at, 4));
    const size = view.getUint32(at + 4, true);
    at += 8;
    const body = buffer.slice(at, at + size);
    if (tag === "MOMT") {
      packet.time = view.getFloat64(at, true);
      packet.late = view.getFloat32(at + 8, true);
      packet.state = STATES[view.getUint32(at + 12, true)] ?? "waiting";
    } else if (tag === "PLAY") {
      packet.playing = { place: view.getFloat64(at, true), length: view.getFloat64(at + 8, true) };
    } else if (tag === "CROW") {
      packet.faces = view.getUint32(at, true);
    } else if (tag === "HOLD") {
      packet.held = view.getFloat32(at, true);
    } else if (tag === "PNTS") {
      packet.points = new Float32Array(body);
    } else if (tag === "LINE") {
      packet.curves.push(new Float32Array(body));
    } else if (tag === "WIRE") {
      packet.wire = new Float32Array(body);
    } else if (tag === "JPEG") {
      packet.picture = new Blob([body], { type: "image/jpeg" });
    } else if (/^C\d{3}$/.test(tag)) {
      const f = new Float32Array(body);
      packet.actors.set(Number(tag.slice(1)), {
        head: four(f, 0),
        place: [f[4] ?? 0, f[5] ?? 0, f[6] ?? 0],
        eyes: [four(f, 7), four(f, 11)],
        weights: f.subarray(15),
      });
    }
    at += size;
  }
  return packet;
}

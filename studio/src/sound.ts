// Sound: what is heard while a take is recorded, and what is heard with what is played.

import { bring } from "./dom";

const RATE = 44100;
const ASTRAY = 0.15;

/** Plays a file in time with what the server shows. */
export class Sound {
  private readonly audio = new Audio();
  private on = true;

  constructor(private readonly there: (there: boolean) => void) {
    this.audio.loop = true;
    this.audio.onloadedmetadata = () => this.there(true);
    this.audio.onerror = () => this.there(false);
  }

  /** The sound at `address`, or silence. */
  set(address: string): void {
    if (this.audio.dataset.address === address) return;
    this.audio.dataset.address = address;
    this.there(false);
    this.audio.pause();
    if (address) this.audio.src = address;
    else this.audio.removeAttribute("src");
  }

  /** What is shown now; the sound comes along. */
  follow(place: number, playing: boolean): void {
    if (!this.audio.dataset.address || !this.audio.duration) return;
    if (Math.abs(this.audio.currentTime - place) > ASTRAY) this.audio.currentTime = Math.min(place, this.audio.duration);
    if (playing && this.on && this.audio.paused) void this.audio.play().catch(() => undefined);
    if (!(playing && this.on)) this.audio.pause();
  }

  toggle(): boolean {
    this.on = !this.on;
    if (!this.on) this.audio.pause();
    return this.on;
  }
}

/** Records what the microphone hears. */
export class Tape {
  private readonly chunks: Blob[] = [];
  private readonly recorder: MediaRecorder;

  constructor(private readonly stream: MediaStream) {
    this.recorder = new MediaRecorder(stream);
    this.recorder.ondataavailable = (event) => this.chunks.push(event.data);
    this.recorder.start();
  }

  /** Ends, and keeps what was heard with the take, if there is one. */
  async keep(take: string | undefined): Promise<void> {
    const ended = new Promise((told) => { this.recorder.onstop = told; });
    this.recorder.stop();
    await ended;
    this.stream.getTracks().forEach((track) => track.stop());
    if (!take) return;
    const audio = new OfflineAudioContext(1, 1, RATE);
    const heard = await audio.decodeAudioData(await new Blob(this.chunks).arrayBuffer());
    await bring(`takes/${encodeURIComponent(take)}/sound`, wave(heard));
  }
}

/** One channel of 16 bits, as a WAV file. */
function wave(heard: AudioBuffer): Blob {
  const mono = new Float32Array(heard.length);
  for (let channel = 0; channel < heard.numberOfChannels; channel++) {
    heard.getChannelData(channel).forEach((level, i) => { mono[i] = (mono[i] ?? 0) + level / heard.numberOfChannels; });
  }
  const samples = Int16Array.from(mono, (level) => Math.round(Math.max(-1, Math.min(1, level)) * 32767));
  const head = new DataView(new ArrayBuffer(44));
  const letters = (at: number, text: string) => [...text].forEach((letter, i) => head.setUint8(at + i, letter.charCodeAt(0)));
  letters(0, "RIFF"); head.setUint32(4, 36 + samples.byteLength, true); letters(8, "WAVEfmt ");
  head.setUint32(16, 16, true); head.setUint16(20, 1, true); head.setUint16(22, 1, true);
  head.setUint32(24, heard.sampleRate, true); head.setUint32(28, 2 * heard.sampleRate, true);
  head.setUint16(32, 2, true); head.setUint16(34, 16, true);
  letters(36, "data"); head.setUint32(40, samples.byteLength, true);
  return new Blob([head.buffer, samples.buffer]);
}

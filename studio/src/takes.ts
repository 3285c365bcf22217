// The takes there are, and the sound that is kept with those that are recorded.

import { button, find, note } from "./dom";
import type { StageSet } from "./messages";
import { Tape } from "./sound";

export class Takes {
  private before?: StageSet;
  private listening = false;
  private tape?: Tape;
  /** Those there were before what is recorded now. */
  private older: string[] = [];

  constructor(private readonly play: (name: string) => void) {
    find("microphone").onclick = () => this.listen();
  }

  /** Whether what the microphone hears is kept, the other way from now on. */
  listen(): void {
    this.listening = !this.listening;
    find("microphone").ariaPressed = String(this.listening);
  }

  set(stage: StageSet): void {
    const before = this.before;
    this.before = stage;
    this.list(stage);
    if (stage.recording && !before?.recording) {
      this.older = stage.takes;
      if (stage.source === "camera" && this.listening) void this.hear();
    }
    if (!stage.recording && this.tape) void this.keep(this.tape, stage.takes.find((name) => !this.older.includes(name)));
  }

  private list(stage: StageSet): void {
    const rows = [...stage.takes].reverse().map((name) => {
      const row = document.createElement("li");
      row.append(button(name.replace(/\.\w+$/, "").replace(/^take /, ""), () => this.play(name), name === stage.name));
      return row;
    });
    if (!rows.length) {
      const none = document.createElement("li");
      none.className = "none";
      none.textContent = "None yet: press Record, or drop one here.";
      rows.push(none);
    }
    find("takes").replaceChildren(...rows);
  }

  private async hear(): Promise<void> {
    const stream = await navigator.mediaDevices.getUserMedia({ audio: true }).catch(() => undefined);
    if (!stream) note("No microphone can be used; the take will be silent.", "error");
    else if (this.before?.recording) this.tape = new Tape(stream);
    else stream.getTracks().forEach((track) => track.stop());
  }

  private async keep(tape: Tape, take: string | undefined): Promise<void> {
    this.tape = undefined;
    await tape.keep(take);
  }
}

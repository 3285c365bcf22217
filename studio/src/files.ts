// Files that come from the person's disk, chosen or dropped: each goes where its ending belongs.

import { bring, choose, find, note, tame } from "./dom";
import { MODELS, PERFORMERS, TAKES, VIDEOS } from "./endings";

/** What becomes of a file once the server has it. */
export interface Welcome {
  video: (name: string) => void;
  take: (name: string) => void;
  performer: (name: string) => void;
  model: (file: File) => void;
}

type Kind = keyof Welcome;
const ENDINGS: Record<Kind, string[]> = { video: VIDEOS, take: TAKES, performer: PERFORMERS, model: MODELS };
const accepted = (...kinds: Kind[]) => kinds.flatMap((kind) => ENDINGS[kind]).join();

export class Files {
  constructor(private readonly welcome: Welcome) {
    const drop = find("drop");
    const carries = (event: DragEvent) => event.dataTransfer?.types.includes("Files") && !document.querySelector("dialog[open]");
    addEventListener("dragover", (event) => {
      if (!carries(event)) return;
      event.preventDefault();
      drop.hidden = false;
    });
    addEventListener("dragleave", (event) => { if (!event.relatedTarget) drop.hidden = true; });
    addEventListener("drop", (event) => {
      event.preventDefault();
      drop.hidden = true;
      const file = event.dataTransfer?.files[0];
      if (file && carries(event)) void this.take(file);
    });
  }

  /** Asks for a file of these kinds. */
  async ask(...kinds: Kind[]): Promise<void> {
    const file = await choose(accepted(...kinds));
    if (file) await this.take(file);
  }

  private async take(file: File): Promise<void> {
    const ending = `.${file.name.split(".").pop()?.toLowerCase()}`;
    const kind = (Object.keys(ENDINGS) as Kind[]).find((each) => ENDINGS[each].includes(ending));
    if (kind === undefined) return void note(`${file.name}: not a video, a take, a character or a performer`, "error");
    if (kind === "model") return this.welcome.model(file);
    const address = `${kind}s/${encodeURIComponent(tame(file.name))}`;
    const kept = await bring<{ name: string }>(address, file, `Bringing ${file.name}`);
    if (kept) this.welcome[kind](kept.name);
  }
}

// Who is on stage, and who could be.

import { button, find, note, spoken } from "./dom";
import type { Guests } from "./guests";
import type { FromPage, StageSet } from "./messages";

const ROOM = 4;
const CROSS = '<svg viewBox="0 0 16 16"><circle class="line" cx="8" cy="8" r="4.5" /><path class="line" d="M8 1v4M8 11v4M1 8h4M11 8h4" /></svg>';

export class Cast {
  /** As last asked for: the server may still be at it when the next is pressed. */
  private asked: string[] = [];

  constructor(private readonly say: (message: FromPage) => void, private readonly guests: Guests) {}

  set(stage: StageSet): void {
    this.asked = stage.actors.map((actor) => actor.name);
    const chips = stage.characters.flatMap((name) => [this.chip(name), ...this.mark(stage, name)]);
    const add = button("+ yours…", () => void this.guests.invite());
    add.className = "add";
    add.title = "A character of your own: GLB, VRM, or a ZIP of glTF or OBJ files (4)";
    find("cast").replaceChildren(...chips, add);
  }

  /** Somebody new comes on stage, beside the others as far as there is room. */
  appear(name: string): void {
    this.ask([...this.asked.filter((other) => other !== name).slice(1 - ROOM), name]);
    note(`${spoken(name)} is on stage`);
  }

  /** Says again who is on stage, to a server that does not know. */
  repeat(): void { this.ask(this.asked); }

  private ask(characters: string[]): void {
    this.asked = characters;
    this.say({ kind: "Cast", characters });
  }

  private chip(name: string): HTMLButtonElement {
    const chip = button(spoken(name), () => {
      const others = this.asked.filter((other) => other !== name);
      const leaves = others.length < this.asked.length;
      if (leaves && !others.length) return void note("Somebody has to be on stage.");
      if (!leaves && others.length === ROOM) return void note(`There is room for ${ROOM}: send somebody off first.`);
      chip.ariaPressed = String(!leaves);
      this.ask(leaves ? others : [...others, name]);
    }, this.asked.includes(name));
    chip.title = this.asked.includes(name) ? "Send off the stage" : "Bring on stage";
    return chip;
  }

  /** Whoever was brought can be pointed at again. */
  private mark(stage: StageSet, name: string): HTMLButtonElement[] {
    const model = stage.models.find((file) => file.replace(/\.\w+$/, "") === name.replace(/^my /, ""));
    if (!model) return [];
    const mark = button("", () => void this.guests.mark(model, name));
    mark.title = mark.ariaLabel = `Mark the face of ${spoken(name)} by hand`;
    mark.className = "mark";
    mark.innerHTML = CROSS;
    return [mark];
  }
}

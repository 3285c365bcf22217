// Characters that are brought: read by the server, and pointed at where their face is not found.

import { bring, choose, find, note, tame } from "./dom";
import { MODELS } from "./endings";
import { Picker } from "./picker";

interface Admitted { name: string; found: boolean; notes: string[] }
interface Point { id: string; what: string; at: [number, number]; needed: boolean }

/** Twelve points of one side; the other is its mirror image. Left is the character's own, which is on
 *  the right where it looks at us. */
export const POINTS: Point[] = [
  { id: "9.3", what: "the tip of the nose", at: [100, 134], needed: true },
  { id: "3.11", what: "the inner corner of its left eye", at: [116, 92], needed: true },
  { id: "3.7", what: "the outer corner of its left eye", at: [160, 92], needed: true },
  { id: "3.1", what: "the middle of its left upper lid's edge", at: [138, 81], needed: false },
  { id: "3.3", what: "the middle of its left lower lid's edge", at: [138, 103], needed: false },
  { id: "4.3", what: "the top of its left brow", at: [142, 62], needed: false },
  { id: "8.3", what: "the left corner of its mouth", at: [134, 162], needed: true },
  { id: "8.1", what: "the upper edge of the upper lip, in the middle", at: [100, 154], needed: true },
  { id: "2.2", what: "the lower edge of the upper lip, where it meets the other", at: [100, 164], needed: false },
  { id: "2.3", what: "the upper edge of the lower lip", at: [100, 169], needed: false },
  { id: "8.2", what: "the lower edge of the lower lip, in the middle", at: [100, 179], needed: true },
  { id: "2.1", what: "the tip of the chin", at: [100, 198], needed: true },
];

export class Guests {
  private readonly dialog = find<HTMLDialogElement>("picking");
  private picker?: Picker;
  private model = "";
  private given = new Map<string, [number, number, number]>();
  private order: string[] = [];

  constructor(private readonly welcome: (name: string) => void) {
    find("pickUndo").onclick = () => this.undo();
    find("pickSkip").onclick = () => this.skip();
    find("pickTurn").onclick = () => this.picker?.turn(Math.PI, 0);
    find("pickCancel").onclick = () => this.dialog.close();
    find("pickDone").onclick = () => void this.done();
    this.dialog.onkeydown = (event) => {
      const keys: Record<string, () => void> = { z: () => this.undo(), x: () => this.skip() };
      keys[event.key.toLowerCase()]?.();
    };
    this.dialog.onclose = () => this.picker?.close();
  }

  async invite(): Promise<void> {
    const file = await choose(MODELS.join());
    if (file) await this.bring(file);
  }

  async bring(file: File): Promise<void> {
    const name = tame(file.name);
    const said = await bring<Admitted>(`characters/${encodeURIComponent(name)}`, file, `Reading ${name}, and looking for its face`);
    if (!said) return;
    if (said.found) return this.arrived(said);
    await this.mark(name, said.name, "It was not found by looking. ");
  }

  /** Asks where the face of a character is that was brought as `model`. */
  async mark(model: string, name: string, why = ""): Promise<void> {
    this.model = model;
    this.given.clear();
    this.order = [];
    find("pickName").textContent = name;
    find("pickWhy").textContent = `${why}Mark twelve points. Left is the character's own left: on your right when it looks at you.`;
    find("pickFile").hidden = true;
    this.dialog.showModal();
    this.picker = new Picker(find<HTMLCanvasElement>("pickCanvas"), (place) => this.add(place));
    this.show();
    const busy = note("Fetching it", "busy");
    await this.picker.load(`models/${encodeURIComponent(model)}`).catch(() => note("it cannot be shown", "error"));
    busy.remove();
  }

  private arrived(said: Admitted): void {
    said.notes.forEach((words) => note(words));
    this.welcome(said.name);
  }

  private next(): Point | undefined { return POINTS.find(({ id }) => !this.order.includes(id)); }

  private add(place: [number, number, number]): void {
    const point = this.next();
    if (!point) return;
    this.order.push(point.id);
    this.given.set(point.id, place);
    this.show();
  }

  private undo(): void {
    const last = this.order.pop();
    if (last) this.given.delete(last);
    this.show();
  }

  private skip(): void {
    const point = this.next();
    if (point && !point.needed) this.order.push(point.id);
    this.show();
  }

  private show(): void {
    const next = this.next();
    find("pickWhat").innerHTML = "";
    find("pickWhat").append(next ? `${this.order.length + 1} of ${POINTS.length}: ${next.what}` : "All marked: press Done.");
    find<HTMLButtonElement>("pickUndo").disabled = !this.order.length;
    find<HTMLButtonElement>("pickSkip").disabled = !next || next.needed;
    find<HTMLButtonElement>("pickDone").disabled = POINTS.some(({ id, needed }) => needed && !this.given.has(id));
    const dots = POINTS.map(({ id, at }) => {
      const dot = document.createElementNS("http://www.w3.org/2000/svg", "circle");
      dot.setAttribute("cx", String(at[0]));
      dot.setAttribute("cy", String(at[1]));
      dot.setAttribute("r", id === next?.id ? "6" : "3.5");
      dot.setAttribute("class", id === next?.id ? "next" : this.given.has(id) ? "given" : "");
      return dot;
    });
    find("pickDots").replaceChildren(...dots);
    this.picker?.show([...this.given.values()]);
  }

  private async done(): Promise<void> {
    const done = find<HTMLButtonElement>("pickDone");
    done.disabled = true;
    const address = `models/${encodeURIComponent(this.model)}/points`;
    const points = JSON.stringify({ points: Object.fromEntries(this.given) });
    const said = await bring<Admitted>(address, points, "Making it a character");
    done.disabled = false;
    if (!said) return;
    const file = find<HTMLAnchorElement>("pickFile");
    file.href = `points/${encodeURIComponent(said.name)}.toml`;
    file.download = "";
    file.hidden = false;
    if (!said.found) {
      note("its face cannot be told from these points; mark them again", "error");
      return;
    }
    this.dialog.close();
    this.arrived(said);
  }
}

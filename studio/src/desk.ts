// The weights of one character as bars, each of which can be pinned, gained and muted.

import type { Actor, Adjust } from "./messages";
import { find, spoken } from "./dom";

interface Bar { root: HTMLElement; fill: HTMLElement; level: HTMLElement; slider: HTMLInputElement; adjust: Adjust; show: () => void }

const GAINS = [1, 1.5, 2, 0.5];
/** What is less than this is nothing to look at. */
const NOTHING = 0.005;
const FORM =
  '<div class="track"><i></i><span class="name"></span><output></output><input type="range" min="0" max="1" step="0.01" /></div>' +
  '<button class="gain"></button><button class="mute" title="Silent">mute</button>';

const changed = (adjust: Adjust) => adjust.pinned !== null || adjust.muted || adjust.gain !== 1;

export class Desk {
  private bars: Bar[] = [];
  private shown = "";
  private readonly kept = new Map<string, Adjust>();

  constructor(
    private readonly list: HTMLElement,
    private readonly filter: HTMLInputElement,
    private readonly say: (adjust: Adjust) => void,
  ) {
    filter.oninput = () => this.sift();
    find("letgo").onclick = () => this.letGo();
  }

  /** Shows a character's bars; those that are shown already stay. */
  set(actor: Actor): void {
    const shown = [actor.name, ...actor.targets].join();
    if (shown === this.shown) return;
    this.shown = shown;
    this.bars = actor.targets.map((target) => this.bar(actor.name, target));
    this.list.replaceChildren(...this.bars.map((bar) => bar.root));
    this.sift();
  }

  show(weights: Float32Array): void {
    this.bars.forEach((bar, i) => {
      const weight = weights[i] ?? 0;
      bar.fill.style.transform = `scaleX(${Math.min(Math.max(weight, 0), 1)})`;
      const level = Math.abs(weight) < NOTHING ? "" : weight.toFixed(2);
      if (bar.level.textContent !== level) bar.level.textContent = level;
      if (bar.adjust.pinned === null && document.activeElement !== bar.slider) bar.slider.value = String(weight);
    });
  }

  /** A server that is new is told all of it again. */
  repeat(): void {
    for (const adjust of this.kept.values()) if (changed(adjust)) this.say(adjust);
  }

  private letGo(): void {
    for (const adjust of this.kept.values()) {
      if (!changed(adjust)) continue;
      Object.assign(adjust, { gain: 1, muted: false, pinned: null });
      this.say(adjust);
    }
    this.bars.forEach((bar) => bar.show());
    this.count();
  }

  private count(): void {
    const count = [...this.kept.values()].filter(changed).length;
    find("letgo").hidden = !count;
    find("letgo").textContent = `Let all ${count > 1 ? `${count} ` : ""}go`;
  }

  private sift(): void {
    const wanted = this.filter.value.trim().toLowerCase();
    for (const bar of this.bars) bar.root.hidden = !spoken(bar.adjust.target).toLowerCase().includes(spoken(wanted));
  }

  private bar(character: string, target: string): Bar {
    const key = `${character} ${target}`;
    const adjust = this.kept.get(key) ?? { kind: "Adjust", character, target, gain: 1, muted: false, pinned: null };
    this.kept.set(key, adjust);
    const root = document.createElement("div");
    root.className = "bar";
    root.innerHTML = FORM;
    const part = <T extends HTMLElement>(selector: string) => root.querySelector(selector) as T;
    const [name, gain, mute, slider] = [part(".name"), part(".gain"), part(".mute"), part<HTMLInputElement>("input")];
    name.textContent = spoken(target);
    slider.ariaLabel = `pin ${spoken(target)}`;
    slider.title = `${spoken(target)}: drag to pin, double-click to let go`;
    const show = () => {
      const pinned = adjust.pinned !== null;
      root.classList.toggle("muted", adjust.muted);
      root.classList.toggle("pinned", pinned);
      gain.textContent = pinned ? "pin" : `×${adjust.gain}`;
      gain.title = pinned ? "Let it go" : "Louder: 1, 1.5, 2 or 0.5 times";
      gain.ariaPressed = String(pinned || adjust.gain !== 1);
      gain.ariaLabel = `${pinned ? "let go" : "gain of"} ${spoken(target)}`;
      mute.ariaPressed = String(adjust.muted);
      mute.ariaLabel = `mute ${spoken(target)}`;
    };
    const tell = (change: Partial<Adjust>) => { Object.assign(adjust, change); show(); this.count(); this.say(adjust); };
    gain.onclick = () => tell(adjust.pinned === null ? { gain: GAINS[(GAINS.indexOf(adjust.gain) + 1) % GAINS.length] ?? 1 } : { pinned: null });
    mute.onclick = () => tell({ muted: !adjust.muted });
    slider.oninput = () => tell({ pinned: Number(slider.value) });
    slider.ondblclick = () => tell({ pinned: null });
    show();
    return { root, fill: part(".track i"), level: part("output"), slider, adjust, show };
  }
}

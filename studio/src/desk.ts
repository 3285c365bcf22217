// The weights of one character as bars, each of which can be pinned, gained and muted.

import type { Actor, Adjust } from "./messages";
import { spoken } from "./dom";

interface Bar { root: HTMLElement; fill: HTMLElement; slider: HTMLInputElement; adjust: Adjust }

const GAINS = [1, 1.5, 2, 0.5];
const FORM =
  '<span class="name"></span><button class="gain" title="Louder: 1, 1.5, 2, 0.5 times; lets a pinned weight go"></button>' +
  '<button class="mute" title="Silent">mute</button><div class="track"><i></i></div>' +
  '<input type="range" min="0" max="1" step="0.01" title="Drag to pin, double-click to let go" />';

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
      if (bar.adjust.pinned === null && document.activeElement !== bar.slider) bar.slider.value = String(weight);
    });
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
    name.title = target;
    slider.ariaLabel = `pin ${spoken(target)}`;
    const show = () => {
      root.classList.toggle("muted", adjust.muted);
      root.classList.toggle("pinned", adjust.pinned !== null);
      gain.textContent = adjust.pinned === null ? `×${adjust.gain}` : "pinned";
      gain.ariaPressed = String(adjust.pinned !== null || adjust.gain !== 1);
      gain.ariaLabel = `${adjust.pinned === null ? "gain of" : "let go"} ${spoken(target)}`;
      mute.ariaPressed = String(adjust.muted);
      mute.ariaLabel = `mute ${spoken(target)}`;
    };
    const tell = () => { show(); this.say(adjust); };
    gain.onclick = () => {
      if (adjust.pinned !== null) adjust.pinned = null;
      else adjust.gain = GAINS[(GAINS.indexOf(adjust.gain) + 1) % GAINS.length] ?? 1;
      tell();
    };
    mute.onclick = () => { adjust.muted = !adjust.muted; tell(); };
    slider.oninput = () => { adjust.pinned = Number(slider.value); tell(); };
    slider.ondblclick = () => { adjust.pinned = null; tell(); };
    show();
    return { root, fill: part(".track i"), slider, adjust };
  }
}

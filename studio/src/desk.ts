// The weights of one character as bars, each of which can be pinned, gained and muted.

import type { Actor, Adjust } from "./messages";

interface Bar { root: HTMLElement; fill: HTMLElement; slider: HTMLInputElement; adjust: Adjust }

export class Desk {
  private bars: Bar[] = [];
  private readonly kept = new Map<string, Adjust>();

  constructor(
    private readonly list: HTMLElement,
    filter: HTMLInputElement,
    private readonly say: (adjust: Adjust) => void,
  ) {
    filter.oninput = () => {
      for (const bar of this.bars) bar.root.hidden = !bar.adjust.target.includes(filter.value.trim());
    };
  }

  set(actor: Actor): void {
    this.bars = actor.targets.map((target) => this.bar(actor.name, target));
    this.list.replaceChildren(...this.bars.map((bar) => bar.root));
  }

  show(weights: Float32Array): void {
    this.bars.forEach((bar, i) => {
      const weight = weights[i] ?? 0;
      bar.fill.style.transform = `scaleX(${Math.min(Math.max(weight, 0), 1)})`;
      if (bar.adjust.pinned === null) bar.slider.value = String(weight);
    });
  }

  private bar(character: string, target: string): Bar {
    const key = `${character} ${target}`;
    const adjust = this.kept.get(key) ?? { kind: "Adjust", character, target, gain: 1, muted: false, pinned: null };
    this.kept.set(key, adjust);
    const root = document.createElement("div");
    root.className = "bar";
    root.innerHTML =
      '<span class="name"></span><button class="gain" title="Louder: 1, 1.5, 2, 0.5 times"></button>' +
      '<button class="mute" title="Silent">mute</button><div class="track"><i></i></div>' +
      '<input type="range" min="0" max="1" step="0.01" title="Drag to pin, double-click to let go" />';
    const part = <T extends HTMLElement>(selector: string) => root.querySelector(selector) as T;
    const [name, gain, mute, slider] = [part(".name"), part(".gain"), part(".mute"), part<HTMLInputElement>("input")];
    name.textContent = name.title = target;
    slider.ariaLabel = `pin ${target}`;
    const tell = () => {
      root.classList.toggle("muted", adjust.muted);
      gain.textContent = adjust.pinned === null ? `×${adjust.gain}` : "pinned";
      gain.ariaPressed = String(adjust.pinned !== null || adjust.gain !== 1);
      mute.ariaPressed = String(adjust.muted);
      this.say(adjust);
    };
    gain.onclick = () => {
      const steps = [1, 1.5, 2, 0.5];
      if (adjust.pinned !== null) adjust.pinned = null;
      else adjust.gain = steps[(steps.indexOf(adjust.gain) + 1) % steps.length] ?? 1;
      tell();
    };
    mute.onclick = () => { adjust.muted = !adjust.muted; tell(); };
    slider.oninput = () => { adjust.pinned = Number(slider.value); tell(); };
    slider.ondblclick = () => { adjust.pinned = null; tell(); };
    gain.textContent = adjust.pinned === null ? `×${adjust.gain}` : "pinned";
    return { root, fill: part(".track i"), slider, adjust };
  }
}

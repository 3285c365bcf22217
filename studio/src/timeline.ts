// The timeline of a take or a video: played, paused and wound, with its sound, and exported.

import { find, spoken } from "./dom";
import type { FromPage, StageSet } from "./messages";
import type { Packet } from "./packet";
import { Sound } from "./sound";

const PLAY = '<svg viewBox="0 0 16 16"><path d="M4 2.5v11l9-5.5z"/></svg>';
const PAUSE = '<svg viewBox="0 0 16 16"><path d="M4 2.5h3v11H4zM9 2.5h3v11H9z"/></svg>';
const LOUD = '<svg viewBox="0 0 16 16"><path d="M2 6v4h2.5L8 13V3L4.5 6zM10 5q2.4 3 0 6M11.7 3.2q4.3 4.8 0 9.6" class="line"/></svg>';
const ACTED = { glb: "with morph targets and animation", csv: "the weights as a table", vrma: "a VRM animation" };
const TOLD = {
  mien: ["MIEN", "the performance itself, for mien animate"],
  csv: ["Live Link", "ARKit's 52 weights, as Live Link Face writes them"],
  fap: ["FAP", "MPEG-4 facial animation parameters"],
};

export class Timeline {
  readonly sound = new Sound((there) => { find("hear").hidden = !there; });
  private playing = true;
  private place = 0;
  private wound = 0;

  constructor(private readonly say: (message: FromPage) => void) {
    find("play").innerHTML = PAUSE;
    find("hear").innerHTML = LOUD;
    find("play").onclick = () => this.toggle();
    find("hear").onclick = () => this.mute();
    const slider = find<HTMLInputElement>("place");
    slider.oninput = () => this.seek(Number(slider.value), false);
  }

  set(stage: StageSet): void {
    const recorded = stage.source === "take" || stage.source === "video";
    find("timeline").hidden = !recorded;
    this.sound.set(recorded ? stage.sound : "");
    this.exports(stage);
  }

  /** Something new is played, from its beginning. */
  begin(): void { this.show(true); }

  see(packet: Packet): void {
    // What was on its way when the slider was moved would pull it back.
    if (!packet.playing || performance.now() - this.wound < 250) return;
    this.place = packet.playing.place;
    const slider = find<HTMLInputElement>("place");
    slider.max = String(packet.playing.length);
    slider.value = String(this.place);
    find("clock").textContent = `${this.place.toFixed(1)} of ${packet.playing.length.toFixed(1)} s`;
    this.sound.follow(this.place, this.playing);
  }

  toggle(): void { this.seek(this.place, !this.playing); }

  mute(): void { find("hear").ariaPressed = String(this.sound.toggle()); }

  private seek(place: number, playing: boolean): void {
    this.place = place;
    this.wound = performance.now();
    this.show(playing);
    find("clock").textContent = `${place.toFixed(1)} of ${Number(find<HTMLInputElement>("place").max).toFixed(1)} s`;
    this.sound.follow(place, playing);
    this.say({ kind: "Seek", time: place, playing });
  }

  private show(playing: boolean): void {
    this.playing = playing;
    find("play").innerHTML = playing ? PAUSE : PLAY;
  }

  private exports(stage: StageSet): void {
    const take = encodeURIComponent(stage.name);
    find("export").hidden = stage.source !== "take";
    if (stage.source !== "take") return find("exports").hidePopover();
    const rows = stage.actors.flatMap((actor) => {
      const kinds = Object.entries(ACTED).filter(([kind]) => kind !== "vrma" || actor.vrm);
      const address = `takes/${take}/${encodeURIComponent(actor.name)}`;
      return row(spoken(actor.name), kinds.map(([kind, what]) => link(`${address}.${kind}?session=${stage.session}`, kind.toUpperCase(), what)));
    });
    const told = Object.entries(TOLD).map(([kind, [text, what]]) => link(`takes/${take}/performance.${kind}`, text!, what!));
    find("exports").querySelector("dl")!.replaceChildren(...rows, ...row("the performance", told));
    find("exports").querySelector("p")!.textContent =
      "Characters as the page shows them: mapping, exaggeration, what is pinned, muted or louder, faces of your own.";
  }
}

function row(name: string, links: HTMLElement[]): HTMLElement[] {
  const [term, given] = [document.createElement("dt"), document.createElement("dd")];
  term.textContent = name;
  given.append(...links);
  return [term, given];
}

function link(address: string, text: string, title: string): HTMLAnchorElement {
  const made = document.createElement("a");
  made.href = address;
  made.download = "";
  made.textContent = text;
  made.title = title;
  return made;
}

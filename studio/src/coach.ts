// Holding faces: the performer is counted in, the server looks, and what it learnt is shown.

import { button, choices, find, note, save, spoken } from "./dom";
import type { FromPage, Hold, Learnt, StageSet } from "./messages";

const SECONDS = 3;
const LIDS = { task: "lids", pose: "" } as const;
const REST = { task: "neutral", pose: "" } as const;
const ONE_EYE = /^(blink|eyeBlink|wink)/i;
const MOST_POSES = 12;
/** The mapping that goes by a standard's parameters, whoever performs. */
const STANDARD = "fap";

type Asked = Pick<Hold, "task" | "pose">;

export class Coach {
  private stage?: StageSet;
  private counting = 0;
  private waiting = false;
  private pinned = false;
  private kept = "";
  private readonly came = new Map<string, Learnt["quality"]>();

  constructor(private readonly say: (message: FromPage) => void) {
    find("own").onclick = () => this.own(SECONDS);
    find("ownActor").onchange = () => { this.pinned = false; this.posesOf(); };
    find("ownPose").onchange = () => { this.pinned = find<HTMLSelectElement>("ownPose").value === ""; };
    find("keep").onclick = () => {
      const name = `me ${new Date().toISOString().slice(0, 10)}`;
      this.say({ kind: "Keep", name });
      // The file is there as soon as the server has told of it.
      this.kept = `${name}.performer`;
    };
    find("forget").onclick = () => { this.came.clear(); this.say({ kind: "Meet", name: "" }); };
  }

  /** Nothing is held any more: somebody else performs. */
  end(): void {
    clearInterval(this.counting);
    this.counting = 0;
    this.waiting = false;
    find("cue").hidden = true;
  }

  set(stage: StageSet): void {
    this.stage = stage;
    const film = ["camera", "sample", "video"].includes(stage.source);
    find("coach").classList.toggle("idle", !film);
    this.rows(stage, film);
    const actor = find<HTMLSelectElement>("ownActor").value;
    const named = stage.actors.map((each): [string, string] => [each.name, spoken(each.name)]);
    const everybody: [string, string] = ["", "everybody"];
    choices(find("ownActor"), [...named, everybody], named.some(([name]) => name === actor) ? actor : (named[0]?.[0] ?? ""));
    this.posesOf();
    find<HTMLButtonElement>("own").disabled = !film;
    this.list(stage);
    this.heed(stage);
    if (this.kept && stage.performers.includes(this.kept)) {
      save(`performers/${encodeURIComponent(this.kept)}`);
      this.kept = "";
    }
  }

  /** The neutral face, counted in. */
  rest(): void { this.hold(REST, "", SECONDS); }

  /** The face of this moment, or of the one after counting, stands for what was chosen. */
  own(seconds = 0): void {
    const pose = find<HTMLSelectElement>("ownPose").value;
    this.hold({ task: "face", pose }, find<HTMLSelectElement>("ownActor").value, seconds);
  }

  /** The share of a held face that has been seen; none where nothing is held. */
  see(share: number | undefined): void {
    if (!this.waiting || share === undefined) return;
    find("ring").style.strokeDashoffset = String(1 - share);
  }

  learnt(message: Learnt): void {
    this.waiting = false;
    this.came.set(`${message.task} ${message.pose}`, message.quality);
    const cue = find("cue");
    cue.dataset.quality = message.quality;
    find("count").textContent = { good: "✓", shaky: "≈", refused: "✕" }[message.quality];
    find("cueWord").textContent = message.text;
    find("ring").style.strokeDashoffset = message.quality === "refused" ? "1" : "0";
    if (message.task === "lids") chime();
    setTimeout(() => { if (!this.waiting && !this.counting) cue.hidden = true; }, 2600);
    if (this.stage) this.rows(this.stage, true);
  }

  private hold(asked: Asked, character: string, seconds: number): void {
    if (!this.stage || !["camera", "sample", "video"].includes(this.stage.source)) {
      note("first choose who performs: the camera, the sample or a video", "error");
      return;
    }
    clearInterval(this.counting);
    const cue = find("cue");
    cue.hidden = false;
    cue.dataset.quality = "";
    find("ring").style.strokeDashoffset = "1";
    find("cueWord").textContent = wording(asked);
    const begin = () => {
      clearInterval(this.counting);
      this.counting = 0;
      this.waiting = true;
      find("count").textContent = "hold";
      this.say({ kind: "Hold", character, ...asked });
    };
    if (!seconds) return begin();
    let left = seconds;
    find("count").textContent = String(left);
    this.counting = window.setInterval(() => {
      left -= 1;
      if (left > 0) find("count").textContent = String(left);
      else begin();
    }, 700);
  }

  private rows(stage: StageSet, film: boolean): void {
    const keys = new Map(stage.actors.flatMap((actor) => actor.keys.map((key) => [key, key])));
    const poses = [...keys.keys()].filter((key) => !ONE_EYE.test(key)).slice(0, MOST_POSES);
    const asked: Asked[] = [REST, ...(stage.way.capture === "landmarks" ? [LIDS] : [])];
    asked.push(...poses.map((pose): Asked => ({ task: "face", pose })));
    find("poses").replaceChildren(...asked.map((each) => {
      const row = button(wording(each), () => this.hold(each, "", SECONDS));
      row.disabled = !film;
      row.dataset.came = this.came.get(`${each.task} ${each.pose || each.task}`) ?? "";
      row.dataset.pose = each.pose || each.task;
      if (each.task === "neutral") row.title = "Your face at rest (N)";
      return row;
    }));
  }

  /** Says where faces of one's own do not count, or cannot be held. */
  private heed(stage: StageSet): void {
    const told = stage.way.mapping === STANDARD
      ? `The mapping ${STANDARD} goes by MPEG-4's own parameters: faces of your own count with the others.`
      : stage.source === "take" ? "A take has no pictures: choose the camera, the sample or a video to hold faces." : "";
    find("heed").hidden = !told;
    find("heed").textContent = told;
  }

  private posesOf(): void {
    const name = find<HTMLSelectElement>("ownActor").value;
    const actor = this.stage?.actors.find((each) => each.name === name);
    const keys = actor?.keys ?? [...new Set(this.stage?.actors.flatMap((each) => each.keys))];
    const pinned: [string, string][] = actor ? [["", "what is pinned"]] : [];
    const chosen = find<HTMLSelectElement>("ownPose").value;
    const options: [string, string][] = [...keys.map((key): [string, string] => [key, spoken(key)]), ...pinned];
    const kept = chosen && options.some(([key]) => key === chosen);
    choices(find("ownPose"), options, kept || this.pinned ? chosen : (options[0]?.[0] ?? ""));
  }

  private list(stage: StageSet): void {
    const items = stage.faces.map((face, number) => {
      const item = document.createElement("li");
      const words = document.createElement("span");
      words.textContent = spoken(face.pose);
      const about = document.createElement("em");
      about.textContent = `${face.character || "everybody"} · ${face.far.toFixed(0)} mm`;
      const away = button("✕", () => this.say({ kind: "Forget", number }));
      away.ariaLabel = `forget ${face.pose}`;
      item.append(words, about, away);
      return item;
    });
    if (!items.length) {
      const none = document.createElement("li");
      none.className = "none";
      none.textContent = "Nothing yet.";
      items.push(none);
    }
    find("faces").replaceChildren(...items);
  }
}

function wording({ task, pose }: Asked): string {
  if (task === "neutral") return "at rest";
  if (task === "lids") return "eyes shut";
  return pose ? spoken(pose) : "what is pinned";
}

/** Whose eyes are shut hears that it is over. */
function chime(): void {
  const audio = new AudioContext();
  const tone = audio.createOscillator();
  const level = audio.createGain();
  level.gain.setValueAtTime(0.12, audio.currentTime);
  level.gain.exponentialRampToValueAtTime(0.001, audio.currentTime + 0.5);
  tone.frequency.value = 660;
  tone.connect(level).connect(audio.destination);
  tone.start();
  tone.stop(audio.currentTime + 0.5);
  tone.onended = () => void audio.close();
}

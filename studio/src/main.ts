import "./style.css";
import { Coach } from "./coach";
import { Desk } from "./desk";
import { bring, button, choices, choose, find, note, plain, spoken, tame } from "./dom";
import { Guests } from "./guests";
import { type Key, listen } from "./keys";
import { Line } from "./line";
import type { Look, StageSet, ToPage } from "./messages";
import type { Packet } from "./packet";
import { Performer } from "./performer";
import { Tape } from "./sound";
import { Theatre } from "./theatre";
import { Timeline } from "./timeline";

const ON_CANVAS = "camera to canvas";
const MOST_MEASURES = 600;
const theatre = new Theatre(find<HTMLCanvasElement>("stage"), find("plates"), drawn);
const line = new Line(told, frame, reached);
const performer = new Performer((time, picture) => line.show(time, picture));
const desk = new Desk(find("bars"), find<HTMLInputElement>("filter"), (adjust) => line.say(adjust));
const coach = new Coach((message) => line.say(message));
const timeline = new Timeline((message) => line.say(message));
const guests = new Guests((name) => appear(name));
let stage: StageSet | undefined;
let shownActor = 0;
let looked: Look | undefined;
let lost = false;
let listening = false;
let tape: Tape | undefined;
let takesBefore: string[] = [];
/** When the camera saw what comes to the canvas next, milliseconds of the page's clock. */
let filmed = 0;

/** A server that comes back is told again what it should look at. */
function reached(there: boolean): void {
  if (!there && !lost) note("the server is not there; trying again", "error");
  if (there && lost) {
    if (stage) line.say({ kind: "Cast", characters: stage.actors.map((actor) => actor.name) });
    if (looked) line.say(looked);
  }
  lost = !there;
}

function told(message: ToPage): void {
  if (message.kind === "Note") note(message.text, message.level);
  else if (message.kind === "Learnt") coach.learnt(message);
  else void set(message);
}

async function set(message: StageSet): Promise<void> {
  const before = stage;
  stage = message;
  settings(message);
  sources(message);
  castChips(message);
  takes(message);
  coach.set(message);
  timeline.set(message);
  performer.invite(message.source);
  void keepSound(before, message);
  await theatre.set(message.actors);
  document.body.dataset.source = message.source;
}

function settings(message: StageSet): void {
  choices(find("capture"), plain(message.captures), message.way.capture);
  choices(find("mapping"), plain(message.mappings), message.way.mapping);
  find<HTMLInputElement>("mirror").checked = message.way.mirror;
  find<HTMLInputElement>("gain").value = String(message.way.gain);
  find("gainValue").textContent = message.way.gain.toFixed(2);
  shownActor = Math.min(shownActor, message.actors.length - 1);
  choices(find("actor"), message.actors.map(({ name }) => [name, spoken(name)]), message.actors[shownActor]?.name ?? "");
  const actor = message.actors[shownActor];
  if (actor) desk.set(actor);
  const record = find<HTMLButtonElement>("record");
  record.ariaPressed = String(message.recording);
  record.lastElementChild!.textContent = message.recording ? "Stop" : "Record";
  record.disabled = !["camera", "sample", "video"].includes(message.source);
  find("microphone").hidden = message.source !== "camera";
}

function frame(packet: Packet): void {
  packet.actors.forEach((acting, number) => theatre.act(number, acting));
  const shown = packet.actors.get(shownActor);
  if (shown) desk.show(shown.weights);
  if (stage?.source === "camera" && packet.actors.size) filmed = 1000 * packet.time;
  performer.see(packet);
  coach.see(packet.held);
  timeline.see(packet);
}

/** How long it took from the camera to the canvas, for the browser's own tools and for tests. */
function drawn(): void {
  if (!filmed) return;
  performance.measure(ON_CANVAS, { start: filmed, end: performance.now() });
  if (performance.getEntriesByName(ON_CANVAS).length > MOST_MEASURES) performance.clearMeasures(ON_CANVAS);
  filmed = 0;
}

async function watch(source: Look["source"], name = ""): Promise<void> {
  performer.rest();
  coach.end();
  if (source === "camera") {
    try {
      await performer.film();
    } catch {
      note("no camera can be used: is one plugged in, and may this page use it?", "error");
      return;
    }
  }
  timeline.begin();
  looked = { kind: "Look", source, name };
  line.say(looked);
}

function sources(message: StageSet): void {
  const chosen = { camera: "camera", sample: "sample", video: "video-file" } as Record<string, string>;
  for (const id of Object.values(chosen)) find(id).ariaPressed = String(chosen[message.source] === id);
  find("video-file").textContent = message.source === "video" ? message.name : "Video…";
}

async function upload(): Promise<void> {
  const file = await choose("video/*");
  if (!file) return;
  const kept = await bring<{ name: string }>(`videos/${encodeURIComponent(tame(file.name))}`, file, `Bringing ${file.name}`);
  if (kept) void watch("video", kept.name);
}

async function meet(): Promise<void> {
  const file = await choose(".performer");
  const kept = file && (await bring<{ name: string }>(`performers/${encodeURIComponent(tame(file.name))}`, file));
  if (kept) line.say({ kind: "Meet", name: kept.name });
}

/** Somebody new comes on stage, beside the others as far as there is room. */
function appear(name: string): void {
  const others = (stage?.actors ?? []).map((actor) => actor.name).filter((other) => other !== name);
  line.say({ kind: "Cast", characters: [...others.slice(-3), name] });
  note(`${name} is on stage`);
}

function castChips(message: StageSet): void {
  const cast = message.actors.map((actor) => actor.name);
  const chips = message.characters.flatMap((name) => {
    const chip = button(spoken(name), () => {
      const characters = cast.includes(name) ? cast.filter((other) => other !== name) : [...cast, name];
      if (characters.length) line.say({ kind: "Cast", characters });
      else note("somebody has to be on stage");
    }, cast.includes(name));
    const model = message.models.find((file) => file.replace(/\.\w+$/, "") === name.replace(/^my /, ""));
    if (!model) return [chip];
    const mark = button("", () => void guests.mark(model, name));
    mark.title = mark.ariaLabel = `mark the face of ${name} by hand`;
    mark.className = "mark";
    mark.innerHTML = '<svg viewBox="0 0 16 16"><circle class="line" cx="8" cy="8" r="4.5" /><path class="line" d="M8 1v4M8 11v4M1 8h4M11 8h4" /></svg>';
    return [chip, mark];
  });
  const add = button("+ yours…", () => void guests.invite());
  add.className = "add";
  add.title = "A character of your own: GLB, VRM, or a ZIP of glTF or OBJ files (4)";
  find("cast").replaceChildren(...chips, add);
}

function takes(message: StageSet): void {
  const items = [...message.takes].reverse().map((name) => {
    const item = document.createElement("li");
    item.append(button(name.replace(/\.take$/, "").replace(/^take /, ""), () => void watch("take", name), name === message.name));
    return item;
  });
  if (!items.length) {
    const none = document.createElement("li");
    none.className = "none";
    none.textContent = "None yet: press Record.";
    items.push(none);
  }
  find("takes").replaceChildren(...items);
}

/** Begins to hear as a recording begins, and keeps what was heard with its take. */
async function keepSound(before: StageSet | undefined, now: StageSet): Promise<void> {
  if (now.recording && !before?.recording) {
    if (now.source !== "camera" || !listening) return;
    const stream = await navigator.mediaDevices.getUserMedia({ audio: true }).catch(() => undefined);
    takesBefore = now.takes;
    if (!stream) note("no microphone can be used; the take will be silent", "error");
    else if (stage?.recording) tape = new Tape(stream);
    else stream.getTracks().forEach((track) => track.stop());
  } else if (!now.recording && tape) {
    const heard = tape;
    tape = undefined;
    await heard.keep(now.takes.find((name) => !takesBefore.includes(name)));
  }
}

function way(): void {
  line.say({
    kind: "Way",
    capture: find<HTMLSelectElement>("capture").value,
    mapping: find<HTMLSelectElement>("mapping").value,
    gain: Number(find<HTMLInputElement>("gain").value),
    mirror: find<HTMLInputElement>("mirror").checked,
  });
}

function tab(name: "Weights" | "Faces"): void {
  for (const [id, panel] of [["Weights", "desk"], ["Faces", "coach"]] as const) {
    find(`tab${id}`).ariaSelected = String(id === name);
    find(panel).hidden = id !== name;
  }
}

const theme = () => {
  const dark = document.documentElement.dataset.theme !== "dark";
  document.documentElement.dataset.theme = dark ? "dark" : "light";
};
const microphone = () => {
  listening = !listening;
  find("microphone").ariaPressed = String(listening);
};
const record = () => { if (!find<HTMLButtonElement>("record").disabled) line.say({ kind: "Recording", on: !stage?.recording }); };
const help = () => find<HTMLDialogElement>("keys").showModal();

for (const id of ["capture", "mapping", "gain", "mirror"]) find(id).onchange = way;
find("gain").oninput = () => { find("gainValue").textContent = Number(find<HTMLInputElement>("gain").value).toFixed(2); };
find("actor").onchange = () => {
  shownActor = find<HTMLSelectElement>("actor").selectedIndex;
  const actor = stage?.actors[shownActor];
  if (actor) desk.set(actor);
};
find("camera").onclick = () => void watch("camera");
find("sample").onclick = () => void watch("sample");
find("video-file").onclick = () => void upload();
find("meet").onclick = () => void meet();
find("record").onclick = record;
find("microphone").onclick = microphone;
find("theme").onclick = theme;
find("help").onclick = help;
find("tabWeights").onclick = () => tab("Weights");
find("tabFaces").onclick = () => tab("Faces");
find("microphone").innerHTML =
  '<svg viewBox="0 0 16 16"><rect x="5.5" y="1" width="5" height="9" rx="2.5" /><path class="line" d="M3 7.5a5 5 0 0 0 10 0M8 12.5V15" /></svg>';
find("theme").innerHTML = '<svg viewBox="0 0 16 16"><path d="M8 1a7 7 0 1 0 0 14z" /><circle class="line" cx="8" cy="8" r="6.3" /></svg>';
if (matchMedia("(prefers-color-scheme: dark)").matches) document.documentElement.dataset.theme = "dark";

const keys: Key[] = [
  { key: "1", what: "your camera", press: () => void watch("camera") },
  { key: "2", what: "the sample", press: () => void watch("sample") },
  { key: "3", what: "a video from your disk", press: () => void upload() },
  { key: "4", what: "a character of your own", press: () => void guests.invite() },
  { key: "n", what: "hold your face at rest", press: () => { tab("Faces"); coach.rest(); } },
  { key: "e", what: "the face you hold at this moment is an example of your own", press: () => { tab("Faces"); coach.own(); } },
  { key: "r", what: "record, and stop", press: record },
  { key: " ", what: "play or pause", press: () => { if (!find("timeline").hidden) timeline.toggle(); } },
  { key: "s", what: "sound on or off", press: () => timeline.mute() },
  { key: "m", what: "microphone on or off", press: microphone },
  { key: "w", what: "weights", press: () => tab("Weights") },
  { key: "f", what: "your faces", press: () => tab("Faces") },
  { key: "t", what: "light or dark", press: theme },
  { key: "?", what: "this list", press: help },
];
listen(keys);

import "./style.css";
import { Cast } from "./cast";
import { Coach } from "./coach";
import { Desk } from "./desk";
import { choices, find, note, plain, spoken } from "./dom";
import { Files } from "./files";
import { Guests } from "./guests";
import { type Key, listen } from "./keys";
import { Line } from "./line";
import type { Look, StageSet, ToPage } from "./messages";
import type { Packet } from "./packet";
import { Performer } from "./performer";
import { Takes } from "./takes";
import { Theatre } from "./theatre";
import { Timeline } from "./timeline";
import { CAPTURES, MAPPINGS } from "./ways";

const ON_CANVAS = "camera to canvas";
const MOST_MEASURES = 600;
const FILMS: Look["source"][] = ["camera", "sample", "video"];
const theatre = new Theatre(find<HTMLCanvasElement>("stage"), find("plates"), drawn);
const line = new Line(told, frame, reached);
const performer = new Performer((time, picture) => line.show(time, picture));
const desk = new Desk(find("bars"), find<HTMLInputElement>("filter"), (adjust) => line.say(adjust));
const coach = new Coach((message) => line.say(message));
const timeline = new Timeline((message) => line.say(message));
const takes = new Takes((name) => void watch("take", name));
const guests = new Guests((name) => cast.appear(name));
const cast = new Cast((message) => line.say(message), guests);
const files = new Files({
  video: (name) => void watch("video", name),
  take: (name) => void watch("take", name),
  performer: (name) => line.say({ kind: "Meet", name }),
  model: (file) => void guests.bring(file),
});
let stage: StageSet | undefined;
let shownActor = 0;
let looked: Look | undefined;
let lost = false;
/** Of the character whose bars are shown. */
let weights: Float32Array = new Float32Array();
/** When the camera saw what comes to the canvas next, milliseconds of the page's clock. */
let filmed = 0;

/** A server that comes back is told again what was chosen, and who does not know it is told so. */
function reached(there: boolean): void {
  find("away").hidden = there;
  if (there && lost) {
    way();
    cast.repeat();
    desk.repeat();
    if (looked) line.say(looked);
    if (stage?.faces.length) note("It is another server: bring your faces back with Load.");
  }
  lost = !there;
}

function told(message: ToPage): void {
  if (message.kind === "Note") note(message.text, message.level);
  else if (message.kind === "Learnt") coach.learnt(message);
  else void set(message);
}

async function set(message: StageSet): Promise<void> {
  stage = message;
  // Whoever opens the page sees it act.
  if (!looked) void watch("sample");
  settings(message);
  sources(message);
  cast.set(message);
  takes.set(message);
  coach.set(message);
  timeline.set(message);
  performer.invite(message.source);
  await theatre.set(message.actors);
  document.body.dataset.source = message.source;
}

function settings(message: StageSet): void {
  choices(find("capture"), plain(message.captures), message.way.capture);
  choices(find("mapping"), plain(message.mappings), message.way.mapping);
  find("capture").title = CAPTURES[message.way.capture] ?? "";
  find("mapping").title = MAPPINGS[message.way.mapping] ?? "";
  find<HTMLInputElement>("mirror").checked = message.way.mirror;
  find<HTMLInputElement>("gain").value = String(message.way.gain);
  find("gainValue").textContent = message.way.gain.toFixed(2);
  shownActor = Math.max(Math.min(shownActor, message.actors.length - 1), 0);
  choices(find("actor"), message.actors.map(({ name }) => [name, spoken(name)]), message.actors[shownActor]?.name ?? "");
  const actor = message.actors[shownActor];
  if (actor) desk.set(actor);
  const record = find<HTMLButtonElement>("record");
  record.ariaPressed = String(message.recording);
  record.lastElementChild!.textContent = message.recording ? "Stop" : "Record";
  record.disabled = !FILMS.includes(message.source);
  find("microphone").hidden = message.source !== "camera";
}

function frame(packet: Packet): void {
  packet.actors.forEach((acting, number) => theatre.act(number, acting));
  weights = packet.actors.get(shownActor)?.weights ?? weights;
  if (stage?.source === "camera" && packet.actors.size) filmed = 1000 * packet.time;
  performer.see(packet);
  coach.see(packet.held);
  timeline.see(packet);
}

/** The bars move with the characters; and how long it took from the camera to the canvas is noted, for
 *  the browser's own tools and for tests. */
function drawn(): void {
  desk.show(weights);
  if (!filmed) return;
  performance.measure(ON_CANVAS, { start: filmed, end: performance.now() });
  if (performance.getEntriesByName(ON_CANVAS).length > MOST_MEASURES) performance.clearMeasures(ON_CANVAS);
  filmed = 0;
}

async function watch(source: Look["source"], name = ""): Promise<void> {
  looked = { kind: "Look", source, name };
  performer.rest();
  coach.end();
  if (source === "camera") {
    try {
      await performer.film();
    } catch {
      note("No camera can be used: is one plugged in, and may this page use it?", "error");
      return watch("sample");
    }
  }
  timeline.begin();
  line.say(looked);
}

function sources(message: StageSet): void {
  const chosen: Partial<Record<Look["source"], string>> = { camera: "camera", sample: "sample", video: "open", take: "open" };
  for (const id of ["camera", "sample", "open"]) find(id).ariaPressed = String(chosen[message.source] === id);
  find("open").textContent = chosen[message.source] === "open" ? message.name.replace(/\.\w+$/, "") : "Open…";
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
const record = () => { if (!find<HTMLButtonElement>("record").disabled) line.say({ kind: "Recording", on: !stage?.recording }); };
const help = () => find<HTMLDialogElement>("keys").showModal();
const open = () => void files.ask("video", "take");

for (const id of ["capture", "mapping", "gain", "mirror"]) find(id).onchange = way;
find("gain").oninput = () => { find("gainValue").textContent = Number(find<HTMLInputElement>("gain").value).toFixed(2); };
find("actor").onchange = () => {
  shownActor = find<HTMLSelectElement>("actor").selectedIndex;
  const actor = stage?.actors[shownActor];
  if (actor) desk.set(actor);
};
find("camera").onclick = () => void watch("camera");
find("sample").onclick = () => void watch("sample");
find("open").onclick = open;
find("meet").onclick = () => void files.ask("performer");
find("record").onclick = record;
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
  { key: "3", what: "a video or a take from your disk", press: open },
  { key: "4", what: "a character of your own", press: () => void guests.invite() },
  { key: "n", what: "hold your face at rest", press: () => { tab("Faces"); coach.rest(); } },
  { key: "e", what: "the face you hold now is an example of your own", press: () => { tab("Faces"); coach.own(); } },
  { key: "r", what: "record, and stop", press: record },
  { key: " ", what: "play or pause", press: () => { if (!find("timeline").hidden) timeline.toggle(); } },
  { key: "s", what: "sound on or off", press: () => timeline.mute() },
  { key: "x", what: "export what is played", press: () => { if (!find("export").hidden) find("exports").togglePopover(); } },
  { key: "m", what: "microphone on or off", press: () => takes.listen() },
  { key: "w", what: "weights", press: () => tab("Weights") },
  { key: "f", what: "your faces", press: () => tab("Faces") },
  { key: "t", what: "light or dark", press: theme },
  { key: "?", what: "this list", press: help },
];
listen(keys);

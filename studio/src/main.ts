import "./style.css";
import { Desk } from "./desk";
import { Line } from "./line";
import type { Look, StageSet, ToPage, Way } from "./messages";
import type { Packet } from "./packet";
import { Performer } from "./performer";
import { Theatre } from "./theatre";

const find = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;
const theatre = new Theatre(find("stage"), find("plates"));
const line = new Line(told, frame, reached);
const performer = new Performer((time, picture) => line.show(time, picture));
const desk = new Desk(find("bars"), find("filter"), (adjust) => line.say(adjust));
let stage: StageSet | undefined;
let shownActor = 0;
let playing = true;
let place = 0;
let take = "";
let looked: Look | undefined;
let cast: string[] = [];
let lost = false;

/** A server that comes back is told again what it should look at. */
function reached(there: boolean): void {
  if (!there && !lost) note("the server is not there; trying again", "error");
  if (there && lost) {
    if (cast.length) line.say({ kind: "Cast", characters: cast });
    if (looked) line.say(looked);
  }
  lost = !there;
}

function told(message: ToPage): void {
  if (message.kind === "Note") note(message.text, message.level);
  else void set(message);
}

async function set(message: StageSet): Promise<void> {
  stage = message;
  await theatre.set(message.actors);
  choices(find<HTMLSelectElement>("capture"), message.captures, message.way.capture);
  choices(find<HTMLSelectElement>("mapping"), message.mappings, message.way.mapping);
  find<HTMLInputElement>("mirror").checked = message.way.mirror;
  find<HTMLInputElement>("gain").value = String(message.way.gain);
  find("gainValue").textContent = message.way.gain.toFixed(2);
  shownActor = Math.min(shownActor, message.actors.length - 1);
  choices(find<HTMLSelectElement>("actor"), message.actors.map((actor) => actor.name), message.actors[shownActor]?.name ?? "");
  const actor = message.actors[shownActor];
  if (actor) desk.set(actor);
  find("record").ariaPressed = String(message.recording);
  sources(message);
  castChips(message);
  takes(message);
  performer.invite(message.source === "none");
  find("timeline").hidden = message.source !== "take";
  document.body.dataset.source = message.source;
}

function frame(packet: Packet): void {
  packet.actors.forEach((acting, number) => theatre.act(number, acting));
  const shown = packet.actors.get(shownActor);
  if (shown) desk.show(shown.weights);
  performer.see(packet);
  const words = { waiting: "looking for a face at rest", following: "following", lost: "the face is lost" };
  const state = find("state");
  state.dataset.state = packet.state;
  state.textContent = `${words[packet.state]} · ${packet.late.toFixed(0)} ms`;
  if (packet.playing) {
    place = packet.playing.place;
    const slider = find<HTMLInputElement>("place");
    slider.max = String(packet.playing.length);
    if (document.activeElement !== slider || playing) slider.value = String(place);
    find("clock").textContent = `${place.toFixed(1)} of ${packet.playing.length.toFixed(1)} s`;
  }
}

async function watch(look: Omit<Look, "kind">): Promise<void> {
  performer.rest();
  if (look.source === "camera") {
    try {
      await performer.film();
    } catch {
      note("no camera can be used: is one plugged in, and may this page use it?", "error");
      return;
    }
  }
  take = look.source === "take" ? look.name : "";
  playing = true;
  looked = { kind: "Look", ...look };
  line.say(looked);
}

function sources(message: StageSet): void {
  const camera = button("Camera", message.source === "camera", () => void watch({ source: "camera", name: "" }));
  const sample = button("Sample", message.source === "sample", () => void watch({ source: "sample", name: "" }));
  const upload = button("Video…", message.source === "video", () => {
    const input = document.createElement("input");
    input.type = "file";
    input.accept = "video/*";
    input.onchange = () => { if (input.files?.[0]) void bring(input.files[0]); };
    input.click();
  });
  camera.id = "camera"; sample.id = "sample"; upload.id = "upload";
  find("sources").replaceChildren(camera, sample, upload);
}

async function bring(file: File): Promise<void> {
  const name = file.name.replace(/[^\w .()+-]/g, "_").slice(-90);
  note(`bringing ${name} …`, "info");
  const answer = await fetch(`videos/${encodeURIComponent(name)}`, { method: "PUT", body: file });
  const said = (await answer.json()) as { error?: string };
  if (answer.ok) void watch({ source: "video", name });
  else note(said.error ?? "the video could not be kept", "error");
}

function castChips(message: StageSet): void {
  cast = message.actors.map((actor) => actor.name);
  find("cast").replaceChildren(
    ...message.characters.map((name) =>
      button(name, cast.includes(name), () => {
        const characters = cast.includes(name) ? cast.filter((other) => other !== name) : [...cast, name];
        if (!characters.length) return;
        cast = characters;
        line.say({ kind: "Cast", characters });
      }),
    ),
  );
}

function takes(message: StageSet): void {
  const items = [...message.takes].reverse().map((name) => {
    const item = document.createElement("li");
    item.append(button(name.replace(/\.take$/, ""), name === take, () => void watch({ source: "take", name })));
    return item;
  });
  if (!items.length) {
    const none = document.createElement("li");
    none.className = "none";
    none.textContent = "none yet: press Record";
    items.push(none);
  }
  find("takes").replaceChildren(...items);
  find("exports").replaceChildren(
    ...message.actors.map((actor) => {
      const link = document.createElement("a");
      link.href = `takes/${encodeURIComponent(take)}/${actor.name}.glb`;
      link.download = "";
      link.textContent = `${actor.name}.glb`;
      return link;
    }),
  );
}

function button(text: string, pressed: boolean, press: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.textContent = text;
  made.ariaPressed = String(pressed);
  made.onclick = press;
  return made;
}

function choices(select: HTMLSelectElement, names: string[], chosen: string): void {
  select.replaceChildren(...names.map((name) => new Option(name, name, name === chosen, name === chosen)));
}

function note(text: string, level: "info" | "error"): void {
  const line = document.createElement("p");
  line.className = level;
  line.textContent = text;
  find("notes").append(line);
  setTimeout(() => line.remove(), 6000);
}

function way(): void {
  const said: Way = {
    kind: "Way",
    capture: find<HTMLSelectElement>("capture").value,
    mapping: find<HTMLSelectElement>("mapping").value,
    gain: Number(find<HTMLInputElement>("gain").value),
    mirror: find<HTMLInputElement>("mirror").checked,
  };
  line.say(said);
}

for (const id of ["capture", "mapping", "gain", "mirror"]) find(id).onchange = way;
find("gain").oninput = () => { find("gainValue").textContent = Number(find<HTMLInputElement>("gain").value).toFixed(2); };
find("actor").onchange = () => {
  shownActor = find<HTMLSelectElement>("actor").selectedIndex;
  const actor = stage?.actors[shownActor];
  if (actor) desk.set(actor);
};
const learn = () => { line.say({ kind: "Learn" }); note("relax your face and hold it for a second", "info"); };
const record = () => line.say({ kind: "Recording", on: !stage?.recording });
const play = () => {
  playing = !playing;
  find("play").textContent = playing ? "❚❚" : "▶";
  line.say({ kind: "Seek", time: place, playing });
};
const theme = () => {
  const dark = document.documentElement.dataset.theme !== "dark";
  document.documentElement.dataset.theme = dark ? "dark" : "light";
};
find("learn").onclick = learn;
find("record").onclick = record;
find("play").onclick = play;
find("theme").onclick = theme;
find("place").oninput = () => {
  line.say({ kind: "Seek", time: Number(find<HTMLInputElement>("place").value), playing: false });
  playing = false;
  find("play").textContent = "▶";
};
if (matchMedia("(prefers-color-scheme: dark)").matches) document.documentElement.dataset.theme = "dark";
addEventListener("keydown", (event) => {
  if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement) return;
  const keys: Record<string, () => void> = { n: learn, r: record, t: theme };
  if (event.code === "Space" && stage?.source === "take") { event.preventDefault(); play(); }
  else if (!event.ctrlKey && !event.metaKey) keys[event.key.toLowerCase()]?.();
});

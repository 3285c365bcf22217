// The characters, side by side in one canvas.

import {
  ACESFilmicToneMapping, AmbientLight, Box3, type BufferAttribute, DirectionalLight, HemisphereLight, Mesh, type Object3D, PerspectiveCamera,
  Scene, Vector3, WebGLRenderer,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { Actor } from "./messages";
import type { Acting } from "./packet";

/** Metres that are seen of a head without a body, about it. */
const ROOM = 1.15;
/** Degrees from top to bottom. */
const FIELD = 16;
/** Width over height of a cell in which a face just has room. */
const SLIM = 0.72;

/** Metres beyond which nobody leaves their place, however far the performer goes. */
const LEASH = 0.05;
const near = (step: number) => LEASH * Math.tanh(step / LEASH);

/** Rows of the weights that move each mesh, in the mesh's own order. */
interface Moved { mesh: Mesh; rows: number[] }

/** The box of what is at rest; three.js would make room for every morph target at once. */
function boxOf(root: Object3D): Box3 {
  const box = new Box3();
  root.updateWorldMatrix(true, true);
  root.traverse((object) => {
    const places = object instanceof Mesh ? (object.geometry.getAttribute("position") as BufferAttribute) : undefined;
    if (places) box.union(new Box3().setFromBufferAttribute(places).applyMatrix4(object.matrixWorld));
  });
  return box;
}

class Player {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(FIELD, 1, 0.1, 20);
  private root?: Object3D;
  private rest: [number, number, number] = [0, 0, 0];
  private moved: Moved[] = [];

  constructor(readonly actor: Actor) {
    this.camera.position.set(0, 0.0, 1.28);
    this.camera.lookAt(0, -0.04, -0.04);
    const key = new DirectionalLight(0xfff1e0, 2.6);
    key.position.set(-0.6, 0.7, 0.9);
    const fill = new DirectionalLight(0xcfe0ff, 0.9);
    fill.position.set(0.9, 0.1, 0.6);
    const rim = new DirectionalLight(0xffffff, 1.6);
    rim.position.set(0.7, 0.5, -0.9);
    this.scene.add(key, fill, rim, new HemisphereLight(0xcfd8e6, 0x6b5b50, 0.9), new AmbientLight(0xffffff, 0.15));
  }

  async load(loader: GLTFLoader): Promise<void> {
    const { scene } = await loader.loadAsync(this.actor.url);
    this.root = scene.getObjectByName(this.actor.name);
    if (this.root) this.rest = this.root.position.toArray();
    const row = new Map(this.actor.targets.map((name, i) => [name, i]));
    scene.traverse((object) => {
      object.frustumCulled = false;
      const dictionary = object instanceof Mesh ? object.morphTargetDictionary : undefined;
      if (object instanceof Mesh && dictionary) {
        const rows: number[] = [];
        for (const [name, index] of Object.entries(dictionary)) rows[index] = row.get(name) ?? -1;
        this.moved.push({ mesh: object, rows });
      }
    });
    this.scene.add(scene);
    this.frame(scene);
  }

  /** Whoever has no body is seen whole, and in the middle. */
  private frame(scene: Object3D): void {
    const head = scene.getObjectByName("head");
    const box = head && boxOf(head);
    if (!box || boxOf(scene).min.y < box.min.y - 0.02) return;
    const size = box.getSize(new Vector3());
    const middle = box.getCenter(new Vector3());
    const away = (ROOM * Math.max(size.y, size.x / SLIM)) / 2 / Math.tan((FIELD * Math.PI) / 360);
    this.camera.position.set(0, middle.y, box.max.z + away);
    this.camera.lookAt(0, middle.y, 0);
  }

  act(acting: Acting): void {
    for (const { mesh, rows } of this.moved) {
      const influences = mesh.morphTargetInfluences;
      if (influences) rows.forEach((from, to) => (influences[to] = acting.weights[from] ?? 0));
    }
    this.root?.getObjectByName("head")?.quaternion.set(...acting.head);
    this.root?.getObjectByName("eye_left")?.quaternion.set(...acting.eyes[0]);
    this.root?.getObjectByName("eye_right")?.quaternion.set(...acting.eyes[1]);
    const [x, y, z] = acting.place.map(near) as Acting["place"];
    this.root?.position.set(this.rest[0] + x, this.rest[1] + y, this.rest[2] + z);
  }
}

export class Theatre {
  private readonly renderer: WebGLRenderer;
  private readonly loader = new GLTFLoader();
  private players: Player[] = [];
  private stale = true;
  private drawn = 0;
  private pace = 33;
  private pause = 0;
  private sharpness = 1;

  /** `told` is called whenever the canvas shows something new. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly plates: HTMLElement,
    private readonly told: () => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.autoClear = false;
    new ResizeObserver(() => this.fit()).observe(canvas.parentElement ?? canvas);
    const draw = (now: number) => {
      requestAnimationFrame(draw);
      if (!this.stale || now - this.drawn < this.pause) return;
      this.keepPace(now - this.drawn);
      this.drawn = now;
      this.draw();
      this.told();
    };
    requestAnimationFrame(draw);
  }

  /** Where drawing is slow (no graphics card) the picture gets coarser, and the page some rest. */
  private keepPace(interval: number): void {
    this.pace += 0.1 * (Math.min(interval, 400) - this.pace);
    const slow = this.pace > 70 && this.sharpness > 0.4;
    const quick = this.pace < 25 && this.sharpness < 1;
    if (slow || quick) {
      this.sharpness *= slow ? 0.8 : 1.25;
      this.pace = 45;
      this.fit();
    }
    this.pause = this.pace > 50 ? 90 : 0;
  }

  /** Puts `actors` on stage; those who stay are not loaded again. */
  async set(actors: Actor[]): Promise<void> {
    const kept = new Map(this.players.map((player) => [player.actor.url, player]));
    const fresh = actors.filter((actor) => !kept.has(actor.url)).map((actor) => new Player(actor));
    await Promise.all(fresh.map((player) => player.load(this.loader)));
    for (const player of fresh) kept.set(player.actor.url, player);
    this.players = actors.flatMap((actor) => kept.get(actor.url) ?? []);
    this.fit();
  }

  act(number: number, acting: Acting): void {
    this.players[number]?.act(acting);
    this.stale = true;
  }

  private cells(): { x: number; y: number; w: number; h: number }[] {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const count = this.players.length;
    const columns = count > 2 && width < 1.4 * height ? 2 : Math.max(count, 1);
    const rows = Math.ceil(count / columns);
    // A last row that is not full stands in the middle.
    const aside = (i: number) => (i >= count - (count % columns) ? ((columns - (count % columns)) * width) / columns / 2 : 0);
    return this.players.map((_, i) => ({
      x: ((i % columns) * width) / columns + aside(i),
      y: (Math.floor(i / columns) * height) / rows,
      w: width / columns,
      h: height / rows,
    }));
  }

  private fit(): void {
    const box = this.canvas.parentElement;
    if (!box) return;
    this.renderer.setPixelRatio(this.sharpness * Math.min(devicePixelRatio, 2));
    this.renderer.setSize(box.clientWidth, box.clientHeight, false);
    this.plates.replaceChildren(
      ...this.cells().map((cell, i) => {
        const plate = document.createElement("span");
        plate.textContent = this.players[i]?.actor.name ?? "";
        plate.style.left = `${cell.x + cell.w / 2}px`;
        plate.style.top = `${cell.y + cell.h - 34}px`;
        return plate;
      }),
    );
    this.stale = true;
  }

  private draw(): void {
    this.stale = false;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.clear();
    this.cells().forEach((cell, i) => {
      const player = this.players[i];
      if (!player) return;
      player.camera.aspect = cell.w / cell.h;
      // A narrow cell keeps the whole face in view.
      player.camera.fov = FIELD * Math.max(1, SLIM / player.camera.aspect);
      // Each has a cell, but whoever leans over is not cut off at its border.
      player.camera.setViewOffset(cell.w, cell.h, -cell.x, -cell.y, width, height);
      this.renderer.clearDepth();
      this.renderer.render(player.scene, player.camera);
    });
  }
}

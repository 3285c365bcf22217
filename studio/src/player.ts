// One character: loaded once, lit, framed as a portrait, and moved by its weights.

import { Box3, type BufferAttribute, type DirectionalLight, Mesh, type Object3D, PerspectiveCamera, Scene, type Texture, Vector3 } from "three";
import type { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { lamps } from "./light";
import type { Actor } from "./messages";
import type { Acting } from "./packet";

/** Degrees from top to bottom. */
const FIELD = 16;
/** Heights and widths of a head that are at least seen of it. */
const TALL = 1.24;
const WIDE = 1.1;
/** Heights of a head above it, where there is room. */
const AIR = 0.1;
/** Metres beyond which nobody leaves their place, however far the performer goes. */
const LEASH = 0.05;
const near = (step: number) => LEASH * Math.tanh(step / LEASH);

/** A weight that nobody sees costs as much to draw as any other. */
const UNSEEN = 2e-3;
const felt = (weight = 0) => (Math.abs(weight) < UNSEEN ? 0 : weight);

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

export class Player {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(FIELD, 1, 0.05, 20);
  private key?: DirectionalLight;
  private root?: Object3D;
  private head = new Box3();
  private whole = new Box3();
  private rest: [number, number, number] = [0, 0, 0];
  private moved: Moved[] = [];

  constructor(readonly actor: Actor, room: Texture) {
    this.scene.environment = room;
    this.scene.environmentIntensity = 0.62;
  }

  async load(loader: GLTFLoader): Promise<void> {
    const { scene } = await loader.loadAsync(this.actor.url);
    this.root = scene.getObjectByName(this.actor.name);
    if (this.root) this.rest = this.root.position.toArray();
    const row = new Map(this.actor.targets.map((name, i) => [name, i]));
    scene.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.frustumCulled = false;
      object.castShadow = object.receiveShadow = true;
      const rows: number[] = [];
      for (const [name, index] of Object.entries(object.morphTargetDictionary ?? {})) rows[index] = row.get(name) ?? -1;
      if (rows.length) this.moved.push({ mesh: object, rows });
    });
    this.whole = boxOf(scene);
    this.head = boxOf(scene.getObjectByName("head") ?? scene);
    const { key, rim } = lamps(this.whole);
    this.key = key;
    this.scene.add(scene, key, key.target, rim, rim.target);
  }

  /** Looks at the head so that it has room in a cell of this width over height, and the body, where
   *  there is one, leaves by its lower edge. */
  frame(aspect: number): void {
    const size = this.head.getSize(new Vector3());
    const middle = this.head.getCenter(new Vector3());
    const seen = Math.max(TALL * size.y, (WIDE * size.x) / aspect);
    const body = this.head.min.y - this.whole.min.y > 0.05 * size.y;
    const floor = this.whole.min.y + LEASH + seen / 2;
    const height = body ? Math.max(floor, Math.min(this.head.max.y + AIR * size.y - seen / 2, middle.y)) : middle.y;
    this.camera.aspect = aspect;
    this.camera.position.set(middle.x, height, this.head.max.z + seen / 2 / Math.tan((FIELD * Math.PI) / 360));
    this.camera.updateProjectionMatrix();
  }

  /** With the shadows it casts on itself, or without. */
  shade(on: boolean): void {
    if (this.key) this.key.castShadow = on;
  }

  act(acting: Acting): void {
    for (const { mesh, rows } of this.moved) {
      const influences = mesh.morphTargetInfluences;
      if (influences) rows.forEach((from, to) => (influences[to] = felt(acting.weights[from])));
    }
    this.root?.getObjectByName("head")?.quaternion.set(...acting.head);
    this.root?.getObjectByName("eye_left")?.quaternion.set(...acting.eyes[0]);
    this.root?.getObjectByName("eye_right")?.quaternion.set(...acting.eyes[1]);
    const [x, y, z] = acting.place.map(near) as Acting["place"];
    this.root?.position.set(this.rest[0] + x, this.rest[1] + y, this.rest[2] + z);
  }
}

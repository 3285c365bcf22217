// The light of the stage: a photographer's, a large soft one from the left that casts shadows, and a
// room of bright panels that eyes and skin reflect.

import {
  BackSide, type Box3, BoxGeometry, Color, DirectionalLight, Mesh, MeshBasicMaterial, PMREMGenerator, Scene, type Texture, Vector3,
  type WebGLRenderer,
} from "three";

/** What hangs in the room: its colour, how bright, where, how large; metres. */
const PANELS: [colour: number, bright: number, at: [number, number, number], size: [number, number, number]][] = [
  [0xfff0de, 9, [-3.2, 2.6, 2.2], [0.1, 2.6, 2.6]],
  [0xffffff, 5, [0, 4.4, 0.4], [3.4, 0.1, 3.0]],
  [0xd9e7ff, 3.2, [3.8, 0.6, 1.6], [0.1, 3.4, 1.6]],
  [0xe8f0ff, 7, [2.6, 1.6, -3.6], [1.2, 3.0, 0.1]],
];
const WALLS = 0x8d8f96;
const WALLS_BRIGHT = 0.55;

/** What a room of panels throws on whoever stands in it. */
export function room(renderer: WebGLRenderer): Texture {
  const scene = new Scene();
  const cube = (colour: number, bright: number, at: Vector3, size: Vector3, inside = false) => {
    const material = new MeshBasicMaterial({ color: new Color(colour).multiplyScalar(bright) });
    if (inside) material.side = BackSide;
    const mesh = new Mesh(new BoxGeometry(...size), material);
    mesh.position.copy(at);
    scene.add(mesh);
  };
  cube(WALLS, WALLS_BRIGHT, new Vector3(), new Vector3(10, 10, 10), true);
  for (const [colour, bright, at, size] of PANELS) cube(colour, bright, new Vector3(...at), new Vector3(...size));
  const generator = new PMREMGenerator(renderer);
  const { texture } = generator.fromScene(scene, 0.03);
  generator.dispose();
  return texture;
}

/** The light that casts shadows within `box`, and one from behind that parts hair from ground. */
export function lamps(box: Box3): { key: DirectionalLight; rim: DirectionalLight } {
  const middle = box.getCenter(new Vector3());
  const reach = box.getSize(new Vector3()).length() / 2;
  const key = new DirectionalLight(0xfff4ea, 2.9);
  key.position.copy(middle).add(new Vector3(-0.62, 0.78, 1).multiplyScalar(2 * reach));
  key.target.position.copy(middle);
  key.shadow.mapSize.set(1024, 1024);
  key.shadow.radius = 5;
  key.shadow.normalBias = 0.012 * reach;
  key.shadow.bias = -0.0006;
  const seen = key.shadow.camera;
  seen.left = seen.bottom = -reach;
  seen.right = seen.top = reach;
  seen.near = 0.5 * reach;
  seen.far = 5 * reach;
  const rim = new DirectionalLight(0xe4eeff, 1.5);
  rim.position.copy(middle).add(new Vector3(0.8, 0.6, -1));
  rim.target.position.copy(middle);
  return { key, rim };
}

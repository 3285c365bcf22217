// A character that is turned and pointed at.

import {
  Box3, DirectionalLight, HemisphereLight, type Intersection, Mesh, MeshBasicMaterial, MeshStandardMaterial, type Object3D,
  PerspectiveCamera, Raycaster, Scene, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

type Place = [number, number, number];
const STEP = 0.12;
const STILL = 4;

export class Picker {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(24, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly sized: ResizeObserver;
  private readonly marks: Mesh[] = [];
  private model?: Object3D;
  private size = 1;
  private down = new Vector2();

  constructor(private readonly canvas: HTMLCanvasElement, private readonly marked: (place: Place) => void) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    const key = new DirectionalLight(0xffffff, 1.7);
    key.position.set(-1, 1, 1.5);
    this.camera.add(key);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0x6f747c, 0.8));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    canvas.onpointerdown = (event) => this.down.set(event.clientX, event.clientY);
    canvas.onpointerup = (event) => {
      if (this.down.distanceTo(new Vector2(event.clientX, event.clientY)) < STILL && event.button === 0) this.point(event.clientX, event.clientY);
    };
    canvas.onkeydown = (event) => this.key(event);
    this.sized = new ResizeObserver(() => this.fit());
    this.sized.observe(canvas.parentElement ?? canvas);
  }

  async load(address: string): Promise<void> {
    const { scene } = await new GLTFLoader().loadAsync(address);
    const bounds = (scene.userData.face ?? null) as { low: Place; high: Place; facing: number } | null;
    const box = bounds ? new Box3(new Vector3(...bounds.low), new Vector3(...bounds.high)) : new Box3().setFromObject(scene);
    const middle = box.getCenter(new Vector3());
    this.size = box.getSize(new Vector3()).length();
    scene.traverse((object) => {
      if (object instanceof Mesh) object.material = new MeshStandardMaterial({ vertexColors: true, roughness: 0.75 });
    });
    this.model = scene;
    this.scene.add(scene);
    this.camera.near = this.size / 100;
    this.camera.far = this.size * 100;
    this.camera.position.copy(middle).add(new Vector3(0, 0, (bounds?.facing ?? 1) * 2.4 * this.size));
    this.controls.target.copy(middle);
    this.controls.update();
    this.fit();
    this.canvas.focus();
  }

  /** Shows these marks and no others. */
  show(places: Place[]): void {
    this.marks.splice(0).forEach((mark) => this.scene.remove(mark));
    for (const place of places) {
      const mark = new Mesh(new SphereGeometry(this.size * 0.008, 16, 12), new MeshBasicMaterial({ color: 0xd9532f, depthTest: false }));
      mark.position.set(...place);
      mark.renderOrder = 1;
      this.marks.push(mark);
      this.scene.add(mark);
    }
    this.draw();
  }

  /** Turns the view about the character, radians to the right and up. */
  turn(aside: number, up: number): void {
    const away = this.camera.position.clone().sub(this.controls.target);
    away.applyAxisAngle(new Vector3(0, 1, 0), aside);
    const level = new Vector3(away.z, 0, -away.x).normalize();
    away.applyAxisAngle(level, -up);
    this.camera.position.copy(this.controls.target).add(away);
    this.controls.update();
    this.draw();
  }

  close(): void {
    this.sized.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
  }

  private key(event: KeyboardEvent): void {
    const ways: Record<string, () => void> = {
      ArrowLeft: () => this.turn(-STEP, 0), ArrowRight: () => this.turn(STEP, 0),
      ArrowUp: () => this.turn(0, STEP), ArrowDown: () => this.turn(0, -STEP),
      Enter: () => { const box = this.canvas.getBoundingClientRect(); this.point(box.left + box.width / 2, box.top + box.height / 2); },
    };
    const way = ways[event.key];
    if (!way) return;
    event.preventDefault();
    way();
  }

  private point(x: number, y: number): void {
    const box = this.canvas.getBoundingClientRect();
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height), this.camera);
    const hit: Intersection | undefined = this.model && caster.intersectObject(this.model, true)[0];
    if (hit) this.marked(hit.point.toArray());
  }

  private fit(): void {
    const box = this.canvas.parentElement;
    if (!box?.clientWidth) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(box.clientWidth, box.clientHeight, false);
    this.camera.aspect = box.clientWidth / box.clientHeight;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private draw(): void { this.renderer.render(this.scene, this.camera); }
}

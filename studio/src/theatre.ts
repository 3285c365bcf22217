// The characters, side by side in one canvas, a card each.

import { NeutralToneMapping, PCFShadowMap, type Texture, WebGLRenderer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { find, spoken } from "./dom";
import { room } from "./light";
import type { Actor } from "./messages";
import type { Acting } from "./packet";
import { Player } from "./player";

/** Pixels between two cards. */
const GAP = 10;
/** Width over height of a card that a portrait just fills. */
const PORTRAIT = 0.8;
/** Milliseconds after which what does not move is drawn as finely as can be. */
const SETTLED = 1200;
/** Milliseconds a picture that are slow, or quick, and that count at most. */
const SLOW = 60;
const QUICK = 20;
const MOST = 400;
/** Pixels drawn for one of the screen's, at least. */
const COARSEST = 0.4;

/** Whether pictures are drawn without a graphics card. */
function unaided(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const told = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && told ? String(gl.getParameter(told.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

interface Cell { x: number; y: number; w: number; h: number }

/** Where `count` cards go so that portraits are largest; a last row that is not full is wider. */
export function cells(count: number, width: number, height: number): Cell[] {
  const size = (columns: number) => {
    const w = (width + GAP) / columns - GAP;
    const h = (height + GAP) / Math.ceil(count / columns) - GAP;
    return Math.min(w / PORTRAIT, h);
  };
  let columns = count;
  for (let fewer = count - 1; fewer > 0; fewer--) if (size(fewer) > 1.1 * size(columns)) columns = fewer;
  const rows = Math.ceil(count / columns);
  const h = (height + GAP) / rows - GAP;
  return Array.from({ length: count }, (_, i) => {
    const row = Math.floor(i / columns);
    const beside = Math.min(columns, count - row * columns);
    const w = (width + GAP) / beside - GAP;
    return { x: (i % columns) * (w + GAP), y: row * (h + GAP), w, h };
  });
}

export class Theatre {
  private readonly renderer: WebGLRenderer;
  private readonly loader = new GLTFLoader();
  private readonly room: Texture;
  private players: Player[] = [];
  private stale = true;
  private fine = false;
  private drawn = 0;
  private pace = (SLOW + QUICK) / 2;
  private fence?: WebGLSync;
  private pause = 0;
  private sharpness = 1;

  /** `told` is called whenever the canvas shows something new. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly cards: HTMLElement,
    private readonly told: () => void,
  ) {
    const slow = unaided();
    if (slow) this.sharpness = COARSEST;
    this.renderer = new WebGLRenderer({ canvas, antialias: !slow, alpha: true });
    this.renderer.toneMapping = NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.setScissorTest(true);
    this.room = room(this.renderer);
    new ResizeObserver(() => this.fit()).observe(canvas.parentElement ?? canvas);
    const draw = (now: number) => {
      requestAnimationFrame(draw);
      // Nobody sees the stage behind a character that is pointed at.
      if (find<HTMLDialogElement>("picking").open || !this.finished(now)) return;
      if (this.stale && now - this.drawn >= this.pause) this.next(now);
      else if (!this.stale && !this.fine && now - this.drawn > SETTLED) this.polish();
    };
    requestAnimationFrame(draw);
  }

  /** Puts `actors` on stage; those who stay are not loaded again. */
  async set(actors: Actor[]): Promise<void> {
    const kept = new Map(this.players.map((player) => [player.actor.url, player]));
    const fresh = actors.filter((actor) => !kept.has(actor.url)).map((actor) => new Player(actor, this.room));
    await Promise.all(fresh.map((player) => player.load(this.loader)));
    for (const player of fresh) kept.set(player.actor.url, player);
    this.players = actors.flatMap((actor) => kept.get(actor.url) ?? []);
    this.fit();
  }

  act(number: number, acting: Acting): void {
    this.players[number]?.act(acting);
    this.stale = true;
  }

  private next(now: number): void {
    if (this.fine) this.size(this.sharpness);
    this.drawn = now;
    this.fine = this.sharpness === 1;
    this.draw();
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0) ?? undefined;
    this.told();
  }

  /** Whether the last picture is on the screen; no other is begun before. */
  private finished(now: number): boolean {
    if (!this.fence) return true;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (gl.getSyncParameter(this.fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(this.fence);
    this.fence = undefined;
    this.keepPace(Math.min(now - this.drawn, MOST));
    return true;
  }

  /** Where drawing is slow (no graphics card) the picture gets coarser and loses its shadows, and
   *  the page rests as long as it draws. */
  private keepPace(took: number): void {
    this.pace += 0.25 * (took - this.pace);
    const slow = this.pace > SLOW && this.sharpness > COARSEST;
    const quick = this.pace < QUICK && this.sharpness < 1;
    if (slow || quick) {
      this.sharpness = Math.min(Math.max((quick ? 1.25 : 0.5) * this.sharpness, COARSEST), 1);
      this.size(this.sharpness);
      this.stale = true;
      this.pace = (SLOW + QUICK) / 2;
    }
    this.pause = this.pace > SLOW ? this.pace : 0;
  }

  /** Nothing moves: there is time for a picture as fine as the screen. */
  private polish(): void {
    this.fine = true;
    this.size(1);
    this.draw();
  }

  private size(sharpness: number): void {
    const box = this.canvas.parentElement;
    const pixels = sharpness * Math.min(devicePixelRatio, 2);
    if (!box || (pixels === this.renderer.getPixelRatio() && this.canvas.clientWidth === box.clientWidth)) return;
    this.renderer.setPixelRatio(pixels);
    this.renderer.setSize(box.clientWidth, box.clientHeight, false);
  }

  private fit(): void {
    const box = this.canvas.parentElement;
    if (!box) return;
    this.renderer.setPixelRatio(this.sharpness * Math.min(devicePixelRatio, 2));
    this.renderer.setSize(box.clientWidth, box.clientHeight, false);
    this.cards.replaceChildren(...this.cells().map((cell, i) => {
      const card = document.createElement("div");
      Object.assign(card.style, { left: `${cell.x}px`, top: `${cell.y}px`, width: `${cell.w}px`, height: `${cell.h}px` });
      const name = document.createElement("span");
      name.textContent = spoken(this.players[i]?.actor.name ?? "");
      card.append(name);
      this.players[i]?.frame(cell.w / cell.h);
      return card;
    }));
    this.stale = true;
  }

  private cells(): Cell[] {
    return this.players.length ? cells(this.players.length, this.canvas.clientWidth, this.canvas.clientHeight) : [];
  }

  private draw(): void {
    this.stale = false;
    const height = this.canvas.clientHeight;
    this.cells().forEach((cell, i) => {
      const player = this.players[i];
      if (!player) return;
      const box = [cell.x, height - cell.y - cell.h, cell.w, cell.h] as const;
      this.renderer.setViewport(...box);
      this.renderer.setScissor(...box);
      player.shade(this.fine);
      this.renderer.render(player.scene, player.camera);
    });
  }
}

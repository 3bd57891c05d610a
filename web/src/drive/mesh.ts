// Triangles with normals and colours, collected in one array. Everything that the drive shows is made of triangles.

import type { Block, Shape } from "../draw/shape.ts";
import type { Pose } from "./samples.ts";

export type Rgba = readonly [number, number, number, number];

/** Floats per vertex: position, normal, colour. */
export const STRIDE = 10;

export function rgba(hex: string, alpha = 1): Rgba {
  const value = Number.parseInt(hex.slice(1), 16);
  return [((value >> 16) & 255) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255, alpha];
}

export function mix(a: Rgba, b: Rgba, part: number): Rgba {
  return [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]), a[2] + part * (b[2] - a[2]), a[3]];
}

type Point = readonly [number, number, number];

export class Mesh {
  #data: Float32Array;
  #used = 0;

  constructor(vertices = 4096) {
    this.#data = new Float32Array(vertices * STRIDE);
  }

  get vertices(): number {
    return this.#used / STRIDE;
  }

  get data(): Float32Array {
    return this.#data.subarray(0, this.#used);
  }

  clear(): void {
    this.#used = 0;
  }

  /** Adds two triangles. Corners are in order around the quad; the last two may have a second colour. */
  quad(a: Point, b: Point, c: Point, d: Point, normal: Point, colour: Rgba, second: Rgba = colour): void {
    this.#vertex(a, normal, colour);
    this.#vertex(b, normal, colour);
    this.#vertex(c, normal, second);
    this.#vertex(a, normal, colour);
    this.#vertex(c, normal, second);
    this.#vertex(d, normal, second);
  }

  triangle(a: Point, b: Point, c: Point, normal: Point, colour: Rgba): void {
    for (const corner of [a, b, c]) this.#vertex(corner, normal, colour);
  }

  #vertex(at: Point, normal: Point, colour: Rgba): void {
    if (this.#used + STRIDE > this.#data.length) {
      const larger = new Float32Array(this.#data.length * 2);
      larger.set(this.#data);
      this.#data = larger;
    }
    this.#data.set(at, this.#used);
    this.#data.set(normal, this.#used + 3);
    this.#data.set(colour, this.#used + 6);
    this.#used += STRIDE;
  }
}

/** The frame of a unit (`ahead` along its heading, `left` across it, `up`), placed in the drive's frame. */
export class Placed {
  constructor(private readonly pose: Pose, private readonly originX = 0, private readonly originY = 0) {}

  at(ahead: number, left: number, up: number): Point {
    const { x, y, dx, dy } = this.pose;
    // y points south, so the left of (dx, dy) is (dy, −dx).
    return [x - this.originX + ahead * dx + left * dy, y - this.originY + ahead * dy - left * dx, up];
  }

  /** The pose beside this one, in the mesh's frame. */
  shifted(left: number): Pose {
    const [x, y] = this.at(0, left, 0);
    return { ...this.pose, x, y };
  }

  direction(ahead: number, left: number): Point {
    const { dx, dy } = this.pose;
    return [ahead * dx + left * dy, ahead * dy - left * dx, 0];
  }
}

const UP: Point = [0, 0, 1];

export function rectangle(mesh: Mesh, placed: Placed, front: number, rear: number, half: number, up: number, colour: Rgba): void {
  mesh.quad(placed.at(front, half, up), placed.at(front, -half, up), placed.at(rear, -half, up), placed.at(rear, half, up), UP, colour);
}

export function box(mesh: Mesh, placed: Placed, block: Block, colour: Rgba): void {
  const { front, rear, low, high } = block;
  const half = block.width / 2;
  const corner = (ahead: number, left: number, up: number): Point => placed.at(ahead, left, up);
  mesh.quad(corner(front, half, high), corner(front, -half, high), corner(rear, -half, high), corner(rear, half, high), UP, colour);
  // Undersides are darker.
  const dim = mix(colour, [0, 0, 0, 1], 0.2);
  const side = (a: [number, number], b: [number, number], normal: Point): void =>
    mesh.quad(corner(...a, low), corner(...b, low), corner(...b, high), corner(...a, high), normal, dim, colour);
  side([front, half], [front, -half], placed.direction(1, 0));
  side([rear, -half], [rear, half], placed.direction(-1, 0));
  side([rear, half], [front, half], placed.direction(0, 1));
  side([front, -half], [rear, -half], placed.direction(0, -1));
}

const ROUND = 16;

export function wheel(mesh: Mesh, placed: Placed, ahead: number, left: number, radius: number, colour: Rgba): void {
  const thick = 0.28;
  const outer = left > 0 ? left : left - thick;
  const side = (angle: number): [number, number] => [ahead + radius * Math.cos(angle), radius + radius * Math.sin(angle)];
  for (let step = 0; step < ROUND; step++) {
    const [a, b] = [(step / ROUND) * 2 * Math.PI, ((step + 1) / ROUND) * 2 * Math.PI];
    const [[xa, za], [xb, zb]] = [side(a), side(b)];
    for (const face of [outer, outer + thick]) {
      const normal = placed.direction(0, face > 0 ? 1 : -1);
      mesh.triangle(placed.at(ahead, face, radius), placed.at(xa, face, za), placed.at(xb, face, zb), normal, colour);
    }
    const middle = (a + b) / 2;
    const flat = placed.direction(Math.cos(middle), 0);
    const normal: Point = [flat[0], flat[1], Math.sin(middle)];
    mesh.quad(placed.at(xa, outer, za), placed.at(xb, outer, zb), placed.at(xb, outer + thick, zb), placed.at(xa, outer + thick, za), normal, colour);
  }
}

/** Adds a ring around an axle on the ground, which shows the bound on the axle's distance to either side. */
export function ellipse(mesh: Mesh, placed: Placed, across: number, along: number, up: number, colour: Rgba, line: number): void {
  const steps = 40;
  const at = (step: number, more: number): Point => {
    const angle = (step / steps) * 2 * Math.PI;
    return placed.at((along + more) * Math.cos(angle), (across + more) * Math.sin(angle), up);
  };
  for (let step = 0; step < steps; step++) {
    mesh.quad(at(step, 0), at(step + 1, 0), at(step + 1, line), at(step, line), UP, colour);
  }
}

/** Adds a soft, flat shadow under a unit. */
export function shadow(mesh: Mesh, placed: Placed, shape: Shape): void {
  for (const [beyond, alpha] of [[0.55, 0.05], [0.35, 0.07], [0.15, 0.1]] as const) {
    rectangle(mesh, placed, shape.front + beyond, shape.rear - beyond, shape.width / 2 + beyond, 0, [0, 0, 0, alpha]);
  }
}

const GLASS: Rgba = [0.09, 0.13, 0.17, 1];
const WHITE: Rgba = [1, 0.97, 0.85, 1];
const RED: Rgba = [0.85, 0.1, 0.1, 1];

/** Adds windows of the cab and lights, which show the direction of travel. */
function fittings(mesh: Mesh, placed: Placed, block: Block): void {
  const tall = block.high - block.low;
  const at = (share: number): number => block.low + share * tall;
  if (block.kind === "cab" && tall > 1.6) {
    box(mesh, placed, { ...block, front: block.front + 0.03, rear: block.front - 0.02, low: at(0.5), high: at(0.86), width: 0.9 * block.width }, GLASS);
    box(mesh, placed, { ...block, front: block.front - 0.2, rear: block.front - 1.1, low: at(0.5), high: at(0.84), width: block.width + 0.04 }, GLASS);
  }
  if (block.kind === "saloon") box(mesh, placed, { ...block, front: block.front - 0.3, rear: block.rear + 0.3, low: at(0.42), high: at(0.82), width: block.width + 0.03 }, GLASS);
  const pair = (front: number, rear: number, low: number, colour: Rgba): void => {
    for (const side of [0.36, -0.36]) {
      const own = new Placed(placed.shifted(side * block.width), 0, 0);
      box(mesh, own, { ...block, front, rear, low, high: low + 0.16, width: 0.34 }, colour);
    }
  };
  if (block.kind === "cab" && tall > 1) pair(block.front + 0.03, block.front, at(0.12), WHITE);
  if (block.kind === "load" || block.kind === "saloon") pair(block.rear, block.rear - 0.03, block.low + 0.05, RED);
}

export function unit(mesh: Mesh, placed: Placed, shape: Shape, colour: Rgba, ink: Rgba): void {
  for (const block of shape.blocks) fittings(mesh, placed, block);
  for (const block of shape.blocks) {
    const tone =
      block.kind === "load" || block.kind === "saloon" ? colour
      : block.kind === "cab" ? mix(colour, [1, 1, 1, 1], 0.25)
      : mix(colour, ink, 0.65);
    box(mesh, placed, block, tone);
  }
  const half = shape.width / 2 - 0.02;
  for (const at of shape.wheels) {
    for (const left of [half - 0.28, -half + 0.28]) wheel(mesh, placed, at, left, shape.wheelRadius, [0.1, 0.11, 0.13, 1]);
  }
}

// The drive in the map's own WebGL context: the corridor on the ground, the swept path so far, the bodies, and the tubes that
// bound them. The scene is drawn in the same frame as the map, so that it does not lag behind the camera.

import type { CustomLayerInterface, CustomRenderMethodInput, Map as Base } from "maplibre-gl";
import type { Route, Vehicle } from "../api/types.ts";
import { shapes, type Shape } from "../draw/shape.ts";
import { marginColour, type Palette } from "../map/palette.ts";
import { draw, program, refill, remove, upload, type Drawn } from "./gl.ts";
import { Mesh, Placed, ellipse, mix, rectangle, rgba, shadow, unit as body } from "./mesh.ts";
import { leewayAt, type Samples } from "./samples.ts";

/** The width of the line along the corridor's edge, metres. */
const EDGE_M = 0.14;
/** The distance of two rectangles of the swept path, metres. Bodies are longer, so the rectangles overlap. */
const SWEPT_M = 1;
const MOST_SWEPT = 5000;
/** The length of the tubes' bands before and behind the vehicle, metres. */
const BANDS_M = 90;
const LEAST_BAND_M = 0.05;

export class Scene implements CustomLayerInterface {
  readonly id = "own-drive";
  readonly type = "custom" as const;
  readonly renderingMode = "3d" as const;
  /** The station of the prime mover's axle. */
  s = 0;
  #map: Base | undefined;
  #gl: WebGL2RenderingContext | undefined;
  #program: WebGLProgram | undefined;
  #matrix: WebGLUniformLocation | null = null;
  #ground: Drawn | undefined;
  #swept: Drawn | undefined;
  #tubes: Drawn | undefined;
  #moving: Drawn | undefined;
  readonly #mesh = new Mesh(16384);
  readonly #shapes: Shape[];
  /** Metres between two places of the swept path, and vertices at each place. */
  readonly #step: number;
  #each = 0;
  get #count(): number {
    return Math.floor(this.samples.length / this.#step) + 1;
  }

  constructor(
    private readonly route: Route,
    private readonly samples: Samples,
    vehicle: Vehicle,
    private palette: Palette,
  ) {
    this.#shapes = shapes(vehicle);
    this.#step = Math.max(SWEPT_M, samples.length / MOST_SWEPT);
  }

  recolour(palette: Palette): void {
    this.palette = palette;
    if (this.#gl) this.#still(this.#gl);
    this.#map?.triggerRepaint();
  }

  onAdd(map: Base, gl: WebGL2RenderingContext): void {
    this.#map = map;
    this.#gl = gl;
    this.#program = program(gl);
    this.#matrix = gl.getUniformLocation(this.#program, "matrix");
    this.#still(gl);
    this.#moving = upload(gl, this.#program!, new Mesh(1));
  }

  onRemove(_map: Base, gl: WebGL2RenderingContext): void {
    for (const drawn of [this.#ground, this.#swept, this.#tubes, this.#moving]) {
      if (drawn) remove(gl, drawn);
    }
    if (this.#program) gl.deleteProgram(this.#program);
    this.#gl = undefined;
  }

  render(gl: WebGL2RenderingContext, input: CustomRenderMethodInput): void {
    if (!this.#program || !this.#ground || !this.#swept || !this.#tubes || !this.#moving) return;
    gl.useProgram(this.#program);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.STENCIL_TEST);
    const main = input.defaultProjectionData.mainMatrix as unknown as ArrayLike<number>;
    gl.uniformMatrix4fv(this.#matrix, false, this.#local(main, 0, 0));
    // On the ground, later drawings cover earlier ones.
    gl.disable(gl.DEPTH_TEST);
    draw(gl, this.#ground, 0, this.#ground.vertices);
    const now = Math.floor(this.s / this.#step);
    draw(gl, this.#swept, 0, this.#each * (now + 1));
    const [from, to] = [now - BANDS_M / this.#step, now + BANDS_M / this.#step].map((at) => Math.min(Math.max(Math.floor(at), 0), this.#count - 1));
    draw(gl, this.#tubes, this.#each * (from ?? 0), this.#each * ((to ?? 0) - (from ?? 0)));
    this.#bodies(gl, main);
    gl.bindVertexArray(null);
  }

  /** The tubes of all axles as bands on the ground: the bounds on each axle's place. */
  #bands(): Mesh {
    const count = this.#count;
    const mesh = new Mesh(count * this.#shapes.length * 6);
    const up = [0, 0, 1] as const;
    for (let index = 0; index + 1 < count; index++) {
      const [s, t] = [index * this.#step, (index + 1) * this.#step];
      const [here, there] = [this.samples.at(s), this.samples.at(t)];
      here.forEach((pose, at) => {
        const next = there[at];
        if (!next) return;
        const [a, b] = [new Placed(pose), new Placed(next)];
        const [wide, then] = [this.#half(at, s), this.#half(at, t)];
        mesh.quad(a.at(0, wide, 0), a.at(0, -wide, 0), b.at(0, -then, 0), b.at(0, then, 0), up, this.#unitColour(at, 0.6));
      });
    }
    return mesh;
  }

  #half(unit: number, s: number): number {
    return Math.max(this.samples.tube(unit, s), LEAST_BAND_M);
  }

  /** Builds the parts that do not move: the corridor with its edges, and the whole swept path. */
  #still(gl: WebGL2RenderingContext): void {
    for (const old of [this.#ground, this.#swept, this.#tubes]) if (old) remove(gl, old);
    this.#ground = upload(gl, this.#program!, this.#corridor());
    const count = this.#count;
    const swept = new Mesh(count * this.#shapes.length * 6);
    const colour = rgba(this.palette.swept);
    for (let index = 0; index < count; index++) {
      this.samples.at(index * this.#step).forEach((pose, at) => {
        const shape = this.#shapes[at];
        if (shape) rectangle(swept, new Placed(pose), shape.front, shape.rear, shape.width / 2, 0, colour);
      });
    }
    this.#each = swept.vertices / count;
    this.#tubes = upload(gl, this.#program!, this.#bands());
    this.#swept = upload(gl, this.#program!, swept);
  }

  #corridor(): Mesh {
    const { s_m: s, left_edge: left, right_edge: right } = this.route.drive;
    const mesh = new Mesh(s.length * 18);
    const road = rgba(this.palette.corridor);
    const up = [0, 0, 1] as const;
    const points = s.map((_, index) => {
      const [l, r] = [this.samples.frame.to(...left[index]!), this.samples.frame.to(...right[index]!)];
      const wide = Math.hypot(l[0] - r[0], l[1] - r[1]) || 1;
      const inward = (from: [number, number], to: [number, number]): [number, number, number] => {
        const part = Math.min(EDGE_M / wide, 0.5);
        return [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]), 0];
      };
      return { l: [...l, 0] as [number, number, number], r: [...r, 0] as [number, number, number], li: inward(l, r), ri: inward(r, l) };
    });
    for (let index = 0; index + 1 < points.length; index++) {
      const [a, b] = [points[index]!, points[index + 1]!];
      mesh.quad(a.l, a.r, b.r, b.l, up, road);
      const leeway = leewayAt(this.route.leeway, s[index]!);
      mesh.quad(a.l, a.li, b.li, b.l, up, rgba(marginColour(this.palette, leeway.left)));
      mesh.quad(a.r, a.ri, b.ri, b.r, up, rgba(marginColour(this.palette, leeway.right)));
    }
    return mesh;
  }

  #bodies(gl: WebGL2RenderingContext, main: ArrayLike<number>): void {
    const poses = this.samples.at(this.s);
    const { x, y } = poses[0] ?? { x: 0, y: 0 };
    const placed = poses.map((pose) => new Placed(pose, x, y));
    gl.uniformMatrix4fv(this.#matrix, false, this.#local(main, x, y));
    const flat = (make: () => void): void => {
      this.#mesh.clear();
      make();
      this.#refill(gl);
    };
    // The bodies with all errors at their bounds, under them.
    flat(() => {
      for (const [index, at] of placed.entries()) {
        const shape = this.#shapes[index];
        if (shape) shadow(this.#mesh, at, shape);
      }
      placed.forEach((at, index) => {
        const shape = this.#shapes[index];
        if (!shape) return;
        const tube = this.samples.tube(index, this.s);
        rectangle(this.#mesh, at, shape.front, shape.rear, shape.width / 2 + tube, 0, this.#unitColour(index, 0.35));
      });
    });
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    gl.depthFunc(gl.LEQUAL);
    flat(() => {
      const ink = rgba("#14171b");
      placed.forEach((at, index) => {
        const shape = this.#shapes[index];
        if (shape) body(this.#mesh, at, shape, this.#unitColour(index, 1), ink);
      });
    });
    gl.disable(gl.DEPTH_TEST);
    flat(() => {
      placed.forEach((at, index) => {
        const tube = Math.max(this.samples.tube(index, this.s), 0.02);
        ellipse(this.#mesh, at, tube, tube, 0, rgba("#ffffff", 0.95), 0.07);
        ellipse(this.#mesh, at, tube + 0.07, tube + 0.07, 0, rgba("#14171b", 0.9), 0.04);
      });
    });
  }

  #unitColour(index: number, alpha: number) {
    const hex = this.palette.units[index % this.palette.units.length] ?? "#0072b2";
    return mix(rgba(hex, alpha), [1, 1, 1, alpha], 0.08);
  }

  #refill(gl: WebGL2RenderingContext): void {
    if (!this.#moving) return;
    refill(gl, this.#moving, this.#mesh);
    draw(gl, this.#moving, 0, this.#mesh.vertices);
  }

  /** The matrix from metres around a place of the drive's frame to the screen, computed in doubles until the last step. */
  #local(main: ArrayLike<number>, x: number, y: number): Float32Array {
    const { origin, metre } = this.samples.frame;
    const [ox, oy] = [origin.x + x * metre, origin.y + y * metre];
    const out = new Float32Array(16);
    for (let row = 0; row < 4; row++) {
      const [a, b, c, d] = [main[row] ?? 0, main[4 + row] ?? 0, main[8 + row] ?? 0, main[12 + row] ?? 0];
      out[row] = a * metre;
      out[4 + row] = b * metre;
      out[8 + row] = c * metre;
      out[12 + row] = a * ox + b * oy + d;
    }
    return out;
  }
}

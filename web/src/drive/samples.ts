// A drive as arrays in a metric frame, interpolated at any station between its samples.
//
// The frame is Mercator, scaled to metres at the drive's beginning: x east, y south. Far from the beginning the scale differs a
// little, and bodies are scaled accordingly.

import { MercatorCoordinate } from "maplibre-gl";
import type { Drive, Leeway } from "../api/types.ts";

export interface Pose {
  x: number;
  y: number;
  /** The heading as a unit vector of the frame. */
  dx: number;
  dy: number;
}

/** The frame of one route. */
export class Frame {
  readonly origin: MercatorCoordinate;
  readonly metre: number;

  constructor(lon: number, lat: number) {
    this.origin = MercatorCoordinate.fromLngLat([lon, lat]);
    this.metre = this.origin.meterInMercatorCoordinateUnits();
  }

  to(lon: number, lat: number): [number, number] {
    const at = MercatorCoordinate.fromLngLat([lon, lat]);
    return [(at.x - this.origin.x) / this.metre, (at.y - this.origin.y) / this.metre];
  }

  from(x: number, y: number): { lng: number; lat: number } {
    return new MercatorCoordinate(this.origin.x + x * this.metre, this.origin.y + y * this.metre).toLngLat();
  }
}

export class Samples {
  readonly frame: Frame;
  readonly length: number;
  readonly duration: number;
  /** Per unit: x, y, sin and cos of the heading, interleaved. */
  readonly #poses: Float64Array[];

  constructor(private readonly drive: Drive) {
    const [lon, lat] = drive.units[0]?.poses[0] ?? [0, 0];
    this.frame = new Frame(lon, lat);
    this.length = drive.s_m.at(-1) ?? 0;
    this.duration = drive.t.at(-1) ?? 0;
    this.#poses = drive.units.map(({ poses }) => {
      const out = new Float64Array(4 * poses.length);
      poses.forEach(([lon, lat, heading], index) => {
        const [x, y] = this.frame.to(lon, lat);
        const angle = (heading * Math.PI) / 180;
        // The angle is clockwise from north, and y points south.
        out.set([x, y, Math.sin(angle), -Math.cos(angle)], 4 * index);
      });
      return out;
    });
  }

  get units(): Drive["units"] {
    return this.drive.units;
  }

  /** The poses of all units at a station. */
  at(s: number): Pose[] {
    const { index, part } = bracket(this.drive.s_m, s);
    return this.#poses.map((poses) => {
      const mixed = (offset: number): number => {
        const a = poses[4 * index + offset] ?? 0;
        const b = poses[4 * (index + 1) + offset] ?? a;
        return a + part * (b - a);
      };
      const [dx, dy] = [mixed(2), mixed(3)];
      const size = Math.hypot(dx, dy) || 1;
      return { x: mixed(0), y: mixed(1), dx: dx / size, dy: dy / size };
    });
  }

  /** The bound on the distance of a unit's axle from its drawn place, to either side, metres. */
  tube(unit: number, s: number): number {
    const own = this.drive.units[unit]?.tube_m ?? [];
    const { index, part } = bracket(this.drive.s_m, s);
    const [a, b] = [own[index] ?? 0, own[index + 1] ?? own[index] ?? 0];
    // Between two samples the greater bound holds.
    return part === 0 ? a : Math.max(a, b);
  }

  timeAt(s: number): number {
    return mapped(this.drive.s_m, this.drive.t, s);
  }

  stationAt(t: number): number {
    return mapped(this.drive.t, this.drive.s_m, t);
  }
}

function mapped(from: number[], to: number[], value: number): number {
  const { index, part } = bracket(from, value);
  const [a, b] = [to[index] ?? 0, to[index + 1] ?? to[index] ?? 0];
  return a + part * (b - a);
}

/** The interval of ascending numbers that contains a value, and the value's share of it. Values beyond the ends are clamped. */
export function bracket(ascending: number[], value: number): { index: number; part: number } {
  let [low, high] = [0, Math.max(ascending.length - 1, 0)];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if ((ascending[middle] ?? 0) <= value) low = middle;
    else high = middle;
  }
  const [a, b] = [ascending[low] ?? 0, ascending[high] ?? 0];
  return { index: low, part: b > a ? Math.min(Math.max((value - a) / (b - a), 0), 1) : 0 };
}

/** A greater leeway means that no body passed, metres. */
export const OPEN_M = 100;

/** The leeway on either side at the stretch of a station, metres. */
export function leewayAt(leeway: Leeway, s: number): { left: number; right: number } {
  const at = Math.min(Math.max(Math.floor(s / leeway.step_m), 0), leeway.s_m.length - 1);
  return { left: leeway.left_m[at] ?? OPEN_M, right: leeway.right_m[at] ?? OPEN_M };
}

// The shape of a vehicle: blocks and wheels of each unit, made from its dimensions.
//
// Lengths and widths are those of the vehicle. Heights of cabs, decks and frames, and the number of wheels around the effective
// axle, are typical values. Every picture says so.

import type { Unit, Vehicle } from "../api/types.ts";

export type BlockKind = "cab" | "load" | "frame" | "drawbar" | "saloon";

/** A box, metres: along the unit ahead of its axle, across it, and above the ground. */
export interface Block {
  kind: BlockKind;
  front: number;
  rear: number;
  low: number;
  high: number;
  width: number;
}

export interface Shape {
  blocks: Block[];
  /** Positions of the wheels ahead of the axle, metres. */
  wheels: number[];
  wheelRadius: number;
  width: number;
  /** Ends of the body: ahead of the axle, and behind it (negative), metres. */
  front: number;
  rear: number;
}

/** The height of a vehicle of unknown height, as a multiple of its width. */
const ASSUMED_HEIGHT = 1.5;

export function heightOf(vehicle: Vehicle): number {
  return vehicle.height_m ?? ASSUMED_HEIGHT * Math.max(...vehicle.units.map((unit) => unit.width_m));
}

/** The front of the next unit's body, metres ahead of this unit's axle. */
function nextFront(unit: Unit, next: Unit | undefined): number | null {
  return next ? -unit.hitch_offset_m + next.front_overhang_m : null;
}

function carries(unit: Unit, next: Unit | undefined): boolean {
  const front = nextFront(unit, next);
  return front !== null && next !== undefined && next.coupling_to_axle_m > 4 && front > -unit.rear_overhang_m + 0.3;
}

export function shapes(vehicle: Vehicle): Shape[] {
  const height = heightOf(vehicle);
  const bus = vehicle.units.some((unit) => unit.name.endsWith("section"));
  return vehicle.units.map((unit, index) => {
    const next = vehicle.units[index + 1];
    const body = { front: unit.coupling_to_axle_m + unit.front_overhang_m, rear: -unit.rear_overhang_m };
    const parts = bus ? saloon(unit, index, height, next) : goods(unit, index, height, next);
    const wheelRadius = Math.min(0.115 * height, 0.52);
    return { ...body, blocks: parts, wheels: wheels(vehicle, unit, index, bus), wheelRadius, width: unit.width_m };
  });
}

function saloon(unit: Unit, index: number, height: number, next: Unit | undefined): Block[] {
  const front = unit.coupling_to_axle_m + unit.front_overhang_m;
  const width = unit.width_m;
  const blocks: Block[] = [{ kind: "saloon", front, rear: -unit.rear_overhang_m, low: 0.11 * height, high: height, width }];
  const joint = nextFront(unit, next);
  if (joint !== null) {
    const rear = joint;
    blocks.push({ kind: "frame", front: -unit.rear_overhang_m, rear, low: 0.14 * height, high: 0.94 * height, width: 0.9 * width });
  }
  if (index === 0) blocks.push({ kind: "cab", front: front + 0.01, rear: front - 0.25, low: 0.3 * height, high: 0.9 * height, width });
  return blocks;
}

function goods(unit: Unit, index: number, height: number, next: Unit | undefined): Block[] {
  const front = unit.coupling_to_axle_m + unit.front_overhang_m;
  const rear = -unit.rear_overhang_m;
  const width = unit.width_m;
  const [deck, frame] = [0.27 * height, 0.15 * height];
  const carrying = carries(unit, next);
  const ahead = nextFront(unit, next) ?? rear;
  const beam: Block = { kind: "frame", front, rear, low: frame, high: deck, width: 0.55 * width };
  if (index === 0) return motor(unit, height, carrying ? ahead : null);
  const bar: Block | null =
    front < unit.coupling_to_axle_m - 0.3 ? { kind: "drawbar", front: unit.coupling_to_axle_m, rear: front, low: frame, high: frame + 0.12, width: 0.12 * width } : null;
  if (carrying && unit.front_overhang_m <= 0 && unit.rear_overhang_m < 0.8) {
    // A dolly: a short frame over its axle and a drawbar.
    const body = Math.min(1.3, 0.5 * unit.coupling_to_axle_m);
    return [
      { kind: "drawbar", front: unit.coupling_to_axle_m, rear: body, low: frame, high: frame + 0.12, width: 0.12 * width },
      { ...beam, front: body, rear, width: 0.8 * width },
    ];
  }
  const loadRear = carrying ? Math.max(ahead + 0.25, rear) : rear;
  const load: Block = { kind: "load", front, rear: loadRear, low: deck, high: height, width };
  return [...(bar ? [bar] : []), beam, load];
}

function motor(unit: Unit, height: number, carriedFront: number | null): Block[] {
  const front = unit.coupling_to_axle_m + unit.front_overhang_m;
  const width = unit.width_m;
  const [deck, frame] = [0.27 * height, 0.15 * height];
  const beam: Block = { kind: "frame", front: front - 0.3, rear: -unit.rear_overhang_m, low: frame, high: deck, width: 0.45 * width };
  const behind = carriedFront === null ? front - 2.3 : carriedFront + 0.35;
  const cabRear = Math.min(Math.max(behind, front - 3.6), front - 0.35 * Math.min(2.2, front));
  // A long bonnet where the steer axle is far ahead of the load.
  const bonnet = front - cabRear > 3.2 ? 1.35 : 0;
  const cab: Block = { kind: "cab", front: front - bonnet, rear: cabRear, low: 0.13 * height, high: 0.9 * height, width: 0.97 * width };
  const blocks = [beam, cab];
  if (bonnet > 0) blocks.push({ kind: "cab", front, rear: front - bonnet, low: 0.13 * height, high: 0.5 * height, width: 0.8 * width });
  if (carriedFront === null && front - cabRear < unit.coupling_to_axle_m) {
    blocks.push({ kind: "load", front: cabRear - 0.2, rear: -unit.rear_overhang_m, low: deck, high: height, width });
  }
  return blocks;
}

function wheels(vehicle: Vehicle, unit: Unit, index: number, bus: boolean): number[] {
  const small = vehicle.region === "indoor" || vehicle.region === "airside";
  if (index === 0) {
    const tandem = !bus && !small && vehicle.region !== "EU" ? [0.65, -0.65] : [0];
    return [unit.coupling_to_axle_m, ...tandem];
  }
  if (bus || small) return [0];
  if (unit.coupling_to_axle_m < 6.4) return [0.65, -0.65];
  return vehicle.region === "US" || vehicle.region === "CA" ? [0.65, -0.65] : [1.3, 0, -1.3];
}

/** Positions of the axles of the straight vehicle, metres behind the front bumper. */
export function straight(vehicle: Vehicle): number[] {
  let coupling = vehicle.units[0]?.front_overhang_m ?? 0;
  return vehicle.units.map((unit) => {
    const axle = coupling + unit.coupling_to_axle_m;
    coupling = axle + unit.hitch_offset_m;
    return axle;
  });
}

// The state of the page. Every part reads it, changes it through `set`, and is told of changes.

import type { AtMost, Evidence, Policy, Position, VerdictName } from "./api/types.ts";
import type { Units } from "./units.ts";

export type ColourBy = "margin" | "reason" | "evidence" | "strip";

export interface Camera {
  lon: number;
  lat: number;
  zoom: number;
}

/** The places of a route: where it begins, through what it leads, where it goes. A place that is not chosen yet is null. */
export type Places = readonly (Position | null)[];

/** A route of which nothing is chosen yet. */
export const UNPLACED: Places = [null, null];
/** The greatest number of places between beginning and end; the server allows no more. */
export const MOST_VIA = 8;

/** The places, if all of them are chosen. */
export function complete(places: Places | null): readonly Position[] | null {
  const chosen = (places ?? []).filter((place): place is Position => place !== null);
  return places && places.length > 1 && chosen.length === places.length ? chosen : null;
}

export interface State {
  vehicle: string;
  policy: Policy;
  /** The vehicle on the second map, beside the first. */
  other: string | null;
  colourBy: ColourBy;
  hidden: ReadonlySet<VerdictName>;
  hiddenClasses: ReadonlySet<string>;
  /** The worst source of width of the roads that are drawn. */
  evidence: Evidence;
  camera: Camera | null;
  /** Id of the selected edge or turn. */
  selected: string | null;
  /** The places of a route, at least two; null if no route is asked for. */
  route: Places | null;
  /** The widest strip that a route may use where that of the policy is not enough; null: none. */
  atMost: AtMost | null;
  stats: boolean;
  /** Whether the changes since the older database are drawn over a muted map. */
  changes: boolean;
  baseMap: boolean;
  /** Metres or feet; null: as is usual where the vehicle comes from. */
  units: Units | null;
}

/** The state at the beginning. */
export function beginning(vehicle: string, policy: Policy): State {
  return {
    vehicle,
    policy,
    other: null,
    colourBy: "margin",
    hidden: new Set(),
    hiddenClasses: new Set(),
    evidence: "assumed",
    camera: null,
    selected: null,
    route: null,
    atMost: null,
    stats: false,
    changes: false,
    baseMap: false,
    units: null,
  };
}

export type Listener = (state: State, changed: ReadonlySet<keyof State>) => void;

export class Store {
  readonly #listeners: Listener[] = [];
  #state: State;

  constructor(state: State) {
    this.#state = state;
  }

  get state(): State {
    return this.#state;
  }

  /** Sets the fields that differ and tells all listeners which fields these were. */
  set(next: Partial<State>): void {
    const changed = new Set<keyof State>();
    for (const key of Object.keys(next) as (keyof State)[]) {
      if (!same(this.#state[key], next[key])) changed.add(key);
    }
    if (changed.size === 0) return;
    this.#state = { ...this.#state, ...next };
    for (const listener of this.#listeners) listener(this.#state, changed);
  }

  listen(listener: Listener): void {
    this.#listeners.push(listener);
  }
}

function same(a: unknown, b: unknown): boolean {
  if (a instanceof Set && b instanceof Set) return a.size === b.size && [...a].every((item) => b.has(item));
  if (typeof a === "object" && typeof b === "object") return JSON.stringify(a) === JSON.stringify(b);
  return a === b;
}

// The state of the page. Every part reads it, changes it through `set`, and is told of changes.

import type { Evidence, Policy, Position, VerdictName } from "./api/types.ts";

export type ColourBy = "margin" | "reason" | "evidence";

export interface Camera {
  lon: number;
  lat: number;
  zoom: number;
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
  /** The places of a route. The list is empty at first, then has one place, then two. */
  route: Position[] | null;
  stats: boolean;
  /** Whether the changes since the older database are drawn over a muted map. */
  changes: boolean;
  baseMap: boolean;
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
    stats: false,
    changes: false,
    baseMap: false,
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

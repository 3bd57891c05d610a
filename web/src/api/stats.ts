// The rows of `/api/stats`, added up for each vehicle as the page shows them. Metres.

import type { Policy, StatsRows, VerdictName } from "./types.ts";

export type Lengths = Record<VerdictName, number>;

export interface Histogram {
  from_m: number;
  step_m: number;
  /** Metres of road in each bin from `from_m` on. */
  lengths_m: number[];
  /** Metres of road below the first bin and above the last. */
  below_m: number;
  above_m: number;
}

export interface VehicleStats {
  id: string;
  verdicts: Lengths;
  /** Metres of road by the narrowest strip that is certified. */
  strips: Record<Policy | "none", number>;
  classes: ({ highway: string } & Lengths)[];
  reasons: { verdict: VerdictName; reason: string; length_m: number }[];
  histogram: Histogram;
}

export interface Stats {
  policy: Policy;
  total_m: number;
  vehicles: VehicleStats[];
  scope: string;
}

/** The ends of the histogram. What lies beyond them is counted together. */
const FIRST_M = -2;
const LAST_M = 2;

export function digest(rows: StatsRows): Stats {
  const ids = [...new Set(rows.certificates.map((row) => row.vehicle))];
  const total_m = 1000 * rows.network.reduce((sum, row) => sum + row.km, 0);
  return { policy: rows.policy, total_m, scope: rows.scope, vehicles: ids.map((id) => one(rows, id)) };
}

export function none(): Lengths {
  return { safe: 0, unsafe: 0, forbidden: 0, unknown: 0 };
}

function one(rows: StatsRows, id: string): VehicleStats {
  const verdicts = none();
  const classes = new Map<string, Lengths>();
  const reasons = new Map<string, { verdict: VerdictName; reason: string; length_m: number }>();
  for (const row of rows.certificates.filter(({ vehicle }) => vehicle === id)) {
    const metres = 1000 * row.km;
    verdicts[row.verdict] += metres;
    const own = classes.get(row.highway) ?? none();
    own[row.verdict] += metres;
    classes.set(row.highway, own);
    if (row.verdict === "safe") continue;
    const reason = row.reason ?? "";
    const key = `${row.verdict}/${reason}`;
    const known = reasons.get(key) ?? { verdict: row.verdict, reason, length_m: 0 };
    known.length_m += metres;
    reasons.set(key, known);
  }
  const strips = { lane: 0, direction: 0, carriageway: 0, none: 0 };
  for (const row of rows.strips.filter(({ vehicle }) => vehicle === id)) strips[row.uses ?? "none"] += 1000 * row.km;
  return {
    id,
    verdicts,
    strips,
    classes: [...classes].map(([highway, lengths]) => ({ highway, ...lengths })),
    reasons: [...reasons.values()],
    histogram: histogram(rows, id),
  };
}

function histogram(rows: StatsRows, id: string): Histogram {
  const step_m = rows.rsc_bin_m;
  const bins = Math.round((LAST_M - FIRST_M) / step_m);
  const made: Histogram = { from_m: FIRST_M, step_m, lengths_m: Array<number>(bins).fill(0), below_m: 0, above_m: 0 };
  for (const row of rows.rsc_histogram) {
    // The margin of forbidden and unknown roads does not matter.
    if (row.vehicle !== id || (row.verdict !== "safe" && row.verdict !== "unsafe")) continue;
    const bin = Math.round((row.rsc_from_m - FIRST_M) / step_m);
    if (bin < 0) made.below_m += 1000 * row.km;
    else if (bin >= bins) made.above_m += 1000 * row.km;
    else made.lengths_m[bin] = (made.lengths_m[bin] ?? 0) + 1000 * row.km;
  }
  return made;
}

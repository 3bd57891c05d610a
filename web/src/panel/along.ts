// Places and stretches along the line of a route, by metres from its beginning.

import type { Position, Route } from "../api/types.ts";

type Line = Pick<Route, "geometry" | "length_m">;

/** The metres from the beginning at each position of a line. Its length is that of the route. */
function metres({ geometry, length_m }: Line): number[] {
  const line = geometry.coordinates;
  const shrink = Math.cos(((line[0]?.[1] ?? 0) * Math.PI) / 180);
  let sum = 0;
  const sums = line.map((b, i) => (sum += i === 0 ? 0 : Math.hypot((b[0] - line[i - 1]![0]) * shrink, b[1] - line[i - 1]![1])));
  return sums.map((one) => (sum > 0 ? (one / sum) * length_m : 0));
}

/** The place so many metres along a route, between two positions of its line. */
export function along(route: Line, s_m: number): Position {
  const line = route.geometry.coordinates;
  const at = metres(route);
  const next = at.findIndex((one) => one >= s_m);
  const after = line[next];
  if (!after) return line.at(-1) ?? [0, 0];
  const before = line[next - 1];
  if (!before) return after;
  const share = (s_m - at[next - 1]!) / Math.max(at[next]! - at[next - 1]!, 1e-9);
  return [before[0] + share * (after[0] - before[0]), before[1] + share * (after[1] - before[1])];
}

/** The stretch of a route's line between two distances from its beginning, metres. */
export function stretch(route: Line, from_m: number, to_m: number): Position[] {
  const at = metres(route);
  const between = route.geometry.coordinates.filter((_, index) => at[index]! > from_m && at[index]! < to_m);
  return [along(route, from_m), ...between, along(route, to_m)];
}

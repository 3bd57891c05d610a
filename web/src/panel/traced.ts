// A surface that somebody traces on the map, such as the paved area of a junction on an aerial picture, and keeps as a measurement.

import type { Tracing } from "../trace/trace.ts";
import type { Position } from "../api/types.ts";
import { DEGREE_M } from "../coordinate.ts";
import { h } from "../ui/dom.ts";
import { square } from "../units.ts";

/** Begins to trace on the map; `done` gets the closed ring. */
export type Trace = (done: (ring: Position[]) => void) => Promise<Tracing>;


/** The area inside of a small ring, square metres. */
function area(ring: readonly Position[]): number {
  const shrink = Math.cos(((ring[0]?.[1] ?? 0) * Math.PI) / 180);
  const at = ring.map(([lon, lat]): Position => [(lon - ring[0]![0]) * shrink * DEGREE_M, (lat - ring[0]![1]) * DEGREE_M]);
  const twice = at.slice(1).reduce((sum, [x, y], i) => sum + at[i]![0] * y - x * at[i]![1], 0);
  return Math.abs(twice) / 2;
}

/**
 * A button that traces, and what is said of it. `ring` is the traced ring, or null. `closed` adds to what is said once there is one. `signal`
 * takes the area off the map.
 */
export function tracer(trace: Trace, closed: (ring: Position[], told: HTMLElement) => void, signal: AbortSignal): { element: HTMLElement; ring: () => Position[] | null } {
  let ring: Position[] | null = null;
  let tracing: Tracing | null = null;
  const said = h("p", { role: "status" });
  const button = h("button", { class: "small", type: "button", onclick: () => void begin() }, "Trace it on the map");
  const end = (): void => {
    tracing?.end();
    [tracing, ring] = [null, null];
  };
  const begin = async (): Promise<void> => {
    end();
    said.replaceChildren("Click on the map, corner by corner, along the edge of what is paved. Click on the last corner again, or press Enter on the map, to close it.");
    button.textContent = "Trace it anew";
    tracing = await trace((made) => {
      ring = made;
      const told = h("span", {});
      said.replaceChildren(`Traced: ${made.length - 1} corners, ${square(area(made))}. `, told);
      closed(made, told);
    });
    if (signal.aborted) end();
  };
  signal.addEventListener("abort", end, { once: true });
  return { element: h("div", { class: "tracer" }, button, said), ring: () => ring };
}

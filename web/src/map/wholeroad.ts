// The line of a whole road that was searched for: a pale band under the lines of verdicts, which stay readable.

import type { WholeRoad } from "../api/types.ts";
import { palettes, type Theme } from "./palette.ts";
import type { View } from "./view.ts";

const ROAD = "own-whole-road";

/** Draws a road; null removes it. */
export function drawRoad(view: View, road: WholeRoad | null, theme: Theme): void {
  const features = road?.features.map(({ geometry }) => ({ type: "Feature" as const, properties: {}, geometry })) ?? [];
  void view.ready.then(() => {
    view.overlay(ROAD, { type: "FeatureCollection", features });
    const { map } = view;
    const colour = palettes[theme].route;
    if (map.getLayer(ROAD)) return void map.setPaintProperty(ROAD, "line-color", colour);
    const before = map.getLayer("names") ? "names" : undefined;
    map.addLayer(
      {
        id: ROAD,
        type: "line",
        source: ROAD,
        layout: { "line-cap": "round", "line-join": "round" },
        paint: { "line-color": colour, "line-opacity": 0.22, "line-width": ["interpolate", ["linear"], ["zoom"], 8, 8, 14, 16, 18, 40] },
      },
      before,
    );
  });
}

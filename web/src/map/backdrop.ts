// What lies behind the roads: woods, water, rivers, coasts and names of places, from the extract itself. It is paler than every road.

import type { ExpressionSpecification, LayerSpecification, SourceSpecification } from "maplibre-gl";
import type { Region } from "../api/types.ts";
import { LABEL_FONT } from "./labels.ts";
import type { Palette } from "./palette.ts";
import { tileAddress } from "./tiles.ts";

const SOURCE = "backdrop";

/** The source, if the extract has any of it. */
export function backdropSource({ backdrop, bbox }: Region): Record<string, SourceSpecification> {
  if (!backdrop) return {};
  return { [SOURCE]: { type: "vector", tiles: [tileAddress(backdrop.tiles)], maxzoom: backdrop.max_zoom, bounds: bbox } };
}

const kind = ["get", "kind"] as unknown as ExpressionSpecification;
/** Places from the greatest to the least: the size of their names in pixels, and where they give way to greater ones. */
const sizes: readonly (readonly [kind: string, size: number])[] = [["city", 15], ["town", 13], ["suburb", 11.5], ["village", 11.5], ["hamlet", 10.5]];
const matched = (value: (size: number, rank: number) => number, other: number) =>
  ["match", kind, ...sizes.flatMap(([name, size], rank) => [name, value(size, rank)]), other] as unknown as ExpressionSpecification;

/** Woods and water, under everything else. */
export function ground({ backdrop }: Region, palette: Palette): LayerSpecification[] {
  if (!backdrop) return [];
  const area = (name: "wood" | "water"): LayerSpecification => ({
    id: `backdrop-${name}`,
    type: "fill",
    source: SOURCE,
    "source-layer": "area",
    filter: ["==", kind, name],
    // Two areas that share a border show no gap.
    paint: { "fill-color": palette[name], "fill-antialias": false },
  });
  const line: LayerSpecification = {
    id: "backdrop-line",
    type: "line",
    source: SOURCE,
    "source-layer": "line",
    layout: { "line-cap": "round", "line-join": "round" },
    paint: { "line-color": palette.water, "line-width": ["interpolate", ["exponential", 1.5], ["zoom"], 9, 1, 14, 3, 18, 9] },
  };
  return [area("wood"), area("water"), line];
}

/** Names of places, above everything else. They vanish where single streets fill the view. */
export function places({ backdrop }: Region, palette: Palette): LayerSpecification[] {
  if (!backdrop) return [];
  return [
    {
      id: "backdrop-places",
      type: "symbol",
      source: SOURCE,
      "source-layer": "place",
      maxzoom: 16,
      layout: {
        "text-font": [LABEL_FONT],
        "text-field": ["get", "name"],
        "text-size": ["interpolate", ["linear"], ["zoom"], 8, matched((size) => 0.8 * size, 9), 14, matched((size) => 1.15 * size, 11)],
        "text-letter-spacing": 0.06,
        "text-max-width": 7,
        "text-padding": 8,
        "symbol-sort-key": matched((_, rank) => rank, sizes.length),
      },
      paint: { "text-color": palette.soft, "text-halo-color": palette.halo, "text-halo-width": 2 },
    },
  ];
}

// The line of a route. What is certified as a whole is a solid line. A route under conditions is striped in two colours, and the way
// that obstacles block is dotted, so that neither can be taken for a certified one, with any colour vision.

import type { LayerSpecification } from "maplibre-gl";
import type { Position } from "../api/types.ts";
import { palettes, type Palette, type Theme } from "./palette.ts";
import type { View } from "./view.ts";

/** What a line stands for. */
export type RouteKind = "certified" | "conditional" | "blocked";

/** What is drawn with a line: other certified ways, and the stretches of the line itself on which the oncoming lane is used. */
export interface Beside {
  others: Position[][];
  oncoming: Position[][];
}

export const ROUTE = "own-route";
const nothing: GeoJSON.FeatureCollection = { type: "FeatureCollection", features: [] };

type Line = Extract<LayerSpecification, { type: "line" }>;

/** The layers from below to above. */
function layers(palette: Palette): Line[] {
  const line = (name: string, kind: RouteKind | "other" | "oncoming", paint: Line["paint"], cap: "round" | "butt" = "round"): Line => ({
    id: `${ROUTE}-${name}`,
    type: "line",
    source: ROUTE,
    filter: ["==", ["get", "kind"], kind],
    layout: { "line-cap": cap, "line-join": "round" },
    paint: { ...paint },
  });
  // At deep zooms the certified line gives way to the drive, which nothing else has.
  const fading: NonNullable<Line["paint"]> = { "line-opacity": ["interpolate", ["linear"], ["zoom"], 16.5, 0.9, 18, 0] };
  const kept: NonNullable<Line["paint"]> = { "line-opacity": ["interpolate", ["linear"], ["zoom"], 16.5, 1, 19, 0.6] };
  return [
    line("other-casing", "other", { ...fading, "line-color": palette.routeCasing, "line-width": 7 }),
    line("other", "other", { ...fading, "line-color": palette.soft, "line-width": 4 }),
    // Three lines, so that it is told from the dark lines of roads by its edges, whatever the colour vision.
    line("edge", "certified", { ...fading, "line-color": palette.route, "line-width": 12 }),
    line("casing", "certified", { ...fading, "line-color": palette.routeCasing, "line-width": 10 }),
    line("line", "certified", { ...fading, "line-color": palette.route, "line-width": 5.5 }),
    // Dashes inside the line: there the oncoming lane is used, too.
    line("oncoming", "oncoming", { ...fading, "line-color": palette.routeCasing, "line-width": 2.4, "line-dasharray": [1.6, 1.2] }, "butt"),
    line("conditional-casing", "conditional", { ...kept, "line-color": palette.routeCasing, "line-width": 9 }),
    line("conditional-ground", "conditional", { ...kept, "line-color": palette.conditionalGap, "line-width": 6.5 }),
    line("conditional", "conditional", { ...kept, "line-color": palette.conditional, "line-width": 4.2, "line-dasharray": [2, 1] }, "butt"),
    line("blocked-casing", "blocked", { ...kept, "line-color": palette.routeCasing, "line-width": 7 }),
    line("blocked", "blocked", { ...kept, "line-color": palette.route, "line-width": 3.6, "line-dasharray": [0.1, 1.9] }),
  ];
}

/** Draws one route at a time, and other certified ways beside it. */
export class RouteLine {
  #drawn = false;

  constructor(private readonly view: View) {}

  /** Draws another line; fewer than two positions remove it. */
  show(kind: RouteKind, coordinates: Position[], { others, oncoming }: Beside, theme: Theme): void {
    const feature = (own: string, line: Position[]): GeoJSON.Feature => ({ type: "Feature", properties: { kind: own }, geometry: { type: "LineString", coordinates: line } });
    this.#drawn = coordinates.length > 1;
    void this.view.ready.then(() => {
      this.view.overlay(ROUTE, this.#drawn ? { ...nothing, features: [...others.map((line) => feature("other", line)), feature(kind, coordinates), ...oncoming.map((line) => feature("oncoming", line))] } : nothing);
      this.#draw(theme);
    });
  }

  recolour(theme: Theme): void {
    void this.view.ready.then(() => {
      if (this.#drawn) this.#draw(theme);
    });
  }

  #draw(theme: Theme): void {
    const { map } = this.view;
    const before = map.getLayer("names") ? "names" : undefined;
    for (const layer of layers(palettes[theme])) {
      if (!map.getLayer(layer.id)) map.addLayer(layer, before);
      map.setPaintProperty(layer.id, "line-color", layer.paint?.["line-color"]);
    }
  }
}

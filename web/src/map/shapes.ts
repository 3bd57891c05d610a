// The shapes of an explanation over the roads: what the vehicle may use, its path, the ground that it sweeps, the tightest place.

import type { AllPaintProperties, ExpressionSpecification, LayerSpecification } from "maplibre-gl";
import type { Part, Shapes } from "../api/types.ts";
import { palettes, type Palette, type Theme } from "./palette.ts";
import { LABEL_FONT } from "./labels.ts";
import type { View } from "./view.ts";

/** The source of all shapes. The names of their layers begin with it. */
export const SHAPES = "own-shapes";
/** Below this zoom the shapes are too small to be seen. */
const FROM_ZOOM = 13;

const nothing: Shapes = { type: "FeatureCollection", features: [] };
const parts = (...names: Part[]): ExpressionSpecification => ["in", ["get", "part"], ["literal", names]];

/** The colour of a unit, the same as in the drive. */
function byUnit({ units, ink }: Palette): ExpressionSpecification {
  const pairs = units.flatMap((colour, index) => [index, colour]);
  return ["match", ["coalesce", ["get", "unit"], -1], ...pairs, ink] as unknown as ExpressionSpecification;
}

type Drawn = Extract<LayerSpecification, { type: "fill" | "line" | "symbol" }>;

/** The layers from below to above. */
function layers(palette: Palette): Drawn[] {
  const common = { source: SHAPES, minzoom: FROM_ZOOM };
  const round = { "line-cap": "round", "line-join": "round" } as const;
  const line = (name: string, filter: ExpressionSpecification, paint: NonNullable<Extract<Drawn, { type: "line" }>["paint"]>): Drawn => ({
    ...common, id: `${SHAPES}-${name}`, type: "line", filter, layout: round, paint,
  });
  const fill = (name: string, filter: ExpressionSpecification, colour: string | ExpressionSpecification, opacity: number): Drawn => ({
    ...common, id: `${SHAPES}-${name}`, type: "fill", filter, paint: { "fill-color": colour, "fill-opacity": opacity, "fill-antialias": false },
  });
  const units = byUnit(palette);
  return [
    fill("ground", parts("area", "strip"), palette.corridor, 0.75),
    fill("beyond", parts("beyond"), palette.corridor, 0.4),
    fill("swept", parts("swept"), units, 0.16),
    line("edge", parts("area", "strip"), { "line-color": palette.ink, "line-width": 1.4 }),
    line("beyond-edge", parts("beyond", "line"), { "line-color": palette.ink, "line-width": 1.2, "line-dasharray": [2, 2] }),
    line("swept-edge", parts("swept"), { "line-color": units, "line-width": 1.6 }),
    fill("body", parts("body"), units, 0.35),
    line("body-edge", parts("body"), { "line-color": palette.ink, "line-width": 1 }),
    line("path-casing", parts("path"), { "line-color": palette.routeCasing, "line-width": 4.5 }),
    line("path", parts("path"), { "line-color": palette.route, "line-width": 2.2 }),
    {
      ...common,
      id: `${SHAPES}-label`,
      type: "symbol",
      minzoom: 16,
      filter: parts("tightest", "hinge"),
      layout: { "text-field": ["get", "label"], "text-font": [LABEL_FONT], "text-size": 13, "text-variable-anchor": ["left", "right", "top", "bottom"], "text-radial-offset": 1.4, "text-justify": "auto", "text-max-width": 18 },
      paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 2 },
    },
  ];
}

/** Draws the shapes of one explanation at a time. */
export class ShapesLayer {
  constructor(private readonly view: View) {}

  /** Draws other shapes; null removes them. */
  show(shapes: Shapes | null, theme: Theme): void {
    void this.view.ready.then(() => {
      this.view.overlay(SHAPES, shapes ?? nothing);
      if (shapes) this.#draw(theme);
    });
  }

  recolour(theme: Theme): void {
    void this.view.ready.then(() => {
      if (this.view.map.getSource(SHAPES)) this.#draw(theme);
    });
  }

  #draw(theme: Theme): void {
    const { map } = this.view;
    for (const layer of layers(palettes[theme])) {
      if (!map.getLayer(layer.id)) map.addLayer(layer);
      for (const [name, value] of Object.entries(layer.paint ?? {})) map.setPaintProperty(layer.id, name as keyof AllPaintProperties, value);
    }
  }
}

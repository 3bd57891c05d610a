// The changes since the older database, over the muted roads. Each kind of change has a line of its own, so that nothing depends on
// colour alone. What the vehicle lost lies on top.

import type { AllPaintProperties, ExpressionSpecification, FilterSpecification, LayerSpecification } from "maplibre-gl";
import type { ChangeName, Changes, Region } from "../api/types.ts";
import { REAL_ZOOM, drivesLeft, pixelsPerMetre, type Numeric } from "./lines.ts";
import { palettes, type Palette, type Theme } from "./palette.ts";
import type { View } from "./view.ts";

/** The source of all changes. The names of their layers begin with it. */
export const CHANGES = "own-changes";
/** The drawing order, from below to above. */
const ORDER: readonly ChangeName[] = ["went", "appeared", "became_safe", "became_unknown", "became_forbidden", "became_unsafe", "became_conditional"];
/** The layers that the pointer can be on, from above to below. */
export const changeLayers = [...ORDER].reverse().map((kind) => `${CHANGES}-${kind}`);
/** From this zoom on, changed turns are drawn, as other turns are. */
const TURN_ZOOM = 15;

const nothing: GeoJSON.FeatureCollection = { type: "FeatureCollection", features: [] };

type Line = Extract<LayerSpecification, { type: "line" }>;
type Paint = NonNullable<Line["paint"]>;

/** Width of a changed road in pixels, by zoom. Wider than roads at low zooms, so that a change is seen in a whole region. */
const widths: readonly (readonly [zoom: number, pixels: number])[] = [[6, 2.4], [10, 3.2], [13, 4.4], [15, 6], [17, 8.5], [19, 11], [22, 14]];

/** What the lines depend on beside the theme. */
interface Ground {
  region: Region;
  /** Whether both directions use the same strip, the whole road. */
  shared: boolean;
}

function width(factor: number): Numeric {
  const own = (pixels: number) => ["*", factor * pixels, ["case", ["==", ["get", "kind"], "turn"], 0.55, 1]];
  return ["interpolate", ["exponential", 1.4], ["zoom"], ...widths.flatMap(([zoom, pixels]) => [zoom, own(pixels)])] as unknown as Numeric;
}

/** To the driving side where a way has two directions. At deep zooms a line lies in its strip. */
function offset({ region, shared }: Ground): Numeric {
  const [, south, , north] = region.bbox;
  const side: Numeric = ["case", drivesLeft(region), -1, 1];
  const metres: Numeric = ["coalesce", ["get", "after_width_m"], ["get", "before_width_m"], 0];
  const stops = widths.flatMap(([zoom, pixels]) => {
    const strip: Numeric = ["*", pixelsPerMetre(zoom, (south + north) / 2) / 2, metres];
    const apart: Numeric | number = zoom < REAL_ZOOM || shared ? 0.6 * pixels : ["max", 0.6 * pixels, strip];
    return [zoom, ["case", ["==", ["get", "two_way"], true], ["*", side, apart], 0]];
  });
  return ["interpolate", ["exponential", 1.4], ["zoom"], ...stops] as unknown as Numeric;
}

/** The layers from below to above. */
function layers(palette: Palette, ground: Ground, selected: string | null): Line[] {
  const aside = offset(ground);
  const seen = ["any", ["!=", ["get", "kind"], "turn"], [">=", ["zoom"], TURN_ZOOM]];
  const of = (kind: ChangeName) => ["all", ["==", ["get", "change"], kind], seen] as unknown as FilterSpecification;
  const line = (name: string, filter: FilterSpecification, paint: Paint, cap: "round" | "butt" = "round"): Line => ({
    id: `${CHANGES}-${name}`,
    type: "line",
    source: CHANGES,
    filter,
    layout: { "line-cap": cap, "line-join": "round" },
    paint: { "line-offset": aside, ...paint },
  });
  const one = (kind: ChangeName, colour: string, factor: number, more: Paint = {}, cap: "round" | "butt" = "round"): Line =>
    line(kind, of(kind), { "line-color": colour, "line-width": width(factor), ...more }, cap);
  const under = (kind: ChangeName, colour: string, factor: number): Line =>
    line(`${kind}-ground`, of(kind), { "line-color": colour, "line-width": width(factor) });
  return [
    line("glow", ["==", ["get", "id"], selected ?? ""] as unknown as FilterSpecification, { "line-color": palette.glow, "line-width": width(3.4), "line-blur": 1.5 }),
    line("casing", seen as unknown as FilterSpecification, { "line-color": palette.casing, "line-width": width(1.7) }),
    one("went", palette.went, 0.9, { "line-dasharray": [0.5, 0.7] }, "butt"),
    under("appeared", palette.appeared, 1.15),
    // Hollow: the middle in the colour of the paper.
    one("appeared", palette.paper, 0.4),
    one("became_safe", palette.room[2], 1),
    one("became_unknown", palette.unknown, 0.9, { "line-dasharray": [0.1, 1.7] }),
    one("became_forbidden", palette.forbidden, 0.9, { "line-dasharray": [1.8, 1] }, "butt"),
    one("became_unsafe", palette.alarm, 0.75),
    under("became_conditional", palette.conditionalGap, 1.15),
    one("became_conditional", palette.conditional, 0.75, { "line-dasharray": [1.6, 0.8] }, "butt"),
  ];
}

/** Draws the changes of one vehicle at a time. */
export class ChangesLayer {
  #drawn = false;
  #key = "";

  constructor(private readonly view: View, private readonly region: Region) {}

  /** Draws other changes; null removes them. */
  show(changes: Changes | null): void {
    this.#drawn = changes !== null;
    void this.view.ready.then(() => {
      if (changes || this.view.map.getSource(CHANGES)) this.view.overlay(CHANGES, changes ? { type: "FeatureCollection", features: changes.features } as GeoJSON.FeatureCollection : nothing);
    });
  }

  /** Draws the lines anew, because theme, policy or choice may be other ones. */
  draw(theme: Theme, shared: boolean, selected: string | null): void {
    const key = JSON.stringify([theme, shared, selected]);
    if (!this.#drawn || key === this.#key) return;
    this.#key = key;
    void this.view.ready.then(() => {
      const { map } = this.view;
      if (!this.#drawn || !map.getSource(CHANGES)) return;
      // Under routes, explanations and names.
      const above = map.getStyle().layers.find(({ id }) => id === "names" || (id.startsWith("own-") && !id.startsWith(CHANGES)));
      for (const layer of layers(palettes[theme], { region: this.region, shared }, selected)) {
        if (!map.getLayer(layer.id)) map.addLayer(layer, above?.id);
        map.setFilter(layer.id, layer.filter as ExpressionSpecification);
        for (const [name, value] of Object.entries(layer.paint ?? {})) map.setPaintProperty(layer.id, name as keyof AllPaintProperties, value);
      }
    });
  }
}

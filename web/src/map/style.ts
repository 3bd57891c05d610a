// The map's style. Background, roads and labels come only from the database's own tiles.
//
// Every line is a directed edge. The two directions of a road are drawn side by side, each on its driving side. Each verdict has a
// layer with its own line: certified is wide and solid, not certified thin, forbidden dashed, unknown dotted.

import type {
  DataDrivenPropertyValueSpecification,
  ExpressionSpecification,
  LayerSpecification,
  LineLayerSpecification,
  StyleSpecification,
} from "maplibre-gl";
import type { Policy, Region, VerdictName } from "../api/types.ts";
import { complete, type State } from "../state.ts";
import { h } from "../ui/dom.ts";
import { CLASSES, EVIDENCE, POLICIES } from "../words.ts";
import { backdropSource, ground as behind, places } from "./backdrop.ts";
import { labels } from "./labels.ts";
import { EDGE_ZOOM, REAL_ZOOM, offset, pixelsPerMetre, width, type Ground, type Numeric } from "./lines.ts";
import { evidenceColours, missingSteps, palettes, reasonColours, roomSteps, type Palette, type Theme } from "./palette.ts";

/** The verdicts in drawing order. What may be used is on top. */
export const verdictLayers: readonly VerdictName[] = ["unknown", "forbidden", "unsafe", "safe"];
export const edgeLayers = verdictLayers.map((verdict) => `edge-${verdict}`);
/** The drawing order of overviews, where one line stands for many roads. What may not be used is on top. */
const fromBest: readonly VerdictName[] = ["safe", "unknown", "unsafe", "forbidden"];
export const overviewLayers = fromBest.map((verdict) => `overview-${verdict}`);
/** The source with the line of the selected road. Sources whose names begin with `own-` survive a change of the style. */
export const OUTLINE = "own-outline";
export const turnLayers = verdictLayers.map((verdict) => `turn-${verdict}`);

type Colour = DataDrivenPropertyValueSpecification<string>;
function stepped(colours: readonly string[], steps: readonly { from_m: number }[]): Numeric {
  const rest = steps.slice(1).flatMap((step, index) => [step.from_m, colours[index + 1] ?? ""]);
  return ["step", ["coalesce", ["get", "rsc_m"], -1000], colours[0] ?? "", ...rest] as unknown as Numeric;
}

function colour(verdict: VerdictName, state: State, palette: Palette, theme: Theme): Colour {
  if (state.colourBy === "evidence") {
    const colours = evidenceColours[theme];
    const pairs = EVIDENCE.flatMap((source) => [source, colours[source]]);
    return ["match", ["coalesce", ["get", "width_source"], "none"], ...pairs, colours.none] as unknown as Colour;
  }
  if (state.colourBy === "strip") {
    const pairs = POLICIES.flatMap((policy: Policy) => [policy, palette.strips[policy]]);
    const none = { safe: palette.noStrip, unsafe: palette.noStrip, forbidden: palette.forbidden, unknown: palette.unknown }[verdict];
    return ["match", ["coalesce", ["get", "uses"], ""], ...pairs, none] as unknown as Colour;
  }
  if (verdict === "safe") return stepped(palette.room, roomSteps);
  if (state.colourBy === "reason" && verdict === "unsafe") {
    const named = Object.entries(reasonColours).filter(([name]) => name.startsWith("unsafe/"));
    const pairs = named.flatMap(([name, value]) => [name.slice("unsafe/".length), value]);
    return ["match", ["coalesce", ["get", "reason"], ""], ...pairs, palette.unknown] as unknown as Colour;
  }
  if (verdict === "unsafe") return stepped(palette.missing, missingSteps);
  return verdict === "forbidden" ? palette.forbidden : palette.unknown;
}

const dashes: Partial<Record<VerdictName, number[]>> = { forbidden: [2.2, 1.4], unknown: [0.1, 2] };
const breadth: Record<VerdictName, number> = { safe: 1.25, unsafe: 0.72, forbidden: 0.6, unknown: 0.75 };

/** From this zoom on, lines are wide enough for a stripe in them. */
const SHARED_ZOOM = 14;

/** How strong roads are drawn while changes or a route lie over them. */
export const muted = (state: State): number => (state.changes ? 0.24 : complete(state.route) ? 0.5 : 1);

/** The filter for one verdict, combined with the user's filters. */
export function filter(verdict: VerdictName, state: State): ExpressionSpecification {
  const all: unknown[] = ["all", ["==", ["get", "verdict"], verdict]];
  if (state.hiddenClasses.size > 0) {
    const gone = CLASSES.filter((name) => state.hiddenClasses.has(name)).flatMap((name) => [name, `${name}_link`]);
    all.push(["!", ["in", ["get", "highway"], ["literal", gone]]]);
  }
  if (state.evidence !== "assumed") {
    const enough = EVIDENCE.slice(EVIDENCE.indexOf(state.evidence));
    all.push(["in", ["coalesce", ["get", "width_source"], "none"], ["literal", [...enough]]]);
  }
  if (state.hidden.has(verdict)) all.push(false);
  return all as ExpressionSpecification;
}

function edge(verdict: VerdictName, state: State, palette: Palette, ground: Ground): LayerSpecification {
  const dash = dashes[verdict];
  // Round ends that overlap would show as dots where lines let the paper through.
  const butt = verdict === "forbidden" || (verdict !== "unknown" && muted(state) < 1);
  return {
    id: `edge-${verdict}`,
    type: "line",
    source: "roads",
    "source-layer": "edge",
    filter: filter(verdict, state),
    layout: { "line-cap": butt ? "butt" : "round", "line-join": "round" },
    paint: {
      "line-color": colour(verdict, state, palette, ground.theme),
      "line-width": width(breadth[verdict]),
      "line-offset": offset(breadth[verdict], ground),
      "line-opacity": muted(state),
      ...(dash ? { "line-dasharray": dash } : {}),
    },
  };
}

/** A stripe in certified roads whose lane is the whole road: oncoming traffic has to wait there. */
function sharedLane(state: State, palette: Palette, ground: Ground): LayerSpecification {
  return {
    id: "edge-shared",
    type: "line",
    source: "roads",
    "source-layer": "edge",
    minzoom: SHARED_ZOOM,
    filter: ["all", filter("safe", state), ["==", ["get", "shared"], true]] as ExpressionSpecification,
    layout: { "line-cap": "butt", "line-join": "round" },
    paint: {
      "line-color": palette.casing,
      "line-width": width(0.3 * breadth.safe),
      "line-offset": offset(breadth.safe, ground),
      "line-opacity": muted(state),
    },
  };
}

/** Roads of the overview. Both directions are one line, so it has no offset. */
function overview(verdict: VerdictName, state: State, palette: Palette, ground: Ground): LayerSpecification {
  const { paint, ...own } = edge(verdict, state, palette, ground) as LineLayerSpecification;
  const { "line-offset": _, ...rest } = paint ?? {};
  return { ...own, id: `overview-${verdict}`, "source-layer": "overview", paint: { ...rest, "line-width": width(1.5 * breadth[verdict]) } };
}

/** A casing in the paper's colour under roads that are not certified, so that no certified line shows through their gaps. */
function overviewCasing(verdict: VerdictName, state: State, palette: Palette): LayerSpecification {
  return {
    id: `overview-casing-${verdict}`,
    type: "line",
    source: "roads",
    "source-layer": "overview",
    filter: filter(verdict, state),
    layout: { "line-cap": "round", "line-join": "round" },
    paint: { "line-color": palette.casing, "line-width": width(2) },
  };
}

function turn(verdict: VerdictName, state: State, palette: Palette, ground: Ground): LayerSpecification {
  const dash = dashes[verdict];
  const filtered = ["all", ["==", ["get", "verdict"], verdict], !state.hidden.has(verdict)];
  return {
    id: `turn-${verdict}`,
    type: "line",
    source: "roads",
    "source-layer": "turn",
    // Most forbidden or unknown turns lead into forbidden or unknown roads, so they appear later.
    minzoom: verdict === "safe" || verdict === "unsafe" ? 15.5 : 17.5,
    filter: filtered as ExpressionSpecification,
    layout: { "line-cap": "round", "line-join": "round" },
    paint: {
      "line-color": colour(verdict, state.colourBy === "strip" ? state : { ...state, colourBy: "margin" }, palette, ground.theme),
      "line-width": ["interpolate", ["exponential", 1.5], ["zoom"], 15.5, verdict === "safe" ? 1.4 : 0.7, 20, verdict === "safe" ? 5 : 2.5],
      "line-opacity": (verdict === "safe" ? 0.95 : verdict === "unsafe" ? 0.6 : 0.35) * muted(state),
      ...(dash ? { "line-dasharray": dash } : {}),
    },
  };
}

/** A wide line in the paper's colour under all roads, which keeps crossings and neighbours apart. */
function casing(palette: Palette, ground: Ground): LayerSpecification {
  return {
    id: "casing",
    type: "line",
    source: "roads",
    "source-layer": "edge",
    minzoom: 12,
    maxzoom: REAL_ZOOM,
    layout: { "line-cap": "round", "line-join": "round" },
    paint: { "line-color": palette.casing, "line-width": width(1.7), "line-offset": offset(1, ground), "line-opacity": 0.9 },
  };
}

/** The strip of a direction in its real width. */
function surface(palette: Palette, ground: Ground): LayerSpecification {
  const zooms = [REAL_ZOOM, 18, 19, 20, 21, 22];
  const metres = ["coalesce", ["get", "width_m"], 0];
  const stops = zooms.flatMap((zoom) => [zoom, ["*", pixelsPerMetre(zoom, ground.latitude), metres]]);
  return {
    id: "surface",
    type: "line",
    source: "roads",
    "source-layer": "edge",
    minzoom: REAL_ZOOM,
    layout: { "line-cap": "round", "line-join": "round" },
    paint: {
      "line-color": palette.surface,
      "line-width": ["interpolate", ["exponential", 1.8], ["zoom"], ...stops] as unknown as Numeric,
      ...(ground.shared ? {} : { "line-offset": offset(1, ground) }),
    },
  };
}

/** The surface of junctions with their corners, as assumed, mapped or measured. */
function junction(palette: Palette): LayerSpecification {
  return {
    id: "junction",
    type: "fill",
    source: "roads",
    "source-layer": "junction",
    minzoom: REAL_ZOOM,
    paint: { "fill-color": palette.surface },
  };
}

function highlight(id: string, layer: "edge" | "turn", palette: Palette, ground: Ground): LayerSpecification {
  const key = layer === "edge" ? "edge_id" : "turn_id";
  return {
    id,
    type: "line",
    source: "roads",
    "source-layer": layer,
    filter: ["==", ["get", key], ""],
    layout: { "line-cap": "round", "line-join": "round" },
    paint: {
      "line-color": palette.selected,
      "line-width": layer === "edge" ? width(2.3) : 6,
      ...(layer === "edge" ? { "line-offset": offset(1, ground) } : {}),
      "line-opacity": id.startsWith("hover") ? 0.35 : 0.9,
    },
  };
}

/** The base map beneath roads that are to stand out, and as it is. */
export const PALE_BASE = { "raster-opacity": 0.45, "raster-saturation": -0.7 };
export const CLEAR_BASE: typeof PALE_BASE = { "raster-opacity": 1, "raster-saturation": 0 };

/** The glow that makes the selected road stand out in a whole region. */
function shine(palette: Palette): NonNullable<LineLayerSpecification["paint"]> {
  return { "line-color": palette.glow, "line-width": ["interpolate", ["linear"], ["zoom"], 9, 12, 14, 16, 19, 34], "line-blur": 1.5 };
}

function glow(palette: Palette, ground: Ground): LayerSpecification {
  const { id, paint, ...edge } = highlight("glow", "edge", palette, ground) as LineLayerSpecification;
  return { ...edge, id, paint: { ...paint, ...shine(palette), "line-opacity": 1 } };
}

/** The glow at low zooms. Overview tiles have no single roads, so the glow has a source of its own. */
function glowAfar(palette: Palette): LayerSpecification {
  return { id: "glow-afar", type: "line", source: OUTLINE, maxzoom: EDGE_ZOOM, layout: { "line-cap": "round", "line-join": "round" }, paint: shine(palette) };
}

/** Escapes a text, because MapLibre treats attributions as HTML. */
function plain(text: string): string {
  return h("span", {}, text).innerHTML;
}

const world: [number, number][] = [[-180, -85], [180, -85], [180, 85], [-180, 85], [-180, -85]];

/** The region's box. Nothing is known outside of it. */
function extent([west, south, east, north]: Region["bbox"]): GeoJSON.Feature {
  const [x, y] = [0.01 * (east - west), 0.01 * (north - south)];
  const [w, s, e, n] = [west - x, south - y, east + x, north + y];
  const box = [[w, s], [w, n], [e, n], [e, s], [w, s]];
  return { type: "Feature", properties: {}, geometry: { type: "Polygon", coordinates: [world, box] } };
}

export function style(state: State, ground: Ground): StyleSpecification {
  const { region, tilesUrl, theme } = ground;
  const palette = palettes[theme];
  const base = state.baseMap && region.base_map ? region.base_map : null;
  const each = (make: typeof edge): LayerSpecification[] =>
    verdictLayers.map((verdict) => make(verdict, state, palette, ground));
  return {
    version: 8,
    // Without `glyphs`, MapLibre draws letters with the fonts of the page.
    sources: {
      roads: { type: "vector", tiles: [tilesUrl], maxzoom: region.max_zoom, bounds: region.bbox, attribution: region.attribution },
      outside: { type: "geojson", data: extent(region.bbox) },
      ...(base ? {} : backdropSource(region)),
      [OUTLINE]: { type: "geojson", data: { type: "FeatureCollection", features: [] } },
      ...(base ? { base: { type: "raster", tiles: [base.url], tileSize: 256, attribution: plain(base.attribution) } } : {}),
    },
    layers: [
      { id: "paper", type: "background", paint: { "background-color": palette.paper } },
      ...(base ? [{ id: "base", type: "raster", source: "base", paint: PALE_BASE } as LayerSpecification] : []),
      ...(base ? [] : behind(region, palette)),
      { id: "outside", type: "fill", source: "outside", paint: { "fill-color": palette.outside, "fill-opacity": base ? 0.4 : 1 } },
      // At low zooms the box keeps a small region from being lost.
      { id: "region", type: "line", source: "outside", maxzoom: 9, paint: { "line-color": palette.soft, "line-width": 2 } },
      surface(palette, ground),
      junction(palette),
      glowAfar(palette),
      ...fromBest.flatMap((verdict) => {
        const line = overview(verdict, state, palette, ground);
        return verdict === "safe" ? [line] : [overviewCasing(verdict, state, palette), line];
      }),
      casing(palette, ground),
      glow(palette, ground),
      highlight("hover-edge", "edge", palette, ground),
      highlight("selected-edge", "edge", palette, ground),
      ...each(edge),
      sharedLane(state, palette, ground),
      highlight("hover-turn", "turn", palette, ground),
      highlight("selected-turn", "turn", palette, ground),
      ...each(turn),
      ...labels(palette, theme),
      ...(base ? [] : places(region, palette)),
    ],
  };
}

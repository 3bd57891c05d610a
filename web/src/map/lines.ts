// Width and offset of the lines of roads by zoom. At low zooms lines are wide enough to be seen; at deep zooms they are as wide as
// the road.

import type { ExpressionSpecification } from "maplibre-gl";
import type { Region } from "../api/types.ts";
import type { Theme } from "./palette.ts";

export type Numeric = ExpressionSpecification;

/** The facts of the database that a style depends on. */
export interface Ground {
  region: Region;
  tilesUrl: string;
  theme: Theme;
  /** Whether both directions use the same strip, the whole road. */
  shared: boolean;
  /** Latitude of the region's middle, degrees. */
  latitude: number;
}

/** From this zoom on, tiles have each road by itself (`crates/serve/src/tiles/mod.rs`). */
export const EDGE_ZOOM = 11;

export const major = ["motorway", "trunk"];
export const middle = ["primary", "secondary"];

/** Width of one direction of a road in pixels, by zoom: of motorways and trunk roads, of main roads, of all others. */
const widths: readonly (readonly [zoom: number, big: number, main: number, other: number])[] = [
  [8, 1.1, 0.8, 0.4],
  [12, 2.2, 1.8, 1.1],
  [15, 4.2, 3.8, 2.8],
  [17, 7, 6.5, 5.5],
  [18, 9, 8.5, 7.5],
  [19, 10, 9.5, 8.5],
  [20, 11, 10.5, 9.5],
  [21, 12, 11.5, 10.5],
  [22, 13, 12.5, 11.5],
];

/** An expression by zoom, made from the width of a direction at each zoom. */
function byWidth(make: (pixels: Numeric, zoom: number) => Numeric): Numeric {
  const links = (names: string[]): string[] => [...names, ...names.map((name) => `${name}_link`)];
  const stops = widths.flatMap(([zoom, big, main, other]) => {
    const pixels: Numeric = ["match", ["get", "highway"], links(major), big, links(middle), main, other];
    return [zoom, make(pixels, zoom)];
  });
  return ["interpolate", ["exponential", 1.5], ["zoom"], ...stops] as unknown as Numeric;
}

export function width(factor: number): Numeric {
  return byWidth((pixels) => ["*", factor, pixels]);
}

/** From this zoom on, roads are drawn in their real width under the lines of verdicts. */
export const REAL_ZOOM = 17;

/** Pixels per metre of ground at a zoom. Tiles are 512 pixels wide. */
export function pixelsPerMetre(zoom: number, latitude: number): number {
  return (512 * 2 ** zoom) / (40_075_016.7 * Math.cos((latitude * Math.PI) / 180));
}

/**
 * The offset of a line to the driving side, so that the two directions of a road touch, and at deep zooms lie in their strips.
 * One-way roads have no offset. `factor` multiplies the line's width.
 */
export function offset(factor: number, ground: Ground): Numeric {
  const sided = (pixels: Numeric): Numeric => [
    "case",
    ["==", ["get", "oneway"], "no"],
    ["*", ["case", drivesLeft(ground.region), -1, 1], pixels],
    0,
  ];
  return byWidth((pixels, zoom) => {
    const touching: Numeric = ["*", 0.53 * factor, pixels];
    if (zoom < REAL_ZOOM || ground.shared) return sided(touching);
    return sided(["max", touching, ["*", pixelsPerMetre(zoom, ground.latitude) / 2, ["coalesce", ["get", "width_m"], 0]]]);
  });
}

/** Whether traffic keeps left. If a region has both sides, its tiles say the side of each road. */
export function drivesLeft(region: Region): ExpressionSpecification {
  return ["to-boolean", ["coalesce", ["get", "left"], region.left_hand_traffic ?? false]];
}

// How broad the lines of roads are and where they lie beside the map's line, by zoom: broad enough to be seen from afar, as wide as
// the road near by.

import type { ExpressionSpecification } from "maplibre-gl";
import type { Region } from "../api/types.ts";
import type { Theme } from "./palette.ts";

export type Numeric = ExpressionSpecification;

/** What of the database a style depends on. */
export interface Ground {
  region: Region;
  tilesUrl: string;
  theme: Theme;
  /** Both directions use the same strip: the whole road. */
  shared: boolean;
  /** Of the region's middle, degrees. */
  latitude: number;
}

export const major = ["motorway", "trunk"];
export const middle = ["primary", "secondary"];

/** Pixels of one direction of a road by zoom: of motorways and trunk roads, of main roads, of all others. */
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

/** Something for each zoom, made from the width of a direction there. */
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

/** From this zoom on roads are drawn as wide as they are, under the lines that say what is certified. */
export const REAL_ZOOM = 17;

/** Pixels a metre of ground at a zoom; tiles are 512 pixels wide. */
export function pixelsPerMetre(zoom: number, latitude: number): number {
  return (512 * 2 ** zoom) / (40_075_016.7 * Math.cos((latitude * Math.PI) / 180));
}

/**
 * To the side on which one drives, so that the two directions of a road touch, and near by lie in their strips; one-way roads
 * stay where the map has them. `factor` is that of the line's own width.
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

/** Where a region has both sides, its tiles say it for each road. */
function drivesLeft(region: Region): ExpressionSpecification {
  return ["to-boolean", ["coalesce", ["get", "left"], region.left_hand_traffic ?? false]];
}

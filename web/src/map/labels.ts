// Names along roads, and numbers on shields.

import type { ExpressionSpecification, LayerSpecification, SymbolLayerSpecification } from "maplibre-gl";
import { EDGE_ZOOM, major, middle } from "./lines.ts";
import { palettes, type Palette, type Theme } from "./palette.ts";

export const LABEL_FONT = "Inter Variable";
/** From this zoom on, names are drawn. Before it, numbers alone tell roads apart. */
const NAME_ZOOM = 12.5;
/** The names of the shields' images begin so; the theme follows. */
const SHIELD = "shield-";

const NAME = ["get", "name"] as unknown as ExpressionSpecification;
/** A road's number; of several, the first two: `I 405;US 30` is `I 405 / US 30`. */
const REF = ["let", "ref", ["concat", ["get", "ref"], ";"], [
  "let", "first", ["index-of", ";", ["var", "ref"]], [
    "let", "second", ["index-of", ";", ["var", "ref"], ["+", ["var", "first"], 1]], [
      "case",
      ["<", ["var", "second"], 0], ["slice", ["var", "ref"], 0, ["var", "first"]],
      ["concat", ["slice", ["var", "ref"], 0, ["var", "first"]], " / ", ["slice", ["var", "ref"], ["+", ["var", "first"], 1], ["var", "second"]]],
    ],
  ],
]] as unknown as ExpressionSpecification;

const along: Pick<SymbolLayerSpecification, "type" | "source" | "source-layer"> = { type: "symbol", source: "roads", "source-layer": "label" };
const order = ["match", ["get", "highway"], major, 0, middle, 1, ["tertiary"], 2, 3] as unknown as ExpressionSpecification;

/** The names, then the numbers. A road with a number is named only from `NAME_ZOOM` on. */
export function labels(palette: Palette, theme: Theme): LayerSpecification[] {
  const names: LayerSpecification = {
    ...along,
    id: "names",
    minzoom: EDGE_ZOOM,
    filter: ["all", ["has", "name"], ["any", ["!", ["has", "ref"]], [">=", ["zoom"], NAME_ZOOM]]],
    layout: {
      "symbol-placement": "line",
      "symbol-spacing": 320,
      "text-font": [LABEL_FONT],
      "text-field": NAME,
      "text-size": ["interpolate", ["linear"], ["zoom"], 11, 10, 16, 12.5, 19, 15],
      "text-letter-spacing": 0.01,
      "text-max-angle": 35,
      "text-padding": 6,
      "symbol-sort-key": order,
    },
    paint: { "text-color": palette.ink, "text-halo-color": palette.halo, "text-halo-width": 2.6 },
  };
  const shields: LayerSpecification = {
    ...along,
    id: "shields",
    minzoom: EDGE_ZOOM,
    filter: ["has", "ref"],
    layout: {
      "symbol-placement": "line",
      "symbol-spacing": 420,
      "text-font": [LABEL_FONT],
      "text-field": REF,
      "text-size": ["interpolate", ["linear"], ["zoom"], 11, 9.5, 16, 11.5],
      "text-rotation-alignment": "viewport",
      "text-pitch-alignment": "viewport",
      "icon-image": `${SHIELD}${theme}`,
      "icon-text-fit": "both",
      "icon-text-fit-padding": [2, 5, 2, 5],
      "icon-rotation-alignment": "viewport",
      "icon-pitch-alignment": "viewport",
      "text-padding": 12,
      "icon-padding": 12,
      "symbol-sort-key": order,
    },
    paint: { "text-color": palette.ink },
  };
  return [names, shields];
}

/** The image of a name, with the parts that may be stretched. `null` if there is no such image. */
export function labelImage(id: string): { data: ImageData; pixelRatio: number; stretchX: [number, number][]; stretchY: [number, number][]; content: [number, number, number, number] } | null {
  const palette = id.startsWith(SHIELD) ? palettes[id.slice(SHIELD.length) as Theme] : undefined;
  const [wide, high, round] = [40, 32, 9];
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [wide, high];
  const context = canvas.getContext("2d");
  if (!palette || !context) return null;
  context.beginPath();
  context.roundRect(2, 2, wide - 4, high - 4, round);
  context.fillStyle = palette.paper;
  context.fill();
  context.lineWidth = 2.5;
  context.strokeStyle = palette.ink;
  context.stroke();
  const inner: [number, number][] = [[round + 3, wide - round - 3]];
  const tall: [number, number][] = [[round + 3, high - round - 3]];
  return { data: context.getImageData(0, 0, wide, high), pixelRatio: 2, stretchX: inner, stretchY: tall, content: [4, 4, wide - 4, high - 4] };
}

// Traces an area on the map, corner by corner. A bundle of its own, loaded when somebody traces: it is a twelfth of the page.

import { TerraDraw, TerraDrawPolygonMode } from "terra-draw";
import { TerraDrawMapLibreGLAdapter } from "terra-draw-maplibre-gl-adapter";
import type { Map } from "maplibre-gl";
import type { Position } from "../api/types.ts";

/** An area that is being traced, or lies there traced. */
export interface Tracing {
  /** Takes the area off the map. */
  end(): void;
}

/** Digits after the point of degrees: those of OpenStreetMap, a centimetre. */
const PRECISION = 7;

/** Begins to trace. `done` gets the closed ring when the first or the last corner is clicked again, or Enter is pressed. */
export function trace(map: Map, colour: string, done: (ring: Position[]) => void): Tracing {
  const draw = new TerraDraw({
    // Layers whose names begin so survive a change of the style.
    adapter: new TerraDrawMapLibreGLAdapter({ map, prefixId: "own-trace", coordinatePrecision: PRECISION }),
    modes: [
      new TerraDrawPolygonMode({
        // Corners of kerbs lie close to each other, and a click near the last one closes the area.
        pointerDistance: 10,
        keyEvents: { cancel: null, finish: "Enter" },
        styles: { fillColor: colour as `#${string}`, fillOpacity: 0.25, outlineColor: colour as `#${string}`, outlineWidth: 3 },
      }),
    ],
  });
  draw.start();
  draw.setMode("polygon");
  draw.on("finish", (id) => {
    const feature = draw.getSnapshotFeature(id);
    if (feature?.geometry.type !== "Polygon") return;
    draw.setMode("static");
    done(feature.geometry.coordinates[0] as Position[]);
  });
  return { end: () => draw.stop() };
}

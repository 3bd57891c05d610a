// Coordinates as text, which the server's search reads, and in metres.

import type { Position } from "./api/types.ts";

/** A degree of latitude, metres. */
export const DEGREE_M = 111_320;

/** The text of a place, latitude first: `−33.85710, 151.21520`. */
export function coordinateText([lon, lat]: Position): string {
  return [lat, lon].map((degrees) => degrees.toFixed(5).replace("-", "−")).join(", ");
}

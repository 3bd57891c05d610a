// Coordinates as text. The server's search reads them.

import type { Position } from "./api/types.ts";

/** The text of a place, latitude first: `−33.85710, 151.21520`. */
export function coordinateText([lon, lat]: Position): string {
  return [lat, lon].map((degrees) => degrees.toFixed(5).replace("-", "−")).join(", ");
}

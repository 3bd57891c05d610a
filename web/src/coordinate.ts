// Coordinates as people type them: latitude first, in degrees, with a comma or a space between.

import type { Position } from "./api/types.ts";

/** The place of a text such as `-33.8571, 151.2152`. Null if the text is no coordinate. */
export function coordinate(text: string): Position | null {
  const found = text.trim().match(/^([-−+]?\d{1,2}(?:\.\d+)?)°?\s*[,;\s]\s*([-−+]?\d{1,3}(?:\.\d+)?)°?$/);
  const [lat, lon] = (found?.slice(1) ?? []).map((part) => Number(part.replace("−", "-")));
  return lat !== undefined && lon !== undefined && Math.abs(lat) <= 85 && Math.abs(lon) <= 180 ? [lon, lat] : null;
}

/** The text of a place: `−33.85710, 151.21520`. */
export function coordinateText([lon, lat]: Position): string {
  return [lat, lon].map((degrees) => degrees.toFixed(5).replace("-", "−")).join(", ");
}

// A protocol of its own for tiles, so that requests for tiles are repeated when the server is busy, like all other requests.

import { addProtocol } from "maplibre-gl";
import { patient } from "../api/patient.ts";

/** MapLibre fetches in a worker, where relative addresses do not work. `netcert://tiles/…` is handled here. */
const SCHEME = "netcert";

/** The address under which MapLibre asks for a path of this server. */
export const tileAddress = (path: string): string => `${SCHEME}:/${path}`;

/** Answers to come for paths of tiles, asked for before MapLibre asks. */
const early = new Map<string, Promise<Response | null>>();

/** The most tiles that are asked for early. */
const MOST_EARLY = 16;

/**
 * Asks for the tiles of a view at once. MapLibre asks for them only after it has compiled its shaders, which takes most of a second where
 * the processor draws. `template` has `{z}`, `{x}` and `{y}`; `bounds` are west, south, east, north in degrees.
 */
export function askEarly(template: string, zoom: number, [west, south, east, north]: readonly [number, number, number, number]): void {
  const side = 2 ** zoom;
  const column = (lon: number) => Math.floor(((lon + 180) / 360) * side);
  const row = (lat: number) => Math.floor((0.5 - Math.asinh(Math.tan((lat * Math.PI) / 180)) / (2 * Math.PI)) * side);
  for (let x = column(west); x <= column(east); x += 1) {
    for (let y = row(north); y <= row(south); y += 1) {
      if (early.size >= MOST_EARLY) return;
      const path = template.replace("{z}", String(zoom)).replace("{x}", String(x)).replace("{y}", String(y));
      // If this fails, MapLibre's own request says why.
      early.set(path, patient(path).catch(() => null));
    }
  }
}

addProtocol(SCHEME, async ({ url }, { signal }) => {
  const path = url.slice(SCHEME.length + 2);
  const asked = await early.get(path);
  early.delete(path);
  const answer = asked?.ok ? asked : await patient(path, { signal });
  if (!answer.ok) throw new Error(`${url}: the server answered ${answer.status}`);
  const data = await answer.arrayBuffer();
  return { data, cacheControl: answer.headers.get("cache-control"), expires: answer.headers.get("expires") };
});

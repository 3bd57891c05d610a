// A protocol of its own for tiles, so that requests for tiles are repeated when the server is busy, like all other requests.

import { MercatorCoordinate, addProtocol } from "maplibre-gl";
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
  const tile = (lon: number, lat: number): [number, number] => {
    const { x, y } = MercatorCoordinate.fromLngLat([lon, lat]);
    return [Math.floor(x * 2 ** zoom), Math.floor(y * 2 ** zoom)];
  };
  const [[left, top], [right, bottom]] = [tile(west, north), tile(east, south)];
  for (let x = left; x <= right; x += 1) {
    for (let y = top; y <= bottom; y += 1) {
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

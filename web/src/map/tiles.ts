// A protocol of its own for tiles, so that requests for tiles are repeated when the server is busy, like all other requests.

import { addProtocol } from "maplibre-gl";
import { patient } from "../api/patient.ts";

/** MapLibre fetches in a worker, where relative addresses do not work. `netcert://tiles/…` is handled here. */
const SCHEME = "netcert";

/** The address under which MapLibre asks for a path of this server. */
export const tileAddress = (path: string): string => `${SCHEME}:/${path}`;

addProtocol(SCHEME, async ({ url }, { signal }) => {
  const answer = await patient(url.slice(SCHEME.length + 2), { signal });
  if (!answer.ok) throw new Error(`${url}: the server answered ${answer.status}`);
  const data = await answer.arrayBuffer();
  return { data, cacheControl: answer.headers.get("cache-control"), expires: answer.headers.get("expires") };
});

// Tiles by an address of their own, so that they are asked for as everything else is: again, when the server is busy.

import { addProtocol } from "maplibre-gl";
import { patient } from "../api/patient.ts";

/** MapLibre fetches in a worker, which knows no page to be relative to: `netcert://tiles/…` comes back here. */
const SCHEME = "netcert";

/** The address under which MapLibre asks for a path of this server. */
export const tileAddress = (path: string): string => `${SCHEME}:/${path}`;

addProtocol(SCHEME, async ({ url }, { signal }) => {
  const answer = await patient(url.slice(SCHEME.length + 2), { signal });
  if (!answer.ok) throw new Error(`${url}: the server answered ${answer.status}`);
  const data = await answer.arrayBuffer();
  return { data, cacheControl: answer.headers.get("cache-control"), expires: answer.headers.get("expires") };
});

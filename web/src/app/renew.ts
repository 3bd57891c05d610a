// The page anew after a change of the database: tiles, numbers, routes and changes all come from the new state. The link in the address bar
// keeps the view. What is to be told, and whether the base map is on, is kept meanwhile in this tab.

import { kept, put } from "../ui/tab.ts";
import { toast } from "../ui/toast.ts";

const [TOLD, BASE_MAP] = ["netcert.told", "netcert.base-map"];

export function renew(words: string, baseMap: boolean): void {
  put(TOLD, words);
  if (baseMap) put(BASE_MAP, "on");
  location.reload();
}

/** What was kept under a name, which is forgotten. */
function taken(key: string): string | null {
  const text = kept(key);
  put(key, null);
  return text;
}

/** Tells what was to be told before the page was loaded anew. */
export function toldBefore(): void {
  const words = taken(TOLD);
  if (words) toast(words);
}

/** Whether the base map was on before the page was loaded anew. */
export function baseMapBefore(): boolean {
  return taken(BASE_MAP) !== null;
}

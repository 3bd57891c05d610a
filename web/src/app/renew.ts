// The page anew after a change of the database: tiles, numbers, routes and changes all come from the new state. The link in the address bar
// keeps the view. What is to be told is kept meanwhile in this tab.

import { toast } from "../ui/toast.ts";

const KEY = "netcert.told";

export function renew(words: string): void {
  sessionStorage.setItem(KEY, words);
  location.reload();
}

/** Tells what was to be told before the page was loaded anew. */
export function toldBefore(): void {
  const words = sessionStorage.getItem(KEY);
  sessionStorage.removeItem(KEY);
  if (words) toast(words);
}

// Two maps side by side that move together.

import type { Map as Base } from "maplibre-gl";

/** Moves each map with the other. Returns a function that stops it. */
export function sync(a: Base, b: Base): () => void {
  let leading = false;
  const follow = (from: Base, to: Base) => () => {
    if (leading) return;
    leading = true;
    to.jumpTo({ center: from.getCenter(), zoom: from.getZoom(), bearing: from.getBearing(), pitch: from.getPitch() });
    leading = false;
  };
  const [left, right] = [follow(a, b), follow(b, a)];
  a.on("move", left);
  b.on("move", right);
  left();
  return () => {
    a.off("move", left);
    b.off("move", right);
  };
}

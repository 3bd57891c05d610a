// A note on the map: which roads the scale leaves out, and where the region is if it is out of sight or a speck.

import type { Region } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import { regionName } from "../words.ts";
import type { View } from "./view.ts";

/** From this zoom on, every road is drawn (`crates/serve/src/tiles/classes.rs`). */
const ALL_ZOOM = 13;
/** A region that is smaller on the screen is a speck, pixels. */
const SPECK_PX = 60;

/** What the tiles of a zoom leave out. */
function missing(zoom: number): string | null {
  if (zoom >= ALL_ZOOM) return null;
  if (zoom >= 12) return "Service roads and tracks are not drawn at this scale.";
  if (zoom >= 11) return "Residential and smaller roads are not drawn at this scale.";
  return "Minor roads are not drawn at this scale, and one line may stand for several roads.";
}

export class MapNote {
  readonly #words = h("span", { role: "status" });
  readonly #button = h("button", { class: "small", type: "button" });
  readonly element = h("div", { class: "map-note" }, this.#words, this.#button);
  #act: () => void = () => {};

  constructor(private readonly view: View, private readonly region: Region, home: () => void) {
    this.#button.addEventListener("click", () => this.#act());
    const draw = () => this.#draw(home);
    view.map.on("moveend", draw);
    void view.ready.then(draw);
  }

  #draw(home: () => void): void {
    const { map } = this.view;
    const lost = this.#lost();
    const words = lost ?? missing(map.getZoom());
    this.element.hidden = words === null;
    if (words === null) return;
    // A status that is set anew is read out again.
    if (this.#words.textContent !== words) this.#words.textContent = words;
    this.#button.textContent = lost ? "Show the region" : "Zoom in";
    this.#act = lost ? home : () => map.easeTo({ zoom: ALL_ZOOM, duration: 600 });
  }

  /** Words for a region that cannot be seen. */
  #lost(): string | null {
    const { map } = this.view;
    const corners = ([west, south, east, north]: Region["bbox"]) => [map.project([west, north]), map.project([east, south])] as const;
    // A few roads lead far out of the focus, so what lies beside it may still be in sight.
    const [a, b] = corners(this.region.bbox);
    const [c, d] = corners(this.region.focus ?? this.region.bbox);
    const { clientWidth: wide, clientHeight: tall } = map.getContainer();
    const name = regionName(this.region.name);
    if (Math.max(a.x, b.x) < 0 || Math.min(a.x, b.x) > wide || Math.max(a.y, b.y) < 0 || Math.min(a.y, b.y) > tall) return `${name} is out of sight.`;
    return Math.max(Math.abs(d.x - c.x), Math.abs(d.y - c.y)) < SPECK_PX ? `${name} is the small box on the map.` : null;
  }
}

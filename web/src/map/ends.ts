// The pins of a route's places. They can be dragged; the fields of the panel do the same for the keyboard.

import { Marker } from "maplibre-gl";
import type { Position } from "../api/types.ts";
import type { Places } from "../state.ts";
import { h } from "../ui/dom.ts";
import type { View } from "./view.ts";

export class Ends {
  readonly #markers: Marker[] = [];

  /** `named` gives letter and words of a place. */
  constructor(private readonly view: View, private readonly named: (index: number, count: number) => [letter: string, words: string], private readonly moved: (index: number, place: Position) => void) {}

  show(places: Places): void {
    while (this.#markers.length > 0) this.#markers.pop()?.remove();
    places.forEach((place, index) => {
      if (!place) return;
      const [letter, words] = this.named(index, places.length);
      const element = h("div", { class: "pin", role: "img", "aria-label": words }, letter);
      const marker = new Marker({ element, draggable: true }).setLngLat(place).addTo(this.view.map);
      marker.on("dragend", () => {
        const { lng, lat } = marker.getLngLat();
        this.moved(index, [lng, lat]);
      });
      this.#markers.push(marker);
    });
  }
}

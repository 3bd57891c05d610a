// Numbered pins: the conditions of a route, or the places that block it. Each is a button with its words beside it, so that the keyboard
// and readers of screens reach what the mouse reaches.

import { Marker } from "maplibre-gl";
import type { Position } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import type { View } from "./view.ts";

export interface Pin {
  number: number;
  place: Position;
  /** Where, and what has to be so or is missing there. */
  title: string;
  what: string;
}

/** The distance of two pins of one place, pixels. */
const BESIDE_PX = 27;

export class Pins {
  readonly #markers: Marker[] = [];
  readonly #buttons = new Map<number, HTMLElement>();

  constructor(private readonly view: View, private readonly chosen: (number: number) => void) {}

  show(kind: "condition" | "obstacle", pins: readonly Pin[]): void {
    while (this.#markers.length > 0) this.#markers.pop()?.remove();
    this.#buttons.clear();
    const taken = new Map<string, number>();
    for (const { number, place, title, what } of pins) {
      // Pins of one place stand side by side.
      const before = taken.get(String(place)) ?? 0;
      taken.set(String(place), before + 1);
      const name = kind === "condition" ? "Condition" : "Obstacle";
      const button = h(
        "button",
        { class: `numbered is-${kind}`, type: "button", "aria-label": `${name} ${number}: ${title}, ${what}`, onclick: (event: MouseEvent) => this.#choose(event, number) },
        h("b", {}, String(number)),
        h("span", { class: "pin-card", "aria-hidden": "true" }, h("strong", {}, title), h("span", {}, what)),
      );
      const element = h("div", { class: "numbered-place" }, button);
      this.#markers.push(new Marker({ element, offset: [before * BESIDE_PX, 0] }).setLngLat(place).addTo(this.view.map));
      this.#buttons.set(number, button);
    }
  }

  /** Shows which pin belongs to the chosen line of the list. */
  mark(number: number | null): void {
    for (const [own, button] of this.#buttons) {
      button.classList.toggle("is-chosen", own === number);
      // A chosen pin lies on top of its neighbours.
      button.parentElement?.classList.toggle("is-on-top", own === number);
    }
  }

  #choose(event: MouseEvent, number: number): void {
    // Otherwise the map takes the click for one on the road below.
    event.stopPropagation();
    this.chosen(number);
  }
}

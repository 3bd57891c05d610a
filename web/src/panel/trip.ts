// The places of a route as fields of text: a road by its name or number, or a coordinate. Between beginning and end there may be stops.

import type { AtMost, Position } from "../api/types.ts";
import { coordinateText } from "../coordinate.ts";
import { MOST_VIA, type Places } from "../state.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { Search } from "./search.ts";

/** The letter of a place on its pin, in its field and in messages. */
export const letter = (index: number): string => String.fromCharCode("A".charCodeAt(0) + index);

/** What a place is called: where the route begins, through what it leads, or where it goes. */
export function roleOf(index: number, count: number): string {
  return index === 0 ? "From" : index === count - 1 ? "To" : `Via ${index}`;
}

/** What a route may use beside the strip of its policy. */
const roomWords: Record<AtMost, string> = {
  lane: "its own lane",
  direction: "all lanes of its direction",
  carriageway: "the oncoming lane, too",
  attested: "places where it is attested",
};

export class Trip {
  readonly element = h("form", { class: "trip", "aria-label": "Places of the route", onsubmit: (event: Event) => event.preventDefault() });
  readonly #names = new Map<string, string>();
  #fields: Search[] = [];
  #shown: Places = [];

  /** How much of the road a route may use, where its vehicle could use more. */
  readonly room = h("div", { class: "trip-room" });

  constructor(private readonly change: (places: Places) => void, private readonly allow: (atMost: AtMost | null) => void) {}

  /** Offers the rungs above the policy's strip. */
  offer(wider: readonly AtMost[], chosen: AtMost | null): void {
    this.room.hidden = wider.length === 0;
    const option = (value: AtMost | null, text: string) => h("option", { value: value ?? "", selected: value === chosen }, text);
    const select = h(
      "select",
      { id: "trip-room", onchange: () => this.allow((select.value || null) as AtMost | null) },
      option(null, "nothing more"),
      ...wider.map((rung) => option(rung, roomWords[rung])),
    );
    this.room.replaceChildren(h("label", { for: "trip-room" }, "Where it is too narrow, use"), select);
  }

  /** Gives a place a name, which its field then shows instead of the coordinate. */
  name(place: Position, name: string): void {
    this.#names.set(String(place), name);
  }

  /** Puts the focus into the first field without a place. */
  focus(): void {
    const empty = this.#shown.indexOf(null);
    this.#fields[Math.max(empty, 0)]?.focus();
  }

  show(places: Places): void {
    const before = this.#shown;
    this.#shown = places;
    if (places.length !== before.length) {
      this.#make(places.length);
    }
    places.forEach((place, index) => this.#fields[index]?.put(place ? (this.#names.get(String(place)) ?? coordinateText(place)) : ""));
  }

  #make(count: number): void {
    this.#fields = Array.from({ length: count }, (_, index) => this.#field(index, count));
    const rows = this.#fields.map((field, index) => {
      const middle = index > 0 && index < count - 1;
      const remove = () => {
        this.change(this.#shown.filter((_, other) => other !== index));
        this.focus();
      };
      const name = roleOf(index, count);
      return h(
        "div",
        { class: "trip-row" },
        h("span", { class: "trip-letter", "aria-hidden": "true" }, letter(index)),
        h("label", { class: "trip-name", for: `place-${index}` }, name),
        field.element,
        middle ? h("button", { class: "plain", type: "button", "aria-label": `Remove ${name}`, onclick: remove }, icon("close")) : null,
      );
    });
    const swap = h("button", { class: "small", type: "button", onclick: () => this.change([...this.#shown].reverse()) }, icon("swap"), "Swap");
    const stop = () => {
      this.change([...this.#shown.slice(0, -1), null, ...this.#shown.slice(-1)]);
      this.focus();
    };
    const add = h("button", { class: "small", type: "button", disabled: count >= MOST_VIA + 2, onclick: stop }, icon("plus"), "Add a stop");
    this.element.replaceChildren(...rows, h("div", { class: "tools" }, swap, add), this.room);
  }

  #field(index: number, count: number): Search {
    const set = (place: Position | null) => {
      this.change(this.#shown.map((one, other) => (other === index ? place : one)));
      // Who types goes on to the next place.
      if (place && this.#shown.includes(null)) this.focus();
    };
    return new Search(
      (hit) => {
        const place: Position = [hit.lon, hit.lat];
        if (hit.kind !== "place" || hit.settlement) this.name(place, hit.title);
        set(place);
      },
      {
        id: `place-${index}`,
        label: roleOf(index, count),
        placeholder: "Road, town, or latitude, longitude",
        field: true,
        emptied: () => set(null),
      },
    );
  }
}

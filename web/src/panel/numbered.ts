// A numbered list whose lines are pins on the map. A click on a line flies to its pin; "Why" opens the road or turn.

import type { Pin } from "../map/pins.ts";
import { h } from "../ui/dom.ts";

/** A line of the list. */
export interface Item extends Omit<Pin, "place"> {
  place: Pin["place"] | null;
  /** Beside what: `over 240 m`. */
  more: string;
  /** The edge, or the two edges of a turn, that can be explained. */
  road: { edge: string } | { from: string; to: string } | null;
}

export interface NumberedActions {
  /** Flies to the pin of a line. */
  fly(number: number): void;
  /** Opens the explanation of a line's road or turn. */
  explain(item: Item): void;
}

export class NumberedList {
  readonly element: HTMLElement;
  readonly #lines = new Map<number, HTMLElement>();

  constructor(kind: "condition" | "obstacle", items: readonly Item[], actions: NumberedActions) {
    const lines = items.map((item) => {
      const go = h(
        "button",
        { class: "numbered-go", type: "button", onclick: () => actions.fly(item.number) },
        h("i", { class: `number is-${kind}`, "aria-hidden": "true" }, String(item.number)),
        h("span", { class: "what" }, item.what),
        h("span", { class: "where" }, item.title),
        item.more ? h("span", { class: "more" }, item.more) : null,
      );
      const why = item.road
        ? h("button", { class: "small why", type: "button", "aria-label": `Why: ${item.title}`, onclick: () => actions.explain(item) }, "Why")
        : null;
      const line = h("li", { "data-number": item.number }, go, why);
      this.#lines.set(item.number, line);
      return line;
    });
    this.element = h("ol", { class: "numbered-list" }, ...lines);
  }

  /** Shows which line belongs to the chosen pin. */
  mark(number: number | null): void {
    for (const [own, line] of this.#lines) {
      const chosen = own === number;
      line.classList.toggle("is-chosen", chosen);
      if (chosen) {
        line.setAttribute("aria-current", "true");
        line.scrollIntoView({ block: "nearest" });
      } else {
        line.removeAttribute("aria-current");
      }
    }
  }
}

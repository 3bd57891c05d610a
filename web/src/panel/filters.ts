// The filters of drawn roads, by source of width and by class.

import type { Evidence } from "../api/types.ts";
import type { Context } from "../context.ts";
import { h } from "../ui/dom.ts";
import { CLASSES, EVIDENCE, className, evidenceWords } from "../words.ts";

export class Filters {
  readonly element: HTMLDetailsElement;
  readonly #evidence: HTMLSelectElement;
  readonly #chips: HTMLInputElement[];
  readonly #count = h("span", { class: "tag", hidden: true });

  constructor(private readonly context: Context, classes: ReadonlySet<string>) {
    const { store } = context;
    const option = (source: Evidence) =>
      h("option", { value: source }, source === "assumed" ? "Any evidence" : `${evidenceWords[source]} or better`);
    this.#evidence = h(
      "select",
      { id: "evidence", onchange: () => store.set({ evidence: this.#evidence.value as Evidence }) },
      ...EVIDENCE.map(option),
    );
    this.#chips = CLASSES.filter((name) => classes.size === 0 || classes.has(name)).map((name) =>
      h("input", { type: "checkbox", value: name, onchange: () => this.#toggle(name) }),
    );
    const chips = this.#chips.map((input) => h("label", { class: "chip" }, input, h("span", {}, className(input.value))));
    this.element = h(
      "details",
      { class: "filters" },
      h("summary", {}, "Filters", this.#count),
      h("label", { class: "label", for: "evidence" }, "Road width"),
      this.#evidence,
      h("fieldset", {}, h("legend", { class: "label" }, "Road class"), h("div", { class: "chips" }, ...chips)),
    );
    this.draw();
  }

  draw(): void {
    const { evidence, hiddenClasses } = this.context.store.state;
    this.#evidence.value = evidence;
    for (const input of this.#chips) input.checked = !hiddenClasses.has(input.value);
    const active = hiddenClasses.size + (evidence === "assumed" ? 0 : 1);
    this.#count.hidden = active === 0;
    this.#count.textContent = `${active} active`;
  }

  #toggle(name: string): void {
    const hiddenClasses = new Set(this.context.store.state.hiddenClasses);
    if (!hiddenClasses.delete(name)) hiddenClasses.add(name);
    this.context.store.set({ hiddenClasses });
  }
}

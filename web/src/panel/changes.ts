// The switch of the changes since the older database; below it kilometres by kind, and the roads that changed most.

import type { Before, ChangeName, Changed, ChangedRoad, Changes, Region } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import { roadLength } from "../units.ts";
import { CHANGES, changeWords, className, sideWords, standingWords } from "../words.ts";

export interface ChangesActions {
  toggle(on: boolean): void;
  /** Shows a road on the map and opens the explanation of its longest edge. */
  go(road: ChangedRoad): void;
}

/** What the panel shows below the switch. */
export type Shown = "off" | "waiting" | { failed: string } | { changes: Changes; drawn: Changes };

/** The day of the older data, or the name of its file if that does not tell the two databases apart. */
export function since({ before, timestamp }: Region): string {
  const day = before?.timestamp?.slice(0, 10);
  return day && day !== timestamp?.slice(0, 10) ? day : before?.file ?? "";
}

export function changeLine(change: ChangeName): HTMLElement {
  return h("i", { class: `line line-change line-${change}`, "aria-hidden": "true" });
}

export class ChangesPanel {
  readonly element: HTMLElement;
  readonly #input: HTMLInputElement;
  readonly #content = h("div", { class: "changes-content" });
  readonly #status = h("p", { class: "note", role: "status" });
  readonly #missing = h("p", { class: "note" }, "The older database has no certificates of this vehicle for this strip of the road.");
  #buttons: HTMLButtonElement[] = [];
  #roads: readonly ChangedRoad[] = [];

  constructor(before: Before, label: string, private readonly actions: ChangesActions) {
    this.#input = h("input", { type: "checkbox", id: "changes", onchange: () => actions.toggle(this.#input.checked) });
    const title = `What changed from ${before.file} to this database (S)`;
    this.element = h(
      "section",
      { class: "changes", "aria-label": `Changes since ${label}` },
      h("label", { class: "legend-row", title }, this.#input, h("span", { class: "legend-name" }, `Changes since ${label}`)),
      this.#missing,
      this.#status,
      this.#content,
    );
  }

  /** `possible` says whether the older database has the vehicle under the policy. */
  draw(on: boolean, possible: boolean, selected: string | null): void {
    this.#input.checked = on;
    this.#input.disabled = !possible;
    this.#missing.hidden = possible;
    this.#buttons.forEach((button, index) => {
      if (this.#roads[index]?.edge_id === selected) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    });
  }

  show(shown: Shown): void {
    this.#status.className = shown === "waiting" ? "waiting" : "note";
    this.#buttons = [];
    this.#roads = [];
    if (shown === "off" || shown === "waiting" || "failed" in shown) {
      this.#status.textContent = shown === "waiting" ? "Comparing both databases …" : "";
      const failed = typeof shown === "object" ? h("p", { class: "problem", role: "alert" }, shown.failed) : "";
      this.#content.replaceChildren(failed);
      return;
    }
    const { changes, drawn } = shown;
    this.#status.textContent = told(changes, drawn);
    const rows = CHANGES.flatMap((name) => {
      const sum = changes.sums.find(({ change }) => change === name);
      return sum ? [row(name, sum)] : [];
    });
    this.#content.replaceChildren(h("ul", { class: "change-rows", "aria-label": "Kinds of changes" }, ...rows), ...changes.notes.map(note), ...this.#list(changes));
  }

  #list({ roads }: Changes): Node[] {
    if (roads.length === 0) return [];
    this.#roads = roads;
    this.#buttons = roads.map((road, index) =>
      h(
        "button",
        // One stop of the Tab key for the whole list; arrows step through it.
        { type: "button", tabindex: index === 0 ? 0 : -1, onclick: () => this.#go(index), onkeydown: (event: KeyboardEvent) => this.#key(event, index) },
        changeLine(road.change),
        h("span", { class: "change-road" }, road.road),
        h("span", { class: "legend-km" }, roadLength(1000 * road.km)),
        h("span", { class: "change-kind" }, `${changeWords[road.change].name}${more(road)} · ${className(road.highway).toLowerCase()}`),
      ),
    );
    const items = this.#buttons.map((button) => h("li", {}, button));
    return [h("h3", { id: "change-roads" }, "Largest changes by road"), h("ol", { class: "change-roads", "aria-labelledby": "change-roads" }, ...items)];
  }

  #go(index: number): void {
    const road = this.#roads[index];
    if (!road) return;
    this.#stop(index);
    this.actions.go(road);
  }

  #key(event: KeyboardEvent, index: number): void {
    const last = this.#buttons.length - 1;
    const to = { ArrowDown: Math.min(index + 1, last), ArrowUp: Math.max(index - 1, 0), Home: 0, End: last }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.#stop(to);
    this.#buttons[to]?.focus();
  }

  /** Makes a line the one that the Tab key reaches. */
  #stop(index: number): void {
    this.#buttons.forEach((button, other) => (button.tabIndex = other === index ? 0 : -1));
  }
}

/** What a road that appeared or went is or was. */
function more({ change, standing }: ChangedRoad): string {
  return change === "appeared" || change === "went" ? `, ${standingWords[standing].toLowerCase()}` : "";
}

function row(name: ChangeName, { edges, km, turns }: Changes["sums"][number]): HTMLElement {
  const counts = [edges > 0 ? roadLength(1000 * km) : null, turns > 0 ? `${turns} ${turns === 1 ? "turn" : "turns"}` : null];
  const { name: title, meaning } = changeWords[name];
  return h(
    "li",
    { class: "legend-row", title: meaning, "data-change": name },
    changeLine(name),
    h("span", { class: "legend-name" }, title),
    h("span", { class: "legend-km" }, counts.filter(Boolean).join(" · ")),
  );
}

function told({ sums, turns_compared: turned }: Changes, drawn: Changes): string {
  const sum = (of: (one: Changes["sums"][number]) => number) => sums.reduce((all, one) => all + of(one), 0);
  const [edges, turns] = [sum(({ edges: count }) => count), sum(({ turns: count }) => count)];
  const without = turned ? "" : " Turns are not compared, because one of the databases has no certificates of them.";
  if (edges + turns === 0) return `Nothing changed for this vehicle.${without}`;
  const words = [edges > 0 ? `${roadLength(1000 * sum(({ km }) => km))} of roads (each direction counted)` : null, turns > 0 ? `${turns} turns` : null];
  const part = drawn.complete ? "" : ` The map shows the ${drawn.features.length} longest changes in view; zoom in for the others.`;
  return `Changed: ${words.filter(Boolean).join(" and ")}.${part}${without}`;
}

function note(text: string): HTMLElement {
  return h("p", { class: "note" }, `${text.charAt(0).toUpperCase()}${text.slice(1)}, so not every change is one of the map.`);
}

/** Before and after of one change, for the panel of its road. */
export function changeNote(changed: Changed, label: string): HTMLElement {
  const side = (name: string, which: "before" | "after") => h("div", {}, h("dt", {}, name), h("dd", {}, sideWords(changed, which)));
  return h(
    "section",
    { class: "changed", "aria-label": `Change since ${label}` },
    h("p", { class: "changed-what" }, changeLine(changed.change), h("strong", {}, changeWords[changed.change].name), ` since ${label}`),
    h("dl", { class: "facts" }, side("Before", "before"), side("Now", "after")),
  );
}

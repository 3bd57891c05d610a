// The card with the margin of the road under the pointer.

import { h, styled } from "../ui/dom.ts";
import { length } from "../units.ts";
import { changeWords, className, evidenceWords, leastMargin, margin, reasonWords, sideWords, title, usesWords, verdictWords } from "../words.ts";
import type { Changed, Evidence, Policy, VerdictName } from "../api/types.ts";
import type { Under } from "./view.ts";

export class HoverCard {
  readonly #card = h("div", { class: "hovercard", role: "status", "aria-live": "off", hidden: true });

  constructor(root: HTMLElement) {
    root.append(this.#card);
  }

  show(under: Under | null, x: number, y: number): void {
    this.#card.hidden = under === null;
    if (!under) return;
    this.#card.replaceChildren(...content(under));
    const { offsetWidth: wide, offsetHeight: tall } = this.#card;
    const right = document.body.classList.contains("has-drawer") ? innerWidth - 402 : innerWidth;
    const left = x + 18 + wide > right ? x - wide - 14 : x + 18;
    const top = y + 18 + tall > innerHeight ? y - tall - 14 : y + 18;
    styled(this.#card, { transform: `translate(${Math.max(left, 4)}px, ${Math.max(top, 4)}px)` });
  }
}

function content({ kind, properties }: Under): Node[] {
  if (kind === "change") return changeContent(properties as unknown as Changed);
  const text = (key: string): string | null => (typeof properties[key] === "string" ? properties[key] : null);
  const verdict = (text("verdict") ?? "unknown") as VerdictName;
  const rsc = properties["rsc_m"];
  const decided = (verdict === "safe" || verdict === "unsafe") && typeof rsc === "number";
  const told = kind === "overview" ? leastMargin : margin;
  const number = decided ? told(rsc) : reasonWords(verdict, text("reason"));
  const road = { ref: text("ref"), name: text("name"), highway: text("highway") };
  const name = { turn: "Turn", overview: "The worst of what lies here", edge: title(road) }[kind];
  const source = text("width_source") as Evidence | null;
  const need = properties["need_width_m"];
  const uses = text("uses") as Policy | null;
  const parts = [
    road.highway ? className(road.highway) : null,
    kind !== "turn" ? `width: ${evidenceWords[source ?? "none"].toLowerCase()}` : null,
  ].filter(Boolean);
  return [
    h("div", { class: `hover-number is-${verdict}` }, h("i", { class: `line line-${verdict}` }), number),
    h("div", { class: "hover-name" }, name),
    typeof need === "number" ? h("div", { class: "hover-more" }, `About ${length(need, "up")} would do, nowhere narrower along the road`) : null,
    uses ? h("div", { class: "hover-more" }, usesWords[uses]) : null,
    h("div", { class: "hover-more" }, [verdictWords[verdict].name, ...parts].join(" · ")),
    kind === "overview" ? h("div", { class: "hover-more" }, "Click to go nearer.") : null,
  ].filter((node) => node !== null);
}

/** Before and after. MapLibre leaves out members that are null. */
function changeContent(properties: Partial<Changed> & Pick<Changed, "kind" | "change">): Node[] {
  const nulls = { before: null, before_reason: null, before_rsc_m: null, before_width_m: null, before_need_width_m: null };
  const after = { after: null, after_reason: null, after_rsc_m: null, after_width_m: null, after_need_width_m: null };
  const changed = { ...nulls, ...after, ...properties } as Changed;
  return [
    h("div", { class: "hover-number" }, h("i", { class: `line line-change line-${changed.change}` }), changeWords[changed.change].name),
    h("div", { class: "hover-name" }, changed.kind === "turn" ? `Turn ${changed.name ?? ""}` : title(changed)),
    h("div", { class: "hover-more" }, `Before: ${sideWords(changed, "before").toLowerCase()}`),
    h("div", { class: "hover-more" }, `Now: ${sideWords(changed, "after").toLowerCase()}`),
  ];
}

// The buttons at the upper right.

import type { Context } from "../context.ts";
import { byId, h } from "../ui/dom.ts";
import { icon, type IconName } from "../ui/icons.ts";

export interface ToolActions {
  route(): void;
  compare(): void;
  stats(): void;
  link(): void;
  home(): void;
  zoom(by: number): void;
}

export class Tools {
  readonly #route: HTMLButtonElement;
  readonly #compare: HTMLButtonElement;

  constructor(private readonly context: Context, actions: ToolActions) {
    this.#route = tool("route", "Route", "Certified route between two places (R)", actions.route);
    this.#compare = tool("compare", "Compare", "Two vehicles side by side (C)", actions.compare);
    const stats = tool("stats", "Numbers", "The region in numbers (N)", actions.stats);
    const link = tool("link", "Link", "Copy a link to what you see (L)", actions.link);
    const small = (name: IconName, title: string, action: () => void) =>
      h("button", { class: "tool small-tool", type: "button", title, "aria-label": title, onclick: action }, icon(name));
    const zoom = h(
      "div",
      { class: "tool-group zoom" },
      small("plus", "Closer", () => actions.zoom(1)),
      small("minus", "Further", () => actions.zoom(-1)),
      small("home", "The whole region", actions.home),
    );
    byId("tools").append(h("div", { class: "tool-group" }, this.#route, this.#compare, stats, link), zoom);
  }

  draw(): void {
    const { route, other } = this.context.store.state;
    this.#route.setAttribute("aria-pressed", String(route !== null));
    this.#compare.setAttribute("aria-pressed", String(other !== null));
  }
}

function tool(name: IconName, text: string, title: string, action: () => void): HTMLButtonElement {
  return h("button", { class: "tool", type: "button", title, onclick: action }, icon(name), h("span", {}, text));
}

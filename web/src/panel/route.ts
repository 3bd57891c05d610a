// A route between two places: certified, or under conditions, or what blocks it.

import type { ConditionalRoute, Position, Route, RouteAnswer, RoutePart } from "../api/types.ts";
import { marginColour, type Palette } from "../map/palette.ts";
import { h, styled } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { distance, duration, margin, signed } from "../words.ts";
import { reasons } from "./blocked.ts";
import { along, conditionalFoot, conditionalHead } from "./conditions.ts";
import { NumberedList, type Item, type NumberedActions } from "./numbered.ts";

/** The functions of the page that the panel uses. */
export interface Actions extends NumberedActions {
  drive(): void;
  seek(s: number): void;
  go(place: Position): void;
  swap(): void;
  clear(): void;
}

/** The state of the search for a route under conditions: under way, without result, or failed. */
export type Search = "searching" | "none" | { failed: string } | undefined;

/** What the panel needs beside the answer. */
export interface Around {
  palette: Palette;
  /** The same question on the command line. */
  command: string;
  /** The address of a sheet of the conditions. */
  sheet(form: "html" | "csv" | "geojson"): string;
  search: Search;
}

const ways = "Lawful turns and one-way roads considered; traffic is not.";
const longer = "Looking for a route under conditions, which may take a minute …";

export class RoutePanel {
  readonly element = h("div", { class: "route" });
  #list: NumberedList | null = null;

  constructor(private readonly actions: Actions) {}

  waiting(chosen: number): void {
    const text = ["Click on the map where it begins.", "Now click where it is to go."][chosen] ?? "Searching, and certifying the whole way …";
    this.#list = null;
    this.element.replaceChildren(h("h2", {}, "Certified route"), h("p", { class: chosen < 2 ? "prompt" : "waiting", role: "status" }, text), this.#tools(false));
  }

  /** No place for a certified route is near, and the search for one under conditions is under way. */
  searching(): void {
    this.element.replaceChildren(h("h2", {}, "No certified route"), h("p", { class: "waiting", role: "status" }, longer), this.#tools(true));
  }

  failed(message: string): void {
    this.element.replaceChildren(h("h2", {}, "No route"), h("p", { class: "problem", role: "alert" }, message), this.#tools(true));
  }

  show(answer: RouteAnswer, items: readonly Item[], around: Around): void {
    const best = answer.routes[0];
    this.#list = best ? null : new NumberedList(answer.conditional ? "condition" : "obstacle", items, this.actions);
    const content = best
      ? this.#found(best, around.palette)
      : answer.conditional
        ? this.#conditional(answer.conditional, around)
        : this.#blocked(answer, around.search);
    const same = h("details", { class: "command" }, h("summary", {}, "The same on the command line"), h("code", {}, around.command));
    this.element.replaceChildren(...content, ...away(answer), same, this.#tools(true));
  }

  /** Shows which line belongs to the chosen pin. */
  mark(number: number | null): void {
    this.#list?.mark(number);
  }

  #tools(both: boolean): HTMLElement {
    const swap = h("button", { class: "small", type: "button", onclick: () => this.actions.swap() }, icon("swap"), "Reverse");
    const clear = h("button", { class: "small", type: "button", onclick: () => this.actions.clear() }, "New route");
    return h("div", { class: "tools" }, both ? swap : null, clear);
  }

  #found(route: Route, palette: Palette): Node[] {
    const go = h("button", { class: "primary", type: "button", onclick: () => this.actions.drive() }, icon("play"), "Drive it");
    const fact = (name: string, value: string) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
    const tolerance = route.shrink < 1 ? `With ${(100 * route.shrink).toFixed(0)} % of the tracking tolerance. ` : "";
    const where = route.limiting_at ? ` on ${route.limiting_at}` : "";
    return [
      h("h2", {}, "Certified as a whole"),
      h(
        "div",
        { class: "verdict is-safe" },
        h("span", { class: "badge" }, h("i", { class: "line line-safe" }), "Certified"),
        h("strong", {}, margin(route.rsc_m)),
      ),
      h("p", { class: "headline-words" }, `Tightest after ${distance(route.limiting_s_m)}${where}: ${route.limiting_unit_name ?? "a unit"}, ${route.limiting_side} side.`),
      go,
      h("dl", { class: "facts columns" }, fact("Length", distance(route.length_m)), fact("Time", duration(route.time_s)), fact("Hinges", `${(Math.floor(route.hinge_margin_deg * 10) / 10).toFixed(1)}° left`)),
      h("h3", {}, "Along the way"),
      this.#parts(route.parts, palette, (part) => this.actions.seek(part.from_m)),
      h("p", { class: "scope" }, `${tolerance}Proved from end to end within the stated model, widths and error bounds; no permit. ${ways}`),
    ];
  }

  #conditional(route: ConditionalRoute, { palette, sheet }: Around): Node[] {
    return [
      ...conditionalHead(route),
      this.#list!.element,
      ...conditionalFoot(route, sheet),
      h("details", { class: "along" }, h("summary", {}, "Along the way, if all of it is so"), this.#parts(route.parts, palette, (part) => this.actions.go(along(route, part.from_m)))),
    ];
  }

  #parts(parts: RoutePart[], palette: Palette, go: (part: RoutePart) => void): HTMLElement {
    const rows = merged(parts).map((part) => {
      const rsc = part.rsc_m > 100 ? "" : signed(part.rsc_m);
      const colour = styled(h("i", { class: "dot" }), { background: marginColour(palette, part.rsc_m) });
      return h(
        "li",
        {},
        h(
          "button",
          { type: "button", onclick: () => go(part) },
          colour,
          h("span", { class: part.kind === "edge" ? "part" : "part is-turn" }, part.title),
          h("span", { class: "part-length" }, distance(part.to_m - part.from_m)),
          h("span", { class: "part-rsc" }, rsc),
        ),
      );
    });
    return h("ol", { class: "parts" }, ...rows);
  }

  #blocked(answer: RouteAnswer, search: Search): Node[] {
    if (answer.obstacles === null) {
      return [h("h2", {}, "No route"), h("p", { class: "headline-words" }, `No roads lead there at all. ${ways}`)];
    }
    const count = answer.obstacles.length;
    const what = count === 1 ? "one place is not certified for this vehicle" : `${count} places are not certified for this vehicle`;
    return [
      h("h2", {}, "No certified route"),
      h(
        "div",
        { class: "verdict is-blocked" },
        h("span", { class: "badge" }, h("i", { class: "line line-blocked" }), "Blocked"),
      ),
      searchWords(search),
      h("p", { class: "headline-words" }, `Even on the easiest way ${what}: ${reasons(answer.obstacles)}. It is the dotted line on the map.`),
      this.#list!.element,
      h("p", { class: "scope" }, `Each of them would have to be certified first. ${answer.gave_up ? "The search was given up before all ways were tried. " : ""}${ways}`),
    ];
  }
}

/** What became of the search for a route under conditions. */
function searchWords(search: Search): Node {
  if (search === "searching") return h("p", { class: "waiting", role: "status" }, longer);
  if (search === "none") return h("p", { class: "note" }, "Nor is there a route under conditions: on every way that was tried something decides that no measurement helps.");
  if (search) return h("p", { class: "note", role: "alert" }, `No route under conditions was found: ${search.failed}. The command line has no limit of time.`);
  return document.createTextNode("");
}

/** A route that begins or ends within this distance of the click counts as there, metres. */
const THERE_M = 60;

/** Remarks on places where the route begins or ends away from the click. */
function away({ places }: RouteAnswer): Node[] {
  const ends: [string, number | undefined][] = [["begins", places[0]?.distance_m], ["ends", places.at(-1)?.distance_m]];
  const far = ends.filter(([, metres]) => metres !== undefined && metres > THERE_M);
  if (far.length === 0) return [];
  const words = far.map(([what, metres]) => `${what} ${distance(metres ?? 0)} from where you clicked`).join(" and ");
  return [h("p", { class: "note" }, `The way ${words}: nearer there is no road that may be used.`)];
}

/** Merges successive edges of one road into one row. */
function merged(parts: RoutePart[]): RoutePart[] {
  const rows: RoutePart[] = [];
  for (const part of parts) {
    const last = rows.at(-1);
    if (last && last.kind === "edge" && part.kind === "edge" && last.title === part.title) {
      last.to_m = part.to_m;
      last.rsc_m = Math.min(last.rsc_m, part.rsc_m);
    } else {
      rows.push({ ...part });
    }
  }
  return rows;
}

// A route between two places: certified, or under conditions, or what blocks it.

import type { ConditionalRoute, Position, Route, RouteAnswer, RoutePart, StripUse } from "../api/types.ts";
import { marginColour, type Palette } from "../map/palette.ts";
import type { Places } from "../state.ts";
import { h, styled } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { distance, length } from "../units.ts";
import { duration, margin, signed } from "../words.ts";
import { along } from "./along.ts";
import { reasons } from "./blocked.ts";
import { conditionalFoot, conditionalHead } from "./conditions.ts";
import { NumberedList, type Item, type NumberedActions } from "./numbered.ts";
import { takeAlong, type About } from "./takealong.ts";

/** The functions of the page that the panel uses. */
export interface Actions extends NumberedActions {
  drive(): void;
  seek(s: number): void;
  go(place: Position): void;
  /** Asks for other certified ways. */
  others(): void;
  /** Shows another one of the certified ways. */
  choose(index: number): void;
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
  /** The address of the decision sheet. */
  decision: string;
  search: Search;
  /** Which of the certified ways is shown, and what is known of others. */
  chosen: number;
  others: "unasked" | "waiting" | "asked" | { failed: string };
  about: About;
}

const ways = "Lawful turns and one-way roads considered; traffic is not.";
const longer = "Looking for a route under conditions, which may take a minute …";

export class RoutePanel {
  readonly element: HTMLElement;
  readonly #heading = h("h2", {});
  readonly #content = h("div", { class: "route-content" });
  #list: NumberedList | null = null;

  /** `trip` are the fields of the places, which stay while the answer changes. */
  constructor(private readonly actions: Actions, trip: HTMLElement) {
    this.element = h("div", { class: "route" }, this.#heading, trip, this.#content);
  }

  waiting(places: Places): void {
    const empty = places.indexOf(null);
    const where = empty === 0 ? "where it begins" : empty === places.length - 1 ? "where it is to go" : "through what place it leads";
    const text = empty < 0 ? "Searching, and certifying the whole way …" : `Click on the map ${where}, or type it above.`;
    this.#list = null;
    this.#put("Certified route", h("p", { class: empty < 0 ? "waiting" : "prompt", role: "status" }, text), empty < 0 ? null : byKeyboard());
  }

  #put(heading: string, ...content: (Node | null)[]): void {
    this.#heading.textContent = heading;
    this.#content.replaceChildren(...content.filter((node) => node !== null));
  }

  /** No place for a certified route is near, and the search for one under conditions is under way. */
  searching(): void {
    this.#put("No certified route", h("p", { class: "waiting", role: "status" }, longer));
  }

  /** `offer` takes the nearest certified road in place of one that is too far away. */
  failed(message: string, offer: { text: string; take(): void } | null): void {
    this.#put("No route", h("p", { class: "problem", role: "alert" }, message), offer && h("button", { class: "primary offer", type: "button", onclick: offer.take }, offer.text));
  }

  show(answer: RouteAnswer, items: readonly Item[], around: Around): void {
    const best = answer.routes[around.chosen];
    this.#list = best ? null : new NumberedList(answer.conditional ? "condition" : "obstacle", items, this.actions);
    const [heading, ...content] = best
      ? this.#found(best, answer, around)
      : answer.conditional
        ? this.#conditional(answer.conditional, around)
        : this.#blocked(answer, around.search);
    const same = h("details", { class: "command" }, h("summary", {}, "The same on the command line"), h("code", {}, around.command));
    const clear = h("button", { class: "small", type: "button", onclick: () => this.actions.clear() }, "New route");
    // While conditions are looked for, nothing is decided. The sheet is that of the first way.
    const decided = around.search !== "searching" && around.chosen === 0;
    const decision = h("a", { class: "button small", href: around.decision, target: "_blank", rel: "noopener" }, icon("sheet"), "Decision sheet");
    this.#put(heading, ...content, ...away(answer), same, h("div", { class: "tools" }, clear, decided ? decision : null));
  }

  /** Shows which line belongs to the chosen pin. */
  mark(number: number | null): void {
    this.#list?.mark(number);
  }

  #found(route: Route, { routes }: RouteAnswer, { palette, chosen, others, about }: Around): [string, ...Node[]] {
    const go = h("button", { class: "primary", type: "button", onclick: () => this.actions.drive() }, icon("play"), "Drive it");
    const fact = (name: string, value: string) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
    const tolerance = route.shrink < 1 ? `With ${(100 * route.shrink).toFixed(0)} % of the tracking tolerance. ` : "";
    const where = route.limiting_at ? ` on ${route.limiting_at}` : "";
    return [
      "Certified as a whole",
      h(
        "div",
        { class: "verdict is-safe" },
        h("span", { class: "badge" }, h("i", { class: "line line-safe" }), "Certified"),
        h("strong", {}, margin(route.rsc_m)),
      ),
      h("p", { class: "headline-words" }, `Tightest after ${distance(route.limiting_s_m)}${where}: ${route.limiting_unit_name ?? "a unit"}, ${route.limiting_side} side.`),
      ...this.#uses(route.uses),
      go,
      ...this.#others(routes, chosen, others),
      takeAlong(route, about),
      h("dl", { class: "facts columns" }, fact("Length", distance(route.length_m)), fact("Time", duration(route.time_s)), fact("Hinges", `${(Math.floor(route.hinge_margin_deg * 10) / 10).toFixed(1)}° left`)),
      h("h3", {}, "Along the way"),
      this.#parts(route.parts, palette, (part) => this.actions.seek(part.from_m)),
      h("p", { class: "scope" }, `${tolerance}Proved from end to end within the stated model, widths and error bounds; no permit. ${ways}`),
    ];
  }

  /** Where the vehicle may use more than its own lane. Whoever reads of the oncoming lane reads what that asks for. */
  #uses(uses: readonly StripUse[]): Node[] {
    if (uses.length === 0) return [];
    const rows = uses.map((used) => {
      const where = used.where === "turn" ? "at the turn" : `${used.side} side`;
      const words = `${used.what}, ${distance(used.to_m - used.from_m)}, at most ${length(Math.ceil(used.beyond_m * 100) / 100)} over the line, ${where}`;
      return h("li", {}, h("button", { type: "button", onclick: () => this.actions.seek(used.from_m) }, h("b", {}, used.title), h("span", {}, words)));
    });
    const oncoming = uses.some(({ strip }) => strip === "carriageway");
    return [
      h("h3", {}, "Beyond its own lane"),
      h("ol", { class: "uses" }, ...rows),
      ...(oncoming ? [h("p", { class: "note" }, "Oncoming traffic must be held back where the dashes are inside the line. Nothing here says that it is.")] : []),
    ];
  }

  /** A button that asks for other certified ways, then a choice among them. */
  #others(routes: readonly Route[], chosen: number, others: Around["others"]): Node[] {
    if (others === "waiting") return [h("p", { class: "waiting", role: "status" }, "Looking for other certified ways …")];
    if (typeof others === "object") return [h("p", { class: "note", role: "alert" }, `No other way was found: ${others.failed}`)];
    if (others === "unasked") return [h("button", { class: "small others", type: "button", onclick: () => this.actions.others() }, icon("route"), "Other certified ways")];
    if (routes.length < 2) return [h("p", { class: "note", role: "status" }, "No other certified way differs enough from this one.")];
    const rows = routes.map((one, index) => {
      const words = `${distance(one.length_m)} · ${duration(one.time_s)} · ${margin(one.rsc_m)}`;
      return h("button", { class: "other-way", type: "button", "aria-pressed": String(index === chosen), onclick: () => this.actions.choose(index) }, h("b", {}, String(index + 1)), words);
    });
    return [h("div", { class: "other-ways", role: "group", "aria-label": "Certified ways" }, ...rows)];
  }

  #conditional(route: ConditionalRoute, { palette, sheet }: Around): [string, ...Node[]] {
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

  #blocked(answer: RouteAnswer, search: Search): [string, ...Node[]] {
    if (answer.obstacles === null) {
      return ["No route", h("p", { class: "headline-words" }, `No roads lead there at all. ${ways}`)];
    }
    const count = answer.obstacles.length;
    const what = count === 1 ? "one place is not certified for this vehicle" : `${count} places are not certified for this vehicle`;
    return [
      "No certified route",
      h(
        "div",
        { class: "verdict is-blocked" },
        h("span", { class: "badge" }, h("i", { class: "line line-blocked" }), "Blocked"),
      ),
      searchWords(search, answer),
      h("p", { class: "headline-words" }, `Even on the easiest way ${what}: ${reasons(answer.obstacles)}. It is the dotted line on the map.`),
      this.#list!.element,
      h("p", { class: "scope" }, `Each of them would have to be certified first. ${answer.gave_up ? "The search was given up before all ways were tried. " : ""}${ways}`),
    ];
  }
}

/** What the mouse does on the map, for the keyboard. */
function byKeyboard(): HTMLElement {
  return h("p", { class: "note" }, "By keyboard: go to the map with the Tab key, move it with the arrows, and press Enter to take the place under the cross.");
}

/** So many places are named at most that no condition opens. */
const MOST_HOPELESS = 5;

/** What became of the search for a route under conditions. */
function searchWords(search: Search, { nothing_helps: hopeless }: RouteAnswer): Node {
  if (search === "searching") return h("p", { class: "waiting", role: "status" }, longer);
  if (search === "none") {
    const places = [...new Set(hopeless.map(({ title }) => title))].slice(0, MOST_HOPELESS).join("; ");
    const what = places ? `no kerb radius, width or paving that was tried opens ${places}` : "on every way that was tried something decides that no measurement helps";
    return h("p", { class: "note" }, `Nor is there a route under conditions: ${what}.`);
  }
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

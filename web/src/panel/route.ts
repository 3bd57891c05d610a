// A certified route between two places, or what blocks it.

import type { Obstacle, Route, RouteAnswer, RoutePart } from "../api/types.ts";
import { marginColour, type Palette } from "../map/palette.ts";
import { h, styled } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { careful, distance, duration, margin, reasonWords, signed } from "../words.ts";

/** The functions of the page that the panel uses. */
export interface Actions {
  drive(): void;
  seek(s: number): void;
  select(id: string | null, place: [number, number] | null): void;
  swap(): void;
  clear(): void;
}

const ways = "Lawful turns and one-way roads considered; traffic is not.";

export class RoutePanel {
  readonly element = h("div", { class: "route" });

  constructor(private readonly actions: Actions) {}

  waiting(chosen: number): void {
    const text = ["Click on the map where it begins.", "Now click where it is to go."][chosen] ?? "Searching, and certifying the whole way …";
    this.element.replaceChildren(h("h2", {}, "Certified route"), h("p", { class: chosen < 2 ? "prompt" : "waiting", role: "status" }, text), this.#tools(false));
  }

  failed(message: string): void {
    this.element.replaceChildren(h("h2", {}, "No route"), h("p", { class: "problem", role: "alert" }, message), this.#tools(true));
  }

  show(answer: RouteAnswer, palette: Palette, command: string): void {
    const best = answer.routes[0];
    const content = best ? this.#found(best, palette) : this.#blocked(answer);
    const same = h("details", { class: "command" }, h("summary", {}, "The same on the command line"), h("code", {}, command));
    this.element.replaceChildren(...content, ...away(answer), same, this.#tools(true));
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
      this.#parts(route.parts, palette),
      h("p", { class: "scope" }, `${tolerance}Proved from end to end within the stated model, widths and error bounds; no permit. ${ways}`),
    ];
  }

  #parts(parts: RoutePart[], palette: Palette): HTMLElement {
    const rows = merged(parts).map((part) => {
      const rsc = part.rsc_m > 100 ? "" : signed(part.rsc_m);
      const colour = styled(h("i", { class: "dot" }), { background: marginColour(palette, part.rsc_m) });
      return h(
        "li",
        {},
        h(
          "button",
          { type: "button", onclick: () => this.actions.seek(part.from_m) },
          colour,
          h("span", { class: part.kind === "turn" ? "part is-turn" : "part" }, part.title),
          h("span", { class: "part-length" }, distance(part.to_m - part.from_m)),
          h("span", { class: "part-rsc" }, rsc),
        ),
      );
    });
    return h("ol", { class: "parts" }, ...rows);
  }

  #blocked(answer: RouteAnswer): Node[] {
    if (answer.obstacles === null) {
      return [h("h2", {}, "No route"), h("p", { class: "headline-words" }, `No roads lead there at all. ${ways}`)];
    }
    const count = answer.obstacles.length;
    const what = count === 1 ? "one place is not certified for this vehicle" : `${count} places are not certified for this vehicle`;
    return [
      h("h2", {}, "No certified route"),
      h("p", { class: "headline-words" }, `Even on the easiest way ${what}: ${reasons(answer.obstacles)}. See the map.`),
      h("ol", { class: "parts" }, ...grouped(answer.obstacles).map((group) => this.#obstacle(group))),
      h("p", { class: "scope" }, `Each of them would have to be certified first. ${answer.gave_up ? "The search was given up before all ways were tried. " : ""}${ways}`),
    ];
  }

  /** A group of successive obstacles on one road, shown by the worst of them. */
  #obstacle(group: Obstacle[]): HTMLElement {
    const short = ({ rsc_m }: Obstacle): number => (rsc_m !== null && rsc_m > -100 ? Math.min(rsc_m, 0) : 0);
    const obstacle = group.reduce((worst, one) => (short(one) < short(worst) ? one : worst));
    const most = group.length > 1 ? "up to " : "";
    const missing = short(obstacle) < 0 ? `${most}${careful(short(obstacle))} m missing` : "";
    const places = group.length > 1 ? `${group.length} places · ` : "";
    const why = places + whyNot(obstacle);
    const select = () => this.actions.select(obstacle.edge_id ?? null, obstacle.place);
    return h(
      "li",
      {},
      h(
        "button",
        { type: "button", onclick: select },
        h("i", { class: `line line-${obstacle.verdict === "refuted" ? "unsafe" : obstacle.verdict}` }),
        h("span", { class: obstacle.kind === "turn" ? "part is-turn" : "part" }, obstacle.title.replace(/^(.+) into \1$/, "Turn on $1")),
        h("span", { class: "part-length" }, why),
        h("span", { class: "part-rsc" }, missing),
      ),
    );
  }
}

function whyNot({ verdict, reason }: Obstacle): string {
  return verdict === "refuted" ? "Fails as part of the whole" : reasonWords(verdict, reason);
}

/** `too narrow (31), no access (2)`, the most frequent first. */
function reasons(obstacles: Obstacle[]): string {
  const counts = new Map<string, number>();
  for (const obstacle of obstacles) counts.set(whyNot(obstacle), (counts.get(whyNot(obstacle)) ?? 0) + 1);
  const sorted = [...counts].sort((a, b) => b[1] - a[1]);
  return sorted.map(([why, count]) => `${why.charAt(0).toLowerCase()}${why.slice(1)} (${count})`).join(", ");
}

/** Groups successive edges of one road that fail for the same reason. */
function grouped(obstacles: Obstacle[]): Obstacle[][] {
  const groups: Obstacle[][] = [];
  for (const obstacle of obstacles) {
    const last = groups.at(-1)?.[0];
    const same = last && last.kind === "edge" && obstacle.kind === "edge" && last.title === obstacle.title && whyNot(last) === whyNot(obstacle);
    if (same) groups.at(-1)!.push(obstacle);
    else groups.push([obstacle]);
  }
  return groups;
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

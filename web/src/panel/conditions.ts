// A route under conditions, in words that nobody can take for a certificate: what has to be so, and sheets to take along.

import type { Condition, ConditionalRoute, RoutePart } from "../api/types.ts";
import { h } from "../ui/dom.ts";
import { icon } from "../ui/icons.ts";
import { distance, length, spoken } from "../units.ts";
import { careful, duration } from "../words.ts";
import { along } from "./along.ts";
import type { Item } from "./numbered.ts";

const quantities: Record<Condition["kind"], string> = {
  kerb_radius: "Kerb radius",
  surface: "Paved, without kerbs and islands,",
  lane_width: "Lane",
  direction_width: "Lanes of this direction",
  carriageway_width: "Road",
};

/** `Kerb radius at least 7.50 m` */
function words({ kind, needed }: Condition): string {
  if (kind === "surface") return `${quantities.surface} up to ${spoken() === "metres" ? `${Math.ceil(needed - 1e-6)} m` : length(needed, "up")} from the node`;
  return `${quantities[kind]} at least ${length(needed, "up")}${kind === "kerb_radius" ? "" : " wide"}`;
}

export function conditionItems(route: ConditionalRoute): Item[] {
  return route.conditions.map((condition) => {
    const { number, place, title, assumed, length_m, attested } = condition;
    const more = [
      assumed === null ? "" : `assumed ${length(assumed)}`,
      length_m ? `over ${distance(length_m)}` : "",
      attested ? `attested, not proved: ${attested.name ? `${attested.name} (${attested.tags})` : "the register knows this vehicle to go here"}` : "",
    ];
    return { number, place, title, what: words(condition), more: more.filter(Boolean).join(" · "), road: roadOf(route, condition) };
  });
}

/** The edge or turn that needs the condition. A junction is needed by the turn of the route that is nearest to it. */
function roadOf(route: ConditionalRoute, { edge_id, from_edge, to_edge, place }: Condition): Item["road"] {
  if (edge_id) return { edge: edge_id };
  if (from_edge && to_edge) return { from: from_edge, to: to_edge };
  const far = (part: RoutePart): number => {
    const [lon, lat] = along(route, (part.from_m + part.to_m) / 2);
    return place ? Math.hypot((lon - place[0]) * Math.cos((lat * Math.PI) / 180), lat - place[1]) : Infinity;
  };
  const turns = route.parts.filter((part) => part.from_edge && part.to_edge);
  const nearest = turns.reduce<RoutePart | null>((best, one) => (best && far(best) <= far(one) ? best : one), null);
  return nearest?.from_edge && nearest.to_edge ? { from: nearest.from_edge, to: nearest.to_edge } : null;
}

/** `3 conditions hold` */
const hold = (count: number): string => (count === 1 ? "one condition holds" : `${count} conditions hold`);

/** The head of the panel: the badge, and what the route is not. */
export function conditionalHead(route: ConditionalRoute): [string, ...Node[]] {
  const count = route.conditions.length;
  return [
    "Route under conditions",
    h(
      "div",
      { class: "verdict is-conditional" },
      h("span", { class: "badge" }, h("i", { class: "line line-conditional" }), `Only if ${hold(count)}`),
    ),
    h(
      "p",
      { class: "headline-words" },
      `No route is certified. This one would be, if ${count === 1 ? "the following" : "all of the following"} were so on site. Nothing here says that it is.`,
    ),
    ...(route.conditions_attested
      ? [h("p", { class: "headline-words" }, "Each place is attested: the law or the register says that such a vehicle goes there. That is no proof.")]
      : []),
    ...(route.conditions_suffice
      ? []
      : [h("p", { class: "headline-words" }, "Measured exactly so, it may still ask for more. Measure more room where there is some.")]),
  ];
}

/** Links to the sheets, the numbers, and the scope. `sheet` gives the address of a form. */
export function conditionalFoot(route: ConditionalRoute, sheet: (form: "html" | "csv" | "geojson") => string): Node[] {
  const take = (form: "csv" | "geojson", name: string) => h("a", { class: "button small", href: sheet(form), download: `conditions.${form}` }, name);
  const fact = (name: string, value: string) => h("div", {}, h("dt", {}, name), h("dd", {}, value));
  return [
    h(
      "div",
      { class: "tools sheets" },
      h("a", { class: "button primary", href: sheet("html"), target: "_blank", rel: "noopener" }, icon("sheet"), "Print the sheet"),
      take("csv", "CSV"),
      take("geojson", "GeoJSON"),
    ),
    h(
      "dl",
      { class: "facts columns" },
      fact("Length", distance(route.length_m)),
      fact("Time", duration(route.time_s)),
      fact("Room then", careful(route.rsc_m)),
    ),
    h(
      "p",
      { class: "scope" },
      "Measure, fill in the sheet, and give it to netcert evidence add: then ask again. Under all conditions the whole way has one certificate, within the stated model, widths and error bounds. Without them it has none; no permit.",
    ),
  ];
}

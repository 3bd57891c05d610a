// What the shapes of an explanation on the map mean.

import type { Part, ShapeProperties, Shapes } from "../api/types.ts";
import { h, styled } from "../ui/dom.ts";
import { margin } from "../words.ts";

/** The key of the shapes that are drawn, or nothing if there are none. */
export function mapKey(shapes: Shapes): HTMLElement[] {
  const all = shapes.features.map(({ properties }) => properties);
  const has = (part: Part): boolean => all.some((one) => one.part === part);
  const turn = all.some((one) => one.turn_id);
  const items: (HTMLElement | null)[] = [
    has("area") ? item("is-ground", "The road that this turn may use") : null,
    has("strip") && !turn ? item("is-ground", "The strip that the vehicle may use") : null,
    has("beyond") ? item("is-beyond", "Straight road that the certificate assumes where the road ends") : null,
    ...all.filter((one) => one.part === "swept").map((one) => swept(one)),
    has("body") ? item("is-body", moment(has("hinge"))) : null,
    has("path") ? item("is-path", "Planned path of the steer axle") : null,
    has("hinge") ? item("is-tightest", "The hinge or steering that decides") : null,
    has("tightest") && !has("hinge") ? item("is-tightest", "The place with the least room") : null,
    has("line") ? item("is-beyond", "The line on the map: there is no corridor to draw") : null,
  ];
  const drawn = items.filter((one): one is HTMLElement => one !== null);
  return drawn.length === 0 ? [] : [h("h3", {}, "On the map"), h("ul", {}, ...drawn)];
}

function moment(hinge: boolean): string {
  return hinge ? "The vehicle where its hinge or steering decides" : "The vehicle where it has the least room";
}

function swept({ unit = 0, unit_name }: ShapeProperties): HTMLElement {
  const made = item("is-swept", `Ground that the ${unit_name ?? "unit"} sweeps, driven exactly as planned`);
  styled(made.firstElementChild as HTMLElement, { "--own": `var(--unit-${unit})` });
  return made;
}

function item(kind: string, text: string): HTMLElement {
  return h("li", {}, h("i", { class: kind, "aria-hidden": "true" }), text);
}

/** The shapes with a label at the place that decides. */
export function labelled(shapes: Shapes): Shapes {
  const features = shapes.features.map((feature) => ({ ...feature, properties: { ...feature.properties, label: label(feature.properties) } }));
  return { ...shapes, features };
}

function label({ part, unit_name, side, rsc_m, margin_deg }: ShapeProperties): string {
  const unit = unit_name ?? "unit";
  if (part === "tightest") return `${margin(rsc_m ?? -Infinity)}: ${unit}, ${side ?? ""} side`;
  if (part !== "hinge") return "";
  if (margin_deg === null || margin_deg === undefined) return `turns too sharply: ${unit}`;
  return `${(Math.ceil(-margin_deg * 10 - 1e-6) / 10).toFixed(1)}° too far: ${unit}`;
}

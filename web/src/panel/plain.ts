// An explanation in plain words: one sentence on what happens, and what would help. The server's own sentences, which name every bound,
// stand under "Details".

import type { Explanation, Limiting, Policy } from "../api/types.ts";
import { length } from "../units.ts";

const strips: Record<Policy, { the: string; a: string }> = {
  lane: { the: "the lane", a: "a lane" },
  direction: { the: "the lanes of its direction", a: "a strip for this direction" },
  carriageway: { the: "the road", a: "a road" },
};

/** `the semi-trailer's rear right corner` */
function part({ unit_name, part: which, side, ahead_of_axle_m: ahead }: Limiting): string {
  const unit = `the ${unit_name ?? "vehicle"}’s`;
  if (which === "front_corner") return `${unit} front ${side} corner`;
  if (which === "rear_corner") return `${unit} rear ${side} corner`;
  if (which === "axle" || (ahead !== null && Math.abs(ahead) < 0.5)) return `${unit} ${side} wheels`;
  return `${unit} ${side} side`;
}

function capital(text: string): string {
  return `${text.charAt(0).toUpperCase()}${text.slice(1)}`;
}

/** The server's headline without the verdict, which the badge shows already. */
export function headline({ headline: text }: Explanation): string {
  return `${capital(text.replace(/^(safe|unsafe|forbidden|unknown): /, ""))}.`;
}

/** The first sentence. Where no bound or no room decides, it is the server's. */
export function sentence(e: Explanation, policy: Policy): string {
  const { limiting } = e;
  const rsc_m = limiting?.rsc_m ?? null;
  if (!limiting || rsc_m === null || rsc_m <= -100) return headline(e);
  const { the } = strips[policy];
  const who = part(limiting.place);
  const edge = e.kind === "turn" ? `the edge of ${limiting.place.width_m === null ? "the junction" : the}` : `the edge of ${the}`;
  if (e.verdict === "safe") return `It fits: where it is tightest, ${who} stay${who.endsWith("wheels") ? "" : "s"} ${length(rsc_m, "down")} inside ${edge}, with every error at its bound.`;
  if (e.verdict !== "unsafe" || e.reason !== "width") return headline(e);
  const [help] = remedies(e, policy);
  return `${capital(who)} would cross ${edge} by up to ${length(-rsc_m, "up")}${help ? `; ${help} would do` : ""}.`;
}

/** What would be enough, in plain words, the most telling first. */
function remedies({ hints, verdict, suppose }: Explanation, policy: Policy): string[] {
  if (verdict !== "unsafe") return [];
  // The need in the database holds along the whole road; the hint is for this piece of it alone.
  const need = suppose && suppose.quantity !== "kerb_radius" ? suppose.need : null;
  const width_m = Math.max(need ?? 0, hints.width_m ?? 0) || null;
  const { kerb_radius_m, hinge_limit_deg, shorter_vehicle: shorter } = hints;
  return [
    width_m === null ? null : `${strips[policy].a} nowhere narrower than ${length(width_m, "up")}`,
    kerb_radius_m === null ? null : `a kerb radius of at least ${length(kerb_radius_m, "up")}`,
    hinge_limit_deg === null ? null : `a hinge or steering that turns to ${hinge_limit_deg.toFixed(1)}°`,
    shorter ? `the shorter vehicle ${shorter.id} (${length(shorter.length_m)})` : null,
  ].filter((one) => one !== null);
}

/** What would do beside what the first sentence says, and what wider strips of the same road come to. */
export function help(e: Explanation, policy: Policy): string[] {
  const all = remedies(e, policy);
  const said = e.reason === "width" && e.limiting?.rsc_m !== null ? all.slice(1) : all;
  const strip = (one: Explanation["hints"]["other_strips"][number]): string => {
    const { the } = strips[one.corridor];
    if (one.safe && one.rsc_m !== null) return `If it may use the whole of ${the}, it fits: ${length(one.rsc_m, "down")} to spare.`;
    const missing = one.rsc_m !== null && one.rsc_m < 0 && one.rsc_m > -100 ? `${length(-one.rsc_m, "up")} are missing` : "a hinge turns too far";
    return `Even the whole of ${the} is not enough: ${missing}.`;
  };
  return [...said.map((one) => `${capital(one)} would do.`), ...(e.verdict === "unsafe" ? e.hints.other_strips.map(strip) : [])];
}

// The words of the page: names for identifiers, and numbers rounded to the cautious side.
//
// `safe` is an identifier of the database. The page says "certified" and shows the scope, or shows a sentence of the server that
// has its scope.

import type { ChangeName, Changed, Evidence, Policy, Standing, VerdictName } from "./api/types.ts";
import { length, roadLength } from "./units.ts";

export const VERDICTS: readonly VerdictName[] = ["safe", "unsafe", "forbidden", "unknown"];
export const EVIDENCE: readonly Evidence[] = ["assumed", "from_lanes", "estimated", "tagged", "surveyed"];
/** The strips from narrow to wide. */
export const POLICIES: readonly Policy[] = ["lane", "direction", "carriageway"];
export const CLASSES: readonly string[] = [
  "motorway",
  "trunk",
  "primary",
  "secondary",
  "tertiary",
  "unclassified",
  "residential",
  "living_street",
  "service",
  "track",
  "busway",
];

export const verdictWords: Record<VerdictName, { name: string; meaning: string }> = {
  safe: { name: "Certified", meaning: "proved to fit, within the stated model, widths and error bounds" },
  unsafe: { name: "Not certified", meaning: "not proved: too narrow, or a hinge or the steering beyond its limit" },
  forbidden: { name: "Forbidden", meaning: "a tagged limit, access rule or barrier excludes it" },
  unknown: { name: "Unknown", meaning: "nothing can be said: no width, broken geometry, an unreadable limit" },
};

/** What a striped certified line means. */
export const SHARED_LANE = "Certified on the whole road: oncoming traffic waits";

/** What the line of a route stands for, by its kind. */
export const routeWords: Record<"certified" | "oncoming" | "conditional" | "blocked", string> = {
  certified: "Certified as a whole",
  oncoming: "Certified, with the oncoming lane",
  conditional: "Only under conditions: not certified",
  blocked: "Blocked: what stands in its way",
};

/** The changes since the older database, in the order of the legend. */
export const CHANGES: readonly ChangeName[] = ["became_safe", "became_conditional", "became_unsafe", "became_forbidden", "became_unknown", "appeared", "went"];

export const changeWords: Record<ChangeName, { name: string; meaning: string }> = {
  became_safe: { name: "Now certified", meaning: "it was not certified before" },
  became_conditional: { name: "Now only under conditions", meaning: "not certified: it lacks room, and it is known how much more would do" },
  became_unsafe: { name: "Now not certified", meaning: "too narrow, or a hinge or the steering beyond its limit" },
  became_forbidden: { name: "Now forbidden", meaning: "a tagged limit, access rule or barrier excludes the vehicle" },
  became_unknown: { name: "Now unknown", meaning: "nothing can be said any more" },
  appeared: { name: "New on the map", meaning: "the older database does not have it" },
  went: { name: "Gone from the map", meaning: "the newer database does not have it" },
};

export const standingWords: Record<Standing, string> = {
  safe: "Certified",
  conditional: "Only under conditions",
  unsafe: "Not certified",
  forbidden: "Forbidden",
  unknown: "Unknown",
};

/** One side of a change, with its reason: `Forbidden: weight limit`. */
export function sideWords(changed: Changed, side: "before" | "after"): string {
  const standing = changed[side];
  if (standing === null) return side === "before" ? "Not in the older database" : "Not in the newer database";
  const verdict = standing === "conditional" ? "unsafe" : standing;
  const reason = changed[`${side}_reason`];
  const rsc_m = changed[`${side}_rsc_m`];
  const need_m = changed[`${side}_need_width_m`];
  const width_m = changed[`${side}_width_m`];
  const why = reason ? reasonWords(verdict, reason) : null;
  const measured = verdict === "safe" || (verdict === "unsafe" && reason === "width");
  const room = measured && rsc_m !== null ? margin(rsc_m) : null;
  const first = [standingWords[standing], why ? lower(why) : room].filter(Boolean).join(": ");
  const more = [why ? room : null, width_m === null ? null : `${length(width_m)} wide`, need_m === null ? null : `about ${length(need_m, "up")} would do`];
  return [first, ...more].filter(Boolean).join(", ");
}

function lower(text: string): string {
  return text.charAt(0).toLowerCase() + text.slice(1);
}

export const policyWords: Record<Policy, { name: string; meaning: string }> = {
  lane: {
    name: "Own lane",
    meaning:
      "Every part of the vehicle stays in its own lane. On a two-way road without lanes, it may use the whole road: oncoming traffic has to wait.",
  },
  direction: { name: "Own direction", meaning: "It may use all lanes of its own direction." },
  carriageway: { name: "Whole road", meaning: "It may use all that is paved: oncoming traffic has to wait." },
};

/** The narrowest certified strip in the legend; `none`: no strip is certified. */
export const stripWords: Record<Policy | "none", string> = {
  lane: "Own lane",
  direction: "Own direction: other lanes, too",
  carriageway: "Whole road: oncoming traffic may wait",
  none: "None, or forbidden, or unknown",
};

/** The narrowest certified strip of one road or turn. */
export const usesWords: Record<Policy, string> = {
  lane: "Certified in its own lane",
  direction: "Certified with other lanes of its direction",
  carriageway: "Certified on the whole road",
};

/** What somebody measures. */
export const quantityWords: Record<string, string> = {
  carriageway_width: "Width of the road",
  direction_width: "Width of the lanes of this direction",
  lane_width: "Width of the lane",
  kerb_radius: "Kerb radius",
  max_height: "Height limit",
  max_weight: "Weight limit",
  surface: "Paved surface",
};

export const evidenceWords: Record<Evidence | "none", string> = {
  none: "No width",
  assumed: "Assumed from class",
  from_lanes: "From number of lanes",
  estimated: "Tagged as estimated",
  tagged: "Tagged",
  surveyed: "Surveyed",
};

const reasons: Record<string, string> = {
  "unsafe/width": "Too narrow",
  "unsafe/articulation": "Hinge beyond its limit",
  "unsafe/steering_lock": "Steering lock",
  "forbidden/height": "Height limit",
  "forbidden/weight": "Weight limit",
  "forbidden/axle_load": "Axle load limit",
  "forbidden/length": "Length limit",
  "forbidden/width": "Width limit",
  "forbidden/hgv": "No heavy vehicles",
  "forbidden/access": "No access",
  "forbidden/barrier": "Barrier",
  "forbidden/restriction": "Turn restriction",
  "forbidden/oneway": "One-way for this vehicle",
  "forbidden/axles": "Too many axles",
  "forbidden/trailers": "Too many trailers",
  "forbidden/class": "Not for this kind of vehicle",
  "unknown/width": "No usable width",
  "unknown/geometry": "Broken geometry",
  "unknown/cut": "Edge of the extract",
  "unknown/limit": "Unreadable limit",
  "unknown/failed": "Machine failed",
  "unknown/time": "Closed at some times",
  "unknown/rule": "Rule not understood",
  "unknown/took_too_long": "Took too long",
};

export function reasonWords(verdict: string, reason: string | null | undefined): string {
  if (!reason) return verdictWords[verdict as VerdictName]?.name ?? verdict;
  return reasons[`${verdict}/${reason}`] ?? reason.replaceAll("_", " ");
}

/** `living_street` → `Living street`. */
export function className(highway: string): string {
  const text = highway.replaceAll("_", " ");
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** `motorway_link` belongs with `motorway`. */
export function mainClass(highway: string): string {
  return highway.replace(/_link$/, "");
}

/** The numbers of a road: `I 405;US 30` is two. */
export function refs(ref: string | null | undefined): string[] {
  return (ref ?? "").split(";").map((one) => one.trim()).filter(Boolean);
}

export function title(road: { ref?: string | null; name?: string | null; highway?: string | null; way_id?: unknown }): string {
  const texts = [refs(road.ref).join(" / "), road.name].filter(Boolean);
  if (texts.length > 0) return texts.join(" · ");
  return road.highway ? `Unnamed ${className(road.highway).toLowerCase()}` : "Unnamed road";
}

/** Below this leeway, metres, no missing width is named, because no useful bound holds. */
const FAR_M = -100;

/** Room to spare or missing, cautiously rounded: `0.31 m to spare`, `0.42 m missing`. */
export function margin(rsc_m: number): string {
  if (rsc_m <= FAR_M) return "far too narrow";
  return rsc_m < 0 ? `${careful(rsc_m)} missing` : `${careful(rsc_m)} to spare`;
}

/** The margin of an overview's road. Its tiles have quarters of a metre, rounded down, from −1.25 m to 1 m. */
export function leastMargin(rsc_m: number): string {
  if (rsc_m < -1) return `more than ${length(1, "down")} missing`;
  return rsc_m < 0 ? `up to ${careful(rsc_m)} missing` : `${careful(rsc_m)} or more to spare`;
}

/** The amount alone. Room to spare is rounded down, missing room is rounded up. */
export function careful(rsc_m: number): string {
  return length(Math.abs(rsc_m), rsc_m < 0 ? "up" : "down");
}

export function signed(rsc_m: number): string {
  return `${rsc_m < 0 ? "−" : "+"}${careful(rsc_m)}`;
}

/** `547 km certified, 23 %` */
export function certifiedWords(lengths: Record<VerdictName, number>): string {
  const all = VERDICTS.reduce((sum, name) => sum + lengths[name], 0);
  return `${roadLength(lengths.safe)} certified, ${percent(lengths.safe, all)}`;
}

/** A share in whole per cent; below 10 % with a decimal. */
export function percent(part: number, all: number): string {
  if (all <= 0 || part <= 0) return "0 %";
  const share = (100 * part) / all;
  // What is not whole must not read as whole.
  if (share >= 99.5 && part < all * (1 - 1e-9)) return "> 99 %";
  return share < 0.1 ? "< 0.1 %" : `${share.toFixed(share < 10 ? 1 : 0)} %`;
}

export function duration(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  const rest = Math.floor(seconds % 60);
  return minutes >= 60
    ? `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, "0")} min`
    : `${minutes}:${String(rest).padStart(2, "0")} min`;
}

/** The name of an extract's file as a title: `columbus_oh_us` → `Columbus OH US`. */
export function regionName(name: string): string {
  const words = name.split(/[_\s]+/).filter(Boolean);
  const short = (word: string): boolean => word.length === 2;
  return words.map((word) => (short(word) ? word.toUpperCase() : word.charAt(0).toUpperCase() + word.slice(1))).join(" ");
}

// The state as the part of a link behind `#`. Values that are as at the beginning are left out, so that links are short.
//
// A link may come from anywhere. What cannot be read is ignored, and what the database does not have is replaced by a default.

import type { AtMost, Evidence, Policy, Position, VerdictName } from "./api/types.ts";
import { MOST_VIA, UNPLACED, type Camera, type ColourBy, type Places, type State } from "./state.ts";
import { UNITS } from "./units.ts";
import { CLASSES, EVIDENCE, VERDICTS } from "./words.ts";

export interface Possible {
  vehicles: readonly string[];
  policies: readonly Policy[];
  /** Whether there is an older database. */
  changes: boolean;
}

const COLOURINGS: readonly ColourBy[] = ["margin", "reason", "evidence", "strip"];

export function write(state: State, first: State): string {
  const parts = new URLSearchParams();
  const put = (key: string, value: string | null): void => {
    if (value) parts.set(key, value);
  };
  parts.set("v", state.vehicle);
  if (state.policy !== first.policy) parts.set("policy", state.policy);
  put("with", state.other);
  if (state.colourBy !== "margin") parts.set("by", state.colourBy);
  put("hide", [...state.hidden].join(","));
  put("without", [...state.hiddenClasses].join(","));
  if (state.evidence !== "assumed") parts.set("width", state.evidence);
  put("id", state.selected);
  if (state.route) parts.set("route", state.route.map((place) => (place ? position(place) : "")).join(";"));
  put("most", state.atMost);
  if (state.stats) parts.set("stats", "1");
  if (state.changes) parts.set("changes", "1");
  put("units", state.units);
  if (state.camera) parts.set("at", camera(state.camera));
  // Commas and semicolons need no escape behind `#`, and links without escapes are easier to read.
  return `#${parts.toString().replaceAll("%2C", ",").replaceAll("%3B", ";")}`;
}

export function read(hash: string, first: State, possible: Possible): State {
  const parts = new URLSearchParams(hash.replace(/^#/, ""));
  const get = (key: string): string => parts.get(key) ?? "";
  const vehicle = (id: string): string | null => (possible.vehicles.includes(id) ? id : null);
  const list = (key: string): string[] => get(key).split(",").filter(Boolean);
  return {
    ...first,
    vehicle: vehicle(get("v")) ?? first.vehicle,
    policy: known(possible.policies, get("policy")) ?? first.policy,
    other: vehicle(get("with")),
    colourBy: known(COLOURINGS, get("by")) ?? "margin",
    hidden: new Set(list("hide").filter((name): name is VerdictName => known(VERDICTS, name) !== null)),
    hiddenClasses: new Set(list("without").filter((name) => CLASSES.includes(name))),
    evidence: known<Evidence>(EVIDENCE, get("width")) ?? "assumed",
    selected: /^[0-9]{1,20}$/.test(get("id")) ? get("id") : null,
    route: places(parts.get("route")),
    atMost: known<AtMost>([...possible.policies, "attested"], get("most")),
    stats: get("stats") === "1",
    changes: possible.changes && get("changes") === "1",
    camera: readCamera(get("at")),
    units: known(UNITS, get("units")) ?? first.units,
  };
}

function known<T extends string>(all: readonly T[], text: string): T | null {
  return all.find((one) => one === text) ?? null;
}

function position([lon, lat]: Position): string {
  return `${lon.toFixed(6)},${lat.toFixed(6)}`;
}

function camera({ lon, lat, zoom }: Camera): string {
  return `${zoom.toFixed(2)},${lat.toFixed(5)},${lon.toFixed(5)}`;
}

function numbers(text: string, count: number): number[] | null {
  // `Number` would turn an empty text into 0.
  const all = text.split(",").map((part) => (part.trim() === "" ? Number.NaN : Number(part)));
  return all.length === count && all.every(Number.isFinite) ? all : null;
}

function onEarth(lon: number, lat: number): boolean {
  return Math.abs(lon) <= 180 && Math.abs(lat) <= 85;
}

/** The places of a route; an empty part is a place that is not chosen yet. */
function places(text: string | null): Places | null {
  if (text === null) return null;
  const parts = text.split(";").slice(0, MOST_VIA + 2);
  const all = parts.map((one): Position | null | undefined => {
    if (one === "") return null;
    const [lon, lat] = numbers(one, 2) ?? [];
    return lon !== undefined && lat !== undefined && onEarth(lon, lat) ? [lon, lat] : undefined;
  });
  const good = all.filter((one): one is Position | null => one !== undefined);
  return good.length === all.length ? [...good, ...UNPLACED.slice(good.length)] : null;
}

function readCamera(text: string): Camera | null {
  const [zoom, lat, lon] = numbers(text, 3) ?? [];
  if (zoom === undefined || lat === undefined || lon === undefined || !onEarth(lon, lat)) return null;
  return { zoom: Math.min(Math.max(zoom, 2), 22), lat, lon };
}

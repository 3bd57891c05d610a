// The server's API with types. Every call can be aborted. A refusal becomes a `ServerProblem` whose message can be shown.

import type {
  AtMost,
  Changes,
  EvidenceChange,
  Explanation,
  Policy,
  Position,
  Problem,
  Region,
  RouteAnswer,
  SearchHit,
  Shapes,
  Supposed,
  StatsRows,
  Vehicle,
  WholeRoad,
} from "./types.ts";
import { patient } from "./patient.ts";
import { digest, type Stats } from "./stats.ts";
import { spoken } from "../units.ts";

export class ServerProblem extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail ?? problem.title);
  }
}

/** Parameters; a list is one that is given several times. */
type Query = Record<string, string | string[]>;

function written(query: Query): string {
  const parts = Object.entries(query).flatMap(([name, value]) => [value].flat().map((one): [string, string] => [name, one]));
  return new URLSearchParams(parts).toString();
}

async function get<T>(path: string, query: Query, signal?: AbortSignal): Promise<T> {
  const parameters = written(query);
  return send<T>(parameters ? `${path}?${parameters}` : path, signal ? { signal } : {});
}

/** What a server answers only if it takes measurements. */
function change<T = EvidenceChange>(method: "POST" | "DELETE", path: string, token: string | null, feature?: object, signal?: AbortSignal): Promise<T> {
  const headers = { ...(feature ? { "content-type": "application/geo+json" } : {}), ...(token ? { authorization: `Bearer ${token}` } : {}) };
  return send<T>(path, { method, headers, ...(feature ? { body: JSON.stringify(feature) } : {}), ...(signal ? { signal } : {}) });
}

async function send<T>(url: string, init: RequestInit): Promise<T> {
  let answer: Response;
  try {
    answer = await patient(url, { ...init, headers: { accept: "application/json", ...init.headers } });
  } catch (error) {
    if (init.signal?.aborted) throw error;
    throw new ServerProblem({ title: "The server does not answer. Is `netcert serve` still running?", status: 0 });
  }
  if (answer.ok) return (await answer.json()) as T;
  const said = (await answer.json().catch(() => null)) as Problem | null;
  throw new ServerProblem(said ?? { title: `The server answered ${answer.status}`, status: answer.status });
}

/** The vehicle and policy of the wanted certificates. */
export interface Question {
  vehicle: string;
  policy: Policy;
}

/** The same for a route. */
export interface RouteQuestion extends Question {
  /** The widest strip that the route may use where that of the policy is not enough; null: none. */
  atMost: AtMost | null;
}

/** The greatest number of changes that the server gives at once. */
export const MOST_CHANGES = 5000;

/** The greatest distance from a clicked place to a usable road, metres. It is large because a click is not exact. */
export const SNAP_M = 500;

/** The greatest number of routes beside the best one that are asked for. */
const MOST_OTHERS = 2;

const place = ([lon, lat]: Position): string => `${lon.toFixed(6)},${lat.toFixed(6)}`;
const asked = ({ vehicle, policy }: Question): Record<string, string> => ({ vehicle, policy });
function ride(places: readonly Position[], question: RouteQuestion): Query {
  const all = places.map(place);
  return { ...asked(question), ...(question.atMost ? { at_most: question.atMost } : {}), from: all[0] ?? "", via: all.slice(1, -1), to: all.at(-1) ?? "", snap: String(SNAP_M) };
}

interface Turn {
  turn_id: string;
  from_edge: string;
  to_edge: string;
}

export const api = {
  region: () => get<Region>("/api/region", {}),
  vehicles: () => get<Vehicle[]>("/api/vehicles", {}),
  search: (q: string, signal?: AbortSignal) => get<SearchHit[]>("/api/search", { q }, signal),
  /** The whole road of a way or road that was found, with a summary of its certificates. */
  wholeRoad: (hit: SearchHit, question: Question, signal?: AbortSignal) =>
    get<WholeRoad>("/api/road", { way: hit.id, ...(hit.by_ref === null ? {} : { ref: hit.by_ref }), ...asked(question) }, signal),
  /** `beside` is a vehicle to compare with. */
  explain: (id: string, question: Question, signal?: AbortSignal, beside?: string) =>
    get<Explanation>(`/api/explain/${encodeURIComponent(id)}`, { ...asked(question), ...(beside ? { relative_to: beside } : {}) }, signal),
  shapes: (id: string, question: Question, signal?: AbortSignal) =>
    get<Shapes>(`/api/explain/${encodeURIComponent(id)}/map.geojson`, asked(question), signal),
  pictureUrl: (id: string, question: Question) =>
    `/api/explain/${encodeURIComponent(id)}/picture.svg?${new URLSearchParams(asked(question))}`,
  suppose: (id: string, metres: number, question: Question, signal?: AbortSignal) =>
    get<Supposed>(`/api/suppose/${encodeURIComponent(id)}`, { ...asked(question), metres: metres.toFixed(2) }, signal),
  /** What a turn would be with a surface, which is not kept. */
  supposeSurface: (id: string, feature: object, question: Question, token: string | null, signal: AbortSignal) =>
    change<Supposed>("POST", `/api/suppose/${encodeURIComponent(id)}?${written(asked(question))}`, token, feature, signal),
  /** Keeps a measurement: a GeoJSON feature as `netcert evidence add` reads it. */
  measure: (feature: object, token: string | null) => change("POST", "/api/evidence", token, feature),
  /** Removes a measurement by its number. */
  forget: (no: number, token: string | null) => change("DELETE", `/api/evidence/${no}`, token),
  /** The id of the turn from one edge into another. Null if there is none. */
  turn: async (from: string, to: string, question: Question, signal?: AbortSignal): Promise<string | null> => {
    const { turns } = await get<{ turns: Turn[] }>(`/api/edges/${encodeURIComponent(from)}`, asked(question), signal);
    return turns.find((turn) => turn.from_edge === from && turn.to_edge === to)?.turn_id ?? null;
  },
  /** `conditions` says whether to look for a route under conditions where none is certified. */
  route: (places: readonly Position[], question: RouteQuestion, conditions: "search" | "none", signal?: AbortSignal) =>
    get<RouteAnswer>("/api/route", { ...ride(places, question), conditions }, signal),
  /** Routes that differ from the best one, after it. Each has its drive. */
  otherRoutes: (places: readonly Position[], question: RouteQuestion, signal?: AbortSignal) =>
    get<RouteAnswer>("/api/route", { ...ride(places, question), conditions: "none", alternatives: String(MOST_OTHERS), drive: "all" }, signal),
  decisionUrl: (places: readonly Position[], question: RouteQuestion) =>
    `/api/decision.html?${written({ ...ride(places, question), ...(spoken() === "feet" ? { units: "feet" } : {}) })}`,
  sheetUrl: (form: "html" | "csv" | "geojson", places: readonly Position[], question: RouteQuestion) =>
    `/api/sheet.${form}?${written({ ...ride(places, question), ...(form === "html" && spoken() === "feet" ? { units: "feet" } : {}) })}`,
  /** What changed since the older database, of the box `west,south,east,north` or everywhere. */
  changes: (question: Question, bbox: string | null, signal?: AbortSignal) =>
    get<Changes>("/api/changes", { ...asked(question), limit: String(MOST_CHANGES), ...(bbox ? { bbox } : {}) }, signal),
  stats: async (policy: Policy, signal?: AbortSignal): Promise<Stats> =>
    digest(await get<StatsRows>("/api/stats", { policy }, signal)),
  tilesPath: ({ tiles }: Region, { vehicle, policy }: Question) =>
    tiles.replace("{policy}", policy).replace("{vehicle}", encodeURIComponent(vehicle)),
};

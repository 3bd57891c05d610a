// The members of the server's answers that the page reads. `/api/openapi.json` describes all members.
//
// Lengths are metres, positions [longitude, latitude] in degrees. Ids of edges and turns are text: they have 63 bits.

export type Policy = "lane" | "direction" | "carriageway";

/** The highest rung of a route: its widest strip, or with conditions only where the vehicle is attested. */
export type AtMost = Policy | "attested";
export type VerdictName = "safe" | "unsafe" | "forbidden" | "unknown";
/** Who may change the register of measurements over the server. */
export type Editing = "off" | "local" | "token";
export type Evidence = "assumed" | "from_lanes" | "estimated" | "tagged" | "surveyed";
export type Position = [lon: number, lat: number];

export interface Region {
  name: string;
  bbox: [west: number, south: number, east: number, north: number];
  /** A box with nearly all roads, because a few roads lead far out of most extracts. */
  focus?: [west: number, south: number, east: number, north: number] | null;
  timestamp: string | null;
  netcert: string;
  database_hash: string;
  attribution: string;
  policies: Policy[];
  default_policy: Policy;
  vehicles_certified: string[];
  scope: string;
  /** Template of the tiles' address, with `{policy}` and `{vehicle}`; it changes when the database does. */
  tiles: string;
  max_zoom: number;
  /** Tiles of woods, water and places; `null` if the extract has none. */
  backdrop: { tiles: string; max_zoom: number } | null;
  left_hand_traffic?: boolean;
  editing: Editing;
  base_map: { url: string; attribution: string } | null;
  /** The older database that the server was started with. */
  before: Before | null;
}

export interface Before {
  /** The name of its file. */
  file: string;
  timestamp: string | null;
  /** What both databases have certificates of. */
  sets: { vehicle: string; policy: Policy }[];
}

export type ChangeName = "became_safe" | "became_conditional" | "became_unsafe" | "became_forbidden" | "became_unknown" | "appeared" | "went";
/** What a certificate comes to. `conditional` is unsafe for want of room, and it is known how much more would be enough. */
export type Standing = "safe" | "conditional" | "unsafe" | "forbidden" | "unknown";

/** A changed edge or turn. `before` or `after` is null if that database does not have it. */
export interface Changed {
  kind: "edge" | "turn";
  change: ChangeName;
  id: string;
  way_id: string | null;
  highway: string | null;
  name: string | null;
  ref: string | null;
  length_m: number | null;
  /** Whether the way has edges in both directions. */
  two_way: boolean;
  /** Whether traffic keeps left there; only where a region has both sides. */
  left?: boolean;
  before: Standing | null;
  before_reason: string | null;
  before_rsc_m: number | null;
  before_width_m: number | null;
  before_need_width_m: number | null;
  after: Standing | null;
  after_reason: string | null;
  after_rsc_m: number | null;
  after_width_m: number | null;
  after_need_width_m: number | null;
}

/** The changes of one kind on one road. */
export interface ChangedRoad {
  change: ChangeName;
  standing: Standing;
  highway: string;
  road: string;
  edges: number;
  km: number;
  /** The longest of the edges. */
  edge_id: string;
  bbox: [west: number, south: number, east: number, north: number];
}

/** The answer of `/api/changes`. Sums and roads count all changes, whatever features there are. */
export interface Changes {
  type: "FeatureCollection";
  sums: { change: ChangeName; edges: number; km: number; turns: number }[];
  roads: ChangedRoad[];
  notes: string[];
  turns_compared: boolean;
  /** Whether the features are all changes that were asked for. */
  complete: boolean;
  features: { type: "Feature"; geometry: { type: "LineString"; coordinates: Position[] }; properties: Changed }[];
}

export interface Unit {
  name: string;
  coupling_to_axle_m: number;
  hitch_offset_m: number;
  front_overhang_m: number;
  rear_overhang_m: number;
  width_m: number;
}

export interface Vehicle {
  id: string;
  name: string;
  region: string;
  length_m: number;
  height_m: number | null;
  gross_mass_t: number | null;
  certified: Policy[];
  /** Whether a designation or the register names the vehicle. */
  may_be_attested: boolean;
  units: Unit[];
}

export interface SearchHit {
  kind: "edge" | "way" | "road" | "place";
  id: string;
  /** The edge, one of the edges of a way or road, or the edge nearest to a place. */
  edge_id: string | null;
  name: string | null;
  ref: string | null;
  /** Ref and name, or what the road joins. */
  title: string;
  /** Of a road by its ref: this ref. */
  by_ref: string | null;
  pieces: number;
  highway: string | null;
  /** Of a named place: its kind. */
  settlement: "city" | "town" | "suburb" | "village" | "hamlet" | null;
  /** The named place that it lies in. */
  town: string | null;
  bbox: [number, number, number, number];
  lon: number;
  lat: number;
}

/** A part of a road by its verdict. */
export interface Share {
  pieces: number;
  length_m: number;
}

/** What the certificates say of a whole road. Turns are not in it. */
export interface RoadSummary extends Share {
  verdicts: Record<VerdictName, Share>;
  worst: { edge_id: string; verdict: VerdictName; reason: string | null; rsc_m: number | null; lon: number; lat: number } | null;
}

/** A whole road, each edge a feature. */
export interface WholeRoad {
  title: string;
  pieces: number;
  /** Null in regions with too many edges to sum. */
  summary: RoadSummary | null;
  scope: string;
  features: { id: string; geometry: { type: "LineString"; coordinates: Position[] } }[];
}

/** The answer of `netcert explain --format json`, with its place on the map. */
export interface Explanation {
  vehicle: string;
  road: {
    edge_id: string;
    way_id: number;
    from_node: number;
    to_node: number;
    direction: string;
    highway: string;
    name: string | null;
    ref: string | null;
    corridor: Policy;
    width_source: Evidence | null;
  } | null;
  verdict: VerdictName;
  reason: string | null;
  headline: string;
  reasons: string[];
  hints_in_words: string[];
  scope: string;
  /** `rsc_m` is null if no bound holds, `width_m` where the area of a junction limits. */
  limiting: { length_m: number; rsc_m: number | null; place: Limiting } | null;
  /** What would make it certified; each is null if it is not known to help. */
  hints: {
    width_m: number | null;
    kerb_radius_m: number | null;
    hinge_limit_deg: number | null;
    shorter_vehicle: { id: string; length_m: number } | null;
    other_strips: { corridor: Policy; width_m: number; safe: boolean; rsc_m: number | null }[];
  };
  kind: "edge" | "turn";
  /** The roads of a turn. */
  turn?: string;
  turn_id?: string;
  /** Of a turn: the node at which it leaves its first road, and both roads. */
  junction?: number | null;
  from_edge?: string | null;
  to_edge?: string | null;
  /** The measurements that count here. */
  measurements: Measured[];
  note?: string;
  /** Beside a reference vehicle, if one was asked for. It says nothing of `safe`. */
  relative?: { relative_to: string; relative_m: number | null; as_reference: boolean; scope: string };
  /** Whether there is a picture. */
  picture: boolean;
  /** What may be supposed of it; null if neither a width nor a kerb radius decides. */
  suppose: Supposable | null;
  geometry?: { type: "LineString"; coordinates: Position[] } | null;
  /** The place that decides, or the turn's node. */
  at: Position | null;
}

/** The part of the vehicle that comes closest to the edge, or goes furthest beyond it. */
export interface Limiting {
  s_m: number;
  unit: number;
  unit_name: string | null;
  side: "left" | "right";
  part: "front_corner" | "rear_corner" | "axle" | "side";
  /** Distance of a place on the side ahead of the axle; null of a corner. */
  ahead_of_axle_m: number | null;
  width_m: number | null;
}

export type Quantity = "kerb_radius" | "lane_width" | "direction_width" | "carriageway_width";

/** The range of a slider, metres, and what is known to be enough. */
export interface Supposable {
  quantity: Quantity;
  now: number;
  low: number;
  high: number;
  step: number;
  /** The stored need; null if none is known. */
  need: number | null;
  /** Of a turn that no radius helps: the width of both roads that would do. */
  need_flare: number | null;
}

/** A measurement that counts at a road or turn. */
export interface Measured {
  evidence_no: number;
  quantity: string;
  /** Metres, or tonnes of masses; null of surfaces. */
  value: number | null;
  source: string;
  date: string | null;
}

interface VerdictChanges {
  again: number;
  became_safe: number;
  no_longer_safe: number;
}

/** What a change of the register did. */
export interface EvidenceChange {
  added: { no: number }[];
  left_out: { why: string | null }[];
  known: { row: number; no: number | null }[];
  conflicts: { what: string }[];
  sets: { vehicle: string; policy: Policy; edges: VerdictChanges; turns: VerdictChanges | null }[];
}

/** The answer to a supposition, which is no certificate. */
export interface Supposed {
  kind: "edge" | "turn";
  quantity: Quantity | "surface";
  /** Null of a surface. */
  supposed: number | null;
  enough: boolean;
  reason: string | null;
  rsc_m: number | null;
  /** Other edges of the stroke that would do, too. */
  opens?: { edge_id: string; title: string; length_m: number; rsc_m: number | null }[];
  opens_m?: number;
  scope: string;
}

/** What a shape of an explanation shows. */
export type Part = "area" | "strip" | "beyond" | "swept" | "path" | "body" | "tightest" | "hinge" | "line";

export interface ShapeProperties {
  part: Part;
  turn_id?: string;
  rsc_m: number | null;
  /** The index of a unit and its name: of swept ground, of a body, or of the one that decides. */
  unit?: number;
  unit_name?: string | null;
  side?: "left" | "right";
  /** What the hinge has left of its limit; null if no bound holds. */
  margin_deg?: number | null;
}

/** The shapes of an explanation, for the map. */
export type Shapes = GeoJSON.FeatureCollection<GeoJSON.Geometry, ShapeProperties>;

/** A passage leads over a roundabout or over several nodes. */
export type PartKind = "edge" | "turn" | "roundabout" | "complex";

export interface RoutePart {
  kind: PartKind;
  title: string;
  edge_id?: string;
  from_edge?: string;
  to_edge?: string;
  from_m: number;
  to_m: number;
  rsc_m: number;
}

/** A stretch on which a route may use more of the road than its own lane. */
export interface StripUse {
  title: string;
  /** In words, such as "the oncoming lane". */
  what: string;
  /** Another lane of its direction, or beyond all of these. */
  strip: "direction" | "carriageway";
  /** On a road, as certified; or near a turn, where the whole strip of the turn counts. */
  where: "road" | "turn";
  from_m: number;
  to_m: number;
  /** How far any point of the vehicle may stand beyond the narrower strip, metres. */
  beyond_m: number;
  side: "left" | "right";
}

export interface Drive {
  /** Stations of the moments, metres from the beginning. */
  s_m: number[];
  /** The time at which the prime mover's axle is there, seconds. */
  t: number[];
  units: DriveUnit[];
  /** The corridor's edges at the same stations. */
  left_edge: Position[];
  right_edge: Position[];
}

export interface DriveUnit {
  name: string;
  width_m: number;
  coupling_to_axle_m: number;
  front_overhang_m: number;
  rear_overhang_m: number;
  /** The axle's longitude and latitude, and the unit's heading in degrees clockwise from true north. */
  poses: [number, number, number][];
  /** The bound on the axle's distance from that place to either side, metres. */
  tube_m: number[];
}

/** The least leeway of each stretch. `null` where no body point passes. */
export interface Leeway {
  step_m: number;
  s_m: number[];
  left_m: (number | null)[];
  right_m: (number | null)[];
}

export interface Route {
  length_m: number;
  time_s: number;
  rsc_m: number;
  hinge_margin_deg: number;
  shrink: number;
  safe: boolean;
  limiting_s_m: number;
  limiting_unit_name: string | null;
  limiting_side: string;
  limiting_at: string | null;
  /** The widest strip that the route uses anywhere. */
  rung: Policy;
  uses: StripUse[];
  parts: RoutePart[];
  geometry: { type: "LineString"; coordinates: Position[] };
  leeway: Leeway;
  drive: Drive;
}

/** What has to be so on site. */
export interface Condition {
  number: number;
  kind: Quantity | "surface";
  place: Position | null;
  assumed: number | null;
  needed: number;
  title: string;
  /** Who says that the vehicle goes there all the same: a sign on the map, or the register of measurements. */
  attested: { by: string; name: string | null; tags: string | null; law: string | null } | null;
  edge_id?: string | null;
  length_m?: number;
  from_edge?: string | null;
  to_edge?: string | null;
}

/** A route that is certified only if all of its conditions hold. It has no drive. */
export interface ConditionalRoute extends Omit<Route, "drive" | "safe"> {
  safe: false;
  conditions: Condition[];
  /** Whether the vehicle is attested at the place of every condition. */
  conditions_attested: boolean;
  /** Whether measurements exactly as named certify the route. */
  conditions_suffice: boolean;
}

export interface Obstacle {
  kind: PartKind;
  title: string;
  edge_id?: string;
  from_edge?: string;
  to_edge?: string;
  verdict: string;
  reason: string | null;
  rsc_m: number | null;
  place: Position | null;
  /** Of an edge: where its width comes from. Of a turn: whether the kerb radius of its corner is assumed. */
  width_source?: Evidence | null;
  kerb_assumed?: boolean | null;
}

export interface RouteAnswer {
  vehicle_id: string;
  scope: string;
  routes: Route[];
  places: { position: Position; distance_m: number }[];
  gave_up: boolean;
  /** The places that no condition opens, where no route is certified under any. */
  nothing_helps: { kind: PartKind; title: string; place: Position | null }[];
  obstacles: Obstacle[] | null;
  conditional: ConditionalRoute | null;
  /** The way on which the obstacles lie. */
  blocked_way: { type: "LineString"; coordinates: Position[] } | null;
}

/** Rows of `/api/stats`; lengths count once for each direction. */
export interface StatsRows {
  strips: { vehicle: string; highway: string; uses: Policy | null; edges: number; km: number }[];
  policy: Policy;
  roads: number;
  network: { highway: string; edges: number; km: number }[];
  widths: { width_source: Evidence | null; km: number }[];
  certificates: { vehicle: string; highway: string; verdict: VerdictName; reason: string | null; km: number }[];
  rsc_bin_m: number;
  rsc_histogram: { vehicle: string; rsc_from_m: number; verdict: VerdictName; km: number }[];
  scope: string;
}

/** `application/problem+json`, RFC 9457. */
export interface Problem {
  title: string;
  status: number;
  detail?: string;
  parameter?: string;
  /** Of measurements: every fault. */
  faults?: { row: number; column: string; what: string }[];
  /** Of a place that is too far from a road that may be used: the place, and the nearest such road. */
  place?: { lon: number; lat: number };
  nearest?: { lon: number; lat: number; distance_m: number } | null;
}

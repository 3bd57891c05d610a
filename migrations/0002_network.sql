-- The route graph. Users read `edge`; the other tables complete it, so that a network loaded from here certifies to
-- the same bytes as one just built from a file. Positions in the program's arrays are kept as they are
-- (`fid` = index of the edge + 1), and single-precision values come back to the same bits.

-- Distinct cross sections: signed positions of a strip's edges across the way's line, metres, positive to the left of
-- travel. NULL: no usable width.
CREATE TABLE section (
    section_no INTEGER PRIMARY KEY,
    lane_left_m DOUBLE, lane_right_m DOUBLE, lane_source TEXT,
    direction_left_m DOUBLE, direction_right_m DOUBLE, direction_source TEXT,
    carriageway_left_m DOUBLE, carriageway_right_m DOUBLE, carriageway_source TEXT
);

-- Distinct sets of limits and access of one direction of a way, as tagged. `unreadable_limits`: names of those that are
-- tagged with a value that could not be read, separated by commas. `rules`: rules that depend on the vehicle or the time, as
-- `key=value` lines, one tagged object after the other with an empty line between; each begins with its direction of travel. Where there are
-- rules, they alone decide on access and limits, and the other columns say what holds for a lorry in general. NULL: the others decide.
-- `tags`: the tags behind limits, access and barriers as the map has them, `key=value` lines; with rules only those of barriers.
CREATE TABLE legal (
    legal_no INTEGER PRIMARY KEY,
    max_height_m DOUBLE,
    max_weight_t DOUBLE,
    max_axle_load_t DOUBLE,
    max_length_m DOUBLE,
    max_width_m DOUBLE,
    unreadable_limits TEXT,
    hgv TEXT NOT NULL,
    motor_vehicle TEXT NOT NULL,
    rules TEXT,
    tags TEXT
);

-- One row per way. `width_tags`: the tags of widths and lanes as the map has them, `key=value` lines.
CREATE TABLE road (
    road_no INTEGER PRIMARY KEY,
    way_id INTEGER NOT NULL,
    highway TEXT NOT NULL,
    roundabout BOOLEAN NOT NULL,
    oneway TEXT NOT NULL,
    name TEXT,
    ref TEXT,
    lanes INTEGER,
    country TEXT NOT NULL,
    left_hand_traffic BOOLEAN NOT NULL,
    section_forward INTEGER NOT NULL REFERENCES section (section_no),
    section_backward INTEGER NOT NULL REFERENCES section (section_no),
    legal_forward INTEGER NOT NULL REFERENCES legal (legal_no),
    legal_backward INTEGER NOT NULL REFERENCES legal (legal_no),
    maxspeed_forward_kmh INTEGER,
    maxspeed_backward_kmh INTEGER,
    width_tags TEXT
);

-- One row per directed edge; `geom` runs in direction of travel. No geometry of this file has an envelope in its header. `edge_id` is stable from extract to extract, `fid` is
-- not. Limits are those of the way and of its nodes on this edge together. `min_radius_m` is NULL on a straight and
-- where no corridor could be laid (then `centreline_deviation_m` is NULL too). `width_source` belongs to
-- `lane_width_m`. `maxspeed_kmh`: the lowest tagged limit for heavy vehicles. `barred`: a barrier on it stops heavy
-- vehicles; `cut`: the extract ends on it. `lane_shared`: a two-way road without a lane for each direction, so that the lane is the whole
-- road, and oncoming traffic has to wait. `supposed_lanes`: lanes of the direction where class and country say how many and how wide, and no tag
-- does. `rules` as in `legal`; `open_when`: those of them that close or limit the edge at some times, for some vehicle. `legal_tags` as `tags` in `legal`, with those of nodes on the edge; `width_tags` as in `road`.
CREATE TABLE edge (
    fid INTEGER PRIMARY KEY NOT NULL,
    edge_id INTEGER NOT NULL,
    way_id INTEGER NOT NULL,
    from_node INTEGER NOT NULL,
    to_node INTEGER NOT NULL,
    direction TEXT NOT NULL,
    geom LINESTRING NOT NULL,
    length_m DOUBLE NOT NULL,
    highway TEXT NOT NULL,
    name TEXT,
    ref TEXT,
    oneway TEXT NOT NULL,
    left_hand_traffic BOOLEAN NOT NULL,
    lanes INTEGER,
    maxspeed_kmh INTEGER,
    lane_width_m DOUBLE,
    width_source TEXT,
    direction_width_m DOUBLE,
    direction_width_source TEXT,
    carriageway_width_m DOUBLE,
    carriageway_width_source TEXT,
    min_radius_m DOUBLE,
    centreline_deviation_m DOUBLE,
    max_height_m DOUBLE,
    max_weight_t DOUBLE,
    max_axle_load_t DOUBLE,
    max_length_m DOUBLE,
    max_width_m DOUBLE,
    unreadable_limits TEXT,
    hgv TEXT NOT NULL,
    motor_vehicle TEXT NOT NULL,
    barred BOOLEAN NOT NULL,
    cut BOOLEAN NOT NULL,
    road_no INTEGER NOT NULL REFERENCES road (road_no),
    shape_start INTEGER NOT NULL,
    narrowing_start INTEGER NOT NULL,
    narrowing_end INTEGER NOT NULL,
    rules TEXT,
    open_when TEXT,
    legal_tags TEXT,
    width_tags TEXT,
    lane_shared BOOLEAN AS (coalesce(oneway = 'no' AND lane_width_m = carriageway_width_m, 0)),
    supposed_lanes INTEGER AS (CASE WHEN width_source = 'assumed' AND direction_width_source = 'assumed'
                               THEN CAST(round(direction_width_m / lane_width_m) AS INTEGER) END)
);

-- Places narrower than the cross section; an edge's are narrowing_start < narrowing_no <= narrowing_end. `vertex` counts
-- along the edge's shape in way order.
CREATE TABLE narrowing (
    narrowing_no INTEGER PRIMARY KEY,
    vertex INTEGER NOT NULL,
    passage_m DOUBLE NOT NULL
);

-- A stroke is a chain of edges continued straight on: rows start < position <= end of `stroke_edge`, in driving order.
CREATE TABLE stroke (
    stroke_no INTEGER PRIMARY KEY,
    approach_start INTEGER NOT NULL,
    approach_end INTEGER NOT NULL,
    edge_start INTEGER NOT NULL,
    edge_end INTEGER NOT NULL,
    closed BOOLEAN NOT NULL
);

CREATE TABLE stroke_edge (
    position INTEGER PRIMARY KEY,
    fid INTEGER NOT NULL REFERENCES edge (fid)
);

-- The spatial index of `edge`, as the extension gpkg_rtree_index has it; its triggers come with the last migration.
CREATE VIRTUAL TABLE rtree_edge_geom USING rtree(id, minx, maxx, miny, maxy);

INSERT INTO gpkg_extensions VALUES
    ('edge', 'geom', 'gpkg_rtree_index', 'http://www.geopackage.org/spec120/#extension_rtree', 'write-only');

-- Vehicles and what was proved for them. A region times its vehicles is millions of certificates, so they are kept as
-- small integers, some 30 bytes each with all that pages cost, behind the view `certificate` in metres and words.

CREATE TABLE vehicle (
    vehicle_no INTEGER PRIMARY KEY,
    vehicle_id TEXT NOT NULL UNIQUE,
    name TEXT NOT NULL,
    definition TEXT NOT NULL, -- the whole vehicle as JSON, in the units of the vehicle file
    blake3 TEXT NOT NULL      -- of `definition`
);

-- Which width counts: lane, direction, carriageway.
CREATE TABLE corridor (
    corridor_no INTEGER PRIMARY KEY,
    corridor TEXT NOT NULL UNIQUE
);

-- Verdicts with their reasons; the program fills it from its own list.
CREATE TABLE verdict (
    verdict_no INTEGER PRIMARY KEY,
    verdict TEXT NOT NULL,
    reason TEXT
);

-- `replication_timestamp` is a text: extracts give whole seconds, and GDAL warns of a DATETIME without thousandths.
CREATE TABLE run (
    run_id INTEGER PRIMARY KEY,
    command TEXT NOT NULL,
    input_name TEXT NOT NULL,
    input_blake3 TEXT,
    replication_timestamp TEXT,
    netcert_version TEXT NOT NULL,
    started DATETIME NOT NULL,
    finished DATETIME NOT NULL,
    parameters TEXT NOT NULL -- JSON
);

-- Everything read was used, or left out for a counted reason.
CREATE TABLE account (
    account_no INTEGER PRIMARY KEY,
    run_id INTEGER NOT NULL REFERENCES run (run_id),
    stage TEXT NOT NULL,
    item TEXT NOT NULL,
    outcome TEXT NOT NULL,
    reason TEXT NOT NULL,
    count INTEGER NOT NULL
);

-- How `ingest` was told to certify: one row, as JSON in the form of `certified_set.settings`. The columns `min_radius_m` and
-- `centreline_deviation_m` of `edge` were measured so, whatever the settings of the sets are; a set that is made later is made so
-- unless it is told otherwise. Kerbs are the same for all sets: `turn.kerb_radius_m` shows them.
CREATE TABLE network_settings (
    settings TEXT NOT NULL
);

-- What is complete: this vehicle's certificates under this corridor policy, and the layer that shows them. `settings`: everything
-- that they depend on besides network and vehicle, as JSON. Whoever computes them again reads it.
CREATE TABLE certified_set (
    vehicle_no INTEGER NOT NULL REFERENCES vehicle (vehicle_no),
    corridor_no INTEGER NOT NULL REFERENCES corridor (corridor_no),
    run_id INTEGER NOT NULL REFERENCES run (run_id),
    edges INTEGER NOT NULL,
    layer TEXT NOT NULL UNIQUE,
    settings TEXT NOT NULL,
    PRIMARY KEY (vehicle_no, corridor_no)
) WITHOUT ROWID;

-- Millimetres, hundredths of a degree, thousandths and decimetres; every value is rounded to the safe side.
-- shrink_milli NULL: 1. limiting_at: 2 × unit + (1 on the right). need_cm: the least width of the strip with which an edge that
-- lacks room would be safe, if its stroke were nowhere narrower; rounded up. No foreign keys: the check costs more than the row;
-- the writer numbers the rows from the edges themselves. The generated columns take no room; a view's column has a type
-- only if it is one of a table, and without one GDAL shows numbers as text. certificate_no names the row in the views: 32
-- bits of fid, 2 of corridor, then the vehicle; up to 2^19 vehicles a floating-point number holds it exactly.
CREATE TABLE certificate_compact (
    vehicle_no INTEGER NOT NULL,
    corridor_no INTEGER NOT NULL,
    fid INTEGER NOT NULL,
    verdict_no INTEGER NOT NULL,
    rsc_mm INTEGER,
    rsc_published_mm INTEGER,
    hinge_margin_cdeg INTEGER,
    shrink_milli INTEGER,
    limiting_s_dm INTEGER,
    limiting_at INTEGER,
    need_cm INTEGER,
    rsc_m DOUBLE AS (rsc_mm / 1000.0),
    rsc_published_m DOUBLE AS (rsc_published_mm / 1000.0),
    hinge_margin_deg DOUBLE AS (hinge_margin_cdeg / 100.0),
    shrink DOUBLE AS (CASE WHEN limiting_at NOT NULL THEN coalesce(shrink_milli, 1000) / 1000.0 END),
    limiting_s_m DOUBLE AS (limiting_s_dm / 10.0),
    limiting_unit INTEGER AS (limiting_at >> 1),
    limiting_side TEXT AS (CASE limiting_at & 1 WHEN 0 THEN 'left' WHEN 1 THEN 'right' END),
    need_width_m DOUBLE AS (need_cm / 100.0),
    certificate_no INTEGER AS ((vehicle_no << 34) | (corridor_no << 32) | fid),
    PRIMARY KEY (vehicle_no, corridor_no, fid)
) WITHOUT ROWID;

-- A view's first column is its key to other programs (GeoPackage 1.3, requirement 151), so it must be unique.
CREATE VIEW certificate AS
SELECT
    c.certificate_no AS fid,
    e.edge_id,
    v.vehicle_id,
    p.corridor,
    c.rsc_m,
    c.rsc_published_m,
    c.hinge_margin_deg,
    c.shrink,
    c.limiting_s_m,
    c.limiting_unit,
    c.limiting_side,
    w.verdict,
    w.reason,
    c.need_width_m,
    c.fid AS edge_fid,
    c.vehicle_no,
    c.corridor_no
FROM certificate_compact AS c
JOIN edge AS e ON e.fid = c.fid
JOIN vehicle AS v ON v.vehicle_no = c.vehicle_no
JOIN corridor AS p ON p.corridor_no = c.corridor_no
JOIN verdict AS w ON w.verdict_no = c.verdict_no;

-- One row per edge and vehicle that may use it. Verdict 0 is `safe`. One part for each policy, as each has a width source of
-- its own: of a CASE the column would have no type.
CREATE VIEW permit AS
SELECT
    c.certificate_no AS fid,
    e.edge_id,
    v.vehicle_id,
    p.corridor,
    e.way_id,
    e.from_node,
    e.to_node,
    e.length_m,
    c.rsc_m,
    c.hinge_margin_deg,
    c.shrink,
    e.width_source AS width_source,
    c.fid AS edge_fid
FROM certificate_compact AS c
JOIN edge AS e ON e.fid = c.fid
JOIN vehicle AS v ON v.vehicle_no = c.vehicle_no
JOIN corridor AS p ON p.corridor_no = c.corridor_no
WHERE c.verdict_no = 0 AND c.corridor_no = 0
UNION ALL
SELECT
    c.certificate_no AS fid,
    e.edge_id,
    v.vehicle_id,
    p.corridor,
    e.way_id,
    e.from_node,
    e.to_node,
    e.length_m,
    c.rsc_m,
    c.hinge_margin_deg,
    c.shrink,
    e.direction_width_source AS width_source,
    c.fid AS edge_fid
FROM certificate_compact AS c
JOIN edge AS e ON e.fid = c.fid
JOIN vehicle AS v ON v.vehicle_no = c.vehicle_no
JOIN corridor AS p ON p.corridor_no = c.corridor_no
WHERE c.verdict_no = 0 AND c.corridor_no = 1
UNION ALL
SELECT
    c.certificate_no AS fid,
    e.edge_id,
    v.vehicle_id,
    p.corridor,
    e.way_id,
    e.from_node,
    e.to_node,
    e.length_m,
    c.rsc_m,
    c.hinge_margin_deg,
    c.shrink,
    e.carriageway_width_source AS width_source,
    c.fid AS edge_fid
FROM certificate_compact AS c
JOIN edge AS e ON e.fid = c.fid
JOIN vehicle AS v ON v.vehicle_no = c.vehicle_no
JOIN corridor AS p ON p.corridor_no = c.corridor_no
WHERE c.verdict_no = 0 AND c.corridor_no = 2;

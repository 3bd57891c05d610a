-- Turns: every way to go on at a junction that is neither straight on nor back, and what was proved for it. The same ways of
-- keeping as for edges: small integers behind a view in metres and words.

-- `angle_deg`: positive to the left. `kerb_radius_m`: of the kerb on the inside of the turn; `kerb_source`: where it comes from
-- (`assumed`: by class and country; `mapped`: the junction's surface, without a radius). `restriction`: the turn restriction that forbids it, as tagged. `turn_id` is stable from
-- extract to extract, `fid` is not. `geom`: the last metres before the node and the first after it.
-- A passage of a roundabout (`kind` 'roundabout') enters, circulates and leaves in one: `from_fid` ends on the ring at `via_node`,
-- `to_fid` starts on it elsewhere, and between them lie its arcs from `first_arc_fid` to `last_arc_fid` in driving order.
CREATE TABLE turn (
    fid INTEGER PRIMARY KEY NOT NULL,
    turn_id INTEGER NOT NULL,
    from_fid INTEGER NOT NULL REFERENCES edge (fid),
    to_fid INTEGER NOT NULL REFERENCES edge (fid),
    via_node INTEGER NOT NULL,
    geom LINESTRING NOT NULL,
    angle_deg DOUBLE NOT NULL,
    kind TEXT NOT NULL,
    kerb_radius_m DOUBLE,
    kerb_source TEXT,
    restriction TEXT,
    first_arc_fid INTEGER REFERENCES edge (fid),
    last_arc_fid INTEGER REFERENCES edge (fid)
);

CREATE UNIQUE INDEX turn_by_id ON turn (turn_id);

CREATE INDEX turn_by_edge ON turn (from_fid);

-- Whose turns are complete, under which policy.
CREATE TABLE certified_turns (
    vehicle_no INTEGER NOT NULL REFERENCES vehicle (vehicle_no),
    corridor_no INTEGER NOT NULL REFERENCES corridor (corridor_no),
    run_id INTEGER NOT NULL REFERENCES run (run_id),
    turns INTEGER NOT NULL,
    PRIMARY KEY (vehicle_no, corridor_no)
) WITHOUT ROWID;

-- As `certificate_compact`. `path_no`: which of the turn's reference paths it rests on. No numbers where one of the turn's edges
-- has the verdict already: then it is that edge's. `unknown: time` replaces only `safe`, and keeps the numbers. `need_kerb_cm`: the least radius of the turn's own kerbs with which a turn that lacks
-- room would be safe; `need_flare_cm`: if no radius helps, the width that the strip near the turn would need on both roads.
CREATE TABLE turn_certificate_compact (
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
    need_kerb_cm INTEGER,
    need_flare_cm INTEGER,
    path_no INTEGER,
    rsc_m DOUBLE AS (rsc_mm / 1000.0),
    rsc_published_m DOUBLE AS (rsc_published_mm / 1000.0),
    hinge_margin_deg DOUBLE AS (hinge_margin_cdeg / 100.0),
    shrink DOUBLE AS (CASE WHEN limiting_at NOT NULL THEN coalesce(shrink_milli, 1000) / 1000.0 END),
    limiting_s_m DOUBLE AS (limiting_s_dm / 10.0),
    limiting_unit INTEGER AS (limiting_at >> 1),
    limiting_side TEXT AS (CASE limiting_at & 1 WHEN 0 THEN 'left' WHEN 1 THEN 'right' END),
    need_kerb_radius_m DOUBLE AS (need_kerb_cm / 100.0),
    need_flare_m DOUBLE AS (need_flare_cm / 100.0),
    certificate_no INTEGER AS ((vehicle_no << 34) | (corridor_no << 32) | fid),
    PRIMARY KEY (vehicle_no, corridor_no, fid)
) WITHOUT ROWID;

CREATE VIEW turn_certificate AS
SELECT
    c.certificate_no AS fid,
    t.turn_id,
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
    c.need_kerb_radius_m,
    c.need_flare_m,
    c.path_no,
    a.edge_id AS from_edge,
    b.edge_id AS to_edge,
    t.via_node,
    c.fid AS turn_fid,
    c.vehicle_no,
    c.corridor_no
FROM turn_certificate_compact AS c
JOIN turn AS t ON t.fid = c.fid
JOIN edge AS a ON a.fid = t.from_fid
JOIN edge AS b ON b.fid = t.to_fid
JOIN vehicle AS v ON v.vehicle_no = c.vehicle_no
JOIN corridor AS p ON p.corridor_no = c.corridor_no
JOIN verdict AS w ON w.verdict_no = c.verdict_no;

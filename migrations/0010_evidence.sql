-- The register of measurements: what somebody measured on site, whether its place was found, and whether certificates use it. The
-- map's own widths stay in `section`, so they are there again when a measurement is removed.

-- `evidence_no` is never used twice. `id`, `file`, `file_row`: where the measurement came from. `lower`: what counts, `value` less 1.64
-- `sigma` for what helps. Its place as given: ids, or `geom`. `state`: `matched`, `unmatched` or `ambiguous`; `used`: what becomes of it
-- if it is matched; `why`: why it is not matched or not used.
CREATE TABLE evidence (
    evidence_no INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,
    geom GEOMETRY,
    file TEXT NOT NULL,
    file_row INTEGER NOT NULL,
    id TEXT,
    quantity TEXT NOT NULL,
    value DOUBLE,
    sigma DOUBLE NOT NULL,
    lower DOUBLE,
    vehicle TEXT,
    direction TEXT NOT NULL,
    way_id INTEGER,
    from_node INTEGER,
    to_node INTEGER,
    edge_id INTEGER,
    junction INTEGER,
    from_edge INTEGER,
    to_edge INTEGER,
    source TEXT NOT NULL,
    date TEXT,
    licence TEXT,
    name TEXT,
    note TEXT,
    state TEXT NOT NULL,
    used TEXT,
    why TEXT
);

-- What a measurement was matched to: an edge; a junction, or its corner between the edge that ends and the edge that begins there.
-- `counts`: whether certificates use the measurement there. No two measurements of a quantity count at one place.
CREATE TABLE evidence_place (
    place_no INTEGER PRIMARY KEY,
    evidence_no INTEGER NOT NULL REFERENCES evidence (evidence_no),
    edge_id INTEGER,
    node INTEGER,
    from_edge INTEGER,
    to_edge INTEGER,
    counts BOOLEAN NOT NULL
);

CREATE INDEX evidence_place_by_evidence ON evidence_place (evidence_no);

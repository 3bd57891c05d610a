-- Turn restrictions that hold for heavy goods vehicles: sequences of edges that may not be driven one right after the
-- other, rows edge_start < position <= edge_end of `restriction_edge`. `kind`: as tagged (`no_left_turn`,
-- `only_straight_on`: what it leaves over is forbidden, one row each). `conditional`: it holds at times, or under a
-- condition that was not decided.

CREATE TABLE restriction (
    restriction_no INTEGER PRIMARY KEY,
    relation_id INTEGER NOT NULL,
    kind TEXT NOT NULL,
    conditional BOOLEAN NOT NULL,
    edge_start INTEGER NOT NULL,
    edge_end INTEGER NOT NULL
);

CREATE TABLE restriction_edge (
    position INTEGER PRIMARY KEY,
    fid INTEGER NOT NULL REFERENCES edge (fid)
);

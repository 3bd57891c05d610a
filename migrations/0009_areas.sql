-- Mapped surfaces of junctions, and islands on them (`kind` 'island'): the closed ways that corners of turns are made from where they
-- are there, `turn.kerb_source` 'mapped'. `kind`: as `highway` (a link's surface is that of its class). `geom`: the ring as a line.

CREATE TABLE area (
    area_no INTEGER PRIMARY KEY,
    way_id INTEGER NOT NULL,
    kind TEXT NOT NULL,
    geom BLOB NOT NULL
);

-- What a map shows behind the roads: woods, water, coasts, rivers, canals and places. Nothing else in this file rests on it.
-- `object`: the object in OpenStreetMap, such as `way 123`. `geom`: polygons, lines or points, within two metres of the map's.
CREATE TABLE backdrop (
    fid INTEGER PRIMARY KEY NOT NULL,
    kind TEXT NOT NULL,
    object TEXT NOT NULL,
    name TEXT,
    geom BLOB NOT NULL
);

-- Boxes in degrees. `size_deg`: the longer side of the box, in degrees of latitude.
CREATE VIRTUAL TABLE rtree_backdrop_geom USING rtree (fid, west, east, south, north, +size_deg REAL);

-- Loads an export of netcert into PostgreSQL in one transaction. Run in this folder: psql -d DATABASE -f load.sql
-- The schema `netcert` of an earlier export is replaced.

\set ON_ERROR_STOP on

BEGIN;

CREATE EXTENSION IF NOT EXISTS pgrouting CASCADE;
DROP SCHEMA IF EXISTS netcert CASCADE;
CREATE SCHEMA netcert;

-- What the permits depend on: vehicle, options, the database's hash, scope, licence.
CREATE TABLE netcert.header (header jsonb NOT NULL);

-- Directed edges. source and target are OpenStreetMap nodes. cost is in metres, -1 where the vehicle may not drive.
CREATE TABLE netcert.edge (
    id bigint PRIMARY KEY,
    edge_id bigint NOT NULL UNIQUE,
    way_id bigint NOT NULL,
    source bigint NOT NULL,
    target bigint NOT NULL,
    cost double precision NOT NULL,
    length_m double precision NOT NULL,
    highway text NOT NULL,
    name text,
    ref text,
    refusal text,
    rsc_m double precision,
    hinge_margin_deg double precision,
    width_m double precision,
    width_source text,
    uses text,
    geom geometry(LineString, 4326) NOT NULL,
    reverse_cost double precision NOT NULL DEFAULT -1
);

-- For pgr_trsp: sequences of edges that may not be driven one right after the other.
CREATE TABLE netcert.restriction (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    path bigint[] NOT NULL,
    cost double precision NOT NULL DEFAULT 'Infinity'
);

-- For pgr_dijkstra with edges as vertices. source and target are ids of netcert.edge. cost is the length from the end of source to
-- the end of target. arcs are the edges of a roundabout between the two.
CREATE TABLE netcert.step (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    source bigint NOT NULL,
    target bigint NOT NULL,
    arcs bigint[] NOT NULL,
    cost double precision
);

\copy netcert.header FROM 'header.copy'
\copy netcert.edge (id, edge_id, way_id, source, target, cost, length_m, highway, name, ref, refusal, rsc_m, hinge_margin_deg, width_m, width_source, uses, geom) FROM 'edge.copy'
\copy netcert.restriction (path) FROM 'restriction.copy'
\copy netcert.step (source, target, arcs) FROM 'step.copy'

CREATE INDEX ON netcert.edge USING gist (geom);
CREATE INDEX ON netcert.edge (source);
ANALYZE netcert.edge;

-- Turning back on the road is never permitted.
INSERT INTO netcert.restriction (path)
SELECT ARRAY[a.id, b.id]
FROM netcert.edge AS a
JOIN netcert.edge AS b ON b.source = a.target AND b.target = a.source AND b.way_id = a.way_id
    AND ST_OrderingEquals(b.geom, ST_Reverse(a.geom))
WHERE a.cost >= 0 AND b.cost >= 0
ORDER BY a.id, b.id;

UPDATE netcert.step AS s
SET cost = t.length_m + coalesce((SELECT sum(length_m) FROM netcert.edge WHERE id = ANY (s.arcs)), 0)
FROM netcert.edge AS t
WHERE t.id = s.target;

ALTER TABLE netcert.step ALTER COLUMN cost SET NOT NULL;

COMMIT;

ANALYZE netcert.restriction;
ANALYZE netcert.step;

-- What can only be made when the data are in: an index that is cheaper in one go, and the triggers.

CREATE UNIQUE INDEX edge_by_id ON edge (edge_id);

-- The triggers that keep the spatial index right when another program edits `edge` (extension gpkg_rtree_index,
-- GeoPackage 1.3, clause F.3). Applied last: they call ST_ functions, which QGIS and GDAL bring along and plain SQLite
-- lacks, so that netcert itself could not insert an edge any more.

CREATE TRIGGER rtree_edge_geom_insert AFTER INSERT ON edge
WHEN (NEW.geom NOT NULL AND NOT ST_IsEmpty(NEW.geom))
BEGIN
    INSERT OR REPLACE INTO rtree_edge_geom
    VALUES (NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom));
END;

CREATE TRIGGER rtree_edge_geom_update1 AFTER UPDATE OF geom ON edge
WHEN OLD.fid = NEW.fid AND (NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))
BEGIN
    INSERT OR REPLACE INTO rtree_edge_geom
    VALUES (NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom));
END;

CREATE TRIGGER rtree_edge_geom_update2 AFTER UPDATE OF geom ON edge
WHEN OLD.fid = NEW.fid AND (NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))
BEGIN
    DELETE FROM rtree_edge_geom WHERE id = OLD.fid;
END;

CREATE TRIGGER rtree_edge_geom_update3 AFTER UPDATE ON edge
WHEN OLD.fid != NEW.fid AND (NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))
BEGIN
    DELETE FROM rtree_edge_geom WHERE id = OLD.fid;
    INSERT OR REPLACE INTO rtree_edge_geom
    VALUES (NEW.fid, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom));
END;

CREATE TRIGGER rtree_edge_geom_update4 AFTER UPDATE ON edge
WHEN OLD.fid != NEW.fid AND (NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))
BEGIN
    DELETE FROM rtree_edge_geom WHERE id IN (OLD.fid, NEW.fid);
END;

CREATE TRIGGER rtree_edge_geom_delete AFTER DELETE ON edge
WHEN OLD.geom NOT NULL
BEGIN
    DELETE FROM rtree_edge_geom WHERE id = OLD.fid;
END;

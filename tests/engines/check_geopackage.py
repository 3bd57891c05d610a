"""Whether programs of others read a database and its exports as they are meant.

    check_geopackage.py DATABASE EXPORTS_FOLDER SPATIAL_EXTENSION|-

EXPORTS_FOLDER holds csv/, geoparquet/, flatgeobuf/ and geojson/. pyogrio and fiona read by GDAL builds of their own, DuckDB by a third.
Prints one line a subject; stops at the first fault.
"""

import csv
import os
import sqlite3
import sys
import warnings

# GDAL before 3.11.4, as in DuckDB 1.5, reads views, and tables that GDAL has not counted, by two threads that get in each other's way.
os.environ["OGR_GPKG_STREAM_BASE_IMPL"] = "YES"

import duckdb
import fiona
import geopandas
import pandas
import pyarrow.parquet as parquet
import pyogrio

DATABASE, EXPORTS, SPATIAL = sys.argv[1:]
TABLES = {"certificate", "permit", "turn_certificate", "vehicle", "run", "account", "layer_styles"}
KEYS = {"junction": "node_id", "vehicle": "vehicle_no", "run": "run_id", "account": "account_no", "layer_styles": "id"}

warnings.simplefilter("error")


def check(condition, *what):
    if not condition:
        sys.exit("refused: " + " ".join(map(str, what)))


def columns_of(name):
    # With columns that are computed from others.
    return [row[1] for row in store.execute(f'PRAGMA table_xinfo("{name}")')]


def layer(name, has_lines):
    key = KEYS.get(name, "fid")
    ids = [row[0] for row in store.execute(f'SELECT "{key}" FROM "{name}"')]
    plain = [column for column in columns_of(name) if column not in (key, "geom")]
    check(len(set(ids)) == len(ids), name, "repeats a key")

    frame = pyogrio.read_dataframe(DATABASE, layer=name, fid_as_index=True)
    check(frame.index.name == "fid" and sorted(frame.index) == sorted(ids), name, "by pyogrio:", frame.index)
    check([column for column in frame.columns if column != "geometry"] == plain, name, list(frame.columns))
    check(("geometry" in frame.columns) == has_lines, name, "lines:", list(frame.columns))
    if "edge_id" in plain:
        wanted = dict(store.execute(f'SELECT "{key}", edge_id FROM "{name}"'))
        check(frame["edge_id"].to_dict() == wanted, name, "edge_id by pyogrio")
    if has_lines:
        check(frame.crs.to_authority() == ("EPSG", "4326"), name, frame.crs)
        check(name != "junction" or (frame.geometry.is_valid.all() and not frame.is_empty.any()), name, "has areas that are none")

    with fiona.open(DATABASE, layer=name) as features:
        check(len({feature["id"] for feature in features}) == len(ids), name, "by fiona")
        # This GDAL does not know a view's key: the column stays among the others, under its own name.
        check(set(features.schema["properties"]) - {key} == set(plain), name, features.schema)

    if SPATIAL != "-":
        read = f"ST_Read('{DATABASE}', layer='{name}')"
        names = [row[0].lower() for row in duck.execute(f"DESCRIBE SELECT * FROM {read}").fetchall()]
        check(len(set(names)) == len(names), name, "by DuckDB:", names)
        found = [row[0] for row in duck.execute(f'SELECT "{key}" FROM {read}').fetchall()]
        check(sorted(found) == sorted(ids), name, "by DuckDB:", len(found))


def layers():
    listed = {name: kind is not None for name, kind in pyogrio.list_layers(DATABASE).tolist()}
    features = {row[0] for row in store.execute("SELECT table_name FROM gpkg_geometry_columns")}
    check({name for name, lines in listed.items() if not lines} == TABLES, "tables:", listed)
    check({name for name, lines in listed.items() if lines} == features, "layers:", listed)
    check({"edge", "junction", "turn"} < features and set(fiona.listlayers(DATABASE)) == listed.keys(), features)
    for name, has_lines in listed.items():
        layer(name, has_lines)
    print(f"layers: {len(listed)} read by pyogrio, fiona" + ("" if SPATIAL == "-" else " and DuckDB"))


def systems():
    bounds = pyogrio.read_dataframe(DATABASE, layer="edge").total_bounds.tolist()
    frames = {
        "GeoParquet": geopandas.read_parquet(f"{EXPORTS}/geoparquet/edges.parquet"),
        "FlatGeobuf": geopandas.read_file(f"{EXPORTS}/flatgeobuf/edges.fgb"),
        "GeoJSON": geopandas.read_file(f"{EXPORTS}/geojson/edges.geojson"),
    }
    for form, frame in frames.items():
        check(frame.crs.to_authority() == ("EPSG", "4326") and frame.crs == "EPSG:4326", form, frame.crs)
        # Longitude is x in all of them.
        near = all(abs(a - b) < 1e-9 for a, b in zip(frame.total_bounds, bounds, strict=True))
        check(near, form, frame.total_bounds, bounds)
    check(len(pandas.concat(frames.values())) == 3 * len(frames["GeoJSON"]), "they do not join")
    print(f"one system: EPSG:4326 in {', '.join(frames)}")


def ids():
    """Ids with gaps come through pandas with every digit."""
    for name, columns in {"edges": ["edge_id"], "turns": ["turn_id", "first_arc", "last_arc"]}.items():
        key = columns[0]
        with open(f"{EXPORTS}/csv/{name}.csv", newline="", encoding="utf-8") as text:
            rows = sorted(csv.DictReader(text), key=lambda row: int(row[key]))
        path = f"{EXPORTS}/geoparquet/{name}.parquet"
        typed = dict.fromkeys(columns, "Int64")
        for frame in (pandas.read_parquet(path), geopandas.read_parquet(path), pandas.read_csv(f"{EXPORTS}/csv/{name}.csv", dtype=typed)):
            # GeoParquet has the rows along a curve.
            frame = frame.sort_values(key)
            for column in columns:
                check(str(frame[column].dtype) == "Int64", name, column, frame[column].dtype)
                texts = ["" if value is pandas.NA else str(value) for value in frame[column]]
                check(texts == [row[column] for row in rows], name, column)
    check(any(row["first_arc"] for row in rows) and any(not row["first_arc"] for row in rows), "no gaps to judge by")
    print("ids: whole in pandas and geopandas")


def statistics():
    """Bounds of doubles let readers skip groups of rows."""
    count = 0
    for name in ("edges", "turns"):
        file = parquet.ParquetFile(f"{EXPORTS}/geoparquet/{name}.parquet")
        for group in range(file.metadata.num_row_groups):
            chunks = [file.metadata.row_group(group).column(i) for i in range(file.metadata.num_columns)]
            table = file.read_row_group(group).flatten()
            for chunk in chunks:
                if chunk.physical_type != "DOUBLE":
                    continue
                values = [value for value in table[chunk.path_in_schema].to_pylist() if value is not None]
                bounds = chunk.statistics
                check(bounds is not None and bounds.has_min_max == bool(values), name, chunk.path_in_schema, "has no bounds")
                check(not values or (bounds.min, bounds.max) == (min(values), max(values)), name, chunk.path_in_schema)
                count += 1
    check(count > 20, count)
    print(f"statistics: bounds of {count} columns of doubles")


store = sqlite3.connect(f"file:{DATABASE}?mode=ro", uri=True)
duck = duckdb.connect(config={"allow_unsigned_extensions": True})
if SPATIAL != "-":
    duck.execute(f"LOAD '{SPATIAL}'")
for judge in (layers, systems, ids, statistics):
    judge()

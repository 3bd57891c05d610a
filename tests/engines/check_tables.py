"""Whether edges.parquet and turns.parquet of an export say what its CSV files say.

    check_tables.py PARQUET_FOLDER CSV_FOLDER [GEOPARQUET_VERSION]

Reads the Parquet files by DuckDB and by pyarrow, each by its own code. CSV is in the order of the network, Parquet in that of a curve. Prints
one line a layer; stops at the first difference.
"""

import csv
import json
import math
import struct
import sys

import duckdb
import pyarrow.parquet as parquet

# https://geoparquet.org/releases/v1.1.0/schema.json, what concerns these files.
VERSION = sys.argv[3] if len(sys.argv) > 3 else "1.1"
GEO_REQUIRED = {"version", "primary_column", "columns"}


def check(condition, *what):
    if not condition:
        sys.exit("refused: " + " ".join(map(str, what)))


def as_csv(value):
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return value


def same(cell, text):
    if isinstance(cell, float):
        return text != "" and float(text) == cell
    return str(as_csv(cell)) == text


def line_of(wkb):
    order, kind, count = struct.unpack_from("<BII", wkb)
    check(order == 1 and kind == 2 and len(wkb) == 9 + 16 * count and count > 1, "no line string:", wkb[:9])
    flat = struct.unpack_from(f"<{2 * count}d", wkb, 9)
    return list(zip(flat[::2], flat[1::2]))


def metadata(path):
    file = parquet.ParquetFile(path)
    pairs = file.metadata.metadata
    geo, header = json.loads(pairs[b"geo"]), json.loads(pairs[b"netcert"])
    check(GEO_REQUIRED <= geo.keys() and geo["version"] == f"{VERSION}.0", "geo:", geo)
    column = geo["columns"][geo["primary_column"]]
    check(column["encoding"] == "WKB" and column["geometry_types"] == ["LineString"], "geo:", column)
    covering = column["covering"]["bbox"]
    check(covering == {side: ["bbox", side] for side in ("xmin", "ymin", "xmax", "ymax")}, "covering:", covering)
    check(len(header["database"]["blake3"]) == 64 and "no legal permit" in header["scope"], header)
    return file, column["bbox"]


def layer(name, tables, plain):
    path = f"{tables}/{name}.parquet"
    file, around = metadata(path)
    duck = duckdb.connect().execute(f"select * exclude (geometry, bbox) from read_parquet('{path}')")
    columns = [column[0] for column in duck.description]
    key = columns.index({"edges": "edge_id", "turns": "turn_id"}[name])
    with open(f"{plain}/{name}.csv", newline="", encoding="utf-8") as text:
        rows = csv.reader(text)
        check(next(rows) == columns, "columns:", columns)
        texts_of = {texts[key]: texts for texts in rows}
    network, ids = list(texts_of), []
    count = 0
    for cells in iter(duck.fetchone, None):
        ids.append(str(cells[key]))
        texts = texts_of.pop(ids[-1], None)
        check(texts is not None, f"{name}: {cells[key]} is not in csv, or twice in Parquet")
        for cell, text, column in zip(cells, texts, columns, strict=True):
            check(same(cell, text), f"{name} row {count} {column}: {cell!r}, csv {text!r}")
        count += 1
    check(not texts_of, f"{name}: {len(texts_of)} rows are in csv alone")
    wide = [180.0, 90.0, -180.0, -90.0]
    arrow = file.read(["geometry", "bbox"]).to_pylist()
    for row in arrow:
        lons, lats = zip(*line_of(row["geometry"]))
        sides = [min(lons), min(lats), max(lons), max(lats)]
        check(list(row["bbox"].values()) == sides, "bbox:", row["bbox"], sides)
        wide = [min(wide[0], sides[0]), min(wide[1], sides[1]), max(wide[2], sides[2]), max(wide[3], sides[3])]
    check(len(arrow) == count == file.metadata.num_rows and wide == around, "bbox of all:", around, wide)
    # Neighbours in the file are neighbours on the ground: on the drawn region the way from row to row is half as long as in the network.
    middles = {id_: ((row["bbox"]["xmin"] + row["bbox"]["xmax"]) / 2, (row["bbox"]["ymin"] + row["bbox"]["ymax"]) / 2) for id_, row in zip(ids, arrow, strict=True)}
    way = [sum(math.dist(middles[a], middles[b]) for a, b in zip(order, order[1:])) for order in (ids, network)]
    check(way[0] < 0.7 * way[1], "not along a curve:", way)
    for group in map(file.metadata.row_group, range(file.metadata.num_row_groups)):
        check(group.num_rows <= 2048, "a group of", group.num_rows)
        check({group.column(i).compression for i in range(group.num_columns)} == {"ZSTD"}, "not compressed with zstd")
    logical = file.schema.column(len(columns)).logical_type
    check((logical.type == "GEOMETRY") == (VERSION == "2.0"), "the type of lines:", logical)
    print(f"{name}: {count} rows, {len(columns)} columns, {file.metadata.num_row_groups} groups of rows")


for each in ("edges", "turns"):
    layer(each, sys.argv[1], sys.argv[2])

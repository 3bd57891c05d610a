#!/usr/bin/env bash
# The value in the name of a folder, `cell=6-10-22`, becomes a day for DuckDB and Polars, and a vehicle `1234` a number.
# A good guess is that such a value is a text, or a number where it is written like one.
#
# Behaviour (DuckDB 2.0.1, Polars 2.1.0, pyarrow 26.0.1 from PyPI, with partitions in the style of Hive): `6-10-22` is the timestamp 22 October
# of the year 6 to DuckDB and the date 6 October of the year 22 to Polars, and a text to pyarrow. `1234` is a whole number to all three. A condition such as
# `cell = '6-10-22'` then compares days, and a join of a vehicle's id with a text ends with an error. Names that begin with a letter stay texts.
#
# Output seen on 2026-11-30:
#   DuckDB: cell TIMESTAMP 0006-10-22, vehicle_id BIGINT; cell VARCHAR z6-x10-y22, certified_set VARCHAR
#   Polars: cell Date 0022-10-06, vehicle_id Int64; cell String z6-x10-y22, certified_set String
#   pyarrow: cell string, vehicle_id int32; cell string, certified_set string
#
# Needs python3 with venv. Fails if the behaviour is another one.
#
# netcert's data set has folders such as `cell=z6-x10-y22/certified_set=lane-1234`, and the vehicle's id as a column of text.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check duckdb==2.0.1 polars==2.1.0 pyarrow==26.0.1
cat >folders.py <<'PY'
import os

import duckdb
import polars
import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet as pq

kinds = {"before": ("cell=6-10-22", "vehicle_id=1234"), "now": ("cell=z6-x10-y22", "certified_set=lane-1234")}
seen = {"DuckDB": [], "Polars": [], "pyarrow": []}
for folder, (cell, other) in kinds.items():
    os.makedirs(f"{folder}/{cell}/{other}")
    pq.write_table(pa.table({"a": [1]}), f"{folder}/{cell}/{other}/part.parquet")
    second = other.split("=")[0]
    rows = f"read_parquet('{folder}/*/*/*.parquet', hive_partitioning = true)"
    types = {row[0]: row[1] for row in duckdb.sql(f"DESCRIBE SELECT * FROM {rows}").fetchall()}
    value = str(duckdb.sql(f"SELECT cell::VARCHAR FROM {rows}").fetchall()[0][0]).split(" ")[0]
    seen["DuckDB"].append(f"cell {types['cell']} {value}, {second} {types[second]}")
    frame = polars.scan_parquet(f"{folder}/", hive_partitioning=True).collect()
    value = str(frame["cell"][0])
    seen["Polars"].append(f"cell {frame['cell'].dtype} {value}, {second} {frame[second].dtype}")
    schema = pyarrow.dataset.dataset(folder, partitioning="hive").schema
    seen["pyarrow"].append(f"cell {schema.field('cell').type}, {second} {schema.field(second).type}")
for name, words in seen.items():
    print(f"{name}: {'; '.join(words)}")
PY
venv/bin/python folders.py | tee seen
# EXPECTED: a day or a number before, a text now.
if grep -qxF "DuckDB: cell TIMESTAMP 0006-10-22, vehicle_id BIGINT; cell VARCHAR z6-x10-y22, certified_set VARCHAR" seen &&
    grep -qxF "Polars: cell Date 0022-10-06, vehicle_id Int64; cell String z6-x10-y22, certified_set String" seen &&
    grep -qxF "pyarrow: cell string, vehicle_id int32; cell string, certified_set string" seen; then
    echo "as described"
else
    echo "the behaviour has changed" >&2
    exit 1
fi

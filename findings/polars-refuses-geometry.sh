#!/usr/bin/env bash
# Polars reads no column of a Parquet file that has a column of the type GEOMETRY, as all files of GeoParquet 2.0 have.
# A good guess is that a reader takes a type that it does not know for what it is stored as, as Parquet allows, or leaves out that column.
#
# Behaviour (Polars 2.1.0, pyarrow 26.0.1 from PyPI): Polars stops with "LogicalType union has no variant set", also if only other columns are
# asked for. It reads the same lines as bytes (GeoParquet 1.1).
#
# Output seen on 2026-11-30:
#   bytes: (2, 2)
#   GEOMETRY: ComputeError: parquet: File out of specification: LogicalType union has no variant set
#   GEOMETRY, the other column: ComputeError: parquet: File out of specification: LogicalType union has no variant set
#
# Needs python3 with venv. Fails if the behaviour is another one.
#
# Users of netcert who ask for GeoParquet 2.0 cannot read the permits with Polars. So 1.1 is the default.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check polars==2.1.0 pyarrow==26.0.1 geoarrow-pyarrow
cat >read.py <<'PY'
import geoarrow.pyarrow as geoarrow
import polars
import pyarrow as pa
import pyarrow.parquet as pq

lines = geoarrow.as_wkb(["LINESTRING (8 49, 8.1 49.1)", "LINESTRING (9 50, 9.1 50.1)"])
pq.write_table(pa.table({"a": [1, 2], "geometry": lines}), "native.parquet")
pq.write_table(pa.table({"a": [1, 2], "geometry": lines.storage}), "bytes.parquet")
assert "Geometry" in str(pq.ParquetFile("native.parquet").schema.column(1).logical_type)
for name, file, columns in (
    ("bytes", "bytes.parquet", None),
    ("GEOMETRY", "native.parquet", None),
    ("GEOMETRY, the other column", "native.parquet", ["a"]),
):
    try:
        print(f"{name}: {polars.read_parquet(file, columns=columns).shape}")
    except polars.exceptions.ComputeError as error:
        print(f"{name}: ComputeError: {error}")
PY
venv/bin/python read.py | tee seen
# EXPECTED: bytes are read, the native type is not.
if grep -qxF "bytes: (2, 2)" seen && [ "$(grep -c "^GEOMETRY.*LogicalType union has no variant set" seen)" = 2 ]; then
    echo "as described"
else
    echo "the behaviour has changed" >&2
    exit 1
fi

#!/usr/bin/env bash
# A GeoParquet file that DuckDB copies loses `covering`, and GeoPandas refuses to read a part of it.
# A good guess is that `COPY (SELECT * FROM 'a.parquet' ORDER BY …) TO 'b.parquet'` gives the same file in another order.
#
# Behaviour (DuckDB 2.0.1 and GeoPandas 1.2.0 from PyPI): the copy has the column `bbox`, but its metadata are of GeoParquet 1.0, without the
# member `covering` that says what `bbox` is. GeoPandas then refuses to read a box.
#
# Output seen on 2026-11-30:
#   before: 1.1.0, covering: True, rows in the box: 1
#   copy: 1.0.0, covering: False, GeoPandas refuses the box
#
# Needs python3 with venv. Fails if the behaviour is another one.
#
# The page of `export geoparquet` told users to sort the file so. netcert now writes the rows along a curve itself.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check duckdb==2.0.1 geopandas==1.2.0 pyarrow==26.0.1
cat >order.py <<'PY'
import json

import duckdb
import geopandas
import pyarrow.parquet as pq
import shapely

lines = [shapely.LineString([(8, 49), (8.1, 49.1)]), shapely.LineString([(9, 50), (9.1, 50.1)])]
frame = geopandas.GeoDataFrame({"a": [1, 2]}, geometry=lines, crs="EPSG:4326")
frame.to_parquet("before.parquet", schema_version="1.1.0", write_covering_bbox=True)
duckdb.sql("COPY (SELECT * FROM 'before.parquet' ORDER BY a DESC) TO 'copy.parquet' (FORMAT parquet)")
for name in ("before", "copy"):
    geo = json.loads(pq.read_metadata(f"{name}.parquet").metadata[b"geo"])
    try:
        box = f"rows in the box: {len(geopandas.read_parquet(f'{name}.parquet', bbox=(7.9, 48.9, 8.2, 49.2)))}"
    except ValueError:
        box = "GeoPandas refuses the box"
    print(f"{name}: {geo['version']}, covering: {'covering' in geo['columns']['geometry']}, {box}")
PY
venv/bin/python order.py | tee seen
# EXPECTED: the copy lacks what readers of a box need.
if grep -qxF "before: 1.1.0, covering: True, rows in the box: 1" seen &&
    grep -qxF "copy: 1.0.0, covering: False, GeoPandas refuses the box" seen; then
    echo "as described"
else
    echo "the behaviour has changed" >&2
    exit 1
fi

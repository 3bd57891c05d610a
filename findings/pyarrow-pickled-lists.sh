#!/usr/bin/env bash
# pyarrow pickles a list of fixed size without the name of its item, and forgets that the item may not be null. Other lists keep both.
# A good guess is that a table which was pickled, as every process pool does with its results, has the schema of the table before.
#
# Behaviour (pyarrow 26.0.1, CPython 3.11): `pickle.loads(pickle.dumps(table))` turns `fixed_size_list<xy: double not null>[2]` into
# `fixed_size_list<item: double>[2]`. The values stay. Both tables are then unequal, and `pyarrow.concat_tables` refuses to join a table that
# was pickled and one that was not. GeoArrow keeps interleaved coordinates in such lists, with the name of their dimensions (`xy`, `xyz`, `xym`),
# so the name that tells z from m is lost. Arrow's own stream (`pyarrow.ipc`) keeps both.
#
# Output seen on 2026-11-30:
#   before:  list<vertices: fixed_size_list<xym: double not null>[3] not null>
#   pickled: list<vertices: fixed_size_list<item: double>[3] not null>
#   stream:  list<vertices: fixed_size_list<xym: double not null>[3] not null>
#   joining a pickled table and one that was not: ArrowInvalid
#
# Needs Python 3.11 or newer with venv. Fails if the behaviour is another one.
#
# Users of netcert's Python package who make tables in a process pool and join them met an error. `netcert.Table` is pickled as Arrow's stream.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyarrow==26.0.1
"$work/venv/bin/python" - <<'PYTHON'
import pickle
import sys

import pyarrow

coordinates = pyarrow.list_(pyarrow.field("xym", pyarrow.float64(), nullable=False), 3)
lines = pyarrow.list_(pyarrow.field("vertices", coordinates, nullable=False))
field = pyarrow.field("geometry", lines, metadata={"ARROW:extension:name": "geoarrow.linestring"})
table = pyarrow.table([pyarrow.array([[[8.6, 49.4, 0.0], [8.7, 49.5, 12.0]]], lines)], schema=pyarrow.schema([field]))

pickled = pickle.loads(pickle.dumps(table))
sink = pyarrow.BufferOutputStream()
with pyarrow.ipc.new_stream(sink, table.schema) as stream:
    stream.write_table(table)
streamed = pyarrow.ipc.open_stream(sink.getvalue()).read_all()
try:
    pyarrow.concat_tables([table, pickled])
    joined = "joined"
except pyarrow.ArrowInvalid:
    joined = "ArrowInvalid"

for name, one in (("before: ", table), ("pickled:", pickled), ("stream: ", streamed)):
    print(name, one.schema.field("geometry").type)
print("joining a pickled table and one that was not:", joined)
kept = pickled["geometry"].to_pylist() == table["geometry"].to_pylist()
item = pickled.schema.field("geometry").type.value_type.value_field
# EXPECTED: the values stay, the name and `not null` go; Arrow's stream keeps them.
as_described = kept and (item.name, item.nullable) == ("item", True) and joined == "ArrowInvalid" and streamed.equals(table)
print("as described" if as_described else "the behaviour has changed")
sys.exit(not as_described)
PYTHON

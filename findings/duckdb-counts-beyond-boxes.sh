#!/usr/bin/env bash
# DuckDB counts rows of a Parquet file that a condition on members of a struct leaves out, if nothing but a count is asked for.
# A good guess is that `count(*)` is the number of rows that the same query lists.
#
# Behaviour (DuckDB 2.0.1 from PyPI): a box is usually asked for by `bbox.xmin < … AND bbox.xmax > …`, two members of one struct. Where the
# bounds of every group of rows decide the condition for the whole group, the count comes from the file's metadata, and groups that only one
# of the two conditions leaves out are counted. With columns in place of members, with a sum beside the count, or where a group lies partly in the
# box, the count is right. So is that of DuckDB 1.5.2.
#
# Output seen on 2026-11-30:
#   DuckDB 1.5.2: count 2, count beside a sum 2, rows 2, count by columns 2
#   DuckDB 2.0.1: count 4, count beside a sum 2, rows 2, count by columns 2
#
# Needs python3 with venv. Fails if the behaviour is another one.
#
# A planner who counts the permitted roads of a box would be told of roads that are not there. netcert's pages ask for sums, lists and groups.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >count.py <<'PY'
import duckdb
import pyarrow as pa
import pyarrow.parquet as pq

places = [0.0, 0.5, 1.5, 1.6, 3.0, 3.5]
box = [{"low": place, "high": place} for place in places]
pq.write_table(pa.table({"a": range(6), "low": places, "high": places, "box": box}), "a.parquet", row_group_size=2)


def first(query):
    return duckdb.sql(query).fetchall()[0][0]


inside = "FROM 'a.parquet' WHERE box.low < 2 AND box.high > 1"
count = first(f"SELECT count(*) {inside}")
summed = first(f"SELECT count(*), sum(a) {inside}")
rows = len(duckdb.sql(f"SELECT a {inside}").fetchall())
plain = first("SELECT count(*) FROM 'a.parquet' WHERE low < 2 AND high > 1")
print(f"DuckDB {duckdb.__version__}: count {count}, count beside a sum {summed}, rows {rows}, count by columns {plain}")
PY
for version in 1.5.2 2.0.1; do
    python3 -m venv "$version"
    "$version/bin/pip" install --quiet --disable-pip-version-check "duckdb==$version" pyarrow==26.0.1
    "$version/bin/python" count.py
done | tee seen
# EXPECTED: two rows are in the box; 2.0.1 counts four.
if grep -qF "DuckDB 1.5.2: count 2, count beside a sum 2, rows 2, count by columns 2" seen &&
    grep -qF "DuckDB 2.0.1: count 4, count beside a sum 2, rows 2, count by columns 2" seen; then
    echo "as described"
else
    echo "the behaviour has changed" >&2
    exit 1
fi

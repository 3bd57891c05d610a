"""Ids of 63 bits and whole numbers with gaps, through each package that reads rows. Most turns have no `first_arc`."""

import re
import sqlite3

import duckdb
import geopandas
import pandas
import polars
import pyarrow
import pyarrow.dataset
import pyarrow.parquet
import pytest
import shapely
from test_region import TUG, safe_turn

# Doubles round whole numbers above it.
EXACT_IN_DOUBLES = 2**53


@pytest.fixture(scope="module")
def stored(demo_path):
    """Ids of turns with their first and last edge between, as SQLite has them."""
    query = (
        "SELECT t.turn_id, a.edge_id, b.edge_id FROM turn AS t"
        " LEFT JOIN edge AS a ON a.fid = t.first_arc_fid LEFT JOIN edge AS b ON b.fid = t.last_arc_fid"
    )
    with sqlite3.connect(demo_path) as database:
        known = {turn_id: tuple(arcs) for turn_id, *arcs in database.execute(query)}
    arcs = {arc for pair in known.values() for arc in pair}
    assert None in arcs and max(arcs - {None}) > EXACT_IN_DOUBLES and max(known) > EXACT_IN_DOUBLES
    return known


@pytest.fixture(scope="module")
def files(demo_path, tmp_path_factory):
    """Turns as a data set of GeoParquet files."""
    import netcert

    folder = tmp_path_factory.mktemp("table") / "permits"
    netcert.open(demo_path).to_dataset(folder, vehicles=[TUG])
    return folder / "turns"


def of_frame(frame):
    """Ids from a frame of pandas, whose columns of whole numbers have to be `Int64`."""
    whole = frame[["turn_id", "from_edge", "to_edge", "via_node", "first_arc", "last_arc", "limiting_unit"]]
    assert set(map(str, whole.dtypes)) == {"Int64"}
    columns = (whole[name].astype(object).where(whole[name].notna(), None) for name in ("turn_id", "first_arc", "last_arc"))
    return list(zip(*columns, strict=True))


def of_arrow(table):
    return list(zip(*(table[name].to_pylist() for name in ("turn_id", "first_arc", "last_arc")), strict=True))


def of_polars(frame):
    return frame.select("turn_id", "first_arc", "last_arc").rows()


def of_duckdb(relation):
    return relation.project("turn_id, first_arc, last_arc").fetchall()


READERS = {
    "pandas": lambda rows: of_frame(rows.to_pandas()),
    "geopandas": lambda rows: of_frame(rows.to_geopandas()),
    "pyarrow": lambda rows: of_arrow(rows.to_pyarrow()),
    "pyarrow, from the stream": lambda rows: of_arrow(pyarrow.table(rows)),
    "polars": lambda rows: of_polars(rows.to_polars()),
    "polars, from the stream": lambda rows: of_polars(polars.DataFrame(rows)),
    "polars, from pandas": lambda rows: of_polars(polars.from_pandas(rows.to_pandas())),
    "duckdb, from the stream": lambda rows: of_duckdb(duckdb.from_arrow(rows)),
    "duckdb, from pandas": lambda rows: of_duckdb(duckdb.from_df(rows.to_pandas())),
}


@pytest.mark.parametrize("reader", READERS)
def test_ids_are_whole_in_every_reader(demo, stored, reader):
    rows = demo.turns(TUG)
    read = READERS[reader](rows)
    assert len(read) == len(rows) == len(stored)
    assert {turn_id: tuple(arcs) for turn_id, *arcs in read} == stored


FILES = {
    "geopandas": lambda folder: of_frame(geopandas.read_parquet(folder)),
    "pandas": lambda folder: of_frame(pandas.read_parquet(folder)),
    "pyarrow": lambda folder: of_arrow(pyarrow.dataset.dataset(folder).to_table()),
    "polars": lambda folder: of_polars(polars.read_parquet(f"{folder}/**/*.parquet", columns=["turn_id", "first_arc", "last_arc"])),
    "duckdb": lambda folder: of_duckdb(duckdb.sql(f"FROM read_parquet('{folder}/*/*/*.parquet')")),
}


@pytest.mark.parametrize("reader", FILES)
def test_ids_are_whole_in_every_reader_of_a_data_set(stored, files, reader):
    assert {turn_id: tuple(arcs) for turn_id, *arcs in FILES[reader](files)} == stored


def test_types_do_not_depend_on_the_rows(demo):
    some, none = demo.turns(TUG), demo.turns(TUG, min_rsc_m=1e6)
    assert len(none) == 0
    assert none.to_pandas().dtypes.to_dict() == some.to_pandas().dtypes.to_dict()
    units = demo.edges(TUG).to_pandas()
    assert {str(units[name].dtype) for name in ("edge_id", "way_id", "maxspeed_kmh", "limiting_unit")} == {"Int64"}


def test_ids_of_a_route_are_whole(demo):
    _, (start, end) = safe_turn(demo)
    found = demo.route(TUG, start, end)
    told = [feature["properties"] for feature in found.to_geojson()["features"]]
    frame = found.to_geopandas()
    for name in ("edge_id", "from_edge", "to_edge"):
        ids = [members.get(name) for members in told]
        assert max(one for one in ids if one is not None) > EXACT_IN_DOUBLES and None in ids
        assert str(frame[name].dtype) == "Int64"
        assert frame[name].astype(object).where(frame[name].notna(), None).tolist() == ids
    assert frame.safe.tolist()[0] is True


def test_what_a_notebook_and_a_map_show_is_whole(demo):
    rows = demo.turns(TUG)
    arcs = [arc for arc in rows.to_pyarrow()["first_arc"].slice(0, 10).to_pylist() if arc is not None]
    shown = rows._repr_html_()
    assert all(f"<td>{arc}</td>" in shown for arc in arcs)
    # In a script a number would be rounded, but a text is not.
    drawn = rows.explore(tiles=None).get_root().render()
    assert set(map(int, re.findall(r'"turn_id": "(\d+)"', drawn))) == set(rows.to_pyarrow()["turn_id"].to_pylist())


def test_a_table_has_what_frames_have(demo):
    table = demo.edges(TUG)
    assert table.columns == table.column_names == table.schema.names
    first = table.head(3)
    assert len(first) == 3 and first.to_pyarrow().equals(table.to_pyarrow().slice(0, 3))
    assert len(table.head(0)) == len(table.head(-2)) == 0


def test_lines_as_binary_are_the_same_lines(demo):
    table = demo.edges(TUG)
    binary = table.to_pyarrow(geometry="wkb")
    assert binary.column_names == table.column_names
    assert binary.drop_columns(["geometry"]).equals(table.to_pyarrow().drop_columns(["geometry"]))
    lines = shapely.from_wkb(binary.column("geometry").combine_chunks().to_numpy(zero_copy_only=False))
    assert list(lines) == list(table.to_geopandas().geometry)
    assert geopandas.GeoDataFrame.from_arrow(binary).crs.to_epsg() == 4326
    with pytest.raises(ValueError, match="geometry: 'text'"):
        table.to_pyarrow(geometry="text")


def test_polars_and_duckdb_take_a_table_as_it_is(demo):
    table = demo.edges(TUG)
    frame = polars.DataFrame(table)
    assert frame.columns == table.columns and frame["edge_id"].to_list() == table.to_pyarrow()["edge_id"].to_pylist()
    stream = pyarrow.RecordBatchReader.from_stream(table)
    [(count,)] = duckdb.sql("SELECT count(*) FROM stream").fetchall()
    assert count == len(table)


def test_importing_everything_hides_no_builtin():
    named = {}
    exec("from netcert import *", named)
    assert "open" not in named and "certify" in named

"""Permits of all vehicles as a data set of GeoParquet files."""

import dataclasses
import hashlib
import json
import re
import shutil
from pathlib import Path

import duckdb
import geopandas
import netcert
import netcert.dataset
import numpy as np
import pyarrow.dataset
import pyarrow.parquet
import pytest
import shapely

TRUCK, TUG = "AU-SEMI19", "AGV-TUG4"
# The drawn region lies in four of them.
ZOOM = 11


@pytest.fixture(scope="module")
def folder(demo_path, tmp_path_factory):
    path = tmp_path_factory.mktemp("dataset") / "permits"
    netcert.open(demo_path).to_dataset(path, zoom=ZOOM)
    return path


def test_every_row_is_there_once_in_the_cell_where_it_begins(demo, folder):
    for vehicle_id in (TRUCK, TUG):
        for layer, id_name, rows in (("edges", "edge_id", demo.edges(vehicle_id)), ("turns", "turn_id", demo.turns(vehicle_id))):
            known = rows.to_geopandas().set_index(id_name)
            files = list(folder.glob(f"{layer}/cell=*/certified_set=carriageway-{vehicle_id}/part.parquet"))
            parts = [geopandas.read_parquet(file, partitioning=None) for file in files]
            assert sum(map(len, parts)) == len(known) and len(parts) > 1
            for file, part in zip(files, parts, strict=True):
                zoom, column, row = map(int, re.fullmatch(r"cell=z(\d+)-x(\d+)-y(\d+)", file.parts[-3]).groups())
                first = shapely.get_point(part.geometry.values, 0)
                x, y = netcert.dataset.tiles(shapely.get_x(first), shapely.get_y(first), zoom)
                assert zoom == ZOOM and set(x) == {column} and set(y) == {row}
                same = known.loc[part[id_name]]
                assert set(part.vehicle_id) == {vehicle_id} and set(part.corridor) == {"carriageway"}
                assert part.verdict.tolist() == same.verdict.tolist()
                assert part.permitted.tolist() == (same.verdict == "safe").tolist()
                assert shapely.equals_exact(part.geometry.values, same.geometry.values).all()


def test_files_are_geoparquet_with_boxes_that_readers_skip_by(folder):
    for file in folder.glob("edges/*/*/*.parquet"):
        metadata = pyarrow.parquet.read_metadata(file)
        geo = json.loads(metadata.metadata[b"geo"])
        column = geo["columns"]["geometry"]
        assert geo["version"] == "1.1.0" and column["encoding"] == "WKB" and column["geometry_types"] == ["LineString"]
        assert column["covering"]["bbox"]["xmin"] == ["bbox", "xmin"]
        frame = geopandas.read_parquet(file, partitioning=None)
        names = [metadata.schema.column(i).path for i in range(metadata.num_columns)]
        low = metadata.row_group(0).column(names.index("bbox.xmin")).statistics.min
        assert low == pytest.approx(frame.total_bounds[0])
        assert frame.crs == "EPSG:4326"
        groups = [metadata.row_group(number) for number in range(metadata.num_row_groups)]
        assert all(group.num_rows <= 2048 for group in groups)
        assert {group.column(i).compression for group in groups for i in range(group.num_columns)} == {"ZSTD"}


def test_a_column_has_the_same_type_in_every_file(folder):
    """Also where a cell has no number in it: engines take the types from any of the files."""
    for layer in ("edges", "turns"):
        files = list(folder.glob(f"{layer}/*/*/*.parquet"))
        schemas = [pyarrow.parquet.read_schema(file).remove_metadata() for file in files]
        assert len(files) > 4 and all(schema.equals(schemas[0]) for schema in schemas)
        some = [pyarrow.parquet.read_table(file, partitioning=None) for file in files]
        empty = {name for part in some for name in part.column_names if part[name].null_count == len(part)}
        assert empty, "no file lacks all values of a column"


def test_sedona_reads_only_files_that_meet_a_box(folder):
    sedonadb = pytest.importorskip("sedonadb", reason="pip install sedonadb geoarrow-pyarrow")
    session = sedonadb.connect()
    session.read_parquet(f"{folder}/edges/").to_view("edges")
    frame = geopandas.read_parquet(folder / "edges")
    largest = max(sorted(folder.glob("edges/*/*/*.parquet")), key=lambda file: pyarrow.parquet.read_metadata(file).num_rows)
    west, south, east, north = geopandas.read_parquet(largest, partitioning=None).total_bounds
    box = shapely.box(west, south, (west + east) / 2, (south + north) / 2)
    query = (
        "SELECT vehicle_id, count(*) AS edges FROM edges WHERE permitted AND "
        f"ST_Intersects(geometry, ST_SetSRID(ST_GeomFromWKT('{box.wkt}'), 4326)) GROUP BY vehicle_id ORDER BY vehicle_id"
    )
    found = session.sql(query).to_arrow_table().to_pydict()
    known = frame[frame.permitted & frame.intersects(box)].groupby("vehicle_id", observed=True).size()
    assert dict(zip(found["vehicle_id"], found["edges"], strict=True)) == known.to_dict() and len(known) == 2
    plan = str(session.sql(f"EXPLAIN ANALYZE {query}").to_arrow_table().to_pydict())
    files, met = map(int, re.search(r"files_ranges_spatial_pruned=(\d+) total → (\d+) matched", plan).groups())
    assert 0 < met < files


def test_a_reader_reads_only_the_files_of_a_cell_and_vehicle(folder, tmp_path):
    """All other files are broken, and nobody notices. DuckDB takes the columns from the first file, so that one is asked for."""
    broken = tmp_path / "permits"
    shutil.copytree(folder, broken)
    files = sorted(broken.glob("edges/*/*/*.parquet"))
    wanted, others = files[0], files[1:]
    count = pyarrow.parquet.read_metadata(wanted).num_rows
    for other in others:
        other.write_bytes(b"no Parquet")
    cell, certified_set = (part.split("=")[1] for part in wanted.parts[-3:-1])
    assert certified_set == netcert.dataset.set_name("carriageway", TUG) and len(others) == 7
    rows = f"read_parquet('{broken}/edges/*/*/*.parquet', hive_partitioning = true)"
    counted = duckdb.sql(f"SELECT count(*) FROM {rows} WHERE cell = '{cell}' AND certified_set = '{certified_set}'").fetchall()
    assert counted == [(count,)]
    some = (pyarrow.dataset.field("cell") == cell) & (pyarrow.dataset.field("certified_set") == certified_set)
    assert pyarrow.dataset.dataset(broken / "edges", partitioning="hive").to_table(filter=some).num_rows == count


def test_geopandas_reads_a_box(demo, folder):
    frame = demo.edges(TRUCK).to_geopandas()
    west, south, east, north = frame.total_bounds
    box = (west, south, (west + east) / 2, (south + north) / 2)
    found = geopandas.read_parquet(folder / "edges", bbox=box, filters=[("vehicle_id", "==", TRUCK)])
    assert set(found.edge_id) >= set(frame[frame.intersects(shapely.box(*box))].edge_id) and len(found) < len(frame)


class Renamed:
    """The region with a vehicle whose id is digits."""

    ID = "1234"

    def __init__(self, region):
        self.region, self.path, self._file = region, region.path, self

    def origin(self, vehicle_id, corridor):
        assert vehicle_id == self.ID
        return self.region._file.origin(TUG, corridor)

    def vehicle(self, vehicle_id):
        return self.region.vehicle(TUG)

    def sets(self):
        return [dataclasses.replace(known, vehicle_id=self.ID) for known in self.region.sets() if known.vehicle_id == TUG]

    def edges(self, vehicle_id, corridor):
        table = self.region.edges(TUG, corridor=corridor).to_pyarrow()
        place = table.column_names.index("vehicle_id")
        return Arrow(table.set_column(place, "vehicle_id", pyarrow.array([self.ID] * len(table))))

    def turns(self, vehicle_id, corridor):
        return self.region.turns(TUG, corridor=corridor)


class Arrow:
    def __init__(self, table):
        self.table = table

    def to_pyarrow(self):
        return self.table


def test_no_reader_takes_the_name_of_a_folder_for_a_day_or_a_number(demo, tmp_path):
    polars = pytest.importorskip("polars")
    netcert.dataset.write(Renamed(demo), tmp_path / "permits", None, 6, "1.1")
    rows = f"read_parquet('{tmp_path}/permits/edges/*/*/*.parquet', hive_partitioning = true)"
    names = ["cell", "certified_set", "vehicle_id"]
    types = {name: kind for name, kind, *_ in duckdb.sql(f"DESCRIBE SELECT * FROM {rows}").fetchall()}
    assert [types[name] for name in names] == ["VARCHAR"] * 3
    frame = polars.scan_parquet(tmp_path / "permits/edges", hive_partitioning=True).select(names).collect()
    assert frame.dtypes == [polars.String] * 3
    assert frame.unique().rows() == [("z6-x54-y37", "carriageway-1234", "1234")]
    schema = pyarrow.dataset.dataset(tmp_path / "permits/edges", partitioning="hive").schema
    assert [str(schema.field(name).type) for name in names] == ["string"] * 3


def test_lines_of_geoparquet_2_have_the_type_of_the_format(demo, folder, tmp_path):
    demo.to_dataset(tmp_path / "permits", zoom=ZOOM, geoparquet="2.0")
    about = json.loads((tmp_path / "permits/netcert.json").read_text())
    assert about["geoparquet"] == "2.0"
    for file in (tmp_path / "permits").rglob("*.parquet"):
        metadata = pyarrow.parquet.read_metadata(file)
        names = [metadata.schema.column(i).path for i in range(metadata.num_columns)]
        column = names.index("geometry")
        assert json.loads(metadata.metadata[b"geo"])["version"] == "2.0.0"
        assert metadata.schema.column(column).logical_type.type == "GEOMETRY"
        frame = geopandas.read_parquet(file, partitioning=None)
        bounds = metadata.row_group(0).column(column).geo_statistics
        assert [bounds.xmin, bounds.ymin, bounds.xmax, bounds.ymax] == pytest.approx(frame.total_bounds)
        older = geopandas.read_parquet(folder / file.relative_to(tmp_path / "permits"), partitioning=None)
        assert frame.equals(older) and frame.crs == older.crs == "EPSG:4326"
    with pytest.raises(ValueError, match="expected 1.1 or 2.0"):
        demo.to_dataset(tmp_path / "permits", geoparquet="1.0")


def test_it_says_what_it_depends_on_and_is_replaced_whole(demo, folder, tmp_path):
    about = json.loads((folder / "netcert.json").read_text())
    assert "no permit to drive" in about["scope"] and {known["vehicle_id"] for known in about["sets"]} == {TRUCK, TUG}
    assert about["layout"] == 2 and about["netcert"] == netcert.__version__ and about["geoparquet"] == "1.1"
    assert about["licence"] == "© OpenStreetMap contributors, ODbL 1.0"
    assert about["database"]["sha256"] == hashlib.sha256(Path(demo.path).read_bytes()).hexdigest()
    assert re.fullmatch("[0-9a-f]{64}", about["input"]["blake3"]) and about["made_by"]["netcert"].startswith(netcert.__version__)
    assert about["vehicles"][TUG] == demo.vehicle(TUG).to_dict()
    hashes = dict(line.split("  ")[::-1] for line in (folder / "SHA256SUMS").read_text().splitlines())
    files = {file.relative_to(folder).as_posix() for file in folder.rglob("*") if file.is_file()} - {"SHA256SUMS"}
    assert hashes.keys() == files
    assert all(hashlib.sha256((folder / file).read_bytes()).hexdigest() == found for file, found in hashes.items())
    target = tmp_path / "permits"
    demo.to_dataset(target, vehicles=[TUG], zoom=ZOOM)
    first = {file.relative_to(target): file.read_bytes() for file in target.rglob("*.parquet")}
    demo.to_dataset(target, vehicles=[TUG], zoom=ZOOM)
    assert first == {file.relative_to(target): file.read_bytes() for file in target.rglob("*.parquet")}
    assert not list(tmp_path.glob("*.part"))


def test_what_cannot_be_written_is_refused(demo, tmp_path):
    with pytest.raises(netcert.NotFound, match="EU-SEMI16.5 not certified"):
        demo.to_dataset(tmp_path / "a", vehicles=["EU-SEMI16.5"])
    with pytest.raises(ValueError, match="zoom"):
        demo.to_dataset(tmp_path / "a", zoom=99)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/letter.txt").write_text("dear")
    with pytest.raises(FileExistsError, match="mine"):
        demo.to_dataset(tmp_path / "mine")
    assert (tmp_path / "mine/letter.txt").read_text() == "dear" and not (tmp_path / "a").exists()


def test_tiles_are_those_of_maps_on_the_web():
    lon, lat = np.array([-180.0, 179.9999, 0.0, 13.4]), np.array([85.05, -85.05, 0.0, 52.52])
    x, y = netcert.dataset.tiles(lon, lat, 10)
    assert x.tolist() == [0, 1023, 512, 550] and y.tolist() == [0, 1023, 512, 335]

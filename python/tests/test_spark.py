"""A region certified by Spark. The database has the bytes of `netcert ingest`."""

import os
import shutil
import sys

import netcert
import netcert.spark
import pandas
import pytest
from conftest import ROOT, extract

pyspark = pytest.importorskip("pyspark", reason="pip install pyspark")
if shutil.which("java") is None:
    pytest.skip("no Java: apt-get install openjdk-17-jre-headless", allow_module_level=True)

VEHICLES = ("AU-SEMI19", "AGV-TUG4")
EXTRACT = ROOT / "data/demo.osm.pbf"


@pytest.fixture(scope="module")
def spark(tmp_path_factory):
    from pyspark.sql import SparkSession

    os.environ["PYSPARK_PYTHON"] = sys.executable
    folder = tmp_path_factory.mktemp("spark")
    session = (
        SparkSession.builder.master("local[2]")
        .config("spark.ui.enabled", "false")
        .config("spark.sql.warehouse.dir", str(folder))
        .config("spark.sql.shuffle.partitions", "4")
        .getOrCreate()
    )
    yield session
    session.stop()


@pytest.fixture(scope="module")
def fleet(catalogue):
    return [catalogue[name] for name in VEHICLES]


@pytest.fixture(scope="module")
def cells(run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("cells") / "demo"
    run("cells", "-q", EXTRACT, "--out", folder, "--edges-at-once", 40)
    return folder


@pytest.fixture(scope="module")
def same_time():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOURCE_DATE_EPOCH", "1700000000")
        yield


@pytest.fixture(scope="module")
def ingested(run, same_time, tmp_path_factory):
    path = tmp_path_factory.mktemp("ingested") / "demo.gpkg"
    run("ingest", "-q", EXTRACT, "--db", path, "--vehicle", *VEHICLES)
    return path


def test_the_database_has_the_bytes_of_one_machine(spark, fleet, cells, ingested, run, tmp_path):
    summary = netcert.spark.certify(cells, fleet, spark=spark)
    assert summary.tasks == 4 and summary.failed == {} and summary.task_seconds > 0
    path = tmp_path / "demo.gpkg"
    run("assemble", "-q", cells, "--db", path)
    assert path.read_bytes() == ingested.read_bytes()


def test_overture_files_make_the_bytes_of_one_machine_too(spark, fleet, ingested, same_time, run, tmp_path):
    source, folder = tmp_path / "overture", tmp_path / "cells"
    run("export", "overture", "-q", "--db", ingested, "--vehicle", VEHICLES[0], "--out", source)
    run("cells", "-q", source, "--out", folder, "--edges-at-once", 40)
    summary = netcert.spark.certify(folder, fleet[:1], spark=spark)
    assert summary.tasks == 4 and summary.failed == {}
    assembled, whole = tmp_path / "assembled.gpkg", tmp_path / "whole.gpkg"
    run("assemble", "-q", folder, "--db", assembled)
    run("ingest", "-q", source, "--db", whole, "--vehicle", VEHICLES[0])
    assert assembled.read_bytes() == whole.read_bytes()
    run("certify", "-q", "--db", assembled, "--vehicle", VEHICLES[1])
    assert [known.vehicle_id for known in netcert.open(assembled).sets()] == list(VEHICLES)


def test_a_task_that_cannot_be_done_is_named_and_the_others_are_certified(spark, fleet, cells, ingested, run, tmp_path):
    from pyspark.sql import functions

    table = spark.read.parquet(str(cells / "tasks.parquet"))
    bad = 1
    broken = functions.when(functions.col("task") == bad, functions.substring("network", 1, 300)).otherwise(functions.col("network"))
    out = tmp_path / "results"
    summary = netcert.spark.certify(table.withColumn("network", broken), fleet, out, spark=spark)
    assert list(summary.failed) == [bad] and f"task {bad}" in str(summary)
    path = tmp_path / "demo.gpkg"
    with pytest.raises(Exception) as told:
        run("assemble", "-q", cells, "--results", out, "--db", path)
    assert f"task {bad}: the task cannot be read" in told.value.stderr
    whole, some = netcert.open(ingested), netcert.open(path)
    owned = table.where(f"task = {bad}").first()
    for vehicle in fleet:
        before, after = (region.edges(vehicle.id).to_pandas() for region in (whole, some))
        failed = after.reason == "failed"
        assert failed.sum() == owned.edges and set(after[failed].verdict) == {"unknown"}
        pandas.testing.assert_frame_equal(after[~failed], before[~failed], check_dtype=False)
        turns = some.turns(vehicle.id).to_pandas()
        assert (turns.reason == "failed").sum() >= owned.turns
    assert "unknown" in run("verify", "--db", path, "--vehicle", VEHICLES[0])


def test_results_of_another_extract_or_job_are_refused(spark, fleet, cells, run, tmp_path):
    from pyspark.sql import functions

    netcert.spark.certify(cells, fleet, spark=spark)
    results = cells / "certified"
    path = tmp_path / "region.gpkg"

    def refused(*arguments):
        with pytest.raises(Exception) as told:
            run("assemble", "-q", cells, "--db", path, *arguments)
        assert not path.exists()
        return told.value.stderr

    assert "another extract" in refused("--extract", extract("sydney_au.osm.pbf"))
    assert "no results" in refused("--results", ROOT / "python/tests")
    mixed = tmp_path / "mixed"
    shutil.copytree(results, mixed)
    other = netcert.spark.certify(cells, fleet[:1], tmp_path / "other", spark=spark)
    assert other.failed == {}
    shutil.copytree(tmp_path / "other/strokes", mixed / "again")
    assert "several jobs" in refused("--results", mixed)
    lacking = tmp_path / "lacking"
    spark.read.parquet(str(results / "strokes")).where(functions.col("task") != 1).write.parquet(str(lacking / "strokes"))
    shutil.copytree(results / "turns", lacking / "turns")
    assert "task 1 lack" in refused("--results", lacking)


def test_bins_are_even():
    costs = {task: float(cost) for task, cost in enumerate([90, 10, 10, 10, 30, 30, 20, 60, 1, 1])}
    chosen = netcert.spark.bins(costs, 3)
    filled = [sum(costs[task] for task in costs if chosen[task] == number) for number in range(3)]
    assert sorted(chosen) == sorted(costs) and max(filled) <= 4 / 3 * max(sum(costs.values()) / 3, 90)


def test_spark_reads_a_data_set_as_one_table(spark, ingested, tmp_path):
    folder = tmp_path / "permits"
    netcert.open(ingested).to_dataset(folder, zoom=11)
    read = spark.read.parquet(f"{folder}/edges").where("permitted").groupBy("vehicle_id").agg({"limiting_unit": "max", "edge_id": "count"})
    found = {row["vehicle_id"]: (row["count(edge_id)"], row["max(limiting_unit)"]) for row in read.collect()}
    region = netcert.open(ingested)
    for vehicle in VEHICLES:
        edges = region.edges(vehicle).to_pandas()
        safe = edges[edges.verdict == "safe"]
        assert found[vehicle] == (len(safe), safe.limiting_unit.max())

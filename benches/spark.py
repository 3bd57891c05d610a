#!/usr/bin/env python3
"""Apache Spark beside threads of one machine, on the same extract: wall seconds, a worker killed in the middle, and whether bytes are equal.

    benches/spark.py NETCERT EXTRACT.osm.pbf VEHICLE TASKS.csv [EDGES_AT_ONCE]

NETCERT is the program. The Python that runs this needs the package `netcert` of the same build, pyarrow, PySpark and Java. TASKS.csv gets length, turns
and seconds of each task, for benches/planet.py.
"""

import csv
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path


def timed(*command):
    begin = time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env={**os.environ, "SOURCE_DATE_EPOCH": "1700000000"})
    return time.monotonic() - begin


def executors():
    """Process ids of Spark's executors on this machine."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            line = (entry / "cmdline").read_bytes() if entry.name.isdigit() else b""
        except OSError:
            continue
        if b"CoarseGrainedExecutorBackend" in line:
            found.append(int(entry.name))
    return sorted(found)


def kill_one_later(seconds):
    """Kills an executor after some seconds, as a machine that is lost. Returns the list that gets its process id."""
    killed = []

    def kill():
        for process in executors()[:1]:
            os.kill(process, signal.SIGKILL)
            killed.append(process)

    timer = threading.Timer(seconds, kill)
    timer.daemon = True
    timer.start()
    return killed


def certified(master, cells, vehicle, kill_after=None):
    """Wall seconds, summary and process ids killed, of a session of its own."""
    import netcert.spark
    from pyspark.sql import SparkSession

    spark = SparkSession.builder.master(master).config("spark.ui.enabled", "false").config("spark.driver.memory", "1g").getOrCreate()
    spark.sparkContext.setLogLevel("ERROR")
    try:
        spark.range(8).count()  # executors have started
        killed = [] if kill_after is None else kill_one_later(kill_after)
        begin = time.monotonic()
        summary = netcert.spark.certify(cells, [netcert.vehicles()[vehicle]], spark=spark)
        return time.monotonic() - begin, summary, killed
    finally:
        spark.stop()


def main():
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    program, extract, vehicle, tasks, *size = sys.argv[1:]
    os.environ["PYSPARK_PYTHON"] = sys.executable
    with tempfile.TemporaryDirectory(dir=".") as folder:
        one, many, cells = (str(Path(folder) / name) for name in ("one.gpkg", "many.gpkg", "cells"))
        print("| how | wall s | certify s | tasks |\n| --- | --- | --- | --- |", flush=True)
        for threads in ("1", "2"):
            wall = timed(program, "ingest", "-q", extract, "--db", one, "--vehicle", vehicle, "--threads", threads)
            print(f"| `ingest --threads {threads}` | {wall:.0f} | | |", flush=True)
        divided = timed(program, "cells", "-q", extract, "--out", cells, *(["--edges-at-once", *size] if size else []))
        stored = os.path.getsize(Path(cells) / "tasks.parquet") / 1e6
        print(f"| `cells` ({stored:.0f} MB) | {divided:.0f} | | |", flush=True)
        for workers, kill_after in ((1, None), (2, None), (2, 40)):
            master = f"local-cluster[{workers},1,1024]"
            wall, summary, killed = certified(master, cells, vehicle, kill_after)
            if summary.failed:
                sys.exit(str(summary))
            assembled = timed(program, "assemble", "-q", cells, "--db", many)
            same = Path(one).read_bytes() == Path(many).read_bytes()
            how = f"`{master}`" + (f", a worker killed after {kill_after} s" if killed else "")
            print(f"| {how}; `assemble` {assembled:.0f} s; {'equal bytes' if same else 'OTHER BYTES'} | "
                  f"{divided + wall + assembled:.0f} | {wall:.0f} | {summary.tasks} |", flush=True)
        write_tasks(cells, tasks)
        shutil.rmtree(cells)


def write_tasks(cells, path):
    import pyarrow.dataset as dataset

    known = dataset.dataset(f"{cells}/tasks.parquet").to_table(columns=["task", "length_km", "turns", "edges"]).to_pylist()
    done = dataset.dataset(f"{cells}/certified", partitioning=None)
    seconds = {}
    for row in done.to_table(columns=["task", "stage", "seconds"]).to_pylist():
        seconds[row["task"], row["stage"]] = row["seconds"]
    with open(path, "w", newline="", encoding="utf-8") as out:
        table = csv.writer(out)
        table.writerow(["task", "edges", "length_km", "turns", "strokes_s", "turns_s"])
        for row in sorted(known, key=lambda row: row["task"]):
            task = row["task"]
            times = [f"{seconds[task, stage]:.2f}" for stage in ("strokes", "turns")]
            table.writerow([task, row["edges"], f"{row['length_km']:.1f}", row["turns"], *times])


if __name__ == "__main__":
    main()

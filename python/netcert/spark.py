"""Certifies a region with Apache Spark.

`netcert cells region.osm.pbf --out FOLDER` writes the tasks. `certify` certifies them on the machines of a cluster. `netcert assemble
FOLDER --db region.gpkg` makes the database, with the bytes that `netcert ingest` makes.

Spark tries a task again if its machine fails. A task that netcert itself cannot do is named in the summary, and its roads become
`unknown`; all others are certified.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _netcert

if TYPE_CHECKING:
    import pyarrow
    from pyspark.sql import DataFrame, SparkSession

    from ._netcert import Vehicle

# Seconds a vehicle of a task: measured on Rhein-Neckar with EU-SEMI16.5 (docs/decisions/cluster.md). Only their ratio matters.
_SECONDS_A_KM = 0.0103
_SECONDS_A_TURN = 0.00095
# Parts for each core. More let a machine that is done early take over; each costs some 10 ms.
_BINS_A_CORE = 8

_RESULT = "task int, stage string, job string, seconds double, error string, verdicts binary, work binary"


@dataclass(frozen=True)
class Summary:
    """What became of the tasks."""

    tasks: int
    """Number of tasks."""
    seconds: float
    """Wall time."""
    task_seconds: float
    """Time of all tasks together, on one core each."""
    failed: dict[int, str] = field(default_factory=dict)
    """Tasks that failed, with the reason. Their roads are `unknown`."""

    def __str__(self) -> str:
        done = f"{self.tasks} tasks in {self.seconds:.0f} s, {self.task_seconds:.0f} s of work"
        if not self.failed:
            return done
        named = "; ".join(f"task {task}: {why}" for task, why in sorted(self.failed.items()))
        return f"{done}; {len(self.failed)} failed, so the roads there are unknown: {named}"


def certify(
    cells: str | os.PathLike[str] | DataFrame,
    vehicles: Sequence[Vehicle],
    out: str | os.PathLike[str] | None = None,
    *,
    spark: SparkSession | None = None,
    turns: bool = True,
    **options: Any,
) -> Summary:
    """Certifies vehicles on all tasks of a region, and writes the results as Parquet.

    cells     the folder that `netcert cells` wrote, or its table as a DataFrame
    vehicles  the vehicles
    out       the folder to write [default: `certified` in the folder of the tasks]; results of an earlier run in it are replaced
    spark     the session [default: the active one, or a local one with a thread for each core]
    turns     whether to certify turns, too
    options   corridor, turn_corridor, needs, max_shift_m, map_tolerance_m, smoothing_tolerance_m: as `netcert ingest`

    Edges come first. Turns need the verdicts of edges in the tasks around; Spark brings them together by a join.
    """
    from pyspark.sql import SparkSession, functions

    begun = time.monotonic()
    job = _netcert.write_job(list(vehicles), turns=turns, **options)
    session = spark or SparkSession.getActiveSession() or _local_session()
    if isinstance(cells, (str, os.PathLike)):
        if out is None:
            out = Path(cells) / "certified"
        table = session.read.parquet(str(Path(cells) / "tasks.parquet"))
    else:
        if out is None:
            raise ValueError("out: name the folder for the results, because `cells` is no folder")
        table = cells
    strokes_path, turns_path = f"{out}/strokes", f"{out}/turns"
    spread, count = _with_bins(session, table, len(vehicles))
    strokes = _spread(spread, count).select("task", "network").mapInArrow(_Strokes(job), _RESULT)
    strokes.write.mode("overwrite").parquet(strokes_path)
    written = session.read.parquet(strokes_path)
    if turns:
        verdicts = written.select(functions.col("task").alias("need"), "verdicts")
        own = functions.array(functions.col("task").cast("string"))
        needs = functions.split(functions.trim("needs"), " +")
        met = functions.filter(functions.concat(own, needs), lambda need: need != "")
        around = (
            table.select("task", functions.explode(met.cast("array<int>")).alias("need"))
            .join(verdicts, "need")
            .groupBy("task")
            .agg(
                functions.collect_list("verdicts").alias("around"),
                functions.max(functions.col("verdicts").isNull()).alias("incomplete"),
            )
        )
        ready = _spread(spread.join(around, "task", "left"), count).select("task", "network", "around", "incomplete")
        ready.mapInArrow(_Turns(job), _RESULT).write.mode("overwrite").parquet(turns_path)
        written = written.unionByName(session.read.parquet(turns_path))
    else:
        _remove(turns_path)
    rows = written.select("task", "seconds", "error").collect()
    failed = {row.task: row.error for row in rows if row.error is not None}
    return Summary(
        tasks=len({row.task for row in rows}),
        seconds=time.monotonic() - begun,
        task_seconds=sum(row.seconds for row in rows),
        failed=failed,
    )


def _local_session() -> SparkSession:
    """A session on this machine, with this interpreter for its workers."""
    from pyspark.sql import SparkSession

    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    return SparkSession.builder.appName("netcert").getOrCreate()


def cost_s(length_km: float, turns: int, vehicles: int = 1) -> float:
    """Estimated seconds of a task on one core."""
    return vehicles * (length_km * _SECONDS_A_KM + turns * _SECONDS_A_TURN)


def bins(costs: dict[int, float], count: int) -> dict[int, int]:
    """Spreads tasks over `count` bins so that the fullest one is not much fuller than it must be: the dearest task first, each into the
    emptiest bin (Graham's rule, at most 4/3 of the best).

    >>> import netcert.spark
    >>> netcert.spark.bins({0: 5.0, 1: 1.0, 2: 2.0, 3: 2.0}, 2)
    {0: 0, 2: 1, 3: 1, 1: 1}
    """
    filled = [0.0] * count
    chosen: dict[int, int] = {}
    for task in sorted(costs, key=lambda task: (-costs[task], task)):
        emptiest = min(range(count), key=filled.__getitem__)
        chosen[task] = emptiest
        filled[emptiest] += costs[task]
    return chosen


def _with_bins(session: SparkSession, table: DataFrame, vehicles: int) -> tuple[DataFrame, int]:
    """The tasks with their bins, and the number of bins."""
    known = table.select("task", "length_km", "turns").collect()
    costs = {row.task: cost_s(row.length_km, row.turns, vehicles) for row in known}
    count = max(1, min(len(costs), _BINS_A_CORE * session.sparkContext.defaultParallelism))
    chosen = session.createDataFrame(list(bins(costs, count).items()), "task int, bin int")
    return table.join(chosen, "task"), count


def _spread(table: DataFrame, count: int) -> DataFrame:
    """A partition for each bin."""
    from pyspark.sql import functions

    return table.repartitionById(count, functions.col("bin"))


def _remove(folder: str) -> None:
    import shutil

    if "://" not in folder:
        shutil.rmtree(folder, ignore_errors=True)


class _Work:
    """What a machine does with tasks. Spark sends it to the machines."""

    stage = ""

    def __init__(self, job: str) -> None:
        self.job = job

    def __call__(self, batches: Iterable[pyarrow.RecordBatch]) -> Iterator[pyarrow.RecordBatch]:
        import pyarrow

        # A machine runs a worker for each core.
        os.environ.setdefault("RAYON_NUM_THREADS", "1")
        schema = pyarrow.schema([
            ("task", pyarrow.int32()),
            ("stage", pyarrow.string()),
            ("job", pyarrow.string()),
            ("seconds", pyarrow.float64()),
            ("error", pyarrow.string()),
            ("verdicts", pyarrow.binary()),
            ("work", pyarrow.binary()),
        ])  # fmt: skip
        for batch in batches:
            # One row after the other: a row has a network and its certificates.
            for row in range(batch.num_rows):
                task = {name: batch.column(name)[row].as_py() for name in batch.schema.names}
                done = {"task": task["task"], "stage": self.stage, "job": self.job}
                begun = time.monotonic()
                try:
                    done |= self.done(task)
                except Exception as error:  # noqa: BLE001 (whatever it is: one bad task must not end the others)
                    done |= {"error": str(error) or type(error).__name__}
                done["seconds"] = time.monotonic() - begun
                yield pyarrow.RecordBatch.from_pylist([done], schema=schema)

    def done(self, task: dict[str, Any]) -> dict[str, Any]:
        raise NotImplementedError


class _Strokes(_Work):
    stage = "strokes"

    def done(self, task: dict[str, Any]) -> dict[str, Any]:
        work, verdicts = _netcert.certify_strokes(self.job, task["network"])
        return {"work": work, "verdicts": verdicts}


class _Turns(_Work):
    stage = "turns"

    def done(self, task: dict[str, Any]) -> dict[str, Any]:
        around = task["around"] or []
        incomplete = task["incomplete"] is not False
        return {"work": _netcert.certify_turns(self.job, task["network"], around, incomplete=incomplete)}

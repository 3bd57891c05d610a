"""Permits of all vehicles as one data set of GeoParquet files, which DuckDB, SedonaDB, GeoPandas and Spark filter by place without reading it all.

    FOLDER/netcert.json                                            what the permits depend on
    FOLDER/edges/cell=8-134-87/vehicle_id=EU-SEMI16.5/lane.parquet  edges that begin in a cell, with verdicts for a vehicle
    FOLDER/turns/cell=…/vehicle_id=…/lane.parquet                   turns, where they are certified

Cells are tiles as maps on the web have them: zoom, column, row. Within a file rows follow a Z-shaped curve, so groups of rows have small boxes.
"""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import errors
from .table import pandas_type

if TYPE_CHECKING:
    import pyarrow
    from numpy.typing import NDArray

    from .region import CertifiedSet, Region
    from .table import Table

# Zoom of the order of rows: a cell of it is 40 m wide at the equator.
_FINE = 20
# Rows of a group. Readers skip whole groups; smaller ones have more bounds to read.
_GROUP_ROWS = 8192
_SCOPE = (
    "permitted means that the verdict is safe: within the stated model, widths and error bounds. It is no permit to drive and says "
    "nothing of bridges or traffic. Whole routes are not certified; an engine that joins edges and turns joins what is safe by itself."
)


def write(region: Region, folder: str | os.PathLike[str], vehicles: list[str] | None, zoom: int) -> None:
    """Writes the data set. The folder is complete or absent; an older data set in it is replaced."""
    if not 0 <= zoom <= 16:
        raise ValueError(f"zoom: {zoom}; expected 0 to 16")
    sets = [known for known in region.sets() if vehicles is None or known.vehicle_id in vehicles]
    missing = sorted(set(vehicles or ()) - {known.vehicle_id for known in sets})
    if missing:
        raise errors.NotFound(f"{region.path}: {', '.join(missing)} not certified here; `netcert certify --vehicle ID` does it")
    if not sets:
        raise errors.NotFound(f"{region.path}: no vehicle is certified here; `netcert certify --vehicle ID` does it")
    target = Path(folder)
    if target.exists() and any(target.iterdir()) and not (target / "netcert.json").is_file():
        raise FileExistsError(f"{target}: other files are in this folder; name another one")
    part = target.with_name(target.name + ".part")
    shutil.rmtree(part, ignore_errors=True)
    try:
        for known in sets:
            _layer(region.edges(known.vehicle_id, corridor=known.corridor), part / "edges", known, zoom)
            if known.turns:
                _layer(region.turns(known.vehicle_id, corridor=known.corridor), part / "turns", known, zoom)
        about = {"database": Path(region.path).name, "zoom": zoom, "scope": _SCOPE, "sets": [vars(known) for known in sets]}
        part.mkdir(parents=True, exist_ok=True)
        (part / "netcert.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
        old = target.with_name(target.name + ".old")
        shutil.rmtree(old, ignore_errors=True)
        if target.exists():
            target.rename(old)
        part.rename(target)
        shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _layer(rows: Table, folder: Path, known: CertifiedSet, zoom: int) -> None:
    import geopandas
    import pandas
    import pyarrow
    import pyarrow.compute

    table = rows.to_pyarrow()
    x, y = tiles(*_first_positions(table), _FINE)
    order = np.argsort(_interleaved(x, y), kind="stable")
    shift = _FINE - zoom
    cells = np.stack([x >> shift, y >> shift], axis=1)[order]
    if len(cells) == 0:
        return
    permitted = pyarrow.compute.equal(table["verdict"], "safe")
    table = table.append_column("permitted", permitted).drop_columns(["vehicle_id"])
    # Rows of a cell follow each other, because the curve stays in a cell until all of it is done.
    begins = np.flatnonzero(np.any(np.diff(cells, axis=0) != 0, axis=1)) + 1
    for begin, end in zip([0, *begins], [*begins, len(cells)], strict=True):
        column, row = cells[begin]
        place = folder / f"cell={zoom}-{column}-{row}" / f"vehicle_id={known.vehicle_id}"
        place.mkdir(parents=True, exist_ok=True)
        # Types that do not depend on the values, so that a column without a number is of the same type in every file.
        rows_here = table.take(pyarrow.array(order[begin:end]))
        mapper = {"types_mapper": lambda kind: pandas_type(kind) or pandas.ArrowDtype(kind)}
        some = geopandas.GeoDataFrame.from_arrow(rows_here, to_pandas_kwargs=mapper)
        some.to_parquet(
            place / f"{known.corridor}.parquet",
            index=False,
            schema_version="1.1.0",
            write_covering_bbox=True,
            row_group_size=_GROUP_ROWS,
            compression="zstd",
        )


def _first_positions(table: pyarrow.Table) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Longitude and latitude at which each row's line begins, degrees."""
    lines: Any = table["geometry"].combine_chunks()
    lines = getattr(lines, "storage", lines)
    if len(lines) == 0:
        return np.empty(0), np.empty(0)
    positions = lines.flatten().flatten().to_numpy(zero_copy_only=False).reshape(-1, 2)
    offsets = lines.offsets.to_numpy()
    first = positions[offsets[:-1] - offsets[0]]
    return first[:, 0], first[:, 1]


def tiles(lon: NDArray[np.float64], lat: NDArray[np.float64], zoom: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Columns and rows of the tiles with these places (Web Mercator; row 0 is in the north).

    >>> import numpy
    >>> import netcert.dataset
    >>> netcert.dataset.tiles(numpy.array([8.68]), numpy.array([49.41]), 8)
    (array([134]), array([87]))
    """
    count = 1 << zoom
    across = (lon + 180) / 360
    down = 0.5 - np.arcsinh(np.tan(np.radians(lat))) / (2 * np.pi)
    column, row = (np.clip(np.floor(share * count), 0, count - 1).astype(np.int64) for share in (across, down))
    return column, row


def _interleaved(x: NDArray[np.int64], y: NDArray[np.int64]) -> NDArray[np.int64]:
    """The place on a Z-shaped curve through all tiles."""
    place = np.zeros(len(x), dtype=np.int64)
    for bit in range(_FINE):
        place |= ((x >> bit) & 1) << (2 * bit) | ((y >> bit) & 1) << (2 * bit + 1)
    return place

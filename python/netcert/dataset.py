"""Permits of all vehicles as one data set of GeoParquet files, which DuckDB, SedonaDB, GeoPandas and Spark filter by place without reading it all.

    FOLDER/netcert.json                                                     what the permits depend on
    FOLDER/SHA256SUMS                                                       hashes of all other files, for `sha256sum -c`
    FOLDER/edges/cell=z8-x134-y87/certified_set=lane-EU-SEMI16.5/part.parquet  edges that begin in a cell, with verdicts for a vehicle
    FOLDER/turns/cell=…/certified_set=…/part.parquet                        turns, where they are certified

Cells are tiles as maps on the web have them: zoom, column, row. A set is a corridor policy and a vehicle. Names of folders begin with a letter, and never read as a number or a date:
DuckDB and Polars take `cell=6-10-22` for a day, and most readers take a vehicle called `1234` for a number. Within a file rows follow a Z-shaped curve, so groups of rows have small boxes.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _netcert, errors
from .table import pandas_type

if TYPE_CHECKING:
    import pyarrow
    from numpy.typing import NDArray

    from .region import CertifiedSet, Region
    from .table import Table

# Zoom of the order of rows: a cell of it is 40 m wide at the equator.
_FINE = 20
# Rows of a group, as in exports. Readers skip whole groups; smaller ones have more bounds to read.
_GROUP_ROWS = 2048
# The form of the folder. 1 had `cell=8-134-87/vehicle_id=…/lane.parquet`.
_LAYOUT = 2
_LICENCE = "© OpenStreetMap contributors, ODbL 1.0"
_SCOPE = (
    "permitted means that the verdict is safe: within the stated model, widths and error bounds. It is no permit to drive and says "
    "nothing of bridges or traffic. Whole routes are not certified; an engine that joins edges and turns joins what is safe by itself."
)


GeoParquet = Literal["1.1", "2.0"]


def write(
    region: Region, folder: str | os.PathLike[str], vehicles: list[str] | None, zoom: int, geoparquet: GeoParquet
) -> None:
    """Writes the data set. The folder is complete or absent; an older data set in it is replaced."""
    if geoparquet not in ("1.1", "2.0"):
        raise ValueError(f"geoparquet: {geoparquet}; expected 1.1 or 2.0")
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
            _layer(region.edges(known.vehicle_id, corridor=known.corridor), part / "edges", known, zoom, geoparquet)
            if known.turns:
                _layer(region.turns(known.vehicle_id, corridor=known.corridor), part / "turns", known, zoom, geoparquet)
        part.mkdir(parents=True, exist_ok=True)
        about = _about(region, sets, zoom, geoparquet)
        (part / "netcert.json").write_text(json.dumps(about, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
        _write_hashes(part)
        old = target.with_name(target.name + ".old")
        shutil.rmtree(old, ignore_errors=True)
        if target.exists():
            target.rename(old)
        part.rename(target)
        shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(part, ignore_errors=True)


def cell_name(zoom: int, column: int, row: int) -> str:
    """The name of a tile, as in folders.

    >>> import netcert.dataset
    >>> netcert.dataset.cell_name(8, 134, 87)
    'z8-x134-y87'
    """
    return f"z{zoom}-x{column}-y{row}"


def set_name(corridor: str, vehicle_id: str) -> str:
    """The name of a set, as in folders.

    >>> import netcert.dataset
    >>> netcert.dataset.set_name("lane", "EU-SEMI16.5")
    'lane-EU-SEMI16.5'
    """
    return f"{corridor}-{vehicle_id}"


def _about(region: Region, sets: list[CertifiedSet], zoom: int, geoparquet: GeoParquet) -> dict[str, Any]:
    """What the permits depend on."""
    first = sets[0]
    origin = region._file.origin(first.vehicle_id, first.corridor)
    vehicles = {known.vehicle_id: region.vehicle(known.vehicle_id).to_dict() for known in sets}
    return {
        "layout": _LAYOUT,
        "netcert": _netcert.__version__,
        "geoparquet": geoparquet,
        "scope": _SCOPE,
        "licence": _LICENCE,
        "database": {"name": Path(region.path).name, "sha256": _sha256(Path(region.path))},
        "input": {"name": origin["input_name"], "blake3": origin["input_blake3"], "timestamp": origin["replication_timestamp"]},
        "made_by": {"netcert": origin["netcert_version"]},
        "zoom": zoom,
        "sets": [{"certified_set": set_name(known.corridor, known.vehicle_id), **vars(known)} for known in sets],
        "vehicles": vehicles,
    }


def _sha256(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def _write_hashes(folder: Path) -> None:
    """Writes the hash of every file below a folder, in the form of `sha256sum`."""
    files = sorted(file for file in folder.rglob("*") if file.is_file())
    lines = [f"{_sha256(file)}  {file.relative_to(folder).as_posix()}\n" for file in files]
    (folder / "SHA256SUMS").write_text("".join(lines), encoding="utf-8")


def _layer(rows: Table, folder: Path, known: CertifiedSet, zoom: int, geoparquet: GeoParquet) -> None:
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
    table = table.append_column("permitted", permitted)
    # Rows of a cell follow each other, because the curve stays in a cell until all of it is done.
    begins = np.flatnonzero(np.any(np.diff(cells, axis=0) != 0, axis=1)) + 1
    for begin, end in zip([0, *begins], [*begins, len(cells)], strict=True):
        column, row = cells[begin]
        set_folder = f"certified_set={set_name(known.corridor, known.vehicle_id)}"
        place = folder / f"cell={cell_name(zoom, column, row)}" / set_folder
        place.mkdir(parents=True, exist_ok=True)
        # Types that do not depend on the values, so that a column without a number is of the same type in every file.
        rows_here = table.take(pyarrow.array(order[begin:end]))
        mapper = {"types_mapper": lambda kind: pandas_type(kind) or pandas.ArrowDtype(kind)}
        some = geopandas.GeoDataFrame.from_arrow(rows_here, to_pandas_kwargs=mapper)
        some.to_parquet(
            place / "part.parquet",
            index=False,
            schema_version=f"{geoparquet}.0",
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

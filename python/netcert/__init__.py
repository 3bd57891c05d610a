"""Certifies articulated vehicles on roads.

`safe` always means: within the model of the vehicle, the widths and the error bounds. It is no permit and says nothing of bridges or
traffic.

    vehicles(*files)                    the catalogue, and vehicles of your own
    Corridor(points, width_m=…)         a road from arrays
    certify(corridor, vehicle)          one certificate: RSC, plan, leeway, tubes
    certify_many(corridors, vehicles)   many, on all cores, as a table
    verify(path)                        the independent checker's opinion of a certificate file
    open(path)                          a database that `netcert ingest` made: tables, routes, reasons

>>> import netcert
>>> corridor = netcert.Corridor([[0, 0], [60, 0], [120, 15]], width_m=7.0)
>>> certificate = netcert.certify(corridor, netcert.vehicles()["EU-SEMI16.5"])
>>> certificate.safe
True
"""

from __future__ import annotations

from collections.abc import Sequence

from . import _netcert, errors
from ._netcert import (
    Catalogue,
    Certificate,
    Corridor,
    Explanation,
    Limiting,
    Report,
    Tube,
    Unit,
    Vehicle,
    Verification,
    __version__,
    certify,
    vehicles,
    verify,
)
from .errors import (
    CorridorError,
    NetcertError,
    NotFound,
    PlaceError,
    RegionError,
    UnknownVehicle,
    VehicleError,
)
from .region import CertifiedSet, Region, open  # noqa: A004
from .routes import Condition, NamedPlace, Obstacle, Part, Route, Routes, StripUse
from .table import Table

# Not `open`: it would hide the function of that name for who imports everything.
__all__ = [
    "Catalogue",
    "Certificate",
    "CertifiedSet",
    "Condition",
    "Corridor",
    "CorridorError",
    "Explanation",
    "Limiting",
    "NamedPlace",
    "NetcertError",
    "NotFound",
    "Obstacle",
    "Part",
    "PlaceError",
    "Region",
    "RegionError",
    "Report",
    "Route",
    "Routes",
    "StripUse",
    "Table",
    "Tube",
    "Unit",
    "UnknownVehicle",
    "Vehicle",
    "VehicleError",
    "Verification",
    "__version__",
    "certify",
    "certify_many",
    "errors",
    "vehicles",
    "verify",
]


def certify_many(
    corridors: Sequence[Corridor],
    vehicles: Sequence[Vehicle],
    *,
    max_shift_m: float = 1.5,
    correction_sweeps: int = 2,
) -> Table:
    """Certifies each vehicle on each corridor, on all cores.

    The table has a row for each pair, corridor by corridor, with the numbers of `certify`. `corridor` is the index into `corridors`.
    `RAYON_NUM_THREADS` in the environment limits the threads. Ctrl-C cancels the work.

    >>> import netcert
    >>> corridors = [netcert.Corridor([[0, 0], [100, 0]], width_m=w) for w in (2.5, 3.5)]
    >>> table = netcert.certify_many(corridors, [netcert.vehicles()["EU-SEMI16.5"]])
    >>> table.to_pandas()["verdict"].tolist()
    ['unsafe', 'safe']
    """
    rows = _netcert.certify_many(
        list(corridors), list(vehicles), max_shift_m=max_shift_m, correction_sweeps=correction_sweeps
    )
    return Table(rows)

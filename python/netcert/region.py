"""A database that `netcert ingest` made."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

from numpy.typing import NDArray

from ._netcert import Explanation, RegionFile, Vehicle, Verification
from .errors import RegionError
from .filters import AtMost, Corridor, EdgeFilters, TurnFilters, Verdict, WidthSource
from .routes import Routes
from .table import Table


class Point(Protocol):
    """What has a longitude `x` and a latitude `y`, as points of Shapely have."""

    @property
    def x(self) -> float: ...
    @property
    def y(self) -> float: ...


Place = Sequence[float] | NDArray[Any] | Point
"""Longitude and latitude, degrees: a pair of numbers, or a point."""


def _position(argument: str, place: Place) -> tuple[float, float]:
    """Longitude and latitude of a place."""
    try:
        if isinstance(place, str | bytes | set | frozenset):
            raise TypeError
        lon, lat = (place.x, place.y) if hasattr(place, "x") and hasattr(place, "y") else place
        return float(lon), float(lat)
    except (TypeError, ValueError):
        expected = "expected a pair of longitude and latitude in degrees, or a point with `x` and `y`"
        raise ValueError(f"{argument}: {place!r} is no place; {expected}") from None



@dataclass(frozen=True)
class CertifiedSet:
    """The certificates of one vehicle under one corridor policy."""

    vehicle_id: str
    corridor: Corridor
    """The width that the vehicle may use: its lane, all lanes of its direction, or the whole carriageway."""
    turns: bool
    """Whether turns are certified, too."""
    layer: str
    """The layer of the GeoPackage that shows the edges."""
    settings: dict[str, Any]
    """All settings that the certificates depend on, with units in their names."""


class Region:
    """A region: its roads and the certificates of its vehicles.

    `corridor` names the width that a vehicle may use in every method: "lane", "direction" or "carriageway". Without it, the policy of
    the database's `ingest` counts. Long calls release the interpreter's lock. Ctrl-C cancels routes, explanations and `verify`.

    A region can be pickled: the other process opens the same file. A process that was forked has to open it again.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._opened = RegionFile(path)
        self._process = os.getpid()
        # Another process may work in another folder.
        self._whole_path = os.path.abspath(path)

    @property
    def _file(self) -> RegionFile:
        # A forked process has none of its parent's threads, and would wait for them for ever.
        if os.getpid() != self._process:
            raise RegionError(f"{self.path}: this process was forked after the region was opened; open it again here")
        return self._opened

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return Region, (self._whole_path,)

    @property
    def path(self) -> str:
        """The file."""
        return os.fspath(self._opened.path)

    @property
    def usual_corridor(self) -> str:
        """The corridor policy that counts where none is named."""
        return self._file.usual_corridor()

    def sets(self) -> list[CertifiedSet]:
        """The sets of certificates."""
        return [CertifiedSet(**known) for known in self._file.sets()]

    def vehicle(self, vehicle_id: str) -> Vehicle:
        """A vehicle as its certificates were made for it.

        Raises NotFound if the database does not have it.
        """
        return self._file.vehicle(vehicle_id)

    def edges(
        self,
        vehicle_id: str,
        *,
        corridor: Corridor | None = None,
        bbox: tuple[float, float, float, float] | None = None,
        verdict: Verdict | None = None,
        min_rsc_m: float | None = None,
        needs_at_most_m: float | None = None,
        min_width_source: WidthSource | None = None,
        uses: Corridor | None = None,
        edge_id: int | None = None,
    ) -> Table:
        """Directed edges with their certificates, in order of the network.

        bbox              only edges that touch (west, south, east, north), degrees
        verdict           only edges with this verdict
        min_rsc_m         only edges with at least this RSC, metres
        needs_at_most_m   only edges that would be safe with at most this much more width, metres
        min_width_source  only edges whose width comes from this source or a better one
        uses              only edges for which this is the narrowest policy under which the file has them as safe
        edge_id           only this edge

        Raises NotFound if the vehicle is not certified under this policy.
        """
        filters = EdgeFilters(
            bbox=bbox,
            verdict=verdict,
            min_rsc_m=min_rsc_m,
            needs_at_most_m=needs_at_most_m,
            min_width_source=min_width_source,
            uses=uses,
            edge_id=edge_id,
        )
        return Table(self._file.edges(vehicle_id, corridor, filters))

    def turns(
        self,
        vehicle_id: str,
        *,
        corridor: Corridor | None = None,
        bbox: tuple[float, float, float, float] | None = None,
        verdict: Verdict | None = None,
        min_rsc_m: float | None = None,
        needs_at_most_m: float | None = None,
        uses: Corridor | None = None,
        turn_id: int | None = None,
    ) -> Table:
        """Turns with their certificates, in order of the network. Options are as in `edges`; `needs_at_most_m` is about kerb radii.

        Raises NotFound if the vehicle's turns are not certified under this policy.
        """
        filters = TurnFilters(
            bbox=bbox,
            verdict=verdict,
            min_rsc_m=min_rsc_m,
            needs_at_most_m=needs_at_most_m,
            uses=uses,
            turn_id=turn_id,
        )
        return Table(self._file.turns(vehicle_id, corridor, filters))

    def explain_edge(self, edge_id: int, vehicle_id: str, *, corridor: Corridor | None = None) -> Explanation:
        """Why an edge is safe or unsafe: what limits, where, and what would do. The certificate is computed again.

        Raises NotFound if there is no such edge.
        """
        return self._file.explain_edge(edge_id, vehicle_id, corridor)

    def explain_turn(self, turn_id: int, vehicle_id: str, *, corridor: Corridor | None = None) -> Explanation:
        """Why a turn is safe or unsafe. The verdict is that of the turn alone, not of the roads before and after it.

        Raises NotFound if there is no such turn.
        """
        return self._file.explain_turn(turn_id, vehicle_id, corridor)

    def route(
        self,
        vehicle_id: str,
        start: Place,
        end: Place,
        *,
        via: Sequence[Place] = (),
        corridor: Corridor | None = None,
        least: Literal["time", "distance"] = "time",
        snap_m: float = 100.0,
        alternatives: int = 0,
        tries: int = 30,
        conditions: bool = True,
        at_most: AtMost | None = None,
    ) -> Routes:
        """Routes with one certificate over the whole way each, or what blocks them.

        start, end, via  places: longitude and latitude in degrees as a tuple, list or array, or a point with `x` and `y`
        snap_m           the greatest distance of a place from a road, metres
        alternatives     number of routes beside the best one
        tries            number of whole routes that may fail to certify
        conditions       whether to look for a route that holds under conditions, if none is certified; that takes longer
        at_most          the widest strip that a route may use where `corridor` is not enough; each route's `uses` says where. With
                         "attested": the widest strip of the file, and conditions only where a sign, a network or the register says
                         that the vehicle goes

        The first question loads the network. Later ones for the same vehicle are faster, because corridors are kept.

        Raises PlaceError if a place is too far from a road, NotFound if the vehicle or its turns are not certified.
        """
        stops = [_position(f"via[{number}]", place) for number, place in enumerate(via)]
        places = [_position("start", start), *stops, _position("end", end)]
        return Routes(
            self._file.route(vehicle_id, places, corridor, least, snap_m, alternatives, tries, conditions, at_most)
        )

    def verify(
        self,
        *,
        vehicles: Sequence[str] = (),
        corridor: Corridor | None = None,
        bbox: tuple[float, float, float, float] | None = None,
        sample: int | None = None,
        source: str | os.PathLike[str] | None = None,
    ) -> Verification:
        """Checks certificates again with code that is independent of the code that made them, as `netcert verify` does.

        vehicles  only those of these vehicles [default: all]
        corridor  only those under this policy [default: all]
        bbox      only edges and turns that touch (west, south, east, north), degrees
        sample    only so many edges and so many turns of each vehicle and policy, always the same ones
        source    the extract that the database was made from: its hash is compared, too

        A claim is confirmed if the bound that is computed is at most 1 mm below the claimed one.

        Raises NotFound if there are no such certificates, FileNotFoundError without the source.
        """
        return self._file.verify(list(vehicles), corridor, bbox, sample, source)

    def to_dataset(
        self,
        folder: str | os.PathLike[str],
        *,
        vehicles: Sequence[str] | None = None,
        zoom: int = 8,
        geoparquet: Literal["1.1", "2.0"] = "1.1",
    ) -> None:
        """Writes the permits of all vehicles as one data set of GeoParquet files, by cell and set (see `netcert.dataset`).

        vehicles    ids of the vehicles [default: all that are certified]
        zoom        zoom of the tiles that divide it; 8 has tiles of some 100 km
        geoparquet  version of the format; 2.0 has lines in Parquet's own type, and needs GeoPandas 1.2 or later here and a new program there

        The folder is complete or absent. Needs GeoPandas.

        Raises NotFound if a vehicle is not certified, FileExistsError if the folder has other files.
        """
        from .dataset import write

        write(self, folder, None if vehicles is None else list(vehicles), zoom, geoparquet)

    def __repr__(self) -> str:
        return f"<Region {self.path}>"


def open(path: str | os.PathLike[str]) -> Region:  # noqa: A001
    """Opens a database that `netcert ingest` made, for reading.

    Raises RegionError if there is no such file, another program made it, or it is damaged.
    """
    return Region(path)

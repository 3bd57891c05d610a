"""Routes, or what blocks them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

if TYPE_CHECKING:
    import geopandas

    from ._netcert import Answer

Members = dict[str, Any]


@dataclass(frozen=True)
class Part:
    """A stretch of a route."""

    kind: str
    """"edge", "turn", "roundabout" or "complex"."""
    title: str
    """Names of the roads."""
    from_m: float
    """Beginning of the part, metres from the route's beginning."""
    to_m: float
    """End of the part, metres from the route's beginning."""
    rsc_m: float | None
    """The least leeway on the part, metres."""
    ids: Members
    """`edge_id`, or `from_edge` and `to_edge`."""


@dataclass(frozen=True)
class StripUse:
    """A stretch on which a route may use more of the road than its own lane."""

    what: str
    """In words, such as "the oncoming lane"."""
    strip: str
    """"direction": another lane of its direction. "carriageway": beyond all of these."""
    where: str
    """"road": as certified. "turn": near a turn, where the whole strip of the turn counts."""
    from_m: float
    """Beginning, metres from the route's beginning."""
    to_m: float
    """End, metres from the route's beginning."""
    beyond_m: float
    """How far any point of the vehicle may stand beyond the narrower strip, metres. An upper bound."""
    side: str
    """"left" or "right"."""
    title: str
    """Names of the roads."""


@dataclass(frozen=True)
class Obstacle:
    """A place that a route would need, and that is not safe."""

    kind: str
    title: str
    verdict: str
    reason: str | None
    missing_m: float | None
    """Room that is missing, metres."""
    place: Place | None
    """Longitude and latitude, degrees."""
    ids: Members


Place = tuple[float, float]


@dataclass(frozen=True)
class NamedPlace:
    """A place that stays closed whatever kerb radius, width or paving the search for conditions supposes."""

    kind: str
    title: str
    place: Place | None
    """Longitude and latitude, degrees."""
    ids: Members


@dataclass(frozen=True)
class Condition:
    """What has to be so on site for a conditional route to hold. Nothing says that it is."""

    number: int
    kind: str
    title: str
    needed: float
    unit: str
    place: Place | None
    """Longitude and latitude, degrees."""
    attested: Members | None
    """Who says that the vehicle goes there all the same (`by`, `name`, `tags`, `law`). That is no proof and no measurement."""
    members: Members
    """All members, as `netcert route --format json` has them."""


class Route:
    """A route with one certificate over its whole length.

    `verdict` is "safe", or "conditional" if the certificate holds only under `conditions`.
    """

    def __init__(self, answer: Answer, number: int, members: Members) -> None:
        self._answer, self._number, self._members = answer, number, members

    @property
    def verdict(self) -> str:
        """"safe" or "conditional"."""
        return self._members["certificate"]["verdict"]

    @property
    def safe(self) -> bool:
        """Whether the route is certified without conditions."""
        return self._members["safe"]

    @property
    def rsc_m(self) -> float | None:
        """What the worst point of the vehicle has to spare on the whole way, metres, all error bounds deducted."""
        return self._members["rsc_m"]

    @property
    def hinge_margin_deg(self) -> float | None:
        """The least margin of a hinge or of the steering lock, degrees."""
        return self._members["hinge_margin_deg"]

    @property
    def length_m(self) -> float:
        """Length, metres."""
        return self._members["length_m"]

    @property
    def time_s(self) -> float:
        """Time by class of road and tagged limits, seconds."""
        return self._members["time_s"]

    @property
    def limiting_at(self) -> str | None:
        """Names of the roads where the least leeway is."""
        return self._members["limiting_at"]

    @cached_property
    def parts(self) -> list[Part]:
        """The parts in driving order."""
        return [
            Part(**_members(part, Part, ("edge_id", "from_edge", "to_edge"))) for part in self._members["parts"]
        ]

    @property
    def rung(self) -> str:
        """The widest strip that the route uses anywhere: "lane", "direction" or "carriageway"."""
        return self._members["rung"]

    @cached_property
    def uses(self) -> list[StripUse]:
        """Where the route may use more of the road than its own lane, in driving order."""
        names = ("what", "strip", "where", "from_m", "to_m", "beyond_m", "side", "title")
        return [StripUse(**{name: one[name] for name in names}) for one in self._members["uses"]]

    @cached_property
    def conditions(self) -> list[Condition]:
        """What has to be so on site. Empty for a route that is certified."""
        names = ("number", "kind", "title", "needed", "unit", "attested")
        known = self._members["conditions"]
        return [
            Condition(**{name: one[name] for name in names}, place=_place(one.get("place")), members=one) for one in known
        ]

    @property
    def conditions_attested(self) -> bool:
        """Whether a sign, a network or the register says that the vehicle goes at the place of every condition. That is no proof."""
        return bool(self._members.get("conditions_attested", False))

    def certificate(self) -> str:
        """The certificate file as JSON text. `netcert verify` checks it."""
        return self._answer.certificate(self._number)

    def to_file(self, path: str | os.PathLike[str]) -> None:
        """Writes the certificate file."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.certificate())

    def to_svg(self) -> str:
        """A picture of the route: its shape and the leeway along it."""
        return self._answer.svg(self._number)

    def _repr_svg_(self) -> str:
        return self.to_svg()

    def __repr__(self) -> str:
        rsc = "no RSC" if self.rsc_m is None else f"RSC {self.rsc_m:.3f} m"
        count = len(self.conditions)
        under = f" under {count} condition{'' if count == 1 else 's'}" if count else ""
        return f"<Route, {self.length_m / 1000:.1f} km: {self.verdict}{under}, {rsc}>"


class Routes:
    """The answer to a question for a route: a sequence of certified routes, the best first.

    If it is empty, `conditional` may have a route under conditions, and `obstacles` names what blocks.
    """

    def __init__(self, answer: Answer) -> None:
        self._answer = answer
        self._members: Members = answer.to_dict()
        self._certified = [Route(answer, number, one) for number, one in enumerate(self._members["routes"])]

    def __len__(self) -> int:
        return len(self._certified)

    @overload
    def __getitem__(self, number: SupportsIndex) -> Route: ...
    @overload
    def __getitem__(self, number: slice) -> list[Route]: ...
    def __getitem__(self, number: SupportsIndex | slice) -> Route | list[Route]:
        """A route, or a list of those of a slice."""
        return self._certified[number]

    def __iter__(self) -> Iterator[Route]:
        return iter(self._certified)

    @property
    def conditional(self) -> Route | None:
        """A route that holds only under its conditions, if no route is certified. It is never `safe`."""
        known = self._members["conditional"]
        return None if known is None else Route(self._answer, len(self._certified), known)

    @property
    def obstacles(self) -> list[Obstacle] | None:
        """What would have to become safe, at least cost. None if there is a route, or if no roads lead there."""
        known = self._members["obstacles"]
        if known is None:
            return None
        ids = ("edge_id", "from_edge", "to_edge")
        return [Obstacle(**_members(one, Obstacle, ids)) for one in known]

    @property
    def nothing_helps(self) -> list[NamedPlace]:
        """The places that no condition opens, where no route is certified under any. Ways without them were tried, too."""
        ids = ("edge_id", "from_edge", "to_edge")
        return [NamedPlace(**_members(one, NamedPlace, ids)) for one in self._members["nothing_helps"]]

    def to_dict(self) -> Members:
        """The answer as `netcert route --format json` writes it."""
        return self._answer.to_dict()

    def to_geojson(self) -> Members:
        """Routes and their parts as lines; obstacles, conditions and places that no condition opens as points."""
        return self._answer.to_geojson()

    def to_geopandas(self) -> geopandas.GeoDataFrame:
        """The features of `to_geojson` as a GeoDataFrame in longitude and latitude.

        Columns of whole numbers are `Int64`, which has room for gaps and for ids of 63 bits.
        """
        import geopandas
        import pandas

        features = self.to_geojson()["features"]
        frame = geopandas.GeoDataFrame.from_features(features, crs="EPSG:4326")
        for name in frame.columns.drop("geometry"):
            values = [feature["properties"].get(name) for feature in features]
            # A column with gaps has become one of doubles. A truth value is no number.
            if {type(value) for value in values} - {type(None)} == {int}:
                frame[name] = pandas.array(values, dtype="Int64")
        return frame

    def explore(self, **options: Any) -> Any:
        """Routes, obstacles and conditions on a map that one can move (folium). Options are those of `folium.Map`.

        The map's background comes from the internet; `tiles=None` leaves it out.
        """
        from .maps import routes

        return routes(self, **options)

    def __repr__(self) -> str:
        if self._certified:
            return f"<Routes: {', '.join(map(repr, self._certified))}>"
        if self.conditional is not None:
            return f"<Routes: none certified; {self.conditional!r}>"
        blocked = self.obstacles
        return "<Routes: none, no roads lead there>" if blocked is None else f"<Routes: none, {len(blocked)} obstacles>"


def _place(place: list[float] | None) -> Place | None:
    return None if place is None else (place[0], place[1])


def _members(known: Members, kind: type, ids: tuple[str, ...]) -> Members:
    """The members of a dataclass, with those in `ids` that there are as `ids`."""
    wanted = kind.__dataclass_fields__  # type: ignore[attr-defined]
    found = {name: known.get(name) for name in wanted if name not in ("ids", "place")}
    if "place" in wanted:
        found["place"] = _place(known.get("place"))
    return {**found, "ids": {name: known[name] for name in ids if name in known}}

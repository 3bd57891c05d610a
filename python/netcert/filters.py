"""Which rows a table of a region has. `None` leaves a filter out."""

from __future__ import annotations

from typing import Literal, TypedDict

Corridor = Literal["lane", "direction", "carriageway"]
AtMost = Literal["lane", "direction", "carriageway", "attested"]
Verdict = Literal["safe", "unsafe", "forbidden", "unknown"]
WidthSource = Literal["assumed", "from_lanes", "estimated", "tagged", "surveyed"]


class Filters(TypedDict):
    """Which edges or turns."""

    bbox: tuple[float, float, float, float] | None
    """West, south, east, north, degrees. West is greater than east in a box over the 180th meridian."""
    verdict: Verdict | None
    min_rsc_m: float | None
    needs_at_most_m: float | None
    uses: Corridor | None


class EdgeFilters(Filters):
    """Which edges."""

    min_width_source: WidthSource | None
    edge_id: int | None


class TurnFilters(Filters):
    """Which turns."""

    turn_id: int | None

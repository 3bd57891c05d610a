"""Pictures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .colours import INK, ROAD, UNITS, VERDICTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ._netcert import Certificate, Tube, Unit

# The vehicle at the tightest place is drawn with so much road before and after it, as a share of its length.
_AROUND = 0.8


def certificate(made: Certificate, ax: Axes | None = None) -> Figure:
    """Draws a certificate: the tightest place with the vehicle there, and the leeway along the corridor.

    With `ax`, only the place is drawn, into these axes.
    """
    if ax is not None:
        _place(ax, made)
        figure = ax.get_figure()
        if figure is None:
            raise ValueError("ax belongs to no figure")
        return figure  # type: ignore[return-value]
    import matplotlib.pyplot as plt

    figure, (place, along) = plt.subplots(2, 1, figsize=(9, 8), height_ratios=(3, 1), layout="constrained")
    _place(place, made)
    _leeway(along, made)
    rsc = "no bound holds" if made.rsc_m is None else f"RSC {made.rsc_m:.2f} m"
    reason = f" ({made.reason})" if made.reason else ""
    figure.suptitle(f"{made.vehicle.id}: {made.verdict}{reason}, {rsc}")
    plt.close(figure)  # a notebook shows what is returned; it must not appear twice
    return figure


def _edges(made: Certificate) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    corridor = made.corridor
    heading, xy = corridor.heading_rad, corridor.xy
    normal = np.column_stack([-np.sin(heading), np.cos(heading)])
    return xy + normal * corridor.left_m[:, None], xy - normal * corridor.right_m[:, None]


def _place(ax: Axes, made: Certificate) -> None:
    left, right = _edges(made)
    ax.fill(*np.vstack([left, right[::-1]]).T, color=ROAD, zorder=0)
    for edge in (left, right):
        ax.plot(*edge.T, color=INK, linewidth=1)
    ax.plot(*made.plan.T, color=INK, linewidth=0.8, linestyle=(0, (4, 4)), label="plan of the steer axle")
    tubes = made.tubes()
    units = made.vehicle.units
    for tube, unit in zip(tubes, units, strict=True):
        colour = UNITS[tube.unit % len(UNITS)]
        across = np.column_stack([-tube.heading[:, 1], tube.heading[:, 0]]) * tube.lateral_m[:, None]
        known = ~np.isnan(tube.lateral_m)
        ring = np.vstack([(tube.centre + across)[known], (tube.centre - across)[known][::-1]])
        ax.fill(*ring.T, color=colour, alpha=0.35, linewidth=0, label=f"{unit.name}: where its axle may be")
    limiting = made.limiting
    if limiting is not None:
        station = _head(tubes[limiting.unit], made, limiting.station, limiting.point_m)
        for tube, unit in zip(tubes, units, strict=True):
            ax.fill(*_body(tube, unit, station).T, facecolor="none", edgecolor=UNITS[tube.unit % len(UNITS)], linewidth=1.6)
        at = (left if limiting.side == "left" else right)[limiting.station]
        ax.plot(*at, marker="o", color=VERDICTS[made.verdict], markersize=7, zorder=5, label=f"tightest: {made.rsc_m:.2f} m")
        reach = made.vehicle.length_m * (0.5 + _AROUND)
        ax.set_xlim(at[0] - reach, at[0] + reach)
        ax.set_ylim(at[1] - reach * 0.62, at[1] + reach * 0.62)
    ax.set_aspect("equal")
    ax.set_xlabel("metres")
    ax.set_ylabel("metres")
    ax.legend(fontsize="small", loc="best")


def _head(tube: Tube, made: Certificate, foot: int, point_m: float) -> int:
    """The station of the steer axle while the limiting point of this unit passes the station `foot`."""
    point = tube.centre + tube.heading * point_m
    foot_xy = made.corridor.xy[foot]
    return int(np.argmin(np.hypot(*(point - foot_xy).T)))


def _body(tube: Tube, unit: Unit, station: int) -> NDArray[np.float64]:
    """Corners of a unit's body while the steer axle is at a station, metres."""
    ahead = tube.heading[station]
    across = np.array([-ahead[1], ahead[0]]) * unit.width_m / 2
    front = tube.centre[station] + ahead * (unit.coupling_to_axle_m + unit.front_overhang_m)
    rear = tube.centre[station] - ahead * unit.rear_overhang_m
    if unit.is_dolly:  # a bar, as long as the dolly
        across = across * 0.2
        front, rear = tube.centre[station] + ahead * unit.coupling_to_axle_m, tube.centre[station]
    return np.array([front + across, front - across, rear - across, rear + across, front + across])


def _leeway(ax: Axes, made: Certificate) -> None:
    along = np.arange(len(made.corridor)) * made.corridor.spacing_m
    columns: list[tuple[str, Any, str]] = [("left", made.left_m, UNITS[0]), ("right", made.right_m, UNITS[1])]
    for name, leeway, colour in columns:
        ax.plot(along, leeway, color=colour, label=f"{name} of the road")
    ax.axhline(0, color=INK, linewidth=0.8)
    ax.set_xlabel("metres along the corridor")
    ax.set_ylabel("leeway, metres")
    ax.legend(fontsize="small")

"""Maps that one can move (folium)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .colours import CONDITIONAL, OBSTACLE, VERDICTS

if TYPE_CHECKING:
    import folium

    from .routes import Routes
    from .table import Table

# What a reader wants to know of a road or turn, as far as the table has it.
_TOLD = ["name", "ref", "from_name", "to_name", "highway", "verdict", "reason", "rsc_m", "width_m", "need_width_m", "uses", "edge_id", "turn_id"]


def table(rows: Table, **options: Any) -> folium.Map:
    """Rows coloured by verdict. What is known of a row shows beside the pointer."""
    import folium

    frame = rows.to_geopandas()
    told = [name for name in _TOLD if name in frame.columns]
    drawn = folium.Map(**options)
    # JavaScript has doubles only, and they round ids.
    ids = {name: str for name in told if name.endswith("_id")}
    layer = folium.GeoJson(
        frame[[*told, "geometry"]].astype(ids).to_json(),
        style_function=lambda feature: {"color": VERDICTS[feature["properties"]["verdict"]], "weight": 4},
        tooltip=folium.GeoJsonTooltip(told) if len(frame) else None,
    )
    layer.add_to(drawn)
    if len(frame):
        west, south, east, north = frame.total_bounds
        drawn.fit_bounds([(south, west), (north, east)])
    swatches = "".join(f'<span style="color:{colour}">&#9632;</span> {verdict} ' for verdict, colour in VERDICTS.items())
    legend = f'<div style="position:fixed;bottom:24px;left:24px;z-index:1000;background:white;padding:4px 8px">{swatches}</div>'
    folium.Element(legend).add_to(drawn.get_root().html)  # type: ignore[attr-defined]
    return drawn


def routes(found: Routes, **options: Any) -> folium.Map:
    """Certified routes as lines, a conditional route as a dashed line, obstacles and conditions as numbered points."""
    import folium

    drawn = folium.Map(**options)
    corners: list[tuple[float, float]] = []
    points = 0
    for feature in found.to_geojson()["features"]:
        told, geometry = feature["properties"], feature["geometry"]
        if geometry["type"] == "LineString" and told.get("kind") in ("route", "conditional_route"):
            line = [(lat, lon) for lon, lat in geometry["coordinates"]]
            certified = told["kind"] == "route"
            rsc = "" if told["rsc_m"] is None else f", RSC {told['rsc_m']:.2f} m"
            words = f"{'safe' if certified else 'only under conditions'}: {told['length_m'] / 1000:.1f} km{rsc}"
            style = {"color": VERDICTS["safe"]} if certified else {"color": CONDITIONAL, "dash_array": "8 8"}
            folium.PolyLine(line, weight=6, tooltip=words, **style).add_to(drawn)
            corners += line
        elif geometry["type"] == "Point" and geometry["coordinates"]:
            lon, lat = geometry["coordinates"]
            points += 1
            what = told.get("feature")
            words = {"condition": _condition, "nothing_helps": _hopeless}.get(what, _obstacle)(told)
            colour = CONDITIONAL if what == "condition" else OBSTACLE
            folium.CircleMarker((lat, lon), radius=8, color=colour, fill=True, tooltip=f"{points}. {words}").add_to(drawn)
            corners.append((lat, lon))
    if corners:
        south, west = (min(corner[axis] for corner in corners) for axis in (0, 1))
        north, east = (max(corner[axis] for corner in corners) for axis in (0, 1))
        drawn.fit_bounds([(south, west), (north, east)])
    return drawn


def _condition(told: dict[str, Any]) -> str:
    return f"{told['title']}: {told['kind'].replace('_', ' ')} at least {told['needed']} {told['unit']}"


def _hopeless(told: dict[str, Any]) -> str:
    return f"{told['title']}: nothing that was tried opens it"


def _obstacle(told: dict[str, Any]) -> str:
    reason = f" ({told['reason']})" if told.get("reason") else ""
    missing = f", {told['missing_m']:.2f} m missing" if told.get("missing_m") else ""
    return f"{told['title']}: {told['verdict']}{reason}{missing}"

#!/usr/bin/env python3
"""How far engines drive where the vehicle needs more than its own lane, without and with what exports say of it.

    target/engines/venv/bin/python benches/wider.py EXTRACT TABLES OSRM_EXPORT REWRITTEN VALHALLA_EXPORT WORK PAIRS

The five exports are of one vehicle of a database with several policies, all under `--corridor carriageway`: csv, osrm, osm-pbf and valhalla.
Prints a row for each way of asking: pairs that have a way in all of them, their length, and how much of it uses which strip.
"""

import json
import os
import sys
from functools import partial

sys.path.insert(0, f"{os.path.dirname(os.path.abspath(__file__))}/../tests/engines")

import osrm
import run_osrm
import run_valhalla
from permits import END_M, Permits, length_m

STRIPS = ("lane", "direction", "carriageway")


def by_strip(permits, nodes):
    """Metres of a way by the narrowest strip of the permitted edges that it drives."""
    out = dict.fromkeys(STRIPS, 0.0)
    for pair in zip(nodes, nodes[1:]):
        uses = [permits.edges[edge]["uses"] for edge, _ in permits.over.get(pair, []) if permits.edges[edge]["permitted"]]
        if uses and pair[0] != pair[1]:
            out[min(uses, key=STRIPS.index)] += length_m(permits, pair)
    return out


def osrm_nodes(engine, exclude, places):
    ask = osrm.RouteParameters(
        coordinates=places, annotations=["nodes", "duration"], overview="false", continue_straight=True, radiuses=[END_M] * 2, exclude=exclude
    )
    try:
        leg = engine.Route(ask)["routes"][0]["legs"][0]
    except RuntimeError as error:
        if "NoRoute" in str(error) or "NoSegment" in str(error):
            return None
        raise
    refused = leg["duration"] - sum(leg["annotation"]["duration"]) >= run_osrm.PENALTY_S
    return None if refused else [int(node) for node in leg["annotation"]["nodes"]]


def valhalla_nodes(permits, actor, request, places):
    line = run_valhalla.route(actor, request, places)
    return None if line is None else [node for node in permits.nodes_of(line) if node]


def valhalla_nodes_with(permits, actor, request, lines, places):
    return valhalla_nodes(permits, actor, request | {"linear_cost_factors": near(lines, places)}, places)


def near(lines, places):
    """The lines with a position in the box of two places, grown by 2 km or so."""
    lows, highs = ([pick(axis) + grown for axis in zip(*places)] for pick, grown in ((min, -0.02), (max, 0.02)))

    def inside(at):
        return all(low <= value <= high for low, value, high in zip(lows, at, highs))

    return [line for line in lines if any(map(inside, line["geometry"]["coordinates"]))]


def followed(actor, request, lines):
    """The lines that Valhalla can follow, found by halves."""
    try:
        run_valhalla.answered(actor, request | {"linear_cost_factors": lines})
        return lines
    except RuntimeError as error:
        if "edge walk" not in str(error):
            raise
    half = len(lines) // 2
    return followed(actor, request, lines[:half]) + followed(actor, request, lines[half:]) if half else []


def main(extract, tables, tuned, rewritten, valhalla_export, work, count):
    os.makedirs(work, exist_ok=True)
    permits = Permits(extract, tables)
    closed = ["--segment-speed-file", f"{tuned}/segment-speeds.csv", "--turn-penalty-file", f"{tuned}/turn-penalties.csv"]
    asks = {"osrm": partial(osrm_nodes, run_osrm.engine(extract, work, "osrm", closed), [])}
    pbf = run_osrm.engine(rewritten, work, "pbf")
    asks["osm-pbf, hgv.lua"] = partial(osrm_nodes, pbf, [])
    actor = run_valhalla.engine(f"{valhalla_export}/extract.osm.pbf", work, "valhalla")
    request = json.load(open(f"{valhalla_export}/request.json"))
    asks["valhalla"] = partial(valhalla_nodes, permits, actor, request)
    pairs = [[permits.middle(edge) for edge in pair] for pair in permits.pairs(count, 11)]
    first = dict(request, locations=[dict(request["locations"][0], lon=lon, lat=lat) for lon, lat in pairs[1]])
    lines = json.load(open(f"{valhalla_export}/wider.json"))["linear_cost_factors"]
    kept = followed(actor, first, lines)
    print(f"lines of wider.json: {len(lines)}, not followed: {len(lines) - len(kept)}")
    asks["valhalla, wider.json"] = partial(valhalla_nodes_with, permits, actor, request, kept)
    found = {name: [ask(places) for places in pairs] for name, ask in asks.items()}
    alone = [osrm_nodes(pbf, ["oncoming"], places) for places in pairs]
    joint = [at for at in range(len(pairs)) if all(ways[at] for ways in found.values())]
    for name, ways in found.items():
        sums = [sum(by_strip(permits, ways[at])[strip] for at in joint) for strip in STRIPS]
        print(f"{name}: {len(joint)} pairs, {sum(sums) / 1e3:.1f} km; " + ", ".join(f"{s} {m / 1e3:.1f}" for s, m in zip(STRIPS, sums)))
    used = sum(by_strip(permits, way)["carriageway"] for way in alone if way)
    print(f"osm-pbf with exclude=oncoming: {sum(bool(way) for way in alone)} of {len(pairs)} pairs have a way, {used:.0f} m of it use the oncoming lane")


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Engines on a drawn road with a narrow part beside a wide way round it, and a narrow part without one: who drives over the narrow parts,
where the vehicle needs the oncoming lane.

    python run_wider.py EXTRACT TABLES OSRM_EXPORT REWRITTEN VALHALLA_EXPORT WORK

Prints one JSON object: for each way of asking, whether the ways past the first and past the second narrow part lead over it; null where there is
no way.
"""

import json
import sys

import osrm
import run_osrm
import run_valhalla
from permits import END_M, Permits

# Nodes of the drawn road: the edges on which the two ways begin and end, and the narrow part between them.
ASKED = [((1, 2), (5, 6), (3, 4)), ((5, 6), (9, 10), (7, 8))]


def pairs(permits):
    """The places to ask for, and the steps over the narrow part."""
    of_ends = {(row["nodes"][0], row["nodes"][-1]): edge for edge, row in permits.edges.items()}
    return [([permits.middle(of_ends[ends]) for ends in (start, goal)], narrow) for start, goal, narrow in ASKED]


def by_osrm(engine, asked, exclude=()):
    out = []
    for places, narrow in asked:
        ask = osrm.RouteParameters(
            coordinates=places, annotations=["nodes"], overview="false", continue_straight=True, radiuses=[END_M] * 2, exclude=list(exclude)
        )
        try:
            nodes = [int(node) for node in engine.Route(ask)["routes"][0]["legs"][0]["annotation"]["nodes"]]
        except RuntimeError as error:
            if not any(word in str(error) for word in ("NoRoute", "NoSegment")):
                raise
            nodes = None
        out.append(None if nodes is None else narrow in zip(nodes, nodes[1:]))
    return out


def by_valhalla(permits, actor, request, asked):
    out = []
    for places, narrow in asked:
        line = run_valhalla.route(actor, request, places)
        nodes = None if line is None else [node for node in permits.nodes_of(line) if node]
        out.append(None if nodes is None else narrow in zip(nodes, nodes[1:]))
    return out


def main(extract, tables, tuned, rewritten, valhalla_export, work):
    permits = Permits(extract, tables)
    asked = pairs(permits)
    closed = ["--segment-speed-file", f"{tuned}/segment-speeds.csv", "--turn-penalty-file", f"{tuned}/turn-penalties.csv"]
    out = {}
    for name, from_file, customize in [("csv", extract, closed), ("pbf", rewritten, [])]:
        engine = run_osrm.engine(from_file, work, name, customize)
        out[name] = by_osrm(engine, asked)
    out["pbf_without_oncoming_lane"] = by_osrm(engine, asked, ["oncoming"])
    actor = run_valhalla.engine(f"{valhalla_export}/extract.osm.pbf", work, "valhalla")
    request = json.load(open(f"{valhalla_export}/request.json"))
    lines = json.load(open(f"{valhalla_export}/wider.json"))
    out["valhalla"] = by_valhalla(permits, actor, request, asked)
    out["valhalla_wider"] = by_valhalla(permits, actor, request | lines, asked)
    print(json.dumps(out))


if __name__ == "__main__":
    main(*sys.argv[1:])

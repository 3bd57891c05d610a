"""Roads of every tagging that decides whether a truck may drive to Valhalla or OSRM, and what they take for open.

    python run_taggings.py make EXTRACT
    python run_taggings.py run EXTRACT TABLES OSRM_EXPORT REWRITTEN VALHALLA_EXPORT WORK

`make` draws each tagging as a road of its own, one wide enough for a truck and one too narrow, and a ring of more than a thousand
roads with a short road beside it. `run` asks OSRM and Valhalla for every step that is refused, and for ways on the short road. It
prints one JSON object.
"""

import itertools
import json
import sys
from functools import partial
from math import cos, pi, sin

import run_osrm
import run_valhalla
from permits import Permits
from probe_osrm import probe as probe_osrm
from probe_valhalla import probe as probe_valhalla
from run_shapes import Drawing

CLASSES = [
    {"highway": "residential"},
    {"highway": "service"},
    {"highway": "service", "service": "driveway"},
    {"highway": "service", "service": "parking_aisle"},
    {"highway": "track", "tracktype": "grade1", "surface": "asphalt", "motor_vehicle": "yes"},
    {"highway": "trunk", "motorroad": "yes"},
    {"route": "ferry", "motor_vehicle": "yes"},
]
ACCESS = [{}, {"access": "no"}, {"access": "yes"}, {"access": "private"}]
TRUCKS = [{}, {"hgv": "no"}, {"hgv": "designated"}, {"hgv": "no", "hgv:conditional": "yes @ (22:00-06:00)"}]
DIRECTIONS = [
    {},
    {"vehicle:forward": "destination"},
    {"vehicle:backward": "destination"},
    {"motor_vehicle:forward": "yes", "motor_vehicle:backward": "no"},
    {"hgv:forward": "yes", "hgv:backward": "no"},
    {"motor_vehicle": "destination", "motor_vehicle:conditional": "yes @ (22:00-06:00)"},
]
ONE_WAY = [{}, {"oneway": "yes"}, {"oneway": "-1"}]
WIDTHS = [{"width": "12"}, {"width": "1.8"}]
RING_ROADS, RING_M = 1100, 4000


def drawing():
    d = Drawing()
    for i, tags in enumerate(itertools.product(CLASSES, ACCESS, TRUCKS, DIRECTIONS, ONE_WAY, WIDTHS)):
        x_m, y_m = 100 * (i % 60), 40 * (i // 60)
        d.way([d.node(x_m, y_m), d.node(x_m + 60, y_m)], {key: value for part in tags for key, value in part.items()})
    ring_and_road_beside(d)
    return d


def ring_and_road_beside(d):
    """Names keep engines from making one road of the ring's."""
    d.shape()
    d.shape()
    corners = [d.node(RING_M * cos(2 * pi * i / RING_ROADS), RING_M * sin(2 * pi * i / RING_ROADS)) for i in range(RING_ROADS)]
    for i, (a, b) in enumerate(zip(corners, corners[1:] + corners[:1])):
        d.way([a, b], {"highway": "unclassified", "width": "14", "name": f"Ring {i}", "oneway": "yes"})
    d.beside = d.way([d.node(RING_M + 300, 0), d.node(RING_M + 900, 0)], {"highway": "unclassified", "width": "14"})


def beside_the_ring(drawn, permits, route):
    """Ways along the short road, and from it onto the ring, to which no road leads: what of them lies elsewhere, `None` if there is
    no way."""
    road, ring = ([permits.place[node] for node in drawn.ways[way][0]] for way in (drawn.beside, drawn.beside - 1))

    def on(ends, share):
        return tuple(a + share * (b - a) for a, b in zip(*ends))

    out = []
    for asked in ([on(road, 1 / 3), on(road, 2 / 3)], [on(road, 1 / 2), on(ring, 1 / 2)]):
        ends = route(asked)
        out.append(ends and permits.elsewhere(ends, asked))
    return out


def run(extract, tables, tuned, rewritten, valhalla, work):
    drawn, permits = drawing(), Permits(extract, tables)
    files = ["--segment-speed-file", f"{tuned}/segment-speeds.csv", "--turn-penalty-file", f"{tuned}/turn-penalties.csv"]
    out = {"edges_lost": permits.lost}
    for name, file, customize in [("plain", extract, []), ("csv", extract, files), ("pbf", rewritten, [])]:
        engine = run_osrm.engine(file, work, name, customize)
        # Without a radius only the small components decide where a way begins.
        beside = beside_the_ring(drawn, permits, lambda asked: (found := run_osrm.route(engine, asked, None)) and found.ends)
        out[name] = dict(probe_osrm(permits, partial(run_osrm.route, engine)), beside=beside)
    request = json.load(open(f"{valhalla}/request.json"))
    for name, file in [("plain_valhalla", extract), ("valhalla", f"{valhalla}/extract.osm.pbf")]:
        actor = run_valhalla.engine(file, work, name)

        def line(asked):
            # As a user asks: the request as it was written, with places put into it.
            places = [dict(place, lon=lon, lat=lat) for place, (lon, lat) in zip(request["locations"], asked)]
            found = run_valhalla.answered(actor, dict(request, locations=places))
            return found and (found[0], found[-1])

        out[name] = dict(probe_valhalla(permits, actor, f"{work}/{name}", file, request), beside=beside_the_ring(drawn, permits, line))
    print(json.dumps(out))


if __name__ == "__main__":
    drawing().write(sys.argv[2]) if sys.argv[1] == "make" else run(*sys.argv[2:])

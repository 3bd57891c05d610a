"""What OSRM and Valhalla take for the limits of roads: of an extract as it is, and of the exports.

    python run_limits.py make EXTRACT
    python run_limits.py run EXTRACT REWRITTEN VALHALLA_EXPORT WORK

`make` draws a straight road for each sign, on the road or on a node of it. All signs of a key say the same. `run` asks each engine for
a way past each sign, for a vehicle a little below the limit and for one a little above it. It prints one JSON object: for each engine
and file, the signs that stop the first vehicle or let the second one pass.
"""

import json
import os
import re
import shutil
import sys

import run_osrm
import run_valhalla
from run_shapes import ROAD, Drawing

# By key: values that say the same, and vehicles a little below and above it. In metres and tonnes.
SIGNS = {
    "maxheight": (["12 ft", "366 cm", "12'", "3,66", "3.66 m", "366 cm;4"], 3.64, 3.68),
    "maxwidth": (["10 ft", "305 cm", "3,05"], 3.03, 3.07),
    "maxlength": (["40 ft", "1219 cm", "12,19 m"], 12.17, 12.21),
    "maxweight": (["20000 lbs", "10 st", "9,07", "9070 kg", "9.07"], 9.05, 9.1),
    "maxaxleload": (["18000 lbs", "9 st", "8,16 t"], 8.14, 8.19),
}
COSTING = {"maxheight": "height", "maxwidth": "width", "maxlength": "length", "maxweight": "weight", "maxaxleload": "axle_load"}
# OSRM's profile reads these. Its weights are kilograms.
PROFILE = {"maxheight": ("vehicle_height", 1), "maxwidth": ("vehicle_width", 1), "maxlength": ("vehicle_length", 1), "maxweight": ("vehicle_weight", 1000)}
BANS = ["hgv:forward", "hgv:backward"]


def drawing():
    """Returns the drawing, and by sign the way before it and the way after it."""
    d, signs = Drawing(), {}
    for key, (values, _, _) in SIGNS.items():
        # Valhalla knows no direction of axle loads.
        for value in values:
            for at in ["way", "node", *(["forward"] if key != "maxaxleload" else [])]:
                tags = {f"{key}:{at}" if at == "forward" else key: value}
                signs[f"{key}={value} {at}"] = road(d, tags, at == "node")
    for key in BANS:
        signs[key] = road(d, {key: "no"}, False)
    return d, signs


def road(d, tags, on_node):
    y_m = 60 * len(d.ways)
    a, b, middle, c, e = (d.node(x_m, y_m, tags if on_node and x_m == 450 else None) for x_m in (0, 300, 450, 600, 900))
    before = d.way([a, b])
    d.way([b, middle, c], ROAD if on_node else {**ROAD, **tags})
    return before, d.way([c, e])


def middle(d, way):
    (a, b), _ = d.ways[way]
    return tuple((one + other) / 2 for one, other in zip(d.nodes[a], d.nodes[b]))


def misread(d, signs, keys, passes):
    """`passes(key, above, places)`: whether there is a way for the vehicle below or above the limit of a key."""
    out = []
    for sign, (before, after) in signs.items():
        places = [middle(d, before), middle(d, after)]
        key = sign.split("=")[0]
        if key in BANS:
            ways = {"hgv:forward": places, "hgv:backward": places[::-1]}
            seen = [passes(None, False, ways[other]) for other in (key, *(set(BANS) - {key}))]
            out += [sign] if seen != [False, True] else []
        elif key in keys:
            seen = [passes(key, above, places) for above in (False, True)]
            out += [sign] if seen != [True, False] else []
    return out


def by_osrm(d, signs, extract, work):
    engines = []
    for above in (False, True):
        folder = f"{work}/{'above' if above else 'below'}"
        shutil.copytree(f"{run_osrm.HOME}/share/profiles", f"{folder}/profiles")
        text = open(f"{os.path.dirname(__file__)}/../../docs/export/hgv.lua").read()
        for key, (name, factor) in PROFILE.items():
            text, found = re.subn(rf"{name} = [\d.]+", f"{name} = {SIGNS[key][1 + above] * factor}", text)
            assert found == 1, name
        with open(f"{folder}/profiles/hgv.lua", "w") as file:
            file.write(text)
        engines.append(run_osrm.engine(extract, folder, "graph"))
    # The vehicle above is above every limit, which a road has one of.
    return misread(d, signs, PROFILE, lambda _, above, places: run_osrm.route(engines[above], places) is not None)


def by_valhalla(d, signs, extract, request, work):
    actor = run_valhalla.engine(extract, work, "tiles")

    def passes(key, above, places):
        truck = dict(request["costing_options"]["truck"])
        if key:
            truck[COSTING[key]] = SIGNS[key][1 + above]
        return run_valhalla.route(actor, dict(request, costing_options={"truck": truck}), places) is not None

    return misread(d, signs, COSTING, passes)


def run(extract, rewritten, valhalla, work):
    d, signs = drawing()
    request = json.load(open(f"{valhalla}/request.json"))
    out = {"signs": len(signs)}
    for name, file in [("plain", extract), ("pbf", rewritten)]:
        out[name] = by_osrm(d, signs, file, f"{work}/{name}")
    for name, file in [("plain_valhalla", extract), ("valhalla", f"{valhalla}/extract.osm.pbf")]:
        out[name] = by_valhalla(d, signs, file, request, f"{work}/{name}")
    print(json.dumps(out))


if __name__ == "__main__":
    drawing()[0].write(sys.argv[2]) if sys.argv[1] == "make" else run(*sys.argv[2:])

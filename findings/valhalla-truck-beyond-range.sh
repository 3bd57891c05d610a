#!/bin/sh
# Valhalla (PyPI: pyvalhalla 3.9.1): a truck that is longer than 50 m passes a sign that a truck of 50 m obeys.
#
# The truck costing takes length up to 50 m, weight up to 100 t, axle load up to 40 t, height and width up to 10 m, and 20 axles. One would expect
# a greater value to count as the greatest one, or to be an error. Instead the default for trucks counts (21.64 m, 21.77 t, 9.07 t, 4.11 m, 2.6 m,
# 5 axles), without an error. So AU-ATRIPLE53 (53.5 m) may pass `maxlength=45`, and is kept off `maxlength=20` only.
#
# Output seen with 3.9.1 (km; 0.58 is the road with the sign, 1.47 the way round it):
#   maxlength=45: length 44 -> 0.58, 46 -> 1.47, 50 -> 1.47, 53.5 -> 0.58
#   maxlength=20: length 53.5 -> 1.47
#   maxweight=90: weight 89 -> 0.58, 91 -> 1.47, 100 -> 1.47, 120 -> 0.58
#   maxaxles=9: axle_count 8 -> 0.58, 10 -> 1.47, 20 -> 1.47, 21 -> 0.58
#
# Needs python 3.12 or newer, which PYTHON may name. Fails if the behaviour is another one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet pyvalhalla==3.9.1 osmium==4.3.2
cd "$work"
cat > probe.py <<'END'
import json, os, shutil, subprocess
import osmium, valhalla
from osmium.osm import mutable

NODES = {1: (0, 0), 2: (0.004, 0), 3: (0, 0.004), 4: (0.004, 0.004), 5: (-0.003, 0), 6: (0.007, 0)}
HOME = os.path.dirname(valhalla.__file__)

def actor(sign):
    """A road with a sign, and a longer way round it."""
    if os.path.exists("roads.osm.pbf"):
        os.remove("roads.osm.pbf")
    shutil.rmtree("tiles", ignore_errors=True)
    os.mkdir("tiles")
    road = {"highway": "secondary"}
    with osmium.SimpleWriter("roads.osm.pbf") as out:
        for id, (east, north) in NODES.items():
            out.add_node(mutable.Node(id=id, version=1, location=(8.6 + east, 49.4 + north)))
        ways = [([5, 1], road), ([1, 2], road | sign), ([2, 6], road), ([1, 3, 4, 2], road)]
        for id, (nodes, tags) in enumerate(ways, 1):
            out.add_way(mutable.Way(id=id, version=1, nodes=nodes, tags=tags))
    config = valhalla.get_config(tile_extract="", tile_dir=f"{os.getcwd()}/tiles", verbose=False)
    config["mjolnir"].update(admin="", timezone="", concurrency=1)
    with open("config.json", "w") as file:
        json.dump(config, file)
    subprocess.run([f"{HOME}/bin/valhalla_build_tiles", "-c", "config.json", "roads.osm.pbf"], check=True, capture_output=True)
    return valhalla.Actor("config.json")

def km(actor, truck):
    places = [{"lat": 49.4, "lon": 8.598}, {"lat": 49.4, "lon": 8.606}]
    request = {"locations": places, "costing": "truck", "costing_options": {"truck": truck}}
    return round(json.loads(actor.route(json.dumps(request)))["trip"]["summary"]["length"], 2)

PASSES, ROUND = 0.58, 1.47
EXPECTED = [
    ({"maxlength": "45"}, "length", {44: PASSES, 46: ROUND, 50: ROUND, 53.5: PASSES}),
    ({"maxlength": "20"}, "length", {53.5: ROUND}),
    ({"maxweight": "90"}, "weight", {89: PASSES, 91: ROUND, 100: ROUND, 120: PASSES}),
    ({"maxaxles": "9"}, "axle_count", {8: PASSES, 10: ROUND, 20: ROUND, 21: PASSES}),
]
for sign, name, values in EXPECTED:
    there = actor(sign)
    seen = {value: km(there, {name: value}) for value in values}
    print(sign, name, seen)
    assert seen == values, f"expected {values}"
END
"$work/venv/bin/python" probe.py 2>/dev/null

#!/bin/sh
# Valhalla (PyPI: pyvalhalla 3.9.1): short tons and pounds count as if 2,000 lb were a metric tonne, so a truck of 9.9 t passes a sign of 9.07 t.
#
# Key:maxweight of OpenStreetMap's wiki has `st` for short tons (907 kg) and `lbs`. One would expect `10 st` and `20000 lbs` to be 9.07 t, as Valhalla
# reads feet (`12 ft` is 3.66 m) and kilograms rightly. A decimal comma is cut off: `7,5` is 7 t.
#
# Output seen with 3.9.1: the greatest of the weights tried, in t, that passes
#   maxweight=7.5: 7.5
#   maxweight=7500 kg: 7.5
#   maxweight=7,5: 7.0
#   maxweight=10 st: 10.0
#   maxweight=20000 lbs: 10.0
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
        ways = [([5, 1], road), ([1, 2], road | {"maxweight": sign}), ([2, 6], road), ([1, 3, 4, 2], road)]
        for id, (nodes, tags) in enumerate(ways, 1):
            out.add_way(mutable.Way(id=id, version=1, nodes=nodes, tags=tags))
    config = valhalla.get_config(tile_extract="", tile_dir=f"{os.getcwd()}/tiles", verbose=False)
    config["mjolnir"].update(admin="", timezone="", concurrency=1)
    with open("config.json", "w") as file:
        json.dump(config, file)
    subprocess.run([f"{HOME}/bin/valhalla_build_tiles", "-c", "config.json", "roads.osm.pbf"], check=True, capture_output=True)
    return valhalla.Actor("config.json")

def passes(actor, weight):
    places = [{"lat": 49.4, "lon": 8.598}, {"lat": 49.4, "lon": 8.606}]
    request = {"locations": places, "costing": "truck", "costing_options": {"truck": {"weight": weight}}}
    return json.loads(actor.route(json.dumps(request)))["trip"]["summary"]["length"] < 1

WEIGHTS = [tenths / 10 for tenths in range(50, 130)]
for sign, most in {"7.5": 7.5, "7500 kg": 7.5, "7,5": 7.0, "10 st": 10.0, "20000 lbs": 10.0}.items():
    there = actor(sign)
    seen = max(weight for weight in WEIGHTS if passes(there, weight))
    print(f"maxweight={sign}: {seen}")
    assert seen == most, f"expected {most}"
END
"$work/venv/bin/python" probe.py 2>/dev/null > seen
grep "^maxweight" seen

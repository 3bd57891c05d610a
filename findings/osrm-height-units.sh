#!/bin/sh
# OSRM (PyPI: osrm-bindings 26.10.0): a sign of `12 ft` lets a vehicle of 11 m pass, and `380 cm` one of 30 m.
#
# Key:maxheight of OpenStreetMap's wiki gives feet and inches as `12'6"`, and `12 ft` is common in the data. One would expect a unit that is not
# understood to be an error, or to close the road. OSRM's profiles take the number and count metres. `12'6"`, `12'` and `3,8` are read rightly.
#
# Output seen with 26.10.0, by maxheight: the vehicle heights, of 1, 3.5, 4, 11, 13 and 30 m, that pass under the sign
#   3.8 [1.0, 3.5]
#   12'6" [1.0, 3.5]
#   3,8 [1.0, 3.5]
#   12 ft [1.0, 3.5, 4.0, 11.0]
#   380 cm [1.0, 3.5, 4.0, 11.0, 13.0, 30.0]
#
# Needs python 3.12 or newer, which PYTHON may name. Fails if the behaviour is another one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet osrm-bindings==26.10.0 osmium==4.3.2
cd "$work"
cat > probe.py <<'END'
import glob, os, re, shutil, subprocess, sys
import osmium, osrm
from osmium.osm import mutable

NODES = {1: (0, 0), 2: (0.004, 0), 3: (0, 0.004), 4: (0.004, 0.004), 5: (-0.003, 0), 6: (0.007, 0)}
PROFILES = f"{os.path.dirname(osrm.__file__)}/share/profiles"

def run(*arguments):
    done = subprocess.run([sys.executable, "-m", "osrm", *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-800:] + done.stderr[-800:])

def passes(sign, height):
    """Whether a vehicle takes the road with the sign, and not the longer way round it."""
    for file in glob.glob("signs.os*"):
        os.remove(file)
    car = open(f"{PROFILES}/car.lua").read()
    with open("profiles/car.lua", "w") as file:
        file.write(re.sub(r"vehicle_height\s*=\s*[\d.]+", f"vehicle_height = {height}", car))
    road = {"highway": "secondary"}
    with osmium.SimpleWriter("signs.osm.pbf") as out:
        for id, (east, north) in NODES.items():
            out.add_node(mutable.Node(id=id, version=1, location=(8.6 + east, 49.4 + north)))
        ways = [([5, 1], road), ([1, 2], road | {"maxheight": sign}), ([2, 6], road), ([1, 3, 4, 2], road)]
        for id, (nodes, tags) in enumerate(ways, 1):
            out.add_way(mutable.Way(id=id, version=1, nodes=nodes, tags=tags))
    run("extract", "-p", "profiles/car.lua", "signs.osm.pbf")
    run("partition", "signs.osrm")
    run("customize", "signs.osrm")
    engine = osrm.OSRM(storage_config="signs.osrm", algorithm="MLD", use_shared_memory=False)
    ends = osrm.RouteParameters(coordinates=[(8.598, 49.4), (8.606, 49.4)])
    return engine.Route(ends)["routes"][0]["distance"] < 1000

shutil.copytree(PROFILES, "profiles")
HEIGHTS = [1.0, 3.5, 4.0, 11.0, 13.0, 30.0]
EXPECTED = {"3.8": 2, "12'6\"": 2, "3,8": 2, "12 ft": 4, "380 cm": 6}
for sign, count in EXPECTED.items():
    seen = [height for height in HEIGHTS if passes(sign, height)]
    print(sign, seen)
    assert seen == HEIGHTS[:count], f"expected {HEIGHTS[:count]}"
END
"$work/venv/bin/python" probe.py > seen
grep "^[0-9]" seen

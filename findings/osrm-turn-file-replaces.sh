#!/bin/sh
# OSRM (PyPI: osrm-bindings 26.10.0): the penalty in a file for `--turn-penalty-file` is not added to the time of a turn. It takes its place.
#
# One would expect that a turn with a penalty of 5 s takes 5 s longer. The profile's own seconds are dropped, so the turn becomes faster: the car
# profile gives a right angle about 7 s.
#
# Output seen with 26.10.0, for a turn of 90° to the left:
#   without a line: 7.3 s
#   with a penalty of 5 s: 5.0 s
#   with a penalty of 0 s: 0.0 s
#
# Needs python 3.12 or newer, which PYTHON may name. Fails if the behaviour is another one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet osrm-bindings==26.10.0 osmium==4.3.2
cd "$work"
cat > probe.py <<'END'
import os, shutil, subprocess, sys
import osmium, osrm
from osmium.osm import mutable

PLACES = {1: (8.0, 49.0), 2: (8.005, 49.0), 3: (8.005, 49.005), 4: (8.01, 49.0)}

def run(*arguments):
    done = subprocess.run([sys.executable, "-m", "osrm", *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-800:] + done.stderr[-800:])

def seconds(name, *lines):
    """What the turn from 1 over 2 to 3 takes."""
    shutil.copytree("roads", name)
    with open(f"{name}/turns.csv", "w") as file:
        file.writelines(lines)
    run("customize", f"{name}/x.osrm", *(["--turn-penalty-file", f"{name}/turns.csv"] if lines else []))
    engine = osrm.OSRM(storage_config=f"{name}/x.osrm", algorithm="MLD", use_shared_memory=False)
    ask = osrm.RouteParameters(coordinates=[(8.001, 49.0), (8.005, 49.003)], annotations=["duration"])
    leg = engine.Route(ask)["routes"][0]["legs"][0]
    return round(leg["duration"] - sum(leg["annotation"]["duration"]), 1)

os.mkdir("roads")
with osmium.SimpleWriter("roads/x.osm.pbf") as out:
    for node, place in PLACES.items():
        out.add_node(mutable.Node(id=node, version=1, location=place))
    for way, nodes in enumerate(([1, 2], [2, 3], [2, 4]), 1):
        out.add_way(mutable.Way(id=way, version=1, nodes=nodes, tags={"highway": "primary"}))
shutil.copytree(f"{os.path.dirname(osrm.__file__)}/share/profiles", "profiles")
run("extract", "-p", "profiles/car.lua", "roads/x.osm.pbf")
run("partition", "roads/x.osrm")
own, five, none = seconds("own"), seconds("five", "1,2,3,5\n"), seconds("none", "1,2,3,0\n")
print(f"without a line: {own} s")
print(f"with a penalty of 5 s: {five} s")
print(f"with a penalty of 0 s: {none} s")
assert own > 6 and (five, none) == (5, 0), "another behaviour"
END
"$work/venv/bin/python" probe.py > seen 2>&1 || { tail -n 20 seen; exit 1; }
grep "^with" seen

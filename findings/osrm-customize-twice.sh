#!/bin/sh
# OSRM (PyPI: osrm-bindings 26.10.0): `customize` with another table of speeds does not undo the table before.
#
# One would expect `osrm-customize --segment-speed-file b.csv` to give the same graph whatever table was applied to the files before, because
# it is the step that is repeated when speeds change. It rewrites its input in place instead: segments that a.csv closed (speed 0) stay closed,
# and routes along them last 2,097,156 s, though b.csv does not name them.
#
# Output seen with 26.10.0, on a grid of 6 by 6 crossings, where a.csv closes the third road and b.csv the fifth:
#   routes that differ: 11 of 36
#   along the third road: 146.0 s on fresh files, 2097155.7 s on files that were customized with a.csv before
#
# Needs python 3.12 or newer, which PYTHON may name. Fails if the behaviour is another one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet osrm-bindings==26.10.0 osmium==4.3.2
cd "$work"
cat > probe.py <<'END'
import glob, os, shutil, subprocess, sys
import osmium, osrm
from osmium.osm import mutable

SIDE, EAST, NORTH = 6, 0.003, 0.002

def node(x, y):
    return 1 + x + SIDE * y

def run(*arguments):
    done = subprocess.run([sys.executable, "-m", "osrm", *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-800:] + done.stderr[-800:])

def closed(row):
    pairs = [(node(x, row), node(x + 1, row)) for x in range(SIDE - 1)]
    return "".join(f"{a},{b},0\n{b},{a},0\n" for a, b in pairs)

def durations(graph):
    engine = osrm.OSRM(storage_config=graph, algorithm="MLD", use_shared_memory=False)
    def seconds(a, b):
        ends = [(8.6 + EAST / 6, 49.4 + NORTH * a), (8.6 + EAST * (SIDE - 1) - EAST / 6, 49.4 + NORTH * b)]
        return round(engine.Route(osrm.RouteParameters(coordinates=ends))["routes"][0]["duration"], 1)
    return {(a, b): seconds(a, b) for a in range(SIDE) for b in range(SIDE)}

with osmium.SimpleWriter("grid.osm.pbf") as out:
    for y in range(SIDE):
        for x in range(SIDE):
            out.add_node(mutable.Node(id=node(x, y), version=1, location=(8.6 + EAST * x, 49.4 + NORTH * y)))
    rows = [[node(x, y) for x in range(SIDE)] for y in range(SIDE)]
    columns = [[node(x, y) for y in range(SIDE)] for x in range(SIDE)]
    for id, nodes in enumerate(rows + columns, 1):
        out.add_way(mutable.Way(id=id, version=1, nodes=nodes, tags={"highway": "residential"}))
shutil.copytree(f"{os.path.dirname(osrm.__file__)}/share/profiles", "profiles")
run("extract", "-p", "profiles/car.lua", "grid.osm.pbf")
run("partition", "grid.osrm")
for name, row in [("a", 2), ("b", 4)]:
    with open(f"{name}.csv", "w") as file:
        file.write(closed(row))
found = {}
for folder, tables in [("fresh", "b"), ("again", "ab")]:
    os.mkdir(folder)
    for file in glob.glob("grid.osrm*"):
        shutil.copy(file, folder)
    for table in tables:
        run("customize", f"{folder}/grid.osrm", "--segment-speed-file", f"{table}.csv")
    found[folder] = durations(f"{folder}/grid.osrm")
differ = [pair for pair in found["fresh"] if found["fresh"][pair] != found["again"][pair]]
along = [found[folder][2, 2] for folder in ("fresh", "again")]
print(f"routes that differ: {len(differ)} of {len(found['fresh'])}")
print(f"along the third road: {along[0]} s on fresh files, {along[1]} s on files that were customized with a.csv before")
assert len(differ) > 5 and along[0] < 200 and along[1] > 1e6, "another behaviour"
END
"$work/venv/bin/python" probe.py > seen
grep "^routes\|^along" seen

#!/bin/sh
# OSRM (PyPI: osrm-bindings 26.10.0): of two lines for one segment, `customize` takes the first of a file, but the last of several files.
#
# One would expect one rule: the last line counts, as with several files. Within a file it is the other way round. So a line that closes a segment
# (speed 0), appended to a table that has a speed for that segment, does nothing, and OSRM gives no warning. In a second file it closes.
# `nan` is taken for a speed, too: such a segment takes 0.1 s.
#
# Output seen with 26.10.0, on a straight road of four segments, of which the second one gets 50 km/h and 0 km/h:
#   one file, 0 last: route
#   one file, 0 first: no route
#   two files, 0 in the last: no route
#   two files, 0 in the first: route
#   nan: route, 0.1 s on the segment
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

NODES = [1, 2, 3, 4, 5]

def run(*arguments):
    done = subprocess.run([sys.executable, "-m", "osrm", *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-800:] + done.stderr[-800:])

def found(name, *tables):
    os.mkdir(name)
    for file in os.listdir("road"):
        shutil.copy(f"road/{file}", name)
    options = []
    for number, lines in enumerate(tables):
        with open(f"{name}/{number}.csv", "w") as file:
            file.write(lines)
        options += ["--segment-speed-file", f"{name}/{number}.csv"]
    run("customize", f"{name}/x.osrm", *options)
    engine = osrm.OSRM(storage_config=f"{name}/x.osrm", algorithm="MLD", use_shared_memory=False)
    ask = osrm.RouteParameters(coordinates=[(8.6005, 49.4), (8.6035, 49.4)], annotations=["nodes", "duration"])
    try:
        leg = engine.Route(ask)["routes"][0]["legs"][0]["annotation"]
    except RuntimeError as error:
        if "NoRoute" not in str(error):
            raise
        return None
    pairs = zip(leg["nodes"], list(leg["nodes"])[1:])
    return [seconds for pair, seconds in zip(pairs, leg["duration"]) if pair == (2, 3)][0]

os.mkdir("road")
with osmium.SimpleWriter("road/x.osm.pbf") as out:
    for node in NODES:
        out.add_node(mutable.Node(id=node, version=1, location=(8.599 + 0.001 * node, 49.4)))
    for way, nodes in enumerate(([1, 2], [2, 3], [3, 4], [4, 5]), 1):
        out.add_way(mutable.Way(id=way, version=1, nodes=nodes, tags={"highway": "primary"}))
shutil.copytree(f"{os.path.dirname(osrm.__file__)}/share/profiles", "profiles")
run("extract", "-p", "profiles/car.lua", "road/x.osm.pbf")
run("partition", "road/x.osrm")
speed, closed = "2,3,50\n", "2,3,0\n"
seen = {
    "one file, 0 last": found("a", speed + closed),
    "one file, 0 first": found("b", closed + speed),
    "two files, 0 in the last": found("c", speed, closed),
    "two files, 0 in the first": found("d", closed, speed),
}
for name, seconds in seen.items():
    print(f"{name}: {'no route' if seconds is None else 'route'}")
nan = found("e", "2,3,nan\n")
print(f"nan: {'no route' if nan is None else f'route, {nan:.1f} s on the segment'}")
assert [seconds is None for seconds in seen.values()] == [False, True, True, False] and nan <= 0.1, "another behaviour"
END
"$work/venv/bin/python" probe.py > seen 2>&1 || { tail -n 20 seen; exit 1; }
grep "file\|^nan" seen

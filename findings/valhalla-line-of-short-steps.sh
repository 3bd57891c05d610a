#!/bin/sh
# Valhalla (PyPI: pyvalhalla 3.9.1) refuses a whole request if it cannot follow one of its `linear_cost_factors`; and it cannot follow some lines
# over the very nodes of a way.
#
# One would expect that a line with the positions of a way's nodes, from one junction to the next, can be followed along the way's edge. It cannot
# if the way begins at the junction with short steps, here of 2 and 4 m. The reverse of the line can be followed, and so can the line without its
# first or its last position. The error names no line, though a request may have thousands.
#
# Output seen with 3.9.1:
#   the way's nodes: Failed to edge walk line feature
#   the same backwards: ok
#   without the first one: ok
#   without the last one: ok
#   beside a line that can be followed: Failed to edge walk line feature
#
# Needs python 3.12 or newer, which PYTHON may name. Fails if the behaviour is another one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet pyvalhalla==3.9.1 osmium==4.3.2
cd "$work"
cat > probe.py <<'END'
import json, os, subprocess, sys
import osmium, valhalla
from osmium.osm import mutable

LINE = [[125.9262049, -30.3029622], [125.9262134, -30.3029803], [125.9262362, -30.3030103], [125.9302883, -30.3033939]]
BEFORE, AFTER = [125.9252, -30.3029], [125.9312, -30.3035]

with osmium.SimpleWriter("roads.osm.pbf") as out:
    places = {1: BEFORE, 2: AFTER, 3: [125.9242, -30.3019], 4: [125.9322, -30.3045]} | {10 + i: at for i, at in enumerate(LINE)}
    for node, at in sorted(places.items()):
        out.add_node(mutable.Node(id=node, version=1, location=tuple(at)))
    for way, nodes in enumerate(([1, 10], [10, 11, 12, 13], [13, 2], [10, 3], [13, 4]), 1):
        out.add_way(mutable.Way(id=way, version=1, nodes=nodes, tags={"highway": "primary"}))
os.mkdir("tiles")
config = valhalla.get_config(tile_extract="", tile_dir="tiles", verbose=False)
config["mjolnir"].update(admin="", timezone="", concurrency=1)
config["mjolnir"]["logging"] = {"type": ""}
with open("config.json", "w") as file:
    json.dump(config, file)
subprocess.run([f"{os.path.dirname(valhalla.__file__)}/bin/valhalla_build_tiles", "-c", "config.json", "roads.osm.pbf"], check=True, capture_output=True)
actor = valhalla.Actor("config.json")

def asked(*lines):
    def feature(line):
        return {"type": "Feature", "geometry": {"type": "LineString", "coordinates": line}, "properties": {"factor": 5.0}}
    places = [{"lon": lon, "lat": lat} for lon, lat in (BEFORE, AFTER)]
    request = {"costing": "auto", "locations": places, "linear_cost_factors": [feature(line) for line in lines]}
    try:
        actor.route(json.dumps(request))
        return "ok"
    except RuntimeError as error:
        return str(error)

seen = {
    "the way's nodes": asked(LINE),
    "the same backwards": asked(LINE[::-1]),
    "without the first one": asked(LINE[1:]),
    "without the last one": asked(LINE[:-1]),
    "beside a line that can be followed": asked(LINE[::-1], LINE),
}
for name, answer in seen.items():
    print(f"{name}: {answer}")
failed = "Failed to edge walk line feature"
assert list(seen.values()) == [failed, "ok", "ok", "ok", failed], "another behaviour"
END
"$work/venv/bin/python" probe.py

#!/bin/sh
# OSRM and Valhalla (PyPI: osrm-bindings 26.10.0, pyvalhalla 3.9.1): of a restriction with several `from` or `to`, some or all turns stay open.
#
# Relation:restriction of OpenStreetMap's wiki allows several `from` for `no_entry`, and several `to` for `no_exit`. One would expect every turn
# to be forbidden, or an error. Valhalla takes the last `from` and the first `to`. OSRM drops a restriction with several of both, and one
# with another word. With one restriction for each pair both engines forbid every turn.
#
# Output seen, by restriction: the forbidden turns that are driven
#   no_entry from 3 to 1: osrm 0, valhalla 2
#   no_exit from 1 to 3: osrm 0, valhalla 2
#   no_entry from 2 to 2: osrm 4, valhalla 3
#   no_straight_on from 3 to 1: osrm 3, valhalla 2
#   no_entry, one for each pair of 2 and 2: osrm 0, valhalla 0
#
# Needs python 3.12 or newer, which PYTHON may name. Fails if the behaviour is another one.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet osrm-bindings==26.10.0 pyvalhalla==3.9.1 osmium==4.3.2
cd "$work"
cat > probe.py <<'END'
import glob, json, os, shutil, subprocess, sys
import osmium, osrm, valhalla
from osmium.osm import mutable

# A crossing of five roads: the ends of the roads 1 to 5, which meet in node 6.
ENDS = {1: (0, 0.004), 2: (0.004, 0.001), 3: (0.0025, -0.0035), 4: (-0.0025, -0.0035), 5: (-0.004, 0.001)}
VALHALLA, OSRM = (os.path.dirname(module.__file__) for module in (valhalla, osrm))

def write(restrictions):
    for file in glob.glob("roads.os*"):
        os.remove(file)
    with osmium.SimpleWriter("roads.osm.pbf") as out:
        for id, (east, north) in {**ENDS, 6: (0, 0)}.items():
            out.add_node(mutable.Node(id=id, version=1, location=(8.6 + east, 49.4 + north)))
        for id in ENDS:
            out.add_way(mutable.Way(id=id, version=1, nodes=[id, 6], tags={"highway": "secondary"}))
        for id, (word, ways) in enumerate(restrictions, 1):
            members = [("w", way, role) for way, role in ways] + [("n", 6, "via")]
            out.add_relation(mutable.Relation(id=id, version=1, members=members, tags={"type": "restriction", "restriction": word}))

def run(*arguments):
    done = subprocess.run(arguments, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout[-800:] + done.stderr[-800:])

def halfway(way):
    return tuple(a + b / 2 for a, b in zip((8.6, 49.4), ENDS[way]))

# A forbidden turn takes a way over the end of another road, which is longer than 700 m.
def by_osrm(turns):
    run(sys.executable, "-m", "osrm", "extract", "-p", f"{OSRM}/share/profiles/car.lua", "roads.osm.pbf")
    for step in ("partition", "customize"):
        run(sys.executable, "-m", "osrm", step, "roads.osrm")
    engine = osrm.OSRM(storage_config="roads.osrm", algorithm="MLD", use_shared_memory=False)
    ask = lambda turn: osrm.RouteParameters(coordinates=[halfway(way) for way in turn])
    return sum(engine.Route(ask(turn))["routes"][0]["distance"] < 700 for turn in turns)

def by_valhalla(turns):
    shutil.rmtree("tiles", ignore_errors=True)
    os.mkdir("tiles")
    config = valhalla.get_config(tile_extract="", tile_dir=f"{os.getcwd()}/tiles", verbose=False)
    config["mjolnir"].update(admin="", timezone="", concurrency=1)
    with open("config.json", "w") as file:
        json.dump(config, file)
    run(f"{VALHALLA}/bin/valhalla_build_tiles", "-c", "config.json", "roads.osm.pbf")
    actor = valhalla.Actor("config.json")
    places = lambda turn: [{"lon": lon, "lat": lat, "minimum_reachability": 0} for lon, lat in map(halfway, turn)]
    ask = lambda turn: json.dumps({"locations": places(turn), "costing": "auto"})
    return sum(json.loads(actor.route(ask(turn)))["trip"]["summary"]["length"] < 0.7 for turn in turns)

for word, several_from, several_to, expected in [
    ("no_entry", [1, 2, 3], [4], (0, 2)),
    ("no_exit", [4], [1, 2, 3], (0, 2)),
    ("no_entry", [1, 2], [3, 4], (4, 3)),
    ("no_straight_on", [1, 2, 3], [4], (3, 2)),
    ("no_entry, one for each pair of", [1, 2], [3, 4], (0, 0)),
]:
    turns = [(a, b) for a in several_from for b in several_to]
    if "pair" in word:
        said = f"{word} {len(several_from)} and {len(several_to)}"
        write([("no_entry", [(a, "from"), (b, "to")]) for a, b in turns])
    else:
        said = f"{word} from {len(several_from)} to {len(several_to)}"
        write([(word, [(way, "from") for way in several_from] + [(way, "to") for way in several_to])])
    driven = by_osrm(turns), by_valhalla(turns)
    print(f"{said}: osrm {driven[0]}, valhalla {driven[1]}", flush=True)
    assert driven == expected, f"expected {expected}"
END
"$work/venv/bin/python" probe.py 2>/dev/null > seen
grep "^no_" seen

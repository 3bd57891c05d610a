"""OSRM, plain and with permits: the same pairs of places, and whether any way uses what is refused.

    python run_osrm.py EXTRACT TABLES OSRM_EXPORT REWRITTEN WORK PAIRS

TABLES: `export csv`; OSRM_EXPORT: `export osrm`; REWRITTEN: `export osm-pbf`. Prints one JSON object.
"""

import json
import os
import shutil
import subprocess
import sys

import osrm
from permits import Permits

HOME = os.path.dirname(osrm.__file__)
PENALTY_S = 3276.7


def run(program, *arguments):
    done = subprocess.run([f"{HOME}/bin/{program}", *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{program} failed: {done.stdout[-800:]}{done.stderr[-800:]}")


def engine(extract, work, name, customize=()):
    folder = f"{work}/{name}"
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    shutil.copy(extract, f"{folder}/x.osm.pbf")
    profiles = f"{work}/profiles"
    if not os.path.exists(profiles):
        shutil.copytree(f"{HOME}/share/profiles", profiles)
        shutil.copy(f"{os.path.dirname(__file__)}/../../docs/export/hgv.lua", profiles)
    run("osrm-extract", "-p", f"{profiles}/hgv.lua", f"{folder}/x.osm.pbf")
    run("osrm-partition", f"{folder}/x.osrm")
    run("osrm-customize", f"{folder}/x.osrm", *customize)
    return osrm.OSRM(storage_config=f"{folder}/x.osrm", algorithm="MLD", use_shared_memory=False)


def route(engine, pair):
    """Nodes, and seconds spent in turns; None where there is no way."""
    ask = osrm.RouteParameters(
        coordinates=pair, annotations=["nodes", "duration"], overview="false", continue_straight=True
    )
    try:
        answer = engine.Route(ask)
    except RuntimeError as error:
        if "NoRoute" in str(error) or "NoSegment" in str(error):
            return None
        raise
    leg = answer["routes"][0]["legs"][0]
    nodes = [int(node) for node in leg["annotation"]["nodes"]]
    return nodes, leg["duration"] - sum(leg["annotation"]["duration"])


def survey(permits, engine, pairs, plain=False):
    out = {"routed": 0, "none": 0, "refused_used": 0, "recognised": 0}
    ways, examples = [], []
    for pair in pairs:
        found = route(engine, [permits.middle(edge) for edge in pair])
        ways.append(found and found[0])
        if found is None:
            out["none"] += 1
            continue
        nodes, turning_s = found
        wrong = permits.judge(nodes)
        if not plain and turning_s >= PENALTY_S:
            # The penalty says it: the caller takes it for no way.
            out["recognised"] += 1
            ways[-1] = None
            if not wrong:
                examples.append(f"a penalty without a refused turn: {nodes}")
            continue
        out["routed"] += 1
        if wrong:
            out["refused_used"] += 1
            examples.append(wrong[0])
    return dict(out, examples=examples[:5]), ways


def main(extract, tables, tuned, rewritten, work, count):
    permits = Permits(extract, tables)
    pairs = permits.pairs(count, 5)
    files = ["--segment-speed-file", f"{tuned}/segment-speeds.csv", "--turn-penalty-file", f"{tuned}/turn-penalties.csv"]
    out, ways = {"edges_lost": permits.lost}, {}
    for name, from_file, customize in [("plain", extract, []), ("csv", extract, files), ("pbf", rewritten, [])]:
        out[name], ways[name] = survey(permits, engine(from_file, work, name, customize), pairs, name == "plain")
    json.dump({"pairs": pairs, **ways}, open(f"{work}/ways.json", "w"))
    print(json.dumps(out))


if __name__ == "__main__":
    main(*sys.argv[1:])

"""OSRM, plain and with permits: the same pairs of places, and whether any way uses what is refused or lies elsewhere; then every
step that is refused, and whether OSRM drives it.

    python run_osrm.py EXTRACT TABLES OSRM_EXPORT REWRITTEN WORK PAIRS

TABLES: `export csv`; OSRM_EXPORT: `export osrm`; REWRITTEN: `export osm-pbf`. Prints one JSON object.
"""

import json
import os
import shutil
import subprocess
import sys
from collections import namedtuple
from functools import partial

import osrm
import probe_osrm
from permits import END_M, Permits

HOME = os.path.dirname(osrm.__file__)
PENALTY_S = 3276.7
# Nodes, seconds spent in turns, and where the way begins and ends.
Way = namedtuple("Way", "nodes turning_s ends")


def run(program, *arguments):
    done = subprocess.run([f"{HOME}/bin/{program}", *arguments], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{program} failed: {done.stdout[-800:]}{done.stderr[-800:]}")


def engine(extract, work, name, customize=()):
    partitioned(extract, work, name)
    return customized(f"{work}/{name}", customize)


def partitioned(extract, work, name):
    """Makes the files of a graph that every vehicle can have a copy of."""
    folder = f"{work}/{name}"
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    shutil.copy(extract, f"{folder}/x.osm.pbf")
    profiles = f"{work}/profiles"
    if not os.path.exists(profiles):
        shutil.copytree(f"{HOME}/share/profiles", profiles)
        shutil.copy(f"{os.path.dirname(__file__)}/../../docs/export/hgv.lua", profiles)
    # Otherwise OSRM moves a place on a small component to a large one, kilometres away.
    run("osrm-extract", "-p", f"{profiles}/hgv.lua", "--small-component-size", "1", f"{folder}/x.osm.pbf")
    run("osrm-partition", f"{folder}/x.osrm")


def customized(folder, customize):
    """An engine on the files of a folder, which `customize` changes."""
    run("osrm-customize", f"{folder}/x.osrm", *customize)
    return osrm.OSRM(storage_config=f"{folder}/x.osrm", algorithm="MLD", use_shared_memory=False)


def route(engine, pair, radius_m=END_M):
    """None where there is no way."""
    ask = osrm.RouteParameters(
        coordinates=pair, annotations=["nodes", "duration"], overview="false", continue_straight=True, radiuses=[radius_m] * 2
    )
    try:
        answer = engine.Route(ask)
    except RuntimeError as error:
        if "NoRoute" in str(error) or "NoSegment" in str(error):
            return None
        raise
    leg = answer["routes"][0]["legs"][0]
    nodes = [int(node) for node in leg["annotation"]["nodes"]]
    ends = [tuple(waypoint["location"]) for waypoint in answer["waypoints"]]
    return Way(nodes, leg["duration"] - sum(leg["annotation"]["duration"]), ends)


def survey(permits, engine, pairs, plain=False):
    out = {"routed": 0, "none": 0, "refused_used": 0, "recognised": 0, "elsewhere": 0}
    ways, examples = [], []
    for pair in pairs:
        asked = [permits.middle(edge) for edge in pair]
        found = route(engine, asked)
        ways.append(found and found.nodes)
        if found is None:
            out["none"] += 1
            continue
        wrong, elsewhere = permits.judge(found.nodes), permits.elsewhere(found.ends, asked)
        if not plain and found.turning_s >= PENALTY_S:
            # The penalty says it: the caller takes it for no way.
            out["recognised"] += 1
            ways[-1] = None
            if not wrong:
                examples.append(f"a penalty without a refused turn: {found.nodes}")
            continue
        out["routed"] += 1
        out["refused_used"] += bool(wrong)
        out["elsewhere"] += bool(elsewhere)
        examples += (wrong + elsewhere)[:1]
    return dict(out, examples=examples[:5]), ways


def second_vehicle(extract, work, tuned, files, judge):
    """How many ways differ from those on fresh files, where another vehicle's table, with all segments closed that the vehicle may
    use, was applied before: to another copy of the partitioned files, and to the same files."""
    permits, pairs, expected = judge
    closed = set(open(f"{tuned}/segment-speeds.csv").read().split())
    opposite = f"{work}/opposite.csv"
    with open(opposite, "w") as file:
        file.writelines(f"{a},{b},0\n" for a, b in permits.over if f"{a},{b},0" not in closed)
    partitioned(extract, work, "shared")
    out = {}
    for name, same_files in [("copy", False), ("same", True)]:
        first, own = f"{work}/{name}-first", f"{work}/{name}-own"
        shutil.copytree(f"{work}/shared", first)
        customized(first, ["--segment-speed-file", opposite])
        shutil.copytree(first if same_files else f"{work}/shared", own)
        _, ways = survey(permits, customized(own, files), pairs)
        out[name] = sum(a != b for a, b in zip(ways, expected, strict=True))
    return out


def main(extract, tables, tuned, rewritten, work, count):
    permits = Permits(extract, tables)
    pairs = permits.pairs(count, 5)
    files = ["--segment-speed-file", f"{tuned}/segment-speeds.csv", "--turn-penalty-file", f"{tuned}/turn-penalties.csv"]
    out, ways = {"edges_lost": permits.lost}, {}
    for name, from_file, customize in [("plain", extract, []), ("csv", extract, files), ("pbf", rewritten, [])]:
        made = engine(from_file, work, name, customize)
        out[name], ways[name] = survey(permits, made, pairs, name == "plain")
        out[name]["probe"] = probe_osrm.probe(permits, partial(route, made))
    out["second"] = second_vehicle(extract, work, tuned, files, (permits, pairs, ways["csv"]))
    json.dump({"pairs": pairs, **ways}, open(f"{work}/ways.json", "w"))
    print(json.dumps(out))


if __name__ == "__main__":
    main(*sys.argv[1:])

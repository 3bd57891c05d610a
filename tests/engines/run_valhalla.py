"""Valhalla's truck costing, plain and with permits: the same pairs of places, and whether any way uses what is refused or lies
elsewhere; then every edge of the tiles that is refused, and whether a truck may drive it.

    python run_valhalla.py EXTRACT TABLES VALHALLA_EXPORT WORK PAIRS

TABLES: `export csv`; VALHALLA_EXPORT: `export valhalla`. Prints one JSON object.
"""

import json
import os
import shutil
import subprocess
import sys

import probe_valhalla
import valhalla
from permits import END_M, Permits

HOME = os.path.dirname(valhalla.__file__)


def engine(extract, work, name):
    folder = f"{work}/{name}"
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(f"{folder}/tiles")
    config = valhalla.get_config(tile_extract="", tile_dir=f"{folder}/tiles", verbose=False)
    config["mjolnir"].update(admin="", timezone="", concurrency=1)
    config["mjolnir"]["logging"] = config.get("loki", {}).get("logging", {}) | {"type": ""}
    with open(f"{folder}/config.json", "w") as file:
        json.dump(config, file)
    build = [f"{HOME}/bin/valhalla_build_tiles", "-c", f"{folder}/config.json", extract]
    done = subprocess.run(build, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"valhalla_build_tiles failed: {done.stdout[-800:]}{done.stderr[-800:]}")
    return valhalla.Actor(f"{folder}/config.json")


def route(actor, request, pair):
    """The line; None where there is no way."""
    like = dict(request["locations"][0], search_cutoff=END_M)
    return answered(actor, dict(request, locations=[dict(like, lon=lon, lat=lat) for lon, lat in pair]))


def answered(actor, request):
    """The same for a request."""
    try:
        answer = json.loads(actor.route(json.dumps(request)))
    except RuntimeError as error:
        # No suitable edge near a place, no path between them: https://valhalla.github.io/valhalla/api/turn-by-turn/api-reference/
        if any(word in str(error) for word in ("No path", "No suitable", "not be connected", "Locations are in unconnected")):
            return None
        raise
    return decoded(answer["trip"]["legs"][0]["shape"])


def decoded(shape):
    """Google's encoded polyline with six decimals."""
    line, at, place = [], 0, [0, 0]
    while at < len(shape):
        for axis in (0, 1):
            value, shift = 0, 0
            while True:
                byte = ord(shape[at]) - 63
                at += 1
                value |= (byte & 31) << shift
                shift += 5
                if byte < 32:
                    break
            place[axis] += ~(value >> 1) if value & 1 else value >> 1
        line.append((place[1] / 1e6, place[0] / 1e6))
    return line


def survey(permits, actor, request, pairs):
    out, ways, examples = {"routed": 0, "none": 0, "refused_used": 0, "elsewhere": 0}, [], []
    for pair in pairs:
        asked = [permits.middle(edge) for edge in pair]
        line = route(actor, request, asked)
        if line is None:
            ways.append(None)
            out["none"] += 1
            continue
        nodes = permits.whole(permits.nodes_of(line), pair)
        ways.append(nodes)
        wrong, elsewhere = permits.judge(nodes), permits.elsewhere((line[0], line[-1]), asked)
        out["routed"] += 1
        out["refused_used"] += bool(wrong)
        out["elsewhere"] += bool(elsewhere)
        examples += [[text, pair] for text in (wrong + elsewhere)[:1]]
    return dict(out, examples=examples[:5]), ways


def main(extract, tables, export, work, count):
    permits = Permits(extract, tables)
    pairs = permits.pairs(count, 5)
    request = json.load(open(f"{export}/request.json"))
    out, ways = {"edges_lost": permits.lost}, {}
    for name, file in [("plain", extract), ("permits", f"{export}/extract.osm.pbf")]:
        actor = engine(file, work, name)
        out[name], ways[name] = survey(permits, actor, request, pairs)
        out[name]["probe"] = probe_valhalla.probe(permits, actor, f"{work}/{name}", file, request)
    json.dump({"pairs": pairs, **ways}, open(f"{work}/ways.json", "w"))
    print(json.dumps(out))


if __name__ == "__main__":
    main(*sys.argv[1:])

#!/usr/bin/env python3
"""Asks programs for routes between random main roads, and compares what they answer and how long it takes.

    benches/routes.py [--pairs N] [--seed S] REGION.gpkg VEHICLE NETCERT [NETCERT...] [-- ROUTE_OPTION...]

A pair is two edges of main roads, 2 to 15 km apart in a straight line. The programs are asked in turn, pair after pair. A pair that none
answers is left out. A pair that only some answer ends the run. Printed: the answers of each kind, conditions, metres of oncoming lanes, and
seconds by the clock; then each pair on which the programs differ.
"""

import argparse
import json
import math
import random
import sqlite3
import struct
import subprocess
import sys
import time

# So many pairs are drawn at most for each that is asked for, and so many without any answer end the run.
MOST_DRAWS = 1000
MOST_FAILED = 50
MAIN = ("primary", "secondary", "tertiary", "trunk")


def middles(db):
    """The middles of all edges of main roads, by id: longitude and latitude."""
    rows = sqlite3.connect(db).execute(
        f"select edge_id, geom from edge where highway in ({','.join('?' * len(MAIN))}) order by edge_id", MAIN
    )
    found = []
    for _, blob in rows:
        # A GeoPackage's header: magic, version, flags, SRS; then a box of the size that the flags name, then WKB.
        envelope = (0, 32, 48, 48, 64)[blob[3] >> 1 & 7]
        wkb = blob[8 + envelope :]
        count = struct.unpack_from("<I", wkb, 5)[0]
        found.append(struct.unpack_from("<2d", wkb, 9 + 16 * (count // 2)))
    return found


def apart_km(a, b):
    """Distance of two places, kilometres."""
    east = (a[0] - b[0]) * math.cos(math.radians(a[1]))
    return 111.2 * math.hypot(east, a[1] - b[1])


def ask(netcert, db, vehicle, pair, options):
    """The answer to one pair, and its seconds. `None` if there is no answer."""
    places = [f"{lon:.7f},{lat:.7f}" for lon, lat in pair]
    began = time.monotonic()
    run = subprocess.run(
        [netcert, "route", "--db", db, "--vehicle", vehicle, f"--from={places[0]}", f"--to={places[1]}", "--format", "json", *options],
        capture_output=True,
        text=True,
        check=False,
    )
    seconds = time.monotonic() - began
    try:
        return summary(json.loads(run.stdout)), seconds
    except ValueError:
        return None, seconds


def summary(answer):
    """What kind of answer it is, its conditions, and its metres of oncoming lanes."""
    routes, conditional = answer.get("routes") or [], answer.get("conditional")
    best = routes[0] if routes else conditional
    kind = "certified" if routes else "conditions" if conditional and conditional.get("conditions_suffice") else "none"
    if kind == "none":
        return kind, None, None
    oncoming = sum(use["to_m"] - use["from_m"] for use in best["uses"] if use["strip"] == "carriageway")
    return kind, len(best.get("conditions") or []), round(oncoming)


def share(values, percent):
    """A percentile."""
    values = sorted(values)
    return values[min(len(values) - 1, math.ceil(percent / 100 * len(values)) - 1)] if values else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("db")
    parser.add_argument("vehicle")
    parser.add_argument("netcert", nargs="+")
    given = sys.argv[1:]
    cut = given.index("--") if "--" in given else len(given)
    arguments, options = parser.parse_args(given[:cut]), given[cut + 1 :]
    draw, places = random.Random(arguments.seed), middles(arguments.db)
    answers = {netcert: [] for netcert in arguments.netcert}
    asked, failed = [], {netcert: 0 for netcert in arguments.netcert}
    for _ in range(MOST_DRAWS * arguments.pairs):
        pair = draw.sample(places, 2)
        if len(asked) == arguments.pairs or not 2 <= apart_km(*pair) <= 15:
            continue
        of_each = [ask(netcert, arguments.db, arguments.vehicle, pair, options) for netcert in arguments.netcert]
        if any(answer is None for answer, _ in of_each):
            for netcert, (answer, _) in zip(arguments.netcert, of_each, strict=True):
                failed[netcert] += answer is None
            if len(set(failed.values())) > 1 or sum(failed.values()) > MOST_FAILED * len(failed):
                sys.exit(f"no answer, by program: {failed}; the last pair was {pair}")
            continue
        asked.append(pair)
        for netcert, answer in zip(arguments.netcert, of_each, strict=True):
            answers[netcert].append(answer)
    for netcert, found in answers.items():
        kinds = [answer[0] for answer, _ in found]
        conditions = [answer[1] for answer, _ in found if answer[0] == "conditions"]
        seconds = [seconds for _, seconds in found]
        print(netcert)
        print("  certified, under conditions, none:", *(kinds.count(kind) for kind in ("certified", "conditions", "none")))
        print("  conditions: 50, 90 %, all:", share(conditions, 50), share(conditions, 90), sum(conditions))
        print("  metres of oncoming lanes:", sum(answer[2] or 0 for answer, _ in found))
        print("  seconds: 50, 90, 95 %, most, all:", *(f"{s:.1f}" for s in [*(share(seconds, p) for p in (50, 90, 95, 100)), sum(seconds)]))
    for pair, *of_each in zip(asked, *answers.values(), strict=True):
        if len({answer for answer, _ in of_each}) > 1:
            print(*(f"{lon:.5f},{lat:.5f}" for lon, lat in pair), *(f"{answer} {seconds:.1f} s" for answer, seconds in of_each), sep="; ")


main()

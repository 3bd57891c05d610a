#!/usr/bin/env python3
"""Memory and time of `ingest` by size of the extract, and time of `update` by number of changed ways, as tables and three small plots.

    benches/sizes.py NETCERT PLOT.svg VEHICLE UPDATED.osm.pbf EXTRACT.osm.pbf [EXTRACT...]

Extracts are ingested with `--no-certify`: corridors, turns and areas of junctions are laid out and stored for all roads. Large extracts can be
made of several small ones by copying them to other places. UPDATED is certified for VEHICLE, with turns, and then some ways of
it get another width. Needs osmium and only Python's standard library.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from growth import plot

CHANGED = (1, 10, 100, 1000)


def run(*command):
    """User seconds, wall seconds and the greatest memory in MB of a program."""
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)}: failed")
    return used.ru_utime, time.monotonic() - begin, used.ru_maxrss / 1024


def write_changes(extract, count, path):
    """Changes that give `count` roads, spread over the extract, a width of 6.3 m."""
    listed = subprocess.run(
        ["osmium", "tags-filter", "-R", "--no-progress", "-f", "opl", extract, "w/highway=residential,tertiary,secondary"],
        check=True, capture_output=True, text=True,
    ).stdout.splitlines()
    ways = [dict((field[0], field[1:]) for field in line.split(" ")) for line in listed if line.startswith("w")]
    plain = [way for way in ways if "%" not in way["T"] and "width" not in way["T"]]
    with open(path, "w", encoding="utf-8") as out:
        out.write('<osmChange version="0.6"><modify>\n')
        for way in plain[:: max(1, len(plain) // count)][:count]:
            version = int(way.get("v", "1")) + 1
            out.write(f'<way id="{way["w"]}" version="{version}" timestamp="2038-01-01T00:00:00Z">')
            out.writelines(f'<nd ref="{ref.lstrip("n")}"/>' for ref in way["N"].split(","))
            tags = dict(tag.split("=", 1) for tag in way["T"].split(",")) | {"width": "6.3"}
            escaped = lambda text: text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
            out.writelines(f'<tag k="{escaped(k)}" v="{escaped(v)}"/>' for k, v in tags.items())
            out.write("</way>\n")
        out.write("</modify></osmChange>\n")


def main():
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    netcert, picture, vehicle, updated, *extracts = sys.argv[1:]
    sizes, updates = [], []
    with tempfile.TemporaryDirectory(dir=".") as folder:
        db, changes = str(Path(folder) / "region.gpkg"), str(Path(folder) / "changes.osc")
        print("| extract, MB | user s | wall s | memory, MB |\n| --- | --- | --- | --- |")
        for extract in sorted(extracts, key=os.path.getsize):
            user, wall, memory = run(netcert, "ingest", "-q", extract, "--db", db, "--no-certify", "--driving-side", "right")
            megabytes = os.path.getsize(extract) / 1e6
            sizes.append((megabytes, wall, memory))
            print(f"| {megabytes:.1f} | {user:.1f} | {wall:.1f} | {memory:.0f} |", flush=True)
        print("\n| ways changed | user s | wall s | memory, MB |\n| --- | --- | --- | --- |")
        first = run(netcert, "ingest", "-q", updated, "--db", db, "--vehicle", vehicle)
        original = Path(db).read_bytes()
        for count in CHANGED:
            write_changes(updated, count, changes)
            Path(db).write_bytes(original)
            user, wall, memory = run(netcert, "update", "-q", "--db", db, "--extract", updated, changes)
            updates.append((count, wall))
            print(f"| {count} | {user:.1f} | {wall:.1f} | {memory:.0f} |", flush=True)
        print(f"| all, by `ingest` | {first[0]:.1f} | {first[1]:.1f} | {first[2]:.0f} |")
    panels = [
        ("Ingest", "MB of extract", "wall seconds", [(size, wall) for size, wall, _ in sizes]),
        ("Ingest", "MB of extract", "MB of memory", [(size, memory) for size, _, memory in sizes]),
        ("Update", "changed ways", "wall seconds", updates),
    ]
    plot(panels, picture)


if __name__ == "__main__":
    main()

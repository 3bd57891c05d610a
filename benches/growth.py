#!/usr/bin/env python3
"""How the time of certificates grows with roads, vehicles, units and threads, as a table and four small plots.

    benches/growth.py NETCERT PLOT.svg EXTRACT.osm.pbf [EXTRACT...]

NETCERT is the program. The first extract serves for vehicles, units and threads, all extracts for roads. Every run is
`ingest --no-turns --needs off` under the lane policy. Seconds are user seconds on one thread, and wall seconds for
threads. Each is the least of three runs. Only Python's standard library is needed.
"""

import os
import resource
import sqlite3
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from xml.sax.saxutils import escape

RUNS = 3
VEHICLE = "EU-SEMI16.5"
COUNTS = (1, 2, 4, 8, 16, 35)


def run(netcert, extract, vehicles, threads, db):
    """User seconds and wall seconds of one run."""
    command = [netcert, "ingest", "--quiet", "--no-turns", "--needs", "off", "--threads", str(threads)]
    command += ["--db", db, extract, "--vehicle", *vehicles]
    Path(db).unlink(missing_ok=True)
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime, time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, time.monotonic() - begin


def least(netcert, extract, vehicles, threads, db):
    """The least user and wall seconds of some runs."""
    runs = [run(netcert, extract, vehicles, threads, db) for _ in range(RUNS)]
    return min(user for user, _ in runs), min(wall for _, wall in runs)


def catalogue(netcert):
    """Ids of the catalogue, and their numbers of units."""
    listed = subprocess.run([netcert, "vehicles", "list"], check=True, capture_output=True, text=True).stdout
    # id, region, length, "m", units
    rows = [line.split() for line in listed.splitlines()[1:]]
    return {row[0]: int(row[4]) for row in rows if len(row) > 4}


def kilometres(db):
    with sqlite3.connect(f"file:{db}?mode=ro", uri=True) as connection:
        return connection.execute("SELECT sum(length_m) / 1000 FROM edge").fetchone()[0]


def panel(title, across, up, points, left, top):
    """A plot of 260 by 200. The line goes through the origin and the last point: what is proportional lies on it."""
    width, height = 190, 130
    most_x, most_y = max(x for x, _ in points) * 1.08, max(y for _, y in points) * 1.12
    at = lambda x, y: (left + 48 + width * x / most_x, top + 28 + height * (1 - y / most_y))
    (x0, y0), (x1, y1) = at(0, 0), at(*points[-1])
    shapes = [f'<text class="title" x="{left + 48}" y="{top + 16}">{escape(title)}, {escape(up)}</text>']
    shapes.append(f'<path class="axis" d="M{x0:.1f} {top + 28}V{y0:.1f}h{width}"/>')
    shapes.append(f'<path class="line" d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}"/>')
    for x, y in points:
        px, py = at(x, y)
        shapes.append(f'<circle cx="{px:.1f}" cy="{py:.1f}" r="3.5"><title>{x:.4g}: {y:.3g}</title></circle>')
    last_x, last_y = points[-1]
    shapes.append(f'<text x="{x1:.1f}" y="{y0 + 14:.1f}" text-anchor="middle">{last_x:,.0f}</text>')
    shapes.append(f'<text x="{x0 - 5:.1f}" y="{y1 + 4:.1f}" text-anchor="end">{last_y:.3g}</text>')
    shapes.append(f'<text x="{x0:.1f}" y="{y0 + 14:.1f}" text-anchor="middle">0</text>')
    shapes.append(f'<text x="{x0 + width / 2:.1f}" y="{y0 + 30:.1f}" text-anchor="middle">{escape(across)}</text>')
    return "\n".join(shapes)


def plot(panels, file):
    style = (
        "text{font:11px sans-serif;fill:#24323d}.title{font-weight:bold}"
        ".axis{fill:none;stroke:#7b8a96}.line{stroke:#b9c4cc;stroke-dasharray:4 3}circle{fill:#0b6e99}"
    )
    places = [(0, 0), (270, 0), (0, 210), (270, 210)]
    body = "\n".join(panel(*one, *place) for one, place in zip(panels, places))
    size = 'width="540" height="420" viewBox="0 0 540 420"'
    svg = f'<svg xmlns="http://www.w3.org/2000/svg" {size}><style>{style}</style><rect width="540" height="420" fill="#fff"/>\n{body}\n</svg>\n'
    Path(file).write_text(svg, encoding="utf-8")


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    netcert, picture, *extracts = sys.argv[1:]
    units = catalogue(netcert)
    with tempfile.TemporaryDirectory() as folder:
        db = str(Path(folder) / "growth.gpkg")
        roads = []
        for extract in extracts:
            user, _ = least(netcert, extract, [VEHICLE], 1, db)
            roads.append((kilometres(db), user))
        roads.sort()
        first = extracts[0]
        fleets = [(count, list(units)[:count]) for count in COUNTS if count <= len(units)]
        vehicles = [(count, least(netcert, first, fleet, 1, db)[0]) for count, fleet in fleets]
        one_of = {}
        for vehicle, count in units.items():
            one_of.setdefault(count, vehicle)
        by_units = [(n, least(netcert, first, [one_of[n]], 1, db)[0]) for n in sorted(one_of)]
        fleet = list(units)[: COUNTS[3]]
        threads = [(n, least(netcert, first, fleet, n, db)[1]) for n in range(1, (os.cpu_count() or 1) + 1)]
    print("| growth with | values | seconds |\n| --- | --- | --- |")
    show = lambda points: (", ".join(f"{x:,.0f}" for x, _ in points), ", ".join(f"{y:.2f}" for _, y in points))
    table = {
        f"km of directed edges, {VEHICLE}": roads,
        "vehicles": vehicles,
        "units of one vehicle": by_units,
        f"threads, {len(fleet)} vehicles, wall": threads,
    }
    for name, points in table.items():
        print(f"| {name} | {' | '.join(show(points))} |")
    speed = [(n, threads[0][1] / wall) for n, wall in threads]
    plot(
        [
            ("Roads", "km of directed edges", "user seconds", roads),
            ("Vehicles", "vehicles", "user seconds", vehicles),
            ("Units", "units of one vehicle", "user seconds", by_units),
            ("Threads", "threads", "times as fast", speed),
        ],
        picture,
    )


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""How near the table of `netcert corners` comes to the corners of a map.

    benches/corners.py NETCERT VEHICLE EXTRACT.osm.pbf [WEST,SOUTH,EAST,NORTH]

Certifies the extract on the whole carriageway with certified needs of turns, or the part of it in the box (with osmium). Of each turn over one node
whose kerb is assumed, the table is read at the nearest angle and at the nearest width of each road that is not wider. Only Python's standard
library is needed.
"""

import json
import sqlite3
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path


def table(netcert, vehicle):
    """Least radius by angle, width left and width entered."""
    done = subprocess.run([netcert, "corners", "-q", "--vehicle", vehicle, "--format", "json"], check=True, capture_output=True)
    corners = json.loads(done.stdout)["corners"][0]
    widths = corners["from_and_to_widths_m"]
    return {
        (angle["turn_deg"], left, entered): least
        for angle in corners["angles"]
        for left, row in zip(widths, angle["least_kerb_radius_m"])
        for entered, least in zip(widths, row)
    }


def turns(netcert, vehicle, extract, box, folder):
    """Angle, both widths, assumed kerb, verdict and needed kerb of each turn that counts."""
    if box:
        ordered, part = (str(Path(folder, f"{name}.osm.pbf")) for name in ("ordered", "part"))
        subprocess.run(["osmium", "sort", "-o", ordered, extract], check=True, capture_output=True)
        subprocess.run(["osmium", "extract", "-b", box, "-o", part, ordered], check=True, capture_output=True)
        extract = part
    db = str(Path(folder, "region.gpkg"))
    ingest = [netcert, "ingest", "-q", extract, "--db", db, "--vehicle", vehicle, "--corridor", "carriageway", "--needs", "all"]
    subprocess.run(ingest, check=True, capture_output=True)
    return sqlite3.connect(db).execute(
        "SELECT t.angle_deg, a.carriageway_width_m, b.carriageway_width_m, t.kerb_radius_m, c.verdict, c.need_kerb_radius_m "
        "FROM turn AS t JOIN turn_certificate AS c ON c.turn_fid = t.fid JOIN edge AS a ON a.fid = t.from_fid "
        "JOIN edge AS b ON b.fid = t.to_fid WHERE t.kind NOT IN ('complex', 'roundabout') AND t.kerb_source = 'assumed' AND "
        "a.carriageway_width_m NOT NULL AND b.carriageway_width_m NOT NULL AND "
        "(c.verdict = 'safe' OR (c.verdict = 'unsafe' AND c.reason = 'width'))"
    ).fetchall()


def main():
    netcert, vehicle, extract, *box = sys.argv[1:]
    least = table(netcert, vehicle)
    angles = sorted({key[0] for key in least})
    widths = sorted({key[1] for key in least})
    count, apart = Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        for angle, left, entered, kerb, verdict, need in turns(netcert, vehicle, extract, box[0] if box else None, folder):
            if abs(angle) < angles[0] - 7.5 or abs(angle) > angles[-1] + 7.5 or min(left, entered) < widths[0]:
                count["beyond the table"] += 1
                continue
            nearest = min(angles, key=lambda known: abs(known - abs(angle)))
            said = least[(nearest, *(max(w for w in widths if w <= width + 1e-6) for width in (left, entered)))]
            does = said is not None and said <= kerb + 1e-6
            if verdict == "safe":
                count["safe"] += 1
                count["safe, and the table says so"] += does
            else:
                count["unsafe"] += 1
                count["unsafe, and the table says so"] += not does
                count["unsafe, neither names a radius"] += need is None and said is None
                count["unsafe, the turn alone names one"] += need is not None and said is None
                count["unsafe, the table alone names one"] += need is None and said is not None
                if need is not None and said is not None:
                    apart.append(said - need)
    apart.sort()
    at = lambda share: f"{apart[min(len(apart) - 1, int(share * len(apart)))]:+.1f}" if apart else "-"
    print(f"{Path(extract).name}, {vehicle}")
    for what, number in count.items():
        print(f"{number:7} {what}")
    print(f"{len(apart):7} unsafe, both name a radius; the table's less the turn's, m, at 5, 25, 50, 75, 95 %: "
          + ", ".join(map(at, (0.05, 0.25, 0.5, 0.75, 0.95))))


if __name__ == "__main__":
    main()

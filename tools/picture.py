#!/usr/bin/env python3
"""picture.py DB OUT.svg: the roads of a database, drawn by which of two vehicles may use them.

Asks `target/release/netcert query` for both and draws an SVG: the picture in README.md.
"""
import json
import math
import subprocess
import sys

TRAIN, SEMI = "AU-ATRIPLE53", "AU-SEMI19"
WIDTH = 900
COLOURS = {"both": "#0072b2", "semi": "#e69f00", "none": "#c8c8c8"}  # told apart by colour-blind people, too
LEGEND = {
    "both": "3-trailer road train (53.2 m) and semi-trailer",
    "semi": "semi-trailer (19 m) only",
    "none": "neither, or not known",
}


def safe_edges(db, vehicle):
    command = ["target/release/netcert", "query", "--db", db, "--vehicle", vehicle, "--format", "geojson", "--quiet"]
    features = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["features"]
    lines = {f["properties"]["edge_id"]: f["geometry"]["coordinates"] for f in features}
    return lines, {f["properties"]["edge_id"] for f in features if f["properties"]["verdict"] == "safe"}


def main():
    db, out = sys.argv[1:]
    lines, train = safe_edges(db, TRAIN)
    _, semi = safe_edges(db, SEMI)
    lons = [p[0] for line in lines.values() for p in line]
    lats = [p[1] for line in lines.values() for p in line]
    west, north = min(lons), max(lats)
    squeeze = math.cos(math.radians((north + min(lats)) / 2))
    scale = (WIDTH - 40) / ((max(lons) - west) * squeeze)
    height = (north - min(lats)) * scale + 110
    layers = {"none": [], "semi": [], "both": []}
    for edge, line in lines.items():
        kind = "both" if edge in train and edge in semi else "semi" if edge in semi else "none"
        points = " ".join(f"{20 + (x - west) * squeeze * scale:.1f},{20 + (north - y) * scale:.1f}" for x, y in line)
        layers[kind].append(f'<polyline points="{points}"/>')
    svg = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0f}" font-family="sans-serif">',
        f'<rect width="{WIDTH}" height="{height:.0f}" fill="#fff"/>',
    ]
    for kind, shapes in layers.items():
        width = 1.2 if kind == "none" else 2.6
        svg.append(f'<g fill="none" stroke="{COLOURS[kind]}" stroke-width="{width}" stroke-linejoin="round">')
        svg += shapes + ["</g>"]
    for row, kind in enumerate(("both", "semi", "none")):
        y = height - 66 + 22 * row
        svg.append(f'<rect x="20" y="{y - 6:.0f}" width="30" height="5" fill="{COLOURS[kind]}"/>')
        svg.append(f'<text x="60" y="{y:.0f}" font-size="15">{LEGEND[kind]}</text>')
    svg.append("</svg>")
    with open(out, "w", encoding="utf-8") as file:
        file.write("\n".join(svg) + "\n")


main()

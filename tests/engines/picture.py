"""A way before and after permits, over the roads around it, as SVG.

    python picture.py EXTRACT TABLES WAYS.json BEFORE AFTER TITLE OUT.svg [NUMBER]

WAYS.json is what run_*.py leaves in its folder; BEFORE and AFTER are names in it. Without NUMBER the pair whose ways differ most.
"""

import json
import sys
from math import cos, radians
from xml.sax.saxutils import escape

from permits import Permits, length_m

WIDE, HIGH, HEAD, FOOT = 1000, 700, 56, 40
PERMITTED, REFUSED, BEFORE, AFTER = "#7fb58a", "#d9d4cc", "#c8553d", "#1f5fa8"


def main(extract, tables, ways, before, after, title, out, number=None):
    permits = Permits(extract, tables)
    ways = json.load(open(ways))
    both = [(i, a, b) for i, (a, b) in enumerate(zip(ways[before], ways[after])) if a and b]
    both = [(i, [n for n in a if n], [n for n in b if n]) for i, a, b in both]

    def apart(entry):
        _, a, b = entry
        same_ends = a[:2] == b[:2] and a[-2:] == b[-2:]
        return same_ends and bool(permits.judge(a)), len(set(zip(a, a[1:])) ^ set(zip(b, b[1:])))

    i, a, b = max(both, key=apart) if number is None else next(entry for entry in both if entry[0] == int(number))
    wrong = permits.judge(a)
    svg = draw(permits, a, b, title, len(wrong))
    with open(out, "w", encoding="utf-8") as file:
        file.write(svg)
    print(i, ways["pairs"][i], round(length_m(permits, a)), round(length_m(permits, b)), wrong[:2], len(svg))


def draw(permits, a, b, title, refused):
    places = [permits.place[node] for node in a + b]
    west, east = min(p[0] for p in places), max(p[0] for p in places)
    south, north = min(p[1] for p in places), max(p[1] for p in places)
    stretch = cos(radians((south + north) / 2))
    scale = min((WIDE - 80) / max((east - west) * stretch, 1e-4), (HIGH - HEAD - FOOT - 60) / max(north - south, 1e-4))
    x0 = WIDE / 2 - (west + east) / 2 * stretch * scale
    y0 = HEAD + (HIGH - HEAD - FOOT) / 2 + (south + north) / 2 * scale

    def path(nodes):
        points = [(x0 + permits.place[n][0] * stretch * scale, y0 - permits.place[n][1] * scale) for n in nodes]
        last, text = None, []
        for x, y in points:
            here = (round(x), round(y)) if scale < 2e5 else (round(x, 1), round(y, 1))
            if here != last:
                text.append(f"{here[0]} {here[1]}")
            last = here
        return "M" + "L".join(text) if len(text) > 1 else ""

    def inside(nodes):
        return any(
            -20 < x0 + permits.place[n][0] * stretch * scale < WIDE + 20
            and HEAD < y0 - permits.place[n][1] * scale < HIGH - FOOT
            for n in nodes
        )

    roads = {True: [], False: []}
    along = {tuple(edge["nodes"]) for edge in permits.edges.values() if edge["direction"] == "forward" and edge["permitted"]}
    for edge in permits.edges.values():
        twice = edge["direction"] == "backward" and (not edge["permitted"] or tuple(edge["nodes"][::-1]) in along)
        if twice or not inside(edge["nodes"]):
            continue
        minor = edge["highway"] in ("service", "track", "residential", "living_street", "unclassified")
        if edge["permitted"] or not minor or scale > 4e3:
            roads[edge["permitted"]].append(path(edge["nodes"]))
    km = [length_m(permits, nodes) / 1000 for nodes in (a, b)]
    ends = [(x0 + permits.place[n][0] * stretch * scale, y0 - permits.place[n][1] * scale) for n in (b[0], b[-1])]
    text = f'font-family="sans-serif" font-size="15" fill="#222"'
    legend = [
        (BEFORE, 6, f"without permits: {km[0]:.1f} km, refused {refused} times"),
        (AFTER, 6, f"with permits: {km[1]:.1f} km"),
        (PERMITTED, 3, "permitted"),
        (REFUSED, 3, "refused"),
    ]
    keys, at = [], 24
    for colour, width, words in legend:
        keys.append(f'<path d="M{at} {HIGH - 16}h28" stroke="{colour}" stroke-width="{width}"/>')
        keys.append(f'<text x="{at + 36}" y="{HIGH - 11}" {text}>{escape(words)}</text>')
        at += 60 + 8 * len(words)
    marks = "".join(
        f'<circle cx="{x:.0f}" cy="{y:.0f}" r="8" fill="#fff" stroke="#222" stroke-width="2.5"/>'
        f'<text x="{x:.0f}" y="{y + 5:.0f}" text-anchor="middle" font-family="sans-serif" font-size="11">{name}</text>'
        for (x, y), name in zip(ends, "AB")
    )
    return f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE} {HIGH}" width="{WIDE}" height="{HIGH}">
<rect width="{WIDE}" height="{HIGH}" fill="#fbfaf7"/>
<g fill="none" stroke-linejoin="round" stroke-linecap="round">
<path d="{''.join(roads[False])}" stroke="{REFUSED}" stroke-width="1.6"/>
<path d="{''.join(roads[True])}" stroke="{PERMITTED}" stroke-width="2.6"/>
<path d="{path(a)}" stroke="{BEFORE}" stroke-width="8" stroke-opacity="0.75"/>
<path d="{path(b)}" stroke="{AFTER}" stroke-width="4.5"/>
</g>
{marks}
<rect width="{WIDE}" height="{HEAD}" fill="#fbfaf7"/><rect y="{HIGH - FOOT}" width="{WIDE}" height="{FOOT}" fill="#fbfaf7"/>
<text x="24" y="34" font-family="sans-serif" font-size="20" fill="#222">{escape(title)}</text>
<text x="{WIDE - 24}" y="34" text-anchor="end" font-family="sans-serif" font-size="11" fill="#777">© OpenStreetMap contributors</text>
<g fill="none">{''.join(k for k in keys if k.startswith('<path'))}</g>{''.join(k for k in keys if k.startswith('<text'))}
</svg>
"""


if __name__ == "__main__":
    main(*sys.argv[1:])

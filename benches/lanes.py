#!/usr/bin/env python3
"""How many roads have at least the lanes that would be supposed of their group if `lanes` were not tagged.

    benches/lanes.py [--counts COUNTS.tsv] US=columbus.osm.pbf US=baltimore.osm.pbf DE=heidelberg.osm.pbf ...

A group is a country, a class, and one-way or two-way. Links, roundabouts and reversible roads are in none. For each group with 30 tagged
ways or more of which 85 % or more reach a number of lanes per direction (2 or 3), one row says on how many roads the supposition
would have been right or less than the truth:

- `share`, `bound`: of the tagged ways, with the lower bound by Wilson (95 %) as if each way had been drawn by itself;
- `tenth`: the worst of ten random tenths that were held back;
- `cells`: the bound if neighbourhoods (about 2 km square) had been drawn, because ways of one road resemble each other;
- `places`: the bound if extracts had been drawn, and the worst extract of 30 tagged ways or more;
- `full`: the share and the bound by neighbourhoods where nine ways in ten of the group are tagged, so that nobody chose which to tag;
- `partly`: the share in the other neighbourhoods, where somebody did;
- `beside`: of the untagged ways that a tagged way of the group touches, the share whose neighbours all reach the number;
- `km`: the share of the tagged length.

A group may use a number if `bound`, `cells`, `places` (of five extracts or more) and `full` are all 90 % or more. `--counts` writes ways by
neighbourhood (data/lanes.tsv). Needs the PyPI package osmium. Extracts with parts of one place count a way once.
"""

import math
import random
import sys
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import osmium

CLASSES = ("motorway", "trunk", "primary", "secondary", "tertiary", "unclassified", "residential")
KM_PER_DEGREE = 111.2
CELL_DEGREES = (0.025, 0.02)
Z = 1.96


@dataclass
class Way:
    """A way of a group: its extract, neighbourhood, lanes of one direction (None: untagged), length and ends."""

    place: str
    cell: tuple
    lanes: float | None
    km: float
    ends: tuple


def wilson(reached, of):
    """Lower bound (95 %) of a share of which `of` draws are known."""
    if of == 0:
        return 0.0
    share = reached / of
    spread = Z * math.sqrt(share * (1 - share) / of + Z * Z / (4 * of * of))
    return (share + Z * Z / (2 * of) - spread) / (1 + Z * Z / of)


def clustered(clusters):
    """The same if clusters were drawn, each with (reached, of) ways: Wilson's bound with the number of draws that are worth as much."""
    of = sum(n for _, n in clusters)
    if len(clusters) < 2:
        return 0.0
    share = sum(k for k, _ in clusters) / of
    many = len(clusters)
    variance = sum((k - share * n) ** 2 for k, n in clusters) * many / (many - 1) / of**2
    worth = share * (1 - share) / variance if variance > 0 else many
    worth = min(worth, of)
    return wilson(share * worth, worth)


def group_and_lanes(tags):
    """Class, direction and lanes of one direction, or None for a way in no group."""
    highway, oneway = tags.get("highway"), tags.get("oneway", "")
    if highway not in CLASSES or tags.get("junction") in ("roundabout", "circular"):
        return None
    if oneway in ("reversible", "alternating"):
        return None
    one = oneway in ("yes", "1", "true", "-1") or (highway == "motorway" and oneway != "no")
    text = tags.get("lanes", "")
    lanes = int(text) / (1 if one else 2) if text.isdigit() and int(text) > 0 else None
    return highway, "one-way" if one else "two-way", lanes


def read(extracts):
    """All ways by group; of extracts that overlap, the first has the way."""
    groups, known = defaultdict(list), set()
    for country, path in extracts:
        for way in osmium.FileProcessor(path, osmium.osm.NODE | osmium.osm.WAY).with_locations():
            if not way.is_way() or way.id in known:
                continue
            found = group_and_lanes(way.tags)
            line = [(node.lon, node.lat) for node in way.nodes if node.location.valid()]
            if not found or not line:
                continue
            known.add(way.id)
            steps = ((b[0] - a[0], b[1] - a[1], b[1]) for a, b in zip(line, line[1:]))
            km = KM_PER_DEGREE * sum(math.hypot(x * math.cos(math.radians(lat)), y) for x, y, lat in steps)
            cell = tuple(math.floor(at / size) for at, size in zip(line[len(line) // 2], CELL_DEGREES))
            ends = (way.nodes[0].ref, way.nodes[-1].ref)
            place = Path(path).name.split(".")[0]
            groups[country, found[0], found[1]].append(Way(place, cell, found[2], km, ends))
    return groups


def clusters(ways, lanes, by):
    """(reached, of) of the tagged ways by cluster."""
    counts = defaultdict(lambda: [0, 0])
    for way in ways:
        counts[by(way)][0] += way.lanes >= lanes
        counts[by(way)][1] += 1
    return dict(counts)


def share(ways, lanes):
    return sum(way.lanes >= lanes for way in ways) / len(ways) if ways else math.nan


def beside(ways, lanes):
    """How many untagged ways touch a tagged one, and the share of them whose tagged neighbours all reach `lanes`."""
    at = defaultdict(list)
    for way in ways:
        if way.lanes:
            for end in way.ends:
                at[end].append(way.lanes)
    least = [min(near) for way in ways if not way.lanes and (near := at[way.ends[0]] + at[way.ends[1]])]
    return len(least), sum(known >= lanes for known in least) / len(least) if least else math.nan


def row(group, ways, lanes):
    tagged = [way for way in ways if way.lanes]
    by_cell = lambda way: (way.place, way.cell)  # noqa: E731
    all_of, tagged_of = defaultdict(int), defaultdict(int)
    for way in ways:
        all_of[by_cell(way)] += 1
        tagged_of[by_cell(way)] += way.lanes is not None
    is_full = lambda way: tagged_of[by_cell(way)] >= 0.9 * all_of[by_cell(way)]  # noqa: E731
    full, partly = [w for w in tagged if is_full(w)], [w for w in tagged if not is_full(w)]
    shuffled = random.Random(1).sample(tagged, len(tagged))
    tenth = min(share(shuffled[at::10], lanes) for at in range(10))
    places = clusters(tagged, lanes, lambda way: way.place)
    large = [k / n for k, n in places.values() if n >= 30]
    touching, near = beside(ways, lanes)
    km = sum(w.km for w in tagged if w.lanes >= lanes) / sum(w.km for w in tagged)
    reached = sum(way.lanes >= lanes for way in tagged)
    percent = lambda value: "–" if math.isnan(value) else f"{100 * value:.1f}"  # noqa: E731
    worst = percent(min(large)) if large else "–"
    cells, full_cells = (list(clusters(of, lanes, by_cell).values()) for of in (tagged, full))
    return [
        *group, str(lanes), str(len(ways)), str(len(tagged)), percent(reached / len(tagged)), percent(wilson(reached, len(tagged))),
        percent(tenth), f"{percent(clustered(cells))} ({len(cells)})", f"{percent(clustered(list(places.values())))} ({len(places)}), {worst}",
        f"{percent(share(full, lanes))} of {len(full)}, {percent(clustered(full_cells))}", f"{percent(share(partly, lanes))} of {len(partly)}",
        f"{percent(near)} of {touching}", percent(km),
    ]


def write_counts(path, groups, rows):
    """Ways, tagged ways and those that reach the number, by group, extract and neighbourhood."""
    lines = []
    for group, lanes in rows:
        counts = defaultdict(lambda: [0, 0, 0])
        for way in groups[group]:
            at = counts[way.place, way.cell]
            at[0] += 1
            at[1] += way.lanes is not None
            at[2] += way.lanes is not None and way.lanes >= lanes
        for (place, (x, y)), numbers in sorted(counts.items()):
            lines.append("\t".join(map(str, [*group, lanes, place, f"{x}/{y}", *numbers])))
    header = Path(path).read_text(encoding="utf-8") if Path(path).exists() else ""
    comments = [line for line in header.splitlines() if line.startswith("#")]
    names = "country\tclass\tdirection\tlanes\tplace\tcell\tways\ttagged\treached"
    Path(path).write_text("\n".join([*comments, names, *lines]) + "\n", encoding="utf-8")


def main(arguments):
    counts = arguments[1] if arguments[:1] == ["--counts"] else None
    extracts = [argument.split("=", 1) for argument in arguments[2 if counts else 0 :]]
    if not extracts or any(len(extract) != 2 for extract in extracts):
        sys.exit(__doc__)
    groups = read(extracts)
    head = "country class direction lanes ways tagged share bound tenth cells places full partly beside km".split()
    print(f"| {' | '.join(head)} |\n|{' --- |' * len(head)}")
    shown = []
    for group, ways in sorted(groups.items()):
        tagged = [way for way in ways if way.lanes]
        for lanes in (2, 3):
            if len(tagged) >= 30 and share(tagged, lanes) >= 0.85:
                shown.append((group, lanes))
                print(f"| {' | '.join(row(group, ways, lanes))} |")
    if counts:
        write_counts(counts, groups, shown)


if __name__ == "__main__":
    main(sys.argv[1:])

"""Refusals of every shape on a small network, and whether engines obey them as the exports word them.

    python run_shapes.py make EXTRACT
    python run_shapes.py run EXTRACT TABLES OSRM_EXPORT REWRITTEN VALHALLA_EXPORT WORK

`make` draws the extract: a crossing of nine roads, two roads between the same two nodes, restrictions over ways (short and long), one
against straight on, a small roundabout whose first exits are too tight, and restrictions with several members. `run` asks OSRM and Valhalla for ways between
all pairs of edges of a shape and prints one JSON object.
"""

import json
import os
import sys
from math import cos, pi, radians, sin

import osmium
from permits import Permits

M = 1 / 111_195  # degrees
LON, LAT = 126.0, -30.25
ROAD = {"highway": "unclassified", "width": "14"}
ONE_WAY = {**ROAD, "oneway": "yes"}


class Drawing:
    def __init__(self):
        self.nodes, self.ways, self.relations, self.shape_of, self.tags_of = {}, {}, {}, {}, {}
        # What restrictions forbid, as nodes in driving order from the last before the first step to the first after the last one.
        self.bans, self.shapes = [], 0

    def shape(self):
        """Each stands 5 km from the one before."""
        self.shapes += 1

    def node(self, x_m, y_m, tags=None):
        number = len(self.nodes) + 1
        x_m += 5000 * self.shapes
        self.nodes[number] = (LON + x_m * M / cos(radians(LAT)), LAT + y_m * M)
        self.tags_of[number] = tags or {}
        return number

    def way(self, nodes, tags=ROAD):
        number = len(self.ways) + 1
        self.ways[number], self.shape_of[number] = (nodes, tags), self.shapes
        return number

    def ban(self, from_way, via, to_way, word):
        over = isinstance(via, list)
        members = [("w", from_way, "from"), *([("w", way, "via") for way in via] if over else [("n", via, "via")]), ("w", to_way, "to")]
        number = len(self.relations) + 1
        self.relations[number] = (members, {"type": "restriction", "restriction": word})
        if over:
            nodes = [self.ways[from_way][0][-2]]
            for way in via:
                nodes += self.ways[way][0][: -1 if way != via[-1] else None]
            self.bans.append([*nodes, self.ways[to_way][0][1]])
        elif word != "no_u_turn":
            beside = [self.ways[way][0][1 if self.ways[way][0][0] == via else -2] for way in (from_way, to_way)]
            self.bans.append([beside[0], via, beside[1]])

    def ban_pairs(self, from_ways, via, to_ways, word):
        """One restriction that bans every turn from one of the ways into another one."""
        for from_way in from_ways:
            for to_way in to_ways:
                self.ban(from_way, via, to_way, word)
                del self.relations[len(self.relations)]
        members = [*(("w", way, "from") for way in from_ways), ("n", via, "via"), *(("w", way, "to") for way in to_ways)]
        self.relations[len(self.relations) + 1] = (members, {"type": "restriction", "restriction": word})

    def write(self, path):
        if os.path.exists(path):
            os.remove(path)
        writer = osmium.SimpleWriter(path)
        for number, place in self.nodes.items():
            writer.add_node(osmium.osm.mutable.Node(id=number, version=1, location=place, tags=self.tags_of[number]))
        for number, (nodes, tags) in self.ways.items():
            writer.add_way(osmium.osm.mutable.Way(id=number, version=1, nodes=nodes, tags=tags))
        for number, (members, tags) in self.relations.items():
            writer.add_relation(osmium.osm.mutable.Relation(id=number, version=1, members=members, tags=tags))
        writer.close()


def drawing():
    d = Drawing()
    crossing_of_nine(d)
    twins(d)
    for ways, footways in [(2, 2), (6, 4)]:
        over_ways(d, ways, footways)
    straight_on(d)
    roundabout(d)
    d.entries = [entries(d, several, word) for several, word in (("from", "no_entry"), ("to", "no_exit"))]
    return d


def crossing_of_nine(d):
    """Valhalla keeps what may not be entered from an edge in eight bits."""
    d.shape()
    middle = d.node(0, 0)
    arms = [d.way([middle, d.node(300 * cos(2 * pi * i / 9), 300 * sin(2 * pi * i / 9))]) for i in range(9)]
    for arm in arms[:7]:
        for last in arms[7:]:
            d.ban(arm, middle, last, "no_left_turn")
    d.ban(arms[0], middle, arms[0], "no_u_turn")


def twins(d):
    """From one into the other at one end, but not at the other end."""
    d.shape()
    a, b = d.node(0, 0), d.node(600, 0)
    north, south = (d.way([a, d.node(150, y_m), d.node(450, y_m), b]) for y_m in (120, -120))
    d.way([d.node(-300, 0), a])
    d.way([b, d.node(900, 0)])
    d.ban(north, b, south, "no_right_turn")
    d.ban(south, b, north, "no_left_turn")


def over_ways(d, ways, footways):
    """A chain of one-way roads with an exit at every joint; footways make engines cut its ways."""
    d.shape()
    joints = [d.node(400 * i, 0) for i in range(ways + 3)]
    chain = []
    for a, b in zip(range(ways + 2), range(1, ways + 3)):
        between = [d.node(400 * (a + (k + 1) / (footways + 1)), 0) for k in range(footways)]
        chain.append(d.way([joints[a], *between, joints[b]], ONE_WAY))
        for node in between:
            d.way([node, d.node(400 * a, -200)], {"highway": "footway"})
    for i in range(1, ways + 2):
        d.way([joints[i], d.node(400 * i + 100, 20)], ONE_WAY)
        d.way([d.node(400 * i - 100, 20), joints[i]], ONE_WAY)
    d.ban(chain[0], chain[1:-1], chain[-1], "no_straight_on")


def straight_on(d):
    d.shape()
    middle = d.node(0, 0)
    west, east = d.way([d.node(-300, 0), middle]), d.way([middle, d.node(300, 0)])
    d.way([middle, d.node(250, 40)])
    d.ban(west, middle, east, "no_straight_on")


def roundabout(d):
    """Traffic keeps left: clockwise. Round the first corner a tug with its trailers does not come, but onto the ring and off it."""
    d.shape()
    at = lambda radius_m, degrees: d.node(radius_m * sin(radians(degrees)), radius_m * cos(radians(degrees)))
    ring = [at(6.5, 7.5 * i) for i in range(48)]
    d.way([*ring, ring[0]], {"highway": "residential", "junction": "roundabout"})
    for i in range(4):
        d.way([ring[12 * i], at(300, 90 * i)], {"highway": "residential"})


def entries(d, several, word):
    """A crossing of five roads: from three of them nobody enters the fourth, or from the fourth nobody goes into three."""
    d.shape()
    middle = d.node(0, 0)
    arms = [d.way([middle, d.node(300 * cos(2 * pi * i / 5), 300 * sin(2 * pi * i / 5))]) for i in range(5)]
    d.ban_pairs(*((arms[:3], middle, arms[3:4]) if several == "from" else (arms[3:4], middle, arms[:3])), word)
    return d.shapes


def missing(permits, drawn, found):
    """Turns of the crossings of five roads that are permitted and not banned, and that an engine does not drive."""
    out = []
    for pair, way in found.items():
        (a, b), shape = pair, drawn.shape_of[int(permits.edges[pair[0]]["way_id"])]
        before, after = permits.edges[a]["nodes"], permits.edges[b]["nodes"]
        if shape in drawn.entries and before[-1] == after[0] and permits.turns.get((a, b)):
            banned = [before[-2], before[-1], after[1]] in drawn.bans
            out += [pair] if way is None and not banned else []
    return out


def repeated(before, after):
    """Restrictions that were lost, those that say what another one says, and those of several turns, of which engines take one."""
    def restrictions(path):
        out = {}
        for relation in osmium.FileProcessor(path, osmium.osm.RELATION):
            out[relation.id] = (dict(relation.tags), tuple((m.type, m.ref, m.role) for m in relation.members))
        return out

    old, new = restrictions(before), restrictions(after)
    lost = sum(1 for number, (tags, _) in old.items() if new.get(number, ({},))[0] != tags)
    said = [members for tags, members in new.values() if tags["type"] == "restriction"]
    roles = [[role for _, _, role in members] for members in said]
    several = sum(members.count("from") > 1 or members.count("to") > 1 for members in roles)
    return lost, len(said) - len(set(said)), several


def survey(permits, drawn, route):
    """All pairs of edges of a shape. `route` gives the nodes of a way and its two ends."""
    out = {"routed": 0, "none": 0, "refused_used": 0, "elsewhere": 0, "examples": []}
    shapes, all_found = {}, {}
    for edge, row in sorted(permits.edges.items()):
        if row["permitted"]:
            shapes.setdefault(drawn.shape_of[int(row["way_id"])], []).append(edge)
    for edges in shapes.values():
        for pair in [(a, b) for a in edges for b in edges if a != b]:
            asked = [permits.middle(edge) for edge in pair]
            found = route(pair, asked)
            all_found[pair] = found
            if found is None:
                out["none"] += 1
                continue
            nodes, ends = found
            out["routed"] += 1
            wrong, elsewhere = permits.judge(nodes), permits.elsewhere(ends, asked)
            out["refused_used"] += bool(wrong)
            out["elsewhere"] += bool(elsewhere)
            out["examples"] = (out["examples"] + [[*pair, text] for text in (wrong + elsewhere)[:1]])[:5]
    out["missing"] = missing(permits, drawn, all_found)
    return out


def run(extract, tables, tuned, rewritten, valhalla, work):
    import run_osrm
    import run_valhalla

    drawn, permits = drawing(), Permits(extract, tables)
    permits.sequences += drawn.bans
    files = ["--segment-speed-file", f"{tuned}/segment-speeds.csv", "--turn-penalty-file", f"{tuned}/turn-penalties.csv"]
    out = {"edges_lost": permits.lost, "refused_passages": len(permits.sequences) - len(drawn.bans)}
    for name, file, customize in [("plain", extract, []), ("csv", extract, files), ("pbf", rewritten, [])]:
        engine = run_osrm.engine(file, work, name, customize)

        def route(_, places):
            found = run_osrm.route(engine, places)
            penalty = found and name == "csv" and found.turning_s >= run_osrm.PENALTY_S
            return None if found is None or penalty else (found.nodes, found.ends)

        out[name] = survey(permits, drawn, route)
    request = json.load(open(f"{valhalla}/request.json"))
    actor = run_valhalla.engine(f"{valhalla}/extract.osm.pbf", work, "valhalla")

    def line(pair, places):
        found = run_valhalla.route(actor, request, places)
        return found and (permits.whole(permits.nodes_of(found), pair), (found[0], found[-1]))

    out["valhalla"] = survey(permits, drawn, line)
    out["lost"], out["repeated"], out["several"] = repeated(extract, rewritten)
    print(json.dumps(out))


if __name__ == "__main__":
    drawing().write(sys.argv[2]) if sys.argv[1] == "make" else run(*sys.argv[2:])

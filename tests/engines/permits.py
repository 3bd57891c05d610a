"""What netcert permits, read from `export csv` and the extract alone, and whether a way that an engine drives keeps to it and lies
between the places asked for.

Knows nothing of how the exports for engines are made: edges are found on their ways by their end nodes, steps from one edge into
another in turns.csv; a step that is not there and not back is straight on.
"""

import csv
import random
from collections import defaultdict
from math import cos, hypot, radians

import osmium

# Ways with one of these keys may be roads to an engine.
ROAD_KEYS = ("highway", "route", "bridge")
M_PER_DEGREE = 111_320
# A route ends where it was asked to, if it ends within this distance. Engines round places to a millionth of a degree.
END_M = 1.0


class Permits:
    def __init__(self, extract, tables):
        rows = list(csv.DictReader(open(f"{tables}/edges.csv", newline="", encoding="utf-8")))
        by_way = defaultdict(list)
        for row in rows:
            by_way[int(row["way_id"])].append(row)
        # All ways that may be roads to an engine; places of their nodes, and of those of the network's roads alone.
        self.roads, self.any_place, self.place = {}, {}, {}
        for way in osmium.FileProcessor(extract, osmium.osm.WAY):
            if way.id in by_way or any(key in way.tags for key in ROAD_KEYS):
                self.roads[way.id] = [node.ref for node in way.nodes]
        refs = {way: self.roads[way] for way in by_way}
        network = {node for nodes in refs.values() for node in nodes}
        wanted = {node for nodes in self.roads.values() for node in nodes}
        for node in osmium.FileProcessor(extract, osmium.osm.NODE):
            if node.id in wanted:
                self.any_place[node.id] = (node.location.lon, node.location.lat)
                if node.id in network:
                    self.place[node.id] = self.any_place[node.id]
        self.edges, self.over, self.lost = {}, defaultdict(list), 0
        for way, edges in by_way.items():
            self._lay(refs[way], edges)
        self.at = defaultdict(list)
        for node, place in self.place.items():
            self.at[_key(place)].append(node)
        self.leaving = defaultdict(list)
        for edge, row in self.edges.items():
            self.leaving[row["nodes"][0]].append(edge)
        self.turns, passages = {}, []
        for row in csv.DictReader(open(f"{tables}/turns.csv", newline="", encoding="utf-8")):
            if not row["first_arc"]:
                self.turns[int(row["from_edge"]), int(row["to_edge"])] = row["permitted"] == "true"
            elif row["permitted"] != "true":
                passages.append([int(row[name]) for name in ("from_edge", "first_arc", "last_arc", "to_edge")])
        # Nodes that may not be driven one after the other, though each step may: refused passages.
        self.sequences = [nodes for passage in passages if (nodes := self._over(*passage))]

    def _lay(self, refs, edges):
        """Both directions of a stretch lie on the same nodes; stretches follow one another."""
        spans, start = {}, 0
        for row in edges:
            ends = (int(row["from_node"]), int(row["to_node"]))
            ends = ends if row["direction"] == "forward" else ends[::-1]
            nodes = spans.get((ends, row["direction"] == "forward"))
            if nodes is None:
                try:
                    first = refs.index(ends[0], start)
                    last = refs.index(ends[1], first + 1)
                except ValueError:
                    self.lost += 1
                    continue
                nodes, start = refs[first : last + 1], last
                spans[ends, row["direction"] != "forward"] = nodes
            if row["direction"] == "backward":
                nodes = nodes[::-1]
            edge = int(row["edge_id"])
            self.edges[edge] = dict(row, nodes=nodes, permitted=row["permitted"] == "true")
            for i, pair in enumerate(zip(nodes, nodes[1:])):
                self.over[pair].append((edge, i))

    def _over(self, start, first, last, goal):
        """The nodes of a passage, from the last one before the ring to the first one after it; its arcs go straight on."""
        if any(edge not in self.edges for edge in (start, first, last, goal)):
            return None
        nodes, arc = [self.edges[start]["nodes"][-2]], first
        while True:
            nodes += self.edges[arc]["nodes"][:-1]
            if arc == last:
                return [*nodes, *self.edges[goal]["nodes"][:2]]
            here = self.edges[arc]["nodes"]
            straight = (edge for edge in self.leaving[here[-1]] if (arc, edge) not in self.turns)
            on = [edge for edge in straight if self._step((arc, len(here) - 2), (edge, 0))]
            if len(on) != 1 or len(nodes) > 10_000:
                return None
            arc = on[0]

    def permitted(self, a, b):
        """Whether one may drive from a node to its neighbour."""
        return any(self.edges[edge]["permitted"] for edge, _ in self.over.get((a, b), []))

    def refused_steps(self):
        """From which node to which neighbour nobody may drive, on all that may be a road to an engine."""
        steps = {}
        for nodes in self.roads.values():
            known = [node for node in nodes if node in self.any_place]
            for a, b in zip(known, known[1:]):
                for step in ((a, b), (b, a)):
                    if a != b and not self.permitted(*step):
                        steps[step] = None
        return list(steps)

    def elsewhere(self, ends, asked):
        """Which ends of a route do not lie where they were asked for: a list of texts, empty if none."""
        out = []
        for name, end, place in zip(("begins", "ends"), ends, asked):
            if distance_m(end, place) > END_M:
                out.append(f"{name} {distance_m(end, place):.1f} m from {place}, where it was asked to")
        return out

    def judge(self, nodes):
        """What a way over these nodes uses that is refused: a list of texts, empty if nothing."""
        wrong, now = [], []
        driven = [node for node, before in zip(nodes, [None, *nodes]) if node != before]
        for banned in self.sequences:
            if any(driven[i : i + len(banned)] == banned for i, node in enumerate(driven) if node == banned[0]):
                wrong.append(f"turn over {banned}: each step may be driven, all of them may not")
        for pair in zip(nodes, nodes[1:]):
            if pair[0] == pair[1]:
                continue
            if None in pair:
                wrong.append("a place that is no node of the network")
                now = []
                continue
            on = [(edge, i) for edge, i in self.over.get(pair, []) if self.edges[edge]["permitted"]]
            if not on:
                edges = [edge for edge, _ in self.over.get(pair, [])]
                wrong.append(f"{pair[0]}-{pair[1]}: edge {edges or 'not in the network'} is refused")
                now = []
                continue
            steps = [(edge, i) for edge, i in on if not now or any(self._step(before, (edge, i)) for before in now)]
            if now and not steps:
                wrong.append(f"turn at {pair[0]} from edge {now[0][0]} into {on[0][0]} is refused")
            now = steps or on
        return wrong

    def _step(self, before, after):
        (a, i), (b, k) = before, after
        if a == b and k == i + 1:
            return True
        first, second = self.edges[a], self.edges[b]
        if i + 2 != len(first["nodes"]) or k != 0:
            return False
        back = first["way_id"] == second["way_id"] and first["nodes"] == second["nodes"][::-1]
        return self.turns.get((a, b), not back)

    def nodes_of(self, line):
        """The nodes of a line as an engine draws it, None where there is none; its two ends lie between nodes and may have none."""
        out = []
        for i, point in enumerate(line):
            here = self._near(point)
            if not here and i in (0, len(line) - 1):
                continue
            known = [node for node in here if not out or (out[-1], node) in self.over or out[-1] == node]
            out.append((known or here or [None])[0])
        return out

    def _near(self, point):
        """Engines round to a millionth of a degree, one way or the other."""
        x, y = _key(point)
        keys = [(x + dx, y + dy) for dx in (0, -1, 1) for dy in (0, -1, 1)]
        return next((self.at[key] for key in keys if key in self.at), [])

    def whole(self, nodes, pair):
        """Nodes from the middle of one edge to that of another, with the node behind the start and the one ahead of the goal."""
        for edge, first in zip(pair, (True, False)):
            a, b = self._beside_middle(edge)
            end, before = (nodes[:1], nodes[:2]) if first else (nodes[-1:], nodes[-2:])
            # Between nodes that lie close together the end of the line may be taken for a node.
            if end in ([a], [b]) and sorted(before, key=str) != sorted([a, b], key=str):
                other = [b] if end == [a] else [a]
                nodes = other + nodes if first else nodes + other
        return nodes

    def _beside_middle(self, edge):
        nodes = self.edges[edge]["nodes"]
        return nodes[(len(nodes) - 1) // 2 :][:2]

    def middle(self, edge):
        a, b = (self.place[node] for node in self._beside_middle(edge))
        return ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)

    def pairs(self, count, seed):
        """Permitted edges drawn at random; of every other pair the second one is one that permits lead to from the first.

        `200+START:GOAL` are 200 and then this pair of edges.
        """
        count, *given = count.split("+")
        count, draw = int(count), random.Random(seed)
        edges = sorted(edge for edge, row in self.edges.items() if row["permitted"])
        leaving = defaultdict(list)
        for edge in edges:
            leaving[self.edges[edge]["nodes"][0]].append(edge)
        out = []
        while len(out) < count:
            start = draw.choice(edges)
            known, front = {start}, [start]
            while front:
                edge = front.pop()
                nodes = self.edges[edge]["nodes"]
                for to in leaving[nodes[-1]]:
                    if to not in known and self._step((edge, len(nodes) - 2), (to, 0)):
                        known.add(to)
                        front.append(to)
            if len(out) % 2:
                out.append((start, draw.choice(edges)))
            elif len(known) > 5:
                out.append((start, draw.choice(sorted(known - {start}))))
        return out + [tuple(int(edge) for edge in pair.split(":")) for pair in given]


def _key(place):
    return (round(place[0] * 1e6), round(place[1] * 1e6))


def distance_m(a, b):
    (x, y), (u, v) = a, b
    return M_PER_DEGREE * hypot((u - x) * cos(radians(y)), v - y)


def length_m(permits, nodes):
    return sum(distance_m(permits.place[a], permits.place[b]) for a, b in zip(nodes, nodes[1:]))

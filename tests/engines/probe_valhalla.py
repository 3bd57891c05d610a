"""Whether Valhalla's truck costing may drive anything that is refused: every directed edge of its tiles is looked at, twice.

Its tiles are read byte by byte, and Valhalla itself is asked which edges a truck may use at the middle of each edge that is refused.
"""

import json
from collections import defaultdict

import osmium
import valhalla_tiles


def probe(permits, actor, folder, extract, request):
    """`extract` is what the tiles in `folder` were built from."""
    nodes = NodesByPlace(permits, extract)
    out = {"refused": 0, "refused_open": 0, "ways_refused": 0, "ways_open": 0, "unclear": 0, "examples": []}
    refused, driven, by_way = {}, set(), defaultdict(list)
    for edge in valhalla_tiles.edges(f"{folder}/tiles"):
        steps = steps_over(permits, edge, nodes.of(edge))
        if steps is None:
            out["unclear"] += 1
            out["examples"].append(f"way {edge.way}: an edge of the tiles that does not lie on it")
            continue
        permitted = all(permits.permitted(*step) for step in steps)
        by_way[edge.way].append((permitted, edge.truck))
        if edge.truck:
            driven.update(steps)
        if not permitted:
            out["refused"] += 1
            refused[edge.id] = edge
            if edge.truck:
                out["refused_open"] += 1
                out["examples"].append(f"way {edge.way} {'forward' if edge.forward else 'backward'}")
    wholly = [edges for edges in by_way.values() if not any(permitted for permitted, _ in edges)]
    out["ways_refused"] = len(wholly)
    out["ways_open"] = sum(any(truck for _, truck in edges) for edges in wholly)
    permitted = {step for step in permits.over if permits.permitted(*step)}
    out["permitted"], out["permitted_closed"] = len(permitted), len(permitted - driven)
    out["located_open"] = located(actor, request, refused)
    return dict(out, examples=out["examples"][:5])


class NodesByPlace:
    """Nodes by their place in millionths of a degree: those of a way, or those of all roads."""

    def __init__(self, permits, extract):
        places, self.ways, self.lists = {}, {}, {}
        for node in osmium.FileProcessor(extract, osmium.osm.NODE):
            places[node.id] = (round(node.location.lon * 1e6), round(node.location.lat * 1e6))
        for way in osmium.FileProcessor(extract, osmium.osm.WAY):
            self.lists[way.id] = [(node.ref, places[node.ref]) for node in way.nodes if node.ref in places]
        self.all = by_place((node, places[node]) for node in permits.any_place)

    def of(self, edge):
        # A shortcut leads over the edges of several ways.
        if edge.shortcut:
            return self.all
        if edge.way not in self.ways:
            self.ways[edge.way] = by_place(self.lists.get(edge.way, []))
        return self.ways[edge.way]


def by_place(nodes):
    at = defaultdict(list)
    for node, place in nodes:
        at[place].append(node)
    return at


def steps_over(permits, edge, at):
    """From which nodes to which neighbours an edge leads; `None` if it does not lie on its way."""
    steps, before = [], None
    for x, y in edge.line:
        # Valhalla rounds down where others round to the nearest.
        here = next((at[x + dx, y + dy] for dx in (0, 1, -1) for dy in (0, 1, -1) if (x + dx, y + dy) in at), None)
        if here is None:
            return None
        if before is not None and before != here:
            both = [(a, b) for a in before for b in here]
            steps.append(next((step for step in both if permits.permitted(*step)), both[0]))
        before = here
    return steps


def located(actor, request, refused):
    """How many refused edges Valhalla itself offers to a truck, asked at the middle of each."""
    offered = set()
    for edge in refused.values():
        (x, y), (u, v) = edge.line[(len(edge.line) - 1) // 2 :][:2]
        place = {"lon": (x + u) / 2e6, "lat": (y + v) / 2e6, "radius": 0, "minimum_reachability": 0, "search_cutoff": 1}
        answer = json.loads(actor.locate(json.dumps(dict(request, locations=[place], verbose=True))))
        for found in answer[0]["edges"] or []:
            offered.add(found["edge_id"]["value"])
    return len(offered & refused.keys())

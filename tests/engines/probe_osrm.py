"""Whether OSRM drives over any step that is refused: it is asked for each of them, from one node to its neighbour.

A step is driven if the way from a place on it to a place further ahead on it passes both of its nodes in this order.
"""

from permits import distance_m

# Where both places lie, as shares of the step.
PLACES = (0.35, 0.65)
# OSRM keeps places in millionths of a degree, 0.1 m: on a shorter step it may take a neighbour's road for this one. It is asked
# for more places there.
SHORT_M = 1.0
MORE_PLACES = ((0.1, 0.9), (0.0, 1.0))


def probe(permits, route):
    """`route` gives OSRM's way between two places, or `None`."""
    out = {"refused": 0, "refused_open": 0, "permitted": 0, "permitted_closed": 0, "examples": []}
    for step in permits.refused_steps():
        out["refused"] += 1
        if drives(permits, route, step):
            out["refused_open"] += 1
            out["examples"] = (out["examples"] + [step])[:5]
    for step in permits.over:
        if permits.permitted(*step):
            out["permitted"] += 1
            out["permitted_closed"] += not drives(permits, route, step)
    return out


def drives(permits, route, step):
    (x, y), (u, v) = ends = [permits.any_place[node] for node in step]
    for shares in (PLACES, *(MORE_PLACES if distance_m(*ends) < SHORT_M else ())):
        found = route([(x + share * (u - x), y + share * (v - y)) for share in shares])
        if found is not None and step in zip(found.nodes, found.nodes[1:]):
            return True
    return False

"""pgRouting: the same pairs of edges on the plain and on the permitted network, and whether any way uses what is refused or lies
elsewhere; then every edge that is refused, and whether it has a cost.

    python run_pgrouting.py EXTRACT TABLES PGROUTING_EXPORT WORK PAIRS

TABLES: `export csv`; PGROUTING_EXPORT: `export pgrouting`. A PostgreSQL of its own is started in WORK. Prints one JSON object.
"""

import json
import sys

import probe_pgrouting
from permits import Permits
from postgres import Postgres

# The way from the end of one edge to the beginning of another, as edges in order; `{costs}` is the table of edges.
DIJKSTRA = """
SELECT coalesce(json_agg(edge ORDER BY seq), '[]') FROM pgr_dijkstra(
    'SELECT id, source, target, {costs} FROM netcert.edge', {a_target}, {b_source}) WHERE edge > 0"""
TRSP = """
SELECT coalesce(json_agg(edge ORDER BY seq), '[]') FROM pgr_trsp(
    'SELECT id, source, target, cost, reverse_cost FROM netcert.edge',
    'SELECT id, path, cost FROM netcert.restriction', {a_source}, {b_target}) WHERE edge > 0"""
STEPS = """
SELECT coalesce(json_agg(json_build_array(node, edge) ORDER BY seq), '[]') FROM pgr_dijkstra(
    'SELECT id, source, target, cost FROM netcert.step', {a}, {b})"""


# At which node of the first edge asked for a way begins, and at which node of the last one it ends.
ENDS = {"plain": (-1, 0), "edges": (-1, 0), "trsp": (0, -1), "steps": (0, -1)}


def main(extract, tables, export, work, count):
    permits = Permits(extract, tables)
    postgres = Postgres(work)
    try:
        postgres.psql("-f", "load.sql", folder=export)
        out = survey(postgres, permits, permits.pairs(count, 5), work)
        print(json.dumps(dict(out, probe=probe_pgrouting.probe(postgres, tables))))
    finally:
        postgres.stop()


def survey(postgres, permits, pairs, work):
    ids = json.loads(postgres.psql("-c", "SELECT json_object_agg(edge_id, json_build_array(id, source, target)) FROM netcert.edge"))
    edge_of = {row[0]: int(edge) for edge, row in ids.items()}
    arcs = json.loads(postgres.psql("-c", "SELECT coalesce(json_object_agg(id, arcs), '{}') FROM netcert.step WHERE arcs <> '{}'"))
    queries = []
    for start, goal in pairs:
        (a, a_source, a_target), (b, b_source, b_target) = ids[str(start)], ids[str(goal)]
        words = dict(a=a, b=b, a_source=a_source, a_target=a_target, b_source=b_source, b_target=b_target)
        for query in (DIJKSTRA.replace("{costs}", "length_m AS cost"), DIJKSTRA.replace("{costs}", "cost"), TRSP, STEPS):
            queries.append(query.format(**words).replace("\n", " ") + ";")
    with open(f"{work}/queries.sql", "w") as file:
        file.write("\n".join(queries))
    answers = [json.loads(line) for line in postgres.psql("-f", f"{work}/queries.sql").splitlines()]
    names = ["plain", "edges", "trsp", "steps"]
    out = {name: {"routed": 0, "none": 0, "refused_used": 0, "turns_refused_used": 0, "elsewhere": 0, "examples": []} for name in names}
    ways = {name: [] for name in names}
    for i, (start, goal) in enumerate(pairs):
        for name, found in zip(names, answers[4 * i :]):
            if not found:
                out[name]["none"] += 1
                ways[name].append(None)
                continue
            if name == "steps":
                edges = []
                for node, step in found:
                    edges += [edge_of[node], *(edge_of[arc] for arc in arcs.get(str(step), []))]
            else:
                edges = [edge_of[edge] for edge in found]
            nodes = [permits.edges[edges[0]]["nodes"][0]]
            for edge in edges:
                nodes += permits.edges[edge]["nodes"][1:]
            ways[name].append(nodes)
            passages = name == "steps" and any(str(step) in arcs for _, step in found)
            wrong = [] if passages else permits.judge(nodes)
            asked = [permits.edges[edge]["nodes"][at] for edge, at in zip((start, goal), ENDS[name])]
            elsewhere = permits.elsewhere(*([permits.place[node] for node in ends] for ends in ((nodes[0], nodes[-1]), asked)))
            tally = out[name]
            tally["routed"] += 1
            tally["refused_used"] += any("edge" in text.split(":")[1] for text in wrong if ":" in text)
            tally["turns_refused_used"] += any(text.startswith("turn") for text in wrong)
            tally["elsewhere"] += bool(elsewhere)
            tally["examples"] = (tally["examples"] + (wrong + elsewhere)[:1])[:3]
    out["edges_lost"] = permits.lost
    json.dump({"pairs": pairs, **ways}, open(f"{work}/../pg_ways.json", "w"))
    return out


if __name__ == "__main__":
    main(*sys.argv[1:])

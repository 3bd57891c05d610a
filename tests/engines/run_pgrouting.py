"""pgRouting: the same pairs of edges on the plain and on the permitted network, and whether any way uses what is refused.

    python run_pgrouting.py EXTRACT TABLES PGROUTING_EXPORT WORK PAIRS

TABLES: `export csv`; PGROUTING_EXPORT: `export pgrouting`. A PostgreSQL of its own is started in WORK on a socket there, as the user
`postgres` where this runs as root. Prints one JSON object.
"""

import glob
import json
import os
import shutil
import subprocess
import sys

from permits import Permits

BIN = max(glob.glob("/usr/lib/postgresql/*/bin"), default="", key=lambda path: int(path.split("/")[4]))


class Postgres:
    def __init__(self, work):
        self.data, self.work = f"{work}/data", work
        self.stop()
        shutil.rmtree(work, ignore_errors=True)
        os.makedirs(work)
        if os.geteuid() == 0:
            shutil.chown(work, "postgres")
        self.run(f"{BIN}/initdb", "-D", self.data, "-A", "trust", "-E", "UTF8", "--no-sync")
        options = f"-c listen_addresses='' -k {work} -c fsync=off"
        self.run(f"{BIN}/pg_ctl", "-D", self.data, "-w", "-l", f"{work}/log", "-o", options, "start")

    def run(self, *command, folder=None):
        user = ["runuser", "-u", "postgres", "--"] if os.geteuid() == 0 else []
        done = subprocess.run([*user, *command], capture_output=True, text=True, cwd=folder or "/tmp")
        if done.returncode:
            sys.exit(f"{command[0]} failed: {done.stdout[-800:]}{done.stderr[-800:]}")
        return done.stdout

    def psql(self, *arguments, folder=None):
        return self.run(f"{BIN}/psql", "-h", self.work, "-d", "postgres", "-qAt", *arguments, folder=folder)

    def stop(self):
        if os.path.exists(f"{self.data}/postmaster.pid"):
            self.run(f"{BIN}/pg_ctl", "-D", self.data, "-m", "immediate", "stop")


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


def main(extract, tables, export, work, count):
    permits = Permits(extract, tables)
    postgres = Postgres(work)
    try:
        postgres.psql("-f", "load.sql", folder=export)
        print(json.dumps(survey(postgres, permits, permits.pairs(count, 5), work)))
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
    out = {name: {"routed": 0, "none": 0, "refused_used": 0, "turns_refused_used": 0, "examples": []} for name in names}
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
            tally = out[name]
            tally["routed"] += 1
            tally["refused_used"] += any("edge" in text.split(":")[1] for text in wrong if ":" in text)
            tally["turns_refused_used"] += any(text.startswith("turn") for text in wrong)
            tally["examples"] = (tally["examples"] + wrong[:1])[:3]
    out["edges_lost"] = permits.lost
    json.dump({"pairs": pairs, **ways}, open(f"{work}/../pg_ways.json", "w"))
    return out


if __name__ == "__main__":
    main(*sys.argv[1:])

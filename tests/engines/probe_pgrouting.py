"""Whether anything that is refused has a cost in pgRouting's tables, by which an algorithm might drive it.

Every edge of `export csv` is looked up in `netcert.edge`, and every row of `netcert.step` must lead from a permitted edge into
another one.
"""

import csv
import json

EDGES = "SELECT json_object_agg(edge_id, json_build_array(id, cost, reverse_cost)) FROM netcert.edge"
STEPS = "SELECT coalesce(json_agg(json_build_array(source, target)), '[]') FROM netcert.step"


def probe(postgres, tables):
    with open(f"{tables}/edges.csv", newline="", encoding="utf-8") as text:
        permitted = {int(row["edge_id"]): row["permitted"] == "true" for row in csv.DictReader(text)}
    rows = {int(edge): row for edge, row in json.loads(postgres.psql("-c", EDGES)).items()}
    out = {"refused": 0, "refused_open": 0, "permitted": 0, "permitted_closed": 0, "unknown": len(permitted.keys() ^ rows.keys())}
    refused = set()
    for edge, yes in permitted.items():
        number, cost, back = rows.get(edge, (None, -1, -1))
        word = "permitted" if yes else "refused"
        out[word] += 1
        if yes:
            out["permitted_closed"] += cost < 0
        else:
            refused.add(number)
        # An edge has one direction: against it nobody drives.
        out["refused_open"] += back >= 0 or not yes and cost >= 0
    out["steps_open"] = sum(bool({source, target} & refused) for source, target in json.loads(postgres.psql("-c", STEPS)))
    return out

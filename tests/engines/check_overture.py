"""Whether segment.geojson and connector.geojson keep to Overture's schema, by Overture's own models (PyPI: overture-schema).

    check_overture.py FOLDER

Beyond the models: ids are unique, connectors named exist and lie where they are said to, neighbours in a sequence meet.
"""

import json
import sys

from overture.schema.transportation import Connector, Segment
from pydantic import TypeAdapter, ValidationError


def check(condition, *what):
    if not condition:
        sys.exit("refused: " + " ".join(map(str, what)))


def features(name):
    with open(f"{sys.argv[1]}/{name}.geojson", encoding="utf-8") as text:
        collection = json.load(text)
    check(collection["type"] == "FeatureCollection" and len(collection["netcert"]["database"]["blake3"]) == 64, name)
    by_id = {feature["id"]: feature for feature in collection["features"]}
    check(len(by_id) == len(collection["features"]), name, "ids repeat")
    return by_id


connectors, segments = features("connector"), features("segment")
models = {"connector": TypeAdapter(Connector), "segment": TypeAdapter(Segment)}
for feature in [*connectors.values(), *segments.values()]:
    try:
        models[feature["properties"]["type"]].validate_json(json.dumps(feature))
    except ValidationError as error:
        check(False, feature["id"], error)

used = set()
rules = transitions = 0
for name, segment in segments.items():
    properties, line = segment["properties"], segment["geometry"]["coordinates"]
    at = [reference["at"] for reference in properties["connectors"]]
    check(at == sorted(at) and at[0] == 0.0 and at[-1] == 1.0, name, "connectors:", at)
    for reference in properties["connectors"]:
        connector = connectors[reference["connector_id"]]
        check(connector["geometry"]["coordinates"] in line, name, "does not pass", connector["id"])
        used.add(connector["id"])
    for rule in properties.get("access_restrictions", []) + properties.get("prohibited_transitions", []):
        low, high = rule.get("between", [0.0, 1.0])
        check(low in at and high in at, name, "a rule begins or ends between connectors")
        # A direction that does not exist is closed to everybody.
        everybody = rule["access_type"] == "denied" and list(rule["when"]) == ["heading"] if "access_type" in rule else False
        check(everybody or rule["when"]["vehicle"][0]["comparison"] == "greater_than_equal", name, rule)
    for rule in properties.get("prohibited_transitions", []):
        before = name
        for step in rule["sequence"]:
            for meets in (before, step["segment_id"]):
                ids = [reference["connector_id"] for reference in segments[meets]["properties"]["connectors"]]
                check(step["connector_id"] in ids, name, "a sequence is broken at", step)
            before = step["segment_id"]
    rules += len(properties.get("access_restrictions", []))
    transitions += len(properties.get("prohibited_transitions", []))
check(used == set(connectors), "connectors that no segment has")
print(f"{len(segments)} segments, {len(connectors)} connectors, {rules} denials, {transitions} transitions")

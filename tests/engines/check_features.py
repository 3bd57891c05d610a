"""Reads all collections of a server of OGC API - Features with OWSLib, page by page.

    check_features.py URL

Prints JSON: the conformance classes, and for each collection the ids of its features in order, its attributes that conditions may name, and
how many features a box and a condition find.
"""

import json
import sys
from urllib.parse import parse_qsl, urlparse

from owslib.ogcapi.features import Features

PAGE = 100


def pages(service, name, **asked):
    """The features of a collection, by the link `next` of each page."""
    while True:
        page = service.collection_items(name, limit=PAGE, **asked)
        if page["numberReturned"] != len(page["features"]):
            sys.exit(f"refused: {name} says {page['numberReturned']} and has {len(page['features'])} features")
        yield from page["features"]
        following = [link["href"] for link in page["links"] if link["rel"] == "next"]
        if not following:
            return
        asked = dict(parse_qsl(urlparse(following[0]).query))
        asked.pop("limit")


def main():
    service = Features(sys.argv[1])
    found = {}
    for name in service.feature_collections():
        features = list(pages(service, name))
        west, south, east, north = service.collection(name)["extent"]["spatial"]["bbox"][0]
        middle = [west, south, (west + east) / 2, (south + north) / 2]
        queryables = service.collection_queryables(name)["properties"]
        first = features[0]
        if service.collection_item(name, first["id"])["properties"] != first["properties"]:
            sys.exit(f"refused: {name} has another feature {first['id']} alone than in a page")
        found[name] = {
            "ids": [feature["id"] for feature in features],
            "attributes": list(first["properties"]),
            "queryables": list(queryables),
            "box": middle,
            "in_box": len(list(pages(service, name, bbox=middle))),
            "safe": len(list(pages(service, name, filter="verdict = 'safe'"))) if "verdict" in queryables else None,
        }
    print(json.dumps({"conformance": service.conformance()["conformsTo"], "api": service.api()["openapi"], "collections": found}))


main()

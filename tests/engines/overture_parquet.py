"""Writes features as Overture's releases have them: GeoParquet with nested columns, Zstandard, a folder a type.

    overture_parquet.py FOLDER_OF_GEOJSON OUT [ROWS_IN_A_GROUP]

The columns and their types are those of a release of 2026 (docs.overturemaps.org/schema/reference/transportation/segment).
"""

import json
import os
import struct
import sys

import pyarrow as pa
import pyarrow.parquet as pq

text, real, texts = pa.string(), pa.float64(), pa.list_(pa.string())
between = ("between", pa.list_(real))


def rules(*members):
    return pa.list_(pa.struct([*members, between]))


vehicle = pa.list_(pa.struct([("dimension", text), ("comparison", text), ("value", real), ("unit", text)]))
when = pa.struct([("during", text), ("heading", text), ("using", texts), ("recognized", texts), ("mode", texts), ("vehicle", vehicle)])
speed = pa.struct([("value", pa.int32()), ("unit", text)])
variant = [("variant", text), ("language", text), ("value", text), between, ("side", text)]
common = [
    ("id", text),
    ("geometry", pa.binary()),
    ("bbox", pa.struct([(side, pa.float32()) for side in ("xmin", "xmax", "ymin", "ymax")])),
    ("version", pa.int32()),
    ("sources", rules(("property", text), ("dataset", text), ("license", text), ("record_id", text), ("update_time", text), ("confidence", real))),
]
connector = pa.schema(common)
segment = pa.schema(
    [
        *common,
        ("subtype", text),
        ("class", text),
        ("names", pa.struct([("primary", text), ("common", pa.map_(text, text)), ("rules", pa.list_(pa.struct(variant)))])),
        ("connectors", pa.list_(pa.struct([("connector_id", text), ("at", real)]))),
        ("routes", rules(("name", text), ("network", text), ("ref", text), ("symbol", text), ("wikidata", text))),
        ("subclass_rules", rules(("value", text))),
        ("access_restrictions", rules(("access_type", text), ("when", when))),
        ("level_rules", rules(("value", pa.int32()))),
        ("destinations", pa.list_(pa.struct([("from_connector_id", text), ("to_connector_id", text)]))),
        (
            "prohibited_transitions",
            rules(
                ("sequence", pa.list_(pa.struct([("connector_id", text), ("segment_id", text)]))),
                ("final_heading", text),
                ("when", when),
            ),
        ),
        ("road_surface", rules(("value", text))),
        ("road_flags", rules(("values", texts))),
        ("speed_limits", rules(("min_speed", speed), ("max_speed", speed), ("is_max_speed_variable", pa.bool_()), ("when", when))),
        ("width_rules", rules(("value", real))),
        ("subclass", text),
        ("rail_flags", rules(("values", texts))),
    ]
)


def wkb(geometry):
    if geometry["type"] == "Point":
        return struct.pack("<BI2d", 1, 1, *geometry["coordinates"])
    numbers = [number for place in geometry["coordinates"] for number in place]
    return struct.pack(f"<BII{len(numbers)}d", 1, 2, len(geometry["coordinates"]), *numbers)


folder, out = sys.argv[1:3]
group = int(sys.argv[3]) if len(sys.argv) > 3 else 100_000
for kind, schema in (("segment", segment), ("connector", connector)):
    with open(f"{folder}/{kind}.geojson", encoding="utf-8") as lines:
        features = json.load(lines)["features"]
    rows = []
    for feature in features:
        row = {name: feature["properties"].get(name) for name in schema.names}
        rows.append(row | {"id": feature["id"], "geometry": wkb(feature["geometry"])})
    geo = {"version": "1.1.0", "primary_column": "geometry", "columns": {"geometry": {"encoding": "WKB", "geometry_types": []}}}
    table = pa.Table.from_pylist(rows, schema=schema.with_metadata({"geo": json.dumps(geo)}))
    os.makedirs(f"{out}/theme=transportation/type={kind}")
    path = f"{out}/theme=transportation/type={kind}/part-00000.zstd.parquet"
    pq.write_table(table, path, compression="zstd", row_group_size=group)

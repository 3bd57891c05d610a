#!/usr/bin/env python3
"""Writes first inputs for every target, from data that ships with netcert, into fuzz/seeds/TARGET/.

    fuzz/seeds.py [NETCERT]

NETCERT: the built program, for certificates. Parquet files need pyarrow. What is missing is said, and its seeds are left out.
"""

import gzip
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import tomllib
import zlib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent


def seed(target, name, content):
    folder = HERE / "seeds" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


# Protocol buffers by hand: messages with rare fields too.
def varint(n):
    n &= 2**64 - 1
    out = b""
    while n > 127:
        out, n = out + bytes([n & 127 | 128]), n >> 7
    return out + bytes([n])


def number(field, n):
    return varint(field << 3) + varint(n)


def nested(field, content):
    content = content.encode() if isinstance(content, str) else content
    return varint(field << 3 | 2) + varint(len(content)) + content


def packed(field, numbers):
    return nested(field, b"".join(varint(n) for n in numbers))


def zigzag(numbers):
    return [n << 1 if n >= 0 else (-n << 1) - 1 for n in numbers]


def deltas(numbers):
    return zigzag([b - a for a, b in zip([0, *numbers], numbers)])


def block(strings, *groups, rest=b""):
    return nested(1, b"".join(nested(1, text) for text in ["", *strings])) + b"".join(nested(2, group) for group in groups) + rest


def extracts():
    places = [(1, 494100000, 86900000), (2, 494110000, 86900000), (3, 494110000, 86910000), (4, 494120000, 86920000), (5, 494100000, 86930000)]
    ids, lats, lons = zip(*places)
    dense = packed(1, deltas(ids)) + packed(8, deltas(lats)) + packed(9, deltas(lons))
    tags = packed(10, [1, 2, 0, 0, 3, 4, 0, 0, 0])
    nodes = block(["barrier", "bollard", "place", "town"], nested(2, dense + tags), rest=number(17, 100))
    seen = block(["barrier", "gate", "place", "town"], nested(2, dense + tags + nested(5, packed(6, [1, 1, 0, 1, 1]))), rest=number(19, 0) + number(20, 0))
    plain = block(
        ["maxwidth", "2.5"],
        b"".join(nested(1, number(1, n * 2) + number(8, lat * 2) + number(9, lon * 2) + packed(2, [1]) + packed(3, [2])) for n, lat, lon in places[:3]),
        rest=number(17, 200),
    )
    words = ["highway", "secondary", "name", "Main Street", "width", "6.5", "lanes", "2", "maxheight", "4.0", "oneway", "yes", "hgv:conditional"]
    words += ["no @ (22:00-06:00)", "junction", "roundabout", "area:highway", "traffic_island", "building", "yes"]

    def way(number_, refs, pairs, more=b""):
        return nested(3, number(1, number_) + packed(2, pairs[::2]) + packed(3, pairs[1::2]) + packed(8, deltas(refs)) + more)

    locations = packed(9, deltas(lats[:3])) + packed(10, deltas(lons[:3]))
    ways = block(
        words,
        way(10, [1, 2, 3], [1, 2, 3, 4, 5, 6, 7, 8]),
        way(11, [3, 4], [1, 2, 9, 10, 11, 12]),
        way(12, [3, 5], [1, 2, 13, 14]),
        way(13, [1, 2, 3, 1], [17, 18]) + way(14, [1, 2, 3, 1], [1, 2, 15, 16]) + way(15, [1, 3, 2, 1], [19, 20]),
    )
    located = block(words, way(10, [1, 2, 3], [1, 2], locations), way(11, [3, 4], [1, 2], nested(4, number(1, 3) + number(6, 0))))
    roles = ["type", "restriction", "no_left_turn", "from", "via", "to", "multipolygon", "landuse", "forest", "outer", "except", "bus"]

    def relation(number_, members, pairs):
        kinds, ids_, names = zip(*members)
        body = number(1, number_) + packed(2, pairs[::2]) + packed(3, pairs[1::2])
        return nested(4, body + packed(8, names) + packed(9, deltas(ids_)) + packed(10, kinds))

    relations = block(
        roles,
        relation(20, [(1, 10, 4), (0, 3, 5), (1, 11, 6)], [1, 2, 2, 3]),
        relation(21, [(1, 10, 4), (1, 11, 5), (1, 12, 6)], [1, 2, 2, 3, 11, 12]),
        relation(22, [(1, 13, 10), (1, 15, 10)], [1, 7, 8, 9]),
    )
    for mode in (1, 3, 5, 27):
        for name, blocks in [("all", [nodes, ways, relations]), ("located", [plain, located]), ("seen", [seen, ways + relations]), ("tagged", [ways, plain, relations])]:
            framed = b"".join(struct.pack(">H", len(b)) + b for b in blocks[:-1])
            seed("osm_pbf", f"{name}-{mode}", bytes([mode]) + framed + blocks[-1])

    def file(kind, blob):
        head = nested(1, kind) + number(3, len(blob))
        return struct.pack(">I", len(head)) + head + blob

    head = nested(4, "OsmSchema-V0.6") + nested(4, "DenseNodes") + nested(5, "Sort.Type_then_ID") + nested(16, "by hand")
    box = nested(1, b"".join(number(n, z) for n, z in zip((1, 2, 3, 4), zigzag([86900000, 86930000, 494120000, 494100000]))))
    for name, blob in [("raw", lambda b: nested(1, b)), ("zlib", lambda b: number(2, len(b)) + nested(3, zlib.compress(b)))]:
        whole = file("OSMHeader", blob(box + head + number(32, 1700000000))) + file("OSMData", blob(nodes))
        seed("osm_pbf", f"file-{name}", b"\x18" + whole + file("Other", b"") + file("OSMData", blob(ways)) + file("OSMData", blob(relations)))
    # The data of lz4 and zstd: a frame of one raw block, and one sequence of literals.
    zstd = b"\x28\xb5\x2f\xfd\x20" + bytes([255]) + struct.pack("<I", 255 << 3 | 1)[:3] + ways[:255]
    lz4 = b"\xf0" + bytes([len(plain) - 15]) + plain
    for name, blob in [("zstd", number(2, 255) + nested(7, zstd)), ("lz4", number(2, len(plain)) + nested(6, lz4))]:
        seed("osm_pbf", f"file-{name}", b"\0" + file("OSMHeader", nested(1, head)) + file("OSMData", blob))
    seed("osm_pbf", "demo", b"\0" + (ROOT / "data/demo.osm.pbf").read_bytes())


def changes():
    text = """<?xml version="1.0" encoding="UTF-8"?>
<osmChange version="0.6" generator="by hand">
  <create><node id="1" version="1" timestamp="2026-11-21T08:00:00Z" lat="49.41" lon="8.69"/><node id="2" lat="49.42" lon="-8.7"><tag k="barrier" v="a &amp; &#x41;"/></node></create>
  <modify><way id="10" version="3"><nd ref="1"/><nd ref="2"/><tag k="highway" v="primary"/></way>
  <relation id="20" version="2" visible="true"><member type="way" ref="10" role="from"/><member type="node" ref="2" role="via"/><tag k="type" v="restriction"/></relation></modify>
  <delete><way id="11" version="4" visible="false"/></delete>
</osmChange>
"""
    seed("osm_change", "plain", text)
    seed("osm_change", "gzipped", gzip.compress(text.encode(), mtime=0))
    seed("osm_change", "two-members", gzip.compress(text[:100].encode(), mtime=0) + gzip.compress(text[100:].encode(), mtime=0))
    seed("osm_change", "comments", text.replace("<create>", "<!-- a --><![CDATA[b]]><create>").replace("<osmChange", "<!DOCTYPE osmChange []>\n<osmChange"))


def shapes():
    ring = [(8.0, 49.0), (8.1, 49.0), (8.1, 49.1), (8.0, 49.0)]

    def wkb(kind, content, order="<", srid=None):
        head = struct.pack(order + "BI", order == "<", kind | (0x20000000 if srid is not None else 0))
        return head + (struct.pack(order + "I", srid) if srid is not None else b"") + content

    def line(places, order="<"):
        return struct.pack(order + "I", len(places)) + b"".join(struct.pack(order + f"{len(p)}d", *p) for p in places)

    one = [
        wkb(1, struct.pack("<2d", 8, 49)),
        wkb(1, struct.pack(">2d", 8, 49), ">"),
        wkb(2, line(ring)),
        wkb(1002, line([(*place, 3.0) for place in ring], ">"), ">"),
        wkb(0xC0000002, line([(*place, 3.0, 4.0) for place in ring])),
        wkb(2, line(ring), srid=4326),
        wkb(3, struct.pack("<I", 2) + line(ring) + line(ring)),
        wkb(4, struct.pack("<I", 1) + wkb(1, struct.pack("<2d", 8, 49))),
        wkb(5, struct.pack("<I", 1) + wkb(2, line(ring))),
        wkb(6, struct.pack("<I", 1) + wkb(3, struct.pack("<I", 1) + line(ring))),
        wkb(1, struct.pack("<2d", float("nan"), float("nan"))),
    ]
    for i, shape in enumerate(one):
        seed("wkb", f"plain-{i}", shape)
        seed("wkt", f"hexadecimal-{i}", shape.hex())
    for envelope, length in enumerate([0, 32, 48, 48, 64]):
        flags = envelope << 1 | 1
        seed("wkb", f"blob-{envelope}", b"GP\0" + bytes([flags]) + struct.pack("<i", 4326) + bytes(length) + one[envelope])
    places = ", ".join(f"{x} {y}" for x, y in ring)
    for i, text in enumerate(
        ["POINT (8 49)", "SRID=4326;POINT Z(8 49 1e2)", f"LINESTRING ({places})", f"LineString M ({places.replace(',', ' 7,')})"]
        + [f"POLYGON (({places}), ({places}))", "MULTIPOINT ((8 49))", f"MULTILINESTRING (({places}))", f"MULTIPOLYGON ((({places})))", "POINT ZM EMPTY"]
    ):
        seed("wkt", f"text-{i}", text)


def tags():
    for i, lines in enumerate(
        [
            "highway=residential\nwidth=5.5\nlanes=2\nwidth:lanes=3.0|2.5\nturn:lanes=left|through;right\nname=A\nref=B 3",
            "hgv=no\nhgv:conditional=yes @ (Mo-Fr 06:00-20:00; PH off)\nmaxweight=7.5\nmaxweight:hgv:conditional=12 @ (axles>3 AND length<=12)",
            "maxheight=12'6\"\nmaxlength=18 m\nmaxwidth=380 cm\nmaxaxleload=11,5\nmaxspeed=30 mph\nmaxspeed:hgv:forward=60;50",
            "access:conditional=no @ (2026 Dec 24-2027 Jan 02 22:00-06:00), destination @ (sunset-sunrise)\noneway=reversible\nice_road=yes",
            "motor_vehicle=destination\nbus=yes\npsv:lanes=designated|yes\nbusway=opposite_lane\noneway=yes\noneway:bus=no\nlanes:psv:backward=1",
            "barrier=gate\nmaxwidth:physical=2.5\naccess=private\nopening_hours=Mo[1] 08:00+; week 1-53/2 We 24:00-26:00",
            "parking:left=parallel\nparking:left:width=2.1\nsidewalk=both\ncycleway:right=lane\ncycleway:right:width=1.5\nshoulder=yes\nverge=left\nkerb=raised",
            "junction=roundabout\nlanes:forward=2\nlanes:both_ways=1\nchange:lanes=no|yes\nhov:lanes=designated|\nnarrow=yes\nest_width=~3\nsource:width=survey",
            "type=restriction\nrestriction=no_left_turn\nrestriction:hgv=only_straight_on\nrestriction:conditional=no_u_turn @ (07:00-09:00)\nexcept=psv;bus",
            "area:highway=traffic_island\nlanduse=forest\nnatural=water\nbuilding=yes\nplace=town\ntraffic_calming=island\nmaxtrailers=1\nmaxaxles=4",
        ]
    ):
        seed("osm_tags", f"tags-{i}", lines)


def vehicles():
    text = (ROOT / "data/vehicles.toml").read_text()
    for i, part in enumerate(text.split("[[vehicle]]")[1::3]):
        seed("vehicle_file", f"toml-{i}", "[[vehicle]]" + part)
    for vehicle in tomllib.loads(text)["vehicle"][::3]:
        seed("vehicle_file", f"json-{vehicle['id']}", json.dumps(vehicle))


def certificates(program):
    with tempfile.TemporaryDirectory() as folder:
        for i, (vehicle, points, width) in enumerate(
            [("EU-SEMI16.5", [[0, 0], [12, 0]], 4.0), ("AGV-TUG4", [[0, 0], [8, 0], [14, 3]], 3.0), ("US-WB67", [[0, 0], [20, 0]], 2.0)]
        ):
            road, out = f"{folder}/road.json", f"{folder}/{i}.json"
            pathlib.Path(road).write_text(json.dumps({"frame": "metres", "points": points, "width_m": width}))
            subprocess.run([program, "corridor", "-q", road, "--vehicle", vehicle, "--out", out], check=True, stdout=subprocess.DEVNULL)
            seed("certificate_file", f"corridor-{i}", pathlib.Path(out).read_text().rsplit(',"sha256"', 1)[0])


def overture():
    def road(i, places, connectors, **more):
        at = [{"connector_id": f"c{c}", "at": share} for c, share in connectors]
        properties = {"type": "segment", "subtype": "road", "class": "secondary", "connectors": at} | more
        return {"type": "Feature", "id": f"s{i}", "geometry": {"type": "LineString", "coordinates": places}, "properties": properties}

    def point(i, place):
        return {"type": "Feature", "id": f"c{i}", "geometry": {"type": "Point", "coordinates": place}, "properties": {"type": "connector"}}

    heavy = {"heading": "forward", "during": "Mo-Fr 07:00-09:00", "mode": ["hgv"], "using": ["as_customer"], "recognized": ["as_permitted"]}
    size = {"vehicle": [{"dimension": "weight", "comparison": "greater_than", "value": 7.5, "unit": "t"}]}
    segments = [
        road(1, [[150, -31], [150.002, -31], [150.004, -31]], [(1, 0), (2, 0.5), (3, 1)], names={"primary": "Main"}, routes=[{"ref": "A1"}],
             width_rules=[{"value": 6.5, "between": [0.25, 1]}], speed_limits=[{"max_speed": {"value": 60, "unit": "km/h"}, "when": heavy}],
             access_restrictions=[{"access_type": "denied", "when": size}, {"access_type": "allowed", "when": heavy, "between": [0, 0.5]}],
             prohibited_transitions=[{"sequence": [{"connector_id": "c2", "segment_id": "s2"}], "final_heading": "forward", "when": {"heading": "forward"}}]),
        road(2, [[150.002, -31], [150.002, -31.002]], [(2, 0), (4, 1)], **{"class": "residential"}, subclass_rules=[{"value": "link"}],
             road_flags=[{"values": ["is_tunnel"], "between": [0, 0.5]}], level_rules=[{"value": -1}], road_surface=[{"value": "paved"}]),
        road(3, [[150.004, -31], [150.004, -31.001]], [(3, 0), (5, 1)], subtype="rail"),
    ]
    places = [[150, -31], [150.002, -31], [150.004, -31], [150.002, -31.002], [150.004, -31.001]]
    connectors = [point(i + 1, place) for i, place in enumerate(places)]
    text = {kind: json.dumps({"type": "FeatureCollection", "features": all_}) for kind, all_ in (("segment", segments), ("connector", connectors), ("both", connectors + segments))}
    seed("overture_geojson", "both", text["both"])
    for i, segment in enumerate(segments):
        seed("overture_geojson", f"segment-{i}", json.dumps({"type": "FeatureCollection", "features": [segment, *connectors[:3]]}))
    with tempfile.TemporaryDirectory() as folder:
        for kind in ("segment", "connector"):
            pathlib.Path(f"{folder}/{kind}.geojson").write_text(text[kind])
        subprocess.run([sys.executable, ROOT / "tests/engines/overture_parquet.py", folder, f"{folder}/out", "2"], check=True)
        import pyarrow.parquet as parquet

        for kind in ("segment", "connector"):
            whole = f"{folder}/out/theme=transportation/type={kind}/part-00000.zstd.parquet"
            seed("overture_parquet", kind, pathlib.Path(whole).read_bytes())
            table = parquet.read_table(whole, partitioning=None)
            # Without what is not read, and with little metadata: the fuzzer changes more of what counts.
            table = table.drop_columns([name for name in ("bbox", "version", "sources", "rail_flags", "speed_limits") if name in table.column_names])
            ways = {"plain": {"compression": "none", "use_dictionary": False}, "dictionary": {"compression": "none"}, "snappy": {"compression": "snappy"}}
            ways["second"] = {"compression": "none", "data_page_version": "2.0", "use_dictionary": False}
            for name, how in ways.items():
                parquet.write_table(table, f"{folder}/x.parquet", store_schema=False, write_statistics=False, **how)
                seed("overture_parquet", f"{kind}-{name}", pathlib.Path(f"{folder}/x.parquet").read_bytes())


extracts()
changes()
shapes()
tags()
vehicles()
if len(sys.argv) > 1:
    certificates(str(pathlib.Path(sys.argv[1]).resolve()))
else:
    print("no seeds of certificates: name the built netcert", file=sys.stderr)
try:
    overture()
except (ImportError, subprocess.CalledProcessError):
    print("no seeds of Parquet: they need pyarrow", file=sys.stderr)

"""Valhalla's tiles, read byte by byte: every directed edge with its way, its line and whether trucks may drive it.

The layout is that of `valhalla/baldr/graphtileheader.h`, `directededge.h` and `edgeinfo.h` of Valhalla 3.9; no stretch of it has a
length of its own, so that a wrong layout gives ways that do not exist.
"""

import glob
import struct
from collections import namedtuple

from valhalla.baldr import GraphTileHeader

# `forward`: in direction of the way's nodes. `line`: places in direction of travel, in millionths of a degree, east and north.
TileEdge = namedtuple("TileEdge", "id way forward truck shortcut line")

NODE_BYTES, TRANSITION_BYTES, EDGE_BYTES = 32, 8, 48
EDGEINFO_OFFSET_AT = 104
TRUCK = 8


def edges(folder):
    for path in sorted(glob.glob(f"{folder}/**/*.gph", recursive=True)):
        yield from edges_of_tile(path)


def edges_of_tile(path):
    with open(path, "rb") as file:
        tile = file.read()
    header = GraphTileHeader.from_bytes(tile)
    (edgeinfo_at,) = struct.unpack_from("<I", tile, EDGEINFO_OFFSET_AT)
    first = GraphTileHeader.byte_size() + header.nodecount * NODE_BYTES + header.transitioncount * TRANSITION_BYTES
    infos = {}
    for i in range(header.directededgecount):
        words = struct.unpack_from("<6Q", tile, first + i * EDGE_BYTES)
        info = words[1] & ((1 << 25) - 1)
        if info not in infos:
            infos[info] = edge_info(tile, edgeinfo_at + info)
        way, line = infos[info]
        forward = bool(words[0] >> 61 & 1)
        shortcut = bool(words[5] >> 60 & 1)
        yield TileEdge(header.graphid.value + (i << 25), way, forward, bool(words[3] & TRUCK), shortcut, line if forward else line[::-1])


def edge_info(tile, at):
    way, second, third = struct.unpack_from("<III", tile, at)
    names, shape_bytes, more_bytes = third & 15, third >> 4 & 0xFFFF, third >> 28 & 3
    shape_at = at + 12 + 4 * names
    way |= (second >> 24) << 32 | (third >> 20 & 0xFF) << 40
    for i in range(more_bytes):
        way |= tile[shape_at + shape_bytes + i] << (48 + 8 * i)
    return way, line_of(tile[shape_at : shape_at + shape_bytes])


def line_of(shape):
    """Steps of seven bits a byte, north before east, each with its sign in the lowest bit."""
    numbers, value, shift = [], 0, 0
    for byte in shape:
        value |= (byte & 127) << shift
        shift += 7
        if byte < 128:
            numbers.append(value >> 1 ^ -(value & 1))
            value = shift = 0
    line, north, east = [], 0, 0
    for up, right in zip(numbers[::2], numbers[1::2]):
        north, east = north + up, east + right
        line.append((east, north))
    return line

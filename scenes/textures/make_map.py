#!/usr/bin/env python3
"""Writes map.png to standard output: 64 x 32 texels whose corners differ, so that a turned or mirrored image shows.

    python3 scenes/textures/make_map.py > scenes/textures/map.png

The same bytes on every machine: one uncompressed block, written here, since compressors differ.
"""

import struct
import sys
import zlib

WIDTH, HEIGHT = 64, 32
GRID = 8  # texels between the lines of the grid
RED, GREEN, BLUE, YELLOW = (220, 60, 50), (60, 170, 80), (50, 90, 200), (230, 200, 60)
LINE = (245, 245, 245)


def texel(x, y):
    if x % GRID == 0 or y % GRID == 0:
        return LINE
    top = y < HEIGHT / 2
    left = x < WIDTH / 2
    return (RED if left else GREEN) if top else (BLUE if left else YELLOW)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def stored(data):
    """A zlib stream (RFC 1950) of one stored block (RFC 1951)."""
    size = struct.pack("<HH", len(data), len(data) ^ 0xFFFF)
    return b"\x78\x01" + b"\x01" + size + data + struct.pack(">I", zlib.adler32(data))


def png():
    rows = b"".join(b"\0" + bytes(v for x in range(WIDTH) for v in texel(x, y)) for y in range(HEIGHT))
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)  # 8 bits a channel, RGB
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", stored(rows)) + chunk(b"IEND", b"")


if __name__ == "__main__":
    sys.stdout.buffer.write(png())

#!/usr/bin/env python3
"""Writes sky.exr to standard output: 512 x 256 texels of a clear sky with a sun, and dark ground below the horizon.

    python3 scenes/textures/make_sky.py > scenes/textures/sky.exr

Equirectangular, +y at the top, -z in the middle. Half precision, uncompressed and written here: so the bytes are the
same on every machine.
"""

import math
import struct
import sys

WIDTH, HEIGHT = 512, 256
ZENITH, HORIZON, GROUND = (0.18, 0.36, 0.80), (0.75, 0.82, 0.90), (0.12, 0.11, 0.10)
SUN = (24000.0, 21600.0, 18000.0)
SUN_RADIUS = math.radians(0.27)
SUN_AT = (-0.62, 0.55, -0.56)  # left of the middle, some 33 degrees high
GLOW = (1.4, 1.1, 0.7)  # around the sun
SUBTEXELS = 8  # along each side of a texel that the sun's edge may cross


def normalised(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def direction(x, y):
    """Of a place in texels from the upper left corner."""
    turn = 2 * math.pi * x / WIDTH
    down = math.pi * y / HEIGHT
    return -math.sin(down) * math.sin(turn), math.cos(down), math.sin(down) * math.cos(turn)


def angle_between(a, b):
    return math.acos(max(-1.0, min(1.0, sum(p * q for p, q in zip(a, b)))))


def radiance(x, y, sun):
    d = direction(x + 0.5, y + 0.5)
    if d[1] <= 0:
        return GROUND
    away = angle_between(d, sun)
    height = math.sqrt(d[1])
    glow = math.exp(-8 * away)
    part = 0.0  # of the texel that the sun fills
    if away < 0.05:
        places = [(i + 0.5) / SUBTEXELS for i in range(SUBTEXELS)]
        inside = sum(angle_between(direction(x + u, y + v), sun) < SUN_RADIUS for v in places for u in places)
        part = inside / SUBTEXELS**2
    return tuple(
        horizon + (zenith - horizon) * height + glow * g + part * s
        for zenith, horizon, g, s in zip(ZENITH, HORIZON, GLOW, SUN)
    )


def attribute(name, kind, value):
    return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value


def exr(rows):
    """Scan lines of half floats, one a chunk (openexr.com/en/latest/OpenEXRFileLayout.html)."""
    half, linear = 1, 0
    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", half, linear, 1, 1) for name in (b"B", b"G", b"R"))
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    header = b"\x76\x2f\x31\x01" + struct.pack("<i", 2)
    header += attribute(b"channels", b"chlist", channels + b"\0")
    header += attribute(b"compression", b"compression", b"\0")
    header += attribute(b"dataWindow", b"box2i", window)
    header += attribute(b"displayWindow", b"box2i", window)
    header += attribute(b"lineOrder", b"lineOrder", b"\0")
    header += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    header += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    header += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    row_bytes = 6 * WIDTH
    first = len(header) + 8 * HEIGHT
    places = struct.pack(f"<{HEIGHT}Q", *(first + y * (8 + row_bytes) for y in range(HEIGHT)))
    chunks = b"".join(
        struct.pack("<ii", y, row_bytes)
        + b"".join(struct.pack(f"<{WIDTH}e", *(texel[channel] for texel in row)) for channel in (2, 1, 0))
        for y, row in enumerate(rows)
    )
    return header + places + chunks


if __name__ == "__main__":
    sun = normalised(SUN_AT)
    sys.stdout.buffer.write(exr([[radiance(x, y, sun) for x in range(WIDTH)] for y in range(HEIGHT)]))

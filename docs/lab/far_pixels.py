#!/usr/bin/env python3
"""How many pixels of two images differ, and by more than a limit: far_pixels.py A.pfm B.pfm LIMIT"""
import array
import sys


def floats(name):
    """Three of each pixel."""
    with open(name, "rb") as file:
        kind, _, _, data = file.read().split(b"\n", 3)
    if kind != b"PF":
        sys.exit(f"{name}: not a colour PFM file")
    values = array.array("f")
    values.frombytes(data)
    return values


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    a, b, limit = floats(sys.argv[1]), floats(sys.argv[2]), float(sys.argv[3])
    if len(a) != len(b):
        sys.exit("the images have different sizes")
    away = sorted((max(abs(a[i + k] - b[i + k]) for k in range(3)) for i in range(0, len(a), 3)), reverse=True)
    squares = sum(value * value for value in away) or 1
    print(f"{len(away)} pixels, {sum(value > 0 for value in away)} differ, {sum(value > limit for value in away)} of them "
          f"by more than {limit:g}")
    print(f"the 20 worst have {100 * sum(value * value for value in away[:20]) / squares:.1f} % of the squared error")


if __name__ == "__main__":
    main()

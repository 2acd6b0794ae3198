#!/usr/bin/env python3
"""What each thread of a render did, and how full its pool was: show.py STATS.json...

The files are what `raypool render --stats FILE` wrote. Tests of boxes and primitives, and the rounds of a pool, are there
with --count-work. The last line of a table is the greatest over the mean: 1 is perfect balance.
"""
import json
import sys


def max_over_mean(values):
    return max(values) * len(values) / sum(values) if sum(values) else 1.0


def columns(stats):
    """(name, a value for each thread) for what was counted."""
    threads = stats["threads"]
    yield "paths", [thread["paths"] for thread in threads]
    yield "segments", [thread["segments"] for thread in threads]
    if threads[0]["box_tests"] is not None:
        yield "tests", [thread["box_tests"] + thread["primitive_tests"] for thread in threads]


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[1:]:
        with open(name, encoding="utf-8") as file:
            stats = json.load(file)
        table = list(columns(stats))
        print(f"{name}: hash {stats['hash']}, {stats['paths']} paths, {stats['segments']} segments")
        print("thread  ", *(f"{title:>10}" for title, _ in table))
        for thread in range(len(stats["threads"])):
            print(f"{thread:<8}", *(f"{values[thread]:>10}" for _, values in table))
        print("max/mean", *(f"{max_over_mean(values):>10.3f}" for _, values in table))
        if stats.get("rounds"):
            records = sum(each["records_in"] for each in stats["rounds"]) / len(stats["rounds"])
            print(f"{len(stats['rounds'])} rounds, {records:.1f} records in each of them, "
                  f"{100 * records / stats['pool_rays']:.1f} % of a pool of {stats['pool_rays']}")


if __name__ == "__main__":
    main()

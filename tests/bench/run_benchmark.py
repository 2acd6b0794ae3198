"""Runs every row of a benchmark for a moment, and fails if one was skipped, lacks a counter, or none ran.

usage: run_benchmark.py BINARY [OPTION OF GOOGLE BENCHMARK...]
"""
import json
import re
import subprocess
import sys

CONTEXT = {"version", "commit", "compiler", "flags", "build", "cpu", "cores", "os", "openmp", "openmp_threads"}
NAME = re.compile(r"[a-z_]+(/[a-z0-9_:-]+)+")


def problems_with(row):
    """Yields what is wrong with a row."""
    if row.get("error_occurred"):
        yield row["error_message"]
        return
    if not NAME.fullmatch(row["name"]):
        yield "the name is not a path"
    if not re.search(r"/(real|manual)_time$", row["name"]):
        yield "the time is not that of the clock on the wall"
    if row.get("rays/s", 0) <= 0:
        yield "no rays/s"
    if "bytes/ray" not in row:
        yield "no bytes/ray"


def main():
    binary, *options = sys.argv[1:]
    result = subprocess.run(
        [binary, "--benchmark_format=json", "--benchmark_min_time=0.001", *options], text=True, capture_output=True)
    if result.returncode != 0 or not result.stdout:
        print(f"exit status {result.returncode}, {len(result.stdout)} characters of JSON: {result.stderr.strip()}")
        return 1
    report = json.loads(result.stdout)
    rows = report["benchmarks"]
    problems = [f"{row['name']}: {problem}" for row in rows for problem in problems_with(row)]
    problems += [f"the context lacks {key}" for key in sorted(CONTEXT - set(report["context"]))]
    names = [row["name"] for row in rows]
    problems += [f"two rows are called {name}" for name in sorted(set(names)) if names.count(name) > 1]
    if not rows:
        problems.append("no row ran")
    print("\n".join(problems) or f"{len(rows)} rows ran")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())

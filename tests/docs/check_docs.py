#!/usr/bin/env python3
"""Checks that the documentation is true where a machine can tell: the commands in ```sh blocks work, links lead somewhere.

Usage: check_docs.py REPOSITORY RAYPOOL

`raypool`, the generators of scenes/ and the programs of docs/lab/ are run, in their order on the page, in a scratch folder that
looks like the repository and whose files go away. Other scripts of the repository are not run; they must exist and be executable.
Presets must exist. A block marked ```json NAME is written to that file of the scratch folder before the page's commands run.
"""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

SECONDS_PER_COMMAND = 120
RUN = ("raypool", "scenes/generate", "scenes/generate_mesh", "docs/lab/", "g++", "out/")  # how a program that is run begins
NEVER_RUN = {"cmake", "ctest", "git", "cd", "clang-format"}


def commands(page):
    """Yields (line number, command) for the shell commands of a page; a backslash continues a line."""
    in_block, pending, start = False, "", 0
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("```"):
            in_block = line == "```sh" and not in_block
        elif in_block:
            start = start if pending else number
            pending += line.strip()
            if pending.endswith("\\"):
                pending = pending[:-1]
            else:
                if shlex.split(pending, comments=True):
                    yield start, pending
                pending = ""


def write_files(page, scratch):
    for name, content in re.findall(r"^```json (\S+)\n(.*?)^```$", page.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE):
        (scratch / name).write_text(content, encoding="utf-8")


def problem_with(command, repository, scratch, raypool, presets):
    """What is wrong with a command, or None."""
    words = shlex.split(command, comments=True)
    while "=" in words[0]:  # a variable for the command alone
        words.pop(0)
    program = words[0]
    if program.startswith(RUN):
        environment = dict(os.environ, PATH=f"{raypool.parent}{os.pathsep}{os.environ['PATH']}")
        result = subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=scratch, env=environment, text=True,
                                stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS_PER_COMMAND)
        return f"exit status {result.returncode}: {result.stderr.strip()}" if result.returncode else None
    if program.startswith(("scripts/", ".ci/", "./")):
        return None if os.access(repository / program, os.X_OK) else "no such executable file"
    if program not in NEVER_RUN:
        return "neither raypool nor a script of the repository"
    if "--preset" in words and words[words.index("--preset") + 1] not in presets:
        return "no such preset"
    return None


def broken_links(page):
    """Yields (line number, target) for links to files that are not there."""
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", line):
            if "://" not in target and not (page.parent / target).exists():
                yield number, target


def main():
    repository, raypool = (Path(argument).resolve() for argument in sys.argv[1:])
    presets = {preset["name"] for preset in json.loads((repository / "CMakePresets.json").read_text())["configurePresets"]}
    pages = [path for pattern in ("*.md", "docs/*.md", "docs/lab/*.md") for path in sorted(repository.glob(pattern))]
    problems, run_count = [], 0
    with tempfile.TemporaryDirectory() as name:
        scratch = Path(name)
        for entry in repository.iterdir():
            if entry.name not in {".git", "build", "out"}:
                (scratch / entry.name).symlink_to(entry)
        (scratch / "out").mkdir()

        for page in pages:
            write_files(page, scratch)
            for number, command in commands(page):
                run_count += command.startswith(RUN)
                problem = problem_with(command, repository, scratch, raypool, presets)
                if problem:
                    problems.append(f"{page.relative_to(repository)}:{number}: {command}\n    {problem}")
            for number, target in broken_links(page):
                problems.append(f"{page.relative_to(repository)}:{number}: no file {target}")

    print("\n".join(problems) or f"{run_count} commands ran, on {len(pages)} pages")
    if run_count == 0:
        print("no page shows a raypool command: is the search for them broken?")
    return 1 if problems or run_count == 0 else 0


if __name__ == "__main__":
    sys.exit(main())

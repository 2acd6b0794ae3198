#!/usr/bin/env python3
"""Draws the pictures of a study. Usage: draw.py FOLDER, which holds run.json and data.csv (`raypool study` calls this).

A study's pictures are functions of the module of its name beside this file: PICTURES[name](run, rows) -> figure.
"""
import importlib
import sys

import common


def main():
    folder = sys.argv[1]
    run, rows = common.read(folder)
    module = importlib.import_module(run["study"].replace("-", "_"))
    for picture in run["pictures"]:
        common.save(module.PICTURES[picture["name"]](run, rows), folder, run, picture)


if __name__ == "__main__":
    main()

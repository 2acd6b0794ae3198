"""Starts the analysis, also by the name of this folder: python3 scripts/analysis study FOLDER."""
import sys
from pathlib import Path

PACKAGE_IS_MISSING = 3  # bench/studies/analysis.cpp then says what to install

sys.path[0] = str(Path(__file__).resolve().parent.parent)  # where this folder is the package `analysis`
try:
    from analysis.command import main
    if sys.argv[1:2] == ["report"]:  # a study does without
        import jinja2  # noqa: F401
except ModuleNotFoundError:
    if sys.argv[1:2] == ["trace"]:  # called by hand: the error must name the package
        raise
    sys.exit(PACKAGE_IS_MISSING)
main()

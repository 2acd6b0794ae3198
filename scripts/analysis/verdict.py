"""Verdicts over ratios: a claim is decided only where all runs are on one side of what it claims."""
from enum import StrEnum


class Verdict(StrEnum):
    HOLDS = "holds"
    DOES_NOT_HOLD = "does not hold"
    CANNOT_TELL = "cannot be told here"


LEAST_RUNS = 5  # fewer fall on one side by chance too often to decide anything


def judged(is_true):
    return Verdict.HOLDS if is_true else Verdict.DOES_NOT_HOLD


def is_at_least(ratio, least):
    """Whether a spread of ratios is at least `least`."""
    if ratio.runs < LEAST_RUNS or ratio.low < least <= ratio.high:
        return Verdict.CANNOT_TELL
    return judged(ratio.low >= least)


def why_open(ratio, least):
    """Why is_at_least() could not tell; empty where it could."""
    if ratio.runs < LEAST_RUNS:
        return f"fewer than {LEAST_RUNS} runs"
    is_open = is_at_least(ratio, least) == Verdict.CANNOT_TELL
    return f"the spread of the runs includes {least:g}" if is_open else ""

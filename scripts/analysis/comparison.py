"""Two runs of one study held side by side: by case, what is measured, what changed beyond the noise, and hashes."""
import math
from dataclasses import dataclass

from .data import grouped
from .spreads import Spread, spread
from .verdict import LEAST_RUNS

# What tells rows of one case apart, where a case leaves several: columns that are settings, not measurements.
PLACES = ("kind", "group", "scene", "way", "source", "axis", "part", "refill", "clocks", "id", "method", "value", "threads",
          "thread", "round", "depth", "level")
TIMES = ("seconds", "_seconds", "_s", "_ns", "ns", "ns_per_segment")  # ends of names; less is better
RATES = ("_per_s",)  # more is better


def is_rate(column):
    return column.endswith(RATES)


def is_measured(column):
    """By its name: a time or a rate, which differ from run to run."""
    return is_rate(column) or column in TIMES or column.endswith(tuple(end for end in TIMES if end.startswith("_")))


@dataclass
class Change:
    """Of one measured column of one case: what was and what is."""
    case: str
    column: str
    old: Spread
    new: Spread

    @property
    def ratio(self):
        """New over old: of the medians, and the least and the most that the ranges allow."""
        return Spread(self.new.median / self.old.median, self.new.low / self.old.high, self.new.high / self.old.low,
                      min(self.old.runs, self.new.runs))

    @property
    def speed(self):
        """The ratio as times as fast, whether the column is a time or a rate."""
        ratio = self.ratio
        return ratio if is_rate(self.column) else Spread(1 / ratio.median, 1 / ratio.high, 1 / ratio.low, ratio.runs)

    @property
    def size(self):
        """The same for twice and for half."""
        return abs(math.log(self.ratio.median))

    @property
    def can_be_told(self):
        return min(self.old.runs, self.new.runs) >= LEAST_RUNS

    @property
    def is_beyond_noise(self):
        """No run of one lies within the range of the other."""
        return self.can_be_told and (self.new.low > self.old.high or self.new.high < self.old.low)

    @property
    def is_better(self):
        return (self.new.median > self.old.median) == is_rate(self.column)

    @property
    def verdict(self):
        if not self.can_be_told:
            return "too few runs"
        return ("faster" if self.is_better else "slower") if self.is_beyond_noise else "within the noise"

    @property
    def by_chance(self):
        """How often runs that do not differ at all lie apart like this."""
        return 2 / math.comb(self.old.runs + self.new.runs, self.new.runs) if self.can_be_told else 0


@dataclass
class Comparison:
    changes: list  # the largest first
    same_hashes: int
    other_hashes: list  # the cases
    only_old: list
    only_new: list
    ambiguous: list  # cases with rows that nothing tells apart

    @property
    def beyond(self):
        return [change for change in self.changes if change.is_beyond_noise]

    @property
    def by_chance(self):
        return sum(change.by_chance for change in self.changes)


def keyed(rows, places):
    """Rows by case, and by what tells the rows of one case apart; and the cases where nothing does."""
    found, ambiguous = {}, []
    for key, group in grouped(rows, "case", *places).items():
        repeats = [row["repeat"] for row in group]
        if len(set(repeats)) == len(repeats):
            found[key] = group
        else:
            ambiguous.append(str(key[0]))
    return found, list(dict.fromkeys(ambiguous))


def names_of(keys, places):
    """Of each key the case, and of what tells rows apart what differs within that case."""
    found = {}
    for (case,), group in grouped([{"case": key[0], "key": key} for key in keys], "case").items():
        values = list(zip(*(row["key"] for row in group)))[1:]
        differing = [i for i, of_place in enumerate(values, 1) if len(set(of_place)) > 1]
        for key in (row["key"] for row in group):
            more = [f"{places[i - 1]} {key[i]}" for i in differing if key[i] is not None]
            found[same_numbers(key)] = ", ".join([str(case), *more])
    return found


def same_numbers(key):
    """2 and 2.0 are one thread count: a column has another type where another of its cells is no whole number."""
    return tuple(float(value) if isinstance(value, int) else value for value in key)


def usable(group, column):
    """The runs of a case: at least one, and all above nothing, as a ratio needs."""
    values = [row[column] for row in group if row.get(column) is not None]
    return values if values and all(isinstance(value, (int, float)) and value > 0 for value in values) else []


def compare(old_rows, new_rows):
    columns = [column for column in (old_rows[0] if old_rows else {}) if new_rows and column in new_rows[0]]
    places = [column for column in columns if column in PLACES]
    (old, unclear_old), (new, unclear_new) = (keyed(rows, places) for rows in (old_rows, new_rows))
    names = {**names_of(new, places), **names_of(old, places)}
    old, new = ({same_numbers(key): group for key, group in found.items()} for found in (old, new))
    changes, same_hashes, other_hashes = [], 0, []
    for key in old:
        if key not in new:
            continue
        for column in filter(is_measured, columns):
            values = usable(old[key], column), usable(new[key], column)
            if all(values):
                changes.append(Change(names[key], column, *map(spread, values)))
        hashes = [{row["hash"] for row in group if row.get("hash")} for group in (old[key], new[key])]
        if all(hashes):
            same_hashes += hashes[0] == hashes[1]
            if hashes[0] != hashes[1]:
                other_hashes.append(names[key])
    changes.sort(key=lambda change: (not change.is_beyond_noise, -change.size))
    return Comparison(changes, same_hashes, other_hashes, [names[key] for key in old if key not in new],
                      [names[key] for key in new if key not in old],
                      list(dict.fromkeys(unclear_old + unclear_new)))

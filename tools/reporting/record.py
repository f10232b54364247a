# SPDX-License-Identifier: Apache-2.0
"""Rows of a sweep's record (docs/SWEEPS.md): reading, selecting, and the questions that the report and docs/FINDINGS.md ask of them."""
import csv
import math

NUMBERS_FROM = "psnr_db"  # measures begin here
WORDS_OF_COORDINATES = ("coordinate_bits", "offset_bits", "reciprocal_bits", "tolerance_bits")  # that move positions


def load(path):
    """Rows as dictionaries; measures are floats, NaN where empty; whole-number axes are ints."""
    with open(path, newline="", encoding="utf-8") as file:
        return rows_of(list(csv.reader(file)))


def rows_of(lines):
    """Of a record's lines, each a list of texts, the heading first."""
    rows = [dict(zip(lines[0], line)) for line in lines[1:]]
    for row in rows:
        measured = False
        for name, text in row.items():
            measured = measured or name == NUMBERS_FROM
            if measured:
                row[name] = float(text) if text else math.nan
            elif text.lstrip("-").isdigit() and name not in ("study", "part"):
                row[name] = int(text)
    return rows


def select(rows, **wanted):
    """Rows whose columns have the values; a value may be a tuple of several."""
    def fits(row):
        return all(row[name] in value if isinstance(value, tuple) else row[name] == value for name, value in wanted.items())
    return [row for row in rows if fits(row)]


def values(rows, name):
    """Different values of a column, in order of size or of appearance."""
    found = list(dict.fromkeys(row[name] for row in rows))
    return sorted(found) if all(isinstance(v, int) for v in found) else found


def one(rows, **wanted):
    found = select(rows, **wanted)
    if len(found) != 1:
        raise SystemExit(f"report: {len(found)} rows for {wanted}")
    return found[0]


def mean(numbers):
    numbers = [n for n in numbers if math.isfinite(n)]
    return sum(numbers) / len(numbers) if numbers else math.nan


def front(points):
    """Those of (cost, quality, row) that no other beats in both, by cost."""
    best, kept = -math.inf, []
    for point in sorted(points, key=lambda p: (p[0], -p[1])):
        if point[1] > best:
            kept.append(point)
            best = point[1]
    return kept


def base_of(rows, axis, at):
    """Rows of a one-at-a-time part in which only this axis differs from the longest words, the longest included."""
    longest = {"subtexel_bits": 8, "level_bits": 8, "blend_bits": 16, "coordinate_bits": 16, "offset_bits": 31, "reciprocal_bits": 30, "tolerance_bits": 16}
    others = {name: value for name, value in longest.items() if name != axis}
    return sorted(select(rows, scene=at, **others), key=lambda row: row[axis])


def least_bits(rows, axis, scenes, good):
    """Fewest bits from which on good(row, longest row) holds on all scenes; None if it never does."""
    needed = 0
    for scene in scenes:
        line = base_of(rows, axis, scene)
        least = None
        for row in reversed(line):
            if not good(row, line[-1]):
                break
            least = row[axis]
        if least is None:
            return None
        needed = max(needed, least)
    return needed


def loses_at_most_a_tenth_db(row, longest):
    return row["psnr_db"] >= longest["psnr_db"] - 0.1


def within_one_lsb(row, _longest):
    return row["twin_worst_lsb"] <= 1


def within_256th_texel(row, _longest):
    return row["coordinate_worst_texels"] <= 1 / 256

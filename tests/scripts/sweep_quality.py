#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Quality of the standard study at zero tolerance: every 124th of its points, some of each part, is judged again, and each quality column must be the committed one to the last digit
(tools/baselines/standard_quality.csv). A change of quality is a commit of its own that says why:  make sweep && tests/scripts/sweep_quality.py --write build/sweeps/standard.csv
The subset must be done in two minutes of one processor, and the whole study, by what the subset took, in minutes of two."""
import csv
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"
SPEC, BASELINE = ROOT / "tools/sweeps/standard.json", ROOT / "tools/baselines/standard_quality.csv"
FIRST, LAST = "psnr_db", "twin_swim_lsb"  # of the quality columns
FIRST_POINT, STEP = 31, 124
MOST_SUBSET_S, MOST_STUDY_MINUTES = 120, 20  # processor time: the machine may have other work. A study of 20 minutes would be one to think about; it takes 3.


def quality(path):
    """Study, and by point its part and quality columns as texts."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    heading = rows[0]
    columns = range(heading.index(FIRST), heading.index(LAST) + 1)
    names = [heading[k] for k in columns]
    return rows[1][0], names, {int(row[2]): (row[1], [row[k] for k in columns]) for row in rows[1:]}


def write(record):
    study, names, points = quality(record)
    count = int(subprocess.run([str(BINARY), "sweep", str(SPEC), "--count"], check=True, capture_output=True, text=True).stdout)
    assert len(points) == count, f"{record}: {len(points)} of {count} points"
    BASELINE.parent.mkdir(exist_ok=True)
    lines = ["study,part,point," + ",".join(names)] + [f"{study},{part},{number}," + ",".join(values) for number, (part, values) in sorted(points.items())]
    BASELINE.write_text("\n".join(lines) + "\n")


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "--write":
        write(sys.argv[2])
        return 0
    study, names, wanted = quality(BASELINE)
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "subset.csv"
        subprocess.run([str(BINARY), "sweep", str(SPEC), "--job", f"{FIRST_POINT}/{STEP}", "--threads", "2", "--out", str(out)], check=True, capture_output=True)
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        now, _, points = quality(out)
    seconds = used.ru_utime + used.ru_stime
    minutes = seconds * STEP / 2 / 60  # too much: neighbours in the study share a reference, here each point makes its own
    if now != study:
        print("the standard study has other points or columns than its committed quality: see this script's first lines")
        return 1
    parts, different = set(), 0
    for number, (part, values) in points.items():
        parts.add(part)
        for name, value, was in zip(names, values, wanted[number][1]):
            if value != was:
                different += 1
                print(f"point {number} ({part}): {name} is {value or 'empty'}, was {was or 'empty'}")
    missing = {part for part, _ in wanted.values()} - parts
    print(f"{len(points)} of {len(wanted)} points, {len(names)} columns: {different} different" + (f"; no point of {', '.join(sorted(missing))}" if missing else ""))
    slow = seconds > MOST_SUBSET_S or minutes > MOST_STUDY_MINUTES
    print(f"{seconds:.1f} s of a processor: the study takes at most {minutes:.1f} minutes of two" + (", which is too long" if slow else ""))
    return 1 if different or missing or slow else 0


if __name__ == "__main__":
    sys.exit(main())

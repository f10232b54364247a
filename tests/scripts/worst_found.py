#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docs/ACCURACY.md tells the truth about the worst found: each case that its last table names reproduces, in today's code, the part of the bound that the table of stages prints
for its profile, to the last digit, and nothing in it fails; the promises' column of what was found is that of the stages.
tests/scripts/worst_found.py --write build/stress   puts what `make stress` found (exact.txt, ...) into all three; profiles without a file
keep what stands there."""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"
DOCUMENT = ROOT / "docs/ACCURACY.md"
PROFILES = ["exact", "default", "compact", "seed"]
PART, STAGES, CASES = "## Worst found", "| stage (unit) | ", "| stage | "
# What the document's first table promises, and the stages that say what was found.
PROMISES = {"texture coordinate": ["u, v: affine", "u, v: series", "u, v: divide", "u, v: pixel"], "level of detail: Jacobian": ["level: Jacobian"],
            "level of detail: KT88": ["level: major axis"], "colour": ["colour"]}


def lines_of(text, head):
    """The first table with such a head, after the heading of the part."""
    return text[text.index(head, text.index(PART)):].split("\n\n")[0].splitlines()


def stage_of(row):
    return re.sub(r" \(.*", "", row[0])


def rows_of(text, head):
    return [[c.strip() for c in line.strip("|").split("|")] for line in lines_of(text, head)[2:]]


def table(text, head):
    """{(stage, profile): cell}"""
    return {(stage_of(row), p): cell for row in rows_of(text, head) for p, cell in zip(PROFILES, row[1:], strict=True)}


def number(text):
    return 1 / float(text[2:]) if text.startswith("1/") else 2 ** float(text[2:]) if text.startswith("2^") else float(text)


def promised(text):
    """Lines of the first table by stage list, with the columns of what was found in `exact` and `default`."""
    for line in text[:text.index("Notation:")].splitlines():
        for name, stages in PROMISES.items():
            if line.startswith(f"| {name}"):
                yield line, stages


def found_of(found, stages):
    """What the last column of a promise must say."""
    largest = [max((found[s, p].split()[0].rstrip(",") for s in stages), key=number) for p in PROFILES[:2]]
    return ", ".join(largest)


def judge(text):
    found, cases, failed = table(text, STAGES), table(text, CASES), 0
    if set(found) != set(cases) or len(cases) < 60:
        print(f"not in both tables: {sorted(set(found) ^ set(cases))}")
        return 1
    for (stage, profile), cell in cases.items():
        family, case = cell.split()
        run = subprocess.run([str(BINARY), "stress", "--profile", profile, "--family", family, "--case", case], capture_output=True, text=True)
        line = re.search(rf"(?m)^  {re.escape(stage)} +\d+ judged, worst (\S+) of (\S+) ", run.stdout)
        share = f"{100 * float(line[1]) / float(line[2]):.1f} %" if line else "not judged"
        if run.returncode != 0 or found[stage, profile].rsplit(", ", 1)[-1] != share:
            failed += 1
            print(f"{profile}, {stage}: {cell} is {share}, exit code {run.returncode}; the table says {found[stage, profile]} {run.stderr}")
    promises = list(promised(text))
    assert len(promises) == len(PROMISES)
    for line, stages in promises:
        if line.strip("| ").split(" | ")[-1].removesuffix(" LSB") != found_of(found, stages):
            failed += 1
            print(f"promised: {line}\nfound: {found_of(found, stages)}")
    print(f"{len(cases)} cases, {len(promises)} promises, {failed} not as the document says")
    return 1 if failed else 0


def written(text, folder):
    stages, found, cases = [r[0] for r in rows_of(text, STAGES)], table(text, STAGES), table(text, CASES)
    for p in PROFILES:
        if not (folder / f"{p}.txt").exists():
            continue
        said = (folder / f"{p}.txt").read_text(encoding="utf-8")
        for stage in stages:
            name = stage_of([stage])
            unit = r"half units|\S*"
            line = re.search(rf"(?m)^{re.escape(name)} +\d+  (?:{unit}) +(\S+) +(\S+) +(\S+) % +\d+  --family (\S+) --case (\d+)$", said)
            largest, bound, share, family, case = line.groups()
            found[name, p] = f"{largest}{'' if bound == 'place' else ' of ' + bound}, {share} %"
            cases[name, p] = f"{family} {case}"
    for head, cells in ((STAGES, found), (CASES, cases)):
        old = lines_of(text, head)
        names = stages if head == STAGES else [stage_of([s]) for s in stages]
        new = old[:2] + ["| " + " | ".join([name] + [cells[stage_of([name]), p] for p in PROFILES]) + " |" for name in names]
        text = text.replace("\n".join(old), "\n".join(new))
    for line, of in list(promised(text)):
        unit = " LSB" if line.endswith("LSB |") else ""
        text = text.replace(line, line.rsplit("| ", 1)[0] + f"| {found_of(found, of)}{unit} |")
    return text


def main():
    text = DOCUMENT.read_text(encoding="utf-8")
    if sys.argv[1:2] == ["--write"]:
        text = written(text, pathlib.Path(sys.argv[2]))
        DOCUMENT.write_text(text, encoding="utf-8")
    return judge(text)


if __name__ == "__main__":
    sys.exit(main())

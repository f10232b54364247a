#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docs/FINDINGS.md tells the truth about `default` and `compact`: the points that justify them are judged again, their tables must be those in the document to the last digit, and
what the document concludes from them must hold.   tests/scripts/findings.py --write   puts the tables into the document."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
from reporting import justify, record  # noqa: E402

BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"
SPEC, DOCUMENT = ROOT / "tools/sweeps/justify.json", ROOT / "docs/FINDINGS.md"


def judged():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "justify.csv"
        subprocess.run([str(BINARY), "sweep", str(SPEC), "--threads", "2", "--out", str(out)], check=True, capture_output=True)
        rows = record.load(out)
    spec = json.loads(SPEC.read_text())
    return {part["name"]: justify.changes(rows, part, spec) for part in spec["parts"]}


def place_of(text, name):
    begin, end = f"<!-- {name}: written by tests/scripts/findings.py -->\n", f"\n<!-- end of {name} -->"
    return text.index(begin) + len(begin), text.index(end)


def conclusions(default, compact):
    """(what the document says, whether it holds)"""
    base, exact, small = default["default"], default["profile = exact"], compact["compact"]
    d, c = default.__getitem__, compact.__getitem__
    return [
        ("default: within 1/256 texel, 1/128 level, 1 LSB", base.coordinate <= 1 / 256 and base.level <= 1 / 128 and base.worst_lsb <= 1),
        ("default: no PSNR lost against exact at 60 % of its product bits", base.psnr_db > exact.psnr_db - 0.01 and base.product_bits < 0.6 * exact.product_bits),
        ("7 weight bits are the fewest for 1 LSB", d("subtexel_bits = 6").worst_lsb > 1),
        ("7 level bits are the fewest for 1 LSB", d("level_bits = 6").worst_lsb > 1 >= d("level_bits = 7").worst_lsb and d("level_bits = 6").level > 1 / 128 >= d("level_bits = 7").level),
        ("kept bits between levels do not show", d("blend_bits = 0").worst_lsb <= 1 and abs(d("blend_bits = 0").psnr_db - base.psnr_db) < 0.1),
        ("numerators of 27 bits and 1/w of 26 measure as 31 and 30", abs(d("offset_bits = 27").coordinate - base.coordinate) < 1e-5 and abs(d("reciprocal_bits = 26").coordinate - base.coordinate) < 1e-5),
        ("numerators of 23 bits or 1/w of 22 keep 1/256", d("offset_bits = 23").coordinate <= 1 / 256 and d("reciprocal_bits = 22").coordinate <= 1 / 256),
        ("a tolerance of 6 bits keeps 1/256, 4 do not, 12 cost half as much again", d("tolerance_bits = 6").coordinate <= 1 / 256 < d("tolerance_bits = 4").coordinate
         and d("tolerance_bits = 12").product_bits > 1.5 * base.product_bits),
        ("16 texels a side: 8 cost half as many cycles again, 32 save less than a twentieth", d("fine_side = 8").cycles > 1.45 * base.cycles and d("fine_side = 32").cycles > 0.95 * base.cycles
         and d("fine_side = 8").psnr_db == d("fine_side = 32").psnr_db == base.psnr_db),
        ("split is the only policy within 1 LSB", min(d("overflow = coarser").worst_lsb, d("overflow = clamp").worst_lsb) > 10),
        ("one level a span shows", d("scope = span").worst_lsb > 10),
        ("KT88's major axis blurs by more than 5 dB", d("formula = major").psnr_db < base.psnr_db - 5),
        ("a level finer gains more than 6 dB and costs more than half the cycles", d("level_bias = -16").psnr_db > base.psnr_db + 6 and d("level_bias = -16").cycles > 1.5 * base.cycles),
        ("half a level finer gains more than 3 dB for a quarter more cycles", d("level_bias = -8").psnr_db > base.psnr_db + 3 and d("level_bias = -8").cycles < 1.25 * base.cycles),
        ("truncated colours cost, halves of positions hardly", d("colour_rounding = floor").psnr_db < base.psnr_db - 0.05 and d("position_rounding = floor").psnr_db > base.psnr_db - 0.02),
        ("compact: no long products at half of default's product bits", small.long_products == 0 and small.product_bits < 0.5 * base.product_bits),
        ("compact: one bit more of either word brings long products", c("offset_bits = 19").long_products > 0 and c("reciprocal_bits = 18").long_products > 0),
        ("compact: its policy loses 3.5 dB, not its words", c("overflow = split").psnr_db > small.psnr_db + 3.4 and c("overflow = split").psnr_db > base.psnr_db - 0.02
         and c("offset_bits = 23").psnr_db < small.psnr_db + 0.02 and c("subtexel_bits = 8").psnr_db < small.psnr_db + 0.02),
        ("compact: clamping is worse than a coarser level", c("overflow = clamp").psnr_db < small.psnr_db - 1),
        ("compact: splitting costs two thirds more cycles and four times the words", 1.6 < c("overflow = split").cycles / small.cycles < 1.75 and 4 < c("overflow = split").words / small.words < 4.5),
    ]


def main():
    found = judged()
    text = DOCUMENT.read_text(encoding="utf-8")
    writes, wrong = sys.argv[1:] == ["--write"], []
    for name, changes in found.items():
        begin, end = place_of(text, name)
        table = justify.table(changes)
        if text[begin:end] != table:
            wrong += [f"{name}: {line}" for line in table.splitlines() if line not in text[begin:end].splitlines()] or [f"{name}: other lines"]
        text = text[:begin] + table + text[end:]
    if writes:
        DOCUMENT.write_text(text, encoding="utf-8")
        wrong = []
    claims = conclusions(found["default"], found["compact"])
    wrong += [f"does not hold: {claim}" for claim, holds in claims if not holds]
    for line in wrong:
        print(line)
    print(f"{sum(len(c) for c in found.values())} changes of {len(found)} profiles, {len(claims)} conclusions: {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

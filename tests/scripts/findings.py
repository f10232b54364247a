#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docs/FINDINGS.md tells the truth. About `default` and `compact`: the points that justify them are judged again. About the standard study: its committed quality columns
(tools/baselines/standard_quality.csv, which scripts.sweep_quality compares with what the code does now). The tables must be those in the document to the last digit, and what the document concludes
must hold.   tests/scripts/findings.py --write   puts the tables into the document."""
import csv
import io
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
STANDARD, BASELINE = ROOT / "tools/sweeps/standard.json", ROOT / "tools/baselines/standard_quality.csv"


def judged():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "justify.csv"
        subprocess.run([str(BINARY), "sweep", str(SPEC), "--threads", "2", "--out", str(out)], check=True, capture_output=True)
        rows = record.load(out)
    spec = json.loads(SPEC.read_text())
    return {part["name"]: justify.changes(rows, part, spec) for part in spec["parts"]}


def standard_study():
    """Rows of the standard study, axes and quality: what each point is, and what the baseline says that it is worth."""
    points = subprocess.run([str(BINARY), "sweep", str(STANDARD), "--points"], check=True, capture_output=True, text=True).stdout
    with open(BASELINE, newline="", encoding="utf-8") as file:
        worth = list(csv.reader(file))
    lines = [point + worth[k][3:] for k, point in enumerate(csv.reader(io.StringIO(points)))]
    assert len(lines) == len(worth) and all(line[:3] == w[:3] for line, w in zip(lines, worth)), "the baseline is of another study"
    return record.rows_of(lines)


def words_table(study):
    parts = [record.select(study, part=name) for name in ("words", "words_near")]
    questions = (record.loses_at_most_a_tenth_db, record.within_one_lsb, record.within_256th_texel)
    names = {"subtexel_bits": "sub-texel (weight) bits", "level_bits": "level bits", "blend_bits": "bits kept between levels", "coordinate_bits": "coordinate fraction bits",
             "offset_bits": "numerator (offset) bits", "reciprocal_bits": "1/w bits", "tolerance_bits": "tolerance bits"}
    lines = ["| word | 0.1 dB far / near | 1 LSB far / near | 1/256 texel far / near |", "|---|---|---|---|"]
    for axis, name in names.items():
        needed = [[record.least_bits(rows, axis, record.values(rows, "scene"), good) for rows in parts] for good in questions]
        lines.append(f"| {name} | " + " | ".join("-" if k == 2 and axis not in record.WORDS_OF_COORDINATES else " / ".join(map(str, bits)) for k, bits in enumerate(needed)) + " |")
    return "\n".join(lines)


def best_bias(study, **wanted):
    """Mean PSNR over the scenes by bias, sixteenths."""
    rows = record.select(record.select(study, part="levels"), **wanted)
    return {bias: record.mean([r["psnr_db"] for r in record.select(rows, level_bias=bias)]) for bias in record.values(rows, "level_bias")}


def levels_table(study):
    prefilters = ("box", "triangle", "kaiser", "lanczos")
    lines = ["| formula | " + " | ".join(prefilters) + " |", "|---|" + "---|" * len(prefilters)]
    for formula in ("jacobian", "major", "minor"):
        cells = []
        for name in prefilters:
            by_bias = best_bias(study, filter="trilinear", formula=formula, prefilter=name)
            best = max(by_bias, key=by_bias.get)
            cells.append(f"{by_bias[0]:.1f}, {by_bias[best]:.1f} at {best / 16:g}")
        lines.append(f"| {formula} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def swim(study, profile, filter_name, measure="swim_lsb"):
    return record.mean([r[measure] for r in record.select(study, part="motion", profile=profile, filter=filter_name)])


def motion_table(study):
    filters = ("nearest", "bilinear", "mip-bilinear", "trilinear", "aniso")
    lines = ["| | " + " | ".join(filters) + " |", "|---|" + "---|" * len(filters)]
    for profile in ("seed", "compact", "default", "exact"):
        lines.append(f"| {profile} | " + " | ".join(f"{swim(study, profile, f):.1f} ({swim(study, profile, f, 'twin_swim_lsb'):.1f})" for f in filters) + " |")
    return "\n".join(lines)


def study_conclusions(study):
    """What the document says of the standard study's quality, and whether it holds."""
    def worst(part, axis, scene):
        return [r["twin_worst_lsb"] for r in record.base_of(record.select(study, part=part), axis, scene)]

    def at(part, **wanted):
        return record.one(record.select(study, part=part), **wanted)["psnr_db"]

    def angle(pitch, filter_name, texels=0):
        return at("angle", filter=filter_name, minification_16=16 * texels, pitch_degrees=pitch)

    def memory(scene, side, policy):
        return at("local_memory", scene=scene, fine_side=side, overflow=policy, filter="trilinear", scope="pixel", port_words=4)

    def moving(scene, bias):
        rows = record.select(study, part="bias_in_motion", scene=scene, prefilter="box", level_bias=bias)
        return [f"{record.one(rows, motion=m)['swim_lsb']:.2f}" for m in ("pan", "zoom")]

    jacobian, major = best_bias(study, filter="trilinear", formula="jacobian", prefilter="box"), best_bias(study, filter="trilinear", formula="major", prefilter="box")
    spans = [record.select(study, part="local_memory", filter="trilinear", overflow="split", fine_side=16, port_words=4, scope=s) for s in ("pixel", "span")]
    gains = [round(angle(p, "aniso") - angle(p, "trilinear"), 1) for p in (90, 75, 60, 45, 30, 20, 12, 8, 5, 3)]
    return [
        ("worst errors halve with every bit of weights: fig7, fig8", worst("words", "subtexel_bits", "fig7")[:7] == [48, 31, 15, 8, 4, 2, 2] and worst("words", "subtexel_bits", "fig8")[:7] == [56, 28, 11, 8, 3, 2, 1]),
        ("default, trilinear: 2 LSB on fig7 and the chessboard, 1 elsewhere", {r["scene"]: r["twin_worst_lsb"] for r in record.select(study, part="profiles", profile="default", filter="trilinear")}
         == {"facing": 1, "tilted": 1, "grazing": 1, "fig6": 1, "fig7": 2, "fig8": 1, "fig9": 1, "chessboard": 2}),
        ("halves to even or up: the same colours but for 0.01 LSB", all(abs(a["twin_rms_lsb"] - b["twin_rms_lsb"]) < 0.0125 for a, b in zip(
            record.select(study, part="roundings", position_rounding="nearest", colour_rounding="nearest"), record.select(study, part="roundings", position_rounding="even", colour_rounding="even")))),
        ("a level finer than Vulkan's gains 7 to 9 dB, half a level 4 to 5", 7 < jacobian[-16] - jacobian[0] < 9 and 4 < jacobian[-8] - jacobian[0] < 5),
        ("KT88's major axis biased by -2 is the Jacobian biased by -1", abs(major[-32] - jacobian[-16]) < 0.15),
        ("swim is least from -3/4 to -1", [moving("tilted", b) for b in (0, -12, -16, -32)] == [["0.88", "1.82"], ["0.67", "1.25"], ["0.68", "1.26"], ["1.30", "2.80"]]
         and [moving("grazing", b) for b in (0, -12, -16, -32)] == [["1.91", "2.87"], ["1.70", "2.23"], ["1.71", "2.18"], ["2.56", "3.45"]]),
        ("split: the size of local memory changes no picture", all(memory(s, 8, "split") == memory(s, 16, "split") == memory(s, 32, "split") for s in ("facing", "tilted", "grazing", "fig7", "fig8"))),
        ("16 texels: coarser loses 1.1 to 4.5 dB, clamp 0.1 to 15", all(1.1 <= round(memory(s, 16, "split") - memory(s, 16, "coarser"), 1) <= 4.5 and 0.1 <= memory(s, 16, "split") - memory(s, 16, "clamp") < 15.5
                                                                        for s in ("facing", "tilted", "grazing", "fig7", "fig8"))),
        ("one level a span costs 0.03 dB", max(p["psnr_db"] - s["psnr_db"] for p, s in zip(*spans)) < 0.035),
        ("what aniso gains by angle", gains == [0.0, -0.9, 1.1, 2.8, 10.1, 18.8, 10.9, 9.9, 10.8, 9.8]),
        ("hat at 20 degrees: 6 dB before trilinear, 13 behind aniso", round(angle(20, "hat") - angle(20, "trilinear")) == 6 and round(angle(20, "aniso") - angle(20, "hat")) == 13),
        ("three points: 20 dB and more behind on a magnified random map", at("points", map="random", filter="three-point", minification_16=-64) < at("points", map="random", filter="bilinear", minification_16=-64) - 20),
        ("the bias took trilinear from 2.8 LSB of swim to 2.2", round(swim(study, "default", "trilinear"), 1) == 2.2),
    ]


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
        ("8 level bits are the fewest for 1 LSB, 7 for 1/128 level", d("level_bits = 7").worst_lsb > 1 >= base.worst_lsb and d("level_bits = 6").level > 1 / 128 >= d("level_bits = 7").level),
        ("kept bits between levels hardly show", d("blend_bits = 0").worst_lsb <= 2 and abs(d("blend_bits = 0").psnr_db - base.psnr_db) < 0.1),
        ("numerators of 27 bits and 1/w of 26 measure as 31 and 30", abs(d("offset_bits = 27").coordinate - base.coordinate) < 1e-5 and abs(d("reciprocal_bits = 26").coordinate - base.coordinate) < 1e-5),
        ("numerators of 23 bits or 1/w of 22 keep 1/256", d("offset_bits = 23").coordinate <= 1 / 256 and d("reciprocal_bits = 22").coordinate <= 1 / 256),
        ("a tolerance of 6 bits keeps 1/256, 4 do not, 12 cost half as much again", d("tolerance_bits = 6").coordinate <= 1 / 256 < d("tolerance_bits = 4").coordinate
         and d("tolerance_bits = 12").product_bits > 1.5 * base.product_bits),
        ("16 texels a side: 8 cost two thirds as many cycles again, 32 save less than a tenth", d("fine_side = 8").cycles > 1.65 * base.cycles and d("fine_side = 32").cycles > 0.9 * base.cycles
         and d("fine_side = 8").psnr_db == d("fine_side = 32").psnr_db == base.psnr_db),
        ("split is the only policy within 1 LSB", min(d("overflow = coarser").worst_lsb, d("overflow = clamp").worst_lsb) > 10),
        ("one level a span shows", d("scope = span").worst_lsb > 10),
        ("KT88's major axis blurs by more than 5 dB", d("formula = major").psnr_db < base.psnr_db - 5),
        ("without its bias of the level more than 3.5 dB less for a sixth of the cycles; half the bias, half the gain", d("mip_bias = 0").psnr_db < base.psnr_db - 3.5
         and d("mip_bias = 0").cycles > 0.82 * base.cycles and d("mip_bias = -4").psnr_db < base.psnr_db - 1.3),
        ("truncated colours cost, halves of positions hardly", d("colour_rounding = floor").psnr_db < base.psnr_db - 0.05 and d("position_rounding = floor").psnr_db > base.psnr_db - 0.02),
        ("compact: no long products at half of default's product bits", small.long_products == 0 and small.product_bits < 0.5 * base.product_bits),
        ("compact: one bit more of either word brings long products", c("offset_bits = 19").long_products > 0 and c("reciprocal_bits = 18").long_products > 0),
        ("compact: its policy loses 3.5 dB, not its words", c("overflow = split").psnr_db > small.psnr_db + 3.4 and c("overflow = split").psnr_db > d("mip_bias = 0").psnr_db - 0.02
         and c("offset_bits = 23").psnr_db < small.psnr_db + 0.02 and c("subtexel_bits = 8").psnr_db < small.psnr_db + 0.02),
        ("compact: a bias of the level loses", c("mip_bias = -8").psnr_db < small.psnr_db),
        ("compact: clamping is worse than a coarser level", c("overflow = clamp").psnr_db < small.psnr_db - 1),
        ("compact: splitting costs two thirds more cycles and four times the words", 1.6 < c("overflow = split").cycles / small.cycles < 1.75 and 4 < c("overflow = split").words / small.words < 4.5),
    ]


def main():
    found, study = judged(), standard_study()
    text = DOCUMENT.read_text(encoding="utf-8")
    tables = {name: justify.table(changes) for name, changes in found.items()} | {"words": words_table(study), "levels": levels_table(study), "motion": motion_table(study)}
    writes, wrong = sys.argv[1:] == ["--write"], []
    for name, table in tables.items():
        begin, end = place_of(text, name)
        if text[begin:end] != table:
            wrong += [f"{name}: {line}" for line in table.splitlines() if line not in text[begin:end].splitlines()] or [f"{name}: other lines"]
        text = text[:begin] + table + text[end:]
    if writes:
        DOCUMENT.write_text(text, encoding="utf-8")
        wrong = []
    claims = conclusions(found["default"], found["compact"]) + study_conclusions(study)
    wrong += [f"does not hold: {claim}" for claim, holds in claims if not holds]
    for line in wrong:
        print(line)
    print(f"{sum(len(c) for c in found.values())} changes of {len(found)} profiles, {len(study)} points of the standard study, {len(tables)} tables, {len(claims)} conclusions: {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""spantex sweep: what is refused and how, that rows do not depend on threads, jobs or interruptions, that a run goes on where one ended, and that what it measures is measured:
pictures that are equal have no error, worse machines have more."""
import json
import math
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from reporting import record  # noqa: E402
from spantex_command import BINARY, run  # noqa: E402

GOOD = {"name": "t", "size": "64x48", "scenes": ["tilted", "fig8"], "measures": ["picture", "twin", "coordinates", "cost"],
        "parts": [{"name": "grid", "axes": {"subtexel_bits": [2, 8], "filter": ["nearest", "trilinear"]}},
                  {"name": "steps", "sample": "one-at-a-time", "base": {"profile": "exact"}, "axes": {"level_bits": [2, 8], "offset_bits": {"from": 13, "to": 31, "step": 9}}},
                  {"name": "cloud", "sample": "random", "points": 5, "axes": {"fine_side": [8, 16, 32], "reciprocal_bits": {"from": 12, "to": 30}}}]}


def write(folder, text):
    path = folder / "spec.json"
    path.write_text(text if isinstance(text, str) else json.dumps(text, indent=1))
    return path


REFUSED = [  # what is replaced in GOOD as it is written, what it is replaced by, what the message must say; the line is found by the replacement
    ('"size": "64x48"', '"size": "64"', "64"), ('"size": "64x48"', '"size": "8x8"', "16 to 1024"), ('"size": "64x48"', '"sizes": "64x48"', "unknown 'sizes'"),
    ('"name": "grid"', '"name": "cloud"', "part 'cloud' twice"), ('"nearest"', '"cubic"', "filter: unknown 'cubic'"), ('"points": 5', '"points": 0', "'points' must be"),
    ('"random"', '"sobol"', "unknown sample 'sobol'"), ('"to": 31', '"to": 32', "offset_bits: 32 is outside 12..31"), ('"to": 31', '"to": 12', "holds nothing"),
    ('"step": 9', '"step": 0', "'step' must be"), ('"fig8"', '"fig88"', "scene: unknown 'fig88'"), ('"fig8"', '"tilted"', "'tilted' twice"),
    ('"cost"', '"price"', "unknown measure 'price'"), ('"profile": "exact"', '"profile": "best"', "profile: unknown 'best'"), ('"fine_side"', '"weight_bits"', "vary subtexel_bits"),
    ('"fine_side"', '"fine_sides"', "unknown axis 'fine_sides'"), ('"profile": "exact"', '"profile": 3.5', "must be a whole number"), ('"profile": "exact"', '"motion": "pan"', "scene fig8 has no motion 'pan'"),
    ('"subtexel_bits": [\n     2,', '"subtexel_bits": [\n     "02",', "'02' is not a whole number"), ('"level_bits": [\n     2,', '"level_bits": [\n     NaN,', "not JSON"),
    ('"subtexel_bits": [\n     2,', '"subtexel_bits": [\n     2.5,', "must be a whole number"), ('"subtexel_bits": [\n     2,', '"subtexel_bits": [\n     99999999999999999999,', "must be a whole number"),
    ('"profile": "exact"', '"scene": "fig8"', "listed under 'scenes'"), ('"cost"', '"twin"', "measure 'twin' twice"), ('"name": "grid"', '"name": "a\\u0000b"', "control character"),
    ('"name": "t"', '"name": 5', "'name' must be a text"), ('"fine_side"', '"fine\\nside"', "unknown axis 'fine?side'"), ('"points": 5', '"points": ' + "[" * 50000, "brackets deeper than 64"),
    ('"points": 5', '"points": ' + "[" * 60, "not JSON at '..."),
    ('"profile": "exact"', '"map": "missing.png"', "missing.png"), ('"points": 5', '"points": 5,,', "not JSON"), ('"points": 5', '"points": 5, "points": 6', "'points' twice"),
]


def refusals(folder):
    text = json.dumps(GOOD, indent=1)
    out = folder / "none.csv"
    for old, new, reason in REFUSED:
        assert text.count(old) >= 1, old
        broken = text.replace(old, new, 1)
        done = run("sweep", write(folder, broken), "--out", out)
        where = done.stderr.split(":")
        assert done.returncode == 2 and reason in done.stderr and done.stderr.count("\n") == 1, (old, done)
        assert not out.exists(), (old, "left a record")
        assert where[1].strip() == str(folder / "spec.json") and where[2].isdigit(), done.stderr
        line = int(where[2])
        near = [k for k, shown in enumerate(broken.splitlines(), 1) if new.split(",")[0].split(" ")[-1] in shown]
        assert any(abs(line - k) <= 4 for k in near) or "part" in reason or "motion" in reason, (old, line, near)
    for more in ((), ("--out", out, "--count"), ("--out", out, "--job", "3/2"), ("--out", out, "--job", "x"), ("--out", out, "--threads", "0"), ("--out", folder)):
        done = run("sweep", write(folder, GOOD), *more)
        assert done.returncode == 2 and done.stderr.count("\n") == 1, (more, done)


def exact_line(folder):
    done = run("sweep", write(folder, '{"name": "x",\n "parts": [\n  {"name": "a",\n   "axes": {\n    "level_bits": 9\n   }}]}\n'), "--count")
    assert done.stderr == f"spantex: {folder}/spec.json:5: level_bits: 9 is outside 1..8\n", done.stderr
    done = run("sweep", write(folder, '{"name": "x",\n "parts": [\n  {"name": "a",,\n'), "--count")
    assert done.stderr.startswith(f"spantex: {folder}/spec.json:3: not JSON"), done.stderr


def the_same_rows(folder):
    spec = write(folder, GOOD)
    count = int(run("sweep", spec, "--count").stdout)
    assert count == 2 * (4 + 4 + 5), count
    one, two, again = folder / "one.csv", folder / "two.csv", folder / "again.csv"
    assert run("sweep", spec, "--out", one).returncode == 0
    assert run("sweep", spec, "--out", two, "--threads", 3).returncode == 0
    whole = one.read_bytes()
    assert two.read_bytes() == whole, "rows depend on threads"
    for kept in (0, 1, 40, len(whole) // 2, len(whole) - 1):  # cut anywhere: a torn row, a torn heading, nothing at all
        again.write_bytes(whole[:kept])
        done = run("sweep", spec, "--out", again)
        assert done.returncode == 0 and again.read_bytes() == whole, (kept, done)
        lost = count - max(0, whole[:kept].count(b"\n") - 1)
        assert f"{count} points, {lost} of them judged now" in done.stdout, (kept, done.stdout)
    before = one.stat().st_mtime_ns
    assert "0 of them judged now" in run("sweep", spec, "--out", one).stdout and one.stat().st_mtime_ns == before
    other = write(folder, dict(GOOD, size="64x56"))
    done = run("sweep", other, "--out", one)
    assert done.returncode == 2 and "another study" in done.stderr and one.read_bytes() == whole, done
    note, spec = folder / "note.csv", write(folder, GOOD)
    heading = whole[:whole.index(b"\n")]
    for text in (b"dear diary\n", b"dear diary", heading + b",", heading + b"\nmy remark", whole + b"my remark", b"\n"):  # not one of them is what a cut write leaves
        note.write_bytes(text)
        done = run("sweep", spec, "--out", note)
        assert done.returncode == 2 and done.stderr.count("\n") == 1 and note.read_bytes() == text, (text[-20:], done)
    before_text = spec.read_bytes()
    assert run("sweep", spec, "--out", spec).returncode == 2 and spec.read_bytes() == before_text, "the specification itself as the record"
    assert "directory" in run("sweep", spec, "--merge", folder, "--out", note).stderr
    with open("/dev/full", "w") as full:
        done = subprocess.run([str(BINARY), "sweep", str(spec), "--points"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1, done
    listed = [line.split(",") for line in run("sweep", spec, "--points").stdout.splitlines()]
    assert listed == [line.split(",")[:len(listed[0])] for line in whole.decode().splitlines()], "--points says other points than were judged"
    return record.load(one)


def merging_takes_what_is_read(folder):
    """One row of a study of 10^9 points, with an address space in which a byte a point has no room; not under the address sanitizer, whose shadow memory alone is larger."""
    limit = None if os.environ.get("SPANTEX_SANITIZED") else lambda: resource.setrlimit(resource.RLIMIT_AS, (512 << 20, 512 << 20))
    spec = write(folder, {"name": "t", "size": "64x48", "parts": [{"name": "a", "sample": "random", "points": 10**9, "axes": {"subtexel_bits": [1, 2]}}]})
    heading = (folder / "one.csv").read_text().splitlines()[0]
    point = run("sweep", spec, "--points", "--job", "1/9999999").stdout.splitlines()[1]
    (folder / "part.csv").write_text(heading + "\n" + point + "," * (heading.count(",") - point.count(",")) + "\n")
    done = subprocess.run([str(BINARY), "sweep", str(spec), "--merge", "part.csv", "--out", "merged.csv"], capture_output=True, text=True, cwd=folder, preexec_fn=limit)
    assert (done.returncode, done.stderr) == (2, "spantex: merged.csv: 999999999 of 1000000000 points are missing, the first is 1: nothing written\n"), done


def killed_and_continued(folder, whole):
    spec, out = write(folder, dict(GOOD, size="160x120")), folder / "killed.csv"
    reference = folder / "reference.csv"
    assert run("sweep", spec, "--out", reference).returncode == 0
    kills = 0
    for delay in (0.15, 0.3, 0.45):
        with subprocess.Popen([str(BINARY), "sweep", str(spec), "--out", str(out)], stdout=subprocess.DEVNULL) as worker:
            time.sleep(delay)
            kills += worker.poll() is None
            worker.send_signal(signal.SIGKILL)
    assert kills > 0, "no run was there to be killed"
    assert run("sweep", spec, "--out", out).returncode == 0 and out.read_bytes() == reference.read_bytes()
    assert whole != reference


def measures(rows):
    grid = record.select(rows, part="grid", scene="tilted", filter="trilinear")
    coarse, fine = record.one(grid, subtexel_bits=2), record.one(grid, subtexel_bits=8)
    assert coarse["psnr_db"] < fine["psnr_db"] and coarse["ssim"] < fine["ssim"] and coarse["oklab"] > fine["oklab"]
    assert coarse["twin_rms_lsb"] > fine["twin_rms_lsb"] and coarse["twin_worst_lsb"] > fine["twin_worst_lsb"] and coarse["product_bits_per_pixel"] < fine["product_bits_per_pixel"]
    assert coarse["coordinate_worst_texels"] == fine["coordinate_worst_texels"] <= 1 / 256
    steps = record.select(rows, part="steps", scene="tilted")
    base, short, few = (record.one(steps, level_bits=l, offset_bits=o) for l, o in ((8, 31), (8, 13), (2, 31)))
    assert base["coordinate_worst_texels"] < 1 / 512 < short["coordinate_worst_texels"] and base["level_worst"] < 1 / 256 < 1 / 16 < few["level_worst"]
    assert base["words_per_pixel"] > 0 and base["cycles_per_pixel"] >= 1 and math.isnan(base["ns_per_pixel"])
    assert base["memory_bits"] - short["memory_bits"] == 2 * 6 * 18 and base["word_bits"] - short["word_bits"] == 18
    nearest = record.select(rows, part="grid", filter="nearest")
    assert all(math.isnan(row["level_worst"]) for row in nearest)


def equal_pictures_have_no_error(folder):
    spec = write(folder, {"name": "t", "size": "64x48", "base": {"profile": "exact", "evaluation": "divide", "tolerance_bits": 16, "motion": "pan", "frames": 3},
                          "measures": ["twin", "motion"], "parts": [{"name": "a", "axes": {"filter": ["trilinear", "aniso", "hat"]}}]})
    assert run("sweep", spec, "--out", folder / "twin.csv").returncode == 0
    for row in record.load(folder / "twin.csv"):
        assert row["twin_psnr_db"] == math.inf and row["twin_worst_lsb"] == 0 and row["twin_swim_lsb"] == 0 < row["swim_lsb"] and math.isnan(row["border_ratio"]), row


def banks_and_ports_cost_cycles_only(folder):
    spec = write(folder, {"name": "t", "size": "64x48", "measures": ["picture", "cost"], "parts": [{"name": "a", "axes": {"banks": ["parity", "columns"], "port_words": [1, 4], "halves": [1, 2]}}]})
    assert run("sweep", spec, "--out", folder / "banks.csv").returncode == 0
    rows = record.load(folder / "banks.csv")
    assert len({row["psnr_db"] for row in rows}) == 1
    by = {(row["banks"], row["port_words"], row["halves"]): row for row in rows}
    assert by["columns", 4, 2]["cycles_per_pixel"] > by["parity", 4, 2]["cycles_per_pixel"] < by["parity", 4, 1]["cycles_per_pixel"]
    assert by["parity", 4, 2]["conflicts_per_pixel"] == 0 < by["columns", 4, 2]["conflicts_per_pixel"] and by["parity", 1, 2]["stalls_per_pixel"] > by["parity", 4, 2]["stalls_per_pixel"]


def main():
    os.environ.pop("COLUMNS", None)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        refusals(folder)
        exact_line(folder)
        rows = the_same_rows(folder)
        measures(rows)
        merging_takes_what_is_read(folder)
        killed_and_continued(folder, rows)
        equal_pictures_have_no_error(folder)
        banks_and_ports_cost_cycles_only(folder)
    print(f"{len(REFUSED)} specifications refused; rows the same for threads, cuts and kills")
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""spantex bench-rig on simulated wires: identify, self-test, a picture equal to the simulator's in every profile and on narrow wires, a recording that the
simulator repeats, JSON and timeline that parse, rig files that are refused by name."""
import json
import pathlib
import sys
import tempfile

from spantex_command import run

LINES = {n: k for k, n in enumerate("D0 D1 D2 D3 D4 D5 D6 D7 clock direction command reset ready busy error".split())}
GOOD = {"chip": "no-such-chip", "lines": LINES}
BAD_RIGS = [
    ([], "object"), ({**GOOD, "colour": 1}, "colour"), ({"lines": LINES}, "chip"), ({"chip": "x"}, "lines"), ({**GOOD, "data_bits": 5}, "data_bits"),
    ({**GOOD, "lines": {**LINES, "D9": 20}}, "D9"), ({**GOOD, "lines": {**LINES, "busy": 3}}, "'3'"), ({**GOOD, "lines": {**LINES, "busy": -1}}, "busy"),
    ({**GOOD, "limits": {"attempts": 0}}, "attempts"), ({**GOOD, "limits": {"attempts": "many"}}, "attempts"), ({**GOOD, "settle_ns": 0}, "settle_ns"),
    ({**GOOD, "settle_ns": 2**64 - 1}, "settle_ns"), ({**GOOD, "limits": {"attempts": 10**30}}, "attempts"), ({**GOOD, "limits": {"step_ns": 1.5}}, "step_ns"),
    ({**GOOD, "limits": {"recoveries": True}}, "recoveries"), ({**GOOD, "limits": []}, "limits"), ({**GOOD, "lines": {**LINES, "busy": None}}, "busy"),
    ({**GOOD, "lines": {**LINES, "busy": 2**64 - 1}}, "busy"), ({**GOOD, "lines": {**LINES, "busy": "13"}}, "without quotes"), ({**GOOD, "chip": "a\0b"}, "'chip'"),
    ({**GOOD, "data_bits": 4}, "D4"), (GOOD, "no-such-chip"),
]
# As text: what Python's JSON cannot say.
BAD_TEXTS = [
    ("", "not JSON"), ("[" * 100000, "not JSON"), (json.dumps(GOOD)[:-1] + ', "chip": "other"}', "'chip' is there twice"),
    (json.dumps(GOOD).replace('"D1"', '"D0"'), "'D0' is there twice"), (json.dumps(GOOD) + "}", "not JSON"),
]


def expect(result, code, *words):
    text = result.stdout + result.stderr
    missing = [w for w in words if w not in text]
    if result.returncode != code or missing or (code == 2 and len(result.stderr.splitlines()) != 1):
        sys.exit(f"{' '.join(result.args)}\nexit code {result.returncode}, wanted {code}; missing: {missing}\n{text}")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        expect(run("bench-rig", "identify", "--simulated", "--profile", "seed", "--json", folder / "i.json"), 0, "profile         seed", "40 words")
        fields = f"profile i16 × {len(json.loads((folder / 'i.json').read_text())['profile'])},"
        if fields not in (pathlib.Path(__file__).resolve().parents[2] / "docs/BENCH.md").read_text():
            sys.exit(f"docs/BENCH.md does not say: {fields}")
        for bits in (8, 4):
            expect(run("bench-rig", "self-test", "--simulated", "--data-bits", bits), 0, "wires           sound", "0 retries")
        for profile in ("seed", "compact", "default", "exact"):
            for scene, kind in (("tilted", "trilinear"), ("fig8", "aniso")):
                drawing = [scene, "--size", "48x40", "--profile", profile, "--filter", kind]
                expect(run("render", *drawing, "--engine", "sim", "--out", folder / "wanted.png"), 0)
                bits = 4 if profile == "seed" else 8
                expect(run("bench-rig", "run", *drawing, "--simulated", "--data-bits", bits, "--out", folder / "got.png", "--json", folder / "j.json",
                           "--timeline", folder / "t.json", "--record", folder / "r.rec"), 0, ", 0 differ")
                if (folder / "got.png").read_bytes() != (folder / "wanted.png").read_bytes():
                    sys.exit(f"{scene}, {profile}: pictures differ")
                found, timeline = json.loads((folder / "j.json").read_text()), json.loads((folder / "t.json").read_text())
                if found["spans_differing"] or not found["spans"] or not found["words_per_second"] or not timeline["traceEvents"]:
                    sys.exit(f"{scene}, {profile}: JSON tells something else")
                expect(run("bench-rig", "replay", folder / "r.rec", "--profile", profile), 0, "operations as recorded")
        expect(run("bench-rig", "replay", folder / "r.rec", "--profile", "seed"), 1, "recorded")
        # One part of the device broken: span, pixel and stage are told, and the recording says the same to the simulator.
        for part, stage in (("coordinates", "coordinates or correction"), ("level", "level of detail"), ("fetch", "finer local memory"),
                            ("filter", "bilinear filter"), ("write-out", "write-out")):
            done = run("bench-rig", "run", "tilted", "--size", "16x8", "--filter", "trilinear", "--profile", "seed", "--simulated", "--broken", part,
                       "--json", folder / "j.json", "--record", folder / "r.rec")
            expect(done, 1, "first difference: operation", f"stage: {stage}")
            found = json.loads((folder / "j.json").read_text())["first_difference"]
            if found["stage"] != stage or found["text"] not in done.stdout:
                sys.exit(f"{part}: JSON says {found}")
            expect(run("bench-rig", "replay", folder / "r.rec", "--profile", "seed"), 1, found["text"].split(", stage")[0])
        expect(run("bench-rig", "run", "tilted", "--simulated", "--broken", "wheel"), 2, "wheel", "coordinates")
        for text, word in [(json.dumps(rig), word) for rig, word in BAD_RIGS] + BAD_TEXTS:
            (folder / "rig.json").write_text(text)
            expect(run("bench-rig", "identify", "--rig", folder / "rig.json"), 2, word)
    return 0


if __name__ == "__main__":
    sys.exit(main())

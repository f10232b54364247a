#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rows of a sweep are the same on another machine: every 248th point of the standard study (19, some of nearly every part) on arm64 under emulation, where products and sums of doubles are
contracted, against this machine's command: every column but ns_per_pixel, to the last digit. What judges is floating point, summed in a fixed order and printed to fewer digits than it has."""
import concurrent.futures
import csv
import io
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"
SPEC = "tools/sweeps/standard.json"
FIRST, STEP = 31, 248
COMPILER, EMULATOR = "aarch64-linux-gnu-g++", "qemu-aarch64"
NAMES = ("distance_field", "draw_host", "encode", "encode_bc", "encode_etc", "figures", "file", "float_sampler", "ideal", "inverse_filter", "map", "object_space_host", "pack", "palette",
         "occlusion", "pattern", "prefilter", "quality", "reference", "scene", "screen_filter", "sweep_judge", "sweep_subjects", "sweep_watch", "trace", "unchanged", "world")
SOURCES = ["tests/identity/sweep_rows.cpp", *(f"sim/{name}.cpp" for name in NAMES), *(f"tools/spantex/{name}.cpp" for name in ("options", "sweep_axes", "sweep_json", "sweep_record", "sweep_spec")),
           *sorted(str(p.relative_to(ROOT)) for p in (ROOT / "hal/kernels").glob("*.cpp"))]
# Headers without code of a machine: CLI11, nlohmann-json, stb.
FLAGS = ["-std=c++20", "-O1", "-Wno-psabi", "-I.", "-Ifirmware", "-idirafter", "/usr/include", "-idirafter", "/usr/include/stb"]


def run(*command):
    done = subprocess.run([str(c) for c in command], cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{command[0]} {command[-1]}: exit code {done.returncode}\n{done.stderr[-2000:]}")
    return done.stdout


def rows(text):
    return [{name: value for name, value in row.items() if name != "ns_per_pixel"} for row in csv.DictReader(io.StringIO(text))]


def main():
    for tool in (COMPILER, EMULATOR):
        if shutil.which(tool) is None:
            print(f"{tool}: not installed (tools/setup emulate)")
            return 1
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        folder = pathlib.Path(name)
        objects = [folder / f"{k}.o" for k in range(len(SOURCES))]
        list(pool.map(lambda job: run(COMPILER, *FLAGS, "-c", job[0], "-o", job[1]), zip(SOURCES, objects)))
        run(COMPILER, "-static", "-pthread", *objects, "-o", folder / "rows")
        run(BINARY, "sweep", SPEC, "--job", f"{FIRST + 1}/{STEP}", "--threads", "2", "--out", folder / "here.csv")
        here, there = rows((folder / "here.csv").read_text()), rows(run(EMULATOR, folder / "rows", SPEC, FIRST, STEP))
    wrong = [f"point {a['point']} ({a['part']}): {key} is {b[key] or 'empty'}, here {a[key] or 'empty'}" for a, b in zip(here, there) for key in a if a[key] != b[key]]
    print("\n".join(wrong + [f"arm64: {len(there)} of {len(here)} points, {len(here[0])} columns: {len(wrong)} different"]))
    return 1 if wrong or len(here) != len(there) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The host kernels of other machines draw the engine's bytes: NEON and 64-bit words on arm64, words on big-endian s390x, under emulation."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = ["tests/identity/kernel_identity.cpp", *(str(path) for path in sorted(ROOT.glob("hal/kernels/*.cpp")))]
BUILDS = [("aarch64-linux-gnu-g++", "qemu-aarch64", ("pixels", "words", "neon")), ("s390x-linux-gnu-g++", "qemu-s390x", ("pixels", "words"))]
MOST_LEFT = 0.01  # of the spans: 20 of 12960 are
FILTERS = ("nearest", "bilinear", "mip-bilinear", "trilinear", "aniso")


def verdict(compiler, emulator, kernels, folder):
    """Lines to print, and how many are wrong."""
    if shutil.which(compiler) is None or shutil.which(emulator) is None:
        return [f"{compiler}: not installed (tools/setup emulate)"], 1
    program = pathlib.Path(folder) / "program"
    subprocess.run([compiler, "-std=c++20", "-O2", "-Wno-psabi", "-static", "-I.", "-Ifirmware", *SOURCES, "-o", str(program)], cwd=ROOT, check=True)
    lines = subprocess.run([emulator, str(program)], check=True, capture_output=True, text=True).stdout.splitlines()
    missing = [f"{kernel} {kind}: not drawn" for kernel in kernels for kind in FILTERS if not any(line.startswith(f"{kernel} {kind}: ") for line in lines)]
    different = [line for line in lines if ", 0 differ;" not in line]
    left = [tuple(map(int, re.search(r"; (\d+) of (\d+) spans left", line).groups())) for line in lines]
    idle = [f"{line}: too many" for line, (alone, spans) in zip(lines, left) if alone > MOST_LEFT * spans and not line.startswith("pixels ")]
    return [f"{compiler}: {line}" for line in lines + missing + idle], len(missing) + len(different) + len(idle)


def main():
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for build in BUILDS:
            lines, bad = verdict(*build, folder)
            wrong += bad
            print("\n".join(lines), flush=True)
    print(f"{wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

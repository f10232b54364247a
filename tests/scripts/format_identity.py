#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every texel format decodes, encodes and draws alike from g++ and clang++ and on arm64, armhf and big-endian s390x under emulation."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = ["tests/identity/format_hashes.cpp", "sim/encode.cpp", "sim/encode_bc.cpp", "sim/encode_etc.cpp", "sim/palette.cpp"]
BUILDS = [("g++", "-O2", []), ("g++", "-O0", []), ("clang++", "-O2", []), ("aarch64-linux-gnu-g++", "-O2", ["qemu-aarch64"]),
          ("arm-linux-gnueabihf-g++", "-O2", ["qemu-arm"]), ("s390x-linux-gnu-g++", "-O2", ["qemu-s390x"])]
FORMATS = 17


def main():
    wrong, reference = 0, None
    with tempfile.TemporaryDirectory() as folder:
        for compiler, level, runner in BUILDS:
            if shutil.which(compiler) is None or (runner and shutil.which(runner[0]) is None):
                print(f"{compiler}: not installed (tools/setup emulate)")
                wrong += 1
                continue
            program = pathlib.Path(folder) / "program"
            static = ["-static"] if runner else []
            subprocess.run([compiler, "-std=c++20", "-Wno-psabi", level, *static, "-I.", "-Ifirmware", *SOURCES, "-o", str(program)], cwd=ROOT, check=True)
            found = subprocess.run([*runner, str(program)], check=True, capture_output=True, text=True).stdout
            if reference is None:
                reference = found
                hashes = [line.split()[3] for line in found.splitlines()]
                if len(hashes) != 2 * FORMATS:
                    sys.exit(f"{len(hashes)} lines instead of {2 * FORMATS}")
            print(f"{compiler} {level}: {'same' if found == reference else 'differs'}")
            for a, b in zip(found.splitlines(), reference.splitlines()):
                if a != b:
                    wrong += 1
                    print(f"  {a}   instead of   {b}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

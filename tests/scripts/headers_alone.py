#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compiles each header of the device library, and of the HAL's device side, alone: g++, clang++ and, where installed, arm-none-eabi-g++
for Cortex-M0+ as freestanding code. Any warning fails. Prints the headers that need another one first. Then the drawing of rows, assembly and
all, for cores and by compilers of which no emulator runs the result."""
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COMMON = ["-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wno-sign-conversion", "-Werror",
          "-I.", "-Ifirmware", "-x", "c++", "-"]
FREESTANDING = ["-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics"]
COMPILERS = {
    "g++": FREESTANDING,
    "clang++": FREESTANDING,
    "arm-none-eabi-g++": ["-mthumb", "-mcpu=cortex-m0plus", *FREESTANDING],
}

ROWS = [("arm-none-eabi-g++", "-mthumb", "-mcpu=cortex-m23"), ("clang++", "--target=thumbv6m-none-eabi", "-mcpu=cortex-m0plus"),
        ("clang++", "--target=thumbv7em-none-eabi", "-mcpu=cortex-m4"), ("arm-linux-gnueabihf-g++", "-march=armv7-a+fp")]


def headers():
    found = [f"spantex/{p.name}" for p in sorted((ROOT / "firmware/spantex").glob("*.hpp"))]
    # Kernels of one kind of core are parts of kernels.hpp.
    found += [f"spantex/rows/{p.name}" for p in sorted((ROOT / "firmware/spantex/rows").glob("*.hpp")) if not p.name.startswith("kernels_")]
    bench = [f"firmware/bench/{p.name}" for p in sorted((ROOT / "firmware/bench").glob("*.hpp"))]
    return found + bench + ["hal/engine.hpp", "hal/direct_engine.hpp", "hal/loading_engine.hpp", "hal/operation.hpp", "hal/ownership.hpp", "hal/span_archive.hpp", "hal/texel_loader.hpp",
                            "firmware/targets/loaders.hpp"]


def compiles(compiler, flags, source):
    done = subprocess.run([compiler, *flags, *COMMON], input=source, capture_output=True, text=True, cwd=ROOT)
    return done.returncode == 0, done.stderr


def main():
    failed = 0
    for compiler, flags in COMPILERS.items():
        if not shutil.which(compiler):
            print(f"{compiler}: not installed, skipped")
            continue
        if compiles(compiler, flags, "int unfinished(\n")[0]:
            sys.exit(f"{compiler} accepts anything: this check proves nothing")
        for header in headers():
            good, text = compiles(compiler, flags, f"#include <{header}>\n")
            failed += not good
            if not good:
                print(f"{compiler}: {header}", *text.splitlines()[:6], sep="\n  ")
        print(f"{compiler}: {len(headers())} headers")
    for compiler, *core in ROWS:
        if not shutil.which(compiler):
            continue
        done = subprocess.run([compiler, *core, "-O2", "-std=c++20", *FREESTANDING, "-I.", "-Ifirmware", "-c", "firmware/apps/rows_counts.cpp", "-o", "/dev/null"],
                              capture_output=True, text=True, cwd=ROOT)
        failed += done.returncode != 0
        print(f"{compiler} {core[-1]}: rows", *(done.stderr.splitlines()[:6] if done.returncode else []), sep="\n  " if done.returncode else " ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""spantex.h is C99: alone and in a program (firmware/apps/drawing.c) it compiles without a word with gcc and clang, -std=c99 -pedantic -Wall -Wextra; linked as C, without
the library of C++, both draw the same picture, in which sky, floor, wheel and wall are where they should be; two cores draw it too, where they can be emulated."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = os.environ.get("SPANTEX_BUILD", str(ROOT / "build"))
C = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wshadow", "-Wstrict-prototypes", "-Wmissing-prototypes", "-Werror", "-Ifirmware"]
CPP = ["-std=c++20", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wno-sign-conversion", "-Werror",
       "-O2", "-Ifirmware"]
SOURCES = ("firmware/apps/drawing.c", "tools/drawing_to_file.c")


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, cwd=ROOT, **more)
    if done.returncode != 0 or done.stderr:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout}{done.stderr}")


def picture(c, cpp, folder):
    run(c, *C, "-fsyntax-only", "-x", "c", "-", input="#include <spantex/spantex.h>\n#include <spantex/spantex.h>\nint unused_number;\n")
    objects = [folder / f"{c}-{k}.o" for k in range(3)]
    for source, out in zip(SOURCES, objects):
        run(c, *C, "-c", source, "-o", out)
    run(cpp, *CPP, "-c", "firmware/spantex/spantex_c.cpp", "-o", objects[2])
    run(c, *objects, "-o", folder / c)
    run(folder / c, folder / f"{c}.rgb565")
    return (folder / f"{c}.rgb565").read_bytes()


def looks_right(raw):
    def at(x, y):
        code = raw[2 * (320 * y + x)] | raw[2 * (320 * y + x) + 1] << 8
        return code >> 11, code >> 5 & 63, code & 31
    blue_sky, red_middle, wall, joint = at(20, 10), at(100, 120), at(270, 60), at(150, 235)
    return blue_sky[2] > 24 and red_middle[0] > 20 and red_middle[1] < 16 and 8 < wall[0] < 20 and joint[0] > 4


def main():
    compilers = [(c, cpp) for c, cpp in (("gcc", "g++"), ("clang", "clang++")) if shutil.which(c) and shutil.which(cpp)]
    with tempfile.TemporaryDirectory() as name:
        pictures = [picture(c, cpp, pathlib.Path(name)) for c, cpp in compilers]
    if not pictures or len(set(pictures)) != 1 or not looks_right(pictures[0]):
        sys.exit(f"{len(pictures)} compilers, {len(set(pictures))} pictures" + ("" if pictures and looks_right(pictures[0]) else ", not the drawing"))
    print(f"{' and '.join(c for c, _ in compilers)}: the same picture")
    missing = [t for t in ("arm-none-eabi-g++", "qemu-system-arm", "riscv64-unknown-elf-g++", "qemu-system-riscv32") if not shutil.which(t)]
    if missing:
        print(f"not installed, skipped: {', '.join(missing)}")
        return 0
    with tempfile.TemporaryDirectory() as name:  # MVE leaves the loops in assembler too few registers where code is to be small
        for options in (["-Os"], ["-O3", "-DSPANTEX_ROWS_DSP=0"]):
            run("arm-none-eabi-g++", *CPP, *options, "-mcpu=cortex-m55", "-mthumb", "-mfloat-abi=hard", "-c", "firmware/spantex/spantex_c.cpp", "-o", pathlib.Path(name) / "m55.o")
    return subprocess.run([ROOT / "tools/device_drawing", "--build", BUILD, "--only", "M4,RV32IMAC"]).returncode


if __name__ == "__main__":
    sys.exit(main())

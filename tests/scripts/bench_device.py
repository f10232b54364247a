#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The device's end of the bench for microcontrollers, firmware/apps/bench_device.cpp, compiles without a warning for Cortex-M0+ and, where the compiler is
installed, RV32; it needs no heap, no floating point and nothing of the C++ library, and the memory that docs/BENCH.md says."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FLAGS = ["-std=c++20", "-Os", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow",
         "-Wconversion", "-Wno-sign-conversion", "-Werror", "-I.", "-Ifirmware", "-c", "firmware/apps/bench_device.cpp"]
TARGETS = {"arm-none-eabi": ["-mthumb", "-mcpu=cortex-m0plus"], "riscv64-unknown-elf": ["-march=rv32imac_zicsr", "-mabi=ilp32"]}
# Integer helpers of the compiler, and what it may always call.
ALLOWED = ("__aeabi_idiv", "__aeabi_uidiv", "__aeabi_l", "__aeabi_ul", "__clz", "__ctz", "__popcount", "__gnu_thumb1", "__mul", "__div", "__udiv", "__mod", "__umod",
           "__ashl", "__ashr", "__lshr", "mem")


def main():
    failed = 0
    for prefix, flags in TARGETS.items():
        if not shutil.which(prefix + "-g++"):
            print(f"{prefix}-g++: not installed, skipped")
            continue
        with tempfile.TemporaryDirectory() as folder:
            out = f"{folder}/device.o"
            subprocess.run([prefix + "-g++", *flags, *FLAGS, "-o", out], check=True, cwd=ROOT)
            names = subprocess.run([prefix + "-nm", "-u", out], check=True, capture_output=True, text=True).stdout.split()[1::2]
            alien = [n for n in names if not n.startswith(ALLOWED)]
            failed += bool(alien)
            print(subprocess.run([prefix + "-size", out], check=True, capture_output=True, text=True).stdout)
            # Addresses are as long on both.
            sizes = {n: int(size, 16) for size, n in re.findall(r"^\S+ (\S+) \S \S*\d(engine|commands)E$",
                                                                subprocess.run([prefix + "-nm", "-S", out], check=True, capture_output=True, text=True).stdout, re.M)}
            told = f"`seed`: {sizes['commands']} bytes beside the engine's {sizes['engine']}"
            if told not in (ROOT / "docs/BENCH.md").read_text():
                failed += 1
                print(f"{prefix}: docs/BENCH.md does not say {told}")
            if alien:
                print(f"{prefix}: needs {' '.join(alien)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

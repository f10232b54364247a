#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`make targets`: every core draws the host's pictures by rows, in no more instructions than recorded; sizes of the device library keep their limits. Skipped, saying so, where compilers or emulators are not installed."""
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = os.environ.get("SPANTEX_BUILD", str(ROOT / "build"))


def main():
    missing = [t for t in ("arm-none-eabi-g++", "qemu-system-arm", "riscv64-unknown-elf-g++", "qemu-system-riscv32") if not shutil.which(t)]
    if missing:
        print(f"not installed, skipped: {', '.join(missing)}")
        return 0
    codes = [subprocess.run([ROOT / "tools/count_instructions", "--build", BUILD]).returncode,
             subprocess.run([ROOT / "tools/size_report", "--build", BUILD]).returncode]
    return max(codes)


if __name__ == "__main__":
    sys.exit(main())

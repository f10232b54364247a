#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Double buffering on emulated devices (tools/device_loading): the committed pictures, stalls of slow loaders and none of fast ones, a status for one that
never ends. Skipped, saying so, where compilers or emulators are not installed."""
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def main():
    missing = [t for t in ("arm-none-eabi-g++", "qemu-system-arm", "riscv64-unknown-elf-g++", "qemu-system-riscv32") if not shutil.which(t)]
    if missing:
        print(f"not installed, skipped: {', '.join(missing)}")
        return 0
    return subprocess.run([ROOT / "tools/device_loading", "--build", os.environ.get("SPANTEX_BUILD", str(ROOT / "build"))]).returncode


if __name__ == "__main__":
    sys.exit(main())

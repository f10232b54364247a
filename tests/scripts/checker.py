#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The example program firmware/apps/checker.cpp compiles without a warning, runs and ends with 0; where the cross compiler is installed it
compiles for Cortex-M0+ too. If README.md shows C++ code, it shows this program."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SOURCE = ROOT / "firmware/apps/checker.cpp"
FLAGS = ["-std=c++20", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wno-sign-conversion", "-Werror",
         "-I.", "-Ifirmware"]
DEVICE = ["-mthumb", "-mcpu=cortex-m0plus", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics", "-c"]


def check(*command):
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout}{done.stderr}")


def shown_in_readme():
    readme = ROOT / "README.md"
    blocks = re.findall(r"^```cpp\n(.*?)^```", readme.read_text(), re.S | re.M) if readme.exists() else []
    code = "\n".join(line for line in SOURCE.read_text().splitlines() if not line.startswith("//")).strip()
    return not blocks or any(code in block for block in blocks)


def main():
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / "checker"
        check(os.environ.get("CXX", "g++"), *FLAGS, str(SOURCE), "-o", str(program))
        check(str(program))
        if shutil.which("arm-none-eabi-g++"):
            check("arm-none-eabi-g++", *FLAGS, *DEVICE, str(SOURCE), "-o", f"{folder}/checker.o")
    if not shown_in_readme():
        sys.exit("README.md shows other code than firmware/apps/checker.cpp")
    return 0


if __name__ == "__main__":
    sys.exit(main())

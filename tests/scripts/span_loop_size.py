#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The HAL costs nothing: on Cortex-M0+ a span loop through the span_engine concept and the direct engine has no more code than the
same loop written by hand (tests/static). Judged with the size-minded options, and at -O2 with the datapath kept a function of its own, so
that it is the loop that is compared; where all of it melts into one function of 3 KB, chance in register allocation moves the total by some
percent either way: there 2 % are allowed. Skipped, saying so, where arm-none-eabi-g++ is not installed."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FLAGS = ["-mthumb", "-mcpu=cortex-m0plus", "-std=c++20", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics",
         "-Wall", "-Wextra", "-Werror", "-I.", "-Ifirmware"]


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout


JUDGED = (["-Os"], ["-O2", "-fno-inline-functions-called-once"])
INLINED = (["-O2"],)


def text_bytes(source, options, folder):
    built = pathlib.Path(folder) / "loop.o"
    run("arm-none-eabi-g++", *FLAGS, *options, "-c", f"tests/static/{source}.cpp", "-o", str(built))
    return int(run("arm-none-eabi-size", str(built)).splitlines()[1].split()[0])


def main():
    if not shutil.which("arm-none-eabi-g++"):
        print("arm-none-eabi-g++ is not installed: skipped")
        return 0
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        for options in (*JUDGED, *INLINED):
            concept, by_hand = (text_bytes(s, options, folder) for s in ("span_loop_concept", "span_loop_by_hand"))
            print(f"{' '.join(options)}: {concept} bytes through the concept, {by_hand} by hand")
            # Inlined altogether the compiler lays registers out anew: 2 % either way is noise of that, not a cost of the contract.
            failed = failed or concept > by_hand * (1 if options in JUDGED else 1.02)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

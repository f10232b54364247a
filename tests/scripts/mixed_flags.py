#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Programs of two files that are compiled with other flags, which have other kernels of rows (or -Os's painter): linked in both orders, each draws the same
pictures, a build with one set of flags draws them too, and nothing is written behind what its file says its memory is."""
import concurrent.futures
import os
import pathlib
import re
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import targets  # noqa: E402

FILES = ("tests/mixed_flags/main.cpp", "tests/mixed_flags/other.cpp")
# A core, the flags of one file and of the other.
PAIRS = [("M0+", ["-Os"], ["-O2"]), ("M3", ["-Os"], ["-O2"]), ("M4", ["-O0"], ["-O2"]), ("M55+MVE", ["-Os"], ["-O2"])]


def built(target, first, first_flags, last, last_flags, out):
    """Linked in this order."""
    compiled = out.with_suffix(".o")
    out.parent.mkdir(parents=True)
    targets.run(target.compiler, *targets.COMMON, *target.flags, *first_flags, "-c", first, "-o", compiled)
    return targets.build(target, last, out, options=[*last_flags, compiled])


def check(folder, number):
    core, one, other = PAIRS[number]
    target = targets.named(core)
    ways = [(FILES[0], one, FILES[1], other), (FILES[1], one, FILES[0], other), (FILES[0], other, FILES[1], one), (FILES[0], one, FILES[1], one)]
    said = [targets.emulate(target, built(target, *way, folder / f"{number}-{k}" / "program.elf")) for k, way in enumerate(ways)]
    right = [line for line in said[-1].splitlines() if re.fullmatch("[0-9a-f]{8}", line)]
    if len(set(right)) < 12:
        sys.exit(f"{core} {one}: too few pictures:\n{said[-1]}")
    wrong = sum(a != b for text in said for a, b in zip(text.splitlines(), right, strict=True))
    if wrong:
        sys.exit(f"{core}, {' '.join(one)} with {' '.join(other)}: {wrong} differ\n" + "\n".join(said))
    return f"{core}: {' '.join(one)} with {' '.join(other)}: {len(said[0].splitlines())} pictures the same in {len(ways)} programs"


def main():
    targets.require(*sorted({x for core, _, _ in PAIRS for x in (targets.named(core).compiler, targets.named(core).emulator)}))
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for line in pool.map(lambda k: check(pathlib.Path(folder), k), range(len(PAIRS))):
            print(line)


main()

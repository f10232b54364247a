#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The same bytes everywhere: hashes of 1088 small pictures (each scene, filter, wrap mode, map and profile;
each scene, shading and profile), from g++ and clang++ at four
optimisation levels, and from arm64, armhf and big-endian s390x under emulation at -O2, all equal to the committed ones. At -O0 and -O3 the
emulated machines draw the 272 pictures of profile compact (32-bit products) and the 272 of exact (64-bit products)."""
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
GOLDEN = (ROOT / "tests/golden/picture_hashes.txt").read_text().splitlines()
SOURCE = ROOT / "tests/identity/picture_hashes.cpp"
LEVELS = ("-O0", "-Os", "-O2", "-O3")
MACHINES = {"aarch64-linux-gnu-g++": "qemu-aarch64", "arm-linux-gnueabihf-g++": "qemu-arm", "s390x-linux-gnu-g++": "qemu-s390x"}

# compiler, level, emulator, profiles ("": all)
BUILDS = [(compiler, level, None, [""]) for compiler in ("g++", "clang++") for level in LEVELS]
BUILDS += [(compiler, level, emulator, [""] if level == "-O2" else ["compact", "exact"])
           for compiler, emulator in MACHINES.items() for level in ("-O2", "-O0", "-O3")]


def hashes(compiler, level, emulator, profiles, folder):
    program = folder / f"{compiler}{level}"
    emulated = [emulator] if emulator else []
    subprocess.run([compiler, "-std=c++20", level, *(["-static"] if emulator else []), "-I.", "-Ifirmware", str(SOURCE), "-o", str(program)],
                   cwd=ROOT, check=True)
    lines = []
    for profile in profiles:
        done = subprocess.run([*emulated, str(program), *([profile] if profile else [])], check=True, capture_output=True, text=True)
        lines += done.stdout.splitlines()
    return lines


def verdict(build, folder):
    """Whether all is the same, and what to print."""
    compiler, level, emulator, profiles = build
    if shutil.which(compiler) is None or (emulator and shutil.which(emulator) is None):
        return False, f"{compiler}: not installed (tools/setup emulate)"
    found = hashes(*build, folder)
    expected = [line for profile in profiles for line in GOLDEN if profile in ("", line.split()[0])]
    different = [f"{a}  instead of  {b.split()[-1]}" for a, b in zip(found, expected) if a != b]
    text = f"{compiler} {level}: {len(found)} pictures, {'same' if found == expected else f'{len(different)} differ'}"
    return found == expected, "\n".join([text, *different[:5]])


def main():
    wrong = 0
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for same, text in pool.map(lambda build: verdict(build, pathlib.Path(name)), BUILDS):
            wrong += not same
            print(text, flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

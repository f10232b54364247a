#!/usr/bin/env python3
"""The same bytes everywhere: hashes of 576 small pictures, from g++ and clang++ at four optimisation levels, and from arm64, armhf and
big-endian s390x under emulation, all equal to the committed ones."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
GOLDEN = (ROOT / "tests/golden/picture_hashes.txt").read_text()
SOURCE = ROOT / "tests/identity/picture_hashes.cpp"

NATIVE = [("g++", level, []) for level in ("-O0", "-Os", "-O2", "-O3")] + [("clang++", level, []) for level in ("-O0", "-Os", "-O2", "-O3")]
EMULATED = [("aarch64-linux-gnu-g++", "-O2", ["qemu-aarch64"]), ("arm-linux-gnueabihf-g++", "-O2", ["qemu-arm"]),
            ("s390x-linux-gnu-g++", "-O2", ["qemu-s390x"])]


def hashes(compiler, level, runner, folder):
    program = folder / f"{compiler}{level}"
    static = ["-static"] if runner else []
    subprocess.run([compiler, "-std=c++20", level, *static, "-I.", "-Ifirmware", str(SOURCE), "-o", str(program)], cwd=ROOT, check=True)
    return subprocess.run([*runner, str(program)], check=True, capture_output=True, text=True).stdout


def main():
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        for compiler, level, runner in NATIVE + EMULATED:
            if shutil.which(compiler) is None or (runner and shutil.which(runner[0]) is None):
                print(f"{compiler}: not installed (tools/setup emulate)")
                wrong += 1
                continue
            found = hashes(compiler, level, runner, pathlib.Path(name))
            different = [f"{a}  instead of  {b.split()[-1]}" for a, b in zip(found.splitlines(), GOLDEN.splitlines()) if a != b]
            same = found == GOLDEN
            wrong += not same
            print(f"{compiler} {level}: {'same' if same else f'{len(different)} pictures differ'}")
            print("\n".join(different[:5]), end="\n" if different else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

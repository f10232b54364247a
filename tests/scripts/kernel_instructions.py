# SPDX-License-Identifier: Apache-2.0
"""Instructions of the host kernels on parts of pictures (tests/counts/kernel_pictures.cpp), whole draws of planes, by whatever counts them. Not a test itself: work_counts.py has the baseline.

  words, sse41, avx2       callgrind
  avx512, avx512-gathers   the program itself, by the processor's trap; fewer pictures, since that takes 20 to 50 us an instruction on a virtual machine
  neon                     QEMU"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import spantex_command as command

sys.path.insert(0, str(command.ROOT / "tools"))
import targets  # noqa: E402

PICTURES = "tests/counts/kernel_pictures.cpp"
SOURCES = ["sim/ideal.cpp", *sorted(str(path.relative_to(targets.ROOT)) for path in (targets.ROOT / "hal/kernels").glob("*.cpp"))]
BUILD = command.BINARY.parent
CXX, ARM64, EMULATOR = os.environ.get("CXX", "g++"), "aarch64-linux-gnu-g++", "qemu-aarch64"
BY_CALLGRIND = ("words", "sse41", "avx2")
BY_TRAP = {
    "avx512": ["facing-trilinear", "tilted-nearest", "tilted-bilinear", "tilted-mip-bilinear", "tilted-trilinear", "tilted-aniso", "far-nearest", "far-bilinear", "far-trilinear",
               "turned-nearest", "turned-trilinear", "scaled-nearest", "scaled-bilinear", "scaled-trilinear", "tilted-trilinear-srgb", "tilted-nearest-cut-out"],
    "avx512-gathers": ["far-nearest", "far-bilinear", "far-aniso"],  # what local memory does not hold
}
# memcpy and the like as they are with AVX2: no string instructions, which are a trap an iteration, no AVX-512.
SAME_LIBRARY = dict(os.environ, GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512BW,-ERMS,-FSRM:glibc.cpu.x86_rep_movsb_threshold=1073741824:"
                                               "glibc.cpu.x86_rep_stosb_threshold=1073741824")
MISSING = 3  # exit code: this machine has not the kernel
LEAST = 1000  # instructions of any picture


def flags():
    """Of the build, but for the kernels' own."""
    return (BUILD / "build.txt").read_text().splitlines()[-1].partition(",")[0].split()


def lines_of(*arguments):
    """What a program printed, split; None where it has not the kernel."""
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, env=SAME_LIBRARY)
    if done.returncode not in (0, MISSING):
        sys.exit(f"work_counts: {' '.join(map(str, arguments))}: exit code {done.returncode}: {done.stderr[-2000:]}")
    return None if done.returncode == MISSING else [line.split() for line in done.stdout.splitlines()]


def by_callgrind(program, kernel, folder):
    out = folder / "callgrind"
    lines = shutil.which("valgrind") and lines_of("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "--toggle-collect=*draw_counted*", "--dump-after=count_end", program, kernel)
    return lines and {name: int(re.search(r"^totals: (\d+)", pathlib.Path(f"{out}.{n}").read_text(), re.M)[1]) for n, (name, _) in enumerate(lines, 1)}


def by_trap(program, kernel):
    lines = lines_of(program, kernel, "--trap", *BY_TRAP[kernel])
    return lines and {name: int(count) for name, count in lines}


def by_emulator(folder):
    targets.require(ARM64, EMULATOR)
    program, counts = folder / "kernel_pictures-arm64", folder / "counts"
    targets.run(ARM64, "-std=c++20", "-O3", "-falign-functions=64", "-Wno-psabi", "-static", "-no-pie", "-I.", "-Ifirmware", PICTURES, *SOURCES, "-o", program)
    symbols = {parts[2]: parts[0] for parts in map(str.split, targets.run("aarch64-linux-gnu-nm", program).splitlines()) if len(parts) == 3}
    lines = lines_of(EMULATOR, "-plugin", f"{targets.build_plugin(folder)},begin=0x{symbols['count_begin']},end=0x{symbols['count_end']},out={counts}", program, "neon")
    return {name: int(count) for (name, _), count in zip(lines, counts.read_text().split(), strict=True)}


def counted():
    """Text of the baseline's form, rows KERNEL/PICTURE, and the kernels that this machine does not count."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        program = folder / "kernel_pictures"
        objects = [(BUILD / source).with_suffix(".o") for source in SOURCES]
        targets.run(CXX, *flags(), "-I.", "-Ifirmware", PICTURES, *objects, "-Wl,-z,now", "-o", program)  # nothing is bound by the first picture
        counts = {kernel: by_callgrind(program, kernel, folder) for kernel in BY_CALLGRIND} | {kernel: by_trap(program, kernel) for kernel in BY_TRAP}
        counts["neon"] = by_emulator(folder)
    rows = {f"{kernel}/{picture}": count for kernel, of_pictures in counts.items() for picture, count in (of_pictures or {}).items()}
    if any(count < LEAST for count in rows.values()):
        sys.exit(f"work_counts: not counted: {[row for row, count in rows.items() if count < LEAST]}")
    made_by = (BUILD / "build.txt").read_text().splitlines()[1]
    return (f"# build: {made_by}; {targets.run(ARM64, '--version').splitlines()[0]}\n# row instructions\n" + "".join(f"{row} {count}\n" for row, count in rows.items()),
            [kernel for kernel, of_pictures in counts.items() if of_pictures is None])

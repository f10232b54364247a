# SPDX-License-Identifier: Apache-2.0
"""Instructions of the host kernels on parts of pictures (tests/counts/kernel_pictures.cpp), whole draws of planes, by whatever counts them. Not a test itself: work_counts.py has the baseline.

  words, sse41, avx2   callgrind
  avx512               the program itself, by the processor's trap, where the processor has it: fewer pictures, since each instruction takes 25 us or more on a virtual machine
  neon                 QEMU"""
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
BUILD = command.BINARY.parent
CXX, ARM64, EMULATOR = os.environ.get("CXX", "g++"), "aarch64-linux-gnu-g++", "qemu-aarch64"
BY_CALLGRIND = ("words", "sse41", "avx2")
TRAPPED = {
    "avx512": ["facing-trilinear", "tilted-nearest", "tilted-bilinear", "tilted-mip-bilinear", "tilted-trilinear", "far-nearest", "far-bilinear", "far-trilinear", "turned-nearest",
               "turned-trilinear", "scaled-nearest", "scaled-bilinear", "scaled-trilinear", "tilted-aniso"],
    "avx512-gathers": ["far-nearest", "far-bilinear", "far-aniso"],  # what local memory does not hold
}
# The C library's memory functions are the same ones on every x86 with AVX2: no string instructions, which are a trap an iteration, no AVX-512.
SAME_LIBRARY = dict(os.environ, GLIBC_TUNABLES="glibc.cpu.hwcaps=-AVX512VL,-AVX512BW,-ERMS,-FSRM:glibc.cpu.x86_rep_movsb_threshold=1073741824:glibc.cpu.x86_rep_stosb_threshold=1073741824")
MISSING = 3  # exit code: this machine has not the kernel


def by_callgrind(program, kernel, folder):
    out = folder / "callgrind"
    lines = targets.run("valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", "--toggle-collect=*draw_counted*", "--dump-after=count_end", program, kernel,
                        env=SAME_LIBRARY).splitlines()
    return {line.split()[0]: int(re.search(r"^totals: (\d+)", pathlib.Path(f"{out}.{n}").read_text(), re.M)[1]) for n, line in enumerate(lines, 1)}


def by_trap(program, kernel):
    done = subprocess.run([program, kernel, "--trap", *TRAPPED[kernel]], capture_output=True, text=True, env=SAME_LIBRARY)
    if done.returncode == MISSING:
        return None
    if done.returncode != 0:
        sys.exit(f"work_counts: {program} {kernel}: exit code {done.returncode}")
    return {name: int(count) for name, count in map(str.split, done.stdout.splitlines())}


def by_emulator(folder):
    kernels = sorted(str(p.relative_to(targets.ROOT)) for p in (targets.ROOT / "hal/kernels").glob("*.cpp"))
    program = folder / "kernel_pictures-arm64"
    targets.run(ARM64, "-std=c++20", "-O3", "-falign-functions=64", "-Wno-psabi", "-static", "-no-pie", "-I.", "-Ifirmware", PICTURES, *kernels, "-o", program)
    symbols = {parts[2]: parts[0] for parts in map(str.split, targets.run("aarch64-linux-gnu-nm", program).splitlines()) if len(parts) == 3}
    counts, plugin = folder / "counts", targets.build_plugin(folder)
    lines = targets.run(EMULATOR, "-plugin", f"{plugin},begin=0x{symbols['count_begin']},end=0x{symbols['count_end']},out={counts}", program, "neon").splitlines()
    return {line.split()[0]: int(count) for line, count in zip(lines, counts.read_text().split(), strict=True)}


def version(compiler):
    return f"{compiler} {targets.run(compiler, '-dumpfullversion').strip()}"


def counted():
    """Text of the baseline's form, and the kernels that this machine does not count."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        program = folder / "kernel_pictures"
        targets.run(CXX, "-std=c++20", "-O2", "-I.", "-Ifirmware", PICTURES, *sorted(BUILD.glob("hal/kernels/*.o")), "-Wl,-z,now", "-o", program)  # nothing is bound by the first picture
        counts = {kernel: by_callgrind(program, kernel, folder) for kernel in BY_CALLGRIND} if shutil.which("valgrind") else dict.fromkeys(BY_CALLGRIND)
        counts |= {kernel: by_trap(program, kernel) for kernel in TRAPPED}
        counts["neon"] = by_emulator(folder)
    flags = (BUILD / "build.txt").read_text().split(maxsplit=1)[1].strip()
    rows = [f"{kernel}-{picture} {count}" for kernel, of_pictures in counts.items() for picture, count in (of_pictures or {}).items()]
    return f"# build: {version(CXX)}, {flags}; {version(ARM64)}\n# row instructions\n" + "\n".join(rows) + "\n", [kernel for kernel in counts if counts[kernel] is None]

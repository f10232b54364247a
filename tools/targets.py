# SPDX-License-Identifier: Apache-2.0
"""The cores that the library is built for and run on under emulation: how to compile, link, run, and count instructions. Used by
tools/count_instructions, tools/size_report, tools/demo_m4 and tests; no command of its own."""
import pathlib
import shutil
import subprocess
import sys
from dataclasses import dataclass, field

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMMON = ["-std=c++20", "-ffreestanding", "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics", "-fno-use-cxa-atexit", "-ffunction-sections",
          "-fdata-sections", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Wno-sign-conversion", "-Werror", "-I.", "-Ifirmware"]
SEMIHOSTING = ["-nographic", "-monitor", "none", "-serial", "none", "-semihosting-config", "enable=on,target=native"]


@dataclass
class Target:
    name: str
    machine: str
    flags: list
    flash: int = 0
    ram: int = 0x20000000
    flash_bytes: int = 4 << 20
    ram_bytes: int = 2 << 20
    emulator: str = "qemu-system-arm"
    compiler: str = "arm-none-eabi-g++"
    defines: list = field(default_factory=list)
    library_flags: list = None  # where no libgcc is built for `flags`: those of one that runs there

    @property
    def is_arm(self):
        return self.emulator == "qemu-system-arm"

    @property
    def tool_prefix(self):
        return self.compiler.removesuffix("g++")


def arm(name, machine, cpu, **more):
    return Target(name, machine, ["-mthumb", f"-mcpu={cpu}", *more.pop("flags", [])], **more)


def riscv(name, architecture, **more):
    return Target(name, "virt", [f"-march={architecture}", "-mabi=ilp32"], ram=0x80000000, emulator="qemu-system-riscv32", compiler="riscv64-unknown-elf-g++", **more)


TARGETS = [
    arm("microbit", "microbit", "cortex-m0plus", flash_bytes=256 << 10, ram_bytes=16 << 10, defines=["-DSPANTEX_SMALL"]),
    arm("M0+", "mps2-an385", "cortex-m0plus"),
    arm("M3", "mps2-an385", "cortex-m3"),
    arm("M4", "mps2-an386", "cortex-m4"),
    arm("M7", "mps2-an500", "cortex-m7+nofp"),
    arm("M33", "mps2-an505", "cortex-m33+nofp", flash=0x10000000, ram=0x38000000),
    arm("M55", "mps3-an547", "cortex-m55+nomve+nofp", flash_bytes=512 << 10, ram_bytes=512 << 10),
    arm("M55+MVE", "mps3-an547", "cortex-m55", flags=["-mfloat-abi=hard"], flash_bytes=512 << 10, ram_bytes=512 << 10),
    riscv("RV32IMAC", "rv32imac"),
    riscv("RV32+Zb", "rv32imac_zba_zbb", library_flags=["-march=rv32imac", "-mabi=ilp32"]),
]


def named(name):
    return next(t for t in TARGETS if t.name == name)


def require(*tools):
    missing = [t for t in tools if shutil.which(t) is None]
    if missing:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: not installed: {', '.join(missing)} (tools/setup cross devices)")


def run(*command, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, cwd=ROOT, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
    return done.stdout


def libgcc(target):
    return run(target.compiler, *(target.library_flags or target.flags), "-print-libgcc-file-name").strip()


def build(target, source, out, optimise="-O2", options=()):
    """A whole program for a target. Its name is `out`."""
    pathlib.Path(out).parent.mkdir(parents=True, exist_ok=True)
    flags = [*COMMON, optimise, *target.flags, *target.defines, *options]
    if target.is_arm:
        layout = {"flash_origin": target.flash, "flash_length": target.flash_bytes, "ram_origin": target.ram, "ram_length": target.ram_bytes}
        start, script = "firmware/targets/start_cortex_m.cpp", "firmware/targets/cortex_m.ld"
    else:
        layout = {"ram_origin": target.ram, "ram_length": target.ram_bytes}
        start, script = "firmware/targets/start_riscv.cpp", "firmware/targets/riscv.ld"
    link = ["-nostartfiles", "-nostdlib", "-Wl,--gc-sections", "-T", script, *(f"-Wl,--defsym={n}={v}" for n, v in layout.items()), libgcc(target)]
    run(target.compiler, *flags, source, start, *link, "-o", out)
    return out


def build_for_host(source, out, options=()):
    pathlib.Path(out).parent.mkdir(parents=True, exist_ok=True)
    run("g++", "-std=c++20", "-O2", "-I.", "-Ifirmware", *options, source, "-o", out)
    return out


def symbols(target, program):
    lines = run(f"{target.tool_prefix}nm", program).splitlines()
    return {parts[2]: int(parts[0], 16) for parts in map(str.split, lines) if len(parts) == 3}


def emulate(target, program, extra=()):
    """What the program printed. A program that does not end with 0 ends this one."""
    board = ["-bios", "none"] if not target.is_arm else []
    try:
        done = subprocess.run([target.emulator, "-M", target.machine, *board, *SEMIHOSTING, *extra, "-kernel", str(program)], capture_output=True, text=True,
                              timeout=1200, cwd=ROOT)
    except subprocess.TimeoutExpired:
        sys.exit(f"{target.name}: {program} did not end")
    if done.returncode != 0:
        sys.exit(f"{target.name}: {program} ended with {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout + done.stderr


def counted(target, program, plugin, folder):
    """What it printed, and the instructions from each count_begin to the next count_end."""
    names, counts = symbols(target, program), pathlib.Path(folder) / f"{pathlib.Path(program).name}.counts"
    text = emulate(target, program, ["-plugin", f"{plugin},begin={names['count_begin']:#x},end={names['count_end']:#x},out={counts}"])
    return text, [int(line) for line in counts.read_text().split()]


def build_plugin(folder):
    out = pathlib.Path(folder) / "count_calls.so"
    out.parent.mkdir(parents=True, exist_ok=True)
    run("gcc", "-O2", "-shared", "-fPIC", "-Wall", "-Wextra", "-Werror", "tools/qemu/count_calls.c", "-o", out)
    return out

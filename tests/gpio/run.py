#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The bench on a real kernel: builds gpio-sim from Debian's kernel source, boots Debian's kernel under emulation with it, and runs tests/gpio/init there:
`spantex bench-rig` through the real libgpiod and the GPIO character device, the device's end as a second process on gpio-sim's values and pulls.
Kernel, modules and sources come from packages and stay in build/gpio."""
import argparse
import gzip
import json
import pathlib
import re
import shutil
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINES = ["D0", "D1", "D2", "D3", "D4", "D5", "D6", "D7", "clock", "direction", "command", "reset", "ready", "busy", "error"]
SOURCES = ["drivers/gpio/gpio-sim.c", "drivers/gpio/gpiolib.h", "kernel/irq/irq_sim.c"]
LIMIT_S = 1200  # of the machine


def run(command, **kw):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, errors="replace", **kw)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


def kernel_release():
    """The newest kernel of which image and headers are there."""
    found = [p.name.removeprefix("vmlinuz-") for p in pathlib.Path("/boot").glob("vmlinuz-*-amd64")]
    found = [r for r in found if pathlib.Path(f"/lib/modules/{r}/build").exists()]
    if not found:
        sys.exit("no kernel image with its headers: tools/setup gpio")
    return max(found, key=lambda r: [int(n) for n in re.findall(r"\d+", r)])


def build_modules(folder, release):
    """gpio-sim and irq_sim, built out of the kernel's tree."""
    stamp = folder / f"built-{release}"
    if stamp.exists():
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    version = ".".join(release.split(".")[:2])
    archive = pathlib.Path(f"/usr/src/linux-source-{version}.tar.xz")
    run(["tar", "-xJf", archive, "-C", folder, "--strip-components=1", *(f"linux-source-{version}/{s}" for s in SOURCES)])
    for source in SOURCES:
        (folder / source).rename(folder / pathlib.Path(source).name)
    irq_sim = (folder / "irq_sim.c").read_text()
    irq_sim = irq_sim.replace("handle_simple_irq(irq_to_desc(irqnum));", "generic_handle_irq_safe(irqnum);") + '\n#include <linux/module.h>\nMODULE_LICENSE("GPL");\n'
    (folder / "irq_sim.c").write_text(irq_sim)
    (folder / "Makefile").write_text("obj-m := irq_sim.o gpio-sim.o\n")
    run(["make", "-C", f"/lib/modules/{release}/build", f"M={folder}", "modules"])
    stamp.touch()


def libraries_of(program):
    """Of a program; none if it is static."""
    return re.findall(r"(/\S+) \(0x", subprocess.run(["ldd", str(program)], capture_output=True, text=True).stdout)


def make_root(root, build, release, size):
    shutil.rmtree(root, ignore_errors=True)
    for name in ("bin", "lib", "lib64", "modules", "proc", "sys", "dev", "run", "etc"):
        (root / name).mkdir(parents=True)
    (root / "init").write_text((ROOT / "tests/gpio/init").read_text().replace("SIZE", size))
    (root / "init").chmod(0o755)
    (root / "etc/passwd").write_text("root::0:0::/:/bin/sh\nnobody::65534:65534::/:/bin/sh\n")
    shutil.copy("/bin/busybox", root / "bin/busybox")
    for name in run(["/bin/busybox", "--list"]).split():
        if not (root / "bin" / name).exists():
            (root / "bin" / name).symlink_to("busybox")
    programs = [build / "spantex", build / "gpio/device", pathlib.Path(shutil.which("gpioinfo"))]
    for program in programs:
        (root / "bin" / program.name).unlink(missing_ok=True)
        shutil.copy(program, root / "bin" / program.name)
        for library in libraries_of(program):
            shutil.copy(library, root / ("lib64" if "ld-linux" in library else "lib"))
    for program in root.glob("bin/*"):
        if not program.is_symlink() and program.name != "busybox":
            run(["strip", program])
    shutil.copy(next(pathlib.Path(f"/lib/modules/{release}").rglob("configfs.ko")), root / "modules")
    for module in ("irq_sim.ko", "gpio-sim.ko"):
        shutil.copy(build / "gpio/modules" / module, root / "modules")
    rig = {"chip": "bench-chip", "lines": {n: n for n in LINES}, "settle_ns": 400_000_000, "limits": {"step_ns": 2_000_000_000, "exchange_ns": 60_000_000_000}}
    (root / "rig.json").write_text(json.dumps(rig))
    (root / "wrong.json").write_text(json.dumps(rig | {"chip": "nowhere"}))
    (root / "missing_line.json").write_text(json.dumps(rig | {"lines": rig["lines"] | {"ready": "unready"}}))


def pack(root, image):
    names = "\n".join(str(p.relative_to(root)) for p in sorted(root.rglob("*")))
    done = subprocess.run(["cpio", "-o", "-H", "newc", "-R", "0:0", "--quiet"], input=names.encode(), capture_output=True, cwd=root, check=True)
    image.write_bytes(gzip.compress(done.stdout, 1))


def boot(release, image):
    command = ["qemu-system-x86_64", "-accel", "tcg", "-smp", "2", "-M", "pc", "-m", "512", "-no-reboot", "-monitor", "none",
               "-serial", "stdio", "-display", "none", "-nic", "none", "-device", "isa-debug-exit,iobase=0xf4,iosize=0x04", "-kernel", f"/boot/vmlinuz-{release}",
               "-initrd", str(image), "-append", "console=ttyS0 quiet panic=-1 reboot=t"]
    machine = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    lines = []
    limit = threading.Timer(LIMIT_S, machine.kill)  # a machine that hangs may say nothing at all
    limit.start()
    try:
        for line in machine.stdout:
            lines.append(line.rstrip())
            print(lines[-1], flush=True)
        return machine.wait(), lines
    finally:
        limit.cancel()
        machine.kill()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--size", default="64x48", help="of the pictures")
    options = parser.parse_args()
    build = options.build.resolve()
    release = kernel_release()
    build_modules(build / "gpio/modules", release)
    make_root(build / "gpio/root", build, release, options.size)
    pack(build / "gpio/root", build / "gpio/initrd.gz")
    begun = time.monotonic()
    code, lines = boot(release, build / "gpio/initrd.gz")
    passed, failed = (sum(line.startswith(word) for line in lines) for word in ("pass  ", "FAIL"))
    print(f"kernel {release}, {time.monotonic() - begun:.0f} s in the machine: {passed} passed, {failed} failed")
    return 0 if code == 1 and failed == 0 and passed > 0 else 1  # QEMU ends with 2 * 0 + 1


if __name__ == "__main__":
    sys.exit(main())

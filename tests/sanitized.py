#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `make sanitize` runs under the address, undefined-behaviour and unsigned-overflow sanitizers: the unit tests, the command's own tests,
every scene with every filter, profile and engine at a small size, a stress run, and the identity pictures. A report of a sanitizer
ends the program (-fno-sanitize-recover), so each exit code is also the sanitizer's verdict."""
import argparse
import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = ["facing", "tilted", "grazing", "fig6", "fig7", "fig8", "fig9"]
FILTERS = ["nearest", "bilinear", "three-point", "mip-bilinear", "trilinear", "trilinear3", "aniso", "squares", "step", "hat", "contour"]
PROFILES = ["seed", "compact", "default", "exact"]
EVALUATIONS = 250_000  # a profile: 10^6 in all
MODELS = pathlib.Path("/usr/share/assimp/models")
TEXTURE = "/usr/lib/python3/dist-packages/skimage/data/brick.png"


def run(command, environment, folder=ROOT):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, errors="replace", cwd=folder, env=environment)
    return None if done.returncode == 0 else f"exit code {done.returncode}: {' '.join(map(str, command))}\n{(done.stdout + done.stderr)[-4000:]}"


def renders(spantex, folder):
    """Every scene with every filter, one profile and engine after the other: each pair of them occurs."""
    for s, scene in enumerate(SCENES):
        for f, kind in enumerate(FILTERS):
            for p, profile in enumerate(PROFILES):
                engine = ("direct", "sim")[(s + f + p) % 2]
                map_of = ["--texture", TEXTURE] if s < 3 else []
                yield [spantex, "render", scene, *map_of, "--size", "40x32", "--filter", kind, "--profile", profile, "--engine", engine,
                       "--threads", 1 + (f + p) % 2, "--out", folder / f"{scene}-{kind}-{profile}.png"]
    for model in ("OBJ/spider.obj", "Collada/duck.dae"):
        yield [spantex, "render", MODELS / model, "--size", "40x32", "--psnr", "--out", folder / "model.png"]
    yield [spantex, "render", "fig9", "--size", "40x32", "--frames", "2", "--psnr", "--out", folder / "t-%d.png"]
    yield [spantex, "trace", "tilted", "--texture", TEXTURE, "--size", "40x32", "--vcd", folder / "t.vcd", "--json", folder / "t.json"]


def identity(program, environment):
    done = subprocess.run([program], capture_output=True, text=True, env=environment)
    if done.returncode != 0 or done.stdout != (ROOT / "tests/golden/picture_hashes.txt").read_text():
        return f"exit code {done.returncode}, {'hashes differ' if done.returncode == 0 else done.stderr[-4000:]}"
    return None


def parts(build, suites, environment, folder):
    """Name and the calls that make it up, the longest first."""
    spantex, one = build / "spantex", lambda *command: lambda: run(command, environment)
    yield "unit tests", [one(sys.executable, "tests/run.py", "--build", build, "--only", suite) for suite in suites]
    yield "command_contract", [one("tests/scripts/command_contract.py")]
    yield "command_maps", [one("tests/scripts/command_maps.py")]
    yield "command_bad_input", [one("tests/scripts/command_bad_input.py")]
    yield "stress", [one(spantex, "stress", "--profile", p, "--evaluations", EVALUATIONS) for p in PROFILES]
    yield "identity pictures", [lambda: identity(build / "picture_hashes", environment)]
    yield "every scene", [one(*command) for command in renders(spantex, folder)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/sanitize")
    parser.add_argument("--suites", nargs="+", required=True, help="unit tests")
    options = parser.parse_args()
    build = options.build.resolve()
    environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0", SPANTEX_SHORT="1", SPANTEX_SANITIZED="1", SPANTEX_BUILD=str(build))
    failed = 0
    with tempfile.TemporaryDirectory() as name, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        def timed(call):
            begun = time.monotonic()
            return call(), time.monotonic() - begun
        waiting = [(part, [pool.submit(timed, call) for call in calls]) for part, calls in parts(build, options.suites, environment, pathlib.Path(name))]
        for part, calls in waiting[1:] + waiting[:1]:  # the unit tests end last
            results = [c.result() for c in calls]
            faults = [fault for fault, _ in results if fault]
            failed += bool(faults)
            print(f"{'FAIL' if faults else 'clean'}  {part}: {len(results)} runs, {sum(t for _, t in results):.0f} s", flush=True)
            print("\n".join(faults[:3]), end="\n" if faults else "", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

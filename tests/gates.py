#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proof that the checks bite: each gate breaks one line of a copy of the tree and runs the test that must notice, one gate a processor. A gate that stays
silent fails, and so does a line that is no longer there to break. A gate counts only if its test passes in the unbroken tree, tried once a suite. What does not include the broken file
comes from the build, where it is newer than all it is made of.  --list names them; arguments select by name; --short takes the first gate of each suite and leaves the unbroken tree to
`make test`, which runs the same suites in it."""
import concurrent.futures
import fnmatch
import functools
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
import tempfile
import time

from gate_list import GATES, LIBRARIES

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")).resolve()
CXX = os.environ.get("CXX", "g++")
FLAGS = ["-std=c++20", "-O1", "-I.", "-Ifirmware", "-pthread"]
BEGUN = time.time()  # before the tree is copied
VERDICT_SECONDS = 900  # for machines that do something else too
LINK = ["-lcmocka", "-ldeflate", "-lpng", "-Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc"]


def build_is_ours():
    """Whether the build's objects and those made here go together."""
    note = BUILD / "build.txt"
    return CXX == "g++" and note.exists() and re.match(r"-std=c\+\+20 -O2( -mstringop-strategy=libcall)?, kernels -O3, g\+\+ ", note.read_text().splitlines()[-1])


@functools.cache
def includes(name):
    """What the build's object of a source is made of, by make's own note; None where it is older than some of that, or made since this began."""
    made = (BUILD / name).with_suffix(".o")
    if not build_is_ours() or not made.exists() or not made.with_suffix(".d").exists():
        return None
    note = made.with_suffix(".d").read_text().replace("\\\n", " ").partition(":")[2]
    files = {ROOT / f for f in note.split() if not f.endswith(":")} | {ROOT / "Makefile"}
    age = made.stat().st_mtime
    return {f.resolve() for f in files} if age < BEGUN and all(f.exists() and f.stat().st_mtime <= age for f in files) else None


def test_of(tree, gate, broken):
    """Build and command of the test that must notice, where `broken` is not as it was. Of the proofs, what ties them to the code: the proofs themselves do not read it."""
    suite, case, sources = gate[4:]
    if suite == "scripts":
        return None, ["/usr/bin/python3", str(tree / f"tests/scripts/{case}.py"), "--links"]
    if suite in ("packaging", "licence_headers"):
        return None, ["/usr/bin/python3", str(tree / f"tests/scripts/{suite}.py"), case]
    options = [s for s in sources if s.startswith("-")]

    def part(source):
        of_build = None if any(o.startswith(("-I", "-D")) for o in options) else includes(source)
        made = (BUILD / source).with_suffix(".o")
        return source if of_build is None or made.stat().st_mtime >= BEGUN or (ROOT / broken).resolve() in of_build else str(made)

    program = tree / "program"
    parts = [part(s) for s in (f"tests/unit/{suite}.cpp", *sources) if not s.startswith("-")]
    return [CXX, *FLAGS, *parts, *options, "-o", str(program), *LINK, *LIBRARIES.get(suite, [])], [str(program)]


def outcome(tree, gate, unbroken=False):
    """None if the test fails, or with `unbroken` if it passes; else why not."""
    _, command = test_of(tree, gate, gate[1])
    try:
        ran = subprocess.run(command, env=dict(os.environ, SPANTEX_TEST_FILTER=gate[5], SPANTEX_SHORT="1"), capture_output=True, text=True, errors="replace", timeout=VERDICT_SECONDS)
    except subprocess.TimeoutExpired:
        return f"no verdict within {VERDICT_SECONDS} s"
    said = ran.stdout + ran.stderr
    if "Running 0 test" in said:
        return f"{gate[4]} has no case {gate[5]}"
    if unbroken:
        return None if ran.returncode == 0 else f"{gate[4]}.{gate[5]} fails before anything is broken"
    if gate[4] == "scripts" and not re.search("inputs: not as proved|DOES NOT HOLD|static assertion failed|[1-9][0-9]* differ", said):
        return "no verdict:\n" + said[-2000:]
    if gate[4] == "packaging" and f"packaging: {gate[5]}: " not in said:
        return "no verdict:\n" + said[-2000:]
    return None if ran.returncode != 0 else f"{gate[4]}.{gate[5]} did not notice"


def build_of(tree, gate):
    """What the compiler says if the gate's suite does not build."""
    build, _ = test_of(tree, gate, gate[1])
    built = build and subprocess.run(build, cwd=tree, capture_output=True, text=True)
    return built.stderr if built and built.returncode != 0 else None


def bites(trees, gate):
    """Breaks the gate's line in a tree that nobody else uses now. None if its test notices, else why not."""
    tree = trees.get()
    _, name, old, new = gate[:4]
    path = tree / name
    text = path.read_text()
    try:
        path.write_text(text.replace(old, new))
        refused = build_of(tree, gate)
        if refused is not None:  # a static_assert that refuses is a check that bites
            return None if "static assertion failed" in refused else "does not build:\n" + refused[-2000:]
        return outcome(tree, gate)
    finally:
        path.write_text(text)
        trees.put(tree)


def baseline(trees, gates):
    """Why the tests of a suite's gates cannot be trusted, by case: each must pass in an unbroken tree, built once for all gates of the same parts."""
    tree = trees.get()
    try:
        refused = build_of(tree, gates[0])
        if refused is not None:
            return {g[5]: "does not build unbroken:\n" + refused[-2000:] for g in gates}
        return {case: outcome(tree, next(g for g in gates if g[5] == case), unbroken=True) for case in {g[5] for g in gates}}
    finally:
        trees.put(tree)


def alike(gate):
    """What gates have in common whose tests are one program before anything is broken."""
    build, _ = test_of(pathlib.Path(), gate, gate[1])
    return (gate[4], *(build or []))


def main():
    if "--list" in sys.argv:
        print("\n".join(f"{g[0]}: {g[4]}.{g[5]}" for g in GATES))
        return 0
    short = "--short" in sys.argv
    wanted = [a for a in sys.argv[1:] if a != "--short"] or ["*"]
    gates = [g for g in GATES if any(fnmatch.fnmatch(g[0], w) for w in wanted)]
    if short:
        gates = list({g[5] if g[4] == "scripts" else g[4]: g for g in reversed(gates)}.values())[::-1]
    if not gates:
        print(f"no gate is called {' '.join(wanted)}")
        return 2
    stale = [g for g in GATES if (ROOT / g[1]).read_text().count(g[2]) != 1]
    for g in stale:
        print(f"STALE   {g[0]}: {g[1]}: the line to break stands there {(ROOT / g[1]).read_text().count(g[2])} times")
    if stale:
        return 1
    silent, trees = [], queue.Queue()  # silent: what is said last, as `make test` shows only the end of what a failed script prints
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for k in range(os.cpu_count()):
            tree = pathlib.Path(folder) / str(k)
            for part in ("docs", "firmware", "hal", "sim", "tests", "tools", "zephyr"):
                shutil.copytree(ROOT / part, tree / part)
            for path in ROOT.iterdir():
                if path.is_file() and path.name != ".git":
                    shutil.copy(path, tree)
            trees.put(tree)
        suites = {}
        for g in gates:
            suites.setdefault(alike(g), []).append(g)
        faults = {} if short else dict(zip(suites, pool.map(lambda named: baseline(trees, named), suites.values())))
        for (suite, *_), cases in faults.items():
            for case, fault in cases.items():
                if fault:
                    print(f"BROKEN  {suite}.{case}: {fault}", flush=True)
        sound = [g for g in gates if short or not faults[alike(g)][g[5]]]
        silent += [f"BROKEN  {g[0]}: {g[4]}.{g[5]}" for g in gates if g not in sound]
        sound.sort(key=lambda g: g[4] not in ("scripts", "kernels"))  # what takes longest first
        for gate, reason in zip(sound, pool.map(lambda g: bites(trees, g), sound)):
            if reason is None:
                print(f"bites   {gate[0]}: {gate[4]}.{gate[5]}", flush=True)
            else:
                silent.append(f"SILENT  {gate[0]}: {gate[4]}.{gate[5]}: {reason}")
    print("\n".join([*silent, f"{len(gates) - len(silent)} of {len(gates)} gates bite"]))
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())

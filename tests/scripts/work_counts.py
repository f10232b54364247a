#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What drawing costs, in counts instead of seconds, against committed baselines: a row (scene, filter, profile) whose count differs by more than 1 %,
up or down, fails by name, until the baseline is changed.

  tests/baselines/work.txt          words, reads, divides, skips: the same on every machine, always compared
  tests/baselines/host_instructions.txt  of the scalar engine, by callgrind; they depend on compiler and flags, which the file states: compared where they are the same
  tests/baselines/kernel_instructions.txt  of the host kernels (kernel_instructions.py), likewise; of those that the machine has

tests/scripts/work_counts.py --write makes them anew, on a machine with AVX-512: in a commit of its own, that says why. `make test T=scripts.work_counts`"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import kernel_instructions
import spantex_command as command

BASELINES = command.ROOT / "tests/baselines"
ALLOWED = 0.01
HEADINGS = {
    "work.txt": "# Work on fixed scenes, 96x72, one picture: spantex bench --counts. Checked by tests/scripts/work_counts.py.\n",
    "host_instructions.txt": "# Instructions of the scalar engine on the same pictures, by callgrind; they hold for this build alone.\n",
    "kernel_instructions.txt": "# Instructions of the host kernels, whole draws of 256x16 pixels: tests/counts/kernel_pictures.cpp; they hold for these builds alone.\n",
}
COUNTED_FUNCTION = "*draw_counted_row*"  # tools/spantex/bench_counts.cpp


def fail(text):
    sys.exit(f"work_counts: {text}")


def checked(arguments, environment=None):
    done = subprocess.run(list(map(str, arguments)), capture_output=True, text=True, env=environment)
    if done.returncode != 0:
        fail(f"{' '.join(map(str, arguments))}: exit {done.returncode}: {done.stderr[-600:]}")
    return done.stdout


def parse(text):
    """Build, and row -> count name -> number."""
    build, names, rows = None, None, {}
    for line in text.splitlines():
        if line.startswith("# build: "):
            build = line.removeprefix("# build: ")
        elif line.startswith("# row "):
            names = line.split()[2:]
        elif line and not line.startswith("#"):
            row, *numbers = line.split()
            if names is None or len(numbers) != len(names):
                fail(f"not a row of counts: {line}")
            rows[row] = dict(zip(names, map(int, numbers)))
    return build, rows


def work():
    return checked([command.BINARY, "bench", "--counts"])


def inclusive_costs(text):
    """Function -> what it and all it called cost, of a file of callgrind's."""
    names, costs, current = {}, {}, None
    for line in text.splitlines():
        named = re.match(r"(c?fn)=\((\d+)\)(?: (.*))?", line)
        if named:
            if named[3]:
                names[named[2]] = named[3]
            if named[1] == "fn":
                current = names[named[2]]
        elif current and re.match(r"[+*\-0-9]", line):
            costs[current] = costs.get(current, 0) + int(line.split()[-1])
    return costs


def instructions():
    """The same form, of callgrind's one count; None where there is no valgrind."""
    if not shutil.which("valgrind"):
        return None
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        printed = checked(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", f"--toggle-collect={COUNTED_FUNCTION}", 
                           command.BINARY, "bench", "--counts", "--draws-only"], kernel_instructions.SAME_LIBRARY)
        build, *names = printed.splitlines()
        costs = inclusive_costs(out.read_text())
        text = build + "\n# row instructions\n"
        for number, name in enumerate(names):
            found = [cost for function, cost in costs.items() if f"draw_counted_row<{number}ul>" in function]
            if len(found) != 1:
                fail(f"callgrind saw {len(found)} functions of row {number}")
            text += f"{name} {found[0]}\n"
        return text


def differences(baseline, now):
    found = [f"{row}: {'gone' if row in baseline else 'not in the baseline'}" for row in baseline.keys() ^ now.keys()]
    for row in baseline.keys() & now.keys():
        for name, was in baseline[row].items():
            new = now[row].get(name)
            if new is None or abs(new - was) > ALLOWED * was:
                found.append(f"{row}: {name} {was} -> {new}" + (f" ({100 * (new - was) / was:+.1f} %)" if was and new is not None else ""))
    return sorted(found)


def bites(baseline):
    """The comparison itself: every count of every row is missed when 1.1 % more or less, and not when 0.9 %."""
    for row, counts in baseline.items():
        for name, was in counts.items():
            for part, wanted in ((1.011, True), (0.989, True), (1.009, False), (0.991, False)):
                now = was * part if was else (1 if wanted else 0)
                found = differences({row: counts}, {row: {**counts, name: now}})
                if bool(found) != wanted or (wanted and (row not in found[0] or name not in found[0])):
                    fail(f"the comparison does not tell {row}: {name} {was} from {now}: {found}")


def compare(file, text, missing=()):
    build_then, then = parse((BASELINES / file).read_text())
    build_now, now = parse(text)
    bites(then)
    if file != "work.txt" and build_then != build_now:
        print(f"{file}: not compared: baseline of '{build_then}', this is '{build_now}'")
        return []
    then = {row: counts for row, counts in then.items() if not row.startswith(tuple(f"{kernel}/" for kernel in missing))}
    found = [f"{file}: {d}" for d in differences(then, now)]
    print(f"{file}: {sum(map(len, now.values()))} counts of {len(now)} rows, {len(found)} differ by more than {100 * ALLOWED:g} %" + "".join(f"; {k} not counted here" for k in missing))
    return found


def write(file, text):
    build, rest = text.split("\n", 1)
    (BASELINES / file).write_text(HEADINGS[file] + (build + "\n" if file != "work.txt" else "") + rest)


def main():
    texts = {"work.txt": work(), "host_instructions.txt": instructions()}
    texts["kernel_instructions.txt"], missing = kernel_instructions.counted()
    if "--write" in sys.argv:
        if texts["host_instructions.txt"] is None or missing:
            fail("--write: valgrind and AVX-512 are needed")
        for file, text in texts.items():
            write(file, text)
        return 0
    if texts["host_instructions.txt"] is None:
        print("valgrind is not installed: the engine's instructions not counted")
    found = [d for file, text in texts.items() if text is not None for d in compare(file, text, missing if file == "kernel_instructions.txt" else ())]
    print("\n".join(found))
    if found:
        print("meant so? tests/scripts/work_counts.py --write, and commit that by itself, saying why")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

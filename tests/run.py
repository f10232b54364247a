#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the tests, a program a processor, and closes with 'N passed, N failed'.

Three kinds, each a suite with named cases:
  unit          build/tests/<suite>: CMocka programs; cases are their tests
  compile_fail  tests/compile_fail/*.cpp: must not compile, and the compiler must say the text after '// expects:'
  scripts       tests/scripts/*: executables, one case each; exit 0 passes
--only SUITE or SUITE.CASE (either may hold * and ?) selects.
"""
import argparse
import concurrent.futures
import fnmatch
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT_S = 2700
LONG_S = 20  # what takes longer says so


def run(command, **kw):
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=ROOT, timeout=LIMIT_S, **kw)
        return done.returncode, done.stdout + done.stderr
    except subprocess.TimeoutExpired:
        return -1, f"no end after {LIMIT_S} s"


def unit_cases(program, build, only_case):
    environment = dict(os.environ, CMOCKA_MESSAGE_OUTPUT="TAP", SPANTEX_BUILD=str(build), SPANTEX_TEST_FILTER=only_case)
    code, text = run([program], env=environment)
    cases = re.findall(r"^(ok|not ok) \d+ - (\S+)", text, re.M)
    results = [(program.name, name, verdict == "ok", text) for verdict, name in cases]
    if code != 0 and all(v == "ok" for v, _ in cases):
        results.append((program.name, "(program)", False, f"exit code {code}\n{text}"))
    return results


def compile_fail_case(source):
    expected = re.search(r"// expects: (.*)", source.read_text())[1].strip()
    code, text = run([os.environ.get("CXX", "g++"), "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I.", "-Ifirmware", str(source)])
    return [("compile_fail", source.stem, code != 0 and expected in text, f"expected to be refused with: {expected}\n{text}")]


def script_case(script, build):
    code, text = run([script], env=dict(os.environ, SPANTEX_BUILD=str(build)))
    return [("scripts", script.stem, code == 0, text)]


def timed(task):
    begun = time.monotonic()
    return task(), time.monotonic() - begun


def programs(folder):
    return [p for p in sorted(folder.glob("*")) if not p.is_dir() and os.access(p, os.X_OK)]


def tasks(build, suite, case, units_alone):
    """What runs side by side: a call a program, each of which returns suite, case, verdict and text of its cases."""
    if not units_alone and fnmatch.fnmatch("compile_fail", suite):
        for source in sorted((ROOT / "tests/compile_fail").glob("*.cpp")):
            if fnmatch.fnmatch(source.stem, case):
                yield lambda source=source: compile_fail_case(source)
    if not units_alone and fnmatch.fnmatch("scripts", suite):
        for script in programs(ROOT / "tests/scripts"):
            if fnmatch.fnmatch(script.stem, case):
                yield lambda script=script: script_case(script, build)
    for program in programs(build / "tests"):
        if fnmatch.fnmatch(program.name, suite):
            yield lambda program=program: unit_cases(program, build, case)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--only", default="*", metavar="SUITE[.CASE]")
    parser.add_argument("--units", action="store_true", help="unit tests only")
    options = parser.parse_args()
    options.build = options.build.resolve()
    suite, _, case = options.only.partition(".")
    passed = failed = 0
    begun = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for results, seconds in pool.map(timed, tasks(options.build, suite, case or "*", options.units)):
            for name, test, good, text in results:
                passed, failed = passed + good, failed + (not good)
                print(f"{'pass' if good else 'FAIL'}  {name}.{test}", flush=True)
                if not good:
                    print("\n".join("      " + line for line in text.splitlines()[-60:]), flush=True)
            if results and seconds >= LONG_S:
                print(f"      {results[0][0]}{'' if len(results) > 1 else '.' + results[0][1]} took {seconds:.0f} s", flush=True)
    if passed + failed == 0:
        print(f"tests/run.py: nothing matches '{options.only}'", file=sys.stderr)
        return 2
    print(f"{time.monotonic() - begun:.0f} s")
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

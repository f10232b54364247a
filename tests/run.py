#!/usr/bin/env python3
"""Runs the tests and closes with 'N passed, N failed'.

Three kinds, each a suite with named cases:
  unit          build/tests/<suite>: CMocka programs; cases are their tests
  compile_fail  tests/compile_fail/*.cpp: must not compile, and the compiler must say the text after '// expects:'
  scripts       tests/scripts/*: executables, one case each; exit 0 passes
--only SUITE or SUITE.CASE (either may hold * and ?) selects.
"""
import argparse
import fnmatch
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT_S = 1800


def run(command, **kw):
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=ROOT, timeout=LIMIT_S, **kw)
        return done.returncode, done.stdout + done.stderr
    except subprocess.TimeoutExpired:
        return -1, f"no end after {LIMIT_S} s"


def unit_cases(build, only_suite, only_case):
    for program in sorted((build / "tests").glob("*")):
        if program.is_dir() or not os.access(program, os.X_OK) or not fnmatch.fnmatch(program.name, only_suite):
            continue
        environment = dict(os.environ, CMOCKA_MESSAGE_OUTPUT="TAP", SPANTEX_BUILD=str(build), SPANTEX_TEST_FILTER=only_case)
        code, text = run([program], env=environment)
        cases = re.findall(r"^(ok|not ok) \d+ - (\S+)", text, re.M)
        for verdict, name in cases:
            yield program.name, name, verdict == "ok", text
        if code != 0 and all(v == "ok" for v, _ in cases):
            yield program.name, "(program)", False, f"exit code {code}\n{text}"


def compile_fail_cases(only_case):
    for source in sorted((ROOT / "tests/compile_fail").glob("*.cpp")):
        if not fnmatch.fnmatch(source.stem, only_case):
            continue
        expected = re.search(r"// expects: (.*)", source.read_text())[1].strip()
        code, text = run([os.environ.get("CXX", "g++"), "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-I.", "-Ifirmware", str(source)])
        passed = code != 0 and expected in text
        yield "compile_fail", source.stem, passed, f"expected to be refused with: {expected}\n{text}"


def script_cases(build, only_case):
    for script in sorted((ROOT / "tests/scripts").iterdir()):
        if script.is_dir() or not os.access(script, os.X_OK) or not fnmatch.fnmatch(script.stem, only_case):
            continue
        code, text = run([script], env=dict(os.environ, SPANTEX_BUILD=str(build)))
        yield "scripts", script.stem, code == 0, text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--only", default="*", metavar="SUITE[.CASE]")
    parser.add_argument("--units", action="store_true", help="unit tests only")
    options = parser.parse_args()
    options.build = options.build.resolve()
    suite, _, case = options.only.partition(".")
    case = case or "*"
    groups = []
    if not options.units and fnmatch.fnmatch("compile_fail", suite):
        groups.append(compile_fail_cases(case))
    groups.append(unit_cases(options.build, suite, case))
    if not options.units and fnmatch.fnmatch("scripts", suite):
        groups.append(script_cases(options.build, case))
    passed = failed = 0
    begun = time.monotonic()
    for group in groups:
        for name, test, good, text in group:
            passed, failed = passed + good, failed + (not good)
            print(f"{'pass' if good else 'FAIL'}  {name}.{test}", flush=True)
            if not good:
                print("\n".join("      " + line for line in text.splitlines()[-60:]), flush=True)
    if passed + failed == 0:
        print(f"tests/run.py: nothing matches '{options.only}'", file=sys.stderr)
        return 2
    print(f"{time.monotonic() - begun:.0f} s")
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

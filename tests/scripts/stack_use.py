#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Stack below the calls of the C interface that draw, and that set up maps and targets, on an emulated Cortex-M0+, found by painting it (tests/stack_use): never more than tools/size_report computes from the same
object file's call graph, and near enough to it that the call graph's worst is met and not imagined."""
import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("size_report", str(ROOT / "tools/size_report"))
size_report = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(size_report)
targets = size_report.targets
LEAST_MET = 0.8  # of the deepest call
LEAST_DRAWN = 20


def main():
    core = targets.named("M0+")
    targets.require(core.compiler, core.emulator)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        library = size_report.compiled("C interface", [], folder)
        computed = size_report.stack_of_calls(library, size_report.linked(library))
        program = targets.build(core, "tests/stack_use/main.cpp", folder / "program.elf", options=[library])
        lines = [line.split() for line in targets.emulate(core, program).splitlines()]
    failed = []
    for name, deepest, drawn in lines:
        met, bound = int(deepest, 16), computed[name][0]
        print(f"{name}: {met} bytes met, {bound} computed, {int(drawn, 16)} pictures")
        failed += [f"{name}: more than computed"] if met > bound else []
        failed += [f"{name}: too few pictures"] if int(drawn, 16) < LEAST_DRAWN else []
    if max(int(deepest, 16) for _, deepest, _ in lines) < LEAST_MET * max(bound for bound, _ in computed.values()):
        failed.append("the deepest call was not met")
    sys.exit("\n".join(failed) or 0)


main()

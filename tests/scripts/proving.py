# SPDX-License-Identifier: Apache-2.0
"""What proofs.py and footprint_proofs.py share: the library asked through tests/identity, random numbers that reach the ends of their ranges, the
solver, and the order of a run: formulas against the C++, enumerations, proofs."""
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

from z3 import Not, Solver, sat, unsat

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIMIT_MS = 60_000


class Library:
    """A program of tests/identity, built and run."""

    def __init__(self, folder, source):
        self.program = pathlib.Path(folder) / "steps"
        subprocess.run([os.environ.get("CXX", "g++"), "-std=c++20", "-O1", "-I.", "-Ifirmware", f"tests/identity/{source}", "-o", self.program], cwd=ROOT, check=True)
        lines = subprocess.run([self.program], input="", capture_output=True, text=True, check=True).stdout.split("end\n")[0].splitlines()
        self.constants = {name: (int(low), int(high)) for name, low, high in map(str.split, lines)}

    def answers(self, questions):
        text = "".join(" ".join(map(str, q)) + "\n" for q in questions)
        done = subprocess.run([self.program], input=text, capture_output=True, text=True, check=True).stdout
        return [list(map(int, line.split())) for line in done.split("end\n")[1].splitlines()]


class Numbers(random.Random):
    def any(self, bits):
        """Every magnitude alike, either sign."""
        return self.choice((-1, 1)) * self.getrandbits(self.randint(0, bits))

    def within(self, limit, weights):
        """Numbers whose weighted magnitudes sum to at most limit, often just."""
        left, out = limit, []
        for w in self.sample(weights, len(weights)):
            x = self.choice((left, self.randint(0, left), 0)) // w
            left -= x * w
            out.append((w, self.choice((-1, 1)) * x))
        return [next(out.pop(i)[1] for i, (v, _) in enumerate(out) if v == w) for w in list(weights)]


def compare(library, pairs, enough=lambda answers: True):
    """Whether the C++ answers every question as the formulas do, and, told by `enough`, on inputs worth it."""
    wrong, answers = {}, library.answers(question for question, _ in pairs)
    for (question, expected), got in zip(pairs, answers, strict=True):
        if got != expected:
            wrong.setdefault(question[0], f"{' '.join(map(str, question))}\n    C++    {got}\n    proved {expected}")
    print(f"{len({q[0] for q, _ in pairs})} steps, {len(pairs)} inputs: {'not as proved: ' + ', '.join(wrong) if wrong else 'formulas equal the C++'}")
    print("\n".join(wrong.values()), end="\n" if wrong else "")
    return not wrong and enough(answers)


def outcome(*assertions):
    solver = Solver()
    solver.set("timeout", LIMIT_MS)
    solver.add(*assertions)
    return solver.check()


def prove(proofs, constants):
    """Each case: what is given, the key precondition, the claim. Without the key there must be a counterexample, not merely no proof."""
    wrong = 0
    for step in proofs:
        begun, cases = time.monotonic(), list(step(constants))
        proved = sum(outcome(*valid, *key, Not(good)) == unsat for valid, key, good in cases)
        valid, _, good = cases[-1]
        bites = outcome(*valid, Not(good)) == sat
        wrong += not (proved == len(cases) and bites)
        print(f"{step.__name__[7:]:28} {'proved' if proved == len(cases) else 'NOT PROVED'} ({proved} of {len(cases)}), "
              f"{'fails' if bites else 'DOES NOT FAIL'} without its precondition, {time.monotonic() - begun:.1f} s", flush=True)
    return wrong


def run(source, compared, enumerations, proofs):
    """Of tests/identity/`source`: `compared` and the enumerations take the library; 1 if anything is wrong."""
    with tempfile.TemporaryDirectory() as folder:
        library = Library(folder, source)
        wrong = not compared(library)
        for step in enumerations:
            verdict = step(library)
            wrong += not verdict
            print(f"{step.__name__[11:]:28} {'holds' if verdict else 'DOES NOT HOLD'} for every case", flush=True)
        if "--links" not in sys.argv:
            wrong += prove(proofs, library.constants)
    return 1 if wrong else 0

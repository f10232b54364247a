#!/usr/bin/env python3
"""Proof that the checks bite: each gate breaks one line of a copy of the tree and runs the test that must notice. A gate that stays
silent fails, and so does a line that is no longer there to break.  --list names them; arguments select by name."""
import fnmatch
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
F = "firmware/spantex/"

# name, file, what stands there, what it is broken into, suite, case, further sources the suite links
GATES = [
    ("one Newton step less", F + "reciprocal.hpp", "return newton_step(m, y);", "return y;", "reciprocal", "wide_reciprocal*", []),
    ("one bit less in the reciprocal", F + "reciprocal.hpp", "y = newton_step(m, y);\n  return newton_step(m, y);",
     "y = newton_step(m, y);\n  return newton_step(m, y) & ~7u;", "reciprocal", "wide_reciprocal*", []),
    ("one bit less in 1/w", F + "coordinates.hpp", "const uint64_t y = reciprocal_wide(w << (31 - bits + below_one));",
     "const uint64_t y = reciprocal_wide(w << (31 - bits + below_one)) & ~0xFFFFull;", "coordinates", "exact_profile*", []),
    ("truncated quotients", F + "reciprocal.hpp", "(product + (uint64_t(1) << (shift - 1))) >> shift", "product >> shift", "reciprocal", "quotients*", []),
    ("truncated positions", F + "datapath.hpp", "return int32_t(scale_down(int64_t(u.raw()), decltype(u)::fraction_bits + level - bits, mode));",
     "return int32_t(scale_down(int64_t(u.raw()), decltype(u)::fraction_bits + level - bits, (void(mode), rounding::floor)));", "conformance", "exact_conforms_with*", ["sim/verifier.cpp"]),
    ("texel centres off by half", F + "datapath.hpp", "const auto u = position - half_texel_of(level);",
     "const auto u = position - half_texel{};", "conformance", "exact_conforms_at*", ["sim/verifier.cpp"]),
    ("wrong tie rule of edges", F + "coverage.hpp", "dy < 0 || (dy == 0 && dx > 0)", "dy < 0 || dy == 0", "coverage", "a_square*", []),
    ("no tie rule of edges", F + "coverage.hpp", "(top_left ? 0 : 1)", "0 * top_left", "coverage", "fans*", []),
    ("swapped banks", F + "local_memory.hpp", "fine_[channel][parity_banks::bank(x, y)][block] = value;",
     "fine_[channel][parity_banks::bank(y, x)][block] = value;", "local_memory_banks", "every_fetch*", []),
    ("output switch without its second bit", F + "local_memory.hpp", "return (select & 2) ?", "return false ?", "local_memory_banks", "every_fetch*", []),
    ("truncated colours", F + "filter.hpp", "uint8_t(round_off(c.value, c.bits, q.colour_rounding))", "uint8_t(c.value >> c.bits)", "filter", "*within_1_lsb*", []),
    ("weights that do not sum to one", F + "filter.hpp", "return a * ((1u << weight_bits) - f) + b * f;", "return a * ((1u << weight_bits) - 1 - f) + b * f;",
     "filter", "a_constant*", []),
    ("level off by one bit", F + "level.hpp", "level -= 2 * (log2_16", "level -= 1 * (log2_16", "level", "exact_profile*", []),
    ("nearest level rounded up on ties", F + "level.hpp", "((level + half + (1 << level_bits) - 1) >> level_bits) - 1", "(level + half) >> level_bits", "level", "the_nearest*", []),
    ("section one texel short", F + "plan.hpp", "const int32_t neighbour = c.kind == filter::nearest ? 0 : 1;", "const int32_t neighbour = 0;", "plan", "spans_equal*power*", []),
    ("sections not widened for rounding", F + "coordinates.hpp", "return int32_t(2 * bound >> (error_unit_log2 - 16)) + 2;", "(void)bound; return -6;", "plan",
     "jobs_hold*", []),
    ("wrap off by one", F + "wrap.hpp", "return k < size ? k : period - 1 - k;", "return k < size ? k : period - k;", "wrap", "*", []),
    ("halves of the engine not told apart", "hal/direct_engine.hpp", "one_half& x = halves_[int(h)];\n    SPANTEX_TRY(x.life.may_load());\n    return x.texels",
     "one_half& x = halves_[0];\n    SPANTEX_TRY(x.life.may_load());\n    return x.texels", "draw", "*", []),
    ("ownership not checked", "hal/engine.hpp", "if (busy_) return status::half_busy;\n    if (!ready_)", "if (!ready_)", "hal_conformance", "*", ["sim/trace.cpp"]),
    ("W = 0 drawn", F + "coverage.hpp", "if (value > 0) mask |=", "if (value >= 0) mask |=", "coverage", "front_masks*", []),
    ("vertices snapped downwards", F + "polygon.hpp", "const int64_t n = x * (int64_t(2) << subpixel_bits) + z,", "const int64_t n = x * (int64_t(2) << subpixel_bits),",
     "polygon", "vertices_snap*", []),
    ("depth test reversed", F + "draw.hpp", "if (z <= stored) continue;", "if (z > stored) continue;", "polygon", "the_nearer*", []),
]

FLAGS = ["-std=c++20", "-O2", "-I.", "-Ifirmware", "-pthread"]
LINK = ["-lcmocka", "-Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc"]


def bites(tree, program, gate):
    """None if the gate bites, else why not."""
    _, name, old, new, suite, case, sources = gate
    path = tree / name
    text = path.read_text()
    if text.count(old) != 1:
        return f"{name}: the line to break stands there {text.count(old)} times"
    path.write_text(text.replace(old, new))
    try:
        built = subprocess.run([os.environ.get("CXX", "g++"), *FLAGS, f"tests/unit/{suite}.cpp", *sources, "-o", str(program), *LINK], cwd=tree,
                               capture_output=True, text=True)
        if built.returncode != 0:  # a static_assert that refuses is a check that bites
            return None if "static assertion failed" in built.stderr else "does not build:\n" + built.stderr[-2000:]
        try:
            ran = subprocess.run([str(program)], env=dict(os.environ, SPANTEX_TEST_FILTER=case), capture_output=True, text=True, errors="replace", timeout=300)
        except subprocess.TimeoutExpired:
            return None
        if "Running 0 test" in ran.stdout + ran.stderr:
            return f"{suite} has no case {case}"
        return None if ran.returncode != 0 else f"{suite}.{case} did not notice"
    finally:
        path.write_text(text)


def main():
    if "--list" in sys.argv:
        print("\n".join(f"{g[0]}: {g[4]}.{g[5]}" for g in GATES))
        return 0
    wanted = sys.argv[1:] or ["*"]
    silent = 0
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder)
        for part in ("firmware", "hal", "sim", "tests"):
            shutil.copytree(ROOT / part, tree / part)
        for gate in GATES:
            if not any(fnmatch.fnmatch(gate[0], w) for w in wanted):
                continue
            reason = bites(tree, tree / "program", gate)
            silent += reason is not None
            print(f"{'bites ' if reason is None else 'SILENT'}  {gate[0]}: {gate[4]}.{gate[5]}{'' if reason is None else ': ' + reason}", flush=True)
    return 1 if silent else 0


if __name__ == "__main__":
    sys.exit(main())

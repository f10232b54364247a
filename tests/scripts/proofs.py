#!/usr/bin/python3
"""Bit-vector proofs (z3) of the steps whose domain is too large to enumerate: no intermediate overflows for any valid input, and the
claims the code relies on hold. Each is a search for a counterexample in arithmetic wider than the code's; 'unsat' proves the step.
The formulas are those of the headers named. Each is tried again without its key precondition and must then fail."""
import sys
import time

from z3 import And, BitVec, BitVecVal, If, Implies, Int, Not, Solver, ULT, unsat

LIMIT_MS = 60_000


def fits_signed(x, bits, width):
    low, high = BitVecVal(-(1 << (bits - 1)), width), BitVecVal((1 << (bits - 1)) - 1, width)
    return And(x >= low, x <= high)


def newton_step():
    """reciprocal.hpp newton_step: y (e >> 32) fits 64 bits and the result 33, given that y errs by at most 2^-6 relative: |e| <= 2^57."""
    y, e, p = Int("y"), Int("e"), Int("p")
    size = lambda x: If(x < 0, -x, x)
    high = e / (1 << 32)
    valid = [y >= 1 << 31, y < 1 << 32, size(p) <= (1 << 32) * size(high)]  # p = y high
    result = y + p / (1 << 31)
    return valid, [size(e) <= 1 << 57], And(size(p) < 1 << 63, result > 0, result < 1 << 33)


def quotient():
    """reciprocal.hpp quotient: (|n| >> drop) y plus half a unit fits 64 bits without sign."""
    W = 72
    n, y, shift = BitVec("n", W), BitVec("y", W), BitVec("shift", W)
    valid = [n >= 0, y >= 0, y < 1 << 32, shift >= 1, shift <= 63]
    total = n * y + (BitVecVal(1, W) << (shift - 1))
    return valid, [n < 1 << 31], And(total >= 0, ULT(total, BitVecVal(1 << 64, W)))


def pixel_numerator():
    """coordinates.hpp position_at: c + a hx + b hy fits 32 bits when |c| + 7 (|a| + |b|) <= 2^30 + 2^5."""
    W = 48
    c, a, b, hx, hy = (BitVec(k, W) for k in ("c", "a", "b", "hx", "hy"))
    size = lambda x: If(x < 0, -x, x)
    small = [fits_signed(k, 32, W) for k in (c, a, b)]
    valid = small + [hx >= -7, hx <= 7, hy >= -7, hy <= 7]
    return valid, [size(c) + 7 * (size(a) + size(b)) <= (1 << 30) + 32], fits_signed(c + a * hx + b * hy, 32, W)


def relative_w():
    """coordinates.hpp w_at: |7g| + |7h| < 1/2 - 1/256 and the rounding error keep w, as fixed point, in (1/2, 3/2): the top bit that
    reciprocal_of_w expects is there."""
    W = 40
    g, h, hx, hy = (BitVec(k, W) for k in ("g", "h", "hx", "hy"))
    size = lambda x: If(x < 0, -x, x)
    R = 30
    valid = [hx >= -7, hx <= 7, hy >= -7, hy <= 7, fits_signed(g, 32, W), fits_signed(h, 32, W)]
    w = (1 << R) + g * hx + h * hy
    bound = (1 << (R - 1)) - (1 << (R - 8)) + 30
    return valid, [7 * (size(g) + size(h)) <= bound], And(w > 1 << (R - 1), w < 3 << (R - 1))


def position():
    """coordinates.hpp coordinate_at: n / w plus half a unit fits 64 bits for every shift the formats allow."""
    W = 72
    n, r, shift = BitVec("n", W), BitVec("r", W), BitVec("shift", W)
    valid = [fits_signed(n, 32, W), r >= 0, shift >= 1, shift <= 62]
    return valid, [r <= 1 << 31], fits_signed(n * r + (BitVecVal(1, W) << (shift - 1)), 64, W)


def on_level():
    """datapath.hpp on_level, sizes that do not halve: u ratio - half texel plus half a unit fits 64 bits, the result 32 bits."""
    W = 80
    u, ratio, level, bits = (BitVec(k, W) for k in ("u", "ratio", "level", "bits"))
    valid = [fits_signed(u, 32, W), ratio > 0, level >= 0, level <= 12, bits >= 1, bits <= 8]
    shift = 47 + level - bits
    total = u * ratio - (BitVecVal(1, W) << (46 + level)) + (BitVecVal(1, W) << (shift - 1))
    return valid, [ratio <= 1 << 31], And(fits_signed(total, 64, W), fits_signed(total >> shift, 32, W))


def blend():
    """filter.hpp interpolated: colours up to M, weights that sum to 2^8, give at most M 2^8, and never less than the smaller one; so three in
    a row stay within 255 2^24."""
    a, b, f, value, most, least = (Int(k) for k in ("a", "b", "f", "value", "most", "least"))
    valid = [least >= 0, most <= 255 << 16, a >= least, b >= least, a <= most, b <= most, f >= 0]
    valid += [Implies(f == k, value == a * (256 - k) + b * k) for k in range(256)]  # linear for each weight
    return valid, [f < 256], And(value <= 256 * most, value >= 256 * least)


def reference():
    """coordinates.hpp reference_at: rebased numerators and their sum fit 64 bits for any plane within its documented bounds."""
    nu, a, b, w, g, h, base = (Int(k) for k in ("nu", "a", "b", "w", "g", "h", "base"))
    size = lambda x: If(x < 0, -x, x)
    # within 16 pixels outside the region; slopes times at least 33 half pixels are part of the bound
    valid = [size(nu) <= 1 << 59, 33 * size(a) <= 1 << 59, 33 * size(b) <= 1 << 59, w > 0, w <= 1 << 45, 33 * size(g) <= 1 << 45,
             33 * size(h) <= 1 << 45]
    # base w, base g, base h: bounded products, by monotonicity of |base| <= 2^15
    bw, bg, bh = Int("bw"), Int("bg"), Int("bh")
    products = [size(bw) <= (1 << 15) * w, size(bg) <= (1 << 15) * size(g), size(bh) <= (1 << 15) * size(h)]
    c, ra, rb = nu - bw, a - bg, b - bh
    limit = 1 << 63
    good = And(size(c) < limit, size(c) + 7 * (size(ra) + size(rb)) < limit)
    return valid, products, good


def level_terms():
    """level.hpp span_levels: squares of the gradients, summed, fit 64 bits; from |c| + 7(|a| + |b|) <= 2^30 + 32 and slopes below 1/14."""
    a, b, c, ag, ah, bg, cg = (Int(k) for k in ("a", "b", "c", "ag", "ah", "bg", "cg"))
    size = lambda x: If(x < 0, -x, x)
    valid = [size(c) + 7 * (size(a) + size(b)) <= (1 << 30) + 32]
    slopes = [14 * size(p) <= size(x) + 14 for p, x in ((ah, a), (bg, b), (cg, c))]
    gradient = size(a - cg) + 7 * size(ah - bg)
    return valid, slopes, gradient < 1 << 31


STEPS = [newton_step, quotient, pixel_numerator, relative_w, position, on_level, blend, reference, level_terms]


def holds(valid, key, good):
    solver = Solver()
    solver.set("timeout", LIMIT_MS)
    solver.add(*valid, *key, Not(good))
    return solver.check() == unsat


def main():
    wrong = 0
    for step in STEPS:
        begun = time.monotonic()
        valid, key, good = step()
        proved, bites = holds(valid, key, good), not holds(valid, [], good)
        wrong += not (proved and bites)
        print(f"{step.__name__:16} {'proved' if proved else 'NOT PROVED'}, {'fails' if bites else 'DOES NOT FAIL'} without its precondition, "
              f"{time.monotonic() - begun:.1f} s", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

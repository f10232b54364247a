#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Bit-vector proofs (z3) of the steps whose domain is too large to enumerate: no intermediate overflows for any valid input, and the
claims the code relies on hold. Each is a search for a counterexample in arithmetic wider than the code's; 'unsat' proves the step. Each
is tried again without its key precondition and must then fail.

What ties them to the C++: the word lengths come from is_valid() and the headers' constants, printed by tests/identity/steps.cpp when this
runs; and every formula that is proved is evaluated here and by that program on the same random and extreme numbers, which must be equal.
--links makes these comparisons only."""
import itertools
import math
import sys
from fractions import Fraction

from proving import Numbers, compare, run
from z3 import And, BitVec, BitVecVal, If, Implies, Int, Or, Real, ULT, is_bv, is_expr

AFFINE, SERIES, DIVIDE = range(3)  # evaluation
TRIALS = 4000


# --- formulas: of integers and of z3's terms alike ---------------------------------------------------------


def power(n):
    """2^n."""
    return BitVecVal(1, n.size()) << n if is_bv(n) else 1 << n


def select(condition, a, b):
    return If(condition, a, b) if is_expr(condition) else a if condition else b


def size(x):
    return select(x < 0, -x, x)


def nearest(x, shift):
    """bits.hpp shift_right: halves up."""
    return (x + power(shift - 1)) >> shift


def newton_next(y, high_product):
    """reciprocal.hpp newton_step, given y (error >> 32)."""
    return y + (high_product / (1 << 31) if is_expr(high_product) else high_product >> 31)


def quotient_sum(n, y, shift):
    return n * y + power(shift - 1)


def numerator(c, a, b, hx, hy):
    return c + a * hx + b * hy


def relative_w(R, g, h, hx, hy):
    return (1 << R) + g * hx + h * hy


def position_sum(n, r, shift):
    """coordinates.hpp coordinate_at, shift > 0."""
    return n * r + power(shift - 1)


def floored(x, shift):
    """x >> shift, or to the left."""
    return x * power(-shift) if shift < 0 else x / power(shift) if is_expr(x) else x >> shift


def series_next(e16, product, s):
    """coordinates.hpp series_of, product = e16 q."""
    return e16 - floored(product, 14 - s)


def series_numerator(n, product, s, D):
    """coordinates.hpp numerator_by_series, product = (n >> D) q."""
    return n - floored(product, 14 - s - D)


def level_terms(e16, square, s):
    """level.hpp power_log2_of_series: t."""
    return e16 - floored(square, 15 - s)


def on_level_sum(product, level, bits):
    """datapath.hpp on_level, product = u ratio: what is shifted by 47 + level - bits."""
    return product - power(46 + level) + power(46 + level - bits)


def interpolated(a, b, f, bits):
    return a * ((1 << bits) - f) + b * f


def rebased(n, base, w):
    return n - base * w


def gradients(a, b, c, ah, bg, cg, ch):
    """level.hpp span_levels: of u or v by x and by y at hx = hy = 0, and what a half pixel adds."""
    return a - cg, b - ch, ah - bg


# --- the same steps, whole, in integers: what the C++ must give --------------------------------------------


class Model:
    def __init__(self, constants):
        self.k = constants
        self.seeds = [constants[f"seed_{k}"][0] for k in range(128)]
        self.knots = [constants[f"knot_{k}"][0] for k in range(64)]

    def newton_step(self, m, y):
        return min(newton_next(y, y * (((1 << 63) - m * y) >> 32)), 0xFFFFFFFF)

    def reciprocal_wide(self, m):
        return self.newton_step(m, self.newton_step(m, self.seeds[m >> 24 & 127] << 16))

    def reciprocal_narrow(self, m):
        y = self.seeds[m >> 8 & 127]
        return min(y + ((y * (((1 << 31) - m * y) >> 16)) >> 15), 0xFFFF)

    def reciprocal_of_w(self, w, bits):
        below = int(w >> bits == 0)
        whole, unit = (16, self.reciprocal_narrow) if bits <= 15 else (32, self.reciprocal_wide)
        y, drop = unit(w << (whole - 1 - bits + below)), whole - bits - below
        return nearest(y, drop) if drop > 0 else y

    def invert(self, w):
        exponent = w.bit_length() - 32
        return self.reciprocal_wide(w >> exponent if exponent >= 0 else w << -exponent), exponent

    @staticmethod
    def quotient(n, drop, y, exponent, scale):
        shift = 63 + exponent - drop - scale
        if shift > 63:
            return 0
        q = quotient_sum(size(n) >> drop, y, shift) >> shift
        return -q if n < 0 else q

    @staticmethod
    def position(coordinate, reciprocal, how, exponent, base, n, r):
        drop = exponent - coordinate + (reciprocal if how == DIVIDE else 0)
        p = n * r if how == DIVIDE else n
        offset = nearest(p, drop) if drop > 0 else p << -drop
        return max(-(1 << 31), min((1 << 31) - 1, (base << 16) + (offset << (16 - coordinate))))

    @staticmethod
    def on_level(u, ratio, level, bits):
        return on_level_sum(u * ratio, level, bits) >> (47 + level - bits)

    def reference(self, plane):
        (ux, uy, uc), (vx, vy, vc), (wx, wy, wc) = plane[:3], plane[3:6], plane[6:]
        y, exponent = self.invert(wc)
        out, good = [], 1
        for n, nx, ny in ((uc, ux, uy), (vc, vx, vy)):
            bits, base = size(n).bit_length(), None
            if bits <= wc.bit_length() + 15:
                base = self.quotient(n, max(0, bits - 31), y, exponent, 0)
            if base is None or size(base) > 32768:
                base, good = (-32767 if n < 0 else 32767), 0
            out += [base, rebased(n, base, wc), rebased(nx, base, wx), rebased(ny, base, wy)]
        return [*out, good]

    def span(self, offset, reciprocal, tolerance, plane):
        wx, wy, wc = plane[6:]
        reach, (y, exponent_w) = self.k["reach"][0], self.invert(wc)
        base_u, cu, au, bu, base_v, cv, av, bv, good = self.reference(plane)
        slope = reach * (size(wx) + size(wy))
        extent = max(size(cu) + reach * (size(au) + size(bu)), size(cv) + reach * (size(av) + size(bv)))
        extent_log2 = extent.bit_length() - wc.bit_length() + 1
        if not good or slope >= wc // 2 - wc // 256 or extent_log2 > self.k["max_extent_log2"][0]:
            return [0]
        scale = min(offset - 1 - extent_log2, self.k["max_exponent"][0])
        drop, slope_drop = max(0, extent.bit_length() - 31), max(0, slope.bit_length() - 31)
        mantissas = [self.quotient(n, drop, y, exponent_w, scale) for n in (cu, au, bu, cv, av, bv)]
        slopes = [self.quotient(n, slope_drop, y, exponent_w, reciprocal) for n in (wx, wy)]
        rounded = reach * sum(map(size, slopes))
        s = max(rounded.bit_length() - reciprocal, self.k["least_slope_log2"][0])
        steep = s > self.k["most_series_slope_log2"][0]
        how, terms = DIVIDE, 1
        if rounded == 0 or extent_log2 + s + 1 + steep <= -tolerance:
            how = AFFINE
        elif not steep and offset - 1 - scale + s <= 11 - tolerance:
            enough = [k for k in range(1, self.k["most_series_terms"][0] + 1) if extent_log2 + s * (k + 1) + 1 <= -tolerance - 1]
            if enough:
                how, terms = SERIES, enough[0]
        return [1, base_u, base_v, *mantissas, *slopes, scale, how, s, terms]

    @staticmethod
    def by_series(offset, reciprocal, s, terms, e, n):
        e16 = q = floored(e, reciprocal + s - 14)
        for _ in range(terms - 1):
            q = series_next(e16, e16 * q, s)
        D = max(0, offset - 15)
        return [e16, q, series_numerator(n, floored(n, D) * q, s, D)]

    def level_series(self, e16, s, times):
        return floored(level_terms(e16, e16 * e16, s) * self.k["level_factor"][0], 13 - times - s)

    def log2_16(self, x):
        n = x.bit_length() - 1
        f = x >> (n - 22) if n >= 22 else x << (22 - n)
        k, t = f >> 16 & 63, f & 0xFFFF
        high = 65536 if k == 63 else self.knots[k + 1]
        return (n << 16) + self.knots[k] + (((high - self.knots[k]) * t + 0x8000) >> 16)

    def term(self, du, dv, exponent):
        square = du * du + dv * dv
        x = self.log2_16(square) // 2 + ((1 - exponent) << 16) if square else -(32 << 16)
        return max(-32 * 1024, min(32 * 1024 - 1, nearest(x, 6)))

    def levels(self, reciprocal, exponent, u, v, g, h):
        def slope(x, s):
            return nearest(x * s, reciprocal) if x * s >= 0 else -nearest(-x * s, reciprocal)
        (ux, uy, tu), (vx, vy, tv) = (gradients(a, b, c, slope(a, h), slope(b, g), slope(c, g), slope(c, h)) for c, a, b in (u, v))
        halves = [2 * k - self.k["reach"][0] for k in range(8)]
        return [self.term(ux + tu * k, vx + tv * k, exponent) for k in halves] + [self.term(uy - tu * k, vy - tv * k, exponent) for k in halves]


# --- comparison with the C++ --------------------------------------------------------------------------------


def plane_about(rng):
    """A plane within its documented bounds about a point where W > 0: numerators near a rational of moderate size."""
    w_bits = rng.randint(1, 45)
    w = rng.getrandbits(w_bits) | 1 << (w_bits - 1)
    steep = rng.randint(0, 40)
    wx, wy = (rng.any(max(0, w_bits - 4 - rng.choice((0, 1, 3, steep)))) for _ in range(2))
    if rng.random() < 0.3:  # at the planner's limit, and by a little beyond
        slope = max(0, (w // 2 - w // rng.choice((256, 256, 300, 480)) + rng.randint(-8, 8)) // 7)
        wx = rng.choice((slope, rng.randint(0, slope))) * rng.choice((-1, 1))
        wy = (slope - size(wx)) * rng.choice((-1, 1))
    out = []
    for _ in range(2):
        base = rng.choice((rng.any(15), 0, rng.any(15), 32767, -32767, 32768, 40000))
        spread = rng.randint(0, 13) - rng.choice((0, 0, 8, 30))
        small = lambda: rng.any(max(0, w_bits + spread))  # noqa: E731
        c = rng.choice((small(), w // 2, -(w // 2), rng.any(w_bits)))
        out += [max(-(1 << 54), min(1 << 54, base * wx + small())), max(-(1 << 54), min(1 << 54, base * wy + small())), base * w + c]
    return [*out, wx, wy, w]


def links(library, trials):
    """Pairs of a question to the C++ and the answer of the formulas here."""
    k, model, rng = library.constants, Model(library.constants), Numbers(5)
    pick = lambda name: rng.choice((k[name][0], k[name][1], rng.randint(*k[name])))  # noqa: E731
    odd = lambda: rng.choice((-7, 7, rng.randrange(-7, 8, 2)))  # noqa: E731
    for _ in range(trials):
        m = rng.choice((1 << 31, (1 << 32) - 1, rng.getrandbits(31) | 1 << 31))
        y = min(max((1 << 63) // m + rng.any(26), 1 << 31), (1 << 32) - 1)
        yield ["newton_step", m, y], [model.newton_step(m, y)]
        n, drop = rng.any(62), 0
        drop = max(0, n.bit_length() - 31) + rng.choice((0, 0, 3))
        shift = rng.randint(max(1, (size(n) >> drop).bit_length() + 2), 66)
        exponent = rng.randint(-31, 14)
        yield ["quotient", n, drop, y, exponent, 63 + exponent - drop - shift], [model.quotient(n, drop, y, exponent, 63 + exponent - drop - shift)]
        limit = (1 << 30) + 32
        c, a, b = rng.within(limit, (1, 7, 7))
        hx, hy = odd(), odd()
        pixel = [(hx + 7) // 2, (hy + 7) // 2]
        yield ["numerator", c, a, b, *pixel], [numerator(c, a, b, hx, hy)]
        R = pick("reciprocal_bits")
        g, h = rng.within((1 << (R - 1)) - (1 << (R - 8)) + 8, (7, 7))
        w = relative_w(R, g, h, hx, hy)
        yield ["relative_w", R, g, h, *pixel], [w]
        yield ["reciprocal_of_w", w, R], [model.reciprocal_of_w(w, R)]
        CB, how = pick("coordinate_bits"), rng.randint(0, 2)
        exponent = rng.randint(-1, k["max_exponent"][0])
        n, r = rng.any(31), model.reciprocal_of_w(w, R)
        if size(n) < 1 << max(0, exponent + 13):
            base = rng.choice((-32768, 32767, rng.any(15)))
            yield ["position", CB, R, how, exponent, base, n, r], [model.position(CB, R, how, exponent, base, n, r)]
        level, bits = rng.randint(0, k["max_levels"][0] - 1), pick("subtexel_bits")
        u, ratio = rng.choice((-(1 << 31), (1 << 31) - 1, rng.any(31))), rng.choice((1 << 31, 1, rng.randint(1, 1 << 31)))
        yield ["on_level", u, ratio, level, bits], [model.on_level(u, ratio, level, bits)]
        a, b, f = (rng.choice((0, 255 << 16, rng.randint(0, 255 << 16))) for _ in range(2)), 0, rng.randint(0, 255)
        a, b = a
        yield ["interpolated", a, b, f, 8], [interpolated(a, b, f, 8)]
        s, terms = rng.randint(k["least_slope_log2"][0], k["most_series_slope_log2"][0]), rng.randint(1, k["most_series_terms"][0])
        OB, most = pick("offset_bits"), (1 << max(0, R + s)) - 1
        e = rng.choice((most, -most, rng.randint(-most, most)))
        n = rng.choice((-1, 1)) * rng.choice(((1 << (OB - 1)) + 32, rng.randint(0, 1 << (OB - 1))))
        yield ["by_series", OB, R, s, terms, e, n], model.by_series(OB, R, s, terms, e, n)
        e16, s = rng.randint(-(1 << 14), 1 << 14), rng.randint(k["least_slope_log2"][0], k["most_level_slope_log2"][0])
        yield ["level_series", e16, s, terms % 2 + 1], [model.level_series(e16, s, terms % 2 + 1)]
        plane = plane_about(rng)
        yield ["reference", *plane], model.reference(plane)
        OB, T = pick("offset_bits"), pick("tolerance_bits")
        yield ["span", OB, R, CB, T, *plane], model.span(OB, R, T, plane)
        u, v = rng.within(1 << 30, (1, 7, 7)), rng.within(1 << 30, (1, 7, 7))
        exponent = rng.randint(-1, 36)
        yield ["levels", R, exponent, *u, *v, g, h], model.levels(R, exponent, u, v, g, h)


def compared(library):
    pairs = list(links(library, TRIALS))
    spans = [k for k, (question, _) in enumerate(pairs) if question[0] == "span"]
    return compare(library, pairs, lambda answers: sum(answers[k][0] == 1 for k in spans) > TRIALS // 5)


# --- proofs --------------------------------------------------------------------------------------------------
# Each gives: what is given, the key precondition, the claim.


def fits_signed(x, bits, width):
    low, high = BitVecVal(-(1 << (bits - 1)), width), BitVecVal((1 << (bits - 1)) - 1, width)
    return And(x >= low, x <= high)


def proves_newton_step(k):
    """y (e >> 32) fits 64 bits and the result 33, for the largest |e| that a seed or the first step leaves."""
    first = max(abs((1 << 63) - m * (k[f"seed_{n}"][0] << 16)) for n in range(128) for m in ((128 + n) << 24, ((129 + n) << 24) - 1))
    second = (first * first >> 63) + 3 * (1 << 32)  # e^2, the cut of e >> 32 and of the product
    y, e, p = Int("y"), Int("e"), Int("p")
    high = e / (1 << 32)
    valid = [y >= 1 << 31, y < 1 << 32, size(p) <= (1 << 32) * size(high)]  # p = y high
    result = newton_next(y, p)
    yield valid, [size(e) <= max(first, second)], And(size(p) < 1 << 63, result > 0, result < 1 << 33)


def proves_quotient(k):
    """(|n| >> drop) y plus half a unit fits 64 bits without sign."""
    W = 72
    n, y, shift = BitVec("n", W), BitVec("y", W), BitVec("shift", W)
    valid = [n >= 0, y >= 0, y < 1 << 32, shift >= 1, shift <= 63]
    total = quotient_sum(n, y, shift)
    yield valid, [n < 1 << 31], And(total >= 0, ULT(total, BitVecVal(1 << 64, W)))


ODD = range(-7, 8, 2)


def proves_pixel_numerator(k):
    """|c| + 7 (|a| + |b|) <= L keeps c + a hx + b hy within L for every pixel; L = 2^(OB-1) + 2^5 is inside offset_bits for every OB."""
    c, a, b, most = (Int(n) for n in ("c", "a", "b", "most"))
    inside = [size(numerator(c, a, b, hx, hy)) <= most for hx in ODD for hy in ODD]
    limits = all((1 << (OB - 1)) + 32 < 1 << OB for OB in range(k["offset_bits"][0], k["offset_bits"][1] + 1))
    yield [most >= 0], [size(c) + 7 * (size(a) + size(b)) <= most], And(limits, *inside)


def proves_relative_w(k):
    """The planner's condition and the roundings keep w in (1/2, 3/2), so that the top bit is where the reciprocal unit expects it, and the
    slopes in their format: for every R."""
    g, h = Int("g"), Int("h")
    for R in range(k["reciprocal_bits"][0], k["reciprocal_bits"][1] + 1):
        w = [relative_w(R, g, h, hx, hy) for hx in ODD for hy in ODD]
        bound = (1 << (R - 1)) - (1 << (R - 8)) + 8
        good = [And(x > 1 << (R - 1), x < 3 << (R - 1)) for x in w] + [size(g) < 1 << (R - 3), size(h) < 1 << (R - 3)]
        yield [], [7 * (size(g) + size(h)) <= bound], And(*good)


MOST_Q = 22000  # of the series: what |q| <= MOST_Q gives again


def scales(k, last):
    return range(k["least_slope_log2"][0], k[last][0] + 1)


def proves_series_slope(k):
    """coordinates.hpp series_slope: e in 2^(s - 14), floor, is a 16-bit number of at most 2^14, also where it is shifted to the left."""
    e = Int("e")
    for R, s in itertools.product(range(k["reciprocal_bits"][0], k["reciprocal_bits"][1] + 1), scales(k, "most_series_slope_log2")):
        e16 = floored(e, R + s - 14)
        bound = [size(e) * power(max(0, -R - s)) < power(max(0, R + s))]  # |e| < 2^(R + s), exactly
        yield [], bound, And(e16 >= -(1 << 14), e16 < 1 << 14)


def proves_series(k):
    """coordinates.hpp series_of: products fit 32 bits and q 16, whatever the number of terms: MOST_Q holds for one and for the next."""
    e16, q, p = Int("e16"), Int("q"), Int("p")  # p = e16 q
    for s in scales(k, "most_series_slope_log2"):
        valid = [size(q) <= MOST_Q, size(p) <= (1 << 14) * size(q)]
        yield valid, [size(e16) <= 1 << 14], And(size(p) < 1 << 31, size(series_next(e16, p, s)) <= MOST_Q, MOST_Q < 1 << 15)


def proves_series_numerator(k):
    """coordinates.hpp numerator_by_series: n cut to 16 bits, a product of 32, and n' inside offset_bits, for every OB and scale."""
    n, p = Int("n"), Int("p")  # p = (n >> D) q
    for OB, s in itertools.product(range(k["offset_bits"][0], k["offset_bits"][1] + 1), scales(k, "most_series_slope_log2")):
        D = max(0, OB - 15)
        n16 = floored(n, D)
        valid = [size(p) <= MOST_Q * size(n16)]
        good = And(n16 >= -(1 << 15), n16 < 1 << 15, size(p) < 1 << 31, size(series_numerator(n, p, s, D)) < 1 << OB)
        yield valid, [size(n) <= (1 << (OB - 1)) + 32], And(good, 14 - s - D >= 0, 14 - s - D < 32)


def proves_level_series(k):
    """level.hpp power_log2_of_series: t fits 16 bits and its product with the constant 32, for every scale."""
    e16, p = Int("e16"), Int("p")  # p = e16 e16
    for s in scales(k, "most_level_slope_log2"):
        t = level_terms(e16, p, s)
        valid = [p >= 0, p <= (1 << 14) * size(e16), 11 - s < 32]
        yield valid, [size(e16) <= 1 << 14], And(t >= -(1 << 15), t < 1 << 15, size(t) * k["level_factor"][0] < 1 << 31)


def proves_corner_numerator(k):
    """area.hpp position_beside: the same up to 9 half pixels from a span's centre: offset_bits hold |c| + 9 (|a| + |b|) as well."""
    c, a, b, most = (Int(n) for n in ("c", "a", "b", "most"))
    offsets = range(-9, 10)
    inside = [size(numerator(c, a, b, hx, hy)) <= most for hx in offsets for hy in offsets]
    limits = all((1 << (OB - 1)) + 40 < 1 << OB for OB in range(k["offset_bits"][0], k["offset_bits"][1] + 1))
    yield [most >= 0], [size(c) + 9 * (size(a) + size(b)) <= most], And(limits, *inside)


def proves_corner_w(k):
    """area.hpp position_beside: w in (1/2, 3/2) at every corner, 9 half pixels from a span's centre or 2 from a pixel's, and slopes below
    1/2, as their format wants: for every R."""
    g, h = Int("g"), Int("h")
    for far, R in itertools.product((9, 2), range(k["reciprocal_bits"][0], k["reciprocal_bits"][1] + 1)):
        w = [relative_w(R, g, h, hx, hy) for hx in (-far, far) for hy in (-far, far)]  # linear: largest and smallest at a corner
        bound = (1 << (R - 1)) - (1 << (R - 8)) + far + 1
        good = [And(x > 1 << (R - 1), x < 3 << (R - 1)) for x in w] + [size(g) < 1 << (R - 1), size(h) < 1 << (R - 1)]
        yield [], [far * (size(g) + size(h)) <= bound], And(*good)


def proves_swept_area(k):
    """area.hpp swept_area: coordinates up to 2^11 keep every sum within 32 bits. `above`, `slope`: products of two coordinates; the squares
    are at most such a product."""
    above, slope, top, bottom, corner = (Int(n) for n in ("above", "slope", "top", "bottom", "corner"))
    most = 1 << 22
    valid = [above >= 0, above <= most, slope <= most, slope >= -most]
    squares = [And(x >= 0, x <= most << 5) for x in (top, bottom, corner)]
    scaled = (above + slope) * 64
    yield valid, squares, And(scaled + top + bottom + corner < 1 << 31, scaled - top - bottom - corner >= -(1 << 31))


def proves_position(k):
    """n / w plus half a unit fits the 64 bits of position_rep, for every shift downwards (position_shifts gives the range)."""
    W = 72
    n, r, shift = BitVec("n", W), BitVec("r", W), BitVec("shift", W)
    valid = [fits_signed(n, 32, W), r >= 0, shift >= 1, shift <= 62]
    yield valid, [r <= 1 << 31], fits_signed(position_sum(n, r, shift), 64, W)


def proves_on_level(k):
    """u ratio - half texel plus half a unit fits 64 bits, the result 32 bits: for every level and subtexel_bits."""
    u, p = Int("u"), Int("p")  # p = u ratio
    claims = []
    for level, bits in itertools.product(range(k["max_levels"][0]), range(k["subtexel_bits"][0], k["subtexel_bits"][1] + 1)):
        total, limit = on_level_sum(p, level, bits), 1 << min(63, 31 + 47 + level - bits)
        claims.append(And(total >= -limit, total < limit))
    yield [u >= -(1 << 31), u < 1 << 31], [size(p) <= (1 << 31) * size(u)], And(*claims)


def proves_blend(k):
    """Colours up to M, weights that sum to 2^8: at most M 2^8, never less than the smaller one; so three in a row stay within 255 2^24."""
    a, b, f, value, most, least = (Int(n) for n in ("a", "b", "f", "value", "most", "least"))
    valid = [least >= 0, most <= 255 << 16, a >= least, b >= least, a <= most, b <= most, f >= 0]
    valid += [Implies(f == n, value == interpolated(a, b, n, 8)) for n in range(256)]  # linear for each weight
    yield valid, [f < 256], And(value <= 256 * most, value >= 256 * least)


def proves_reference(k):
    """Rebased numerators and their sum fit 64 bits for any plane within its documented bounds."""
    nu, a, b, w, g, h = (Int(n) for n in ("nu", "a", "b", "w", "g", "h"))
    # within 16 pixels outside the region; slopes times at least 33 half pixels are part of the bound
    valid = [size(nu) <= 1 << 59, 33 * size(a) <= 1 << 59, 33 * size(b) <= 1 << 59, w > 0, w <= 1 << 45, 33 * size(g) <= 1 << 45,
             33 * size(h) <= 1 << 45]
    # base w, base g, base h: bounded products, by monotonicity of |base| <= 2^15
    bw, bg, bh = Int("bw"), Int("bg"), Int("bh")
    products = [size(bw) <= (1 << 15) * w, size(bg) <= (1 << 15) * size(g), size(bh) <= (1 << 15) * size(h)]
    c, ra, rb = rebased(nu, 1, bw), rebased(a, 1, bg), rebased(b, 1, bh)
    yield valid, products, And(size(c) < 1 << 63, size(c) + 7 * (size(ra) + size(rb)) < 1 << 63)


def proves_exact_reference(k):
    """coordinates.hpp exact_reference_at: rebased from coefficients of set-up's contract (below 2^110, at the point below 2^125) everything fits
    the 126 bits of `wide`; cut to 45 bits of W and 57 of the slopes, the sums of coordinates_within() fit 64. Held against 128-bit integers in
    tests/unit/coordinates.cpp."""
    n, w, bw, x, g, bg, cut_c, cut_a, cut_b = (Int(name) for name in ("n", "w", "bw", "x", "g", "bg", "cut_c", "cut_a", "cut_b"))
    valid = [size(n) <= 1 << 125, w > 0, w <= 1 << 125, size(x) < 1 << 110, size(g) < 1 << 110, size(bg) <= (1 << 15) * size(g)]
    valid += [size(cut_c) <= (1 << 45) + 1, size(cut_a) <= 1 << 57, size(cut_b) <= 1 << 57]
    fits = And(size(bw) < 1 << 127, size(rebased(n, 1, bw)) < 1 << 126, size(rebased(x, 1, bg)) < 1 << 126)
    yield valid, [size(n - bw) <= w], And(fits, size(cut_c) + 9 * (size(cut_a) + size(cut_b)) < 1 << 63)


def proves_level_terms(k):
    """Gradients stay below 2^31, so their squares, summed, fit 64 bits; from |c| + 7(|a| + |b|) <= 2^30 + 32 and slopes below 1/14."""
    a, b, c, ah, bg, cg, ch = (Int(n) for n in ("a", "b", "c", "ah", "bg", "cg", "ch"))
    valid = [size(c) + 7 * (size(a) + size(b)) <= (1 << 30) + 32]
    slopes = [14 * size(p) <= size(x) + 14 for p, x in ((ah, a), (bg, b), (cg, c), (ch, c))]
    x, y, twist = gradients(a, b, c, ah, bg, cg, ch)
    yield valid, slopes, And(size(x) + 7 * size(twist) < 1 << 31, size(y) + 7 * size(twist) < 1 << 31)


def proves_gradient_is_half_the_slopes(k):
    """With c = 0 the longer of w^2 du/dx, w^2 du/dy is at least half of the longer of a, b: the ground of level_bound() (ACCURACY 8)."""
    g, h, p, q, b = (Real(n) for n in ("g", "h", "p", "q", "b"))  # a = 1 >= |b|; p = 7 hx / 7, q likewise; g and h times 7
    valid = [p >= -1, p <= 1, q >= -1, q <= 1, b >= -1, b <= 1]
    twist = h - b * g
    ux, uy = 1 + twist * q, b - twist * p
    yield valid, [2 * (size(g) + size(h)) < 1], Or(2 * size(ux) >= 1, 2 * size(uy) >= 1)


# --- by enumeration -----------------------------------------------------------------------------------------


def enumerates_quotient_shifts(library):
    """coordinates.hpp: every quotient's shift is at least 1 and its result at most 2^30, for all bit lengths and word lengths."""
    k = library.constants
    top = k["max_extent_log2"][0]
    for w in range(1, 47):
        def good(n, drop, scale):
            shift = 63 + (w - 32) - drop - scale
            return shift > 63 or (shift >= 1 and min(n, 31) + 32 - shift <= 30)
        for n in range(0, 64):
            drop = max(0, n - 31)
            if n <= w + 15 and not good(n, drop, 0):
                return False
            for OB in range(k["offset_bits"][0], k["offset_bits"][1] + 1):
                if n - w + 1 <= top and not good(n, drop, min(OB - 1 - (n - w + 1), k["max_exponent"][0])):
                    return False
                if n <= w and not good(n, drop, min(OB - 2, k["max_exponent"][0])):  # a pixel about itself: |c| <= W/2
                    return False
            if n < w and not all(good(n, drop, R) for R in range(k["reciprocal_bits"][0], k["reciprocal_bits"][1] + 1)):
                return False
    return True


def enumerates_position_shifts(library):
    """coordinates.hpp coordinate_at: for every word length and reach the shift is shorter than position_rep, and product and half a unit, or
    the product scaled up, fit it. |n| <= 2^(OB-1) + 2^5, below 2^OB after a series; 1/w < 2. In words of 32 bits profiles are told apart by longest_position_shift()."""
    k = library.constants
    (c_low, c_high), tolerance = k["coordinate_bits"], k["tolerance_bits"][1]
    for OB, R in itertools.product(*(range(k[n][0], k[n][1] + 1) for n in ("offset_bits", "reciprocal_bits"))):
        if f"width_{OB}_{R}" not in k:
            print(f"  OB {OB} R {R}: tests/identity/steps.cpp and these proofs know no such word lengths")
            return False
        most = (1 << (OB - 1)) + 32
        for extent in range(-45, k["max_extent_log2"][0] + 1):
            exponent = min(OB - 1 - extent, k["max_exponent"][0])
            for CB in range(c_low, c_high + 1):
                shifts = [(exponent - CB, 1 << OB)] + ([(exponent - CB + R, most << (R + 1))] if extent >= -tolerance else [])
                longest = max(k["max_exponent"][0], min(OB - 1 + tolerance, k["max_exponent"][0]) + R) - CB
                width = k[f"width_{OB}_{R}"][0] if CB == c_low else 64 if OB + R + 2 > 32 or longest > 30 else 32
                for shift, x in shifts:
                    if not (shift < width - 1 and x + (1 << (shift - 1)) < 1 << (width - 1) if shift > 0 else x << -shift < 1 << (width - 1)):
                        print(f"  OB {OB} R {R} CB {CB} extent {extent}: {x.bit_length()} bits shifted by {shift} in {width}")
                        return False
    return True


def mantissa_share(OB, R, extent, exponent):
    """Bound of the level's error by the mantissas, relative to the longer column (ACCURACY 8), for a reach of 2^extent texels."""
    unit = Fraction(1, 1 << exponent) if exponent >= 0 else Fraction(1 << -exponent)
    reach = Fraction(2) ** extent / unit                       # |c| + 7 (|a| + |b|), in units
    mantissa = Fraction(1, 2) + Fraction(2) ** (extent - 31) / unit
    slope = Fraction(1, 1 << (R + 1)) + Fraction(1, 1 << 31)
    component = mantissa + Fraction(1, 14) * mantissa + Fraction(1, 2) * mantissa + reach * slope + Fraction(1, 2) * 15
    column = max(Fraction(1, 8), (Fraction(2) ** (extent - 2) - Fraction(501, 1000)) / 28 - Fraction(36, 1000))
    return float(component * unit / column) * math.sqrt(2)


def enumerates_level_bound(library):
    """accuracy.hpp level_bound() covers the sum of its parts for every offset_bits, reciprocal_bits and reach at which level >= 0 can be."""
    k, worst = library.constants, 0
    cases = list(itertools.product(*(range(k[n][0], k[n][1] + 1) for n in ("offset_bits", "reciprocal_bits"))))
    for (OB, R), (bound,) in zip(cases, library.answers(["level_bound", OB, R, 8] for OB, R in cases), strict=True):
        w = 2**-30 + 14 * 2**-31 + 7 * 2**-R
        rest = 2**-11 + 2**-9 + 19 * 2**-16 - 2 * math.log2(1 - 2 * w)
        for extent in range(-4, k["max_extent_log2"][0] + 1):
            share = mantissa_share(OB, R, extent, min(OB - 1 - extent, k["max_exponent"][0]))
            need = rest - math.log2(1 - share) if share < 1 else math.inf
            if need > bound * 2**-40:
                print(f"  OB {OB} R {R} extent {extent}: {need:.4g} levels, level_bound() {bound * 2**-40:.4g}")
                return False
            worst = max(worst, need / (bound * 2**-40))
    print(f"  at most {100 * worst:.1f} % of level_bound()")
    return True


PROOFS = [proves_newton_step, proves_quotient, proves_pixel_numerator, proves_relative_w, proves_series_slope, proves_series, proves_series_numerator,
          proves_level_series, proves_corner_numerator, proves_corner_w,
          proves_swept_area, proves_position, proves_on_level, proves_blend,
          proves_reference, proves_exact_reference, proves_level_terms, proves_gradient_is_half_the_slopes]


if __name__ == "__main__":
    sys.exit(run("steps.cpp", compared, [enumerates_quotient_shifts, enumerates_position_shifts, enumerates_level_bound], PROOFS))

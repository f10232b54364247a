#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The proofs of proofs.py for the filters with a footprint: axis vectors and their direction, samples and their sums, squares, areas, contours.
In the same manner: ranges and constants come from the headers (tests/identity/footprint_steps.cpp), every proof must fail without its
precondition, and the formulas are compared with the C++ on random and extreme numbers. --links makes these comparisons only."""
import itertools
import math
import sys

from proofs import gradients, nearest, size
from proving import Numbers, compare, run
from z3 import And, Int, Or, Real

TRIALS = 2000


# --- formulas: of integers and of z3's terms alike ---------------------------------------------------------


def doubled_angle(xx, xy, yy, vv, vw, ww):
    """footprint.hpp major_direction: |P|^2 - |Q|^2 and 2 P.Q, from the products of the columns (x, v) and (y, w)."""
    return xx + vv - yy - ww, 2 * (xy + vw)


def along(d, x, y):
    """footprint.hpp axis_of: the columns along a direction (cos, sin)."""
    return d[0] * x + d[1] * y


def axis_reach(d, x, y, twist, reach):
    return size(along(d, x, y)) + reach * (size(d[1] * twist) + size(d[0] * twist))


def sample_step(n):
    return (65536 + n) // (2 * n)


def offset_product(length, k, n):
    return length * ((2 * k + 1 - n) * sample_step(n))


def centred(value, threshold, field_bits):
    """contour.hpp centred_field, of a value that has field_bits already."""
    return value - threshold * (1 << (field_bits - 8))


def field_sum(a, b, one, f):
    return a * (one - f) + b * f


def symmetric(x, shift):
    return x if shift <= 0 else nearest(x, shift) if x >= 0 else -nearest(-x, shift)


def clamp(x, low, high):
    return max(low, min(high, x))


# --- the same steps, whole, in integers: what the C++ must give --------------------------------------------


class Model:
    def __init__(self, constants):
        self.k = {name: value[0] for name, value in constants.items()}
        self.directions = [constants[f"direction_{n}"] for n in range(self.k["direction_count"])]
        self.borders = [self.k[f"border_{n}"] for n in range(4)]
        self.log_knots = [self.k[f"knot_{n}"] for n in range(64)] + [65536]
        self.exp_knots = [self.k[f"exp2_{n}"] for n in range(65)]

    def log2_16(self, x):
        n = x.bit_length() - 1
        f = x >> (n - 22) if n >= 22 else x << (22 - n)
        low, high = self.log_knots[f >> 16 & 63], self.log_knots[(f >> 16 & 63) + 1]
        return (n << 16) + low + (((high - low) * (f & 0xFFFF) + 0x8000) >> 16)

    def exp2(self, x):
        k, t = x >> 10 & 63, x & 1023
        fraction, shift = (self.exp_knots[k] << 10) + (self.exp_knots[k + 1] - self.exp_knots[k]) * t, 10 - (x >> 16)
        return nearest(fraction, shift) if shift > 0 else fraction << -shift

    def direction(self, ux, uy, vx, vy):
        drop = max(0, max(size(x).bit_length() for x in (ux, uy, vx, vy)) - 30)
        ux, uy, vx, vy = (symmetric(x, drop) for x in (ux, uy, vx, vy))
        across, twice = doubled_angle(ux * ux, ux * uy, uy * uy, vx * vx, vx * vy, vy * vy)
        p, q = size(across), size(twice)
        steep = q > p
        if steep:
            p, q = q, p
        shift = max(0, p.bit_length() - 48)
        p, q, k = p >> shift, q >> shift, 0
        while k < 4 and (q << 15) > p * self.borders[k]:
            k += 1
        k = 8 - k if steep else k
        k = 16 - k if across < 0 else k
        return (self.k["direction_count"] - k) % self.k["direction_count"] if twice < 0 else k

    @staticmethod
    def term(level_16):
        return clamp(nearest(level_16, 6), -32 * 1024, 32 * 1024 - 1)

    def axis(self, OB, ux, uy, vx, vy, twist_u, twist_v, exponent):
        reach, bits = self.k["reach"], OB - 1
        d = self.directions[self.direction(ux, uy, vx, vy)]
        parts = [(along(d, x, y), -d[1] * t, d[0] * t) for x, y, t in ((ux, uy, twist_u), (vx, vy, twist_v))]
        given = exponent + self.k["direction_bits"]
        longest = max(axis_reach(d, x, y, t, reach) for x, y, t in ((ux, uy, twist_u), (vx, vy, twist_v)))
        kept = clamp(given - max(0, longest.bit_length() - bits), bits - 14, self.k["max_axis_exponent"])
        most = (1 << bits) - 1

        def mantissa(x):
            return clamp(symmetric(x, given - kept) if given >= kept else x << (kept - given), -most, most)

        det = ux * vy - uy * vx
        area = self.term(self.log2_16(size(det)) + 2 * (1 - exponent) * 65536) if det else self.term(-(32 << 16))
        return [*map(mantissa, parts[0]), *map(mantissa, parts[1]), area, kept]

    @staticmethod
    def vector(R, affine, exponent, n, r):
        x = n if affine else symmetric(symmetric(n * r, R) * r, R)
        drop = exponent - 17
        return clamp(symmetric(x, drop) if drop >= 0 else x << -drop, -(1 << 31), (1 << 31) - 1)

    def shape(self, squares, L, samples, spacing, slack, bias, exponent, area, nu, nv, log2_w):
        square = nu * nu + nv * nv
        length = self.log2_16(square) // 2 + (1 - exponent) * 65536 if square else -(32 << 16)
        major, bias = length - 2 * log2_w, 0 if squares else bias * 4096
        ratio = clamp(min(2 * length - area * 64 - log2_w, major), 0, self.log2_16(samples))
        minor = major - ratio
        level = clamp(nearest(max(minor + bias, min(minor, -5 * bias // 8)), 16 - L), 0, 12 << L)
        if not squares:
            widths = self.exp2(ratio)
            pitches = min(widths, 2 << 16) + (max(widths - (2 << 16), 0) * self.exp2(-spacing * 4096) >> 16)
            return [level, clamp((pitches - (slack << 12) + 65535) >> 16, 1, samples)]
        whole = max(0, ((level + (1 << (L - 1)) + (1 << L) - 1) >> L) - 1)
        texels = self.exp2(clamp(major - whole * 65536, -16 * 65536, 4 * 65536 + 65535))
        return [whole << L, 2 * clamp((texels + 2 * 65536 - 1) >> 18, 0, 7) + 1]

    @staticmethod
    def sample_offset(length, k, n):
        return symmetric(offset_product(length, k, n), 16)

    @staticmethod
    def square(u, v, n, fu, fv, S, k):
        aside = (n - 1) // 2
        index = k - aside
        far, row = size(index), aside + 3 - size(index)
        if index == 0:
            return [0, 0, 5, 5, 5, 5, row]
        if size(v) * 32768 < size(u) * 13573:
            return [2 * index, 0, *((6, 4, 6, 4) if index > 0 else (4, 6, 4, 6)), row]
        if size(u) * 32768 < size(v) * 13573:
            return [0, 2 * index, *((6, 6, 4, 4) if index > 0 else (4, 4, 6, 6)), row]
        even, odd = far // 2, far - far // 2
        right, falling = index > 0, (u < 0) != (v < 0)
        down = right != falling
        across, along_v = (odd + 2 * even, 2 * odd + even) if 2 * fu > 1 << S else (2 * odd + even, odd + 2 * even)
        weight = [5, 5, 5, 5]
        near = (0 if right else 1) + (0 if down else 2)
        weight[near], weight[3 - near] = 6, 4
        return [across if right else -across, along_v if down else -along_v, *weight, row]

    @staticmethod
    def area_on_level(x, ratio, level, S):
        product, shift = (x, 16 + level - S) if ratio == 1 << 31 else (x * ratio, 47 + level - S)
        return nearest(product, shift) if shift > 0 else product

    @staticmethod
    def fitted(S, side_log2, centre, *corners):
        low, high = min(centre, *corners), max(centre, *corners)
        at = lambda x, k: centre + symmetric(x - centre, k)  # noqa: E731
        count = lambda a, b: ((b - 1 if b > a else b) >> S) - (a >> S) + 1  # noqa: E731
        k = 0
        while k < 24 and count(at(low, k), at(high, k)) > 1 << side_log2:
            k += 1
        first = at(low, k) >> S
        return [first, count(at(low, k), at(high, k)), centre - (first << S), *(at(x, k) - (first << S) for x in corners)]

    def square_part(self, t, n, d):
        s = self.k["swept_bits"]
        return t * (n * t // d) * (1 << s) + (t * (n * t % d) * (1 << s) + d // 2) // d

    def swept(self, x0, dx, dy, top, bottom, x, x_end):
        width, d, unit = size(dx), x - x0, 2 << self.k["swept_bits"]
        triangle = lambda t: (-1 if dx < 0 else 1) * self.square_part(t, width, dy)  # noqa: E731
        above = (x_end - x0) * top
        after_top, after_bottom = d * dy >= dx * top, d * dy >= dx * bottom
        if after_top and after_bottom:
            return unit * (above + d * (bottom - top)) - triangle(bottom)
        if not after_top and not after_bottom:
            return unit * above - triangle(top)
        corner = self.square_part(size(d), dy, width)
        if after_top:
            return unit * (above - d * top) + corner
        return unit * (above + d * bottom) - triangle(top) - triangle(bottom) + corner

    @staticmethod
    def linear_weight(columns, rows, bits, weight):
        drop = max(0, (columns * rows << (2 * bits + 1)).bit_length() - 15)
        return [drop, 0 if weight == 0 else max(1, nearest(weight, drop) if drop else weight)]

    def contour_field(self, two, own, threshold, L, f, value, bits, value2, bits2):
        F = self.k["field_bits"]
        field = lambda v, b: centred(nearest(v, b - F) if b > F else v << (F - b), threshold, F)  # noqa: E731
        if not two:
            return field(value, bits) << L
        return field_sum(field(value, bits), field(value2, bits2) * (2 if own else 1), 1 << L, f)

    def contour_distance(self, L, field, e):
        product, shift = field * self.exp2(e & 0xFFFF), self.k["field_bits"] + L - (e >> 16)
        most = self.k["most_distance"]
        return clamp(nearest(product, shift) if shift > 0 else product << -shift, -most, most)

    @staticmethod
    def coverage(distance, outline):
        fill = lambda x: clamp(x + (1 << 15), 0, 1 << 16)  # noqa: E731
        half = outline << 11
        c = fill(distance) if outline == 0 else fill(distance + half) - fill(distance - half)
        return (c * 255 + (1 << 15)) >> 16


# --- comparison with the C++ --------------------------------------------------------------------------------


def edge_in_window(rng, most):
    """An edge, a row of it and a place, all in a window: x0, dx, dy, top, bottom, x, x_end."""
    x_end, height = (rng.choice((most, rng.randint(1, most))) for _ in range(2))
    dy = rng.choice((height, 1, rng.randint(1, height)))
    x0, x1 = (rng.choice((0, x_end, rng.randint(0, x_end))) for _ in range(2))
    top, bottom = sorted(rng.choice((0, dy, rng.randint(0, dy))) for _ in range(2))
    return x0, x1 - x0, dy, top, bottom, rng.choice((0, x_end, rng.randint(0, x_end))), x_end


def links(library, trials):
    k, model, rng = library.constants, Model(library.constants), Numbers(6)
    pick = lambda name: rng.choice((k[name][0], k[name][1], rng.randint(*k[name])))  # noqa: E731
    for _ in range(trials):
        alike = rng.randint(0, 31)
        columns = rng.choice(([rng.any(31) for _ in range(4)], [rng.any(alike) for _ in range(4)], [rng.any(alike), 0, 0, rng.any(alike)]))
        yield ["direction", *columns], [model.direction(*columns)]
        OB = pick("offset_bits")
        twist = [rng.any(28), rng.any(28)] if rng.random() < 0.7 else [0, 0]
        exponent = rng.choice((OB - 1 - rng.randint(-45, 12), rng.randint(-80, 104)))
        yield ["axis_of", OB, *columns, *twist, exponent], model.axis(OB, *columns, *twist, exponent)
        R, n = pick("reciprocal_bits"), rng.any(30)
        r = rng.choice((1 << (R + 1), rng.randint(2 << R - 1, 1 << (R + 1)), rng.randint((1 << R) * 2 // 3, 1 << R)))
        axis_exponent = rng.randint(-3, k["max_axis_exponent"][0])
        affine = rng.randint(0, 1)
        yield ["axis_at", R, affine, axis_exponent, n, r], [model.vector(R, affine, axis_exponent, n, r)]
        L, samples, spacing, slack, bias = pick("level_bits"), pick("max_samples"), rng.randint(0, 16), rng.randint(0, 15), rng.randint(-16, 0)
        nu, nv, log2_w = rng.any(30), rng.any(30), rng.randint(-65536, 38336)
        shape = [rng.randint(0, 1), L, samples, spacing, slack, bias, rng.randint(0, 34), rng.randint(-8 * 1024, 24 * 1024), nu, nv, log2_w]
        yield ["shape", *shape], model.shape(*shape)
        count = rng.randint(1, k["max_footprint_samples"][0])
        at, length = rng.randrange(count), rng.choice((-(1 << 31), (1 << 31) - 1, rng.any(31), rng.any(22)))
        yield ["sample_offset", length, at, count], [model.sample_offset(length, at, count)]
        S, odd = pick("subtexel_bits"), 2 * rng.randint(0, 7) + 1
        vector = [rng.any(24), rng.any(24)] if rng.random() < 0.6 else [x * rng.choice((-1, 1)) for x in (rng.randint(5000, 9000), rng.randint(5000, 9000))]
        square = [*vector, odd, rng.randrange(1 << S), rng.randrange(1 << S), S, rng.randrange(odd)]
        yield ["square", *square], model.square(*square)
        x, ratio = rng.choice((-1, 1)) * rng.choice(((1 << 31) + (1 << 29), rng.getrandbits(31))), rng.choice((1 << 31, rng.randint(1, 1 << 31)))
        level = rng.randrange(k["max_levels"][0])
        yield ["area_on_level", x, ratio, level, S], [model.area_on_level(x, ratio, level, S)]
        middle, wide = rng.any(23), rng.choice((4, 10, 12, 20))
        corners = [middle, *(middle + rng.any(wide) for _ in range(k["max_area_corners"][0]))]
        side = pick("area_side_log2")
        yield ["fitted", S, side, *corners], model.fitted(S, side, *corners)
        most = 1 << k["area_bits"][0]
        d = rng.choice((most, 1, rng.randint(1, most)))
        part = rng.choice((0, d, rng.randint(0, d))), rng.choice((0, most, rng.randint(0, most))), d
        yield ["scaled_square", *part], [model.square_part(*part)]
        edge = edge_in_window(rng, most)
        yield ["swept", *edge], [model.swept(*edge)]
        cells, bits = (rng.randint(1, 16), rng.randint(1, 16)), rng.randint(1, 7)
        weight = rng.choice((0, 1, rng.randint(0, 2 << (2 * bits))))
        yield ["linear_weight", *cells, bits, weight], model.linear_weight(*cells, bits, weight)
        exponent = rng.randint(-16 * 65536, 15 * 65536 - 1)
        yield ["exp2", exponent], [model.exp2(exponent)]
        value, bits = (lambda b: (rng.choice((0, 255 << b, rng.randint(0, 255 << b))), b)), lambda: rng.randint(0, 24)  # noqa: E731
        field = [rng.randint(0, 1), rng.randint(0, 1), rng.choice((0, 65535, rng.getrandbits(16))), L, rng.randrange(1 << L), *value(bits()), *value(bits())]
        yield ["contour_field", *field], [model.contour_field(*field)]
        distance = [L, rng.any(29), rng.randint(-32 * 65536, 15 * 65536)]
        yield ["contour_distance", *distance], [model.contour_distance(*distance)]
        cover = [rng.any(21), rng.choice((0, 255, rng.randrange(256)))]
        yield ["coverage", *cover], [model.coverage(*cover)]


def compared(library):
    return compare(library, list(links(library, TRIALS)))


# --- proofs: what is given, the key precondition, the claim ------------------------------------------------------


def ints(names):
    return (Int(n) for n in names.split())


def proves_major_direction(k):
    """Squares, their differences, and the folded angle times a border fit 64 bits once the columns are cut to 30 bits."""
    xx, yy, vv, ww, xy, vw, p, q = ints("xx yy vv ww xy vw p q")
    most = 1 << 60
    across, twice = doubled_angle(xx, xy, yy, vv, vw, ww)
    cut = [And(x >= 0, x <= most) for x in (xx, yy, vv, ww)] + [And(x <= most, x >= -most) for x in (xy, vw)]
    yield [], cut, And(xx + vv < 1 << 63, size(across) < 1 << 63, size(twice) < 1 << 63)
    yield [p >= q, q >= 0], [p < 1 << 48], And(q * (1 << 15) < 1 << 64, *(p * k[f"border_{n}"][0] < 1 << 64 for n in range(4)))


def proves_area_determinant(k):
    """ux vy - uy vx fits 64 bits: both products of columns below 2^31."""
    a, b = ints("a b")
    yield [], [size(a) <= ((1 << 31) - 1) ** 2, size(b) <= ((1 << 31) - 1) ** 2], size(a - b) < 1 << 63


def proves_axis_terms(k):
    """A span's axis: along each direction the columns and the twist reach less than 2^16 times what the mantissas do, so that axis_exponents holds,
    and after the drop and its roundings |c| + 7 (|a| + |b|) stays within what proves_pixel_numerator takes."""
    a, b, c, ah, bg, cg, ch, most = ints("a b c ah bg cg ch most")
    reach = k["reach"][0]
    valid = [most >= 1 << (k["offset_bits"][0] - 1), size(c) + reach * (size(a) + size(b)) <= most + 32]
    slopes = [14 * size(p) <= size(x) + 14 for p, x in ((ah, a), (bg, b), (cg, c), (ch, c))]
    x, y, twist = gradients(a, b, c, ah, bg, cg, ch)
    directions = [k[f"direction_{n}"] for n in range(k["direction_count"][0])]
    yield valid, slopes, And(*(axis_reach(d, x, y, twist, reach) < most * (1 << 16) for d in directions))
    terms, rounded = [Real(n) for n in "cab"], [Real(n) for n in ("c2", "a2", "b2")]
    halves = [size(y - x) <= 0.5 for x, y in zip(terms, rounded, strict=True)]
    sums = [size(x[0]) + reach * (size(x[1]) + size(x[2])) for x in (terms, rounded)]
    yield halves, [sums[0] <= Real("most")], sums[1] <= Real("most") + 32


def proves_axis_vector(k):
    """n r r fits 64 bits for every R and exponent, half units and the scale upwards included; for n of a whole span."""
    n, p, q, x, y = ints("n p q x y")
    for R in range(k["reciprocal_bits"][0], k["reciprocal_bits"][1] + 1):
        r = 1 << (R + 1)
        products = [n >= 0, p >= 0, p <= n * r, x * (1 << R) <= p + (1 << (R - 1)), q >= 0, q <= x * r, y * (1 << R) <= q + (1 << (R - 1)), x >= 0, y >= 0]
        lowest = k["offset_bits"][0] - 15 - 17
        yield products, [n <= (1 << 30) + 32], And(p + (1 << (R - 1)) < 1 << 63, q + (1 << (R - 1)) < 1 << 63, y * (1 << -lowest) < 1 << 63)


def proves_sample_offset(k):
    """The product fits 64 bits, the offset 32; it is within half a unit and 15/2 2^-16 of the length of the exact place (accuracy.hpp)."""
    length, claims = Int("length"), []
    for n in range(1, k["max_footprint_samples"][0] + 1):
        for at in range(n):
            m = 2 * at + 1 - n
            p, exact = offset_product(length, at, n), length * m  # in 2^-16 and 2n; the offset is within half a unit of p 2^-16
            claims.append(And(size(p) + (1 << 15) < 1 << (31 + 16), size(p * 2 * n - exact * (1 << 16)) <= n * 15 * size(length)))
    yield [], [size(length) <= 1 << 31], And(*claims)


def proves_sample_sums(k):
    """Sixteen samples of at most 255 2^20 fit 32 bits, and their weights; so do those of 16 bits in linear light."""
    count = k["max_footprint_samples"][0]
    values = [Int(f"value_{n}") for n in range(count)]
    for most in (255 << k["max_sum_bits"][0], 65535 << k["max_linear_sum_bits"][0]):
        yield [v >= 0 for v in values], [v <= most for v in values], And(sum(values) < 1 << 32, count << k["max_sum_bits"][0] < 1 << 32)


def proves_corner_position(k):
    """area.hpp position_beside: base + n/w lies in wide_coordinate (s16.16) unsaturated, for every coordinate_bits: at most 2^12 texels of offset over w > 1/2."""
    base, offset = ints("base offset")
    for CB in range(k["coordinate_bits"][0], k["coordinate_bits"][1] + 1):
        far = 1 << (k["max_extent_log2"][0] + 1 + CB)
        yield [size(base) <= 1 << 15], [size(offset) <= far + 1], size(base * (1 << 16) + offset * (1 << (16 - CB))) < 1 << 32


def proves_area_on_level(k):
    """The product with the ratio and half a unit fit 64 bits, the result 32, for every level and subtexel_bits."""
    x, p, claims = Int("x"), Int("p"), []
    for level, S in itertools.product(range(k["max_levels"][0]), range(k["subtexel_bits"][0], k["subtexel_bits"][1] + 1)):
        shift = 47 + level - S
        total = p + (1 << (shift - 1))
        claims.append(And(total < 1 << 63, total >= -(1 << 63), size(total) < 1 << (31 + shift)))
    yield [size(p) <= (1 << 31) * size(x)], [size(x) <= (1 << 31) + (1 << 29)], And(*claims)


def proves_scaled_square(k):
    """Every product fits 32 bits, and the result is within half a unit of 2^-5 of n t^2 / d, for t <= d. `part`, `whole`: t (n t mod d), t (n t / d)."""
    t, d, n, part, whole, got = ints("t d n part whole got")
    most, unit = 1 << k["area_bits"][0], 1 << k["swept_bits"][0]
    valid = [d >= 1, t >= 0, n >= 0, part >= 0, part <= most * most, whole >= 0, whole <= most * most, got * d <= part * unit + d / 2, (got + 1) * d > part * unit + d / 2]
    yield valid, [d <= most, n <= most], And(part * unit + d / 2 < 1 << 31, whole * unit + got < 1 << 31, 2 * (got * d - part * unit) <= d, 2 * (part * unit - got * d) <= d)


def proves_swept_area(k):
    """The four cases of swept_area are the area swept by an edge that stays in the window: nothing to twice the window, so that six edges with
    three roundings each fit 32 bits. In shares of the window: e is the edge's slope, x0 + e t its place t below its upper end."""
    x0, e, dy, t, b, x = (Real(n) for n in ("x0", "e", "dy", "t", "b", "x"))
    d = x - x0
    valid = [x0 >= 0, x0 <= 1, dy > 0, dy <= 1, t >= 0, t <= b, b <= dy, x >= 0, x <= 1]
    inside = [x0 + e * dy >= 0, x0 + e * dy <= 1]
    above = 2 * (1 - x0) * t
    cases = [([d >= e * t, d >= e * b], above + 2 * d * (b - t) - e * b * b), ([d < e * t, d < e * b], above - e * t * t)]
    # Between: e > 0 and right of the top only, e < 0 and right of the bottom only; d^2 / |e| is the corner's area, twice.
    s = Real("s")  # where the edge crosses x: d = e s
    cases.append(([d == e * s, s >= t, s <= b, e > 0], above - 2 * d * t + d * s))
    cases.append(([d == e * s, s >= t, s <= b, e < 0], above + 2 * d * b - e * t * t - e * b * b - d * s))
    for where, area in cases:
        yield [*valid, *where], inside, And(area >= 0, area <= 2)
    areas, unit = [Int(f"area_{n}") for n in range(k["max_area_corners"][0])], 1 << k["swept_bits"][0]
    window = 2 * unit << (2 * k["area_bits"][0])
    partial = [sum(areas[:n]) < (1 << 31) - 9 for n in range(1, len(areas) + 1)]
    yield [2 * x >= -3 for x in areas], [2 * x <= 2 * window + 3 for x in areas], And(*partial)


def proves_area_sums(k):
    """Weights of a footprint add up to less than 2^24 and 255 times them to less than 2^32: a step in its window, eight layers of a hat, each within
    its share of the window and a unit for the rounding of its corners, halved up cell by cell."""
    side, layers = 1 << k["area_bits"][0], k["hat_layers"][0]
    step = 2 * side * side
    areas = [Int(f"layer_{m}") for m in range(layers)]
    # A corner between centre and corner: the box shrinks alike, plus half a unit at either end; hexagons within it. Units of 2^-4.
    within = [16 * 16 * x <= 2 * (side * (2 * m + 1) + 16) ** 2 for m, x in enumerate(areas)]
    halves = k["max_area_side"][0] ** 2
    total = (sum(areas) + halves) / 2
    yield [x >= 0 for x in areas], within, And(step < 1 << 24, total < 1 << 24, 255 * total < 1 << 32, 255 * step < 1 << 32)


def proves_linear_sums(k):
    """In linear light: weights cut to 15 bits a window, at least one each, times 16-bit values fit 32 bits."""
    total, cut, cells = ints("total cut cells")
    full = Int("full")
    # total <= 4/3 full (a hat's layers), cut: after the shift, half a unit and one for each texel
    valid = [cells >= 1, cells <= k["max_area_side"][0] ** 2, full >= 0, 3 * total <= 4 * full + 3 * cells, cut <= total + cells + cells, total >= 0]
    yield valid, [full < 1 << 15], And(cut < 1 << 16, cut * 65535 < 1 << 32)


def proves_contour_field(k):
    """Centred fields lie within 2^20, their blend within 2^29, for every level_bits; doubled where levels count in their own texels."""
    fine, coarse, threshold, f, blend = ints("fine coarse threshold f blend")
    F = k["field_bits"][0]
    for L in range(k["level_bits"][0], k["level_bits"][1] + 1):
        a, b, one = centred(fine, threshold, F), 2 * centred(coarse, threshold, F), 1 << L
        ends = [Or(blend <= one * a, blend <= one * b), Or(blend >= one * a, blend >= one * b)]  # a convex blend, linear for each f
        yield [*ends, f >= 0, f < one, threshold >= 0, threshold < 1 << 16], \
            [x >= 0 for x in (fine, coarse)] + [x <= 255 << F for x in (fine, coarse)], And(size(a) <= 1 << 20, size(blend) < 1 << (21 + L + 1), 21 + L <= 29)


def proves_contour_distance(k):
    """field 2^x fits 64 bits, half a unit or a shift upwards included, for every level_bits and exponent; coverage times 255 fits 32."""
    product, c = ints("product c")
    F = k["field_bits"][0]
    shifts = [F + L - whole for L in range(k["level_bits"][0], k["level_bits"][1] + 1) for whole in range(-32, 16)]
    down, up = max(shifts), -min(shifts)
    yield [size(product) <= (1 << 17) * size(Int("field")), c >= 0, c <= 1 << 16], [size(Int("field")) <= 1 << 29], \
        And(down <= 62, size(product) + (1 << (down - 1)) < 1 << 63, size(product) * (1 << max(0, up)) < 1 << 63, c * 255 + (1 << 15) < 1 << 31)


# --- by enumeration -----------------------------------------------------------------------------------------


def enumerates_axis_exponents(library):
    """A span's axis never meets the lower end of its exponent, where terms would be clamped one by one, and no drop exceeds 62."""
    k = library.constants
    for OB in range(k["offset_bits"][0], k["offset_bits"][1] + 1):
        bits, top = OB - 1, k["max_axis_exponent"][0]
        for extent in range(-45, k["max_extent_log2"][0] + 1):
            given = min(OB - 1 - extent, k["max_exponent"][0]) + k["direction_bits"][0]
            for reach_bits in range(bits + 17):  # below 2^(bits + 16): proves_axis_terms
                fitting = given - max(0, reach_bits - bits)
                kept = max(bits - 14, min(top, fitting))
                if kept > fitting or not 0 <= given - kept <= 62:
                    print(f"  OB {OB} extent {extent} reach of {reach_bits} bits: exponent {kept} of {fitting}, drop {given - kept}")
                    return False
    return True


def enumerates_squares(library):
    """Every square of every row, in every direction and from both halves of a texel: weights of 20, sums within 32 bits, squares within 15 texels."""
    questions = [[u, v, n, f, f, 8, at] for n in range(1, 16, 2) for at in range(n) for f in (0, 128, 129, 255)
                 for u, v in itertools.product((-9, -4, 0, 4, 9), repeat=2)]
    rows = {}
    for q, (u, v, *weights, row) in zip(questions, library.answers(["square", *q] for q in questions), strict=True):
        if sum(weights) != 20 or min(weights) < 4 or row < 3 or max(size(u), size(v)) > 14:
            print(f"  square {q}: {u}, {v}, {weights}, {row}")
            return False
        rows[tuple(q[:6])] = rows.get(tuple(q[:6]), 0) + 20 * row
    return 255 * max(rows.values()) < 1 << 24 and 65535 * max(rows.values()) < 1 << 32


def enumerates_exp2(library):
    """exp2_bound(): every fraction, against the power in floating point of 53 bits; knots to nearest; results fit 32 bits up to 2^15."""
    if any(library.constants[f"exp2_{n}"][0] != round(2 ** (16 + n / 64)) for n in range(65)):
        print("  a knot is not the nearest number")
        return False
    answers = library.answers(["exp2", x] for x in range(65536))
    worst = max(abs(y / 65536 / 2 ** (x / 65536) - 1) for x, (y,) in enumerate(answers))
    print(f"  2^x within 2^{math.log2(worst):.2f}, relative")
    return worst < 2**-15 and library.answers([["exp2", 15 * 65536 - 1]])[0][0] < 1 << 32


PROOFS = [proves_major_direction, proves_area_determinant, proves_axis_terms, proves_axis_vector, proves_sample_offset, proves_sample_sums,
          proves_corner_position, proves_area_on_level, proves_scaled_square, proves_swept_area, proves_area_sums, proves_linear_sums, proves_contour_field,
          proves_contour_distance]


if __name__ == "__main__":
    sys.exit(run("footprint_steps.cpp", compared, [enumerates_axis_exponents, enumerates_squares, enumerates_exp2], PROOFS))

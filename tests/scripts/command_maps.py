#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command's maps: wrap modes, formats, packs, prefilters, contours, alpha and sRGB, judged on the pictures drawn of them."""
import itertools
import json
import re
import struct
import sys
import zlib
from random import Random

sys.dont_write_bytecode = True
from spantex_command import FILTERS, FORMATS, IDENTITY, PREFILTERS, PROFILES, TILTED, WRAPS, done, plane, png_bytes, read_png, run_tests  # noqa: E402


def texel(x, y):
    return [(37 * x + 91 * y) % 256, (50 + x * y) % 256, (x * 11) % 256, 255]


def test_wraps_are_exact(folder):
    """The identity at nearest shows texels as they are, beyond the map's edge too."""
    width, height, shift = 24, 20, 7
    (folder / "w.png").write_bytes(png_bytes(width, height, pixel=texel))
    index = {
        "repeat": lambda k, n: k % n,
        "clamp": lambda k, n: min(max(k, 0), n - 1),
        "mirror": lambda k, n: min(k % (2 * n), 2 * n - 1 - k % (2 * n)),
    }
    for wrap in WRAPS:
        for profile in PROFILES:
            plane(folder, "o.png", "w.png", "64x56", f"1,0,-{shift},0,1,-{shift},0,0,1", wrap=wrap, filter="nearest", profile=profile)
            w, h, rows = read_png(folder / "o.png")
            assert (w, h) == (64, 56)
            for y, x in itertools.product(range(h), range(w)):
                wanted = texel(index[wrap](x - shift, width), index[wrap](y - shift, height))
                assert list(rows[y][4 * x:4 * x + 4]) == wanted, (wrap, profile, x, y)


def test_constant_maps_stay_constant(folder):
    for width, height in ((64, 64), (37, 23), (1, 1)):
        (folder / "c.png").write_bytes(png_bytes(width, height, pixel=lambda x, y: [201, 3, 77, 255]))
        for filter_name, prefilter in itertools.product(FILTERS, PREFILTERS):
            plane(folder, "o.png", "c.png", matrix=TILTED, filter=filter_name, prefilter=prefilter)
            _, _, rows = read_png(folder / "o.png")
            assert all(row == bytes([201, 3, 77, 255]) * 64 for row in rows), (width, filter_name, prefilter)


def test_formats(folder):
    """Gray, gray with alpha, RGB and RGBA become RGBA."""
    expand = {0: lambda p: p * 3 + [255], 4: lambda p: p[:1] * 3 + p[1:], 2: lambda p: p + [255], 6: lambda p: p}
    count = {0: 1, 4: 2, 2: 3, 6: 4}
    for kind, to_rgba in expand.items():
        (folder / "f.png").write_bytes(png_bytes(16, 16, kind, lambda x, y: texel(x, y)[:count[kind] - 1] + [9 * x + y]))
        plane(folder, "o.png", "f.png", "16x16", IDENTITY, filter="nearest")
        _, _, rows = read_png(folder / "o.png")
        for y, x in itertools.product(range(16), range(16)):
            assert list(rows[y][4 * x:4 * x + 4]) == to_rgba(texel(x, y)[:count[kind] - 1] + [9 * x + y]), (kind, x, y)


def test_every_kind_of_png(folder):
    """Colour types and depths, interlaced or not, palettes, one colour clear: as the PNG specification says, 16 bits cut to 8, gamma left alone."""
    random = Random(8)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    width, height = 13, 11
    whole, adam7 = [(0, 0, 1, 1)], [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]
    kinds = [(0, depth) for depth in (1, 2, 4, 8, 16)] + [(3, depth) for depth in (1, 2, 4, 8)] + [(kind, depth) for kind in (2, 4, 6) for depth in (8, 16)]
    for (kind, depth), passes, clear in itertools.product(kinds, (whole, adam7), (False, True)):
        if clear and kind in (4, 6):
            continue
        most, samples = 2 ** depth - 1, {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind]
        texels = [[[random.randrange(most + 1) for _ in range(samples)] for _ in range(width)] for _ in range(height)]
        palette = [[random.randrange(256) for _ in range(3)] for _ in range(most + 1)] if kind == 3 else []
        alphas = [random.randrange(256) for _ in range(min(3, len(palette)))]
        raw = b""
        for x0, y0, dx, dy in passes:
            for row in texels[y0::dy]:
                numbers = [n for texel in row[x0::dx] for n in texel]
                bits = "".join(f"{n:0{depth}b}" for n in numbers)
                bits += "0" * (-len(bits) % 8)
                raw += bytes([0] + [int(bits[k:k + 8], 2) for k in range(0, len(bits), 8)]) if numbers else b""
        data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, int(passes is adam7))) + chunk(b"gAMA", struct.pack(">I", 30000))
        data += chunk(b"PLTE", bytes(c for colour in palette for c in colour)) if kind == 3 else b""
        if clear:
            data += chunk(b"tRNS", bytes(alphas) if kind == 3 else struct.pack(f">{samples}H", *texels[5][6]))
        (folder / "k.png").write_bytes(data + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))
        plane(folder, "o.png", "k.png", f"{width}x{height}", IDENTITY, filter="nearest")
        _, _, rows = read_png(folder / "o.png")
        for y, x in itertools.product(range(height), range(width)):
            texel = texels[y][x]
            eight = [n >> 8 if depth == 16 else n * 255 // most for n in texel]
            alpha = 0 if clear and texel == texels[5][6] else 255
            if kind == 3:
                wanted = palette[texel[0]] + [alphas[texel[0]] if clear and texel[0] < len(alphas) else 255]
            else:
                wanted = {0: eight * 3 + [alpha], 2: eight + [alpha], 4: eight[:1] * 3 + eight[1:], 6: eight}[kind]
            assert list(rows[y][4 * x:4 * x + 4]) == wanted, (kind, depth, passes is adam7, clear, x, y)


def test_texture_packs(folder):
    """A picture and the pack made of it draw the same picture, in every command that takes a texture."""
    (folder / "n.png").write_bytes(png_bytes(100, 37))
    for prefilter, wrap in itertools.product(PREFILTERS, WRAPS):
        done("texture", "n.png", "--out", "n.stx", "--prefilter", prefilter, "--wrap", wrap, cwd=folder)
        for engine in ("direct", "sim"):
            how = dict(matrix=TILTED, filter="trilinear", engine=engine)
            assert plane(folder, "a.png", "n.stx", **how) == plane(folder, "b.png", "n.png", prefilter=prefilter, wrap=wrap, **how), (prefilter, wrap)
    for command in (["render", "tilted"], ["trace", "tilted", "--vcd", "/dev/null"]):
        for name in ("n.stx", "n.png"):
            more = ["--prefilter", "lanczos", "--wrap", "mirror"] if name == "n.png" else []
            done(*command, "--texture", name, "--size", "64x48", "--out", name + ".out.png", *more, cwd=folder)
        assert (folder / "n.stx.out.png").read_bytes() == (folder / "n.png.out.png").read_bytes(), command


def test_packs_of_every_format(folder):
    """A picture drawn in a format and its pack in that format give the same picture; the header tells the format."""
    (folder / "n.png").write_bytes(png_bytes(30, 21))
    for number, name in enumerate(FORMATS):
        done("texture", "n.png", "--out", "n.stx", "--format", name, cwd=folder)
        assert (folder / "n.stx").read_bytes()[12] == number, name
        how = dict(matrix=TILTED, filter="trilinear")
        assert plane(folder, "a.png", "n.stx", **how) == plane(folder, "b.png", "n.png", format=name, **how), name


def test_packs_do_not_depend_on_threads(folder):
    for more in (["--inverse"], ["--alpha-weighted", "--alpha-test", "128"], ["--format", "argb4444"], ["--format", "palette8"],
                 ["--format", "etc2_rgba8", "--alpha-test", "128"]):
        packs = set()
        for threads in ("1", "2", "7"):
            done("texture", "map.png", "--out", "t.stx", "--prefilter", "kaiser", "--threads", threads, *more, cwd=folder)
            packs.add((folder / "t.stx").read_bytes())
        assert len(packs) == 1, more


def test_packs_of_16_bit_texels(folder):
    (folder / "f.png").write_bytes(png_bytes(16, 16, 6, lambda x, y: [8 * x, 16 * y, 200, 255 if x < 8 else 0]))
    widen = {"rgb565": lambda r, g, b, a: [round(255 * round(31 * r / 255) / 31), round(255 * round(63 * g / 255) / 63), round(255 * round(31 * b / 255) / 31), 255],
             "argb4444": lambda r, g, b, a: [17 * round(x / 17) for x in (r, g, b, a)]}
    for name, expected in widen.items():
        done("texture", "f.png", "--out", "f.stx", "--format", name, "--levels", "2", cwd=folder)
        data = (folder / "f.stx").read_bytes()
        assert (data[13], len(data)) == (2, 64 + 512 + 128), name
        plane(folder, "o.png", "f.stx", "16x16", IDENTITY, filter="nearest")
        _, _, rows = read_png(folder / "o.png")
        for y, x in itertools.product(range(16), range(16)):
            assert list(rows[y][4 * x:4 * x + 4]) == expected(8 * x, 16 * y, 200, 255 if x < 8 else 0), (name, x, y)


def coverage_of_rows(rows, background, ink):
    """Of red, 0 to 1."""
    return [[(row[4 * x] - background) / (ink - background) for x in range(len(row) // 4)] for row in rows]


def test_contours(folder):
    """A field made of a picture: a half-plane's outline is as wide as asked at every magnification; fills, blending, options and packs agree."""
    (folder / "half.png").write_bytes(png_bytes(256, 256, 2, lambda x, y: [255 * (x >= 128)] * 3))
    for scale in ("16", "32"):
        done("texture", "half.png", "--field", scale, "--reduction", "4", "--outline", "2", "--ink", "ff0000", "--wrap", "clamp", "--out", "f.stx", cwd=folder)
        for texels_per_px in (1 / 16, 0.5, 1, 3):
            matrix = f"{texels_per_px},0,{32 - 32 * texels_per_px},0,{texels_per_px},0,0,0,1"
            for width, more in ((2, {}), (3.5, {"outline": "3.5"})):
                plane(folder, "o.png", "f.stx", "64x16", matrix, filter="contour", alpha="blended", **more)
                _, _, rows = read_png(folder / "o.png")
                assert all(abs(sum(row) - width) < 0.25 for row in coverage_of_rows(rows, 0, 255)), (scale, texels_per_px, width)
            plane(folder, "o.png", "f.stx", "64x16", matrix, filter="contour", alpha="blended", outline="0")
            _, _, rows = read_png(folder / "o.png")
            assert all(abs(sum(row) - 32) < 0.25 for row in coverage_of_rows(rows, 0, 255)), (scale, texels_per_px)
    how = dict(matrix=TILTED, filter="contour", alpha="blended", background="102030")
    assert plane(folder, "a.png", "f.stx", **how) == plane(folder, "b.png", "f.stx", engine="sim", **how) == plane(folder, "c.png", "f.stx", threads="2", **how)
    # The threshold moves the contour: by 32 units, one texel, two pixels.
    moved = {}
    for threshold in ("128", "160"):
        plane(folder, "o.png", "f.stx", "64x16", "0.5,0,16,0,0.5,0,0,0,1", filter="contour", alpha="blended", outline="0", threshold=threshold)
        moved[threshold] = sum(coverage_of_rows(read_png(folder / "o.png")[2], 0, 255)[8])
    assert abs(moved["128"] - moved["160"] - 2) < 0.1, moved
    # A pack keeps the scale it was made with; only --field-scale overrides it.
    how = dict(matrix="0.5,0,16,0,0.5,0,0,0,1", size="64x16", filter="contour", alpha="blended", outline="2")
    assert plane(folder, "a.png", "f.stx", **how) == plane(folder, "b.png", "f.stx", **{"field-scale": "32"}, **how)
    assert plane(folder, "a.png", "f.stx", **how) != plane(folder, "b.png", "f.stx", **{"field-scale": "16"}, **how)
    done("texture", "half.png", "--field", "16", "--inside", "dark", "--wrap", "clamp", "--format", "a8", "--c-array", "f.h", "--out", "g.stx", cwd=folder)
    plane(folder, "o.png", "g.stx", "64x16", "1,0,96,0,1,0,0,0,1", filter="contour", alpha="blended", background="ffffff")
    _, _, rows = read_png(folder / "o.png")
    assert all(row[:4] == bytes([0, 0, 0, 255]) and row[-4:] == bytes([255] * 4) for row in rows)


def test_alpha_modes(folder):
    """Write-out against the formulas: a map of one alpha a column, drawn texel by texel."""
    (folder / "a.png").write_bytes(png_bytes(16, 16, 6, lambda x, y: [200, 100, 40, 17 * x]))
    back = (16, 32, 48, 255)
    blend = lambda s, d, a: (2 * (s * a + d * (255 - a)) + 255) // 510  # noqa: E731
    modes = {"opaque": lambda c: c,
             "cut-out": lambda c: c if c[3] >= 128 else back,
             "cut-out:200": lambda c: c if c[3] >= 200 else back,
             "blended": lambda c: back if c[3] == 0 else tuple(blend(s, d, c[3]) for s, d in zip((*c[:3], 255), back)),
             "premultiplied": lambda c: tuple(min(255, s + (2 * d * (255 - c[3]) + 255) // 510) for s, d in zip(c, back))}
    for mode, expected in modes.items():
        for engine in ("direct", "sim"):
            plane(folder, "o.png", "a.png", "16x16", IDENTITY, filter="nearest", alpha=mode, background="102030", engine=engine)
            _, _, rows = read_png(folder / "o.png")
            for x in range(16):
                assert tuple(rows[3][4 * x:4 * x + 4]) == expected((200, 100, 40, 17 * x)), (mode, x)


def test_srgb(folder):
    """Black and white texels far away: half the light has code 188. Levels and filters, from a picture and from a pack; and the reference agrees."""
    (folder / "b.png").write_bytes(png_bytes(64, 64, 2, lambda x, y: [255 * ((x + y) % 2)] * 3))
    for texels_per_px in (1, 2, 8):
        matrix = f"{texels_per_px},0,{0.5 * (texels_per_px == 1)},0,{texels_per_px},0,0,0,1"
        for name, code, more in (("srgb", 188, ["--srgb"]), ("coded", 128, [])):
            done("texture", "b.png", "--out", "b.stx", *more, cwd=folder)
            for texture, extra in (("b.png", more), ("b.stx", [])):
                text = done("plane", "--texture", texture, "--size", "16x16", "--matrix", matrix, "--filter", "trilinear", "--out", "o.png", "--psnr", "--stats", "s.json", *extra, cwd=folder)
                _, _, rows = read_png(folder / "o.png")
                assert list(rows[5][20:24]) == [code, code, code, 255], (texels_per_px, name, texture, list(rows[5][20:24]))
                assert json.loads((folder / "s.json").read_text())["srgb"] == (name == "srgb")
                if texels_per_px > 1:
                    assert float(re.search(r"([\d.]+) dB", text)[1]) > 50, (texels_per_px, name, texture, text)
    # A map of one colour keeps it.
    (folder / "c.png").write_bytes(png_bytes(20, 12, pixel=lambda x, y: [201, 3, 77, 255]))
    for filter_name in FILTERS:
        done("plane", "--texture", "c.png", "--size", "32x24", "--matrix", TILTED, "--filter", filter_name, "--srgb", "--out", "o.png", cwd=folder)
        assert all(row == bytes([201, 3, 77, 255]) * 32 for row in read_png(folder / "o.png")[2]), filter_name


def test_prefilter_tables(folder):
    text = done("prefilters", cwd=folder)
    response = {line[:16].strip(): [float(n) for n in line[16:].replace("|", " ").split()] for line in text.splitlines()[2:]}
    assert set(response) == {p + s for p in PREFILTERS for s in ("", " inverse")}, text
    quarter, nyquist, alias = 2, 4, 6
    for name, row in response.items():
        assert 0.98 < row[0] < 1.02 and len(row) == 9, (name, row)
    assert response["kaiser"][quarter] > response["box"][quarter] > response["triangle"][quarter]
    assert abs(response["kaiser"][alias]) < 0.02 < 0.3 < response["box"][alias]
    for name in ("box", "triangle"):  # the inverse brings a quarter cycle back and costs an overshoot
        assert abs(response[name + " inverse"][quarter] - 1) < 0.01 and response[name][-1] == 0 < response[name + " inverse"][-1], name


if __name__ == "__main__":
    sys.exit(run_tests(globals()))

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command's contract: help, statistics, equal bytes from both engines and any number of threads, wrap modes, odd sizes of map and
picture, formats, turntables, comparison, traces."""
import itertools
import json
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from spantex_command import BINARY, FACING, FORMATS, QUAD_WITH_UV, png_bytes, read_png, run  # noqa: E402

FILTERS = ["nearest", "bilinear", "three-point", "mip-bilinear", "trilinear", "trilinear3", "squares", "aniso", "step", "hat"]
PROFILES = ["seed", "compact", "default", "exact"]
WRAPS = ["repeat", "clamp", "mirror"]
PREFILTERS = ["box", "triangle", "kaiser", "lanczos"]
IDENTITY = "1,0,0,0,1,0,0,0,1"
TILTED = "0.621854806,-0.142806403,-12.2821072,-0.226336639,-0.392357368,585.413164,0,0.000855254125,0.43752662"
HORIZON = "0.21,-0.05,-31.7,-0.08,0.13,103.9,0.0002,0.0041,-0.171"


def done(*arguments, cwd):
    result = run(*arguments, cwd=cwd)
    assert result.returncode == 0, f"spantex {' '.join(map(str, arguments))}: exit {result.returncode}: {result.stderr}"
    assert result.stderr == "", f"spantex {' '.join(map(str, arguments))}: stderr in a pipe: {result.stderr!r}"
    return result.stdout


def plane(folder, out, texture="map.png", size="64x48", matrix=FACING, **more):
    extra = [part for name, value in more.items() for part in ("--" + name, value)]
    done("plane", "--texture", texture, "--size", size, "--matrix", matrix, "--out", out, *extra, cwd=folder)
    return (folder / out).read_bytes()


def test_help(folder):
    for sub in ([], ["plane"], ["render"], ["texture"], ["prefilters"], ["compare"], ["trace"], ["bench"], ["demo"]):
        text = done(*sub, "--help", cwd=folder)
        assert "--help" in text, sub
    for option in "--texture --size --matrix --out --filter --profile --wrap --engine --prefilter --threads --repeat --stats".split():
        assert option in done("plane", "--help", cwd=folder), option
    for option in "--out --c-array --format --prefilter --wrap --inverse --alpha-weighted --alpha-test --levels --byte-order --srgb --field --inside --reduction --ink --outline --threads".split():
        assert option in done("texture", "--help", cwd=folder), option


def test_stats(folder):
    common = ("ns_per_pixel spans_total spans_skipped words_loaded loads_skipped divides second_levels_skipped "
              "threads profile filter").split()
    plane(folder, "o.png", stats="s.json", filter="trilinear", profile="exact", repeat="3", threads="2")
    stats = json.loads((folder / "s.json").read_text())
    missing = [k for k in common if k not in stats]
    assert not missing, missing
    assert "cycles" not in stats
    assert (stats["profile"], stats["filter"], stats["threads"], stats["spans_total"]) == ("exact", "trilinear", 2, 48)
    assert stats["ns_per_pixel"] > 0 and stats["words_loaded"] > 0 and set(stats["spans_skipped"]) == {"empty", "behind", "hidden"}
    plane(folder, "o.png", stats="s.json", engine="sim")
    stats = json.loads((folder / "s.json").read_text())
    assert all(k in stats for k in common + ["cycles", "stalls", "bank_conflicts"]), stats
    assert stats["bank_conflicts"] == 0 and stats["cycles"] >= 64 * 48
    assert stats["machines"] == 1 and stats["cycles_of_all_machines"] == stats["cycles"]
    for threads, machines in ((3, 3), (40, 6)):  # 48 rows of pixels are 6 of spans
        plane(folder, "o.png", stats="s.json", engine="sim", threads=str(threads))
        several = json.loads((folder / "s.json").read_text())
        assert several["machines"] == machines and several["cycles"] < stats["cycles"] <= several["cycles_of_all_machines"], several
        assert several["compute_cycles"] == stats["compute_cycles"] and several["pixels"] == stats["pixels"], several
    assert stats["format"] == "rgba8888" and 0 < stats["words_read"] and stats["words_uploaded"] >= 128 * 128 * 4 // 8
    for name, texels_a_word in (("rgb565", 4), ("palette8", 8), ("bc1", 16), ("etc2_rgba8", 8)):
        for engine in ("direct", "sim"):
            plane(folder, f"{engine}.png", stats="s.json", engine=engine, format=name)
            packed = json.loads((folder / "s.json").read_text())
            assert packed["format"] == name and packed["words_loaded"] == stats["words_loaded"], packed
            assert packed["words_read"] < stats["words_read"] and packed["words_uploaded"] < 2 * 128 * 128 // texels_a_word, packed
        assert (folder / "direct.png").read_bytes() == (folder / "sim.png").read_bytes(), name
    done("render", "fig8", "--size", "64x48", "--format", "etc1", "--out", "a.png", cwd=folder)
    done("trace", "tilted", "--size", "64x48", "--format", "bc3", "--json", "t.json", cwd=folder)
    uploads = [e for e in json.loads((folder / "t.json").read_text())["traceEvents"] if e["name"] == "map upload"]
    assert len(uploads) == 1 and uploads[0]["args"]["words"] > 512 * 512 // 8, uploads
    for sub in ("plane", "render"):
        assert "machines" in done(sub, "--help", cwd=folder), sub
    done("render", "fig8", "--size", "64x48", "--out", "o.png", "--stats", "s.json", "--psnr", cwd=folder)
    stats = json.loads((folder / "s.json").read_text())
    assert 15 < stats["psnr_db"] < 60 and stats["spans_skipped"]["hidden"] + stats["spans_skipped"]["empty"] > 0


def test_evaluations(folder):
    """How 1/w is evaluated is counted, and is no more than the plane needs: nothing where w is constant, products on an ordinary plane, a
    reciprocal a pixel only where the slope of w is large."""
    def counts(matrix, **options):
        plane(folder, "o.png", matrix=matrix, stats="s.json", filter="trilinear", **options)
        stats = json.loads((folder / "s.json").read_text())
        assert sum(stats["evaluations"].values()) == stats["jobs"], stats
        return stats["evaluations"], stats

    flat, stats = counts("1,0.25,3,-0.25,1,7,0,0,1", profile="exact")
    assert flat["affine"] == stats["jobs"] and stats["divides"] == stats["spans_total"], stats
    for profile in ("default", "exact"):
        ordinary, stats = counts("tilted", profile=profile)
        assert ordinary["series"] > stats["jobs"] / 2, stats
    near_horizon, stats = counts("1,0,0,0,1,0,0,0.02,0.01", profile="default")
    assert near_horizon["divide"] > 0 and near_horizon["series"] > 0, stats


def test_engines_agree(folder):
    for filter_name, profile, wrap in itertools.product(FILTERS, PROFILES, WRAPS):
        how = dict(filter=filter_name, profile=profile, wrap=wrap, matrix=TILTED)
        assert plane(folder, "a.png", **how) == plane(folder, "b.png", engine="sim", **how), how
    for scene, profile in itertools.product(("fig6", "fig7", "fig8", "fig9", "chessboard"), PROFILES):
        for engine in ("direct", "sim"):
            done("render", scene, "--size", "96x72", "--profile", profile, "--engine", engine, "--out", f"{engine}.png", cwd=folder)
        assert (folder / "direct.png").read_bytes() == (folder / "sim.png").read_bytes(), (scene, profile)


def test_threads_agree(folder):
    for profile, matrix in itertools.product(PROFILES, (TILTED, HORIZON)):
        pictures = {plane(folder, "o.png", size="130x97", matrix=matrix, profile=profile, threads=str(n)) for n in (1, 2, 3, 40)}
        assert len(pictures) == 1, (profile, matrix)
    pictures = set()
    for n in (1, 2, 3):
        done("render", "fig9", "--size", "130x97", "--threads", n, "--out", "o.png", cwd=folder)
        pictures.add((folder / "o.png").read_bytes())
    assert len(pictures) == 1


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


def test_sizes(folder):
    for size in ("1x1", "641x479", "4096x8", "3x4096", "7x9"):
        for threads in ("1", "2"):
            plane(folder, "o.png", size=size, matrix=TILTED, filter="trilinear", threads=threads)
        header = (folder / "o.png").read_bytes()[16:24]
        assert tuple(map(int, size.split("x"))) == (int.from_bytes(header[:4], "big"), int.from_bytes(header[4:], "big"))
    for width, height in ((1, 1), (1, 64), (100, 37), (33, 65), (255, 3), (4096, 2)):
        (folder / "n.png").write_bytes(png_bytes(width, height))
        for prefilter, wrap in itertools.product(PREFILTERS, WRAPS):
            how = dict(texture="n.png", matrix=TILTED, filter="trilinear", prefilter=prefilter, wrap=wrap, profile="exact")
            assert plane(folder, "a.png", **how) == plane(folder, "b.png", engine="sim", **how), (width, height, how)


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


def test_background_and_planes_behind(folder):
    plane(folder, "o.png", matrix="1,0,0,0,1,0,0,0,-1", background="102030")
    _, _, rows = read_png(folder / "o.png")
    assert all(row == bytes([0x10, 0x20, 0x30, 255]) * 64 for row in rows)
    plane(folder, "o.png", matrix="1,0,0,0,1,0,0,1,-24", background="102030", filter="nearest")
    _, _, rows = read_png(folder / "o.png")
    assert all(row == bytes([0x10, 0x20, 0x30, 255]) * 64 for row in rows[:23]) and rows[40] != rows[0]


def test_scaling_the_matrix_changes_nothing(folder):
    numbers = [float(x) for x in TILTED.split(",")]
    pictures = {plane(folder, "o.png", matrix=",".join(repr(x * k) for x in numbers)) for k in (1, 2.0**-200, 2.0**200, 2.0**-20)}
    assert len(pictures) == 1


def test_models(folder):
    (folder / "m.obj").write_text(QUAD_WITH_UV)
    (folder / "m.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd .\\Sub\\MAP4.png\n")
    (folder / "sub").mkdir()
    corners = {(0, 0): [255, 0, 0], (1, 0): [0, 255, 0], (0, 1): [0, 0, 255], (1, 1): [255, 255, 255]}
    (folder / "sub" / "map4.png").write_bytes(png_bytes(64, 64, 2, lambda x, y: corners[x // 32, y // 32]))
    done("render", "m.obj", "--size", "80x80", "--camera", "0,0,0", "--filter", "nearest", "--out", "o.png", cwd=folder)
    _, _, rows = read_png(folder / "o.png")
    at = lambda x, y: list(rows[y][4 * x:4 * x + 3])  # noqa: E731
    # Seen from +z with y up, the picture is the right way up: its top left is the map's top left.
    assert [at(28, 28), at(52, 28), at(28, 52), at(52, 52)] == [corners[0, 0], corners[1, 0], corners[0, 1], corners[1, 1]]
    # Both triangles of the quad: no hole and no crack along the diagonal.
    inside = [at(x, y) for y in range(14, 66) for x in range(14, 66)]
    assert [0, 0, 0] not in inside
    (folder / "m.mtl").write_text("newmtl m\nKd 0.2 0.4 0.6\n")
    done("render", "m.obj", "--size", "80x80", "--camera", "0,0,0", "--out", "o.png", cwd=folder)
    _, _, rows = read_png(folder / "o.png")
    assert at(40, 40) == [51, 102, 153]


def test_flat_and_textured_meshes(folder):
    """A mesh without texture coordinates is good where its own material has no texture."""
    (folder / "m.obj").write_text(QUAD_WITH_UV + "o bare\nusemtl flat\nf 1 4 3\n")
    (folder / "m.mtl").write_text("newmtl m\nmap_Kd map.png\nnewmtl flat\nKd 1 0 0\n")
    done("render", "m.obj", "--size", "16x16", "--out", "o.png", cwd=folder)
    (folder / "m.mtl").rename(folder / "other.mtl")
    (folder / "m.obj").write_text(QUAD_WITH_UV.replace("mtllib m.mtl", "mtllib   ./other.mtl \r"))
    done("render", "m.obj", "--size", "16x16", "--out", "o.png", cwd=folder)


def test_turntable(folder):
    done("render", "fig8", "--size", "40x30", "--frames", "3", "--out", "t-%04d.png", cwd=folder)
    frames = [(folder / f"t-{k:04d}.png").read_bytes() for k in range(3)]
    assert len(set(frames)) == 3 and not (folder / "t-0003.png").exists()


def test_outputs_replace_and_follow_links(folder):
    (folder / "target.png").write_bytes(b"old")
    os.symlink("target.png", folder / "link.png")
    data = plane(folder, "link.png")
    assert (folder / "link.png").is_symlink() and (folder / "target.png").read_bytes() == data
    assert not [p for p in folder.iterdir() if p.name.endswith(".tmp")]
    done("plane", "--texture", "map.png", "--size", "8x8", "--matrix", IDENTITY, "--out", "/dev/null", cwd=folder)
    assert not pathlib.Path("/dev/null").is_file()
    plane(folder, "/dev/null", stats="/dev/null")


def test_compare(folder):
    (folder / "a.png").write_bytes(png_bytes(20, 10, 2, lambda x, y: [100, 100, 100]))
    (folder / "b.png").write_bytes(png_bytes(20, 10, 2, lambda x, y: [110 if (x, y) == (3, 4) else 100, 100, 100]))
    text = done("compare", "a.png", "b.png", "--diff", "d.png", cwd=folder)
    # one channel of one pixel of 200 is off by 10: 10 log10(255^2 * 600 / 100)
    assert re.search(r"^PSNR +55\.91 dB$", text, re.M) and re.search(r"^worst error +10$", text, re.M), text
    assert re.search(r"^differing pixels +1 of 200$", text, re.M), text
    _, _, rows = read_png(folder / "d.png")
    assert list(rows[4][12:16]) == [10, 0, 0, 255] and rows[0] == bytes([0, 0, 0, 255]) * 20
    text = done("compare", "a.png", "a.png", cwd=folder)
    assert re.search(r"^PSNR +inf dB$", text, re.M) and re.search(r"^SSIM +1\.000000$", text, re.M), text


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


def test_changes_of_a_profile(folder):
    """The profile's own choices given by name change nothing, others do; compare takes them too; the reference is a picture of its own."""
    how = dict(matrix=TILTED)
    for engine in ("direct", "sim"):
        same = plane(folder, "a.png", filter="trilinear", engine=engine, **how)
        assert same == plane(folder, "b.png", filter="trilinear", level="jacobian", engine=engine, **how)
        pictures = {plane(folder, "b.png", filter="trilinear", level=level, engine=engine, **how) for level in ("jacobian", "major", "minor")}
        assert len(pictures) == 3
        assert plane(folder, "a.png", filter="aniso", engine=engine, **how) == plane(folder, "b.png", filter="aniso", samples="16", slack="2", bias="-8", engine=engine, **how)
        assert plane(folder, "a.png", filter="aniso", engine=engine, **how) != plane(folder, "b.png", filter="aniso", samples="1", engine=engine, **how)
    text = done("compare", "--scenes", "tilted", "--size", "64x48", "--texture", "map.png", "--filters", "trilinear:level=minor,aniso:samples=4:slack=8:bias=-4", "--out", "c", "--json", "c.json", cwd=folder)
    assert "trilinear:level=minor" in text and "aniso:samples=4:slack=8:bias=-4" in text
    rows = json.loads((folder / "c.json").read_text())
    assert [r["method"] for r in rows] == ["trilinear:level=minor", "aniso:samples=4:slack=8:bias=-4"] and all(r["pixels"] == 64 * 48 for r in rows)
    assert (folder / "c" / "tilted-aniso-samples-4-slack-8-bias--4-default.png").exists()
    done("render", "tilted", "--size", "64x48", "--texture", "map.png", "--out", "o.png", "--reference", "r.png", cwd=folder)
    assert (folder / "r.png").read_bytes() == (folder / "c" / "tilted-reference.png").read_bytes()


def test_chessboard(folder):
    text = done("chessboard", "--out", "chess", "--size", "160x120", cwd=folder)
    marks = {line[:20].strip(): float(line.split()[-2]) for line in text.splitlines()[1:]}
    assert set(marks) == {f"{kind} on the {where}" for kind in ("step", "hat") for where in ("screen", "map")}, text
    assert all(marks[f"{kind} on the map"] > marks[f"{kind} on the screen"] - 0.5 for kind in ("step", "hat")), text
    assert len(list((folder / "chess").glob("chessboard-*.png"))) == 4


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


def test_trace(folder):
    done("trace", "tilted", "--size", "64x48", "--texture", "map.png", "--vcd", "t.vcd", "--json", "t.json", "--out", "t.png", cwd=folder)
    assert "$enddefinitions" in (folder / "t.vcd").read_text()
    events = json.loads((folder / "t.json").read_text())
    events = events["traceEvents"] if isinstance(events, dict) else events
    assert len(events) > 48
    done("render", "tilted", "--size", "64x48", "--texture", "map.png", "--out", "r.png", cwd=folder)
    assert (folder / "t.png").read_bytes() == (folder / "r.png").read_bytes()
    done("trace", "--matrix", TILTED, "--texture", "map.png", "--size", "64x48", "--vcd", "m.vcd", "--single-half", cwd=folder)


def test_bench(folder):
    """Rows of who can draw what; errors that agree with --psnr; peers, where built, with the right picture."""
    size, filters = "64x48", ["nearest", "bilinear", "trilinear"]
    text = done("bench", "--scenes", "tilted,spider", "--filters", ",".join(filters), "--profiles", "seed,default", "--size", size, "--repeat", "3",
                "--json", "b.json", cwd=folder)
    bench = json.loads((folder / "b.json").read_text())
    ours = [r for r in bench["rows"] if r["drawer"] == "spantex"]
    for scene in ("tilted", "spider"):
        for kind in filters:
            of = [r for r in ours if (r["scene"], r["filter"]) == (scene, kind)]
            assert {r["profile"] for r in of if r["kernel"] == "scalar"} == {"seed", "default"}, of
            assert len({(r["rms_error"], r["words_per_pixel"]) for r in of if r["profile"] == "default"}) == 1, of  # kernels: the same picture
    for r in bench["rows"]:
        time = r["ns_per_pixel"]
        assert 0 < time["low"] <= time["median"] <= time["high"] and time["samples"] == 3, r
        assert abs(255 * 10 ** (-r["psnr_db"] / 20) - r["rms_error"]) < 1e-9 * r["rms_error"] and r["worst_error"] >= r["rms_error"], r
        assert r["scene"] + " " in text and r["drawer"] in text
    psnr = done("render", "tilted", "--size", size, "--filter", "trilinear", "--out", "t.png", "--psnr", cwd=folder)
    row = next(r for r in ours if (r["scene"], r["filter"], r["profile"]) == ("tilted", "trilinear", "default"))
    assert f"{row['psnr_db']:.2f} dB" in psnr, (row, psnr)
    peers = [r for r in bench["rows"] if r["drawer"] != "spantex"]
    assert all(r["scene"] == "tilted" and r["right_picture"] for r in peers), peers
    built = {p.stem for p in (BINARY.parent / "peers").glob("*.so")}
    assert len(bench["peers"]) == len({r["drawer"] for r in peers}) == len(built), (bench["peers"], built)
    # The same filter of the same plane: nearly our picture (null: ours exactly), but for pixman, whose coordinates are coarse.
    others = [r for r in peers if r["drawer"] != "pixman" and r["psnr_ours_db"] is not None]
    assert all(r["psnr_ours_db"] > 30 for r in others), others


def test_progress_only_on_a_terminal(folder):
    arguments = ["plane", "--texture", "map.png", "--size", "640x480", "--matrix", TILTED, "--out", "o.png", "--repeat", "40", "--kernel", "scalar"]  # long enough to show
    parent, child = pty.openpty()
    process = subprocess.Popen([str(BINARY), *arguments], cwd=folder, stderr=child)
    os.close(child)
    shown = b""
    try:
        while block := os.read(parent, 65536):
            shown += block
    except OSError:
        pass
    assert process.wait() == 0
    assert b"%" in shown and shown.rstrip().endswith(b"\r\x1b[K".rstrip()), shown[-80:]
    done(*arguments, cwd=folder)


def main():
    failed = 0
    for name, test in sorted(globals().items()):
        if not name.startswith("test_"):
            continue
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "map.png").write_bytes(png_bytes(128, 128))
            try:
                test(folder)
                print(f"ok    {name}")
            except AssertionError as error:
                failed += 1
                print(f"FAIL  {name}: {str(error)[:600]}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command's contract: help, statistics, equal bytes from both engines and any number of threads, skips, sizes, planes, models and
levels, turntables, comparison, traces."""
import itertools
import json
import os
import pathlib
import pty
import re
import struct
import subprocess
import sys
import zipfile

sys.dont_write_bytecode = True
from spantex_command import BINARY, FILTERS, HORIZON, IDENTITY, PREFILTERS, PROFILES, QUAD_WITH_UV, TILTED, WRAPS, done, plane, png_bytes, read_png, run, run_tests  # noqa: E402


def test_help(folder):
    for sub in ([], ["plane"], ["render"], ["texture"], ["prefilters"], ["compare"], ["trace"], ["bench"], ["demo"]):
        text = done(*sub, "--help", cwd=folder)
        assert "--help" in text, sub
    for option in "--texture --size --matrix --out --filter --profile --wrap --engine --prefilter --threads --repeat --stats".split():
        assert option in done("plane", "--help", cwd=folder), option
    for option in "--out --c-array --format --prefilter --wrap --inverse --alpha-weighted --alpha-test --levels --byte-order --srgb --field --inside --reduction --ink --outline --threads".split():
        assert option in done("texture", "--help", cwd=folder), option
    for sub, said in (("plane", ["1..256", "1..1000000", *(f"profile's, {x} in profile default" for x in ("jacobian", "16", "12", "2", "-8"))]), ("render", ["1..9999"]),
                      ("texture", ["1..256"]), ("stress", ["1..256"]), ("sweep", ["1..256"]), ("bench", ["1..1000"]), ("compare", ["1..1000000"])):
        text = " ".join(done(sub, "--help", cwd=folder).split())
        assert all(words in text for words in said), (sub, said, text)


def test_stats(folder):
    common = ("ns_per_pixel spans_total spans_skipped words_loaded loads_skipped divides second_levels_skipped "
              "threads profile filter").split()
    plane(folder, "o.png", stats="s.json", filter="trilinear", profile="exact", repeat="3", threads="2")
    stats = json.loads((folder / "s.json").read_text())
    missing = [k for k in common if k not in stats]
    assert not missing, missing
    assert "cycles" not in stats
    assert (stats["profile"], stats["filter"], stats["threads"], stats["spans_total"], stats["kernel"]) == ("exact", "trilinear", 2, 48, "pixels")
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
    # Levels are uploaded one by one, when a span first reads them: bc3 takes 8 texels a word.
    uploads = [e["args"]["words"] for e in json.loads((folder / "t.json").read_text())["traceEvents"] if e["name"] == "map upload"]
    assert uploads and len(set(uploads)) == len(uploads) and set(uploads) <= {(512 >> k) ** 2 // 8 for k in range(8)}, uploads
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


SKIPS = ["outside", "empty", "hidden", "floors", "held", "second-level", "other-half", "constant", "uniform", "one-texel", "copy", "opaque", "transparent", "levels"]


def test_skips(folder):
    """No skip changes the picture; without it its count is 0 and the work more."""
    text = done("render", "--help", cwd=folder)
    assert all(name in text for name in SKIPS + ["--cull", "occluded"])

    def stats_of(*arguments):
        done(*arguments, "--engine", "sim", "--stats", "s.json", "--out", "o.png", cwd=folder)
        return json.loads((folder / "s.json").read_text()), (folder / "o.png").read_bytes()

    flat, dot = folder / "flat.png", folder / "dot.png"
    flat.write_bytes(png_bytes(64, 64, pixel=lambda x, y: (9, 8, 7, 255)))
    dot.write_bytes(png_bytes(1, 1))
    (folder / "clear.png").write_bytes(png_bytes(64, 64, pixel=lambda x, y: (x, y, 7, 0)))
    on_plane = lambda texture, matrix, *more: ["plane", "--texture", texture, "--size", "64x48", "--matrix", matrix, *more]  # noqa: E731
    cubes = ["render", "fig8", "--size", "96x72"]
    close = "0.03,0,5,0,0.03,5,0,0,1"
    cases = {  # name, what shows it, its count, what is more without it
        "outside": (cubes, lambda s: s["skipped"]["outside"]["spans"], "spans_total"), "empty": (cubes, None, "fetches"), "hidden": (cubes, None, "fetches"),
        "floors": (cubes, lambda s: s["skipped"]["floors"]["spans"], None), "held": (on_plane("map.png", close), lambda s: s["loads_skipped"], "words_loaded"),
        "second-level": (on_plane("map.png", close), lambda s: s["second_levels_skipped"], "words_loaded"),
        "other-half": (on_plane("map.png", close), lambda s: s["skipped"]["other-half"]["jobs"], "words_loaded"),
        "constant": (on_plane("dot.png", TILTED), lambda s: s["skipped"]["constant"]["spans"], "divides"),
        "uniform": (on_plane("flat.png", TILTED), lambda s: s["skipped"]["uniform"]["jobs"], "words_loaded"),
        "one-texel": (on_plane("map.png", "0.01,0,3.2,0,0.01,3.2,0,0,1", "--filter", "nearest"), lambda s: s["skipped"]["one-texel"]["jobs"], "words_loaded"),
        "copy": (on_plane("map.png", IDENTITY), lambda s: s["skipped"]["copy"]["jobs"], "fetches"),
        "opaque": ([*cubes, "--alpha", "blended"], lambda s: s["skipped"]["opaque"]["pixels"], "pixels_blended"),
        "transparent": (on_plane("clear.png", TILTED, "--alpha", "cut-out"), lambda s: s["skipped"]["transparent"]["jobs"], "words_loaded"),
        "levels": (on_plane("map.png", TILTED, "--filter", "bilinear"), lambda s: s["skipped"]["levels"]["levels"], "words_uploaded"),
    }
    assert sorted(cases) == sorted(SKIPS)
    mip, picture = stats_of(*on_plane("map.png", TILTED, "--format", "bc1"))  # levels of a filter that has them, too
    whole, same = stats_of(*on_plane("map.png", TILTED, "--format", "bc1"), "--no-skip", "levels")
    assert picture == same and mip["skipped"]["levels"]["levels"] > 0 and mip["words_uploaded"] < whole["words_uploaded"], mip
    assert 0 < mip["blocks_decoded"] == whole["blocks_decoded"]
    for name, (arguments, counted, work) in cases.items():
        skipped, picture = stats_of(*arguments, *(["--skip", name] if name == "other-half" else []))
        without, same = stats_of(*arguments, "--no-skip", name)
        assert picture == same, name
        if counted is not None:
            assert counted(skipped) > 0 and counted(without) == 0, (name, skipped, without)
        if work is not None:
            assert skipped[work] < without[work], (name, work, skipped[work], without[work])
        assert stats_of(*arguments, "--no-skip", "all")[1] == picture, name
        for threads in ("2", "5"):
            done(*arguments, "--threads", threads, "--out", "t.png", cwd=folder)
            assert (folder / "t.png").read_bytes() == picture, (name, threads)


def test_unchanged_spans(folder):
    """Frames are the same with and without what they keep of the frame before; a camera that moves keeps nothing."""
    assert "unchanged" in done("render", "--help", cwd=folder)

    def frames_of(subject, *arguments, count=4):
        done("render", *subject, "--size", "96x72", *arguments, "--stats", "s.json", "--out", "f%d.png", cwd=folder)
        stats = json.loads((folder / "s.json").read_text())["frames"]
        return [f["skipped"]["unchanged"]["spans"] for f in stats], stats, [(folder / f"f{k}.png").read_bytes() for k in range(count)]

    for more in ([], ["--engine", "sim"], ["--kernel", "scalar", "--threads", "3"], ["--alpha", "blended"], ["--order", "depths"]):
        kept, stats, pictures = frames_of(["turning", "--frames", "4"], *more)
        none, alone, same = frames_of(["turning", "--frames", "4"], "--no-skip", "unchanged", *more)
        assert pictures == same and len(set(pictures)) == 4, more
        assert kept[0] == 0 and all(54 < k < 108 for k in kept[1:]) and none == [0] * 4, (more, kept, none)
        assert all(2 * f["words_loaded"] < g["words_loaded"] for f, g in zip(stats[1:], alone[1:])), more
        assert frames_of(["turning", "--frames", "4"], "--no-skip", "all", *more)[0] == none
    assert frames_of(["fig8", "--frames", "4"])[0] == [0] * 4


SCALED = "0.73,0,11.3,0,0.61,5.7,0,0,1"


def test_every_kernel_draws_the_same_on_any_number_of_threads(folder):
    kernels = [k for k in ("scalar", "pixels", "words", "sse41", "avx2", "avx512", "avx512-gathers", "neon")
               if run("plane", "--texture", "map.png", "--size", "8x8", "--matrix", IDENTITY, "--kernel", k, "--out", "o.png", cwd=folder).returncode == 0]
    assert {"scalar", "pixels", "words"} <= set(kernels), kernels
    (folder / "alpha.png").write_bytes(png_bytes(64, 64, 6, lambda x, y: [200, 4 * x, 4 * y, (37 * x + 91 * y) % 256]))
    numbers = ("3", "40") if os.environ.get("SPANTEX_SANITIZED") else ("1", "2", "3", "40")
    for filter_name in ("nearest", "bilinear", "mip-bilinear", "trilinear", "aniso"):
        for subject in (["plane", "--texture", "map.png", "--matrix", HORIZON], ["plane", "--texture", "map.png", "--matrix", TILTED],
                        ["plane", "--texture", "map.png", "--matrix", SCALED], ["render", "fig8"], ["render", "fig9"],
                        ["plane", "--texture", "alpha.png", "--matrix", TILTED, "--alpha", "blended"], ["render", "fig8", "--alpha", "cut-out"],
                        ["plane", "--texture", "alpha.png", "--matrix", TILTED, "--srgb", "--alpha", "premultiplied"], ["render", "fig9", "--srgb"]):
            pictures = {}
            for kernel, threads in itertools.product(kernels, numbers):
                done(*subject, "--filter", filter_name, "--size", "130x197", "--kernel", kernel, "--threads", threads, "--out", "o.png", cwd=folder)
                pictures.setdefault((folder / "o.png").read_bytes(), []).append((kernel, threads))
            assert len(pictures) == 1, (filter_name, subject, list(pictures.values()))
    widest = set()  # rows of as many spans as there may be
    for kernel in kernels:
        done("plane", "--texture", "alpha.png", "--matrix", TILTED, "--alpha", "blended", "--srgb", "--filter", "bilinear", "--size", "4096x9", "--kernel", kernel, "--out", "o.png", cwd=folder)
        widest.add((folder / "o.png").read_bytes())
    assert len(widest) == 1


def test_culling_leaves_the_picture_of_a_closed_model(folder):
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [(1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6)]  # counterclockwise from outside
    (folder / "m.mtl").write_text("newmtl m\nmap_Kd map.png\n")
    (folder / "cube.obj").write_text("mtllib m.mtl\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n" +
                                     "".join("f " + " ".join(f"{v}/{k + 1}" for k, v in enumerate(f)) + "\n" for f in faces))

    def drawn(cull):
        done("render", "cube.obj", "--size", "120x90", "--camera", "35,25,0", "--kernel", "scalar", "--cull", cull, "--stats", "s.json", "--out", "o.png", cwd=folder)
        return (folder / "o.png").read_bytes(), json.loads((folder / "s.json").read_text())

    (all_of_it, plain), (fronts, culled), (backs, _) = drawn("none"), drawn("clockwise"), drawn("counterclockwise")
    assert plain["skipped"]["cull"]["polygons"] == 0 and culled["skipped"]["cull"]["polygons"] == 6
    assert fronts == all_of_it and backs != all_of_it
    assert culled["spans_total"] < plain["spans_total"] and culled["words_loaded"] <= plain["words_loaded"]


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
    for threads in ("2", "3", "8"):  # several encoded at once, some at the end
        done("render", "fig8", "--size", "40x30", "--frames", "3", "--threads", threads, "--out", threads + "-%d.png", cwd=folder)
        assert [(folder / f"{threads}-{k}.png").read_bytes() for k in range(3)] == frames, threads


def level_bytes(texture):
    """A Quake III map: one square room, two units high, and two places in it."""
    corners = [(x, y, z) for z in (0, 96) for y in (0, 256) for x in (0, 256)]
    sides = [(0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 4, 5), (2, 3, 6, 7), (0, 2, 4, 6), (1, 3, 5, 7)]
    vertices, indices, faces = b"", b"", b""
    for k, side in enumerate(sides):
        for c, uv in zip(side, ((0, 0), (1, 0), (0, 1), (1, 1))):
            vertices += struct.pack("<3f2f20x4x", *corners[c], *uv)
        indices += struct.pack("<6i", 0, 1, 2, 2, 1, 3)
        faces += struct.pack("<7i76x", 0, 0, 1, 4 * k, 4, 6 * k, 6)
    places = b"".join(b'{ "classname" "info_player_start" "origin" "%d 128 24" }\n' % x for x in (40, 216))
    lumps = {0: places, 1: texture.encode("latin-1").ljust(64, b"\0") + bytes(8), 10: vertices, 11: indices, 13: faces}
    table, body = b"", b""
    for k in range(17):
        table += struct.pack("<2i", 144 + len(body), len(lumps.get(k, b"")))
        body += lumps.get(k, b"")
    return b"IBSP" + struct.pack("<i", 46) + table + body


def write_wall(folder):
    """Two triangles before forty-nine."""
    wall = "v -4 -4 0\nv 4 -4 0\nv 4 4 0\nv -4 4 0\n"
    behind = "".join(f"v {x / 2} {y / 2} -2\nv {x / 2 + 0.4} {y / 2} -2\nv {x / 2} {y / 2 + 0.4} -2.2\n" for x in range(-3, 4) for y in range(-3, 4))
    faces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n" + "".join(f"f {5 + 3 * k}/1 {6 + 3 * k}/2 {7 + 3 * k}/4\n" for k in range(49))
    (folder / "wall.mtl").write_text("newmtl m\nmap_Kd wall.png\n")
    (folder / "wall.obj").write_text("mtllib wall.mtl\n" + wall + behind + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n" + faces)
    (folder / "wall.png").write_bytes(png_bytes(16, 16, pixel=lambda x, y: (16 * x, 16 * y, 99, 200)))


def test_hidden_faces(folder):
    """Triangles behind a wall: not set up where they are drawn nearest first and opaque, counted, and the same picture; set up where something shows through."""
    write_wall(folder)

    def drawn(*more):
        done("render", "wall.obj", "--size", "96x72", "--eye", "0,0,3", "--target", "0,0,0", "--fov", "60", "--stats", "s.json", "--out", "o.png", *more, cwd=folder)
        stats = json.loads((folder / "s.json").read_text())
        return stats["skipped"]["occluded"]["polygons"], (folder / "o.png").read_bytes(), stats

    hidden, picture, stats = drawn("--order", "nearest", "--psnr", "--reference", "r.png")
    assert 30 < hidden < 49 and stats["spans_skipped"]["hidden"] > 0, stats  # the nearest are set up together
    reference = (folder / "r.png").read_bytes()
    assert drawn("--order", "nearest", "--no-skip", "occluded", "--psnr", "--reference", "r.png")[2]["psnr_db"] == stats["psnr_db"] and (folder / "r.png").read_bytes() == reference
    for more in (["--no-skip", "occluded"], ["--no-skip", "all"], []):
        count, same, _ = drawn(*more, "--order", "file" if not more else "nearest")
        assert count == 0 and same == picture, more
    for more in (["--order", "depths"], ["--threads", "3"], ["--kernel", "scalar"], ["--engine", "sim"], ["--profile", "seed", "--filter", "bilinear"]):
        order = [] if "--order" in more else ["--order", "nearest"]
        count, same, _ = drawn(*order, *more)
        assert count == hidden and same == drawn(*order, "--no-skip", "occluded", *more)[1], more
    for more in (["--alpha", "blended"], ["--cull", "clockwise"], ["--space", "object"]):
        assert drawn("--order", "nearest", *more)[0] == 0, more
    done("render", "wall.obj", "--size", "96x72", "--order", "nearest", "--frames", "3", "--out", "f%d.png", "--stats", "s.json", cwd=folder)
    for frame in json.loads((folder / "s.json").read_text())["frames"]:
        assert frame["polygons_set_up"] <= frame["polygons"] <= 51 and frame["skipped"]["occluded"]["polygons"] >= frame["polygons"] - frame["polygons_set_up"], frame


def test_frames_against_peers(folder):
    """bench --model: ours by each kernel, peers that draw triangles and show the same, JSON beside it."""
    write_wall(folder)
    peers = "mesa" if (BINARY.parent / "peers/mesa.so").exists() else "none"
    done("bench", "--model", "wall.obj", "--size", "64x48", "--frames", "3", "--repeat", "1", "--filters", "trilinear,bilinear", "--kernels", "scalar,words", "--peers", peers, "--json", "b.json", cwd=folder)
    report = json.loads((folder / "b.json").read_text())
    ours = [r for r in report["rows"] if "kernel" in r]
    assert [r["kernel"] for r in ours] == ["scalar", "words"] * 2 and report["frames"] == 3, report
    assert all(0 < r["set_up_ms"]["median"] <= r["all_ms"]["median"] <= r["most_ms"] and r["psnr_db"] > 10 for r in ours), report
    theirs = [r for r in report["rows"] if "kernel" not in r]
    assert len(theirs) == (2 if peers == "mesa" else 0) and all(r["right_picture"] and r["psnr_ours_db"] > 30 for r in theirs), theirs


def test_levels(folder):
    """From an archive, its texture from another beside it: a walk whose frames differ, the same bytes in either order and by engine and kernel; statistics of each frame and of textures that are missing; a path."""
    with zipfile.ZipFile(folder / "maps.pk3", "w") as a:
        a.writestr("maps/room.bsp", level_bytes("textures/wall"))
        a.writestr("maps/other.bsp", b"")
    with zipfile.ZipFile(folder / "pictures.pk3", "w", zipfile.ZIP_DEFLATED) as a:
        a.writestr("Textures/Wall.PNG", png_bytes(16, 16, 2, lambda x, y: [200, 16 * x, 16 * y]))
    level = ["render", "maps.pk3", "--map", "room", "--size", "64x48", "--fov", "60"]
    done(*level, "--frames", "4", "--out", "w%d.png", "--stats", "w.json", cwd=folder)
    frames = [(folder / f"w{k}.png").read_bytes() for k in range(4)]
    assert len(set(frames)) == 4
    _, _, rows = read_png(folder / "w0.png")
    assert all(rows[y][4 * x] == 200 for y in range(48) for x in range(64)), "the room is closed, and textured from the other archive"
    stats = json.loads((folder / "w.json").read_text())["frames"]
    for f in stats:
        assert f["pixels_shown"] == 64 * 48 <= f["pixels"] <= f["pixels_tested"] and 1 <= f["polygons"] <= 12 and f["words_loaded"] > 0, f
    assert json.loads((folder / "w.json").read_text())["textures_missing"] == []
    with zipfile.ZipFile(folder / "bare.pk3", "w") as a:
        a.writestr("MAPS/Bare.BSP", level_bytes("textures/stra\xdfe"))  # no UTF-8
    done("render", "bare.pk3", "--map", "bare", "--size", "32x24", "--out", "o.png", "--stats", "b.json", cwd=folder)
    assert json.loads((folder / "b.json").read_text())["textures_missing"] == ["textures/stra\ufffde"]
    for more in (["--kernel", "scalar"], ["--order", "file"], ["--engine", "sim"], ["--order", "depths"], ["--order", "depths", "--kernel", "scalar", "--threads", "3"]):
        done(*level, "--frames", "4", "--out", "v%d.png", "--stats", "v.json", *more, cwd=folder)
        assert [(folder / f"v{k}.png").read_bytes() for k in range(4)] == frames, more
        drawn = json.loads((folder / "v.json").read_text())["frames"]
        assert "depths" not in more or all(f["pixels"] == 64 * 48 for f in drawn), "every pixel once"
    done(*level, "--out", "o.png", cwd=folder)
    assert (folder / "o.png").read_bytes() == frames[0]
    (folder / "p.path").write_text("# a frame a line\n40,50,-128,200,50,-128\n\n40,50,-128,40,50,-200\n")
    done(*level, "--path", "p.path", "--out", "p%d.png", cwd=folder)
    assert (folder / "p0.png").read_bytes() != (folder / "p1.png").read_bytes() and not (folder / "p2.png").exists()
    assert (folder / "p0.png").read_bytes() == frames[0], "from the first place to the second"
    assert run(*level, "--out", "pictures.pk3", cwd=folder).returncode == 2 and zipfile.is_zipfile(folder / "pictures.pk3"), "what the textures are read from"
    (folder / "textures").mkdir()
    (folder / "textures/loose.png").write_bytes(png_bytes(16, 16))
    with zipfile.ZipFile(folder / "loose.pk3", "w") as a:
        a.writestr("maps/loose.bsp", level_bytes("textures/loose"))
    replaced = run("render", "loose.pk3", "--map", "loose", "--size", "32x24", "--out", "textures/loose.png", cwd=folder)
    assert replaced.returncode == 2 and (folder / "textures/loose.png").read_bytes() == png_bytes(16, 16), "a picture beside the archive"
    (folder / "crlf.path").write_bytes((folder / "p.path").read_bytes().replace(b"\n", b"\r\n"))
    for name in ("crlf.path", "/dev/stdin"):
        subprocess.run([str(BINARY), *level, "--path", name, "--out", "q%d.png"], input=(folder / "p.path").read_bytes(), cwd=folder, check=True)
        assert all((folder / f"q{k}.png").read_bytes() == (folder / f"p{k}.png").read_bytes() for k in (0, 1)), name
    (folder / "bad.path").write_text("40,50,-128,200,50,-128\n40,50,-128,40,50,-128\n")  # a camera at its own target: the frame before it stays
    for threads in ("1", "3"):
        failed = run(*level, "--path", "bad.path", "--out", threads + "b%d.png", "--threads", threads, cwd=folder)
        assert failed.returncode == 2 and (folder / f"{threads}b0.png").read_bytes() == (folder / "p0.png").read_bytes() and not (folder / f"{threads}b1.png").exists(), failed
    (folder / "away.path").write_text(2 * "9000,9000,9000,9100,9000,9000\n")
    done(*level, "--path", "away.path", "--out", "a%d.png", "--stats", "a.json", cwd=folder)
    away, _ = json.loads((folder / "a.json").read_text())["frames"]
    assert (away["polygons"], away["pixels_tested"], away["pixels_shown"], away["pixels"]) == (0, 0, 0, 0), "nothing in view"
    done("render", "maps.pk3", "--map", "room", "--size", "64x48", "--eye", "40,50,-128", "--target", "200,50,-128", "--fov", "60", "--out", "e.png", cwd=folder)
    assert (folder / "e.png").read_bytes() == frames[0]


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


def test_changes_of_a_profile(folder):
    """The profile's own choices given by name change nothing, others do; compare takes them too; the reference is a picture of its own."""
    how = dict(matrix=TILTED)
    for engine in ("direct", "sim"):
        same = plane(folder, "a.png", filter="trilinear", engine=engine, **how)
        assert same == plane(folder, "b.png", filter="trilinear", level="jacobian", engine=engine, **how)
        pictures = {plane(folder, "b.png", filter="trilinear", level=level, engine=engine, **how) for level in ("jacobian", "major", "minor")}
        assert len(pictures) == 3
        assert plane(folder, "a.png", filter="aniso", engine=engine, **how) == plane(folder, "b.png", filter="aniso", samples="16", spacing="12", slack="2", bias="-8", engine=engine, **how)
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
    # In linear light, other colours than as coded, but for nearest; the peers that know it agree with ours.
    text = done("bench", "--srgb", "--scenes", "tilted", "--filters", "nearest,trilinear", "--profiles", "default", "--size", size, "--repeat", "1", "--json", "l.json", cwd=folder)
    light = json.loads((folder / "l.json").read_text())
    assert light["srgb"] and not bench["srgb"] and "linear light" in text, text
    psnr = done("render", "tilted", "--size", size, "--filter", "trilinear", "--srgb", "--out", "t.png", "--psnr", cwd=folder)
    rows = [r for r in light["rows"] if r["drawer"] == "spantex" and r["filter"] == "trilinear"]
    assert len(rows) > 1 and all(f"{r['psnr_db']:.2f} dB" in psnr for r in rows), (rows, psnr)
    assert len({r["rms_error"] for b in (bench, light) for r in b["rows"] if (r["scene"], r["filter"], r.get("profile")) == ("tilted", "trilinear", "default")}) == 2
    mesa = [r for r in light["rows"] if r["drawer"] == "llvmpipe"]
    assert len(mesa) == (2 if "mesa" in built else 0) and all(r["psnr_ours_db"] is None or r["psnr_ours_db"] > 30 for r in mesa), mesa
    assert not any(r["drawer"] in ("OpenCV", "pixman") and r["filter"] == "trilinear" for r in light["rows"])
    text = done("bench", "--scenes", "facing", "--filters", "all", "--profiles", "seed", "--kernels", "scalar", "--peers", "none", "--size", "8x8", "--repeat", "1", cwd=folder)
    assert all(f" {name} " in text for name in FILTERS) and "contour" not in text, text
    # A plane of one's own, alone and after named ones; a shift by whole texels is everybody's same picture.
    for named in ([], ["--scenes", "tilted"]):
        done("bench", *named, "--matrix", "1,0,5,0,1,-3,0,0,1", "--filters", "nearest,bilinear", "--profiles", "default", "--size", size, "--repeat", "1", "--json", "m.json", cwd=folder)
        rows = json.loads((folder / "m.json").read_text())["rows"]
        assert list(dict.fromkeys(r["scene"] for r in rows)) == [*named[1:], "matrix"], named
        shifted = [r for r in rows if r["scene"] == "matrix"]
        assert {r["drawer"] for r in shifted} >= {"spantex"} and len({r["rms_error"] for r in shifted}) == 1, shifted


def test_stress_says_that_it_was_stopped(folder):
    for seconds, evaluations, complete in (("0.05", "1000000000000", False), ("1e9", "1000", True)):
        text = done("stress", "--family", "horizon", "--evaluations", evaluations, "--seconds", seconds, "--json", "s.json", cwd=folder)
        assert ("INCOMPLETE" not in text) == json.loads((folder / "s.json").read_text())["complete"] == complete, text


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


if __name__ == "__main__":
    sys.exit(run_tests(globals()))

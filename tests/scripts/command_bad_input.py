#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bad input of every kind ends in exit code 2, one line on stderr that names the file or option and the reason, and no file left."""
import functools
import io
import os
import pathlib
import re
import resource
import struct
import subprocess
import sys
import tempfile
import zipfile
import zlib

sys.dont_write_bytecode = True
from spantex_command import FORMATS, BINARY, FACING, QUAD_WITH_UV, QUAD_WITHOUT_UV, png_bytes, run  # noqa: E402

FILTERS = ["nearest", "bilinear", "three-point", "mip-bilinear", "trilinear", "trilinear3", "squares", "aniso", "step", "hat", "contour"]


# One mesh with a texture and coordinates, one with the same texture and none.
MIXED_MESHES = ("mtllib half.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
                "o covered\nusemtl m\nf 1/1 2/2 3/3\no bare\nusemtl m\nf 1 3 4\n")
EMPTY_LEVEL = b"IBSP" + struct.pack("<35i", 46, *[144, 0] * 17)
SPARSE = {"vast.png": 3 << 30, "vast.obj": 3 << 30, "large.png": 400 << 20}
SMALL_MEMORY_BYTES = 256 << 20


def bmp_header(width, height):
    return b"BM" + struct.pack("<IHHIIiiHHIIiiII", 54 + width * height * 3, 0, 0, 54, 40, width, height, 1, 24, 0, 0, 0, 0, 0, 0)


def archive(files, kind=zipfile.ZIP_DEFLATED):
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", kind) as a:
        for name, content in files.items():
            a.writestr(name, content)
    return data.getvalue()


def pack_bytes(**changed):
    """A pack of one rgba8888 texel; its header sealed after the changes, unless they are to the checksum."""
    fields = dict(magic=b"STX\x1a", version=1, header=56, total=64, format=0, levels=1, wraps=b"\0\0", width=1, height=1, flags=3, order=0,
                  threshold=0, uniform=1, colours=0, palette=0, reserved=0, offset=56, size=4, payload=b"\1\2\3\xff\0\0\0\0")
    fields.update(changed)
    f = fields
    fixed = (f["magic"] + struct.pack("<HHIBB", f["version"], f["header"], f["total"], f["format"], f["levels"]) + f["wraps"] +
             struct.pack("<HHHBBHHIQI", f["width"], f["height"], f["flags"], f["order"], f["threshold"], f["uniform"], f["colours"], f["palette"],
                         f["reserved"], f.get("payload_crc", zlib.crc32(f["payload"]))))
    table = struct.pack("<II", f["offset"], f["size"])
    return fixed + struct.pack("<I", f.get("header_crc", zlib.crc32(fixed + table))) + table + f["payload"]


PACKS = {  # damage and the words that tell it
    "magic.stx": (dict(magic=b"STY\x1a"), "not a texture pack"), "version.stx": (dict(version=9), "version"),
    "header.stx": (dict(header_crc=1), "checksum of its header"), "payload.stx": (dict(payload_crc=1), "checksum of its texels"),
    "format.stx": (dict(format=200), "undefined header field"), "flags.stx": (dict(flags=0x8000), "undefined header field"),
    "wide.stx": (dict(width=5000), "size out of range"), "layout.stx": (dict(offset=64), "do not fit"),
    "far.stx": (dict(offset=0xFFFFFFF8), "do not fit"), "long.stx": (dict(total=72), "truncated"),
    "colours.stx": (dict(format=8, size=1), "undefined header field"), "many.stx": (dict(format=9, size=1, colours=17, palette=56), "undefined header field"),
    "no_palette.stx": (dict(colours=1, palette=56), "undefined header field"),
    "palette.stx": (dict(format=8, size=1, colours=1, palette=64), "do not fit"), "block.stx": (dict(format=10, size=4), "do not fit"),
    "style.stx": (dict(flags=11), "undefined header field"), "styled.stx": (dict(reserved=1), "undefined header field"),
    "order.stx": (dict(format=1, order=2, size=2), "byte order"),
}


def make_inputs(folder):
    good = png_bytes(64, 64)
    files = {
        "good.png": good, "small.png": png_bytes(32, 64), "empty.png": b"", "text.png": b"this is not a picture\n" * 20,
        "checksum.png": good[:-20] + bytes([good[-20] ^ 1]) + good[-19:],
        "truncated.png": good[:len(good) // 2], "header.png": good[:40], "wide.png": png_bytes(4097, 1), "tall.png": png_bytes(1, 4097),
        "truncated.bmp": bmp_header(64, 64) + b"\x55" * 900,
        "noise.png": good[:60] + bytes((b * 7 + 3) % 256 for b in good[60:-30]) + good[-30:],
        "plain.obj": QUAD_WITHOUT_UV.encode(), "garbage.obj": b"\x00\x01\x02 nonsense", "garbage.xyz": b"nonsense",
        "short.bsp": b"IBSP", "old.bsp": b"IBSP" + struct.pack("<35i", 29, *[0] * 34), "cut.bsp": b"IBSP" + struct.pack("<35i", 46, 144, 1, *[0] * 32), "void.bsp": EMPTY_LEVEL,
        "garbage.pk3": b"nonsense", "none.pk3": archive({"a.txt": b"a"}), "two.pk3": archive({"maps/one.bsp": EMPTY_LEVEL, "maps/two.bsp": EMPTY_LEVEL}),
        "flipped.pk3": archive({"maps/one.bsp": EMPTY_LEVEL}, zipfile.ZIP_STORED).replace(EMPTY_LEVEL, EMPTY_LEVEL[:-1] + b"\1"),
        "short.path": b"# eye, target\n1,2,3\n", "empty.path": b"# nothing\n", "one.path": b"1,2,3,0,0,0\n",
        "points.obj": b"v 0 0 0\nv 1 0 0\nvt 0 0\n",
        "lost.obj": QUAD_WITH_UV.replace("m.mtl", "lost.mtl").encode(), "lost.mtl": b"newmtl m\nKd 1 1 1\nmap_Kd lost_texture.png\n",
        "broken.obj": QUAD_WITH_UV.replace("m.mtl", "broken.mtl").encode(), "broken.mtl": b"newmtl m\nKd 1 1 1\nmap_Kd truncated.png\n",
        "huge.obj": QUAD_WITH_UV.replace("vt 1 1", "vt 1e6 1").replace("m.mtl", "huge.mtl").encode(),
        "textured.obj": QUAD_WITH_UV.replace("m.mtl", "huge.mtl").encode(),
        "huge.mtl": b"newmtl m\nmap_Kd good.png\n",
        "half.obj": MIXED_MESHES.encode(), "half.mtl": b"newmtl m\nmap_Kd good.png\nnewmtl flat\nKd 1 0 0\n",
        "nolib.obj": QUAD_WITH_UV.replace("m.mtl", "no such library.mtl").encode(),
        "point.obj": re.sub(r"(?m)^v .*$", "v 1 2 3", QUAD_WITH_UV).replace("m.mtl", "huge.mtl").encode(),
        "line.obj": re.sub(r"(?m)^v (\S+) .*$", r"v \1 0 0", QUAD_WITH_UV).replace("m.mtl", "huge.mtl").encode(),
    }
    files.update({name: pack_bytes(**changed) for name, (changed, _) in PACKS.items()})
    files.update({"good.stx": pack_bytes(), "srgb.stx": pack_bytes(flags=7), "cut.stx": pack_bytes()[:60], "stub.stx": b"STX\x1a", "none.stx": b"", "picture.stx": good,
                  "pack_named.png": pack_bytes(header_crc=1)})
    for name, data in files.items():
        (folder / name).write_bytes(data)
    for name, size in SPARSE.items():
        with open(folder / name, "wb") as file:
            file.truncate(size)
    (folder / "link.png").symlink_to("small.png")
    (folder / "full.h").symlink_to("/dev/full")
    (folder / "folder").mkdir()
    (folder / "folder" / "tilted-reference.png").write_bytes(good)


def plane(**changed):
    options = {"texture": "good.png", "size": "32x24", "matrix": FACING, "out": "out.png"}
    options.update(changed)
    return ["plane"] + [part for name, value in options.items() if value is not None for part in ("--" + name, value)]


def texture(picture="good.png", *more):
    return ["texture", picture, *(more if "--out" in more or "--c-array" in more else ("--out", "out.stx", *more))]


def render(subject, *more):
    return ["render", subject, "--size", "32x24", *(more if "--out" in more else ("--out", "out.png", *more))]


# Arguments, and words that the message must hold.
CASES = [
    # pictures
    (plane(texture="missing.png"), ["missing.png", "No such file"]),
    (plane(texture="folder"), ["folder", "directory"]),
    (plane(texture="empty.png"), ["empty.png", "empty"]),
    (plane(texture="text.png"), ["text.png", "cannot decode"]),
    (plane(texture="truncated.png"), ["truncated.png", "truncated"]),
    (plane(texture="checksum.png"), ["checksum.png", "cannot decode", "IDAT"]),
    *[([*plane(), "--kernel", "words", *more], ["--kernel words", "profile default"])
      for more in (["--profile", "seed"], ["--slack", "8", "--filter", "aniso"], ["--filter", "squares"], ["--engine", "sim"], ["--no-skip", "empty"])],
    *[([*plane(), "--kernel", "pixels", *more], ["--kernel pixels", "exact"]) for more in (["--profile", "seed"], ["--profile", "compact"], ["--level", "major"], ["--filter", "three-point"])],
    (plane(texture="header.png"), ["header.png", "truncated"]),
    (plane(texture="truncated.bmp"), ["truncated.bmp", "truncated"]),
    (plane(texture="noise.png"), ["noise.png"]),
    (plane(texture="wide.png"), ["wide.png", "4097x1", "4096"]),
    (plane(texture="tall.png"), ["tall.png", "1x4097", "4096"]),
    # matrices
    (plane(matrix="1,0,0,0,1,0,0,0"), ["--matrix", "9 numbers", "8"]),
    (plane(matrix="1,0,0,0,1,0,0,0,1,0"), ["--matrix", "9 numbers", "10"]),
    (plane(matrix=""), ["--matrix"]),
    (plane(matrix="1,0,0,0,1,0,0,,1"), ["--matrix", "not a number"]),
    (plane(matrix="1,0,0,0,one,0,0,0,1"), ["--matrix", "one", "not a number"]),
    (plane(matrix="1,0,0,0,1x,0,0,0,1"), ["--matrix", "1x", "not a number"]),
    (plane(matrix="1,0,0,0,nan,0,0,0,1"), ["--matrix", "nan", "finite"]),
    (plane(matrix="1,0,0,0,1,0,0,0,inf"), ["--matrix", "inf", "finite"]),
    (plane(matrix="1,0,0,0,1,0,0,0,1e999"), ["--matrix", "1e999", "finite"]),
    (plane(matrix="0,0,0,0,0,0,0,0,0"), ["--matrix", "singular"]),
    (plane(matrix="1,2,3,2,4,6,0,0,1"), ["--matrix", "singular"]),
    (plane(matrix="1e-9,2e-9,3e-9,2e9,4e9,6e9,0,0,1"), ["--matrix", "singular"]),
    (plane(matrix="1,0,0,0,1,0,0,0,0"), ["--matrix", "singular"]),
    (plane(matrix="1e12,0,1e12,0,1e12,1e12,0,0,1"), ["--matrix", "overflow"]),
    (plane(matrix="1e308,0,1e308,0,1e308,1e307,0,0,1e-300"), ["--matrix"]),
    (plane(format="dxt1"), ["unknown format", "dxt1", "etc2_rgb8"]),
    # sizes
    *[(plane(size=s), ["--size", s]) for s in ("0x24", "32x0", "4097x24", "32x4097", "32", "32x", "x24", "-1x24", "1e3x24", "32x24x8",
                                               "99999999999x1", " 32x24")],
    (["render", "fig6", "--size", "0x0", "--out", "out.png"], ["--size", "0x0"]),
    # names
    (plane(filter="cubic"), ["filter", "cubic", *FILTERS]),
    (plane(profile="best"), ["profile", "best", "seed", "compact", "default", "exact"]),
    (plane(wrap="tile"), ["wrap", "tile", "repeat", "clamp", "mirror"]),
    (plane(engine="gpu"), ["engine", "gpu", "direct", "sim"]),
    (plane(prefilter="none"), ["prefilter", "none", "box", "triangle", "kaiser", "lanczos"]),
    (plane(alpha="glass"), ["alpha", "glass", "opaque", "cut-out", "blended", "premultiplied"]),
    *[(plane(alpha=a), ["--alpha", a]) for a in ("cut-out:256", "cut-out:", "cut-out:-1", "cut-out:1:2", "blended:3", "opaque:128")],
    (plane(alpha=""), ["alpha"]),
    *[(plane(filter="contour", **{name: value}), ["--" + name, value]) for name, value in (
        ("outline", "-1"), ("outline", "16"), ("outline", "wide"), ("outline", "nan"), ("threshold", "256"), ("threshold", "-1"),
        ("field-scale", "0"), ("field-scale", "256"), ("field-scale", "1e9"))],
    *[(plane(**{name: "1"}), ["--" + name, "contour"]) for name in ("outline", "threshold", "field-scale")],
    *[(plane() + ["--no-skip", names], ["--no-skip", names.split(",")[-1], "uniform"]) for names in ("unifrom", "uniform,", "all,none", "uniform,Held")],
    (plane() + ["--skip", "uniform"], ["--skip", "uniform", "other-half"]),
    (plane() + ["--cull", "back"], ["back", "clockwise"]), (plane() + ["--cull", "clockwise", "--psnr"], ["--psnr", "--cull"]),
    (plane(alpha="blended") + ["--psnr"], ["--psnr", "--alpha"]), (render("tilted", "--alpha", "blended", "--reference", "r.png"), ["--reference:", "--alpha"]),
    (render("contour", "--filter", "contour", "--psnr"), ["--psnr", "contour"]),
    (render("fig10"), ["fig10", "fig6", "fig9", "grazing"]),
    (["paint"], ["paint", "plane", "render", "texture", "prefilters", "compare", "trace", "stress", "demo"]),
    ([], ["subcommand", "plane"]),
    # options
    (plane(out=None), ["--out"]),
    (plane(texture=None), ["--texture"]),
    (plane(size=None), ["--size"]),
    (plane(matrix=None), ["--matrix"]),
    (plane() + ["--colour", "red"], ["--colour"]),
    (plane() + ["stray"], ["stray"]),
    (["--nonsense"], ["--nonsense"]),
    (plane(threads="0"), ["--threads"]),
    (plane(threads="1000000"), ["--threads"]),
    (plane(threads="two"), ["--threads", "two"]),
    (plane(repeat="0"), ["--repeat"]),
    (plane(background="red"), ["--background", "red"]),
    (render("fig8", "--fov", "5"), ["--fov"]),
    (render("fig8", "--camera", "1,2"), ["--camera", "3 numbers"]),
    (render("fig8", "--eye", "1,2,3"), ["--eye", "--target"]),
    (render("fig8", "--frames", "2"), ["--out", "out.png"]),
    (render("fig8", "--out", "%s-%n.png", "--frames", "2"), ["--out", "%s"]),
    (render("fig8", "--out", "o%04d.png", "--frames", "-1"), ["--frames"]),
    # outputs
    (plane(out="no/such/folder/out.png"), ["no/such/folder/out.png", "cannot write"]),
    (plane(out="folder"), ["folder", "cannot write", "directory"]),
    (plane(out="good.png/out.png"), ["good.png/out.png", "cannot write"]),
    (plane(out=""), ["out"]),
    (plane(stats="no/stats.json"), ["no/stats.json", "cannot write"]),
    (plane(out="/dev/full"), ["/dev/full", "cannot write"]),
    # the last output cannot be written: none is
    *[(arguments, [full, "cannot write"]) for arguments, full in (
        (plane(stats="/dev/full"), "/dev/full"), (render("fig6", "--reference", "r.png", "--stats", "/dev/full"), "/dev/full"), (render("fig6", "--stats", "s.json", "--reference", "/dev/full"), "/dev/full"),
        (texture("good.png", "--out", "o.stx", "--c-array", "full.h"), "full.h"), (["trace", "fig6", "--size", "32x24", "--vcd", "t", "--json", "j", "--out", "o.png", "--stats", "/dev/full"], "/dev/full"),
        (["bench-rig", "run", "tilted", "--size", "8x8", "--simulated", "--json", "j", "--timeline", "t", "--record", "r", "--out", "/dev/full"], "/dev/full"))],
    (render("fig6", "--out", "no/f-%04d.png", "--frames", "2"), ["no/f-0000.png", "cannot write"]),
    (["trace", "fig6", "--size", "32x24", "--vcd", "no/t.vcd"], ["no/t.vcd", "cannot write"]),
    (["trace", "fig6", "--size", "32x24"], ["--vcd", "--json"]),
    (["trace", "--vcd", "t.vcd"], ["scene"]),
    (["demo", "--out", "good.png"], ["good.png"]),
    (["demo", "--out", "made", "--texture", "missing.png"], ["missing.png: missing\n"]),  # not the package of another
    # models
    (render("missing.obj"), ["missing.obj", "no such model file or scene", "fig6"]),
    (render("folder"), ["folder", "directory"]),
    (render("plain.obj"), ["plain.obj", "no texture coordinates"]),
    (render("lost.obj"), ["lost.obj", "lost_texture.png", "not found"]),
    (render("broken.obj"), ["truncated.png", "truncated"]),
    (render("points.obj"), ["points.obj"]),
    (render("garbage.obj"), ["garbage.obj"]),
    (render("garbage.xyz"), ["garbage.xyz"]),
    (render("huge.obj"), ["huge.obj", "32768"]),
    (render("good.png"), ["good.png"]),
    (render("half.obj"), ["half.obj", "bare", "has a texture but no texture coordinates"]),
    (render("nolib.obj"), ["nolib.obj", "no such library.mtl", "not found"]),
    (render("point.obj"), ["point.obj", "nothing to draw"]),
    (render("line.obj"), ["line.obj", "nothing to draw"]),
    # levels
    (render("short.bsp"), ["short.bsp", "not a Quake III map"]),
    (render("old.bsp"), ["old.bsp", "version 29, not 46"]),
    (render("cut.bsp"), ["cut.bsp", "damaged", "lump 0"]),
    (render("void.bsp"), ["void.bsp", "nothing to draw"]),
    (render("garbage.pk3"), ["garbage.pk3", "cannot read archive"]),
    (render("none.pk3"), ["none.pk3", "no map"]),
    (render("two.pk3"), ["two.pk3", "--map", "one", "two"]),
    (render("two.pk3", "--map", "three"), ["two.pk3", "three", "one", "two"]),
    (render("two.pk3", "--map", "one"), ["two.pk3", "one", "nothing to draw"]),
    (render("flipped.pk3"), ["flipped.pk3", "maps/one.bsp", "checksum"]),
    (render("void.bsp", "--map", "one"), ["void.bsp", "--map"]),
    (render("textured.obj", "--map", "one"), ["--map", "textured.obj"]),
    (render("textured.obj", "--order", "far"), ["--order", "far"]),
    (render("tilted", "--order", "nearest"), ["--order", "tilted"]),
    (render("textured.obj", "--order", "depths", "--alpha", "cut-out"), ["--order depths", "cut-out"]),
    (render("textured.obj", "--order", "depths", "--space", "object"), ["--order depths", "object space"]),
    (render("textured.obj", "--path", "short.path"), ["short.path", "line 2", "6 numbers"]),
    (render("textured.obj", "--path", "empty.path"), ["empty.path", "0 views"]),
    (render("textured.obj", "--path", "missing.path"), ["missing.path"]),
    (render("textured.obj", "--path", "one.path"), ["--out", "out.png"]),
    (render("textured.obj", "--path", "one.path", "--frames", "2", "--out", "o%d.png"), ["--path"]),
    (render("fig8", "--path", "one.path", "--out", "o%d.png"), ["--path", "fig8"]),
    # without end, or too large
    (plane(texture="/dev/zero"), ["/dev/zero", "512 MiB"]),
    (plane(texture="vast.png"), ["vast.png", "512 MiB"]),
    (render("vast.obj"), ["vast.obj", "512 MiB"]),
    (["compare", "good.png", "/dev/zero"], ["/dev/zero", "512 MiB"]),
    # options that contradict each other
    (plane(stats="out.png"), ["--out", "--stats", "out.png"]),
    (plane(stats="./folder/../out.png"), ["--out", "--stats", "out.png"]),
    (plane(out="link.png", stats="small.png"), ["--out", "--stats", "small.png"]),
    (render("fig8", "--stats", "out.png"), ["--out", "--stats", "out.png"]),
    *[(render("fig8", "--out", "f%d.png", "--frames", "3", other, "f2.png"), ["--out", other, "f2.png"]) for other in ("--stats", "--reference")],
    # outputs that would replace what is read
    *[(arguments, [option, path, "read"]) for arguments, option, path in (
        (plane(out="good.png"), "--out", "good.png"), (plane(stats="./folder/../good.png"), "--stats", "good.png"), (plane(texture="small.png", out="link.png"), "--out", "link.png"),
        (plane(texture="good.stx", out="good.stx"), "--out", "good.stx"), (texture("good.png", "--out", "good.png"), "--out", "good.png"),
        *[(render("textured.obj", *more), more[0], more[1]) for more in (["--out", "textured.obj"], ["--stats", "textured.obj"], ["--out", "good.png"], ["--reference", "good.png"])],
        (render("textured.obj", "--path", "one.path", "--out", "o%d.png", "--stats", "one.path"), "--stats", "one.path"),
        (render("tilted", "--texture", "good.png", "--out", "good.png"), "--out", "good.png"),
        *[(["trace", "tilted", "--texture", "good.png", "--size", "32x24", "--vcd", "t", other, "good.png"], other, "good.png") for other in ("--json", "--out", "--stats")],
        *[(["bench-rig", "run", "tilted", "--texture", "good.png", "--size", "32x24", "--simulated", other, "good.png"], other, "good.png") for other in ("--out", "--json", "--timeline", "--record")],
        *[(["bench-rig", what, "--rig", "one.path", "--json", "one.path"], "--json", "one.path") for what in ("identify", "self-test")],
        (["compare", "small.png", "good.png", "--diff", "good.png"], "--diff", "good.png"),
        (["compare", "--scenes", "tilted", "--texture", "good.png", "--json", "good.png"], "--json", "good.png"),
        (["compare", "--scenes", "textured.obj", "--json", "textured.obj"], "--json", "textured.obj"),
        (["compare", "--scenes", "tilted", "--texture", "folder/tilted-reference.png", "--out", "folder"], "--out", "folder/tilted-reference.png"),
        (["bench", "--scenes", "tilted", "--texture", "good.png", "--json", "good.png", "--peers", "none"], "--json", "good.png"),
        (["sweep", "one.path", "--out", "one.path"], "--out", "one.path"), (["sweep", "one.path", "--merge", "empty.path", "--out", "empty.path"], "--out", "empty.path"))],
    (["demo", "--out", ".", "--texture", "good.png"], ["--texture", "good.png", "--out"]),
    *[(["trace", "fig6", "--size", "32x24", "--vcd", "t", other, "./t"], ["--vcd", other, "./t"])
      for other in ("--json", "--out", "--stats")],
    (["trace", "fig6", "--size", "32x24", "--vcd", "t", "--json", "u", "--stats", "u"], ["--json", "--stats", " u"]),
    *[(render(scene, *more), [more[0], scene]) for scene in ("tilted", "fig6", "fig8")
      for more in (["--camera", "1,2,3"], ["--eye", "1,2,3", "--target", "0,0,0"], ["--fov", "40"])],
    (["trace", "--matrix", FACING, "--size", "32x24", "--vcd", "t", "--camera", "1,2,3"], ["--camera", "--matrix"]),
    (["trace", "fig6", "--matrix", FACING, "--size", "32x24", "--vcd", "t"], ["--matrix"]),
    (render("fig8", "--texture", "good.png"), ["--texture", "fig8"]),
    (render("textured.obj", "--texture", "good.png"), ["--texture", "textured.obj"]),
    (render("textured.obj", "--camera", "1,2,3", "--eye", "1,2,3", "--target", "0,0,0"), ["--camera", "--eye", "--target"]),
    *[(render("fig8", "--out", "o%04d.png", "--frames", n), ["--frames", "1..9999"]) for n in ("0", "10000")],
    (render("tilted", "--out", "o%04d.png", "--frames", "2"), ["--frames", "tilted"]),
    (render("textured.obj", "--out", "o%d.png", "--frames", "2", "--eye", "1,2,3", "--target", "0,0,0"), ["--frames", "textured.obj"]),
    # texture
    (["texture"], ["PICTURE"]),
    (["texture", "good.png"], ["--out", "--c-array"]),
    *[(texture(name), [name, why]) for name, why in (("missing.png", "No such file"), ("truncated.png", "truncated"), ("text.png", "cannot decode"),
                                                    ("wide.png", "4097x1"), ("folder", "directory"), ("/dev/zero", "512 MiB"),
                                                    ("good.stx", "texture pack"))],
    (texture("good.png", "--format", "rgb332"), ["format", "rgb332", *FORMATS]),
    (plane(format="rgb332"), ["format", "rgb332", *FORMATS]),
    (texture("good.png", "--prefilter", "cubic"), ["prefilter", "cubic", "box", "triangle", "kaiser", "lanczos"]),
    *[(texture("good.png", "--wrap", w), ["wrap", "repeat", "clamp", "mirror"]) for w in ("tile", "repeat,", ",clamp", "clamp,clamp,clamp", "")],
    (texture("good.png", "--byte-order", "middle"), ["byte order", "middle", "little", "big"]),
    *[(texture("good.png", "--levels", n), ["--levels", "1..7"]) for n in ("0", "8", "-1")],
    (texture("good.png", "--levels", "two"), ["--levels", "two"]),
    *[(texture("good.png", "--alpha-test", n), ["--alpha-test", "1..255"]) for n in ("0", "256", "-7")],
    *[(texture("good.png", "--alpha-test", "99", "--format", f), ["--alpha-test", f]) for f in ("rgb565", "rgb888", "l8", "etc1", "etc2_rgb8")],
    *[(texture("good.png", "--threads", n), ["--threads", "1..256"]) for n in ("0", "257")],
    (texture("good.png", "--out", "no/o.stx"), ["no/o.stx", "cannot write"]),
    (texture("good.png", "--out", "o.stx", "--c-array", "no/o.h"), ["no/o.h", "cannot write"]),
    *[(texture("good.png", "--out", name), ["--out", name, ".c or .h"]) for name in ("o.hpp", "o.cpp", "o.cc", "o.cxx", "o.hxx", "o.hh", "o.C", "o.H")],
    (texture("good.png", "--c-array", "array.txt"), ["--c-array", "array.txt", ".h"]),
    (texture("good.png", "--out", "o.h", "--c-array", "./o.h"), ["--out", "--c-array", "o.h"]),
    (texture("good.png", "--out", "/dev/full"), ["/dev/full", "cannot write"]),
    (texture("good.png", "stray"), ["stray"]),
    *[(texture("good.png", "--field", n), ["field", "1..64"]) for n in ("0", "65", "-1")],
    (texture("good.png", "--field", "wide"), ["--field", "wide"]),
    *[(texture("good.png", "--field", "16", *more), ["--field", more[0]]) for more in (
        ["--srgb"], ["--prefilter", "box"], ["--inverse"], ["--alpha-weighted"], ["--alpha-test", "9"], ["--levels", "2"], ["--inverse", "--c-array", "o.h"])],
    *[(texture("good.png", "--field", "16", "--format", f), ["--field", f, "alpha"]) for f in ("l8", "rgb565", "rgb888")],
    *[(texture("good.png", "--field", "16", "--reduction", n), ["field", "multiples", n]) for n in ("0", "3", "-2", "128")],
    *[(texture("good.png", "--field", "16", "--outline", n), ["--outline", n, "number" if n == "wide" else "0..15.9375"]) for n in ("16", "-1", "wide")],
    (texture("good.png", "--field", "16", "--ink", "red"), ["--ink", "red"]),
    (texture("good.png", "--field", "16", "--inside", "out"), ["inside", "out", "either", "alpha", "light", "dark"]),
    *[(texture("good.png", name, value), [name, "--field"]) for name, value in (("--reduction", "2"), ("--ink", "000000"), ("--outline", "1"), ("--inside", "dark"))],
    (plane(texture="good.png", space="object") + ["--srgb"], ["--space object", "--srgb"]),
    (plane(texture="srgb.stx", space="object"), ["object space", "sRGB"]),
    (["prefilters", "--level", "5"], ["--level", "1..4"]),
    (["prefilters", "--texture", "missing.png"], ["missing.png"]),
    # the bench
    (["bench-rig"], ["bench-rig", "subcommand", "self-test"]), (["bench-rig", "paint"], ["bench-rig", "paint", "self-test"]), (["bench-rig", "--rig", "r"], ["bench-rig", "--rig", "self-test"]),
    (["bench-rig", "identify"], ["--rig", "--simulated"]),
    (["bench-rig", "identify", "--rig", "good.png", "--simulated"], ["--rig", "--simulated"]),
    (["bench-rig", "identify", "--rig", "missing.json"], ["missing.json", "No such file"]),
    (["bench-rig", "identify", "--rig", "good.png"], ["good.png", "not JSON"]),
    (["bench-rig", "self-test", "--simulated", "--data-bits", "5"], ["--data-bits", "8 or 4"]),
    (["bench-rig", "identify", "--simulated", "--patience", "-5"], ["--patience", "86400"]),
    (["bench-rig", "identify", "--simulated", "--patience", "nan"], ["--patience", "86400"]),
    (["bench-rig", "identify", "--simulated", "--patience", "1e300"], ["--patience", "86400"]),
    (["bench-rig", "run", "tilted", "--simulated", "--size", "8x8", "--profile", "huge"], ["profile", "huge"]),
    (["bench-rig", "run", "tilted", "--simulated", "--size", "8x8", "--space", "object"], ["screen space"]),
    (["bench-rig", "run", "tilted", "--simulated", "--size", "8x8", "--json", "no/j.json"], ["no/j.json", "cannot write"]),
    (["bench-rig", "replay", "good.png"], ["good.png", "not a recording"]),
    # texture packs
    *[(plane(texture=name), [name, why]) for name, (_, why) in PACKS.items()],
    *[(render("tilted", "--texture", name), [name, why]) for name, (_, why) in PACKS.items()],
    *[(plane(texture=name), [name, "truncated"]) for name in ("cut.stx", "stub.stx", "none.stx")],
    (plane(texture="picture.stx"), ["picture.stx", "not a texture pack"]),
    (plane(texture="pack_named.png"), ["pack_named.png", "checksum of its header"]),
    (plane(texture="missing.stx"), ["missing.stx", "No such file"]),
    (plane(texture="good.stx", wrap="clamp"), ["--wrap", "good.stx"]),
    (plane(texture="good.stx", prefilter="box"), ["--prefilter", "good.stx"]),
    (["trace", "tilted", "--texture", "cut.stx", "--size", "32x24", "--vcd", "t"], ["cut.stx", "truncated"]),
    *[([*command, "good.stx"], ["good.stx", "texture pack", "picture"]) for command in (
        ["compare", "good.png"], ["prefilters", "--texture"], ["bench", "--scenes", "tilted", "--peers", "none", "--texture"], ["demo", "--out", "folder", "--texture"])],
    # compare
    (["compare", "good.png", "missing.png"], ["missing.png"]),
    (["compare", "good.png", "small.png"], ["small.png", "32x64", "64x64"]),
    (["compare", "good.png"], ["two pictures", "--scenes"]),
    (["compare", "good.png", "good.png", "--scenes", "tilted"], ["--scenes", "good.png"]),
    (["render", "tilted", "--out", "o.png", "--space", "inner"], ["inner", "object"]),
    (["render", "tilted", "--out", "o.png", "--space", "object", "--engine", "sim"], ["--space object", "direct"]),
    (["render", "tilted", "--out", "o.png", "--space", "object", "--threads", "2"], ["--space object", "thread"]),
    *[(["render", "tilted", "--out", "o.png", "--space", "object", *more], ["--space object", "--alpha"])
      for more in (["--alpha", "blended"], ["--srgb"], ["--filter", "contour"])],
    *[(["render", "tilted", "--out", "o.png", "--space", "object", "--filter", "aniso", *more], ["--space object", "aniso"]) for more in ([], ["--samples", "4"])],
    (["compare", "--scenes", "tilted,nowhere"], ["nowhere", "tilted"]),
    *[(["compare", "--scenes", "tilted", "--" + name, ",".join(twice)], ["--" + name, twice[0], "twice"]) for name, twice in (
        ("filters", ["nearest"] * 2), ("filters", ["aniso:samples=4:slack=2", "aniso:slack=2:samples=4"]), ("profiles", ["seed"] * 2))],
    *[(["compare", "--scenes", names], ["--scenes", one, "twice"]) for names, one in (("tilted,tilted", "tilted"), ("half.obj,folder/half.xyz", "half"))],
    (["compare", "--scenes", "tilted", "--filters", "aniso,best"], ["best", "trilinear"]),
    *[(["compare", "--scenes", "tilted", "--filters", f], words) for f, words in (
        ("trilinear:slack=2", ["--slack", "aniso"]), ("aniso:slack=16", ["--slack", "0..15"]), ("aniso:samples=0", ["--samples", "1..16"]), ("aniso:samples=x", ["x", "number"]),
        ("aniso:speed=9", ["speed", "level, samples, spacing, slack, bias"]), ("aniso:bias=-17", ["--bias", "-16..0"]), ("aniso:bias=-", ["number"]), ("trilinear:level=best", ["best", "jacobian", "major", "minor"]), ("bilinear:level=minor", ["--level", "bilinear"]))],
    (plane(slack="2"), ["--slack", "aniso"]), (plane(spacing="2"), ["--spacing", "aniso"]), (plane(bias="-2"), ["--bias", "aniso"]), (plane(samples="2"), ["--samples", "aniso"]),
    *[(plane(filter="aniso", spacing=n), ["--spacing", "0..16"]) for n in ("-1", "17")],
    *[(plane(filter="aniso", slack=n), ["--slack", "0..15"]) for n in ("-1", "16")],
    *[(plane(filter="aniso", samples=n), ["--samples", "1..16"]) for n in ("0", "17")],
    (plane(level="best"), ["level", "best", "jacobian", "major", "minor"]),
    *[(plane(level="minor", filter=f), ["--level", f]) for f in ("nearest", "bilinear", "three-point", "squares", "aniso", "step", "hat")],
    (plane(level="minor", space="object"), ["--space object", "--level"]),
    (["chessboard"], ["--out"]), (["chessboard", "--out", "o", "--size", "0x1"], ["--size"]), (["chessboard", "--out", "o", "--profile", "best"], ["best", "seed"]),
    (["chessboard", "--out", "good.png/o"], ["good.png/o", "folder"]),
    (render("contour", "--filter", "contour", "--reference", "r.png"), ["--reference:", "contour"]),
    (["compare", "--scenes", "tilted", "--profiles", "huge"], ["huge", "compact"]),
    (["compare", "--scenes", "tilted", "--size", "0x9"], ["--size", "0x9"]),
    (["compare", "--scenes", "tilted", "--texture", "missing.png"], ["missing.png"]),
    (["compare", "--scenes", "fig7", "--texture", "good.png"], ["--texture", "fig7"]),
    (["compare", "--scenes", "tilted", "--repeat", "0"], ["--repeat"]),
    (["compare", "--scenes", "tilted", "--json", "no/t.json"], ["no/t.json", "cannot write"]),
    (["compare", "--scenes", "tilted", "--diff", "d.png"], ["--diff"]),
    (["compare", "--filters", "aniso", "good.png", "good.png"], ["--scenes"]),
    (["compare", "good.png", "good.png", "--diff", "no/d.png"], ["no/d.png", "cannot write"]),
    # stress
    *[(["stress", "--evaluations", n], ["--evaluations", n]) for n in ("0", "-5", "1e9", "10.5", "", "1000000000000001", "99999999999999999999999")],
    *[(["stress", "--evaluations", "1000", "--" + name, n], ["--" + name, n]) for name, n in (
        ("seed", "-1"), ("seed", "0x5"), ("seconds", "-1"), ("seconds", "nan"), ("seconds", "1e12"), ("seconds", "1.1e9"), ("seconds", "soon"), ("threads", "0"), ("threads", "257"))],
    (["stress", "--profile", "best"], ["best", "seed"]),
    (["stress", "--family", "nowhere"], ["nowhere", "horizon"]),
    (["stress", "--case", "5"], ["--case", "--family"]),
    *[(["stress", "--family", "horizon", "--case", n], ["--case", n]) for n in ("-1", "x", " 5", "18446744073709551616")],
    *[(["stress", "--family", "horizon", "--case", "5", *more], ["--case", more[0]]) for more in (
        ("--json", "j.json"), ("--evaluations", "9"), ("--seed", "2"), ("--seconds", "1"), ("--threads", "2"))],
    (["stress", "--evaluations", "1000", "--json", "no/j.json"], ["no/j.json", "cannot write"]),
    # bench
    (["bench", "--scenes", "tilted,nowhere"], ["--scenes", "nowhere", "grazing"]),
    *[(["bench", "--" + name, f"{one},{one}"], ["--" + name, one, "twice"])
      for name, one in (("scenes", "tilted"), ("filters", "nearest"), ("profiles", "seed"), ("kernels", "scalar"), ("peers", "none"))],
    (["bench", "--matrix", "1,0,0,2,0,0,0,0,1"], ["--matrix", "singular"]),
    (["bench", "--model", "nowhere.obj"], ["nowhere.obj", "no such model"]),
    (["bench", "--model", "fig8"], ["--model", "fig8", "its own view"]),
    (["bench", "--model", "good.png"], ["good.png"]),
    (["bench", "--model", "textured.obj", "--frames", "0"], ["--frames", "9999"]),
    (["bench", "--model", "textured.obj", "--fov", "5"], ["--fov", "10..150"]),
    (["bench", "--model", "textured.obj", "--map", "x"], ["--map", "no archive"]),
    (["bench", "--model", "textured.obj", "--scenes", "tilted"], ["--model", "--scenes"]),
    (["bench", "--frames", "3"], ["--frames", "--model"]),
    (["bench", "--model", "textured.obj", "--json", "textured.obj", "--peers", "none"], ["--json", "textured.obj"]),
    (["bench", "--matrix", "1,0,0"], ["--matrix"]),
    (["bench", "--filters", "best"], ["best", "trilinear"]),
    *[([*command, "--filters", "contour"], ["--filters", "contour"]) for command in (["bench"], ["compare", "--scenes", "contour"])],
    (["bench", "--profiles", "great"], ["great", "seed"]),
    (["bench", "--kernels", "mmx"], ["mmx", "scalar"]),
    (["bench", "--kernels", "fastest"], ["--kernels", "fastest"]),
    (["bench", "--peers", "nobody"], ["--peers", "nobody"]),
    (["bench", "--repeat", "0"], ["--repeat"]),
    (["bench", "--samples", "17", "--filters", "aniso"], ["--samples", "1..16"]),
    (["bench", "--samples", "4", "--filters", "trilinear"], ["--samples", "aniso"]),
    (["bench", "--counts", "--samples", "4"], ["--counts", "--samples"]),
    (["bench", "--size", "0x480", "--peers", "none"], ["--size"]),
    (["bench", "--scenes", "tilted", "--texture", "missing.png", "--peers", "none"], ["missing.png"]),
    (["bench", "--scenes", "spider", "--models", "nowhere", "--peers", "none"], ["nowhere", "assimp-testmodels"]),
    (["bench", "--json", "no/t.json"], ["no/t.json", "cannot write"]),
    (["bench", "--draws-only"], ["--counts"]),
    (["bench", "--counts", "--scenes", "far"], ["--counts", "--scenes"]),
    (["bench", "--counts", "--matrix", "1,0,0,0,1,0,0,0,1"], ["--counts", "--matrix"]),
    (["bench", "--counts", "--growth"], ["--counts", "--growth"]), (["bench", "--counts", "--srgb"], ["--counts", "--srgb"]), (["bench", "--growth", "--srgb"], ["--growth", "--srgb"]),
    (["bench", "--counts", "--json", "counts.json"], ["--counts", "--json"]),
]


# With an address space of SMALL_MEMORY_BYTES; not under the address sanitizer, whose shadow memory alone is larger.
SMALL_MEMORY_CASES = [] if os.environ.get("SPANTEX_SANITIZED") else [(plane(texture="large.png"), ["not enough memory"])]


def run_in_small_memory(folder, *arguments):
    limit = (SMALL_MEMORY_BYTES, SMALL_MEMORY_BYTES)
    return subprocess.run([str(BINARY), *arguments], capture_output=True, text=True, cwd=folder, timeout=300,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, limit))


def faults_of(result, words, left):
    lines = result.stderr.splitlines()
    if result.returncode != 2:
        yield f"exit code {result.returncode}, not 2"
    if len(lines) != 1 or not lines[0].strip():
        yield f"{len(lines)} lines on stderr, not one"
    for word in words:
        if word not in result.stderr:
            yield f"message does not hold '{word}'"
    if result.stdout:
        yield "something on stdout"
    if left:
        yield f"left behind: {', '.join(sorted(left))}"


def main():
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        make_inputs(folder)
        before = {str(p) for p in folder.rglob("*")}
        contents = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file() and p.name not in SPARSE}
        small = functools.partial(run_in_small_memory, folder)
        cases = [(functools.partial(run, cwd=folder), *case) for case in CASES] + [(small, *case) for case in SMALL_MEMORY_CASES]
        for start, arguments, words in cases:
            result = start(*arguments)
            left = {str(p) for p in folder.rglob("*")} - before
            for fault in faults_of(result, words, left):
                failed += 1
                print(f"spantex {' '.join(arguments)}: {fault}\n    {result.stderr.strip()}")
        changed = [p.name for p, data in contents.items() if p.read_bytes() != data]
        if changed:
            failed += 1
            print(f"inputs changed: {changed}")
    print(f"{len(cases)} bad inputs, {failed} faults")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

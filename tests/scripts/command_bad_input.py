#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bad input of every kind ends in exit code 2, one line on stderr that names the file or option and the reason, and no file left."""
import pathlib
import struct
import sys
import tempfile

sys.dont_write_bytecode = True
from spantex_command import FACING, QUAD_WITH_UV, QUAD_WITHOUT_UV, png_bytes, run  # noqa: E402

FILTERS = ["nearest", "bilinear", "three-point", "mip-bilinear", "trilinear", "trilinear3"]


def bmp_header(width, height):
    return b"BM" + struct.pack("<IHHIIiiHHIIiiII", 54 + width * height * 3, 0, 0, 54, 40, width, height, 1, 24, 0, 0, 0, 0, 0, 0)


def make_inputs(folder):
    good = png_bytes(64, 64)
    files = {
        "good.png": good, "small.png": png_bytes(32, 64), "empty.png": b"", "text.png": b"this is not a picture\n" * 20,
        "truncated.png": good[:len(good) // 2], "header.png": good[:40], "wide.png": png_bytes(4097, 1), "tall.png": png_bytes(1, 4097),
        "truncated.bmp": bmp_header(64, 64) + b"\x55" * 900,
        "noise.png": good[:60] + bytes((b * 7 + 3) % 256 for b in good[60:-30]) + good[-30:],
        "plain.obj": QUAD_WITHOUT_UV.encode(), "garbage.obj": b"\x00\x01\x02 nonsense", "garbage.xyz": b"nonsense",
        "points.obj": b"v 0 0 0\nv 1 0 0\nvt 0 0\n",
        "lost.obj": QUAD_WITH_UV.replace("m.mtl", "lost.mtl").encode(), "lost.mtl": b"newmtl m\nKd 1 1 1\nmap_Kd lost_texture.png\n",
        "broken.obj": QUAD_WITH_UV.replace("m.mtl", "broken.mtl").encode(), "broken.mtl": b"newmtl m\nKd 1 1 1\nmap_Kd truncated.png\n",
        "huge.obj": QUAD_WITH_UV.replace("vt 1 1", "vt 1e6 1").replace("m.mtl", "huge.mtl").encode(),
        "huge.mtl": b"newmtl m\nmap_Kd good.png\n",
    }
    for name, data in files.items():
        (folder / name).write_bytes(data)
    (folder / "folder").mkdir()


def plane(**changed):
    options = {"texture": "good.png", "size": "32x24", "matrix": FACING, "out": "out.png"}
    options.update(changed)
    return ["plane"] + [part for name, value in options.items() if value is not None for part in ("--" + name, value)]


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
    # sizes
    *[(plane(size=s), ["--size", s]) for s in ("0x24", "32x0", "4097x24", "32x4097", "32", "32x", "x24", "-1x24", "1e3x24", "32x24x8",
                                               "99999999999x1", " 32x24")],
    (["render", "fig6", "--size", "0x0", "--out", "out.png"], ["--size", "0x0"]),
    # names
    (plane(filter="cubic"), ["filter", "cubic", *FILTERS]),
    (plane(profile="best"), ["profile", "best", "seed", "compact", "default", "exact"]),
    (plane(wrap="tile"), ["wrap", "tile", "repeat", "clamp", "mirror"]),
    (plane(engine="gpu"), ["engine", "gpu", "direct", "sim"]),
    (plane(prefilter="none"), ["prefilter", "none", "box", "triangle"]),
    (render("fig10"), ["fig10", "fig6", "fig9", "grazing"]),
    (["paint"], ["paint", "plane", "render", "compare", "trace", "stress", "demo"]),
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
    (render("fig6", "--out", "no/f-%04d.png", "--frames", "2"), ["no/f-0000.png", "cannot write"]),
    (["trace", "fig6", "--size", "32x24", "--vcd", "no/t.vcd"], ["no/t.vcd", "cannot write"]),
    (["trace", "fig6", "--size", "32x24"], ["--vcd", "--json"]),
    (["trace", "--vcd", "t.vcd"], ["scene"]),
    (["demo", "--out", "good.png"], ["good.png"]),
    (["demo", "--out", "made", "--texture", "missing.png"], ["missing.png"]),
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
    # compare
    (["compare", "good.png", "missing.png"], ["missing.png"]),
    (["compare", "good.png", "small.png"], ["small.png", "32x64", "64x64"]),
    (["compare", "good.png"], ["B"]),
    (["compare", "good.png", "good.png", "--diff", "no/d.png"], ["no/d.png", "cannot write"]),
]


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
        contents = {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        for arguments, words in CASES:
            result = run(*arguments, cwd=folder)
            left = {str(p) for p in folder.rglob("*")} - before
            for fault in faults_of(result, words, left):
                failed += 1
                print(f"spantex {' '.join(arguments)}: {fault}\n    {result.stderr.strip()}")
        changed = [p.name for p, data in contents.items() if p.read_bytes() != data]
        if changed:
            failed += 1
            print(f"inputs changed: {changed}")
    print(f"{len(CASES)} bad inputs, {failed} faults")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

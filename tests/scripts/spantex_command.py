# SPDX-License-Identifier: Apache-2.0
"""What the tests of the command share: running it, and pictures and models made here. Not a test itself."""
import os
import pathlib
import struct
import subprocess
import tempfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"

# By number, texel.hpp.
FORMATS = "rgba8888 rgb565 argb1555 argb4444 rgb888 l8 la88 a8 palette8 palette4 bc1 bc2 bc3 etc1 etc2_rgb8 etc2_rgba8 etc2_rgb8a1".split()
FACING = "0.912053716,-0.314742496,-140.780791,-0.331960405,-0.8647479,521.306321,0,0.000288959809,0.896575472"

FILTERS = ["nearest", "bilinear", "three-point", "mip-bilinear", "trilinear", "trilinear3", "squares", "aniso", "step", "hat"]
PROFILES = ["seed", "compact", "default", "exact"]
WRAPS = ["repeat", "clamp", "mirror"]
PREFILTERS = ["box", "triangle", "kaiser", "lanczos"]
IDENTITY = "1,0,0,0,1,0,0,0,1"
TILTED = "0.621854806,-0.142806403,-12.2821072,-0.226336639,-0.392357368,585.413164,0,0.000855254125,0.43752662"
HORIZON = "0.21,-0.05,-31.7,-0.08,0.13,103.9,0.0002,0.0041,-0.171"


def run(*arguments, cwd=None):
    return subprocess.run([str(BINARY), *map(str, arguments)], capture_output=True, text=True, errors="replace", cwd=cwd, timeout=300)


def done(*arguments, cwd):
    result = run(*arguments, cwd=cwd)
    assert result.returncode == 0, f"spantex {' '.join(map(str, arguments))}: exit {result.returncode}: {result.stderr}"
    assert result.stderr == "", f"spantex {' '.join(map(str, arguments))}: stderr in a pipe: {result.stderr!r}"
    return result.stdout


def plane(folder, out, texture="map.png", size="64x48", matrix=FACING, **more):
    extra = [part for name, value in more.items() for part in ("--" + name, value)]
    done("plane", "--texture", texture, "--size", size, "--matrix", matrix, "--out", out, *extra, cwd=folder)
    return (folder / out).read_bytes()


def png_bytes(width, height, colour_type=6, pixel=None):
    """A PNG; pixel(x, y) gives its samples. Colour types: 0 gray, 2 RGB, 4 gray with alpha, 6 RGBA."""
    samples = {0: 1, 2: 3, 4: 2, 6: 4}[colour_type]
    pixel = pixel or (lambda x, y: [(37 * x + 91 * y + 50 * k + x * y) % 256 for k in range(samples)])
    rows = b"".join(b"\0" + bytes(v for x in range(width) for v in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, colour_type, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def read_png(path):
    """Width, height and rows of RGBA bytes of a PNG that the command wrote (8-bit RGBA)."""
    data = pathlib.Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "not a PNG"
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body), "bad CRC"
        if kind == b"IHDR":
            size = struct.unpack(">IIBB", body[:10])
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    width, height, depth, colour = size
    assert (depth, colour) == (8, 6), "not 8-bit RGBA"
    return width, height, unfiltered(zlib.decompress(packed), height, width * 4)


def unfiltered(raw, height, stride):
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for k in range(stride):
            left, up, corner = line[k - 4] if k >= 4 else 0, above[k], above[k - 4] if k >= 4 else 0
            if kind == 1:
                line[k] = (line[k] + left) & 255
            elif kind == 2:
                line[k] = (line[k] + up) & 255
            elif kind == 3:
                line[k] = (line[k] + (left + up) // 2) & 255
            elif kind == 4:
                p = left + up - corner
                nearest = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
                line[k] = (line[k] + nearest) & 255
        rows.append(bytes(line))
        above = line
    return rows


QUAD_WITH_UV = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n"
QUAD_WITHOUT_UV = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"


def run_tests(names):
    """Every test_ of a module's names, each in a folder of its own that holds map.png; the exit code."""
    failed = 0
    for name, test in sorted(names.items()):
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

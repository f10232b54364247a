# SPDX-License-Identifier: Apache-2.0
"""What the tests of the command share: running it, and pictures and models made here. Not a test itself."""
import os
import pathlib
import struct
import subprocess
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SPANTEX_BUILD", ROOT / "build")) / "spantex"

# By number, texel.hpp.
FORMATS = "rgba8888 rgb565 argb1555 argb4444 rgb888 l8 la88 a8 palette8 palette4 bc1 bc2 bc3 etc1 etc2_rgb8 etc2_rgba8 etc2_rgb8a1".split()
FACING = "0.912053716,-0.314742496,-140.780791,-0.331960405,-0.8647479,521.306321,0,0.000288959809,0.896575472"


def run(*arguments, cwd=None):
    return subprocess.run([str(BINARY), *map(str, arguments)], capture_output=True, text=True, errors="replace", cwd=cwd, timeout=300)


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

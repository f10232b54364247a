#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A texture pack is the same from a file, a C array (C99, static or external) and .incbin, on the host and on big-endian s390x, which refuses
16-bit texels of the other order; its checksums are zlib's."""
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

sys.dont_write_bytecode = True
from spantex_command import ROOT, png_bytes, run  # noqa: E402

SIXTEEN_BIT = {"rgb565", "argb1555", "argb4444"}
C_FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
CPP_FLAGS = ["-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror", f"-I{ROOT}/firmware"]

# Prints the status, or size, levels and a hash over every texel.
READER = r"""
#include <stdio.h>
#include <spantex/pack.hpp>
%s
int main() {
  spantex::texture_pack p;
  const spantex::status s = spantex::texture_pack::open(DATA, SIZE, p);
  if (s != spantex::status::ok) return puts(spantex::to_string(s)), 0;
  const spantex::texture_view& t = p.view();
  uint32_t h = 0;
  for (int level = 0; level < t.level_count(); ++level)
    for (int32_t y = 0; y < t.height(level); ++y)
      for (int32_t x = 0; x < t.width(level); ++x) {
        const spantex::rgba8 c = t.texel(level, x, y);
        const uint8_t bytes[] = {c.r, c.g, c.b, c.a};
        h = spantex::crc32(bytes, 4, h);
      }
  printf("%%dx%%d %%d %%08x\n", int(t.width()), int(t.height()), t.level_count(), unsigned(h));
}
"""
FROM_HEADER = '#include "m.h"\n#define DATA m\n#define SIZE m_bytes'
FROM_OBJECT = 'extern "C" { extern const uint8_t* const m; extern const uint32_t m_bytes; }\n#define DATA m\n#define SIZE m_bytes'
FROM_INCBIN = ('asm(".section .rodata\\n.balign 8\\nbegin_of_m: .incbin \\"m.stx\\"\\nend_of_m:\\n.previous\\n");\n'
               'extern "C" const uint8_t begin_of_m[], end_of_m[];\n#define DATA begin_of_m\n#define SIZE size_t(end_of_m - begin_of_m)')


def read_by(folder, source, extra=(), compiler="g++", runner=()):
    (folder / "reader.cpp").write_text(READER % source)
    static = ["-static"] if runner else []
    subprocess.run([compiler, *CPP_FLAGS, *static, "-I.", "reader.cpp", *extra, "-o", "reader"], cwd=folder, check=True)
    return subprocess.run([*runner, "./reader"], cwd=folder, check=True, capture_output=True, text=True).stdout.strip()


def compiled(folder, *options):
    result = run("texture", "m.png", "--out", "m.stx", "--c-array", "m.h", *options, cwd=folder)
    assert result.returncode == 0 and result.stderr == "", result.stderr
    result = run("texture", "m.png", "--out", "m.c", *options, cwd=folder)
    assert result.returncode == 0, result.stderr


def check_file(data):
    header, total = struct.unpack("<HI", data[6:12])
    assert data[:4] == b"STX\x1a" and total == len(data) and header == 48 + 8 * data[13]
    payload, crc = struct.unpack("<II", data[40:48])
    assert payload == zlib.crc32(data[header:]) and crc == zlib.crc32(data[:44] + data[48:header])
    levels = [struct.unpack("<II", data[48 + 8 * k:56 + 8 * k]) for k in range(data[13])]
    assert all(offset % 8 == 0 and offset + size <= total for offset, size in levels) and total % 8 == 0


def check_everywhere(folder, options, s390x):
    compiled(folder, *options)
    check_file((folder / "m.stx").read_bytes())
    subprocess.run(["gcc", *C_FLAGS, "-c", "m.c", "-o", "m.o"], cwd=folder, check=True)
    (folder / "use.c").write_text('#include "m.h"\nuint32_t size(void) { return m_bytes + m[0]; }\n')
    subprocess.run(["gcc", *C_FLAGS, "-c", "use.c", "-o", "use.o"], cwd=folder, check=True)
    found = {read_by(folder, FROM_HEADER), read_by(folder, FROM_OBJECT, ["m.o"]), read_by(folder, FROM_INCBIN)}
    assert len(found) == 1, found
    if s390x:
        other = read_by(folder, FROM_HEADER, (), "s390x-linux-gnu-g++", ["qemu-s390x"])
        if SIXTEEN_BIT & set(options):
            assert other == "texture pack has 16-bit texels of the other byte order", other
            compiled(folder, *options, "--byte-order", "big")
            assert read_by(folder, FROM_INCBIN) == "texture pack has 16-bit texels of the other byte order"
            other = read_by(folder, FROM_HEADER, (), "s390x-linux-gnu-g++", ["qemu-s390x"])
        found.add(other)
    assert len(found) == 1, found
    return found.pop()


def main():
    s390x = shutil.which("s390x-linux-gnu-g++") is not None and shutil.which("qemu-s390x") is not None
    if not s390x:
        print("s390x: not installed (tools/setup emulate)")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "m.png").write_bytes(png_bytes(37, 20))
        for texel_format in ("rgba8888", *sorted(SIXTEEN_BIT), "rgb888", "la88", "palette8", "palette4", "bc1", "bc3", "etc2_rgba8"):
            text = check_everywhere(folder, ["--format", texel_format, "--prefilter", "kaiser", "--wrap", "mirror,clamp"], s390x)
            print(texel_format, text)
            assert text.startswith("37x20 6 ")
    return 0 if s390x else 1


if __name__ == "__main__":
    sys.exit(main())

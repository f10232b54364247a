#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The device library stands on nothing: firmware/spantex includes only <stdint.h>, <stddef.h>, <limits.h> and its own headers, the HAL in
draw.hpp alone; nowhere in firmware/ does a floating-point type, an allocation or an exception appear, nor numbers of 128 bits but where the compiler has them and something
else stands beside. Comments and strings do not count."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BARE = {"stdint.h", "stddef.h", "limits.h"}
TOKENS = ("float", "double", "new", "delete", "malloc", "calloc", "realloc", "free", "alloca", "throw", "catch", "try", "typeid",
          "dynamic_cast", "virtual", "std", "__int128")
SPELL = re.compile(r"\b(" + "|".join(TOKENS) + r")\b")
DELETED = re.compile(r"=\s*delete\b")
WHERE_IT_IS = re.compile(r"^#ifdef __SIZEOF_INT128__$.*?^#else$", re.S | re.M)


def without_comments_and_strings(text):
    pattern = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\''
    return re.sub(pattern, lambda m: "\n" * m[0].count("\n"), text, flags=re.S)


def bad_include(path, line):
    match = re.match(r'\s*#\s*include\s*(<([^>]*)>|"([^"]*)")', line)
    if not match:
        return None
    name = match[2] or match[3]
    inside = path.parts[:2] == ("firmware", "spantex")
    allowed = name in BARE or (match[2] and name.startswith("spantex/"))
    if inside:
        allowed = allowed or (path.name == "draw.hpp" and name == "hal/engine.hpp")
        allowed = allowed or (path.name == "kernels_mve.hpp" and name == "arm_mve.h")  # vectors have no other spelling; MVE cores only
    else:
        allowed = allowed or name.startswith(("hal/", "firmware/")) or (match[3] and "/" not in name)
        allowed = allowed or (path.name == "console.hpp" and name == "stdio.h")  # the host's side of it
    return None if allowed else f"includes {name}"


def complaints(path, text):
    for number, line in enumerate(text.splitlines(), 1):
        if reason := bad_include(path, line):
            yield f"{path}:{number}: {reason}"
    for number, line in enumerate(WHERE_IT_IS.sub(lambda m: m[0].replace("__int128", "wide"), without_comments_and_strings(text)).splitlines(), 1):
        if line.lstrip().startswith("#"):
            continue
        for match in SPELL.finditer(DELETED.sub("", line)):
            yield f"{path}:{number}: {match[1]}"


def check_the_check():
    inside, outside = pathlib.Path("firmware/spantex/x.hpp"), pathlib.Path("firmware/apps/x.cpp")
    bad = ["#include <vector>", "#include <hal/engine.hpp>", '#include "bits.hpp"', "float x;", "int* p = new int;",
           "void f() { throw 1; }", "double y = 0; // not this comment", "__int128 z;", "#ifdef __SIZEOF_INT128__\nx();\n#endif\n__int128 z;",
           "#ifdef __SIZEOF_INT128__\n#else\n__int128 z;\n#endif"]
    good = ["// float in a comment, new too", "#include <stdint.h>", "#include <spantex/bits.hpp>", 'const char* t = "double";',
            "x(const x&) = delete;", "int renewed, floating;", "#ifdef __SIZEOF_INT128__\n__int128 z;\n#else\nint z;\n#endif"]
    missed = [t for t in bad if not list(complaints(inside, t))] + [t for t in good if list(complaints(inside, t))]
    if list(complaints(outside, "#include <hal/direct_engine.hpp>")) or missed:
        sys.exit(f"this check is broken: {missed}")


def main():
    check_the_check()
    files = [p for p in sorted((ROOT / "firmware").rglob("*")) if p.suffix in (".hpp", ".cpp", ".h", ".c") and p.is_file()]
    found = [c for p in files for c in complaints(p.relative_to(ROOT), p.read_text())]
    print("\n".join(found) if found else f"{len(files)} files")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())

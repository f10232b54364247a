#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every file of source says its licence in its first three lines: SPDX-License-Identifier: Apache-2.0. Documents, data, and formats without comments do not."""
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LINE = "SPDX-License-Identifier: Apache-2.0"
SOURCE = {".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".ino", ".ld", ".cmake", ".in", ".yml", ".1", ".ignore"}
NAMES = {"Makefile", "CMakeLists.txt", "Kconfig", "boards.txt", "platform.txt"}
SKIPPED = {".git", "build", "__pycache__", "corpus"}  # corpus: inputs of the fuzzers


def sources(root):
    for folder, below, names in os.walk(root):
        below[:] = sorted(n for n in below if n not in SKIPPED and not n.startswith("build-"))
        for name in sorted(names):
            path = pathlib.Path(folder, name)
            with_suffix = path.suffix in SOURCE or name in NAMES
            if with_suffix or (not path.suffix and os.access(path, os.X_OK) and path.is_file()):
                yield path


def without_licence(root):
    found = list(sources(root))
    return found, [p for p in found if not any(LINE in line for line in p.read_text(errors="replace").splitlines()[:3])]


def main():
    found, bad = without_licence(ROOT)
    for path in bad:
        print(f"licence_headers: {path.relative_to(ROOT)}: no '{LINE}' in its first three lines")
    print(f"{len(found)} files")
    return 1 if bad or len(found) < 100 else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that all files give the version of CMakeLists.txt."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PLACES = {
    "CMakeLists.txt": r"project\(dd3imp VERSION (\S+)",
    "CHANGELOG.md": r"(?m)^## (\S+)",
    "CITATION.cff": r"(?m)^version: (\S+)",
    "utils/dd3/__init__.py": r'__version__ = "(.+)"',
    "utils/packaging/README.md": r"dd3imp@(\S+)",
    "utils/packaging/conda/meta.yaml": r'version: "(.+)"',
    "utils/packaging/spack/spack_repo/dd3imp/packages/dd3imp/package.py": r'version\("(.+)"\)',
}


def main():
    """Compare the first version that each file gives, and the dates of the release."""
    texts = {name: (ROOT / name).read_text(encoding="utf-8") for name in PLACES}
    found = {name: re.search(pattern, texts[name]).group(1) for name, pattern in PLACES.items()}
    if len(set(found.values())) > 1:
        sys.exit(f"versions differ: {found}")
    date = re.search(r"(?m)^date-released: (\S+)", texts["CITATION.cff"]).group(1)
    if f"({date})" not in re.search(r"(?m)^## .*", texts["CHANGELOG.md"]).group(0):
        sys.exit(f"CHANGELOG.md: expected the date of CITATION.cff, {date}")
    print(f"version {found['CMakeLists.txt']}")


if __name__ == "__main__":
    main()

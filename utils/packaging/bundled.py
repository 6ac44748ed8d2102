#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Add the licences of the libraries that auditwheel has put into a wheel: bundled.py WHEEL FOLDER.

The new wheel is written into the folder, with `licenses/bundled/libraries.txt`, a line for each library, and the
copyright file of each Debian package beside it. A library whose licence is not listed here is an error.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# Library: package of Debian 12, and the licence of the library, compatible with version 3 of the GPL.
RUNTIME = "GPL-3.0-or-later WITH GCC-exception-3.1"
LICENCES = {
    "libgfortran": ("libgfortran5", RUNTIME),
    "libgomp": ("libgomp1", RUNTIME),
    "libquadmath": ("libquadmath0", "LGPL-2.1-or-later"),
    "libopenblasp-r0": ("libopenblas0-pthread", "BSD-3-Clause"),
    "libblas": ("libopenblas0-pthread", "BSD-3-Clause"),
    "liblapack": ("libopenblas0-pthread", "BSD-3-Clause"),
    "libumfpack": ("libumfpack5", "GPL-2.0-or-later"),
    "libcholmod": ("libcholmod3", "LGPL-2.1-or-later AND GPL-2.0-or-later"),
    "libamd": ("libamd2", "BSD-3-Clause"),
    "libcamd": ("libcamd2", "BSD-3-Clause"),
    "libcolamd": ("libcolamd2", "BSD-3-Clause"),
    "libccolamd": ("libccolamd2", "BSD-3-Clause"),
    "libsuitesparseconfig": ("libsuitesparseconfig5", "no conditions"),
    "libmetis": ("libmetis5", "Apache-2.0"),
    "libsz": ("libsz2", "BSD-2-Clause"),
    "libaec": ("libaec0", "BSD-2-Clause"),
}
STATIC = {"libhdf5": ("libhdf5-103-1", "BSD-3-Clause")}  # within the program


def call(*words: str) -> str:
    """Run a command; return what it prints."""
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout.strip()


def stem(name: str) -> str:
    """Return the name of a library, libmetis of libmetis-6ee5b8f5.so.5.1.0."""
    return re.sub(r"(-[0-9a-f]{8})?\..*", "", name)


def add_licences(root: Path) -> None:
    """Write list and copyright files into an unpacked wheel."""
    names = {stem(path.name) for path in root.glob("*.libs/*.so*")}
    unknown = names - set(LICENCES)
    if unknown:
        sys.exit(f"{', '.join(sorted(unknown))}: the licence is not listed in {Path(__file__).name}")
    (info,) = root.glob("*.dist-info")
    folder = info / "licenses" / "bundled"
    folder.mkdir(parents=True)
    lines, files = ["library, package of Debian with its version, licence", ""], {"libraries.txt"}
    for name, (package, licence) in sorted({**{name: LICENCES[name] for name in names}, **STATIC}.items()):
        version = call("dpkg-query", "-W", "-f", "${Version}", package)
        lines.append(f"{name}, {package} {version}, {licence}")
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / f"{package}.txt")
        files.add(f"{package}.txt")
    (folder / "libraries.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    metadata = info / "METADATA"
    head, end, body = metadata.read_text(encoding="utf-8").partition("\n\n")
    head += "".join(f"\nLicense-File: bundled/{name}" for name in sorted(files))
    metadata.write_text(head + end + body, encoding="utf-8")


def main(wheel: str, target: str) -> None:
    """Unpack, add, pack."""
    with tempfile.TemporaryDirectory() as work:
        call(sys.executable, "-m", "wheel", "unpack", "--dest", work, wheel)
        (root,) = Path(work).iterdir()
        add_licences(root)
        Path(target).mkdir(exist_ok=True)
        call(sys.executable, "-m", "wheel", "pack", "--dest-dir", target, str(root))


if __name__ == "__main__":
    main(*sys.argv[1:])

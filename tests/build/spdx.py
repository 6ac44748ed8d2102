#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that each source names its licence by an SPDX line in its first two lines; --write adds the missing ones."""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LINE = "SPDX-License-Identifier: GPL-3.0-or-later"
#: What begins and ends a comment, by the end of a file's name.
COMMENTS = {".f90": ("! ", ""), ".pf": ("! ", ""), ".f90.in": ("! ", ""), ".c": ("/* ", " */"), ".h": ("/* ", " */"),
            ".py": ("# ", ""), ".sh": ("# ", ""), ".cmake": ("# ", ""), ".cmake.in": ("# ", ""),
            "CMakeLists.txt": ("# ", ""), "Dockerfile": ("# ", ""), ".ci/run": ("# ", "")}
#: Files without the line: tests refer to their lines by number.
WITHOUT = ("tests/standin/refused/", "tests/standin/failing/")


def sources():
    """Return the sources with what begins and ends their comments: files under version control, or of an archive."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    names = listed.stdout.split("\0")[:-1]
    if listed.returncode or not names:
        folders = ("src", "cmake", "tests", "utils")
        names = [str(path.relative_to(ROOT)) for folder in folders for path in (ROOT / folder).rglob("*")]
    found = []
    for name in sorted(names):
        comment = next((comment for end, comment in COMMENTS.items() if name.endswith(end)), None)
        if comment and not name.startswith(WITHOUT) and (ROOT / name).is_file() and (ROOT / name).stat().st_size:
            found.append((ROOT / name, comment))
    return found


def main():
    """Check or write."""
    missing = []
    for path, (begin, end) in sources():
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        place = 1 if lines[0].startswith("#!") else 0
        line = begin + LINE + end + "\n"
        if lines[place:place + 1] == [line]:
            continue
        missing.append(path)
        if "--write" in sys.argv:
            path.write_text("".join([*lines[:place], line, *lines[place:]]), encoding="utf-8")
    if missing and "--write" not in sys.argv:
        sys.exit("\n".join(f"{path}: expected the line {LINE} first, or after #!" for path in missing))
    print(f"{len(missing)} lines added" if missing else "all sources name their licence")


if __name__ == "__main__":
    main()

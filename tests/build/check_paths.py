# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that the files named in README and CONTRIBUTING exist, scripts can be run, all folders of src are named."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PATH = re.compile(r"(?<![\w./-])\.?/?((?:utils|docs|tests|src|input_files|cmake|\.ci)/[\w./-]*\w)")


def main():
    """Print the errors; exit code 1 if there are any."""
    wrong = []
    for name in ("README.md", "CONTRIBUTING.md"):
        document = ROOT / name
        if not document.exists():
            wrong.append(f"{name} does not exist")
            continue
        for path in sorted(set(PATH.findall(document.read_text(encoding="utf-8")))):
            if ".out" in path:
                continue
            target = ROOT / path
            if not target.exists():
                wrong.append(f"{name}: {path} does not exist")
            elif target.suffix == ".sh" and not target.stat().st_mode & 0o100:
                wrong.append(f"{name}: {path} is not executable")
    tree = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").split("## The tree")[1]
    folders = sorted(path.name for path in (ROOT / "src").iterdir() if path.is_dir())
    wrong += [f"CONTRIBUTING.md: the tree lacks src/{folder}" for folder in folders if f"`src/{folder}`" not in tree]
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the sources by ruff, mypy, fortitude and codespell, which `utils/install_needed.sh --browser` installs.

    lint.py            all of them
    lint.py mypy       some

Exit code 77, which ctest counts as skipped, where one of them is not installed.
"""
import argparse
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHECKS = (("ruff", "check", "--quiet", "utils"), ("mypy", "--no-error-summary"), ("fortitude", "check", "--quiet"),
          ("codespell", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "cmake", "docs", "input_files", "src", "utils"))
SKIPPED = 77


def main():
    """Run checks."""
    names = [name for name, *_ in CHECKS]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checks", nargs="*", help=f"of {', '.join(names)}; all by default")
    checks = parser.parse_args().checks or names
    if not set(checks) <= set(names):
        parser.error(f"expected some of {', '.join(names)}, got {' '.join(checks)}")
    chosen = [check for check in CHECKS if check[0] in checks]
    folder = Path(sys.executable).parent
    absent = [name for name, *_ in chosen if not (folder / name).is_file()]
    if absent:
        print(f"not installed beside {sys.executable}: {' '.join(absent)}; utils/install_needed.sh --browser")
        sys.exit(SKIPPED)
    failed = [name for name, *words in chosen
              if subprocess.run([folder / name, *words], cwd=ROOT, check=False).returncode]
    if failed:
        sys.exit(f"failed: {' '.join(failed)}")


if __name__ == "__main__":
    main()

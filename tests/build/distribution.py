#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the metadata of the wheel and the contents of the source distribution; nothing is compiled."""
import email
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXTRAS = {"cad": {"ezdxf", "gmsh"}, "plot": {"pyvista", "vtk"}, "study": {"snakemake"}}
CORE = {"h5py", "matplotlib", "numpy", "pandas", "scipy", "tqdm"}
LEFT_OUT = (".ci/", "build/", "dist/", ".venv", "test_history")


def name_of(requirement):
    """Return the name of a package that is required."""
    return "".join(c if c.isalnum() or c in "-_" else " " for c in requirement).split()[0]


def check_metadata(folder):
    """Check name, version, extras, commands, licence and description."""
    from dd3 import __version__, errors
    from scikit_build_core.build import prepare_metadata_for_build_wheel
    info = pathlib.Path(folder, prepare_metadata_for_build_wheel(str(folder)))
    data = email.message_from_string((info / "METADATA").read_text(encoding="utf-8"))
    assert (data["Name"], data["Version"]) == ("dd3imp", __version__), (data["Name"], data["Version"])
    needed = [text.partition(";") for text in data.get_all("Requires-Dist")]
    assert {name_of(name) for name, _, when in needed if "extra" not in when} == CORE, needed
    for extra, names in EXTRAS.items():
        found = {name_of(name) for name, _, when in needed if f"'{extra}'" in when.replace('"', "'")}
        assert found == names, (extra, found)
    assert {name: extra for extra, names in EXTRAS.items() for name in names} == errors.EXTRAS, errors.EXTRAS
    assert any("dd3imp[cad,plot]" in name and "all" in when for name, _, when in needed), needed
    commands = (info / "entry_points.txt").read_text(encoding="utf-8")
    assert "dd3 = dd3.command:main" in commands and "dd3imp = dd3.places:execute" in commands, commands
    assert data["License-Expression"] == "GPL-3.0-or-later" and data["License-File"] == "LICENSE", data.items()
    assert (info / "licenses" / "LICENSE").is_file()
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert data["Description-Content-Type"].startswith("text/markdown") and readme in data.get_payload(), "description"


def check_source(folder):
    """Check that the source distribution has all that the build reads, and no results."""
    from scikit_build_core.build import build_sdist
    with tarfile.open(pathlib.Path(folder, build_sdist(str(folder)))) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    listed = subprocess.run(["git", "ls-files", "src", "cmake", "utils", "input_files", "docs", "tests", "*.md", "LICENSE"],
                            capture_output=True, text=True, check=False).stdout.splitlines()
    listed = [name for name in listed if pathlib.Path(name).is_file()] or ["src/app/dd3imp.f90", "utils/dd3/run.py"]
    lost = {*listed, "pyproject.toml", "CMakeLists.txt", "LICENSE", "README.md"} - names
    assert not lost, f"not in the source distribution: {sorted(lost)[:10]}"
    more = [name for name in names if name.startswith(LEFT_OUT) or ".out/" in name or "__pycache__" in name]
    assert not more, f"in the source distribution: {more[:10]}"


def main():
    """Check both."""
    os.chdir(ROOT)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert "version" in project["dynamic"], "the version is that of utils/dd3/__init__.py"
    try:
        import scikit_build_core  # noqa: F401
    except ModuleNotFoundError:
        sys.exit("scikit-build-core is missing: utils/install_needed.sh installs it into .venv")
    with tempfile.TemporaryDirectory() as folder:
        check_metadata(folder)
        check_source(folder)
    print("metadata and source distribution are complete")


if __name__ == "__main__":
    main()

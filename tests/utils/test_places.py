# SPDX-License-Identifier: GPL-3.0-or-later
"""What belongs to the package where it is installed, and what it does without optional packages."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import dd3
from dd3 import errors, example, info, places, rendering
from dd3.errors import Problem

HISTORY = "# units:,mm,N\nphase,travel,punch_fz\ndraw,1.0,-5.0\ndraw,2.0,-7.5\n"
OPTIONAL = ("h5py", "matplotlib", "scipy", "tqdm", "pyvista", "vtk", "vtkmodules", "gmsh", "ezdxf", "snakemake")
OF_POSIX = ("fcntl", "resource")


def run_hidden(hidden, code, *words):
    """Run Python code in a process in which the modules `hidden` cannot be imported."""
    hide = f"import sys; sys.modules.update(dict.fromkeys({hidden!r}))\n"
    return subprocess.run([sys.executable, "-c", hide + code, *words], capture_output=True, text=True, check=False)


def test_history_needs_numpy_and_pandas_alone(tmp_path):
    (tmp_path / "history.csv").write_text(HISTORY, encoding="utf-8")
    (tmp_path / "run.json").write_text('{"format": "dd3imp run", "format_version": 2, "outcome": {"state": "running"}}',
                                       encoding="utf-8")
    (tmp_path / "job.log").write_text("", encoding="utf-8")
    done = run_hidden(OPTIONAL + OF_POSIX, "import dd3; run = dd3.open(sys.argv[1]); "
                      "print(run.history['punch_fz'].sum(), run.job['outcome']['state'])", str(tmp_path))
    # Without locks it is not known whether a program is still writing.
    assert (done.returncode, done.stdout) == (0, "-12.5 running\n"), done
    assert dd3.open(tmp_path).job["outcome"]["state"] == "killed"


@pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="libdd3laws.so is not built")
def test_laws_need_no_pictures():
    """Check that curves, forming limits and draw-beads of a material are computed without matplotlib."""
    code = """import dd3
from dd3 import forming_limit
from dd3.tools.beads import through
steel = dd3.material("dc06")
print(steel.flc(0.8).limit(0.0) > 0.2, len(steel.curve(0.3)), through(None, 1.0, 0.1).restraint > 50)"""
    done = run_hidden(("matplotlib", "pyvista", "vtk", "vtkmodules"), code)
    assert done.stdout == "True 101 True\n", done


def test_commands_without_locks():
    code = "import dd3.report, dd3.process, dd3.study.vary, dd3.tool; print('imported')"
    done = run_hidden(OF_POSIX, code)
    assert done.stdout == "imported\n", done


@pytest.mark.parametrize(("hidden", "words"), [
    (("pyvista",), ("plot", "sheet", "none.out")),
    (("matplotlib",), ("fit", "none.csv")),
    (("ezdxf",), ("curve", "plate.dxf", "plate.txt")),
    (("gmsh",), ("curve", "plate.step", "plate.txt")),
])
def test_missing_package_is_one_sentence(hidden, words, tmp_path):
    for name in ("plate.dxf", "plate.step"):
        (tmp_path / name).write_text("0\nSECTION\n", encoding="utf-8")
    done = run_hidden(hidden, "from dd3.command import main; main(sys.argv[1:])", *words)
    assert done.returncode == 2 and not done.stdout, done
    assert done.stderr.count("\n") == 1 and done.stderr.startswith(f"error: {hidden[0]} is missing: "), done
    assert "pip install " in done.stderr, done


def test_extra_of_installed_package(monkeypatch):
    monkeypatch.setattr(errors.metadata, "version", lambda name: "1.0")
    for name in ("vtkmodules", "gmsh", "numpy"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    assert errors.missing("vtkmodules") == 'vtk is missing: pip install --upgrade "dd3imp[plot]"'
    assert errors.missing("gmsh") == 'gmsh is missing: pip install --upgrade "dd3imp[cad]"'
    monkeypatch.setitem(sys.modules, "ezdxf", errors)
    assert errors.missing("ezdxf.xclip") == 'ezdxf is too old: pip install --upgrade "dd3imp[cad]"'
    assert errors.missing("numpy") == "numpy is missing: pip install --upgrade numpy"


def test_shared_library_names_packages():
    code = "from dd3.errors import run\nimport ctypes\nrun(lambda: ctypes.CDLL('libnone.so.1'))"
    done = run_hidden((), code)
    assert done.returncode == 2 and "apt-get install libegl1" in done.stderr, done


def test_no_library_of_opengl(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(rendering, "is_there", lambda library: False)
    with pytest.raises(rendering.NoOpenGL, match="apt-get install libegl1"):
        rendering.new_plotter()


def installed(tmp_path, monkeypatch, package):
    """Make an installed tree and take its package for this one; return the prefix."""
    prefix = tmp_path / "prefix"
    for folder in ("bin", "share/dd3imp/input_files/cup", "share/dd3imp/input_files/flat",
                   "share/dd3imp/input_files/materials", package):
        (prefix / folder).mkdir(parents=True, exist_ok=True)
    program = prefix / "bin" / "dd3imp"
    program.write_text('#!/bin/sh\necho "dd3imp of the prefix: $*"\n', encoding="utf-8")
    program.chmod(0o755)
    folder = prefix / "share" / "dd3imp" / "input_files"
    (folder / "cup" / "cup.dat").write_text("*INCLUDE ../materials/steel.dat\n", encoding="utf-8")
    (folder / "cup" / "cup.out").mkdir()
    (folder / "flat" / "flat.dat").write_text("*TITLE\n", encoding="utf-8")
    (folder / "materials" / "steel.dat").write_text("*MATERIAL steel\n", encoding="utf-8")
    monkeypatch.setattr(places, "PACKAGE", prefix / package)
    return prefix


@pytest.mark.parametrize("package", ["share/dd3imp/python/dd3", "lib/python3/dist-packages/dd3", "."])
def test_installed_tree(tmp_path, monkeypatch, capsys, package):
    prefix = installed(tmp_path, monkeypatch, package)
    assert Path(places.program()) == prefix / "bin" / "dd3imp"
    info.main([])
    said = capsys.readouterr().out
    assert "dd3imp of the prefix: --version" in said and str(prefix / "share") in said, said
    example.main([])
    assert capsys.readouterr().out.split() == [f"{prefix}/share/dd3imp/input_files:", "cup", "flat", "materials"]


def test_example_with_its_materials(tmp_path, monkeypatch, capsys):
    installed(tmp_path, monkeypatch, "share/dd3imp/python/dd3")
    example.main(["flat", "--into", "work"])
    assert sorted(os.listdir("work")) == ["flat"]
    example.main(["cup", "--into", "work"])
    assert sorted(os.listdir("work")) == ["cup", "flat", "materials"] and os.listdir("work/cup") == ["cup.dat"]
    with pytest.raises(Problem, match="exists already"):
        example.main(["cup", "--into", "work"])
    with pytest.raises(Problem, match="no such example; there are cup, flat, and materials"):
        example.main(["cap"])
    capsys.readouterr()


def test_examples_of_the_clone():
    assert places.examples() == Path(__file__).resolve().parents[2] / "input_files"


def test_program_in_place_of_the_command(tmp_path, monkeypatch):
    prefix = installed(tmp_path, monkeypatch, "share/dd3imp/python/dd3")
    code = f"from pathlib import Path; from dd3 import places; places.PACKAGE = Path({str(places.PACKAGE)!r})\n" \
        "places.execute()"
    done = run_hidden((), code, "cup.dat", "--quiet")
    assert done.stdout == "dd3imp of the prefix: cup.dat --quiet\n", done
    (prefix / "bin" / "dd3imp").unlink()
    done = run_hidden((), code)
    assert done.returncode == 2 and "not part of this package" in done.stderr, done

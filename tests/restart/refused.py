#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "restart_refused", "labels": ["case", "debug"]}
"""Restart files and decks that are refused: a sentence each, exit code 2, and nothing touched.

    refused.py --program build/release/dd3imp --work build/refused
"""
import os
import pathlib
import shutil
import subprocess

import h5py
from runs import ROOT, Deck, Runner, call_tests, check, fresh

from dd3.programs import parser_of_runs

DIE = ROOT / "input_files" / "bending" / "die.bez"
# Phases reached by the restart file: the first two. Changes of the deck and what the message names as different.
DIFFERENT = {
    "other mesh": ((("divisions = 10 2 1", "divisions = 10 3 1"),), "the mesh or the place of the sheet"),
    "other size": ((("175 35 0.78", "176 35 0.78"),), "the mesh or the place of the sheet"),
    "other element": ((("element = hex8", "element = solid_shell"),), "the mesh or the place of the sheet"),
    "other mesh and material": ((("divisions = 10 2 1", "divisions = 10 3 1"), ("K=565", "K=566")),
                                "the mesh or the place of the sheet, material 'mild_steel'"),
    "other hardening": ((("K=565", "K=566"),), "material 'mild_steel'"),
    "other criterion": ((("yield = hill48 F=0.284 G=0.358 H=0.642 L=1.289 M=1.289 N=1.289", "yield = von_mises"),),
                        "material 'mild_steel'"),
    "other elasticity": ((("young = 2.1e5", "young = 2.0e5"),), "material 'mild_steel'"),
    "other back-stress": ((("CX=5", "CX=6"),), "material 'mild_steel'"),
    "other name of the material": ((("*MATERIAL mild_steel", "*MATERIAL steel"),
                                    ("material = mild_steel", "material = steel")),
                                   "material 'steel' (new), material 'mild_steel' (missing)"),
    "other surface": ((("bending/punch.bez", "bending/die.bez"),), "tool 'punch'"),
    "other friction": ((('die.bez"\n  friction = 0.144', 'die.bez"\n  friction = 0.1'),), "tool 'die'"),
    "other position": ((('punch.bez"', 'punch.bez"\n  position = 0 0 1e-9'),), "tool 'punch'"),
    "other candidates": ((('punch.bez"\n  friction = 0.144\n  contact = z_max',
                           'punch.bez"\n  friction = 0.144\n  contact = x_max'),), "tool 'punch'"),
    "another tool": ((("*CONTACT", f'*TOOL more\n  patches = "{DIE}"\n  contact = z_min\n\n*CONTACT'),),
                     "tool 'more' (new)"),
    "other supports": ((("fix = y", "fix = y z"),), "the supports (*BOUNDARY)"),
    "other force pressed": ((("-22600", "-22000"),), "phase 'clamp'"),
    "other end of a phase": ((("force punch 400", "force punch 401"),), "phase 'draw'"),
    "other move": ((("punch 0 0 -4", "punch 0 0 -4.5"),), "phase 'draw'"),
    "other name of a phase": ((("*PHASE draw", "*PHASE press"),), "phase 'press' (new), phase 'draw' (missing)"),
    "another load": ((("hold = punch\n", "hold = punch\n  load = corner 0 0 0\n"),), "phase 'clamp'"),
    "phase missing": ((("every 0.4 mm", "increments 2"),), "phase 'draw' (missing)"),
}
POINT = ROOT / "tests" / "cases" / "point_tension" / "case.dat"


def write_text(path):
    """A text instead of a restart file."""
    path.write_text("restart\n"*1000, encoding="utf-8")


def truncate(path):
    """The first half of the file."""
    os.truncate(path, path.stat().st_size//2)


def newer_format(path):
    """The format of a later version."""
    with h5py.File(path, "r+") as file:
        file.attrs.modify("format", 10)


def lose(name):
    """Without a dataset."""
    def change(path):
        with h5py.File(path, "r+") as file:
            del file[name]
    return change


def shorten(name):
    """With a dataset that is too short."""
    def change(path):
        with h5py.File(path, "r+") as file:
            values = file[name][:-1]
            del file[name]
            file[name] = values
    return change


def as_text(name):
    """With a dataset of text."""
    def change(path):
        with h5py.File(path, "r+") as file:
            n = file[name].size
            del file[name]
            file[name] = [b"text"]*n
    return change


def fields_instead(path):
    """The field file instead."""
    shutil.copy(path.parent / "fields.vtkhdf", path)


def folder(path):
    """A folder of that name."""
    path.unlink()
    path.mkdir()


# Changes of the file, and the message with its name as {}.
NOT_HDF5 = "cannot read the restart file '{}': truncated or not an HDF5 file"
DAMAGED = {
    "missing": (pathlib.Path.unlink, "cannot read the restart file '{}': no such file"),
    "folder": (folder, NOT_HDF5),
    "empty": (lambda path: os.truncate(path, 0), NOT_HDF5),
    "text": (write_text, NOT_HDF5),
    "truncated": (truncate, NOT_HDF5),
    "field file": (fields_instead, "'{}' is not a restart file of dd3imp"),
    "newer format": (newer_format, "'{}' has restart format 10, written by dd3imp "),
    "missing component": (lose("state/stress"), "'{}': component 'stress' is missing"),
    "wrong size": (shorten("state/internal_variables"), "'{}': component 'internal_variables': expected "),
    "text as numbers": (as_text("state/x"), "'{}': component 'x' cannot be read"),
    "missing fingerprint": (lose("model/digest"), "'{}' has no fingerprint of its model"),
    "missing group": (lose("state"), "'{}' has no fingerprint of its model"),
}


class Refusals:
    """A folder with results and a restart file in phase `draw`."""

    def __init__(self, runner, work):
        self.runner, self.work = runner, work
        deck = Deck(work / "first.dat", ("iterations = 8", "iterations = 2"), ("cutback = on", "cutback = off"))
        text = deck.path.read_text(encoding="utf-8")
        deck.path.write_text(text.replace("*PHASE draw\n", "*PHASE draw\n  iterations = 30\n")
                             .replace("*PHASE deeper\n", "*PHASE deeper\n  iterations = 2\n"), encoding="utf-8")
        runner.run(deck, work / "results", expect=3)

    def refuse(self, deck, *sentences, output=None, arguments=(), expect=2):
        """Restart; check exit code, message, and that no file has changed."""
        output = output or self.work / "results"
        restart = output / "restart.h5"
        before = {path.name: path.stat() for path in output.iterdir()}
        said = self.runner.run(deck, output, restart, expect, arguments=arguments)
        for sentence in sentences:
            check(sentence in said, f"expected '{sentence}', got '{said}'")
        check(len(said.splitlines()) == 1, f"more than one line: {said}")
        after = {path.name: path.stat() for path in output.iterdir()}
        check({k: (v.st_mtime_ns, v.st_ino, v.st_size) for k, v in before.items()}
              == {k: (v.st_mtime_ns, v.st_ino, v.st_size) for k, v in after.items()}, f"{output} was changed")

    def different(self, name):
        """A deck of another model."""
        changes, parts = DIFFERENT[name]
        end = "*PHASE draw" if name == "phase missing" else None
        deck = Deck(self.work / "changed.dat", *changes, end=end)
        self.refuse(deck, f"restart.h5' belongs to another model; different: {parts}\n")

    def damaged(self, name):
        """A restart file that is none."""
        change, sentence = DAMAGED[name]
        output = self.work / name.replace(" ", "_")
        shutil.copytree(self.work / "results", output)
        change(output / "restart.h5")
        self.refuse(Deck(self.work / "same.dat"), "dd3imp: error E204: " + sentence.format(output / "restart.h5"), output=output)

    def point(self):
        """A run of a material point."""
        deck = Deck(self.work / "same.dat")
        shutil.copy(POINT, deck.path)
        self.refuse(deck, "dd3imp: error E205: a run of material points (*POINT) has no restart")

    def unreadable(self):
        """A file that may not be read."""
        output = self.work / "unreadable"
        shutil.copytree(self.work / "results", output)
        (output / "restart.h5").chmod(0)
        if os.access(output / "restart.h5", os.R_OK):
            return
        self.refuse(Deck(self.work / "same.dat"), "cannot be read", output=output)

    def usage(self):
        """Options that are wrong."""
        deck = Deck(self.work / "same.dat")
        for arguments, sentence in ((["--restart", "a", "--restart", "b"], "--restart is given twice"),
                                    (["--restart"], "needs a value"), (["--restart="], "needs a value")):
            done = subprocess.run([self.runner.program, str(deck.path), *arguments], stdout=subprocess.PIPE, text=True,
                                  stderr=subprocess.STDOUT, timeout=60, check=False)
            check(done.returncode == 1 and sentence in done.stdout, f"{arguments}: {done.returncode} {done.stdout}")

    def checked(self):
        """--check refuses too, and accepts without touching anything."""
        self.refuse(Deck(self.work / "changed.dat", ("K=565", "K=566")), "belongs to another model",
                    arguments=("--check",))
        output = self.work / "results"
        before = sorted(path.name for path in output.iterdir())
        self.runner.run(Deck(self.work / "same.dat"), output, output / "restart.h5", arguments=("--check", "--quiet"))
        check(sorted(path.name for path in output.iterdir()) == before, "--check has written files")


def main():
    """Run all of them."""
    options = parser_of_runs(__doc__).parse_args()
    refusals = Refusals(Runner(options.program), fresh(options.work.resolve()))
    tests = [(name, lambda name=name: refusals.different(name)) for name in DIFFERENT]
    tests += [(name, lambda name=name: refusals.damaged(name)) for name in DAMAGED]
    tests += [(name, getattr(refusals, name)) for name in ("point", "unreadable", "usage", "checked")]
    raise SystemExit(call_tests(tests))


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured tables: quotes, separators, decimal commas, headings with units, what is left out, and damaged files."""

import logging

import numpy as np
import pytest
from helpers import call
from mutations import mutants

from dd3.errors import Problem
from dd3.forming_limit_curve import read_curve as read_limit
from dd3.identify.measurements import check_law, read_curve, read_data

CURVE = [(0.004, 178.47), (0.01, 207.87), (0.02, 237.52), (0.04, 273.83), (0.06, 298.32)]


def rows(form, decimal="."):
    """Return the rows of the curve."""
    return "".join(form.format(*(str(value).replace(".", decimal) for value in row)) + "\n" for row in CURVE)


TABLES = {
    "quoted": '"strain","stress"\n' + rows('"{}","{}"'), "quoted comma": '"strain","stress"\n' + rows('"{}","{}"', ","),
    "apostrophes": "'strain';'stress'\n" + rows("'{}';'{}'", ","), "semicolons": "strain;stress\n" + rows("{};{}", ","),
    "a row of units": "Dehnung;Spannung\n-;MPa\n" + rows("{};{}", ","), "blanks and commas": rows("{}  {}", ","),
    "byte order mark": "\ufeffstrain,stress\n" + rows("{},{}"), "CRLF": ("strain,stress\n" + rows("{},{}")).replace("\n", "\r\n"),
    "tabs": "strain\tstress\n" + rows("{}\t{}", ","), "blank columns": "strain,,stress,\n,,,\n" + rows("{},,{},"),
    "first column blank": ";strain;stress\n" + rows(";{};{}", ","), "comma and tab": rows("{},\t{}"), "indented": rows("  {} {} "),
    "per cent": "strain (%);stress [MPa]\n" + "".join(f"{100 * a:.6g};{b}\n" for a, b in CURVE),
    "GPa": "strain,stress in GPa\n" + "".join(f"{a},{b / 1000}\n" for a, b in CURVE),
    "other order": "stress,strain\n" + "".join(f"{b},{a}\n" for a, b in CURVE), "comment": "# a b\n" + rows("{} {} # c"),
    "true beside engineering": "eng. strain,true strain,eng. stress,true stress\n" + rows("9,{},9,{}"),
    "headings with blanks": "True strain   True stress (MPa)\n" + rows("{}    {}"),
    "exponents": "".join(f"{a:.3e}".replace("e", "D") + f" {b:.5E}\n" for a, b in CURVE)}


@pytest.mark.parametrize("name", TABLES)
def test_tables(tmp_path, name):
    """Check that each way of writing gives the same curve."""
    path = tmp_path / "curve.csv"
    path.write_text(TABLES[name], encoding="utf-8")
    assert np.allclose(read_curve(str(path), False).T, CURVE, rtol=1e-9), name
    path.write_text(TABLES[name], encoding="utf-16")
    assert np.allclose(read_curve(str(path), False).T, CURVE, rtol=1e-9), name


def test_left_out(tmp_path, caplog):
    """Check that rows above the numbers, other columns and unknown units are named with their lines."""
    path = tmp_path / "curve.csv"
    path.write_text("Specimen;7\n\ntime (s);Strain;Stress (bar);temperature\n" + rows("1;{};{};20"))
    with caplog.at_level(logging.INFO, "dd3"):
        read_curve(str(path), False)
    said = caplog.text
    for text in ("curve.csv:1: row 'Specimen 7'", "curve.csv:3: column 1 'time (s)'", "curve.csv:3: column 4 'temperature'",
                 "curve.csv:3: unit 'bar' of the stress"):
        assert f"left out: {tmp_path}/{text}" in said, said


def test_wrong_tables(tmp_path):
    """Check the messages of tables that cannot be used."""
    path = tmp_path / "curve.csv"
    for text, said in (
            (rows("{},{}", ","), "1: error: more than two numbers"), (rows("{},{},7"), "1: error: more than two numbers"),
            ("strain\tstress\n" + rows("{}\t{}") + "0.07\t1,234\n", "7: error: '1,234' has a comma"),
            ("engineering strain,engineering stress\n" + rows("{},{}"), "1: error: the strain is an engineering one"),
            (rows("{},{}") + "mean,300\n", "6: error: 'mean' is not a number"), (rows("{},{}") + "0.08,\n", "6: error: a number is"),
            (rows("{},{}") + "0.08,nan\n", "6: error: 'nan' is not"), (rows("{},{}") + '"0.08,300\n', "6: error: "),
            ("true strain true stress\n" + rows("{} {}"), "1: error: no row has numbers in the columns named: 4 names, 2"),
            ("strain,stress\nA,B\n", "0 rows: none begins with a number"), ("", "0 rows"),
            ("strain,strain,stress\n" + rows("0,{},{}"), "1: error: a second column for the strain")):
        path.write_text(text)
        with pytest.raises(Problem) as problem:
            read_curve(str(path), False)
        assert said in str(problem.value), text


def test_values(tmp_path):
    """Check measured values with semicolons, tabs and quotes, and r-values in per cent."""
    path = tmp_path / "data.csv"
    path.write_text('r;45;1,51\nr\t90\t2,27\n"r","0","1.79"\nbiaxial_stress 1.18 2\n')
    assert [datum.value for datum in read_data(str(path))] == [1.51, 2.27, 1.79, 1.18]
    path.write_text("r 45 151\n")
    with pytest.raises(Problem, match="r = 151 is out of range"):
        read_data(str(path))
    (tmp_path / "curve.csv").write_text(TABLES["quoted"])
    said = call("fit", "steel", "swift", tmp_path / "curve.csv", "--yield", "hill48 r0=179 r45=151 r90=227", expect=2)
    assert "r = 179 is out of range" in said and "not per cent" in said
    check_law("--yield", "hill48 r0=1.79 r45=1.51 r90=2.27")


def test_fit_of_quotes(tmp_path, program):
    """Check that a quoted table is fitted: a curve of Swift's law with K = 550, e0 = 0.005, n = 0.22."""
    strains = [0.004, 0.01, 0.02, 0.04, 0.06, 0.08, 0.1, 0.12, 0.14]
    path = tmp_path / "curve.csv"
    path.write_text('"strain","stress"\n' + "".join(f'"{a:.4f}","{550 * (0.005 + a)**0.22:.2f}"\n' for a in strains))
    said = call("fit", "steel", "swift", path, "--plastic-strain", "--starts", 1, "--program", program)
    values = {word.split("=")[0]: float(word.split("=")[1]) for word in said.split() if word[:2] in ("K=", "e0", "n=")}
    assert abs(values["K"] / 550 - 1) < 0.01 and abs(values["n"] / 0.22 - 1) < 0.01


def test_mutants(tmp_path):
    """Check that no damaged table ends in anything but a curve or a Problem that names it."""
    path = tmp_path / "mutant.csv"
    for seed, name in enumerate(TABLES):
        for mutant in mutants(TABLES[name].encode(), 60, seed):
            path.write_bytes(mutant)
            for read in (lambda file: read_curve(file, False), read_limit, read_data):
                try:
                    read(str(path))
                except Problem as problem:
                    assert "mutant.csv" in str(problem)

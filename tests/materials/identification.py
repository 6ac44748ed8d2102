#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"labels": ["utils", "slow"], "timeout": 900, "cost": 110}
"""Check dd3 identify and dd3 fit.

    identification.py --program build/release/dd3imp

- Values computed by the program from known parameters are reproduced, and so are the parameters if determined.
- Measured sheets: mild steel of NUMISHEET'93 by every criterion, AA2090-T3 by those that can fit it.
- Scattered and missing values; a curve with a reversal; messages for unusable input.
- Each file written is read by the program.
"""
import contextlib
import io
import os
import re
import sys
import tempfile
from pathlib import Path
from unittest import mock

import numpy as np

from dd3.command import dispatch
from dd3.errors import Problem, run
from dd3.identify import least_squares as fit
from dd3.identify.measurements import TENSION, Datum
from dd3.plot.figures import save
from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]


fit.BORDER, fit.EVALUATIONS = 5, 25  # enough to see that it works
ANGLES = range(0, 91, 15)
TITANIUM = ["--stress", "90:1.053", "--compression", "0:0.898", "90:0.805", "--biaxial-stress", "1.449",
            "--biaxial-compression", "1.104"]  # Ti-4Al-1/4O2 at 0.2 %
STEEL = ["--r", "0:1.79", "45:1.51", "90:2.27"]  # NUMISHEET'93
G = 1 / 2.79
F = 1.79 * G / 2.27
# Criterion, what is given, the parameters known, tolerance: of the library, where not by formula.
STEEL_SETS = (
    ("hill48", [], {"F": F, "G": G, "H": 1 - G, "N": (F + G) * 2.01}),
    ("yld91", ["m=6"], {"a": 0.81385, "b": 0.88006, "c": 1.11247, "h": 0.94446}),
    ("karafillis_boyce", ["k=3", "c=0.1192"],
     {"scale": 0.66412, "alpha1": 0.96524, "alpha2": 0.84183, "gamma3": 1.4173}),
    ("karafillis_boyce", ["k=3"], {}),
    ("drucker", ["c=1.2129"], {"C1": 0.81324, "C2": 0.87964, "C3": 1.11288, "C6": 0.94426}),
    ("drucker", [], {}), ("cazacu_barlat2001", [], {}), ("yld2004", ["m=6"], {}), ("cpb06", [], {}),
    ("yld2000", ["m=6"], {}), ("bbc2008", ["k=3"], {}))
# Criterion, its true parameters, those given, whether all come out again.
TRUE_SETS = (
    ("hill48", "F=0.284 G=0.358 H=0.642 N=1.289", [], True),
    ("hosford", "m=8", [], True),
    ("yld91", "a=1.07591 b=1.29631 c=0.85845 h=1.21462 m=8", [], True),
    ("karafillis_boyce", "c=0.3 scale=0.66412 alpha1=0.96524 alpha2=0.84183 gamma3=1.4173 k=6", ["k=6"], False),
    ("drucker", "c=1.2129 C1=0.81324 C2=0.87964 C3=1.11288 C6=0.94426", [], True),
    ("cazacu_barlat2001", "a1=1.2254 a2=0.69238 a3=0.79239 a4=0.91063 b1=0.98369 b2=1.1328 b3=1.16348 b4=0.93022 "
     "b5=1 b10=0.89573 c=1.2", [], False),
    ("yld2004", "c12=-0.069888 c13=0.936408 c21=0.079143 c23=1.003060 c31=0.524741 c32=1.363180 c66=0.954322 "
     "d12=0.981171 d13=0.476741 d21=0.575316 d23=0.866827 d31=1.145010 d32=-0.079294 d66=1.404620 m=8", [], False),
    ("cpb06", "C11=1 C12=0.05 C13=-0.04 C22=1.1 C23=0.06 C33=0.95 C66=1.05 k=0.1 m=2", [], True),
    ("yld2000", "alpha1=0.4865 alpha2=1.3783 alpha3=0.7536 alpha4=1.0246 alpha5=1.0363 alpha6=0.9036 alpha7=1.2321 "
     "alpha8=1.4858 m=8", [], True),
    ("bbc2008", "l1_1=0.53 l2_1=0.47 m1_1=0.52 m2_1=0.49 m3_1=0.5 n1_1=0.48 n2_1=0.53 n3_1=0.46 l1_2=0.45 l2_2=0.51 "
     "m1_2=0.55 m2_2=0.46 m3_2=0.53 n1_2=0.52 n2_2=0.48 n3_2=0.55 k=4", [], False))
LAWS = ("linear Y0=200 H=400", "swift K=565 e0=0.007 n=0.26", "voce Y0=150 Rsat=200 CR=12",
        "ludwik Y0=150 K=450 n=0.5", "hockett_sherby Y0=150 Ysat=420 N=6 q=0.75",
        "swift_voce alpha=0.4 K=600 e0=0.005 n=0.25 Y0=180 Rsat=170 CR=15")
TWO_SURFACES = "yoshida_uemori Y=130 B=180 C=300 m=12 b_sat=40 Rsat=160 h=0.4"
REVERSAL = "voce Y0=200 Rsat=100 CR=10\n  backstress = lemaitre_chaboche CX=50 Xsat=60"
ALLOY = "\n".join(["# AA2090-T3", *(f"stress {15 * i} {value}" for i, value in enumerate(
    (1, .9605, .9102, .8114, .8096, .8815, .9102))), *(f"r {15 * i} {value}" for i, value in enumerate(
        (.2115, .3269, .6923, 1.5769, 1.0385, .5384, .6923))), "biaxial_stress 1.035", "biaxial_r .67  # last"])
# Words of the command line, and what is said.
MISTAKES = (
    ("--criterion hill48", "error: no measured values"),
    ("--criterion yld91 --fix m=1 --r 0:1.79 45:1.51 90:2.27", "it said: m = 1 is out of range"),
    ("--criterion hill48 --r 0:1.79", "1 measured value\n  expected: 3 or more"),
    ("--criterion hill48 --r 0:1.79 45:1.51 90:2.27 --fix Q=1", "hill48 has no Q"),
    ("--criterion hill48 --r 0:-1.79 45:1.51", "--r: error: r = -1.79 is out of range\n  0:-1.79\n    ^^^^^\n"),
    ("--criterion hill48 --r 100:1.79", "angle = 100 is out of range\n  100:1.79\n  ^^^\n"),
    ("--criterion hill48 --r 1.79", "r has too few numbers\n  1.79\n      ^\n"),
    ("--criterion hill48 --stress 0:250 90:260", "stress = 250 is out of range"),
    ("--criterion hill48 --stress 0:nan", "--stress: error: 'nan' is not a number\n  0:nan\n    ^^^\n"),
    ("--criterion hill48 --r 0:1:2:3", "r has too many numbers\n  0:1:2:3\n        ^\n"),
    ("--criterion hill48 --r 0:1:0 45:1:0 90:1:0", "all weights are 0"),
    ("--criterion hill48 --r 0:x 100:-2", "--r: error: 'x' is not a number\n  0:x\n    ^\n"),
    ("--criterion hill48 --r 0:x 100:-2", "r = -2 is out of range"),
    ("--criterion hill48 --r 0:x 100:-2", "angle = 100 is out of range"),
    ("--criterion hill48 --r 0:x --data two_bad.txt", "two_bad.txt:1: error: 'one' is not a number"),
    ("--criterion hill48 --r 0:x --data two_bad.txt", "two_bad.txt:3: error: r = -1 is out of range"),
    ("--criterion hill48 --r 0:x --data two_bad.txt", "--r: error: 'x' is not a number"),
    ("--criterion hill48 --data many_bad.txt", "\nand 5 more\n"),
    ("--criterion hill48 --r 0:1 45:1 90:1 --fix Q=1 Z=2", "hill48 has no Q Z"),
    ("--criterion hosford --stress 90:1", "do not determine m"),
    ("--criterion hill48 --data none.txt", "none.txt: error: No such file"),
    ("--criterion hill48 --data bad_key.txt", "bad_key.txt:2: error: unknown key 'rr'\n    rr 0 1.5\n    ^^\n"),
    ("--criterion hill48 --data bad_word.txt", "bad_word.txt:1: error: 'one' is not a number\n  r 0 one\n      ^^^\n"),
    ("--criterion hill48 --data comma.txt",
     "comma.txt:2: error: '1,51' is not a number\n  r, 45, 1,51\n         ^^^^\n"),
    ("--criterion hill48 --data comma.txt", "comma.txt:3: error: r = 227 is out of range"),
    ("--criterion hill48 --data empty.txt", "empty.txt: error: no measured values"),
    ("--criterion hill48 --data bytes.txt", "bytes.txt: error: not a text"),
    ("--hardening swift --curve bad_word.txt", "bad_word.txt: error: 0 rows"),
    ("--hardening swift --curve percent.csv", "percent.csv:3: error: strain = 5 is out of range\n  5,200\n  ^\n"),
    ("--hardening swift --curve pascal.csv", "pascal.csv:1: error: stress = 2e8 is out of range"),
    ("--hardening swift --curve small.csv", "the largest stress is 0.4\n"),
    ("--hardening swift --curve decimal.csv", "decimal.csv:1: error: more than two numbers"),
    ("--hardening swift --curve neck.csv",
     "neck.csv:3: error: from here the stress falls to 150\n  0.2,300\n      ^^^\n"),
    ("--hardening swift --curve back.csv", "back.csv:3: error: strain = 0.01 does not increase\n  0.01,300\n  ^^^^\n"),
    ("--hardening voce --backstress prager --curve forth.csv", "no back-stress can be identified"),
    ("--hardening voce --curve elastic.csv", "0 rows beyond the elastic range"),
    ("--hardening voce", "--curve and the name of a law"),
    ("--hardening vocal --curve forth.csv", "--hardening: one of"),
    ("--criterion hill48 --r 0:1 45:1 90:1 --hardening", "expected one argument"),
    ("--criterion hill48 --r 0:1 45:1 90:1 --program ./none", "./none: no such program"),
    ("--criterion hill48 --r 0:1 45:1 90:1 --program /bin/true", "/bin/true: error: exit code 0, and no results"),
    ("--criterion hill48 --r 0:1 45:1 90:1 --program /bin/false", "/bin/false: error: exit code 1, and no results"),
    ("--criterion hill48 --r 0:1 45:1 90:1 --output no/where.dat", "no/where.dat: error: No such file"))
FILES = {
    "bad_key.txt": "r 0 1.5\n  rr 0 1.5\n", "bad_word.txt": "r 0 one\n", "empty.txt": "# nothing\n", "alloy.txt": ALLOY,
    "two_bad.txt": "r 0 one\nr 45 1\nr 90 -1\n", "many_bad.txt": 25 * "r 0 one\n",
    "comma.txt": "r,0,1.8,2\nr, 45, 1,51\nr;90;227\n", "percent.csv": "strain;stress\n1,150\n5,200\n",
    "pascal.csv": "0.01 2e8\n",
    "small.csv": "0 .1\n.1 .2\n.2 .3\n.3 0.4\n",
    "decimal.csv": "0,01,200,5\n", "neck.csv": "0.01,200\n0.1,280\n0.2,300\n0.3,250\n0.4,150\n",
    "back.csv": "0,100\n0.02,200\n0.01,300\n0.3,200\n",
    "forth.csv": "".join(f"{i / 50},{200 + i}\n" for i in range(9)),
    "elastic.csv": "".join(f"{i / 1e5} {2.1 * i}\n" for i in range(9))}


class Trial:
    """Identifications in a folder, and their failures."""

    def __init__(self, program):
        self.program, self.points, self.wrong = program, fit.Points(program, 2.1e5, 0.3), []

    def expect(self, true, what):
        """Record a failure unless the condition holds."""
        if not true:
            self.wrong.append(what)

    def call(self, *words, command="identify"):
        """Return exit code, messages and the file written."""
        Path("found.dat").unlink(missing_ok=True)
        code, out, err = 0, io.StringIO(), io.StringIO()
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
                run(lambda: dispatch([command, "found", *words, *([] if "--program" in words else ["--program", self.program])]))
        except SystemExit as end:
            code = end.code
        text = Path("found.dat").read_text(encoding="utf-8") if code == 0 else ""
        return code, out.getvalue() + err.getvalue(), text

    def fit(self, *words, command="identify"):
        """Return parameters and rows of the table (measured, identified) of a fit that must succeed."""
        code, said, text = self.call(*words, *([] if "--starts" in words else ["--starts", "2"]), command=command)
        self.expect(code == 0, f"{words}: exit code {code}\n{said}")
        back, told, _ = self.points.run(text + "*POINT p\n  material = found\n  control = " + TENSION
                                        + "\n  target = 1e-6 0 0 0 0 0 steps=1\n")
        self.expect(back == 0, f"{words}: the program refuses the file\n{told}")
        rows = {label: (float(one) if one != "-" else None, float(two)) for label, one, two in re.findall(
            r"^# (\S[^\n]*?) +(-|-?\d+\.\d+) +(-?\d+\.\d+)(?: |$)", text, re.MULTILINE)}
        return {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", text)}, rows, text

    def near(self, name, found, wanted, tolerance):
        """Compare parameters."""
        for key, value in wanted.items():
            self.expect(abs(found.get(key, 1e9) - value) <= tolerance * max(abs(value), 1),
                        f"{name}: {key} is {found.get(key)}, expected {value:.6g}")


def largest(rows):
    """Return the largest difference of measured and identified."""
    return max((abs(one - two) for one, two in rows.values() if one is not None), default=float("inf"))


def of_law(law):
    """Return the parameters of a text."""
    return {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", law)}


def check_steel(trial):
    """Check that every criterion has exactly the r-values of mild steel."""
    for name, given, wanted in STEEL_SETS:
        found, rows, text = trial.fit("--criterion", name, *STEEL, *(["--fix", *given] if given else []))
        trial.expect(largest(rows) < 2e-4, f"{name}: {text}")
        trial.near(name, found, wanted, 3e-5)
        trial.expect(("the data determine" in text) != bool(wanted), f"{name}: notes\n{text}")
        trial.expect(rows["equibiaxial, r"][1] > 0, f"{name}: equibiaxial r\n{text}")
        trial.expect("end of its range" not in text and " in place of " not in text, f"{name}: notes\n{text}")
    _, _, text = trial.fit("--criterion", "hill48", "--r", "0:1.79", "90:2.27", "--stress", "90:1.04")
    trial.expect("the data do not determine N: left as in the isotropic case" in text, f"N is open:\n{text}")
    _, _, text = trial.fit("--criterion", "hill48", "--r", "0:.01", "45:19", "90:.01")
    trial.expect("N is at the end of its range" in text, f"no note of N:\n{text}")
    trial.expect("tension 0, stress is 1.39" in text, f"no note of the stress:\n{text}")


def measure(trial, name, law):
    """Return lines with the values that the program computes for a law."""
    data = [Datum(key, angle) for key in ("stress", "r") for angle in ANGLES]
    data += [Datum("biaxial_stress"), Datum("biaxial_r"), Datum("plane_strain", 0), Datum("plane_strain", 90)]
    keys = ["stress"] * 7 + ["r"] * 7 + ["biaxial_stress", "biaxial_r", "plane_strain", "plane_strain"]
    if name == "cpb06":
        data += [Datum("compression", angle) for angle in ANGLES] + [Datum("biaxial_compression")]
        keys += ["compression"] * 7 + ["biaxial_compression"]
    paths = [(control, angle, [(values, 1) for values in targets])
             for control, angle, targets in (d.path() for d in data)]
    rows = trial.points.rows([(f"yield = {name} {law}", f"hardening = {fit.UNIT}")], paths)[0]
    return [(key, d.angle if d.angled else None, d.computed(row)) for key, d, row in zip(keys, data, rows)]


def write(values, path="values.txt"):
    """Write values as a file for --data."""
    Path(path).write_text("".join(f"{key} {'' if angle is None else f'{angle} '}{value:.10g}\n"
                                  for key, angle, value in values), encoding="utf-8")


def check_true(trial):
    """Check that values of known parameters are reproduced."""
    for name, law, given, whole in TRUE_SETS:
        write(measure(trial, name, law))
        found, rows, text = trial.fit("--criterion", name, "--data", "values.txt",
                                      *(["--fix", *given] if given else []))
        trial.expect(largest(rows) < 5e-3, f"{name}: differs by {largest(rows)}\n{text}")
        if whole:
            trial.near(name, found, of_law(law), 2e-3)
    name, law = TRUE_SETS[0][:2]
    random = np.random.default_rng(7)
    write([(key, angle, value * (1 + 0.01 * random.standard_normal()))
           for key, angle, value in measure(trial, name, law)])
    found, rows, text = trial.fit("--criterion", name, "--data", "values.txt")
    trial.near("hill48, scattered", found, of_law(law), 0.03)
    trial.expect(0.002 < largest(rows) < 0.08, f"scattered: {text}")


def check_alloy(trial):
    """Check titanium by cpb06, AA2090-T3 by criteria that can fit it: root of the sum of squares, equibiaxial r."""
    found, rows, text = trial.fit("--criterion", "cpb06", *TITANIUM)
    trial.expect(largest(rows) < 2e-3, f"titanium: {text}")
    trial.expect("C66" not in found and "do not determine C66" in text, f"titanium: {text}")
    for name, limit, starts in (("yld2004", 0.06, "2"), ("cazacu_barlat2001", 0.28, "1")):
        _, rows, text = trial.fit("--criterion", name, "--data", "alloy.txt", "--starts", starts)
        squares = [((two - one) * (0.5 if label.endswith(", r") else 1)) ** 2 for label, (one, two) in rows.items()]
        trial.expect(len(squares) == 16 and np.sqrt(sum(squares)) < limit, f"{name}: {np.sqrt(sum(squares))}\n{text}")
        trial.expect(rows["equibiaxial, r"][1] > 0, f"{name}: {text}")


def curve(trial, law, targets):
    """Return strains and stresses of a law along rolling."""
    path = (TENSION, 0, [([value, 0, 0, 0, 0, 0], steps) for value, steps in targets])
    rows = trial.points.rows([("yield = von_mises", f"hardening = {law}")], [path])[0][0]
    return np.array([(row["e11"], row["s11"]) for row in rows[1:]])


def write_curve(rows, header="strain,stress (N/mm²)\n"):
    """Write a curve in the format of testing machines."""
    Path("curve.csv").write_text(header + "".join(f"{a:.10g},{b:.10g}\n" for a, b in rows), encoding="latin-1")


def check_hardening(trial):
    """Check that each law is identified from its curve."""
    for law in LAWS:
        name = law.split()[0]
        write_curve(curve(trial, law, [(0.25, 40)]))
        found, rows, text = trial.fit("--hardening", name, "--curve", "curve.csv")
        trial.expect(largest(rows) < 0.02, f"{name}: {text}")
        if name != "swift_voce":  # its two parts can do for each other
            trial.near(name, found, of_law(law), 1e-3)
    _, rows, text = trial.fit("--hardening", "table", "--curve", "curve.csv", "--starts", "1")
    trial.expect(largest(rows) < 0.6 and "table 0:" in text, f"table: {text}")
    rows = curve(trial, LAWS[1], [(0.25, 200)])
    rows[:, 1] *= 1 + 0.005 * np.random.default_rng(3).standard_normal(len(rows))
    write_curve(rows, "")
    found, _, text = trial.fit("--hardening", "swift", "--curve", "curve.csv", "--starts", "1")
    trial.near("swift, scattered", {**found, "K": found["K"] / 565}, {"K": 1, "n": 0.26}, 0.02)
    plastic = np.linspace(0, 0.2, 11)
    write_curve(zip(plastic, 350 - 200 * np.exp(-12 * plastic)))
    found, _, _ = trial.fit("--hardening", "voce", "--curve", "curve.csv", "--plastic-strain")
    trial.near("voce, plastic strain", found, of_law(LAWS[2]), 1e-4)
    found, _, text = trial.fit("voce", "curve.csv", "--plastic-strain", "--yield", "hosford m=6", command="fit")
    trial.near("voce by fit", found, of_law(LAWS[2]), 1e-4)
    trial.expect("yield = hosford m=6" in text, f"fit: {text}")


def check_reversal(trial):
    """Check a back-stress from tension and then compression, and the picture: both curves, one on the other."""
    write_curve(curve(trial, REVERSAL, [(0.08, 160), (-0.04, 240)])[4::5])
    with mock.patch("dd3.identify.command.save", wraps=save) as drawn:
        found, rows, text = trial.fit("--hardening", "voce", "--backstress", "lemaitre_chaboche", "--curve",
                                      "curve.csv", "--criterion", "hill48", *STEEL, "--plot", "found.png")
    trial.near("reversal", found, of_law(REVERSAL), 2e-3)
    trial.expect("Note" not in text, f"reversal: notes\n{text}")
    curves, ratios = (part.get_lines() for part in drawn.call_args.args[0].axes[:2])
    measured, identified = (next(line for line in curves if line.get_label() == name) for name in ("measured", "identified"))
    far = np.abs(np.subtract(measured.get_xydata(), identified.get_xydata())).max(axis=0)
    trial.expect(far[0] == 0 and far[1] < 1 and min(np.diff(measured.get_xdata())) < 0, f"picture: {far} off")
    values = {tuple(row) for line in ratios for row in line.get_xydata() if line.get_label() == "measured"}
    trial.expect(values == {(0, 1.79), (45, 1.51), (90, 2.27)}, f"picture: r-values {values}")
    trial.expect(Path("found.png").exists(), "no picture")


def check_two_surfaces(trial):
    """Check a law with a back-stress of its own, from tension, compression and tension."""
    write_curve(curve(trial, TWO_SURFACES, [(0.06, 120), (-0.06, 240), (0.06, 240)])[4::5])
    _, rows, text = trial.fit("--hardening", "yoshida_uemori", "--curve", "curve.csv", "--starts", "1")
    trial.expect(largest(rows) < 1.0, f"two surfaces: {text}")
    write_curve(curve(trial, TWO_SURFACES, [(0.1, 100)]))
    said = trial.call("--hardening", "yoshida_uemori", "--curve", "curve.csv")
    trial.expect("no back-stress can be identified" in str(said), f"two surfaces without reversal: {said}")


def check_few_rows(trial):
    """Check the notes if a curve has fewer rows than there are parameters, and if the fit is poor."""
    write_curve([(0.01, 200), (0.05, 250), (0.1, 280), (0.09, -100), (0.05, -250), (0, -290)])
    _, _, text = trial.fit("--hardening", "voce", "--backstress", "lemaitre_chaboche", "lemaitre_chaboche", "--curve",
                           "curve.csv")
    trial.expect(re.search(r"the data determine \d of 7 parameters", text), f"few rows: {text}")
    trial.expect(re.search(r"the curve is missed by \d\.\d % of its largest stress", text), f"missed: {text}")


def check_mistakes(trial):
    """Check the messages for unusable input."""
    Path("bytes.txt").write_bytes(b"\xff\x00r")
    for words, wanted in MISTAKES:
        code, said, _ = trial.call(*words.split())
        trial.expect(code == 2 and wanted in said, f"{words}: exit code {code}\n{said}")


def main():
    """Run all checks."""
    trial = Trial(str(parser_of_runs(__doc__).parse_args().program))
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, text in FILES.items():
            Path(name).write_text(text, encoding="utf-8")
        for check in (check_mistakes, check_steel, check_true, check_hardening, check_reversal, check_two_surfaces,
                      check_few_rows, check_alloy):
            try:
                check(trial)
            except Problem as problem:
                trial.expect(False, f"{check.__name__}: {problem}")
            print(f"{check.__name__}: {sum(os.times()[:4]):.0f} s", flush=True)
        os.chdir(ROOT)
    print("\n".join(trial.wrong) or "all is found again")
    sys.exit(1 if trial.wrong else 0)


if __name__ == "__main__":
    main()

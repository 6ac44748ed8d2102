#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"labels": ["case", "debug"]}
"""Check the special cases stated in docs/laws: both laws of a pair give the same stresses.

    special_cases.py --program build/release/dd3imp

Both materials undergo the same random strain paths, in all six components, with a change of direction.
"""
import random
import sys

from dd3.programs import parser_of_runs, run_points

PATHS = 12
UNIT = "perfect Y0=100"
SWIFT = "swift K=565 e0=0.007117 n=0.259"
ABC = {"a": 0.81385, "b": 0.88006, "c": 1.11247, "f": 0.9, "g": 1.1, "h": 0.94446}
DRUCKER = " ".join(f"C{i}={value}" for i, value in enumerate(ABC.values(), 1))
BARLAT = " ".join(f"{name}={value}" for name, value in ABC.items())


def hill_of_barlat():
    """Return Hill's coefficients of the transformed stress of yld91 with a quadratic function."""
    a, b, c = ABC["a"], ABC["b"], ABC["c"]
    f, g, h = ((x * x + (x * y + x * z - y * z) / 2) / 3 for x, y, z in ((a, b, c), (b, a, c), (c, a, b)))
    shears = (1.5 * ABC[name] ** 2 for name in "fgh")
    return "hill48 F={:.15g} G={:.15g} H={:.15g} L={:.15g} M={:.15g} N={:.15g}".format(f, g, h, *shears)


def mixture_of_barlat(k, c):
    """Return karafillis_boyce with the transformed stress of yld91."""
    x, y, z = ABC["a"], ABC["b"], ABC["c"]
    scale = (y + z) / 3
    values = (k, c, scale, (x + z) / (y + z), (x + y) / (y + z), *(ABC[name] / scale for name in "fgh"))
    return "karafillis_boyce k={} c={} scale={:.15g} alpha1={:.15g} alpha2={:.15g} gamma1={:.15g} gamma2={:.15g} " \
           "gamma3={:.15g}".format(*values)


def two_of_barlat(m):
    """Return yld2004 with the transformed stress of yld91, twice."""
    a, b, c = ABC["a"], ABC["b"], ABC["c"]
    values = {"12": (b + 2 * c) / 3, "13": (2 * b + c) / 3, "21": (a + 2 * c) / 3, "23": (2 * a + c) / 3,
              "31": (a + 2 * b) / 3, "32": (2 * a + b) / 3, "44": ABC["f"], "55": ABC["g"], "66": ABC["h"]}
    return "yld2004 " + " ".join(f"{t}{key}={value:.15g}" for t in "cd" for key, value in values.items()) + f" m={m}"


def ones(law, names, rest):
    """Return a criterion with all these parameters 1."""
    return f"{law} {' '.join(f'{name}=1' for name in names)} {rest}"


def halves(s):
    """Return coefficients of bbc2008 in the isotropic case, with s terms."""
    return " ".join(f"{name}_{r}=0.5" for r in range(1, s + 1) for name in "l1 l2 m1 m2 m3 n1 n2 n3".split())


ALPHAS = [f"alpha{i}" for i in range(1, 9)]
NORMAL = [f"{t}{place}" for t in "cd" for place in ("12", "13", "21", "23", "31", "32")]
CAZACU = [f"a{i}" for i in range(1, 7)] + [f"b{i}" for i in range(1, 12)]
QUADRATIC = "cazacu_barlat2001 a1=1.3 a2=0.7 a3=0.8 a4=0.9 a5=1.2 a6=1.1 b1=1 b2=1 b3=1 b4=1 c=0"
ISOTROPIC = "cpb06 C11=1 C12=0 C13=0 C22=1 C23=0 C33=1"
CRITERIA = (
    ("hill48 r0=1 r45=1 r90=1", "von_mises"), ("hosford m=2", "von_mises"), ("hosford m=4", "von_mises"),
    (ones("yld91", "abc", "m=6"), "hosford m=6"), (f"yld91 {BARLAT} m=2", hill_of_barlat()),
    (f"yld91 {BARLAT} m=4", hill_of_barlat()), (mixture_of_barlat(3, 0), f"yld91 {BARLAT} m=6"),
    (mixture_of_barlat(1, 0.3), hill_of_barlat()), (mixture_of_barlat(2, 0.3), hill_of_barlat()),
    ("drucker c=0", "von_mises"), (f"drucker c=0 {DRUCKER}", hill_of_barlat()),
    (ones("cazacu_barlat2001", CAZACU, "c=1.2"), "drucker c=1.2"),
    (QUADRATIC, "hill48 F={:.15g} G={:.15g} H={:.15g} L={:.15g} M={:.15g} N={:.15g}".format(
        *(value / 2.1 for value in (0.7, 0.8, 1.3, 3.3, 3.6, 2.7)))),
    (ones("yld2004", NORMAL, "m=8"), "hosford m=8"), (two_of_barlat(6), f"yld91 {BARLAT} m=6"),
    (ones("yld2000", ALPHAS, "m=2"), "von_mises"), (ones("yld2000", ALPHAS, "m=4"), "von_mises"),
    (f"bbc2008 {halves(1)} k=2", "von_mises"), (f"bbc2008 {halves(2)} k=1", "von_mises"),
    (f"bbc2008 {halves(1)} k=4", ones("yld2000", ALPHAS, "m=8")),
    (f"bbc2008 {halves(2)} f=1.2 k=3", ones("yld2000", ALPHAS, "f=1.2 m=6")),
    (f"{ISOTROPIC} k=0 m=2", "von_mises"), (f"{ISOTROPIC} k=0 m=4", "von_mises"),
    ("cpb06 C11=1.2 C12=0.7 C13=0.7 C22=1.2 C23=0.7 C33=1.2 C44=0.5 C55=0.5 C66=0.5 k=0.2 m=2",
     f"{ISOTROPIC} k=0.2 m=2"),
)
STRUCTURES = "Ssat=200 CSL=1 nL=1 CP=2 nP=20 r=2"
HARDENING = (
    ("linear Y0=200 H=0", "perfect Y0=200"), ("swift K=565 Y0=156.6 n=0.259", f"swift K=565 e0="
     f"{(156.6 / 565) ** (1 / 0.259):.15g} n=0.259"), ("voce Y0=200 Rsat=0 CR=10", "perfect Y0=200"),
    ("swift_voce alpha=0 K=565 e0=0.007117 n=0.259 Y0=160 Rsat=200 CR=10", SWIFT),
    ("swift_voce alpha=1 K=565 e0=0.007117 n=0.259 Y0=160 Rsat=200 CR=10", "voce Y0=160 Rsat=200 CR=10"),
    ("ludwik Y0=150 K=450 n=1", "linear Y0=150 H=450"),
    ("hockett_sherby Y0=150 Ysat=420 N=6 q=1", "voce Y0=150 Rsat=270 CR=6"),
    ("table 0:150 1:600", "linear Y0=150 H=450"),
    (f"teodosiu_hu Y0=150 CR=10 Rsat=200 CX=0 X0=0 CSD=4 f=0 {STRUCTURES}", "voce Y0=150 Rsat=200 CR=10"),
    (f"teodosiu_hu Y0=150 CR=10 Rsat=200 CX=50 X0=60 CSD=0 f=0.5 {STRUCTURES}",
     "voce Y0=150 Rsat=200 CR=10\n  backstress = lemaitre_chaboche CX=50 Xsat=60"),
    ("yoshida_uemori Y=200 B=300 C=0 m=50 b_sat=60 Rsat=100 h=0.5",
     "perfect Y0=200\n  backstress = lemaitre_chaboche CX=50 Xsat=60"),
    ("perfect Y0=200\n  modulus = chord Ea=1.5e5 xi=0", "perfect Y0=200"),
    ("swift K=565 e0=0.007117 n=0.259\n  modulus = chord Ea=2.1e5 xi=50", SWIFT),
    ("perfect Y0=200\n  backstress = prager k=0", "perfect Y0=200"),
    ("perfect Y0=200\n  backstress = lemaitre_chaboche CX=0 Xsat=60", "perfect Y0=200"),
    ("perfect Y0=200\n  backstress = lemaitre_chaboche CX=1e-6 Xsat=5e8",
     "perfect Y0=200\n  backstress = prager k=500"),
    ("perfect Y0=200\n  backstress = prager k=300\n  backstress = prager k=200",
     "perfect Y0=200\n  backstress = prager k=500"),
)


def deck(number, laws):
    """Return both materials of a pair with its paths."""
    lines = []
    for i, law in enumerate(laws):
        lines += [f"*MATERIAL m{i}", "  young = 2.1e5", "  poisson = 0.3", *law]
    for path in range(PATHS):
        random.seed(100 * number + path)
        ways = [[random.gauss(0, 0.02) for _ in range(6)] for _ in range(2)]
        ways[1] = [a + b for a, b in zip(*ways)]
        for i in range(2):
            lines += [f"*POINT p{i}_{path}", f"  material = m{i}", "  control = e11 e22 e33 e12 e23 e13"]
            lines += [f"  target = {' '.join(f'{value:.9f}' for value in way)} steps=10" for way in ways]
    return "\n".join(lines) + "\n"


def stresses(program, text):
    """Return the stresses of both materials of a pair, and messages if the program fails."""
    done, points = run_points(program, text, timeout=60)
    if done.code != 0:
        return None, done.errors
    found = ([], [])
    for name, rows in points.items():
        for row in rows:
            found[int(name[1])].extend(row[key] for key in ("s11", "s22", "s12", "s23", "s13"))
    return found, ""


def main():
    """Compare all pairs."""
    program = parser_of_runs(__doc__).parse_args().program
    pairs = [([f"  yield = {law}", f"  hardening = {UNIT}"] for law in pair) for pair in CRITERIA]
    pairs += [(["  yield = hill48 r0=1.79 r45=1.51 r90=2.27", f"  hardening = {law}"] for law in pair)
              for pair in HARDENING]
    wrong, largest = [], 0.0
    for number, (pair, names) in enumerate(zip(pairs, (*CRITERIA, *HARDENING))):
        found, said = stresses(program, deck(number, list(pair)))
        if not found:
            wrong.append(f"{names[0]}: {said}")
            continue
        scale = max(map(abs, found[0]))
        apart = max(abs(a - b) for a, b in zip(*found)) / scale
        largest = max(largest, apart)
        if not apart < 1e-6:
            wrong.append(f"{names[0]}\nis not\n{names[1]}:\n{apart:.1e} apart")
    print("\n".join(wrong) or f"{len(CRITERIA) + len(HARDENING)} pairs agree within {largest:.1e}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()

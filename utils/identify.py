#!/usr/bin/env -S uv run --script
# /// script
# requires-python = ">=3.11"
# dependencies = ["numpy==2.4.6", "scipy==1.17.1"]
# ///
"""Find the parameters of a yield criterion and of a hardening law from measured values.

Weighted least squares from several starts. Every trial set is evaluated by dd3imp itself, at single points (*POINT), so
that there is one implementation of the laws. Sets that the program refuses, because they are out of bounds or their
surface is not convex, count as infinitely bad. The result is a file with one *MATERIAL block.

  Hill's parameters from three r-values, with a known hardening:
    identify.py steel --criterion hill48 --r 0:1.79 45:1.51 90:2.27 --hardening "swift K=565.32 e0=0.007117 n=0.2589"
  Yld'91 with exponent 6, also from yield stresses (over the one along rolling), the equibiaxial one with double weight:
    identify.py steel --criterion yld91 --fix m=6 --r 0:1.79 45:1.51 90:2.27 --stress 45:1.08 90:1.03 \\
        --biaxial-stress 1.18:2
  A Voce law from a tension curve:
    identify.py steel --hardening voce --curve tension.csv

The curve is a table: logarithmic strain and true stress (MPa) in two columns, separated by commas; lines that do not
begin with a number are passed over.
"""

import argparse
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
    from scipy.optimize import least_squares
except ImportError as error:
    sys.exit(f"{error}: pip install -r utils/requirements-identify.txt")

ALONG, THROUGH = "e11 s22 s33 s12 s23 s13", "s11 s22 e33 s12 s23 s13"
UNIT = "perfect Y0=100"  # the flow stress with which criteria are tried
REFUSED = 1e3  # residual of a set that the program does not take
PULL = 1e-3  # weight of the distance from isotropy: decides what the data leave open

# Criterion: its parameters with start, lowest and highest value; the values of those that are not sought.
YLD2004 = [letter + place for letter in "cd" for place in ("12", "13", "21", "23", "31", "32", "66")]
CRITERIA = {
    "hill48": ({"F": (0.5, -1, 5), "G": (0.5, -1, 5), "H": (0.5, -1, 5), "N": (1.5, 0.05, 10)}, {}),
    "hosford": ({"m": (6, 2, 100)}, {}),
    "yld91": ({name: (1, -3, 4) for name in "abch"}, {"m": 8}),
    "karafillis_boyce": ({"c": (0.3, 0, 1), "scale": (2 / 3, 0.1, 2), "alpha1": (1, 0, 3), "alpha2": (1, 0, 3),
                          "gamma3": (1.5, 0.1, 5)}, {"k": 4}),
    "drucker": ({"c": (0.5, -3.37, 2.24), **{name: (1, -3, 4) for name in ("C1", "C2", "C3")}, "C6": (1, 0.05, 4)}, {}),
    "cazacu_barlat2001": ({**{f"a{i}": (1, 0.05, 5) for i in (1, 2, 3, 4)},
                           **{f"b{i}": (1, -5, 5) for i in (1, 2, 3, 4, 5, 10)}, "c": (0.5, -3.37, 2.24)}, {}),
    "yld2004": ({name: (1, -3, 4) for name in YLD2004}, {"m": 8}),
    "cpb06": ({"C12": (0, -3, 3), "C13": (0, -3, 3), "C22": (1, -4, 4), "C23": (0, -3, 3), "C33": (1, -4, 4),
               "C66": (1, 0.05, 5), "k": (0, -0.99, 0.99)}, {"C11": 1, "m": 2}),
}
LAWS = ("linear", "swift", "voce", "ludwick", "hockett_sherby", "swift_voce")


def law_text(name, values):
    """A law with its parameters, as it stands in the input."""
    return " ".join([name, *(f"{key}={value:.10g}" for key, value in values.items())])


class Points:
    """Runs of the program: materials at single points, along given paths."""

    def __init__(self, program, young, poisson):
        self.program, self.elastic, self.runs = program, f"  young = {young:g}\n  poisson = {poisson:g}", 0

    def deck(self, materials, paths):
        """The input, and the number of the material to which each of its lines belongs."""
        lines, owner = [], []
        for i, laws in enumerate(materials):
            block = [f"*MATERIAL m{i}", *self.elastic.split("\n"), *(f"  {line}" for line in laws)]
            for j, (control, angle, targets) in enumerate(paths):
                block += [f"*POINT p{i}_{j}", f"  material = m{i}", f"  angle = {angle:.10g}", f"  control = {control}"]
                block += [f"  target = {' '.join(f'{value:.12g}' for value in values)} steps=1" for values in targets]
            lines += block
            owner += [i] * len(block)
        return "\n".join(lines) + "\n", owner

    def run(self, text):
        """Exit code, messages and rows by point of one run."""
        self.runs += 1
        with tempfile.TemporaryDirectory() as folder:
            file, out = Path(folder) / "points.dat", Path(folder) / "out"
            file.write_text(text, encoding="utf-8")
            try:
                done = subprocess.run([self.program, "--quiet", "--output", str(out), str(file)], capture_output=True,
                                      text=True, check=False)
            except OSError as error:
                sys.exit(f"{self.program}: {error.strerror}")
            points = {}
            if done.returncode == 0:
                with open(out / "history.csv", newline="", encoding="utf-8") as stream:
                    for row in csv.DictReader(line for line in stream if not line.startswith("#")):
                        points.setdefault(row.pop("point"), []).append({key: float(row[key]) for key in row})
        return done.returncode, done.stderr, points

    def rows(self, materials, paths):
        """For each material the rows of each path; None for a material that the program refuses."""
        result, left = [None] * len(materials), list(range(len(materials)))
        while left:
            text, owner = self.deck([materials[i] for i in left], paths)
            code, said, points = self.run(text)
            if code == 0:
                for i, number in enumerate(left):
                    result[number] = [points[f"p{i}_{j}"] for j in range(len(paths))]
                break
            refused = {owner[int(line) - 1] for line in re.findall(r"points\.dat:(\d+): error", said)}
            if code == 2 and refused:
                left = [number for i, number in enumerate(left) if i not in refused]
            elif code == 2:
                sys.exit(said)
            elif len(left) == 1:
                break
            else:
                for number in left:
                    result[number] = self.rows([materials[number]], paths)[0]
                break
        return result


class Datum:
    """A measured value: kind of test, angle, stress or r, value, weight."""

    def __init__(self, text, kind, quantity, weight):
        parts = text.split(":")
        if kind == "biaxial":
            parts.insert(0, "0")
        if len(parts) not in (2, 3):
            sys.exit(f"{text}: expected {'value' if kind == 'biaxial' else 'angle:value'}, with :weight if wanted")
        try:
            self.angle, self.value, self.weight = (float(part) for part in [*parts, str(weight)][:3])
        except ValueError:
            sys.exit(f"{text}: not a number")
        if self.value < 0 or self.weight < 0 or (quantity == "stress" and self.value == 0):
            sys.exit(f"{text}: measured values and weights are positive")
        self.kind, self.quantity = kind, quantity

    def label(self):
        """Its name in the table."""
        where = "equibiaxial" if self.kind == "biaxial" else f"{self.kind} {self.angle:g}"
        return f"{where}, {self.quantity}"

    def path(self):
        """The path at a point; equibiaxial tension is compression through the thickness, but for pressure."""
        sign, place = (1 if self.kind == "tension" else -1), (2 if self.kind == "biaxial" else 0)
        targets = [[sign * strain if i == place else 0.0 for i in range(6)] for strain in (0.01, 0.011)]
        return (THROUGH if place else ALONG, self.angle, targets)

    def computed(self, rows):
        """Its value from the rows of its path; the strains between the last two are plastic."""
        if self.quantity == "stress":
            return abs(rows[-1]["s33" if self.kind == "biaxial" else "s11"]) / rows[-1]["flow_stress"]
        across, through = (rows[-1][key] - rows[-2][key] for key in
                           ("e22", "e11" if self.kind == "biaxial" else "e33"))
        return across / through


class Fit:
    """Least squares of values that the program computes from trial parameters."""

    def __init__(self, trial, evaluate, sought, measured, weights, pull):
        self.trial, self.evaluate, self.sought = trial, evaluate, sought
        self.start, self.low, self.high = (np.array([row[i] for row in sought], float) for i in range(3))
        self.measured, self.weights, self.pull = np.array(measured), np.array(weights), pull

    def residuals(self, points):
        """Residuals at several points, by one run."""
        found = self.evaluate([self.trial(point) for point in points])
        return [None if values is None or not np.all(np.isfinite(values)) else np.concatenate(
            [self.weights * (values - self.measured), self.pull * (point - self.start)])
            for values, point in zip(found, points)]

    def value(self, point):
        """Residuals at a point."""
        found = self.residuals([point])[0]
        return np.full(len(self.measured) + len(point), REFUSED) if found is None else found

    def slope(self, point):
        """Their derivatives by differences: central, one-sided beside a refused set."""
        n = len(point)
        steps = 1e-4 * np.maximum(np.abs(point), 0.1)
        ahead, behind = (np.clip(point + sign * np.diag(steps), self.low, self.high) for sign in (1, -1))
        found = self.residuals([point, *ahead, *behind])
        slope = np.zeros((len(self.measured) + n, n))
        for i in range(n):
            (x1, f1), (x0, f0) = ((x, f) if f is not None else (point, found[0])
                                  for x, f in ((ahead[i], found[1 + i]), (behind[i], found[1 + n + i])))
            if f1 is not None and f0 is not None and x1[i] > x0[i]:
                slope[:, i] = (f1 - f0) / (x1[i] - x0[i])
        return slope

    def best(self, starts, spread, seed):
        """The best of several starts: parameters and the root of the cost of each start."""
        random, best, costs = np.random.default_rng(seed), None, []
        scale = spread * np.maximum(np.abs(self.start), 0.5)
        for number in range(starts):
            first = self.start if number == 0 else self.start + scale * random.standard_normal(len(scale))
            margin = 1e-6 * (self.high - self.low)
            first = np.clip(first, self.low + margin, self.high - margin)
            if self.residuals([first])[0] is None:
                costs.append(np.inf)
                continue
            found = least_squares(self.value, first, jac=self.slope, bounds=(self.low, self.high), x_scale="jac",
                                  xtol=1e-9, ftol=1e-10, gtol=1e-10, max_nfev=60)
            costs.append(np.sqrt(2 * found.cost))
            if best is None or found.cost < best.cost:
                best = found
        if best is None:
            sys.exit("no start gave a set that the program takes: more --starts, or other values of --fix?")
        return best.x, costs


def criterion(options, points, data):
    """Identifies a criterion: its text and the table of values."""
    sought, fixed = ({**part} for part in CRITERIA[options.criterion])
    for name, value in options.fix.items():
        if name not in sought and name not in fixed:
            sys.exit(f"--fix: {options.criterion} has no {name}; it has {' '.join([*sought, *fixed])}")
        sought.pop(name, None)
        fixed[name] = value
    if "k" in sought and options.criterion == "cpb06" and not any(datum.kind == "compression" for datum in data):
        fixed["k"] = sought.pop("k")[0]
    if not sought:
        sys.exit("nothing is left to be sought")
    paths = list({(d.kind, d.angle): d.path() for d in data}.items())
    place = {key: i for i, (key, _) in enumerate(paths)}

    def trial(point):
        return law_text(options.criterion, {**dict(zip(sought, point)), **fixed})

    def evaluate(texts):
        found = points.rows([(f"yield = {text}", f"hardening = {UNIT}") for text in texts], [path for _, path in paths])
        return [None if rows is None else np.array([d.computed(rows[place[d.kind, d.angle]]) for d in data])
                for rows in found]

    fit = Fit(trial, evaluate, list(sought.values()), [d.value for d in data], [d.weight for d in data], PULL)
    point, costs = fit.best(options.starts, 0.3, options.seed)
    text, values = rounded(trial, evaluate, point)
    report(options.criterion, costs)
    return text, [f"{d.label():<24}{d.value:>10.4f}{value:>12.4f}{d.weight:>9g}" for d, value in zip(data, values)]


def rounded(trial, evaluate, point):
    """The law with as few digits as the program takes, six or more, and its values."""
    texts = [re.sub(r"=(\S+)", lambda found, n=digits: f"={float(found[1]):.{n}g}", trial(point))
             for digits in (6, 8, 10)]
    for text, values in zip(texts, evaluate(texts)):
        if values is not None:
            return text, values
    sys.exit("the program does not take the rounded parameters: " + texts[-1])


def report(name, costs):
    """Says what the starts gave."""
    print(f"{name}: root of the sum of squares from each start: " + " ".join(f"{cost:.3g}" for cost in costs))


def read_curve(path):
    """Strains and stresses of a table."""
    pairs = []
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            for row in csv.reader(stream):
                try:
                    pairs.append((float(row[0]), float(row[1])))
                except (ValueError, IndexError):
                    continue
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    strain, stress = np.array(pairs).reshape(-1, 2).T
    if len(strain) < 3 or np.any(np.diff(strain) <= 0) or np.any(stress <= 0):
        sys.exit(f"{path}: expected three rows or more, strain,stress, the strains growing, the stresses positive")
    return strain, stress


def law_start(name, plastic, stress):
    """First values of a hardening law's parameters and their upper bounds, from the curve."""
    first, last, end = stress[0], stress.max(), max(plastic[-1], 1e-3)
    rise = max(last - first, 0.05 * last)
    swift = {"K": last / (0.01 + end) ** 0.2, "e0": 0.01, "n": 0.2}
    voce = {"Y0": first, "Rsat": rise, "CR": 2 / end}
    start = {"linear": {"Y0": first, "H": rise / end}, "swift": swift, "voce": voce,
             "ludwick": {"Y0": 0.9 * first, "K": rise / end**0.5, "n": 0.5},
             "hockett_sherby": {"Y0": first, "Ysat": first + 1.2 * rise, "N": 2 / end, "q": 0.8},
             "swift_voce": {"alpha": 0.5, **swift, **voce}}[name]
    return start, {"n": 1, "q": 1, "alpha": 1}


def hardening(options, points):
    """Identifies a hardening law: its text and the table of values."""
    strain, stress = read_curve(options.curve)
    if options.plastic_strain:
        strain = strain + stress / options.young
    plastic = strain - stress / options.young
    keep = plastic > -1e-9 if options.plastic_strain else plastic > 2e-4
    strain, stress, plastic = strain[keep], stress[keep], plastic[keep]
    if len(strain) < 3:
        sys.exit(f"{options.curve}: fewer than three rows beyond the elastic range of --young")
    if len(strain) > 60:
        chosen = np.unique(np.linspace(0, len(strain) - 1, 60).astype(int))
        strain, stress, plastic = strain[chosen], stress[chosen], plastic[chosen]
    start, highest = law_start(options.hardening, plastic, stress)
    sought = [(np.log(value), np.log(value / 300), np.log(highest.get(name, value * 300)))
              for name, value in start.items()]
    path = (ALONG, 0, [[value, 0, 0, 0, 0, 0] for value in strain])

    def trial(point):
        return law_text(options.hardening, dict(zip(start, np.exp(point))))

    def evaluate(texts):
        found = points.rows([("yield = von_mises", f"hardening = {text}") for text in texts], [path])
        return [None if rows is None else np.array([row["s11"] for row in rows[0][1:]]) for rows in found]

    weight = 1 / (stress.max() * np.sqrt(len(stress)))
    fit = Fit(trial, evaluate, sought, stress, np.full(len(stress), weight), 1e-6)
    point, costs = fit.best(options.starts, 0.15, options.seed)
    text, values = rounded(trial, evaluate, point)
    report(options.hardening, costs)
    some = np.unique(np.linspace(0, len(strain) - 1, 8).astype(int))
    lines = [f"{f'tension, strain {strain[i]:.4f}':<24}{stress[i]:>10.2f}{values[i]:>12.2f}" for i in some]
    error = np.sqrt(np.mean((values - stress) ** 2))
    return text, [*lines, f"root mean square over {len(strain)} rows: {error:.2f} MPa"]


def folded(key, text):
    """A line of the block, continued where it is long."""
    lines, line = [], f"  {key} ="
    for word in text.split():
        if len(line) + len(word) > 92:
            lines.append(line + " &")
            line = "   "
        line += " " + word
    return [*lines, line]


def block(options, yields, hardens, table):
    """The file: what was measured and what came out, then the *MATERIAL."""
    lines = ["# Identified by utils/identify.py", f"# {'':<24}{'measured':>10}{'identified':>12}{'weight':>9}"]
    lines += [f"# {line}" for line in table]
    if not options.hardening:
        lines.append("# No hardening was given: the flow stress 100 stands for the unit.")
    lines += [f"*MATERIAL {options.name}", f"  young = {options.young:g}", f"  poisson = {options.poisson:g}"]
    return "\n".join([*lines, *folded("yield", yields), *folded("hardening", hardens)]) + "\n"


def fixed_value(text):
    """A parameter of --fix."""
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: expected name=value") from None


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("name", help="name of the material")
    add("--criterion", choices=CRITERIA, help="yield criterion to identify (without it: von_mises)")
    add("--fix", type=fixed_value, action="extend", nargs="+", default=[], metavar="NAME=VALUE",
        help="parameters of the criterion that are given, such as its exponent (default: m=8, k=4; cpb06 C11=1 m=2)")
    add("--r", nargs="+", default=[], metavar="ANGLE:R[:WEIGHT]", help="r-values in tension (weight 0.5)")
    add("--stress", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]",
        help="yield stresses in tension over the one along rolling (weight 1); 0:1 is added")
    add("--compression", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]", help="the same in compression")
    add("--biaxial-stress", nargs=1, default=[], metavar="S[:WEIGHT]", help="the same in equibiaxial tension")
    add("--biaxial-r", nargs=1, default=[], metavar="R[:WEIGHT]", help="its ratio of strains, across over along (0.5)")
    add("--hardening", metavar="LAW",
        help=f"law to identify from --curve ({', '.join(LAWS)}), or a law with all its values")
    add("--curve", metavar="FILE", help="tension curve along rolling")
    add("--plastic-strain", action="store_true", help="the strains of the curve are the plastic parts")
    add("--young", type=float, default=2.1e5, help="Young's modulus, MPa (2.1e5)")
    add("--poisson", type=float, default=0.3, help="Poisson's ratio (0.3)")
    add("--starts", type=int, default=4, help="number of starts: the first from isotropy, the others at random (4)")
    add("--seed", type=int, default=1, help="seed of the random starts (1)")
    add("--program", default="dd3imp", help="the program dd3imp (default: the one on the path)")
    add("--output", metavar="FILE", help="file to write (default: NAME.dat)")
    options = parser.parse_args()
    options.fix = dict(options.fix)
    fits = bool(options.hardening) and "=" not in options.hardening
    if fits and options.hardening not in LAWS:
        parser.error(f"--hardening: one of {', '.join(LAWS)}, or a law with all its values")
    if fits != bool(options.curve):
        parser.error("--curve and the name of a law in --hardening go together")
    if not options.criterion and not fits:
        parser.error("nothing to identify: --criterion, or --hardening with --curve")
    if options.young <= 0 or options.starts < 1:
        parser.error("--young and --starts are positive")
    return options, fits


def measured(options):
    """The measured values of a criterion."""
    kinds = ((options.stress, "tension", "stress", 1), (options.r, "tension", "r", 0.5),
             (options.compression, "compression", "stress", 1), (options.biaxial_stress, "biaxial", "stress", 1),
             (options.biaxial_r, "biaxial", "r", 0.5))
    data = [Datum(text, kind, quantity, weight) for texts, kind, quantity, weight in kinds for text in texts]
    if not data:
        sys.exit("no measured values: --r, --stress, --compression, --biaxial-stress, --biaxial-r")
    if not any(d.kind == "tension" and d.quantity == "stress" and d.angle == 0 for d in data):
        data.insert(0, Datum("0:1", "tension", "stress", 1))
    return data


def main():
    """Identifies and writes."""
    options, fits = arguments()
    points, table = Points(options.program, options.young, options.poisson), []
    yields, hardens = "von_mises", options.hardening or UNIT
    if options.criterion:
        yields, table = criterion(options, points, measured(options))
    if fits:
        hardens, more = hardening(options, points)
        table = table + more
    text = block(options, yields, hardens, table)
    code, said, _ = points.run(text + f"*POINT p\n  material = {options.name}\n  control = {ALONG}\n"
                               "  target = 1e-6 0 0 0 0 0 steps=1\n")
    if code != 0:
        sys.exit(said)
    path = Path(options.output or f"{options.name}.dat")
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    print(f"{text}\n{points.runs} runs of the program; written to {path}")


if __name__ == "__main__":
    main()

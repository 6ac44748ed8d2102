#!/usr/bin/env python3
"""Find the parameters of a yield criterion and of a hardening law from measured values.

Weighted least squares from several starts. Every trial set is evaluated by dd3imp itself, at single points (*POINT), so
that the laws are implemented once. Sets that the program refuses, because they are out of bounds or their surface is
not convex, have an infinite cost. The result is a file with one *MATERIAL block.

  Hill's parameters from three r-values, with a known hardening:
    identify.py steel --criterion hill48 --r 0:1.79 45:1.51 90:2.27 --hardening "swift K=565.32 e0=0.007117 n=0.2589"
  Yld'91 with exponent 6, also from yield stresses (over the one along rolling), the equibiaxial one with double weight:
    identify.py steel --criterion yld91 --fix m=6 --r 0:1.79 45:1.51 90:2.27 --stress 45:1.08 90:1.03 \\
        --biaxial-stress 1.18:2
  A Voce law from a tension curve; with a back-stress, from a curve that continues in compression:
    identify.py steel --hardening voce --curve tension.csv --plot steel.png
    identify.py steel --hardening voce --backstress lemaitre_chaboche --curve reversal.csv

The curve is a table: logarithmic strain and true stress (MPa) in two columns, separated by commas, semicolons or
blanks; lines before the first number are skipped. Each line of the file of --data gives one of the values of the
options --r, --stress and so on, such as `r 45 1.51` or `biaxial_stress 1.18 2`; # begins a comment.
"""

import argparse
import re
import sys
import tempfile
from functools import partial
from pathlib import Path

import scripts

scripts.need("numpy", "scipy")
import numpy as np  # noqa: E402
import results  # noqa: E402
from measurements import KEYS, TENSION, Datum, every, from_argument, read_curve, read_data  # noqa: E402
from scipy.optimize import differential_evolution, least_squares  # noqa: E402
from scripts import Problem  # noqa: E402

UNIT = "perfect Y0=100"  # hardening law of the trial runs of criteria
REFUSED = 1e3  # residual of a set that the program refuses
PULL = 1e-3  # weight of the distance from isotropy, which determines what the data do not
ENOUGH = 1e-3  # root of the sum of squares of the data below which no other start is tried
BORDER = 60  # generations of the search along a border of convexity
EVALUATIONS = 60  # at most, in a descent
STEP = 1e-4  # of the differences, over the size of the parameter
END = 3e-3  # fraction of a range: a note if a parameter is nearer to its end
MISSED = 0.1  # difference from a measured value, over the value or 1, that is noted
MISSED_CURVE = 0.01  # the same for a curve: root mean square over the largest stress

# Criterion: its parameters with start, lowest and highest value; the values of those that are not sought; the least
# number of measured values.
NORMAL, SHEAR = ("12", "13", "21", "23", "31", "32"), ("66",)
CRITERIA = {
    "hill48": ({"F": (0.5, -1, 5), "G": (0.5, -1, 5), "H": (0.5, -1, 5), "N": (1.5, 0.05, 10)}, {}, 3),
    "hosford": ({"m": (6, 2, 100)}, {}, 1),
    "yld91": ({name: (1, -3, 4) for name in "abch"}, {"m": 8}, 3),
    "karafillis_boyce": ({"c": (0.3, 0, 1), "scale": (2 / 3, 0.1, 2), "alpha1": (1, 0, 3), "alpha2": (1, 0, 3),
                          "gamma3": (1.5, 0.1, 5)}, {"k": 4}, 3),
    "drucker": ({"c": (0.5, -3.37, 2.24), **{name: (1, -3, 4) for name in ("C1", "C2", "C3")}, "C6": (1, 0.05, 4)},
                {}, 3),
    "cazacu_barlat2001": ({**{f"a{i}": (1, 0.05, 5) for i in (1, 2, 3, 4)},
                           **{f"b{i}": (1, -5, 5) for i in (1, 2, 3, 4, 5, 10)}, "c": (0.5, -3.37, 2.24)}, {}, 3),
    "yld2004": ({letter + place: (1, -3, 4) for letter in "cd" for place in NORMAL + SHEAR}, {"m": 8}, 3),
    "cpb06": ({"C12": (0, -3, 3), "C13": (0, -3, 3), "C22": (1, -4, 4), "C23": (0, -3, 3), "C33": (1, -4, 4),
               "C66": (1, 0.05, 5), "k": (0, -0.99, 0.99)}, {"C11": 1, "m": 2}, 3),
}
LAWS = ("linear", "swift", "voce", "swift_voce", "ludwik", "hockett_sherby", "table")
BACKSTRESSES = {"prager": ("k",), "lemaitre_chaboche": ("CX", "Xsat")}


def law_text(name, values, digits=10):
    """Return a law with its parameters in the form of the input."""
    return " ".join([name, *(f"{key}={value:.{digits}g}" for key, value in values.items())])


class Points:
    """Runs of the program with materials at single points, along given paths."""

    def __init__(self, program, young, poisson):
        self.program, self.elastic, self.runs = program, f"  young = {young:g}\n  poisson = {poisson:g}", 0
        self.refusal = ""

    def deck(self, materials, paths):
        """Return the input, and the number of the material to which each of its lines belongs."""
        lines, owner = [], []
        for i, laws in enumerate(materials):
            block = [f"*MATERIAL m{i}", *self.elastic.split("\n"), *(f"  {line}" for line in laws)]
            for j, (control, angle, targets) in enumerate(paths):
                block += [f"*POINT p{i}_{j}", f"  material = m{i}", f"  angle = {angle:.10g}"]
                block.append(f"  control = {control}")
                block += [f"  target = {' '.join(f'{value:.12g}' for value in values)} steps={steps}"
                          for values, steps in targets]
            lines += block
            owner += [i] * len(block)
        return "\n".join(lines) + "\n", owner

    def run(self, text):
        """Return exit code, messages and rows by point of one run."""
        self.runs += 1
        done, points = results.run_points(self.program, text)
        return done.code, done.errors, points

    def rows(self, materials, paths):
        """Return the rows of each path for each material; None for a material that the program refuses."""
        result, left = [None] * len(materials), list(range(len(materials)))
        while left:
            text, owner = self.deck([materials[i] for i in left], paths)
            code, said, points = self.run(text)
            if code == 0:
                for i, number in enumerate(left):
                    result[number] = [points[f"p{i}_{j}"] for j in range(len(paths))]
                break
            refused = {owner[int(line) - 1] for line in re.findall(re.escape(results.POINTS) + r":(\d+): error", said)}
            if code == 2 and refused:
                self.refusal = re.search(r": error: (.*)", said).group(1)
                left = [number for i, number in enumerate(left) if i not in refused]
            elif code == 2:
                raise Problem(said.strip())
            elif len(left) == 1:
                break
            else:
                for number in left:
                    result[number] = self.rows([materials[number]], paths)[0]
                break
        return result


class NoStart(Exception):
    """The program refuses all starts of the search."""


class Fit:
    """Least squares of values that the program computes from trial parameters."""

    def __init__(self, evaluate, sought, measured, weights, pull):
        self.evaluate, self.names = evaluate, list(sought)
        self.start, self.low, self.high = (np.array([row[i] for row in sought.values()], float) for i in range(3))
        self.measured, self.weights, self.pull = np.array(measured), np.array(weights), pull
        self.known = {}

    def residuals(self, points):
        """Return the residuals at several points, from one run; None for those that the program refuses."""
        found = self.evaluate([dict(zip(self.names, point)) for point in points])
        return [None if values is None or not np.all(np.isfinite(values)) else np.concatenate(
            [self.weights * (values - self.measured), self.pull * (point - self.start)])
            for values, point in zip(found, points)]

    def at(self, point):
        """Return residuals at a point, their derivatives by differences, and whether a set nearby is refused."""
        key = point.tobytes()
        if key not in self.known:
            steps = STEP * np.maximum(np.abs(point), 0.1)
            steps[point + steps > self.high] *= -1
            here, *near = self.residuals([point, *(point + np.diag(steps))])
            refused = [i for i, one in enumerate(near) if one is None]
            if here is None:
                here = np.full(len(self.measured) + len(point), REFUSED)
                near = [here] * len(point)
            elif refused:
                steps[refused] *= -1
                behind = np.clip(point + np.diag(steps)[refused], self.low, self.high)
                for i, one in zip(refused, self.residuals(list(behind))):
                    near[i] = here if one is None else one
            self.known[key] = here, np.array([(one - here) / step for one, step in zip(near, steps)]).T, bool(refused)
        return self.known[key]

    def descend(self, first):
        """Minimise the squares from a point."""
        return least_squares(lambda point: self.at(point)[0], first, jac=lambda point: self.at(point)[1],
                             bounds=(self.low, self.high), xtol=1e-8, ftol=1e-5, gtol=1e-9, max_nfev=EVALUATIONS)

    def along_border(self, first, seed):
        """Continue from a point next to refused sets, where least squares fail, by differential evolution."""
        def costs(points):
            found = self.residuals(list(points.T))
            return np.array([np.inf if one is None else one @ one / 2 for one in found])

        random = np.random.default_rng(seed)
        spread = 0.05 * np.maximum(np.abs(self.start), 0.5) * random.standard_normal((32, len(first)))
        spread[0] = 0
        found = differential_evolution(costs, list(zip(self.low, self.high)), init=np.clip(
            first + spread, self.low, self.high), vectorized=True, updating="deferred", maxiter=BORDER, polish=False,
            tol=1e-4, rng=seed)
        return found.x if found.fun < costs(first[:, None])[0] else first

    def best(self, starts, spread, seed):
        """Return the parameters of the best of several starts, and the root of the cost of each start."""
        random, best, costs = np.random.default_rng(seed), None, []
        scale = spread * np.maximum(np.abs(self.start), 0.5)
        for number in range(starts):
            first = self.start if number == 0 else self.start + scale * random.standard_normal(len(scale))
            margin = 1e-6 * (self.high - self.low)
            first = np.clip(first, self.low + margin, self.high - margin)
            if self.residuals([first])[0] is None:
                costs.append(np.inf)
                continue
            found = self.descend(first)
            costs.append(np.sqrt(2 * found.cost))
            if best is None or found.cost < best.cost:
                best = found
            if np.linalg.norm(found.fun[:len(self.measured)]) < ENOUGH:
                break
        if best is None:
            raise NoStart
        point = best.x
        if self.at(point)[2]:
            point = self.descend(self.along_border(point, seed)).x
            costs.append(np.linalg.norm(self.at(point)[0]))
        return point, costs

    def left_open(self, point, none, rest):
        """Return notes on what the data do not determine; `none` and `rest` say what value those parameters have."""
        slope = self.at(point)[1][:len(self.measured)]
        size = np.linalg.norm(slope, axis=0)
        idle = [name_of(name) for name, part in zip(self.names, size) if part < 1e-6]
        count = int(np.sum(np.linalg.svd(slope, compute_uv=False) > PULL))
        notes = []
        if idle:
            notes.append(f"the data do not determine {', '.join(idle)}: {none}")
        if count < len(point) - len(idle):
            notes.append(f"the data determine {count} of {len(point) - len(idle)} parameters, or combinations of them; "
                         f"{rest}")
        return notes

    def at_ends(self, point):
        """Return notes on the parameters at the end of their range."""
        ends = np.minimum(point - self.low, self.high - point) < END * (self.high - self.low)
        return [f"{name_of(name)} is at the end of its range: another law may fit the data better"
                for name, end in zip(self.names, ends) if end]


def name_of(name):
    """Return the name of a parameter in the input."""
    return name[-1] if isinstance(name, tuple) else name


def sought_parameters(options, data):
    """Return the parameters to identify, with start and bounds, and those that are given."""
    sought, fixed, least = CRITERIA[options.criterion]
    sought, fixed = dict(sought), dict(fixed)
    unknown = [name for name in options.fix if name not in sought and name not in fixed]
    if unknown:
        raise Problem(f"--fix: error: {options.criterion} has no {' '.join(unknown)}\n  expected: one of "
                      + " ".join([*sought, *fixed]))
    for name, value in options.fix.items():
        sought.pop(name, None)
        fixed[name] = value
    if "k" in sought and options.criterion == "cpb06" and not any("compression" in datum.kind for datum in data):
        fixed["k"] = sought.pop("k")[0]
    if options.criterion == "cpb06" and "C66" in sought and not any(0 < datum.angle < 90 for datum in data):
        sought.pop("C66")  # the program's own value follows the other parameters
    if not sought:
        raise Problem(f"--fix: error: all parameters of {options.criterion} are given\n  expected: one to seek")
    if len(data) < least:
        raise Problem(f"{options.criterion}: error: {len(data)} measured value{'s' * (len(data) != 1)}\n  expected: "
                      f"{least} or more, such as r-values at 0, 45 and 90 degrees")
    if options.criterion == "hosford" and not any(datum.kind == "plane strain" for datum in data):
        raise Problem("hosford: error: tension and equibiaxial tension do not determine m\n"
                      "  expected: --plane-strain, or no identification: m is 6 for bcc, 8 for fcc metals")
    return sought, fixed


def test_paths(data):
    """Return the paths of the tests of the data, each once, by test."""
    paths = {d.same_test(): d.path() for d in data}
    return {test: (control, angle, [(values, 1) for values in targets])
            for test, (control, angle, targets) in paths.items()}


def criterion_table(data, values):
    """Return the lines that compare measured and identified values."""
    return [f"{d.label():<32}{'-' if d.value is None else f'{d.value:.4f}':>10}{value:>12.4f}"
            + (f"{value - d.value:>12.4f}{d.weight:>8g}" if d.value is not None else "")
            for d, value in zip(data, values)]


def criterion(options, points, data):
    """Identify a criterion; return its text, the table of values and notes."""
    sought, fixed = sought_parameters(options, data)
    if not any(d.same_test() == ("tension", 0) and d.quantity == "stress" for d in data):
        data.insert(0, Datum("stress", 0.0, 1.0))
    extra = [Datum(key) for key in ("biaxial_stress", "biaxial_r")
            if not any(d.label() == Datum(key).label() for d in data)]
    paths = test_paths(data + extra)
    place = {test: i for i, test in enumerate(paths)}

    def compute(texts):
        found = points.rows([(f"yield = {text}", f"hardening = {UNIT}") for text in texts], list(paths.values()))
        return [None if rows is None else np.array([d.computed(rows[place[d.same_test()]]) for d in data + extra])
                for rows in found]

    def evaluate(sets):
        return [None if values is None or values[ratio] <= 0 else values[:len(data)]
                for values in compute([law_text(options.criterion, {**one, **fixed}) for one in sets])]

    ratio = next(i for i, d in enumerate(data + extra) if d.kind == "equibiaxial" and d.quantity == "r")
    fit = Fit(evaluate, sought, [d.value for d in data], [d.weight for d in data], PULL)
    if options.criterion == "yld2004":  # not where both transformations are the same: a saddle
        fit.start = fit.start + np.array([0.02 if name[0] == "c" else -0.02 for name in fit.names])
    point, costs = fit.best(options.starts, 0.3, options.seed)
    text, values = rounded(lambda digits: law_text(options.criterion, {**dict(zip(sought, point)), **fixed}, digits),
                           compute)
    report(options.criterion, costs)
    notes = fit.left_open(point, "left as in the isotropic case", "the rest stays as near to isotropy as they allow")
    if options.criterion == "cpb06" and "C66" not in {**sought, **fixed}:
        notes.insert(0, "the data do not determine C66: left out, so that it follows the other parameters")
    return text, criterion_table(data + extra, values), notes + fit.at_ends(point) + missed(data, values)


def missed(data, values):
    """Return notes on the measured values that the criterion does not fit."""
    far = [f"{d.label()} is {value:.4g} in place of {d.value:.4g}" for d, value in zip(data, values)
           if d.weight and abs(value - d.value) > MISSED * max(d.value, 1)]
    return [f"{text}: another criterion may fit the data better, or the value is wrong" for text in far]


def rounded(trial, compute):
    """Return the law with the fewest digits that the program accepts, six or more, and its values."""
    texts = [trial(digits) for digits in (6, 8, 10)]
    for text, values in zip(texts, compute(texts)):
        if values is not None:
            return text, values
    raise Problem("the program refuses the rounded parameters: " + texts[-1])


def report(name, costs):
    """Print the result of each start."""
    print(f"{name}: root of the sum of squares from each start: " + " ".join(f"{cost:.3g}" for cost in costs))


def law_start(name, plastic, stress):
    """Return the starting values of a hardening law's parameters."""
    first, last, end = stress[0], stress.max(), max(plastic.max(), 1e-3)
    rise = max(last - first, 0.05 * last)
    swift = {"K": last / (0.01 + end) ** 0.2, "e0": 0.01, "n": 0.2}
    voce = {"Y0": first, "Rsat": rise, "CR": 2 / end}
    return {"linear": {"Y0": first, "H": rise / end}, "swift": swift, "voce": voce,
            "ludwik": {"Y0": 0.9 * first, "K": rise / end**0.5, "n": 0.5},
            "hockett_sherby": {"Y0": first, "Ysat": first + 1.2 * rise, "N": 2 / end, "q": 0.8},
            "swift_voce": {"alpha": 0.5, **swift, **voce}, "table": table_start(plastic, stress)}[name]


def table_start(plastic, stress):
    """Return the start of a table: the initial flow stress and its rise from each knot to the next."""
    count = min(8, len(plastic) - 1)
    knots = [float(f"{value:.4g}") for value in plastic.max() * np.linspace(0, 1, count) ** 2]
    order = np.argsort(plastic)
    values = np.maximum.accumulate(np.interp(knots, plastic[order], stress[order]))
    rises = np.maximum(np.diff(values), 1e-3 * stress.max())
    return {knots[0]: values[0], **dict(zip(knots[1:], rises))}


def hardening_lines(name, values, digits=10):
    """Return the input lines of the hardening and of the back-stresses, whose keys are (law, number, parameter)."""
    own = {key: value for key, value in values.items() if not isinstance(key, tuple)}
    if name == "table":
        knots = " ".join(f"{knot:g}:{value:.{digits}g}" for knot, value in zip(own, np.cumsum(list(own.values()))))
        lines = [f"hardening = table {knots}"]
    else:
        lines = ["hardening = " + law_text(name, own, digits)]
    for law in dict.fromkeys(key[:2] for key in values if isinstance(key, tuple)):
        part = {key[2]: value for key, value in values.items() if isinstance(key, tuple) and key[:2] == law}
        lines.append("backstress = " + law_text(law[0], part, digits))
    return lines


def measured_curve(options):
    """Return at most 60 strains and stresses beyond the first elastic range, and the turning points."""
    strain, stress = read_curve(options.curve, bool(options.backstress))
    if options.plastic_strain:
        strain = strain + stress / options.young
    plastic = strain - stress / options.young
    first = 0 if options.plastic_strain else int(np.argmax(plastic > 2e-4))
    if not options.plastic_strain and not np.any(plastic > 2e-4):
        first = len(strain)
    strain, stress = strain[first:], stress[first:]
    if len(strain) < 4:
        raise Problem(f"{options.curve}: error: {len(strain)} rows beyond the elastic range of --young "
                      f"{options.young:g}\n  expected: four or more")
    turns = np.flatnonzero(np.diff(np.sign(np.diff(strain)))) + 1
    if options.backstress and not len(turns):
        raise Problem(f"{options.curve}: error: the strain increases throughout: no back-stress can be identified\n"
                      "  expected: a curve with a reversal, such as tension and then compression")
    if len(strain) > 60:
        chosen = np.linspace(0, len(strain) - 1, 60).astype(int)
        chosen = np.unique(np.concatenate([chosen, turns]))
        strain, stress = strain[chosen], stress[chosen]
        turns = np.flatnonzero(np.diff(np.sign(np.diff(strain)))) + 1
    return strain, stress, turns


def hardening_start(options, strain, stress, turns):
    """Return the logarithms of the parameters to identify, with start and bounds."""
    forward = slice(0, turns[0] + 1 if len(turns) else None)
    plastic = strain[forward] - stress[forward] / options.young
    start = law_start(options.hardening, plastic, stress[forward])
    most = stress[forward].max()
    for number, law in enumerate(options.backstress):
        first = {"k": most, "CX": 15 * 8**number, "Xsat": 0.15 * most}
        start.update({(law, number, name): first[name] for name in BACKSTRESSES[law]})
    highest = {"n": 1, "q": 1, "alpha": 1}
    return {name: (np.log(value), np.log(value / 300), np.log(highest.get(name, value * 300)))
            for name, value in start.items()}


def curve_table(strain, stress, values, missed_by):
    """Return the lines that compare eight rows of the curve, and the root mean square of the difference (MPa)."""
    some = np.unique(np.linspace(0, len(strain) - 1, 8).astype(int))
    return [*(f"{f'strain {strain[i]:.4f}, MPa':<32}{stress[i]:>10.2f}{values[i]:>12.2f}{values[i] - stress[i]:>12.2f}"
              for i in some), f"root mean square over {len(strain)} rows: {missed_by:.2f} MPa"]


def hardening(options, points, yields):
    """Identify a hardening law; return its lines, the table of values, notes, and the curve: strain, both stresses."""
    strain, stress, turns = measured_curve(options)
    sought = hardening_start(options, strain, stress, turns)
    counts = np.ones(len(strain), int)
    if options.backstress:  # the law of the back-stress is integrated step by step
        counts = np.maximum(1, np.ceil(np.abs(np.diff(strain, prepend=0)) / 0.002)).astype(int)
    path = (TENSION, 0, [([value, 0, 0, 0, 0, 0], count) for value, count in zip(strain, counts)])
    ends = np.cumsum(counts)

    def compute(laws):
        found = points.rows([(f"yield = {yields}", *lines) for lines in laws], [path])
        return [None if rows is None else np.array([rows[0][i]["s11"] for i in ends]) for rows in found]

    def evaluate(sets):
        return compute([hardening_lines(options.hardening, {key: np.exp(value) for key, value in one.items()})
                        for one in sets])

    weight = 1 / (np.abs(stress).max() * np.sqrt(len(stress)))
    fit = Fit(evaluate, sought, stress, np.full(len(stress), weight), 1e-6)
    point, costs = fit.best(options.starts, 0.15, options.seed)
    found = dict(zip(sought, np.exp(point)))
    lines, values = rounded(lambda digits: hardening_lines(options.hardening, found, digits), compute)
    report(options.hardening, costs)
    far = np.linalg.norm(weight * (values - stress))
    table = curve_table(strain, stress, values, far * np.abs(stress).max())
    notes = fit.left_open(point, "left as at the start", "other values of the rest may do as well") + fit.at_ends(point)
    if far > MISSED_CURVE:
        notes.append(f"the curve is missed by {100 * far:.1f} % of its largest stress: "
                     "another law may fit it better")
    return lines, table, notes, (strain, stress, values)


def folded(key, text):
    """Return a line of the block, continued if it is long."""
    lines, line = [], f"  {key} ="
    for word in text.split():
        if len(line) + len(word) > 92:
            lines.append(line + " &")
            line = "   "
        line += " " + word
    return [*lines, line]


def block(options, yields, hardens, table, notes):
    """Return the file: measured and identified values as comments, then the *MATERIAL."""
    lines = ["# Identified by utils/identify.py",
             f"# {'':<32}{'measured':>10}{'identified':>12}{'difference':>12}{'weight':>8}"]
    lines += [f"# {line}" for line in table]
    if not options.hardening:
        notes = [*notes, "no hardening was given: the flow stress of 100 is only a unit"]
    lines += [f"# Note: {note}" for note in notes]
    lines += [f"*MATERIAL {options.name}", f"  young = {options.young:g}", f"  poisson = {options.poisson:g}"]
    lines += folded("yield", yields)
    for line in hardens:
        lines += folded(*line.split(" = "))
    return "\n".join(lines) + "\n"


def fixed_value(text):
    """Return name and value of an argument of --fix."""
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: expected name=value") from None


def command_line():
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("name", help="name of the material")
    add("--criterion", choices=CRITERIA, help="yield criterion to identify (without it: von_mises)")
    add("--fix", type=fixed_value, action="extend", nargs="+", default=[], metavar="NAME=VALUE",
        help="parameters of the criterion that are given, such as its exponent (default: m=8, k=4; cpb06 C11=1 m=2)")
    add("--data", metavar="FILE", help="measured values, one in a line: " + ", ".join(KEYS))
    add("--r", nargs="+", default=[], metavar="ANGLE:R[:WEIGHT]", help="r-values in tension (weight 0.5)")
    add("--stress", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]",
        help="yield stresses in tension over the one along rolling (weight 1); 0:1 is added")
    add("--compression", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]", help="the same in compression")
    add("--plane-strain", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]", help="the same in plane strain tension")
    add("--biaxial-stress", nargs="+", default=[], metavar="S[:WEIGHT]", help="the same in equibiaxial tension")
    add("--biaxial-compression", nargs="+", default=[], metavar="S[:WEIGHT]",
        help="the same in equibiaxial compression, or tension through the thickness")
    add("--biaxial-r", nargs="+", default=[], metavar="R[:WEIGHT]",
        help="its strain ratio, transverse over along rolling (0.5)")
    add("--hardening", metavar="LAW",
        help=f"law to identify from --curve ({', '.join(LAWS)}), or a law with all its values")
    add("--backstress", nargs="+", choices=BACKSTRESSES, default=[], metavar="LAW",
        help=f"back-stresses to identify with it ({', '.join(BACKSTRESSES)}), from a curve with a reversal")
    add("--curve", metavar="FILE", help="tension curve along rolling; with --backstress continuing in compression")
    add("--plastic-strain", action="store_true", help="the strains of the curve are plastic strains")
    add("--young", type=float, default=2.1e5, help="Young's modulus, MPa (2.1e5)")
    add("--poisson", type=float, default=0.3, help="Poisson's ratio (0.3)")
    add("--starts", type=int, default=4, help="number of starts: the first from isotropy, the others at random (4)")
    add("--seed", type=int, default=1, help="seed of the random starts (1)")
    add("--program", default="dd3imp", help="the program dd3imp (default: the one on the path)")
    add("--output", metavar="FILE", help="file to write (default: NAME.dat)")
    add("--plot", metavar="FILE", help="picture to draw: measured values and identified curves")
    return parser


def arguments():
    """Return the options, and whether a hardening law is identified."""
    parser = command_line()
    options = parser.parse_args()
    options.fix = dict(options.fix)
    fits = bool(options.hardening) and "=" not in options.hardening and ":" not in options.hardening
    if not re.fullmatch(r"[A-Za-z][\w.-]*", options.name):
        parser.error(f"{options.name}: a name begins with a letter and has letters, digits, _ . - only")
    if fits and options.hardening not in LAWS:
        parser.error(f"--hardening: one of {', '.join(LAWS)}, or a law with all its values")
    if fits != bool(options.curve):
        parser.error("--curve and the name of a law in --hardening go together")
    if options.backstress and not fits:
        parser.error("--backstress goes with --curve")
    if not options.criterion and not fits:
        parser.error("nothing to identify: --criterion, or --hardening with --curve")
    if options.young <= 0 or options.starts < 1:
        parser.error("--young and --starts are positive")
    return options, fits


def measured(options):
    """Return the measured values of a criterion."""
    parts = [partial(read_data, options.data)] if options.data else []
    parts += [partial(from_argument, key, text) for key in KEYS for text in getattr(options, key)]
    data = [datum for part in every(parts) for datum in part]
    if not data:
        raise Problem("error: no measured values\n  expected: --data or --" + " --".join(KEYS).replace("_", "-"))
    if not any(d.weight for d in data):
        raise Problem("error: all weights are 0\n  expected: a positive weight")
    return data


def draw(options, text, data, curve):
    """Draw the material without its back-stresses as plot_point.py does, and the measured values."""
    import plot_point
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "material.dat"
        path.write_text(re.sub(r"  backstress = .*\n", "", text), encoding="utf-8")
        figure = plot_point.picture([path], options.program, 0.2 if curve is None else max(curve[0].max(), 0.02))
    figure.legends[0].remove()  # each panel has its own
    axes = figure.axes
    if options.backstress:
        for line in list(axes[0].lines):
            line.remove()
        axes[0].set_title("Curve")
    style = {"linestyle": "none", "marker": "s", "color": "k", "markerfacecolor": "none", "label": "measured"}
    if curve is not None:
        axes[0].plot(curve[0], curve[1], **{**style, "marker": ".", "zorder": 1})
        if options.backstress:
            axes[0].plot(curve[0], curve[2], color="C1", label="identified")
    for part, quantity in ((axes[1], "r"), (axes[2], "stress")):
        chosen = [d for d in data if d.kind == "tension" and d.quantity == quantity]
        if chosen:
            part.plot([d.angle for d in chosen], [d.value for d in chosen], **style)
    places = [place for place in map(on_surface, data) if place]
    if places:
        axes[3].plot(*zip(*places), **style)
    for part in axes:
        part.legend(fontsize="small")
    plot_point.save(figure, options.plot)


def on_surface(d):
    """Return the point of a measured stress in the plane of rolling and transverse stresses; None if it has none."""
    if d.quantity != "stress" or d.angle not in (0, 90) or d.kind == "plane strain":
        return None
    value = d.value if d.kind in ("tension", "equibiaxial") else -d.value
    if d.kind.startswith("equibiaxial"):
        return value, value
    return (value, 0) if d.angle == 0 else (0, value)


def identify():
    """Identify the parameters and write the file."""
    options, fits = arguments()
    points, table, notes, data, curve = Points(options.program, options.young, options.poisson), [], [], [], None
    yields, hardens = "von_mises", [f"hardening = {options.hardening or UNIT}"]
    try:
        if options.criterion:
            data = measured(options)
            yields, table, notes = criterion(options, points, data)
        if fits:
            hardens, more, other, curve = hardening(options, points, yields)
            table, notes = table + more, notes + other
    except NoStart:
        raise Problem("error: the program refused the parameters of every start; it said: "
                      f"{points.refusal or 'the points did not converge'}\n"
                      "  expected: more --starts, or other values of --fix") from None
    text = block(options, yields, hardens, table, notes)
    code, said, _ = points.run(text + f"*POINT p\n  material = {options.name}\n  control = {TENSION}\n"
                               "  target = 1e-6 0 0 0 0 0 steps=1\n")
    if code != 0:
        raise Problem(said.strip())
    path = Path(options.output or f"{options.name}.dat")
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Problem(f"{path}: error: {error.strerror}") from None
    print(f"{text}\n{points.runs} runs of the program; written to {path}")
    if options.plot:
        draw(options, text, data, curve)


def main():
    """End with exit code 2 if the input cannot be used."""
    try:
        identify()
    except Problem as problem:
        scripts.end(str(problem))


if __name__ == "__main__":
    scripts.run(main)

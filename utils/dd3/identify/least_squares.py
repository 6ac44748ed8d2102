# SPDX-License-Identifier: GPL-3.0-or-later
"""Least squares of what the program computes at single points, from trial parameters of a law."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import differential_evolution, least_squares

from dd3.errors import LOG, Problem
from dd3.programs import POINTS, run_points
from dd3.progress import counter

UNIT = "perfect Y0=100"  # hardening law of the trial runs of criteria
REFUSED = 1e3  # residual of a set that the program refuses
PULL = 1e-3  # weight of the distance from isotropy, which determines what the data do not
ENOUGH = 1e-3  # root of the sum of squares of the data below which no other start is tried
BORDER = 60  # generations of the search along a border of convexity
EVALUATIONS = 60  # at most, in a descent
STEP = 1e-4  # of the differences, over the size of the parameter
END = 3e-3  # fraction of a range: a note if a parameter is nearer to its end


class LoadPath(NamedTuple):
    """Control, angle to the rolling direction, targets with their steps, and rate (1/s) of the first component, which
    the control prescribes, if the material has a law of the strain rate."""

    control: str
    angle: float
    targets: Sequence[tuple[Sequence[float], int]]
    rate: float | None = None

    def lines(self) -> list[str]:
        """Return the lines of *POINT."""
        lines = [f"  angle = {self.angle:.10g}", f"  control = {self.control}"]
        lines += [f"  target = {' '.join(f'{value:.12g}' for value in values)} steps={steps}"
                  for values, steps in self.targets]
        if self.rate:
            ways = np.abs(np.diff([values[0] for values, _ in self.targets], prepend=0))
            lines += ["  duration = &"] + [f"    {way / self.rate:.12g} &" for way in ways]
            lines[-1] = lines[-1].removesuffix(" &")
        return lines


class Search(NamedTuple):
    """Number of starts, and the seed of the random ones."""

    starts: int
    seed: int


# Lines of a material, and its paths.
Case = tuple[Sequence[str], Sequence[LoadPath]]


def law_text(name: str, values: dict[str, float], digits: int = 10) -> str:
    """Return a law with its parameters in the form of the input."""
    return " ".join([name, *(f"{key}={value:.{digits}g}" for key, value in values.items())])


class Points:
    """Runs of the program with materials at single points, along given paths."""

    def __init__(self, program: str | Path, young: float, poisson: float) -> None:
        self.program, self.young, self.runs = program, young, 0
        self.elastic = f"  young = {young:g}\n  poisson = {poisson:g}"
        self.refusal, self.bar = "", counter("identification", "runs")

    def set_elastic(self, young: float, modulus: str) -> None:
        """Set Young's modulus, MPa, and the law of the modulus, its text, of all further runs."""
        self.young = young
        poisson = self.elastic.split("\n")[1]
        self.elastic = f"  young = {young:.6g}\n{poisson}\n  modulus = {modulus}"

    def deck(self, cases: Sequence[Case]) -> tuple[str, list[int]]:
        """Return the input, and the number of the material to which each of its lines belongs."""
        lines, owner = [], []
        for i, (laws, paths) in enumerate(cases):
            own = {line.split()[0] for line in laws}
            block = [f"*MATERIAL m{i}", *(line for line in self.elastic.split("\n") if line.split()[0] not in own),
                     *(f"  {line}" for line in laws)]
            for j, path in enumerate(paths):
                block += [f"*POINT p{i}_{j}", f"  material = m{i}", *LoadPath(*path).lines()]
            lines += block
            owner += [i] * len(block)
        return "\n".join(lines) + "\n", owner

    def run(self, text: str) -> tuple[int, str, dict[str, list[Any]]]:
        """Return exit code, messages and rows by point of one run."""
        self.runs += 1
        self.bar.update()
        done, points = run_points(self.program, text)
        return done.code, done.errors, points

    def rows(self, materials: Sequence[Sequence[str]], paths: Sequence[LoadPath]) -> list[Any]:
        """Return the rows of each path for each material; None for a material that the program refuses."""
        return self.rows_of([(laws, paths) for laws in materials])

    def rows_of(self, cases: Sequence[Case]) -> list[Any]:
        """Return the rows of each path for each material, which has paths of its own; None for a material that the
        program refuses. A line of a material takes the place of that of the elastic ones with the same key."""
        result: list[Any] = [None] * len(cases)
        left = list(range(len(cases)))
        while left:
            text, owner = self.deck([cases[i] for i in left])
            code, said, points = self.run(text)
            if code == 0:
                for i, number in enumerate(left):
                    result[number] = [points[f"p{i}_{j}"] for j in range(len(cases[number][1]))]
                break
            refused = {owner[int(line) - 1] for line in re.findall(re.escape(POINTS) + r":(\d+): error", said)}
            if code == 2 and refused:
                self.refusal = said.partition(": error ")[2].partition(": ")[2].partition("\n")[0]
                left = [number for i, number in enumerate(left) if i not in refused]
            elif code == 2:
                raise Problem(said.strip())
            elif len(left) == 1:
                break
            else:
                for number in left:
                    result[number] = self.rows_of([cases[number]])[0]
                break
        return result


class NoStart(Exception):
    """The program refuses all starts of the search."""


class Fit:
    """Least squares of values that the program computes from trial parameters."""

    def __init__(self, evaluate: Callable[..., Any], sought: dict[Any, tuple[float, float, float]],
                 measured: Any, weights: Any, pull: float) -> None:
        self.evaluate, self.names = evaluate, list(sought)
        self.start, self.low, self.high = (np.array([row[i] for row in sought.values()], float) for i in range(3))
        self.measured, self.weights, self.pull = np.array(measured), np.array(weights), pull
        self.known: dict[bytes, tuple[np.ndarray, np.ndarray, bool]] = {}

    def residuals(self, points: list[np.ndarray]) -> list[np.ndarray | None]:
        """Return the residuals at several points, from one run; None for those that the program refuses."""
        found = self.evaluate([dict(zip(self.names, point)) for point in points])
        return [None if values is None or not np.all(np.isfinite(values)) else np.concatenate(
            [self.weights * (values - self.measured), self.pull * (point - self.start)])
            for values, point in zip(found, points)]

    def at(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, bool]:
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

    def descend(self, first: np.ndarray) -> Any:
        """Minimise the squares from a point."""
        return least_squares(lambda point: self.at(point)[0], first, jac=lambda point: self.at(point)[1],
                             bounds=(self.low, self.high), xtol=1e-8, ftol=1e-5, gtol=1e-9, max_nfev=EVALUATIONS)

    def along_border(self, first: np.ndarray, seed: int) -> np.ndarray:
        """Continue from a point next to refused sets, where least squares fail, by differential evolution."""
        def costs(points: np.ndarray) -> np.ndarray:
            found = self.residuals(list(points.T))
            return np.array([np.inf if one is None else one @ one / 2 for one in found])

        random = np.random.default_rng(seed)
        spread = 0.05 * np.maximum(np.abs(self.start), 0.5) * random.standard_normal((32, len(first)))
        spread[0] = 0
        found = differential_evolution(costs, list(zip(self.low, self.high)), init=np.clip(
            first + spread, self.low, self.high), vectorized=True, updating="deferred", maxiter=BORDER, polish=False,
            tol=1e-4, seed=seed)
        return found.x if found.fun < costs(first[:, None])[0] else first

    def best(self, starts: int, spread: float, seed: int) -> tuple[np.ndarray, list[float]]:
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
            costs.append(float(np.linalg.norm(self.at(point)[0])))
        return point, costs

    def left_open(self, point: np.ndarray, none: str, rest: str) -> list[str]:
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

    def at_ends(self, point: np.ndarray) -> list[str]:
        """Return notes on the parameters at the end of their range."""
        ends = np.minimum(point - self.low, self.high - point) < END * (self.high - self.low)
        return [f"{name_of(name)} is at the end of its range: another law may fit the data better"
                for name, end in zip(self.names, ends) if end]


def name_of(name: str) -> str:
    """Return the name of a parameter in the input."""
    return name[-1] if isinstance(name, tuple) else name


def rounded(trial: Callable[[int], Any], compute: Callable[[list[Any]], list[Any]]) -> tuple[Any, np.ndarray]:
    """Return the law with the fewest digits that the program accepts, six or more, and its values."""
    texts = [trial(digits) for digits in (6, 8, 10)]
    for text, values in zip(texts, compute(texts)):
        if values is not None:
            return text, values
    raise Problem("the program refuses the rounded parameters: " + texts[-1])


def report(name: str, costs: list[float]) -> None:
    """Tell the result of each start."""
    LOG.info(f"{name}: root of the sum of squares from each start: " + " ".join(f"{cost:.3g}" for cost in costs))

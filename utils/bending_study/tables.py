# SPDX-License-Identifier: GPL-3.0-or-later
"""Rewrite the tables of docs/reports/bending_study.md from the results of the bending study.

    python3 -m bending_study report docs/reports/bending_study.md
"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from bending_study.runs import FIRST, Run, differences
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.pages import places, put_table, table
from dd3.run import read_job
from dd3.tables import Row, read_table, totals

PENALTIES = ["1e2", "1e3", "1e4", "1e5"]
MESHES = ["a", "b"]
END = 40.0
# Endings of the cases' names and their meaning.
FORCE = {"": "off", "-c0.1": "0.1, 0.1, 0.1", "-c1": "1, 1, 1", "-c1000": "1000, 1000, 1000",
         "-normal": "1, 1000, 1000", "-tangential": "1000, 1, 1"}
ALONE = {"-c1-alone": "c = 1, trial 1 mm", "-c1000-alone": "c = 1000, trial 1 mm",
         "-c1-alone-trial0.1": "c = 1, trial 0.1 mm", "-c1000-alone-trial0.1": "c = 1000, trial 0.1 mm"}
VARIANTS = {"": "as in Fig. 3", "-c1": "c = 1", "-held": "u_y = 0", "-held-c1": "u_y = 0, c = 1",
            "-half_holder": "blank-holder 11.3 kN", "-c1-floor0": "c = 1, no floor of B",
            "-umfpack": "solver `umfpack`"}
MAX8 = {"-max8": "off", "-c1-max8": "c = 1", "-c1000-max8": "c = 1000", "-held-max8": "off, u_y = 0"}
SCATTER = {("a", "", "30"): "off", ("a", "-c0.1", "30"): "0.1, 0.1, 0.1", ("a", "-c1", "30"): "1, 1, 1",
           ("a", "-normal", "30"): "1, 1000, 1000", ("a", "-tangential", "30"): "1000, 1, 1",
           ("a", "-half_holder", "30"): "off, blank-holder 11.3 kN",
           ("a", "-max8", "8"): "off", ("a", "-c1-max8", "8"): "1, 1, 1", ("a", "-held-max8", "8"): "off, u_y = 0",
           ("b", "-max8", "8"): "off", ("b", "-c1-max8", "8"): "1, 1, 1",
           ("a", "-c1-alone", "30"): "1, 1, 1 alone, trial 1 mm", ("b", "-c1-alone", "30"): "1, 1, 1 alone, trial 1 mm",
           ("a", "-c1-alone-trial0.1", "30"): "1, 1, 1 alone, trial 0.1 mm",
           ("b", "-c1-alone-trial0.1", "30"): "1, 1, 1 alone, trial 0.1 mm"}
# Endings of the cases that differ from the plain one by round-off only.
PERTURBED = ["", "-auto", "-umfpack", *(f"-{way}{n}" for way in ("above", "below") for n in ("", "2", "3", "4"))]
PAPER_COST = {"-c0.1": "+150 %", "-c1": "+7 %", "-c1000": "-2 %", "-normal": "+3 %", "-tangential": "-8 %"}
SENSITIVITY = {"tolerance1e-4": "tolerance 1e-4", "tolerance1e-6": "tolerance 1e-6", "trial0.1": "trial 0.1 mm",
               "trial0.5": "trial 0.5 mm", "halved": "halved limits", "iterations10": "at most 10 iterations",
               "iterations100": "at most 100 iterations", "auto": "solver `auto`", "umfpack": "solver `umfpack`"}


class Rows(dict[str, Row]):
    """Rows of the table of results by their cases."""

    def __missing__(self, case: str) -> Row:
        raise Problem(f"results.csv: the case {case} is missing; `python3 -m bending_study run` runs the cases that "
                      "are not done")


class Results:
    """Table of results, and the runs it was made from."""

    def __init__(self, work: Path) -> None:
        self.work = work
        self.row = Rows((row["case"], row) for row in read_table(work / "results.csv"))
        self.run = cache(lambda case: Run(work / case))

    def number(self, case: str, column: str) -> float:
        """Return a value of the table."""
        return float(self.row[case][column])

    def travel(self, case: str) -> str:
        """Return the travel reached with one decimal; `-` if the case was not run."""
        return f"{self.number(case, 'travel'):.1f}" if case in self.row else "-"

    def finished(self, ending: str) -> list[str]:
        """Return the runs of mesh (b) with this ending that reached the end."""
        cases = [f"b-{p}{ending}" for p in PENALTIES]
        return [case for case in cases if self.number(case, "travel") > END - 1e-6]


def percent(value: float, base: float) -> str:
    """Return a change in per cent with its sign."""
    return f"{100 * (value / base - 1):+.0f} %"


def travel_table(results: Results, endings: Mapping[str, str], heading: str, meshes: Sequence[str] = MESHES) -> str:
    """Travel by mesh, variant and penalty."""
    rows = [[f"({mesh[0]}){' s = 0.5' if mesh == 'b05' else ''}", label,
             *(results.travel(f"{mesh}-{p}{ending}") for p in PENALTIES)]
            for mesh in meshes for ending, label in endings.items() if f"{mesh}-{PENALTIES[0]}{ending}" in results.row]
    return table(["mesh", heading] + [f"p = {p}" for p in PENALTIES], rows)


def travels(results: Results) -> str:
    """Travel reached, mm: Figs 3, 6 and 8."""
    return travel_table(results, FORCE, "c, d, e")


def alone(results: Results) -> str:
    """Travel reached with the limit on the contact forces alone, mm: Fig. 9."""
    return travel_table(results, ALONE, "force limit alone")


def eight(results: Results) -> str:
    """Travel reached with at most 8 iterations, mm."""
    return travel_table(results, MAX8, "force limit")


def variants(results: Results) -> str:
    """Travel reached in the variants, mm."""
    return travel_table(results, VARIANTS, "variant", ["a", "b", "b05"])


def scatter(results: Results) -> str:
    """Smallest and largest travel of the runs that differ by round-off only, mm."""
    def cell(case: str) -> str:
        names = [case + ending for ending in PERTURBED if case + ending in results.row]
        if len(names) < 2:
            return ""
        ends = [results.travel(end(names, key=lambda name: results.number(name, "travel"))) for end in (min, max)]
        return " - ".join(dict.fromkeys(ends))

    rows = [[f"({mesh})", label, iterations] + [cell(f"{mesh}-{p}{ending}") for p in PENALTIES]
            for (mesh, ending, iterations), label in SCATTER.items()]
    return table(["mesh", "c, d, e", "iterations at most"] + [f"p = {p}" for p in PENALTIES], rows)


def costs(results: Results) -> str:
    """Cost of the runs of mesh (b) that reached the end, relative to those without force control."""
    def mean(ending: str, column: str) -> float:
        cases = results.finished(ending)
        if not cases:
            raise Problem(f"results.csv: no run b-*{ending} reached {END:g} mm")
        return sum(results.number(case, column) for case in cases) / len(cases)

    columns = ["increments", "newton_iterations", "linear_iterations", "seconds"]
    base = {column: mean("", column) for column in columns}
    rows = [["off", str(len(results.finished(""))),
             *(f"{base[c]:.{1 if c == 'seconds' else 0}f}" for c in columns), ""]]
    for ending, paper in PAPER_COST.items():
        rows.append([FORCE[ending], str(len(results.finished(ending))),
                     *(percent(mean(ending, c), base[c]) for c in columns), paper])
    return table(["c, d, e", "runs", "increments", "Newton iterations", "linear iterations", "processor time, s",
                  "paper, CPU"], rows)


def cost_up_to(results: Results, case: str, end: float) -> tuple[int, int, float]:
    """Return increments, Newton iterations and processor time of a case up to a travel."""
    status = results.run(case).status
    before = [row for row in status if row["outcome"] == "accepted" and float(row["travel"]) <= end + 1e-6]
    part, whole = (sum(float(row["seconds"]) for row in rows) for rows in (before, status))
    total = totals(before)
    return total.increments, total.iterations, part / whole * results.number(case, "seconds")


def equal_travel(results: Results) -> str:
    """Cost of both meshes up to the travel where mesh (a) stops."""
    rows = []
    for p in PENALTIES:
        end = results.number(f"a-{p}", "travel")
        cells = [cost_up_to(results, f"{mesh}-{p}", end) for mesh in MESHES]
        rows.append([p, f"{end:.1f}"] + [f"{a} / {b}" for a, b in list(zip(*cells))[:2]]
                    + [f"{cells[0][2]:.2f} / {cells[1][2]:.2f}", f"{cells[0][2] / cells[1][2]:.2f}"])
    return table(["p", "up to, mm", "increments (a) / (b)", "Newton iterations (a) / (b)", "seconds (a) / (b)",
                  "ratio"], rows)


def control(results: Results) -> str:
    """Node that controls the limit on the contact forces, c = d = e = 1."""
    rows = []
    for ending, floor in (("-c1", "0.1"), ("-c1-floor0", "0")):
        for p in PENALTIES:
            pair = [results.row[f"{mesh}-{p}{ending}"] for mesh in MESHES]
            rows.append([floor, p, *(f"{float(r['B_median']):.3g}" for r in pair),
                         *(f"{float(r['flange']):.1f} %" for r in pair),
                         *(f"{float(r['percent_force']) + float(r['percent_r_min']):.0f} %" for r in pair)])
    return table(["floor", "p", "median B (a), N", "(b), N", "node in the flange (a)", "(b)", "increments it sets (a)",
                  "(b)"], rows)


def limiters(results: Results) -> str:
    """Limiters of the increments of the stroke, p = 1e3."""
    names = ["rotation", "strain", "stress", "force", "r_max", "r_min"]
    rows = [[f"({mesh})", label,
             *(f"{results.number(f'{mesh}-1e3{ending}', 'percent_' + name):.1f} %" for name in names)]
            for mesh in MESHES for ending, label in FORCE.items()]
    return table(["mesh", "c, d, e"] + [f"`{name}`" for name in names], rows)


def sensitivity(results: Results) -> str:
    """Effect of the numerical choices, p = 1e3, free edges."""
    rows = []
    for mesh in MESHES:
        base = f"{mesh}-1e3"
        for ending, label in {"": "as in Fig. 3", **SENSITIVITY}.items():
            case = f"{base}-{ending}" if ending else base
            cells = [f"({mesh})", label, f"{results.number(case, 'travel'):.2f}", results.row[case]["increments"],
                     results.row[case]["newton_iterations"], results.row[case]["linear_iterations"]]
            rows.append(cells + (difference(results, case, base) if ending else ["", ""]))
    return table(["mesh", "run", "reached, mm", "increments", "Newton iterations", "linear iterations",
                  "largest difference of the force", "median"], rows)


def compared(results: Results, case: str, base: str) -> list[tuple[float, float]]:
    """Return the sorted differences of the punch force at equal travel; none if a run ends before the first place."""
    pair = results.run(case), results.run(base)
    return sorted(differences(*pair)) if min(run.travel[-1] for run in pair) >= FIRST else []


def difference(results: Results, case: str, base: str) -> list[str]:
    """Return the largest and the median difference of the punch force at equal travel, as cells."""
    values = compared(results, case, base)
    if not values:
        return ["", ""]
    return [f"{values[-1][0]:.3f} % at {values[-1][1]:.1f} mm", f"{values[len(values) // 2][0]:.4f} %"]


def agreement(results: Results) -> str:
    """Dependence of the punch force on p and on the limits: against p = 1e4 without force control."""
    rows = []
    for mesh in MESHES:
        base = f"{mesh}-1e4"
        for ending, label in {**FORCE, "-c1-alone-trial0.1": "1, 1, 1 alone, trial 0.1 mm"}.items():
            found = [(*values[-1], p, values[len(values) // 2][0]) for p in PENALTIES if f"{mesh}-{p}{ending}" != base
                     and (values := compared(results, f"{mesh}-{p}{ending}", base))]
            worst = max(found)
            rows.append([f"({mesh})", label, f"{worst[0]:.2f} % (p = {worst[2]}, {worst[1]:.1f} mm)",
                         f"{max(median for *_, median in found):.3f} %"])
    return table(["mesh", "c, d, e", "largest difference", "largest of the medians"], rows)


def stops(results: Results) -> str:
    """Reasons why the runs without force control stopped."""
    rows = []
    for ending, label in (("", "30"), ("-max8", "8")):
        for mesh in MESHES:
            for p in PENALTIES:
                row = results.row[f"{mesh}-{p}{ending}"]
                if row["code"] != "0":
                    last = results.run(row["case"]).status[-1]
                    rows.append([label, f"({mesh})", p, f"{float(row['travel']):.2f}",
                                 ", ".join(last[key] for key in ("gap", "stick", "slip")), row["reason"]])
    return table(["iterations at most", "mesh", "p", "reached, mm", "gap, stick, slip", "reason"], rows)


TABLES = [travels, scatter, alone, eight, variants, costs, equal_travel, control, limiters, sensitivity, agreement,
          stops]


def write(work: Path, document: Path) -> None:
    """Print the tables, the number of runs and their time, and write those for which the document has a place."""
    results = Results(work)
    tables = {make.__name__: make(results) for make in TABLES}
    seconds = sum(float(row["seconds"]) for row in results.row.values())
    programs = sorted({row["program"] for row in results.row.values()})
    tables["size"] = (f"{len(results.row)} runs, {seconds:.0f} s of processor time together, by the program "
                      f"{', '.join(programs)} (the first digits of its SHA-256).")
    jobs = [read_job(work / case) for case in results.row]
    for name, content in tables.items():
        print(f"{name}\n\n{content}\n")
    for name in tables.keys() & places(document):
        put_table(document, name, tables[name], jobs)


def main(words: Sequence[str] | None = None) -> None:
    """Rewrite the tables of the document of the command line."""
    parser = new_parser("report", __doc__, "python3 -m bending_study")
    parser.add_argument("document", type=Path, help="document with places for the tables")
    parser.add_argument("--work", type=Path, default=Path("bending_study.out"), help="folder of all results")
    options = parser.parse_args(words)
    write(options.work, options.document)

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "verification", "timeout": 600}
#: {"name": "verification_slow", "arguments": ["--slow"], "labels": ["case", "slow"],
#:  "timeout": 3600, "cost": 300}
"""Run the cases of the verification manual, docs/verification.md, and compare them with values.md beside this file.

    run.py --program build/release/dd3imp --work build/verification              the quick sections
    run.py --program build/release/dd3imp --work build/verification --slow       all sections
    run.py --program build/release/dd3imp --work build/verification --slow --write

Every value must be within its tolerance of the expected one, and the same as in values.md: the computed values within
a fifth of their tolerance, those of the studies of refinement within 1 %. --write puts the sections that were run into
values.md, and with the largest errors and the pictures into the page. --only WORD runs the sections with this word in
their heading.

A section is an entry of SECTIONS in gathered.py, which gathers cases of tests/cases, or in the file case.py of a
folder here, beside its deck.
"""
import re
import sys

from frame import HERE, ROOT, STUDY_HEAD, VALUE_HEAD, Bench, Problem, load, study_rows

from dd3.programs import parser_of_runs

PAGE = ROOT / "docs" / "verification.md"
VALUES = HERE / "values.md"
PICTURES = ROOT / "docs" / "images" / "verification"
HEADING = re.compile(r"^## ", re.MULTILINE)
ELEMENTS = ["hex8", "solid_shell", "hex20", "hex27"]
ACCURATE = 0.02
BESIDE_HEAD = "Elements side by side"
START = """# Verification manual

Cases with a closed form, an independent computation or a published figure: expected value, computed value and error.
Expected values are computed by scripts that do not use the program.

    tests/verification/run.py --program build/release/dd3imp --work build/verification --slow --write

runs all cases and writes this page; without `--slow` the quick ones only, in about two minutes. A section shows the
value with the largest error, of its tolerance; all values and the meshes of the studies of refinement are in
`tests/verification/values.md`. The tests `verification` and `verification_slow` require that each error is within the
tolerance.

V3 is in unit tests, V26, V28 and V30 are reports ([square cup](reports/square_cup.md), [round
cup](reports/round_cup.md), [rail](reports/rail.md)).

The tests `case_bending_*` without a section here compare the bending test with the program's own runs, with halved
limits of the predictor or a finer mesh: no independent verification.

The times in the studies of refinement are those of one thread of a busy machine: compare within a picture.
"""
BESIDE = f"""Unknowns and seconds of the coarsest mesh of each element within {100 * ACCURATE:g} %, from the refinements
below; none if no mesh is within this error. `solid_shell` is best in the bending of sheets, `hex8` and the quadratic
elements in the plastic flow of thick bodies, the quadratic ones where the stress is smooth.
"""


def sections():
    """Return all sections in the order of the page."""
    found = []
    for file in [HERE / "gathered.py", *sorted(HERE.glob("*/case.py"))]:
        found += load(file).SECTIONS
    return sorted(found, key=lambda section: (int(re.match(r"V(\d+)", section.heading)[1]), section.slow))


def table(head, rows):
    """Return a table of the page."""
    lines = ["| " + " | ".join(row) + " |" for row in [head, *rows]]
    return "\n".join([lines[0], "|" + "---|" * len(head), *lines[1:]]) + "\n"


def tables_of(section, outcome):
    """Return the values and the study of a section in full."""
    parts = [f"## {section.heading}\n"]
    if outcome.values:
        parts.append(table(VALUE_HEAD, [value.row() for value in outcome.values]))
    if outcome.study:
        parts.append(table(STUDY_HEAD, study_rows(outcome.study)))
    return "\n".join(parts)


def of_tolerance(row):
    """Return the error of a row of values over its tolerance."""
    return abs(size(row[3]) / size(row[4]))


def render(section, outcome):
    """Return the text of a section."""
    parts = [f"## {section.heading}\n", section.text.strip() + "\n"]
    if outcome.values:
        quantity, *numbers = max((value.row() for value in outcome.values), key=of_tolerance)
        parts.append(f"*{quantity}*: " + ", ".join(map(" ".join, zip(VALUE_HEAD[1:], numbers))) + "\n")
    pictures = [name for name, _ in outcome.pictures] + ([section.picture] if section.picture else [])
    parts += [f"![{section.heading}](images/verification/{name})\n" for name in pictures]
    if section.after:
        parts.append(section.after.strip() + "\n")
    return "\n".join(parts)


def cells(text, head):
    """Return the rows of the tables with a head in a part of the page, as lists of cells."""
    rows, inside = [], False
    for line in text.splitlines():
        if line == "| " + " | ".join(head) + " |":
            inside = True
        elif not line.startswith("|"):
            inside = False
        elif inside and not line.startswith("|---"):
            rows.append([cell.strip() for cell in line.strip("|").split("|")])
    return rows


def size(cell):
    """Return a number of a table, per cent as a fraction."""
    return float(cell.removesuffix(" %")) / (100 if cell.endswith("%") else 1)


def comparison(parts):
    """Return the table of the coarsest meshes that are accurate enough, by case and element."""
    rows = []
    for heading, text in parts.items():
        study = [dict(zip(STUDY_HEAD, row)) for row in cells(text, STUDY_HEAD)]
        cheapest = []
        for element in ELEMENTS:
            good = [row for row in study if row["element"] == f"`{element}`" and abs(size(row["error"])) <= ACCURATE]
            cheapest.append(f"{good[0]['unknowns']}; {good[0]['seconds']} s" if good else "")
        if study:
            rows.append([heading.partition(":")[0], *cheapest])
    return table(["case", *(f"`{element}`" for element in ELEMENTS)], rows)


def old_parts(file):
    """Return the sections of a file by heading."""
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    return {part.split("\n", 1)[0]: "## " + part for part in HEADING.split(text)[1:]}


def differences(section, outcome, text):
    """Yield what is wrong with a section: errors beyond the tolerance, and other values in its text of values.md."""
    for value in outcome.values:
        if value.fails():
            yield f"{value.quantity}: {value.found:.9g}, expected {value.expected:.9g}, tolerance {value.row()[4]}"
    old = {row[0]: row for row in cells(text, VALUE_HEAD)}
    if list(old) != [value.quantity for value in outcome.values]:
        yield f"{VALUES.name} has other quantities"
    for value in outcome.values:
        if value.quantity in old:
            allowed = 0.2 * value.tolerance * (1 if value.absolute else abs(value.expected))
            if abs(size(old[value.quantity][2]) - value.found) > allowed + 1e-5 * abs(value.found):
                yield f"{value.quantity}: {value.found:.6g}, in {VALUES.name} {old[value.quantity][2]}"
    old = cells(text, STUDY_HEAD)
    for row, new in zip(old, study_rows(outcome.study)):
        if row[:3] != new[:3] or abs(size(row[4]) - size(new[4])) > 0.01 * abs(size(new[4])):
            yield f"{' '.join(new[:2])}: {new[4]}, in {VALUES.name} {' '.join(row[:2])}: {row[4]}"
    if len(old) != len(outcome.study):
        yield f"{len(outcome.study)} meshes, in {VALUES.name} {len(old)}"


def figure(name, painters):
    """Draw a picture of one or more axes side by side."""
    import matplotlib  # only here: the tests need no picture
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    PICTURES.mkdir(parents=True, exist_ok=True)
    drawing, axes = plt.subplots(1, len(painters), figsize=[6.4 if len(painters) == 1 else 9.0, 3.8], sharey=True,
                                 squeeze=False, layout="constrained")
    for paint, own in zip(painters, axes[0]):
        paint(own)
        own.grid(True, color="0.88", linewidth=0.7)
        own.spines[["top", "right"]].set_visible(False)
    drawing.savefig(PICTURES / name, dpi=90)
    plt.close(drawing)


def set_ticks(axis):
    """Label 1, 2 and 5, or 1 alone, of each decade of a logarithmic axis."""
    from matplotlib.ticker import LogLocator, NullFormatter
    low, high = axis.get_data_interval()
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 100 * low else (1.0,)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def draw_study(axes, rows, column):
    """Draw the error of the rows of a study over the unknowns or seconds, by element."""
    for element in dict.fromkeys(row[0] for row in rows):
        own = [row for row in rows if row[0] == element]
        axes.loglog([float(row[STUDY_HEAD.index(column)]) for row in own],
                    [100 * max(abs(size(row[STUDY_HEAD.index("error")])), 1e-7) for row in own], "o-", linewidth=1.4,
                    markersize=4, label=element.strip("`"))
    for axis in (axes.xaxis, axes.yaxis):
        set_ticks(axis)
    axes.set_xlabel(column)
    if column == "unknowns":
        axes.set_ylabel("error (%)")
        axes.legend(frameon=False)


def draw(section, text, outcome=None):
    """Draw the pictures of a section; its study from its text of values.md."""
    for name, paint in outcome.pictures if outcome else []:
        figure(name, [paint])
    rows = cells(text, STUDY_HEAD)
    if section.picture and rows:
        figure(section.picture, [lambda axes, column=column: draw_study(axes, rows, column)
                                 for column in ("unknowns", "seconds")])


def write(parts, values):
    """Write the page, from its sections, and all values."""
    VALUES.write_text("\n".join(values.values()), encoding="utf-8")
    start = [START, f"## {BESIDE_HEAD}\n", BESIDE, comparison(values)]
    PAGE.write_text("\n".join([*start, *parts.values()]), encoding="utf-8")


def main():
    """Run the sections; exit code 1 if one is wrong."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--slow", action="store_true", help="run all sections")
    parser.add_argument("--write", action="store_true", help="write the page and the pictures")
    parser.add_argument("--only", default="", help="a word of the headings of the sections to run")
    options = parser.parse_args()
    bench, wrong = Bench(options.program, options.work), []
    old, old_values, parts, values = old_parts(PAGE), old_parts(VALUES), {}, {}
    for section in sections():
        text = old_values.get(section.heading, "").rstrip("\n") + "\n"
        if options.only not in section.heading or section.slow and not options.slow:
            parts[section.heading] = old.get(section.heading, "").rstrip("\n") + "\n"
            values[section.heading] = text
            if options.write and options.slow:
                draw(section, text)
            continue
        try:
            outcome = section.produce(bench)
        except Problem as problem:
            sys.exit(f"{section.heading}: {problem}")
        parts[section.heading] = render(section, outcome)
        values[section.heading] = tables_of(section, outcome)
        print(values[section.heading], flush=True)
        if options.write:
            text = values[section.heading]
            draw(section, text, outcome)
        wrong += [f"{section.heading}: {line}" for line in differences(section, outcome, text)]
    if options.write:
        write(*({heading: text for heading, text in found.items() if text.strip()} for found in (parts, values)))
    elif not options.only and [heading for heading in old if heading != BESIDE_HEAD] != list(parts):
        wrong.append("the page has other sections")
    sys.exit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the operations of a part one after another: draw, trim, flange, springback.

    dd3 process part.toml
    dd3 process part.toml --report          and write one report of all operations

The file lists the input files in their order; a later one takes the sheet of an earlier one over by *START:

    title = "S-rail"
    [report]
    mirror = ["y"]
    [[tool]]
    source = "die.step"
    toward = [0, 0, 1]
    [[operation]]
    deck = "op10.dat"
    set = { depth = 37 }
    [[operation]]
    deck = "op20.dat"

Paths belong to the folder of the file that names them. A [[tool]] makes die.bez as `dd3 tool` does, with the same
options as keys. Results of op10.dat go to op10.out beside it. A tool is not made again, and an operation that has ended
not repeated, unless a file that it reads has changed, the sheet that it starts from included; an operation that was
interrupted continues. The input files are checked before the first run.
"""
import argparse
import hashlib
import html
import json
import re
import tempfile
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dd3 import process_tools, verdict
from dd3 import report as pages
from dd3.command import new_parser
from dd3.errors import LOG, Problem, Stopped
from dd3.programs import add_program, command, find_program, launch, made_folder
from dd3.run import effort_of, files_of, read_job, state_of, warnings_of
from dd3.tools.settings import ToolSettings

STAMP = "operation.json"  # in the folder of an operation: what it has read
KEYS: dict[str, type[Any]] = {"title": str, "report": dict, "tool": list, "operation": list}
OPERATION_KEYS: dict[str, type[Any]] = {"deck": str, "name": str, "set": dict}
REPORT_KEYS: dict[str, type[Any]] = {"mirror": list, "section": list}
STOPPED = 3  # exit code of a run that cannot go on
LATER = "E152"  # code of the error of a sheet that is not there yet


@dataclass
class Operation:
    """A run of the process: its input file, parameters, and folder of results."""

    name: str
    deck: Path
    settings: dict[str, object] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """The folder of the results."""
        return self.deck.parent / f"{self.name}.out"


@dataclass
class Process:
    """The operations of a part, the options of their reports, and the tools to make before them."""

    path: Path
    title: str
    operations: list[Operation]
    report: dict[str, list[str]]
    tools: list[ToolSettings] = field(default_factory=list)


def refuse(path: Path, table: Any, keys: Mapping[str, type[Any]], where: str) -> None:
    """Refuse what is no table, keys that are not known and values of another type."""
    if not isinstance(table, dict):
        raise Problem(f"{path}: error: {table!r}{where}; expected a table of keys and values")
    for key, value in table.items():
        if key not in keys:
            raise Problem(f"{path}: error: unknown key '{key}'{where}; expected one of: {' '.join(keys)}")
        if not (isinstance(value, keys[key]) or (keys[key] is float and type(value) is int)):
            raise Problem(f"{path}: error: {key}{where} is a {type(value).__name__}; expected a {keys[key].__name__}")


def read_process(path: Path) -> Process:
    """Read the file of a process."""
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Problem(f"{path}: error: {error}") from None
    refuse(path, table, KEYS, "")
    refuse(path, table.get("report", {}), REPORT_KEYS, " of [report]")
    for number, row in enumerate(table.get("tool", []), 1):
        refuse(path, row, process_tools.KEYS, f" of tool {number}")
    operations: list[Operation] = []
    for number, row in enumerate(table.get("operation", []), 1):
        where = f" of operation {number}"
        refuse(path, row, OPERATION_KEYS, where)
        if "deck" not in row:
            raise Problem(f"{path}: error: operation {number} has no deck")
        deck = path.parent / row["deck"]
        if not deck.is_file():
            raise Problem(f"{path}: error: the deck '{row['deck']}'{where} does not exist")
        operations.append(Operation(row.get("name", deck.stem), deck.resolve(), row.get("set", {})))
        if len({operation.name for operation in operations}) < number:
            raise Problem(f"{path}: error: two operations are named '{operations[-1].name}'; give one another name")
    if not operations:
        raise Problem(f"{path}: error: no [[operation]]")
    return Process(path, table.get("title", path.stem), operations, table.get("report", {}),
                   process_tools.read_tools(path, table.get("tool", [])))


def check_deck(program: Path, operation: Operation) -> tuple[dict[str, Any], str]:
    """Return the description of the run of a deck, empty if it has errors, and these."""
    with tempfile.TemporaryDirectory() as folder:
        done = launch(command(program, operation.deck, None, ["--quiet", "--check", "--initial", folder],
                              operation.settings))
        if done.code == 0:
            return read_job(Path(folder)), ""
        if done.code != 2:
            raise Problem(f"{operation.deck}: exit code {done.code}\n{done.errors}")
        return {}, done.errors.strip()


def digests(job: dict[str, Any], settings: dict[str, object]) -> dict[str, str]:
    """Return the check sums of what a run depends on."""
    sums = {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files_of(job)}
    return {**sums, "settings": json.dumps(settings, sort_keys=True), "version": job["program"]["version"]}


def run_operation(program: Path, operation: Operation, threads: int | None = None) -> bool:
    """Run an operation unless it has ended with the same input; return whether it was run."""
    job, errors = check_deck(program, operation)
    if errors:
        raise Problem(errors)
    now = digests(job, operation.settings)
    stamp = operation.folder / STAMP
    same = stamp.is_file() and json.loads(stamp.read_text(encoding="utf-8")) == now
    if same and state_of(operation.folder) == "reached":
        return False
    made_folder(operation.folder)
    restart = operation.folder / "restart.h5"
    options: list[object] = ["--quiet", *(["--threads", threads] if threads else [])]
    going_on = ["--restart", restart] if same and restart.is_file() else []
    stamp.write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")
    done = launch(command(program, operation.deck, operation.folder, [*options, *going_on], operation.settings),
                  one_core=False)
    if done.code == 2 and going_on:  # the restart file is that of another model
        done = launch(command(program, operation.deck, operation.folder, options, operation.settings), one_core=False)
    if done.code != 0:
        raise (Stopped if done.code == STOPPED else Problem)(
            f"{operation.name}: {done.errors.strip() or f'exit code {done.code}'}")
    return True


def check_all(program: Path, process: Process) -> None:
    """Report the errors of all input files at once; a sheet that an earlier operation will leave is no error."""
    found = []
    for operation in process.operations:
        _, errors = check_deck(program, operation)
        codes = set(re.findall(r": error (E\d+):", errors))
        if errors and codes != {LATER}:
            found.append(errors)
    if found:
        raise Problem("\n".join(found))


def run_process(program: Path, process: Process, threads: int | None = None) -> None:
    """Make the tools and run all operations."""
    process_tools.make_tools(process.tools)
    check_all(program, process)
    for operation in process.operations:
        again = run_operation(program, operation, threads)
        job = read_job(operation.folder)
        increments, seconds = effort_of(job)
        LOG.info(f"{operation.name}: {'reached its end' if again else 'has ended before'}, "
              f"{increments} increments, {seconds:.4g} s, {len(warnings_of(job))} warnings; "
              f"results in {operation.folder}")


def run_with(program: Path, process: Process, operations: Sequence[Operation], settings: Mapping[str, object],
             threads: int | None = None) -> Problem | None:
    """Run all operations, some of them with other settings; return what stopped them, if anything did."""
    for operation in operations:
        operation.settings.update(settings)
    try:
        run_process(program, process, threads)
    except Problem as problem:
        return problem
    return None


def write_report(process: Process) -> Path:
    """Write the page of each operation, and one that leads to them."""
    target = made_folder(process.path.parent / f"{process.path.stem}.report")
    rows = []
    for operation in process.operations:
        page = pages.make(operation.folder, output=target / operation.name, mirror=process.report.get("mirror", []),
                          section=[str(plane) for plane in process.report.get("section", [])])
        job, thinning = page.job, page.field("thinning")
        draw, (increments, seconds) = page.field("equivalent_plastic_strain"), effort_of(job)
        largest = max((abs(page.column(f"{tool}_fz")).max() * page.whole / 1000 for tool in page.tools), default=0.0)
        rows.append((f'<a href="{operation.name}/report.html">{html.escape(operation.name)}</a>',
                     html.escape(" ".join(job["title"].split())), html.escape(job["outcome"]["state"]),
                     job["sheet"]["elements"], f"{largest:.4g}", f"{100 * thinning.max():.3g}", f"{draw.max():.3g}",
                     increments, len(warnings_of(job)), f"{seconds:.4g}",
                     html.escape(verdict.summary(page.verdict))))
    head = ("operation", "title", "state", "elements", "largest force along z, kN", "largest thinning, %",
            "plastic strain", "increments", "warnings", "seconds", "verdict")
    lines = ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    path = target / "report.html"
    title = html.escape(process.title)
    path.write_text(
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{pages.STYLE}</style></head><body><main>\n<h1>{title}</h1><section><table>\n<tr>"
        + "".join(f"<th>{name}</th>" for name in head) + "</tr>\n" + "\n".join(lines)
        + "\n</table></section>\n</main></body></html>\n", encoding="utf-8")
    return path


def process_parser(name: str, text: str | None) -> argparse.ArgumentParser:
    """Return the parser of a command that runs a process."""
    parser = new_parser(name, text)
    parser.add_argument("file", type=Path, metavar="FILE", help="file of the process, .toml")
    add_program(parser)
    parser.add_argument("--threads", type=int, help="threads of a run (default: all cores)")
    parser.add_argument("--report", action="store_true", help="write one report of all operations")
    return parser


def write_deviations(path: Path, names: str, found: Sequence[Sequence[float]], first: int) -> None:
    """Write a table of deviations by the number of the loop, from `first` on."""
    rows = [names, *(",".join([str(number), *(f"{value:.6g}" for value in row)])
                     for number, row in enumerate(found, first))]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def main(words: Sequence[str] | None = None) -> None:
    """Run the process of the command line."""
    parser = process_parser("process", __doc__)
    options = parser.parse_args(words)
    process = read_process(options.file)
    run_process(find_program(options.program), process, options.threads)
    if options.report:
        print(write_report(process))

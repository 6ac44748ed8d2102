#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare contact settings with stored reference values on a list of forming problems: the envelope of the contact.

    tests/benchmark/envelope.py --program build/release/dd3imp --work build/envelope
    tests/benchmark/envelope.py ... --label soft --contact "formulation = compliant; layer = 0.01" --problems squeeze
    tests/benchmark/envelope.py ... --label fine --limits "depth = 0.0025; rotation = 1" --problems squeeze --store
    tests/benchmark/envelope.py --work build/envelope --compare mixed soft --ablation

--contact, --limits and --newton give lines of the blocks *CONTACT, *LIMITS and *NEWTON; they replace those of the same
keys in the decks. Each run is kept in the folder of its label and problem, and not repeated without --again. A run that
takes more than --seconds of processor time is ended. The deviations are those from --reference; --store puts the values
of the runs that reached their end into it. The stored ones are of the augmented Lagrangian with increments of a half
to an eighth of the default size. Deviations beyond 2 % are bold. The problems are ordered by time, cheap ones first.
"""
import argparse
import concurrent.futures
import functools
import importlib
import json
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field

import numpy as np
import peer
import problems
from problems import CASES, ROOT, merged, of_file, with_paths, without

from dd3.errors import Problem, run
from dd3.fields import Fields
from dd3.pages import put_table
from dd3.programs import command, find_program, made_folder
from dd3.run import read_job
from dd3.tables import interpolate, is_whole, number, read_table, tools_in, totals

sys.path.append(str(ROOT / "tests" / "forming"))
round_cup, round_cup_aa6016, square_cup, studies = map(
    importlib.import_module, ("round_cup", "round_cup_aa6016", "square_cup", "studies"))

REFERENCE = pathlib.Path(__file__).with_name("envelope_reference.json")
REPORT = ROOT / "docs" / "reports" / "contact.md"
ABLATION = ROOT / "docs" / "reports" / "ablation.md"
KEYWORDS = ("contact", "limits", "newton")  # options that change blocks of the decks
ALLOWED = 2.0  # deviation of a quantity, %
EFFORT = ["end", "increments", "cut-backs", "iterations", "per increment", "processor time, s", "depth, thicknesses"]
DRAW_BENDING = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
DEAD_LOAD = 1.0  # of the capstan, N
STEP = 0.02  # interval of the travels at which a force is averaged, mm


# ---- results of a run ------------------------------------------------------------------------------------------------

class Results:
    """Results of a run, and of the values that it has not reached None."""

    def __init__(self, folder):
        self.folder = folder
        self.history, self.status = ([row for row in read_table(path) if is_whole(row)] if path.is_file() else []
                                     for path in (folder / "history.csv", folder / "status.csv"))

    @functools.cached_property
    def fields(self):
        """Return the fields."""
        return Fields(self.folder)

    def column(self, name):
        """Return a column of the history."""
        return [number(row, name, self.folder / "history.csv") for row in self.history]

    def at(self, name, travel):
        """Return a value of the history at a travel, mm."""
        return interpolate(self.column("travel"), self.column(name), travel)

    def resampled(self, name, first, last):
        """Return travels at equal intervals, mm, and values of the history there, or None if the last is not reached.

        The history is linear between two increments.
        """
        if self.at(name, last) is None:
            return None
        places = np.linspace(first, last, round((last - first)/STEP) + 1)
        return places, np.interp(places, self.column("travel"), self.column(name))

    def mean(self, name, first, last):
        """Return the mean of a value of the history between two travels, mm."""
        found = self.resampled(name, first, last)
        return float(np.mean(found[1])) if found else None

    def end(self, name, phase):
        """Return a value of the history at the end of a phase."""
        rows = [row for row in self.history if row["phase"] == phase and float(row["progress"]) > 1 - 1e-9]
        return number(rows[-1], name, self.folder / "history.csv") if rows else None

    def has(self, travel):
        """Check whether the fields have a step at a travel, mm."""
        return bool(np.any(np.abs(self.fields.travel - travel) < 1e-6))

    def thickness(self, travel, extreme):
        """Return the smallest (min) or largest (max) thickness at a travel, mm."""
        if not self.has(travel):
            return None
        return float(extreme(self.fields.values(self.fields.nearest_step(travel), "thickness")[0]))

    def depth(self):
        """Return the largest depth of a tool, mm."""
        names = [f"{tool}_depth" for tool in tools_in(self.history[0]) if f"{tool}_depth" in self.history[0]]
        return max(max(self.column(name)) for name in names) if names else None


def forces(tool, *travels):
    """Return the forces of a tool at travels."""
    return {f"{tool} force at {travel:g} mm, N": lambda found, at=travel: found.at(f"{tool}_fz", at)
            for travel in travels}


def mean_forces(tool, half, *travels):
    """Return the means of the force of a tool around travels: single ones depend on the nodes that are in contact."""
    return {f"{tool} force, mean of {travel - half:g} to {travel + half:g} mm, N":
            lambda found, at=travel: found.mean(f"{tool}_fz", at - half, at + half) for travel in travels}


def thinnest(travel):
    """Return the smallest thickness at a travel."""
    return {f"smallest thickness at {travel:g} mm, mm": lambda found: found.thickness(travel, np.min)}


def draw_in(across, travel):
    """Return the draw-in of the square cup at a travel."""
    def value(found, place):
        if not found.has(travel):
            return None
        return float(square_cup.Cup(found.folder, across, 1).draw_in(travel)[place])
    return {f"{name} at {travel:g} mm, mm": lambda found, place=place: value(found, place)
            for place, name in enumerate(("DX", "DY", "DD"))}


def square_cup_quantities(across, travels, *places):
    """Return the quantities of a square cup: forces at travels; draw-in at places, the last with the thickness."""
    found = forces("punch", *travels)
    for place in places:
        found |= draw_in(across, place)
    return found | thinnest(places[-1])


def rim(found):
    """Return the mean height of the rim of the round cup at its end, mm."""
    if not found.has(48.0):
        return None
    cup = round_cup.Cup(found.folder, round_cup_aa6016.BLANK)
    return float(np.mean(cup.heights))


def roughness(first, last, half):
    """Return the quantity of the punch force: root mean square about local cubic polynomials over its mean, %."""
    def value(found):
        curve = found.resampled("punch_fz", first, last)
        if not curve:
            return None
        places, force = curve
        rest = []
        for place, here in zip(places, force, strict=True):
            near = np.abs(places - place) < half
            rest.append(here - np.polyfit(places[near] - place, force[near], 3)[-1])
        return float(100*np.sqrt(np.mean(np.square(rest)))/np.mean(force))
    return {"roughness of the punch force, %": value}


def tension_ratio(found):
    """Return the ratio of the tensions of the capstan."""
    reaction = found.end("left_rx", "pull")
    return -DEAD_LOAD/reaction if reaction else None


def tension_error(found):
    """Return the deviation of the ratio of the tensions from exp(mu theta), %."""
    ratio = tension_ratio(found)
    return 100*(ratio/math.exp(0.144*math.pi/2) - 1) if ratio else None


# ---- problems --------------------------------------------------------------------------------------------------------

@dataclass
class Job:
    """A problem: function of a folder that returns its deck, thickness (mm), quantities and parameters of --set.

    Of the quantities in `notes` no deviation is given.
    """

    deck: object
    thickness: float
    quantities: dict
    settings: dict = field(default_factory=dict)
    notes: dict = field(default_factory=dict)


def first_contact(folder):
    """Return the case first_contact with default settings."""
    return without(of_file(CASES / "first_contact" / "case.dat")(folder), "LIMITS", "NEWTON",
                   "CONTACT").replace("*PHASE", "*CONTACT\n*PHASE")


def u_bend(folder):
    """Return the strip of peer.py."""
    deck = peer.write_deck(argparse.Namespace(work=folder, columns=160, friction=0.0))
    return with_paths(deck.read_text(encoding="utf-8"), folder)


def air_bending(folder):
    """Return the air bending with default settings."""
    return with_paths(problems.air_bending(folder), folder).replace("*PHASE", "*CONTACT\n*PHASE")


def draw_bending(_):
    """Return the deck of draw bending without springback."""
    text = of_file(DRAW_BENDING)(None).split("*PHASE springback")[0]
    return text + "*SET end\n  near = 175 0 0\n*HISTORY end\n  set = end\n  quantities = draw_in\n"


def squeeze(friction):
    """Return the problem of a sheet between two flat tools with a friction."""
    return Job(of_file(CASES / "squeeze_solid_shell" / "case.dat"), 1.0, forces("ram", 0.2, 0.4),
               {"friction": friction})


def strip(columns, force):
    """Return the problem of draw bending with elements along the half strip and a force of the holder, N/mm."""
    quantities = {**mean_forces("punch", 12.5, 17.5), "draw-in at 30 mm, mm":
                  lambda found: found.at("end_draw_in", 30), **thinnest(30)}
    return Job(draw_bending, 0.78, quantities,
               {"divisions": f"{columns} 1 1", "points": 5, "holder": -force, "depth": 30}, roughness(5, 30, 3))


def steel_cup(across, points, depth, travels, *places):
    """Return the problem of the square cup of steel."""
    return Job(of_file(square_cup.DECK), 0.78, square_cup_quantities(across, travels, *places),
               {"divisions": f"{across} {across} 1", "levels": 0, "points": points, "depth": depth})


HELD = {"holder force at the end of squeeze, N": lambda found: found.end("holder_fz", "squeeze"),
        "die force at the end of squeeze, N": lambda found: found.end("die_fz", "squeeze"),
        "holder force at the end of hold, N": lambda found: found.end("holder_fz", "hold")}
ROUND = {**forces("punch", 5, 10, 20), **mean_forces("punch", 2, 30, 35, 40, 44, 46), "mean height of the rim, mm": rim,
         **thinnest(48), "largest thickness at 48 mm, mm": lambda found: found.thickness(48, np.max)}
ENVELOPE = {
    "holder_gap": Job(of_file(CASES / "holder_gap" / "case.dat"), 0.78, HELD),
    "coining": Job(problems.coining, 1.0, forces("ram", 0.005, 0.01)),
    "squeeze": squeeze(0),
    "squeeze_friction": squeeze(0.05),
    "first_contact": Job(first_contact, 0.78, {**forces("punch", 6, 7, 8), "force of the support, N":
                                               lambda found: found.end("end_rz", "draw")}),
    "flat_punch": Job(of_file(CASES / "flat_punch" / "case.dat"), 0.78, forces("punch", 1)),
    "air_bending": Job(air_bending, 1.0, forces("punch", 5, 10, 15, 20, 25)),
    "capstan": Job(of_file(CASES / "capstan" / "case.dat"), 0.02, {"T1/T2": tension_ratio},
                   notes={"T1/T2, error, %": tension_error}),
    "u_bend": Job(u_bend, 1.0, mean_forces("punch", 1, 2, 4, 6, 8), notes=roughness(1, 9, 1)),
    "strip_19.6kN_2mm": strip(88, 280),
    "strip_19.6kN_1mm": strip(175, 280),
    "strip_2.45kN_2mm": strip(88, 35),
    "strip_2.45kN_1mm": strip(175, 35),
    "aluminium_15": Job(of_file(square_cup.ALUMINIUM), 0.81, square_cup_quantities(15, (5, 10, 20), 20),
                        {"divisions": "15 15 1", "levels": 0, "points": 5, "depth": 20}),
    "steel_15": steel_cup(15, 5, 40, (3, 5, 10, 20, 40), 20, 40),
    "round_cup": Job(of_file(round_cup_aa6016.DECK), 1.0, ROUND, {"divisions": "8 16 1", "levels": 0}),
    "steel_60": steel_cup(60, 3, 4, (1, 2, 3, 4), 4),
    "steel_30": steel_cup(30, 3, 40, (3, 5, 10, 20, 40), 20, 40),
}
LAYERS = ("formulation = mixed", *(f"layer = {height:g}" for height in (0.005, 0.01, 0.02, 0.04)))
# Problems and quantities of the table of the layers: heading of the problem, and of the quantities.
LAYERED = {"strip_2.45kN_1mm": ("strip", {"punch force, mean of 5 to 30 mm, N": "mean force, N",
                                          "roughness of the punch force, %": "roughness, %"}),
           "steel_30": ("cup", {"punch force at 5 mm, N": "force at 5 mm, N", "punch force at 40 mm, N":
                                "at 40 mm, N"}),
           "round_cup": ("round cup", {"punch force, mean of 42 to 46 mm, N": "mean force of 42 to 46 mm, N"})}


# ---- runs ------------------------------------------------------------------------------------------------------------

def lines_of(text):
    """Return the lines of an option: `key = value; key = value`."""
    lines = [line.strip() for line in text.split(";") if line.strip()]
    if any("=" not in line for line in lines):
        raise Problem(f"{text}: expected key = value; key = value")
    return lines


def execute(words, limit):
    """Run a command; return its exit code (None after the limit, s), processor time, s, and errors."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment) as child:
        late, began, used = False, time.monotonic(), 0.0
        while child.poll() is None:
            time.sleep(0.05)
            used = processor_time(child.pid) or used
            if used > limit and not late:
                late, began = True, time.monotonic()
                child.send_signal(signal.SIGTERM)
            if late and time.monotonic() - began > 60:
                child.kill()
        errors = child.stderr.read().decode("utf-8", errors="replace")
    return None if late else child.returncode, used, errors


def processor_time(pid):
    """Return the processor time of a process, s; 0 if it has ended."""
    try:
        words = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def make(options, job, folder, blocks):
    """Make a run in a folder, with lines of blocks of its deck by their keyword, unless it is there."""
    folder.mkdir(parents=True, exist_ok=True)
    text = job.deck(folder)
    for keyword, lines in blocks.items():
        text = merged(text, keyword.upper(), lines_of(lines))
    deck, record = folder / "deck.dat", folder / "done.json"
    if record.is_file() and not options.again:
        if deck.read_text(encoding="utf-8") != text:
            raise Problem(f"{folder}: has a run with other settings; --again repeats it, --label gives another folder")
        return
    deck.write_text(text, encoding="utf-8")
    record.unlink(missing_ok=True)
    shutil.rmtree(folder / "results", ignore_errors=True)
    words = command(options.program, deck, folder / "results", ["--quiet", "--threads", 1],
                    job.settings)
    code, seconds, errors = execute(words, options.seconds)
    if code in (1, 2):
        raise Problem(f"{deck}: exit code {code}: {errors}")
    record.write_text(json.dumps({"code": code, "seconds": seconds, "errors": errors}, indent=2), encoding="utf-8")


def end_text(code, last, deck):
    """Return how a run ended."""
    phases = re.findall(r"^\*PHASE (\w+)", deck.read_text(encoding="utf-8"), re.MULTILINE)
    if code == 0:
        return "reached"
    place = f"{phases[int(last['phase']) - 1] if last['phase'].isdigit() else last['phase']} " \
            f"{100 * float(last['progress']):.0f} %"
    return ("limit of time in " if code is None else "stopped in ") + place


@dataclass
class Measured:
    """What a table shows of a run: columns EFFORT, values of the quantities and of the notes, whether it ended."""

    effort: list
    values: dict
    notes: dict
    reached: bool


def measure(folder, job):
    """Return what a table shows of a run, None if it is not there."""
    if not (folder / "done.json").is_file():
        return None
    record = json.loads((folder / "done.json").read_text(encoding="utf-8"))
    found = Results(folder / "results")
    total, depth, end = totals(found.status), None, "no increment"
    if found.history:
        depth, end = found.depth(), end_text(record["code"], found.history[-1], folder / "deck.dat")
        if record["code"] != 0:
            end += f", {float(found.history[-1]['travel']):.3g} mm"
    if record["code"] not in (0, 3, None):
        end = f"exit code {record['code']}: {end}"
    effort = [end, str(total.increments), str(total.cutbacks), str(total.iterations),
              f"{total.iterations/max(total.increments, 1):.1f}", f"{record['seconds']:.1f}",
              "" if depth is None else f"{depth/job.thickness:.2g}"]
    values, notes = ({label: quantity(found) if found.history else None for label, quantity in quantities.items()}
                     for quantities in (job.quantities, job.notes))
    return Measured(effort, values, notes, record["code"] == 0)


# ---- tables ----------------------------------------------------------------------------------------------------------

def deviation(value, reference):
    """Return the deviation of a value from its reference, %; None without one of them."""
    return 100*(value/reference - 1) if value is not None and reference else None


def worst(measured, reference):
    """Return the largest deviation of a run and the quantity that has it."""
    found = [(abs(apart), apart, label) for label, value in measured.values.items()
             if (apart := deviation(value, reference.get(label))) is not None]
    return f"{max(found)[1]:+.2f} ({max(found)[2]})" if found else ""


def shown(value, form="{:.5g}"):
    """Return a number as a text, empty for None."""
    return "" if value is None else form.format(value)


def values_of(references, name):
    """Return the reference values of a problem."""
    return references.get(name, {}).get("values", {})


def tables(measured, references):
    """Return the tables of runs by problem and label: that of the effort of each run, and that of each quantity."""
    labels = list(dict.fromkeys(label for runs in measured.values() for label in runs))
    effort, quantities = [], []
    for name, runs in measured.items():
        reference = values_of(references, name)
        effort += [[name, label, *run.effort, worst(run, reference)] for label, run in runs.items()]
        job = ENVELOPE[name]
        for quantity in job.quantities:
            row = [name, quantity, shown(reference.get(quantity))]
            for label in labels:
                value = runs[label].values[quantity] if label in runs else None
                apart = deviation(value, reference.get(quantity))
                row += [shown(value), shown(apart, "**{:+.2f}**" if abs(apart or 0) > ALLOWED else "{:+.2f}")]
            quantities.append(row)
        for note in job.notes:
            quantities.append([name, note, ""] + [cell for label in labels for cell in
                                                  (shown(runs[label].notes[note]) if label in runs else "", "")])
    heads = [cell for label in labels for cell in (label, "deviation, %")]
    return (studies.table(["problem", "label", *EFFORT, "largest deviation, %"], effort),
            studies.table(["problem", "quantity", "reference", *heads], quantities))


def ablation(measured, labels):
    """Return the table of increments, cut-backs and iterations by problem and label."""
    rows = []
    for name, runs in measured.items():
        found = (runs.get(label) for label in labels)
        rows.append([name, *("" if run is None else ", ".join(run.effort[1:4]) + ("" if run.reached else " (stopped)")
                             for run in found)])
    return studies.table(["problem", *labels], rows)


def layers(options):
    """Make the runs of LAYERS; return their table and their run.json."""
    head, rows, jobs = ["`*CONTACT`"], [], []
    for title, quantities in LAYERED.values():
        head += [f"{title}: iterations", *quantities.values()]
    for contact in LAYERS:
        row = [f"`{contact}`"]
        for name, (_, quantities) in LAYERED.items():
            folder = options.work / re.sub(r"[^\w.]+", "_", contact) / name
            make(options, ENVELOPE[name], folder, {"contact": contact})
            found = measure(folder, ENVELOPE[name])
            values = found.values | found.notes
            row += [found.effort[3] + ("" if found.reached else " (stopped)"),
                    *(shown(values[quantity]) for quantity in quantities)]
            jobs.append(read_job(folder / "results"))
        rows.append(row)
        print(*row, sep=" | ", file=sys.stderr, flush=True)
    return studies.table(head, rows), jobs


def store(options, measured):
    """Put the values of the runs that have reached their end, and their settings, into the file of the reference."""
    path, label = options.reference, options.label
    references = read_references(path)
    settings = {keyword: text for keyword in KEYWORDS if (text := getattr(options, keyword))}
    for name, runs in measured.items():
        if runs[label].reached:
            references[name] = {"label": label, **settings, "values": runs[label].values}
        else:
            print(f"{name}: not stored, has not reached its end", file=sys.stderr)
    ordered = {name: references[name] for name in ENVELOPE if name in references}
    path.write_text(json.dumps(ordered, indent=2) + "\n", encoding="utf-8")
    return ordered


def read_references(path):
    """Return the reference values, none without the file."""
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def parser():
    """Return the parser of the command line."""
    found = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--program", type=find_program, help="the program dd3imp; not needed with --compare")
    found.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    found.add_argument("--problems", nargs="+", choices=ENVELOPE, default=list(ENVELOPE), metavar="NAME",
                       help=f"problems (all): {', '.join(ENVELOPE)}")
    for keyword in KEYWORDS:
        found.add_argument(f"--{keyword}", default="", metavar="LINES",
                           help=f"lines of *{keyword.upper()}, separated by semicolons")
    found.add_argument("--label", default="mixed", help="name of these settings (mixed)")
    found.add_argument("--compare", nargs="+", metavar="LABEL", help="run nothing; print the runs of these labels")
    found.add_argument("--reference", type=pathlib.Path, default=REFERENCE, help="file of the reference values")
    found.add_argument("--store", action="store_true", help="put the values of the runs into the reference")
    found.add_argument("--write", action="store_true", help="put the table of the effort into docs/reports/contact.md")
    found.add_argument("--ablation", action="store_true",
                       help="put the effort of the labels of --compare into docs/reports/ablation.md")
    found.add_argument("--layers", action="store_true",
                       help="only compare heights of the contact layer, with --write in docs/reports/contact.md")
    found.add_argument("--again", action="store_true", help="repeat runs that are there")
    found.add_argument("--seconds", type=float, default=1800.0, help="processor time of a run, s (1800)")
    found.add_argument("--jobs", type=int, default=1, help="runs at a time (1)")
    return found


def main():
    """Make the runs and print their tables."""
    options = parser().parse_args()
    options.work = options.work.resolve()
    labels = options.compare or [options.label]
    blocks = {keyword: getattr(options, keyword) for keyword in KEYWORDS}
    if not options.compare and not options.program:
        raise Problem("expected --program or --compare")
    if options.layers:
        text, jobs = layers(options)
        print(text)
        if options.write:
            put_table(REPORT, "layers", text, jobs)
        return
    if not options.compare:
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            made = pool.map(lambda name: make(options, ENVELOPE[name], options.work / options.label / name, blocks),
                            options.problems)
            for name, _ in zip(options.problems, made, strict=True):
                found = measure(options.work / options.label / name, ENVELOPE[name])
                print(name, *found.effort, sep=" | ", file=sys.stderr, flush=True)
    measured = {name: {label: found for label in labels if (found := measure(options.work / label / name,
                                                                                      ENVELOPE[name]))}
                for name in options.problems}
    measured = {name: runs for name, runs in measured.items() if runs}
    references = read_references(options.reference)
    if options.store and not options.compare:
        references = store(options, measured)
    effort, quantities = tables(measured, references)
    print(effort, quantities, sep="\n\n")
    jobs = [read_job(options.work / label / name / "results") for name, runs in measured.items() for label in runs]
    if options.write:
        put_table(REPORT, "envelope", effort, jobs)
    if options.ablation:
        put_table(ABLATION, "ablation", ablation(measured, labels), jobs)


if __name__ == "__main__":
    run(main)

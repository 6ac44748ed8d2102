#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""Conical cups drawn without a holder: wrinkles on a mesh that is refined in the run beside its uniform subdivision.

    conical_cup.py --program build/release/dd3imp --work build/conical_cup            make the runs that are missing
    conical_cup.py --program build/release/dd3imp --work build/conical_cup --write    and put the table into docs/reports

The blank has a waviness of random amplitudes, a tenth of its thickness at the rim, which wrinkles grow from: linear
within the elements of the coarse blank, so that both meshes begin with the same shape.
"""
import json
import subprocess
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import studies
from scipy.interpolate import LinearNDInterpolator

from dd3.errors import run
from dd3.fields import Fields
from dd3.mesh import Mesh, read_run, write_inp
from dd3.pages import put_table, table
from dd3.programs import command, launch
from dd3.run import read_job
from dd3.tables import read_table, totals

REPORT = studies.ROOT / "docs" / "reports" / "adaptive.md"
MATERIAL = studies.ROOT / "input_files" / "materials" / "mild_steel_numisheet93.dat"
THICKNESS, LEVELS = 0.8, 2  # mm
LOBES = range(2, 17)  # of the waviness
WAVINESS = np.random.default_rng(1).uniform(-1, 1, len(LOBES))
AMPLITUDE = 0.05  # of a coefficient of 1 at the rim, mm
MOST_LOBES = 24  # that are looked for
RING = 0.97  # radius in the blank on which wrinkles are measured, over that of the blank
ONSET = 0.5  # root mean square of the height on the ring that is a wrinkle, in thicknesses
REFINED, UNIFORM = "refined", "uniform"
TOOLS = {"die": "start = {foot} -{depth}\n  corner = {opening} 0 6\n  line = {end} 0\n  revolve = -100 100",
         "punch": "start = {top} {height}\n  corner = {punch} 0.8 {radius}\n  line = 0 0.8\n  revolve = -180 180"}
BLANK = """*INCLUDE {material}
*BLANK sheet
  radius = {radius}
  thickness = 0.8
  portion = half
  divisions = {divisions} 1
  material = mild_steel_numisheet93
*TOOL die
  patches = "die.bez"
  friction = 0.1
  contact = z_min
*CONTACT
*BOUNDARY symmetry
  set = x_min
  fix = x
*PHASE draw
  control = die
  trial = 1
  move = die 0 0 1
"""
DECK = """*TITLE
  Conical cup without a holder
*INCLUDE {material}
*MATERIAL isotropic               # so that wrinkles grow from the waviness alone
  young = 2.06e5
  poisson = 0.30
  yield = von_mises
  hardening = swift K=565.32 e0=0.007117 n=0.2589
*MESH sheet
  file = "sheet.inp"
  thickness_points = 5
  adaptive = {levels}
  material = isotropic
*TOOL die
  patches = "die.bez"
  friction = 0.1
  contact = z_min
  position = 0 0 -{waviness}
*TOOL punch
  patches = "punch.bez"
  friction = 0.1
  contact = z_max
  position = 0 0 {waviness}
*CONTACT
*BOUNDARY symmetry
  set = x_min
  fix = x
*BOUNDARY centre
  set = centre
  fix = y
*PHASE draw
  control = punch
  trial = 1.0
  hold = die
  move = punch 0 0 -{travel}
*OUTPUT
  fields = every 0.5 mm
"""


@dataclass
class Cup:
    """Radius of the blank, elements of its core and from there to the rim, radii of the opening of the die and of the
    flat of the punch, of the foot of the die and the top of the punch, their heights, profile radius of the punch, and
    travel, mm."""

    blank: float
    divisions: str
    opening: float
    punch: float
    foot: float
    top: float
    height: float
    radius: float
    travel: float

    def write_tools(self, folder):
        """Write the surfaces of the tools."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, profile in TOOLS.items():
            shape = folder / f"{name}.shape"
            text = profile.format(foot=self.foot, depth=self.height, opening=self.opening, end=1.6*self.blank,
                                  top=self.top, height=self.height + THICKNESS, punch=self.punch, radius=self.radius)
            shape.write_text(f"*PROFILE {name}\n  {text}\n", encoding="utf-8")
            subprocess.run([sys.executable, "-m", "dd3", "tool", shape, folder / f"{name}.bez"], check=True,
                           stdout=subprocess.DEVNULL)

    def write_deck(self, folder, program, divided):
        """Write the input file, with a blank whose elements are divided in it (`divided`) or in the run."""
        blank = folder / "blank.dat"
        blank.write_text(BLANK.format(material=MATERIAL, radius=self.blank, divisions=self.divisions), encoding="utf-8")
        initial = folder / "initial"
        if not initial.is_dir():
            subprocess.run([program, "--quiet", "--check", "--initial", initial, blank], check=True,
                           stdout=subprocess.DEVNULL)
        quads, place = faces(read_run(initial / "fields.vtkhdf"))
        place[:, 2] = self.waviness(place)
        for _ in range(LEVELS if divided else 0):
            quads, place = divide(quads, place)
        write_inp(folder / "sheet.inp", solid(quads, place), blank)
        (folder / "cone.dat").write_text(
            DECK.format(material=MATERIAL, levels=0 if divided else LEVELS, travel=self.travel,
                        waviness=np.abs(place[:, 2]).max() + 0.01), encoding="utf-8")

    def waviness(self, place):
        """Return the height of the lower face of the blank, mm."""
        radius, angle = np.hypot(place[:, 0], place[:, 1]), np.arctan2(place[:, 0], place[:, 1])
        return AMPLITUDE*(radius/self.blank)**2*(WAVINESS @ np.cos(np.outer(LOBES, angle)))


CUPS = {"100 mm": Cup(50, "4 5", 38, 20, 22, 36, 34.286, 5, 24),
        "200 mm": Cup(100, "6 7", 80, 30, 45, 65, 75, 6, 40)}


def faces(mesh):
    """Return the quadrilaterals of the lower face of a blank, whose nodes are in pairs, and their nodes' places."""
    place = np.array([mesh.nodes[label] for label in range(1, len(mesh.nodes), 2)])
    return [[(label - 1)//2 for label in nodes[:4]] for nodes in mesh.elements.values()], place


def divide(quads, place):
    """Divide quadrilaterals into four, with straight edges."""
    place, middles, parts = list(place), {}, []

    def middle(*ends):
        key = tuple(sorted(ends))
        if key not in middles:
            middles[key] = len(place)
            place.append(np.mean([place[end] for end in ends], axis=0))
        return middles[key]

    for quad in quads:
        sides = [middle(quad[i], quad[(i + 1) % 4]) for i in range(4)]
        centre = middle(*quad)
        parts += [[quad[i], sides[i], centre, sides[i - 1]] for i in range(4)]
    return parts, np.array(place)


def solid(quads, place):
    """Return the mesh of a sheet on its lower face, with the sets of the supports."""
    mesh = Mesh()
    for k, point in enumerate(place):
        mesh.nodes[2*k + 1] = tuple(map(float, point))
        mesh.nodes[2*k + 2] = tuple(map(float, point + [0, 0, THICKNESS]))
    mesh.elements = {k + 1: [2*i + 1 for i in quad] + [2*i + 2 for i in quad] for k, quad in enumerate(quads)}
    for name, distance in ("x_min", np.abs(place[:, 0])), ("centre", np.hypot(place[:, 0], place[:, 1])):
        mesh.node_sets[name] = [int(2*k + side) for k in np.flatnonzero(distance < 1e-6) for side in (1, 2)]
    return mesh


class Result:
    """A finished run."""

    def __init__(self, folder, cup, cpu):
        self.folder, self.cup, self.cpu, self.fields = folder, cup, cpu, Fields(folder)
        self.job, self.total = read_job(folder), totals(read_table(folder / "status.csv"))

    @cached_property
    def waves(self):
        """Amplitudes of cos(n phi), n from 0, of the height of the middle surface on the ring, at each step, mm."""
        angle = (np.arange(360) + 0.5)*np.pi/360
        ring = RING*self.cup.blank*np.c_[np.sin(angle), np.cos(angle)]
        cosine = np.cos(np.outer(range(MOST_LOBES + 1), angle))
        return np.array([2*cosine @ LinearNDInterpolator(*self.middle(step))(ring)/len(angle)
                         for step in range(self.fields.count)])

    def middle(self, step):
        """Return the places of the columns of nodes in the blank and the heights of their middles, mm."""
        initial, points = (points.reshape(-1, 2, 3).mean(axis=1)
                           for points in (self.fields.initial(step), self.fields.points(step)))
        return initial[:, :2], points[:, 2]

    def heights(self):
        """Return the root mean square of the height on the ring without its mean and a tilt, at each step, mm."""
        return np.sqrt((self.waves[:, 2:]**2).sum(axis=1)/2)

    def onset(self):
        """Return the travel at which the sheet is wrinkled, mm."""
        height, limit = self.heights(), ONSET*THICKNESS
        step = int(np.argmax(height > limit))
        return float(np.interp(limit, height[step - 1:step + 1], self.fields.travel[step - 1:step + 1]))

    def lobes(self, travel):
        """Return the numbers of waves with the three largest amplitudes, and these."""
        wave = self.waves[self.fields.nearest_step(travel)].copy()
        wave[:2] = 0
        return ", ".join(f"{n} ({abs(wave[n]):.2f})" for n in np.argsort(-np.abs(wave))[:3])

    def words(self):
        """Return the cells of its row."""
        late = self.cup.travel/2
        return [f"{self.fields.size_of('Cells', 1)} to {self.fields.size_of('Cells', self.fields.last)}",
                str(self.total.increments), str(self.total.iterations), f"{self.cpu:.0f}", f"{self.onset():.2f}",
                self.lobes(self.onset()), f"{np.interp(late, self.fields.travel, self.heights()):.2f}", self.lobes(late)]


def make(options, name, cup, mesh):
    """Make a run unless it is there; return it, None if it is not wanted or has stopped."""
    folder = options.work / f"{name}_{mesh}".replace(" ", "_")
    note, results = folder / "cpu.json", folder / "cone.out"
    if not (note.is_file() and studies.is_finished(results)):
        if options.only and name not in options.only:
            return None
        print(f"{name}: {mesh}", flush=True)
        cup.write_tools(folder)
        cup.write_deck(folder, options.program, mesh == UNIFORM)
        done = launch(command(options.program, folder / "cone.dat", results, ["--quiet"], {}))
        if done.code != 0:
            print(f"{name}, {mesh}: exit code {done.code}: {done.errors}", flush=True)
            return None
        note.write_text(json.dumps({"cpu": done.cpu}), encoding="utf-8")
    return Result(results, cup, json.loads(note.read_text(encoding="utf-8"))["cpu"])


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    results = {(name, mesh): make(options, name, cup, mesh) for name, cup in CUPS.items() for mesh in (REFINED, UNIFORM)}
    found = {key: result for key, result in results.items() if result}
    text = table(["blank", "mesh", "elements", "increments", "iterations", "CPU seconds", "onset, mm",
                          "waves at the onset (amplitude, mm)", "height at half of the travel, mm", "waves there"],
                         [[*key, *result.words()] for key, result in found.items()])
    print(text)
    if options.write and found:
        put_table(REPORT, "conical_cup", text, [result.job for result in found.values()])
    sys.exit(0 if all(results.values()) else 1)


if __name__ == "__main__":
    run(main)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Import a forming deck of LS-DYNA: an input file with comments, the blank's mesh and the tools' surfaces.

    dd3 import cup.k                             writes cup/cup.dat, cup/blank.inp, cup/punch.bez, ...
    dd3 import cup.k --output study --units "m Pa"
    dd3imp cup/cup.dat

The blank is the part that deforms, of quadrilateral shells, which are extruded about their mid-surface, or hexahedra;
the tools are rigid parts in contact with it. Materials: *MAT_003 to 242, as in the manual. Motions and forces
by curves become phases: a phase ends where a tool starts, stops or turns back, or where tools go on in other
proportions; a force that changes meanwhile gets a press_table. Each keyword and each field that is not used is listed
with its line and the reason, here and in the input file.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from dd3.account import LeftOut
from dd3.command import new_parser
from dd3.dyna.blank import Blank, blank_of, with_sets
from dd3.dyna.damage import take_fracture
from dd3.dyna.deck import SHELL, Deck, Drive
from dd3.dyna.laws import UNITS, Law, Units, law_of, number_of, units_of, use_rigid
from dd3.dyna.mesh import Part
from dd3.dyna.phases import AT_ONCE, EARTH, Names, Phases, numbers
from dd3.dyna.process import Stage, stages
from dd3.errors import Problem, run
from dd3.mesh import set_name, write_inp
from dd3.programs import made_folder
from dd3.progress import each
from dd3.tools.one_tool import made
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import write

RIGID = 20
SEW = 2e-3  # distance up to which free edges of a tool are joined, mm: deck writers round coordinates
SECTION = "*SECTION_SHELL"
LONGEST_NAME = 40  # of a tool, before its number: the program takes 60 characters
BENT = 2.0  # angle between first edges of elements, degrees, from which a note tells of it


@dataclass
class Tool:
    """A tool: its parts of the deck, its name, friction, and whether it is on the side of the blank's normal."""

    parts: list[int]
    name: str
    friction: float
    above: bool
    cover: float = 0.0  # distance of its contact surface from its nodes, towards the sheet, mm


class Import:
    """The import of a deck: what is found in it, and the notes for the user."""

    def __init__(self, path: Path, blank: int | None = None, units: str | None = None) -> None:
        self.deck = deck = Deck(path)
        self.part = self.blank_part(blank)
        self.material = deck.material(self.part)
        self.units: Units = units_of(self.material, units)
        self.blank: Blank = blank_of(deck, self.part, self.units)
        self.law: Law = law_of(deck, self.material, self.units, self.blank.axes)
        take_fracture(deck, self.part.material, self.law)
        self.notes = [*deck.notes, *self.law.notes]
        if self.blank.asked not in (0, self.blank.points):
            self.notes.append(f"blank, part {self.part.number}: NIP = {self.blank.asked}: {self.blank.points} points "
                              "through the thickness")
        if self.blank.bent > BENT and any("AOPT = 0" in note for note in self.law.notes):
            self.notes.append(f"rolling direction: the first edges of the elements differ by up to "
                              f"{self.blank.bent:.3g} degrees; LS-DYNA follows each, here the first one counts")
        self.nodes = {label for cell in self.part.cells for label in cell.nodes}  # of the blank
        self.tools = self.find_tools()
        self.stages: list[Stage] = self.find_stages()
        self.fixed = self.find_supports()

    def is_rigid(self, part: Part) -> bool:
        """Check whether a part is rigid."""
        return number_of(self.deck.material(part)) == RIGID

    def blank_part(self, wanted: int | None) -> Part:
        """Return the part that is the blank."""
        soft = [part for part in self.deck.parts.values() if part.cells and not self.is_rigid(part)]
        if wanted is not None:
            soft = [part for part in soft if part.number == wanted]
        if len(soft) != 1:
            there = ", ".join(f"{part.number} {part.title}".strip() for part in soft)
            raise Problem(f"{self.deck.path}: expected one part that deforms, the blank; "
                          + (f"there are {there}; --blank chooses one" if soft else "there is none"))
        return soft[0]

    def find_tools(self) -> list[Tool]:
        """Return the tools: rigid parts in contact with the blank, joined where one follows another."""
        pairs, friction, covers = self.deck.pairs(), dict[int, float](), dict[int, float]()
        for pair in pairs:
            for k, (one, other) in enumerate((pair.sides, pair.sides[::-1])):
                for number in other if self.part.number in one else ():
                    if pair.covers:
                        covers[number] = max(covers.get(number, 0.0), self.cover(number, *pair.covers[1 - k]))
                    if friction.setdefault(number, pair.friction) != pair.friction:
                        self.notes.append(f"{pair.place}: another friction of part {number}; the larger one is taken")
                        friction[number] = max(friction[number], pair.friction)
        groups: dict[int, list[Part]] = {}
        for part in self.deck.parts.values():
            if part.number == self.part.number or not part.cells:
                continue
            if not self.is_rigid(part):
                self.notes.append(f"part {part.number} {part.title}: it deforms, as only the blank does here; left out")
            elif pairs and part.number not in friction:
                self.notes.append(f"part {part.number} {part.title}: no contact with the blank; left out")
            else:
                groups.setdefault(self.root(part.number), []).append(part)
        if not groups:
            raise Problem(f"{self.deck.path}: no rigid part in contact with the blank, part {self.part.number}"
                          + self.deck.unread("*CONTACT"))
        if not pairs:
            self.notes.append("no contact is defined: all rigid parts are tools, without friction")
        found = list[Tool]()
        for root, parts in groups.items():
            leader = next((part for part in parts if part.number == root), parts[0])
            name = set_name(leader.title or f"tool_{leader.number}")[:LONGEST_NAME]
            if name == "load" or name in [tool.name for tool in found]:
                name = f"{name}_{leader.number}"
            found.append(self.tool_of(parts, name, [friction.get(part.number, 0.0) for part in parts],
                                      max(covers.get(part.number, 0.0) for part in parts)))
        return found

    def tool_of(self, parts: list[Part], name: str, frictions: list[float], cover: float) -> Tool:
        """Return the tool of parts; tell of what they do not have in common, and of where its surface lies."""
        for part in parts:
            use_rigid(self.deck.material(part))
            self.use_section(part)
        numbers_of_parts = [part.number for part in parts]
        if len(set(frictions)) > 1:
            self.notes.append(f"tool {name}: frictions {frictions}; the largest is taken")
        if len({self.is_above([part]) for part in parts}) > 1:
            self.notes.append(f"tool {name}: its parts {' and '.join(map(str, numbers_of_parts))} lie on both sides of "
                              "the sheet, of which a tool touches one")
        if cover:
            self.notes.append(f"tool {name}: an AUTOMATIC contact acts at the faces of its shells, {cover:g} mm, half "
                              "their thickness, from their nodes")
        return Tool(numbers_of_parts, name, max(frictions), self.is_above(parts), cover)

    def cover(self, number: int, given: float, factor: float) -> float:
        """Return how far the contact surface of a part of shells lies from its nodes, mm: half of the thickness that
        the contact gives, else of that of the part times a factor."""
        part = self.deck.parts.get(number)
        if not part or number == self.part.number or not any(cell.dimension == 2 for cell in part.cells):
            return 0.0
        own = max((value for cell in part.cells for value in cell.thickness), default=0.0)
        if not own and part.section in self.deck.sections and self.deck.sections[part.section][0].keyword == SECTION:
            own = self.deck.section(part, SECTION, SHELL)[1].number("T1")
        return (given or own * factor) / 2 * self.units.length

    def root(self, number: int) -> int:
        """Return the rigid part that a part follows."""
        seen = {number}
        while (number := self.deck.master.get(number, number)) not in seen:
            seen.add(number)
        return number

    def use_section(self, part: Part) -> None:
        """Take the section of a tool, of which nothing is needed: a sheet touches its elements at their nodes."""
        if part.section in self.deck.sections:
            card, i = self.deck.sections[part.section]
            for k in range(i, min(len(card), i + (1 if card.keyword == "*SECTION_SOLID" else 2))):
                card.row(k, "").use()

    def is_above(self, parts: list[Part]) -> bool:
        """Check whether a tool is on the side of the blank's normal, by its nodes over the blank."""
        sheet = np.array(list(self.blank.mesh.nodes.values()))
        labels = sorted({label for part in parts for cell in part.cells for label in cell.nodes})
        points = np.array([self.deck.nodes[label] for label in labels]) * self.units.length
        flat = np.eye(3) - np.outer(self.blank.normal, self.blank.normal)
        low, high = (sheet @ flat).min(axis=0), (sheet @ flat).max(axis=0)
        over = np.all((points @ flat >= low - 1e-6) & (points @ flat <= high + 1e-6), axis=1)
        heights = (points[over] if over.any() else points) @ self.blank.normal
        return bool(heights.mean() > (sheet @ self.blank.normal).mean())

    def find_stages(self) -> list[Stage]:
        """Return the stages of the process, with tools in place of parts."""
        number_of_tool = {part: i for i, tool in enumerate(self.tools) for part in tool.parts}
        drives: list[Drive] = []
        for drive in self.deck.drives:
            if drive.of_set and drive.kind == "force" and self.members(drive.target):
                drives.append(drive)
                continue
            target = number_of_tool.get(self.root(drive.target))
            if drive.of_set or target is None:
                self.notes.append(f"{drive.place}: a {drive.kind} of "
                                  + (f"set {drive.target}" if drive.of_set else f"part {drive.target}, no tool")
                                  + "; left out")
                continue
            if drive.begins:
                self.notes.append(f"{drive.place}: the curve of the motion is taken from its birth on")
            drives.append(replace(drive, target=target))
        self.check_gravity()
        found = stages(self.deck, drives)
        if not any(stage.moving or stage.forces or stage.gravity for stage in found):
            raise Problem(f"{self.deck.path}: no tool moves and none is pressed: expected "
                          "*BOUNDARY_PRESCRIBED_MOTION_RIGID or *LOAD_RIGID_BODY of a tool"
                          + "".join(f"; {text}" for text in self.deck.no_drives[:3])
                          + self.deck.unread("*BOUNDARY_PRESCRIBED") + self.deck.unread("*LOAD")
                          + self.deck.unread("*CONTACT"))
        return found

    def check_gravity(self) -> None:
        """Leave out gravity that does not act on the blank; tell of one that is not that of the earth."""
        for row in self.deck.heavy:
            if self.part.number not in self.deck.of_set("PART", row.label("PSID"), row.place):
                self.notes += [f"{one.place}: gravity of other parts than the blank; left out"
                               for one in self.deck.gravity]
                self.deck.gravity = []
        if self.deck.gravity and not self.law.density:
            raise Problem(f"{self.material.place}: error: gravity acts, but the blank's material has no density RO")
        for one in self.deck.gravity:
            curve = self.deck.curves.get(one.curve, one.place)
            value = float(np.abs(one.scale * curve.y).max()) * self.units.acceleration
            if value and not 0.9 < value / EARTH < 1.1:
                self.notes.append(f"{one.place}: gravity of {value:.4g} mm/s2 in the units {self.units.name}; that of "
                                  f"the earth is {EARTH:g}: another unit of time?")

    def members(self, number: int) -> set[int]:
        """Return the nodes of the blank in a set."""
        return self.nodes & set(self.deck.sets.get("NODE", number)) if self.deck.sets.has("NODE", number) else set()

    def find_supports(self) -> dict[str, set[int]]:
        """Return the nodes of the blank that are held, by the axes."""
        held: dict[int, set[str]] = {}
        turns: dict[int, set[str]] = {}
        for fix in self.deck.fixes():
            for label in fix.nodes & self.nodes:
                held.setdefault(label, set()).update(fix.axes)
                turns.setdefault(label, set()).update(fix.turns)
        self.check_turns(held, turns)
        found: dict[str, set[int]] = {}
        for label, axes in held.items():
            if axes:
                found.setdefault("".join(sorted(axes)), set()).add(label)
        return found

    def check_turns(self, held: dict[int, set[str]], turns: dict[int, set[str]]) -> None:
        """Tell of rotations that are held where the faces of the sheet are not: about an axis of the sheet the nodes
        move along the other."""
        normal = "xyz"[int(np.abs(self.blank.normal).argmax())]
        if self.blank.upper:
            for axis in "xyz".replace(normal, ""):
                other = "xyz".replace(normal, "").replace(axis, "")
                free = [label for label, axes in turns.items() if axis in axes and other not in held.get(label, ())]
                if free:
                    self.notes.append(f"the rotation about {axis} of {len(free)} nodes is held, the first "
                                      f"{min(free)}, but not their displacement along {other}; left out")

    def write_tools(self, folder: Path) -> None:
        """Write the surfaces of the tools."""
        for tool in each(self.tools, "tools"):
            toward = -self.blank.normal if tool.above else self.blank.normal
            words = [str(self.deck.path), str(folder / f"{tool.name}.bez"), "--scale", f"{self.units.length:g}",
                     "--toward", *numbers(toward).split()]
            for number in tool.parts:
                words += ["--part", str(number)]
            words += ["--sew", f"{SEW:g}", *(["--offset", f"{tool.cover:g}"] if tool.cover else [])]
            target = folder / f"{tool.name}.bez"
            surface, _, result = made(ToolSettings(self.deck.path, target, toward.tolist(), self.units.length, sew=SEW,
                                                   offset=tool.cover, tolerance=1000.0,
                                                   part=[str(number) for number in tool.parts]))
            if result.errors:
                raise Problem(f"tool {tool.name}: {'; '.join(result.errors)}; alone: dd3 tool {' '.join(words)}")
            write(target, surface, [f"{self.deck.path.name}: dd3 tool {' '.join(words[2:])}"])
            estimate = next((line.strip() for line in result.lines if "estimated" in line), "")
            self.notes.append(f"tool {tool.name}: {len(surface.net)} patches, {' '.join(estimate.split())}")

    @property
    def left_out(self) -> list[LeftOut]:
        """What of the deck nothing has used."""
        return self.deck.left_out()

    def entries(self) -> list[str]:
        """Return the lines of the input file, behind notes and what is left out."""
        body = self.body()
        lines = [f"# {self.deck.path.name}, imported from LS-DYNA ({self.units.name}) to mm, N and MPa."]
        lines += ["#", "# Notes:", *(f"# - {note}" for note in self.notes)] if self.notes else []
        left = self.left_out
        if left:
            lines += ["#", "# Left out:", *(f"# - {item._replace(place=Path(item.place).name)}" for item in left)]
        return lines + body

    def body(self) -> list[str]:
        """Return the blocks of the input file."""
        lines = ["*TITLE", f"  {self.deck.title or self.deck.path.stem}", "",
                 f"# {self.material.keyword} {self.part.material}.", "*MATERIAL blank",
                 f"  young = {self.law.young:g}", f"  poisson = {self.law.poisson:g}",
                 f"  yield = {self.law.criterion}", f"  hardening = {self.law.hardening}",
                 *(f"  backstress = {law}" for law in self.law.backstresses),
                 *([f"  modulus = {self.law.modulus}"] if self.law.modulus else []),
                 *([f"  rate = {self.law.rate}"] if self.law.rate else []),
                 *(f"  {entry}" for entry in self.law.heating),
                 *([f"  fracture = {self.law.fracture}"] if self.law.fracture else []),
                 *([f"  forming_limit = {self.law.forming_limit}"] if self.law.forming_limit else [])]
        if self.law.density:
            lines.append(f"  density = {self.law.density:.6g}")
        if self.law.rolling:
            lines.append("  rolling_direction = " + numbers(self.law.rolling))
        if abs(self.blank.normal[2]) < 1 - 1e-6:
            lines.append("  normal_direction = " + numbers(self.blank.normal))
        lines += ["", f"# Part {self.part.number} {self.part.title}".rstrip() + f", {self.blank.thickness:g} mm.",
                  "*MESH sheet", "  file = blank.inp", f"  element = {self.blank.element}"]
        if self.blank.element == "solid_shell":
            lines.append(f"  thickness_points = {self.blank.points}")
        lines += ["  material = blank", ""]
        for tool in self.tools:
            lines += [f"# Part {' and '.join(map(str, tool.parts))}, {'above' if tool.above else 'below'} the sheet.",
                      f"*TOOL {tool.name}", f"  patches = {tool.name}.bez", f"  friction = {tool.friction:g}",
                      f"  contact = {'z_max' if tool.above else 'z_min'}", ""]
        lines += ["*CONTACT", ""]
        fields = "every 5 mm" if any(stage.moves for stage in self.stages) else "increments 10"
        return [*lines, *self.bead_lines(), *self.support_lines(), *self.phase_lines(),
                "*OUTPUT", f"  fields = {fields}"]

    def bead_lines(self) -> list[str]:
        """Return the draw-beads."""
        lines = []
        for i, bead in enumerate(self.deck.lines_of_beads(), 1):
            per_length = self.units.force / self.units.length
            force = abs(bead.scale * float(self.deck.curves.get(bead.curve, bead.place).y[-1])) * per_length
            points = [self.deck.nodes[label] for label in bead.nodes if label in self.deck.nodes]
            if len(points) < 2:
                raise Problem(f"{bead.place}: error: a draw-bead of {len(points)} nodes; expected 2 or more")
            lines += [f"*DRAWBEAD bead_{i}", f"  force = {force:g}", "  points = " + "  ".join(
                numbers([self.units.length * value for value in point[:2]]) for point in points)]
            if bead.normal:
                normal = abs(float(self.deck.curves.get(bead.normal, bead.place).y[-1])) * per_length
                tool = self.tool_of_bead(bead.nodes, points)
                lines += [f"  normal = {-normal if tool.above else normal:g}", f"  tool = {tool.name}"]
            lines.append("")
        return lines

    def tool_of_bead(self, nodes: list[int], points: list[tuple[float, ...]]) -> Tool:
        """Return the tool that carries a bead: that of its nodes, or of the nearest one."""
        least: list[tuple[float, int]] = []
        for i, tool in enumerate(self.tools):
            labels = {label for part in tool.parts for cell in self.deck.parts[part].cells for label in cell.nodes}
            if labels & set(nodes):
                return tool
            there = np.array([self.deck.nodes[label] for label in labels])
            least.append((float(np.linalg.norm(there - np.array(points[0]), axis=1).min()), i))
        return self.tools[min(least)[1]]

    def support_lines(self) -> list[str]:
        """Return the supports; of a sheet without any the node nearest to its middle is held in its plane."""
        lines = []
        for axes in self.fixed:
            lines += [f"*BOUNDARY hold_{axes}", f"  set = hold_{axes}", f"  fix = {' '.join(axes)}", ""]
        if lines:
            return lines
        middle = np.mean(list(self.blank.mesh.nodes.values()), axis=0)
        plane = " ".join(axis for axis, part in zip("xyz", np.abs(self.blank.normal)) if part < 0.7)
        return ["# The deck holds no node of the blank: its middle is held in the plane.", "*SET middle",
                f"  near = {numbers(middle)}", "", "*BOUNDARY middle", "  set = middle", f"  fix = {plane}", ""]

    def phase_lines(self) -> list[str]:
        """Return the phases."""
        phases = Phases(Names([tool.name for tool in self.tools], self.tool_points,
                              lambda number: len(self.members(number)), self.blank.size, self.units, self.notes,
                              bool(self.law.rate)))
        phases.add(self.stages)
        if self.deck.springback:
            phases.lines += ["# *INTERFACE_SPRINGBACK.", "*PHASE springback", "  unload = on",
                             *phases.duration(AT_ONCE), ""]
        return phases.lines

    def tool_points(self, number: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the nodes of a tool and its centre, mm: that of *PART_INERTIA, else of its area."""
        cells = [cell.nodes for part in self.tools[number].parts for cell in self.deck.parts[part].cells]
        corners = np.array([[self.deck.nodes[label] for label in (*cell, *cell[-1:] * 4)[:4]] for cell in cells])
        area = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1)
        centre = np.average(corners.mean(axis=1), axis=0, weights=area) if area.sum() > 0 else corners.mean(axis=(0, 1))
        inertia = self.deck.parts[self.root(self.tools[number].parts[0])].inertia
        if inertia:
            node = inertia.label("NODEID")
            centre = np.array(self.deck.nodes[node] if node in self.deck.nodes else inertia.numbers("XC YC ZC"))
        return corners.reshape(-1, 3) * self.units.length, centre * self.units.length


def convert(words: Sequence[str]) -> None:
    """Import the deck of the command line."""
    parser = new_parser("import", __doc__)
    parser.add_argument("deck", type=Path, help="keyword file of LS-DYNA: .k, .key, .dyn")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder to write (default: the deck's name)")
    parser.add_argument("--units", choices=list(UNITS), help="units of lengths and stresses (by Young's modulus)")
    parser.add_argument("--blank", type=int, metavar="PART", help="number of the part that is the blank")
    options = parser.parse_args(words)
    if not options.deck.is_file():
        raise Problem(f"{options.deck}: no such file")
    found = Import(options.deck, options.blank, options.units)
    folder = made_folder(options.output or options.deck.with_suffix(""))
    found.write_tools(folder)
    lines = found.entries()
    sets = {f"hold_{axes}": labels for axes, labels in found.fixed.items()}
    sets |= {f"load_{number}": found.members(number) for stage in found.stages for number in stage.loads}
    mesh = with_sets(found.blank, sets)
    write_inp(folder / "blank.inp", mesh, options.deck)
    target = folder / f"{options.deck.stem}.dat"
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{target}: blank of {len(mesh.elements)} {found.blank.element}, {found.blank.thickness:g} mm; tools: "
          + ", ".join(tool.name for tool in found.tools))
    for note in found.notes:
        print(f"note: {note}")
    for item in found.left_out:
        print(f"left out: {item}")


def main(words: Sequence[str] | None = None) -> None:
    """Import the deck of the command line."""
    words = sys.argv[1:] if words is None else words
    run(lambda: convert(words))

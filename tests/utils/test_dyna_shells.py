# SPDX-License-Identifier: GPL-3.0-or-later
"""Blanks of LS-DYNA's shells that are bent, turned over, or not at their middle surface; parts with common nodes."""

from pathlib import Path

import numpy as np
import pytest
from dyna_decks import flat_deck, flat_mesh, row
from helpers import call
from test_dyna import imported, refused

from dd3.dyna.command import Import
from dd3.dynain import sheet_of


def bent_mesh(shape, turned=()):
    """Return the mesh of the flat deck whose sheet has the places shape(x) in x and z; the shells `turned` are numbered
    the other way round."""
    lines = []
    for line in flat_mesh():
        label = int(line[:8]) if line[:8].strip().isdecimal() else 0
        if 1 <= label <= 45 and "." in line:
            (x, z), y = shape(float(line[8:24])), line[24:40]
            line = f"{label:8d}{x:16.6f}{y}{z:16.6f}"
        elif label in turned and "." not in line:
            words = [line[i:i + 8] for i in range(0, 48, 8)]
            line = "".join((*words[:2], *words[:1:-1]))
        lines.append(line)
    return lines


def volumes(blank):
    """Return the volumes of the elements over the areas of their middle surfaces."""
    points = np.array([[blank.mesh.nodes[label] for label in cell] for cell in blank.mesh.elements.values()])
    gauss = np.array([-1, 1]) / np.sqrt(3)
    signs = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1),
                      (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])
    volume = np.zeros(len(points))
    for at in np.array(np.meshgrid(gauss, gauss, gauss)).reshape(3, -1).T:
        slopes = np.array([[signs[a, k] * np.prod(np.delete(1 + signs[a] * at, k)) / 8 for k in range(3)]
                           for a in range(8)])
        volume += np.linalg.det(np.einsum("eai,ak->eik", points, slopes))
    middle = (points[:, :4] + points[:, 4:]) / 2
    return volume / (np.linalg.norm(np.cross(middle[:, 2] - middle[:, 0], middle[:, 3] - middle[:, 1]), axis=1) / 2)


def roof(x):
    """Return the places of a roof of 30 degrees."""
    return x, (20 - abs(x - 20)) * np.tan(np.radians(30))


def channel(lean):
    """Return the places of a channel with walls of 10 mm that lean inwards, degrees."""
    def place(x):
        if 10 <= x <= 30:
            return x, 0.0
        left, along = x < 10, min(abs(x - 10), abs(x - 30))
        side = along * np.sin(np.radians(lean))
        return (10 + side if left else 30 - side), along * np.cos(np.radians(lean))
    return place


@pytest.mark.parametrize("shape", [roof, channel(0.0), channel(5.0), channel(-20.0)])
@pytest.mark.parametrize("turned", [(), (1, 2, 9, 17, 30)])
def test_thickness(shape, turned):
    """Check that elements of bent sheets have the thickness of the shells, all on one side, however they are numbered.

    At a bend the faces are not parallel: the mean over the elements beside it is right to second order of the angle.
    """
    found, _, _ = imported(flat_deck(mesh=bent_mesh(shape, turned)))
    ratio = volumes(found.blank)
    assert ratio.min() > 0.9 and abs(ratio.mean() - 1.0) < 0.005, ratio
    straight = imported(flat_deck(mesh=bent_mesh(shape)))[0].blank.mesh
    assert all(np.allclose(point, straight.nodes[label], atol=1e-9) for label, point in found.blank.mesh.nodes.items())


def section(nloc):
    """Return the sections with a place of the blank's reference surface."""
    return ["*SECTION_SHELL", row(1, 16, 0.833, 5), row(1.0, 1.0, 1.0, 1.0, nloc), "*SECTION_SHELL", row(2, 2),
            row(1.0, 1.0, 1.0, 1.0)]


def test_reference_surface():
    """Check that NLOC counts along the normals that the shells have in the deck."""
    every = tuple(range(1, 33))
    for nloc, turned, low in ((1, (), -1.0), (-1, (), 0.0), (0.5, (), -0.75), (1, every, 0.0), (-1, every, -1.0)):
        blank = imported(flat_deck(mesh=bent_mesh(lambda x: (x, 0.0), turned), section=section(nloc)))[0].blank
        heights = np.array(list(blank.mesh.nodes.values()))[:, 2]
        assert np.allclose((heights.min(), heights.max()), (low, low + 1.0)), (nloc, heights)
    assert "NLOC = 1, but 2 of the 32 shells" in refused(
        flat_deck(mesh=bent_mesh(lambda x: (x, 0.0), (1, 2)), section=section(1)))
    assert "NLOC = 2; expected -1 to 1" in refused(flat_deck(section=section(2)))


def thick_mesh(values):
    """Return the mesh with *ELEMENT_SHELL_THICKNESS of the blank's shells; `values` gives them by label."""
    lines = []
    for line in flat_mesh():
        label = int(line[:8]) if line[:8].strip().isdecimal() and "." not in line else 0
        lines.append("*ELEMENT_SHELL_THICKNESS" if line == "*ELEMENT_SHELL" else line)
        if label:
            lines.append("".join(f"{value:16.6f}" for value in values(label)))
    return lines


def test_own_thickness():
    """Check that shells without a thickness of their own have that of the section."""
    thick = imported(flat_deck(mesh=thick_mesh(lambda label: (1.2,) * 4)))[0].blank.thickness
    assert thick == 1.2
    assert imported(flat_deck(mesh=thick_mesh(lambda label: (0.0,) * 4)))[0].blank.thickness == 1.0
    assert imported(flat_deck(mesh=thick_mesh(lambda label: (1.0 if label % 2 else 0.0,) * 4)))[0].blank.thickness == 1.0
    for values in (lambda label: (1.2 if label < 17 else 0.0,) * 4, lambda label: (1.2, 0.0, 0.0, 0.0)):
        assert "shells 1 to 1.2 thick; the blank has one thickness" in refused(flat_deck(mesh=thick_mesh(values)))


def test_points():
    """Check that points through the thickness that are not those of the deck are told."""
    for asked, points in ((3, 7), (21, 15)):
        lines = ["*SECTION_SHELL", row(1, 16, 0.833, asked), row(1.0), "*SECTION_SHELL", row(2, 2), row(1.0)]
        found = imported(flat_deck(section=lines))[0]
        assert found.blank.points == points and any(f"NIP = {asked}: {points} points" in note for note in found.notes)
    assert not any("NIP" in note for note in imported(flat_deck())[0].notes)


def test_sections():
    """Check sections with titles of their own, without a second row, and of layers with angles."""
    titled = ["*SECTION_SHELL_TITLE", "sheet", row(1, 16, 0.833, 5), row(1.0), "tools", row(2, 2), row(1.0)]
    assert imported(flat_deck(section=titled))[0].blank.points == 5
    angles = ["*SECTION_SHELL", row(1, 16, 0.833, 5, "", "", 1), row(1.0), row(0, 45, 90, 45, 0), row(2, 2), row(1.0)]
    _, _, left = imported(flat_deck(section=angles))
    assert any("row 3 field 2 = 45" in item for item in left)
    alone = ["*SECTION_SHELL", row(2, 2), row(1.0), "*SECTION_SHELL", row(1, 16, 0.833, 5)]
    assert imported(flat_deck(section=alone, mesh=thick_mesh(lambda label: (1.2,) * 4)))[0].blank.thickness == 1.2


def two_part_mesh():
    """Return the mesh whose die is of the parts 3 and 4, with seven nodes in common."""
    lines = flat_mesh()
    return [line[:8] + f"{4:8d}" + line[16:] if line[8:16].strip() == "3" and "." not in line
            and int(line[:8]) > 66 else line for line in lines]


TWO = ["*PART", "punch", row(2, 2, 2), "*PART", "die", row(3, 2, 2), "*PART", "die, behind", row(4, 2, 2)]
BOTH = ["*SET_PART_LIST", row(34), row(3, 4), "*SET_PART_LIST", row(1), row(1)]
CONTACT = ["*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 2, 3, 3), row(0.11), "",
           "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 34, 3, 2), row(0.12), ""]


def test_parts_with_common_nodes():
    """Check that nodes of two parts that are displaced together are displaced once."""
    moves = {-2.5: [["*PART_MOVE", f"{34:8d}{0:16d}{0:16d}{-2.0:16.6f}{0:8d}{1:8d}"]],
             -3.0: [["*CONTROL_FORMING_AUTOPOSITION_PARAMETER_SET", row(34, "", 3, 1, -1, "", 3.0)],
                    ["*CONTROL_FORMING_AUTOPOSITION_PARAMETER_SET", row(34, "", 3, 1, -1, "", 3.0, "down"), "*PART_MOVE",
                     f"{34:8d}{0:16d}{0:16d}{'&down':>16}{0:8d}{1:8d}"],
                    ["*PART_MOVE", *(f"{part:8d}{0:16d}{0:16d}{-2.5:16.6f}" for part in (3, 4))]]}
    for height, cards in moves.items():
        for card in cards:
            deck = imported(flat_deck(parameter=["*PARAMETER", row("R down", 0.0)], tools=TWO, mesh=two_part_mesh(),
                                      contact=BOTH + CONTACT, more=card))[0].deck
            places = {round(deck.nodes[label][2], 9) for label in range(2001, 2050)}
            assert places == {height}, (places, card)
    apart = ["*PART_MOVE", f"{3:8d}{0:16d}{0:16d}{-2.5:16.6f}", f"{4:8d}{0:16d}{0:16d}{-1.0:16.6f}"]
    assert "belongs to the parts 3 and 4, which are displaced" in refused(
        flat_deck(tools=TWO, mesh=two_part_mesh(), contact=BOTH + CONTACT, more=apart))


def test_held_by_nodes(tmp_path):
    """Check that the nodes that *NODE of a dynain file holds become sets of both faces."""
    text = ["*KEYWORD", "*NODE", *(f"{i:8d}{x:16.6f}{y:16.6f}{0.0:16.6f}{held:8d}{turns:8d}" for i, (x, y, held, turns)
            in enumerate(((0, 0, 4, 0), (10, 0, 2, 4), (10, 10, 0, 7), (0, 10, 1, 0)), 1)), "*ELEMENT_SHELL_THICKNESS",
            "".join(f"{value:8d}" for value in (1, 1, 1, 2, 3, 4)), "".join(f"{1.0:16.6f}" for _ in range(4)),
            "*INITIAL_STRESS_SHELL", row(1, 1, 1), row(0.0, 100.0, 0, 0, 0, 0, 0, 0.1), "*END"]
    (tmp_path / "dynain").write_text("\n".join(text))
    sheet, said = sheet_of(tmp_path / "dynain", [], 5, (1.0, 0.0, 0.0))
    assert {name: nodes.tolist() for name, nodes in sheet.sets.items() if name.startswith("hold")} == {
        "hold_x": [6, 7], "hold_xy": [0, 1], "hold_y": [2, 3]}
    assert any("holds 1 nodes along x and y" in line for line in said)
    assert "left out: the rotations of 2 nodes that *NODE holds (RC)" in said


def test_faces_of_tools():
    """Check that an AUTOMATIC contact acts at the faces of the tools' shells, in mm and m."""
    contact = ["*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE", row(1, 2, 3, 3), row(0.11), "",
               "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 3, 3, 3), row(0.12), ""]
    found = imported(flat_deck(contact=contact))[0]
    assert [tool.cover for tool in found.tools] == [0.5, 0.0] and sum("AUTOMATIC" in note for note in found.notes) == 1
    call("import", "deck.k")
    assert " 0\n" in Path("deck/punch.bez").read_text() and " -0.5\n" in Path("deck/die.bez").read_text()
    for third, cover in ((row("", "", 0.3, 0.4, "", 0.5), 0.2), (row("", "", "", "", "", 0.5), 0.25)):
        contact[3] = third  # a thickness of the contact is not scaled
        assert [tool.cover for tool in imported(flat_deck(contact=contact))[0].tools] == [cover, 0.0]
    single = ["*CONTACT_AUTOMATIC_SINGLE_SURFACE", row("", "", 5), row(0.15)]
    found = imported(flat_deck(contact=single))[0]
    assert [(tool.friction, tool.cover) for tool in found.tools] == [(0.15, 0.5)] * 2


def test_faces_of_tools_in_metres(tmp_path):
    """Check the place of a tool's face in a deck of m and Pa."""
    lines = [line if "." not in line or line[0] == "*" else
             f"{line[:8]}" + "".join(f"{float(line[i:i + 16]) / 1000:16.6f}" for i in (8, 24, 40)) for line in flat_mesh()]
    thin = ["*SECTION_SHELL", row(1, 16, 0.833, 5), row(0.001), "*SECTION_SHELL", row(2, 2), row(0.001)]
    deck = flat_deck(mesh=lines, section=thin, material=["*MAT_024", row(1, 7850.0, "2.1E11", 0.3, "2.0E8", "5.0E8"), "", "",
                                                         ""],
                     contact=["*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE", row(1, 2, 3, 3), row(0.11), "",
                              "*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE", row(1, 3, 3, 3), row(0.12), ""])
    Path("deck.k").write_text(deck)
    found = Import(Path("deck.k"), units="m Pa")
    found.write_tools(tmp_path)
    heights = {name: {float(line.split()[2]) for line in (tmp_path / f"{name}.bez").read_text().splitlines()
                      if len(line.split()) == 3 and line[0] not in "#p"} for name in ("punch", "die")}
    assert [sorted(values) for values in heights.values()] == [[0.0], [0.0]], heights


def test_bonds():
    """Check that bonds of surfaces are no contacts, and rows of options are named for what they are."""
    for option in ("TIED_SURFACE_TO_SURFACE", "AUTOMATIC_SURFACE_TO_SURFACE_TIEBREAK"):
        contact = [f"*CONTACT_{option}", row(1, 2, 3, 3), row(0.11), "", "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE",
                   row(1, 3, 3, 3), row(0.12), ""]
        assert f"*CONTACT_{option} at deck.k" in refused(flat_deck(contact=contact))
    for option, rows in (("ORTHO_FRICTION", 2), ("THERMAL", 1), ("THERMAL_FRICTION", 2)):
        contact = [f"*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE_{option}", row(1, 2, 3, 3), row(0.11), "",
                   *(row(0.3) for _ in range(rows)), row(2), "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE",
                   row(1, 3, 3, 3), row(0.12), ""]
        _, _, left = imported(flat_deck(contact=contact))
        assert any("SOFT = 2" in item for item in left), left
        assert any("field 1 = 0.3" in item for item in left) and not any("SOFSCL" in item for item in left)


def test_order():
    """Check a vector that stands behind the motion that names it, and what a message on missing motions names."""
    motion = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 4, 2, 1, -1.0, 4), "*DEFINE_VECTOR", row(4, 0, 0, 1, 0, 0, 0)]
    assert "  move = punch 0 0 -5\n" in imported(flat_deck(motion=motion))[1]
    assert "motion of kind DOF = 3, VAD = 1: left out" in refused(
        flat_deck(motion=["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 1, 1, 1.0)]))


def test_rounding():
    """Check nint and anint, and a parameter whose name looks like an exponent."""
    cards = ["*PARAMETER", row("R p1d2", 2.0), "*PARAMETER_EXPRESSION", "R half    anint(4.5)-nint(-2.5)-8.0+0.0d0",
             "R stroke  -&half*&p1d2-1d0"]
    curve = ["*DEFINE_CURVE", row(1), f"{0.0:>20}{0.0:>20}", f"{0.01:>20}{'&stroke':>20}"]
    assert "  move = punch 0 0 -1\n" in imported(flat_deck(parameter=cards, curve=curve))[1]


def test_scaled_table():
    """Check the scale and the offset of the values of a table."""
    slow = ["*DEFINE_CURVE", row(51), f"{0.0:>20}{210.0:>20}", f"{1.0:>20}{300.0:>20}"]
    fast = ["*DEFINE_CURVE", row(52), f"{0.0:>20}{250.0:>20}", f"{1.0:>20}{400.0:>20}"]
    material = ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3), row("", "", 50, "", 1.0), "", ""]
    for head, rates in ((row(50, 1000.0), "r1=1 r2=1000"), (row(50, 1000.0, 1.0), "r1=1001 r2=2000"),
                        (row(50), "r1=0.001 r2=1")):
        table = ["*DEFINE_TABLE", head, f"{0.001:>20}", f"{1.0:>20}", *slow, *fast]
        assert f"rate = curves {rates}" in imported(flat_deck(material=material, more=table))[1]


def test_centre_of_a_part():
    """Check that a part turns about the centre that *PART_INERTIA gives."""
    tools = ["*PART_INERTIA", "punch", row(2, 2, 2), row(1.0, 2.0, 3.0, 1.0), row(1, 0, 0, 1, 0, 1), row(0, 0, 0),
             "*PART", "die", row(3, 2, 2)]
    motion = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 5, 2, 1, -0.01)]
    assert "  turn = punch 1 2 3  " in imported(flat_deck(tools=tools, motion=motion))[1]
    assert "  turn = punch 20 0 0.5  " in imported(flat_deck(motion=motion))[1]


def test_long_title():
    """Check that a tool whose part has a long title gets a name that the program takes."""
    tools = ["*PART", "p" * 70, row(2, 2, 2), "*PART", "p" * 69 + "q", row(3, 2, 2)]
    names = [tool.name for tool in imported(flat_deck(tools=tools))[0].tools]
    assert len(set(names)) == 2 and max(map(len, names)) < 60

# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether a part is likely to be drawn without a split, judged before its draw.

Thinning. The inverse calculation in one step that lays the part flat for its blank (Guo, Batoz, Detraux and Duroux,
Int. J. Numer. Methods Eng. 30 (1990) 1385-1401) gives the strains of the part. The thinning at a node is that of the
triangles around it together, 1 - A0/A by their areas in the blank and in the part, so that it does not depend on the
shape of single triangles. The calculation is without friction, and its exponent of hardening, 0.5, spreads the strains:
the draw thins the sheet more where these matter. The limit is that of `dd3 fld`.

Inner pan. Where the punch has a step, what is below it is drawn first, by a punch that is smaller than the part, from
the whole blank. If its surface is so much larger than its plan that stretching alone would thin the sheet beyond the
limit, 1 - A0/A, it has to be drawn, and its drawing ratio, the root of the area of the blank over that of its section
at half its height, must not exceed the limiting one: about 2 for mild steel (Whiteley, Trans. ASM 52 (1960) 154-169).
"""
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dd3.tools import set_material
from dd3.tools.report import where
from dd3.tools.surface import Surface, areas_at, grid, points_at
from dd3.triangles import Triangles, area_vectors
from dd3.verdict import THINNING

if TYPE_CHECKING:
    from dd3.tools.tool_set import ToolSet

RATIO = 2.0  # drawing ratio up to which mild steel is drawn in one stroke, about
SAMPLES = 5  # points along each side of a patch at which its area is taken
LEAST = 0.01  # thinning that is told


@dataclass
class InnerPan:
    """What a punch has below its lowest step: area in plan of its section at half its height, mm2, and its thinning if
    it were stretched alone, a fraction."""

    area: float
    stretch: float


def thinnest(mesh: Triangles, flat: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the largest thinning at a node of a part, a fraction, by its nodes' places in the flat blank (n, 2), and
    the place of the node (3)."""
    blank = np.column_stack((flat, np.zeros(len(flat))))
    area = np.zeros((2, len(mesh.nodes)))
    for row, nodes in zip(area, (blank, mesh.nodes)):
        of_triangle = np.linalg.norm(area_vectors(nodes, mesh.triangles), axis=1)
        for corner in mesh.triangles.T:
            np.add.at(row, corner, of_triangle)
    thinning = 1 - area[0] / area[1]
    worst = int(thinning.argmax())
    return float(thinning[worst]), mesh.nodes[worst]


def inner_pan(part: Surface, roles: list[str]) -> InnerPan | None:
    """Return what a part, with the roles of its faces, has below its lowest step, None without a step."""
    steps = np.isin(part.face, [face for face, role in enumerate(roles) if role == "step"])
    if not steps.any():
        return None
    of_part = part.face < len(roles)
    points, area = points_at(part.net, *grid(SAMPLES))[of_part], areas_at(part.net, *grid(SAMPLES))[of_part]
    height, size, plan = points[..., 2], np.linalg.norm(area, axis=-1), np.abs(area[..., 2])
    step, floor = float(points_at(part.net[steps], *grid(SAMPLES))[..., 2].min()), float(height.min())
    below, section = height < step, height < 0.5 * (step + floor)
    return InnerPan(float(plan[section].sum()) / SAMPLES**2, 1 - float(plan[below].sum() / size[below].sum()))


def limit_of(material: Path | None) -> tuple[float, str]:
    """Return the largest thinning of a material, a fraction, and who gives it."""
    given = set_material.block_of(material).value("thinning_limit") if material else None
    return (float(given), "of the material") if given else (THINNING, "a convention")


def judged(tools: "ToolSet", material: Path | None) -> tuple[list[tuple[str, str]], list[str]]:
    """Return lines and warnings of the report on the tools of a part."""
    lines, warnings = [], []
    limit, by = limit_of(material)
    if tools.blank.thinning is None:
        lines.append(("thinning", "not estimated, as the part is not laid flat: judge the draw by its run alone"))
    elif tools.blank.thinning < LEAST:
        lines.append(("thinning", f"below {100 * LEAST:g} % by the estimate of the blank, without friction"))
    else:
        place = where(tools.blank.thinnest + np.array([0.0, 0.0, tools.height]))
        found = (f"{100 * tools.blank.thinning:.3g} % by the estimate of the blank, without friction, at x y z = "
                 f"{place}; limit {100 * limit:g} %, {by}")
        lines.append(("thinning", found))
        if tools.blank.thinning > limit:
            warnings.append(f"likely to split: thinning of {found}. Larger radii there, less depth, or two strokes")
    if tools.lost:
        warnings.append(f"--flange: the blank is cut off at the border of the die, by up to {tools.lost:.3g} mm; "
                        f"{np.ceil(tools.flange):g} leaves it whole, or take a smaller --margin")
    if tools.ratio > RATIO:
        warnings.append(
            f"the drawing ratio, the root of the area of the blank over that of the punch, is {tools.ratio:.2f}: mild "
            f"steel is drawn in one stroke up to about {RATIO:g}. Take a smaller --margin or --shoulder, or draw it in "
            "two strokes")
    if tools.ratio and (pan := tools.inner_pan):
        ratio = (tools.blank.area / pan.area)**0.5
        found = (f"drawing ratio {ratio:.3g}, limit about {RATIO:g}; stretched alone, thinned by "
                 f"{100 * pan.stretch:.3g} %")
        lines.append(("inner pan", found))
        if ratio > RATIO and pan.stretch > limit:
            warnings.append(f"likely to split: what is below the step of the punch is drawn first, from the whole "
                            f"blank: {found}. Draw it in two strokes")
    return lines, warnings

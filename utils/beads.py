"""Lines of draw-beads of a run, for pictures."""

import numpy as np
import pyvista as pv
import results
from scripts import Problem

COLOUR = "#c0392b"
POINTS = 300  # of a drawn line, about
NEAREST = 8  # nodes around a point of the line that give its height


def beads_of_deck(deck, log, settings):
    """Return the vertices (n, 2) of the draw-beads' lines by their names in small letters, as a run used them."""
    blocks = results.run_blocks(deck, log, settings, lambda block: block.keyword == "drawbead")
    return {block.name.lower(): vertices(block) for block in blocks}


def vertices(block):
    """Return the vertices of a bead's line, from its block or the file that it names."""
    words = (block.value("points") or "").split()
    if not words and block.value("file"):
        path = block.folder / block.value("file").strip("\"'")
        words = " ".join(line for line, _ in results.deck_lines(path)).split()
    try:
        return np.array([float(word.lower().replace("d", "e")) for word in words]).reshape(-1, 2)
    except ValueError:
        raise Problem(f"draw-bead '{block.name}': no pairs x y") from None


def draped(line, nodes):
    """Return a line in plan as a curve on the sheet with these nodes: the highest of the nearest nodes at each point."""
    ends = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))))
    places = np.union1d(np.linspace(0.0, ends[-1], POINTS), ends)
    plan = np.column_stack([np.interp(places, ends, line[:, i]) for i in (0, 1)])
    distance = ((plan[:, None, :] - nodes[None, :, :2]) ** 2).sum(axis=2)
    nearest = np.argpartition(distance, min(NEAREST, len(nodes)) - 1, axis=1)[:, :NEAREST]
    return pv.lines_from_points(np.column_stack([plan, nodes[nearest, 2].max(axis=1)]))


def draw_beads(plotter, lines, nodes, shift, images):
    """Draw lines on the sheet, moved by `shift` towards the eye; `images` adds the mirror images of a mesh."""
    for line in lines:
        for part in images(draped(line, nodes)):
            plotter.add_mesh(part.translate(shift), color=COLOUR, line_width=5)

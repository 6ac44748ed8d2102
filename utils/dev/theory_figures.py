#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the sketches of docs/theory.md as SVG: elements, contact layer, an increment.

  theory_figures.py [folder]      docs/images/theory by default
"""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEEL, HEIGHT = 2.1e5, 20.0  # Young's modulus, MPa; height of the layer for a sheet of 1 mm, micrometres
BLACK, GREY, BLUE, RED = "#222", "#888", "#1565c0", "#c62828"


def line(points, colour=BLACK, width=1.5, extra=""):
    """Return a polyline."""
    where = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{where}" fill="none" stroke="{colour}" stroke-width="{width}" {extra}/>'


def arrow(start, end, colour=BLACK):
    """Return a line with a head at its end."""
    return line([start, end], colour, 1.5, f'marker-end="url(#{colour[1:]})"')


def dot(x, y, colour=BLACK, radius=3):
    """Return a point."""
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>'


def text(x, y, words, colour=BLACK, anchor="start"):
    """Return a text."""
    return f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="{anchor}">{words}</text>'


def picture(width, height, parts):
    """Return the file of a picture on white."""
    heads = "".join(f'<marker id="{colour[1:]}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
                    f'orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="{colour}"/></marker>'
                    for colour in (BLACK, BLUE, RED))
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
                      f'height="{height}" font-family="sans-serif" font-size="13">', f"<defs>{heads}</defs>",
                      '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>"]) + "\n"


def box(place, size, thickness):
    """Return the edges of a block, and the function that places a point of its natural coordinates."""
    def at(xi, eta, zeta):
        return (place[0] + size * (0.5 * xi + 0.28 * eta), place[1] - size * 0.22 * eta - 0.5 * thickness * zeta)
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]
    edges = [line([at(*corner, zeta) for corner in corners]) for zeta in (-1, 1)]
    return [*edges, *(line([at(*corner, -1), at(*corner, 1)]) for corner in corners[:4])], at


def elements():
    """Return the sketch of hex8 and solid_shell."""
    gauss = (-0.577, 0.577)
    parts, at = box((135, 115), 130, 90)
    parts += [dot(*at(xi, eta, zeta), BLUE) for xi in gauss for eta in gauss for zeta in gauss]
    parts += [text(135, 225, "hex8", anchor="middle")]
    thin, at = box((430, 115), 190, 50)
    parts += thin
    for xi in gauss:
        for eta in gauss:
            parts += [dot(*at(xi, eta, 0.9 * zeta / 2), BLUE, 2.5) for zeta in (-2, -1, 0, 1, 2)]
    for xi, eta in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        parts.append(arrow(at(xi, eta, -1), at(xi, eta, 1.9), RED))
    for start, end in (((-1, -1), (1, -1)), ((1, -1), (1, 1))):
        steps = [(1 - k / 10, k / 10) for k in range(11)]
        edge = [at(a * start[0] + b * end[0], a * start[1] + b * end[1], 1.6 * a * b) for a, b in steps]
        parts.append(line(edge, GREY, 1.5, 'stroke-dasharray="5 3"'))
    return picture(600, 240, [*parts, text(430, 225, "solid_shell", anchor="middle")])


def layer():
    """Return the sketch of a node in the contact layer, and its pressure over the gap."""
    arc = [(40 + 4 * k, 190 - 0.0022 * (120**2 - (4 * k - 120) ** 2)) for k in range(61)]
    parts = [line([*arc, (280, 215), (40, 215), arc[0]], BLACK, 1.5), line([(x, y - 45) for x, y in arc], BLUE, 1.5,
             'stroke-dasharray="5 3"'), line([(50, 128), (160, 136), (270, 128)], GREY, 3), dot(160, 136, RED, 4)]
    parts += [arrow((160, 136), (160, arc[30][1])), text(167, 151, "g"), arrow((90, arc[12][1]), (90, arc[12][1] - 44)),
              text(77, 155, "h"), text(160, 205, "tool", anchor="middle"), text(172, 128, "node"),
              text(285, 150, "layer", BLUE)]
    left, bottom, wide, high, most = 385, 200, 200, 160, 100.0
    parts += [arrow((left, bottom), (left + wide + 15, bottom)), arrow((left, bottom), (left, bottom - high - 15))]
    curve = []
    for k in range(1, 1001):
        part = k / 1000
        pressure = 1e-5 * STEEL * (1 / part - 2 + part)
        if pressure <= most:
            curve.append((left + wide * part, bottom - high * pressure / most))
    parts.append(line(curve, BLUE, 2))
    for gap in (5, 10, 15, 20):
        parts.append(text(left + wide * gap / HEIGHT, bottom + 16, gap, anchor="middle"))
    for pressure in (50, 100):
        parts.append(text(left - 5, bottom + 4 - high * pressure / most, pressure, anchor="end"))
    parts += [text(left + wide, bottom + 32, "gap g, μm", anchor="end"), text(left + 8, bottom - high - 4, "p, MPa")]
    return picture(620, 240, parts)


def increment():
    """Return the sketch of predictor and corrector."""
    left, bottom = 60, 220

    def equilibrium(travel):
        return bottom - 130 * (travel / 400) ** 0.4

    curve = [(left + x, equilibrium(x)) for x in range(4, 420, 4)]
    start, trial, part = 50, 260, 150
    slope = (equilibrium(start + 1) - equilibrium(start - 1)) / 2
    predicted = equilibrium(start) + slope * part
    committed = (left + start, equilibrium(start))
    tried = (left + start + trial, equilibrium(start) + slope * trial)
    reached, final = left + start + part, equilibrium(start + part)
    parts = [arrow((left, bottom), (left + 460, bottom)), arrow((left, bottom), (left, 15)), line(curve, BLACK, 2)]
    parts += [line([committed, tried], BLUE, 1.5, 'stroke-dasharray="5 3"'),
              arrow(committed, (reached, predicted), BLUE), arrow((reached, predicted), (reached, final - 4), RED),
              dot(*committed, BLACK, 4), dot(reached, final, BLACK, 4)]
    parts += [text(committed[0] + 6, committed[1] + 20, "committed state N-1"),
              text(reached + 8, final + 18, "state N: equilibrium"),
              text(reached - 12, predicted - 6, "predictor, r", BLUE, "end"),
              text(reached + 8, (predicted + final) / 2 + 2, "corrector", RED),
              text(tried[0] + 4, tried[1] + 14, "trial increment, r = 1", BLUE),
              text(left + 455, bottom + 18, "travel of the tool", anchor="end"), text(left + 8, 22, "force")]
    return picture(620, 245, parts)


def main():
    """Write the pictures."""
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images" / "theory"
    folder.mkdir(parents=True, exist_ok=True)
    for draw in (elements, layer, increment):
        (folder / f"{draw.__name__}.svg").write_text(draw(), encoding="utf-8")


if __name__ == "__main__":
    main()

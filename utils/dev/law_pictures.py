#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the pictures of docs/laws: one for each yield criterion, hardening law, back-stress law, the chord modulus,
laws of the strain rate and of fracture, and one of the laws of friction.

    utils/dev/law_pictures.py --program build/release/dd3imp
    utils/dev/law_pictures.py hill48 swift --program build/release/dd3imp --output /tmp

Materials and paths are those of input_files/laws/<law>.dat; all values come from runs of the program. Criteria: the
yield surface with its normals, r-values and yield stresses by angle; the broken line is the surface of von Mises.
Hardening laws: tension as true and as nominal stress, with a dot at the largest force. Back-stresses and laws that
depend on the strain path: reversals and changes of the path. Chord modulus: tension with unloadings. Strain rate:
tension at four rates, and with jumps of the rate and relaxation. Fracture: damage, and strains to fracture in plane
stress; of a table over triaxiality and Lode angle. Friction: coefficients of a strip that is drawn under a die, over
pressure and speed.
"""

import argparse
import io
import re
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from dd3.errors import Problem, run
from dd3.plot import point as pp
from dd3.programs import command, launch
from dd3.progress import each
from dd3.tables import read_table
from dd3.tools.blocks import read_blocks

ROOT = Path(__file__).resolve().parents[2]
DECKS = ROOT / "input_files" / "laws"
STYLE = {"font.size": 9, "axes.grid": True, "grid.color": "0.9", "grid.linewidth": 0.7, "lines.linewidth": 1.4,
         "lines.markersize": 4, "axes.titlesize": 9, "legend.frameon": False, "axes.spines.top": False,
         "axes.spines.right": False}
BROKEN = {"color": "0.55", "linestyle": "--", "linewidth": 1.1, "label": "von Mises"}
DOTS = {"color": "black", "marker": "o", "linestyle": "", "label": "measured", "zorder": 3}
RATIOS = np.radians(np.arange(0, 360, 5))
ANGLES = list(range(0, 91, 5))
SHEAR = "e11 s22 s33 e12 s23 s13"
# Measured at angles to the rolling direction, as the headers of the sheets in input_files/materials state it.
STEEL = {"r": {0: 1.79, 45: 1.51, 90: 2.27}, "stress": {}}
ALLOY = {"r": {0: 0.2115, 15: 0.3269, 30: 0.6923, 45: 1.5769, 60: 1.0385, 75: 0.5384, 90: 0.6923},
         "stress": {0: 1.0, 15: 0.9605, 30: 0.9102, 45: 0.8114, 60: 0.8096, 75: 0.8815, 90: 0.9102},
         "biaxial": 1.035}


def labels(law):
    """Return labels for the points and materials of the law's input file, by their names: n_0.3 becomes n = 0.3."""
    names = [block.name for block in read_blocks(DECKS / f"{law}.dat") if block.keyword in ("point", "material")]
    return {name.lower(): re.sub(r"^([^_]+)_(?=[\d.]+$)", r"\1 = ", name).replace("_", " ") for name in names}


def legend(axes, **options):
    """Add a small legend."""
    axes.legend(fontsize="small", **options)


def von_mises(program):
    """Return the ends of the paths in the plane of s11 and s22 for a von Mises material."""
    text = pp.deck(DECKS / "von_mises.dat", ["steel"], [], RATIOS, 0.1)
    points = pp.run(program, text)[1]
    return [points[f"p0_{i}"][-1] for i in range(len(RATIOS))]


def orthotropic(program, law, figure, measured=None, compression=False):
    """Draw yield surface, r-values and yield stresses of a sheet."""
    path, materials = pp.names_in(str(DECKS / f"{law}.dat"), program)
    points = pp.run(program, pp.deck(path, materials, ANGLES, RATIOS, 0.1))[1]
    axes = figure.subplot_mosaic([["surface", "r"], ["surface", "stress"]], width_ratios=(1, 1.1))
    normals = np.cos(RATIOS), np.sin(RATIOS)
    pp.draw_surface(axes["surface"], [points[f"p0_{i}"][-1] for i in range(len(RATIOS))], normals, color="C0",
                    label=law)
    pp.draw_surface(axes["surface"], von_mises(program), None, **BROKEN)
    if measured and "biaxial" in measured:
        transverse, both = measured["stress"][90], measured["biaxial"]
        axes["surface"].plot([1, 0, both], [0, transverse, both], **DOTS)
    legend(axes["surface"], loc="upper left")
    ways = [("tension", 0.1, "-")] + ([("compression", -0.1, ":")] if compression else [])
    for label, strain, line in ways:
        points = pp.run(program, pp.deck(path, materials, ANGLES, [], strain))[1]
        for name, value in (("r", pp.r_value), ("stress", pp.yield_stress)):
            values = [abs(value(points[f"t0_{angle}"])) for angle in ANGLES]
            pp.draw_over_angle(axes[name], ANGLES, values, color="C0", linestyle=line, label=label)
    for name in ("r", "stress"):
        if measured and measured[name]:
            axes[name].plot(measured[name].keys(), measured[name].values(), **DOTS)
        axes[name].axhline(1, color="0.55", linestyle="--", linewidth=1.1, zorder=1)
        axes[name].margins(y=0.12)
    axes["r"].set(ylabel="r-value", xlabel="")
    axes["stress"].set(ylabel="stress / flow stress")
    if measured or compression:
        legend(axes["r"])


def isotropic(program, law, figure):
    """Draw yield surfaces in the plane of two normal stresses and in that of a normal and a shear stress."""
    path, materials = pp.names_in(str(DECKS / f"{law}.dat"), program)
    axes = figure.subplots(1, 2)
    points = pp.run(program, pp.deck(path, materials, [], RATIOS, 0.1))[1]
    text = pp.deck(path, [], [], [], 0.1)
    for m, material in enumerate(materials):
        for i, ratio in enumerate(RATIOS):
            text += pp.point(f"q{m}_{i}", material, SHEAR, [([0.05 * np.cos(ratio), 0, 0, 0.05 * np.sin(ratio), 0, 0],
                                                            10)]) + "\n"
    shear, names, normals = pp.run(program, text)[1], labels(law), (np.cos(RATIOS), np.sin(RATIOS))
    for m, material in enumerate(materials):
        style = {"color": f"C{m}", "label": names[material] if len(materials) > 1 else law}
        pp.draw_surface(axes[0], [points[f"p{m}_{i}"][-1] for i in range(len(RATIOS))], normals if m == 0 else None,
                        **style)
        pp.draw_surface(axes[1], [shear[f"q{m}_{i}"][-1] for i in range(len(RATIOS))],
                        (normals[0], 2 * normals[1]) if m == 0 else None, keys=("s11", "s12"), **style)
    if law != "von_mises":
        pp.draw_surface(axes[0], von_mises(program), None, **BROKEN)
    for part in axes:
        part.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5))
    legend(axes[0], loc="upper left")


def tension(program, law, figure, points_of=None):
    """Draw tension as true stress over logarithmic strain and as nominal stress over elongation."""
    axes, names = figure.subplots(1, 2), labels(law)
    for name, rows in deck_run(program, law).items():
        strain, stress = (np.array([row[key] for row in rows]) for key in ("e11", "s11"))
        nominal = stress * np.exp([row["e22"] + row["e33"] for row in rows])
        line, = axes[0].plot(strain, stress, label=names[name])
        axes[1].plot(100 * np.expm1(strain), nominal)
        top = int(np.argmax(nominal))
        if 0 < top < len(rows) - 1:
            axes[0].plot(strain[top], stress[top], "o", color=line.get_color())
            axes[1].plot(100 * np.expm1(strain[top]), nominal[top], "o", color=line.get_color())
    for strain, stress in points_of or ():
        axes[0].plot(strain + stress / 2.1e5, stress, "s", color="black", markersize=3.5, zorder=3)
    axes[0].set(xlabel="logarithmic strain", ylabel="true stress (MPa)", ylim=(0, None))
    axes[1].set(xlabel="elongation (%)", ylabel="nominal stress (MPa)", ylim=(0, None))
    legend(axes[0], loc="lower right")


def deck_run(program, law):
    """Return the rows of the law's input file by point."""
    path = (DECKS / f"{law}.dat").as_posix()
    return pp.run(program, f'*INCLUDE "{path}"\n')[1]


def prager(program, law, figure):
    """Draw a reversal, and large simple shear."""
    points = deck_run(program, law)
    axes = figure.subplots(1, 2)
    for name, colour in (("isotropic", "C1"), ("kinematic", "C0")):
        rows, shear = points[name], points[f"shear_{name}"]
        axes[0].plot(*columns(rows, "e11", "s11"), color=colour, label=name)
        axes[1].plot(*columns(shear, "eqps", "s12"), color=colour, label=f"s12, {name}")
        axes[1].plot(*columns(shear, "eqps", "s11"), color=colour, linestyle=":", label=f"s11, {name}")
    axes[0].set(xlabel="logarithmic strain", ylabel="stress (MPa)", title="tension, compression")
    axes[1].set(xlabel="equivalent plastic strain", ylabel="stress (MPa)", title="simple shear")
    legend(axes[0])
    legend(axes[1])


def lemaitre_chaboche(program, law, figure):
    """Draw reversals of tension and of shear."""
    points = deck_run(program, law)
    axes = figure.subplots(1, 2)
    for name in ("none", "one", "two"):
        axes[0].plot(*columns(points[name], "e11", "s11"), label=name)
        axes[1].plot(*columns(points[f"shear_{name}"], "e12", "s12"))
    axes[0].set(xlabel="logarithmic strain", ylabel="stress (MPa)", title="tension, compression")
    axes[1].set(xlabel="shear strain e12", ylabel="shear stress (MPa)", title="shear, reversed")
    legend(axes[0], title="back-stresses")


def teodosiu_hu(program, law, figure):
    """Draw a reversal, and shear after tension."""
    points = deck_run(program, law)
    axes, names = figure.subplots(1, 2, sharey=True), labels(law)
    for part, way, first in ((axes[0], "compression", "tension"), (axes[1], "shear", "shear")):
        for number, name in enumerate((first, f"{way}_after_0.1", f"{way}_after_0.2")):
            strain, tensile, shear = columns(points[name], "eqps", "s11", "s12")
            flows = np.diff(strain, prepend=0) > 1e-9
            stress = np.where(flows, np.sqrt(tensile**2 + 3 * shear**2), np.nan)
            turned = tensile < 0 if part is axes[0] else shear > 0
            stress = np.where(turned | (number == 0), stress, np.nan)
            style = BROKEN if number == 0 else {"color": f"C{number - 1}"}
            part.plot(strain, stress, **{**style, "label": names[name]})
        part.set(xlabel="equivalent plastic strain", ylim=(0, None))
        legend(part, loc="lower right")
    axes[0].set(ylabel="equivalent stress (MPa)", title="reversed")
    axes[1].set(title="orthogonal")


def yoshida_uemori(program, law, figure):
    """Draw cycles with and without stagnation, and compression after tension."""
    points = deck_run(program, law)
    axes, names = figure.subplots(1, 2), labels(law)
    for name, style in (("cycles_without_stagnation", BROKEN), ("cycles", {"color": "C0"})):
        strain, stress = columns(points[name], "e11", "s11")
        axes[0].plot(100 * strain, stress, **{**style, "label": names[name]})
    for number, name in enumerate(("tension", "compression_after_0.05", "compression_after_0.1")):
        strain, stress = columns(points[name], "eqps", "s11")
        flows = np.diff(strain, prepend=0) > 1e-9
        stress = np.where(flows & (stress * (1 if number == 0 else -1) > 0), abs(stress), np.nan)
        style = BROKEN if number == 0 else {"color": f"C{number - 1}"}
        axes[1].plot(strain, stress, **{**style, "label": names[name]})
    axes[0].set(xlabel="logarithmic strain (%)", ylabel="true stress (MPa)", title="cycles")
    axes[1].set(xlabel="equivalent plastic strain", title="reversed", ylim=(0, None))
    for part in axes:
        legend(part, loc="lower right")


def chord(program, law, figure):
    """Draw tension with unloadings, and the modulus of each over the plastic strain."""
    points = deck_run(program, law)
    axes, names = figure.subplots(1, 2), labels(law)
    for name, style in (("constant", BROKEN), ("chord", {"color": "C0"}), ("table", {"color": "C1"})):
        strain, stress, plastic = columns(points[name], "e11", "s11", "eqps")
        ends = np.flatnonzero(np.isclose(stress, 0, atol=1e-6))[1:]
        modulus = stress[ends - 1] / (strain[ends - 1] - strain[ends]) / 1000
        style = {**style, "label": names[name]}
        last = slice(ends[-1] - 1, ends[-1] + 1)
        axes[0].plot(1000 * (strain[last] - strain[ends[-1] - 1]), stress[last], **style)
        axes[1].plot(plastic[ends], modulus, **{**style, "marker": "o"})
    axes[0].set(xlabel="strain recovered (0.001)", ylabel="true stress (MPa)", title="last unloading")
    axes[1].set(xlabel="equivalent plastic strain", ylabel="Young's modulus (GPa)", title="slope of the unloadings")
    for part in axes:
        legend(part)


def rates(program, law, figure):
    """Draw tension at several strain rates, and with jumps of the rate."""
    points = deck_run(program, law)
    axes, names = figure.subplots(1, 2, sharey=True), labels(law)
    for name, rows in points.items():
        strain, stress = columns(rows, "e11", "s11")
        jumps = name == "jumps"
        axes[int(jumps)].plot(strain, stress, **({"color": "C4"} if jumps else {"label": f"{names[name]} /s"}))
        if name in ("rate_0.001", "rate_1000"):
            axes[1].plot(strain, stress, **{**BROKEN, "label": f"{names[name]} /s"})
    axes[0].set(xlabel="logarithmic strain", ylabel="true stress (MPa)", title="constant rates", ylim=(0, None))
    axes[1].set(xlabel="logarithmic strain", title="jumps of the rate, relaxation at 0.1")
    for part in axes:
        legend(part, loc="lower right")


def fracture(program, law, figure):
    """Draw the damage on several paths, and the strain to fracture in plane stress over the triaxiality."""
    points = deck_run(program, law)
    axes, names = figure.subplots(1, 2), labels(law)
    for name, rows in points.items():
        axes[0].plot(*columns(rows, "eqps", "fracture_damage"), label=names[name])
    ratios = np.radians(np.arange(-45, 46, 1))
    path, materials = pp.names_in(str(DECKS / f"{law}.dat"), program)
    found = pp.run(program, pp.deck(path, materials, [], ratios, 0.1))[1]
    ends = [rows[-1] for name, rows in found.items() if name.startswith("p0_")]
    strain, damage, first, second = columns(ends, "eqps", "fracture_damage", "s11", "s22")
    triaxiality = (first + second) / 3 / np.sqrt(first ** 2 - first * second + second ** 2)
    axes[1].plot(triaxiality, strain / damage, color="C0")
    axes[0].set(xlabel="equivalent plastic strain", ylabel="damage", ylim=(0, 1.1))
    axes[1].set(xlabel="triaxiality", ylabel="plastic strain to fracture", ylim=(0, None))
    legend(axes[0])


def fracture_table(program, law, figure):
    """Draw the strain to fracture of a table over triaxiality and Lode angle, by points of constant stress state, the
    points of the table, and the states of plane stress."""
    angles, levels, stress = np.linspace(-1, 1, 33), np.linspace(-0.1, 0.8, 46), 300.0
    text = FRACTURE.format(" ".join(f"lode{k}={lode:g}" for k, lode in enumerate(LODE, 1)),
                           "  ".join(f"{x:g}:{y:g}" for curve in LODE.values() for x, y in curve))
    for i, lode in enumerate(angles):
        deviator = 2 / 3 * np.cos((1 - lode) * np.pi / 6 - np.array([0, 2, -2]) * np.pi / 3)
        for k, level in enumerate(levels):
            target = " ".join(f"{value:.8g}" for value in stress * (deviator + level))
            text += f"*POINT p{i}_{k}\n  material = steel\n  control = {STRESSES}\n  target = {target} 0 0 0 steps=1\n"
    points = pp.run(program, text)[1]
    strain, damage = (np.array([[points[f"p{i}_{k}"][-1][key] for k in range(len(levels))] for i in range(len(angles))])
                      for key in ("eqps", "fracture_damage"))
    axes = figure.subplots(1, 2)
    image = axes[0].contourf(levels, angles, strain / damage, 12, cmap="viridis")
    figure.colorbar(image, ax=axes[0])
    axes[0].grid(False)
    plane = np.linspace(-np.pi / 4, np.pi / 4, 181)
    first, second = np.cos(plane), np.sin(plane)
    size = np.sqrt(first**2 - first * second + second**2)
    cube = 27 / 2 * (2 * first - second) * (2 * second - first) * -(first + second) / 27 / size**3
    axes[0].plot((first + second) / 3 / size, 1 - 2 / np.pi * np.arccos(np.clip(cube, -1, 1)), **{
        **BROKEN, "color": "white", "label": "plane stress"})
    for k, (lode, curve) in enumerate(LODE.items()):
        x, y = np.array(curve).T
        axes[0].plot(x, np.full(len(x), lode), "o", color="white", markeredgecolor="black", clip_on=False)
        axes[1].plot(levels, (strain / damage)[np.argmin(np.abs(angles - lode))], color=f"C{k}", label=f"{lode:g}")
        axes[1].plot(x, y, "o", color=f"C{k}")
    axes[0].set(xlabel="triaxiality", ylabel="normalised Lode angle", title="plastic strain to fracture")
    axes[1].set(xlabel="triaxiality", title="plastic strain to fracture", ylim=(0, None))
    axes[0].legend(fontsize="small", loc="lower right", labelcolor="white")
    legend(axes[1], title="Lode angle")


def friction(program, law, figure):
    """Draw coefficients over the contact pressure, and over the speed of sliding."""
    axes = figure.subplots(1, 2, sharey=True)
    for label, words in BY_PRESSURE.items():
        axes[0].plot(*coefficients(program, law, words), label=label)
    for label, words in BY_SPEED.items():
        ends = [coefficients(program, law, words, 1000, 5 / speed)[1][-1] for speed in SPEEDS]
        axes[1].plot(SPEEDS, ends, marker="o", markersize=3, label=label)
    axes[0].set(xlabel="contact pressure (MPa)", ylabel="coefficient of friction", ylim=(0, None))
    axes[1].set(xlabel="speed of sliding (mm/s)")
    for part in axes:
        legend(part)


def coefficients(program, law, words, force=15000, duration=1):
    """Return pressures and coefficients of a run of the input file of friction."""
    with tempfile.TemporaryDirectory() as folder:
        settings = {"law": words, "force": force, "duration": f"{duration:.8g}"}
        done = launch(command(program, DECKS / f"{law}.dat", folder, ["--quiet"], settings))
        if done.code != 0:
            raise Problem(done.errors)
        rows = [row for row in read_table(Path(folder) / "history.csv") if row["phase"] == "draw"]
    pressures, along, normal = (column.astype(float) for column in columns(rows, "die_pressure", "die_fx", "die_fz"))
    return pressures, along / normal


def columns(rows, *keys):
    """Return columns of rows."""
    return [np.array([row[key] for row in rows]) for key in keys]


TABLE = ((0, 160), (0.02, 230), (0.1, 310), (0.25, 400), (0.5, 480))
# Strains to fracture over the triaxiality by the normalised Lode angle: the example of docs/laws/table.md.
LODE = {-1: ((0, 1.4), (0.667, 0.9)), 0: ((0, 0.7), (0.577, 0.5)), 1: ((0, 1.1), (0.333, 0.9))}
STRESSES = "s11 s22 s33 s12 s23 s13"
FRACTURE = """*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = linear Y0=200 H=1000
  fracture = table {} {}
"""
# Laws of friction of the picture, 0.15 times their factors, and speeds of sliding, mm/s.
BY_PRESSURE = {"power n = 0.8": "power p0=10 n=0.8 p_min=2 p_max=100", "power n = 0.9": "power p0=10 n=0.9 p_min=2",
               "table": "table 0:1.1 20:0.9 100:0.7"}
BY_SPEED = {"stribeck n = 1": "stribeck v0=20 r=0.6 n=1", "stribeck n = 2": "stribeck v0=20 r=0.6 n=2",
            "speed_table": "speed_table 0:1 30:0.8 80:0.9"}
SPEEDS = np.array([0.1, *range(5, 105, 5)])
PICTURES = {
    "von_mises": (isotropic, {}), "hill48": (orthotropic, {"measured": STEEL}), "hosford": (isotropic, {}),
    "yld91": (orthotropic, {"measured": STEEL}), "karafillis_boyce": (orthotropic, {}),
    "drucker": (orthotropic, {"measured": STEEL}), "cazacu_barlat2001": (orthotropic, {"measured": STEEL}),
    "yld2004": (orthotropic, {"measured": ALLOY}), "cpb06": (orthotropic, {"compression": True}),
    "yld2000": (orthotropic, {"measured": ALLOY}), "bbc2008": (orthotropic, {"measured": ALLOY}),
    **{law: (tension, {}) for law in ("perfect", "linear", "swift", "voce", "swift_voce", "ludwik",
                                      "hockett_sherby")},
    "table": (tension, {"points_of": TABLE}), "teodosiu_hu": (teodosiu_hu, {}),
    "yoshida_uemori": (yoshida_uemori, {}), "chord": (chord, {}),
    **{law: (rates, {}) for law in ("cowper_symonds", "johnson_cook", "power", "curves")}, "prager": (prager, {}),
    "hosford_coulomb": (fracture, {}), "fracture_table": (fracture_table, {}),
    "lemaitre_chaboche": (lemaitre_chaboche, {}), "friction": (friction, {}),
}


def save(figure, path):
    """Write a picture of 64 colours, which keeps it small."""
    memory = io.BytesIO()
    figure.savefig(memory, dpi=110)
    try:
        Image.open(memory).convert("RGB").quantize(64).save(path, optimize=True)
    except OSError as error:
        raise Problem(f"{path}: {error.strerror}") from None


def main():
    """Draw the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("law", nargs="*", help="law to draw (default: all)")
    parser.add_argument("--program", default="dd3imp", help="the program dd3imp (default: the one on the path)")
    parser.add_argument("--output", type=Path, default=ROOT / "docs" / "images" / "laws", help="folder of the pictures")
    options = parser.parse_args()
    for law in options.law:
        if law not in PICTURES:
            raise Problem(f"no law {law}; there are: {', '.join(PICTURES)}")
    options.output.mkdir(parents=True, exist_ok=True)
    for law in each(options.law or PICTURES, "pictures"):
        draw, settings = PICTURES[law]
        with matplotlib.rc_context(STYLE):
            figure = Figure(figsize=(8, 3.8), layout="constrained")
            draw(options.program, law, figure, **settings)
            save(figure, options.output / f"{law}.png")


if __name__ == "__main__":
    run(main)

"""Draw materials at a point: values and pictures of utils/plot_point.py, pictures of the laws, messages on bad input.
Skipped (77) without the packages.

    points.py --program build/release/dd3imp
"""

import argparse
import contextlib
import importlib.util
import io
import math
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "utils"))
if any(importlib.util.find_spec(name) is None for name in ("matplotlib", "numpy")):
    print("skipped: the packages of utils/requirements.txt are not installed")
    sys.exit(77)

import law_pictures  # noqa: E402
import plot_point  # noqa: E402
import results  # noqa: E402
from scripts import Problem  # noqa: E402

plt = plot_point.plt
SHEETS = ROOT / "input_files" / "materials"
# Hill's criterion and Swift's law, for which all values are known.
F, G, H, N = 0.284, 0.358, 0.642, 1.289
STEEL = f"""*MATERIAL Steel
  young = 2.1e5
  poisson = 0.3
  yield = hill48 F={F} G={G} H={H} L={N} M={N} N={N}
  hardening = swift K=565 e0=0.007117 n=0.259
"""
MISES = STEEL.replace("Steel", "round").replace("hill48", "von_mises #")


def close(value, wanted, tolerance=1e-3):
    assert abs(value - wanted) <= tolerance * max(1, abs(wanted)), f"{value}, expected {wanted}"


def call(module, *arguments, expect=None):
    """Run a script and return its figure; with `expect` it must end with a message that contains it."""
    plt.close("all")
    before, sys.argv = sys.argv, ["script", *map(str, arguments)]
    try:
        with contextlib.redirect_stderr(io.StringIO()) as said:
            module.main()
    except (Problem, SystemExit) as end:
        message = f"{said.getvalue()}{end}"
        assert expect and expect in message, f"{arguments}: {message}"
        return None
    finally:
        sys.argv = before
    assert not expect, f"{arguments}: no message, expected: {expect}"
    return plt.gcf()


def check_values(program, file):
    """Check tension, r-values, surface and normals against Hill's and Swift's formulas."""
    path, names = plot_point.names_in(f"{file}:STEEL")
    assert (path, names) == (str(file), ["steel"]), (path, names)
    ratios = plot_point.np.radians([0, 30, 80, 200])
    points = plot_point.run(program, plot_point.deck(path, names, [0, 45, 90], ratios, 0.2))
    stress = points["t0_0"][-1]["s11"]
    close(stress, 565 * (0.007117 + 0.2 - stress / 2.1e5) ** 0.259, 1e-6)
    for angle, r, stress in ((0, H / G, 1), (45, N / (F + G) - 0.5, 2 / math.sqrt(F + G + 2 * N)),
                             (90, H / F, 1 / math.sqrt(F + H))):
        close(plot_point.r_value(points[f"t0_{angle}"]), r)
        close(plot_point.yield_stress(points[f"t0_{angle}"]), stress)
    for i, ratio in enumerate(ratios):
        end = points[f"p0_{i}"][-1]
        x, y = (end[key] / end["flow_stress"] for key in ("s11", "s22"))
        close((G + H) * x * x + (F + H) * y * y - 2 * H * x * y, 1, 1e-6)
        normal = math.atan2((F + H) * y - H * x, (G + H) * x - H * y)
        close(math.cos(normal - ratio), 1, 1e-4)


def check_pictures(program, folder):
    """Check a picture of two files, of finished runs, and pictures of laws."""
    picture = folder / "both.png"
    files = folder / "steel.dat", folder / "round.dat:round"
    figure = call(plot_point, *files, "--program", program, "--output", picture)
    assert picture.read_bytes()[:4] == b"\x89PNG"
    tension, r_values, stresses, surface = figure.axes
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["steel", "round"], labels
    assert (len(tension.lines), len(r_values.lines), len(stresses.lines)) == (6, 2, 2)
    assert len(surface.lines) == len(surface.collections) == 2
    close(max(r_values.lines[0].get_ydata()), H / F)
    assert all(abs(value - 1) < 1e-3 for value in r_values.lines[1].get_ydata())
    close(max(surface.lines[1].get_xdata()), 2 / math.sqrt(3))

    deck = folder / "run.dat"
    deck.write_text(STEEL + plot_point.point("pull", "steel", plot_point.TENSION, [([0.1, 0, 0, 0, 0, 0], 10)]) + "\n")
    assert results.launch([program, "--quiet", deck]).code == 0
    run = folder / "run.out"
    figure = call(plot_point, "--run", run, "--run", run / "history.csv", "--output", folder / "run.svg")
    assert "<svg" in (folder / "run.svg").read_text()
    assert [line.get_label() for line in figure.axes[0].lines] == ["run, pull"] * 2

    for law in ("hill48", "swift", "prager"):
        call(law_pictures, law, "--program", program, "--output", folder)
        assert (folder / f"{law}.png").read_bytes() == (folder / f"{law}.png").read_bytes()[:60000], f"{law} is large"


def check_messages(program, folder):
    """Check the messages on bad input."""
    (folder / "empty.dat").write_text("*TITLE\n  nothing\n")
    (folder / "wrong.dat").write_text(STEEL.replace("hill48", "hil48"))
    (folder / "binary.dat").write_bytes(b"\xff\xfe\x00*MATERIAL x")
    (folder / "history.csv").write_text("increment,phase\n0,draw\n")
    (folder / "cut.csv").write_text("increment,point,e11,s11\n0,p,0,0\n1,p,0.1\n")
    end = ("--program", program, "--output", folder / "none.png")
    steel = folder / "steel.dat"
    for arguments, said in (
            (("nowhere.dat", *end), "nowhere.dat: No such file"), ((folder, *end), "Is a directory"),
            ((folder / "empty.dat", *end), "empty.dat: no *MATERIAL"), ((folder / "binary.dat", *end), "not a text"),
            ((f"{steel}:iron", *end), "no *MATERIAL iron; there are: steel"),
            ((folder / "wrong.dat", *end), "did you mean 'hill48'"),
            ((steel, "--program", folder / "no_program"), "no_program: no such program"),
            ((steel, "--program", program, "--output", folder / "no" / "none.png"), "No such file"),
            ((steel, "--program", program, "--output", folder / "none.xyz"), "none.xyz: Format 'xyz' is not supported"),
            (("--run", folder / "no.out"), "no.out: No such file"),
            (("--run", folder / "cut.csv"), "cut.csv: row 2 does not hold a number in each column"),
            (("--run", folder), "history.csv: not the history of single points"), ((), "a file or a --run is needed")):
        call(plot_point, *arguments, expect=said)
    assert not (folder / "none.png").exists()
    call(law_pictures, "hill84", expect="no law hill84; there are: von_mises")
    call(plot_point, steel, "--strain", -1, expect="positive numbers")
    call(law_pictures, "swift", "--program", program, "--output", folder / "made")
    assert (folder / "made" / "swift.png").is_file()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the program dd3imp")
    program = str(Path(parser.parse_args().program).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "parts.inc").write_text(STEEL)
        (folder / "steel.dat").write_text("# the sheet\n*INCLUDE parts.inc\n")
        (folder / "round.dat").write_text(STEEL + MISES)
        check_values(program, folder / "steel.dat")
        check_pictures(program, folder)
        check_messages(program, folder)
    print("materials drawn")


main()

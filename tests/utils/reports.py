"""Check section.py and report.py with a made-up run of a U profile and wrong input. Skipped (77) without packages."""

import csv
import importlib.util
import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path

UTILS = Path(__file__).resolve().parents[2] / "utils"
if any(importlib.util.find_spec(name) is None for name in ("h5py", "matplotlib", "numpy", "pyvista")):
    print("skipped: the packages of utils/requirements.txt are not installed")
    sys.exit(77)

import h5py  # noqa: E402
import numpy as np  # noqa: E402

sys.path.insert(0, str(UTILS))
from forming_limit import ZONES, keeler_brazier, read_curve  # noqa: E402

# Parts of the profile: length along it and turn. The wall is an arc of radius 100 mm.
PARTS = [(20.0, 0.0), (5 * math.radians(80), math.radians(80)), (40.0, 0.4), (5 * math.radians(75), -math.radians(75)),
         (20.0, 0.0)]
ENDS = np.concatenate(([0.0], np.cumsum([part[0] for part in PARTS])))
HISTORY = """# units: -,-,mm,-,mm,mm,mm,N,N,N,-,mm2,MPa,mJ,mJ,mJ,mJ,N,mm
increment,phase,travel,progress,punch_ux,punch_uy,punch_uz,punch_fx,punch_fy,punch_fz,punch_contacts,punch_area,\
punch_pressure,tool_work,external_work,friction_work,energy_error,rib_restraint,rib_length
0,draw,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0
1,draw,2,1,0,0,-2,0,0,2500,4,10,250,5000,0,100,5,300,10
"""
STATUS = "phase,travel,outcome,iterations,solver_iterations,limiter\ndraw,2,accepted,5,0,rotation\n"
LOG = """dd3imp 0.1.0: job.dat
A profile & its <report>
started 2026-01-01 00:00
*MATERIAL steel
  hardening = swift K=565 e0=0.007117 n=0.2
linear solver: umfpack
warning: the mesh is coarse
1 increments, 0 cut back; 5 iterations; 1.5 s
time by section, s:
  material      1.0
reached the end; results in job.out
"""


def profile(count=10):
    """Return the lengths along the profile, and position and direction there."""
    length, points, angles = [0.0], [np.zeros(2)], [0.0]
    for part, turn in PARTS:
        for _ in range(count):
            step, half = part / count, turn / count / 2
            chord = step * (math.sin(half) / half if half else 1.0)
            angle = angles[-1] + half
            points.append(points[-1] + chord * np.array([math.cos(angle), math.sin(angle)]))
            angles.append(angle + half)
            length.append(length[-1] + step)
    return np.array(length), np.array(points), np.array(angles)


def make_run(folder):
    """Write the results of a flat strip that became the profile at its upper face."""
    length, points, angles = profile()
    n, widths = len(length), (0.0, 5.0, 10.0)
    normal = np.column_stack([-np.sin(angles), np.cos(angles)])
    start, now = [], []
    for y in widths:
        for z in (0.0, 1.0):
            start.append(np.column_stack([length, np.full(n, y), np.full(n, z)]))
            place = points - (1 - z) * normal
            now.append(np.column_stack([place[:, 0], np.full(n, y), place[:, 1]]))
    start, now = np.concatenate(start), np.concatenate(now)
    cells = [[2 * j * n + i + a for a in (0, 1, 2 * n + 1, 2 * n, n, n + 1, 3 * n + 1, 3 * n)]
             for j in range(2) for i in range(n - 1)]
    run = folder / "job.out"
    run.mkdir()
    for name, text in (("history.csv", HISTORY), ("status.csv", STATUS), ("job.log", LOG)):
        (run / name).write_text(text)
    with h5py.File(run / "fields.vtkhdf", "w") as file:
        grid = file.create_group("VTKHDF")
        grid["NumberOfPoints"], grid["NumberOfCells"], grid["NumberOfConnectivityIds"] = \
            [len(start)], [len(cells)], [8 * len(cells)]
        grid["Types"], grid["Connectivity"] = np.full(len(cells), 12, np.uint8), np.ravel(cells)
        grid["Offsets"], grid["Points"] = 8 * np.arange(len(cells) + 1), np.vstack([start, now])
        steps = grid.create_group("Steps")
        steps.attrs["NSteps"] = 2
        steps["Values"], steps["PointOffsets"] = [0.0, 2.0], [0, len(start)]
        one = np.ones(len(start))
        for name, (first, last) in {"thickness": (1, 1 - start[:, 0] / 1000), "thinning": (0, start[:, 0] / 1000),
                                    "draw_in": (0, 0.5), "equivalent_plastic_strain": (0, 0.1),
                                    "major_strain_middle": (0, start[:, 0] / 200), "minor_strain_middle": (0, -0.02),
                                    }.items():
            grid[f"PointData/{name}"] = np.concatenate([first * one, last * one])
            steps[f"PointDataOffsets/{name}"] = [0, len(start)]
    return run


def call(script, *arguments, expect=0):
    done = subprocess.run([sys.executable, UTILS / script, *map(str, arguments)], capture_output=True, text=True)
    said = done.stdout + done.stderr
    assert done.returncode == expect and "Traceback" not in said, f"{script} {arguments}: {done.returncode}\n{said}"
    return said


def check_section(run, folder):
    """Check table, lines of nodes, and angles and radius of the profile."""
    words = [word for name, part in (("bottom", 0), ("wall", 2), ("flange", 4))
             for word in (f"--{name}", ENDS[part], ENDS[part + 1])]
    for plane in ("y=0", "y=2.5"):
        said = call("section.py", run, "--plane", plane, *words, "--table", folder / "s.csv",
                    "--output", folder / "s.png")
        for name, value in (("angle between bottom and wall", 100), ("angle between wall and flange", 105),
                            ("radius of the wall", 100)):
            found = float(re.search(f"{name}: ([0-9.]+)", said)[1])
            assert abs(found - value) < 0.05, f"{plane}: {name} {found}, expected {value}"
        rows = list(csv.DictReader((folder / "s.csv").open()))
        assert abs(float(rows[-1]["length0"]) - ENDS[-1]) < 1e-3 and len(rows) == 51
        for row in rows:
            assert abs(float(row["thickness"]) - 1 + float(row["x0"]) / 1000) < 1e-6, row
    call("section.py", run, "--nodes", 1, 2, 3, "--table", folder / "s.csv", "--output", folder / "s.svg")
    assert len((folder / "s.csv").read_text().splitlines()) == 4
    for words, said in ((("--plane", "y=50"), "does not cut the sheet"), (("--plane", "q=1"), "plane 'q=1'"),
                        (("--nodes", 1, 9999), "the nodes are 1 to"), (("--field", "nosuch"), "no field 'nosuch'"),
                        (("--wall", 0, 1), "expected 3 or more"), (("--flange", 0, 1), "need --wall")):
        assert said in call("section.py", run, *words, "--output", folder / "s.png", expect=2), words


def check_limit(folder):
    """Check the curve of Keeler and Brazier, the zones, and measured curves."""
    curve = keeler_brazier(1.0, 0.21)
    plane = math.log(1.3743)
    assert abs(curve.limit(0.0) - plane) < 1e-12 and abs(curve.limit(-0.9) - plane - 0.9) < 1e-12
    assert abs(curve.limit(0.6) - plane - 0.36) < 1e-12 and keeler_brazier(1.0, 0.5).limit(0.0) == curve.limit(0.0)
    assert abs(keeler_brazier(0.8, 0.105).limit(0.0) - math.log1p(0.5 * 0.34604)) < 1e-12
    major, minor = np.array([0.4, 0.25, 0.15, 0.2, 0.001]), np.array([0.0, 0.0, 0.0, -0.3, 0.0])
    names = [ZONES[zone] for zone in curve.zones(major, minor, 0.1)]
    assert names == ["critical", "marginal", "safe", "wrinkling", "no strain"], names
    file = folder / "curve.csv"
    file.write_text("# minor, major\n0.3, 0.45\n-0.2 0.5\n0, 0.3\n")
    assert abs(read_curve(file).limit(-0.1) - 0.4) < 1e-12
    assert abs(read_curve(file, engineering=True).limit(0.0) - math.log(1.3)) < 1e-12


def check_report(run, folder):
    """Check that the page is complete and needs no other file."""
    call("report.py", run, "--mirror", "x", "y", "--output", folder / "report")
    text = (folder / "report" / "report.html").read_text()
    for title in ("Result", "Thinning", "Sheet and tools", "Forming limit", "Thickness along sections",
                  "Outline and draw-in", "Forces in phase draw", "Draw-beads", "Warnings", "Run", "Set-up"):
        assert f"<h2>{title}</h2>" in text, title
    assert "A profile &amp; its &lt;report&gt;" in text and "warning: the mesh is coarse" in text
    assert "Keeler-Brazier" not in text and "10 kN, 250 MPa" in text and "0.1 %" in text
    assert all(source.startswith("data:image/png") for source in re.findall(r'src="([^"]{20})', text))
    assert "at most 1.2 kN, at the end 1.2 kN; on the sheet 40 mm at most" in text
    assert not re.search(r"(href|url)\b", text)
    for name in ("thinning", "sheet", "limit", "zones", "sections", "outline", "force", "beads"):
        assert (folder / "report" / f"{name}.png").read_bytes()[:4] == b"\x89PNG", name
    (folder / "bad.csv").write_text("0 0.3\n0.1 a\n")
    assert "bad.csv:2: error: expected minor" in call("report.py", run, "--curve", folder / "bad.csv", "--output",
                                                      folder / "report", expect=2)
    assert "No such file" in call("report.py", folder / "none.out", "--output", folder / "other", expect=2)
    assert not (folder / "other").exists()


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run = make_run(folder)
        check_limit(folder)
        check_section(run, folder)
        check_report(run, folder)
    print("sections and reports made")


main()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of modulus, rate, temperature, friction and fracture identified from tables and curves: exact ones, which the
library of the laws computes, and such with scatter; what is refused and what is noted."""

import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from helpers import ROOT, call
from scipy.integrate import solve_ivp

import dd3
from dd3 import places
from dd3.tables import read_table

with_library = pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="without the library of the laws")
STEEL = {"young": 2.06e5, "poisson": 0.3, "yield": "von_mises"}
SWIFT = "swift K=565.32 e0=0.007117 n=0.2589"


def write(name, *columns, heading=""):
    """Write a table of numbers."""
    rows = [heading] * bool(heading) + [" ".join(f"{value:.12g}" for value in row) for row in zip(*columns)]
    Path(name).write_text("\n".join(rows) + "\n")


def identified(program, *words, command="identify"):
    """Return what is written for a material, and what is said."""
    said = call(command, "steel", *words, *([] if "--starts" in words else ["--starts", 1]), "--program", program)
    return re.sub(r" &\n +", " ", Path("steel.dat").read_text()), said


def numbers(text, key):
    """Return the parameters of the law in a line of the file."""
    line = re.search(rf"^  {key} = (.*)$", text, re.MULTILINE)[1]
    return {name: float(value) for name, value in re.findall(r"(\w+)=(\S+)", line)}


def points(text, key):
    """Return the pairs of the law in a line of the file."""
    line = re.search(rf"^  {key} = (.*)$", text, re.MULTILINE)[1]
    return np.array([[float(one) for one in pair.split(":")] for pair in re.findall(r"\S+:\S+", line)])


def rate_factor(law, rates):
    """Return the factors of a law of the rate, by the library."""
    material = dd3.material({**STEEL, "hardening": "perfect Y0=100", "rate": law})
    place = material.state_names.index("plastic_strain_rate")
    return np.array([material.flow_stress(one * np.eye(material.state_size)[place]) for one in rates]) / 100


def temperature_factor(law, degrees):
    """Return the factors of a law of the temperature, by the library."""
    return np.array([dd3.material({**STEEL, "hardening": "perfect Y0=100", "temperature": law,
                                   "initial_temperature": float(one)}).flow_stress() for one in degrees]) / 100


def young_of(law, strains):
    """Return the moduli of a law, from the tangent of the library."""
    material = dd3.material({**STEEL, "hardening": "perfect Y0=100", "modulus": law})
    found = []
    for strain in strains:
        point = material.point()
        point.state[0] = strain
        assert point.update([1e-8, 0, 0, 0, 0, 0])
        found.append(1 / np.linalg.inv(point.tangent)[0, 0])
    return np.array(found)


@with_library
def test_chord(program):
    """Check the chord modulus: exact moduli in GPa with its start, scattered ones, a table."""
    strains = np.array([0, 0.01, 0.02, 0.04, 0.08, 0.15])
    exact = young_of("chord Ea=1.63e5 xi=30.8", strains)
    assert exact == pytest.approx(1.63e5 + 0.43e5 * np.exp(-30.8 * strains), rel=1e-9)
    write("moduli.txt", exact / 1e3, 100 * strains, heading="modulus[GPa] strain[%]")
    text, _ = identified(program, "--modulus", "chord", "--moduli", "moduli.txt", "--plot", "moduli.png")
    assert numbers(text, "modulus") == pytest.approx({"Ea": 1.63e5, "xi": 30.8}, rel=2e-5)
    assert float(re.search(r"young = (\S+)", text)[1]) == pytest.approx(2.06e5, rel=1e-5)
    assert "# Note: measured" not in text and "determine" not in text and Path("moduli.png").is_file()
    text, _ = identified(program, "--modulus", "chord", "--moduli", "moduli.txt", "--young", 206000, "--fix",
                         "modulus.Ea=163000")
    assert numbers(text, "modulus") == pytest.approx({"Ea": 1.63e5, "xi": 30.8}, rel=2e-5)
    text, _ = identified(program, "--modulus", "table", "--moduli", "moduli.txt")
    assert points(text, "modulus") == pytest.approx(np.array([strains, exact]).T, rel=5e-6)
    random = np.random.default_rng(5)
    many = np.linspace(0, 0.15, 40)
    scattered = young_of("chord Ea=1.63e5 xi=30.8", many) * (1 + 0.01 * random.standard_normal(40))
    write("moduli.txt", many, scattered)
    text, _ = identified(program, "--modulus", "chord", "--moduli", "moduli.txt")
    assert numbers(text, "modulus")["Ea"] == pytest.approx(1.63e5, rel=0.02)
    assert numbers(text, "modulus")["xi"] == pytest.approx(30.8, rel=0.25)
    off = float(re.search(r"root mean square over 40 moduli: (\S+) MPa, largest", text)[1])
    assert off == pytest.approx(0.01 * scattered.mean(), rel=0.3)
    text, _ = identified(program, "--modulus", "table", "--moduli", "moduli.txt")
    assert (np.diff(points(text, "modulus")[:, 1]) <= 0).all() and len(points(text, "modulus")) == 8


RATES = np.array([1e-3, 1e-2, 0.1, 1, 10, 100, 1000])


@with_library
@pytest.mark.parametrize("law", ["cowper_symonds C=40 p=5", "johnson_cook C=0.02 reference=0.001",
                                 "power m=0.015 reference=0.003"])
def test_rate_ratios(program, law):
    """Check laws of the rate from ratios to the slowest test, and a table."""
    name = law.split()[0]
    exact = rate_factor(law, RATES)
    write("ratios.txt", RATES, exact / exact[0], heading="rate ratio")
    text, _ = identified(program, "--rate", name, "--rate-ratios", "ratios.txt", "--plot", "rate.png")
    wanted = {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", law)}
    assert numbers(text, "rate") == pytest.approx(wanted, rel=1e-4), text
    assert "largest 0.0000" in text and ("has to be divided" in text) == (exact[0] > 1.001)
    write("ratios.txt", RATES, exact)
    text, _ = identified(program, "--rate", name, "--rate-ratios", "ratios.txt", "--rate-reference", 0)
    assert numbers(text, "rate") == pytest.approx(wanted, rel=1e-4), text
    text, _ = identified(program, "--rate", "table", "--rate-ratios", "ratios.txt")
    assert points(text, "rate") == pytest.approx(np.array([RATES, exact]).T, rel=1e-5)
    scattered = exact * (1 + 0.005 * np.random.default_rng(2).standard_normal(len(RATES)))
    write("ratios.txt", RATES, scattered)
    text, _ = identified(program, "--rate", name, "--rate-ratios", "ratios.txt", "--rate-reference", 0)
    again = rate_factor(re.search(r"  rate = (.*)", text)[1], RATES)
    assert again == pytest.approx(exact, abs=0.012)


@with_library
def test_temperature_ratios(program):
    """Check laws of the temperature from ratios: exact, scattered, with the melting temperature given, a table."""
    warm = np.array([20, 100, 180, 260, 340])
    exact = temperature_factor("johnson_cook Tr=20 Tm=650 m=1.3", warm)
    assert exact == pytest.approx(1 - ((warm - 20) / 630) ** 1.3)
    write("ratios.txt", warm, exact, heading="temperature(°C) ratio")
    for fixed in ([], ["--fix", "temperature.Tm=650"]):
        text, _ = identified(program, "--temperature", "johnson_cook", "--temperature-ratios", "ratios.txt", *fixed)
        assert numbers(text, "temperature") == pytest.approx({"Tr": 20, "Tm": 650, "m": 1.3}, rel=1e-4)
        assert "initial_temperature" not in text
    text, _ = identified(program, "--temperature", "table", "--temperature-ratios", "ratios.txt", "--plot", "t.png")
    assert points(text, "temperature") == pytest.approx(np.array([warm, exact]).T, rel=1e-5)
    write("ratios.txt", warm + 273, exact * (1 + 0.01 * np.random.default_rng(1).standard_normal(5)))
    text, _ = identified(program, "--temperature", "johnson_cook", "--temperature-ratios", "ratios.txt")
    assert "initial_temperature = 293" in text
    law = re.search(r"  temperature = (.*)", text)[1]
    assert temperature_factor(law, warm + 273) == pytest.approx(exact, abs=0.03)


def swift(plastic):
    """Return the flow stress of SWIFT, MPa."""
    return 565.32 * (0.007117 + plastic) ** 0.2589


def curve(rate, inverse, hardening=swift, end=0.2, rows=41):
    """Return strains and stresses of tension at a rate, 1/s, by an integration of the rate of the plastic strain, which
    is the inverse of the factor: independent of the program. Rows from a plastic strain of about 0.002 on."""
    def speed(strain, plastic):
        return [inverse(2.06e5 * (strain - plastic[0]) / hardening(plastic[0])) / rate]

    strain = np.linspace(0.004, end, rows)
    solved = solve_ivp(speed, (0, end), [0.0], "LSODA", strain, rtol=1e-10, atol=1e-13)
    return strain, 2.06e5 * (strain - solved.y[0])


INVERSE = {"cowper_symonds C=4000 p=4": lambda ratio: 4000 * max(ratio - 1, 0) ** 4,
           "johnson_cook C=0.02 reference=0.0001": lambda ratio: 1e-4 * np.exp((min(ratio, 9) - 1) / 0.02) if ratio > 1
           else 0.0}
RANGE = (0.001, 1, 100)


def write_curves(law, scatter=0.0):
    """Write curves at three rates; return the argument of --rate-curves."""
    random = np.random.default_rng(4)
    for rate in RANGE:
        strain, stress = curve(rate, INVERSE[law])
        write(f"{rate}.txt", strain, stress * (1 + scatter * random.standard_normal(len(strain))),
              heading="strain stress")
    return [f"{rate}:{rate}.txt" for rate in RANGE]


@pytest.mark.parametrize("law", INVERSE)
def test_rate_curves(program, law):
    """Check hardening and rate together from curves at three rates, the rate alone with the hardening given, and both
    from curves with scatter."""
    name, wanted = law.split()[0], {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", law)}
    words = ["--rate", name, "--young", 206000, "--starts", 1, "--rate-curves", *write_curves(law)]
    if name == "johnson_cook":
        words += ["--fix", "rate.reference=1e-4"]
    text, said = identified(program, "swift", *words, command="fit")
    assert numbers(text, "hardening") == pytest.approx({"K": 565.32, "e0": 0.007117, "n": 0.2589}, rel=1e-4), said
    assert numbers(text, "rate") == pytest.approx(wanted, rel=1e-4), said
    text, said = identified(program, *words, "--hardening", SWIFT)
    assert numbers(text, "rate") == pytest.approx(wanted, rel=1e-4), said
    write_curves(law, 0.005)
    text, said = identified(program, "swift", *words, command="fit")
    assert numbers(text, "hardening") == pytest.approx({"K": 565.32, "e0": 0.007117, "n": 0.2589}, rel=0.06), said
    off = [float(one) for one in re.findall(r"root mean square over 41 rows: (\S+) MPa", text)]
    assert len(off) == 3 and all(0.0035 < one / 340 < 0.0065 for one in off), said


@with_library
def test_flow_curves(program):
    """Check the law of flow curves from curves at three rates: its stresses miss them by less than a percent, and it
    does not fall with the rate although one curve is a repetition with scatter."""
    law = "cowper_symonds C=4000 p=4"
    words = [*write_curves(law), "0.002:0.001.txt"]
    text, said = identified(program, "swift", "--rate", "curves", "--young", 206000, "--rate-curves", *words,
                            "--plot", "curves.png", command="fit")
    rate = re.search(r"  rate = curves (.*)", text)[1]
    assert rate.startswith("r1=0.001 r2=0.002 r3=1 r4=100 0:") and rate.count(" 0:") == 4
    values = points(text, "rate")[:, 1].reshape(4, -1)
    assert values.shape == (4, 8) and (np.diff(values, axis=0) >= -1e-4).all() and (np.diff(values) > 0).all()
    steps = 400
    material = dd3.material({**STEEL, "hardening": re.search(r"  hardening = (.*)", text)[1], "rate": f"curves {rate}"})
    strain, stress = curve(100, INVERSE[law])
    found = material.curve(0.2, steps=steps, rate=100)
    assert np.interp(strain, found["strain"], found["stress"]) == pytest.approx(stress, rel=0.01), said


def test_temperature_curves(program):
    """Check hardening, rate and temperature together from curves of a flow stress without hardening by the rate."""
    def warm_curve(rate, degrees):
        factor = 1 - ((degrees - 20) / 630) ** 0.8
        strain, stress = curve(rate, INVERSE["cowper_symonds C=4000 p=4"], lambda plastic: factor * swift(plastic))
        write(f"{rate}_{degrees}.txt", strain, stress)
        return f"{rate}_{degrees}.txt"

    cold = [f"{rate}:{warm_curve(rate, 20)}" for rate in RANGE]
    warm = [f"{degrees}:{warm_curve(0.001, degrees)}" for degrees in (20, 150, 300)]
    text, said = identified(program, "swift", "--rate", "cowper_symonds", "--rate-curves", *cold, "--temperature",
                            "johnson_cook", "--temperature-curves", *warm, "--young", 206000, "--starts", 1,
                            command="fit")
    assert numbers(text, "hardening") == pytest.approx({"K": 565.32, "e0": 0.007117, "n": 0.2589}, rel=1e-4), said
    assert numbers(text, "rate") == pytest.approx({"C": 4000, "p": 4}, rel=1e-4), said
    assert numbers(text, "temperature") == pytest.approx({"Tr": 20, "Tm": 650, "m": 0.8}, rel=1e-4), said


@pytest.mark.parametrize("values, noted", [("true", False), ("nominal", True), ("beyond necking", True)])
def test_nominal_values(program, values, noted):
    """Check the note on a curve that no tension test gives: its slope falls below its stress, at a strain of n."""
    strain = np.linspace(0.002, 0.45 if values == "beyond necking" else 0.24, 40)
    stress = swift(strain)
    if values == "nominal":
        strain, stress = np.expm1(strain), stress / np.exp(strain)
    write("tension.txt", strain, stress)
    text, _ = identified(program, "swift", "tension.txt", command="fit")
    found = re.search(r"# Note: from the strain (\S+) on a curve rises by less than its stress", text)
    assert bool(found) == noted and (not found or 0.02 < float(found[1]) < 0.2589), text


@with_library
def test_ratios_and_curve(program):
    """Check that a curve beside ratios is one of the reference rate: the hardening law is that at rest, and with a
    law of the modulus."""
    law = "cowper_symonds C=4000 p=4"
    write("curve.txt", *curve(0.01, INVERSE[law]))
    rates = np.array([0.01, 1, 100])
    ratios = rate_factor(law, rates)
    write("ratios.txt", rates, ratios / ratios[0])
    write("moduli.txt", [0, 0.02, 0.1], [206, 206, 206], heading="strain modulus(GPa)")
    text, said = identified(program, "--hardening", "swift", "--curve", "curve.txt", "--rate", "cowper_symonds",
                            "--rate-ratios", "ratios.txt", "--modulus", "table", "--moduli", "moduli.txt", "--plot",
                            "both.png")
    assert numbers(text, "rate") == pytest.approx({"C": 4000, "p": 4}, rel=1e-4), said
    assert numbers(text, "hardening") == pytest.approx({"K": 565.32, "e0": 0.007117, "n": 0.2589}, rel=1e-4), said
    assert Path("both.png").is_file() and Path("both_laws.png").is_file()


def friction_words(text):
    """Return the coefficient, and the parameters of each law, of a file with lines of *TOOL."""
    laws = {name: {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", rest)}
            for name, rest in re.findall(r"friction_law = (\w+) (.*)", text)}
    return float(re.search(r"friction = (\S+)", text)[1]), laws


def test_friction_that_rises(program):
    """A coefficient that rises with the speed is outside of Stribeck's curve, whose factor ends at 1: the nearest one
    is constant, by r = 1 or by a speed v0 far below the data with any r, which a note tells."""
    speed = np.array([1, 5, 15, 40, 80])
    write("mu.csv", speed, 0.1 * (1 + 0.005 * speed), heading="speed[mm/s] mu")
    text, _ = identified(program, "--friction", "stribeck", "--friction-data", "mu.csv", "--fix", "stribeck.n=1")
    found = [float(line.split()[4]) for line in text.splitlines() if line.startswith("# speed ")]
    assert len(found) == 5 and np.ptp(found) < 1e-3
    assert "stribeck.r is at the end of its range" in text or "the data determine 1 of 2 parameters" in text


def test_friction(program):
    """Check laws of friction: a power of the pressure with a decrease by the speed, which a run of the program has
    too, found from exact coefficients and from such with scatter, and tables."""
    pressure, speed = (grid.ravel() for grid in np.meshgrid([1, 2, 5, 10, 20], [1, 5, 15, 40, 80]))
    exact = 0.14 * (pressure / 5) ** -0.1 * (0.6 + 0.4 * np.exp(-(speed / 30) ** 1.5))
    write("mu.csv", pressure, speed, exact, heading="pressure[MPa] speed[mm/s] mu")
    words = ["--friction", "power", "stribeck", "--friction-data", "mu.csv", "--fix", "power.p0=5"]
    text, _ = identified(program, *words, "--plot", "mu.png")
    coefficient, laws = friction_words(text)
    assert coefficient == pytest.approx(0.14, rel=1e-5) and Path("mu.png").is_file() and "Note" not in text
    assert laws["power"] == pytest.approx({"p0": 5, "n": 0.9, "p_min": 1}, rel=1e-5)
    assert laws["stribeck"] == pytest.approx({"v0": 30, "r": 0.6, "n": 1.5}, rel=1e-5)
    drag_block(program, text)
    write("mu.csv", pressure, speed, exact * (1 + 0.01 * np.random.default_rng(3).standard_normal(25)),
          heading="pressure[MPa] speed[mm/s] mu")
    coefficient, laws = friction_words(identified(program, *words)[0])
    assert coefficient == pytest.approx(0.14, rel=0.02) and laws["power"]["n"] == pytest.approx(0.9, abs=0.01)
    assert laws["stribeck"]["r"] == pytest.approx(0.6, abs=0.03)
    assert laws["stribeck"]["v0"] == pytest.approx(30, rel=0.15)
    by_pressure, by_speed = ((1, 1), (5, 0.9), (20, 0.7)), ((1, 1), (80, 0.8))
    by_strain = ((0, 1), (0.1, 1.1), (0.3, 1.2))
    rows = [(p, v, e, 0.12 * f * g * h) for p, f in by_pressure for v, g in by_speed for e, h in by_strain]
    write("mu.csv", *zip(*rows), heading="pressure;speed;strain;coefficient")
    text, _ = identified(program, "--friction", "table", "speed_table", "strain_table", "--friction-data", "mu.csv")
    assert friction_words(text)[0] == pytest.approx(0.12, rel=1e-5)
    for name, wanted in (("table", by_pressure), ("speed_table", by_speed), ("strain_table", by_strain)):
        pairs = re.findall(r"(\S+):(\S+)", re.search(rf"friction_law = {name} (.*)", text)[1])
        assert np.array(pairs, float) == pytest.approx(np.array(wanted), rel=1e-5)


def drag_block(program, text):
    """Check the friction of a block that is dragged at 40 mm/s under 1.2 MPa in a run with the lines of a file."""
    lines = "\n".join(line for line in text.splitlines() if line.startswith("  friction"))
    case = ROOT / "tests/cases/friction_slide"
    deck = (case / "case.dat").read_text().partition("#: {")[0]
    for old, new in (("  friction = 0.144", lines), ("  control = load\n", "  control = load\n  duration = 0.01\n"),
                     ("x 0.04", "x 0.4")):
        deck = deck.replace(old, new)
    Path("block.dat").write_text(deck)
    Path("table.bez").write_text((case / "table.bez").read_text())
    subprocess.run([program, "--quiet", "--threads", "1", "block.dat"], check=True, capture_output=True)
    last = read_table("block.out/history.csv")[-1]
    expected = 0.14 * (1.2 / 5) ** -0.1 * (0.6 + 0.4 * np.exp(-(40 / 30) ** 1.5))
    assert float(last["table_fx"]) / 120 == pytest.approx(expected, rel=1e-4)


def test_fracture_table(program):
    """Check tables of strains to fracture: over the triaxiality, with repeated tests, over blocks of the Lode angle."""
    places, strains = np.array([0, 1 / 3, 1 / 3, 0.577, 0.667]), np.array([0.7, 0.88, 0.92, 0.5, 0.9])
    write("tests.csv", places, strains, heading="triaxiality strain")
    words = ["--fracture", "tests.csv", "--fracture-law", "table", "--hardening", SWIFT]
    text, _ = identified(program, *words, "--plot", "strains.png", "--fracture-exponent", 2)
    assert points(text, "fracture") == pytest.approx(np.array([(0, 0.7), (0.3333, 0.9), (0.577, 0.5), (0.667, 0.9)]),
                                                     abs=1e-4)
    assert "exponent=2" in text and Path("strains.png").is_file() and "largest 0.02" in text
    grid = [(t, lode, strain) for lode, block in ((-1, ((0, 1.4), (0.667, 0.9))), (0, ((0, 0.7), (0.577, 0.5))),
                                                  (1, ((0.2, 1.1), (0.333, 0.9)))) for t, strain in block]
    write("tests.csv", *zip(*grid), heading="triaxiality Lode strain")
    text, _ = identified(program, *words)
    assert "lode1=-1 lode2=0 lode3=1 0:1.4 0.667:0.9 0:0.7 0.577:0.5 0:1.1 0.2:1.1 0.333:0.9" in text
    assert "largest 0.0000" in text


@pytest.mark.parametrize(("words", "text", "said"), [
    ("--modulus chord --moduli", "0 206\n0.02 190\n0.1 170\n", "t.txt:1: error: modulus = 206 is out of range"),
    ("--modulus chord --moduli", "0 206000\n2 190000\n5 170\n", "t.txt:2: error: plastic strain = 2 is out of range"),
    ("--modulus chord --moduli", "0 206000\n2 190000\n5 170\n", "t.txt:3: error: modulus = 170 is out of range"),
    ("--modulus chord --moduli", "0 206000\n0.1 190000\n", "2 rows\n  expected: plastic strain and modulus in 3 rows"),
    ("--modulus table --moduli", "0.05 206000\n0.1 190000\n", "no modulus at the plastic strain 0"),
    ("--modulus chord --young 150000 --moduli", "0 206000\n0.1 190000\n", "modulus = 206000 is above --young 150000"),
    ("--rate power --rate-ratios", "0.001 100\n1 110\n", "ratio = 100 is out of range"),
    ("--rate power --rate-ratios", "0.001 1\n1 one\n", "a row that"),
    ("--rate power --rate-ratios", "0.001 1\n", "1 row\n  expected: rate and ratio in 2 rows or more: m"),
    ("--rate power --rate-ratios", "0.001 1\n1 0.8\n", "the stress falls with the rate"),
    ("--rate power --rate-ratios", "0 1\n1 1.1\n", "rate = 0 is out of range"),
    ("--temperature table --temperature-ratios", "20 1\n20 0.98\n", "one temperature only"),
    ("--friction power --friction-data", "1 12\n2 11\n", "coefficient of friction = 12 is out of range"),
    ("--friction power stribeck --friction-data", "1 1 0.1\n2 2 0.1\n3 3 .1\n", "in 5 rows or more: friction, power.n"),
    ("--friction table --friction-data", "1 0.1\n1 0.11\n", "the pressure is the same in all rows"),
    ("--friction table --friction-data", "1 0.2\n10 0.01\n", "the friction stress falls from 1 to 10 MPa"),
    ("--fracture-law table --fracture", "0.3 0.9\n0.3 0.8\n", "tests at one triaxiality only"),
    ("--fracture-law table --fracture", "0.3 90\n0.5 80\n", "strain to fracture = 80"),
    ("--fracture-law table --fracture", "0.3 1 0.9\n0.5 0 0.8\n", "at the Lode angle 0\n"),
    ("--hardening swift --rate power --rate-curves 1:none.txt x:t.txt 1:", "0.1 1\n", "none.txt: error"),
    ("--hardening swift --rate power --rate-curves 1:none.txt x:t.txt 1:", "0.1 1\n", "--rate-curves x:t.txt: error"),
])
def test_wrong_tables(program, words, text, said):
    """Check what tables are refused, with all errors at once."""
    Path("t.txt").write_text(text)
    *words, last = words.split()
    words += [last + "t.txt"] if last.endswith(":") else [last, "t.txt"]
    if said == "a row that":
        said = "t.txt:2: error: 'one' is not a number"
    assert said in call("identify", "steel", *words, "--program", program, expect=2)


@pytest.mark.parametrize(("words", "said"), [
    ("--modulus chord", "--modulus and --moduli go together"),
    ("--rate power", "--rate goes with one of --rate-ratios and --rate-curves"),
    ("--rate curves --rate-ratios t.txt", "--rate curves goes with --rate-curves"),
    ("--rate power --rate-curves 1:a.txt 2:b.txt", "need --hardening"),
    ("--rate power --rate-curves 1:a.txt --hardening swift", "two curves or more"),
    ("--rate power --rate-ratios t.txt --fix rate.C=1", "rate has m, reference"),
    ("--criterion hosford --fix rate.C=1", "no such law is identified"),
    ("--friction power --friction-data t.txt --rate power --rate-ratios t.txt", "in a command of its own"),
    ("--friction power", "--friction and --friction-data go together")])
def test_wrong_options(program, words, said):
    """Check what options are refused."""
    assert said in call("identify", "steel", *words.split(), "--program", program, expect=2)


def test_undetermined(program):
    """Check the notes on parameters that the tests do not determine."""
    write("ratios.txt", [0.001, 1, 1, 1], [1, 1.1, 1.11, 1.09])
    text, _ = identified(program, "--rate", "cowper_symonds", "--rate-ratios", "ratios.txt")
    assert "Note: measured at 1 rate, which does not determine C, p" in text
    write("ratios.txt", [1, 1, 1], [1, 1.01, 0.99])
    text, _ = identified(program, "--rate", "johnson_cook", "--rate-ratios", "ratios.txt")
    assert "do not determine C: left as at the start" in text
    write("moduli.txt", [0.1, 0.1, 0.1], [1.7e5, 1.71e5, 1.69e5])
    text, _ = identified(program, "--modulus", "chord", "--moduli", "moduli.txt")
    assert "measured at 1 plastic strain, which does not determine young, Ea, xi" in text
    write("mu.txt", [5, 5, 5], [0.12, 0.13, 0.14])
    text, _ = identified(program, "--friction", "power", "--friction-data", "mu.txt")
    assert "measured at 1 pressure, which does not determine n, friction" in text


@with_library
def test_teodosiu_hu(program):
    """Check the law of Teodosiu and Hu from tension, compression and tension, with the parameters of latent structures
    given: its stresses within 0.2 MPa at the measured strains and its parameters within a tenth, as curves determine
    them; a curve without reversal is refused."""
    law = "Y0=120 CR=28 Rsat=80 CX=200 X0=10 Ssat=240 CSD=4 CSL=4 nL=1 CP=2.2 nP=25 f=0.7 r=4"
    point, strain, rows = dd3.material({**STEEL, "hardening": f"teodosiu_hu {law}"}).point(), 0.0, []
    for end, steps in ((0.15, 600), (-0.05, 800), (0.1, 600)):
        step = (end - strain) / steps
        for i in range(steps):
            point.pull(step)
            strain += step
            rows += [(strain, point.stress[0])] * (i % 25 == 24)
    write("curve.txt", *zip(*rows))
    text, said = identified(program, "teodosiu_hu", "curve.txt", "--young", 206000, "--starts", 1, "--fix",
                            "hardening.CSL=4", "hardening.nL=1", "hardening.r=4", command="fit")
    assert float(re.search(r"largest (\S+) MPa", said)[1]) < 0.2 and "no tension and compression" not in said
    wanted = {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", law)}
    assert numbers(text, "hardening") == pytest.approx(wanted, rel=0.1), said
    write("curve.txt", *zip(*rows[:20]))
    assert "no back-stress can be identified" in call("fit", "steel", "teodosiu_hu", "curve.txt", "--program", program,
                                                      expect=2)


@pytest.mark.parametrize("ends", [(0.04, -0.02), (-0.04, 0.02), (-0.03, 0.02, -0.02)])
def test_first_branch(program, ends):
    """Check that a curve with reversals gives the parameters of its law, whether it begins in tension or compression."""
    laws = {"hardening": "voce Y0=200 Rsat=150 CR=12", "backstress": "lemaitre_chaboche CX=40 Xsat=80"}
    point, strain, rows = dd3.material({**STEEL, **laws}).point(), 0.0, []
    for end in ends:
        count = round(abs(end - strain) / 0.001)
        step = (end - strain) / count
        for _ in range(count):
            point.pull(step)
            strain += step
            rows.append((strain, point.stress[0]))
    write("curve.txt", *zip(*rows))
    text, said = identified(program, "voce", "curve.txt", "--young", 206000, "--starts", 1, "--backstress",
                            "lemaitre_chaboche", command="fit")
    for key, law in laws.items():
        wanted = {name: float(value) for name, value in re.findall(r"(\w+)=(\S+)", law)}
        assert numbers(text, key) == pytest.approx(wanted, rel=0.01), said

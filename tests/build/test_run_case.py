# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of tests/run_case.py and tests/run_description.py with a stand-in for the program."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TESTS = pathlib.Path(__file__).resolve().parent.parent
RUNNER = TESTS / "run_case.py"
SCHEMA = json.loads((TESTS.parent / "docs" / "run.schema.json").read_text(encoding="utf-8"))
sys.path.insert(0, str(TESTS))
from case_file import Unlisted, cases  # noqa: E402
from run_description import check_description, jsonschema  # noqa: E402

from dd3.errors import Problem  # noqa: E402

PROGRAM = """#!{python}
import pathlib, sys
folder = pathlib.Path(sys.argv[sys.argv.index("--output") + 1])
folder.mkdir()
factor = float(sys.argv[sys.argv.index("--factor") + 1]) if "--factor" in sys.argv else 1.0
rows = ["clamp,0,5", "clamp,0,10", "draw,1,20", "draw,2,40"]
(folder / "history.csv").write_text("# -, mm, N\\nphase, travel, force\\n" + "".join(
    "%s,%s,%g\\n" % (r.split(",")[0], r.split(",")[1], factor * float(r.split(",")[2])) for r in rows))
(folder / "status.csv").write_text("increment,iterations\\n1,2\\n2,3\\n")
(folder / "job.log").write_text("")
if "--fields" in sys.argv:
    import h5py
    with h5py.File(folder / "fields.vtkhdf", "w") as file:
        file["VTKHDF/NumberOfCells"] = [4, 7]
        file["VTKHDF/Steps/Values"] = [0.0, 1.0, 2.0]
        file["VTKHDF/Steps/PartOffsets"] = [0, 1, 1]
        file["VTKHDF/Steps"].attrs["NSteps"] = 3
code = 3 if "--stop" in sys.argv else 0
(folder / "run.json").write_text(pathlib.Path("{scratch}", "run_%d.json" % code).read_text())
print("the run is over")
sys.exit(code)
"""
REFERENCE = "# from a hand calculation\nphase,travel,force\nclamp,0,10\ndraw,1.5,30\ndraw,2,40\n"


def smallest(schema):
    """Return the smallest value that obeys a schema of docs/run.schema.json."""
    if "$ref" in schema:
        return smallest(SCHEMA["$defs"][schema["$ref"].removeprefix("#/$defs/")])
    if "anyOf" in schema:
        return None if {"type": "null"} in schema["anyOf"] else smallest(schema["anyOf"][0])
    if "const" in schema or "enum" in schema:
        return schema.get("const", schema.get("enum", [None])[0])
    kind = schema["type"]
    if isinstance(kind, list):
        return None
    if kind == "object":
        return {name: smallest(schema["properties"][name]) for name in schema.get("required", [])}
    if kind == "array":
        return [smallest(schema["items"])] * schema.get("minItems", 0)
    time = "2026-01-31T12:00:00+01:00" if "pattern" in schema else ""
    return {"string": time, "boolean": False}.get(kind, schema.get("minimum", 0))


def description(code):
    """Return the run.json of a run with an exit code."""
    message = {"code": None, "text": "", "at": None, "phase": None, "increment": None}
    return {**smallest(SCHEMA), "errors": [message] * (code > 0),
            "outcome": {"state": "stopped" if code else "reached", "exit_code": code, "code": None, "message": None}}


class RunDescription(unittest.TestCase):
    """Tests with a run.json each."""

    def refuse(self, text, found):
        """Check that a run.json is refused as that of a run that reached its end."""
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "run.json").write_text(found if isinstance(found, str) else json.dumps(found))
            with self.assertRaises(Problem) as caught:
                check_description(folder, 0)
        self.assertIn(text, str(caught.exception))

    def test_what_is_refused(self):
        self.refuse("line 1 column 2", "{")
        self.refuse("exit code 0", description(3))
        self.refuse("1 errors", {**description(0), "errors": description(3)["errors"]})

    @unittest.skipIf(jsonschema is None, "jsonschema is not installed")
    def test_schema(self):
        self.refuse("'title' is a required property", {key: value for key, value in description(0).items()
                                                       if key != "title"})
        self.refuse("machine/threads", {**description(0), "machine": {**description(0)["machine"], "threads": 0}})
        self.refuse("unknown", {**description(0), "unknown": 1})


class RunCase(unittest.TestCase):
    """Tests with a case folder each."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name) / "case"
        self.folder.mkdir()
        self.program = pathlib.Path(self.scratch.name) / "program"
        self.program.write_text(PROGRAM.format(python=sys.executable, scratch=self.scratch.name))
        for code in (0, 3):
            (pathlib.Path(self.scratch.name) / f"run_{code}.json").write_text(json.dumps(description(code)))
        self.program.chmod(0o755)

    def tearDown(self):
        self.scratch.cleanup()

    def run_case(self, reference=REFERENCE, **case):
        """Return exit code and output of the runner."""
        (self.folder / "case.json").write_text(json.dumps(case))
        if reference:
            (self.folder / "reference.csv").write_text(reference)
        return self.call()

    def call(self):
        """Return exit code and output of the runner with the folder."""
        done = subprocess.run([sys.executable, RUNNER, "--program", self.program, "--work",
                               pathlib.Path(self.scratch.name) / "work", self.folder],
                              capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def refuse(self, text, **case):
        """Check that the case fails with a message."""
        code, output = self.run_case(**case)
        self.assertNotEqual(code, 0, output)
        self.assertIn(text, output)

    def test_agreement(self):
        code, output = self.run_case(tolerance={"*": {"relative": 1e-9}}, last={"force": [40, 0]},
                                     status={"iterations": [1, 3]}, contains=["the run is over"])
        self.assertEqual(code, 0, output)
        self.assertIn("7 values compared", output)

    def test_tolerance_of_a_column(self):
        self.refuse("force = 30.3", tolerance={"force": {"relative": 0.005}}, arguments=["--factor", "1.01"])
        code, output = self.run_case(tolerance={"force": {"relative": 0.011}}, arguments=["--factor", "1.01"])
        self.assertEqual(code, 0, output)

    def test_every_variant_counts(self):
        self.refuse("FAILED case --factor 2", tolerance={"*": {"absolute": 1}}, variants=[[], ["--factor", "2"]])

    def test_variant_with_keys_of_its_own(self):
        (self.folder / "double.csv").write_text(REFERENCE.replace("10", "20").replace("30", "60").replace("40", "80"))
        double = {"arguments": ["--factor", "2"], "reference": "double.csv"}
        code, output = self.run_case(tolerance={"*": {"absolute": 1}}, variants=[[], double])
        self.assertEqual(code, 0, output)
        self.refuse("FAILED case --factor 2", tolerance={"*": {"absolute": 1}},
                    variants=[{**double, "reference": "reference.csv"}])
        self.refuse("unknown: referenz", tolerance={"*": {"absolute": 1}}, variants=[{"referenz": "double.csv"}])

    def test_exit_code(self):
        self.refuse("exit code 3, expected 0", tolerance={"*": {}}, arguments=["--stop"])
        code, output = self.run_case(tolerance={"*": {}}, arguments=["--stop"], exit_code=3)
        self.assertEqual(code, 0, output)

    def test_run_that_ends_too_early(self):
        self.refuse("ends at travel = 2", reference="phase,travel,force\ndraw,3,1\n", tolerance={"*": {}})

    def test_column_that_is_not_there(self):
        self.refuse("no column height", reference="travel,height\n1,1\n", tolerance={"*": {}})

    def test_no_tolerance(self):
        self.refuse("no tolerance is given for force", tolerance={})

    def test_nothing_compared(self):
        self.refuse("nothing was compared", reference=None)

    def test_last_row_and_status(self):
        self.refuse("last row: force = 40", reference=None, last={"force": [41, 0.5]})
        self.refuse("iterations = 3", reference=None, status={"iterations": [0, 2]})

    def test_elements_at_the_end(self):
        code, output = self.run_case(reference=None, arguments=["--fields"], elements=[7, 7])
        self.assertEqual(code, 0, output)
        self.refuse("7 elements at the end", reference=None, arguments=["--fields"], elements=[1, 6])

    def test_sums_of_columns(self):
        code, output = self.run_case(reference=None, equal=[[["force", "travel"], ["travel", "force"], 0]])
        self.assertEqual(code, 0, output)
        self.refuse("['force', 'travel'] = 42", reference=None, equal=[[["force", "travel"], "force", 1]])

    def test_same_in_the_variants(self):
        double = {"arguments": ["--factor", "2"], "same": {"force": [2, 1e-9]}}
        code, output = self.run_case(reference=None, last={"travel": [2, 0]}, variants=[[], double])
        self.assertEqual(code, 0, output)
        self.refuse("in the first variant times 1", reference=None, last={"travel": [2, 0]}, same={"force": [1, 0.4]},
                    variants=[[], ["--factor", "2"]])

    def test_case_in_a_deck(self):
        deck = self.folder / "case.dat"
        deck.write_text('*TITLE\n#: {"last": {"force": [40, 0]},\n#:  "tolerance": {"*": {}}}\n'
                        "#| travel,force\n#| 2,40\n#> the run\n#> is over\n")
        code, output = self.call()
        self.assertEqual(code, 0, output)
        with deck.open("a") as file:
            file.write("#> the run\n")
        code, output = self.call()
        self.assertNotEqual(code, 0)
        self.assertIn("does not contain, in this order: the run", output)

    def test_refused_input(self):
        self.program.write_text(f"#!{sys.executable}\nimport sys\nopen('left', 'w') if '--leave' in sys.argv else 0\n"
                                "sys.exit('error E101' + ' Backtrace' * ('--trace' in sys.argv))\n")
        case = {"reference": None, "exit_code": 1, "contains": ["E101"]}
        code, output = self.run_case(**case)
        self.assertEqual(code, 0, output)
        self.refuse("says 'Backtrace'", arguments=["--trace"], **case)
        self.refuse("files are left", arguments=["--leave"], **case)

    def test_file_that_is_no_case(self):
        (self.folder / "case.dat").write_text("*TITLE\n")
        with self.assertRaises(Unlisted):
            cases(self.folder)

    def test_text_file_and_key(self):
        self.refuse("does not contain: converged", contains=["converged"])
        self.refuse("fields.vtkhdf was not written", files=["fields.vtkhdf"])
        self.refuse("unknown: tolerances", tolerances={})


if __name__ == "__main__":
    unittest.main()

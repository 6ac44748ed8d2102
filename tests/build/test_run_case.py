"""Tests of tests/run_case.py with a stand-in for the program."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

RUNNER = pathlib.Path(__file__).resolve().parent.parent / "run_case.py"
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
print("the run is over")
sys.exit(3 if "--stop" in sys.argv else 0)
"""
REFERENCE = "# from a hand calculation\nphase,travel,force\nclamp,0,10\ndraw,1.5,30\ndraw,2,40\n"


class RunCase(unittest.TestCase):
    """Tests with a case folder each."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name) / "case"
        self.folder.mkdir()
        self.program = pathlib.Path(self.scratch.name) / "program"
        self.program.write_text(PROGRAM.format(python=sys.executable))
        self.program.chmod(0o755)

    def tearDown(self):
        self.scratch.cleanup()

    def run_case(self, reference=REFERENCE, **case):
        """Return exit code and output of the runner."""
        (self.folder / "case.json").write_text(json.dumps(case))
        if reference:
            (self.folder / "reference.csv").write_text(reference)
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

    def test_text_file_and_key(self):
        self.refuse("does not contain: converged", contains=["converged"])
        self.refuse("fields.vtkhdf was not written", files=["fields.vtkhdf"])
        self.refuse("unknown: tolerances", tolerances={})


if __name__ == "__main__":
    unittest.main()

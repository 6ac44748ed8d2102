# Workflow of the bending study: a run for every row of the table of cases, a table of results, and its figures.
# `python3 -m bending_study run` calls it; docs/reports/bending_study.md explains how it runs on a cluster. A run that
# stops before its end (exit code 3) is a result: `python3 -m bending_study case` records it and succeeds.
import csv
import sys
from pathlib import Path

STUDY = f"{sys.executable} -m bending_study"
PROGRAM = config["program"]
TABLE = Path(config["cases"])
WANTED = str(config.get("sets") or "").split()
FIGURES = str(config.get("figures", "yes")) == "yes"

with open(TABLE, newline="", encoding="utf-8") as file:
    CASES = {row["case"]: row for row in csv.DictReader(file) if not WANTED or row["set"] in WANTED}
if not CASES:
    sys.exit(f"{TABLE}: no case in the sets {' '.join(WANTED)}")


wildcard_constraints:
    case=r"[\w.+-]+",


localrules:
    all,
    table,
    figures,


rule all:
    input:
        expand("{case}/done.json", case=CASES),
        "results.csv",
        ["figures.txt"] if FIGURES else [],


# One run of the program. It depends on its row of the table only.
rule case:
    input:
        deck=TABLE.parent / "study.dat",
        tools=sorted((TABLE.parent.parent / "bending").glob("*.bez")),
        program=ancient(PROGRAM),
    output:
        "{case}/done.json",
    params:
        row=lambda wildcards: CASES[wildcards.case],
    threads: 1
    resources:
        mem_mb=500,
        runtime=20,
    message:
        "{wildcards.case}"
    shell:
        "{STUDY} case {wildcards.case} --cases {TABLE} --program {PROGRAM} --work . "
        "--sets " + " ".join(WANTED)


rule table:
    input:
        expand("{case}/done.json", case=CASES),
    output:
        "results.csv",
    params:
        rows=CASES,
    message:
        "results.csv"
    shell:
        "{STUDY} table --cases {TABLE} --program {PROGRAM} --work . --only " + " ".join(CASES)


rule figures:
    input:
        "results.csv",
    output:
        "figures.txt",
    message:
        "figures"
    shell:
        "{STUDY} figures --work . > {output}"

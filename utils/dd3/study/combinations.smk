# Workflow of dd3 study FILE --vary: a run for every combination of combinations.json, which the command writes.
import json
import sys

with open("combinations.json", encoding="utf-8") as file:
    STUDY = json.load(file)


wildcard_constraints:
    case=r"[^/]+",


localrules:
    all,


rule all:
    input:
        expand("{case}/ended", case=STUDY["cases"]),


rule case:
    input:
        deck=STUDY["deck"],
        program=ancient(STUDY["program"]),
    output:
        "{case}/ended",
    threads: 1
    message:
        "{wildcards.case}"
    shell:
        "{sys.executable} -m dd3 study combination '{wildcards.case}' && touch '{output}'"

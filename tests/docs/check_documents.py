#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "docs", "labels": ["docs"], "timeout": 300}
"""Check README.md, CONTRIBUTING.md, docs/ and the links of CHANGELOG.md.

    check_documents.py --program build/release/dd3imp

- docs/keywords.md is the output of `dd3imp --help markdown`; to update it: `dd3imp --help markdown >docs/keywords.md`.
- Links and pictures lead to files and headings that exist.
- Scripts, input files and presets named in the documents exist, and the program, dd3 and the scripts have every `--option`
  that is used there.
- Code blocks that are complete input files pass `dd3imp --check`; those of single points run to their end.
- docs/messages.md is the output of `dd3imp --help messages`, and the program uses each code of it.
- Each law has a page docs/laws/<law>.md with its picture, linked from the page of its kind. The table of the page has
  the parameters that `dd3imp --help <law>` prints, with their units, bounds and defaults; equal ones may share a row.
  The input file input_files/laws/<law>.dat runs to its end. The laws of friction have one page, friction.md, linked from
  the manual; rows of its table begin with the laws that have the parameter.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
from functools import cache
from itertools import takewhile

from dd3.command import COMMANDS
from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```\w*\n(.*?)^```", re.DOTALL | re.MULTILINE)
GATHERED = {"yield": "yield_criteria.md", "hardening": "hardening_laws.md", "backstress": "hardening_laws.md",
            "modulus": "hardening_laws.md", "rate": "hardening_laws.md",
            "temperature": "hardening_laws.md", "fracture": "forming_limits.md", "friction": "manual.md"}
LAW = re.compile(r"^### `(\w+) = law|^\| `(\w+)` \|", re.MULTILINE)
PARAMETER = re.compile(r"^  (\S+) = (a \w.*?) \((\w.*)\)$", re.MULTILINE)
BOUND = re.compile(r"[<>]=? ")
GROUPS = [name for name, row in COMMANDS.items() if isinstance(row[-1], dict)]
SCRIPT = re.compile(r"(?:utils|tests)/[\w/]+\.(?:py|sh)")


@cache
def run(*command):
    """Return output and exit code of a command."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr, done.returncode


def anchors(path):
    """Return the anchors of a document's headings."""
    text = FENCE.sub("", path.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ +(.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(path, text):
    """Yield the broken links of a document."""
    for target in LINK.findall(FENCE.sub("", text)):
        if target.startswith(("http:", "https:")):
            continue
        name, _, anchor = target.partition("#")
        file = path.parent / name if name else path
        if not file.exists():
            yield f"the link {target} leads to no file"
        elif anchor and anchor not in anchors(file):
            yield f"the link {target} leads to no heading"


def commands(text):
    """Return the commands of a document: lines indented by four columns or more."""
    joined = FENCE.sub("", text).replace("\\\n", " ")
    indented = [line.strip() for line in joined.splitlines() if line.startswith("    ")]
    return [line for line in indented if not line.startswith("|")]


def broken_commands(program, text):
    """Yield the commands of a document with unknown files, presets or options."""
    presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
    names = {preset["name"] for kind in presets if kind.endswith("Presets") for preset in presets[kind]}
    for line in commands(text):
        for script in SCRIPT.findall(line):
            if not (ROOT / script).exists():
                yield f"there is no {script}: {line}"
        for deck in re.findall(r"input_files/[\w/]+\.dat", line):
            if not (ROOT / deck).exists():
                yield f"there is no {deck}: {line}"
        for preset in re.findall(r"--preset (\w+)", line):
            if preset not in names:
                yield f"there is no preset {preset}: {line}"
        words = line.split(" #")[0].split()
        if re.match(r"(build/\w+/)?dd3imp$", words[0]) if words else False:
            known = run(program, "--help")[0]
        elif words and words[0] == "dd3":
            names_of = takewhile(lambda word: word[0] != "-", words[1:2 + (words[1] in GROUPS)])
            known, code = run(sys.executable, "-m", "dd3", *names_of, "--help")
            if code:
                yield f"there is no such command: {line}"
        else:
            found = SCRIPT.search(line)
            known = (ROOT / found[0]).read_text(encoding="utf-8") if found and (ROOT / found[0]).exists() else None
            if known and "argparse" in known:
                known += "--help"
        if known is None:
            continue
        for option in re.findall(r"(?<=\s)--[a-z][\w-]*", line.split(" #")[0]):
            if option not in known:
                yield f"unknown option {option}: {line}"


def broken_examples(program, text):
    """Yield the complete input files in a document that the program refuses or, with single points, that fail."""
    for example in FENCE.findall(text):
        if "*BLANK" not in example and "*POINT" not in example:
            continue
        with tempfile.TemporaryDirectory() as folder:
            deck = pathlib.Path(folder) / "example.dat"
            deck.write_text(example, encoding="utf-8")
            for surface in (ROOT / "input_files" / "bending").glob("*.bez"):
                (pathlib.Path(folder) / surface.name).write_bytes(surface.read_bytes())
            said, code = run(program, *(["--check"] if "*BLANK" in example else ["--quiet"]), str(deck))
            if code:
                yield f"an example is refused or fails:\n{said}"


def wrong_codes(program):
    """Yield what is wrong with the codes of messages: docs/messages.md, and codes that no library but the list's has.

    The runs of the cases check that the list has the codes that the program gives.
    """
    printed = run(program, "--help", "messages")[0]
    if printed != (ROOT / "docs" / "messages.md").read_text(encoding="utf-8"):
        yield ("docs/messages.md differs from the output of the program; update it: "
               "dd3imp --help messages >docs/messages.md")
    listed = re.findall(r"^\| ([WNE]\d{3}) \|", printed, re.MULTILINE)
    libraries = [path.read_bytes() for path in pathlib.Path(program).resolve().parent.glob("libdd3_*.a")
                 if path.name != "libdd3_message.a"]
    for code in sorted(set(listed)):
        if not any(code.encode() in library for library in libraries):
            yield f"the code {code} is listed, but not used"
        if listed.count(code) > 1:
            yield f"the code {code} is listed twice"
    if f"{listed[0]}: " not in run(program, "--help", listed[0].lower())[0]:
        yield f"--help {listed[0]} prints no entry"


def laws_of(reference):
    """Return the laws of the keyword reference: kind and name."""
    kind, laws = "", []
    for heading, name in LAW.findall(reference.partition("\n## Laws")[2]):
        kind = heading or kind
        if name:
            laws.append((kind, name))
    return laws


def parameters_of(said):
    """Return unit, bounds and default of parameters by name, from the output of --help; of laws of one name the first."""
    found = {}
    for name, value, states in PARAMETER.findall(said):
        parts = value.split(", ")[1:]
        bounds = [part for part in parts if BOUND.match(part)]
        unit = [part for part in parts if part not in bounds and " " not in part]
        default = ", ".join(state.removeprefix("default ") for state in states.split(") ("))
        found.setdefault(name, [unit[0] if unit else "-", ", ".join(bounds) or "any", default])
    return found


def parameter_rows(text):
    """Yield the rows of the tables of parameters of a page: names in the first cell, unit, bounds and default."""
    for line in re.findall(r"^\| `.*\|$", text, re.MULTILINE):
        names, _, *rest = (cell.strip() for cell in line.strip("|").split("|"))
        yield re.findall(r"`([^`]+)`", names), rest


def law_table(program, law, text):
    """Return the parameters of a law by its page and by the program."""
    table = {name: rest for names, rest in parameter_rows(text) for name in names}
    return table, parameters_of(run(program, "--help", law)[0])


def friction_table(program, text):
    """Return the parameters of the laws of friction, named `law: parameter`, by their page and by the program."""
    table, wanted = {}, {}
    for (*laws, name), (units, *rest) in parameter_rows(text):
        for k, law in enumerate(laws):
            table[f"{law}: {name}"] = [(units.split("; ") * len(laws))[k], *rest]
    for part in re.split(r"^friction_law = ", run(program, "--help", "friction_law")[0], flags=re.MULTILINE)[1:]:
        wanted |= {f"{part.split()[0]}: {name}": row for name, row in parameters_of(part).items()}
    return table, wanted


def broken_page(program, kind, law):
    """Yield the errors of the page of a law."""
    page = ROOT / "docs" / "laws" / f"{law}.md"
    if not page.exists():
        yield "the page does not exist"
        return
    text = page.read_text(encoding="utf-8")
    table, wanted = friction_table(program, text) if kind == "friction" else law_table(program, law, text)
    for name in sorted(wanted.keys() | table.keys()):
        if wanted.get(name) != table.get(name):
            yield f"the parameter {name} has {table.get(name)} in the table, {wanted.get(name)} by dd3imp --help"
    picture = ROOT / "docs" / "images" / "laws" / f"{law}.png"
    if f"](../images/laws/{law}.png)" not in text:
        yield "its picture is missing; draw it: utils/dev/law_pictures.py"
    elif picture.exists() and picture.stat().st_size > 60000:
        yield f"its picture has {picture.stat().st_size} bytes, more than 60000"
    if f"](laws/{law}.md)" not in (ROOT / "docs" / GATHERED[kind]).read_text(encoding="utf-8"):
        yield f"docs/{GATHERED[kind]} has no link to it"
    deck = ROOT / "input_files" / "laws" / f"{law}.dat"
    with tempfile.TemporaryDirectory() as folder:
        said, code = run(program, "--quiet", "--output", str(pathlib.Path(folder) / "out"), str(deck))
    if code:
        yield f"{deck.relative_to(ROOT)} fails:\n{said}"


def broken_laws(program, reference):
    """Yield the errors of the pages of the laws."""
    laws = [*laws_of(reference), ("friction", "friction")]
    for kind, law in laws:
        yield from (f"docs/laws/{law}.md: {problem}" for problem in broken_page(program, kind, law))
    for page in sorted((ROOT / "docs" / "laws").glob("*.md")):
        if page.stem not in {law for _, law in laws}:
            yield f"docs/laws/{page.name}: the program has no such law"


def main():
    """Print the errors; exit code 1 if there are any."""
    program = parser_of_runs(__doc__).parse_args().program
    wrong = []
    printed, _ = run(program, "--help", "markdown")
    if printed != (ROOT / "docs" / "keywords.md").read_text(encoding="utf-8"):
        wrong.append("docs/keywords.md differs from the output of the program; update it: "
                     "dd3imp --help markdown >docs/keywords.md")
    for path in DOCUMENTS:
        text = path.read_text(encoding="utf-8")
        for problem in [*broken_links(path, text), *broken_commands(program, text), *broken_examples(program, text)]:
            wrong.append(f"{path.relative_to(ROOT)}: {problem}")
    changes = ROOT / "CHANGELOG.md"
    wrong += [f"CHANGELOG.md: {problem}" for problem in broken_links(changes, changes.read_text(encoding="utf-8"))]
    wrong += [*broken_laws(program, printed), *wrong_codes(program)]
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()

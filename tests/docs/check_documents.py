#!/usr/bin/env python3
"""Checks README.md, CONTRIBUTING.md and docs/.

    check_documents.py --program build/release/dd3imp

- docs/keywords.md is what `dd3imp --help markdown` prints; to renew it: `dd3imp --help markdown >docs/keywords.md`.
- Links and pictures lead to files and headings that exist.
- Scripts, input files and presets named in the documents exist, and every `--option` of the program and the scripts
  that is used there is one that they have.
- Blocks of code that are whole input files pass `dd3imp --check`.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```\w*\n(.*?)^```", re.DOTALL | re.MULTILINE)
SCRIPT = re.compile(r"(?:utils|tests)/[\w/]+\.(?:py|sh)")


def run(*command):
    """Output and exit code of a command."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr, done.returncode


def anchors(path):
    """The anchors of a document's headings."""
    text = FENCE.sub("", path.read_text(encoding="utf-8"))
    headings = re.findall(r"^#+ +(.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(path, text):
    """Links of a document that lead nowhere."""
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
    """Lines of the document that are commands: indented by four columns or more."""
    joined = FENCE.sub("", text).replace("\\\n", " ")
    return [line.strip() for line in joined.splitlines() if line.startswith("    ") and not line.strip().startswith("|")]


def broken_commands(program, text):
    """Commands of a document that cannot work."""
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
        else:
            found = SCRIPT.search(line)
            known = (ROOT / found[0]).read_text(encoding="utf-8") if found and (ROOT / found[0]).exists() else None
        if known is None:
            continue
        for option in re.findall(r"(?<=\s)--[a-z][\w-]*", line.split(" #")[0]):
            if option not in known:
                yield f"unknown option {option}: {line}"


def broken_examples(program, text):
    """Whole input files in a document that the program refuses."""
    for example in FENCE.findall(text):
        if "*BLANK" not in example:
            continue
        with tempfile.TemporaryDirectory() as folder:
            deck = pathlib.Path(folder) / "example.dat"
            deck.write_text(example, encoding="utf-8")
            for surface in (ROOT / "input_files" / "bending").glob("*.bez"):
                (pathlib.Path(folder) / surface.name).write_bytes(surface.read_bytes())
            said, code = run(program, "--check", str(deck))
            if code:
                yield f"an example is refused:\n{said}"


def main():
    """Exit code 1 and a list of what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    program = parser.parse_args().program
    wrong = []
    printed, _ = run(program, "--help", "markdown")
    if printed != (ROOT / "docs" / "keywords.md").read_text(encoding="utf-8"):
        wrong.append("docs/keywords.md is not what the program prints; renew it: dd3imp --help markdown >docs/keywords.md")
    for path in DOCUMENTS:
        text = path.read_text(encoding="utf-8")
        for problem in [*broken_links(path, text), *broken_commands(program, text), *broken_examples(program, text)]:
            wrong.append(f"{path.relative_to(ROOT)}: {problem}")
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the program on mutated input files: it must answer each with an exit code and a sentence.

    fuzz.py --program build/release/dd3imp --work build/fuzz --count 400          mutated decks through --check
    fuzz.py --program build/asan/dd3imp --work build/fuzz --count 20000 --limit 60  the same with the sanitizers
    fuzz.py --program build/asan/dd3imp --work build/fuzz --count 300 --runs      short runs with mutated numbers
    fuzz.py ... --seed 7 --only 1234                                              one deck of a series again

The decks are those of input_files/, tests/cases/ and tests/bad_input/, with words, lines, blocks or bytes removed,
doubled, swapped or replaced, and numbers at their extremes; some of the surfaces and included files that they name are
mutated as well. Deck i of a series depends on the seed and on i only. A deck fails if

- the program ends by a signal, or with an exit code other than 0 to 3 (1 is wrong usage: also a failure);
- it prints a backtrace, an error of the Fortran library or a report of a sanitizer;
- exit code 2 comes without a message, or with one that has no file, or no line where there is a line to name;
- exit code 3 comes without a sentence;
- --check takes more than the limit of 10 s; a run does not end in time after SIGTERM;
- a run with exit code 0 leaves values that are not numbers in history.csv, or any run an incomplete row.

Failing decks stay in the folder `failed` of the work folder, each with what the program said.
"""
import argparse
import concurrent.futures
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SOURCES = ("input_files", "tests/cases", "tests/bad_input")
# Errors of a file as a whole, which have no line.
WITHOUT_LINE = ("is missing", "contains no block", "cannot read the input file", "would overwrite the input file")
TRACES = ("Backtrace", "SIGSEGV", "SIGABRT", "SIGFPE", "runtime error", "At line", "ERROR STOP", "Sanitizer",
          "terminate")
NUMBER = re.compile(r"^[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?$")
EXTREMES = ("0", "-1", "1", "-0.0", "1e300", "-1e300", "1e-300", "1e-12", "1e12", "nan", "inf", "1e999", "2", "3", "7",
            "0.5", "2147483647", "2147483648", "-2147483648", "99999999999999999999", "1e", "--1", "1,5", "0x10", "off")
FACTORS = (0.0, -1.0, 0.5, 0.9, 1.1, 2.0, 3.0, 10.0, 0.1, 100.0, 0.01, 1e-6, 1e6, 1e-100, 1e100)
RUN_TIME, END_TIME = 4.0, 60.0


class Corpus:
    """The decks, and the words that occur in them."""

    def __init__(self, work, smallest_only):
        self.decks = []
        for source in SOURCES:
            shutil.copytree(ROOT / source, work / source, dirs_exist_ok=True)
            self.decks += [path for path in (work / source).rglob("*.dat") if path.is_file()]
        self.decks.sort()
        if smallest_only:
            self.decks = [path for path in self.decks if is_small(path)]
        self.valid = [path for path in self.decks if "bad_input" not in path.parts]
        text = "\n".join(path.read_text(encoding="utf-8", errors="replace") for path in self.decks)
        self.words = sorted(set(text.split()))
        self.lines = sorted({line for line in text.splitlines() if "=" in line or line.startswith("*")})


def is_small(path):
    """Whether a deck is a valid one of at most 60 elements, or of points."""
    if "bad_input" in path.parts or path.name == "study.dat":
        return False
    found = re.search(r"divisions\s*=\s*(\d+)\s+(\d+)\s+(\d+)", path.read_text(encoding="utf-8"))
    return not found or int(found[1]) * int(found[2]) * int(found[3]) <= 60


def mutated_word(word, corpus, dice):
    """Return a word changed, exchanged or at an extreme."""
    if NUMBER.match(word) and dice.random() < 0.7:
        return dice.choice(EXTREMES)
    way = dice.randrange(6)
    if way == 0:
        return dice.choice(corpus.words)
    if way == 1:
        return dice.choice(EXTREMES)
    if way == 2 and len(word) > 1:
        i = dice.randrange(len(word) - 1)
        return word[:i] + word[i + 1] + word[i] + word[i + 2:]
    if way == 3:
        i = dice.randrange(len(word) + 1)
        return word[:i] + dice.choice("=*#!&'\"${}é \t,:/-") + word[i:]
    if way == 4:
        return word * dice.choice((2, 3, 50, 400))
    return word[:dice.randrange(len(word) + 1)]


def mutate_words(line, corpus, dice):
    """Return a line with a word removed, doubled, swapped or changed."""
    parts = re.split(r"(\s+|=)", line)
    places = [i for i, part in enumerate(parts) if part.strip()]
    if not places:
        return dice.choice(corpus.lines)
    i, j = dice.choice(places), dice.choice(places)
    way = dice.randrange(5)
    if way == 0:
        parts[i] = ""
    elif way == 1:
        parts[i] += " " + parts[i]
    elif way == 2:
        parts[i], parts[j] = parts[j], parts[i]
    else:
        parts[i] = mutated_word(parts[i], corpus, dice)
    return "".join(parts)


def blocks_of(lines):
    """Return the first and the last line of each block, as a list of pairs."""
    starts = [i for i, line in enumerate(lines) if line.lstrip().startswith("*")]
    return list(zip(starts, starts[1:] + [len(lines)]))


def mutate_lines(lines, corpus, dice):
    """Change a list of lines in one way."""
    i, way = dice.randrange(len(lines)), dice.randrange(12)
    blocks = blocks_of(lines)
    if way < 5:
        lines[i] = mutate_words(lines[i], corpus, dice)
    elif way == 5:
        del lines[i]
    elif way == 6:
        lines.insert(i, dice.choice(lines))
    elif way == 7:
        lines.insert(i, dice.choice(corpus.lines))
    elif way in (8, 9) and blocks:
        first, last = dice.choice(blocks)
        lines[i:i] = lines[first:last] if dice.random() < 0.7 else []
        if dice.random() < 0.3:
            del lines[first:last]
    elif way == 10:
        lines[i] += " " + dice.choice(("&", "#", "!", "=", "'", '"', "${p}", "${")) * dice.choice((1, 1, 1000))
    else:
        lines[i] = lines[i] + (" " + dice.choice(lines[i].split() or ["1"])) * dice.choice((1, 10, 2000))


def mutate_bytes(data, dice):
    """Return bytes truncated, changed or doubled."""
    data = bytearray(data)
    way = dice.randrange(4)
    if way == 0:
        return bytes(data[:dice.randrange(len(data) + 1)])
    for _ in range(dice.choice((1, 3, 30))):
        i = dice.randrange(len(data) + 1)
        if way == 1:
            data[i:i + 1] = bytes([dice.randrange(256)])
        elif way == 2:
            data[i:i] = bytes(dice.choice((b"\0", b"\r", b"\n", b"\t", b"\xff", b"\xc2\xa0", b"\f")))
        else:
            data[i:i + dice.randrange(40)] = b""
    return bytes(data)


def mutate_file(data, corpus, dice):
    """Return the content of a file with one or several mutations."""
    lines = data.decode("utf-8", "replace").split("\n")
    for _ in range(dice.choice((1, 1, 1, 2, 3, 6))):
        mutate_lines(lines, corpus, dice)
        lines = lines or [""]
    data = "\n".join(lines).encode("utf-8", "replace")
    return mutate_bytes(data, dice) if dice.random() < 0.12 else data


def mutate_numbers(data, _, dice):
    """Return the content of a file with one to three numbers changed, for a run."""
    parts = re.split(r"([\s=:]+)", data.decode("utf-8", "replace"))
    places = [i for i, part in enumerate(parts) if NUMBER.match(part)]
    for i in dice.sample(places, min(len(places), dice.choice((1, 1, 2, 3)))):
        value = float(parts[i].replace("d", "e").replace("D", "e")) * dice.choice(FACTORS)
        parts[i] = str(round(value)) if re.fullmatch(r"[-+]?\d+", parts[i]) and abs(value) < 1e9 else f"{value:.6g}"
        if dice.random() < 0.1:
            parts[i] = dice.choice(EXTREMES)
    return "".join(parts).encode("utf-8", "replace")


def named_files(data, folder):
    """Return the files that a deck names and that exist."""
    words = set(re.findall(rb'[\w./-]+\.(?:bez|inp|inc|txt|dat|csv)', data))
    return sorted(word for word in words if (folder / word.decode()).is_file())


def make_deck(index, seed, corpus, mutate):
    """Write deck number `index` of a series beside its original; return its path and the files made for it."""
    dice = random.Random(f"{seed}-{index}")
    original = dice.choice(corpus.valid if dice.random() < 0.7 else corpus.decks)
    data, made = original.read_bytes(), []
    others = named_files(data, original.parent)
    if others and dice.random() < 0.25:
        word = dice.choice(others)
        other = original.parent / word.decode()
        copy = other.with_name(f"fuzz_{index}_{other.name}")
        copy.write_bytes(mutate(other.read_bytes(), corpus, dice))
        made.append(copy)
        data = data.replace(word, os.path.relpath(copy, original.parent).encode())
    if not made or dice.random() < 0.3:
        data = mutate(data, corpus, dice)
    deck = original.with_name(f"fuzz_{index}.dat")
    deck.write_bytes(data)
    return deck, [deck, *made]


def faults_of_errors(said):
    """Return what is wrong with the messages of an input that was refused."""
    messages = re.findall(r"^(?!  )(.*error E1\d\d: .*)$", said, re.MULTILINE)
    faults = [] if messages else ["exit code 2 without a message"]
    for message in messages:
        if not re.match(r".*?\S: error E1", message):
            faults.append(f"no file: {message[:200]}")
        elif not re.match(r".*?:\d+: error E1", message) and not any(text in message for text in WITHOUT_LINE):
            faults.append(f"no line: {message[:200]}")
    return faults


def faults_of_tables(output, code):
    """Return what is wrong with the tables of a run."""
    faults = []
    for path in output.glob("*.csv"):
        text = path.read_text(encoding="utf-8", errors="replace")
        if text and not text.endswith("\n"):
            faults.append(f"{path.name} ends in the middle of a line")
        if code == 0 and path.name == "history.csv" \
                and re.search(r"(^|,)-?(nan|inf)", text, re.MULTILINE | re.IGNORECASE):
            faults.append(f"{path.name} has values that are not numbers")
    return faults


def call(words, limit, end_limit, memory):
    """Run the program; return its exit code (None if it had to be killed) and what it said. SIGTERM comes first."""
    def limits():
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment,
                          preexec_fn=limits) as process:
        for number, wait in ((signal.SIGTERM, limit), (signal.SIGKILL, end_limit)):
            try:
                said, _ = process.communicate(timeout=wait)
                return process.returncode, said.decode("utf-8", "replace")
            except subprocess.TimeoutExpired:
                process.send_signal(number if end_limit > 0 else signal.SIGKILL)
        said, _ = process.communicate()
    return None, said.decode("utf-8", "replace")


def try_deck(index, options, corpus):
    """Run one deck; return its number, its exit code and a list of what is wrong."""
    deck, made = make_deck(index, options.seed, corpus, mutate_numbers if options.runs else mutate_file)
    output = options.work / "results" / str(index)
    words = [options.program, "--output", output, *([] if options.runs else ["--check"]), deck]
    code, said = call(words, *((RUN_TIME, END_TIME) if options.runs else (options.limit, 0.0)), options.memory << 20)
    faults = []
    if code is None:
        faults.append("it did not end in time")
    elif code == -signal.SIGTERM and not (output / "status.csv").exists():
        pass  # terminated before it began to compute
    elif code < 0 or code > 3 or code == 1:
        faults.append(f"exit code {code}")
    elif code == 2:
        faults += faults_of_errors(said)
    elif code == 3 and "dd3imp: stopped E2" not in said:
        faults.append("exit code 3 without a sentence")
    faults += [f"it says {trace!r}" for trace in TRACES if trace in said]
    faults += faults_of_tables(output, code)
    if faults:
        folder = options.work / "failed" / f"{options.seed}-{index}"
        folder.mkdir(parents=True, exist_ok=True)
        for path in made:
            shutil.copy(path, folder)
        (folder / "said.txt").write_text("\n".join(faults) + f"\n{deck}\n\n{said}", encoding="utf-8")
    for path in made:
        path.unlink()
    shutil.rmtree(output, ignore_errors=True)
    return index, code, faults


def main():
    """Run a series of decks; exit code 1 if one of them fails."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="the program dd3imp")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the decks and the results")
    parser.add_argument("--seed", type=int, default=1, help="number of the series (1)")
    parser.add_argument("--count", type=int, default=400, help="number of decks (400)")
    parser.add_argument("--first", type=int, default=0, help="number of the first deck (0), to share a series")
    parser.add_argument("--only", type=int, help="number of the only deck to be run")
    parser.add_argument("--runs", action="store_true", help="short runs with mutated numbers in place of --check")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="programs at a time (number of cores)")
    parser.add_argument("--limit", type=float, default=10.0, help="longest time of --check, s (10)")
    parser.add_argument("--memory", type=int, default=0, help="limit of the address space, MB; not with a sanitizer")
    options = parser.parse_args()
    options.program, options.work = options.program.resolve(), options.work.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    corpus = Corpus(options.work / "decks", options.runs)
    numbers = range(options.first, options.count) if options.only is None else [options.only]
    codes, failed = {}, 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for index, code, faults in pool.map(lambda index: try_deck(index, options, corpus), numbers):
            codes[code] = codes.get(code, 0) + 1
            failed += bool(faults)
            for fault in faults:
                print(f"FAILED deck {index} of seed {options.seed}: {fault}", flush=True)
    counts = ", ".join(f"{count} with exit code {code}" for code, count in sorted(codes.items(), key=str))
    print(f"{len(numbers)} decks: {counts}; {failed} failed" + (f", see {options.work / 'failed'}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

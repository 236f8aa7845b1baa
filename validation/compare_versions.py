#!/usr/bin/env python3
"""Compares what two versions of the program write for every case, column by column and bit for bit.

    python3 validation/compare_versions.py OLD_DWELL NEW_DWELL [--scenes FOLDER_OF_OLD_CASES] [--motions] [CASE...]

`check`, `kinematics`, `statics`, `kinetostatics` and `reduce` must agree in every bit: the columns of each CSV file are compared in
their order, with their names. With --motions, `simulate`, `cycle`, `equilibria` and
`linearise` are compared, too, and the largest difference of each column is told, as a part of its largest value. The old program reads
the cases of --scenes (a checkout of its time), since scene keys have changed their names. Exit status 1 where anything differs.
"""
import argparse
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[1]
EXACT = ["check", "kinematics", "statics", "kinetostatics", "reduce"]
MOTIONS = ["simulate", "cycle", "equilibria", "linearise"]
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?")


def run(program, command, case, scenes, folder):
    scene = scenes / case / "scene.toml"
    arguments = [str(program), command, str(scene), "--out", str(folder)]
    return subprocess.run(arguments, capture_output=True, text=True, cwd=scenes.parent)


def columns(path):
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    if not rows:
        return [], []
    return rows[0], list(zip(*rows[1:])) if len(rows) > 1 else [()] * len(rows[0])


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def largest_difference(old, new):
    """The largest difference of two columns as a part of the largest value, or None where the texts differ."""
    pairs = [(number(a), number(b)) for a, b in zip(old, new)]
    if len(old) != len(new) or any((a is None) != (b is None) for a, b in pairs):
        return None
    values = [(a, b) for a, b in pairs if a is not None]
    size = max((max(abs(a), abs(b)) for a, b in values), default=0.0)
    return max((abs(a - b) for a, b in values), default=0.0) / size if size else 0.0


def compare_tables(where, old, new, exact):
    """Lines about what differs."""
    faults = []
    heads_old, columns_old = columns(old)
    heads_new, columns_new = columns(new)
    if len(heads_old) != len(heads_new):
        return [f"{where}: {len(heads_old)} columns have become {len(heads_new)}"]
    for head_old, head_new, a, b in zip(heads_old, heads_new, columns_old, columns_new):
        if head_old != head_new:
            faults.append(f"{where}: column `{head_old}` has become `{head_new}`")
        if a != b and (exact or (largest_difference(a, b) or 1.0) > 0.0):
            faults.append(f"{where}: `{head_new}` differs by {largest_difference(a, b)} of its largest value")
    return faults


def tables(folder):
    return {path.stem: path for path in sorted(folder.glob("*.csv"))}


def compare(case, command, arguments):
    with tempfile.TemporaryDirectory() as one, tempfile.TemporaryDirectory() as two:
        one, two = pathlib.Path(one), pathlib.Path(two)
        old = run(arguments.old, command, case, arguments.scenes, one)
        new = run(arguments.new, command, case, TOP / "validation", two)
        where = f"{case} {command}"
        if old.returncode != new.returncode:
            return [f"{where}: status {old.returncode} has become {new.returncode}: {new.stderr.strip()[:300]}"], 0
        if old.returncode == 2:
            return [], 0
        faults, count = [], 0
        files_old, files_new = tables(one), tables(two)
        if files_old.keys() != files_new.keys():
            faults.append(f"{where}: files {sorted(files_old)} have become {sorted(files_new)}")
        for name in files_old.keys() & files_new.keys():
            count += len(columns(files_old[name])[0])
            faults += compare_tables(f"{where} {name}", files_old[name], files_new[name], command in EXACT)
        if command == "check":
            numbers_old, numbers_new = NUMBER.findall(old.stdout), NUMBER.findall(new.stdout)
            count = len(numbers_old)
            lost = [n for n in set(numbers_old) if numbers_old.count(n) > numbers_new.count(n)]
            faults += [f"{where}: the numbers {lost} are not printed any more"] if lost else []
        return faults, count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--scenes", type=pathlib.Path, default=TOP / "validation")
    parser.add_argument("--motions", action="store_true")
    parser.add_argument("cases", nargs="*")
    arguments = parser.parse_args()
    arguments.old, arguments.new = arguments.old.resolve(), arguments.new.resolve()
    arguments.scenes = arguments.scenes.resolve()
    cases = arguments.cases or sorted(p.parent.name for p in (TOP / "validation").glob("*/scene.toml"))
    faults, count = [], 0
    for case in cases:
        for command in EXACT + (MOTIONS if arguments.motions else []):
            found, columns_compared = compare(case, command, arguments)
            for line in found:
                print(line, flush=True)
            faults += found
            count += columns_compared
    print(f"{len(cases)} cases, {count} columns and printed numbers compared, {len(faults)} differences")
    sys.exit(1 if faults else 0)


main()

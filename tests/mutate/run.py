#!/usr/bin/env python3
"""Changes of the source text, one at a time, and which numbered checks of `dwell validate` fail by each.

    python3 tests/mutate/run.py 400 1          # one change of each of 400 lines drawn by seed 1, all of the laws, all named faults
    python3 tests/mutate/run.py --named        # only the named faults of named.toml
    python3 tests/mutate/run.py 400 1 --again  # only those that the last run found neither caught nor without effect

All changes are built into one program, in target/mutate; a variable of the environment chooses one. The overview is
reports/source-mutations.md and .txt; what is not caught stands there with its reason, from tests/mutate/reasons.toml.
"""
import argparse
import hashlib
import json
import os
import pickle
import sys
import time

import exercise
import judge
import named
import overview
import schemata
import selection

# Outcomes that a later run need not look at again.
SETTLED = {judge.CAUGHT, "no number changed", "not reached", "refused", "endless"}


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("lines", type=int, nargs="?", default=400)
    options.add_argument("seed", type=int, nargs="?", default=1)
    options.add_argument("--named", action="store_true", help="only the named faults")
    options.add_argument("--again", action="store_true", help="only what the last run left open")
    options.add_argument("--seconds", type=float, default=float("inf"), help="stop after so long; --again goes on from there")
    options.add_argument("--largest", type=int, default=None, help="at most so many changes of the laws")
    options = options.parse_args()
    os.nice(10)
    begin = time.monotonic()
    say = lambda text: print(f"{time.monotonic() - begin:5.0f} s  {text}", flush=True)
    top = selection.top()
    changes = chosen(top, options)
    folder = top / "target" / "mutate"
    build = schemata.Build(top, folder, changes)
    build.run(say)
    program = exercise.Program(build.program(), folder / "runs")
    all_cases, all_exercises = reached(build, program, folder, say)
    store = folder / ("named.json" if options.named else "results.json")
    known = {key(one): one for one in json.loads(store.read_text())} if options.again and store.is_file() else {}
    results = []
    for count, change in enumerate(build.changes, 1):
        result = known.get(key_of(change))
        if result is None or result["outcome"] not in SETTLED:
            if time.monotonic() - begin > options.seconds:
                results += [result] if result else []
                continue
            result = judge.judge(change, program, all_cases, all_exercises).as_dict()
            result["text"] = selection.line_of(top, change)
            say(f"{count}/{len(build.changes)} {result['outcome']}: {change.path}:{change.line} {change.what} {sorted(result['checks'])}")
        results.append(result)
        store.write_text(json.dumps(results, indent=1, ensure_ascii=False))
    store.write_text(json.dumps(results, indent=1, ensure_ascii=False))
    return overview.write(top, results, len(build.left_out), options, say)


def reached(build, program, folder, say):
    """What each case and each run reaches; as it was found before, if the program and the scenes are the same."""
    files = [build.program(), *sorted(build.tree.glob("**/*.toml")), *(selection.top() / "tests/mutate" / name for name in ("exercise.py", "contents.py"))]
    state = hashlib.sha256(b"".join(hashlib.sha256(path.read_bytes()).digest() for path in files)).hexdigest()
    store = folder / "reached.pickle"
    if store.is_file():
        known, found = pickle.loads(store.read_bytes())
        if known == state:
            return found
    found = judge.cases(build.tree, program), exercise.exercises(build.tree, program, say)
    store.write_bytes(pickle.dumps((state, found)))
    return found


def chosen(top, options):
    """The changes of a run; a named fault that finds no place ends it."""
    changes, wrong = named.named_changes(top)
    if wrong:
        raise SystemExit("\n".join(wrong))
    if not options.named:
        changes += selection.drawn_changes(top, options.lines, options.seed) + selection.exhaustive_changes(top)[: options.largest]
    return changes


def key(result):
    """What stays the same where lines are added above."""
    return result["file"], result["text"], result["change"], result["instead"]


def key_of(change):
    return change.path, selection.line_of(selection.top(), change), change.what, change.text


if __name__ == "__main__":
    sys.exit(main())

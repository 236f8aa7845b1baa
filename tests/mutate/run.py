#!/usr/bin/env python3
"""Changes the source text, one change at a time, and finds the numbered checks of `dwell validate` that fail.

    python3 tests/mutate/run.py 400 1          # one change of each of 400 lines drawn by seed 1, all of the laws, all named faults
    python3 tests/mutate/run.py --named        # only the named faults of named.toml
    python3 tests/mutate/run.py 400 1 --again  # only those that the last run found neither caught nor without effect

All changes are built into one program, in target/mutate; a variable of the environment chooses one. The overview is
reports/source-mutations.md and .txt; what is not caught stands there with its reason, from tests/mutate/reasons.toml.
"""
import argparse
import collections
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

# Outcomes that `--again` skips.
SETTLED = {judge.CAUGHT, "no number changed", "not reached", "refused", "endless"}
# A number is known to change, and only the checks are to be tried again. What no check catches is tried from its beginning.
OPEN = {"caught by one"}


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
    all_cases = judge.cases(build.tree, program)
    say(f"{len(all_cases)} cases reach {len(set().union(*(case.reached for case in all_cases)))} changes")
    all_exercises = None
    store = folder / ("named.json" if options.named else "results.json")
    earlier = json.loads(store.read_text()) if options.again and store.is_file() else []
    known = dict(zip(keys(map(key, earlier)), earlier))
    results, keep = [], lambda rest: store.write_text(json.dumps(results + rest, indent=1, ensure_ascii=False))
    all_keys = keys(map(key_of, build.changes))
    for count, (change, its_key) in enumerate(zip(build.changes, all_keys), 1):
        result = known.pop(its_key, None)
        if result is None or result["outcome"] not in SETTLED:
            if time.monotonic() - begin > options.seconds:
                results += [result] if result else []
                continue
            if result and result["outcome"] in OPEN:
                result = judge.judge_again(change, result, program, all_cases).as_dict()
            else:
                all_exercises = all_exercises or reached(build, program, folder, say)
                result = judge.judge(change, program, all_cases, all_exercises).as_dict()
            result["text"] = selection.line_of(top, change)
            say(f"{count}/{len(build.changes)} {result['outcome']}: {change.path}:{change.line} {change.what} {sorted(result['checks'])}")
            results.append(result)
            # Written now, so that an interrupted run keeps the changes that are still to be tried.
            keep(list(known.values()))
        else:
            results.append(result)
    keep([])
    return overview.write(top, results, len(build.left_out), options, say, len(build.changes))


def reached(build, program, folder, say):
    """What each run reaches and writes; as it was found before, if the program and the scenes are the same."""
    files = [build.program(), *sorted(build.tree.glob("**/*.toml")), *(selection.top() / "tests/mutate" / name for name in ("exercise.py", "contents.py"))]
    state = hashlib.sha256(b"".join(hashlib.sha256(path.read_bytes()).digest() for path in files)).hexdigest()
    store = folder / "reached.pickle"
    if store.is_file():
        known, found = pickle.loads(store.read_bytes())
        if known == state:
            return found
    found = exercise.exercises(build.tree, program, say)
    store.write_bytes(pickle.dumps((state, found)))
    return found


def chosen(top, options):
    """The changes of a run. A named fault whose text is not found ends the run."""
    changes, wrong = named.named_changes(top)
    if wrong:
        raise SystemExit("\n".join(wrong))
    if not options.named:
        changes += selection.drawn_changes(top, options.lines, options.seed) + selection.exhaustive_changes(top)[: options.largest]
    return changes


def keys(some):
    """The key of each change, with its number among equal ones, such as two constants of one line."""
    counts = collections.Counter()
    numbered = []
    for one in some:
        counts[one] += 1
        numbered.append((one, counts[one]))
    return numbered


def key(result):
    """An identification that does not change if lines are added above."""
    return result["file"], result["text"], result["change"], result["instead"]


def key_of(change):
    return change.path, selection.line_of(selection.top(), change), change.what, change.text


if __name__ == "__main__":
    sys.exit(main())

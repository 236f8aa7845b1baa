#!/usr/bin/env python3
"""Random jobs of `dwell optimise`, each in a process of its own, judged by sweeps of the scene that it wrote.

    python3 tests/jobs/run.py 300 1                        # 300 jobs of seed 1; status 1 where one is wrong
    python3 tests/jobs/run.py 1 1 --first 77 --keep FOLDER # job 77 again, with its scene and its files

The program is target/release/dwell, or that of --program. A job is

  certified      the sweep has the same goal and conditions, no design nearby is better, and differences confirm its prices
  front          its points have these goals, satisfy the conditions, and none is worse than another
  not certified  the program says why
  refused        the program names what is wrong, with status 1 or 2
  slow           it computes for more than 30 s
  wrong          anything else: a panic, a contradiction, an optimum that is none
"""
import argparse
import collections
import multiprocessing
import os
import pathlib
import random
import shutil
import sys
import tempfile
import time

import make
import program as runs
from judge import Fault, Judge

TOP = pathlib.Path(__file__).resolve().parents[2]
# At most this part of the jobs that can be solved may be refused or slow (seen: 2 of 14, in space and a leg, by variants of the scene), and at
# least this part certified or fronts.
MOST_REFUSED, LEAST_SOLVED = 0.3, 0.5


def judged(task):
    seed, number, program, keep = task
    rng = random.Random(f"jobs/{seed}/{number}")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dwell-jobs-"))
    try:
        job = make.draw(rng, program, folder)
        begin = time.monotonic()
        pictures = "main" if rng.random() < 0.1 else "none"
        arguments = ["optimise", "machine.toml", "--seed", str(rng.randint(1, 9)), "--pictures", pictures, "--out", "out"]
        status, text = runs.run(program, arguments, folder)
        seconds = time.monotonic() - begin
        (folder / "out.txt").write_text(text)
        try:
            kind, detail = Judge(program, job, folder).verdict(status, text)
        except Fault as fault:
            kind, detail = "wrong", str(fault)
        except runs.Refused as refused:
            kind, detail = "wrong", f"the sweep refuses the written scene: {refused}"
        if keep:
            shutil.copytree(folder, pathlib.Path(keep) / f"{seed}-{number}", dirs_exist_ok=True)
        return number, job.kind, kind, detail, seconds
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("jobs", type=int)
    options.add_argument("seed", type=int)
    options.add_argument("--first", type=int, default=0)
    options.add_argument("--program", default=str(TOP / "target/release/dwell"))
    options.add_argument("--processes", type=int, default=os.cpu_count())
    options.add_argument("--keep", default=str(TOP / "target/jobs"), help="a folder for the scenes and files of all jobs")
    options = options.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    tasks = [(options.seed, options.first + k, program, options.keep) for k in range(options.jobs)]
    totals, details, begin, worst = collections.Counter(), collections.Counter(), time.monotonic(), 0.0
    with multiprocessing.Pool(options.processes) as pool:
        for number, start, kind, detail, seconds in pool.imap_unordered(judged, tasks):
            totals[start, kind] += 1
            if isinstance(detail, float):
                worst = max(worst, detail)
                detail = "confirmed by differences"
            details[kind, detail[:90]] += 1
            if kind in ("wrong", "slow") or kind == "refused" and start in ("fair", "infeasible"):
                print(f"job {options.seed}/{number} ({start}, {seconds:.0f} s), {kind}: {detail}", flush=True)
    for (start, kind), count in sorted(totals.items()):
        print(f"  {start}: {count} {kind}")
    for (kind, detail), count in sorted(details.items()):
        print(f"  {kind}, {detail}: {count}")
    kinds = collections.Counter()
    for (start, kind), count in totals.items():
        kinds[kind] += count
    print(f"  largest residual by differences: {worst:.1e}")
    print(f"{options.jobs} jobs of seed {options.seed} in {time.monotonic() - begin:.0f} s: " + ", ".join(f"{c} {k}" for k, c in sorted(kinds.items())))
    fair = sum(count for (start, _), count in totals.items() if start in ("fair", "torn"))
    lost = sum(count for (start, kind), count in totals.items() if start in ("fair", "torn") and kind in ("refused", "slow"))
    solved = kinds["certified"] + kinds["front"]
    is_bad = kinds["wrong"] > 0 or fair >= 20 and (lost > MOST_REFUSED * fair or solved < LEAST_SOLVED * fair)
    sys.exit(is_bad)


if __name__ == "__main__":
    main()

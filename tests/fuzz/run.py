#!/usr/bin/env python3
"""Runs pairs of a mutated scene and a command, each in its own process. No run may panic, compute for more than 10 s without output,
take more than 2 GB, or be inconsistent in its status, messages, numbers and files.

    python3 tests/fuzz/run.py 2000 1             # 2000 pairs of seed 1; status 1 where one fails
    python3 tests/fuzz/run.py 1 1 --first 716 --keep FOLDER   # pair 716 again, with its scene and its files

The program is target/release/dwell, or that of --program. Pair k of a seed is the same on every machine and whatever the number of
pairs; --first begins with another than pair 0.
"""
import argparse
import collections
import multiprocessing
import os
import pathlib
import random
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import commands
import judge
import scenes

# At least this part of the pairs must be valid: status 0, or a result with status 1.
LEAST_VALID = 0.3
# Longest wait on the clock for a run that uses no computing time, s.
LONGEST_WAIT = 120
SOURCES = scenes.sources()


def limit():
    """Limits of the child process: its computing time, a second longer than the longest silence, and its memory."""
    resource.setrlimit(resource.RLIMIT_CPU, (judge.LONGEST + 1, judge.LONGEST + 3))
    resource.setrlimit(resource.RLIMIT_AS, (2 * judge.LARGEST, 2 * judge.LARGEST))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run_pair(task):
    """Runs pair `number` of a seed; its command, status and faults."""
    seed, number, program, keep = task
    rng = random.Random(f"{seed}/{number}")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dwell-fuzz-"))
    try:
        name = commands.name(rng)
        text = scenes.mutated(rng, rng.choice(SOURCES), name)
        arguments = commands.arguments_of(rng, name, text, folder)
        (folder / "scene.toml").write_text(text, encoding="utf-8", errors="surrogatepass")
        run = run_program(program, arguments, text, folder)
        faults = judge.faults(run)
        if keep:
            shutil.copytree(folder, pathlib.Path(keep) / f"{seed}-{number}", dirs_exist_ok=True)
        return number, arguments, run.status, faults, run.seconds
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def environment():
    # One thread: its computing time equals the elapsed time on an idle machine.
    return {"NO_COLOR": "1", "LC_ALL": "C.UTF-8", "TERM": "xterm", "RAYON_NUM_THREADS": "1"}


def run_program(program, arguments, text, folder):
    paths = [folder / "out.txt", folder / "err.txt"]
    with open(paths[0], "wb") as out, open(paths[1], "wb") as err:
        child = subprocess.Popen(
            [program, *arguments], cwd=folder, env=environment(), stdin=subprocess.DEVNULL, stdout=out, stderr=err, preexec_fn=limit
        )
        signal.signal(signal.SIGALRM, lambda *_: child.kill())
        signal.alarm(LONGEST_WAIT)
        _, status, usage = os.wait4(child.pid, 0)
        signal.alarm(0)
        child.returncode = os.waitstatus_to_exitcode(status)
    out, err = [path.read_text(encoding="utf-8", errors="replace") for path in paths]
    seconds, memory = usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss
    return judge.Run(arguments, text, child.returncode, out, err, seconds, memory, folder)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("pairs", type=int)
    options.add_argument("seed", type=int)
    options.add_argument("--first", type=int, default=0)
    options.add_argument("--program", default=str(scenes.TOP / "target/release/dwell"))
    options.add_argument("--jobs", type=int, default=os.cpu_count())
    options.add_argument("--keep", help="a folder for scenes and files of all pairs")
    options = options.parse_args()
    numbers = range(options.first, options.first + options.pairs)
    program = str(pathlib.Path(options.program).resolve())
    tasks = [(options.seed, number, program, options.keep) for number in numbers]
    long_runs, statuses, failed, begin = 0, collections.Counter(), [], time.monotonic()
    by_command = collections.defaultdict(lambda: [0, 0, 0.0])
    with multiprocessing.Pool(options.jobs) as pool:
        for number, arguments, status, faults, seconds in pool.imap_unordered(run_pair, tasks, chunksize=4):
            statuses[status] += 1
            long_runs += status == judge.OUT_OF_TIME and not faults
            of = by_command[arguments[0]]
            of[0], of[1], of[2] = of[0] + 1, of[1] + (status in (0, 1)), of[2] + seconds
            for fault in faults:
                failed.append((number, fault))
                print(f"pair {options.seed}/{number}: dwell {shlex.join(arguments)}\n  {fault}", flush=True)
    valid = (statuses[0] + statuses[1]) / max(1, options.pairs)
    seconds = time.monotonic() - begin
    for name, (count, accepted, used) in sorted(by_command.items()):
        print(f"  {name}: {count} pairs, {accepted} valid, {used / count:.3f} s each")
    print(f"{options.pairs} pairs of seed {options.seed} in {seconds:.0f} s: {valid:.0%} valid, "
          f"{long_runs} longer than {judge.LONGEST} s, {len(failed)} faults")
    # A single pair is a repetition for inspection.
    return 1 if failed or options.pairs >= 100 and valid < LEAST_VALID else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Motions under nested laws, each by `dwell simulate` and by an independent program: the last positions and speeds agree.

    python3 tests/laws/run.py 2000 1              # 2000 laws of seed 1; status 1 where one is wrong
    python3 tests/laws/run.py 1 1 --first 716 --keep FOLDER    # law 716 again, with its scene and its files

The program is target/release/dwell, or that of --program. Law k of a seed is the same on every machine. Laws are of depth 1 to 5,
from if, step, sign, floor, ceilings, min, max, clamp, abs, tables, products, sums, narrow pulses and windows, of t, a coordinate,
a speed or all of them (`draw.py`). A law is

  right       the program agrees to 1e-9 of the largest value of each coordinate and speed
  finer       it does so at a tenth of its tolerance, and nearly so at its own: the difference is the error of its method
  wrong       it does not, says nothing, or panics
  unnamed     it is refused, with the load not named
  refused     the program names the load and what is wrong, with status 1 or 2
  slow        it computes for more than 10 s
  not judged  its motion is not unique, its switches accumulate, or it depends on what is below 1e-11: the reason is counted

At most 1 % of those judged may be refused or slow.
"""
import argparse
import collections
import csv
import math
import multiprocessing
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import draw
import motion

TOP = pathlib.Path(__file__).resolve().parents[2]
AGREE = 1e-9
# A motion that differs by less than this many times what is allowed is computed again at a tenth of its tolerance, at which the error of
# any method falls by three and more; what is decided otherwise, or at another time, differs as before.
NEARLY, FALLS = 3, 3
# A motion that grazes a threshold at a slope below 1e-7 is not compared more closely than this.
GRAZING = 1e-6
LONGEST = 10
LARGEST_MEMORY = 4 << 30
MOST_REFUSED = 0.01
# The motion again from a start this far away: where it ends elsewhere by as much as the program, it says nothing of the program.
NEARBY = 1e-11
# Where a motion differs by more than this, it is kicked so often on the way, by so much.
FAR, KICKS, KICK = 1e-3, 15, 1e-8
# Method, tolerance, and how well its motions agree: ESDIRK34 has errors of 5e-8 in smooth motions at a tolerance that takes as long.
METHODS = [("bdf", 1e-12, AGREE), ("dop853", 1e-12, AGREE), ("tsit45", 1e-12, AGREE), ("esdirk34", 1e-11, 1e-6)]


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 2))
    resource.setrlimit(resource.RLIMIT_AS, (LARGEST_MEMORY, LARGEST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def reference(scene, shift=0.0, kicks=0, kick=0.0, **options):
    """The reference motion from a start moved by `shift`. Its speeds are changed by `kick` several times on the way."""
    found = motion.Motion(scene.laws, [x + shift for x in scene.start], **options)
    for part in range(1, kicks + 1):
        found.run(draw.DURATION * part / (kicks + 1))
        for k in found.speeds:
            found.point[k] += kick
    found.run(draw.DURATION)
    return found


def simulated(program, scene, method, folder, finer=1.0):
    """Status, message and the last row of the program, at its tolerance or a finer one."""
    (folder / "law.toml").write_text(scene.text)
    name, tolerance, _ = method
    tolerance *= finer
    arguments = ["simulate", "law.toml", "--method", name, "--rtol", str(tolerance), "--atol", str(tolerance)]
    arguments += ["--pictures", "none", "--sample-interval", str(draw.DURATION), "--out", "out"]
    with open(folder / "out.txt", "wb") as out:
        child = subprocess.Popen(
            [program, *arguments], cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=out, preexec_fn=limit,
            env={"NO_COLOR": "1", "LC_ALL": "C.UTF-8", "RAYON_NUM_THREADS": "1"},
        )
        signal.signal(signal.SIGALRM, lambda *_: child.kill())
        signal.alarm(12 * LONGEST)
        child.wait()
        signal.alarm(0)
    row, path = None, folder / "out" / "law-motion.csv"
    if path.exists():
        rows = list(csv.DictReader(path.open()))
        row = rows[-1] if rows else None
    return child.returncode, (folder / "out.txt").read_text(errors="replace"), row


def values_of(scene, row):
    places = [float(row[next(c for c in row if c.startswith(f"{name} ["))]) for name in scene.names]
    speeds = [float(row[next(c for c in row if c.startswith(f"{name}.velocity ["))]) for name in scene.names]
    return [*places, *speeds]


def difference(values, right, largest):
    """The largest difference, relative to the largest coordinate or speed; NaN counts as infinite."""
    parts = [abs(a - b) / max(size, 1e-3) for a, b, size in zip(values, right, largest)]
    return max(math.inf if math.isnan(p) else p for p in parts)


def verdict(scene, found, run, agree, again):
    """The verdict on a run of the program; `again` computes the motion at a tenth of its tolerance."""
    status, text, row = run
    if status in (-signal.SIGXCPU, -signal.SIGKILL):
        return "slow", f"more than {LONGEST} s"
    if "panicked" in text or status not in (0, 1, 2):
        return "wrong", f"status {status}: {text[:300]}"
    time_column = row and float(row["t [s]"])
    if status != 0 or time_column is None or abs(time_column - draw.DURATION) > 1e-9:
        named = any(f"`{name}{i}`" in text for name in "fg" for i in range(2))
        message = " ".join(line.strip() for line in text.splitlines() if line.lstrip().startswith(("×", "│")))
        if status == 0:
            return "wrong", f"status 0 at t = {time_column}"
        if is_sensitive(scene, found, GRAZING):
            return "not judged", "refused, and depends on what is below 1e-11"
        return ("refused", message[:300] or text[:300]) if named else ("unnamed", message[:300] or text[:300])
    values = values_of(scene, row)
    gap = difference(values, found.point[1:], found.largest)
    if gap <= agree:
        return "right", gap
    if gap <= NEARLY * agree:
        status, _, finer_row = again()
        finer = difference(values_of(scene, finer_row), found.point[1:], found.largest) if status == 0 and finer_row else math.inf
        if finer <= min(agree, gap / FALLS):
            return "finer", f"differs by {gap:.1e}, and by {finer:.1e} at a tenth of the tolerance"
    if found.is_close and gap < GRAZING:
        return "not judged", "touches a threshold, and agrees to 1e-6"
    if is_sensitive(scene, found, gap):
        return "not judged", "depends on what is below 1e-11"
    return "wrong", f"differs by {gap:.1e}: {values}, right {found.point[1:]}"


def is_sensitive(scene, found, gap):
    """Whether the motion from a neighbouring start, or with other steps, differs by as much."""
    try:
        others = [reference(scene, shift) for shift in (NEARBY, -NEARBY)] + [reference(scene, order=11, tolerance=1e-15)]
        if gap > FAR:
            # What stays on a threshold from which all leads away may leave it at any time.
            others += [reference(scene, kicks=KICKS, kick=kick) for kick in (KICK, -KICK)]
    except motion.Unjudged:
        return True
    return max(difference(other.point[1:], found.point[1:], found.largest) for other in others) > 0.1 * gap


def scene_of(seed, number):
    """Scene, method, its motion, or why there is none to compare with. What grows beyond bounds is drawn again."""
    rng = random.Random(f"laws/{seed}/{number}")
    while True:
        scene, method = draw.Scene(rng), rng.choice(METHODS)
        try:
            return scene, method, reference(scene), None
        except motion.Grows:
            continue
        except motion.Unjudged as unjudged:
            return scene, method, None, str(unjudged)


def judged(task):
    seed, number, program, keep = task
    scene, method, found, reason = scene_of(seed, number)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dwell-laws-"))
    try:
        begin = time.monotonic()
        run = simulated(program, scene, method, folder)
        seconds = time.monotonic() - begin
        if found is None:
            # Without a reference, the program must still end without a panic.
            is_slow = run[0] in (-signal.SIGXCPU, -signal.SIGKILL)
            is_lost = not is_slow and run[0] not in (0, 1, 2) or "panicked" in run[1]
            outcome = ("wrong", run[1][:300]) if is_lost else ("slow", f"more than {LONGEST} s") if is_slow else ("not judged", reason)
        else:
            outcome = verdict(scene, found, run, method[2], lambda: simulated(program, scene, method, folder, 0.1))
        if keep:
            shutil.copytree(folder, pathlib.Path(keep) / f"{seed}-{number}", dirs_exist_ok=True)
        counts = (found.events, found.slides) if found else (0, 0)
        return number, scene, method, outcome, seconds, counts
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("laws", type=int)
    options.add_argument("seed", type=int)
    options.add_argument("--first", type=int, default=0)
    options.add_argument("--program", default=str(TOP / "target/release/dwell"))
    options.add_argument("--jobs", type=int, default=os.cpu_count())
    options.add_argument("--keep", help="a folder for the scenes and files of all laws")
    options = options.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    tasks = [(options.seed, options.first + k, program, options.keep) for k in range(options.laws)]
    totals, reasons, depths = collections.Counter(), collections.Counter(), collections.defaultdict(collections.Counter)
    worst, with_events, with_slides, begin = 0.0, 0, 0, time.monotonic()
    with multiprocessing.Pool(options.jobs) as pool:
        for number, scene, method, (kind, detail), seconds, (events, slides) in pool.imap_unordered(judged, tasks, chunksize=2):
            totals[kind] += 1
            depths[scene.depth][kind] += 1
            with_events, with_slides = with_events + (events > 0), with_slides + (slides > 0)
            if kind == "right":
                worst = max(worst, detail)
            elif kind == "not judged":
                reasons[detail] += 1
            else:
                print(f"law {options.seed}/{number}, {kind}, {scene.kind}, {method[0]}: {detail}\n{scene.text}", flush=True)
    for depth, counts in sorted(depths.items()):
        print(f"  depth {depth}: " + ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items())))
    for reason, count in sorted(reasons.items()):
        print(f"  not judged, {reason}: {count}")
    print(f"  largest difference of those that are right: {worst:.1e}; {with_events} have events, {with_slides} slide")
    seconds = time.monotonic() - begin
    print(f"{options.laws} laws of seed {options.seed} in {seconds:.0f} s: " + ", ".join(f"{c} {k}" for k, c in sorted(totals.items())))
    considered = options.laws - totals["not judged"]
    unanswered = totals["refused"] + totals["slow"]
    is_wrong = totals["wrong"] + totals["unnamed"] > 0
    return 1 if is_wrong or options.laws >= 100 and unanswered > MOST_REFUSED * considered else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Random motions that are driven into limits and singular positions: every run ends, with rows, the instant and the cause, and no row is false.

    python3 tests/fuzz/motions.py 30 1           # 30 motions of seed 1; status 1 where one fails
    python3 tests/fuzz/motions.py 1 1 --first 17 --keep FOLDER   # motion 17 again, with its scene and its files

In the plane and in space, of one to four coordinates, each by a method. Of every run: status 0, or 1 with a message that says why; a table
that reaches the end of the summary; in the last rows the kinetic energy of the table is that of the masses, computed here from velocities of
the centres of mass and angular velocities, and energies and works balance; and not more than 20 times the median steps of its kind and method.
The program is target/release/dwell, or that of --program. Motion k of a seed is the same whatever the number of motions.
"""
import argparse
import collections
import csv
import json
import math
import pathlib
import random
import re
import statistics
import subprocess
import sys
import tempfile

METHODS = ["bdf", "esdirk34", "tr-bdf2", "tsit45", "dop853"]
# The number of last rows that are checked.
LAST = 5
# The energies of a row, as parts of the largest kinetic energy: between digits of two computations, and of the balance. The rows before
# a singular position closed to 1e-5; false ones missed by 0.3 and more.
SAME, BALANCED = 1e-9, 1e-3
# Largest number of steps as a multiple of the median, and a number of steps that is always allowed.
MOST, ALLOWED = 20, 30000
# Longest computing time, s.
LONGEST = 60


def number(value):
    return format(value, ".6g")


def vector(values):
    return "[" + ", ".join(number(v) for v in values) + "]"


class Body:
    """A body with points in its frame, which coincides with the frame of the ground at the start."""

    def __init__(self, rng, name, points):
        self.name, self.points = name, points
        space = len(next(iter(points.values())))
        ends = list(points.values())
        middle = [sum(p[k] for p in ends) / len(ends) + rng.uniform(-0.02, 0.02) for k in range(space)]
        self.points["G"] = middle
        self.mass, self.inertia = rng.uniform(0.2, 3), rng.uniform(1e-3, 2e-2)

    def text(self):
        points = ", ".join(f"{name} = {vector(p)}" for name, p in self.points.items())
        space = len(self.points["G"]) == 3
        inertia = vector([self.inertia] * 3 + [0] * 3) if space else number(self.inertia)
        return f"[bodies.{self.name}]\npoints = {{ {points} }}\nmass = {number(self.mass)}\ncenter = \"G\"\ninertia = {inertia}\n"


def scene(ground, bodies, joints, actuators, rest):
    points = ", ".join(f"{name} = {vector(p)}" for name, p in ground.items())
    text = f"[bodies.ground]\npoints = {{ {points} }}\n" + "".join(b.text() for b in bodies)
    text += "[joints]\n" + "".join(f"{line}\n" for line in joints)
    text += "[actuators]\n" + "".join(f"{line}\n" for line in actuators)
    return text + rest


def speeds(rng, names, largest):
    values = ", ".join(f"{name} = {number(rng.uniform(-largest, largest))}" for name in names)
    return f"[motion]\ninitial-velocity = {{ {values} }}\nduration = {number(rng.uniform(0.2, 1.0))}\n"


def chain_in_plane(rng, pendulums, links):
    """A loop of moving links whose speeds soon stretch it, with pendulums on it."""
    near = lambda x, y: [x + rng.uniform(-0.06, 0.06), y + rng.uniform(-0.06, 0.06)]
    places = {3: [(0, 0), (0, 0.15), (0.3, 0.25), (0.35, 0)], 4: [(0, 0), (0, 0.12), (0.2, 0.3), (0.35, 0.15), (0.35, 0)]}
    at = [near(*place) for place in places[links]]
    names = "ABCDE"[: links + 1]
    ground = {names[0]: at[0], names[-1]: at[-1]}
    bodies = [Body(rng, f"b{k}", {names[k]: at[k], names[k + 1]: at[k + 1]}) for k in range(links)]
    joints = []
    for k, name in enumerate(names):
        one = "ground" if k == 0 else f"b{k - 1}"
        two = "ground" if k == links else f"b{k}"
        joints.append(f'{name} = {{ revolute = ["{one}.{name}", "{two}.{name}"] }}')
    actuators = {3: ["p = { angle = [\"ground\", \"b0\"] }"]}.get(
        links, ['p = { angle = ["ground", "b0"] }', f'q = {{ angle = ["ground", "b{links - 1}"] }}'])
    for k in range(pendulums):
        carrier = bodies[k]
        point = f"P{k}"
        carrier.points[point] = near(*carrier.points["G"])
        start = carrier.points[point]
        # The mass centre of the carrier has been drawn: the point does not move it.
        bodies.append(Body(rng, f"bob{k}", {point: start, "T": [start[0], start[1] - 0.2]}))
        joints.append(f'{point} = {{ revolute = ["{carrier.name}.{point}", "bob{k}.{point}"] }}')
        actuators.append(f'r{k} = {{ angle = ["ground", "bob{k}"] }}')
    names = [line.split(" ")[0] for line in actuators]
    start = "[assembly]\n" + "".join(f"{name} = 0\n" for name in names) + "".join(f"{b.name} = 0\n" for b in bodies)
    loads = '[loads]\nweight = { gravity = [0, -9.81] }\n'
    if rng.random() < 0.5:
        loads += f'turn = {{ torque = ["ground", "b0"], magnitude = "{number(rng.uniform(-5, 5))}*cos({number(rng.uniform(1, 20))}*t)" }}\n'
    return scene(ground, bodies, joints, actuators, start + loads + speeds(rng, names, 6))


def spherical_loop(rng, pendulum):
    """Crank, rod between two spherical joints, and rocker, with a pendulum on the crank. The crank can seldom rotate fully."""
    a, d = [0, 0, 0], [rng.uniform(0.3, 0.5), rng.uniform(-0.05, 0.05), rng.uniform(0, 0.2)]
    b = [rng.uniform(0.08, 0.3), 0, 0]
    c = [d[0] + rng.uniform(-0.05, 0.05), d[1], d[2] + rng.uniform(0.15, 0.3)]
    bodies = [Body(rng, "crank", {"A": a, "B": b}), Body(rng, "rocker", {"D": d, "C": c})]
    joints = ['A = { revolute = ["ground.A", "crank.A"], axis = [0, 0, 1] }',
              f'rod = {{ distance = ["crank.B", "rocker.C"], length = {math.dist(b, c)!r} }}',
              'D = { revolute = ["ground.D", "rocker.D"], axis = [0, 1, 0] }']
    actuators = ['phi = { angle = "A" }']
    if pendulum:
        bodies.append(Body(rng, "bob", {"B": b, "T": [b[0], b[1] - 0.1, b[2]]}))
        joints.append(f'P = {{ revolute = ["crank.B", "bob.B"], axis = {vector([0, rng.uniform(-0.3, 0.3), 1])} }}')
        actuators.append('psi = { angle = "P" }')
    names = [line.split(" ")[0] for line in actuators]
    start = "[assembly]\n" + "".join(f"{name} = 0\n" for name in names)
    loads = f"[loads]\nweight = {{ gravity = {vector([rng.uniform(-5, 5), 0, -9.81])} }}\n"
    return scene({"A": a, "D": d}, bodies, joints, actuators, start + loads + speeds(rng, names, 10))


def tripod(rng):
    """A platform on three legs of variable length with revolute joints at their feet: three coordinates."""
    angle = lambda k: 2 * math.pi * k / 3
    feet = [[0.4 * math.cos(angle(k)), 0.4 * math.sin(angle(k)), 0] for k in range(3)]
    height = rng.uniform(0.2, 0.5)
    tops = [[0.25 * math.cos(angle(k)), 0.25 * math.sin(angle(k)), height] for k in range(3)]
    bodies = [Body(rng, "plate", {f"T{k}": tops[k] for k in range(3)})]
    joints, actuators = [], []
    for k in range(3):
        along = [t - f for t, f in zip(tops[k], feet[k])]
        bodies.append(Body(rng, f"low{k}", {"F": feet[k], "M": [f + 0.3 * a for f, a in zip(feet[k], along)]}))
        bodies.append(Body(rng, f"high{k}", {"T": tops[k], "M": [f + 0.3 * a for f, a in zip(feet[k], along)]}))
        hinge = [-math.sin(angle(k)), math.cos(angle(k)), 0]
        joints.append(f'F{k} = {{ revolute = ["ground.F{k}", "low{k}.F"], axis = {vector(hinge)} }}')
        joints.append(f'S{k} = {{ prismatic = ["low{k}.M", "high{k}.M"], axis = {vector(along)} }}')
        joints.append(f'B{k} = {{ spherical = ["high{k}.T", "plate.T{k}"] }}')
        actuators.append(f's{k} = {{ travel = "S{k}" }}')
    start = "[assembly]\n" + "".join(f"s{k} = 0\n" for k in range(3))
    loads = "[loads]\nweight = { gravity = [0, 0, -9.81] }\n"
    rest = start + loads + speeds(rng, ["s0", "s1", "s2"], 0.5)
    return scene({f"F{k}": feet[k] for k in range(3)}, bodies, joints, actuators, rest)


KINDS = {
    "four-bar": lambda rng: chain_in_plane(rng, 0, 3),
    "four-bar and pendulum": lambda rng: chain_in_plane(rng, 1, 3),
    "five-bar": lambda rng: chain_in_plane(rng, 0, 4),
    "five-bar and pendulum": lambda rng: chain_in_plane(rng, 1, 4),
    "five-bar and two pendulums": lambda rng: chain_in_plane(rng, 2, 4),
    "loop in space": lambda rng: spherical_loop(rng, False),
    "loop in space and pendulum": lambda rng: spherical_loop(rng, True),
    "platform": tripod,
}


def masses(text):
    """Mass and moment of inertia of each body, from the text of the scene."""
    found = re.findall(r"\[bodies\.(\w+)\]\npoints = .*\nmass = (\S+)\ncenter = \"G\"\ninertia = \[?([^,\n]+)", text)
    return {name: (float(mass), float(inertia)) for name, mass, inertia in found}


def kinetic(row, bodies):
    """The kinetic energy of a row, from the written velocities of the centres of mass and the angular velocities."""
    total = 0.0
    for name, (mass, inertia) in bodies.items():
        velocity = [row.get(f"{name}.G.v{axis}", 0.0) for axis in "xyz"]
        turning = [row.get(f"{name}.angular_velocity{axis}", 0.0) for axis in ("", ".x", ".y", ".z")]
        total += 0.5 * mass * sum(v * v for v in velocity) + 0.5 * inertia * sum(w * w for w in turning)
    return total


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        lines = csv.reader(file)
        names = [name.split(" [")[0] for name in next(lines)]
        return [dict(zip(names, map(float, line))) for line in lines]


def faults(text, run, folder):
    """The faults of a run, and its number of steps."""
    if run.returncode not in (0, 1):
        return [f"status {run.returncode}: {run.stderr.strip().splitlines()[:1]}"], None
    summary = json.loads((folder / "o/scene-simulate.json").read_text(encoding="utf-8"))
    results = {name: entry["value"] for name, entry in summary["results"].items()}
    rows, wrong = rows_of(folder / "o/scene-motion.csv"), []
    largest, bodies = max(row["energy.kinetic"] for row in rows), masses(text)
    if abs(rows[-1]["t"] - results["end"]) > 1e-9 * results["end"]:
        wrong.append(f"the rows end at {rows[-1]['t']}, the motion at {results['end']}")
    said = " ".join(run.stderr.replace("│", " ").split())
    if (results["end"] < results["duration"]) != (run.returncode == 1) and "not resolved" not in said:
        wrong.append(f"status {run.returncode}, though it ends at {results['end']} of {results['duration']} s")
    if run.returncode == 1 and not re.search(r"t = [0-9.e-]+ s|not resolved", said):
        wrong.append(f"no instant: {said[:200]}")
    for row in rows[-LAST:]:
        if abs(kinetic(row, bodies) - row["energy.kinetic"]) > SAME * largest:
            wrong.append(f"kinetic energy at {row['t']} s: {row['energy.kinetic']}, of the masses {kinetic(row, bodies)}")
        if abs(row["energy.balance_error"]) > BALANCED * largest and "not resolved" not in said:
            wrong.append(f"energies at {row['t']} s miss their balance by {row['energy.balance_error']} of {largest} J")
    return wrong, results["steps"]


def run_motion(seed, number_of, program, keep):
    """Runs motion `number_of` of a seed: its kind with its method, its steps and its faults."""
    rng = random.Random(f"motions/{seed}/{number_of}")
    kind = list(KINDS)[number_of % len(KINDS)]
    text, method = KINDS[kind](rng), rng.choice(METHODS)
    folder = pathlib.Path(keep) / f"{seed}-{number_of}" if keep else pathlib.Path(tempfile.mkdtemp(prefix="dwell-motions-"))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(text, encoding="utf-8")
    command = [program, "simulate", "scene.toml", "--method", method, "--pictures", "none", "--name", "scene", "--out", "o"]
    try:
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=LONGEST, check=False)
        wrong, steps = faults(text, run, folder)
        status = run.returncode
    except subprocess.TimeoutExpired:
        wrong, steps, status = [f"no end in {LONGEST} s"], None, None
    return (kind, method), status, steps, wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--keep")
    program = pathlib.Path(__file__).resolve().parents[2] / "target/release/dwell"
    parser.add_argument("--program", default=str(program))
    given = parser.parse_args()
    steps, all_faults, statuses = collections.defaultdict(list), [], collections.Counter()
    for k in range(given.first, given.first + given.count):
        kind, status, taken, wrong = run_motion(given.seed, k, str(pathlib.Path(given.program).resolve()), given.keep)
        statuses[status] += 1
        all_faults += [(k, kind, fault) for fault in wrong]
        if taken is not None:
            steps[kind].append((k, taken))
    for kind, found in steps.items():
        most = max(ALLOWED, MOST * statistics.median(taken for _, taken in found))
        all_faults += [(k, kind, f"{taken:.0f} steps, {most:.0f} allowed") for k, taken in found if taken > most]
    for k, (kind, method), fault in all_faults:
        print(f"motion {k} ({kind}, {method}): {fault}")
    print(f"{given.count} motions of seed {given.seed}: status {dict(statuses)}, {len(all_faults)} faults")
    return 1 if all_faults or not statuses[1] else 0


if __name__ == "__main__":
    sys.exit(main())

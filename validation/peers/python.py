"""Dwell beside Python packages, in one run: `python3 validation/peers/python.py --write`, or `just peers`.

pylinkage gives positions, Exudyn motions, SymPy equations; Dwell gives all three. On the four-bar and the single-dwell the script
measures the times of each, and its error against a closed form that shares no code with Dwell and is evaluated with 40 digits. It
prints tables; `--write` puts them into docs/performance.md. Dwell is the newest wheel in target/wheels; all are installed into a
scratch environment. Needs Python 3.11 or later on x86-64 Linux and the network.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
import time
import tomllib
import venv
from functools import partial
from importlib.metadata import version
from pathlib import Path
from types import SimpleNamespace

from run import HERE, HOME, PACKAGES

if "--measure" in sys.argv:  # in the scratch environment
    import dwell
    import mpmath
    import numpy as np
    import pylinkage
    import sympy

    import mechanism
    import peers

MORE = ["pylinkage==1.3.0", "numba==0.68.1", "sympy==1.14.0", "scipy"]
POSITIONS = 361
TURNS, BEYOND = 10, 1.0  # of the crank in the free motion, and rad
DOCUMENT, BEGIN, END = HOME / "docs" / "performance.md", "<!-- peers/python.py -->", "<!-- /peers/python.py -->"


def placed(base, unit, point):
    """A point of a body: its base, and the direction of its x axis."""
    return base[0] + unit[0] * point[0] - unit[1] * point[1], base[1] + unit[1] * point[0] + unit[0] * point[1]


def towards(f, start, end):
    """Direction and distance from a point to another."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = f.sqrt(x * x + y * y)
    return (x / length, y / length), length


def poses(case, q, f):
    """Base and direction of every moving body, of numbers or symbols. C is left of the way from B to the rocker's pivot."""
    ground, coupler = case.points["ground"], case.points["coupler"]
    crank, pivot = (f.cos(q), f.sin(q)), ground[case.pivot]
    b = placed(ground["A"], crank, case.points["crank"]["B"])
    long, short = coupler["C"][0], case.points["rocker"]["C"][0]
    unit, distance = towards(f, b, pivot)
    along = (distance**2 + long**2 - short**2) / (2 * distance)
    c = placed(b, unit, (along, f.sqrt(long**2 - along**2)))
    found = {"crank": (ground["A"], crank), "coupler": (b, towards(f, b, c)[0]), "rocker": (pivot, towards(f, pivot, c)[0])}
    if "guide" in case.points:
        p = placed(*found["coupler"], coupler["P"])
        found["guide"] = ground["Q"], towards(f, ground["Q"], p)[0]
        found["slider"] = p, found["guide"][1]
    return found


def read(name):
    """A case's data in metres, and its text with a free motion alone: no loads, no drives, no prescribed motion."""
    text = (HERE.parent / name / "scene.toml").read_text(encoding="utf-8")
    scene = tomllib.loads(text)
    unit = mechanism.UNITS[scene["units"]["length"]]
    points = {body: {p: (x * unit, y * unit) for p, (x, y) in has["points"].items()} for body, has in scene["bodies"].items()}
    moving = {body: has for body, has in scene["bodies"].items() if body != "ground"}
    speed = scene.get("prescribed", scene["motion"]).get("phi", {}).get("speed") or scene["motion"]["initial-velocity"]["phi"]
    centers = {body: points[body].get(at) if isinstance(at := has["center"], str) else (at[0] * unit, at[1] * unit)
               for body, has in moving.items()}
    start = scene["assembly"]["phi"]
    wanted = [("coupler", "B"), ("coupler", "C"), ("coupler", "P")] + [("guide", "end")] * ("guide" in points)
    case = SimpleNamespace(name=name, points=points, moving=moving, centers=centers, wanted=wanted, start=start, speed=speed)
    case.pivot = next(iter(points["rocker"]))
    case.duration = duration_of(case, TURNS, BEYOND)
    kept = [t for t in re.split(r"(?m)^(?=\[)", text) if not re.match(r"\[(loads|drives|motion|prescribed|calibration)\b", t)]
    case.free = "".join(kept) + (f"\n[motion]\nduration = {case.duration!r}\ninitial-coordinate = {{ phi = {start!r} }}\n"
                                 f"initial-velocity = {{ phi = {speed!r} }}\n")
    return case


def reduced_inertia(case):
    """m and ½m′ as SymPy expressions: twice the kinetic energy at unit speed, and half its derivative."""
    q, m = sympy.Symbol("q", real=True), 0
    for body, (base, unit) in poses(case, q, sympy).items():
        x, y = (sympy.diff(part, q) for part in placed(base, unit, case.centers[body]))
        rate = unit[0] * sympy.diff(unit[1], q) - unit[1] * sympy.diff(unit[0], q)
        m += case.moving[body]["mass"] * (x**2 + y**2) + case.moving[body].get("inertia", 0.0) * rate**2
    return q, [m, sympy.diff(m, q) / 2]


def duration_of(case, turns, angle):
    """How long the free motion takes for so many turns and an angle: sqrt(m) integrated, to rounding."""
    q, (m, _) = reduced_inertia(case)
    root = sympy.lambdify(q, sympy.sqrt(m), "numpy", cse=True)
    nodes, weights = np.polynomial.legendre.leggauss(100)
    turn = math.tau * np.mean(root(np.linspace(0, math.tau, 4096, endpoint=False)))
    beyond = angle / 2 * np.dot(weights, root(case.start + angle / 2 * (nodes + 1)))
    return float((turns * turn + beyond) / (case.speed * root(case.start)))


def deviation(values, exact, largest=None):
    """The largest deviation, relative to the largest value."""
    return float(np.max(np.abs(np.asarray(values) - exact) / (np.max(np.abs(exact)) if largest is None else largest)))


def exactly(function, coordinates):
    """Evaluated with 40 digits."""
    with mpmath.workdps(40):
        return np.array([[float(v) for v in function(mpmath.mpf(float(q)))] for q in coordinates])


def least(call, seconds=0.3):
    """The least time of a call in about so many seconds."""
    times, end = [timed(call)[1]], time.perf_counter() + seconds
    while time.perf_counter() < end:
        times.append(timed(call)[1])
    return min(times)


def timed(call):
    """What a call gives, and how long it takes."""
    start = time.perf_counter()
    value = call()
    return value, time.perf_counter() - start


def assembled(case):
    """Dwell's mechanism and the time of reading and assembling it."""
    return timed(lambda: dwell.Scene(case.free).assemble())


def by_pylinkage(case, method):
    """A function for its positions; its first call, which compiles, is made. A guide's end is a point on the line from Q to P."""
    ground, coupler, step = case.points["ground"], case.points["coupler"], math.tau / (POSITIONS - 1)
    a, pivot = pylinkage.Ground(*ground["A"]), pylinkage.Ground(*ground[case.pivot])
    b = pylinkage.Crank(a, case.points["crank"]["B"][0], angular_velocity=step, initial_angle=-step)
    x, y = placed(*poses(case, -step, math)["coupler"], coupler["C"])
    c = pylinkage.RRRDyad(b.output, pivot, coupler["C"][0], case.points["rocker"]["C"][0], x=x, y=y)
    parts = [a, pivot, b, c, pylinkage.FixedDyad(b.output, c, math.hypot(*coupler["P"]), math.atan2(*coupler["P"][::-1]))]
    if "guide" in case.points:
        q = pylinkage.Ground(*ground["Q"])
        parts = [q, *parts, pylinkage.FixedDyad(q, parts[-1], case.points["guide"]["end"][0], 0.0)]
    model, begin = pylinkage.simulation.Linkage(parts), [part.position for part in parts]
    model.set_input_velocity(b, 1.0)

    def call():
        model.set_coords(begin)
        found = getattr(model, method)(POSITIONS)
        found = np.array(list(found)) if method == "step" else found[0] if isinstance(found, tuple) else found
        return found[:, -len(case.wanted):]

    call()
    return call


def by_closed_form(case):
    """The expressions of `Scene.symbolic` for the angles, compiled by SymPy for arrays; the points by two lines of NumPy."""
    sympy.core.cache.clear_cache()
    form = dwell.Scene(case.free).symbolic()
    names = ["x_B", "y_B", "theta_coupler"] + ["theta_guide"] * ("guide" in case.points)
    compiled = sympy.lambdify(form.coordinate, [form.numeric(name) for name in names], "numpy", cse=True)
    own = [(int(body == "guide"), complex(*case.points[body][point])) for body, point in case.wanted]
    pin = complex(*case.points["ground"].get("Q", (0, 0)))

    def call(q):
        x, y, *angles = compiled(q)
        bases, turned = (x + 1j * y, pin), [np.exp(1j * angle) for angle in angles]
        at = np.stack([bases[k] + turned[k] * point for k, point in own], axis=-1)
        return at.view(float).reshape(len(q), -1, 2)

    return call


def positions(case):
    """Rows of (call, set-up, clock, relative error)."""
    q = np.linspace(0, math.tau, POSITIONS)

    def points(at):
        bodies = poses(case, at, mpmath)
        return [v for body, point in case.wanted for v in placed(*bodies[body], case.points[body][point])]

    truth = exactly(points, q).reshape(len(q), -1, 2)
    for method in ("step_fast", "step", "step_fast_with_kinematics"):
        call, setup = timed(lambda: by_pylinkage(case, method))
        yield f"pylinkage: `{method}`", setup, partial(least, call), deviation(call(), truth)
    call, setup = timed(lambda: by_closed_form(case))
    yield "Dwell: `Scene.symbolic`, compiled by SymPy", setup, partial(least, partial(call, q)), deviation(call(q), truth)
    whole, setup = assembled(case)
    names = [f"{body}.{point}" for body, point in case.wanted]

    path = partial(whole.paths, names, q)
    yield "Dwell: `paths(points, q)`", setup, partial(least, path), deviation(path(), truth)

    def one_by_one():
        return [[state.position(name) for name in names] for state in map(whole.at, q)]

    yield "Dwell: `at(q)`, one by one", setup, partial(least, one_by_one), deviation(one_by_one(), truth)
    rows = whole.kinematics()
    found = np.stack([np.stack([rows[f"{name}.{axis}"] for axis in "xy"], axis=-1) for name in names], axis=1)
    yield "Dwell: `kinematics()`", setup, partial(least, whole.kinematics), deviation(found, truth)


def motion(case):
    """Rows of (call, set-up, clock, error of the crank's angle at the end in rad)."""
    turned = TURNS * math.tau + BEYOND
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "scene.toml").write_text(case.free, encoding="utf-8")
        Path(folder, "case.toml").write_text(f"free_motion.period_s = {case.duration / peers.PERIODS!r}\n", encoding="utf-8")
        model = mechanism.read(Path(folder))
    setup = min(whole - run[0] for run, whole in (timed(lambda: peers.exudyn_(model, 7315)) for _ in range(9)))
    for steps in (7315, 73149):
        error = abs(peers.exudyn_(model, steps)[1] - turned)
        yield f"Exudyn: {steps} steps", setup, lambda steps=steps: peers.exudyn_(model, steps)[0], error
    own, setup = assembled(case)
    end_alone = {"sample_interval": case.duration}
    for says, options in (("`simulate(1e-9)`, the end alone", {"accuracy": 1e-9} | end_alone),
                          ("`simulate(1e-9)`, 1001 rows", {"accuracy": 1e-9}),
                          ("`simulate` by DOP853 at 1e-10, the end alone", {"method": "dop853", "tolerance": 1e-10} | end_alone)):
        end = own.simulate(**options)["phi"][-1]
        yield f"Dwell: {says}", setup, partial(least, partial(own.simulate, **options)), abs(float(end) - case.start - turned)


def equations(case):
    """Rows of (call, set-up, clock, error relative to the largest value)."""
    sympy.core.cache.clear_cache()
    (q, forms), derived = timed(lambda: reduced_inertia(case))
    exact = sympy.lambdify(q, forms, "mpmath", cse=True)
    turn = np.linspace(0, math.tau, POSITIONS)
    largest = np.max(np.abs(exactly(exact, turn)), axis=0)
    model, setup = timed(lambda: assembled(case)[0].reduced([]))
    for module, at, says in (("numpy", turn, f"{POSITIONS} positions"), ("math", 0.5, "one position")):
        truth = exactly(exact, np.atleast_1d(at))
        compiled, built = timed(lambda: sympy.lambdify(q, forms, module, cse=True))
        error = deviation(np.transpose(compiled(at)), truth, largest)
        yield f"SymPy: {says}", derived + built, partial(least, partial(compiled, at)), error
        options = {"threads": 1} if module == "numpy" else {}
        found = np.transpose([model(at).m, model(at).half_dm])
        yield f"Dwell: {says}", setup, partial(least, partial(model, at, **options)), deviation(found, truth, largest)


def number(value):
    """Two digits without an exponent."""
    return f"{float(f'{value:.1e}'):g}"


def length_of_time(seconds):
    """In the unit that fits."""
    unit, name = (1.0, "s") if seconds >= 0.995 else (1e-3, "ms") if seconds >= 0.995e-3 else (1e-6, "µs")
    return f"{number(seconds / unit)} {name}"


def table(title, task, base, cases):
    """A row for each call, with the ratio of its time to that of the row that `base` finds for it. All take turns, five times."""
    head = "".join(f" {case.name}: set-up | time | ratio | error |" for case in cases)
    cells = []
    for rows in (list(task(case)) for case in cases):
        times = np.min([[clock() for _, _, clock, _ in rows] for _ in range(5)], axis=0)
        ratios = [number(times[k] / times[base(k)]) for k in range(len(rows))]
        cells.append([f" {length_of_time(setup)} | {length_of_time(seconds)} | {ratio} | {error:.0e} |"
                      for (_, setup, _, error), seconds, ratio in zip(rows, times, ratios)])
    lines = [f"| {title} |{head}", "|---|" + "---|---|---|---|" * len(cases)]
    lines += [f"| {row[0]} |" + "".join(more).replace("0e+00", "0").replace("e-0", "e-") for row, more in zip(rows, zip(*cells))]
    return [*lines, ""]


def measure(out):
    cases, begin = [read("four-bar"), read("single-dwell")], os.getloadavg()[0]
    lines = table(f"{POSITIONS} positions", positions, lambda k: 4, cases)
    lines += table(f"free motion, {TURNS} revolutions and {BEYOND:g} rad", motion, lambda k: 2, cases)
    lines += table("m and ½m′", equations, lambda k: k | 1, cases)
    versions = [f"{name} {version(name)}" for name in ("pylinkage", "numba", "exudyn", "sympy", "numpy", "dwell")]
    load = "System load {:.1f} to {:.1f}".format(*sorted([begin, os.getloadavg()[0]]))
    lines.append(f"{load}; Python {sys.version.split()[0]}, {', '.join(versions)}.")
    out.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    wheel = max((HOME / "target" / "wheels").glob("dwell-*.whl"), key=lambda path: path.stat().st_mtime)
    with tempfile.TemporaryDirectory() as scratch:
        python, out = Path(scratch, "env", "bin", "python"), Path(scratch, "tables.md")
        venv.create(Path(scratch, "env"), with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES, *MORE, wheel], check=True)
        subprocess.run([python, "-W", "ignore", __file__, "--measure", out], cwd=scratch, check=True)
        tables = out.read_text(encoding="utf-8")
    print(tables)
    if "--write" in sys.argv:
        text = DOCUMENT.read_text(encoding="utf-8")
        DOCUMENT.write_text(re.sub(f"(?s){BEGIN}.*{END}", f"{BEGIN}\n{tables}{END}", text), encoding="utf-8")


if __name__ == "__main__":
    measure(Path(sys.argv[2])) if "--measure" in sys.argv else main()

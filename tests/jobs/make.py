"""Draws jobs of `dwell optimise`: what varies, what follows, the goal, the conditions, and a start that is good, torn or hopeless.

Limits of conditions are quantiles of what the sweep has at random designs within the bounds, or beyond all of them.
"""
import dataclasses
import math
import re

import mechanisms
import program as runs
from mechanisms import rounded

# How a job begins: where the scene assembles and conditions can hold; where it does not assemble but some designs do; where no design
# does; where no design satisfies a condition.
KINDS, WEIGHTS = ["fair", "torn", "hopeless", "infeasible"], [70, 15, 3, 12]


@dataclasses.dataclass
class Job:
    kind: str
    text: str
    files: dict = dataclasses.field(default_factory=dict)
    # By path or parameter: the bounds.
    vary: dict = dataclasses.field(default_factory=dict)
    # Of [sweep] and of the job, in their order.
    tied_by_sweep: list = dataclasses.field(default_factory=list)
    tied: list = dataclasses.field(default_factory=list)
    # Goals with weights; two of a front.
    goal: list = dataclasses.field(default_factory=list)
    is_front: bool = False
    # Expression, sign, limit.
    conditions: list = dataclasses.field(default_factory=list)
    # Of each choice: the header and the rows of its table.
    choices: list = dataclasses.field(default_factory=list)
    # Of [sweep]: the lines of its parameters and targets.
    parameters: str = ""
    targets: str = ""


def quoted(path):
    return f"`{path}`"


def numbers(rng, scene):
    """Paths of numbers with bounds about their values, and whether each is a length."""
    found = []
    for path in scene.points:
        name, point = path.split(".")
        values = scene.value(f"{name}.points.{point}")
        for k, value in enumerate(values):
            if abs(value) > 1e-6:
                found.append((f"{name}.points.{point}[{k}]", abs(value) * rng.uniform(0.1, 0.6), True))
    for name, body in scene.bodies.items():
        if "mass" in body and not scene.is_spatial:
            found.append((f"{name}.inertia", 0.8 * body.get("inertia", 0), False) if isinstance(body.get("inertia"), float) else None)
        if "mass" in body:
            found.append((f"{name}.mass", 0.8 * body["mass"], False))
        if isinstance(body.get("center"), list):
            size = max(map(abs, body["center"])) or max(abs(x) for p in body["points"].values() for x in p)
            found += [(f"{name}.center[{k}]", rng.uniform(0.5, 3) * size, False) for k in range(len(body["center"]))]
    for name, load in scene.data.get("loads", {}).items():
        for key in ("stiffness", "damping", "free-length", "magnitude"):
            if isinstance(load.get(key), (int, float)) and load[key] > 0:
                found.append((f"loads.{name}.{key}", 0.8 * load[key], False))
    return [one for one in found if one and one[1] > 0]


def wanted(rng, scene):
    """Names of results, by what they are of."""
    data = scene.data
    names = []
    for name in data["actuators"]:
        names += [f"{name}.actuator_force.{k}" for k in ("rms", "max_abs", "rms", "max_abs", "mean", "max", "work", "peak_power")]
    for name, joint in data["joints"].items():
        if set(joint) & {"revolute", "spherical", "universal"}:
            names += [f"{name}.x.{k}" for k in ("rms", "max_abs", "max")] + [f"{name}.y.{k}" for k in ("max_abs", "min", "stroke")]
            names += [f"{name}.magnitude.max", f"{name}.magnitude.rms"]
    names += [f"shaking.{k}" for k in ("force.rms", "force.max", "moment.rms", "moment.max_abs")] * 2
    for name, body in scene.bodies.items():
        point = rng.choice(list(body["points"]))
        names += [f"{name}.{point}.x.{k}" for k in ("stroke", "max", "mean")] + [f"{name}.{point}.y.min"]
        names += [f"{name}.angle.stroke"] if not scene.is_spatial else []
    if scene.curve or "guide" in data["joints"]:
        names += ["C.transmission_angle.min", "C.transmission_angle.max", "closure.determinant.min"] * 2
    return names + ["m.max", "m.min", "half_dm.max"]


def table(rng, scene):
    """A target for a point, an angle or both, and its results."""
    if scene.curve is None:
        body, point = rng.choice([(b, p) for b, at in scene.bodies.items() for p in at["points"]])
        places = [[rounded(rng.uniform(-0.2, 0.3), 3) for _ in range(3 if scene.is_spatial else 2)] for _ in range(rng.randint(3, 8))]
        header = ",".join(f"{body}.{point}.{axis}" for axis in "xyz"[: len(places[0])])
        return header, places, False, ["foot.distance"]
    kind, noise = rng.choice(["path", "timed", "function", "poses"]), rng.choice([0, 0.003, 0.02])
    rows = []
    for k in range(rng.randint(4, 12)):
        q = 0.3 + 0.5 * k
        place, coupler, rocker = scene.curve(q)
        place += complex(rng.gauss(0, noise), rng.gauss(0, noise))
        row = {"path": [place.real, place.imag], "timed": [q, place.real, place.imag], "function": [q, rocker + rng.gauss(0, 3 * noise)],
               "poses": [q, place.real, place.imag, coupler]}[kind]
        rows.append([rounded(value, 9) for value in row])
    header = {"path": "coupler.P.x,coupler.P.y", "timed": "phi,coupler.P.x,coupler.P.y", "function": "phi,rocker.angle",
              "poses": "phi,coupler.P.x,coupler.P.y,coupler.angle"}[kind]
    results = {"function": ["foot.angle"], "poses": ["foot.distance", "foot.angle"]}.get(kind, ["foot.distance"])
    return header, rows, kind != "path", results


def draw_design(rng, scene, job, is_torn):
    """What varies and what follows: at least one length where the start is torn."""
    all_numbers = numbers(rng, scene)
    lengths = [one for one in all_numbers if one[2]]
    chosen = rng.sample(all_numbers, min(len(all_numbers), rng.choice([1, 2, 2, 3, 3, 4, 6])))
    if is_torn and not any(one[2] for one in chosen):
        chosen.append(rng.choice(lengths))
    for path, span, _ in chosen:
        value, part = scene.value(path), rng.uniform(-0.1, 1.1) if rng.random() < 0.2 else rng.uniform(0.2, 0.8)
        low, high = value - part * 2 * span, value + (1 - part) * 2 * span
        is_sized = path.endswith((".mass", ".inertia")) or path.startswith("loads.")
        job.vary[path] = [rounded(max(low, 0.1 * value) if is_sized else low), rounded(high)]
    if len(job.vary) > 1 and rng.random() < 0.15:
        # A parameter in place of a number.
        path = rng.choice(list(job.vary))
        job.vary["p"] = [2 * bound for bound in job.vary.pop(path)]
        job.tied_by_sweep.append((path, "p / 2"))
        job.parameters = f"parameters = {{ p = {2 * scene.value(path)!r} }}\n"
    for path, _, is_length in chosen:
        body = path.split(".")[0]
        if is_length and path in job.vary and body in scene.bodies and f"{body}.mass" not in job.vary and rng.random() < 0.4:
            ratio = rounded(scene.bodies[body]["mass"] / abs(scene.value(path)))
            rng.choice([job.tied, job.tied_by_sweep]).append((f"{body}.mass", f"{ratio!r} * abs({quoted(path)})"))


def draw_goal(rng, scene, job):
    if rng.random() < 0.25:
        header, rows, is_placed, results = table(rng, scene)
        job.files["foot.csv"] = header + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows)
        first = header.split(",")[0]
        job.targets = "foot = { table = \"foot.csv\"" + (f", at = \"{first}\"" if is_placed else "") + " }"
        weights = [1.0, rounded(rng.uniform(0.01, 0.3))]
        ending = rng.choice(["rms", "rms", "max_abs", "mean"])
        job.goal = [(f"{name}.{ending}", weight) for name, weight in zip(results, weights)]
        return
    names = wanted(rng, scene)
    kind = rng.random()
    pick = lambda: rng.choice(names)
    if kind < 0.5:
        job.goal = [(pick(), 1.0)]
    elif kind < 0.65:
        job.goal = [(pick(), rounded(rng.uniform(0.1, 3))) for _ in range(rng.randint(2, 3))]
        job.goal = list(dict(job.goal).items())
    elif kind < 0.8:
        form = rng.choice(["{a}^2 + {b}^2", "sqrt({a}^2 + 0.1*{b}^2)", "{a} * 2 + abs({b})", "max({a}, {b})", "{a}^2 + {n}^2"])
        number = quoted(rng.choice(list(job.vary) or ["p"]))
        job.goal = [(form.format(a=quoted(pick()), b=quoted(pick()), n=number), 1.0)]
    elif kind < 0.9:
        job.is_front, job.goal = True, [(a, 1.0) for a in rng.sample(sorted(set(names)), 2)]
    else:
        job.goal = [(quoted(rng.choice([p for p in job.vary if p != "p"] or ["p"])) + f" + 1e-3*{quoted(pick())}", 1.0)]


def names_in(text, numbers):
    """The results in an expression."""
    found = re.findall(r"`([^`]+)`", text) or [text]
    return [name for name in found if name not in numbers]


def value_of(text, values):
    """The value of an expression, whose results and numbers have these values."""
    if text in values:
        return values[text]
    python = re.sub(r"`([^`]+)`", lambda m: f"({values[m[1]]!r})", text).replace("^", "**")
    return eval(python, {"sqrt": math.sqrt, "abs": abs, "max": max, "min": min, "pi": math.pi, **{k: v for k, v in values.items() if k.isidentifier()}})


def draw_conditions(rng, scene, job, sample):
    """Conditions with limits among, or beyond, what random designs have; `sample` computes results there."""
    count = rng.choice([0, 1, 1, 2, 3]) if job.kind != "infeasible" else rng.randint(1, 2)
    names = wanted(rng, scene)
    texts = [rng.choice(names) for _ in range(count)]
    masses = [path for path in job.vary if path.endswith(".mass")]
    if count and masses and rng.random() < 0.4:
        texts[0] = " + ".join(map(quoted, masses)) + rng.choice(["", f" + 0*{quoted(names[0])}"])
    rows = sample([name for text in texts for name in names_in(text, job.vary)])
    for k, text in enumerate(texts):
        values = sorted(value_of(text, row) for row in rows)
        sign, part = rng.choice(["<=", ">=", "<=", ">=", "="]), rng.uniform(0.25, 0.75)
        extent = values[-1] - values[0]
        if max(map(abs, values)) < 1e-9:
            continue  # rounding, as the work of a mechanism without loads
        if job.kind == "infeasible" and k == 0:
            off = 3 * extent + 0.5 * abs(values[0]) + 1e-3
            limit = values[0] - off if sign == "<=" else values[-1] + off
        else:
            limit = values[int(part * len(values))]
        job.conditions.append((text, sign, rounded(limit, 6)))
        if sign != "=" and rng.random() < 0.15 and job.kind != "infeasible":
            # A result with two limits.
            job.conditions.append((text, {"<=": ">=", ">=": "<="}[sign], rounded(values[0] - extent if sign == "<=" else values[-1] + extent, 6)))


def toml_key(path):
    return f'"{path}"'


def section(rng, job):
    """The text of [sweep] and of the job."""
    text = ""
    if job.parameters:
        text += "[sweep]  # its numbers have names\n" + job.parameters
    if job.tied_by_sweep:
        text += "[sweep.tied]\n" + "".join(f"{toml_key(path)} = \"{of}\"\n" for path, of in job.tied_by_sweep)
    if job.targets:
        text += f"[sweep.targets]\n{job.targets}\n"
    text += "\n[optimise.job]  # drawn at random\nvary = { " + ", ".join(f"{toml_key(p)} = {b!r}" for p, b in job.vary.items()) + " }\n"
    if job.tied:
        text += "tied = { " + ", ".join(f"{toml_key(path)} = \"{of}\"" for path, of in job.tied) + " }\n"
    if job.is_front:
        text += "front = [" + ", ".join(toml_key(name) for name, _ in job.goal) + "]\n"
    elif len(job.goal) == 1 and job.goal[0][1] == 1.0:
        text += f"minimise = {toml_key(job.goal[0][0])}\n"
    else:
        text += "minimise = { " + ", ".join(f"{toml_key(name)} = {weight!r}" for name, weight in job.goal) + " }\n"
    if job.conditions:
        text += "subject-to = [" + ", ".join(f"\"{of} {sign} {limit!r}\"" for of, sign, limit in job.conditions) + "]\n"
    if job.choices:
        text += "choose = { " + ", ".join(f"part{k} = \"part{k}.csv\"" for k in range(len(job.choices))) + " }\n"
    return text + f"starts = {rng.randint(2, 4)}\npool = {rng.choice([10, 20, 40])}\n"


def draw_choices(rng, scene, job):
    """Now and then parts from a table, of a number that does not vary."""
    used = set(job.vary) | {path for path, _ in job.tied + job.tied_by_sweep}
    free = [path for path, _, is_length in numbers(rng, scene) if not is_length and path not in used]
    if job.is_front or not free or rng.random() > 0.12:
        return
    path = rng.choice(free)
    rows = [(f"M{k}", rounded(scene.value(path) * rng.uniform(0.5, 2))) for k in range(rng.randint(2, 4))]
    job.choices.append((path, rows))
    job.files["part0.csv"] = f"part,{path}\n" + "".join(f"{name},{value!r}\n" for name, value in rows)


def draw(rng, program, folder):
    """A job whose results the sweep knows; its scene and tables are in the folder."""
    while True:
        scene = mechanisms.mechanism(rng)
        kind = rng.choices(KINDS, WEIGHTS)[0]
        if kind in ("torn", "hopeless") and not scene.points:
            continue
        job = Job(kind, scene.text)
        draw_design(rng, scene, job, kind in ("torn", "hopeless"))
        draw_goal(rng, scene, job)
        draw_choices(rng, scene, job)
        for name, text in job.files.items():
            (folder / name).write_text(text)

        def sample(results):
            goals = [name for text, _ in job.goal for name in names_in(text, job.vary)]
            head = section(rng, job).split("[optimise.job]")[0]
            (folder / "drawn.toml").write_text(scene.text + "\n" + head)
            vary = [f"{path}~uniform({low!r},{high!r})" for path, (low, high) in job.vary.items()]
            rows = runs.sweep(program, folder, "drawn.toml", goals + results, vary, job.tied, 24)
            rows = [row for row in rows if row is not None]
            if not rows:
                raise runs.Refused("no design has results")
            return rows

        try:
            draw_conditions(rng, scene, job, sample)
        except runs.Refused:
            continue
        text = scene.text
        if kind in ("torn", "hopeless"):
            length = next((path for path in job.vary if path.replace(".points", "").split("[")[0] in scene.points), None)
            if length is None:
                continue
            far = 8 * max(abs(bound) for bound in job.vary[length])
            text = scene.with_point(length, rounded(far))
            if kind == "hopeless":
                job.vary[length] = [rounded(0.9 * far), rounded(1.1 * far)]
        job.text = text + "\n" + section(rng, job)
        (folder / "machine.toml").write_text(job.text)
        return job

"""Mutated scenes: scenes of the cases with changed numbers, with keys dropped, renamed or repeated, with duplicated joints, and
with added loads, drives, laws, tables and events. Most scenes stay valid: numbers change by a few per cent, and loads are moderate.
The others imitate typing errors and attacks."""
import copy
import json
import math
import pathlib
import re
import tomllib

TOP = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ["validation/*/scene.toml", "tests/mutations/scenes/*.toml", "crates/cli/tests/command/*.toml"]


def sources():
    """The paths of the scenes to mutate, in an order that is the same on every machine."""
    paths = [path for pattern in FOLDERS for path in TOP.glob(pattern)]
    return [path.read_text(encoding="utf-8") for path in sorted(paths)]


def mutated(rng, source, command):
    """The text of a mutated scene for a command."""
    scene = tomllib.loads(source)
    if rng.random() < 0.9:
        fit(rng, scene, command)
    gentle = rng.random() < 0.6
    # A scene that requests a period may have no loads.
    changes = [nudge] if command == "calibrate" else GENTLE
    for _ in range(rng.choice([0, 1, 1, 2, 3])):
        rng.choice(changes)(rng, scene)
    if not gentle:
        for _ in range(rng.choice([1, 1, 2, 4])):
            rng.choice(HARSH)(rng, scene)
    text = document(scene)
    if not gentle and rng.random() < 0.25:
        text = torn(rng, text)
    return text


def fit(rng, scene, command):
    """Adds the sections that a command needs."""
    if command in ("simulate", "calibrate", "sweep", "work-precision") and not isinstance(scene.get("motion"), dict):
        add_motion(rng, scene)
    if command == "calibrate":
        # Calibration needs a period; only a motion without loads always has one.
        scene.pop("loads", None)
        scene.pop("drives", None)
        scene.pop("friction", None)
        scene["motion"] = {"initial-velocity": 1.0, "periods": 1}
    if command == "cycle" and not scene.get("drives"):
        add_drive(rng, scene)


# ---------------------------------------------------------------------------------------------- gentle changes

def names(scene, section):
    of = scene.get(section)
    return [name for name in of if isinstance(of[name], dict)] if isinstance(of, dict) else []


def points(scene):
    """Every body.point of the scene."""
    bodies = scene.get("bodies")
    if not isinstance(bodies, dict):
        return []
    return [
        f"{body}.{point}"
        for body, of in bodies.items() if isinstance(of, dict)
        for point in (of.get("points") if isinstance(of.get("points"), dict) else {})
    ]


def leaves(node, path=()):
    """Every number of a scene as (its container, its key, the keys above)."""
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, value in items:
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            yield node, key, path + (key,)
        else:
            yield from leaves(value, path + (key,))


def nudge(rng, scene):
    """Changes a mass, a load or a speed by some per cent. Points are kept, because most lengths must fit each other."""
    free = [leaf for leaf in leaves(scene) if not {"points", "joints", "assembly", "center"} & set(leaf[2])]
    if free:
        node, key, _ = rng.choice(free)
        value = node[key] * rng.uniform(0.8, 1.25)
        node[key] = max(2, round(value)) if isinstance(node[key], int) and key == "points" else value


def magnitude(rng, scene):
    """A number, a table, or an expression of time, coordinates and speeds."""
    size = rng.choice([0.01, 1.0, 20.0])
    kind = rng.randrange(4)
    if kind == 0:
        return round(rng.uniform(-size, size), 4)
    if kind == 1:
        end = rng.choice([1, 10, 100])
        at = sorted(rng.uniform(0, end) for _ in range(rng.randrange(1, 6)))
        table = [[round(t, 6), round(rng.uniform(-size, size), 4)] for t in [0, *at, 1000]]
        of = {"table": table}
        if rng.random() < 0.7:
            of["interpolation"] = rng.choice(["linear", "monotone", "spline", "step"])
        return of
    return expression(rng, scene, size)


def expression(rng, scene, size=1.0):
    """An expression like those of users: pulses, switches, stops and friction written as expressions."""
    actuators = names(scene, "actuators") or ["phi"]
    quote = lambda name: name if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name) else f"`{name}`"
    q = rng.choice(actuators + names(scene, "coordinates"))
    v = quote(q + ".velocity") if not re.fullmatch(r"\w+", q, re.A) else f"{q}.velocity"
    q = quote(q)
    at, width = rng.choice([0.05, 0.3, 1.0, 7.0]) * rng.random(), 10 ** rng.uniform(-6, 0)
    size = f"{rng.uniform(-size, size):.4g}"
    return rng.choice([
        f"if(t > {at:.4g}, {size}, 0)",
        f"if(abs(t - {at:.4g}) < {width:.3g}, {size}, 0)",
        f"{size}*exp(-((t - {at:.4g})/{width:.3g})^2)",
        f"{size}*max(0, 1 - abs(t - {at:.4g})/{width:.3g})",
        f"{size}*sin({10 ** rng.uniform(-1, 3):.3g}*t)",
        f"{size}*sign(sin({10 ** rng.uniform(-1, 2):.3g}*t))",
        f"if(sin({10 ** rng.uniform(0, 2):.3g}*t) > 0.5, {size}, 0)",
        f"if({q} > {at:.4g}, {size}, 0)",
        f"if({v} > {at:.4g}, {size}, 0)",
        f"-abs({size})*sign({v})",
        f"-abs({size})*{v}",
        f"-abs({size})*tanh({v}/0.01)",
        f"clamp({size}*({at:.4g} - {q}), -1, 1)",
        f"{size}*(1 + cos({q}))",
        f"{size}*floor(3*t)",
        f"{size}*step(t - {at:.4g})*cos({q})",
    ])


def add_load(rng, scene):
    bodies, of = [b for b in names(scene, "bodies")], points(scene)
    if len(bodies) < 2 or len(of) < 2:
        return
    two = rng.sample(bodies, 2)
    size = magnitude(rng, scene)
    moving = [point for point in of if not point.startswith("ground.")] or of
    loads = scene.get("loads") if isinstance(scene.get("loads"), dict) else {}
    has_weight = any("gravity" in load for load in loads.values() if isinstance(load, dict))
    load = rng.choice([
        {"torque": two, "magnitude": 0} if has_weight else {"gravity": [0, -9.81]},
        {"force": rng.choice(moving), "direction": [1, 0], "magnitude": size},
        {"force": rng.choice(moving), "direction": [0.6, -0.8], "frame": "body", "magnitude": size},
        {"torque": rng.choice([b for b in bodies if b != "ground"] or bodies), "magnitude": size},
        {"torque": two, "magnitude": size},
        {"spring": rng.sample(of, 2), "stiffness": 10 ** rng.uniform(-1, 3), "free-length": 10 ** rng.uniform(-2, 0)},
        {"torsion-spring": two, "stiffness": 10 ** rng.uniform(-2, 2), "free-angle": 0.0},
        {"damper": rng.sample(of, 2), "damping": 10 ** rng.uniform(-2, 2)},
        {"rotational-damper": two, "damping": 10 ** rng.uniform(-3, 1)},
        {"point-to-point-force": rng.sample(of, 2), "magnitude": size},
    ])
    add(scene, "loads", rng, load)


def add(scene, section, rng, value):
    table = scene.setdefault(section, {})
    if isinstance(table, dict):
        table[f"added{rng.randrange(100)}"] = value


def add_drive(rng, scene):
    actuators = names(scene, "actuators")
    motion = scene.get("motion")
    if not actuators or not isinstance(motion, dict):
        return
    q = rng.choice(actuators)
    drive = rng.choice([
        {"applied-force": q, "magnitude": magnitude(rng, scene)},
        {"motor": q, "voltage": rng.choice([12, magnitude(rng, scene)]), "torque-constant": 0.05, "resistance": 1.2,
         "inductance": rng.choice([0, 0.002]), "gear-ratio": 10},
        {"motor": q, "stall-torque": 0.5, "no-load-speed": 300, "gear-ratio": rng.choice([1, 20])},
        {"speed-controller": q, "speed": rng.choice([5, magnitude(rng, scene)]), "proportional": 10 ** rng.uniform(-1, 2),
         "integral": rng.choice([0, 5.0]), "limit": 10 ** rng.uniform(-1, 3)},
    ])
    add(scene, "drives", rng, drive)


def add_motion(rng, scene):
    actuators = names(scene, "actuators")
    if not actuators:
        return
    # About as long as that of the source: it knows how fast the mechanism is.
    former = scene.get("motion")
    former = former.get("duration") if isinstance(former, dict) else None
    longest = 3 * former if isinstance(former, float) and 0 < former < 3 else 5
    motion = {"duration": round(longest * 10 ** rng.uniform(-2, 0), 6)}
    motion["initial-velocity"] = {q: rng.choice([0, 0, 1, -3, 10]) for q in actuators}
    if len(actuators) == 1 and rng.random() < 0.2:
        del motion["duration"]
        motion["periods"] = rng.choice([1, 2, 0.5])
    if len(actuators) > 1 and rng.random() < 0.4:
        q = actuators[0]
        del motion["initial-velocity"][q]
        motion["prescribed"] = {q: law(rng)}
    scene["motion"] = motion


def law(rng):
    at = round(10 ** rng.uniform(-2, 0), 3)
    return rng.choice([
        {"speed": round(rng.uniform(-3, 3), 3)},
        {"sinusoid": {"amplitude": 0.1, "period": at}},
        {"polynomial345": {"rise": 0.2, "duration": at, "delay": round(0.1 * at, 4)}},
        {"trapezoidal": {"rise": 0.2, "duration": at, "ramp": round(0.2 * at, 4)}},
        {"cycloidal": {"rise": -0.1, "duration": at}},
    ])


def add_prescribed(rng, scene):
    actuators = names(scene, "actuators")
    if actuators:
        scene["prescribed"] = {"duration": round(10 ** rng.uniform(-1, 1), 3), **{q: law(rng) for q in actuators}}


def add_events(rng, scene):
    motion, actuators = scene.get("motion"), names(scene, "actuators")
    if not isinstance(motion, dict) or not actuators:
        return
    q = rng.choice(actuators)
    event = rng.choice([
        {"reaches": q, "value": round(rng.uniform(-3, 3), 3)}, {"reverses": q}, {"revolution": q},
    ])
    if rng.random() < 0.4:
        event["stop"] = True
    motion.setdefault("events", {})
    if isinstance(motion["events"], dict):
        motion["events"][f"event{rng.randrange(9)}"] = event


def add_friction(rng, scene):
    joints = [j for j in names(scene, "joints") if "revolute" in scene["joints"][j] or "prismatic" in scene["joints"][j]]
    if joints:
        joint = rng.choice(joints)
        of = {"viscous": 10 ** rng.uniform(-4, -1)}
        if rng.random() < 0.5:
            of |= {"coefficient": 0.05, "regularization-speed": 0.5}
            if "revolute" in scene["joints"][joint]:
                of["radius"] = 0.01
        scene.setdefault("friction", {})
        if isinstance(scene["friction"], dict):
            scene["friction"][joint] = of


def change_requests(rng, scene):
    scene["requests"] = rng.choice([{}, {"reactions": []}, {"paths": points(scene)[:2]}, {"variables": names(scene, "bodies")[:1]}])


GENTLE = [nudge, nudge, nudge, add_load, add_load, add_load, add_drive, add_drive, add_motion, add_motion, add_prescribed, add_events,
          add_friction, change_requests]


# ----------------------------------------------------------------------------------------------- harsh changes

EXTREMES = [0, -0.0, 1, -1, 1e-300, 1e-30, 1e-12, 1e-6, 1e6, 1e12, 1e30, 1e60, 1e300, math.inf, -math.inf, math.nan, 2**62]


def break_number(rng, scene):
    found = list(leaves(scene))
    if found:
        node, key, _ = rng.choice(found)
        value = node[key]
        node[key] = rng.choice([
            -value, 0, value * 10 ** rng.uniform(-12, 12), value * 10.0 ** rng.choice([-3, -1, 1, 3]), rng.choice(EXTREMES), value + 1,
            value * (1 + 1e-9), value / 2,
        ])


def tables(node):
    """Every table that is not empty, including the scene itself."""
    if isinstance(node, dict):
        if node:
            yield node
        for value in node.values():
            yield from tables(value)
    elif isinstance(node, list):
        for value in node:
            yield from tables(value)


def drop_key(rng, scene):
    table = rng.choice(list(tables(scene)) or [{"": 0}])
    del table[rng.choice(list(table))]


def rename_key(rng, scene):
    table = rng.choice(list(tables(scene)) or [{"": 0}])
    key = rng.choice(list(table))
    table[rng.choice([key + "s", key.upper(), key[:-1] or "x", "ground", "t", "é", "a.b", " ", "", "magnitude"])] = table.pop(key)


def swap_value(rng, scene):
    table = rng.choice(list(tables(scene)) or [{"": 0}])
    key = rng.choice(list(table))
    junk = ["", "ground", "t", [], {}, [1], [[0, 1]], [[0, 0], [0, 1]], [[1, 0], [0, 1]], True, "1/0", "0/0", "sqrt(-1)", "1e308*1e308",
            "((((((((((t))))))))))", "phi phi", "if(", expression(rng, scene), "exp(1000*t)", "1/t", "ln(t)", "tan(t)", "t^0.5", "9" * 400]
    table[key] = rng.choice(junk)


def double_joint(rng, scene):
    """Copies a joint under another name, or connects it to other bodies."""
    joints = names(scene, "joints")
    if joints:
        again = copy.deepcopy(scene["joints"][rng.choice(joints)])
        of = points(scene)
        if rng.random() < 0.4 and len(of) > 1:
            again[next(iter(again), "revolute")] = rng.sample(of, 2)
        scene["joints"][f"again{rng.randrange(9)}"] = again


def swap_references(rng, scene):
    """Exchanges two names of bodies or points."""
    lists = [t[k] for t in tables(scene) for k in t if isinstance(t[k], list) and all(isinstance(v, str) for v in t[k]) and t[k]]
    if lists:
        rng.choice(lists)[0] = rng.choice((points(scene) or ["ground.A"]) + (names(scene, "bodies") or ["ground"]))


def swap_units(rng, scene):
    scene["units"] = {
        "length": rng.choice(["m", "mm", "km", "in", "parsec"]), "inertia": rng.choice(["kg m2", "kg mm2", "t km2", "kg"]),
        "angle": rng.choice(["deg", "rad"]),
    }


HARSH = [break_number, break_number, break_number, break_number, drop_key, rename_key, swap_value, swap_value, double_joint, swap_references,
         swap_units]


def torn(rng, text):
    """The text of a scene with a line removed, repeated or cut, or with a changed letter."""
    lines = text.splitlines()
    k = rng.randrange(len(lines)) if lines else 0
    change = rng.randrange(5)
    if not lines:
        return text
    if change == 0:
        del lines[k]
    elif change == 1:
        lines.insert(k, lines[k])
    elif change == 2:
        lines = lines[:k] + [lines[k][: rng.randrange(len(lines[k]) + 1)]]
    elif change == 3 and lines[k]:
        at = rng.randrange(len(lines[k]))
        lines[k] = lines[k][:at] + rng.choice('"[]{}=,.#\\é\x00 0-e') + lines[k][at + 1:]
    else:
        rng.shuffle(lines)
    return "\n".join(lines) + "\n"


# ------------------------------------------------------------------------------------------------ TOML as text

def document(scene):
    """A scene as TOML: a section for each table at the top level, with inline tables below."""
    head = [f"{key(k)} = {value(v)}" for k, v in scene.items() if not isinstance(v, dict)]
    for name, table in scene.items():
        if isinstance(table, dict):
            head += ["", f"[{key(name)}]", *(f"{key(k)} = {value(v)}" for k, v in table.items())]
    return "\n".join(head) + "\n"


def key(name):
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name, ensure_ascii=False)


def value(of):
    if isinstance(of, bool):
        return "true" if of else "false"
    if isinstance(of, float):
        return repr(of)
    if isinstance(of, int):
        return str(of)
    if isinstance(of, str):
        return json.dumps(of, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(of, list):
        return "[" + ", ".join(map(value, of)) + "]"
    return "{ " + ", ".join(f"{key(k)} = {value(v)}" for k, v in of.items()) + " }" if of else "{}"

"""Other places that repeat the model: `check`, `calibrate`, and the table of `reduce --table-accuracy`."""

import numpy as np

import poses
from files import result
from judge import largest
from motion import Motion, Unplaced
from reduced import taken
from sweeps import along_itself, with_numbers


# The output of `check`.


def judge_contents(judge, scene, summary, others):
    """Judges masses, inertias and counts, and the centre of mass and the angles at assembly."""
    moving = [body for body in scene.bodies if not body.is_ground]
    mass = sum(body.mass for body in moving)
    stated = {"moving_bodies": len(moving), "joints": len(scene.joints), "degrees_of_freedom": len(scene.actuators), "mass": mass}
    stated |= {f"mass.{body.name}": body.mass for body in moving}
    if scene.is_plane:
        stated |= {f"inertia.{body.name}": body.inertia[2, 2] for body in moving if not body.varying}
    axes = "xyz"
    pairs = [(i, j) for i in range(3) for j in range(i, 3)]
    stated |= {f"inertia.{b.name}.{axes[i]}{axes[j]}": b.inertia[i, j] for b in moving for i, j in pairs if not scene.is_plane}
    stated |= {f"start.{c.name}": scene.start_of(c) for c in scene.actuators if scene.start_of(c) is not None}
    stated |= {"prescribed.duration": scene.keys.get("prescribed", {}).get("duration"), "free_motion.duration": scene.keys.get("motion", {}).get("duration"),
               "free_motion.periods": scene.keys.get("motion", {}).get("periods")}
    for c in (c for c in scene.actuators if c.name not in scene.laws("motion")):
        q, v = scene.initial("initial-coordinate", c), scene.initial("initial-velocity", c)
        stated |= {f"free_motion.{c.name}": scene.start_of(c) if q is None else q, f"free_motion.{c.name}.velocity": v or 0.0}
    stated = {name: value for name, value in stated.items() if value is not None}
    for stop in scene.stops:
        keys = ("min", "max", *(("stiffness", "damping") if stop["stiffness"] is not None else ("restitution",)))
        stated |= {f"stop.{stop['name']}.{key}": stop[key] for key in keys if key in stop}
    for name, value in stated.items():
        written = result(summary, name)
        if written is not None:
            judge.compare("contents", written - value, abs(value) or 1.0, "SI", name)
    motion = assembled(scene, others)
    if motion is None:
        judge.skip("centre of mass and angles", "no file has a row at the assembly")
        return
    if mass > 0.0:
        center = sum(body.mass * motion.center(k).value[0] for k, body in enumerate(scene.bodies)) / mass
        for axis, value in zip("xyz", center):
            written = result(summary, f"mass.center.{axis}")
            if written is not None:
                judge.compare("contents", written - value, scene.size, "m", f"mass.center.{axis}")
    for body, frame in zip(scene.bodies, motion.frames):
        written = result(summary, f"start.{body.name}.angle")
        if written is not None and frame.angle is not None:
            turn = np.mod(written - frame.angle[0] + np.pi, 2.0 * np.pi) - np.pi
            judge.compare("contents", turn, 2.0 * np.pi, "rad", f"start.{body.name}.angle")


def assembled(scene, others):
    """The first row of a file in which all actuators have their values at assembly; None if there is none."""
    starts = {c.name: scene.start_of(c) for c in scene.actuators}
    for rows in others:
        if rows is None or not all(name in rows and start is not None for name, start in starts.items()):
            continue
        near = np.all([np.abs(rows.get(name) - start) <= 1e-12 * (1.0 + abs(start)) for name, start in starts.items()], axis=0)
        if near.any():
            try:
                return Motion(scene, taken(rows, np.nonzero(near)[0][:1]))
            except Unplaced:
                continue
    return None


def judge_range(judge, summary, rows, name):
    """Judges the range. Between two limit positions, the rows of `reduce` leave out a thousandth of the range at each."""
    said = " ".join(summary.get("printed") or [])
    low, high = result(summary, "range.lower"), result(summary, "range.upper")
    if None in (low, high) or not ("limit positions at both ends" in said or said.count("limit position of ") >= 2):
        return
    span, q = high - low, rows.get(name)
    for at, wanted in ((q[0], low + 1e-3 * span), (q[-1], high - 1e-3 * span)):
        judge.compare("range", at - wanted, span, "SI", f"an end of the rows at {at:.6g}")


# Calibration.


def judge_calibration(judge, scene, text, summary, moving):
    """Judges the period with the calibrated number: in a free rotation without loads, q̇ √m is constant."""
    parameter = scene.keys.get("calibration", {}).get("parameter", "")
    value, period = result(summary, parameter), result(summary, "required_period")
    coordinate = scene.actuators[0]
    speed, start = scene.initial("initial-velocity", coordinate), scene.start_of(coordinate)
    motion = next((m for m in (along_itself(scene, rows) for rows in moving) if m), None)
    if None in (value, period, motion, speed, start) or scene.loads or scene.frictions or scene.drives or not parameter.endswith((".mass", ".inertia")):
        judge.skip("the period of the calibrated scene", "loads, another parameter, or no file of a whole revolution")
        return
    unit = scene.mass if parameter.endswith(".mass") else scene.inertia
    motion.scene = with_numbers(text, {parameter: value / unit})
    q = motion.measure(coordinate.measure).value
    root = np.sqrt(2.0 * poses.kinetic(motion)[0])
    here = np.nonzero(np.abs(np.mod(q - start + np.pi, 2.0 * np.pi) - np.pi) < 1e-12)[0]
    if abs(abs(q[-1] - q[0]) - 2.0 * np.pi) > 1e-9 or not here.size:
        judge.skip("the period of the calibrated scene", "no file of a whole revolution with a row at the start")
        return
    # The trapezoidal rule over a whole revolution is exact to rounding.
    integral = (0.5 * np.diff(q) * (root[1:] + root[:-1])).sum()
    judge.compare("calibration", integral / (root[here[0]] * abs(speed)) - period, period, "s", f"period with the calibrated {parameter}")


# Tables.


class ModelTable:
    """A table of the reduced model: cells of polynomials, by the format of docs/table-format.md."""

    def __init__(self, text):
        self.checked = text[: text.rindex("check ")].encode()
        self.reactions, self.loads, cells = [], [], {"m": [], "ab": [], "wc": []}
        for line in text.splitlines():
            key, _, rest = line.partition(" ")
            if key in cells:
                cells[key].append([float(x) for x in rest.split()])
            elif key == "reaction":
                self.reactions.append(rest)
            elif key == "load":
                self.loads.append(rest)
            elif key == "extent":
                self.start, self.length = (float(x) for x in rest.split())
            elif key == "turns":
                self.turns = float(rest)
            elif key in ("scales", "errors"):
                setattr(self, key, np.array([float(x) for x in rest.split()]))
            elif key == "check":
                self.check = int(rest, 16)
        self.cells = {key: np.array(rows) for key, rows in cells.items() if rows}

    def names(self, kind):
        """Columns in the order of a kind of cells, as `reduce` names them."""
        if kind == "ab":
            return [f"{r}.a" for r in self.reactions] + [f"{r}.b" for r in self.reactions]
        return [f"{load}.w" for load in self.loads] + [f"{r}.c.{load}" for load in self.loads for r in self.reactions]

    def columns(self, q):
        """All coefficients at places, by name."""
        if self.turns:
            q = self.start + np.mod(q - self.start, self.length)
        found = {}
        for kind, rows in self.cells.items():
            n = len(rows)
            width = self.length / n
            cell = np.clip(((q - self.start) / width).astype(int), 0, n - 1)
            x = 2.0 * (q - self.start) / width - 2.0 * cell - 1.0
            if kind == "m":
                middle, g = rows[cell, 0], rows[cell, 1:]
                powers = x[:, None] ** np.arange(8)
                found["half_dm"] = (g * powers).sum(1)
                found["m"] = middle + width * (g * powers * x[:, None] / np.arange(1, 9)).sum(1)
            else:
                names = self.names(kind)
                blocks = rows[cell].reshape(len(q), 8, len(names))
                values = (blocks * (x[:, None] ** np.arange(7, -1, -1))[:, :, None]).sum(1)
                found |= dict(zip(names, values.T))
        return found

    def fnv(self):
        """FNV-1a of 64 bits of all bytes before the checksum."""
        value = 0xCBF29CE484222325
        for byte in self.checked:
            value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
        return value


def judge_table(judge, text, rows, name):
    """Compares every row of `reduce` with the table, within the errors that the table states."""
    table = ModelTable(text)
    judge.require("table", table.fnv() == table.check, "the checksum of the table is another")
    order = ["m", "half_dm", *table.names("ab"), *table.names("wc")]
    bounds = dict(zip(order, table.scales * table.errors))
    scales = dict(zip(order, table.scales))
    q = rows.get(name)
    inside = (q >= table.start) & (q <= table.start + table.length) if not table.turns else np.ones_like(q, bool)
    for column, values in table.columns(q).items():
        if column in rows and column in bounds:
            excess = np.maximum(np.abs(values - rows.get(column)) - bounds[column], 0.0)
            judge.compare("table", np.where(inside, excess, 0.0), scales[column] or largest(rows.get(column)) or 1.0, "SI", column)
        elif column not in rows and np.any(values):
            judge.skip(f"column {column} of the table", "`reduce` has no such column")

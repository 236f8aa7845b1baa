"""Positions and their rates: joints, points, coordinates and laws in every row, and the changes between rows."""

import numpy as np

from jets import Jet, jet, without_turns
from joints import residuals
from judge import largest


RATES = ("", " velocity", " acceleration")


def closure(judge, motion):
    """Compares points, joints, coordinates and travels of every row with the scene."""
    scene, rows = motion.scene, motion.rows
    size, speed, rate = motion.largest
    scales = (1.0, speed, rate)

    def add(what, open_jet, is_angle, turns=1.0, is_rate=False):
        scale = turns if is_angle else size
        for k, order in enumerate(open_jet.orders if motion.has_rates else open_jet.orders[:1]):
            if not (is_rate and k == 0):
                unit = ("rad" if is_angle else "m") + ("", "/s", "/s2")[k]
                judge.compare("closure", order, scale * scales[k], unit, what + RATES[k])

    for k, body in enumerate(scene.bodies):
        for name, at in body.points.items():
            written = None if body.is_ground else motion.written_point(body.name, name)
            if written is not None:
                difference = written - motion.frames[k].origin - motion.direction(k, at)
                for axis in range(2 if scene.is_plane else 3):
                    add(f"{body.name}.{name}", difference[axis], False)
    angles = [frame.angle for frame in motion.frames if frame.angle is not None]
    turns = max(1.0, largest(*angles))  # angles of many revolutions are rounded as such
    for joint in scene.joints:
        for residual in residuals(joint, motion):
            add(f"joint {joint.name}", residual.jet, residual.is_angle, turns, residual.is_rate)
    for coordinate in scene.coordinates:
        written = column_jet(rows, coordinate.name)
        if written is None:
            continue
        difference = written - motion.measure(coordinate.measure)
        if coordinate.measure.is_angle:
            difference = without_turns(difference)
            if not coordinate.measure.normals:  # any direction is the zero of such an angle
                difference = without_turns(difference - difference.value[0])
        add(f"coordinate {coordinate.name}", difference, coordinate.measure.is_angle, max(1.0, largest(written.value)))
    for joint in scene.joints:
        if joint.kind in ("prismatic", "slot", "cylindrical", "helical", "point-on-line") and f"{joint.name}.travel" in rows:
            written = column_jet(rows, f"{joint.name}.travel")
            add(f"{joint.name}.travel", written - motion.measure(scene.measure_of(joint, "travel")), False)


def column_jet(rows, name):
    """A column with its rates; None without the column. Missing rates are zero."""
    value = rows.get(name)
    if value is None:
        return None
    return Jet(value, *(rows.get(name + end) for end in (".velocity", ".acceleration")))


def laws(judge, motion, section):
    """Compares prescribed coordinates in every row with their laws."""
    scene, time = motion.scene, motion.rows.get("t")
    if time is None:
        return
    prescribed = scene.laws(section)
    values = {}
    for name, (law, knows_start) in prescribed.items():
        written = column_jet(motion.rows, name)
        if written is None:
            continue
        expected = law.at(Jet(time, np.ones_like(time), 0.0 * time), lambda name: Jet(time, np.ones_like(time)) if name == "t" else None)
        expected = Jet(*(np.broadcast_to(order, time.shape) for order in jet(expected).orders))
        values[name] = written, expected, law, knows_start
    scales = [largest(*(e.orders[k] for _, e, _, _ in values.values())) for k in range(3)]
    for name, (written, expected, law, knows_start) in values.items():
        at_corner = np.any(np.abs(time[:, None] - np.array([*law.corners, -np.inf])) <= 1e-12 * (1.0 + np.abs(time[:, None])), axis=1)
        difference = written - expected
        if not knows_start:  # the length at assembly, which the scene does not give
            difference = difference - difference.value[0]
        for k, order in enumerate(difference.orders if motion.has_rates else difference.orders[:1]):
            inside = ~at_corner if k == 2 else np.ones_like(at_corner)  # a second derivative has two values at a corner
            judge.compare("laws", np.where(inside, order, 0.0), scales[k] or 1.0, "SI", f"{name}{RATES[k]}")


def switch_times(motion):
    """The times of rows between which something may switch; empty for a file without a time."""
    time = motion.rows.get("t")
    return [] if time is None else switch_places(motion, time)


def switch_places(motion, abscissa, of_forces=True):
    """Places of the rows between which a coupling may switch; of forces also a load, a drive or the sign of a friction."""
    time, scene = motion.time(), motion.scene
    names, quantities = motion.names(time), []
    for joint in scene.joints:
        if joint.kind == "coupling":
            variable = motion.measure(joint.measures[1]).value
            quantities += [variable - corner for corner in joint.law.corners]
    sources = [*scene.loads, *scene.drives] if of_forces else []
    for magnitude in [of.magnitude for of in sources if of.magnitude]:
        quantities += [np.broadcast_to(switch(names).value, time.shape) for switch in magnitude.switches]
    for drive in scene.drives if of_forces else []:
        if "limit" in drive.numbers:
            state, force = rows_of(motion, f"{drive.name}.integral"), drive.numbers["integral"]
            error = drive.magnitude(names).value - motion.measure(scene.coordinate(drive.coordinate).measure).first
            wanted = force * state + drive.numbers["proportional"] * error
            quantities += [wanted - drive.numbers["limit"], wanted + drive.numbers["limit"]]
    for friction in scene.frictions if of_forces and motion.has_rates else []:
        joint = scene.joints[friction.joint]
        kinds = {"revolute": ("angle",), "cylindrical": ("angle", "travel")}.get(joint.kind, ("travel",))
        quantities += [motion.measure(scene.measure_of(joint, kind)).first for kind in kinds]
        normal, moment = (rows_of(motion, f"{joint.name}.{end}") for end in ("normal", "moment"))
        lever = moment / (friction.distance or np.inf)  # each end of a guide presses on one side or the other
        quantities += [0.5 * normal + lever, 0.5 * normal - lever]
    found = set()
    for values in quantities:
        rows = np.nonzero((values[:-1] * values[1:] <= 0.0) & ((values[:-1] != 0.0) | (values[1:] != 0.0)))[0]
        found |= {*abscissa[rows], *abscissa[rows + 1]}
    return sorted(found)


VALUES = ((("", ".velocity", ".acceleration"),), ((".angle", ".angular_velocity", ".angular_acceleration"),),
          ((".x", ".vx", ".ax"), (".y", ".vy", ".ay"), (".z", ".vz", ".az"),
           (".travel", ".travel.velocity", ".travel.acceleration")))


def between_rows(judge, rows, corners=()):
    """The change of a column from row to row is the integral of its rate."""
    time = rows.get("t")
    if time is None or len(time) < 5:
        return
    inside = even_rows(time, corners)
    duration = time[-1] - time[0]
    for kinds in VALUES:
        found = []
        for value, rate, second in kinds:
            for stem, values in rows.ending(value):
                orders = values, rows.get(stem + rate), rows.get(stem + second)
                if not any(order is None for order in orders):
                    found.append((stem + value, orders))
        largest_of = [largest(*(orders[k] for _, orders in found)) for k in range(3)]
        scales = [max(largest_of[0] / duration, largest_of[1])]
        scales.append(max(scales[0] / duration, largest_of[2]))
        for name, (y, v, a) in found:
            for k, (rule, order) in enumerate(((hermite(time, y, v, a), 7), (simpson(time, v, a), 5))):
                excess = beyond_estimate(*rule, order) / np.diff(time)[1:-2]
                judge.compare("rates", np.where(inside, excess, 0.0), scales[k] or 1.0, "SI", f"{name}, derivative {k + 1}")


def even_rows(time, corners=()):
    """For the rows from the third to the last but two: whether they are equally spaced, and away from corners."""
    h = np.diff(time)
    windows = np.stack([h[k : len(h) - 3 + k] for k in range(4)])
    even = np.all(np.abs(windows - windows[1]) < 1e-6 * np.abs(windows[1]), axis=0)
    low, high = time[:-4], time[4:]
    for corner in corners:
        even &= ~((low <= corner + 1e-9 * np.abs(h[1])) & (corner - 1e-9 * np.abs(h[1]) <= high))
    return even


def near(values, k):
    """Values k rows further, for the rows from the third to the last but two."""
    return values[2 + k : len(values) - 2 + k]


def hermite(time, y, v, a):
    """The residual of y(+k) − y(−k) by the rule of sixth order with first and second derivatives, for k = 1 and 2."""
    h = near(np.append(np.diff(time), 0.0), 0)
    return [near(y, k) - near(y, -k) - k * h / 15.0 * (7.0 * (near(v, -k) + near(v, k)) + 16.0 * near(v, 0))
            - (k * h) ** 2 / 15.0 * (near(a, -k) - near(a, k)) for k in (1, 2)]


def simpson(time, y, rate):
    """The residual of y(+k) − y(−k) by Simpson's rule, for k = 1 and 2."""
    h = near(np.append(np.diff(time), 0.0), 0)
    return [near(y, k) - near(y, -k) - k * h / 3.0 * (near(rate, -k) + 4.0 * near(rate, 0) + near(rate, k)) for k in (1, 2)]


def beyond_estimate(once, twice, order):
    """The residual of a rule beyond four times its error, which is estimated from twice the interval in the row and its neighbours."""
    far = np.pad(np.abs(twice), 2)
    far = np.max([far[k : k + len(twice)] for k in range(5)], axis=0)
    excess = np.maximum(np.abs(once) - 4.0 * far / 2.0**order, 0.0)
    return np.where(np.isnan(once), np.nan, excess)


def zero_if_none(column, count):
    return np.zeros(count) if column is None else column


def rows_of(motion, name):
    """A column, or zeros."""
    return zero_if_none(motion.rows.get(name), motion.count)

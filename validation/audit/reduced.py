"""The reduced model: m, ½m′, a, b, w and c of `reduce`, and the runs of unit speed and acceleration of `runs`."""

import numpy as np

import kinematics
import poses
from balance import Balance, add_reactions
from files import Rows, result
from forces import coefficient, unit_load
from jets import Jet
from joints import along, separating
from judge import largest
from kinematics import beyond_estimate, even_rows, simpson
from motion import Frame, Motion
from motions import potentials


def judge_reduced(judge, scene, rows, moving, summary):
    """Judges the rows of `reduce` by the motion in another file at the same positions."""
    name = scene.actuators[0].name
    q = rows.get(name)
    judge.compare("wanted", np.diff(q) - (q[-1] - q[0]) / max(len(q) - 1, 1), max(1.0, largest(q)), "SI", f"steps of {name}")
    extent(judge, rows, summary)
    motion = None
    for other in moving:
        motion = motion or unit_motion(scene, rows, other, name)
    slopes(judge, scene, rows, name, motion)
    if motion is None:
        judge.skip("m, ½m′, a, b, w and c", "no file of `runs`, `kinematics` or `kinetostatics` has rows of the same positions")
        return
    sums(judge, motion)
    bodies(judge, motion)
    known_coefficients(judge, motion)
    names = [load.name for load in scene.loads]
    if "V" in motion.rows and all(load.magnitude.is_constant for load in scene.loads):
        V = motion.rows.get("V")
        conservative = [load for load in scene.loads if load.source != "damper" and (load.kind in ("gravity", "force") or load.source == "spring")]
        if [load.name for load in conservative] == names:
            potentials(judge, motion, names, V, largest(V - V[0], *potential_terms(scene, motion)) or 1.0, "reduced")


def potential_terms(scene, motion):
    """The sizes of the loads' work over a unit of the coordinate."""
    return [load.magnitude(motion.names(motion.time())).value * motion.rows.get(f"{load.name}.w")
            for load in scene.loads if f"{load.name}.w" in motion.rows]


def rows_of_positions(rows, other, name):
    """The rows of both files at the same positions."""
    q, at = rows.get(name), other.get(name)
    if q is None or at is None:
        return None
    order = np.argsort(at)
    place = np.clip(np.searchsorted(at[order], q), 1, max(len(at) - 1, 1))
    nearest = np.where(np.abs(at[order][place - 1] - q) <= np.abs(at[order][place % len(at)] - q), place - 1, place % len(at))
    partner = order[nearest]
    same = np.abs(at[partner] - q) <= 4e-16 * (1.0 + np.abs(q))
    return np.nonzero(same)[0], partner[same]


def unit_motion(scene, rows, other, name):
    """The motion with unit speed and zero acceleration at the rows of `reduce`, from a file with a motion there; or None."""
    found = None if other is None else rows_of_positions(rows, other, name)
    if found is None or len(found[0]) < 3:
        return None
    here, there = found
    motion = Motion(scene, taken(other, there))
    q = motion.measure(scene.actuators[0].measure)
    if np.any(np.abs(q.first) < 1e-3 * largest(q.first)) or not largest(q.first):
        return None
    motion = scaled_to_unit_speed(motion, q)
    motion.rows = taken(rows, here)
    return motion


def taken(rows, which):
    return Rows({name: values[which] for name, values in rows.columns.items()}, rows.units, {}, rows.label)


def scaled_to_unit_speed(motion, q):
    """Velocities divided by the speed; accelerations without the part of q̈, divided by the square of the speed."""
    speed, acceleration = q.first[:, None], q.second[:, None]
    unit = lambda first, second: (first / speed, (second - first / speed * acceleration) / speed**2)
    frames = []
    for frame in motion.frames:
        turned = Frame(frame.rotation, *unit(frame.omega, frame.alpha))
        turned.origin, turned.angle = Jet(frame.origin.value, *unit(frame.origin.first, frame.origin.second)), frame.angle
        frames.append(turned)
    other = motion.at_rest()
    other.frames, other.has_rates = frames, True
    return other


def channels(motion):
    """The unit wrenches of the columns of w and c: loads, friction and separating forces; by name."""
    scene, found = motion.scene, {}
    for load in scene.loads:
        factor = coefficient(load, motion)
        found[load.name] = [w.times(factor) for w in unit_load(load, motion)]
    for friction in scene.frictions:
        joint = scene.joints[friction.joint]
        kind = "angle" if joint.kind == "revolute" else "travel"
        unit = along(motion, scene.measure_of(joint, kind))
        # Dry friction counts as it acts on the second body, viscous friction as what it resists with.
        found |= {f"{joint.name}.friction": unit, f"{joint.name}.viscous": [w.times(-np.ones(motion.count)) for w in unit]}
        if joint.kind == "cylindrical":
            found[f"{joint.name}.friction-moment"] = along(motion, scene.measure_of(joint, "angle"))
    for joint in scene.joints:
        apart, _ = separating(joint, motion)
        if apart:
            found[f"{joint.name}.separating"] = apart
    return found


def sums(judge, motion):
    """Judges m, ½m′ and w by sums over bodies."""
    rows = motion.rows
    energy, rate, terms = poses.kinetic(motion)
    columns = [("m", 2.0 * energy, 2.0 * energy, "kg m2"), ("half_dm", rate, terms, "kg m2")]
    for name, wrenches in channels(motion).items():
        power = sum((w.power(motion) for w in wrenches), np.zeros(motion.count))
        size = sum((w.power_terms(motion) for w in wrenches), np.zeros(motion.count))
        columns.append((f"{name}.w", power, size, "m"))
    for name, values, sizes, unit in columns:
        if name in rows:
            judge.compare("reduced", rows.get(name) - values, largest(values, sizes) or 1.0, unit, name)


def bodies(judge, motion):
    """Judges a, b and c in the equations of every body."""
    rows, scene = motion.rows, motion.scene
    drive = along(motion, scene.actuators[0].measure)
    reactions = [name for name in rows.columns if name.endswith(".a")]
    if not reactions or not poses.varying_is_known(judge, motion):
        return
    for end, force, order in ((".a", "m", 1), (".b", "half_dm", 2)):
        balance = Balance(motion)
        add_reactions(judge, balance, end, False)
        balance.add(drive, rows.get(force))
        balance.add_inertia(order)
        balance.judge(judge, "coefficients", f"{end[1:]}: ")
    for name, wrenches in channels(motion).items():
        if not any(f".c.{name}" in column for column in rows.columns):
            continue
        balance = Balance(motion)
        add_reactions(judge, balance, f".c.{name}", False)
        balance.add(drive, -kinematics.rows_of(motion, f"{name}.w"))
        balance.add(wrenches)
        balance.judge(judge, "coefficients", f"c of {name}: ")


def known_coefficients(judge, motion):
    """a and b of the reactions that the scene states as functions of the angle of a body."""
    for body, frame in zip(motion.scene.bodies, motion.frames):
        if not body.varying:
            continue
        ratio, second = frame.omega[:, 2], frame.alpha[:, 2]
        for end, rates in (("a", (0.0 * ratio, ratio)), ("b", (ratio, second))):
            for name, values in body.varying.reactions_at(frame.angle, *rates).items():
                column = motion.rows.get(f"{name}.{end}")
                if column is not None:
                    judge.compare("reduced", column - values, largest(values) or 1.0, "kg m", f"{name}.{end}")


def slopes(judge, scene, rows, name, motion):
    """Compares m and V with the integrals of 2·½m′ and −Σ w F between rows, away from corners of couplings."""
    q = rows.get(name)
    if len(q) < 5 or "m" not in rows:
        return
    if motion is None and any(joint.kind == "coupling" and joint.law.corners for joint in scene.joints):
        judge.skip("slopes of m and V", "no rows say where couplings pass the corners of their laws")
        return
    corners = [] if motion is None else kinematics.switch_places(motion, motion.rows.get(name))
    span, inside = abs(q[-1] - q[0]), even_rows(q, corners)
    pairs = [("m", rows.get("m"), 2.0 * rows.get("half_dm"))]
    constant = [load for load in scene.loads if load.magnitude.is_constant and (load.kind in ("gravity", "force") and not load.in_body
                                                                                 or load.source == "spring")]
    forces = [float(load.magnitude(None).value.flat[0]) * rows.get(f"{load.name}.w") for load in constant if f"{load.name}.w" in rows]
    if "V" in rows and len(forces) == len(constant):
        pairs.append(("V", rows.get("V"), -sum(forces, np.zeros_like(q))))
    for what, values, slope in pairs:
        scale = max(largest(values), largest(slope) * span) or 1.0
        excess = beyond_estimate(*simpson(q, values, slope), 5)
        judge.compare("slopes", np.where(inside, excess, 0.0), scale * np.diff(q)[1:-2] / span, "SI", what)


def extent(judge, rows, summary):
    """Smallest and largest m and ½m′ of the summary are those of the rows."""
    for name in ("m", "half_dm"):
        column, scale = rows.get(name), largest(rows.get("m"))
        for end, value in (("min", column.min()), ("max", column.max())):
            stated = result(summary, f"{name}.{end}")
            if stated is not None and (stated != 0.0 or largest(column) > 1e-12 * scale):
                judge.compare("summary", stated - value, scale, "kg m2", f"{name}.{end}")


def uniform(judge, run, name):
    """A run has constant acceleration; time, coordinate and speed agree with it."""
    time, q, speed, acceleration = (run.get(n) for n in ("t", name, f"{name}.velocity", f"{name}.acceleration"))
    if any(column is None for column in (time, q, speed, acceleration)):
        return
    since, a = time - time[0], acceleration[0]
    scale = max(largest(speed), abs(a) * largest(since), 1e-300)
    judge.compare("wanted", acceleration - a, max(abs(a), scale / (largest(since) or 1.0)), "SI", f"{name}.acceleration")
    judge.compare("wanted", speed - speed[0] - a * since, scale, "SI", f"{name}.velocity")
    judge.compare("wanted", q - q[0] - speed[0] * since - 0.5 * a * since**2, max(1.0, largest(q)), "SI", name)


def judge_runs(judge, rows, run_i, run_ii, name):
    """Compares m and ½m′, a and b in the file of `runs` with the forces of both runs, and its columns with each other."""
    both = [("m_1", "half_m_1q1", "m", "half_dm", f"{name}.actuator_force")]
    both += [(f"{n}.m_e1", f"{n}.m_e2", f"{n}.a", f"{n}.b", n) for n, _ in rows.ending(".m_e1")]
    is_moment = lambda force: force.endswith("_force") or ".moment" in force
    scales = {kind: largest(*(rows.get(c) for p in both if is_moment(p[4]) == kind for c in p[:2] if c in rows)) for kind in (True, False)}
    for first, second, a, b, force in both:
        scale = scales[is_moment(force)] or 1.0
        for of_runs, of_reduce in ((first, a), (second, b)):
            if of_runs in rows and of_reduce in rows:
                judge.compare("runs", rows.get(of_runs) - rows.get(of_reduce), scale, "SI", of_runs)
        pairs = [(run, force, f"{name}.velocity", f"{name}.acceleration") for run in (run_i, run_ii)]
        for run in (run_i, run_ii):
            if run is not None and run.count == rows.count and name in run and name in rows:
                judge.compare("runs", rows.get(name) - run.get(name), 1.0 + largest(run.get(name)), "SI", f"{name} of {run.label}")
        for run, *columns in pairs:
            if run is not None and run.count == rows.count and all(c in run for c in columns) and first in rows:
                force_column, speed, acceleration = (run.get(c) for c in columns)
                left = force_column - rows.get(first) * acceleration - rows.get(second) * speed**2
                judge.compare("runs", left, scale * (1.0 + speed**2 + np.abs(acceleration)), "SI", f"{force} of {run.label}")

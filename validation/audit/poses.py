"""Rows of positions: `kinematics`, `statics`, `kinetostatics`, runs and the rows of `simulate` by the scene's equations."""

import numpy as np

from forces import FrictionForces, load_magnitude, load_terms, unit_load
from jets import Jet, dot, jet, without_turns
from joints import SPACE_COMPONENTS, along, free_directions, residuals, separating, unit_reactions
from judge import largest
from scene import Z

RATES = ("", " velocity", " acceleration")
# At most so many rows are projected where reactions are in no column: each takes a singular value decomposition.
PROJECTED = 200


def closure(judge, motion):
    """Points, joints, coordinates and travels of every row with the scene's text."""
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
        if joint.kind in ("prismatic", "slot", "cylindrical", "helical") and f"{joint.name}.travel" in rows:
            written = column_jet(rows, f"{joint.name}.travel")
            add(f"{joint.name}.travel", written - motion.measure(scene.measure_of(joint, "travel")), False)


def column_jet(rows, name):
    """A column with its rates; none where it is not there. Columns that are not there are those of rest."""
    value = rows.get(name)
    if value is None:
        return None
    return Jet(value, *(rows.get(name + end) for end in (".velocity", ".acceleration")))


def laws(judge, motion, section):
    """Prescribed coordinates of every row with their laws."""
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
    """Times of the rows between which something may switch; none of a file without a time."""
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


# Between rows.

VALUES = ((("", ".velocity", ".acceleration"),), ((".angle", ".angular_velocity", ".angular_acceleration"),),
          ((".x", ".vx", ".ax"), (".y", ".vy", ".ay"), (".z", ".vz", ".az"),
           (".travel", ".travel.velocity", ".travel.acceleration")))


def between_rows(judge, rows, corners=()):
    """What a column changes by from row to row is the integral of its rate."""
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
    """Of the rows from the third to the last but two: whether they are at equal distances, and away from corners."""
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
    """What is left of y(+k) − y(−k) by the rule of sixth order with first and second derivatives, for k of 1 and 2."""
    h = near(np.append(np.diff(time), 0.0), 0)
    return [near(y, k) - near(y, -k) - k * h / 15.0 * (7.0 * (near(v, -k) + near(v, k)) + 16.0 * near(v, 0))
            - (k * h) ** 2 / 15.0 * (near(a, -k) - near(a, k)) for k in (1, 2)]


def simpson(time, y, rate):
    """What is left of y(+k) − y(−k) by Simpson's rule, for k of 1 and 2."""
    h = near(np.append(np.diff(time), 0.0), 0)
    return [near(y, k) - near(y, -k) - k * h / 3.0 * (near(rate, -k) + 4.0 * near(rate, 0) + near(rate, k)) for k in (1, 2)]


def beyond_estimate(once, twice, order):
    """What a rule leaves beyond four times its error, estimated from twice the interval in the row and its neighbours."""
    far = np.pad(np.abs(twice), 2)
    far = np.max([far[k : k + len(twice)] for k in range(5)], axis=0)
    excess = np.maximum(np.abs(once) - 4.0 * far / 2.0**order, 0.0)
    return np.where(np.isnan(once), np.nan, excess)


# Forces.


class Balance:
    """The forces on every body: Newton's and Euler's equations about the centres of mass."""

    def __init__(self, motion):
        scene, n = motion.scene, motion.count
        self.motion, self.size = motion, scene.size
        self.moving = [k for k, body in enumerate(scene.bodies) if not body.is_ground]
        self.centers = {k: motion.center(k).value for k in self.moving}
        self.left = np.zeros((n, len(scene.bodies), 6))
        self.force, self.moment = np.zeros(n), np.zeros(n)
        self.unknown, self.conditions = [], []

    def vector(self, wrenches):
        """Force and moment of wrenches on each body, (rows, bodies, 6)."""
        found = np.zeros_like(self.left)
        for w in wrenches:
            if w.body in self.centers:
                arm = np.cross(w.point - self.centers[w.body], w.force)
                found[:, w.body, :3] += w.force
                found[:, w.body, 3:] += arm + w.couple
        return found

    def add(self, wrenches, factor=1.0):
        wrenches = [w.times(factor) for w in wrenches]
        self.left += self.vector(wrenches)
        for w in wrenches:
            if w.body in self.centers:
                force = np.linalg.norm(w.force, axis=-1)
                arm = np.linalg.norm(w.point - self.centers[w.body], axis=-1)
                self.force = np.maximum(self.force, force)
                self.moment = np.maximum.reduce([self.moment, force * arm, np.linalg.norm(w.couple, axis=-1)])

    def add_inertia(self, order=2):
        """m a and dL/dt; with order 1 velocities stand for accelerations, so that what is left is linear in them."""
        motion = self.motion
        for k in self.moving:
            body, frame, center = motion.scene.bodies[k], motion.frames[k], motion.center(k)
            tensor = motion.inertia(k)
            turned = lambda v: np.einsum("nij,nj->ni", tensor, v)
            force = body.mass * center.orders[order]
            if order == 2:
                moment = turned(frame.alpha) + np.cross(frame.omega, turned(frame.omega))
            else:
                moment = turned(frame.omega)
            terms = np.linalg.norm(moment, axis=1)
            if body.varying:
                inertia, half_slope = body.varying.at(frame.angle)
                alpha, square = frame.alpha[:, 2], frame.omega[:, 2] ** 2
                parts = (inertia * alpha, half_slope * square) if order == 2 else (inertia * frame.omega[:, 2], 0.0 * square)
                moment, terms = moment + np.outer(sum(parts), Z), terms + np.abs(parts[0]) + np.abs(parts[1])
            self.left[:, k, :3] -= force
            self.left[:, k, 3:] -= moment
            self.force = np.maximum(self.force, np.linalg.norm(force, axis=1))
            self.moment = np.maximum(self.moment, terms)

    def add_unknown(self, wrenches):
        """A component of which the file has no column: what it could balance is left out."""
        self.unknown.append(self.vector(wrenches))
        return len(self.unknown) - 1

    def judge(self, judge, key, what):
        """What is left of every body, beyond what unknown components could balance."""
        force = largest(self.force)
        moment = max(largest(self.moment), force * self.size)
        if self.unknown:
            self.project(judge, key, what, force, moment)
            return
        for k in self.moving:
            name = self.motion.scene.bodies[k].name
            for axis in range(6):
                scale, unit = (force, "N") if axis < 3 else (moment, "N m")
                judge.compare(key, self.left[:, k, axis], scale, unit, f"{what}{name} {('x', 'y', 'z')[axis % 3]} ({unit})")

    def project(self, judge, key, what, force, moment):
        """Least squares over the unknown components, moments in forces at the size of the mechanism."""
        n = len(self.left)
        rows = np.unique(np.linspace(0, n - 1, min(n, PROJECTED)).astype(int))
        scale = np.array([1.0] * 3 + [1.0 / self.size] * 3)
        flat = lambda a: (a[rows][:, self.moving] * scale).reshape(len(rows), -1)
        left = flat(self.left)
        matrix = np.stack([flat(u) for u in self.unknown], axis=-1)
        if self.conditions:
            extra = [self.condition(c) for c in self.conditions]
            left = np.concatenate([left, np.stack([value[rows] for value, _ in extra], -1)], axis=1)
            matrix = np.concatenate([matrix, np.stack([of[rows] for _, of in extra], 1)], axis=1)
        basis, sizes, _ = np.linalg.svd(matrix, full_matrices=False)
        basis = basis * (sizes > 1e-9 * np.maximum(sizes[:, :1], 1e-300))[:, None, :]
        rest = left - np.einsum("nij,nj->ni", basis, np.einsum("nij,ni->nj", basis, left))
        equations = (3 if self.motion.scene.is_plane else 6) * len(self.moving) + len(self.conditions)
        decided = equations - int(round((sizes > 1e-9 * sizes[:, :1]).sum(1).max()))
        if decided <= 0:
            judge.skip(f"{what}equilibrium", "reactions are in no column, and any forces would be balanced by them")
            return
        judge.compare(key, np.abs(rest).max(1), max(force, moment / self.size), "N",
                      f"{what}{decided} of {equations} equations that reactions without a column leave")

    def condition(self, condition):
        """A direction in which a joint transmits nothing: the value of known components, and the row of the unknown ones."""
        (direction_f, direction_m), known_f, known_m, unknown = condition
        is_moment = np.any(direction_m)
        parts = [d / self.size if is_moment else d for d in (direction_f, direction_m)]
        value = (parts[0] * known_f).sum(-1) + (parts[1] * known_m).sum(-1)
        row = np.zeros((len(value), len(self.unknown)))
        for k, component in unknown:
            row[:, k] = parts[component // 3][:, component % 3]
        return value, row


def add_reactions(judge, balance, suffix="", parts_teeth=True):
    """The reactions of all joints, as columns with this ending have them; with what parts teeth, which counts as a load."""
    motion = balance.motion
    rows = motion.rows
    for joint in motion.scene.joints:
        units = unit_reactions(joint, motion)
        columns = {name: rows.get(f"{joint.name}.{name}{suffix}") for name in units}
        unknown = []
        for k, (name, wrenches) in enumerate(units.items()):
            if columns[name] is None:
                unknown.append((balance.add_unknown(wrenches), k))
            else:
                balance.add(wrenches, columns[name])
        apart, slope = separating(joint, motion) if parts_teeth else (None, 0.0)
        if apart and columns["tooth"] is None:
            balance.add_unknown(apart)
        elif apart:
            balance.add(apart, slope * np.abs(columns["tooth"]))
        if not motion.scene.is_plane:
            vectors = [np.stack([zero_if_none(columns[c], motion.count) for c in part], -1)
                       for part in (SPACE_COMPONENTS[:3], SPACE_COMPONENTS[3:])]
            add_free_directions(judge, balance, joint, vectors, unknown, suffix)


def zero_if_none(column, count):
    return np.zeros(count) if column is None else column


def rows_of(motion, name):
    """A column, or zeros."""
    return zero_if_none(motion.rows.get(name), motion.count)


def add_free_directions(judge, balance, joint, vectors, unknown, suffix):
    """A joint transmits no force along what it leaves free, and no moment about it."""
    force, moment = vectors
    for direction in free_directions(joint, balance.motion):
        condition = (direction, force, moment, unknown)
        if unknown:
            balance.conditions.append(condition)
            continue
        value, _ = balance.condition(condition)
        scale = max(largest(force), largest(moment) / balance.size)
        judge.compare("free-directions", value, scale, "N", f"joint {joint.name}{suffix}")


def reaction(motion, joint):
    """Force and moment of a joint about its second body's point; none where a component has no column."""
    total, couple = np.zeros((motion.count, 3)), np.zeros((motion.count, 3))
    for name, wrenches in unit_reactions(joint, motion).items():
        column = motion.rows.get(f"{joint.name}.{name}")
        if column is None:
            return None
        total += wrenches[-1].force * column[:, None]
        couple += wrenches[-1].couple * column[:, None]
    return total, couple


def written(rows, name):
    """The force or moment of a load or drive as written; none without a column."""
    return next((rows.get(f"{name}.load_{end}") for end in ("force", "moment") if f"{name}.load_{end}" in rows), None)


def loads(judge, motion, time):
    """Wrenches of all loads by the scene's text, and their columns with them; by load."""
    names, found = motion.names(time), {}
    for load in motion.scene.loads:
        magnitude = load_magnitude(load, motion, names)
        if np.isnan(magnitude).any():
            judge.require("loads", False, f"load {load.name} has no value in a row: its table does not reach there")
        found[load.name] = [w.times(magnitude) for w in unit_load(load, motion)]
        column = written(motion.rows, load.name)
        if column is not None and load.kind != "gravity":
            judge.compare("loads", column - magnitude, largest(column, load_terms(load, motion, names)), "SI", f"load {load.name}")
        power = motion.rows.get(f"{load.name}.power")
        if power is not None:
            powers = [w.power(motion) for w in found[load.name]]
            scale = largest(sum((w.power_terms(motion) for w in found[load.name]), np.zeros(motion.count)))
            judge.compare("powers", power - sum(powers), max(scale, largest(power)), "W", f"{load.name}.power")
    return found


def frictions(judge, motion, is_free):
    """Friction of all joints by their reactions as written: wrenches by joint, or None where a reaction has no column."""
    found = {}
    for friction in motion.scene.frictions:
        joint = motion.scene.joints[friction.joint]
        of = reaction(motion, joint)
        if of is None:
            judge.skip(f"friction of {joint.name}", "a component of the joint's reaction has no column")
            found[joint.name] = None
            continue
        forces = FrictionForces(friction, motion, *of)
        found[joint.name] = judge_friction(judge, motion, forces, is_free)
    return found


def judge_friction(judge, motion, forces, is_free):
    """Dry friction as the law says where the surfaces move, within its limit where they hold; viscous friction."""
    rows, name, friction = motion.rows, forces.joint.name, forces.friction
    axial, about = forces.dry()
    kind = "moment" if forces.is_pin else "force"
    column = rows.get(f"{name}.friction.load_{kind}")
    rest = forces.limit * friction.static / friction.coefficient if friction.coefficient else forces.limit
    if is_free and friction.regularization is None and friction.coefficient and column is not None and forces.joint.kind != "cylindrical":
        law = about if forces.is_pin else axial
        moves = np.abs(forces.speed) > 1e-6 * largest(forces.speed)
        scale = largest(forces.limit, column)
        judge.compare("friction", np.where(moves, column - law, 0.0), scale, "SI", f"{name}, sliding")
        judge.compare("friction", np.where(moves, 0.0, np.maximum(np.abs(column) - rest, 0.0)), scale, "SI", f"{name}, at rest")
        axial, about = (0.0 * column, column) if forces.is_pin else (column, 0.0 * column)
    elif column is not None and forces.joint.kind != "cylindrical":
        law = about if forces.is_pin else axial
        judge.compare("friction", column - law, largest(law, column), "SI", f"{name}, friction")
    viscous = forces.viscous()
    column = rows.get(f"{name}.viscous.load_{kind}")
    if column is not None:
        judge.compare("friction", column - viscous, largest(viscous, column), "SI", f"{name}, viscous")
    wrenches = forces.wrenches(axial, about)
    wrenches += forces.wrenches(*((0.0 * viscous, viscous) if forces.is_pin else (viscous, 0.0 * viscous)))
    return wrenches


def actuator_forces(balance, of_free, prescribed):
    """The forces of actuators: their columns; those of free coordinates are zero, all others unknown."""
    motion, powers = balance.motion, []
    for coordinate in motion.scene.actuators:
        column = motion.rows.get(f"{coordinate.name}.actuator_force")
        unit = along(motion, coordinate.measure)
        if column is not None:
            balance.add(unit, column)
            powers.append(column * motion.measure(coordinate.measure).first)
        elif not of_free or coordinate.name in prescribed:
            balance.add_unknown(unit)
            powers.append(None)
    return powers


def equilibrium(judge, motion, at_rest=False, is_loaded=True):
    """The forces of a file of `statics` or `kinetostatics`; of `runs` without loads and friction."""
    motion = motion.at_rest() if at_rest else motion
    of_loads = loads(judge, motion, motion.time()) if is_loaded else {}
    balance = Balance(motion)
    for wrenches in of_loads.values():
        balance.add(wrenches)
    add_reactions(judge, balance, parts_teeth=is_loaded)
    of_friction = {} if at_rest or not is_loaded else frictions(judge, motion, False)
    if at_rest:
        no_friction(judge, motion)
    powers = actuator_forces(balance, False, ())
    if not at_rest:
        balance.add_inertia()
    if any(w is None for w in of_friction.values()):
        judge.skip("equilibrium", "friction by reactions without columns")
    else:
        for wrenches in of_friction.values():
            balance.add(wrenches)
        if varying_is_known(judge, motion):
            balance.judge(judge, "equilibrium", "")
    known_reactions(judge, motion)
    totals(judge, motion, of_loads, of_friction, powers)
    repeated(judge, motion)


def no_friction(judge, motion):
    """At rest the files have no friction."""
    for friction in motion.scene.frictions:
        name = motion.scene.joints[friction.joint].name
        for what in ("friction", "viscous"):
            column = written(motion.rows, f"{name}.{what}")
            if column is not None:
                judge.compare("friction", column, 1.0, "SI", f"{name}.{what} at rest")


def varying_is_known(judge, motion):
    unknown = [b.name for b in motion.scene.bodies if b.varying and not b.varying.is_known]
    if unknown:
        judge.skip("equilibrium", f"the inertia of {unknown[0]} varies, and the scene gives no half slope")
    return not unknown


def known_reactions(judge, motion):
    """Reactions that the scene gives over the angle of a body."""
    for body, frame in zip(motion.scene.bodies, motion.frames):
        if body.varying:
            for name, values in body.varying.reactions_at(frame.angle, frame.omega[:, 2], frame.alpha[:, 2]).items():
                column = motion.rows.get(name)
                if column is not None:
                    judge.compare("known-reactions", column - values, largest(values), "N", name)


# Sums over the mechanism.


def kinetic(motion):
    """The kinetic energy, its rate, and the size of the rate's terms."""
    energy, rate, terms = np.zeros(motion.count), np.zeros(motion.count), np.zeros(motion.count)
    for k, body in enumerate(motion.scene.bodies):
        frame, center, tensor = motion.frames[k], motion.center(k), motion.inertia(k)
        turned = lambda v: np.einsum("nij,nj->ni", tensor, v)
        spin = (frame.omega * turned(frame.alpha)).sum(-1)  # ω·(ω × Iω) is zero
        energy += 0.5 * (body.mass * (center.first**2).sum(-1) + (frame.omega * turned(frame.omega)).sum(-1))
        if body.varying:
            inertia, half_slope = body.varying.at(frame.angle)
            omega, alpha = frame.omega[:, 2], frame.alpha[:, 2]
            energy += 0.5 * inertia * omega**2
            spin = spin + omega * (inertia * alpha + half_slope * omega**2)
        parts = body.mass * (center.first * center.second).sum(-1), spin
        rate += sum(parts)
        terms += body.mass * np.linalg.norm(center.first, axis=1) * np.linalg.norm(center.second, axis=1) + np.abs(spin)
    return energy, rate, terms


def shaking(motion, of_loads):
    """What the ground feels: loads from outside less the rate of momentum; with the size of the terms."""
    force, moment = np.zeros((motion.count, 3)), np.zeros((motion.count, 3))
    sizes = [np.zeros(motion.count), np.zeros(motion.count)]

    def add(f, at, couple):
        nonlocal force, moment
        force, moment = force + f, moment + np.cross(at, f) + couple
        size = np.linalg.norm(f, axis=-1)
        sizes[0] += size
        sizes[1] += size * np.linalg.norm(at, axis=-1) + np.linalg.norm(couple, axis=-1)

    for load in motion.scene.loads:
        if load.kind in ("gravity", "force") and load.name in of_loads:
            for w in of_loads[load.name]:
                add(w.force, w.point, w.couple)
    for k, body in enumerate(motion.scene.bodies):
        frame, center, tensor = motion.frames[k], motion.center(k), motion.inertia(k)
        turned = lambda v: np.einsum("nij,nj->ni", tensor, v)
        couple = turned(frame.alpha) + np.cross(frame.omega, turned(frame.omega))
        if body.varying:
            inertia, half_slope = body.varying.at(frame.angle)
            parts = inertia * frame.alpha[:, 2], half_slope * frame.omega[:, 2] ** 2
            couple = couple + np.outer(sum(parts), Z)
            sizes[1] += np.abs(parts[0]) + np.abs(parts[1])
        add(-body.mass * center.second, center.value, -couple)
    return force, moment, sizes


def totals(judge, motion, of_loads, of_friction, actuator_powers, drives=()):
    """Shaking force and moment, powers and energies with sums over bodies and loads."""
    rows, scene = motion.rows, motion.scene
    joint_force = largest(*(v for j in scene.joints for v in [rows.get(f"{j.name}.magnitude")] if v is not None))
    force, moment, sizes = shaking(motion, of_loads)
    f_scale = max(largest(sizes[0]), joint_force)
    m_scale = max(largest(sizes[1]), joint_force * scene.size)
    axes = {"x": 0, "y": 1} if scene.is_plane else {"x": 0, "y": 1, "z": 2}
    columns = [(f"shaking.f{a}", force[:, k], f_scale, "N") for a, k in axes.items()]
    columns += [("shaking.moment", moment[:, 2], m_scale, "N m")] if scene.is_plane else \
        [(f"shaking.m{a}", moment[:, k], m_scale, "N m") for a, k in axes.items()]
    energy, rate, terms = kinetic(motion)
    load_powers = [w.power(motion) for wrenches in of_loads.values() for w in wrenches]
    is_known = all(w is not None for w in of_friction.values())
    load_powers += [w.power(motion) for wrenches in of_friction.values() if wrenches for w in wrenches]
    load_powers += [drives[name].net() * drives[name].coordinate.first for name in drives]
    driven = [p for p in actuator_powers if p is not None]
    speed = max((largest(f.omega) for f in motion.frames), default=0.0)
    p_scale = max(largest(terms), largest(*load_powers), largest(*driven), largest(energy) * speed)
    sum_of = lambda powers: sum(powers, np.zeros(motion.count))
    columns += [("energy.kinetic_bodies", energy, largest(energy), "J"), ("power.kinetic", rate, p_scale, "W"),
                ("power.residual", 0.0 * rate, p_scale, "W")]
    if is_known:
        columns.append(("power.loads", sum_of(load_powers), p_scale, "W"))
    if all(p is not None for p in actuator_powers):
        columns.append(("power.actuators", sum_of(driven), p_scale, "W"))
    for name, value, scale, unit in columns:
        if name in rows:
            judge.compare("totals", rows.get(name) - value, scale or 1.0, unit, name)


# Columns that repeat others.


def repeated(judge, motion):
    """Magnitudes, directions and other components of joint forces, and powers of friction."""
    rows, scene = motion.rows, motion.scene
    vectors = {}
    for joint in scene.joints:
        of = reaction(motion, joint)
        if of is not None:
            vectors[joint.name] = of
    f_scale, m_scale = largest(*(v[0] for v in vectors.values())), largest(*(v[1] for v in vectors.values()))
    for joint in scene.joints:
        if joint.name not in vectors:
            continue
        force, moment = vectors[joint.name]
        found = {"magnitude": (np.linalg.norm(force, axis=1), f_scale), "moment-magnitude": (np.linalg.norm(moment, axis=1), m_scale)}
        for place in joint.places:
            name, rotation = scene.bodies[place.body].name, motion.frames[place.body].rotation
            local = np.einsum("nij,ni->nj", rotation, force)
            found |= {f"{axis}@{name}": (local[:, k], f_scale) for k, axis in enumerate("xyz")}
        if not scene.is_plane and joint.kind != "gear in space":
            found |= joint_axes(joint, motion, force, moment, f_scale, m_scale)
        for name, (values, scale) in found.items():
            column = rows.get(f"{joint.name}.{name}")
            if column is not None:
                judge.compare("joint-forces", column - values, scale or 1.0, "SI", f"{joint.name}.{name}")
        direction = rows.get(f"{joint.name}.direction")
        if direction is not None:
            turned = without_turns(jet(direction - np.arctan2(force[:, 1], force[:, 0]))).value
            judge.compare("joint-forces", turned * np.linalg.norm(force, axis=1), f_scale or 1.0, "N", f"{joint.name}.direction")
    friction_powers(judge, motion)


def joint_axes(joint, motion, force, moment, f_scale, m_scale):
    """Components along the axes of a joint in space."""
    axis = motion.direction(joint.places[0].body, joint.axes[0]).value
    found = {"axial": ((force * axis).sum(-1), f_scale), "moment-axial": ((moment * axis).sum(-1), m_scale)}
    if joint.normals:
        normal = motion.direction(joint.places[0].body, joint.normals[0]).value
        for name, direction in (("normal", normal), ("across", np.cross(axis, normal))):
            found[name] = (force * direction).sum(-1), f_scale
            found[f"moment-{name}"] = (moment * direction).sum(-1), m_scale
    return found


def friction_powers(judge, motion):
    """The power of a joint's friction with its force along the written motion."""
    rows = motion.rows
    for friction in motion.scene.frictions:
        joint = motion.scene.joints[friction.joint]
        kind = "angle" if joint.kind == "revolute" else "travel"
        if joint.kind == "cylindrical":
            continue
        speed = motion.measure(motion.scene.measure_of(joint, kind)).first
        for what in ("friction", "viscous"):
            force, power = written(rows, f"{joint.name}.{what}"), rows.get(f"{joint.name}.{what}.power")
            if force is not None and power is not None:
                judge.compare("powers", power - force * speed, largest(power, force * speed), "W", f"{joint.name}.{what}.power")



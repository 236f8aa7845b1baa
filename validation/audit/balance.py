"""Newton's and Euler's equations of every body with the written forces."""

import numpy as np

from joints import SPACE_COMPONENTS, along, free_directions, separating, unit_reactions
from judge import largest
from kinematics import zero_if_none
from scene import Z


# Largest number of projected rows if reactions have no columns: each row needs a singular value decomposition.
PROJECTED = 200


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
        """Adds m a and dL/dt. With order 1, velocities replace the accelerations, so that the residual is linear in them."""
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
        """Adds a component without a column in the file; the residual that it could balance is not judged."""
        self.unknown.append(self.vector(wrenches))
        return len(self.unknown) - 1

    def judge(self, judge, key, what):
        """Judges the residual of every body, except the part that unknown components could balance."""
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
        """A condition for a direction in which a joint transmits nothing: the value of known components, and the row of the unknown ones."""
        (direction_f, direction_m), known_f, known_m, unknown = condition
        is_moment = np.any(direction_m)
        parts = [d / self.size if is_moment else d for d in (direction_f, direction_m)]
        value = (parts[0] * known_f).sum(-1) + (parts[1] * known_m).sum(-1)
        row = np.zeros((len(value), len(self.unknown)))
        for k, component in unknown:
            row[:, k] = parts[component // 3][:, component % 3]
        return value, row


def add_reactions(judge, balance, suffix="", parts_teeth=True):
    """Adds the reactions of all joints from the columns with this ending, and the separating forces of teeth, which count as loads."""
    motion = balance.motion
    rows = motion.rows
    vectors = {}
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
        if all(component in units for component in SPACE_COMPONENTS):
            force, moment = (np.stack([zero_if_none(columns[c], motion.count) for c in part], -1)
                             for part in (SPACE_COMPONENTS[:3], SPACE_COMPONENTS[3:]))
            vectors[joint.name] = (joint, force, moment, unknown)
    add_free_directions(judge, balance, vectors.values(), suffix)


def add_free_directions(judge, balance, reactions, suffix):
    """Adds the conditions that joints transmit no force along their free directions, and no moment about them.

    Their scale is the largest reaction of all joints: that of a joint which a load does not reach is rounding.
    """
    scale = max((max(largest(force), largest(moment) / balance.size) for _, force, moment, _ in reactions), default=0.0)
    for joint, force, moment, unknown in reactions:
        for direction in free_directions(joint, balance.motion):
            condition = (direction, force, moment, unknown)
            if unknown:
                balance.conditions.append(condition)
                continue
            value, _ = balance.condition(condition)
            judge.compare("free-directions", value, scale, "N", f"joint {joint.name}{suffix}")


def reaction(motion, joint):
    """Force and moment of a joint about its second body's point; None if a component has no column."""
    total, couple = np.zeros((motion.count, 3)), np.zeros((motion.count, 3))
    for name, wrenches in unit_reactions(joint, motion).items():
        column = motion.rows.get(f"{joint.name}.{name}")
        if column is None:
            return None
        total += wrenches[-1].force * column[:, None]
        couple += wrenches[-1].couple * column[:, None]
    return total, couple


def written(rows, name):
    """The written force or moment of a load or drive; None without a column."""
    return next((rows.get(f"{name}.load_{end}") for end in ("force", "moment") if f"{name}.load_{end}" in rows), None)


def actuator_forces(balance, of_free, prescribed):
    """The forces of actuators from their columns. Without a column, the force of a free coordinate is zero, any other force unknown."""
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

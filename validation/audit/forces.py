"""Forces and moments of loads, friction and drives in every row."""

import numpy as np

from joints import Wrench, along, axis_of, pair


class NoValue(Exception):
    """A magnitude has no value in some row, such as beyond the end of a table."""


def load_magnitude(load, motion, names):
    """The force or moment of a load, as in its column; for gravity, the acceleration."""
    amount = value_of(load.magnitude, names, motion.count)
    if load.source == "given":
        return amount
    if load.source == "drag":
        speed = along_drag(load, motion)
        return -amount * np.abs(speed) * speed
    coordinate = motion.measure(load.measure)
    return -amount * (coordinate.value - load.free if load.source == "spring" else coordinate.first)


def along_drag(load, motion):
    """The speed of the point of a drag, or the angular velocity of a fan."""
    if load.kind == "drag":
        return np.linalg.norm(motion.point(load.place).first, axis=-1)
    return motion.measure(load.measure).first


def load_terms(load, motion, names):
    """The size of the terms of a load's magnitude; the elongation of a spring, for example, is a difference of lengths."""
    amount = np.abs(value_of(load.magnitude, names, motion.count))
    if load.source == "given":
        return amount
    if load.source == "drag":
        return amount * along_drag(load, motion) ** 2
    coordinate = motion.measure(load.measure)
    return amount * (np.abs(coordinate.value) + abs(load.free) if load.source == "spring" else np.abs(coordinate.first))


def value_of(magnitude, names, count):
    return np.broadcast_to(magnitude(names).value, count)


def unit_load(load, motion):
    """The wrenches of a load whose magnitude is 1."""
    if load.kind == "gravity":
        found = []
        for k, body in enumerate(motion.scene.bodies):
            if body.mass > 0.0:
                center = motion.center(k).value
                found.append(Wrench(k, np.broadcast_to(body.mass * load.direction, center.shape), center, 0.0 * center))
        return found
    if load.kind == "force":
        point = motion.point(load.place).value
        force = motion.direction(load.place.body, load.direction).value if load.in_body else load.direction
        return [Wrench(load.place.body, np.broadcast_to(force, point.shape), point, 0.0 * point)]
    if load.kind == "drag":
        velocity, speed = motion.point(load.place).first, along_drag(load, motion)[:, None]
        forward = np.divide(velocity, speed, out=np.zeros_like(velocity), where=speed > 0.0)
        return [Wrench(load.place.body, forward, motion.point(load.place).value, 0.0 * forward)]
    if load.kind == "torque":
        axis = motion.direction(load.bodies[0], load.direction).value
        return pair(load.bodies, 0.0 * axis, 0.0 * axis, axis)
    return along(motion, load.measure)


def coefficient(load, motion):
    """The magnitude of a load whose number in `reduce` is 1: a force of 1 N, a stiffness of 1 N/m, a resistance of 1 N; of a drag that of
    coefficient 1 at unit speed."""
    if load.source == "drag":
        speed = along_drag(load, motion)
        return -np.abs(speed) * speed
    if load.source == "spring":
        return load.free - motion.measure(load.measure).value
    return np.full(motion.count, -1.0 if load.source == "damper" else 1.0)


class FrictionForces:
    """The contact forces of a joint, its sliding speeds, and the friction."""

    def __init__(self, friction, motion, force, moment):
        """Takes the force and the moment of the joint about its second body's point, in the axes of the ground."""
        scene = motion.scene
        self.friction, self.joint = friction, scene.joints[friction.joint]
        self.bodies = [place.body for place in self.joint.places]
        self.axis = axis_of(self.joint, motion).value
        self.point = motion.point(self.joint.places[1]).value
        across = force - (force * self.axis).sum(-1, keepdims=True) * self.axis
        if friction.distance > 0.0:
            lever = np.cross(moment, self.axis) / friction.distance
            ends = [0.5 * across + sign * lever for sign in (1.0, -1.0)]
            self.pressure = sum(np.linalg.norm(end, axis=1) for end in ends)
        else:
            self.pressure = np.linalg.norm(across, axis=1)
        kind = self.joint.kind
        rate = lambda measure: motion.measure(scene.measure_of(self.joint, measure)).first
        self.spin = rate("angle") if kind in ("revolute", "cylindrical") else np.zeros(motion.count)
        self.slide = np.zeros(motion.count) if kind == "revolute" else rate("travel")
        self.is_pin = kind == "revolute"

    @property
    def speed(self):
        """The speed in the smoothing: angular velocity for a pin, sliding velocity for all other surfaces."""
        if self.is_pin:
            return self.spin
        if self.joint.kind != "cylindrical":
            return self.slide
        return np.hypot(self.slide, self.friction.radius * self.spin)

    @property
    def limit(self):
        """The largest dry friction while sliding: a moment for a pin, a force for all other joints."""
        return self.friction.coefficient * self.pressure * (self.friction.radius if self.is_pin else 1.0)

    def dry(self):
        """Dry friction along the axis and about it, by the law of sliding surfaces."""
        v, speed = self.friction.regularization, self.speed
        share = np.sign(speed) if v is None else np.tanh(speed / v)
        if self.joint.kind != "cylindrical":
            return (0.0 * speed, -self.limit * share) if self.is_pin else (-self.limit * share, 0.0 * speed)
        with np.errstate(all="ignore"):
            size = np.where(speed > 0.0, self.limit * share / speed, 0.0)
        return -size * self.slide, -size * self.friction.radius**2 * self.spin

    def viscous(self):
        return -self.friction.viscous * (self.spin if self.is_pin else self.slide)

    def wrenches(self, force, moment):
        """A force along the axis and a moment about it, on the second body."""
        return pair(self.bodies, force[:, None] * self.axis, self.point, moment[:, None] * self.axis)


# Drives.


class DriveForces:
    """A drive in every row: its force on the coordinate, and the state of its circuit."""

    def __init__(self, drive, coordinate, magnitude, rows):
        self.drive, self.numbers, self.coordinate, self.magnitude = drive, drive.numbers, coordinate, magnitude
        self.written_current, self.integral = rows.get(f"{drive.name}.current"), rows.get(f"{drive.name}.integral")
        self.written = next((rows.get(f"{drive.name}.load_{end}") for end in ("moment", "force")
                             if f"{drive.name}.load_{end}" in rows), None)

    @property
    def has_circuit(self):
        return self.drive.kind == "motor" and "resistance" in self.numbers

    @property
    def current(self):
        """The current of the circuit. With an inductance it is a state and read from its column."""
        if self.numbers.get("inductance", 0.0) > 0.0:
            return self.written_current
        return (self.magnitude - self.induced) / self.numbers["resistance"]

    @property
    def induced(self):
        return self.numbers["torque-constant"] * self.numbers["ratio"] * self.coordinate.first

    @property
    def current_rate(self):
        """The rate of a current that is a state; None for other currents."""
        inductance = self.numbers.get("inductance", 0.0)
        if not inductance or self.current is None:
            return None
        return (self.magnitude - self.numbers["resistance"] * self.current - self.induced) / inductance

    @property
    def unlimited(self):
        """The force of a controller without its limit; None for other drives, and if no file has its integral."""
        if self.drive.kind != "speed-controller":
            return None
        integral = self.numbers["integral"]
        if integral and self.integral is None:
            return None
        error = self.magnitude - self.coordinate.first
        return self.numbers["proportional"] * error + (integral * self.integral if integral else 0.0)

    def force(self):
        """The force before the part that accelerates the rotor. For a controller whose integral is in no file, the written force."""
        ratio = self.numbers["ratio"]
        if self.drive.kind == "applied-force":
            return self.magnitude
        if self.drive.kind == "speed-controller":
            limit = self.numbers.get("limit", np.inf)
            return self.written if self.unlimited is None else np.clip(self.unlimited, -limit, limit)
        if self.has_circuit:
            current = self.current
            return None if current is None else ratio * self.numbers["torque-constant"] * current
        voltage = 1.0 if self.magnitude is None else self.magnitude
        return ratio * self.numbers["stall-torque"] * (voltage - ratio * self.coordinate.first / self.numbers["no-load-speed"])

    def net(self):
        """The force on the mechanism: the force without the part that accelerates the rotor."""
        force = self.force()
        return None if force is None else force - self.numbers["rotor"] * self.coordinate.second


def stop_forces(stop, motion):
    """The force of a compliant stop along its coordinate: a spring and a damper that can only push."""
    coordinate = motion.measure(motion.scene.coordinate(stop["coordinate"]).measure)
    total = np.zeros(motion.count)
    for end, sign in (("min", 1.0), ("max", -1.0)):
        if end in stop:
            depth = sign * (stop[end] - coordinate.value)
            push = stop["stiffness"] * depth - stop["damping"] * sign * coordinate.first
            total += sign * np.where(depth > 0.0, np.maximum(push, 0.0), 0.0)
    return coordinate, total

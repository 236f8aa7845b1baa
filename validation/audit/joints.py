"""Joints: their constraint residuals, and the forces of their reactions.

Every kind is a list of parts. A joint in the plane is the joint in space whose axis is z, or whose slide lies in z = 0.
"""

from dataclasses import dataclass

import numpy as np

from jets import Jet, atan2, cross, dot, jet, length, scaled, without_turns
from scene import Z


# Parts of the kinds of joints, from points, axes and normals.
PARTS = {
    "revolute": ("point", "axes"),
    "spherical": ("point",),
    "universal": ("point", "right angle"),
    "weld": ("point", "axes", "normals"),
    "prismatic": ("line", "axes", "normals"),
    "cylindrical": ("line", "axes"),
    "helical": ("line", "axes", "thread"),
    "planar": ("plane", "axes"),
    "point-on-line": ("line",),
    "point-in-plane": ("plane",),
    "slot": ("line",),
    "distance": ("length",),
    "gear": ("gear",),
    "rack": ("rolled",),
    "rolling": ("rolled", "height"),
    "coupling": ("coupling",),
    "gear in space": ("teeth",),
}


@dataclass
class Residual:
    """A quantity that a joint keeps at zero, an angle or a length. For teeth between moving wheels only its rates are known."""

    jet: Jet
    is_angle: bool
    is_rate: bool = False


def residuals(joint, motion):
    """The quantities that a joint keeps at zero, in every row."""
    found = []
    for part in PARTS[joint.kind]:
        for residual in PART_FUNCTIONS[part](joint, motion):
            of = residual.jet
            vector = of.value.ndim == 2
            found += [Residual(of[k], residual.is_angle, residual.is_rate) for k in range(3)] if vector else [residual]
    return found


def gap_of(joint, motion):
    return motion.gap(joint.places)


def axis_of(joint, motion, k=0):
    return motion.direction(joint.places[k].body, joint.axes[k])


def normal_of(joint, motion, k=0):
    return motion.direction(joint.places[k].body, joint.normals[k])


def points_coincide(joint, motion):
    return [Residual(gap_of(joint, motion), False)]


def parallel(u, w):
    """Residuals of two parallel unit vectors of the same sense."""
    return [Residual(cross(u, w), True), Residual(1.0 - dot(u, w), True)]


def axes_parallel(joint, motion):
    return parallel(axis_of(joint, motion), axis_of(joint, motion, 1))


def normals_parallel(joint, motion):
    return parallel(normal_of(joint, motion), normal_of(joint, motion, 1))


def axes_at_right_angle(joint, motion):
    return [Residual(dot(axis_of(joint, motion), axis_of(joint, motion, 1)), True)]


def on_line(joint, motion):
    return [Residual(cross(axis_of(joint, motion), gap_of(joint, motion)), False)]


def in_plane(joint, motion):
    return [Residual(dot(axis_of(joint, motion), gap_of(joint, motion)), False)]


def along_thread(joint, motion):
    """The travel is the pitch times the angle in revolutions. The travel decides the number of whole revolutions."""
    travel = dot(axis_of(joint, motion), gap_of(joint, motion))
    measure = motion.scene.measure_of(joint, "angle")
    pitch = joint.sizes["pitch"]
    return [Residual(without_turns(travel - pitch / (2.0 * np.pi) * motion.relative_angle(measure), abs(pitch)), False)]


def keeps_length(joint, motion):
    """The length of a distance is constant; for a driven distance the actuator decides it."""
    wanted = joint.sizes.get("length")
    return [] if wanted is None else [Residual(length(gap_of(joint, motion)) - wanted, False)]


def kept(quantity, turn=None):
    """A quantity keeps its value of the first row, except for whole revolutions of meshing wheels."""
    change = quantity - quantity.value[0]
    return change if turn is None else without_turns(change, turn)


def gears_roll(joint, motion):
    """Two wheels roll on each other, relative to their line of centres."""
    r, s = joint.sizes["radii"]
    s = -s if joint.sizes["internal"] else s
    gap = gap_of(joint, motion)
    line = atan2(gap[1], gap[0])
    a, b = (plane_angle(motion, place.body) - line for place in joint.places)
    return [Residual(kept(r * a + s * b, abs(r + s) * 2.0 * np.pi), False)]


def plane_angle(motion, body):
    frame = motion.frames[body]
    return Jet(frame.angle, frame.omega[:, 2], frame.alpha[:, 2])


def wheel_rolls(joint, motion):
    """A wheel rolls along a straight line of the first body."""
    a, b = (plane_angle(motion, place.body) for place in joint.places)
    travel = dot(gap_of(joint, motion), axis_of(joint, motion))
    return [Residual(kept(travel + joint.sizes["radius"] * (b - a)), False)]


def keeps_height(joint, motion):
    return [Residual(dot(gap_of(joint, motion), normal_of(joint, motion)) - joint.sizes["radius"], False)]


def follows_law(joint, motion):
    value, variable = (motion.measure(measure) for measure in joint.measures)
    open_jet = value - joint.law.at(variable, lambda name: None)
    for corner in joint.law.corners:  # where the second derivative has two values
        open_jet.second = np.where(np.abs(variable.value - corner) <= 1e-12 * (1.0 + abs(corner)), 0.0, open_jet.second)
    return [Residual(open_jet, joint.measures[0].is_angle)]


def teeth_touch(joint, motion):
    """Both wheels have the same velocity along the normal of the teeth at the pitch point of the carrier."""
    pitch = motion.point(joint.carrier)
    normal = motion.direction(joint.carrier.body, joint.axes[0])
    a, b = (motion.body_point_rates(place.body, pitch) for place in joint.places)
    slip = dot(normal, b - a)
    return [Residual(Jet(0.0 * slip.value, slip.value, slip.first), False, True)]


PART_FUNCTIONS = {
    "point": points_coincide,
    "axes": axes_parallel,
    "normals": normals_parallel,
    "right angle": axes_at_right_angle,
    "line": on_line,
    "plane": in_plane,
    "thread": along_thread,
    "length": keeps_length,
    "gear": gears_roll,
    "rolled": wheel_rolls,
    "height": keeps_height,
    "coupling": follows_law,
    "teeth": teeth_touch,
}


# Forces.


@dataclass
class Wrench:
    """A force at a point and a couple on a body, in every row, in the axes of the ground."""

    body: int
    force: np.ndarray
    point: np.ndarray
    couple: np.ndarray

    def times(self, factor):
        factor = np.asarray(factor)[..., None]
        return Wrench(self.body, self.force * factor, self.point, self.couple * factor)

    def power(self, motion):
        """The power of the wrench on the moving body."""
        frame = motion.frames[self.body]
        velocity = frame.origin.first + np.cross(frame.omega, self.point - frame.origin.value)
        return (self.force * velocity).sum(-1) + (self.couple * frame.omega).sum(-1)

    def power_terms(self, motion):
        """The size of the terms of the power, independent of the directions."""
        frame = motion.frames[self.body]
        speed = np.linalg.norm(frame.origin.first + np.cross(frame.omega, self.point - frame.origin.value), axis=-1)
        spin = np.linalg.norm(frame.omega, axis=-1)
        return np.linalg.norm(self.force, axis=-1) * speed + np.linalg.norm(self.couple, axis=-1) * spin


def pair(bodies, force, point, couple):
    """A force and a couple of the first body on the second at a point, and the opposite ones on the first."""
    force, point, couple = np.broadcast_arrays(force, point, couple)
    return [Wrench(bodies[0], -force, point, -couple), Wrench(bodies[1], force, point, couple)]


def along(motion, measure):
    """A unit force along a coordinate, of its first body on its second: its work is positive if the coordinate increases."""
    a, b = (place.body for place in measure.places)
    if measure.kind == "length":
        line = motion.gap(measure.places).value
        line = line / np.linalg.norm(line, axis=1, keepdims=True)
        ends = [motion.point(place).value for place in measure.places]
        return [Wrench(a, -line, ends[0], 0.0 * line), Wrench(b, line, ends[1], 0.0 * line)]
    axis, point = motion.direction(a, measure.axes[0]).value, motion.point(measure.places[1]).value
    if measure.kind == "angle":
        return pair((a, b), 0.0 * axis, point, axis)
    return pair((a, b), axis, point, 0.0 * axis)


def unit_reactions(joint, motion):
    """The wrenches of a unit of each component of a joint's reaction, by the name of its column."""
    return plane_reactions(joint, motion) if motion.scene.is_plane else space_reactions(joint, motion)


SPACE_COMPONENTS = ("x", "y", "z", "moment-x", "moment-y", "moment-z")


def reaction_point(joint, motion):
    """The point at which a reaction acts: the second body's point, or the pitch point of teeth."""
    return motion.point(joint.carrier or joint.places[1]).value


def space_reactions(joint, motion):
    if joint.kind == "coupling":
        return coupling_reaction(joint, motion)
    bodies, point = [place.body for place in joint.places], reaction_point(joint, motion)
    zero = np.zeros(3)
    units = {name: (axis, zero) for name, axis in zip(SPACE_COMPONENTS[:3], np.eye(3))}
    units |= {name: (zero, axis) for name, axis in zip(SPACE_COMPONENTS[3:], np.eye(3))}
    return {name: pair(bodies, force, point, couple) for name, (force, couple) in units.items()}


def plane_reactions(joint, motion):
    bodies, point = [place.body for place in joint.places], motion.point(joint.places[1]).value
    x, y, zero = np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), np.zeros(3)
    force = lambda direction, at=point: pair(bodies, direction, at, zero)
    pins = {"x": force(x), "y": force(y)}
    couple = {"moment": pair(bodies, zero, point, Z)}
    if joint.kind == "revolute":
        return pins
    if joint.kind == "weld":
        return pins | couple
    if joint.kind == "distance":
        return {"axial": along(motion, motion.scene.measure_of(joint, "length"))}
    if joint.kind == "coupling":
        return coupling_reaction(joint, motion)
    if joint.kind == "gear":
        pitch, tangent, _ = pitch_point(joint, motion)
        return {"tooth": force(tangent, pitch)}
    axis, normal = axis_of(joint, motion).value, normal_of(joint, motion).value
    if joint.kind in ("prismatic", "slot"):
        return {"normal": force(normal)} | (couple if joint.kind == "prismatic" else {})
    contact = point - joint.sizes["radius"] * normal
    if joint.kind == "rack":
        return {"tooth": force(axis, contact)}
    return {"normal": force(normal, contact), "tangent": force(axis, contact)}


def coupling_reaction(joint, motion):
    """A multiplier λ acts on the dependent coordinate, and −λ law′ on the independent one."""
    value, variable = joint.measures
    at = motion.measure(variable).value
    slope = joint.law.at(Jet(at, np.ones_like(at), 0.0 * at), lambda name: None).first
    wrenches = along(motion, value) + [w.times(-slope) for w in along(motion, variable)]
    return {"moment" if value.is_angle else "force": wrenches}


def pitch_point(joint, motion):
    """The pitch point of two gears in the plane, and the directions of the tooth force and of the separating force."""
    r, s = joint.sizes["radii"]
    line = gap_of(joint, motion).value
    line = line / np.linalg.norm(line, axis=1, keepdims=True)
    outwards = line if joint.sizes["internal"] and r > s else -line
    return motion.point(joint.places[1]).value + s * outwards, np.cross(Z, outwards), -outwards


def separating(joint, motion):
    """The unit separating force of teeth with a pressure angle, of the first body on the second; None for other joints."""
    slope = np.tan(joint.sizes.get("pressure", 0.0))
    if slope == 0.0:
        return None, 0.0
    bodies = [place.body for place in joint.places]
    if joint.kind == "gear":
        point, _, apart = pitch_point(joint, motion)
    else:
        radius, normal = joint.sizes["radius"], normal_of(joint, motion).value
        point, apart = motion.point(joint.places[1]).value - radius * normal, np.sign(radius) * normal
    return pair(bodies, apart, point, np.zeros(3)), slope


def free_directions(joint, motion):
    """Pairs of a direction of the force and one of the moment along which a joint in space transmits nothing.

    A force counts in N, a moment in N m: the direction of a force beside a moment is a length, as that of a thread.
    """
    zero = Jet(np.zeros((motion.count, 3)))
    eye = [jet(np.broadcast_to(e, (motion.count, 3))) for e in np.eye(3)]
    parts = PARTS[joint.kind]

    def across(u):
        return [e - scaled(u, dot(u, e)) for e in eye]

    if "thread" in parts:
        u = axis_of(joint, motion)
        slides, turns = [(u * (joint.sizes["pitch"] / (2.0 * np.pi)), u)], []
    elif "teeth" in parts:
        slides, turns = across(motion.direction(joint.carrier.body, joint.axes[0])), eye
    elif "length" in parts:
        line = gap_of(joint, motion)
        slides, turns = across(scaled(line, 1.0 / length(line))), eye
    else:
        u, w = axis_of(joint, motion), axis_of(joint, motion, 1)
        slides = [] if "point" in parts else [u] if "line" in parts else across(u)
        turns = [] if "normals" in parts else [u] if "axes" in parts else [u, w] if "right angle" in parts else eye
    free = [slide if isinstance(slide, tuple) else (slide, zero) for slide in slides] + [(zero, turn) for turn in turns]
    return [(force.value, moment.value) for force, moment in free]

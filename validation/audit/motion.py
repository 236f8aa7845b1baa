"""The motion of all bodies in every row of a file, from one point and the rotation of each body in the file."""

import numpy as np

from jets import Jet, atan2, cross, dot, length, without_turns
from scene import Z, across


# Endings of the columns of a body and of its points, for each derivative, in the plane and in space.
PLANE_ROTATION = ("angle", "angular_velocity", "angular_acceleration")
SPACE_ROTATION = ("rotation", "angular_velocity", "angular_acceleration")
POINT = ("", "v", "a")


class Unplaced(Exception):
    """A body without columns that determine its position."""


class Frame:
    """A body's frame in all rows."""

    def __init__(self, rotation, omega, alpha):
        self.rotation, self.omega, self.alpha = rotation, omega, alpha
        self.origin = None  # set once the rotation is known
        self.angle = None  # of a body in the plane, with its revolutions

    def turned(self, vector):
        """A direction of the body in the axes of the ground."""
        u = self.rotation @ vector
        first = np.cross(self.omega, u)
        return Jet(u, first, np.cross(self.alpha, u) + np.cross(self.omega, first))


class Motion:
    """All bodies in all rows of a file."""

    def __init__(self, scene, rows):
        self.scene, self.rows, self.count = scene, rows, rows.count
        self.frames = [self.frame(body) for body in scene.bodies]
        self.has_rates = any(name.endswith((".angular_velocity", ".angular_velocity.z")) for name in rows.columns)
        self.turns = {}

    # Frames.

    def frame(self, body):
        n = self.count
        if body.is_ground:
            still = Frame(np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3)), np.zeros((n, 3)))
            still.origin, still.angle = Jet(np.zeros((n, 3))), np.zeros(n)
            return still
        frame = self.plane_frame(body.name) if self.scene.is_plane else self.space_frame(body.name)
        name, local = next(((p, at) for p, at in body.points.items() if self.written_point(body.name, p)), (None, None))
        if frame is None or name is None:
            raise Unplaced(body.name)
        frame.origin = self.written_point(body.name, name) - frame.turned(local)
        return frame

    def plane_frame(self, name):
        angle, omega, alpha = (self.rows.get(f"{name}.{end}") for end in PLANE_ROTATION)
        if angle is None:
            return None
        s, c, zero = np.sin(angle), np.cos(angle), 0.0 * angle
        rotation = np.stack([np.stack(row, -1) for row in ((c, -s, zero), (s, c, zero), (zero, zero, zero + 1.0))], 1)
        about_z = lambda rate: Z * (zero if rate is None else rate)[:, None]
        frame = Frame(rotation, about_z(omega), about_z(alpha))
        frame.angle = angle
        return frame

    def space_frame(self, name):
        vectors = [self.rows.several(f"{name}.{end}", (".x", ".y", ".z")) for end in SPACE_ROTATION]
        if vectors[0] is None:
            return None
        zero = np.zeros((self.count, 3))
        omega, alpha = (zero if v is None else v for v in vectors[1:])
        return Frame(rotation_of(vectors[0]), omega, alpha)

    def written_point(self, body, point):
        """A point from its columns, or None. In a file without rates the mechanism is at rest."""
        axes = "xy" if self.scene.is_plane else "xyz"
        orders = [self.rows.several(f"{body}.{point}.", [f"{end}{axis}" for axis in axes]) for end in POINT]
        if orders[0] is None:
            return None
        if self.scene.is_plane:
            orders = [None if o is None else np.column_stack([o, np.zeros(self.count)]) for o in orders]
        return Jet(*orders)

    def at_rest(self):
        """The positions with zero rates."""
        other = object.__new__(Motion)
        other.scene, other.rows, other.count, other.turns, other.has_rates = self.scene, self.rows, self.count, {}, False
        other.frames = []
        for frame in self.frames:
            still = Frame(frame.rotation, 0.0 * frame.omega, 0.0 * frame.alpha)
            still.origin, still.angle = frame.origin.at_rest(), frame.angle
            other.frames.append(still)
        return other

    # Positions, directions, rates.

    def direction(self, body, vector):
        return self.frames[body].turned(vector)

    def point(self, place):
        return self.frames[place.body].origin + self.frames[place.body].turned(place.point)

    def gap(self, places):
        """The vector from the first place to the second."""
        return self.point(places[1]) - self.point(places[0])

    def center(self, body):
        frame = self.frames[body]
        return frame.origin + frame.turned(self.scene.bodies[body].center)

    def omega(self, body):
        """The angular velocity with its first derivative; a second one is in no file."""
        frame = self.frames[body]
        return Jet(frame.omega, frame.alpha, np.full_like(frame.alpha, np.nan))

    def body_point_rates(self, body, at):
        """Velocity of the body's material point at a moving place, with its rate."""
        frame = self.frames[body]
        origin, omega = frame.origin, self.omega(body)
        arm = at - origin
        spin = np.cross(omega.value, arm.value)
        change = np.cross(omega.first, arm.value) + np.cross(omega.value, arm.first)
        return Jet(origin.first + spin, origin.second + change, np.full_like(spin, np.nan))

    def inertia(self, body):
        """The tensor about the centre of mass in the axes of the ground."""
        rotation = self.frames[body].rotation
        return rotation @ self.scene.bodies[body].inertia @ rotation.transpose(0, 2, 1)

    # Coordinates.

    def measure(self, measure):
        """A coordinate with its derivatives."""
        if measure.kind == "length":
            return length(self.gap(measure.places))
        first = measure.places[0].body
        if measure.kind == "travel":
            return dot(self.gap(measure.places), self.direction(first, measure.axes[0]))
        return self.relative_angle(measure)

    def relative_angle(self, measure):
        """The angle about the axis from the normal of the first body to that of the second, with its revolutions."""
        a, b = (place.body for place in measure.places)
        normals = measure.normals or [across(axis) for axis in measure.axes]
        n, m = self.direction(a, normals[0]), self.direction(b, normals[1])
        axis = self.direction(a, measure.axes[0])
        angle = atan2(dot(axis, cross(n, m)), dot(n, m))
        return angle + 2.0 * np.pi * self.revolutions(measure, angle.value)

    def revolutions(self, measure, angle):
        """The whole revolutions of an angle: from the angles of both bodies, from a coordinate's column, or by continuity from row to row."""
        a, b = (place.body for place in measure.places)
        whole = lambda other: np.round((other - angle) / (2.0 * np.pi))
        if self.frames[a].angle is not None and self.frames[b].angle is not None:
            return whole(self.frames[b].angle - self.frames[a].angle)
        for coordinate in self.scene.coordinates:
            of = coordinate.measure
            if of.is_angle and of.joint == measure.joint and measure.normals and coordinate.name in self.rows:
                return whole(self.rows.get(coordinate.name))
        return whole(np.unwrap(angle))

    def names(self, time):
        """The signals of expressions and tables: t, coordinates and their velocities, without derivatives."""

        def signal(name):
            if name == "t":
                return Jet(time)
            if coordinate := self.scene.coordinate(name):
                return self.measure(coordinate.measure).at_rest()
            stem = name.removesuffix(".velocity")
            coordinate = self.scene.coordinate(stem)
            return Jet(self.measure(coordinate.measure).first) if coordinate and stem != name else None

        return signal

    def time(self):
        """The time of the rows; a sweep of positions is at t = 0."""
        t = self.rows.get("t")
        return np.zeros(self.count) if t is None else t

    @property
    def largest(self):
        """The largest distance from the origin, m, and the largest velocity and acceleration of a body, 1/s and 1/s² of it."""
        spans = [np.abs(self.frames[k].origin.value + self.frames[k].rotation @ p).max()
                 for k, body in enumerate(self.scene.bodies) for p in body.points.values()]
        size = max(spans, default=0.0) or 1.0
        speed, rate = 0.0, 0.0
        for frame in self.frames:
            speed = max(speed, np.abs(frame.origin.first).max() / size, np.abs(frame.omega).max())
            rate = max(rate, np.abs(frame.origin.second).max() / size, np.abs(frame.alpha).max())
        return size, speed, max(rate, speed**2)


def rotation_of(vectors):
    """The rotations about vectors by their lengths (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)
    safe = np.where(angle > 0.0, angle, 1.0)
    x, y, z = (vectors / safe[:, None]).T
    zero = 0.0 * x
    k = np.stack([np.stack(row, -1) for row in ((zero, -z, y), (z, zero, -x), (-y, x, zero))], 1)
    s, half = np.sin(angle)[:, None, None], np.sin(0.5 * angle)[:, None, None]
    return np.eye(3) + s * k + 2.0 * half**2 * (k @ k)


def difference_without_turns(a, b):
    """a − b of two angles, without whole revolutions."""
    return without_turns(a - b)

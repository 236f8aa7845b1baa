"""A mechanism in space as its reference of 25 digits defines it, in the pose and with the speeds of its start."""

import json
import math
from dataclasses import dataclass

import numpy as np

# Which free motion of a reference, of those without or with its loads, and after how much time the crank's angle is compared with
# the reference again and again: none where it is compared after whole turns, of which the period is known.
MOTIONS = {
    "slider-crank-haug": ("as defined", None),
    "rsur-haug": ("none", None),
    "bricard-a04": ("gravity", 0.25),
}
TURNS = 10


@dataclass
class Body:
    """A body: centre and inertia about it in its own frame; pose and rates of that frame in the ground's, at the start."""

    mass: float
    center: np.ndarray
    inertia: np.ndarray
    origin: np.ndarray
    rotation: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray

    def at(self, point):
        """Where a point of the body is, and its velocity."""
        arm = self.rotation @ point
        return self.origin + arm, self.velocity + np.cross(self.spin, arm)


GROUND = Body(0.0, np.zeros(3), np.zeros((3, 3)), np.zeros(3), np.eye(3), np.zeros(3), np.zeros(3))


@dataclass(eq=False)
class Joint:
    """A joint of two bodies: its point, and its axes on the first and the second, in the ground's frame at the start."""

    kind: str
    bodies: tuple
    points: tuple  # in the frames of the bodies
    at: np.ndarray
    axes: tuple


@dataclass
class Tree:
    """A joint that carries a body, from its parent; the freedoms are turns about axes, or one slide along one."""

    joint: Joint
    parent: str
    child: str
    axes: list
    rates: list


@dataclass
class Mechanism:
    name: str
    bodies: dict  # with the ground
    joints: list
    crank: str
    driver: tuple  # its axis, and the directions on ground and crank between which its angle is
    gravity: np.ndarray
    period: float
    unit: float  # s, between two instants
    instants: list  # how many units after the start, and the crank's angle there

    @property
    def duration(self):
        return self.instants[-1][0] * self.unit

    def error(self, angles):
        """The largest error of the crank's angle, of those after each unit, rad; whole turns do not count."""
        return max(abs(math.remainder(angles[k - 1] - angle, math.tau)) for k, angle in self.instants)

    def tree(self):
        """The joints that carry a body each, branch after branch, and those that close loops; balls close them wherever they are."""
        carried, closing, seen = {}, [j for j in self.joints if j.kind == "spherical"], ["ground"]
        for parent in seen:
            for joint in self.joints:
                if parent not in joint.bodies or joint in closing or any(joint is by.joint for by in carried.values()):
                    continue
                end = joint.bodies.index(parent)
                child = joint.bodies[1 - end]
                if child in seen:
                    closing.append(joint)
                else:
                    seen.append(child)
                    carried[child] = self.carried(joint, parent, child, end)

        def branch(parent):
            for by in carried.values():
                if by.parent == parent:
                    yield by
                    yield from branch(by.child)

        return list(branch("ground")), closing

    def carried(self, joint, parent, child, end):
        """The freedoms of a joint from this end to the other, with their rates at the start: the axes are at right angles."""
        axes = [joint.axes[end], joint.axes[1 - end]] if joint.kind == "universal" else [joint.axes[end]]
        a, b = self.bodies[parent], self.bodies[child]
        apart = b.spin - a.spin
        if joint.kind == "prismatic":  # on a parent that does not turn
            apart = b.at(joint.points[1 - end])[1] - a.at(joint.points[end])[1]
        return Tree(joint, parent, child, axes, [float(axis @ apart) for axis in axes])


def number(value):
    """A decimal number, or a quotient of two."""
    above, _, below = str(value).partition("/")
    return float(above) / float(below or 1)


def vector(values):
    return np.array([number(v) for v in values])


def unit(v):
    return v / np.linalg.norm(v)


def tensor(values):
    """Of three or six elements."""
    xx, yy, zz, xy, xz, yz = [number(v) for v in values] + [0.0] * (6 - len(values))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def read(path):
    """The mechanism of a reference, at the start of its motion; the reference has its pose there and its velocities at unit speed."""
    data = json.loads(path.read_text(encoding="utf-8"))
    given, (loads, step) = data["definition"], MOTIONS[path.stem]
    motion = next(m for m in data["free_motion"] if m["loads"] == loads)
    start, speed = number(motion.get("q0", 0)), number(motion.get("qdot0", 0))
    pose = next(s for s in data["samples"] if number(s["q"]) == start)
    bodies = {"ground": GROUND}
    for name, body in given["bodies"].items():
        at = pose["bodies"][name]
        rotation = np.array([vector(row) for row in at["rotation_rows"]])
        bodies[name] = Body(number(body["mass"]), vector(body["com"]), tensor(body["inertia"]), vector(at["position"]), rotation,
                            speed * vector(at["v"]), speed * vector(at["omega"]))
    joints = []
    for joint in given["joints"]:
        ends = joint["a"], joint["b"]
        points = vector(joint["pa"]), vector(joint["pb"])
        axes = tuple(bodies[e].rotation @ unit(vector(joint[u])) for e, u in zip(ends, ("ua", "ub")) if u in joint)
        joints.append(Joint(joint["kind"], ends, points, bodies[ends[1]].at(points[1])[0], axes))
    driver = given["driver"]
    gravity = vector(given["gravity"]) if loads != "none" else np.zeros(3)
    period = number(motion["period_s"])
    instants = [(k, start + math.tau * k) for k in range(1, TURNS + 1)] if step is None else \
        [(round(number(s["t"]) / step), number(s["q"])) for s in motion["states"]]
    return Mechanism(path.stem, bodies, joints, driver["b"], tuple(unit(vector(driver[k])) for k in ("ua", "na", "nb")), gravity,
                     period, step or period, instants)

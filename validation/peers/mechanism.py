"""A scene's bodies and joints, and where and how fast they start: what every tool builds its model from."""

import math
import tomllib
from dataclasses import dataclass

import numpy as np

# Lengths in metres.
UNITS = {"mm": 1e-3, "in": 0.0254}


@dataclass
class Body:
    """A moving body: what is fixed to it is in its own frame, in metres; pose and rates are x, y and angle of that frame."""

    mass: float
    center: np.ndarray
    inertia: float  # about its centre, kg m²
    pose: np.ndarray
    rates: np.ndarray

    def at(self, point):
        """Where a point of the body is, and its velocity."""
        arm = turned(self.pose[2], point)
        return self.pose[:2] + arm, self.rates[:2] + self.rates[2] * np.array([-arm[1], arm[0]])


@dataclass(eq=False)
class Joint:
    """A pin, or a slide along `axis` of the first body."""

    bodies: tuple
    points: tuple
    axis: np.ndarray | None


@dataclass
class Mechanism:
    name: str
    period: float  # s, exact
    bodies: dict  # without the ground
    joints: list
    crank: str

    def tree(self):
        """The joints that carry a body each, branch after branch, as (joint, parent, child, parent's point, child's point); and
        those that close loops. Bodies are reached from the ground by the fewest joints."""
        carried, closing, seen = {}, [], ["ground"]
        for parent in seen:
            for joint in self.joints:
                if parent not in joint.bodies or joint in closing or any(joint is by[0] for by in carried.values()):
                    continue
                end = joint.bodies.index(parent)
                child = joint.bodies[1 - end]
                if child in seen:
                    closing.append(joint)
                else:
                    seen.append(child)
                    carried[child] = (joint, parent, child, joint.points[end], joint.points[1 - end])

        def branch(parent):
            for by in carried.values():
                if by[1] == parent:
                    yield by
                    yield from branch(by[2])

        return list(branch("ground")), closing


def turned(angle, v):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]])


def read(folder):
    """The mechanism of a case, at its start."""
    scene = tomllib.loads((folder / "scene.toml").read_text(encoding="utf-8"))
    case = tomllib.loads((folder / "case.toml").read_text(encoding="utf-8"))
    unit = UNITS.get(scene.get("units", {}).get("length"), 1.0)
    points = {
        f"{name}.{point}": unit * np.array(at, float)
        for name, body in scene["bodies"].items()
        for point, at in body["points"].items()
    }
    bodies = {}
    for name, body in scene["bodies"].items():
        if name != "ground":
            center = body.get("center", [0, 0])
            center = points[f"{name}.{center}"] if isinstance(center, str) else unit * np.array(center, float)
            bodies[name] = Body(body["mass"], center, body.get("inertia", 0.0), np.zeros(3), np.zeros(3))
    joints = []
    for joint in scene["joints"].values():
        ends = joint.get("revolute") or joint["prismatic"]
        axis = np.array(joint["axis"], float) if "prismatic" in joint else None
        joints.append(Joint(tuple(e.split(".")[0] for e in ends), tuple(points[e] for e in ends), axis))
    (coordinate, actuator), = scene["actuators"].items()
    mechanism = Mechanism(folder.name, float(case["free_motion"]["period_s"]), bodies, joints, actuator["angle"][1])
    motion = scene["motion"]
    rough = scene["assembly"] | {mechanism.crank: motion["initial-coordinate"][coordinate]}
    assemble(mechanism, rough, motion["initial-coordinate"][coordinate], motion["initial-velocity"][coordinate])
    return mechanism


def assemble(mechanism, rough, angle, speed):
    """Newton's method on all joints from the scene's rough angles; then the speeds from the same matrix."""
    names = list(mechanism.bodies)
    place = {name: slice(3 * k, 3 * k + 3) for k, name in enumerate(names)}
    x = np.zeros(3 * len(names))
    for name in names:
        x[place[name]][2] = rough[name]
    for _ in range(50):
        rest, rows = [], []
        for joint in mechanism.joints:
            gap, slopes = np.zeros(2), np.zeros((2, len(x)))
            for sign, name, point in zip((-1, 1), joint.bodies, joint.points):
                if name == "ground":
                    gap += sign * point
                    continue
                arm = turned(x[place[name]][2], point)
                gap += sign * (x[place[name]][:2] + arm)
                slopes[:, place[name]] += sign * np.array([[1, 0, -arm[1]], [0, 1, arm[0]]])
            if joint.axis is None:
                rest.extend(gap)
                rows.extend(slopes)
            else:
                first, second = (place[name].start + 2 for name in joint.bodies)
                normal = turned(x[first] + math.pi / 2, joint.axis)
                across = normal @ slopes
                across[first] += gap @ turned(math.pi / 2, normal)
                same = np.zeros(len(x))
                same[[first, second]] = -1, 1
                rest.extend([normal @ gap, x[second] - x[first]])
                rows.extend([across, same])
        crank = np.zeros(len(x))
        crank[place[mechanism.crank].start + 2] = 1
        matrix = np.array([*rows, crank])
        # The first matrix may be singular: nothing is yet where it belongs.
        step = np.linalg.lstsq(matrix, np.array([*rest, x[place[mechanism.crank]][2] - angle]))[0]
        x -= step
        if np.abs(step).max() < 1e-15:
            break
    rates = np.linalg.solve(matrix, speed * np.eye(len(x))[-1])
    for name, body in mechanism.bodies.items():
        body.pose, body.rates = x[place[name]], rates[place[name]]

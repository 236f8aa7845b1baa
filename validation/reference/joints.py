"""The constraint equations of joints and coordinates in reference-point coordinates (x, y of the centre of mass, angle).

Each row is a residual as a function of the bodies' coordinates, numbers or power series alike; its multiplier is, by the
order and the sign chosen here, the force or the moment of the first-named body on the second.
"""

import math

from mpmath import mpf, pi

from jets import Jet, atan2, sincos, sqrt
from scene import evaluate


class Row:
    def __init__(self, name, bodies, residual):
        self.name, self.residual = name, residual
        self.bodies = [b for b in dict.fromkeys(bodies) if b != "ground"]


def place(scene, X, name):
    """A point, such as crank.B, in the ground's axes."""
    body, (u, v) = scene.points[name]
    x, y, angle = X[body]
    s, c = sincos(angle)
    return x + c * u - s * v, y + s * u + c * v


def unit(v):
    n = sqrt(mpf(v[0]) ** 2 + mpf(v[1]) ** 2)
    return mpf(v[0]) / n, mpf(v[1]) / n


def turned(X, body, v):
    s, c = sincos(X[body][2])
    return c * v[0] - s * v[1], s * v[0] + c * v[1]


def between(scene, X, ends):
    p, q = (place(scene, X, e) for e in ends)
    return q[0] - p[0], q[1] - p[1]


def distance(scene, X, ends):
    dx, dy = between(scene, X, ends)
    return sqrt(dx * dx + dy * dy)


def slide_ends(joint):
    return joint.get("prismatic") or joint["slot"]


def slide_axis(joint):
    axes = joint.get("axes")
    return unit(axes[0] if axes else joint["axis"])


def travel(scene, X, name):
    joint = scene.joints[name]
    ends = slide_ends(joint)
    d, t = between(scene, X, ends), turned(X, scene.points[ends[0]][0], slide_axis(joint))
    return d[0] * t[0] + d[1] * t[1]


def coordinate(scene, X, name):
    """The value of an actuator's or a named coordinate."""
    c = scene.coordinates[name]
    if "angle" in c:
        return X[c["angle"][1]][2] - X[c["angle"][0]][2]
    along = c.get("travel") or c["length"]
    return travel(scene, X, along) if isinstance(along, str) else distance(scene, X, along)


def coordinate_bodies(scene, name):
    c = scene.coordinates[name]
    if "angle" in c:
        return c["angle"]
    along = c.get("travel") or c["length"]
    if isinstance(along, str):
        along = slide_ends(scene.joints[along])
    return [scene.points[e][0] for e in along]


def revolute(scene, name, joint):
    first, *others = joint["revolute"]
    for other in others:
        body = scene.points[other][0]
        label = name if len(others) == 1 else f"{name}-{body}"
        for k in (0, 1):
            yield label + (".x", ".y")[k], (first, other), lambda X, k=k, e=(first, other): between(scene, X, e)[k]


def aside(scene, X, ends, axis):
    """How far the second point is to the left of the axis through the first."""
    d, t = between(scene, X, ends), turned(X, scene.points[ends[0]][0], axis)
    return d[1] * t[0] - d[0] * t[1]


def slide(scene, name, joint):
    ends, axis = slide_ends(joint), slide_axis(joint)
    yield name + ".normal", ends, lambda X: aside(scene, X, ends, axis)
    if "prismatic" in joint:
        a, b = (scene.points[e][0] for e in ends)
        second = unit(joint["axes"][1]) if "axes" in joint else axis
        lag = (atan2(second[1], second[0]) - atan2(axis[1], axis[0])).v
        yield name + ".moment", ends, lambda X: X[b][2] - X[a][2] + lag


def weld(scene, name, joint):
    yield from revolute(scene, name, {"revolute": joint["weld"]})
    a, b = (scene.points[e][0] for e in joint["weld"])
    fixed = mpf(joint.get("angle", 0)) * scene.angle
    yield name + ".moment", joint["weld"], lambda X: X[b][2] - X[a][2] - fixed


def link(scene, name, joint):
    length = mpf(joint["length"]) * scene.length
    yield name + ".axial", joint["distance"], lambda X: distance(scene, X, joint["distance"]) - length


def gear(scene, name, joint):
    """Rolling of the pitch circles: r2 (angle2 - line) + r1 (angle1 - line) = 0, the line that of the centres.

    The constant is zero since the case is assembled with every angle zero. The line's angle is continuous: it is the
    one nearest to the last, from which the coordinates come in small steps.
    """
    ends = joint["gear"]
    a, b = (scene.points[e][0] for e in ends)
    r1, r2 = (mpf(r) * scene.length for r in joint["radii"])
    r1 = -r1 if joint.get("internal") else r1
    last = [0.0]

    def residual(X):
        d = between(scene, X, ends)
        line = atan2(d[1], d[0])
        now = float(line.v)
        turns = round((last[0] - now) / (2 * math.pi))
        last[0] = now + 2 * math.pi * turns
        line = (line if isinstance(d[0] + d[1], Jet) else line.v) + 2 * turns * pi
        return r2 * (X[b][2] - line) + r1 * (X[a][2] - line)

    yield name + ".tooth", ends, residual


def rolling(scene, name, joint):
    kind = "rolling" if "rolling" in joint else "rack"
    ends, axis, radius = joint[kind], unit(joint["axis"]), mpf(joint["radius"]) * scene.length
    a, b = (scene.points[e][0] for e in ends)

    def roll(X):
        d, t = between(scene, X, ends), turned(X, a, axis)
        return d[0] * t[0] + d[1] * t[1] + radius * (X[b][2] - X[a][2])

    if kind == "rolling":
        yield name + ".normal", ends, lambda X: aside(scene, X, ends, axis) - radius
    yield name + (".tangent" if kind == "rolling" else ".tooth"), ends, roll


def coupling(scene, name, joint):
    y, x = joint["coupling"]
    bodies = coordinate_bodies(scene, y) + coordinate_bodies(scene, x)
    law = joint["expression"]
    value = lambda X: coordinate(scene, X, y) - evaluate(law, {"x": coordinate(scene, X, x)})
    yield name + ".force", bodies, value


KINDS = {"revolute": revolute, "prismatic": slide, "slot": slide, "weld": weld, "distance": link, "gear": gear,
         "rack": rolling, "rolling": rolling, "coupling": coupling}


def rows(scene):
    """All rows: those of the joints, then one for each actuator (its coordinate)."""
    found = []
    for name, joint in scene.joints.items():
        kind = next(k for k in joint if k in KINDS)
        for label, ends, residual in KINDS[kind](scene, name, joint):
            bodies = [scene.points[e][0] if e in scene.points else e for e in ends]
            found.append(Row(label, bodies, residual))
    for name in scene.actuators:
        residual = lambda X, name=name: coordinate(scene, X, name)
        found.append(Row(name + ".actuator_force", coordinate_bodies(scene, name), residual))
    return found

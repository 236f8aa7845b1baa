"""Functions of one variable in a scene: tables, sinusoids, rises and expressions."""

from dataclasses import dataclass

import numpy as np

from expressions import Expression
from jets import Jet, choose, jet, sin


RISES = ("polynomial345", "polynomial4567", "cycloidal", "trapezoidal")


@dataclass
class Law:
    """A function of a jet (time, or the independent coordinate of a coupling)."""

    at: object
    corners: list  # where one of its first derivatives may jump


class Table:
    """The curve through the points of a table, as cubic pieces with a slope at both ends of each."""

    def __init__(self, points, interpolation, goes_on=False):
        self.goes_on = goes_on  # along the tangents at both ends
        self.x, self.y = np.asarray(points, float).T
        self.is_step = interpolation == "step"
        secants = np.diff(self.y) / np.diff(self.x)
        slopes = {"spline": spline_slopes, "monotone": monotone_slopes}.get(interpolation)
        if slopes:
            at_points = slopes(self.x, self.y)
            self.slopes = np.stack([at_points[:-1], at_points[1:]])
        else:
            self.slopes = np.stack([secants, secants])

    def __call__(self, x):
        """The value; beyond the points, that of the tangents, or NaN."""
        at = x.value
        piece = np.clip(np.searchsorted(self.x, at, side="right") - 1, 0, len(self.x) - 2)
        y0, y1 = self.y[piece], self.y[piece + 1]
        outside = (at < self.x[0]) | (at > self.x[-1])
        if self.is_step:
            return Jet(np.where(outside, np.nan, np.where(at == self.x[-1], y1, y0)))
        h = self.x[piece + 1] - self.x[piece]
        u = (x - self.x[piece]) * (1.0 / h)
        rest = 1.0 - u
        m0, m1 = self.slopes[:, piece]
        curve = rest * rest * (1.0 + 2.0 * u) * y0 + u * u * (3.0 - 2.0 * u) * y1 + u * rest * (rest * m0 - u * m1) * h
        end = np.where(at < self.x[0], 0, -1)
        tangent = (x - self.x[end]) * self.slopes[end, end] + self.y[end]
        return choose(outside, tangent if self.goes_on else jet(np.nan * at), curve)


def spline_slopes(x, y):
    """Slopes of the cubic spline with two continuous derivatives, not-a-knot at both ends."""
    n, h, secants = len(x), np.diff(x), np.diff(y) / np.diff(x)
    if n == 2:
        return np.array([secants[0]] * 2)
    if n == 3:
        bend = (secants[1] - secants[0]) / (h[0] + h[1])
        return np.array([secants[0] - bend * h[0], secants[0] + bend * h[0], secants[1] + bend * h[1]])
    matrix, right = np.zeros((n, n)), np.zeros(n)
    for i in range(1, n - 1):
        before, after = 1.0 / h[i - 1], 1.0 / h[i]
        matrix[i, i - 1 : i + 2] = before, 2.0 * (before + after), after
        right[i] = 3.0 * (secants[i - 1] * before + secants[i] * after)
    # The third derivative of a piece is 6 (m0 + m1 - 2 secant)/h²; at both ends it is that of the next piece.
    for row, (this, other) in ((0, (0, 1)), (n - 1, (n - 3, n - 2))):
        for piece, sign in ((this, 1.0), (other, -1.0)):
            weight = sign / h[piece] ** 2
            matrix[row, piece : piece + 2] += weight
            right[row] += 2.0 * weight * secants[piece]
    return np.linalg.solve(matrix, right)


def monotone_slopes(x, y):
    """Slopes after Fritsch and Butland (1984): no piece goes beyond its points."""
    h, secants = np.diff(x), np.diff(y) / np.diff(x)
    if len(x) == 2:
        return np.array([secants[0]] * 2)

    def end(near, next_one):
        s, t = secants[near], secants[next_one]
        slope = s + (s - t) * h[near] / (h[near] + h[next_one])
        if slope * s <= 0.0:
            return 0.0
        return 3.0 * s if s * t <= 0.0 and abs(slope) > 3.0 * abs(s) else slope

    def inner(i):
        a, b, s, t = h[i - 1], h[i], secants[i - 1], secants[i]
        return 0.0 if s * t <= 0.0 else 3.0 * (a + b) / ((2.0 * b + a) / s + (b + 2.0 * a) / t)

    last = len(secants) - 1
    return np.array([end(0, 1), *(inner(i) for i in range(1, len(x) - 1)), end(last, last - 1)])


def rise(shape, u, ramp):
    """The relative rise at the relative time u, from 0 to 1."""
    if shape == "polynomial345":
        inside = u * u * u * (10.0 - 15.0 * u + 6.0 * (u * u))
    elif shape == "polynomial4567":
        inside = u * u * u * u * (35.0 - 84.0 * u + 70.0 * (u * u) - 20.0 * (u * u * u))
    elif shape == "cycloidal":
        inside = u - sin(u * (2.0 * np.pi)) * (0.5 / np.pi)
    else:  # the area under a trapezium of height 1/(1 - ramp)
        height, rest = 1.0 / (1.0 - ramp), 1.0 - u
        first, last = u * u * (0.5 * height / ramp), 1.0 - rest * rest * (0.5 * height / ramp)
        middle = (u - 0.5 * ramp) * height
        inside = choose(u.value < ramp, first, choose(u.value > 1.0 - ramp, last, middle))
    zero = Jet(0.0 * u.value)
    return choose(u.value <= 0.0, zero, choose(u.value >= 1.0, zero + 1.0, inside))


def read_points(table, units):
    return [[x * units[0], y * units[1]] for x, y in table]


def read_law(table, start, value_unit, variable_unit, angle_unit, goes_on=False):
    """The law of a table of the scene; `start`, in SI units, is where speeds, sinusoids and rises begin.

    The table of a coupling goes on along its tangents; that of a motion has no value beyond its points.
    """
    if "speed" in table:
        speed = table["speed"] * value_unit
        return Law(lambda x, names: start + speed * x, [])
    if "sinusoid" in table:
        keys = table["sinusoid"]
        amplitude, phase = keys["amplitude"] * value_unit, keys.get("phase", 0.0) * angle_unit
        turn = 2.0 * np.pi / (keys["period"] * variable_unit)
        return Law(lambda x, names: start + amplitude * (sin(x * turn + phase) - np.sin(phase)), [])
    if "expression" in table:
        expression = Expression(table["expression"])
        return Law(lambda x, names: expression(lambda name: x if name == "x" else names(name)), [])
    if "table" in table:
        points = read_points(table["table"], (variable_unit, value_unit))
        curve = Table(points, table.get("interpolation", "spline"), goes_on)
        return Law(lambda x, names: curve(x), list(curve.x))
    shape = next(name for name in RISES if name in table)
    keys = table[shape]
    height, duration = keys["rise"] * value_unit, keys["duration"] * variable_unit
    delay, ramp = keys.get("delay", 0.0) * variable_unit, keys.get("ramp", 0.0) / keys["duration"]
    parts = (0.0, ramp, 1.0 - ramp, 1.0) if shape == "trapezoidal" else (0.0, 1.0)
    corners = [delay + part * duration for part in parts]
    return Law(lambda x, names: start + height * rise(shape, (x - delay) * (1.0 / duration), ramp), corners)

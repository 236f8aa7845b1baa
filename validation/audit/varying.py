"""A moment of inertia that is a function of its body's angle, with reactions within the mechanism that the body represents."""

import numpy as np


class VaryingInertia:
    """I and ½I′ over the angle: over a whole revolution by barycentric weights (Henrici 1979), otherwise by Hermite's cubics."""

    def __init__(self, table, angle_unit, inertia_unit):
        angles = angle_unit * np.array(table["angle"], float)
        count, step = len(angles), angles[1] - angles[0]
        rows = count - 1 if abs(angles[-1] - angles[0] - 2 * np.pi) < 1e-6 * step else count
        equal = angles[0] + 2 * np.pi / rows * np.arange(rows)
        is_whole = np.all(np.abs(angles[:rows] - equal) < 1e-6 * step)
        self.angles = angles[:rows]
        self.is_series = is_whole and table.get("interpolation") != "cubic"
        self.inertia = inertia_unit * np.array(table["inertia"], float)[:rows]
        slope = table.get("half-slope")
        self.half_slope = None if slope is None else inertia_unit * np.array(slope, float)[:rows]
        reactions = table.get("reactions", {}).items()
        self.reactions = {name: (np.array(of["a"], float)[:rows], np.array(of["b"], float)[:rows]) for name, of in reactions}

    @property
    def is_known(self):
        """Whether the scene determines the curve: without half slopes the audit would have to choose an interpolation."""
        return self.half_slope is not None or self.is_series

    def at(self, angle):
        """I and ½I′ at angles."""
        if not self.is_series:
            return self.hermite(angle)
        slopes = self.half_slope if self.half_slope is not None else 0.5 * self.derivative()
        return self.series(self.inertia, angle), self.series(slopes, angle)

    def reactions_at(self, angle, omega, alpha):
        """a α + b ω² of each reaction, by name."""
        if not self.is_series:
            return {}
        series = self.series
        return {n: series(a, angle) * alpha + series(b, angle) * omega**2 for n, (a, b) in self.reactions.items()}

    def series(self, values, angle):
        """The trigonometric interpolant of values at equal distances."""
        n = len(values)
        half = 0.5 * (np.asarray(angle)[:, None] - self.angles)
        with np.errstate(all="ignore"):
            weights = (-1.0) ** np.arange(n) / (np.tan(half) if n % 2 == 0 else np.sin(half))
            curve = (weights * values).sum(1) / weights.sum(1)
        nearest = np.argmin(np.abs(np.sin(half)), axis=1)
        is_node = np.abs(np.sin(half[np.arange(len(half)), nearest])) < 1e-15
        return np.where(is_node, values[nearest], curve)

    def derivative(self):
        """The slopes of the trigonometric interpolant at the angles."""
        n = len(self.inertia)
        spectrum = 1j * np.fft.fftfreq(n, 1.0 / n) * np.fft.fft(self.inertia)
        if n % 2 == 0:
            spectrum[n // 2] = 0.0
        return np.fft.ifft(spectrum).real

    def hermite(self, angle):
        middle = 0.5 * (self.angles[0] + self.angles[-1])
        angle = angle - 2 * np.pi * np.round((angle - middle) / (2 * np.pi))
        k = np.clip(np.searchsorted(self.angles, angle, side="right") - 1, 0, len(self.angles) - 2)
        h = self.angles[k + 1] - self.angles[k]
        u = (angle - self.angles[k]) / h
        f, g, v = self.inertia[k], self.inertia[k + 1], 1.0 - u
        df, dg = 2.0 * h * self.half_slope[k], 2.0 * h * self.half_slope[k + 1]
        value = f * v * v * (1 + 2 * u) + g * u * u * (3 - 2 * u) + df * u * v * v - dg * u * u * v
        slope = 6 * u * v * (g - f) + df * v * (1 - 3 * u) - dg * u * (2 - 3 * u)
        return value, 0.5 * slope / h

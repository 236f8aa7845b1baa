"""Formulation 2, free motion of one freedom: the energy integral t = integral of sqrt(m / (2 (E - V))) dq, by quadrature.

m is the sum of w v^2 at unit speed, without accelerations or multipliers; E - V is the start's energy and the work of
the loads, written by hand here.
"""

from mpmath import calculus, mp, mpf, pi, sqrt

from joints import distance


def unit_energy(machine, q):
    """m(q), kg m2 or kg: twice the kinetic energy at unit speed."""
    return sum(w * v * v for w, v in zip(machine.weights(), machine.velocities(machine.move([q]), [mpf(1)])))


def turn(machine, digits):
    """m at equidistant positions of a turn, as many as the mean of sqrt(m) needs for its digits."""
    count, m, last = 64, [], None
    while True:
        m = [m[k // 2] if m and k % 2 == 0 else unit_energy(machine, 2 * pi * k / count) for k in range(count)]
        mean = sum(sqrt(v) for v in m) / count
        if last and abs(mean - last) < mean * mpf(10) ** -digits:
            return m
        last, count = mean, 2 * count


def period(m, m0, speed):
    """Of the motion without loads from a position with m0, s; the periodic trapezoidal rule converges exponentially."""
    return 2 * pi * sum(sqrt(v / m0) for v in m) / len(m) / speed


def crank_inertia(m, m0, present, goal):
    """The crank's inertia for which the period of the motion at 1 rad/s is the goal, by the secant method."""
    excess = lambda i: period([v + i - present for v in m], m0 + i - present, 1) - goal
    return mp.findroot(excess, (present, present + mpf("0.001")), tol=mpf(10) ** (-2 * mp.dps + 10))


class Squeezer:
    """Andrews' mechanism from rest under its motor (0.033 N m) and its spring."""

    def __init__(self, machine, start):
        self.machine, self.start = machine, start
        self.stored0 = self.stored(start)

    def stored(self, q):
        s = self.machine.scene
        spring = s.loads["spring"]
        length = distance(s, self.machine.bodies(self.machine.move([q])), spring["spring"])
        return mpf(spring["stiffness"]) * (length - mpf(spring["free-length"]) * s.length) ** 2 / 2

    def speed(self, q):
        work = mpf(self.machine.scene.loads["motor"]["magnitude"]) * (q - self.start) - self.stored(q) + self.stored0
        return sqrt(2 * work / unit_energy(self.machine, q))

    def time(self, s0, s1, rule):
        """From start + s0^2 to start + s1^2, s: the square removes the root's singularity at rest."""
        half, middle = (s1 - s0) / 2, (s0 + s1) / 2
        return sum(w * half * 2 * s / self.speed(self.start + s * s) for p, w in rule for s in [middle + half * p])

    def at(self, t, near, panels):
        """The coordinate and its velocity at t; `near` is where the search begins."""
        rule = sorted(calculus.quadrature.GaussLegendre(mp).calc_nodes(4, mp.prec))  # 24 points
        last = sqrt(near - self.start)
        passed = sum(self.time(last * k / panels, last * (k + 1) / panels, rule) for k in range(panels))
        while True:
            q = self.start + last * last
            speed = self.speed(q)
            step = (t - passed) * speed / (2 * last)
            if abs(step) < mpf(10) ** -28:
                return q, speed
            passed += self.time(last, last + step, rule)
            last += step

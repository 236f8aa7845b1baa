"""Formulation 3, by hand: pendulums by Jacobi's elliptic functions, and the double pendulum by extrapolation."""

from mpmath import asin, cos, ellipfun, ellipk, mpf, pi, sin, sqrt


def gravity():
    """9.81 m/s2 in the precision of the moment."""
    return mpf(981) / 100

def a01(t):
    """Problem A01: a point of 1 kg on 1 m from rest at (-1, 0). x, y, their velocities, tension, angle, its velocity."""
    w, half = sqrt(gravity()), mpf(1) / 2  # amplitude 90 degrees: the parameter k^2 is sin^2(45 degrees)
    sn, cn, dn = (ellipfun(f, w * t + ellipk(half), m=half) for f in ("sn", "cn", "dn"))
    swing = -2 * asin(sqrt(half) * sn)  # from straight down, -90 degrees at first
    rate = -2 * sqrt(half) * w * cn
    x, y = sin(swing), -cos(swing)
    return x, y, rate * cos(swing), rate * sin(swing), rate ** 2 + gravity() * cos(swing), swing + 3 * pi / 2, rate


def a01_period():
    return 4 * ellipk(mpf(1) / 2) / sqrt(gravity())


def a02(t):
    """Problem A02, two windows: 3 phi'' + 3.5 g cos(phi) = 0 from phi = 90 degrees at -1 rad/s. phi, its velocity."""
    w2 = mpf("3.5") * gravity() / 3
    fastest = sqrt(1 + 4 * w2)  # at the bottom
    k2 = 4 * w2 / fastest ** 2
    u = ellipk(k2) + fastest * t / 2
    psi = 2 * (pi - asin(ellipfun("sn", u, m=k2)))  # from straight down
    return pi / 2 - (psi - pi), -fastest * ellipfun("dn", u, m=k2)


def double(bodies, length, centres, start, t_end, steps):
    """p, q and their velocities of the double pendulum at t_end, by extrapolation of the midpoint rule (Gragg).

    Angles are absolute, from the x axis:
    (I1 + m1 c1^2 + m2 L^2) p'' + m2 L c2 cos(p - q) q'' + m2 L c2 sin(p - q) q'^2 + (m1 c1 + m2 L) g cos p = 0
    (I2 + m2 c2^2) q'' + m2 L c2 cos(p - q) p'' - m2 L c2 sin(p - q) p'^2 + m2 c2 g cos q = 0
    """
    (m1, i1), (m2, i2) = bodies
    c1, c2, g0 = *centres, gravity()
    a, b, c = i1 + m1 * c1 ** 2 + m2 * length ** 2, i2 + m2 * c2 ** 2, m2 * length * c2

    def rate(y):
        p, q, u, v = y
        s, k = c * sin(p - q), c * cos(p - q)
        f = -s * v * v - (m1 * c1 + m2 * length) * g0 * cos(p)
        g = s * u * u - m2 * c2 * g0 * cos(q)
        det = a * b - k * k
        return u, v, (b * f - k * g) / det, (a * g - k * f) / det

    def shift(y, h, d):
        return [v + h * w for v, w in zip(y, d)]

    def midpoint(y, h, n):
        h = h / n
        before, now = y, shift(y, h, rate(y))
        for _ in range(n - 1):
            before, now = now, shift(before, 2 * h, rate(now))
        return [(r + s + h * w) / 2 for r, s, w in zip(before, now, rate(now))]

    y, h = list(start), t_end / steps
    counts = [2 * k for k in range(1, 16)]
    for _ in range(steps):
        rows = []
        for k, n in enumerate(counts):
            row = [midpoint(y, h, n)]
            for j in range(1, k + 1):
                ratio = (mpf(n) / counts[k - j]) ** 2 - 1
                row.append([s + (s - r) / ratio for s, r in zip(row[-1], rows[-1][j - 1])])
            rows.append(row)
        y = rows[-1][-1]
    return y

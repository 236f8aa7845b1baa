"""The mechanism of docs/theory.md by its equations (1) to (17), with 50 digits, from the standard library alone.

Derivatives are central differences: with 50 digits, steps of 1e-13 leave more than twenty of them.
"""

from decimal import Decimal as D
from decimal import getcontext

getcontext().prec = 60
STEP = D("1e-13")
R, L1, L = D("0.1"), D("0.25"), D("0.5")
O, Q = (D("0.2"), D(0)), (D("-0.2"), D("0.4"))
I_A, M_C, M_O, M_G, M_S = D("0.626"), D("1.5"), D("0.75"), D("2.1"), D("0.5")
I_C, I_O, I_Q = M_C * L**2 / 12, M_O * L1**2 / 3, M_G * D("0.49") / 3
GRAVITY = D("9.81")


def sine_cosine(x):
    """Sine and cosine, by their series."""
    sine, cosine, term, n = D(0), D(0), D(1), 0
    while abs(term) > D("1e-58") or n < 4:
        if n % 2:
            sine += term if n % 4 == 1 else -term
        else:
            cosine += term if n % 4 == 0 else -term
        n += 1
        term *= x / n
    return sine, cosine


def arc_tangent(y, x):
    """The angle of (x, y), by Newton's method from the value in double precision."""
    from math import atan2

    angle = D(atan2(float(y), float(x)))
    length = (x * x + y * y).sqrt()
    for _ in range(3):
        sine, cosine = sine_cosine(angle)
        angle += (y * cosine - x * sine) / length
    return angle


PI = 4 * arc_tangent(D(1), D(1))


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1]


def combine(a, u, b, v):
    return a * u[0] + b * v[0], a * u[1] + b * v[1]


def left(u):
    """The vector turned by +90 degrees."""
    return -u[1], u[0]


def derivative(f, x):
    """The derivative of a function whose value is a number or a pair."""
    a, b = f(x + STEP), f(x - STEP)
    if isinstance(a, tuple):
        return tuple((p - q) / (2 * STEP) for p, q in zip(a, b))
    return (a - b) / (2 * STEP)


class Position:
    """The positions of section 2."""

    def __init__(self, phi):
        sine, cosine = sine_cosine(phi)
        self.e_phi = (cosine, sine)
        self.b = (R * cosine, R * sine)
        self.d = combine(1, O, -1, self.b)
        self.square = dot(self.d, self.d)
        self.f = D("0.5")
        self.h = (L1**2 / self.square - self.f**2).sqrt()
        self.c = combine(1, self.b, 1, combine(self.f, self.d, self.h, left(self.d)))
        self.e_beta = combine(1 / L1, self.c, -1 / L1, self.b)
        self.e_gamma = combine(1 / L1, self.c, -1 / L1, O)
        self.p = combine(1, self.b, L, self.e_beta)
        self.w = combine(1, self.p, -1, Q)
        self.s = dot(self.w, self.w).sqrt()
        self.e_theta = (self.w[0] / self.s, self.w[1] / self.s)
        self.delta = dot(left(self.e_beta), self.e_gamma)

    def angle(self, name):
        x, y = getattr(self, f"e_{name}")
        return arc_tangent(y, x)


class Rates:
    """The velocities and accelerations of section 3 for given rates of the crank; ratios by (5) to (7)."""

    def __init__(self, position, v, a):
        p = position
        self.position, self.v, self.a = p, v, a
        n_phi = left(p.e_phi)
        self.b1 = (R * v * n_phi[0], R * v * n_phi[1])
        self.b2 = combine(R * a, n_phi, -R * v * v, p.e_phi)
        self.beta1 = -dot(self.b1, p.e_gamma) / (L1 * p.delta)
        self.gamma1 = -dot(self.b1, p.e_beta) / (L1 * p.delta)
        centripetal = combine(L1 * self.beta1**2, p.e_beta, -L1 * self.gamma1**2, p.e_gamma)
        self.g = combine(-1, self.b2, 1, centripetal)
        self.beta2 = dot(self.g, p.e_gamma) / (L1 * p.delta)
        self.gamma2 = dot(self.g, p.e_beta) / (L1 * p.delta)
        n_beta, n_gamma, n_theta = left(p.e_beta), left(p.e_gamma), left(p.e_theta)
        self.c1 = (L1 * self.gamma1 * n_gamma[0], L1 * self.gamma1 * n_gamma[1])
        self.c2 = combine(L1 * self.gamma2, n_gamma, -L1 * self.gamma1**2, p.e_gamma)
        self.p1 = combine(1, self.b1, L * self.beta1, n_beta)
        self.p2 = combine(1, self.b2, 1, combine(L * self.beta2, n_beta, -L * self.beta1**2, p.e_beta))
        self.theta1 = dot(n_theta, self.p1) / p.s
        self.s1 = dot(p.e_theta, self.p1)
        self.theta2 = (dot(n_theta, self.p2) - 2 * self.s1 * self.theta1) / p.s


class Forces:
    """The forces of section 4."""

    def __init__(self, rates):
        p = rates.position
        self.n = -I_Q * rates.theta2 / p.s
        self.r_p = combine(M_S, rates.p2, -self.n, left(p.e_theta))
        self.y_gamma = I_O * rates.gamma2 / L1
        inner = combine(L1 * M_C, rates.c2, L, self.r_p)
        self.y_beta = -(I_C * rates.beta2 + dot(left(p.e_beta), inner)) / L1
        self.r_c = combine(self.y_beta / p.delta, p.e_gamma, -self.y_gamma / p.delta, p.e_beta)
        self.r_b = combine(M_C, rates.c2, 1, combine(1, self.r_c, 1, self.r_p))
        self.tau = I_A * rates.a + R * dot(left(p.e_phi), self.r_b)
        self.r_o = combine(M_O / 2, rates.c2, -1, self.r_c)
        arm = D("0.35")
        a_g = combine(arm * rates.theta2, left(p.e_theta), -arm * rates.theta1**2, p.e_theta)
        self.r_q = combine(M_G, a_g, self.n, left(p.e_theta))


def run(phi, v, a):
    """Position, rates and forces."""
    position = Position(phi)
    rates = Rates(position, D(v), D(a))
    return position, rates, Forces(rates)


def energy_parts(phi):
    """2 E_c at unit velocity: crank, coupler (two), rocker, slider, guide; from velocities only."""
    _, r, _ = run(phi, 1, 0)
    return [I_A, M_C * dot(r.c1, r.c1), I_C * r.beta1**2, I_O * r.gamma1**2, M_S * dot(r.p1, r.p1), I_Q * r.theta1**2]


def inertia(phi):
    return sum(energy_parts(phi))


def potential(phi):
    p = Position(phi)
    heights = M_C * p.c[1] + M_O * p.c[1] / 2 + M_S * p.p[1]
    return GRAVITY * (heights + M_G * (Q[1] + D("0.35") * p.e_theta[1]))


def period(n, energy, crank=I_A):
    """T_n of (17). The mechanism is not symmetric, so the sum has all nodes."""
    nodes = (inertia(2 * PI * j / n) - I_A + crank for j in range(n))
    return 2 * PI / n * sum((m / (2 * energy)).sqrt() for m in nodes)

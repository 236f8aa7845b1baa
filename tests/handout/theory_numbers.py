"""Computes every number of five or more digits in docs/theory.md, and fails if a printed number differs from all computed ones.

    python3 tests/handout/theory_numbers.py

`mechanism.py` computes sections 1 to 9 and 12, this file section 13; the reference values are read from the file of the case. Section 10 is about
other programs, and section 11 has no such number.
"""

import re
import sys
import tomllib
from decimal import Decimal as D
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import mechanism as m  # noqa: E402

ROOT = Path(__file__).parents[2]
ONE, TWO = D(1), D(2)


def flat(*values):
    """All numbers of nested tuples and lists."""
    for value in values:
        if isinstance(value, (tuple, list)):
            yield from flat(*value)
        else:
            yield D(value)


def of_runs():
    """The numbers of sections 2 to 4, and of section 8: run 1 at 1 + ε, whose second part is the derivative."""
    p = m.Position(ONE)
    yield from flat(p.b, p.d, p.square, p.h, p.c, p.e_beta, p.e_gamma, p.p, p.w, p.s, p.e_theta, p.delta)
    yield from flat([p.angle(name) for name in ("beta", "gamma", "theta")])
    for v, a in ((1, 0), (0, 1)):
        _, r, f = m.run(ONE, v, a)
        yield from flat(r.b1, r.beta1, r.gamma1, r.c1, r.p1, r.theta1, r.s1, r.b2, r.g, r.beta2, r.gamma2, r.c2, r.p2, r.theta2)
        yield from flat(f.n, f.r_p, f.y_gamma, f.y_beta, f.r_c, f.r_b, f.tau, f.r_o, f.r_q)
    for part in (
        lambda x: m.Position(x).square,
        lambda x: m.Position(x).h,
        lambda x: m.Position(x).c,
        lambda x: m.run(x, 1, 0)[1].theta2,
        lambda x: m.run(x, 1, 0)[2].n,
        half_slope,
    ):
        yield from flat(m.derivative(part, ONE))


def half_slope(phi):
    """½m′, which is the actuator's moment in run 1."""
    return m.run(phi, 1, 0)[2].tau


def coefficients(phi):
    """m, ½m′, and a and b of the force in the slide."""
    one, two = m.run(phi, 1, 0)[2], m.run(phi, 0, 1)[2]
    return two.tau, one.tau, two.n, one.n


def released(phi):
    """m12,1 and ½m1,2 of the slide, by (14)."""
    p, r, f = m.run(phi, 1, 0)
    half = m.I_Q * r.theta1 * r.s1 / p.s**2
    return f.n + half, half


def run_two(phi):
    """Moment and force of the paper's run ii, and m_e1 as printed, with q̇² = 2q."""
    inertia, half, a, b = coefficients(phi)
    square = 2 * phi
    slope, cross = released(phi)
    moment, force = inertia + half * square, a + b * square
    literal = force - (slope - cross * square)
    return moment, force, literal, slope - cross * square


def of_meaning():
    """The numbers of section 5."""
    inertia, half, a, b = coefficients(ONE)
    yield from flat(run_two(ONE), released(ONE), a - released(ONE)[0])
    _, r1, f1 = m.run(ONE, 1, 0)
    _, _, f2 = m.run(ONE, 0, 1)
    yield from flat(inertia, half, a, b, f1.r_b, f2.r_b, f1.r_c, f2.r_c)


def free_motion(phi):
    """φ̇, φ̈ and the two parts of N in the motion from φ = 0."""
    inertia, half, a, b = coefficients(phi)
    velocity = (m.inertia(D(0)) / inertia).sqrt()
    acceleration = -half * velocity**2 / inertia
    return velocity, acceleration, a * acceleration, b * velocity**2


def of_motion():
    """The numbers of section 6, and the Jacobian of section 8."""
    velocity, acceleration, first, second = free_motion(ONE)
    start = m.inertia(D(0))
    yield from flat(start, start / 2, velocity, acceleration, first, second, first + second)
    inertia, half, a, b = coefficients(ONE)
    curvature = m.derivative(half_slope, ONE)
    yield from flat(2 * curvature, (-curvature * velocity**2 - 2 * half * acceleration) / inertia, -2 * half * velocity / inertia)
    weight = -m.derivative(m.potential, ONE)
    p = m.Position(ONE)
    c = -D("0.35") * m.M_G * m.GRAVITY * p.e_theta[0] / p.s
    energy = start / 2 + m.potential(D(0))
    square = 2 * (energy - m.potential(ONE)) / inertia
    acceleration = (weight - half * square) / inertia
    force = a * acceleration + b * square + c
    yield from flat(m.potential(D(0)), m.potential(ONE), energy, square.sqrt(), weight, c, acceleration)
    yield from flat(a * acceleration, b * square, force)


def of_period(text):
    """The numbers of section 7. The errors of its table are compared here, because they have only two digits."""
    half = m.inertia(D(0)) / 2
    exact = m.period(160, half)
    yield exact
    for n, printed, mantissa, exponent in re.findall(r"\| (\d+) \| ([\d.]+) \| ([−\d.]+)·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+) \|", text):
        value = m.period(int(n), half)
        yield value
        power = int(exponent.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")))
        error = (value - exact) / D(10) ** power
        if abs(error - D(mantissa.replace("−", "-"))) > D("0.0501"):
            raise SystemExit(f"docs/theory.md: T_n - T at n = {n} is {value - exact:.3e}, not {mantissa}·10^{power}")
    # The inertia of the crank for 5.42 s: the start is at 1 rad/s, whatever the crank is.
    crank, step = m.I_A, D("1e-12")
    for _ in range(4):
        at = [m.period(96, half - (m.I_A - x) / 2, x) - D("5.42") for x in (crank, crank + step)]
        crank -= at[0] * step / (at[1] - at[0])
    yield crank


def of_checks():
    """The numbers of section 9."""
    inertia, half, _, _ = coefficients(ONE)
    p, r, f = m.run(ONE, 1, 0)
    yield from flat(m.energy_parts(ONE), inertia - m.I_A)
    guide, slider = m.I_Q * r.theta1 * r.theta2, m.M_S * m.dot(r.p1, r.p2)
    yield from flat(m.M_C * m.dot(r.c1, r.c2), m.I_C * r.beta1 * r.beta2, m.I_O * r.gamma1 * r.gamma2, slider, guide)
    slopes = [(m.inertia(1 + h) - m.inertia(1 - h)) / (4 * h) for h in (D("0.01"), D("0.005"))]
    yield from flat(slopes, (4 * slopes[1] - slopes[0]) / 3)
    yield from flat([sum(forces) for forces in zip(f.r_b, f.r_o, f.r_q)])
    moment = lambda at, force: at[0] * force[1] - at[1] * force[0]  # noqa: E731
    yield f.tau + moment(m.O, f.r_o) + moment(m.Q, f.r_q)


def of_exercises():
    """The numbers of section 12."""
    inertia, half, a, b = coefficients(ONE)
    at_two = coefficients(TWO)
    velocity, acceleration, first, second = free_motion(TWO)
    yield from flat(at_two, velocity, acceleration, first + second, run_two(TWO))
    acceleration = (D("0.1") - half) / inertia
    yield from flat(acceleration, a * acceleration + b)
    for guess in ("0.9744", "0.0150"):
        phi = D(guess)
        for _ in range(6):
            phi -= half_slope(phi) / m.derivative(half_slope, phi)
        yield from flat(phi, free_motion(phi)[0])
    yield from flat(2 * inertia, 2 * sum(free_motion(ONE)[2:]))


def of_hooke_joint():
    """The numbers of section 13: β = 30°, q = 60°."""
    half, root = D("0.5"), D(3).sqrt() / 2
    sin_b, cos_b, sin_q, cos_q = half, root, root, half
    one, two = D("0.02"), D("0.03")
    square = 1 - sin_b**2 * cos_q**2
    ratio, slope = cos_b / square, -cos_b * sin_b**2 * 2 * sin_q * cos_q / square**2
    u, e = (D(0), cos_q, sin_q), (cos_b, sin_b, D(0))
    along = sum(x * y for x, y in zip(e, u))
    normal = [x - along * y for x, y in zip(e, u)]
    couples = [[two * acceleration / square * k for k in normal] for acceleration in (ratio, slope)]
    turning = sum(x * y for x, y in zip(e, couples[0]))
    bending = (sum(x * x for x in couples[0]) - turning**2).sqrt()
    yield from flat(square, ratio, slope, one + two * ratio**2, two * ratio * slope, normal, couples, turning, bending)


def of_reference():
    """The reference values of the case at φ = 1."""
    case = tomllib.loads((ROOT / "validation/single-dwell/case.toml").read_text(encoding="utf-8"))
    sample = next(s for s in case["samples"] if D(s["q"]) == 1)
    yield from flat(sample["m"], sample["half_dm"])
    for reaction in sample["reactions"].values():
        yield from flat(reaction["a"], reaction["b"])


def is_value_of(printed, values):
    """Whether one of the values equals the printed number, rounded or truncated in its last digit."""
    unit = D(1).scaleb(printed.as_tuple().exponent)
    return any(abs(printed - value) <= unit * D("0.51") for value in values)


def main():
    text = (ROOT / "docs/theory.md").read_text(encoding="utf-8")
    checked = text.split("## 10. ")[0] + "## 12. " + text.split("## 12. ")[1].split("## References")[0]
    values = list(of_runs()) + list(of_meaning()) + list(of_motion()) + list(of_period(text)) + list(of_checks())
    values += list(of_exercises()) + list(of_hooke_joint()) + list(of_reference())
    values += [-value for value in values]
    # Data of section 1, and what the text says about the complex zero of m, which another program found.
    given = [m.I_C, m.I_O, D("0.00390625"), D("5.9297")]
    tokens = re.findall(r"(?<![\d.])[−-]?\d+\.\d+", checked)
    wrong, count = [], 0
    for token in tokens:
        printed = D(token.replace("−", "-"))
        if len(printed.as_tuple().digits) < 5:
            continue
        count += 1
        if not is_value_of(printed, values + given):
            wrong.append(token)
    if wrong:
        raise SystemExit("docs/theory.md prints what no formula gives: " + ", ".join(wrong))
    if count < 150:
        raise SystemExit(f"only {count} numbers were found in docs/theory.md")
    print(f"{count} numbers of docs/theory.md are those that its formulas give")


if __name__ == "__main__":
    main()

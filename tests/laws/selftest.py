#!/usr/bin/env python3
"""The independent program of the laws against closed forms, against itself at other orders, and against a second program: steps of
1e-3 s of the classical Runge–Kutta method, with the decisions that the values say, and bisection where one of them changes.

    python3 tests/laws/selftest.py 200 1      # 200 laws of seed 1; status 1 where two disagree
"""
import math
import random
import sys

import draw
import motion
import run
from draw import bell, binary, call, conditional, minus, number, plus, times
from motion import Law
from series import numeric

STEP = 1e-3
T, X, V = (draw.Term(name, Law("var", (), i)) for i, name in enumerate(("t", "x", "x.velocity")))


def closed_forms():
    """Name, law, start, duration, and the last position and speed (None: not said)."""
    half, one, ten, nothing = number(0.5), number(1), number(10), number(0)
    stops = math.sqrt(11)
    reach = (stops - 1) / 10
    after = 0.5 + stops * (2 - reach)
    force_of_pulse = 1000 * 2e-4 * math.sqrt(math.log(2))
    yield "step on its threshold", conditional("<", call("step", minus(X, half)), one, ten, nothing), (0, 1), 2, (after, stops)
    yield "if in if", conditional(">", conditional("<", X, half, one, nothing), nothing, ten, nothing), (0, 1), 2, (after, stops)
    yield "sign of if", times(ten, call("sign", conditional("<", X, half, one, nothing))), (0, 1), 2, (after, stops)
    yield "floor", conditional("<", call("floor", times(number(2), X)), one, ten, nothing), (0, 1), 2, (after, stops)
    yield "sign of max", times(number(5000), call("sign", call("max", nothing, minus(half, X)))), (0, 1), 2, (None, math.sqrt(5001))
    yield "step in time", conditional("<", call("step", minus(T, one)), one, ten, nothing), (0, 1), 2, (17, 11)
    yield "zero", call("max", nothing, times(nothing, T)), (0, 1), 2, (2, 1)
    window = conditional(">", bell(X, half, 1e-4), half, number(1000), nothing)
    yield "narrow window", window, (0, 1), 2, (None, math.sqrt(1 + 2 * force_of_pulse))
    tau = binary("/", "div", X, number(math.tau))
    speed = math.sqrt(8 * math.tau)
    yield "first turn", conditional("<", call("floor", tau), one, number(4), nothing), (0, 0), 8, (math.tau + speed * (8 - speed / 4), speed)
    yield "oscillator", times(number(-1), X), (0, 1), 10, (math.sin(10), math.cos(10))
    pull = plus(times(number(-0.5), call("sign", V)), times(number(0.25), T))
    # The mass rests until the pull equals the friction: v = (t − 2)²/8.
    yield "rest and release", pull, (0, 0), 5, (27 / 24, 9 / 8)
    surface = times(number(-5), call("sign", plus(V, times(number(2), X))))
    # v + 2x = 0 with v = 1 − 5t and x = t − 2.5t².
    t1 = (math.sqrt(9 + 20) - 3) / 10
    x1 = t1 - 2.5 * t1 * t1
    yield "sliding surface", surface, (0, 1), 3, (x1 * math.exp(-2 * (3 - t1)), -2 * x1 * math.exp(-2 * (3 - t1)))
    moving = times(number(-5), call("sign", minus(V, call("sin", T))))
    yield "moving surface", moving, (0, 0), 3, (1 - math.cos(3), math.sin(3))
    # sin(6v) touches −1, and is never below it: ẍ = −1 − x.
    touches = minus(call("floor", call("sin", times(number(6), V))), X)
    s, c = math.sin(0.45), math.cos(0.45)
    yield "touched threshold", touches, (0, -0.015), 0.45, (c - 0.015 * s - 1, -s - 0.015 * c)
    # x³ has a threefold root: ẍ = −1 − x up to x = 0, then 1 − x.
    cubed = minus(call("sign", times(X, times(X, X))), X)
    reach = math.hypot(0.5, 2)
    last, rest = math.sqrt(reach * reach - 1), 2 - math.atan2(2, 0.5) + math.acos(1 / reach)
    s, c = math.sin(rest), math.cos(rest)
    yield "threefold root", cubed, (-0.5, 2), 2, (1 - c + last * s, s + last * c)
    pulse = bell(X, half, 1e-3)
    area = math.sqrt(math.pi) * 1e-3
    yield "narrow pulse", times(number(500), pulse), (0, 1), 2, (None, math.sqrt(1 + 1000 * area))


class Gives(Exception):
    """The second program has no answer."""


def value(law, point, decisions, memo):
    """The value of a law. `decisions` collects the decisions, or contains them if they are held."""
    if law in memo:
        return memo[law]
    if law.op == "num":
        result = law.number
    elif law.op == "var":
        result = point[law.number]
    elif law.op in ("if", "floor"):
        argument = value(law.args[0], point, decisions, memo)
        taken = math.floor(argument) if law.op == "floor" else motion.holds(law.number, argument)
        taken = decisions.setdefault(law, taken)
        result = float(taken) if law.op == "floor" else value(law.args[1 if taken else 2], point, decisions, memo)
    else:
        result = numeric(law.op, [value(a, point, decisions, memo) for a in law.args])
    memo[law] = result
    return result


def second_program(laws, start, end):
    """The last state by the classical Runge–Kutta method with bisection of the instants at which a decision changes."""
    n, now, state, changes = len(laws), 0.0, list(start), 0

    def rates(point, decisions):
        memo = {}
        return [*point[1 + n :], *[value(law, point, decisions, memo) for law in laws]]

    def stepped(h, decisions):
        def shifted(k, part):
            return [now + part * h, *[x + part * h * r for x, r in zip(state, k)]]

        k1 = rates([now, *state], decisions)
        k2 = rates(shifted(k1, 0.5), decisions)
        k3 = rates(shifted(k2, 0.5), decisions)
        k4 = rates(shifted(k3, 1.0), decisions)
        return [x + h / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(state, k1, k2, k3, k4)]

    def taken(t, y):
        decisions = {}
        rates([t, *y], decisions)
        return decisions

    def agrees(h, decisions):
        after = taken(now + h, stepped(h, dict(decisions)))
        return all(after.get(law, choice) == choice for law, choice in decisions.items())

    decisions = taken(now, state)
    while now < end - 1e-12:
        h = min(STEP, end - now)
        if not agrees(h, decisions):
            low, high = 0.0, h
            while high - low > 1e-14:
                middle = 0.5 * (low + high)
                low, high = (middle, high) if agrees(middle, decisions) else (low, middle)
            changes += 1
            if changes > 400:
                raise Gives
            h = max(high, 1e-13)
            state = stepped(h, dict(decisions))
            now += h
            # The decisions by the values a little later.
            decisions = taken(now + 1e-11, stepped(1e-11, taken(now, state)))
            continue
        held = dict(decisions)
        state = stepped(h, held)
        now += h
        decisions = held
        if max(map(abs, state)) > motion.LARGEST:
            raise Gives
    return state


def main():
    count, seed = int(sys.argv[1]), int(sys.argv[2])
    failed = 0
    for name, law, start, end, right in closed_forms():
        found = motion.Motion([law.law], list(map(float, start))).run(float(end))
        if any(want is not None and abs(have - want) > 1e-11 * max(1.0, abs(want)) for have, want in zip(found, right)):
            print(f"{name}: {found}, right {right}")
            failed += 1
    compared, skipped, other_orders, worst = 0, 0, 0.0, 0.0
    for k in range(count):
        rng = random.Random(f"laws/{seed}/{k}")
        draw.WIDTHS, widths = (0.3, 0.1), draw.WIDTHS
        scene = draw.Scene(rng)
        draw.WIDTHS = widths
        try:
            found = run.reference(scene)
            other = run.reference(scene, order=20, tolerance=1e-15)
            if found.is_close or found.slides:
                raise Gives
            second = second_program(scene.laws, scene.start, draw.DURATION)
        except (motion.Unjudged, Gives):
            skipped += 1
            continue
        compared += 1
        gaps = [run.difference(values, found.point[1:], found.largest) for values in (other.point[1:], second)]
        other_orders, worst = max(other_orders, gaps[0]), max(worst, gaps[1])
        if gaps[0] > 1e-10 or gaps[1] > 1e-8:
            print(f"law {seed}/{k}: other order {gaps[0]:.1e}, second program {gaps[1]:.1e}: {second}, {found.point[1:]}\n{scene.text}")
            failed += 1
    print(f"{compared} laws compared, {skipped} not: other orders differ by {other_orders:.1e}, the second program by {worst:.1e}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

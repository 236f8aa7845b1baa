"""The motion of unit inertias under nested laws. This independent program shares nothing with Dwell.

A law is a tree of `Law`s. Where all of its decisions are taken it is a smooth expression; Taylor series with enclosed remainders
carry the motion to the next place where a decision may change, and no window between is missed, however narrow. There each
decision is taken anew: what is not on its threshold by its value, what is by the motion that follows from it (the first
coefficient of its argument that is not zero; if all are zero, the comparison's value at equality). Where no choice agrees with
the motion that follows, the motion slides along the threshold (A. F. Filippov, Differential Equations with Discontinuous
Righthand Sides, 1988). Where several agree, the motion is not unique and `NotUnique` is raised.
"""
import itertools
import math

from series import Algebra, Unbounded, bisected, depends_on, enclosures, first_root, horner, in_order, least, numbers, ranges, value_and_size

ORDER = 14
# An argument below this fraction of its terms is on its threshold.
ON = 1e-11
# A deciding coefficient below this multiple of that fraction is too small to decide.
CLOSE = 1e4
# An argument this near to its threshold, as a fraction of its terms, may touch it.
TOUCHES = 1e-4
# The number of coefficients that may decide.
DECIDING = 6
MOST_EVENTS = 3000
# Largest number of steps, including rejected ones.
MOST_STEPS = 6000
# A motion beyond these limits is not compared.
LARGEST = 1e4


class Unjudged(Exception):
    """The motion has no reference value, for the stated reason."""


class NotUnique(Unjudged):
    pass


class Grows(Unjudged):
    pass


class Undecided(Exception):
    def __init__(self, law):
        self.law = law


class Law:
    """`op` is an operation of `series`, or `if` (the comparison of args[0] with 0, then two values), or `floor`."""

    __slots__ = ("op", "args", "number")

    def __init__(self, op, args=(), number=None):
        self.op, self.args, self.number = op, tuple(args), number


def holds(comparison, a):
    return {"<": a < 0, "<=": a <= 0, ">": a > 0, ">=": a >= 0}[comparison]


class Mode:
    """Decisions, the rates of the speeds, and the expressions that must keep their signs: expression → sign."""

    def __init__(self, choices, rates, signs):
        self.choices, self.rates, self.signs = choices, rates, signs


class Motion:
    """Coordinates with unit inertia: `laws` are their accelerations; `start` the coordinates, then the speeds."""

    def __init__(self, laws, start, order=ORDER, tolerance=1e-16):
        self.laws, self.freedoms = laws, len(laws)
        self.algebra = Algebra()
        self.point = [0.0, *start]
        self.order, self.tolerance = order, tolerance
        self.largest = [abs(x) for x in start]
        self.events, self.slides, self.steps = 0, 0, 0
        self.is_close = False
        self.speeds = range(1 + self.freedoms, 1 + 2 * self.freedoms)

    # --- laws with decisions taken

    def frozen(self, law, choices, memo):
        """The smooth expression of a law with the decisions `choices`."""
        if law in memo:
            return memo[law]
        f = self.algebra
        if law.op == "num":
            e = f.num(law.number)
        elif law.op == "var":
            e = f.var(law.number)
        elif law.op == "if":
            side = self.chosen(law, choices, memo)
            e = self.frozen(law.args[1 if holds(law.number, side) else 2], choices, memo)
        elif law.op == "floor":
            e = f.num(self.chosen(law, choices, memo))
        else:
            e = f.apply(law.op, *[self.frozen(a, choices, memo) for a in law.args])
        memo[law] = e
        return e

    def chosen(self, law, choices, memo):
        argument = self.frozen(law.args[0], choices, memo)
        if argument.op == "num":
            return math.floor(argument.number) if law.op == "floor" else argument.number
        if law not in choices:
            raise Undecided(law)
        return choices[law][0]

    def candidates(self, zero_too):
        """All choices that the values at the point allow: decisions → (choice, expression on its threshold or None, its sign)."""
        found, stack, memo_values = [], [{}], {}
        while stack:
            choices = stack.pop()
            memo = {}
            try:
                rates = [self.frozen(law, choices, memo) for law in self.laws]
                found.append(self.mode_of(choices, rates, memo))
            except Undecided as undecided:
                law = undecided.law
                argument = self.frozen(law.args[0], choices, memo)
                for choice in self.sides(law, argument, memo_values, zero_too):
                    stack.append({**choices, law: choice})
            if len(found) + len(stack) > 800:
                raise Unjudged("too many thresholds at a time")
        return found

    def sides(self, law, argument, memo, zero_too):
        value, size = value_and_size(argument, self.point, memo)
        if not math.isfinite(value):
            raise Unjudged("not a number")
        if law.op == "floor":
            below = round(value)
            if abs(value - below) > ON * size:
                return [(math.floor(value), None, 0)]
            margin = self.algebra.apply("sub", argument, self.algebra.num(below))
            choices = [(below, margin, 1), (below - 1, margin, -1)]
            return choices + [(below, margin, 0)] if zero_too else choices
        if abs(value) > ON * size:
            return [(math.copysign(1.0, value), None, 0)]
        choices = [(1.0, argument, 1), (-1.0, argument, -1)]
        known = self.sign_by_speeds(argument)
        if known:
            return [choices[0 if known > 0 else 1]]
        return choices + [(0.0, argument, 0)] if zero_too else choices

    def sign_by_speeds(self, argument):
        """The sign of the rate of an expression without speeds, if the rate is not zero."""
        if depends_on(argument, self.speeds):
            return 0
        rate, size = self.algebra.derivative(argument, 0), value_and_size(argument, self.point)[1]
        value = value_and_size(rate, self.point)[0]
        for i in range(self.freedoms):
            slope = self.algebra.derivative(argument, 1 + i)
            value += value_and_size(slope, self.point)[0] * self.point[1 + self.freedoms + i]
        if abs(value) > CLOSE * ON * size:
            return value
        return 0

    def mode_of(self, choices, rates, memo):
        signs, f = {}, self.algebra
        for law, (choice, _, _) in choices.items():
            argument = memo.get(law.args[0])
            if argument is None or argument.op == "num":
                continue
            if law.op == "floor":
                signs[f.apply("sub", argument, f.num(choice))] = 1
                signs[f.apply("sub", argument, f.num(choice + 1))] = -1
            elif choice:
                signs[argument] = choice
        return Mode(choices, rates, signs)

    # --- the mode that begins at a point

    def leading(self, coefficients, size):
        """The first coefficient that is nonzero beyond rounding, with its order; None if all are zero."""
        for k, c in enumerate(coefficients):
            if abs(c) > ON * size:
                if k > 0 and abs(c) < CLOSE * ON * size:
                    self.is_close = True
                return k, c
        return None

    def decide(self):
        """The only mode that is consistent with the motion that follows from it, or a sliding mode."""
        modes = {}
        for mode in self.candidates(True):
            if self.agrees(mode):
                modes.setdefault(tuple(mode.rates), mode)
        if len(modes) > 1:
            modes = self.distinct(modes)
        if len(modes) > 1:
            raise NotUnique("several motions begin here")
        if modes:
            mode = next(iter(modes.values()))
            # An argument that stays at zero is not watched.
            for _, argument, sign in mode.choices.values():
                if argument is not None and sign == 0:
                    mode.signs.pop(argument, None)
                    if any(part.op == "exp" for part in in_order([argument])):
                        raise Unjudged("an exponential that is zero by rounding decides")
            return mode
        return self.slide()

    def distinct(self, modes):
        """The modes with different series."""
        found = {}
        for key, mode in modes.items():
            variables, _ = numbers(mode.rates, [], self.point, self.freedoms, DECIDING)
            same = any(
                all(abs(p - q) <= 1e-9 * (1 + abs(p)) for a, b in zip(variables, other) for p, q in zip(a, b))
                for other, _ in found.values()
            )
            if not same:
                found[key] = (variables, mode)
        return {key: mode for key, (_, mode) in found.items()}

    def agrees(self, mode):
        watched = [(a, sign) for _, a, sign in mode.choices.values() if a is not None]
        if not watched:
            return True
        _, series = numbers(mode.rates, [a for a, _ in watched], self.point, self.freedoms, DECIDING)
        for argument, sign in watched:
            size = value_and_size(argument, self.point)[1]
            lead = self.leading(series[argument], size)
            if (0 if lead is None or lead[0] == 0 and len(series[argument]) < 2 else math.copysign(1, lead[1])) != sign:
                return False
        return True

    def slide(self):
        """The sliding mode between two modes that both lead back to their common threshold (Filippov)."""
        modes = self.candidates(False)
        if len(modes) > 64:
            raise Unjudged("too many thresholds at a time")
        found = {}
        for below, above in itertools.permutations(modes, 2):
            at_zero = [{a: s for _, a, s in m.choices.values() if a is not None} for m in (below, above)]
            for g in at_zero[0]:
                if at_zero[0][g] < 0 and at_zero[1].get(g, 0) > 0:
                    mode = self.sliding_mode(g, below, above, at_zero)
                    if mode:
                        found.setdefault(tuple(mode.rates), mode)
        found = self.distinct(found)
        if len(found) > 1:
            raise NotUnique("several motions slide here")
        if not found:
            raise Unjudged("two thresholds at a time")
        self.slides += 1
        return next(iter(found.values()))

    def rate_along(self, g, rates):
        f = self.algebra
        total = f.derivative(g, 0)
        for i in range(self.freedoms):
            total = f.apply("add", total, f.apply("mul", f.derivative(g, 1 + i), f.var(1 + self.freedoms + i)))
            total = f.apply("add", total, f.apply("mul", f.derivative(g, 1 + self.freedoms + i), rates[i]))
        return total

    def sliding_mode(self, g, below, above, at_zero):
        f = self.algebra
        up, down = self.rate_along(g, below.rates), self.rate_along(g, above.rates)
        size = value_and_size(g, self.point)[1]
        values = [value_and_size(e, self.point)[0] for e in (up, down)]
        if not (values[0] > ON * size and values[1] < -ON * size):
            return None
        part = f.apply("div", up, f.apply("sub", up, down))
        rates = []
        for lower, upper in zip(below.rates, above.rates):
            # In one coordinate the speed alone decides: v̇ = −(∂g/∂t + v ∂g/∂x) / (∂g/∂v).
            rates.append(f.apply("add", lower, f.apply("mul", part, f.apply("sub", upper, lower))))
        others = {**at_zero[0], **at_zero[1]}
        _, series = numbers(rates, list(others), self.point, self.freedoms, DECIDING)
        steps = [
            value_and_size(f.apply("sub", u, l), self.point)[0] for l, u in zip(below.rates, above.rates)
        ]

        def across(h):
            return sum(
                value_and_size(f.derivative(h, i), self.point)[0] * step for i, step in zip(self.speeds, steps)
            )

        signs = {}
        for h in others:
            if h is g:
                continue
            lead = self.leading(series[h], value_and_size(h, self.point)[1])
            for sides, end in zip(at_zero, (-1, 1)):
                if h not in sides:
                    continue
                if lead is None:
                    # It stays on its threshold, too: each side of g is a side of it.
                    if sides[h] * across(h) * across(g) * end <= 0:
                        return None
                elif math.copysign(1, lead[1]) != sides[h]:
                    return None
            if lead is not None:
                signs[h] = math.copysign(1, lead[1])
        signs[up], signs[down] = 1, -1
        for mode, sides in ((below, at_zero[0]), (above, at_zero[1])):
            for h, sign in mode.signs.items():
                if h not in others:
                    signs[h] = sign
        mode = Mode({}, rates, signs)
        mode.sliding = g
        return mode

    # --- steps

    def run(self, end):
        mode, h, crowd = self.decide(), end / 8, []
        while self.point[0] < end:
            taken, h, is_event = self.step(mode, min(h, end - self.point[0]))
            if self.point[0] + 1e-15 * end >= end:
                break
            if is_event:
                self.events += 1
                crowd = [*crowd[-40:], self.point[0]]
                if self.events > MOST_EVENTS or len(crowd) > 40 and crowd[-1] - crowd[0] < 1e-7 * end:
                    raise Unjudged("switches accumulate")
                mode = self.decide()
        return self.point[1:]

    def step(self, mode, h):
        """Takes a step: its length, the length of the next attempt, and whether an event ends the step."""
        signs = mode.signs
        variables, series = numbers(mode.rates, signs, self.point, self.freedoms, self.order)
        leads = {}
        for g, sign in signs.items():
            lead = self.leading(series[g], value_and_size(g, self.point)[1])
            if lead is None or math.copysign(1, lead[1]) != sign:
                if self.fresh == self.point[0]:
                    raise Unjudged("a decision changes where it was taken")
                self.fresh = self.point[0]
                return 0.0, h, True
            leads[g] = lead[0]
            # What leaves its threshold with the square of time is on it for 1e-8 s, where it is computed with 16 digits.
            self.is_close |= lead[0] > 1 and not depends_on(g, range(1, len(self.point)))
        grow = 2.0
        while True:
            self.steps += 1
            if self.steps > MOST_STEPS:
                raise Unjudged("too many steps")
            if h < 1e-15:
                raise Unjudged("a step without length")
            outcome = self.try_step(mode, h, variables, series, leads)
            if outcome is not None:
                break
            h, grow = 0.5 * h, 1.0
        root = outcome[0]
        length = h if root is None else root
        for i in range(1, len(self.point)):
            self.point[i] = horner(variables[i][: self.order + 1], length)
            self.largest[i - 1] = max(self.largest[i - 1], abs(self.point[i]))
        self.point[0] += length
        if max(map(abs, self.point)) > LARGEST or not all(map(math.isfinite, self.point)):
            raise Grows("grows beyond bounds")
        if root is not None:
            self.fresh = self.point[0]
        return length, max(grow * h, 1e-9), root is not None

    fresh = None

    def try_step(self, mode, h, variables, series, leads):
        """The first root within a step, or None, in a tuple; None alone where the step is too long."""
        n = self.order
        box, sizes = [(self.point[0], self.point[0] + h)], []
        for i in range(1, len(self.point)):
            terms = [c * h**k for k, c in enumerate(variables[i][: n + 1])]
            room = 1e-13 * (1 + abs(terms[0]))
            low = terms[0] + sum(min(0.0, c) for c in terms[1:]) - room
            high = terms[0] + sum(max(0.0, c) for c in terms[1:]) + room
            box.append((low, high))
            sizes.append(max(1.0, abs(low), abs(high)))
        try:
            enclosed, _ = enclosures(mode.rates, [], box, self.freedoms, n)
            bounds = ranges(leads, box)
            for i, size in enumerate(sizes):
                last = enclosed[1 + i]
                if (abs(last.mid[n + 1]) + last.rad[n + 1]) * h ** (n + 1) > self.tolerance * size:
                    return None
            doubtful = [g for g in leads if bounds[g][0] <= 0 <= bounds[g][1]]
            if doubtful:
                _, balls = enclosures(mode.rates, doubtful, box, self.freedoms, n + 1)
        except (Unbounded, OverflowError, ZeroDivisionError):
            return None
        first = None
        for g in doubtful:
            # That of a product is zero where both of its factors are.
            size = value_and_size(g, self.point)[1] or max(abs(c) * h**k for k, c in enumerate(series[g][: n + 1]))
            remainder = (abs(balls[g].mid[n + 1]) + balls[g].rad[n + 1]) * h ** (n + 1)
            if not remainder <= 1e-15 * size:
                return None
            deflated = series[g][leads[g] : n + 1]
            root = first_root(deflated, h, 1e-13 * size)
            # A threshold that is touched, to what its neighbours on a grid say of it.
            self.is_close |= leads[g] == 0 and least(deflated, h if root is None else root) < TOUCHES * size
            if root is not None and (first is None or root < first):
                first = self.polished(g, mode.signs[g], variables, root, h)
        return (first,)

    def polished(self, g, sign, variables, root, h):
        """A root by the expression itself: of a multiple one its Taylor polynomial only knows where it is below a rounding."""

        def is_before(at):
            point = [self.point[0] + at, *(horner(v[: self.order + 1], at) for v in variables[1:])]
            return value_and_size(g, point)[0] * sign > 0

        around = 1e-12 * h
        while around < 1e-2 * h:
            low, high = max(0.0, root - around), min(h, root + around)
            if is_before(low) and not is_before(high):
                return bisected(is_before, low, high)
            around *= 4
        return root

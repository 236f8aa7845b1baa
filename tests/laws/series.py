"""Smooth expressions of t, coordinates and speeds, and the Taylor series of the motions under them.

Expressions are interned: equal expressions are one object. A series is computed once in numbers and once in intervals
(midpoint and radius), whose last coefficient bounds what the numbers leave out (Moore, Interval Analysis, 1966; Nedialkov's
high-order enclosure). Rounding errors, of the order of 1e-16, are not enclosed; no decision here depends on them.
"""
import math
from operator import mul


class Expr:
    __slots__ = ("op", "args", "number", "order")

    def __init__(self, op, args, number, order):
        self.op, self.args, self.number, self.order = op, args, number, order


class Algebra:
    """Builds expressions; folds constants and empty sums. Variable 0 is t; coordinates follow, then their speeds."""

    def __init__(self):
        self.known = {}
        self.zero = self.num(0.0)
        self.derivatives = {}

    def make(self, op, args=(), number=None):
        key = (op, tuple(id(a) for a in args), number, math.copysign(1.0, number) if op == "num" else 0)
        if key not in self.known:
            self.known[key] = Expr(op, args, number, len(self.known))
        return self.known[key]

    def num(self, value):
        return self.make("num", (), float(value))

    def var(self, index):
        return self.make("var", (), index)

    def apply(self, op, *args):
        a, b = args[0], args[-1]
        if all(x.op == "num" for x in args):
            return self.num(numeric(op, [x.number for x in args]))
        if op == "add":
            if is_number(a, 0):
                return b
            if is_number(b, 0):
                return a
        elif op == "sub":
            if a is b:
                return self.zero
            if is_number(b, 0):
                return a
            if is_number(a, 0):
                return self.apply("neg", b)
        elif op == "mul":
            if is_number(a, 0) or is_number(b, 0):
                return self.zero
            if is_number(a, 1):
                return b
            if is_number(b, 1):
                return a
            if a is b:
                return self.make("sq", (a,))
        elif op == "div" and is_number(a, 0):
            return self.zero
        return self.make(op, args)

    def derivative(self, e, index):
        """∂e/∂(variable `index`)."""
        key = (e, index)
        if key not in self.derivatives:
            self.derivatives[key] = self.differentiate(e, index)
        return self.derivatives[key]

    def differentiate(self, e, index):
        d = [self.derivative(a, index) for a in e.args]
        f = self.apply
        if e.op == "num":
            return self.zero
        if e.op == "var":
            return self.num(1.0 if e.number == index else 0.0)
        if e.op in ("add", "sub", "neg"):
            return f(e.op, *d)
        if e.op == "mul":
            return f("add", f("mul", d[0], e.args[1]), f("mul", e.args[0], d[1]))
        if e.op == "div":
            return f("div", f("sub", d[0], f("mul", e, d[1])), e.args[1])
        outer = {
            "sq": lambda: f("mul", self.num(2.0), e.args[0]),
            "exp": lambda: e,
            "sin": lambda: f("cos", e.args[0]),
            "cos": lambda: f("neg", f("sin", e.args[0])),
        }
        return f("mul", outer[e.op](), d[0])


def is_number(e, value):
    return e.op == "num" and e.number == value


def numeric(op, values):
    a, b = values[0], values[-1]
    return {
        "add": lambda: a + b,
        "sub": lambda: a - b,
        "mul": lambda: a * b,
        "div": lambda: a / b,
        "neg": lambda: -a,
        "sq": lambda: a * a,
        "exp": lambda: math.exp(a),
        "sin": lambda: math.sin(a),
        "cos": lambda: math.cos(a),
    }[op]()


def in_order(roots):
    """All subexpressions, operands first."""
    found, stack = {}, list(roots)
    while stack:
        e = stack.pop()
        if e not in found:
            found[e] = None
            stack.extend(e.args)
    return sorted(found, key=lambda e: e.order)


def value_and_size(e, point, memo=None):
    """The value at a point, and the sum of the magnitudes that a rounding of it is relative to."""
    memo = {} if memo is None else memo
    for part in in_order([e]):
        if part in memo:
            continue
        if part.op == "num":
            memo[part] = (part.number, abs(part.number))
        elif part.op == "var":
            memo[part] = (point[part.number], 1.0 + abs(point[part.number]))
        else:
            (a, sa), (b, sb) = memo[part.args[0]], memo[part.args[-1]]
            value = numeric(part.op, [a, b] if len(part.args) == 2 else [a])
            size = {
                "add": lambda: sa + sb,
                "sub": lambda: sa + sb,
                "mul": lambda: sa * abs(b) + abs(a) * sb,
                "div": lambda: (sa + abs(value) * sb) / abs(b),
                "neg": lambda: sa,
                "sq": lambda: 2 * abs(a) * sa,
                "exp": lambda: abs(value) * (1 + sa),
                "sin": lambda: 1 + sa,
                "cos": lambda: 1 + sa,
            }[part.op]()
            memo[part] = (value, size)
    return memo[e]


def depends_on(e, indices):
    return any(part.op == "var" and part.number in indices for part in in_order([e]))


def numbers(rates, others, point, freedoms, order):
    """Taylor coefficients of the variables and of other expressions, where speeds have the rates given."""
    parts = in_order([*rates, *others])
    series = {part: [] for part in parts}
    aside = {part: ([], []) for part in parts if part.op in ("sin", "cos", "exp")}
    variables = [[x] for x in point]
    for k in range(order + 1):
        for part in parts:
            s = series[part]
            op = part.op
            if op == "num":
                s.append(part.number if k == 0 else 0.0)
                continue
            if op == "var":
                s.append(variables[part.number][k])
                continue
            a = series[part.args[0]]
            if op == "add":
                s.append(a[k] + series[part.args[1]][k])
            elif op == "sub":
                s.append(a[k] - series[part.args[1]][k])
            elif op == "neg":
                s.append(-a[k])
            elif op == "mul":
                s.append(sum(map(mul, a, reversed(series[part.args[1]]))))
            elif op == "sq":
                s.append(sum(map(mul, a, reversed(a))))
            elif op == "div":
                b = series[part.args[1]]
                s.append((a[k] - sum(map(mul, b[1:], reversed(s)))) / b[0])
            else:
                slope, other = aside[part]
                if k == 0:
                    s.append(numeric(op, [a[0]]))
                    other.append({"sin": math.cos, "cos": math.sin, "exp": math.exp}[op](a[0]))
                else:
                    slope.append(k * a[k])
                    if op == "exp":
                        s.append(sum(map(mul, slope, reversed(s))) / k)
                    else:
                        sign = 1.0 if op == "sin" else -1.0
                        new = sign * sum(map(mul, slope, reversed(other))) / k
                        other.append(-sign * sum(map(mul, slope, reversed(s))) / k)
                        s.append(new)
        variables[0].append(1.0 if k == 0 else 0.0)
        for i in range(freedoms):
            variables[1 + i].append(variables[1 + freedoms + i][k] / (k + 1))
        for i, rate in enumerate(rates):
            variables[1 + freedoms + i].append(series[rate][k] / (k + 1))
    return variables, series


class Unbounded(Exception):
    """An expression has no bound over an interval."""


def range_of(op, args):
    """The range of an operation over intervals (low, high)."""
    a, b = args[0], args[-1]
    if op == "add":
        return a[0] + b[0], a[1] + b[1]
    if op == "sub":
        return a[0] - b[1], a[1] - b[0]
    if op == "neg":
        return -a[1], -a[0]
    if op == "mul":
        products = (a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1])
        return min(products), max(products)
    if op == "sq":
        low, high = sorted((a[0] * a[0], a[1] * a[1]))
        return (0.0 if a[0] <= 0 <= a[1] else low), high
    if op == "div":
        if b[0] <= 0 <= b[1]:
            raise Unbounded
        return range_of("mul", (a, (1 / b[1], 1 / b[0])))
    if op == "exp":
        if a[1] > 600:
            raise Unbounded
        return math.exp(a[0]), math.exp(a[1])
    shift = 0.0 if op == "cos" else math.pi / 2
    low, high = a[0] - shift, a[1] - shift
    ends = (math.cos(low), math.cos(high))
    has_top = math.floor(high / (2 * math.pi)) >= math.ceil(low / (2 * math.pi))
    has_bottom = math.floor((high - math.pi) / (2 * math.pi)) >= math.ceil((low - math.pi) / (2 * math.pi))
    return (-1.0 if has_bottom else min(ends)), (1.0 if has_top else max(ends))


def ranges(roots, box):
    """The ranges of expressions over a box of the variables."""
    memo = {}
    for part in in_order(roots):
        if part.op == "num":
            memo[part] = (part.number, part.number)
        elif part.op == "var":
            memo[part] = box[part.number]
        else:
            memo[part] = range_of(part.op, [memo[a] for a in part.args])
    return memo


class Balls:
    """Coefficients as midpoints and radii."""

    __slots__ = ("mid", "rad", "size", "reach")

    def __init__(self):
        self.mid, self.rad, self.size, self.reach = [], [], [], []

    def append(self, mid, rad):
        self.mid.append(mid)
        self.rad.append(rad)
        self.size.append(abs(mid))
        self.reach.append(abs(mid) + rad)

    def first(self, low, high):
        if not (high - low < math.inf):
            raise Unbounded
        self.append(0.5 * (low + high), 0.5 * (high - low))


def product(a, b):
    """The sum of aⱼ b₋ⱼ."""
    mid = sum(map(mul, a.mid, reversed(b.mid)))
    rad = sum(map(mul, a.size, reversed(b.rad))) + sum(map(mul, a.rad, reversed(b.reach)))
    return mid, rad


def tail(b):
    """The series without its first coefficient."""
    rest = Balls()
    rest.mid, rest.rad, rest.size, rest.reach = b.mid[1:], b.rad[1:], b.size[1:], b.reach[1:]
    return rest


def enclosures(rates, others, box, freedoms, order):
    """As `numbers`, with all coefficients enclosed that the series have at points of a box."""
    parts = in_order([*rates, *others])
    values = ranges([*rates, *others], box)
    series = {part: Balls() for part in parts}
    aside = {part: (Balls(), Balls()) for part in parts if part.op in ("sin", "cos", "exp")}
    variables = [Balls() for _ in box]
    for variable, sides in zip(variables, box):
        variable.first(*sides)
    for k in range(order + 1):
        for part in parts:
            s = series[part]
            op = part.op
            if k == 0:
                s.first(*values[part])
                if part in aside:
                    a = values[part.args[0]]
                    other = {"sin": "cos", "cos": "sin", "exp": "exp"}[op]
                    aside[part][1].first(*range_of(other, [a]))
                continue
            if op == "num":
                s.append(0.0, 0.0)
                continue
            if op == "var":
                s.append(variables[part.number].mid[k], variables[part.number].rad[k])
                continue
            a = series[part.args[0]]
            if op in ("add", "sub"):
                b = series[part.args[1]]
                s.append(a.mid[k] + (b.mid[k] if op == "add" else -b.mid[k]), a.rad[k] + b.rad[k])
            elif op == "neg":
                s.append(-a.mid[k], a.rad[k])
            elif op == "mul":
                s.append(*product(a, series[part.args[1]]))
            elif op == "sq":
                s.append(*product(a, a))
            elif op == "div":
                b = series[part.args[1]]
                mid, rad = product(tail(b), s)
                mid, rad = a.mid[k] - mid, a.rad[k] + rad
                low, high = range_of("div", [(mid - rad, mid + rad), values[part.args[1]]])
                s.append(0.5 * (low + high), 0.5 * (high - low))
            else:
                slope, other = aside[part]
                slope.append(k * a.mid[k], k * a.rad[k])
                if op == "exp":
                    mid, rad = product(slope, s)
                    s.append(mid / k, rad / k)
                else:
                    sign = 1.0 if op == "sin" else -1.0
                    mid, rad = product(slope, other)
                    cross_mid, cross_rad = product(slope, s)
                    s.append(sign * mid / k, rad / k)
                    other.append(-sign * cross_mid / k, cross_rad / k)
        variables[0].append(1.0 if k == 0 else 0.0, 0.0)
        for i in range(freedoms):
            speed = variables[1 + freedoms + i]
            variables[1 + i].append(speed.mid[k] / (k + 1), speed.rad[k] / (k + 1))
        for i, rate in enumerate(rates):
            s = series[rate]
            variables[1 + freedoms + i].append(s.mid[k] / (k + 1), s.rad[k] / (k + 1))
    return variables, series


def horner(coefficients, tau):
    value = 0.0
    for c in reversed(coefficients):
        value = value * tau + c
    return value


def first_root(coefficients, h, noise):
    """The first root in (0, h] that a polynomial crosses, or None. The first coefficient gives its sign before.

    By the signs of its Bernstein coefficients, which are halved until there is at most one change (Descartes). What is below
    `noise` has no sign: a polynomial that touches zero does not cross it."""
    n = len(coefficients) - 1
    scaled = [c * h**k for k, c in enumerate(coefficients)]
    weights = WEIGHTS.setdefault(n, [[math.comb(i, k) / math.comb(n, k) for k in range(i + 1)] for i in range(n + 1)])
    bernstein = [sum(map(mul, row, scaled)) for row in weights]
    before = coefficients[0] > 0
    stack = [(0.0, 1.0, bernstein)]
    while stack:
        low, high, b = stack.pop()
        signs = [x > 0 for x in b if abs(x) > noise]
        if not signs:
            continue
        changes = sum(p != q for p, q in zip([before, *signs], signs))
        # One that has no sign at the end may touch zero there.
        if changes == 0 or high - low < 1e-15:
            continue
        if changes == 1 and abs(b[-1]) > noise:
            return bisected(lambda t: (horner(coefficients, t) > 0) == before, low * h, high * h)
        left, right, row = [], [], b
        while row:
            left.append(row[0])
            right.append(row[-1])
            row = [0.5 * (p + q) for p, q in zip(row, row[1:])]
        middle = 0.5 * (low + high)
        stack.append((middle, high, right[::-1]))
        stack.append((low, middle, left))
    return None


WEIGHTS = {}


def least(coefficients, h, points=24):
    """The least magnitude of a polynomial in [0, h], nearly: at an inner minimum, or infinity where there is none."""
    values = [abs(horner(coefficients, k * h / points)) for k in range(points + 1)]
    found = math.inf
    for before, value, after in zip(values, values[1:], values[2:]):
        bend = before - 2 * value + after
        if before >= value <= after and bend > 0:
            found = min(found, abs(value - (after - before) ** 2 / (8 * bend)))
    return found


def bisected(is_before, low, high):
    for _ in range(200):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if is_before(middle):
            low = middle
        else:
            high = middle
    return high

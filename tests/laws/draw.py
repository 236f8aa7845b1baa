"""Draws scenes whose loads are nested laws: each with its text for Dwell and its tree for `motion`.

Numbers are mostly eighths, so that values meet their thresholds exactly: `if(floor(2*x) < 1, …)`, `sign(max(0, 0.5 - x))`.
"""
from motion import Law

MOST_DEPTH = 5
DURATION = 2.0
# Widths of pulses and windows, in the unit of their variable.
WIDTHS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


class Term:
    """A part of an expression: its text, and its tree."""

    __slots__ = ("text", "law")

    def __init__(self, text, law):
        self.text, self.law = text, law


def number(value):
    value = float(value)
    text = repr(value) if value >= 0 else f"({value!r})"
    return Term(text, Law("num", (), value))


def binary(symbol, op, a, b):
    return Term(f"({a.text} {symbol} {b.text})", Law(op, (a.law, b.law)))


def plus(a, b):
    return binary("+", "add", a, b)


def minus(a, b):
    return binary("-", "sub", a, b)


def times(a, b):
    return binary("*", "mul", a, b)


def call(name, *arguments):
    """A function of Dwell, as decisions."""
    text = f"{name}({', '.join(a.text for a in arguments)})"
    laws = [a.law for a in arguments]
    a, b = laws[0], laws[-1]
    return Term(text, {
        "sin": lambda: Law("sin", (a,)),
        "cos": lambda: Law("cos", (a,)),
        "exp": lambda: Law("exp", (a,)),
        "floor": lambda: Law("floor", (a,)),
        "abs": lambda: choice(">=", a, a, Law("neg", (a,))),
        "step": lambda: choice(">=", a, fixed(1), fixed(0)),
        "sign": lambda: choice(">", a, fixed(1), choice("<", a, fixed(-1), fixed(0))),
        "min": lambda: smaller(a, b),
        "max": lambda: larger(a, b),
        "clamp": lambda: smaller(larger(a, laws[1]), b) if len(laws) == 3 else None,
    }[name]())


def ceiling(a):
    return Term(f"(-floor(-{a.text}))", Law("neg", (Law("floor", (Law("neg", (a.law,)),)),)))


def conditional(comparison, a, b, then, other):
    text = f"if({a.text} {comparison} {b.text}, {then.text}, {other.text})"
    return Term(text, choice(comparison, Law("sub", (a.law, b.law)), then.law, other.law))


def fixed(value):
    return Law("num", (), float(value))


def choice(comparison, a, then, other):
    return Law("if", (a, then, other), comparison)


def smaller(a, b):
    return choice("<=", Law("sub", (a, b)), a, b)


def larger(a, b):
    return choice(">=", Law("sub", (a, b)), a, b)


def bell(variable, centre, width):
    """exp(-((x - a)/w)²)."""
    z = binary("/", "div", minus(variable, centre), number(width))
    return Term(f"exp(-{z.text}^2)", Law("exp", (Law("neg", (Law("sq", (z.law,)),)),)))


class Draw:
    """One scene: `names` are those of its coordinates."""

    def __init__(self, rng, names):
        self.rng = rng
        self.times = [Term("t", Law("var", (), 0))]
        self.places = [Term(n, Law("var", (), 1 + i)) for i, n in enumerate(names)]
        self.speeds = [Term(f"{n}.velocity", Law("var", (), 1 + len(names) + i)) for i, n in enumerate(names)]
        # The variables of the laws of this scene.
        mixed = [*self.times, *self.places, *self.speeds]
        self.variables = rng.choices([self.times, self.places, self.speeds, mixed], [2, 3, 2, 4])[0]

    def eighth(self, low=-2.0, high=2.0):
        if self.rng.random() < 0.15:
            return number(round(self.rng.uniform(low, high), 3))
        return number(self.rng.randint(int(8 * low), int(8 * high)) / 8)

    def factor(self):
        return number(self.rng.choice([-3, -2, -1.5, -1, -0.5, 0.5, 1, 1.5, 2, 3, 4]))

    def variable(self):
        return self.rng.choice(self.variables)

    def smooth(self):
        """An expression without a decision."""
        kind = self.rng.randrange(8)
        x = self.variable()
        if kind < 3:
            return self.eighth()
        if kind == 3:
            return times(self.factor(), x)
        if kind == 4:
            return minus(x, self.eighth())
        if kind == 5:
            return times(self.eighth(), call(self.rng.choice(["sin", "cos"]), times(self.factor(), x)))
        if kind == 6:
            return times(x, self.variable())
        return minus(self.eighth(), times(self.factor(), x))

    def argument(self, depth):
        """An argument that is likely to meet a threshold."""
        if depth > 0 and self.rng.random() < 0.6:
            return self.nested(depth)
        x = self.variable()
        kind = self.rng.randrange(5)
        if kind < 2:
            return minus(x, self.eighth(-0.5, 1.5))
        if kind == 2:
            return minus(self.eighth(-0.5, 1.5), x)
        if kind == 3:
            return times(self.factor(), x)
        return call("sin", times(number(self.rng.randint(1, 9)), x))

    def value(self, depth):
        return self.nested(depth) if depth > 0 and self.rng.random() < 0.6 else self.smooth()

    def threshold(self):
        """A threshold; often a whole number, at which floors, steps and signs jump."""
        if self.rng.random() < 0.6:
            return number(self.rng.randint(-1, 2))
        return self.eighth()

    def nested(self, depth):
        rng, d = self.rng, depth - 1
        kind = rng.choices(
            ["if", "step", "sign", "floor", "ceiling", "min", "max", "clamp", "abs", "product", "sum", "bell", "window"],
            [6, 3, 3, 3, 1, 3, 3, 2, 2, 2, 2, 0.5, 0.5],
        )[0]
        if kind == "if":
            a, b = self.argument(d), self.threshold()
            if rng.random() < 0.2:
                a, b = b, a
            return conditional(rng.choice(["<", "<=", ">", ">="]), a, b, self.value(d), self.value(d))
        if kind in ("step", "sign", "floor", "abs"):
            return call(kind, self.argument(d))
        if kind == "ceiling":
            return ceiling(self.argument(d))
        if kind in ("min", "max"):
            # A bound that its argument may rest on, like max(0, 0.5 - x).
            pair = [self.argument(d), self.threshold() if rng.random() < 0.6 else self.value(d)]
            rng.shuffle(pair)
            return call(kind, *pair)
        if kind == "clamp":
            low = rng.randint(-2, 1)
            return call(kind, self.argument(d), number(low), number(low + rng.randint(1, 2)))
        if kind == "product":
            return times(self.value(d), self.nested(d) if d > 0 else self.smooth())
        if kind == "sum":
            return plus(self.value(d), self.value(d))
        width = rng.choice(WIDTHS)
        pulse = bell(self.variable(), self.eighth(-0.5, 1.5), width)
        # The impulse does not vanish with the width, and the force is at most 1000 N.
        height = number(min(1000.0, round(rng.uniform(0.1, 1.0) / width, 1)) * rng.choice([-1, 1]))
        if kind == "bell":
            return times(height, pulse)
        return conditional(rng.choice([">", ">="]), pulse, number(0.5), height, self.value(d))

    def table(self):
        """A table instead of an expression: its text and its tree."""
        rng = self.rng
        of = rng.choice([*self.times, *self.places, *self.speeds])
        is_step = rng.random() < 0.5
        inner = sorted(rng.sample(range(-8, 17), rng.randint(2, 6)))
        xs = [-1e5, *[k / 8 for k in inner], 1e5]
        ys = [self.rng.randint(-16, 16) / 8 for _ in xs]
        # A piecewise linear table is constant beyond its inner points.
        ys[0], ys[-1] = ys[1], ys[-2]
        law = fixed(ys[-2] if is_step else ys[-1])
        for i in range(len(inner), -1, -1):
            if is_step or ys[i] == ys[i + 1]:
                piece = fixed(ys[i])
            else:
                slope = fixed((ys[i + 1] - ys[i]) / (xs[i + 1] - xs[i]))
                offset = Law("sub", (of.law, fixed(xs[i])))
                piece = Law("add", (fixed(ys[i]), Law("mul", (slope, offset))))
            law = choice("<", Law("sub", (of.law, fixed(xs[i + 1]))), piece, law)
        points = ", ".join(f"[{x!r}, {y!r}]" for x, y in zip(xs, ys))
        kind = "step" if is_step else "linear"
        return f'{{ table = [{points}], interpolation = "{kind}", of = "{of.text}" }}', law


class Scene:
    """The text of a scene, the accelerations and the start of its coordinates, and what was drawn."""

    def __init__(self, rng):
        self.depth = rng.randint(1, MOST_DEPTH)
        self.kind = rng.choices(["slide", "wheel", "two slides"], [6, 2, 1])[0]
        self.names = {"slide": ["x"], "wheel": ["phi"], "two slides": ["x", "y"]}[self.kind]
        draw = Draw(rng, self.names)
        places = [rng.choice([0.0, 0.0, 0.25, 0.5, -0.5, 1.0]) for _ in self.names]
        speeds = [rng.choice([1.0, 1.0, 0.5, -1.0, 2.0, 0.0]) for _ in self.names]
        self.start = [*places, *speeds]
        self.mass = rng.choice([1.0, 1.0, 0.5, 2.0])
        drives, self.laws = [], []
        for i, name in enumerate(self.names):
            law = draw.nested(self.depth)
            if rng.random() < 0.5:
                spring = times(number(-4), draw.places[i])
                damper = times(number(0.5), draw.speeds[i])
                law = plus(law, minus(spring, damper))
            self.text_of_law = law.text
            drives.append(f'f{i} = {{ applied-force = "{name}", magnitude = "{law.text}" }}')
            force = law.law
            if rng.random() < 0.12:
                text, table = draw.table()
                drives.append(f'g{i} = {{ applied-force = "{name}", magnitude = {text} }}')
                force = Law("add", (force, table))
            self.laws.append(Law("div", (force, fixed(self.mass))))
        self.text = self.written(drives)

    def written(self, drives):
        is_wheel = self.kind == "wheel"
        lines = [f'title = "{self.kind}, depth {self.depth}"', "[bodies.ground]", "points = { O = [0, 0] }"]
        for name in self.names:
            lines += [f"[bodies.body-{name}]", "points = { P = [0, 0] }", "mass = 1.0" if is_wheel else f"mass = {self.mass}"]
            lines += ['center = "P"', f"inertia = {self.mass}" if is_wheel else "inertia = 0.01"]
        lines.append("[joints]")
        for i, name in enumerate(self.names):
            axis = "" if is_wheel else f", axis = {[[1, 0], [0, 1]][i]}"
            pair = "revolute" if is_wheel else "prismatic"
            lines.append(f'J{i} = {{ {pair} = ["ground.O", "body-{name}.P"]{axis} }}')
        lines.append("[actuators]")
        for i, name in enumerate(self.names):
            lines.append(f'{name} = {{ angle = ["ground", "body-{name}"] }}' if is_wheel else f'{name} = {{ length = "J{i}" }}')
        n = len(self.names)
        speeds = ", ".join(f"{name} = {v}" for name, v in zip(self.names, self.start[n:]))
        lines += ["[assembly]", *[f"{name} = {x}" for name, x in zip(self.names, self.start)]]
        lines += ["[drives]", *drives, "[motion]", f"initial-velocity = {{ {speeds} }}", f"duration = {DURATION}"]
        return "\n".join(lines) + "\n"

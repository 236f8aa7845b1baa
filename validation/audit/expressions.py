"""Expressions of a scene: numbers, names, operators and functions, evaluated with two derivatives.

    comparison := sum [("<" | "<=" | ">" | ">=") sum]        sum := term {("+" | "-") term}
    term := sign {("*" | "/") sign}                           sign := "-" sign | power
    power := operand ["^" sign]                               operand := number | name | name "(" … ")" | "(" … ")"
"""

import re

import numpy as np

from jets import Jet, atan, atan2, choose, cos, exp, jet, log, power, sin, sqrt


TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|`(?P<quoted>[^`]+)`"
    r"|(?P<name>[^\W\d][\w.'′]*)|(?P<sign>\*\*|<=|>=|[-+*/^<>(),]))"
)


class Expression:
    """An expression as a function of the jets of its names."""

    def __init__(self, text):
        self.text, self.names, self.tokens = text, set(), []
        self.switches = []  # quantities at whose zeros the value or a derivative may jump
        at = 0
        while text[at:].strip():
            found = TOKEN.match(text, at)
            if not found:
                raise ValueError(f"expression `{text}` cannot be read at `{text[at:]}`")
            self.tokens.append((found.lastgroup, found.group(found.lastgroup)))
            at = found.end()
        self.tokens.append(("end", ""))
        self.evaluate = self.comparison()
        if self.tokens[0][0] != "end":
            raise ValueError(f"expression `{text}` cannot be read at `{self.tokens[0][1]}`")

    def __call__(self, names):
        with np.errstate(all="ignore"):
            return self.evaluate(names)

    def take(self, *signs):
        """Takes the next sign if it is one of these."""
        kind, text = self.tokens[0]
        if kind == "sign" and text in signs:
            self.tokens.pop(0)
            return text
        return None

    def chain(self, operand, operators):
        """Operands with operators between them, from the left."""
        left = operand()
        while sign := self.take(*operators):
            left = operation(operators[sign], left, operand())
        return left

    def comparison(self):
        left = self.sum()
        while sign := self.take(*COMPARISONS):
            right = self.sum()
            self.switches.append(operation(lambda a, b: a - b, left, right))
            left = operation(COMPARISONS[sign], left, right)
        return left

    def sum(self):
        return self.chain(self.term, {"+": lambda a, b: a + b, "-": lambda a, b: a - b})

    def term(self):
        return self.chain(self.sign, {"*": lambda a, b: a * b, "/": lambda a, b: a / b})

    def sign(self):
        if self.take("-"):
            inner = self.sign()
            return lambda names: -inner(names)
        base = self.operand()
        return operation(raised, base, self.sign()) if self.take("^", "**") else base

    def operand(self):
        kind, text = self.tokens.pop(0)
        if kind == "number":
            return lambda names: Jet(float(text))
        if kind == "sign" and text == "(":
            inner = self.comparison()
            self.need(")")
            return inner
        if kind == "name" and self.take("("):
            arguments = [self.comparison()]
            while self.take(","):
                arguments.append(self.comparison())
            self.need(")")
            function = FUNCTIONS[text]
            self.add_switches(text, arguments)
            return lambda names: function(*(argument(names) for argument in arguments))
        if kind in ("name", "quoted"):
            self.names.add(text)
            return lambda names: variable(text, names(text))
        raise ValueError(f"expression `{self.text}` cannot be read at `{text}`")

    def add_switches(self, name, arguments):
        """Adds the switches of a function: where two arguments are equal, or where its only argument is zero or a whole number."""
        if name in ("min", "max", "clamp"):
            self.switches += [operation(lambda a, b: a - b, arguments[0], other) for other in arguments[1:]]
        elif name in ("abs", "sign", "step"):
            self.switches += arguments
        elif name == "floor":
            self.switches.append(lambda names: sin(arguments[0](names) * np.pi))

    def need(self, sign):
        if not self.take(sign):
            raise ValueError(f"expression `{self.text}` has no `{sign}` where one is needed")


def variable(name, value):
    """The value of a name; a variable of the scene comes before a constant of its name."""
    if value is None and name not in CONSTANTS:
        raise ValueError(f"nothing is called `{name}`")
    return Jet(CONSTANTS[name]) if value is None else jet(value)


def operation(function, left, right):
    return lambda names: function(left(names), right(names))


def raised(base, exponent):
    """A power; with a constant exponent the base may be negative."""
    p = exponent.value.flat[0] if exponent.value.size else 0.0
    if np.all(exponent.value == p) and not exponent.first.any() and not exponent.second.any():
        return power(base, float(p))
    return exp(exponent * log(base))


def constant(values):
    return Jet(np.asarray(values, float))


def smaller(a, b):
    return choose(b.value < a.value, b, a)


def larger(a, b):
    return choose(b.value > a.value, b, a)


CONSTANTS = {"pi": np.pi, "tau": 2.0 * np.pi}
COMPARISONS = {
    "<": lambda a, b: constant(a.value < b.value),
    "<=": lambda a, b: constant(a.value <= b.value),
    ">": lambda a, b: constant(a.value > b.value),
    ">=": lambda a, b: constant(a.value >= b.value),
}
FUNCTIONS = {
    "sin": sin,
    "cos": cos,
    "tan": lambda u: sin(u) / cos(u),
    "asin": lambda u: atan2(u, sqrt(1.0 - u * u)),
    "acos": lambda u: atan2(sqrt(1.0 - u * u), u),
    "atan": atan,
    "atan2": atan2,
    "sinh": lambda u: 0.5 * (exp(u) - exp(-u)),
    "cosh": lambda u: 0.5 * (exp(u) + exp(-u)),
    "tanh": lambda u: tanh(u),
    "exp": exp,
    "ln": log,
    "log10": lambda u: log(u) / np.log(10.0),
    "sqrt": sqrt,
    "abs": lambda u: choose(u.value < 0.0, -u, u),
    "sign": lambda u: constant(np.sign(u.value)),
    "floor": lambda u: constant(np.floor(u.value)),
    "step": lambda u: constant(u.value >= 0.0),
    "min": smaller,
    "max": larger,
    "hypot": lambda a, b: sqrt(a * a + b * b),
    "clamp": lambda u, low, high: smaller(larger(u, low), high),
    "if": lambda condition, a, b: choose(condition.value != 0.0, a, b),
}


def tanh(u):
    """tanh(u) without overflow of the exponentials."""
    t = np.tanh(u.value)
    return u.through(t, 1.0 - t * t, -2.0 * t * (1.0 - t * t))

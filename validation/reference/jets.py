"""Numbers with their first and second derivative along one direction: no differences, any precision."""

import math

import mpmath


class Jet:
    def __init__(self, v, d=0, s=0):
        self.v, self.d, self.s = v, d, s

    def __add__(self, o):
        o = lift(o)
        return Jet(self.v + o.v, self.d + o.d, self.s + o.s)

    def __neg__(self):
        return Jet(-self.v, -self.d, -self.s)

    def __sub__(self, o):
        return self + -lift(o)

    def __rsub__(self, o):
        return lift(o) - self

    def __mul__(self, o):
        o = lift(o)
        return Jet(self.v * o.v, self.d * o.v + self.v * o.d, self.s * o.v + 2 * self.d * o.d + self.v * o.s)

    def __rtruediv__(self, o):
        return o * chain(self, 1 / self.v, -1 / self.v**2, 2 / self.v**3)

    __radd__, __rmul__ = __add__, __mul__


def lift(x):
    return x if isinstance(x, Jet) else Jet(x)


def chain(x, f, first, second):
    """The jet of a function of x from its value and derivatives there; of a number, the value."""
    return Jet(f, first * x.d, second * x.d * x.d + first * x.s) if isinstance(x, Jet) else f


def plain(name, *x):
    """A function of plain numbers, in their own precision."""
    return getattr(math if isinstance(x[0], float) else mpmath, name)(*x)


def sincos(x):
    v = lift(x).v
    s, c = plain("sin", v), plain("cos", v)
    return chain(x, s, c, -s), chain(x, c, -s, -c)


def exp(x):
    e = plain("exp", lift(x).v)
    return chain(x, e, e, e)


def sqrt(x):
    r = plain("sqrt", lift(x).v)
    return chain(x, r, 1 / (2 * r), -1 / (4 * r**3))


def atan2(y, x):
    y, x = lift(y), lift(x)
    square = x.v**2 + y.v**2
    rate = (x.v * y.d - y.v * x.d) / square
    return Jet(plain("atan2", y.v, x.v), rate,
               (x.v * y.s - y.v * x.s - 2 * rate * (x.v * x.d + y.v * y.d)) / square)

"""Quantities over all rows of a file, with their first and second derivative in time.

A jet holds three arrays: value, first and second derivative. Scalars have the shape (rows,), vectors (rows, 3).
"""

import numpy as np


class Jet:
    """A quantity of every row with two derivatives in time."""

    __array_ufunc__ = None  # so that array * jet is the jet's business

    def __init__(self, value, first=None, second=None):
        self.value = np.asarray(value, float)
        self.first = np.zeros_like(self.value) if first is None else np.asarray(first, float)
        self.second = np.zeros_like(self.value) if second is None else np.asarray(second, float)

    @property
    def orders(self):
        """Value, first and second derivative."""
        return self.value, self.first, self.second

    def at_rest(self):
        """The value with zero derivatives."""
        return Jet(self.value)

    def each(self, function):
        """Applies a linear function to value and derivatives."""
        return Jet(*(function(order) for order in self.orders))

    def through(self, f, f1, f2):
        """f(u), by the values of f, f' and f'' at u."""
        return Jet(f, f1 * self.first, f1 * self.second + f2 * self.first**2)

    def __add__(self, other):
        other = jet(other)
        return Jet(*(a + b for a, b in zip(self.orders, other.orders)))

    def __neg__(self):
        return self.each(np.negative)

    def __sub__(self, other):
        return self + -jet(other)

    def __rsub__(self, other):
        return jet(other) - self

    def __mul__(self, other):
        return product(lambda a, b: a * b, self, jet(other))

    def __truediv__(self, other):
        return self * power(jet(other), -1.0)

    def __rtruediv__(self, other):
        return jet(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __getitem__(self, k):
        """The k-th component of a vector."""
        return self.each(lambda order: order[..., k])


def jet(value):
    """The jet of a constant number or array; a jet is returned unchanged."""
    return value if isinstance(value, Jet) else Jet(value)


def product(multiply, a, b):
    """A product of two jets by Leibniz's rule."""
    return Jet(
        multiply(a.value, b.value),
        multiply(a.first, b.value) + multiply(a.value, b.first),
        multiply(a.second, b.value) + 2.0 * multiply(a.first, b.first) + multiply(a.value, b.second),
    )


def dot(a, b):
    """The scalar product of two vectors."""
    return product(lambda u, v: (u * v).sum(-1), jet(a), jet(b))


def cross(a, b):
    """The vector product of two vectors."""
    return product(np.cross, jet(a), jet(b))


def scaled(vector, factor):
    """A vector times a scalar of every row."""
    return product(lambda u, s: u * s[..., None], jet(vector), jet(factor))


def power(u, p):
    """u to the constant power p."""
    with np.errstate(all="ignore"):
        first = p * u.value ** (p - 1.0) if p != 0.0 else 0.0 * u.value
        second = p * (p - 1.0) * u.value ** (p - 2.0) if p not in (0.0, 1.0) else 0.0 * u.value
        return u.through(u.value**p, first, second)


def sqrt(u):
    """The square root."""
    with np.errstate(all="ignore"):
        root = np.sqrt(u.value)
        return u.through(root, 0.5 / root, -0.25 / root**3)


def length(vector):
    """The length of a vector."""
    return sqrt(dot(vector, vector))


def atan2(y, x):
    """The angle of the vector (x, y)."""
    square = x.value**2 + y.value**2
    with np.errstate(all="ignore"):
        first = (x.value * y.first - y.value * x.first) / square
        change = x.value * y.second - y.value * x.second
        turned = 2.0 * (x.value * x.first + y.value * y.first)
        return Jet(np.arctan2(y.value, x.value), first, (change - first * turned) / square)


def sin(u):
    s, c = np.sin(u.value), np.cos(u.value)
    return u.through(s, c, -s)


def cos(u):
    s, c = np.sin(u.value), np.cos(u.value)
    return u.through(c, -s, -c)


def exp(u):
    e = np.exp(u.value)
    return u.through(e, e, e)


def log(u):
    with np.errstate(all="ignore"):
        return u.through(np.log(u.value), 1.0 / u.value, -1.0 / u.value**2)


def atan(u):
    slope = 1.0 / (1.0 + u.value**2)
    return u.through(np.arctan(u.value), slope, -2.0 * u.value * slope**2)


def choose(condition, a, b):
    """a where the condition holds, b elsewhere."""
    a, b = jet(a), jet(b)
    return Jet(*(np.where(condition, x, y) for x, y in zip(a.orders, b.orders)))


def without_turns(angle, turn=2.0 * np.pi):
    """An angle without its whole revolutions."""
    return angle - turn * np.round(angle.value / turn)

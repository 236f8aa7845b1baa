"""Closed forms as SymPy objects."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

#: A constant of the mechanism in the code: name, value, meaning.
_CONSTANT = re.compile(r"^    (\w+) = (-?[\d.e+-]+)  # (.*)$", re.MULTILINE)
#: A quantity in the description of the function: name, meaning.
_QUANTITY = re.compile(r"^    (\w+): (.*)$", re.MULTILINE)


@dataclass(frozen=True)
class ClosedForm:
    """Positions, m, half_dm, and a and b of a reaction of a mechanism made of dyads, in closed form.

    ``expressions`` are SymPy expressions of ``coordinate`` and of the constants of the mechanism, whose values are in ``constants``;
    ``meanings`` says what each name is, with its unit; ``code`` is the same as a function in Python.
    """

    coordinate: Any
    expressions: dict[str, Any]
    constants: dict[Any, float]
    meanings: dict[str, str]
    code: str

    def numeric(self, name: str) -> Any:
        """An expression with the values of the constants."""
        return self.expressions[name].subs(self.constants)


def closed_form(code: str) -> ClosedForm:
    """The function that the native half wrote, called with symbols."""
    import sympy

    signature = re.search(r"def reduced\((\w+)\):", code)
    if signature is None:
        raise ValueError("the code has no function `reduced`")
    coordinate = sympy.Symbol(signature[1], real=True)
    found = _CONSTANT.findall(code)
    symbols = {name: sympy.Symbol(name, real=True) for name, _, _ in found}
    description, body = code.split('"""')[1:3]
    # Constants are left as symbols: their lines are not run.
    function = code.replace(body, _CONSTANT.sub("", body)).replace("from math import atan2, cos, sin, sqrt", "")
    names: dict[str, Any] = {name: getattr(sympy, name) for name in ("atan2", "cos", "sin", "sqrt")} | symbols
    exec(compile(function, "<closed forms>", "exec"), names)  # noqa: S102 - code that this package wrote
    expressions = {name: sympy.sympify(value) for name, value in names["reduced"](coordinate).items()}
    meanings = dict(_QUANTITY.findall(description)) | {name: meaning for name, _, meaning in found}
    constants = {symbols[name]: float(value) for name, value, _ in found}
    return ClosedForm(coordinate, expressions, constants, meanings, code)

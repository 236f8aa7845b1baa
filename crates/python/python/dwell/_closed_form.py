"""Closed forms as SymPy objects."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

#: An assignment in the generated function: name, value and, for constants of the mechanism, the meaning in a comment. A value consists of numbers,
#: names, operators and parentheses only. Text of a scene occurs only in comments, and is never executed.
_ASSIGNMENT = re.compile(r"^    ([A-Za-z]\w*) = ((?:[A-Za-z]\w*|[\d.]+(?:e[+-]?\d+)?|[-+*/(), ])+?)(?:  # (.*))?$", re.MULTILINE)
#: A quantity in the description of the function: name, meaning.
_QUANTITY = re.compile(r"^    (\w+): (.*)$", re.MULTILINE)
#: A quantity that the function returns.
_RETURNED = re.compile(r'^        "(\w+)": \1,$', re.MULTILINE)


@dataclass(frozen=True)
class ClosedForm:
    """Positions, m, half_dm, and a and b of a reaction of a mechanism made of dyads, in closed form.

    ``expressions`` are SymPy expressions of ``coordinate`` and of the constants of the mechanism, whose values are in ``constants``;
    ``meanings`` has the meaning and unit of each name; ``code`` is a function in Python.
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
    """The generated function, evaluated with symbols."""
    import sympy

    signature = re.search(r"^def reduced\((\w+)\):$", code, re.MULTILINE)
    if signature is None:
        raise ValueError("the code has no function `reduced`")
    body = code[signature.end() :]
    coordinate = sympy.Symbol(signature[1], real=True)
    names: dict[str, Any] = {name: getattr(sympy, name) for name in ("atan2", "cos", "sin", "sqrt")}
    names |= {signature[1]: coordinate, "__builtins__": {}}
    meanings = dict(_QUANTITY.findall(body))
    constants: dict[Any, float] = {}
    for name, value, meaning in _ASSIGNMENT.findall(body):
        if meaning:
            # A constant stays a symbol.
            names[name] = sympy.Symbol(name, real=True)
            constants[names[name]] = float(value)
            meanings[name] = meaning
        else:
            names[name] = eval(value, names)  # noqa: S307 - arithmetic only, by the pattern above
    expressions = {name: sympy.sympify(names[name]) for name in _RETURNED.findall(body)}
    return ClosedForm(coordinate, expressions, constants, meanings, code)

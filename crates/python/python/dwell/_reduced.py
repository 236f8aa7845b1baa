"""Reduced models: m q̈ + ½m′ q̇² = Σ w F and R = a q̈ + b q̇² + Σ c F (Jordi, Zayas and Cardona 2008)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np
import numpy.typing as npt

from . import _native

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Coefficients:
    """The coefficients of a reduced model at coordinates ``q``; every array has the shape of ``q``.

    m, half_dm: kg m² (kg if the coordinate is a length). a, b: by reaction, of q̈ and q̇². w: by load, its generalised force per unit of
    its magnitude. c: by load, then by reaction, its contribution per unit of its magnitude.
    """

    q: Array
    m: Array
    half_dm: Array
    a: dict[str, Array]
    b: dict[str, Array]
    w: dict[str, Array]
    c: dict[str, dict[str, Array]]


class ReducedModel:
    """The exact reduced model of a mechanism of one degree of freedom: constant, and safe to use in several threads.

    >>> import dwell, numpy as np
    >>> m = dwell.Builder("Wheel")
    >>> m.body("ground", O=(0, 0)); m.body("wheel", O=(0, 0), mass=2.0, center=(0.1, 0), inertia=0.3)
    >>> model = m.pin("O", "ground", "wheel").actuator("phi", angle=("ground", "wheel")).assemble().reduced(["O"])
    >>> at = model(np.array([0.0, np.pi / 2]))
    >>> at.m, at.b["O.x"].round(12) + 0.0
    (array([0.32, 0.32]), array([-0.2,  0. ]))
    """

    def __init__(self, native: _native.ReducedModel) -> None:
        self._native = native
        self._reactions, self._loads = native.reactions, native.loads

    @property
    def reactions(self) -> list[str]:
        """Names of the reactions."""
        return list(self._reactions)

    @property
    def loads(self) -> list[str]:
        """Names of the loads."""
        return list(self._loads)

    def __call__(self, q: npt.ArrayLike, *, threads: int = 0) -> Coefficients:
        """The coefficients at coordinates q (rad or m) of any shape, on all cores or on ``threads`` of them. The arrays of one
        reaction are views of one block.

        Raises DwellError for the first coordinate that the mechanism cannot reach.
        """
        wanted = np.asarray(q, dtype=np.float64)
        flat = np.ascontiguousarray(wanted).reshape(-1)
        m, half_dm, a, b, w, c = self._native.coefficients(flat, threads)
        shape, names, loads = wanted.shape, self._reactions, self._loads

        def by_name(values: Array, names: Sequence[str]) -> dict[str, Array]:
            if len(names) == 1:
                return {names[0]: values.reshape(shape)}
            columns = values.reshape(*shape, len(names))
            return {name: columns[..., k] for k, name in enumerate(names)}

        shares = c.reshape(*shape, len(loads), len(names)) if loads else c
        return Coefficients(
            q=wanted,
            m=m.reshape(shape),
            half_dm=half_dm.reshape(shape),
            a=by_name(a, names),
            b=by_name(b, names),
            w=by_name(w, loads) if loads else {},
            c={load: {name: shares[..., k, r] for r, name in enumerate(names)} for k, load in enumerate(loads)},
        )

    def table(self, accuracy: float = 1e-9) -> Table:
        """The model as piecewise polynomials; ``accuracy`` bounds the error of every coefficient relative to its largest value. Raises DwellError if
        no table reaches it."""
        return Table(self._native.table(accuracy), self.reactions, self.loads)


class Table:
    """A reduced model as piecewise polynomials, independent of the mechanism."""

    def __init__(self, native: _native.Table, reactions: Sequence[str], loads: Sequence[str]) -> None:
        self._native = native
        self.reactions, self.loads = list(reactions), list(loads)

    @property
    def error_bound(self) -> float:
        """An upper bound of the error of a coefficient, relative to its largest value."""
        return self._native.error_bound

    def __call__(self, q: float) -> Coefficients:
        """The coefficients at one coordinate, rad or m. Raises DwellError outside the table."""
        m, half_dm, a, b, w, c = self._native.at(float(q))

        def named(values: Sequence[float]) -> dict[str, Array]:
            return {name: np.float64(value) for name, value in zip(self.reactions, values)}  # type: ignore[misc]

        return Coefficients(
            q=np.asarray(q, dtype=np.float64),
            m=np.asarray(m),
            half_dm=np.asarray(half_dm),
            a=named(a),
            b=named(b),
            w={load: np.asarray(value) for load, value in zip(self.loads, w)},
            c={load: named(values) for load, values in zip(self.loads, c)},
        )

    def to_text(self) -> str:
        """The text that ``docs/table-format.md`` describes, for other programs."""
        return self._native.to_text()

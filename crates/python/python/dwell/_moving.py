"""Results of machines: equilibria, linearised motions, cycles, periods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Period:
    """The period of a conservative motion, s, and its energy, J."""

    period: float
    energy: float


@dataclass(frozen=True)
class Equilibrium:
    """An equilibrium: free coordinates (rad or m); stability "asymptotic", "centre", "unstable", "neutral" or "undecided"; modes as
    (angular frequency in rad/s, damping ratio); eigenvalues, 1/s."""

    coordinates: Array
    stability: str
    modes: list[tuple[float, float]]
    eigenvalues: npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Gradient:
    """A result with its derivatives by the numbers of the scene at ``paths``: in its unit per unit of the number.

    errors: estimated errors of derivatives by differences, zero of exact ones. ties: coordinates (rad or m) at which other extrema are as
    large; the derivative is that of one of them.
    """

    name: str
    unit: str
    value: float
    paths: list[str]
    units: list[str]
    values: Array
    derivatives: Array
    errors: Array
    ties: list[float]

    def __getitem__(self, path: str) -> float:
        """The derivative by a number; zero by one on which the result does not depend."""
        return float(self.derivatives[self.paths.index(path)]) if path in self.paths else 0.0


@dataclass(frozen=True)
class StateSpace:
    """A linearised motion, ẋ = A x + B u, z = C x + D u, in deviations from the operating point.

    Use it as ``scipy.signal.StateSpace(*s.matrices)`` or ``control.ss(*s.matrices)``.
    """

    states: list[str]
    inputs: list[str]
    outputs: list[str]
    operating_point: Array
    a: Array
    b: Array
    c: Array
    d: Array
    eigenvalues: npt.NDArray[np.complex128]

    @property
    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """The matrices A, B, C and D."""
        return self.a, self.b, self.c, self.d


@dataclass(frozen=True)
class Cycle:
    """A steady cycle: period (s), mean speed (rad/s), coefficient of fluctuation, whether a small disturbance decays, the work of each
    load and drive in a cycle (J), and the moment of inertia to be added for the requested fluctuation (kg m²)."""

    period: float
    mean_speed: float
    fluctuation: float
    is_stable: bool
    works: dict[str, float]
    flywheel: float | None


def complex_numbers(pairs: list[list[float]]) -> npt.NDArray[np.complex128]:
    """Pairs of real and imaginary parts as one array."""
    array = np.array(pairs, dtype=np.float64).reshape(-1, 2)
    return array[:, 0] + 1j * array[:, 1]

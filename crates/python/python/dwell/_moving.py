"""What assembled mechanisms in the plane and in space have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Sequence, TypeVar

import numpy as np
import numpy.typing as npt

from . import _native
from ._progress import Progress
from ._reduced import Coefficients, ReducedModel
from ._results import Motion, Results

if TYPE_CHECKING:
    from ._drawing import Drawn

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
class StateSpace:
    """A linearised motion, ẋ = A x + B u, z = C x + D u, in deviations from the operating point.

    ``scipy.signal.StateSpace(*s.matrices)`` and ``control.ss(*s.matrices)`` take it.
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
        """A, B, C, D."""
        return self.a, self.b, self.c, self.d


@dataclass(frozen=True)
class Cycle:
    """A steady cycle: period (s), mean speed (rad/s), coefficient of fluctuation, whether a small disturbance decays, the work of each
    load and drive in a cycle (J), and the moment of inertia to be added for the fluctuation that was asked for (kg m²)."""

    period: float
    mean_speed: float
    fluctuation: float
    is_stable: bool
    works: dict[str, float]
    flywheel: float | None


Native = TypeVar("Native", bound="_native.Mechanism | _native.SpaceMechanism")


class AssembledMechanism(Generic[Native]):
    """An assembled mechanism: constant, and safe to use in several threads. Coordinates are those of the actuators, in their order.

    In a notebook it shows itself as a picture; ``plot()`` draws it with matplotlib.
    """

    _native: Native

    @property
    def actuators(self) -> list[str]:
        """Names of the coordinates."""
        return self._native.actuators

    @property
    def reactions(self) -> list[str]:
        """Names of all reactions: ``joint.component``."""
        return self._native.reactions

    @property
    def limits(self) -> tuple[float, float] | None:
        """The limits of the only coordinate, rad or m, if it has any."""
        return self._native.limits

    @property
    def points(self) -> dict[str, list[str]]:
        """The bodies with their named points."""
        return dict(self._native.points)

    @property
    def start(self) -> Array:
        """The coordinates at assembly, rad or m."""
        return np.array(self._native.start)

    def reduced(self, reactions: Sequence[str] | None = None) -> ReducedModel:
        """The reduced model with these reactions: joints (``A``) or components (``guide.normal``); without a list, all of them.

        Raises DwellError unless there is exactly one actuator.
        """
        return ReducedModel(self._native.reduced(list(self._all_reactions() if reactions is None else reactions)))

    def reduce(self, q: npt.ArrayLike, reactions: Sequence[str] | None = None, *, threads: int = 0) -> Coefficients:
        """``reduced(reactions)(q)``: m, ½m′, a, b, w and c at coordinates of any shape."""
        return self.reduced(reactions)(q, threads=threads)

    def kinematics(self) -> Results:
        """Positions, velocities and accelerations along the scene's prescribed motion or coordinate sweep: the columns of
        ``dwell kinematics``."""
        with Progress("kinematics") as progress:
            return Motion(self._native.kinematics(progress)).check()

    def statics(self) -> Results:
        """Actuator forces and reactions at rest in every position of the prescribed motion or coordinate sweep."""
        with Progress("statics") as progress:
            return Motion(self._native.statics(progress)).check()

    def kinetostatics(self) -> Results:
        """Everything of ``kinematics`` and the forces that the motion needs."""
        with Progress("kinetostatics") as progress:
            return Motion(self._native.kinetostatics(progress)).check()

    def simulate(
        self,
        accuracy: float | None = None,
        *,
        method: str | None = None,
        tolerance: float = 1e-10,
        sample_interval: float | None = None,
    ) -> Motion:
        """The free motion of the scene under its loads, drives and friction.

        accuracy: the cheapest method that reaches it, with an error estimate. Otherwise ``method`` ("bdf", "esdirk34", "tr-bdf2",
        "tsit45", "dop853") with a relative and absolute tolerance; without either, BDF at 1e-10, as the command. sample_interval: s; absent, a thousandth of the duration.
        """
        with Progress("simulate") as progress:
            return Motion(self._native.simulate(accuracy, method, tolerance, sample_interval, progress))

    def period(self) -> Period:
        """Period and energy of the free motion, by quadrature: one free coordinate, conservative loads."""
        with Progress("period") as progress:
            return Period(*self._native.period(progress))

    def equilibria(self) -> list[Equilibrium]:
        """The equilibria, with stability and modes."""
        with Progress("equilibria") as progress:
            found = self._native.equilibria(progress)
        return [
            Equilibrium(np.array(e["coordinates"]), e["stability"], e["modes"], _complex(e["eigenvalues"])) for e in found
        ]

    def linearise(self) -> StateSpace:
        """Small motions about the equilibrium nearest to the initial state."""
        with Progress("linearise") as progress:
            found = self._native.linearise(progress)
        states, inputs, outputs = found["states"], found["inputs"], found["outputs"]

        def matrix(rows: list[list[float]], height: int, width: int) -> Array:
            return np.array(rows, dtype=np.float64).reshape(height, width)

        return StateSpace(
            states,
            inputs,
            outputs,
            np.array(found["operating_point"]),
            matrix(found["a"], len(states), len(states)),
            matrix(found["b"], len(states), len(inputs)),
            matrix(found["c"], len(outputs), len(states)),
            matrix(found["d"], len(outputs), len(inputs)),
            _complex(found["eigenvalues"]),
        )

    def cycle(
        self,
        accuracy: float | None = None,
        *,
        method: str | None = None,
        tolerance: float = 1e-10,
        fluctuation: float | None = None,
    ) -> Cycle:
        """The steady cycle of a rotating machine, and the flywheel that keeps its coefficient of fluctuation to ``fluctuation``."""
        with Progress("cycle") as progress:
            found = self._native.cycle(accuracy, method, tolerance, fluctuation, progress)
        return Cycle(
            period=found["period"],
            mean_speed=found["mean_speed"],
            fluctuation=found["fluctuation"],
            is_stable=found["is_stable"],
            works=dict(found["works"]),
            flywheel=found["flywheel"],
        )

    def plot(self: Drawn, q: float | Sequence[float] | None = None, **options: Any) -> Any:
        """Draws the mechanism with matplotlib at coordinates q (absent: at assembly). Returns the axes."""
        from ._drawing import plot_mechanism

        return plot_mechanism(self, q, **options)

    def animate(self: Drawn, motion: Results | None = None, *, frames: int = 120, interval: float = 40.0) -> Any:
        """A matplotlib animation over a motion, or over the range of the only coordinate. interval: ms between frames."""
        from ._drawing import animate_mechanism

        return animate_mechanism(self, motion, frames, interval)

    def _repr_svg_(self: Drawn) -> str:
        from ._drawing import svg

        return svg(self)

    def _all_reactions(self) -> list[str]:
        """The reactions of a reduced model for which none are named."""
        return self.reactions

    def _coordinates(self, values: float | Sequence[float]) -> list[float]:
        """A number for each actuator: one stands for all of them."""
        array = np.asarray(values, dtype=np.float64)
        return [float(array)] * len(self.actuators) if array.ndim == 0 else [float(value) for value in array]


def _complex(pairs: list[list[float]]) -> npt.NDArray[np.complex128]:
    array = np.array(pairs, dtype=np.float64).reshape(-1, 2)
    return array[:, 0] + 1j * array[:, 1]

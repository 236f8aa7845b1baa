"""Assembled mechanisms and their results."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Callable, Sequence

import numpy as np
import numpy.typing as npt

from . import _native
from ._moving import Cycle, Equilibrium, Gradient, Period, StateSpace, complex_numbers
from ._progress import Progress
from ._reduced import Coefficients, ReducedModel
from ._results import Motion, Results

if TYPE_CHECKING:
    from ._scene import Scene

Array = npt.NDArray[np.float64]


class State:
    """Positions, velocities, accelerations and forces at one position. Points are ``body.point``, reactions ``joint.component``.

    Vectors are in the axes of the ground. Positions, velocities and accelerations have two numbers in the plane and three in space; angular
    quantities are a number in the plane, about z, and three numbers in space.
    """

    def __init__(self, native: _native.State) -> None:
        self._native = native

    def position(self, point: str) -> Array:
        """Position of a point in the ground's frame, m."""
        return np.array(self._native.position(point))

    def velocity(self, point: str) -> Array:
        """Velocity of a point, m/s."""
        return np.array(self._native.velocity(point))

    def acceleration(self, point: str) -> Array:
        """Acceleration of a point, m/s²."""
        return np.array(self._native.acceleration(point))

    def angle(self, body: str) -> float:
        """Angle of a body in the plane from the ground, rad. Raises DwellError in space, where a body has a ``rotation``."""
        return self._native.angle(body)

    def rotation(self, body: str) -> Array:
        """The rotation of a body as a matrix of 3 × 3: its columns are the axes of the body's frame in the axes of the ground."""
        return np.array(self._native.axes(body)).T

    def angular_velocity(self, body: str) -> Any:
        """Angular velocity of a body, rad/s."""
        return _turning(self._native.angular_velocity(body))

    def angular_acceleration(self, body: str) -> Any:
        """Angular acceleration of a body, rad/s²."""
        return _turning(self._native.angular_acceleration(body))

    def coordinate(self, name: str) -> tuple[float, float, float]:
        """A coordinate with its first two derivatives: rad or m, per s, per s²."""
        value, velocity, acceleration = self._native.coordinate(name)
        return value, velocity, acceleration

    def reaction(self, name: str) -> float:
        """A reaction, N or N m: of the joint's first-named body on the second. The component ``magnitude`` is
        the magnitude of the force. Raises DwellError if redundant constraints leave it undetermined."""
        return self._native.reaction(name)

    def actuator_force(self, name: str) -> float:
        """The force, N, or torque, N m, that an actuator must exert."""
        return self._native.actuator_force(name)


def _turning(numbers: list[float]) -> float | Array:
    """A number in the plane, an array in space."""
    return numbers[0] if len(numbers) == 1 else np.array(numbers)


class Mechanism:
    """An assembled mechanism, in the plane or in space: constant, and safe to use in several threads. Coordinates are those of the actuators, in their order.

    A notebook shows it as a picture; ``plot()`` draws it with matplotlib.
    """

    def __init__(self, native: _native.Mechanism, scene: Scene) -> None:
        self._native = native
        self.scene = scene

    @property
    def actuators(self) -> list[str]:
        """Names of the coordinates."""
        return self._native.actuators

    @property
    def reactions(self) -> list[str]:
        """Names of the reactions: ``joint.component``. In space they are those that the scene requests."""
        return self._native.reactions

    @property
    def determined_reactions(self) -> list[str]:
        """The reactions that equilibrium determines."""
        return self._native.determined_reactions

    @property
    def dimension(self) -> int:
        """The number of coordinates of a point: 2 in the plane, 3 in space."""
        return self._native.dimension

    @property
    def limits(self) -> tuple[float, float] | None:
        """The limits of the coordinate, rad or m; None unless the mechanism has exactly one coordinate with limits."""
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
        """The reduced model with these reactions: joints (``A``) or components (``guide.normal``); by default all that
        equilibrium determines.

        Raises DwellError unless there is exactly one actuator.
        """
        return ReducedModel(self._native.reduced(list(self._native.determined_reactions if reactions is None else reactions)))

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
        """The columns of ``kinematics``, and the forces of the motion."""
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

        accuracy: selects the cheapest method that reaches it, with an error estimate. Otherwise ``method`` ("bdf", "esdirk34", "tr-bdf2",
        "tsit45", "dop853") with a relative and absolute tolerance; the default is BDF at 1e-10, as for the command. sample_interval: s (default: a thousandth of the duration).
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
            Equilibrium(np.array(e["coordinates"]), e["stability"], e["modes"], complex_numbers(e["eigenvalues"])) for e in found
        ]

    def gradient(self, results: list[str]) -> list[Gradient]:
        """The derivatives of results of ``sweep`` by all numbers of the scene, in its units, the strongest first.

        They are exact where a result is an extremum, a mean or a sum along the trajectory, an extremum of m or a period; otherwise by
        differences, with an estimated error.
        """
        with Progress("gradient") as progress:
            found = self._native.gradient(results, progress)
        return [
            Gradient(
                r["name"],
                r["unit"],
                r["value"],
                r["paths"],
                r["units"],
                np.array(r["values"]),
                np.array(r["derivatives"]),
                np.array(r["errors"]),
                r["ties"],
            )
            for r in found
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
            complex_numbers(found["eigenvalues"]),
        )

    def cycle(
        self,
        accuracy: float | None = None,
        *,
        method: str | None = None,
        tolerance: float = 1e-10,
        fluctuation: float | None = None,
    ) -> Cycle:
        """The steady cycle of a rotating machine, and the flywheel for the coefficient of fluctuation ``fluctuation``."""
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

    def plot(self, q: float | Sequence[float] | None = None, **options: Any) -> Any:
        """Draws the mechanism with matplotlib at coordinates q (default: at assembly). Returns the axes."""
        from ._drawing import plot_mechanism

        return plot_mechanism(self, q, **options)

    def animate(self, motion: Results | None = None, *, frames: int = 120, interval: float = 40.0) -> Any:
        """A matplotlib animation over a motion, or over the range of the only coordinate. interval: ms between frames."""
        from ._drawing import animate_mechanism

        return animate_mechanism(self, motion, frames, interval)

    def _repr_svg_(self) -> str:
        # The width suits a text column; the height follows from the drawing.
        return re.sub('width="[0-9]+" height="[0-9]+"', 'width="640"', self._native.svg(list(self.start)), count=1)

    def _coordinates(self, values: float | Sequence[float]) -> list[float]:
        """A number for each actuator; a single number applies to all."""
        array = np.asarray(values, dtype=np.float64)
        return [float(array)] * len(self.actuators) if array.ndim == 0 else [float(value) for value in array]

    def at(
        self,
        q: float | Sequence[float],
        q_dot: float | Sequence[float] = 0.0,
        q_ddot: float | Sequence[float] = 0.0,
        *,
        t: float = 0.0,
    ) -> State:
        """State and forces at coordinates q, velocities and accelerations, under all loads at time t (s): inverse dynamics. At
        rest this is statics. A single number applies to all coordinates.

        Raises DwellError if the mechanism cannot reach q.
        """
        return State(self._native.at(self._coordinates(q), self._coordinates(q_dot), self._coordinates(q_ddot), float(t)))

    def paths(self, points: str | Sequence[str], q: npt.ArrayLike) -> Array:
        """Positions of points ``body.point`` at many coordinates, m. Only positions are computed.

        q: coordinates of any shape, rad or m; with several actuators its last axis has one coordinate for each. The result has the shape
        of the positions, then an axis for the points (omitted for one name), then x and y, and z in space::

            x, y = mechanism.paths("coupler.P", np.linspace(0, 2 * np.pi, 361)).T

        Raises DwellError for an unknown point, and for the first position that the mechanism cannot reach.
        """
        names = [points] if isinstance(points, str) else list(points)
        wanted = np.ascontiguousarray(q, dtype=np.float64)
        count = len(self.actuators)
        shape = wanted.shape if count == 1 else wanted.shape[:-1]
        if count != 1 and wanted.shape[-1:] != (count,):
            raise ValueError(f"the last axis of q must have the coordinates of {count} actuators: {', '.join(self.actuators)}")
        found = self._native.paths(names, wanted.reshape(-1)).reshape(*shape, len(names), 3)
        found = found[..., : self._native.dimension]
        return found[..., 0, :] if isinstance(points, str) else found

    def rhs(self) -> tuple[Callable[[float, Array], Array], Callable[[float, Array], Array], Array]:
        """The free motion as plain functions for an integrator such as ``scipy.integrate.solve_ivp``: f(t, y), its Jacobian, and the
        state at t = 0. States: free coordinates, their velocities, states of drives and contacts, works of the sources without a
        potential. The functions share one working memory: call them from one thread at a time.
        """
        equation = self._native.equation()
        states = len(equation.initial_state)

        def f(t: float, y: Array) -> Array:
            return equation.rates(t, np.asarray(y, dtype=np.float64))

        def jacobian(t: float, y: Array) -> Array:
            return equation.jacobian(t, np.asarray(y, dtype=np.float64)).reshape(states, states)

        return f, jacobian, equation.initial_state

    def __repr__(self) -> str:
        return f"Mechanism({self.scene.title!r}, driven by {', '.join(self.actuators)})"

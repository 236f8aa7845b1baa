"""Assembled mechanisms in the plane, and what can be asked of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Callable, Sequence

import numpy as np
import numpy.typing as npt

from . import _native
from ._moving import AssembledMechanism

if TYPE_CHECKING:
    from ._scene import Scene

Array = npt.NDArray[np.float64]


class State:
    """Positions, velocities, accelerations and forces at one position. Points are ``body.point``, reactions ``joint.component``."""

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
        """Angle of a body from the ground, rad."""
        return self._native.angle(body)

    def angular_velocity(self, body: str) -> float:
        """Angular velocity of a body, rad/s."""
        return self._native.angular_velocity(body)

    def angular_acceleration(self, body: str) -> float:
        """Angular acceleration of a body, rad/s²."""
        return self._native.angular_acceleration(body)

    def coordinate(self, name: str) -> tuple[float, float, float]:
        """A coordinate with its first two derivatives: rad or m, per s, per s²."""
        value, velocity, acceleration = self._native.coordinate(name)
        return value, velocity, acceleration

    def reaction(self, name: str) -> float:
        """A reaction, N or N m: of the joint's first-named body on the second. ``magnitude`` of a pin is the length of (x, y)."""
        return self._native.reaction(name)

    def actuator_force(self, name: str) -> float:
        """The force, N, or torque, N m, that an actuator must exert."""
        return self._native.actuator_force(name)


class Mechanism(AssembledMechanism[_native.Mechanism]):
    """An assembled mechanism: constant, and safe to use in several threads. Coordinates are those of the actuators, in their order.

    In a notebook it shows itself as a picture; ``plot()`` draws it with matplotlib.
    """

    def __init__(self, native: _native.Mechanism, scene: Scene) -> None:
        self._native = native
        self.scene = scene

    def at(
        self,
        q: float | Sequence[float],
        q_dot: float | Sequence[float] = 0.0,
        q_ddot: float | Sequence[float] = 0.0,
        *,
        t: float = 0.0,
    ) -> State:
        """State and forces with coordinates q, velocities and accelerations, under all loads at time t (s): the inverse dynamics. At
        rest it is statics. A number stands for the only coordinate, or for all of them.

        Raises DwellError where the mechanism cannot reach q.
        """
        return State(self._native.at(self._coordinates(q), self._coordinates(q_dot), self._coordinates(q_ddot), float(t)))

    def paths(self, points: str | Sequence[str], q: npt.ArrayLike) -> Array:
        """Where points ``body.point`` are at many positions, m. Only positions are computed.

        q: coordinates of any shape, rad or m; with several actuators its last axis has one coordinate for each. The result has the shape
        of the positions, then an axis for the points (absent for one name), then x and y::

            x, y = mechanism.paths("coupler.P", np.linspace(0, 2 * np.pi, 361)).T

        Raises DwellError for an unknown point, and for the first position that the mechanism cannot reach.
        """
        names = [points] if isinstance(points, str) else list(points)
        wanted = np.ascontiguousarray(q, dtype=np.float64)
        count = len(self.actuators)
        shape = wanted.shape if count == 1 else wanted.shape[:-1]
        if count != 1 and wanted.shape[-1:] != (count,):
            raise ValueError(f"the last axis of q must have the coordinates of {count} actuators: {', '.join(self.actuators)}")
        found = self._native.paths(names, wanted.reshape(-1)).reshape(*shape, len(names), 2)
        return found[..., 0, :] if isinstance(points, str) else found

    def rhs(self) -> tuple[Callable[[float, Array], Array], Callable[[float, Array], Array], Array]:
        """The free motion as plain functions for an integrator such as ``scipy.integrate.solve_ivp``: f(t, y), its Jacobian, and the
        state at t = 0. States: free coordinates, their velocities, states of drives and contacts, works of the sources without a
        potential. The functions share one working memory: one thread at a time.
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

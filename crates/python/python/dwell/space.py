"""Mechanisms in space: scenes whose points have three numbers.

>>> import dwell
>>> scene = dwell.space.Scene('''
... bodies.ground.points = { O = [0, 0, 0] }
... bodies.bob = { points = { O = [0, 0, 0], P = [0.5, 0, 0] }, mass = 2.0, center = [0.5, 0, 0] }
... joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 1, 0] }
... actuators.phi = { angle = "O" }
... assembly.phi = 0.0
... loads.weight = { gravity = [0, 0, -9.81] }
... ''')
>>> bob = scene.assemble()
>>> state = bob.at(0.0)
>>> round(state.actuator_force("phi"), 6), state.position("bob.P").tolist()  # held horizontally, N m
(-9.81, [0.5, 0.0, 0.0])

The calls and the units are those of mechanisms in the plane; positions, velocities, accelerations and rotations have three numbers, in
the axes of the ground. Scenes are written as text: there is no builder.
"""

from __future__ import annotations

import os
import pathlib
import warnings
from typing import Sequence

import numpy as np
import numpy.typing as npt

from . import _native
from ._export import write_export
from ._moving import AssembledMechanism
from ._reduced import Coefficients
from ._results import Motion, Results

__all__ = ["Mechanism", "Scene", "State", "read"]

Array = npt.NDArray[np.float64]


class State:
    """Positions, velocities, accelerations and forces at one position. Points are ``body.point``, reactions ``joint.component``."""

    def __init__(self, native: _native.SpaceState) -> None:
        self._native = native

    def position(self, point: str) -> Array:
        """Position of a point, m."""
        return np.array(self._native.position(point))

    def velocity(self, point: str) -> Array:
        """Velocity of a point, m/s."""
        return np.array(self._native.velocity(point))

    def acceleration(self, point: str) -> Array:
        """Acceleration of a point, m/s²."""
        return np.array(self._native.acceleration(point))

    def rotation(self, body: str) -> Array:
        """The rotation of a body as a matrix of 3 × 3: its columns are the axes of the body's frame in the axes of the ground."""
        return np.array(self._native.axes(body)).T

    def angular_velocity(self, body: str) -> Array:
        """Angular velocity of a body, rad/s."""
        return np.array(self._native.angular_velocity(body))

    def angular_acceleration(self, body: str) -> Array:
        """Angular acceleration of a body, rad/s²."""
        return np.array(self._native.angular_acceleration(body))

    def reaction(self, name: str) -> float:
        """A reaction, N or N m about the joint's point: of the joint's first-named body on the second. Raises DwellError where
        redundant constraints leave it open."""
        return self._native.reaction(name)

    def actuator_force(self, name: str) -> float:
        """The force, N, or torque, N m, that an actuator must exert."""
        return self._native.actuator_force(name)


class Mechanism(AssembledMechanism[_native.SpaceMechanism]):
    """An assembled mechanism in space: constant, and safe to use in several threads."""

    def __init__(self, native: _native.SpaceMechanism, scene: Scene) -> None:
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
        """State and forces with coordinates q, velocities and accelerations, under all loads at time t (s). At rest it is statics. A
        number stands for the only coordinate, or for all of them.

        Raises DwellError where the mechanism cannot reach q.
        """
        return State(self._native.at(self._coordinates(q), self._coordinates(q_dot), self._coordinates(q_ddot), float(t)))

    def _all_reactions(self) -> list[str]:
        return self._native.determined_reactions

    def __repr__(self) -> str:
        return f"space.Mechanism({self.scene.title!r}, driven by {', '.join(self.actuators)})"


class Scene:
    """A scene in space, from its text; ``Scene.read(path)`` reads a file. The format is that of the ``dwell`` command."""

    def __init__(self, text: str, *, _native_scene: _native.SpaceScene | None = None) -> None:
        self._native = _native.SpaceScene(text) if _native_scene is None else _native_scene
        for message in self._native.warnings:
            warnings.warn(message, stacklevel=2)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a scene file. Raises SceneError with line, column and help."""
        return cls("", _native_scene=_native.SpaceScene.read(os.fspath(path)))

    @property
    def title(self) -> str:
        """Its title."""
        return self._native.title

    @property
    def text(self) -> str:
        """Its text, with what ``with_value`` changed."""
        return self._native.text

    def value(self, path: str) -> float:
        """A number by its path, in the scene's own unit: ``crank.mass``, ``crank.inertia[2]``, ``joints.A.axis[0]``."""
        return self._native.value(path)

    def with_value(self, path: str, value: float) -> Scene:
        """The same scene with a number replaced."""
        return Scene("", _native_scene=self._native.with_value(path, value))

    def export(self, target: str, folder: str | os.PathLike[str] = ".", *, accuracy: float = 1e-9) -> list[pathlib.Path]:
        """Writes the machine as code into a folder, and returns the files, as ``dwell.Scene.export`` does. Loops in space have no exact
        code."""
        return write_export(self._native, target, folder, accuracy)

    def check(self) -> str:
        """What ``dwell check`` prints: degrees of freedom, range, groups, placements and reactions."""
        return self._native.check()

    def assemble(self) -> Mechanism:
        """Assembles its mechanism. Raises SceneError where it cannot be assembled or a load does not fit it."""
        return Mechanism(self._native.assemble(), self)

    def reduce(self, q: npt.ArrayLike, reactions: Sequence[str] | None = None, *, threads: int = 0) -> Coefficients:
        """``assemble().reduce(q, reactions)``."""
        return self.assemble().reduce(q, reactions, threads=threads)

    def kinetostatics(self) -> Results:
        """``assemble().kinetostatics()``."""
        return self.assemble().kinetostatics()

    def simulate(self, accuracy: float | None = None) -> Motion:
        """``assemble().simulate(accuracy)``."""
        return self.assemble().simulate(accuracy)

    def __repr__(self) -> str:
        return f"space.Scene({self.title!r})"


def read(path: str | os.PathLike[str]) -> Mechanism:
    """Reads a scene file and assembles its mechanism: ``Scene.read(path).assemble()``."""
    return Scene.read(path).assemble()

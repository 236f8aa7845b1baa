"""Kinematics, forces, the reduced model and motions of mechanisms, in the plane and in space.

A mechanism is read from a scene file, or built, and then assembled:

>>> import numpy as np, dwell
>>> m = dwell.Builder("Pendulum")
>>> m.body("ground", O=(0, 0))
>>> m.body("bob", O=(0, 0), P=(0, -0.5), mass=2.0, center="P", inertia=0.0)
>>> m.pin("O", "ground", "bob").actuator("phi", angle=("ground", "bob")).load("weight", gravity=(0, -9.81))
Builder('Pendulum')
>>> bob = m.assemble()
>>> round(bob.at(np.pi / 2).actuator_force("phi"), 6)  # held horizontally, N m
9.81

A mechanism whose points have three numbers is in space:

>>> scene = dwell.Scene('''
... bodies.ground.points = { O = [0, 0, 0] }
... bodies.bob = { points = { O = [0, 0, 0], P = [0.5, 0, 0] }, mass = 2.0, center = [0.5, 0, 0] }
... joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 1, 0] }
... actuators.phi = { angle = "O" }
... assembly.phi = 0.0
... loads.weight = { gravity = [0, 0, -9.81] }
... ''')
>>> state = scene.assemble().at(0.0)
>>> round(state.actuator_force("phi"), 6), state.position("bob.P").tolist()
(-9.81, [0.5, 0.0, 0.0])

All units are SI: m, rad, kg, s, N. Reactions are named ``joint.component``: the force or moment of the joint's first-named body
on the second. Points are named ``body.point``. Results have units, and convert to pandas, polars and xarray if these are
installed.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ._builder import Builder
from ._closed_form import ClosedForm
from ._cluster import StoredSweep
from ._import import import_model
from ._mechanism import Mechanism, State
from ._moving import Cycle, Equilibrium, Gradient, Period, StateSpace
from ._native import DwellError, SceneError, __version__
from ._reduced import Coefficients, ReducedModel, Table
from ._results import Motion, Results
from ._scene import Scene
from ._sweep import sweep
from ._validate import validate

__all__ = [
    "Builder",
    "ClosedForm",
    "Coefficients",
    "Cycle",
    "DwellError",
    "Equilibrium",
    "Gradient",
    "Mechanism",
    "Motion",
    "Period",
    "ReducedModel",
    "Results",
    "Scene",
    "SceneError",
    "State",
    "StateSpace",
    "StoredSweep",
    "Table",
    "__version__",
    "import_model",
    "read",
    "sweep",
    "validate",
]


if not TYPE_CHECKING:

    def __getattr__(name):
        if name == "space":
            raise AttributeError("dwell.space is gone: dwell.Scene and dwell.read take mechanisms in space, too")
        raise AttributeError(f"module 'dwell' has no attribute {name!r}")


def read(path: str | os.PathLike[str]) -> Mechanism:
    """Reads a scene file and assembles its mechanism: ``Scene.read(path).assemble()``.

    Raises SceneError with all errors in the file, each with its place.
    """
    return Scene.read(path).assemble()

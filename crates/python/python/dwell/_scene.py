"""Scenes: the description of a mechanism, read and checked."""

from __future__ import annotations

import os
import pathlib
import warnings
from typing import TYPE_CHECKING, Callable, Literal, Mapping, Sequence

import numpy.typing as npt

from . import _native
from ._closed_form import ClosedForm, closed_form
from ._export import write_export
from ._mechanism import Mechanism

if TYPE_CHECKING:
    from ._reduced import Coefficients
    from ._results import Motion, Results


class Scene:
    """A scene, from its text; ``Scene.read(path)`` reads a file. The format is that of the ``dwell`` command.

    >>> scene = Scene('''
    ... bodies.ground.points = { O = [0, 0] }
    ... bodies.bob = { points = { O = [0, 0] }, mass = 2.0, center = [0.5, 0] }
    ... joints.O = { revolute = ["ground.O", "bob.O"] }
    ... actuators.phi = { angle = ["ground", "bob"] }
    ... ''')
    >>> scene.value("bob.mass")
    2.0
    >>> Scene("bodies = 3").title
    Traceback (most recent call last):
    dwell.SceneError: ...
    """

    def __init__(self, text: str, *, _native_scene: _native.Scene | None = None) -> None:
        self._native = _native.Scene(text) if _native_scene is None else _native_scene
        for message in self._native.warnings:
            warnings.warn(message, stacklevel=2)

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a scene file. Raises SceneError with line, column and help."""
        return cls._of(_native.Scene.read(os.fspath(path)))

    @classmethod
    def _of(cls, native: _native.Scene) -> Scene:
        return cls("", _native_scene=native)

    @property
    def title(self) -> str:
        """Its title."""
        return self._native.title

    @property
    def text(self) -> str:
        """Its text, with the changes of ``with_value``."""
        return self._native.text

    def value(self, path: str) -> float:
        """A number by its path, in the scene's own unit: ``crank.mass``, ``rod.points.C[0]``, ``loads.brake.damping``."""
        return self._native.value(path)

    def with_value(self, path: str, value: float) -> Scene:
        """A copy of the scene with a number replaced."""
        return Scene._of(self._native.with_value(path, value))

    def with_function(
        self,
        load: str,
        signals: Sequence[str],
        function: Callable[..., float],
        *,
        breakpoints: Mapping[str, Sequence[float]] | Literal[False] | None = None,
    ) -> Scene:
        """A copy of the scene whose load has a magnitude given by a Python function.

        The function is called with the signals, in their order: ``t`` (s), coordinates (rad or m), velocities such as ``phi.velocity``.
        One call costs about 1 µs more than an expression. Jumps and kinks of the function are not searched: give the values of the
        signals at which they occur, ``breakpoints={"x.velocity": [-0.02], "t": [0.5]}``. The integration of a motion stops at each of them and restarts,
        as with an expression. An unnamed jump makes the steps so short that the motion ends there, and a short pulse may be
        missed. ``breakpoints=False`` states that the function is smooth; without either, a warning is issued.

        If the function raises an exception, the evaluation fails and names the load.
        """
        if breakpoints is None:
            warnings.warn(
                f"`{load}` is a Python function: where it switches is not known, and a motion may step over a short pulse of it "
                "(breakpoints={signal: [values]} names where it switches, breakpoints=False says that it is smooth)",
                stacklevel=2,
            )
        named = [(signal, [float(value) for value in values]) for signal, values in (breakpoints or {}).items()]
        return Scene._of(self._native.with_function(load, list(signals), function, named))

    def export(self, target: str, folder: str | os.PathLike[str] = ".", *, accuracy: float = 1e-9) -> list[pathlib.Path]:
        """Writes the machine as code into a folder, and returns the files: ``"c"`` (C99), ``"exact-c"`` (the model's own operations),
        ``"rust"`` (a crate without the standard library), ``"matlab"`` (also for Octave), ``"fmu"`` (FMI 3.0; ``"fmu2"``: FMI 2.0) or
        ``"exact-fmu"`` (``"exact-fmu2"``). An FMU has a library for this platform if a C compiler is found, otherwise sources only.

        With cells, the error of every function of the coordinate is at most ``accuracy`` times its largest value; exact code has rounding errors only. Raises
        SceneError if the machine cannot be exported, with a suggestion.

        >>> import dwell, tempfile
        >>> m = dwell.Builder("Pendulum")
        >>> m.body("ground", O=(0, 0))
        >>> m.body("bob", O=(0, 0), P=(0, -0.5), mass=2.0, center="P")
        >>> scene = m.pin("O", "ground", "bob").actuator("phi", angle=("ground", "bob")).scene()
        >>> [path.name for path in scene.export("c", tempfile.mkdtemp())]
        ['scene.h', 'scene.c']
        """
        return write_export(self._native, target, folder, accuracy)

    def symbolic(self, reaction: str | None = None) -> ClosedForm:
        """Closed forms of positions, m, half_dm, and a and b of a reaction (of the first that the scene requests), as SymPy objects.

        For mechanisms made of dyads. Needs SymPy. Raises SceneError if there is no closed form.
        """
        return closed_form(self._native.closed_form(reaction))

    def check(self) -> str:
        """The output of ``dwell check``: degrees of freedom, range, groups, assembly modes, loads and requests."""
        return self._native.check()

    def assemble(self) -> Mechanism:
        """Assembles its mechanism. Raises SceneError if it cannot be assembled or a load does not fit it."""
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
        return f"Scene({self.title!r})"

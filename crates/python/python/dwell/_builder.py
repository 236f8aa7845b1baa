"""The builder of mechanisms: keyword arguments are the keys of a scene file."""

from __future__ import annotations

import json
import math
import re
from typing import Any, Callable, Literal, Mapping, Sequence

from ._mechanism import Mechanism
from ._scene import Scene

_BARE = re.compile(r"[A-Za-z0-9_-]+\Z")
#: The text in place of a Python function; without the function, every evaluation fails and names the load.
_NO_VALUE = "0/(t - t)"


class Builder:
    """Collects the parts of a mechanism; ``assemble()`` assembles it. All numbers are in SI units.

    Keyword arguments are the keys of a scene file, with ``_`` for ``-``. Calls may be chained. A mechanism whose points have three numbers is in
    space.

    >>> m = Builder("Slider-crank")
    >>> m.body("ground", A=(0, 0), G=(0, 0.025))
    >>> m.body("crank", A=(0, 0), B=(0.08, 0), mass=2.0, center=(0.015, 0.002), inertia=0.004)
    >>> m.body("rod", B=(0, 0), C=(0.28, 0), mass=1.2, center=(0.095, 0.003), inertia=0.0085)
    >>> m.body("piston", C=(0, 0), mass=0.9, center=(0, 0), inertia=6e-4)
    >>> _ = m.pin("A", "ground", "crank").pin("B", "crank", "rod").pin("C", "rod", "piston")
    >>> _ = m.joint("guide", prismatic=("ground.G", "piston.C"), axis=(1, 0))
    >>> _ = m.actuator("phi", angle=("ground", "crank")).assembly(rod=0.0)
    >>> m.assemble().actuators
    ['phi']
    """

    def __init__(self, title: str) -> None:
        self.title = title
        self._bodies: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {}
        self._sections: dict[str, dict[str, Any]] = {}
        self._functions: list[
            tuple[str, Sequence[str], Callable[..., float], Mapping[str, Sequence[float]] | Literal[False] | None]
        ] = []
        self._text = ""

    def body(
        self,
        name: str,
        points: Mapping[str, Sequence[float]] | None = None,
        *,
        mass: float | None = None,
        center: Sequence[float] | str | None = None,
        inertia: float | Sequence[float] | None = None,
        **named_points: Sequence[float],
    ) -> None:
        """Adds a body: its points in its own frame (m) as keywords or a mapping, mass (kg), centre of mass (m, or the name of a
        point), moment of inertia about that (kg m²; in space ``(xx, yy, zz)``, or all six elements of the tensor). Without mass it is a massless link; ``ground`` is the fixed body."""
        if name in self._bodies:
            raise ValueError(f"body `{name}` is given twice")
        keys = {"mass": mass, "center": center, "inertia": inertia}
        given = {key: value for key, value in keys.items() if value is not None}
        self._bodies[name] = ({**(points or {}), **named_points}, given)

    def joint(self, name: str, **keys: Any) -> Builder:
        """Adds a joint or coupling by its keys: ``joint("guide", prismatic=("ground.G", "piston.C"), axis=(1, 0))``."""
        return self._add("joints", name, keys)

    def pin(self, name: str, first: str, second: str) -> Builder:
        """Adds a revolute joint between the points with the joint's name on two bodies."""
        return self.joint(name, revolute=(f"{first}.{name}", f"{second}.{name}"))

    def actuator(self, name: str, **keys: Any) -> Builder:
        """Adds an independent coordinate: ``actuator("phi", angle=("ground", "crank"))``, or ``length="guide"``."""
        return self._add("actuators", name, keys)

    def assembly(self, **values: Any) -> Builder:
        """Sets coordinates of actuators at assembly (exact) and initial guesses of the angles of bodies, rad, which select the assembly mode; for bodies
        in space their placements, ``rod={"at": (0.1, 0, 0), "turn": (0, 0.7, 0)}``."""
        self._sections.setdefault("assembly", {}).update(values)
        return self

    def load(
        self, name: str, *, breakpoints: Mapping[str, Sequence[float]] | Literal[False] | None = None, **keys: Any
    ) -> Builder:
        """Adds a load by its keys: ``gravity=(0, -9.81)``, ``force="piston.C", direction=(-1, 0), magnitude="400*cos(phi)"``.

        A magnitude may be a pair (signals, function): ``torque="crank", magnitude=(["phi.velocity"], lambda v: -0.2 * v)``. See
        ``Scene.with_function`` for its cost and for ``breakpoints``.
        """
        magnitude = keys.get("magnitude", keys.get("torque"))
        if isinstance(magnitude, tuple) and len(magnitude) == 2 and callable(magnitude[1]):
            signals, function = magnitude
            self._functions.append((name, list(signals), function, breakpoints))
            keys = {key: _NO_VALUE if value is magnitude else value for key, value in keys.items()}
        return self._add("loads", name, keys)

    def friction(self, joint: str, **keys: Any) -> Builder:
        """Adds Coulomb friction to a joint by its keys: ``friction("guide", coefficient=0.1)``."""
        return self._add("friction", joint, keys)

    def drive(self, name: str, **keys: Any) -> Builder:
        """Adds a drive by its keys."""
        return self._add("drives", name, keys)

    def prescribed(self, duration: float, **laws: Any) -> Builder:
        """Prescribes motions over a duration, s: ``prescribed(2.0, phi={"speed": 10.0})``."""
        self._sections.setdefault("prescribed", {}).update({"duration": duration, **laws})
        return self

    def motion(self, **keys: Any) -> Builder:
        """Sets the free motion: ``motion(duration=5.0, initial_velocity={"phi": 1.0})``."""
        self._sections["motion"] = _dashed(keys)
        return self

    def request(self, **keys: Any) -> Builder:
        """Restricts the computed results: ``request(reactions=["A", "guide.normal"])``."""
        self._sections.setdefault("requests", {}).update(_dashed(keys))
        return self

    def toml(self, text: str) -> Builder:
        """Appends text of the scene format, for sections that have no function here."""
        self._text += "\n" + text + "\n"
        return self

    def to_toml(self) -> str:
        """The mechanism as the text of a scene file. A load that is a Python function has a comment and no value there."""
        lines = [f"title = {_value(self.title)}"]
        for name, (points, keys) in self._bodies.items():
            lines += ["", f"[bodies.{_key(name)}]", f"points = {_value(points)}"]
            lines += [f"{_key(key)} = {_value(value)}" for key, value in keys.items()]
        for section, entries in self._sections.items():
            lines += ["", f"[{section}]"]
            for load, *_ in self._functions if section == "loads" else ():
                place = f"write an expression or a table in place of {_NO_VALUE}"
                lines.append(f"# The magnitude of `{load}` is a function of a program: {place}.")
            lines += [f"{_key(key)} = {_value(value)}" for key, value in entries.items()]
        return "\n".join(lines) + "\n" + self._text

    def scene(self) -> Scene:
        """The scene of this mechanism. Raises SceneError with all errors."""
        scene = Scene(self.to_toml())
        for load, signals, function, breakpoints in self._functions:
            scene = scene.with_function(load, signals, function, breakpoints=breakpoints)
        return scene

    def assemble(self) -> Mechanism:
        """Assembles the mechanism. Raises SceneError with all errors, which name bodies and joints."""
        return self.scene().assemble()

    def _add(self, section: str, name: str, keys: Mapping[str, Any]) -> Builder:
        entries = self._sections.setdefault(section, {})
        if name in entries:
            raise ValueError(f"`{name}` is given twice among the {section}")
        entries[name] = _dashed(keys)
        return self

    def __repr__(self) -> str:
        return f"Builder({self.title!r})"


def _dashed(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Keys in the spelling of a scene."""
    return {key.replace("_", "-"): value for key, value in keys.items()}


def _key(text: str) -> str:
    return text if _BARE.match(text) else json.dumps(text)


def _value(value: Any) -> str:
    """The value as TOML, in one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(str(key))} = {_value(item)}" for key, item in value.items()) + " }"
    if hasattr(value, "tolist"):
        return _value(value.tolist())
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return "nan" if math.isnan(value) else repr(value)
    if isinstance(value, Sequence):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    raise TypeError(f"{value!r} cannot stand in a scene: numbers, texts, lists and mappings can")

"""Reads a scene description into SI numbers: exact decimals, no code shared with Dwell.

Only what the plane's cases with reference values use is read; anything else is an error and not passed over.
"""

import re
import tomllib
from pathlib import Path

from mpmath import mpf, pi

import jets

LENGTHS = {"m": "1", "mm": "0.001", "in": "0.0254"}
MASSES = {"kg": "1", "g": "0.001"}
INERTIAS = {"kg m2": "1", "g mm2": "1e-9"}


class Scene:
    """Bodies (mass, centre, inertia, points from the centre), joints, actuators, coordinates, loads and assembly."""

    def __init__(self, folder):
        text = (Path(folder) / "scene.toml").read_text()
        d = tomllib.loads(text, parse_float=mpf)
        units = d.get("units", {})
        self.length = mpf(LENGTHS[units.get("length", "m")])
        self.angle = pi / 180 if units.get("angle") == "deg" else mpf(1)
        mass, inertia = mpf(MASSES[units.get("mass", "kg")]), mpf(INERTIAS[units.get("inertia", "kg m2")])
        self.bodies, self.points = {}, {}
        for name, b in d["bodies"].items():
            points = {p: self.vector(at) for p, at in b.get("points", {}).items()}
            centre = b.get("center", [0, 0])
            centre = points[centre] if isinstance(centre, str) else self.vector(centre)
            for p, at in points.items():
                self.points[f"{name}.{p}"] = (name, (at[0] - centre[0], at[1] - centre[1]))
            if name != "ground":
                self.bodies[name] = (mpf(b.get("mass", 0)) * mass, mpf(b.get("inertia", 0)) * inertia)
        self.joints, self.loads, self.actuators = d["joints"], d.get("loads", {}), list(d["actuators"])
        self.coordinates = {**d["actuators"], **d.get("coordinates", {})}
        self.assembly, self.motion = d["assembly"], d.get("motion", {})

    def vector(self, xy):
        return (mpf(xy[0]) * self.length, mpf(xy[1]) * self.length)

    def is_angle(self, coordinate):
        return "angle" in self.coordinates[coordinate]

    def guess(self, name):
        """The rough value of [assembly] in SI: a body's angle or a coordinate."""
        is_length = name in self.coordinates and not self.is_angle(name)
        return mpf(self.assembly[name]) * (self.length if is_length else self.angle)


def evaluate(expression, names):
    """The value of an expression of the scene; `names` gives the value of every variable in it."""
    if not isinstance(expression, str):
        return mpf(expression)
    token = re.compile(r"(\d+\.?\d*(?:[eE][-+]?\d+)?)|([A-Za-z_][\w.-]*)|(.)")
    values, code = {"sin": lambda x: jets.sincos(x)[0], "cos": lambda x: jets.sincos(x)[1], "exp": jets.exp}, []
    for k, (number, name, other) in enumerate(token.findall(expression)):
        if number:
            values[f"n{k}"] = mpf(number)
        elif name and name not in values:
            values[f"n{k}"] = names[name]
        code.append(name if name in values else f"n{k}" if number or name else other)
    return eval("".join(code), {"__builtins__": {}}, values)

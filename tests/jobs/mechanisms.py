"""Draws mechanisms: four-bars, slider-cranks and six-bars of random dimensions, and perturbed cases of validation/ in the plane and in space."""
import cmath
import math
import pathlib
import re
import tomllib

TOP = pathlib.Path(__file__).resolve().parents[2]
# Cases, each with the points whose dimensions may vary without contradicting the joints.
PLANE_CASES = {
    "watt-six-bar": ["crank.B", "coupler.E", "rocker.F", "link5.G", "link6.G"],
    "whitworth": ["crank.B", "arm.E", "rod.F"],
    "scotch-yoke": ["crank.B"],
    "stephenson-six-bar": [],
    "cam": [],
    "five-bar": ["left.B", "left-rod.C", "right-rod.C", "right.D"],
    "jansen": [],
    "class-three-six-bar": [],
    "planetary": [],
    "press": ["crank.B", "rod.P"],
}
SPACE_CASES = {
    "rssr": ["crank.B", "coupler.C", "rocker.C", "ground.D"],
    "rssr-haug": ["coupler.B", "rocker.C", "ground.D"],
    "rsur": ["coupler.C", "ground.D"],
    "slider-crank-haug": ["crank.B", "ground.A"],
    "oblique-slider": ["crank.B"],
    "cam-and-rod": [],
    "bevel-differential": [],
}


class Mechanism:
    """The text of a scene, with what may vary and be wanted: `curve` has the places of a point and angles over a turn, for tables."""

    def __init__(self, text, points, curve=None):
        self.text, self.points, self.curve = text, points, curve
        self.data = tomllib.loads(text)
        ground = next(iter(self.data["bodies"]))
        self.bodies = {name: body for name, body in self.data["bodies"].items() if name != ground}
        self.is_spatial = len(next(iter(self.data["bodies"][ground]["points"].values()))) == 3

    def value(self, path):
        """A number of the scene, as written."""
        at = self.data if path.split(".")[0] in ("loads", "sweep") else self.data["bodies"]
        for key in re.findall(r"[^.\[\]]+", path):
            at = at[int(key)] if isinstance(at, list) else at[key]
        return at

    def with_point(self, path, value):
        """The text with another component of a point, as `crank.points.B[0]`."""
        body, point, k = re.fullmatch(r"(.+)\.points\.(.+)\[(\d)\]", path).groups()
        begin = self.text.index(f"[bodies.{body}]")
        found = re.compile(rf"\b{point} = \[([^\]]*)\]").search(self.text, begin)
        numbers = [part.strip() for part in found[1].split(",")]
        numbers[int(k)] = repr(value)
        return self.text[: found.start(1)] + ", ".join(numbers) + self.text[found.end(1) :]


def rounded(value, digits=5):
    return float(f"{value:.{digits}g}")


def body(name, points, mass, center, inertia):
    points = ", ".join(f"{k} = [{rounded(x)!r}, {rounded(y)!r}]" for k, (x, y) in points.items())
    numbers = f"mass = {rounded(mass)!r}\ncenter = [{rounded(center[0])!r}, {rounded(center[1])!r}]  # as drawn\ninertia = {rounded(inertia)!r}\n"
    return f"[bodies.{name}]\npoints = {{ {points} }}\n" + ("" if name == "ground" else numbers)


def link(rng, name, points):
    """A link along its second point."""
    length = math.hypot(*list(points.values())[1])
    mass = rng.uniform(1, 4) * length
    return body(name, points, mass, (rng.uniform(0.2, 0.7) * length, rng.uniform(-0.2, 0.2) * length), mass * length**2 * rng.uniform(0.08, 0.2))


def triangle(start, end, first, second):
    """The third corner of a triangle, to the left of the line from start to end."""
    line = end - start
    gap = abs(line)
    along = (first**2 - second**2 + gap**2) / (2 * gap)
    return start + line / gap * complex(along, math.sqrt(first**2 - along**2))


def tail(rng, angles, forces):
    """Actuator, motion and loads of a mechanism with the crank `phi`."""
    speed = rounded(rng.uniform(3, 20))
    text = "[actuators.phi]\nangle = [\"ground\", \"crank\"]\n\n[assembly]  # rough angles\n"
    text += "".join(f"{name} = {rounded(angle, 9)!r}\n" for name, angle in angles.items())
    text += "\n[loads]\n" + "".join(rng.sample(forces, rng.randint(0, len(forces))))
    text += f"weight = {{ gravity = [0, -9.81] }}\n" if rng.random() < 0.7 else ""
    kind = rng.random()
    if kind < 0.75:
        return text + f"\n[prescribed]\nduration = {2 * math.pi / speed!r}\npoints = {rng.choice([91, 181])}\nphi = {{ speed = {speed!r} }}\n"
    if kind < 0.9:
        law = f"sinusoid = {{ amplitude = {rounded(rng.uniform(0.3, 1))!r}, period = 1.5 }}"
        return text + f"\n[prescribed]\nduration = 1.5\npoints = 91\nphi = {{ {law} }}\n"
    return text + "\n[coordinate-sweep]\nphi = [0.1, 2.0]\n"


def four_bar_lengths(rng):
    while True:
        a, b, c, d = [rounded(rng.uniform(0.05, 0.12), 3)] + [rounded(rng.uniform(0.15, 0.5), 3) for _ in range(3)]
        if abs(d - a) > abs(b - c) + 0.01 and d + a < b + c - 0.01:
            return a, b, c, d


def four_bar(rng):
    a, b, c, d = four_bar_lengths(rng)
    u, v = rounded(rng.uniform(0, 0.6) * b, 3), rounded(rng.uniform(-0.4, 0.6) * b, 3)

    def at(q):
        pin = cmath.rect(a, q)
        corner = triangle(pin, d, b, c)
        return pin + complex(u, v) * (corner - pin) / b, cmath.phase(corner - pin), cmath.phase(corner - d)

    _, coupler, rocker = at(0)
    text = "# A four-bar of random dimensions.\ntitle = \"Four-bar\"\n\n"
    text += body("ground", {"A": (0, 0), "D": (d, 0), "S": (d, rng.uniform(0.1, 0.4))}, 0, (0, 0), 0)
    text += link(rng, "crank", {"A": (0, 0), "B": (a, 0)}) + link(rng, "coupler", {"B": (0, 0), "C": (b, 0), "P": (u, v)})
    text += link(rng, "rocker", {"D": (0, 0), "C": (c, 0), "S": (0.6 * c, 0.1 * c)})
    if rng.random() < 0.4:
        text += body("weight", {"A": (0, 0)}, rng.uniform(0.2, 2), (rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)), 0.0001)
        weld = "W = { weld = [\"crank.A\", \"weight.A\"] }\n"
    else:
        weld = ""
    text += "\n[joints]\n" + weld + "A = { revolute = [\"ground.A\", \"crank.A\"] }\nB = { revolute = [\"crank.B\", \"coupler.B\"] }\n"
    text += "C = { revolute = [\"coupler.C\", \"rocker.C\"] }\nD = { revolute = [\"ground.D\", \"rocker.D\"] }\n\n"
    forces = [f"spring = {{ spring = [\"ground.S\", \"rocker.S\"], stiffness = {rounded(rng.uniform(5, 300))!r}, free-length = {rounded(rng.uniform(0, 0.2))!r} }}\n",
              f"push = {{ force = \"coupler.P\", direction = [1, -0.5], magnitude = {rounded(rng.uniform(1, 30))!r} }}\n",
              f"moment = {{ torque = \"rocker\", magnitude = {rounded(rng.uniform(-3, 3))!r} }}\n",
              "law = { torque = \"rocker\", magnitude = \"1 + sin(phi)\" }\n"]
    text += tail(rng, {"phi": 0.0, "coupler": coupler, "rocker": rocker}, forces)
    return Mechanism(text, ["crank.B", "coupler.C", "coupler.P", "rocker.C", "ground.D"], at)


def slider_crank(rng):
    r, e = rounded(rng.uniform(0.03, 0.1), 3), rounded(rng.uniform(-0.02, 0.02), 2)
    b = rounded(r * rng.uniform(2, 5), 3)
    text = "title = \"Slider-crank\"  # of random dimensions\n\n" + body("ground", {"A": (0, 0), "G": (0, e)}, 0, (0, 0), 0)
    text += link(rng, "crank", {"A": (0, 0), "B": (r, 0)}) + link(rng, "rod", {"B": (0, 0), "C": (b, 0)})
    text += body("piston", {"C": (0, 0)}, rng.uniform(0.2, 2), (0.01, 0), 0.0004)
    text += "\n[joints]\nA = { revolute = [\"ground.A\", \"crank.A\"] }\nB = { revolute = [\"crank.B\", \"rod.B\"] }\n"
    text += "C = { revolute = [\"rod.C\", \"piston.C\"] }\nguide = { prismatic = [\"ground.G\", \"piston.C\"], axis = [1, 0] }\n\n"
    forces = [f"gas = {{ force = \"piston.C\", direction = [-1, 0], magnitude = {rounded(rng.uniform(5, 100))!r} }}\n",
              f"oil = {{ damper = [\"ground.A\", \"piston.C\"], damping = {rounded(rng.uniform(5, 60))!r} }}\n",
              "law = { force = \"piston.C\", direction = [-1, 0], magnitude = \"20*(1 + cos(phi))\" }\n"]
    text += tail(rng, {"phi": 0.5, "rod": math.asin((e - r * math.sin(0.5)) / b), "piston": 0.0}, forces)
    return Mechanism(text, ["crank.B", "rod.C", "ground.G"])


def six_bar(rng):
    """A four-bar whose coupler carries a dyad to the ground (Stephenson III)."""
    while True:
        a, b, c, d = four_bar_lengths(rng)
        p = complex(rng.uniform(0.2, 0.8) * b, rng.uniform(0.1, 0.4) * b)
        pivot = complex(rng.uniform(0, d), -rng.uniform(0.1, 0.4))

        def at(q):
            pin = cmath.rect(a, q)
            corner = triangle(pin, d, b, c)
            return pin + p * (corner - pin) / b, corner, pin

        gaps = [abs(at(0.2 * k)[0] - pivot) for k in range(32)]
        e, f = rounded(rng.uniform(0.2, 0.6), 3), rounded(rng.uniform(0.2, 0.6), 3)
        if max(gaps) < e + f - 0.02 and min(gaps) > abs(e - f) + 0.02:
            break
    place, corner, pin = at(0)
    top = triangle(place, pivot, e, f)
    text = "title = \"Six-bar\"\n\n" + body("ground", {"A": (0, 0), "D": (d, 0), "G": (pivot.real, pivot.imag)}, 0, (0, 0), 0)
    text += link(rng, "crank", {"A": (0, 0), "B": (a, 0)}) + link(rng, "coupler", {"B": (0, 0), "C": (b, 0), "E": (p.real, p.imag)})
    text += link(rng, "rocker", {"D": (0, 0), "C": (c, 0)}) + link(rng, "rod", {"E": (0, 0), "F": (e, 0)}) + link(rng, "arm", {"G": (0, 0), "F": (f, 0)})
    joints = {"A": ("ground", "crank"), "B": ("crank", "coupler"), "C": ("coupler", "rocker"), "D": ("ground", "rocker")}
    joints |= {"E": ("coupler", "rod"), "F": ("rod", "arm"), "G": ("ground", "arm")}
    text += "\n[joints]\n" + "".join(f"{k} = {{ revolute = [\"{i}.{k}\", \"{j}.{k}\"] }}\n" for k, (i, j) in joints.items()) + "\n"
    angles = {"phi": 0.0, "coupler": cmath.phase(corner - pin), "rocker": cmath.phase(corner - d)}
    angles |= {"rod": cmath.phase(top - place), "arm": cmath.phase(top - pivot)}
    text += tail(rng, angles, [f"moment = {{ torque = \"arm\", magnitude = {rounded(rng.uniform(-3, 3))!r} }}\n"])
    return Mechanism(text, ["crank.B", "coupler.C", "coupler.E", "rod.F", "arm.F", "ground.G"])


def perturbed(rng, folder, name, points):
    """A case with other masses, and a prescribed motion if it has none."""
    path = TOP / "validation" / folder / name
    text = (path / "scene.toml" if path.is_dir() else path.with_suffix(".toml")).read_text()
    text = re.sub(r"^(mass = )([\d.]+)", lambda m: m[1] + repr(rounded(float(m[2]) * rng.uniform(0.7, 1.4))), text, flags=re.M)
    if "[prescribed]" not in text and rng.random() < 0.7:
        actuators = tomllib.loads(text)["actuators"]
        speeds = "".join(f"{name} = {{ speed = {rounded(rng.uniform(2, 9))!r} }}\n" for name in actuators)
        motion = f"[prescribed]\nduration = {rng.choice([0.5, 1.0, 2.0])}\npoints = 91\n" + speeds
        text = text.replace("[actuators", motion + "\n[actuators", 1)
    return Mechanism(text, points)


def mechanism(rng):
    kind = rng.random()
    if kind < 0.6:
        return rng.choices([four_bar, slider_crank, six_bar], [4, 2, 2])[0](rng)
    folder, cases = ("", PLANE_CASES) if kind < 0.78 else ("spatial", SPACE_CASES)
    name = rng.choice(sorted(cases))
    return perturbed(rng, folder, name, cases[name])

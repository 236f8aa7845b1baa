"""The audit's reader of scenes: bodies, joints, coordinates, loads, friction, drives and stops in SI units.

A scene in the plane is lifted into space: points get z = 0, axes are z, angles are about z, a moment of inertia is I_zz.
Outside this file, only the names of columns depend on the dimension.
"""

import tomllib
from dataclasses import dataclass, field

import numpy as np

from curves import Table, read_law, read_points
from expressions import Expression
from jets import jet
from varying import VaryingInertia


LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "in": 0.0254, "ft": 0.3048}
MASSES = {"kg": 1.0, "g": 1e-3, "t": 1e3, "lb": 0.45359237, "oz": 0.45359237 / 16.0}
ANGLES = {"rad": 1.0, "deg": np.pi / 180.0}
PLANE_KINDS = ("revolute", "prismatic", "slot", "weld", "gear", "rack", "rolling", "distance")
SPACE_KINDS = ("revolute", "prismatic", "cylindrical", "helical", "universal", "spherical", "planar", "point-on-line", "point-in-plane", "weld", "distance")
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


@dataclass
class Body:
    name: str
    points: dict
    mass: float
    center: np.ndarray
    inertia: np.ndarray  # tensor about the centre of mass, in the body's frame
    varying: VaryingInertia | None
    is_ground: bool


@dataclass
class Place:
    """A point of a body, in the body's frame."""

    body: int
    point: np.ndarray


@dataclass
class Joint:
    """A joint of two bodies. Fields that a kind does not have are None."""

    name: str
    kind: str
    places: list
    axes: list  # of each body, in its frame
    normals: list | None  # directions between which the angle is counted
    sizes: dict = field(default_factory=dict)  # length, radii, radius, pitch, angle … in SI units
    law: object = None  # of a coupling, with the measures it connects
    measures: list | None = None
    carrier: Place | None = None  # of a gear in space: the pitch point


@dataclass
class Measure:
    """What a coordinate measures: an `angle` or a `travel` of a pair of bodies, or the `length` between two places."""

    kind: str
    places: list
    axes: list
    normals: list | None = None
    joint: str | None = None

    @property
    def is_angle(self):
        return self.kind == "angle"


@dataclass
class Coordinate:
    name: str
    measure: Measure


@dataclass
class Magnitude:
    """A number, an expression or a table, as a function of the signals of a row."""

    at: object
    switches: list = field(default_factory=list)  # quantities at whose zeros it may switch
    is_constant: bool = False

    def __call__(self, names):
        return self.at(names)


@dataclass
class Load:
    """A load: gravity, a force at a place, a torque about a direction, the drag of a place, or a force along a measure."""

    name: str
    kind: str
    measure: Measure | None = None
    place: Place | None = None
    direction: np.ndarray | None = None
    bodies: list | None = None  # of a torque about a direction in the first body
    in_body: bool = False
    source: str = "given"  # given, spring, damper or drag
    magnitude: Magnitude | None = None
    free: float = 0.0


@dataclass
class Friction:
    joint: int
    coefficient: float
    static: float
    radius: float
    distance: float  # of two bearings, or the ends of a guide
    regularization: float | None
    viscous: float


@dataclass
class Drive:
    name: str
    kind: str
    coordinate: str
    magnitude: Magnitude | None = None  # of a motor its voltage, of a controller its reference speed
    numbers: dict = field(default_factory=dict)


class Scene:
    """The parts of a scene that affect numbers."""

    def __init__(self, text):
        self.keys = keys = tomllib.loads(text) if isinstance(text, str) else text
        units = keys.get("units", {})
        self.length = LENGTHS[units.get("length", "m")]
        self.mass = MASSES[units.get("mass", "kg")]
        self.angle = ANGLES[units.get("angle", "rad")]
        self.inertia = inertia_unit(units.get("inertia", "kg m2"))
        points = [p for body in keys["bodies"].values() for p in body["points"].values()]
        self.is_plane = not any(len(p) == 3 for p in points)
        self.bodies = [self.read_body(name, table) for name, table in keys["bodies"].items()]
        self.joints, self.coordinates = [], []
        self.read_joints()
        self.loads = [self.read_load(name, table) for name, table in keys.get("loads", {}).items()]
        self.frictions = [f for name, table in keys.get("friction", {}).items() for f in self.read_friction(name, table)]
        self.drives = [self.read_drive(name, table) for name, table in keys.get("drives", {}).items()]
        self.stops = [self.read_stop(name, table) for name, table in keys.get("stops", {}).items()]

    # Names and vectors.

    def vector(self, numbers):
        """A vector of a scene in the plane or in space."""
        return np.array([*numbers, 0.0] if len(numbers) == 2 else numbers, float)

    def direction(self, numbers):
        vector = self.vector(numbers)
        return vector / np.linalg.norm(vector)

    def body_index(self, name):
        return next(k for k, body in enumerate(self.bodies) if body.name == name)

    @property
    def ground(self):
        return next((k for k, body in enumerate(self.bodies) if body.is_ground), None)

    def place(self, name):
        body, point = name.split(".", 1)
        k = self.body_index(body)
        return Place(k, self.bodies[k].points[point])

    def joint(self, name):
        return next(joint for joint in self.joints if joint.name == name)

    def coordinate(self, name):
        return next((c for c in self.coordinates if c.name == name), None)

    @property
    def actuators(self):
        return self.coordinates[: len(self.keys.get("actuators", {}))]

    def unit_of(self, measure):
        return self.angle if measure.is_angle else self.length

    @property
    def size(self):
        """The largest distance of a point from its body's origin, or of two points of a body, m."""
        spans = [np.linalg.norm(p - q) for b in self.bodies for p in b.points.values() for q in [*b.points.values(), 0 * p]]
        return max(spans, default=0.0) or 1.0

    # Bodies.

    def read_body(self, name, table):
        points = {point: self.length * self.vector(at) for point, at in table["points"].items()}
        is_ground = table.get("fixed", name == "ground")
        center = table.get("center", [0.0, 0.0])
        center = points[center] if isinstance(center, str) else self.length * self.vector(center)
        inertia = np.zeros((3, 3)) if is_ground else self.inertia * inertia_tensor(table)
        mass = 0.0 if is_ground else table.get("mass", 0.0) * self.mass
        varying = table.get("varying-inertia")
        varying = VaryingInertia(varying, self.angle, self.inertia) if varying and not is_ground else None
        return Body(name, points, mass, center, inertia, varying, is_ground)

    # Joints and coordinates.

    def read_joints(self):
        tables = self.keys["joints"].items()
        for name, table in tables:
            if "coupling" not in table:
                self.joints += self.read_plane_joint(name, table) if self.is_plane else [self.read_space_joint(name, table)]
        for section in ("actuators", "coordinates"):
            for name, table in self.keys.get(section, {}).items():
                self.coordinates.append(Coordinate(name, self.read_measure(table)))
        self.joints += [self.read_coupling(name, table) for name, table in tables if "coupling" in table]

    def read_plane_joint(self, name, table):
        """The joints of a pin, which may connect several bodies; one joint for any other kind. Axes of slides lie in the plane, all others are z."""
        kind = next(kind for kind in PLANE_KINDS if kind in table)
        places = [self.place(place) for place in table[kind]]
        sizes = {"angle": table.get("angle", 0.0) * self.angle, "pressure": table.get("pressure-angle", 0.0) * self.angle}
        for key in ("length", "radius"):
            if key in table:
                sizes[key] = table[key] * self.length
        if "radii" in table:
            sizes["radii"] = [r * self.length for r in table["radii"]]
            sizes["internal"] = table.get("internal", False)
        axes = table.get("axes", [table["axis"]] * 2 if "axis" in table else None)
        slides = axes is not None
        axes = [self.direction(axis) for axis in axes] if slides else [Z, Z]
        normals = [np.cross(Z, axis) for axis in axes] if slides else [X, X]
        if kind == "weld":
            normals = [np.array([np.cos(sizes["angle"]), np.sin(sizes["angle"]), 0.0]), X]
        several = len(places) > 2
        names = [f"{name}-{self.bodies[p.body].name}" if several else name for p in places[1:]]
        return [Joint(n, kind, [places[0], p], axes, normals, sizes) for n, p in zip(names, places[1:])]

    def read_space_joint(self, name, table):
        if "gear" in table:
            bodies = [Place(self.body_index(body), np.zeros(3)) for body in table["gear"]]
            carrier = self.place(table["pitch-point"])
            return Joint(name, "gear in space", bodies, [self.direction(table["normal"])] * 2, None, carrier=carrier)
        kind = next(kind for kind in SPACE_KINDS if kind in table)
        places = [self.place(place) for place in table[kind]]
        axes = table.get("axes", [table.get("axis", [0, 0, 1])] * 2)
        axes = [self.direction(axis) for axis in axes]
        normals = table.get("normals")
        if normals:  # across the axis
            normals = [self.direction(n - (self.vector(n) @ u) * u) for n, u in zip(map(self.vector, normals), axes)]
        elif "axes" not in table:
            normals = [across(axes[0])] * 2
            normals = [X, X] if kind == "weld" else normals
        sizes = {key: table[key] * self.length for key in ("length", "pitch") if key in table}
        return Joint(name, kind, places, axes, normals, sizes)

    def read_coupling(self, name, table):
        value, variable = (self.coordinate(c).measure for c in table["coupling"])
        start = table.get("start", 0.0) * self.unit_of(value)
        law = read_law(table, start, self.unit_of(value), self.unit_of(variable), self.angle, goes_on=True)
        origin = Place(self.ground or 0, np.zeros(3))
        return Joint(name, "coupling", [origin, origin], [Z, Z], None, law=law, measures=[value, variable])

    def read_measure(self, table):
        kind = next(kind for kind in ("angle", "travel", "length") if kind in table)
        of = table[kind]
        if not isinstance(of, str):
            return self.angle_between(of) if kind == "angle" else self.distance(of)
        joint = self.joint(of)
        if kind == "length" and joint.kind == "distance":
            return Measure("length", joint.places, joint.axes, joint=of)
        return self.measure_of(joint, "angle" if kind == "angle" else "travel")

    def measure_of(self, joint, kind):
        return Measure(kind, joint.places, joint.axes, joint.normals, joint.name)

    def angle_between(self, bodies):
        """The relative angle of two bodies in the plane."""
        return Measure("angle", [Place(self.body_index(b), np.zeros(3)) for b in bodies], [Z, Z], [X, X])

    def distance(self, points):
        return Measure("length", [self.place(point) for point in points], [Z, Z])

    # Loads, friction, drives, stops.

    def read_magnitude(self, value, unit=1.0):
        """A magnitude. Numbers and values of tables have the stated unit; expressions are in SI units."""
        if isinstance(value, str):
            expression = Expression(value)
            return Magnitude(expression, expression.switches, not expression.names - {"pi", "tau"})
        if isinstance(value, dict):
            signal = value.get("of", "t")
            coordinate = self.coordinate(signal.removesuffix(".velocity"))
            variable = self.unit_of(coordinate.measure) if coordinate else 1.0
            curve = Table(read_points(value["table"], (variable, unit)), value.get("interpolation", "monotone"))
            knots = [lambda names, knot=knot: names(signal) - knot for knot in curve.x]
            return Magnitude(lambda names: curve(names(signal)), knots)
        return Magnitude(lambda names: jet(value * unit), [], True)

    def read_load(self, name, table):
        magnitude = lambda key: self.read_magnitude(table[key])
        if "gravity" in table:
            g = self.vector(table["gravity"])
            size = np.linalg.norm(g)
            return Load(name, "gravity", direction=g / (size or 1.0), magnitude=self.read_magnitude(size))
        if "force" in table:
            in_body = table.get("frame", "ground") == "body"
            place, direction = self.place(table["force"]), self.direction(table["direction"])
            return Load(name, "force", place=place, direction=direction, in_body=in_body, magnitude=magnitude("magnitude"))
        if "torque" in table:
            bodies = [table["torque"]] if isinstance(table["torque"], str) else table["torque"]
            bodies = [self.bodies[self.ground].name, *bodies] if len(bodies) == 1 else bodies
            axis = self.direction(table.get("axis", Z))
            bodies = [self.body_index(body) for body in bodies]
            return Load(name, "torque", direction=axis, bodies=bodies, magnitude=magnitude("magnitude"))
        if "drag" in table:
            return Load(name, "drag", place=self.place(table["drag"]), source="drag", magnitude=magnitude("coefficient"))
        key = next(key for key in ALONG if key in table)
        kind, source = ALONG[key]
        of = table[key]
        if isinstance(of, str):
            measure = self.measure_of(self.joint(of), kind)
        else:
            measure = self.angle_between(of) if kind == "angle" else self.distance(of)
        amount = {"given": "magnitude", "spring": "stiffness", "damper": "damping", "drag": "coefficient"}[source]
        free = table.get("free-length", 0.0) * self.length + table.get("free-angle", 0.0) * self.angle
        return Load(name, "along", measure=measure, source=source, magnitude=magnitude(amount), free=free)

    def read_friction(self, name, table):
        """The friction of a joint. Friction of a pin through several bodies applies to each of its joints."""
        names = [joint.name for joint in self.joints]
        meant = [name] if name in names else [n for n in names if n.startswith(f"{name}-") and n not in self.keys["joints"]]
        for k, joint in enumerate(self.joints):
            if joint.name in meant:
                speed = self.angle if joint.kind == "revolute" else self.length
                coefficient, smooth = table.get("coefficient", 0.0), table.get("regularization-speed")
                yield Friction(
                    k,
                    coefficient,
                    table.get("static-coefficient", coefficient),
                    table.get("radius", 0.0) * self.length,
                    (table.get("guide-length", 0.0) + table.get("bearing-distance", 0.0)) * self.length,
                    None if smooth is None else smooth * speed,
                    table.get("viscous", 0.0),
                )

    def read_drive(self, name, table):
        kind = next(kind for kind in ("applied-force", "motor", "speed-controller") if kind in table)
        coordinate = table[kind]
        numbers = {"ratio": table.get("gear-ratio", 1.0), "integral": table.get("integral", 0.0)}
        numbers["rotor"] = numbers["ratio"] ** 2 * table.get("inertia", 0.0) * self.inertia
        for key in ("torque-constant", "resistance", "inductance", "stall-torque", "proportional", "limit"):
            if key in table:
                numbers[key] = table[key]
        if "no-load-speed" in table:
            numbers["no-load-speed"] = table["no-load-speed"] * self.angle
        magnitude = None
        if kind == "speed-controller":
            magnitude = self.read_magnitude(table["speed"], self.unit_of(self.coordinate(coordinate).measure))
        elif "voltage" in table or "magnitude" in table:
            magnitude = self.read_magnitude(table.get("voltage", table.get("magnitude")))
        return Drive(name, kind, coordinate, magnitude, numbers)

    def read_stop(self, name, table):
        unit = self.unit_of(self.coordinate(table["coordinate"]).measure)
        ends = {end: table[end] * unit for end in ("min", "max") if end in table}
        stiffness = table.get("stiffness")
        return {"name": name, "coordinate": table["coordinate"], **ends, "stiffness": stiffness,
                "damping": table.get("damping", 0.0), "restitution": table.get("restitution", 0.0)}

    # Motions.

    def start_of(self, coordinate):
        """The value of an actuator at assembly, else at the start of its motion; None for a length that the scene does not state."""
        name = coordinate.name
        initial = self.initial("initial-coordinate", coordinate)
        usual = initial if initial is not None or coordinate.measure.kind == "length" else 0.0
        given = self.keys.get("assembly", {}).get(name)
        return usual if isinstance(given, dict) or given is None else given * self.unit_of(coordinate.measure)

    def initial(self, key, coordinate):
        """The number of a coordinate in `[motion]`, or None. A number without a name belongs to the only free actuator."""
        given = self.keys.get("motion", {}).get(key)
        given = given.get(coordinate.name) if isinstance(given, dict) else given
        return None if given is None else given * self.unit_of(coordinate.measure)

    def laws(self, section):
        """The prescribed laws by coordinate: of `prescribed`, or of `motion.prescribed`."""
        tables = self.keys.get("prescribed", {}) if section == "prescribed" else self.keys.get("motion", {}).get("prescribed", {})
        found = {}
        for coordinate in self.actuators:
            if coordinate.name in tables:
                unit, start = self.unit_of(coordinate.measure), self.start_of(coordinate)
                law = read_law(tables[coordinate.name], start or 0.0, unit, 1.0, self.angle)
                needs_start = not {"table", "expression"} & set(tables[coordinate.name])
                found[coordinate.name] = (law, start is not None or not needs_start)
        return found


# Kinds of loads along a measure, by their key: the measure and the source of the magnitude.
ALONG = {
    "point-to-point-force": ("length", "given"),
    "slide-force": ("travel", "given"),
    "joint-torque": ("angle", "given"),
    "spring": ("length", "spring"),
    "torsion-spring": ("angle", "spring"),
    "damper": ("length", "damper"),
    "rotational-damper": ("angle", "damper"),
    "slide-damper": ("travel", "damper"),
    "rotational-drag": ("angle", "drag"),
}


def inertia_unit(text):
    """A mass unit and a squared length unit, such as `kg mm2`."""
    mass, length = text.replace("²", "2").replace("^", "").replace("*", " ").replace("·", " ").split()
    return MASSES[mass] * LENGTHS[length.removesuffix("2")] ** 2


def inertia_tensor(table):
    """The tensor in the body's frame; in the plane its one element I_zz."""
    inertia = table.get("inertia", 0.0)
    if not isinstance(inertia, list):
        return np.diag([0.0, 0.0, inertia])
    xx, yy, zz, xy, xz, yz = [*inertia, 0.0, 0.0, 0.0][:6]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], float)
    if "inertia-axes" not in table:
        return tensor
    x, y = (np.array(axis, float) / np.linalg.norm(axis) for axis in table["inertia-axes"])
    axes = np.stack([x, y, np.cross(x, y)], axis=1)
    return axes @ tensor @ axes.T


def across(axis):
    """Any direction at right angles to an axis."""
    other = np.eye(3)[np.argmin(np.abs(axis))]
    normal = np.cross(axis, other)
    return normal / np.linalg.norm(normal)

"""Internal forces of links: equilibrium of the part beyond each cut, in the row of the largest bending moment."""

import numpy as np

from balance import reaction
from files import result
from forces import FrictionForces, load_magnitude, unit_load
from joints import along, unit_reactions
from judge import largest
from kinematics import rows_of


GAUSS = ((-np.sqrt(0.6), 5.0 / 9.0), (0.0, 8.0 / 9.0), (np.sqrt(0.6), 5.0 / 9.0))  # exact for the cubic of the moment
# Stations that differ by less than this fraction of the length are equal.
SAME = 1e-11


def judge_sections(judge, motion, folder, summary, command):
    """Judges all links that the scene requests."""
    for section in motion.scene.keys.get("requests", {}).get("sections", []):
        body, start, end = section["body"], section["from"], section["to"]
        stem = f"{command}-internal-forces-{body}.{start}.{end}"
        cuts, envelope = folder.csv(stem), folder.csv(f"{stem}.envelope")
        name = f"{body} from {start} to {end}.bending_moment"
        at = result(summary, f"{name}.at")
        over = ((summary or {}).get("extrema_over") or {}).get("name", "t")
        if cuts is None or at is None or over not in motion.rows:
            continue
        place = np.nonzero(np.abs(motion.rows.get(over) - at) <= 1e-12 * (1.0 + abs(at)))[0]
        judge.require("sections", len(place) == 1, f"the largest {name} is at {at}, which is no row")
        if len(place) == 1:
            forces = forces_on(motion, body, (start, end), place[0])
            if forces is None:
                judge.skip(f"internal forces of {body}", "a reaction has no column, or no joint places a couple")
            else:
                judge_cuts(judge, cuts, forces, stem)
        bending = cuts.get("bending")
        judge.compare("sections", abs(result(summary, name)) - largest(bending), largest(bending) or 1.0, "N m", name)
        if envelope is not None:
            within_envelope(judge, cuts, envelope, name)


class Link:
    """A link in one row: forces at their projections on its line, and the inertia and weight of its mass."""

    def __init__(self, origin, direction, length):
        self.origin, self.direction, self.length = origin, direction, length
        self.applied = []  # station, axial part, part across, couple
        self.bar = None  # mass per length, and accelerations less gravity at both ends

    def parts(self, vector):
        """The components along and across the line."""
        return vector @ self.direction, np.cross(self.direction, vector)[2]

    def add(self, force, point, couple):
        station, offset = self.parts(point - self.origin)
        axial, across = self.parts(force)
        self.applied.append((station, axial, across, couple - offset * axial))

    def beyond(self, station, side):
        """Force and moment of the part beyond a cut on the other part. A cut is before (−1) or behind (1) the forces at its station."""
        slack, total = SAME * self.length, np.zeros(3)
        for at, axial, across, couple in self.applied:
            # What is beyond the far end acts at it, and nothing in front of the near one is beyond a cut.
            if at >= self.length - slack or (at > slack and at > station + side * slack):
                total += axial, across, (at - station) * across + couple
        if self.bar:
            density, (a, b) = self.bar
            half = 0.5 * (self.length - station)
            for x, weight in GAUSS:
                at = station + half * (1.0 + x)
                axial, across = (density * weight * half * (p + at / self.length * (q - p)) for p, q in zip(a, b))
                total -= axial, across, (at - station) * across
        return total


def forces_on(motion, name, ends, row):
    """The forces on a link in a row; None if one of them is unknown."""
    scene = motion.scene
    k = scene.body_index(name)
    body = scene.bodies[k]
    jets = [motion.frames[k].origin + motion.direction(k, body.points[end]) for end in ends]
    a, b = (jet.value[row] for jet in jets)
    span = np.linalg.norm(b - a)
    link = Link(a, (b - a) / span, span)
    wrenches = wrenches_of(motion)
    if wrenches is None:
        return None
    for pair in wrenches:
        for w in (w for w in pair if w.body == k):
            force, point, couple = w.force[row], w.point[row], w.couple[row][2]
            if not force.any() and couple:
                joint = only_joint(scene, [other.body for other in pair])
                if joint is None:
                    return None
                point = motion.point(joint.places[1]).value[row]
            link.add(force, point, couple)
    gravity = sum((load.direction * float(load.magnitude(None).value) for load in scene.loads if load.kind == "gravity"), np.zeros(3))
    middle, uniform = 0.5 * (body.points[ends[0]] + body.points[ends[1]]), body.mass * span**2 / 12.0
    if np.linalg.norm(body.center - middle) <= 1e-9 * span and abs(body.inertia[2, 2] - uniform) <= 1e-9 * uniform:
        link.bar = body.mass / span, [link.parts(jet.second[row] - gravity) for jet in jets]
    else:
        center = motion.center(k)
        link.add(body.mass * (gravity - center.second[row]), center.value[row], -body.inertia[2, 2] * motion.frames[k].alpha[row, 2])
    return link


def wrenches_of(motion):
    """The pairs of wrenches of joints, actuators, loads except weights, and friction; None if a reaction has no column."""
    scene, names, found = motion.scene, motion.names(motion.time()), []
    for joint in scene.joints:
        for component, pair in unit_reactions(joint, motion).items():
            column = motion.rows.get(f"{joint.name}.{component}")
            if column is None:
                return None
            found.append([w.times(column) for w in pair])
    for actuator in scene.actuators:
        found.append([w.times(rows_of(motion, f"{actuator.name}.actuator_force")) for w in along(motion, actuator.measure)])
    for load in (load for load in scene.loads if load.kind != "gravity"):
        found.append([w.times(load_magnitude(load, motion, names)) for w in unit_load(load, motion)])
    for friction in scene.frictions:
        of = FrictionForces(friction, motion, *reaction(motion, scene.joints[friction.joint]))
        viscous, zero = of.viscous(), np.zeros(motion.count)
        found += [of.wrenches(*of.dry()), of.wrenches(*((zero, viscous) if of.is_pin else (viscous, zero)))]
    return found


def only_joint(scene, bodies):
    """The only joint between two bodies, at which a couple between them acts; or None."""
    joints = [joint for joint in scene.joints if sorted(p.body for p in joint.places) == sorted(bodies)]
    return joints[0] if len(joints) == 1 else None


def judge_cuts(judge, cuts, link, name):
    stations = cuts.get("station")
    force = max((np.hypot(axial, across) for _, axial, across, _ in link.applied), default=0.0)
    moment = max((abs(couple) for *_, couple in link.applied), default=0.0)
    scales = [force or 1.0, force or 1.0, max(moment, force * link.length) or 1.0]
    for k, station in enumerate(stations):
        # A station with a force has two cuts, before and behind it.
        same = lambda j: 0 <= j < len(stations) and abs(stations[j] - station) <= 1e-9 * link.length
        side = (1 if same(k - 1) else 0) - (1 if same(k + 1) else 0) or 1
        wanted = link.beyond(link.length if k == len(stations) - 1 else station, side)
        for value, column, scale in zip(wanted, ("axial", "shear", "bending"), scales):
            judge.compare("sections", cuts.get(column)[k] - value, scale, "SI", f"{name}, {column} at {station} m")


def within_envelope(judge, cuts, envelope, name):
    """Every cut is within the envelope of its station, which goes nowhere beyond the largest bending moment."""
    stations, places = cuts.get("station"), envelope.get("station")
    nearest = np.abs(stations[:, None] - places).argmin(1)
    met = np.abs(stations - places[nearest]) <= 1e-12 * (1.0 + np.abs(stations))
    forces = largest(cuts.get("axial"), cuts.get("shear"))
    for column, scale in (("axial", forces), ("shear", forces), ("bending", largest(cuts.get("bending")))):
        low, high = (envelope.get(f"{column}.{end}")[nearest] for end in ("min", "max"))
        value = cuts.get(column)
        beyond = np.where(met, np.maximum(np.maximum(low - value, value - high), 0.0), 0.0)
        judge.compare("sections", beyond, scale or 1.0, "SI", f"{name}: {column} beyond its envelope")
    excess = largest(envelope.get("bending.min"), envelope.get("bending.max")) - largest(cuts.get("bending"))
    judge.compare("sections", max(excess, 0.0), largest(cuts.get("bending")) or 1.0, "N m", f"{name}: the largest of its envelope")

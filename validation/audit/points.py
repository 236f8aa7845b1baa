"""Steady cycles and equilibria in the files of `cycle` and `equilibria`, judged by the reduced model of `reduce`."""

import numpy as np

from files import result
from forces import DriveForces
from jets import Jet
from judge import largest
from kinematics import beyond_estimate, even_rows, simpson


class Unknown(Exception):
    """A load or drive that the reduced model does not determine."""


# The reduced model between its rows.


class Reduced:
    """The columns of `reduce` and their slopes between its rows, by polynomials through the eight nearest ones."""

    def __init__(self, scene, rows):
        self.scene, self.rows, self.name = scene, rows, scene.actuators[0].name
        self.q = rows.get(self.name)
        self.is_whole = scene.actuators[0].measure.is_angle and abs(self.q[-1] - self.q[0] - 2.0 * np.pi) < 1e-9

    def at(self, column, q):
        """Values and slopes at coordinates; a model over a whole revolution is continued periodically."""
        values = self.rows.get(column)
        if values is None or len(self.q) < 8:
            raise Unknown(f"no column {column} of eight rows or more")
        if self.is_whole and abs(values[-1] - values[0]) <= 1e-9 * largest(values):
            q = self.q[0] + np.mod(np.asarray(q) - self.q[0], 2.0 * np.pi)
        elif np.any((q < self.q[0]) | (q > self.q[-1])):
            raise Unknown("the rows of `reduce` do not reach there")
        places = np.clip(np.searchsorted(self.q, q) - 4, 0, len(self.q) - 8)
        window = places[:, None] + np.arange(8)
        x, y = self.q[window] - np.asarray(q)[:, None], values[window]
        scale = np.abs(x).max(1, keepdims=True)
        powers = (x / scale)[:, :, None] ** np.arange(8)
        polynomial = np.linalg.solve(powers, y[:, :, None])[:, :, 0]
        return polynomial[:, 0], polynomial[:, 1] / scale[:, 0]

    def force(self, q, velocity, time):
        """Σ w F of all loads, and the size of its terms."""
        if self.scene.frictions:
            raise Unknown("friction needs the reactions")
        total, terms = np.zeros_like(q), np.zeros_like(q)
        for name, number in self.load_numbers(q, velocity, time).items():
            part = self.at(f"{name}.w", q)[0] * number
            total, terms = total + part, terms + np.abs(part)
        return total, terms

    def load_numbers(self, q, velocity, time):
        """F of every load. For a damper, F is the resistance, positive if it opposes growth; for a drag, the coefficient times |velocity| velocity."""
        signals, found = {self.name: q, f"{self.name}.velocity": velocity, "t": time}, {}
        for load in self.scene.loads:
            amount = known(load.magnitude, signals, q)
            if load.source == "drag":
                amount = amount * np.abs(velocity) * velocity
            rate = -self.at(f"{load.name}.w", q)[0] * velocity if load.source == "damper" else 1.0
            found[load.name] = amount * rate
        return found

    def drives(self, coordinate, time, rows, inputs=None):
        """The forces of all drives on the coordinate; an input is added to their magnitudes."""
        signals, found = {self.name: coordinate.value, f"{self.name}.velocity": coordinate.first, "t": time}, {}
        for drive in self.scene.drives:
            if drive.coordinate != self.name:
                raise Unknown(f"drive {drive.name} acts on another coordinate")
            # A motor that is given by its line always has its full voltage: 1.
            magnitude = known(drive.magnitude, signals, coordinate.value) if drive.magnitude else np.ones_like(coordinate.value)
            magnitude = magnitude + (inputs or {}).get(drive.name, 0.0)
            found[drive.name] = DriveForces(drive, coordinate, magnitude, rows)
            if found[drive.name].force() is None:
                raise Unknown(f"the state of {drive.name} has no column")
        return found


def known(magnitude, signals, q):
    """A magnitude from the signals that are known along the coordinate."""
    try:
        return np.broadcast_to(magnitude(lambda name: Jet(signals[name]) if name in signals else None).value, q.shape)
    except (ValueError, AttributeError, TypeError) as error:
        raise Unknown("a magnitude depends on other coordinates") from error


# Cycles.


def judge_cycle(judge, scene, rows, summary, prefix, reduced):
    """Rows of a cycle: rates, the same state at both ends, and speeds, fluctuation and works of the summary."""
    name = scene.actuators[0].name if f"{scene.actuators[0].name}.velocity" in rows else \
        next(n for n, _ in rows.ending(".velocity") if n in rows)
    time, q, speed, acceleration = (rows.get(n) for n in ("t", name, f"{name}.velocity", f"{name}.acceleration"))
    if len(q) >= 5:
        for values, rate, what in ((time, 1.0 / speed, "t"), (0.5 * speed**2, acceleration, "speed")):
            excess = beyond_estimate(*simpson(q, values, rate), 5)
            key = "cycle-rates-friction" if scene.frictions else "cycle-rates"
            judge.compare(key, np.where(even_rows(q), excess, 0.0), largest(values), "SI", what)
    fastest, change = largest(speed), lambda values: values[-1] - values[0]
    of = lambda key: result(summary, prefix + key)
    mean, turns = change(q) / change(time), result(summary, "revolutions") or 1.0
    judge.compare("cycle", change(speed), fastest, "SI", "speed at both ends")
    for state in ("current", "integral"):
        for n, values in rows.ending(f".{state}"):
            judge.compare("cycle", change(values), max(largest(values), state_scale(scene, n, fastest)), "SI", f"{n}.{state} at both ends")
    judge.compare("cycle", of("mean_speed") - mean, fastest, "SI", "mean speed")
    judge.compare("cycle", abs(change(q)) - 2.0 * np.pi * turns, 2.0 * np.pi, "rad", "revolutions")
    if not prefix:
        judge.compare("cycle", of("period") - change(time), change(time), "s", "period")
    step = largest(np.diff(speed))  # between rows the motion may be faster or slower by no more than that
    for what, place in (("slowest_speed", np.abs(speed).argmin()), ("fastest_speed", np.abs(speed).argmax())):
        at, row = of(f"{what}.at"), q[place]
        if at is not None and np.ptp(speed) > 1e-9 * fastest:  # it is the place of the row, or near it
            gap = np.abs(np.mod(at - row + np.pi, 2.0 * np.pi) - np.pi)
            judge.compare("cycle", max(gap - 2.0 * largest(np.diff(q)), 0.0), 1.0, "SI", f"{what}.at")
    for beyond, what in ((np.abs(speed).min() - abs(of("slowest_speed")), "slowest speed"), (abs(of("fastest_speed")) - fastest, "fastest speed")):
        judge.compare("cycle", max(-beyond, beyond - step, 0.0), fastest, "SI", what)
    fluctuation = (abs(of("fastest_speed")) - abs(of("slowest_speed"))) / abs(mean)
    if of("coefficient_of_fluctuation") is not None:
        judge.compare("cycle", of("coefficient_of_fluctuation") - fluctuation, 1.0, "", "coefficient of fluctuation")
    works = rows.ending(".work")
    total = result(summary, f"{prefix}work_sum")
    if total is not None:
        judge.compare("cycle", total - sum(change(w) for _, w in works), largest(*(w for _, w in works)) or 1.0, "J", "work_sum")
    for n, work in works:
        stated = result(summary, f"{prefix}{n}.work")
        if stated is not None:
            judge.compare("cycle", stated - change(work), largest(*(w for _, w in works)) or 1.0, "J", f"{n}.work of a cycle")
    states_of_cycle(judge, scene, rows, name, (time, Jet(q, speed, acceleration)))
    added = of("inertia") if prefix else 0.0
    cycle_equation(judge, reduced, rows, (time, Jet(q, speed, acceleration)), added or 0.0)


def without_flywheel(judge, summary):
    """If no flywheel is needed, the cycles with and without it are equal."""
    if result(summary, "flywheel.inertia") is None:
        return
    judge.compare("cycle", result(summary, "flywheel.inertia"), 1.0, "kg m2", "a flywheel without a file")
    for speed in ("mean_speed", "slowest_speed", "fastest_speed"):
        stated, own = result(summary, f"flywheel.{speed}"), result(summary, speed)
        judge.compare("cycle", stated - own, own, "SI", f"flywheel.{speed}")


def states_of_cycle(judge, scene, rows, name, motion):
    """Judges the changes of works, currents and integrals of drives over the coordinate by the laws of the scene."""
    time, q = motion
    signals = {name: q.value, f"{name}.velocity": q.first, "t": time}
    for drive in (d for d in scene.drives if d.coordinate == name):
        try:
            magnitude = known(drive.magnitude, signals, q.value) if drive.magnitude else np.ones_like(q.value)
        except Unknown:
            continue
        of = DriveForces(drive, q, magnitude, rows)
        held = of.unlimited is not None and np.abs(of.unlimited) > of.numbers.get("limit", np.inf)
        rates = {"work": of.force(), "current": of.current_rate, "integral": None if of.unlimited is None else np.where(held, 0.0, magnitude - q.first)}
        for state, rate in rates.items():
            values = rows.get(f"{drive.name}.{state}")
            if values is not None and rate is not None:
                rate = rate if state == "work" else rate / q.first
                gain = drive.numbers.get("proportional", drive.numbers.get("torque-constant", drive.numbers.get("stall-torque", 0.0)))
                gain = 1e-3 * abs(gain * drive.numbers["ratio"]) * max(1.0, largest(q.first))  # where all forces are zero
                scale = max(largest(values), largest(rate), gain) if state == "work" else max(largest(values), state_scale(scene, drive.name, largest(q.first)))
                key = "cycle-rates-friction" if scene.frictions else "cycle-rates"
                excess = beyond_estimate(*simpson(q.value, values, rate), 5)
                judge.compare(key, np.where(even_rows(q.value), excess, 0.0), scale or 1.0, "SI", f"{drive.name}.{state}")


def cycle_equation(judge, reduced, rows, motion, added):
    """m q̈ + ½m′ q̇² = Σ w F and the drives' forces, where `reduce` has written m, ½m′ and w; with a flywheel's inertia."""
    if reduced is None:
        judge.skip("the equation of motion", "no file of `reduce`")
        return
    time, q = motion
    try:
        m, _ = reduced.at("m", q.value)
        half, _ = reduced.at("half_dm", q.value)
        loads, terms = reduced.force(q.value, q.first, time)
        drives = reduced.drives(q, time, rows).values()
    except Unknown as reason:
        judge.skip("the equation of motion", str(reason))
        return
    rotor, drives = sum(of.numbers["rotor"] for of in drives), sum((of.force() for of in drives), np.zeros_like(m))
    for load, number in reduced.load_numbers(q.value, q.first, time).items():
        values = rows.get(f"{load}.work")
        if values is not None:
            rate = number * reduced.at(f"{load}.w", q.value)[0]
            excess = beyond_estimate(*simpson(q.value, values, rate), 5)
            judge.compare("cycle-rates", np.where(even_rows(q.value), excess, 0.0), max(largest(values), largest(rate)) or 1.0, "J", f"{load}.work")
    left = (m + rotor + added) * q.second + half * q.first**2 - loads - drives
    scale = max(largest(terms), largest(drives), largest(m * q.second), largest(half * q.first**2), 1e-3 * largest(m * q.first**2))
    judge.compare("cycle-equation", left, scale or 1.0, "N m", "the equation of motion")


def state_scale(scene, name, fastest):
    """A typical size of a drive's state: the current from the induced voltage, or the integral over a revolution."""
    numbers = next(drive.numbers for drive in scene.drives if drive.name == name)
    if "resistance" in numbers:
        return abs(numbers["torque-constant"] * numbers["ratio"] * fastest / numbers["resistance"])
    return 2.0 * np.pi


# Equilibria.


def eigenvalues(summary, name):
    found = []
    while (re := result(summary, f"{name}.eigenvalue.{len(found) + 1}.re")) is not None:
        found.append(complex(re, result(summary, f"{name}.eigenvalue.{len(found) + 1}.im")))
    return found


def modes(judge, summary, name):
    """|λ| = ω = 2π f and ζ = −Re λ/|λ| of each mode."""
    values = eigenvalues(summary, name)
    scale = max(map(abs, values), default=0.0)
    if values:
        judge.compare("modes", sum(values).imag, scale or 1.0, "1/s", f"{name}: conjugate pairs")
    for k, value in enumerate(values, 1):
        of = lambda what: result(summary, f"{name}.eigenvalue.{k}.{what}")
        for what, factor, wanted in (("angular_frequency", 1.0, abs(value)), ("frequency", 2.0 * np.pi, abs(value)),
                                     ("damping_ratio", abs(value), -value.real)):
            if of(what) is not None:
                judge.compare("modes", factor * of(what) - wanted, scale, "1/s", f"{name}, eigenvalue {k}, {what}")


def judge_equilibria(judge, scene, rows, summary, reduced, statics):
    """The table of equilibria with its summary, distances from the start, and forces and stiffness by `reduce`."""
    count = int(result(summary, "equilibria") or 0)
    judge.compare("equilibria", rows.count - count, 1.0, "", "number of equilibria")
    free = [c for c in scene.actuators if c.name not in scene.laws("motion")]
    for k in range(min(count, rows.count)):
        name = f"equilibrium.{k + 1}"
        modes(judge, summary, name)
        table_row(judge, rows, k, summary, name, free)
        from_start(judge, scene, rows, summary, name, free)
    neighbours(judge, rows, summary, count, free)
    if len(free) != 1 or len(scene.actuators) != 1:
        return
    places = rows.get(free[0].name)
    if count and reduced is not None:
        by_reduced(judge, reduced, places, summary)
    sign_changes(judge, scene, places, statics, summary, free[0].name)
    static_forces(judge, scene, statics, summary, free[0].name)


def table_row(judge, rows, k, summary, name, free):
    """Compares coordinates, the largest real part and the modes of a row with the summary."""
    values = eigenvalues(summary, name)
    scale = max(map(abs, values), default=0.0) or 1.0
    for coordinate in free:
        stated, from_row = result(summary, f"{name}.{coordinate.name}"), rows.get(coordinate.name)
        if stated is not None and from_row is not None:
            judge.compare("equilibria", from_row[k] - stated, max(1.0, abs(stated)), "SI", f"{name}, {coordinate.name}")
    column = rows.get("max_real_eigenvalue")
    error = 2.0 * (result(summary, f"{name}.error.eigenvalues") or 0.0)  # what is zero within it is written as zero
    if column is not None and values:
        excess = max(abs(column[k] - max(v.real for v in values)) - error, 0.0)
        judge.compare("equilibria", excess, scale, "1/s", f"{name}, max_real_eigenvalue")
    neutral = any(key.startswith(f"{name}.neutral") for key in summary["results"])
    stability, largest_real = rows.get("stability"), max((v.real for v in values), default=0.0)
    is_open = any(abs(value) <= error for value in values)  # rounding alone would decide
    if stability is not None and not neutral and not is_open and values and (abs(largest_real) > error or largest_real == 0.0):
        judge.compare("stability", stability[k] + np.sign(largest_real), 1.0, "", f"{name}: stable 1, centre 0, unstable -1")
    frequencies = {j: result(summary, f"{name}.eigenvalue.{j}.angular_frequency") for j in range(1, len(values) + 1)}
    oscillating = sorted((j for j in frequencies if frequencies[j] is not None), key=frequencies.get)
    surplus = [rows.get(n)[k] for n in rows.columns if n.startswith("mode") and int(n[4:].split(".")[0]) > len(oscillating)]
    judge.require("equilibria", bool(np.isnan(surplus).all()), f"{name} has more modes in the table than in the summary")
    for mode, j in enumerate(oscillating, 1):
        for what in ("angular_frequency", "frequency", "damping_ratio"):
            column, stated = rows.get(f"mode{mode}.{what}"), result(summary, f"{name}.eigenvalue.{j}.{what}")
            if column is not None and stated is not None:
                judge.compare("equilibria", column[k] - stated, 1.0 if what == "damping_ratio" else scale, "SI", f"{name}, mode{mode}.{what}")


def from_start(judge, scene, rows, summary, name, free):
    """The difference of each coordinate from the start of the motion."""
    for coordinate in free:
        start = scene.initial("initial-coordinate", coordinate)
        start = scene.start_of(coordinate) if start is None else start
        at, stated = result(summary, f"{name}.{coordinate.name}"), result(summary, f"{name}.{coordinate.name}.from_start")
        column, k = rows.get(f"{coordinate.name}.deflection"), int(name.split(".")[1]) - 1
        if None not in (start, at) and column is not None:
            judge.compare("equilibria", column[k] - (at - start), max(1.0, abs(start)), "SI", f"{name}, {coordinate.name}.deflection")
        if None not in (start, at, stated):
            judge.compare("equilibria", stated - (at - start), max(1.0, abs(start)), "SI", f"{name}, {coordinate.name} from the start")


def neighbours(judge, rows, summary, count, free):
    """Along one coordinate the force at rest crosses zero upwards and downwards in turn."""
    if len(free) != 1 or count < 2 or any(".neutral" in key for key in summary["results"]):
        return
    values = [eigenvalues(summary, f"equilibrium.{k + 1}") for k in range(count)]
    products = [(a * b).real if len(pair) == 2 else 0.0 for pair in values for a, b in [(*pair, 0, 0)[:2]]]
    order = np.argsort(rows.get(free[0].name)[:count])
    for a, b in zip(order[:-1], order[1:]):
        if products[a] and products[b]:
            judge.require("stability", products[a] * products[b] < 0.0, f"equilibria {a + 1} and {b + 1} are neighbours of the same stability")


def by_reduced(judge, reduced, places, summary):
    """Σ w F is zero at rest, and λ² = (Σ w F)′/m where there is no damping."""
    zero, scene = np.zeros_like(places), reduced.scene
    if scene.drives or scene.stops:
        judge.skip("forces at equilibria", "drives and stops act there")
        return
    try:
        near = np.linspace(-2.0, 2.0, 5)[:, None] * 1e-3 + places  # slopes by differences of fourth order
        force, terms = zip(*(reduced.force(q, zero, zero) for q in near))
        m, _ = reduced.at("m", places)
    except Unknown as reason:
        judge.skip("forces at equilibria", str(reason))
        return
    judge.compare("rest", force[2], largest(*terms) or 1.0, "N m", "static force at equilibria")
    slope = (force[0] - 8.0 * force[1] + 8.0 * force[3] - force[4]) / 12e-3
    for k, (stiffness, inertia) in enumerate(zip(slope, m)):
        values = eigenvalues(summary, f"equilibrium.{k + 1}")
        if len(values) == 2 and all(load.source != "damper" for load in scene.loads) and not scene.frictions:
            product = (values[0] * values[1]).real
            scale = max(abs(product), largest(slope / m))
            judge.compare("stiffness", product + stiffness / inertia, scale or 1.0, "1/s2", f"equilibrium {k + 1}: λ₁ λ₂")


def static_forces(judge, scene, statics, summary, name):
    """The smallest and the largest static force by rows of `statics`, where only loads act."""
    low, high = (result(summary, f"static_force.{end}") for end in ("min", "max"))
    ends = [result(summary, f"searched.{name}.{end}") for end in ("from", "to")]
    force = None if statics is None else statics.get(f"{name}.actuator_force")
    if None in (low, high, *ends) or force is None or scene.drives or scene.frictions or scene.stops:
        return
    q, step = statics.get(name), largest(np.diff(force))
    if abs(abs(q[-1] - q[0]) - abs(ends[1] - ends[0])) > 1e-2 * abs(ends[1] - ends[0]):
        return
    for stated, found in ((low, (-force).min()), (high, (-force).max())):  # the actuator holds what the loads do
        judge.compare("equilibria", max(abs(stated - found) - step, 0.0), max(abs(low), abs(high)), "SI", "extent of the static force")


def sign_changes(judge, scene, places, statics, summary, name):
    """Between two rows of `statics` with forces of different sign there is an equilibrium."""
    if statics is None or f"{name}.actuator_force" not in statics or scene.drives or scene.frictions or scene.stops:
        return
    q, force = statics.get(name), statics.get(f"{name}.actuator_force")
    low, high = result(summary, f"searched.{name}.from"), result(summary, f"searched.{name}.to")
    if low is None or high is None or any(".neutral" in key for key in summary["results"]):
        return
    turns = [0.0, -2.0 * np.pi, 2.0 * np.pi] if scene.actuators[0].measure.is_angle else [0.0]
    clear = 1e-9 * largest(force)
    for a, b, f, g in zip(q[:-1], q[1:], force[:-1], force[1:]):
        if f * g < 0.0 and min(abs(f), abs(g)) > clear and any(low <= a + t and b + t <= high for t in turns):
            slack = 1e-6 * abs(b - a)
            met = any(min(a, b) - slack <= p - t <= max(a, b) + slack for p in places for t in turns)
            judge.require("stability", met, f"no equilibrium between {a} and {b}, where the static force changes its sign")

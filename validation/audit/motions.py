"""Rows, events and the summary of a free motion in the files of `simulate`."""

import numpy as np

import kinematics
import poses
from balance import Balance, actuator_forces, add_reactions
from files import result
from forces import DriveForces, stop_forces, value_of
from joints import along
from judge import largest
from kinematics import beyond_estimate, even_rows, simpson


def judge_motion(judge, motion, events):
    """Judges all rows of a motion."""
    rows, scene = motion.rows, motion.scene
    corners = [*kinematics.switch_times(motion), *event_times(events)]
    corners += [c for law, _ in scene.laws("motion").values() for c in law.corners]
    kinematics.closure(judge, motion)
    kinematics.laws(judge, motion, "motion")
    kinematics.between_rows(judge, rows, corners)
    forces = forces_of_rows(judge, motion)
    energies(judge, motion, forces, corners)
    motors(judge, motion, forces["drives"])
    poses.repeated(judge, motion)
    stops_hold(judge, motion)
    return corners


def event_times(events):
    return [] if events is None else list(events.get("t"))


def forces_of_rows(judge, motion):
    """Newton's and Euler's equations of every row with loads, drives, friction and stops; powers by their names."""
    scene = motion.scene
    of_loads = poses.loads(judge, motion, motion.time())
    balance, powers = Balance(motion), {}
    for name, wrenches in of_loads.items():
        balance.add(wrenches)
        powers[name] = sum(w.power(motion) for w in wrenches) if wrenches else np.zeros(motion.count)
    add_reactions(judge, balance)
    drives = drive_forces(judge, motion, balance, powers)
    of_friction = poses.frictions(judge, motion, True)
    prescribed = scene.laws("motion")
    actuators = actuator_forces(balance, True, prescribed)
    add_stops(motion, balance, powers)
    balance.add_inertia()
    complete = drives is not None and all(w is not None for w in of_friction.values())
    if complete and poses.varying_is_known(judge, motion):
        for joint, wrenches in of_friction.items():
            balance.add(wrenches)
            powers[f"friction of {joint}"] = sum(w.power(motion) for w in wrenches)
        balance.judge(judge, "motion-equilibrium", "")
    elif not complete:
        judge.skip("equilibrium", "a drive or friction has no columns")
    poses.known_reactions(judge, motion)
    outside = {**of_friction} if complete else {"": None}
    still = np.zeros(motion.count)  # on a rigid stop nothing moves
    of_stops = [powers.get(stop["name"], still) for stop in scene.stops]
    poses.totals(judge, motion, of_loads, outside, actuators + of_stops, drives or {})
    return {"powers": powers, "drives": drives or {}, "complete": complete, "actuators": actuators}


def drive_forces(judge, motion, balance, powers):
    """The net forces of all drives, compared with their columns; None if one has no value."""
    scene, rows, found = motion.scene, motion.rows, {}
    names = motion.names(motion.time())
    for drive in scene.drives:
        measure = scene.coordinate(drive.coordinate).measure
        magnitude = None if drive.magnitude is None else value_of(drive.magnitude, names, motion.count)
        of = found[drive.name] = DriveForces(drive, motion.measure(measure), magnitude, rows)
        net = of.net()
        if net is None:
            judge.skip(f"drive {drive.name}", "its force depends on a state without a column")
            return None
        balance.add(along(motion, measure), net)
        if of.written is not None:
            judge.compare("drives", of.written - net, largest(of.force(), of.written), "SI", f"drive {drive.name}")
        power = rows.get(f"{drive.name}.power")
        if power is not None:
            values = net * of.coordinate.first
            judge.compare("powers", power - values, largest(power, of.force() * of.coordinate.first), "W", f"{drive.name}.power")
        powers[drive.name] = of.force() * of.coordinate.first
    return found


def add_stops(motion, balance, powers):
    """Adds the forces of compliant stops. The force of a rigid stop on which a coordinate rests is in no column."""
    for stop in motion.scene.stops:
        measure = motion.scene.coordinate(stop["coordinate"]).measure
        unit = along(motion, measure)
        if stop["stiffness"] is not None:
            coordinate, force = stop_forces(stop, motion)
            balance.add(unit, force)
            powers[stop["name"]] = force * coordinate.first
        else:
            resting = rests(stop, motion)
            if resting.any():
                balance.add_unknown([w.times(resting.astype(float)) for w in unit])


def rests(stop, motion):
    """The rows in which the coordinate may rest on a rigid stop."""
    q = motion.measure(motion.scene.coordinate(stop["coordinate"]).measure)
    size, speed = largest(q.value) + 1e-300, largest(q.first) + 1e-300
    ends = [np.abs(q.value - stop[end]) <= 1e-9 * size for end in ("min", "max") if end in stop]
    return np.any(ends, axis=0) & (np.abs(q.first) <= 1e-9 * speed)


def stops_hold(judge, motion):
    """No row is beyond a rigid stop."""
    for stop in motion.scene.stops:
        column = motion.rows.get(stop["coordinate"])
        if stop["stiffness"] is None and column is not None:
            beyond = np.maximum(stop.get("min", -np.inf) - column, column - stop.get("max", np.inf))
            judge.compare("stops", np.maximum(beyond, 0.0), max(1.0, largest(column)), "SI", f"{stop['name']}: {stop['coordinate']}")


# Energies.


def energies(judge, motion, forces, corners):
    """Judges the kinetic energy with the power of all forces, and the columns of energies and works."""
    rows, time = motion.rows, motion.rows.get("t")
    if time is None or "energy.kinetic" not in rows:
        judge.skip("energies", "no columns of energies")
        return
    kinetic, rate, _ = poses.kinetic(motion)
    for of in forces["drives"].values():
        rotor, q = of.numbers["rotor"], of.coordinate
        kinetic = kinetic + 0.5 * rotor * q.first**2
    works = dict(rows.ending(".work"))
    potential = rows.get("energy.potential")
    potential = np.zeros_like(time) if potential is None else potential
    scale = largest(kinetic, potential - potential[0], *works.values()) or 1.0
    judge.compare("energy-columns", rows.get("energy.kinetic") - kinetic, scale, "J", "energy.kinetic")
    between = Between(judge, time, corners, scale)
    powers, actuators = forces["powers"], forces["actuators"]
    if forces["complete"] and all(p is not None for p in actuators):
        between.integral("energy", kinetic, sum([*powers.values(), *actuators], np.zeros_like(time)), "kinetic energy")
    kept = [name for name in powers if name not in works and name not in forces["drives"]]
    of_loads = {load.name for load in motion.scene.loads}
    lost = -sum((powers[name] for name in kept if name in of_loads), np.zeros_like(time))
    between.integral("energies", potential, lost, "energy.potential")
    potentials(judge, motion, [name for name in kept if name in of_loads], potential, scale)
    for name, work in works.items():
        judge.compare("energy-columns", work[0], scale, "J", f"{name}.work at the start")
        power = powers.get(name)
        power = rows.get(f"{name}.power") if power is None else power
        if name == "loads":  # of many loads together
            power = sum(powers[load] for load in of_loads)
        if power is not None:
            between.integral("energies", work, power, f"{name}.work")
    states(judge, motion, forces["drives"], between)
    balance = rows.get("energy.balance_error")
    if balance is not None:
        total = kinetic + potential - sum(works.values(), np.zeros_like(time))
        judge.compare("energy-columns", balance - (total - total[0]), scale, "J", "energy.balance_error")
        judge.compare("energy-balance", balance, scale, "J", "energy.balance_error itself")


class Between:
    """Integrals between the rows of a motion, away from events and switches."""

    def __init__(self, judge, time, corners, scale):
        self.judge, self.time, self.scale = judge, time, scale
        self.inside = even_rows(time, corners) if len(time) >= 5 else None

    def integral(self, key, values, rate, place, scale=None):
        if self.inside is not None and self.inside.any():
            excess = beyond_estimate(*simpson(self.time, values, rate), 5)
            self.judge.compare(key, np.where(self.inside, excess, 0.0), scale or self.scale, "J", place)


def potentials(judge, motion, names, potential, scale, key="energy-columns"):
    """The potential of loads whose magnitudes are constant, up to a constant."""
    total, at = np.zeros(motion.count), motion.names(motion.time())
    for load in motion.scene.loads:
        if load.name not in names:
            continue
        if not load.magnitude.is_constant or load.kind == "torque" and motion.scene.is_plane is False:
            return
        amount = float(load.magnitude(at).value.flat[0])
        if load.kind == "gravity":
            bodies = enumerate(motion.scene.bodies)
            total -= amount * sum(body.mass * motion.center(k).value @ load.direction for k, body in bodies)
        elif load.kind == "force" and not load.in_body:
            total -= amount * motion.point(load.place).value @ load.direction
        elif load.source == "spring":
            total += 0.5 * amount * (motion.measure(load.measure).value - load.free) ** 2
        elif load.kind == "along" and load.source == "given":
            total -= amount * motion.measure(load.measure).value
        else:
            return
    judge.compare(key, (potential - potential[0]) - (total - total[0]), scale, "J", "potential energy by the loads")


def states(judge, motion, drives, between):
    """Judges currents and integrals of controllers by the integrals of their rates."""
    rows = motion.rows
    for name, of in drives.items():
        current, rate = rows.get(f"{name}.current"), of.current_rate
        if current is not None and rate is not None:
            between.integral("energy", current, rate, f"{name}.current", largest(current))
        if of.integral is not None and of.unlimited is not None:  # while the force is at its limit the integral waits
            error = of.magnitude - of.coordinate.first
            held = np.abs(of.unlimited) > of.numbers.get("limit", np.inf)
            between.integral("energy", of.integral, np.where(held, 0.0, error), f"{name}.integral", largest(of.integral) or 1.0)


def motors(judge, motion, drives):
    """Judges the electrical power and the efficiency of motors, from voltage and current."""
    rows = motion.rows
    for name, of in drives.items():
        taken, efficiency = rows.get(f"{name}.electrical_power"), rows.get(f"{name}.efficiency")
        if not of.has_circuit:
            known = [end for end in ("current", "electrical_power", "efficiency") if f"{name}.{end}" in rows]
            judge.require("motors", not known, f"columns {known} of `{name}`, which has no circuit")
            continue
        current = of.current
        if current is None:
            continue
        if taken is not None:
            judge.compare("motors", taken - of.magnitude * current, largest(taken), "W", f"{name}.electrical_power")
        column = rows.get(f"{name}.current")
        if column is not None:
            judge.compare("motors", column - current, largest(column), "A", f"{name}.current")
        if efficiency is not None and of.written is not None:
            delivered = (of.written + of.numbers["rotor"] * of.coordinate.second) * of.coordinate.first
            whole = delivered + of.numbers["resistance"] * current**2
            difference = np.where(delivered > 0.0, efficiency * whole - delivered, np.nan_to_num(efficiency) * largest(whole))
            judge.compare("motors", difference, largest(whole), "W", f"{name}.efficiency")


# Summary and events.


def judge_summary(judge, scene, rows, events, summary):
    """Compares energies, end and events of the summary with the rows and the table of events."""
    time, kinetic = rows.get("t"), rows.get("energy.kinetic")
    events_stop = any(event.get("stop") for event in scene.keys.get("motion", {}).get("events", {}).values())
    duration = scene.keys.get("motion", {}).get("duration", time[-1] if summary.get("status") == 0 and not events_stop else None)
    if duration is not None and result(summary, "duration") is not None:
        judge.compare("summary", result(summary, "duration") - duration, duration, "s", "duration")
    stated = result(summary, "end")
    if stated is not None:
        judge.compare("summary", stated - time[-1], time[-1], "s", "end")
    stated = result(summary, "largest_kinetic_energy")
    if stated is not None and kinetic is not None:
        change = largest(np.diff(kinetic))  # between rows it may be larger by no more than that
        excess = max(largest(kinetic) - stated, stated - largest(kinetic) - change, 0.0)
        judge.compare("summary", excess, largest(kinetic) or 1.0, "J", "largest_kinetic_energy")
        balance, share = rows.get("energy.balance_error"), result(summary, "energy_balance_error")
        if balance is not None and share is not None:
            excess = max(largest(balance) - share * stated, 0.0)
            judge.compare("summary", excess, largest(kinetic) or 1.0, "J", "energy_balance_error")
    judge_event_counts(judge, scene, events, summary)


def event_number(scene, summary, name):
    """The number of an event in the column `event`: its position in the scene, or the number in the summary."""
    number = result(summary, f"event.{name}.number")
    wanted = list(scene.keys.get("motion", {}).get("events", {}))
    return wanted.index(name) + 1 if number is None and name in wanted else number


def judge_event_counts(judge, scene, events, summary):
    """Judges the number of events of each kind, and the first of each."""
    found = {k[6:-6]: result(summary, k) for k in summary["results"] if k.startswith("event.") and k.endswith(".count")}
    times, numbers = event_times(events), None if events is None else events.get("event")
    for name, count in found.items():
        number = event_number(scene, summary, name)
        own = times if numbers is None or number is None else [t for t, k in zip(times, numbers) if k == number]
        judge.compare("summary", len(own) - count, 1.0, "", f"number of events `{name}`")
        first = result(summary, f"event.{name}.first")
        if own and first is not None:
            judge.compare("summary", own[0] - first, max(abs(first), 1e-3), "s", f"first event `{name}`")
    if found:
        judge.compare("summary", len(times) - sum(found.values()), 1.0, "", "number of all events")


def missing_events(judge, scene, rows, events):
    """If two successive rows are on different sides of an event, the table has an event between them."""
    wanted = scene.keys.get("motion", {}).get("events", {})
    if scene.stops or not wanted:
        return
    time, times = rows.get("t"), np.array(event_times(events))
    for name, event in wanted.items():
        for side in event_sides(scene, rows, event):
            clear = np.abs(side) > 1e-6 * largest(side)
            decided = np.nonzero(clear)[0]
            for a, b in zip(decided[:-1], decided[1:]):
                if side[a] * side[b] < 0.0:
                    near = 1e-9 * abs(time[b])
                    holds = bool(np.any((times >= time[a] - near) & (times <= time[b] + near)))
                    judge.require("events", holds, f"no event `{name}` between t = {time[a]} s and {time[b]} s")


def event_sides(scene, rows, event):
    """The quantities whose changes of sign are events, in every row."""
    if "reverses" in event:
        column = rows.get(f"{event['reverses']}.velocity")
        return [] if column is None else [column]
    if "reaction" in event:
        column = rows.get(event["reaction"])
        return [] if column is None else [column - event.get("value", 0.0)]
    name = event.get("reaches", event.get("revolution"))
    column = rows.get(name)
    if column is None:
        return []
    if "reaches" in event:
        unit = scene.unit_of(scene.coordinate(name).measure)
        return [column - event["value"] * unit]
    turns = (column - column[0]) / (2.0 * np.pi)
    whole = int(np.floor(largest(turns)))
    return [np.maximum(np.abs(turns) - k, -1.0) for k in range(1, min(whole, 200) + 1)]


def events_are_met(judge, scene, rows, events, summary):
    """At each event the coordinate has the value of the scene, or zero velocity. A terminal event is the end of the motion."""
    if events is None:
        return
    for name, event in scene.keys.get("motion", {}).get("events", {}).items():
        own = np.asarray(events.get("event")) == event_number(scene, summary, name)
        if not own.any():
            continue
        if event.get("stop"):
            end = rows.get("t")[-1]
            judge.compare("events", events.get("t")[own][0] - end, end, "s", f"event `{name}` stops the motion")
        coordinate = event.get("reaches", event.get("reverses"))
        if "reaches" in event and coordinate in events:
            value = event["value"] * scene.unit_of(scene.coordinate(coordinate).measure)
            judge.compare("events", events.get(coordinate)[own] - value, max(1.0, abs(value)), "SI", f"event `{name}`")
        if "reverses" in event and f"{coordinate}.velocity" in events:
            speeds = events.get(f"{coordinate}.velocity")
            judge.compare("events", speeds[own], max(largest(speeds), 1.0), "SI", f"event `{name}`")


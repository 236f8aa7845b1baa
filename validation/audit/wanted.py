"""Start, end and speed of the rows: those of the scene, unless its motion ends early."""

import numpy as np

from judge import largest


def compare(judge, found, wanted, place):
    judge.compare("wanted", found - wanted, max(1.0, abs(wanted)), "SI", place)


def positions(judge, scene, rows, summary, at_rest):
    """The prescribed motion, or the coordinate sweep."""
    if not summary or summary.get("status") != 0:
        return
    sweep = scene.keys.get("coordinate-sweep")
    if "prescribed" in scene.keys:
        if "t" in rows:
            compare(judge, rows.get("t")[0], 0.0, "the first time")
            compare(judge, rows.get("t")[-1], scene.keys["prescribed"]["duration"], "the last time")
    elif sweep is not None:
        for coordinate in scene.actuators:
            sweep_of(judge, scene, rows, sweep, coordinate, at_rest)


def sweep_of(judge, scene, rows, sweep, coordinate, at_rest):
    """One actuator between two values at a constant speed, all others fixed."""
    name, unit = coordinate.name, scene.unit_of(coordinate.measure)
    q, speed, of = rows.get(name), rows.get(f"{name}.velocity"), sweep.get(name)
    if q is None or of is None:
        return
    ends = of if isinstance(of, list) else [of, of]
    for found, wanted, which in zip((q[0], q[-1]), ends, ("first", "last")):
        compare(judge, found, wanted * unit, f"the {which} {name}")
    if speed is not None and not at_rest:
        wanted = sweep["speed"] * unit if "speed" in sweep else 1.0
        wanted = np.sign(ends[1] - ends[0]) * wanted if isinstance(of, list) else 0.0
        judge.compare("wanted", speed - wanted, max(1.0, abs(wanted)), "SI", f"{name}.velocity")


def motion(judge, scene, rows, events, summary):
    """The start of a free motion, and its end unless an event or a limit ends it before."""
    time, keys, laws = rows.get("t"), scene.keys.get("motion", {}), scene.laws("motion")
    if time is None:
        return
    for coordinate in scene.actuators:
        if time[0] != 0.0 or coordinate.name in laws:
            continue
        start = scene.initial("initial-coordinate", coordinate)
        start = scene.start_of(coordinate) if start is None else start
        speed = scene.initial("initial-velocity", coordinate) or 0.0
        for name, value in ((coordinate.name, start), (f"{coordinate.name}.velocity", speed)):
            if name in rows and value is not None:
                compare(judge, rows.get(name)[0], value, f"{name} at the start")
    ends_early = any(event.get("stop") for event in keys.get("events", {}).values()) or (summary or {}).get("status") != 0
    if "duration" in keys and not ends_early:
        compare(judge, time[-1], keys["duration"], "the end")
    for stop in scene.stops:
        if stop["stiffness"] is None and events is not None:
            impacts(judge, rows, events, stop, summary)


def impacts(judge, rows, events, stop, summary):
    """After an impact on a rigid stop, the speed of a coordinate is `restitution` times the speed in the rows before."""
    name, time = stop["coordinate"], rows.get("t")
    number = (summary or {}).get("results", {}).get(f"event.{stop['name']} is struck.number", {}).get("value")
    q, speed, all_times = (of.get(n) for of, n in ((rows, name), (rows, f"{name}.velocity"), (events, "t")))
    after = events.get(f"{name}.velocity")
    if number is None or q is None or speed is None or after is None:
        return
    for t, v, kind in zip(all_times, after, events.get("event")):
        k = int(np.searchsorted(time, t))
        if kind != number or k < 5 or np.any((all_times >= time[k - 5]) & (all_times < t)):
            continue
        nearest = min((abs(value) for value in (stop.get("min"), stop.get("max")) if value is not None), default=0.0)
        place = events.get(name)[list(all_times).index(t)]
        ends = [stop[end] for end in ("min", "max") if end in stop]
        judge.compare("wanted", min(abs(place - end) for end in ends), max(1.0, nearest), "SI", f"{name} at an impact")
        before = np.polyval(np.polyfit(time[k - 4 : k] - t, speed[k - 4 : k], 3), 0.0)
        judge.compare("impacts", v + stop["restitution"] * before, largest(speed), "SI", f"{name}.velocity after the impact at t = {t:.6g} s")

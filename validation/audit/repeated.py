"""Numbers that occur in several files: archives, extrema of the summary, headings, quotients and extents of columns."""

import numpy as np

from judge import largest
from kinematics import beyond_estimate, even_rows, simpson


# Columns whose extrema are those of the rows: errors, what is infinite in some positions, rotations in space.
OF_ROWS = ("mechanical_advantage", "pole", "balance", "residual", ".rotation.")
# Columns that bend sharply, and those that jump or are zero over zero where a motion begins: of these only the rows are compared.
NOT_SMOOTH = (".friction.",)
JUMPS = (".direction", ".efficiency")


def archive(judge, rows, npz):
    """Every column of the table is in the archive, with the same numbers, and the archive lists the same names and units."""
    if npz is None:
        return
    for name, values in rows.columns.items():
        other = npz.get(name)
        if other is None or other.shape != values.shape:
            judge.require("archive", False, f"the archive has no column {name} of {rows.count} rows")
            continue
        same = (values == other) | (np.isnan(values) & np.isnan(other))
        judge.compare("archive", np.where(same, 0.0, values - other), np.abs(values), "SI", name)
    if "columns" in npz and "units" in npz:
        listed = dict(zip(map(str, npz["columns"]), map(str, npz["units"])))
        judge.require("archive", listed == rows.units, "names and units of the archive are not those of the table")


POSITIONS = ("rad", "m", "rad/s", "m/s", "rad/s2", "m/s2", "")  # units of what a prescribed motion has without forces


def extrema(judge, rows, summary, corners=(), of_positions=()):
    """Judges the extrema of the summary: no row is beyond them, and a polynomial through rows reaches them at the stated positions."""
    if not summary or not summary.get("extrema"):
        return
    events = [event["t"] for event in summary.get("events") or [] if isinstance(event.get("t"), float)]
    x = rows.get((summary.get("extrema_over") or {}).get("name", "t"))
    scales = {}
    for entry in summary["extrema"]:
        sizes = [abs(entry[end]["value"]) for end in ("min", "max")]
        scales[entry["unit"]] = max(scales.get(entry["unit"], 0.0), *sizes)
    for entry in summary["extrema"]:
        y = rows.get(entry["quantity"])
        if y is None or x is None:
            judge.require("extrema", False, f"the extremum of {entry['quantity']} has no column")
            continue
        is_zero = entry["min"]["value"] == 0.0 == entry["max"]["value"]  # zero but for rounding is written as zero
        scale = max(scales[entry["unit"]], 1.0 if is_zero else 0.0) or 1.0
        for end, sign in (("min", -1.0), ("max", 1.0)):
            near = of_positions if entry["unit"] in POSITIONS else corners
            extremum(judge, (x, y), entry, (end, sign), scale, [*near, *events], is_zero)


def extremum(judge, curve, entry, side, scale, corners, is_zero):
    """Judges the minimum or the maximum of a column."""
    (x, y), (end, sign), quantity = curve, side, entry["quantity"]
    value, at, place = entry[end]["value"], entry[end]["at"], f"{end} of {quantity}"
    judge.compare("extrema", max(np.nanmax(sign * (y - value)), 0.0), scale, entry["unit"], f"a row beyond {place}")
    k = int(np.clip(np.searchsorted(x, at, side="right"), 1, len(x) - 1)) if x[0] <= x[-1] else None
    if k is None or is_zero or any(part in quantity for part in JUMPS):
        return
    if at in (x[0], x[-1]):
        judge.compare("extrema", value - y[0 if at == x[0] else -1], scale, entry["unit"], f"{place}, in a row")
        return
    if quantity.endswith("magnitude"):  # the square of a length is smooth where the length is not
        value, y, scale, place = value**2, y**2, scale**2, f"{place} (its square)"
    # At the start of a motion a transient may be faster than the rows.
    is_smooth = not any(part in quantity for part in NOT_SMOOTH) and k > 2
    near = [through(x, y, at, k, half, corners) for half in (2, 3, 4)] if is_smooth else [None]
    if None not in near:
        # The change by two more rows, or a part of that before, which may be small by chance.
        few, more = ([abs(a - b) for a, b in zip(near[j], near[j + 1])] for j in (0, 1))
        error, error_of_slope = (10.0 * max(more[k], few[k] / 3.0) for k in (0, 1))
        many, slope = near[2]
        if error < 1e-5 * scale:  # otherwise the rows are too far apart for a polynomial
            judge.compare("extrema", max(abs(value - many) - error, 0.0), scale, entry["unit"], place)
            if x[0] < at < x[-1] and error_of_slope < 1e-4 * scale and not any(part in quantity for part in OF_ROWS):
                judge.compare("places", max(abs(slope) - error_of_slope, 0.0), scale, entry["unit"], place)
            return
    # Elsewhere it is not much farther from the rows around its place than a curve bends there.
    around = y[max(k - 3, 0) : k + 3]
    change = 1.5 * np.nanmax(np.abs(np.diff(around, 2))) if len(around) > 2 else np.inf
    excess = max(np.nanmin(np.abs(around - value)) - change, 0.0)
    judge.compare("extrema", excess, scale, entry["unit"], f"{place}, by the rows around it")


def through(x, y, at, k, half, corners):
    """Value and slope (per row) of the polynomial through the rows around a position; None if the column is not smooth."""
    start = int(np.clip(k - half, 0, len(x) - 2 * half))
    rows = slice(start, start + 2 * half)
    xs, ys = x[rows], y[rows]
    low, high = x[max(k - 4, 0)], x[min(k + 3, len(x) - 1)]
    if len(xs) < 2 * half or start < 0 or any(low <= c <= high for c in corners):
        return None
    distance = (xs[-1] - xs[0]) / (2 * half - 1)
    if not np.all(np.diff(xs) > 0.0):
        return None

    def value(place):
        return sum(ys[i] * np.prod([(place - xs[j]) / (xs[i] - xs[j]) for j in range(2 * half) if j != i]) for i in range(2 * half))

    step = 1e-3 * distance
    return value(at), (value(at + step) - value(at - step)) / 2e-3


def ascends(judge, rows, name):
    """The abscissa of a table is monotone."""
    steps = np.diff(rows.get(name)) if name in rows else np.zeros(0)
    judge.require("order", bool(np.all(steps >= 0.0) or np.all(steps <= 0.0)), f"{name} neither grows nor falls all the time")


def summary_of_table(judge, rows, summary):
    """Judges the number of rows and columns, the first and the last abscissa, and the extremes of transmission angles."""
    over = (summary.get("extrema_over") or {}).get("name")
    found = {"positions": rows.count, "columns": len(rows.columns) + len(rows.words)}
    if over in rows:
        found |= {"from": rows.get(over)[0], "to": rows.get(over)[-1]}
    results = summary.get("results", {})
    for name, value in found.items():
        if name in results:
            judge.compare("summary", results[name]["value"] - value, max(1.0, abs(value)), "SI", name)
            if summary.get("status") == 0 and f"wanted_{name}" in results:
                judge.compare("summary", results[f"wanted_{name}"]["value"] - value, max(1.0, abs(value)), "SI", f"wanted_{name}")
    extrema = {entry["quantity"]: entry for entry in summary.get("extrema") or []}
    for name, entry in results.items():
        stem, _, end = name.rpartition(".")
        if stem.endswith(".transmission_angle") and stem in extrema:
            judge.compare("summary", entry["value"] - extrema[stem][end]["value"], np.pi, "rad", name)


def quotients(judge, motion):
    """Judges velocity ratios and transmission angles."""
    rows, scene = motion.rows, motion.scene
    if not scene.actuators:
        return
    name = scene.actuators[0].name
    speed = rows.get(f"{name}.velocity")
    if speed is None and len(scene.actuators) == 1 and name in rows and rows.count >= 5:
        ratios_between_rows(judge, rows, rows.get(name))
    for stem, ratios in rows.ending(".velocity_ratio"):
        velocity = next((rows.get(f"{stem}.{end}") for end in ("angular_velocity", "velocity") if f"{stem}.{end}" in rows), None)
        if velocity is not None and speed is not None:
            scale = max(largest(velocity), 1e-3 * largest(speed)) or 1.0
            judge.compare("quotients", ratios * speed - velocity, scale, "SI", f"{stem}.velocity_ratio")
    for stem, angles in rows.ending(".transmission_angle"):
        pin = scene.joint(stem)
        sides = [lines_from(motion, pin, place) for place in pin.places]
        differences = [angles - angle_between(u, v) for u in sides[0] for v in sides[1]]
        if differences:  # which links make the dyad is the program's choice, and the same in all rows
            best = min(differences, key=lambda d: np.nanmax(np.abs(d)))
            judge.compare("quotients", best, np.pi, "rad", f"{stem}.transmission_angle")


def lines_from(motion, pin, place):
    """The lines of a body from its pin: to its other pins, and along the normals of its slides."""
    found, scene = [], motion.scene
    for joint in (j for j in scene.joints if j is not pin):
        for k, other in enumerate(joint.places):
            if other.body == place.body and joint.kind == "revolute":
                found.append((motion.point(other) - motion.point(place)).value)
            elif other.body == place.body and joint.kind in ("prismatic", "slot"):
                normal = motion.direction(other.body, joint.normals[k]).value
                found += [normal, -normal]
    return found


def angle_between(u, v):
    """The angle between two lines, 0 to π."""
    return np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(-1))


def ratios_between_rows(judge, rows, q):
    """At rest an angle or a travel changes by the integral of its velocity ratio over the coordinate."""
    inside = even_rows(q)
    for stem, ratios in rows.ending(".velocity_ratio"):
        values = next((rows.get(n) for n in (f"{stem}.angle", f"{stem}.travel", stem) if n in rows), None)
        if values is not None:
            excess = beyond_estimate(*simpson(q, values, ratios), 5)
            scale = max(largest(ratios), 1e-3) * np.abs(np.diff(q)[1:-2])
            judge.compare("ratios", np.where(inside, excess, 0.0), np.where(inside, scale, 1.0), "SI", f"{stem}.velocity_ratio")


def extents(judge, rows, summary):
    """Compares the ranges of body angles and travels, and the dwell of a body, with the rows."""
    results = (summary or {}).get("results", {})
    for key, entry in results.items():
        name = key.removesuffix(".range")
        if name == key or f"{key}.from" not in results or name not in rows:
            continue
        by, low, high = (results[k]["value"] for k in (key, f"{key}.from", f"{key}.to"))
        values = rows.get(name)
        judge.compare("extents", by - (high - low), by or 1.0, entry["unit"], key)
        beyond = max(low - values.min(), values.max() - high, 0.0) - 1e-6 * by  # an end that is rounding is written as zero
        judge.compare("extents", max(beyond, 0.0), by or 1.0, entry["unit"], f"rows beyond {key}")
        gap = max(values.min() - low, high - values.max()) - largest(np.diff(values))
        judge.compare("extents", max(gap, 0.0), by or 1.0, entry["unit"], f"{key} beyond the rows")


def dwell(judge, scene, rows, summary):
    """The longest window of rows within a band of the range of a body's angle."""
    wanted, results = scene.keys.get("requests", {}).get("dwell"), (summary or {}).get("results", {})
    if not wanted or "dwell.angle" not in results or f"{wanted['body']}.angle" not in rows:
        return
    angles, time = rows.get(f"{wanted['body']}.angle"), rows.get("t")
    band, best = wanted["relative-band"] * np.ptp(angles), (0, 0)
    for first in range(len(angles)):
        last = first + best[1] - best[0] + 1
        while last < len(angles) and np.ptp(angles[first : last + 1]) <= band:
            best, last = (first, last), last + 1
    inside = angles[best[0] : best[1] + 1]
    found = {"dwell.angle": 0.5 * (inside.min() + inside.max())}
    if time is not None:
        found |= {"dwell.t.from": time[best[0]], "dwell.t.to": time[best[1]]}
    for name, value in found.items():
        if name in results:
            judge.compare("extents", results[name]["value"] - value, 1.0, "SI", name)


# Units of columns by the end of their name; of an angle, or of a length.
UNITS = (
    (".actuator_force", ("N m", "N")), (".load_force", ("N",)), (".load_moment", ("N m",)), (".power", ("W",)), (".work", ("J",)),
    (".angular_velocity", ("rad/s",)), (".angular_acceleration", ("rad/s2",)), (".angle", ("rad",)), (".magnitude", ("N", "N m")),
    (".travel.velocity", ("m/s",)), (".travel.acceleration", ("m/s2",)), (".travel", ("m",)), (".moment-magnitude", ("N m",)),
    (".current", ("A",)), (".electrical_power", ("W",)), (".normal", ("N",)), (".tooth", ("N",)), (".axial", ("N",)),
    (".moment", ("N m",)), (".moment-x", ("N m",)), (".moment-y", ("N m",)), (".moment-z", ("N m",)), (".direction", ("rad",)),
    (".vx", ("m/s",)), (".vy", ("m/s",)), (".vz", ("m/s",)), (".ax", ("m/s2",)), (".ay", ("m/s2",)), (".az", ("m/s2",)),
)


def headings(judge, scene, rows):
    """Compares the units of columns with their names."""
    wanted = {"t": ("s",)}
    for coordinate in scene.coordinates:
        unit = "rad" if coordinate.measure.is_angle else "m"
        wanted |= {coordinate.name + end: (unit + per,) for end, per in (("", ""), (".velocity", "/s"), (".acceleration", "/s2"))}
        wanted[f"{coordinate.name}.actuator_force"] = ("N m" if coordinate.measure.is_angle else "N",)
    for body in scene.bodies:
        wanted |= {f"{body.name}.{point}.{axis}": ("m",) for point in body.points for axis in "xyz"}
    for joint in scene.joints:
        wanted |= {f"{joint.name}.{axis}": ("N",) for axis in "xyz"}
    for name, unit in rows.units.items():
        units = wanted.get(name) or next((units for end, units in UNITS if name.endswith(end)), None)
        units = {"energy": ("J",), "power": ("W",)}.get(name.split(".")[0], units)
        if units is not None:
            judge.require("headings", unit in units, f"{name} is in `{unit}`")

"""Rows of `sweep`: drawn numbers, statistics, and m of variants by sums over bodies."""

import re
import tomllib

import numpy as np

import poses
from files import result
from judge import largest
from reduced import unit_motion
from scene import Scene


WEYL, FACTORS = (0x9E3779B9, 0xBB67AE85), (0xD2511F53, 0xCD9E8D57)
LOWER = 0xFFFFFFFF


def uniform(seed, axis, sample):
    """Two uniform random numbers in (0, 1) for a sample of an axis: Philox4x32-10 (Salmon, Moraes, Dror and Shaw, 2011, table 2)."""
    block = [sample & LOWER, sample >> 32, axis, 0]
    for r in range(10):
        keys = [((seed >> (32 * k)) + r * WEYL[k]) & LOWER for k in (0, 1)]
        first, second = block[0] * FACTORS[0], block[2] * FACTORS[1]
        block = [(second >> 32) ^ block[1] ^ keys[0], second & LOWER, (first >> 32) ^ block[3] ^ keys[1], first & LOWER]
    # The first 52 bits of each half, at the middle of their interval.
    return [(high * 2**20 + (low >> 12) + 0.5) / 2**52 for high, low in (block[:2], block[2:])]


def normal(pair):
    """A standard normal number of two uniform ones (Box and Muller, 1958)."""
    return np.cos(2.0 * np.pi * pair[1]) * np.sqrt(2.0 * np.log(1.0 / pair[0]))


def read_axis(text, scene):
    """Path of an axis, its grid or none, and a function of two uniform numbers or none."""
    numbers = lambda part: [float(x) for x in re.findall(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?", part)]
    if "~" in text:
        path, law = text.split("~")
        a, b = numbers(law)
        return path, None, (lambda u: a + b * normal(u)) if law.startswith("normal") else (lambda u: a + (b - a) * u[0])
    if "±" in text or "+-" in text:
        path, width = re.split(r"±|\+-", text)
        nominal = number_at(scene.keys, path)
        half = numbers(width)[0] * (abs(nominal) / 100.0 if width.endswith("%") else 1.0)
        return path, None, lambda u: nominal + half * (2.0 * u[0] - 1.0)
    path, values = text.split("=")
    if ":" in values:
        low, high, count = (float(x) for x in values.split(":"))
        return path, np.linspace(low, high, int(count)), None
    return path, np.array(numbers(values)), None


def steps(keys, path):
    """The keys on the path to a number: from a body as in `calibrate`, else from the top of the scene."""
    parts = [p for p in re.split(r"[.\[\]]+", path) if p]
    parts = [int(p) if p.isdigit() else p for p in parts]
    return ["bodies", *parts] if parts[0] in keys["bodies"] else parts


def number_at(keys, path):
    value = keys
    for part in steps(keys, path):
        value = value[part]
    return float(value)


def with_numbers(text, values):
    """The scene with other numbers, by path."""
    keys = tomllib.loads(text)
    for path, number in values.items():
        *parts, last = steps(keys, path)
        value = keys
        for part in parts:
            value = value[part]
        value[last] = number
    return Scene(keys)


def judge_sweep(judge, scene, text, rows, study, summary, moving):
    """Judges all rows of a sweep."""
    axes = [read_axis(axis, scene) for axis in study.get("axes", "").split("; ") if axis]
    if axes:
        drawn(judge, rows, axes, int(result(summary, "samples") or 1), int(result(summary, "seed") or 0))
    else:
        judge.skip("drawn numbers", "no study says which numbers are varied")
    inputs = [path for path, _, _ in axes]
    for name, value in (("points", rows.count), ("rows", rows.count), ("points.missing", 0), ("samples", study.get("samples")), ("seed", study.get("seed"))):
        stated = result(summary, name)
        if stated is not None and value not in (None, ""):
            judge.compare("statistics", stated - float(value), 1.0, "", name)
    for name in rows.columns:
        if result(summary, f"{name}.smallest") is not None:
            statistics(judge, rows, name, inputs, summary)
    variants(judge, scene, text, rows, inputs, moving)


def drawn(judge, rows, axes, samples, seed):
    """Grids change most slowly in the first axis; random axes have the same samples for each combination."""
    grids = [grid for _, grid, _ in axes if grid is not None]
    is_random = any(law for _, _, law in axes)
    samples = samples if is_random else 1
    combinations = int(np.prod([len(grid) for grid in grids]))
    judge.compare("draws", rows.count - combinations * samples, 1.0, "", "number of points")
    judge.compare("draws", rows.get("index") - np.arange(rows.count), 1.0, "", "index")
    index = np.arange(rows.count)
    combination, sample = index // samples, index % samples
    for axis, (path, grid, law) in enumerate(axes):
        if grid is not None:
            place = grids.index(grid) if grid is not None else 0
            later = int(np.prod([len(other) for other in grids[place + 1 :]]))
            wanted = grid[combination // later % len(grid)]
        else:
            wanted = np.array([law(uniform(seed, axis, int(s))) for s in sample])
        judge.compare("draws", rows.get(path) - wanted, np.abs(wanted), "", path)


def statistics(judge, rows, name, inputs, summary):
    """Smallest, largest, mean, RMS, deviation and quantiles of a result, and where it is smallest and largest."""
    values = rows.get(name)
    values, which = values[~np.isnan(values)], np.nonzero(~np.isnan(rows.get(name)))[0]
    n, scale = len(values), largest(values) or 1.0
    deviation = values.std(ddof=1) if n > 1 else np.nan
    found = {
        "smallest": values.min(), "largest": values.max(), "mean": values.mean(), "rms": np.sqrt((values**2).mean()),
        "standard_deviation": deviation, "mean.standard_error": deviation / np.sqrt(n),
        "quantile_2.5": np.quantile(values, 0.025), "quantile_97.5": np.quantile(values, 0.975),
    }
    for what, value in found.items():
        stated = result(summary, f"{name}.{what}")
        if stated is not None and not np.isnan(value):
            judge.compare("statistics", stated - value, scale, "SI", f"{name}.{what}")
    for end, row in (("smallest", which[values.argmin()]), ("largest", which[values.argmax()])):
        for path in inputs:
            stated = result(summary, f"{name}.{end}.{path}")
            if stated is not None:
                expected = rows.get(path)[row]
                judge.compare("statistics", stated - expected, abs(expected) or 1.0, "", f"{name}.{end} at {path}")


# Numbers of bodies that do not affect the motion: the variants move as the scene does.
INERT = re.compile(r"\.(mass|inertia|center)(\[\d+\])*$")
VARIANTS = 12


def variants(judge, scene, text, rows, inputs, moving):
    """Extrema of m of some points by sums over bodies with their numbers, along the motion of the scene."""
    if not {"m.min", "m.max"} & set(rows.columns):
        return
    if not inputs or not all(INERT.search(path) for path in inputs):
        judge.skip("m of the variants", "what varies changes the motion")
        return
    motion = next((m for m in (along_itself(scene, other) for other in moving) if m), None)
    if motion is None:
        judge.skip("m of the variants", "no file of `runs` or `kinematics` says how the bodies move")
        return
    for row in np.unique(np.linspace(0, rows.count - 1, min(VARIANTS, rows.count)).astype(int)):
        motion.scene = with_numbers(text, {path: rows.get(path)[row] for path in inputs})
        m = 2.0 * poses.kinetic(motion)[0]
        for name, sign in (("m.min", -1.0), ("m.max", 1.0)):
            if name in rows and not np.isnan(rows.get(name)[row]):
                judge.compare("variants", beyond_rows(m, rows.get(name)[row], sign), largest(m), "kg m2", f"point {row}, {name}")


def along_itself(scene, rows):
    """The motion of a file at unit speed."""
    return None if rows is None else unit_motion(scene, rows, rows, scene.actuators[0].name)


def beyond_rows(values, extremum, sign):
    """The distance of an extremum from the interval between the highest row and twice a parabola's height above it."""
    heights = sign * values
    k = int(heights.argmax())
    bend = 2.0 * heights[k] - heights[k - 1 if k else -2] - heights[k + 1 if k + 1 < len(heights) else 1]
    above = sign * extremum - heights[k]
    return max(-above, above - 0.25 * bend, 0.0)

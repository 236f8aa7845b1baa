"""A test of the audit itself: it must find faults in files and in scenes. `python3 validation/audit/selftest.py PROGRAM [SCENE…]`.

The program's commands run on some scenes. Their files must pass as they are. Then one number or column after another is changed in what is
read of them, and one number or word after another in the scene, and the audit must fail each time. A changed table is judged without its
archive and its summary, which would give it away, and with no other file than those that its checks need.
"""

import copy
import random
import sys
import tempfile
import tomllib
from collections import Counter
from pathlib import Path

import numpy as np

import runs
import unfound
from files import Folder, Rows
from parts import judge_folder


TOP = Path(__file__).resolve().parents[1]
SCENES = [
    "four-bar/scene.toml", "slider-crank-friction/scene.toml", "press/scene.toml", "single-dwell/scene.toml", "rack-pinion/scene.toml",
    "planetary/scene.toml", "cam/scene.toml", "massless-coupler/scene.toml", "boom/scene.toml", "exported-model/scene.toml",
    "spatial/rssr.toml", "spatial/bevel-differential-held.toml", "spatial/screw-jack.toml", "spatial/stopped-arm.toml",
    "spatial/oblique-slider.toml", "capabilities/events.toml", "capabilities/motor.toml", "capabilities/teeth.toml",
    "capabilities/coupling-laws.toml", "capabilities/loads-between-points.toml", "capabilities/prescribed-laws.toml",
    "capabilities/tabulated-loads.toml", "capabilities/speed-controller.toml", "capabilities/pin-friction.toml", "capabilities/stop.toml",
]
# Tables, with the other files that their checks need; a star stands for their summary.
TABLES = {
    "kinematics": [], "statics": [], "kinetostatics": [], "motion": ["motion-events"], "reduced": ["run-i", "run-ii", "kinematics"],
    "run-i": [], "run-ii": [], "runs": ["run-i", "run-ii"], "cycle": ["reduced", "*cycle"], "equilibria": ["*equilibria"],
    "sweep": ["kinematics", "*sweep"],
}
SUMMARIES = {"kinematics": "kinematics", "statics": "statics", "kinetostatics": "kinetostatics", "simulate": "motion", "reduce": "reduced",
             "cycle": "cycle", "equilibria": "equilibria", "linearise": "linear", "sweep": "sweep", "check": "check", "calibrate": "calibrate"}
COMMANDS = {"kinematics": "kinematics", "statics": "statics", "kinetostatics": "kinetostatics", "motion": "simulate", "reduced": "reduce",
            "cycle": "cycle", "equilibria": "equilibria", "linear": "linearise"}
COLUMNS, NUMBERS, WORDS = 12, 20, 30  # drawn of each table, summary and scene


class Altered(Folder):
    """A folder of which some files are seen, with changes."""

    def __init__(self, whole, seen, tables=None, summaries=None, texts=None, scene_text=None):
        self.__dict__.update(whole.__dict__)
        self.whole, self.seen = whole, set(seen)
        self.changed, self.summaries, self.texts = tables or {}, summaries or {}, texts or {}
        self.scene_text = scene_text or whole.scene_text

    def csv(self, end):
        is_seen = end.split("-internal-forces")[0] in self.seen
        return self.changed.get(end) or (self.whole.csv(end) if is_seen else None)

    def npz(self, end):
        return self.whole.npz(end) if f"{end}.npz" in self.seen else None

    def summary(self, command):
        return self.summaries.get(command) or (self.whole.summary(command) if f"*{command}" in self.seen else None)

    def text(self, end):
        return self.texts.get(end) or (self.whole.text(end) if end in self.seen else None)


def is_found(folder):
    """Whether the audit fails, or cannot read the files."""
    try:
        return judge_folder(folder).has_failed
    except Exception:
        return True


# Faults in tables.


def faults_of(rows, name, rng):
    """A column as it should not be: another size, another sign, a row late, and another one's place; each by its kind."""
    values = rows.get(name)
    same = [n for n in rows.columns if rows.units[n] == rows.units[name] and n != name]
    scale = max(np.nanmax(np.abs(rows.get(n)), initial=0.0) for n in [name, *same])
    found = {"1e-6 larger": values * (1.0 + 1e-6), "reversed": -values, "one row late": np.roll(values, 1)}
    if same:
        found["another column"] = rows.get(rng.choice(same))
    for kind, other in found.items():
        # A change hidden by rounding, or without effect, is no fault.
        if not np.array_equal(np.isnan(other), np.isnan(values)) or np.nanmax(np.abs(other - values), initial=0.0) > 2e-7 * scale:
            yield kind, other


def with_column(rows, name, values):
    return Rows(rows.columns | {name: values}, rows.units, rows.words, rows.label)


def table_faults(folder, rng):
    for end, needed in TABLES.items():
        rows = folder.csv(end)
        if rows is None or rows.count < 2:
            continue
        names = list(rows.columns)
        names = [name for name in names if not np.isnan(rows.get(name)).all()]
        for name in rng.sample(names, min(COLUMNS, len(names))):
            for kind, values in faults_of(rows, name, rng):
                yield f"{end}: {name}, {kind}", Altered(folder, [end, *needed], {end: with_column(rows, name, values)})


def archive_faults(folder, rng):
    for end in TABLES:
        if folder.csv(end) is None or folder.npz(end) is None:
            continue
        rows = folder.csv(end)
        name = rng.choice(list(rows.columns))
        changed = with_column(rows, name, rows.get(name) * (1.0 + 1e-15) + 1e-300)
        yield f"{end}: archive of {name}", Altered(folder, [end, f"{end}.npz"], {end: changed})


def text_faults(folder, rng):
    """Faults in the numbers of the matrices."""
    text = folder.text("linear.csv")
    if text is None:
        return
    lines = [line.split(",") for line in text.splitlines()]
    places = [(i, j) for i, line in enumerate(lines) if line[0] != "matrix" for j in range(2, len(line)) if abs(float(line[j])) > 1e-6]
    largest = max((abs(float(lines[i][j])) for i, j in places), default=0.0)
    places = [(i, j) for i, j in places if abs(float(lines[i][j])) > 1e-3 * largest]
    for i, j in rng.sample(places, min(10, len(places))):
        other = copy.deepcopy(lines)
        other[i][j] = repr(1.001 * float(other[i][j]))
        changed = "\n".join(",".join(line) for line in other) + "\n"
        yield f"linear: row {lines[i][1]} of {lines[i][0]}", Altered(folder, ["linear.npz", "reduced", "*linearise"], texts={"linear.csv": changed})


# Faults in summaries.


def summary_faults(folder, rng):
    for command, end in SUMMARIES.items():
        summary = folder.summary(command)
        if summary is None:
            continue
        seen = [end, "motion-events", "cycle-flywheel", "reduced", "kinematics", "statics", "run-i", "linear.csv", "equilibria", "*equilibria"]
        names = list(summary.get("results", {}))
        for name in rng.sample(names, min(NUMBERS, len(names))):
            other = copy.deepcopy(summary)
            value = other["results"][name].get("value")
            if isinstance(value, (int, float)):
                other["results"][name]["value"] = 1.001 * value + (1e-3 if value == 0.0 else 0.0)
                yield f"{command}.json: {name}", Altered(folder, seen, summaries={command: other})
        extrema = summary.get("extrema") or []
        for k in rng.sample(range(len(extrema)), min(10, len(extrema))):
            for side in ("min", "max"):
                other = copy.deepcopy(summary)
                entry = other["extrema"][k]
                if abs(entry[side]["value"]) > 1e-3 * max(abs(e[s]["value"]) for e in extrema if e["unit"] == entry["unit"] for s in ("min", "max")):
                    entry[side]["value"] *= 1.01
                    yield f"{command}.json: {side} of {entry['quantity']}", Altered(folder, [end], summaries={command: other})


# Faults in scenes.


def places_of(value, path=()):
    """All numbers and words below a value, by their paths."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else []
    for key, inner in items:
        if isinstance(inner, (dict, list)):
            yield from places_of(inner, (*path, key))
        else:
            yield (*path, key), inner


def changed_word(keys, path, value):
    """Another word: a place of another name, another number in an expression, another kind; or none."""
    if isinstance(value, bool):
        return not value
    if any(c.isdigit() for c in value) and path[-1] in ("magnitude", "expression", "voltage", "stiffness", "damping", "speed"):
        return f"1.01*({value})"
    others = {"linear": "step", "spline": "linear", "monotone": "linear", "step": "linear", "ground": None, "body": "ground"}
    if value in others:
        return others[value]
    if "." in value and path[0] in ("joints", "loads"):
        body, point = value.split(".", 1)
        return next((f"{body}.{p}" for p in keys["bodies"].get(body, {}).get("points", {}) if p != point), None)
    return None


def scene_faults(folder, rng):
    keys = tomllib.loads(folder.scene_text)
    places = [(path, value) for path, value in places_of(keys) if path[0] not in ("title", "note", "requests", "units")]
    ends = [end for end in TABLES if folder.csv(end) is not None] + ["motion-events", "linear.csv", *(f"*{c}" for c in SUMMARIES)]
    for path, value in rng.sample(places, min(WORDS, len(places))):
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            other = 1.01 * value if value else 0.013
        elif isinstance(value, (str, bool)):
            other = changed_word(keys, path, value)
        if other is None:
            continue
        changed = copy.deepcopy(keys)
        inner = changed
        for key in path[:-1]:
            inner = inner[key]
        inner[path[-1]] = other
        yield f"scene: {'.'.join(map(str, path))}", Altered(folder, ends, scene_text=changed)


FAULTS = {"tables": table_faults, "archives": archive_faults, "matrices": text_faults, "summaries": summary_faults, "scenes": scene_faults}


def changes_nothing(program, folder, keys):
    """Whether the program rejects the changed scene or writes the same tables for it, so that no file shows the fault."""
    with tempfile.TemporaryDirectory() as place:
        scene = Path(place) / f"{folder.name}.toml"
        scene.write_text(runs.toml_text(keys), encoding="utf-8")
        for end, command in COMMANDS.items():
            rows = folder.csv(end)
            if rows is None:
                continue
            status, _, _ = runs.run(program, command, scene, place, *runs.options(folder.path.name.rpartition("-")[2], command))
            other = Folder(scene, place).csv(end) if status != 2 else None
            if other is not None and not same_tables(rows, other):
                return False
    return True


def same_tables(rows, other):
    """Whether all columns agree to 1e-9 of the largest of their unit; no check finds smaller differences."""
    if rows.count != other.count or set(rows.columns) != set(other.columns):
        return False
    largest = {}
    for name, values in rows.columns.items():
        largest[rows.units[name]] = max(largest.get(rows.units[name], 0.0), np.nanmax(np.abs(values), initial=0.0))
    return all(np.allclose(values, other.get(name), rtol=0.0, atol=1e-9 * largest[rows.units[name]], equal_nan=True)
               for name, values in rows.columns.items() if name != "relative_error")


def test_folder(program, folder, kinds, rng, counts):
    """Tries all faults of a folder; returns those that are neither found nor known to be unfindable."""
    missed = []
    for kind in kinds:
        for name, altered in FAULTS[kind](folder, rng):
            if is_found(altered):
                counts[kind, "found"] += 1
            else:
                reason = unfound.reason(name, folder) or kind == "scenes" and changes_nothing(program, folder, altered.scene_text)
                counts[kind, "known" if reason else "missed"] += 1
                if not reason:
                    missed.append(f"{folder.path.name}: {name}")
                    print("not found:", missed[-1], flush=True)
    return missed


def main(program, scenes):
    rng, counts, missed, failed = random.Random(1), Counter(), [], []
    with tempfile.TemporaryDirectory() as place:
        for scene in scenes:
            runs.prepare(program, scene, place)
            for path in sorted(Path(place).iterdir()):
                folder = Folder(next(p for p in path.glob("*.toml") if not p.name.endswith("-scene.toml")), path)
                judge = judge_folder(folder)
                failed += [f"{path.name}: {line}" for line in judge.lines() if line.startswith("FAIL")]
                if judge.checks:
                    missed += test_folder(program, folder, FAULTS, rng, counts)
                runs.remove(path)
            print(scene, dict(sum_of(counts)), flush=True)
    for line in failed:
        print("without a fault:", line)
    for (kind, what), count in sorted(counts.items()):
        print(f"{kind}: {count} {'not found, with a reason' if what == 'known' else what}")
    return 1 if missed or failed else 0


def sum_of(counts):
    found = Counter()
    for (_, what), count in counts.items():
        found[what] += count
    return found


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], [Path(s) for s in sys.argv[2:]] or [TOP / scene for scene in SCENES]))

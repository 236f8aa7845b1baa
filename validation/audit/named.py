"""The named faults of `tests/mutate/named.toml`, each as it shows in files or, turned round, in the audit's own reading.

`python3 validation/audit/named.py PROGRAM` runs the program's commands and requires that the audit finds each. A fault of a reader or of a
function of the program is planted in that of the audit: files and reading then differ as they would the other way round.
"""

import copy
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

import numpy as np

import curves
import expressions
import runs
import varying
from copies import ModelTable
from files import Folder, Rows
from forces import DriveForces
from jets import Jet
from parts import judge_folder
from selftest import Altered


TOP = Path(__file__).resolve().parents[1]


# Faults in files: a folder with a change.


def column(end, name, change, *needed):
    """Changes every column of a table whose name has this ending."""

    def plant(folder):
        rows = folder.csv(end)
        columns = {n: change(v, rows) if n.endswith(name) else v for n, v in rows.columns.items()}
        return Altered(folder, [end, *needed], {end: Rows(columns, rows.units, rows.words, rows.label)})

    return plant


def all_columns(end, change, *needed):
    """Changes all columns of a table except the time, row by row."""

    def plant(folder):
        rows = folder.csv(end)
        columns = {n: v if n == "t" else change(v, rows.get("t")) for n, v in rows.columns.items()}
        return Altered(folder, [end, *needed], {end: Rows(columns, rows.units, rows.words, rows.label)})

    return plant


def number(command, name, factor, *needed):
    """Multiplies the numbers of a summary whose names have this ending by a factor."""

    def plant(folder):
        summary = copy.deepcopy(folder.summary(command))
        for key, entry in summary["results"].items():
            if key.endswith(name):
                entry["value"] *= factor
        return Altered(folder, needed, summaries={command: summary})

    return plant


def rounded(value, digits):
    return float(f"{value:.{digits}e}") if isinstance(value, float) else value


def few_digits(folder):
    """Rounds the numbers of a summary to three digits."""
    summary = copy.deepcopy(folder.summary("kinematics"))
    for entry in summary["extrema"]:
        for end in ("min", "max"):
            entry[end]["value"] = rounded(entry[end]["value"], 2)
    return Altered(folder, ["kinematics"], summaries={"kinematics": summary})


def archive_to_the_left(folder):
    """An archive whose columns are one place to the left: the table is changed instead."""
    rows = folder.csv("kinematics")
    names = list(rows.columns)
    columns = {name: rows.get(names[max(k - 1, 0)]) for k, name in enumerate(names)}
    return Altered(folder, ["kinematics", "kinematics.npz"], {"kinematics": Rows(columns, rows.units, rows.words, rows.label)})


def table(change):
    """A table of the reduced model with changed lines and the checksum of these."""

    def plant(folder):
        lines = [change(line) for line in folder.text("table").splitlines()]
        text = "\n".join(lines[:-1]) + "\n"
        text += f"check {ModelTable(text + 'check 0').fnv():016x}\n"
        return Altered(folder, ["reduced"], texts={"table": text})

    return plant


def cell_line(key, change):
    return lambda line: " ".join([key, *(repr(float(x)) for x in change(np.array(line.split()[1:], float)))]) if line.startswith(f"{key} ") else line


def seven_digits(line):
    head, *rest = line.split(" ")
    return " ".join([head, *(f"{float(x):.6e}" for x in rest)]) if head in ("m", "ab", "wc") else line


def a_for_b(values):
    """Replaces the coefficients of b by those of a."""
    blocks = values.reshape(8, -1)
    half = blocks.shape[1] // 2
    return np.hstack([blocks[:, :half]] * 2).ravel()


def doubled_inputs(folder):
    lines = [line.split(",") for line in folder.text("linear.csv").splitlines()]
    lines = [line if line[0] not in ("B", "D") else [*line[:2], *(repr(2.0 * float(x)) for x in line[2:])] for line in lines]
    return Altered(folder, ["reduced", "*linearise"], texts={"linear.csv": "\n".join(map(",".join, lines)) + "\n"})


def farther_equilibrium(folder):
    """`linearise` takes the equilibrium of the table that is farthest from the start."""
    summary, other = copy.deepcopy(folder.summary("linearise")), folder.summary("equilibria")["results"]
    names = [key.split(".", 2)[2] for key in other if key.startswith("equilibrium.1.")]
    coordinate = next(n for n in names if n.endswith(".from_start"))
    count = int(other["equilibria"]["value"])
    far = max(range(1, count + 1), key=lambda k: abs(other[f"equilibrium.{k}.{coordinate}"]["value"]))
    for n in names:
        if f"equilibrium.{far}.{n}" in other and f"equilibrium.{n}" in summary["results"]:
            summary["results"][f"equilibrium.{n}"] = other[f"equilibrium.{far}.{n}"]
    return Altered(folder, ["linear.csv", "*equilibria"], summaries={"linearise": summary})


def near_one_angle(values, rows):
    return values * (1.0 + 0.02 * np.exp(-(((rows.get(list(rows.columns)[0]) - 2.0) / 0.1) ** 2)))


def linear_between_steps(values, time):
    """Every other row is the mean of its neighbours."""
    other = values.copy()
    other[1:-1:2] = 0.5 * (values[0:-2:2] + values[2::2])[: len(other[1:-1:2])]
    return other


def moved_rows(values, time):
    """Every other row is that of a state a part of 1e-6 of the coordinate further."""
    return values + 1e-6 * np.gradient(values, time) * (np.arange(len(values)) % 2)


# Faults in the audit's reading.


@contextmanager
def reading(*patches):
    for p in patches:
        p.start()
    try:
        yield
    finally:
        for p in patches:
            p.stop()


def with_keys(change):
    """The scene read with changed keys."""

    def plant(folder):
        from tomllib import loads

        keys = loads(folder.scene_text)
        change(keys)
        ends = ["kinematics", "statics", "kinetostatics", "motion", "motion-events", "run-i", "reduced", "cycle", "*cycle"]
        return Altered(folder, ends, scene_text=keys)

    return plant


def tables_larger(value):
    for key, inner in value.items() if isinstance(value, dict) else []:
        if key == "table" and isinstance(inner, list):
            value[key] = [[x, 1.01 * y] for x, y in inner]
        else:
            tables_larger(inner)


def each(section, key, change):
    def apply(keys):
        for table_of in keys.get(section, {}).values():
            for inner in [table_of, *(v for v in table_of.values() if isinstance(v, dict))] if isinstance(table_of, dict) else []:
                if key in inner:
                    inner[key] = change(inner[key])

    return apply


def larger_rates(u, order, factor):
    orders = list(curves_sin(u).orders)
    orders[order] = orders[order] * factor
    return Jet(*orders)


curves_sin, curves_rise = curves.sin, curves.rise


def bent_rise(shape, u, ramp):
    of = curves_rise(shape, u, ramp)
    return Jet(of.value, of.first, 1.5 * of.second)


def without_mixed_term(self):
    full = lambda a, b: a * b
    mixed = lambda a, b: Jet((a * b).value, (a * b).first, a.second * b.value + a.value * b.second)
    return self.chain(self.sign, {"*": mixed if self else full, "/": lambda a, b: a / b})


def speed_for_its_square(self, angle, omega, alpha):
    series = self.series
    return {n: series(a, angle) * alpha + series(b, angle) * omega for n, (a, b) in self.reactions.items()} if self.is_series else {}


NOTHING = ()
SINE = patch.dict(expressions.FUNCTIONS, {"sin": lambda u: 1.01 * curves_sin(u)})
FASTER = patch.object(curves, "sin", lambda u: larger_rates(u, 1, 1.01))
MIXED = patch.object(expressions.Expression, "term", without_mixed_term)
SQUARE = patch.object(varying.VaryingInertia, "reactions_at", speed_for_its_square)
BENT = patch.object(curves, "rise", bent_rise)
MILLIMETRES = patch.dict("scene.LENGTHS", {"mm": 1.0 / 1001.0})
DEGREES = patch.dict("scene.ANGLES", {"deg": np.pi / 181.0})
REVERSED = patch.object(DriveForces, "induced", property(lambda self: -self.numbers["torque-constant"] * self.coordinate.first))
ALL = with_keys(lambda keys: None)

# Name of the fault, the scene and its folder, the fault in files, and those in the audit's reading.
NAMED = [
    ("law-second-derivative", "press/forced", ALL, (BENT,)),
    ("friction-halved", "slider-crank-friction/forced", with_keys(each("friction", "coefficient", lambda c: 0.5 * c)), NOTHING),
    ("sine-of-expressions", "press/forced", ALL, (SINE,)),
    ("motor-line-doubled", "motor-line/plain", with_keys(each("drives", "stall-torque", lambda c: 2.0 * c)), NOTHING),
    ("sign-of-w", "press/plain", column("reduced", ".w", lambda v, _: -v, "run-i", "kinematics"), NOTHING),
    ("section-angular-acceleration", "press/forced",
     column("kinetostatics-internal-forces-rod.B.P", "shear", lambda v, _: 1.001 * v, "kinetostatics", "*kinetostatics"), NOTHING),
    ("a-in-batches", "four-bar/plain", column("reduced", ".a", lambda v, _: 1.5 * v, "run-i"), NOTHING),
    ("linear-between-steps", "four-bar/plain", all_columns("motion", linear_between_steps), NOTHING),
    ("hertz-without-2-pi", "pendulum-periods/plain", column("equilibria", ".frequency", lambda v, _: 2 * np.pi * v, "*equilibria"), NOTHING),
    ("b-near-one-angle", "four-bar/plain", column("reduced", ".b", near_one_angle, "run-i"), NOTHING),
    ("reader-table-values", "press/forced", with_keys(tables_larger), NOTHING),
    ("reader-phase", "coupling-laws/plain", with_keys(each("joints", "phase", lambda c: 0.0)), NOTHING),
    ("reader-rotor", "press/plain", with_keys(each("drives", "inertia", lambda c: 0.0)), NOTHING),
    ("unit-of-lengths", "teeth-in-turn/plain", ALL, (MILLIMETRES,)),
    ("unit-of-angles", "press/forced", ALL, (DEGREES,)),
    ("sinusoid-speed", "teeth-in-turn/forced", ALL, (FASTER,)),
    ("expression-product-rule", "product/forced", ALL, (MIXED,)),
    ("back-emf-sign", "motor/plain", ALL, (REVERSED,)),
    ("controller-gain", "speed-controller/plain", with_keys(each("drives", "proportional", lambda c: 1.1 * c)), NOTHING),
    ("batch-half-dm", "four-bar/plain", column("reduced", "half_dm", lambda v, _: 1.001 * v, "run-i"), NOTHING),
    ("sampler-sign-of-w", "press/plain", table(cell_line("wc", np.negative)), NOTHING),
    ("sampler-b", "four-bar/plain", table(cell_line("ab", a_for_b)), NOTHING),
    ("random-normal", "four-bar/plain", column("sweep", ".mass", lambda v, _: v.mean() + 0.5 * (v - v.mean()), "*sweep"), NOTHING),
    ("table-integral", "four-bar/plain", table(cell_line("m", lambda v: v * np.array([1.001, *[1.0] * 8]))), NOTHING),
    ("table-file-digits", "four-bar/plain", table(seven_digits), NOTHING),
    ("csv-digits", "four-bar/plain", all_columns("kinematics", lambda v, _: np.array([rounded(x, 5) for x in v])), NOTHING),
    ("npz-columns", "four-bar/plain", archive_to_the_left, NOTHING),
    ("json-digits", "four-bar/plain", few_digits, NOTHING),
    ("dual-quotient", "four-bar/forced", column("kinetostatics", "B.x", lambda v, _: 1.001 * v), NOTHING),
    ("dual-cosine", "four-bar/forced", column("kinetostatics", "actuator_force", lambda v, _: 1.001 * v), NOTHING),
    ("dop853-nodes", "four-bar/plain", column("motion", "t", lambda v, _: v * 1.0001), NOTHING),
    ("dop853-interpolant", "four-bar/plain", all_columns("motion", moved_rows), NOTHING),
    ("bdf-interpolation", "single-dwell/plain", all_columns("motion", moved_rows), NOTHING),
    ("faer-factor", "class-three-six-bar/forced", column("kinetostatics", ".x", lambda v, _: 1.001 * v), NOTHING),
    ("cycle-period", "four-bar/plain", number("cycle", "mean_speed", 1.001, "cycle"), NOTHING),
    ("flywheel-inertia", "four-bar/plain", number("cycle", "flywheel.inertia", 1.01, "cycle", "cycle-flywheel", "reduced"), NOTHING),
    ("equilibrium-damping", "boom-damped/plain", number("linearise", "damping_ratio", -1.0, "linear.csv"), NOTHING),
    ("equilibrium-frequency", "pendulum-periods/plain", number("equilibria", "angular_frequency", 1.001, "equilibria"), NOTHING),
    ("linearise-b", "driven/plain", doubled_inputs, NOTHING),
    ("linearise-eigenvalues", "pendulum-periods/plain", number("linearise", ".im", 1.0005, "linear.csv"), NOTHING),
    ("linearise-nearest", "pendulum-periods/plain", farther_equilibrium, NOTHING),
    ("varying-inertia-half-slope", "exported-model/plain", with_keys(each("bodies", "half-slope", lambda c: [1.01 * x for x in c])), NOTHING),
    ("known-reaction-speed", "exported-model/plain", ALL, (SQUARE,)),
    ("check-center-of-mass", "four-bar/plain", number("check", "mass.center.y", -1.0, "motion", "kinematics", "kinetostatics"), NOTHING),
]
ELSEWHERE = {
    "printed-numbers": "sentences: `crates/validation/src/written` has them",
    "printed-extrema-of-m": "sentences: `crates/validation/src/written` has them",
    "variant-number-slope": "no number of the cases changes",
    "variant-free-reaction": "not reached by the cases",
    "variant-same-mode": "no number of the cases changes",
}
# Scenes that no case is: a damper or a drive added to one, and one in millimetres.
MADE = {
    "boom-damped": ("capabilities/pendulum-periods.toml", '\n[loads.drag]\nrotational-damper = ["ground", "rotor"]\ndamping = 0.3\n'),
    "driven": ("capabilities/pendulum-periods.toml", '\n[drives]\npush = { applied-force = "phi", magnitude = 0.5 }\n'),
    "product": ("capabilities/pendulum-periods.toml", '\n[prescribed]\nduration = 1\nphi = { expression = "0.3*t*sin(2*t)" }\n'),
    "teeth-in-turn": ("teeth.toml", ""),
}


def scene_of(name, place):
    """The path of a case, or of a scene that is made of one."""
    if name not in MADE:
        found = [TOP / name / "scene.toml", TOP / "spatial" / f"{name}.toml", TOP / "capabilities" / f"{name}.toml"]
        return next(path for path in found if path.exists())
    base, added = MADE[name]
    text = (TOP / base if "/" in base else TOP / "capabilities" / base).read_text(encoding="utf-8")
    if name == "teeth-in-turn":
        text = runs.without_section(text, "coordinate-sweep")
    path = Path(place) / f"{name}.toml"
    path.write_text(text + added, encoding="utf-8")
    return path


def main(program):
    missed, folders = [], {}
    with tempfile.TemporaryDirectory() as place:
        for name, where, plant, patches in NAMED:
            scene, kind = where.split("/")
            if scene not in folders:
                folders[scene] = scene_of(scene, place)
                runs.prepare(program, folders[scene], Path(place) / "files")
            path = Path(place) / "files" / f"{scene}-{kind}"
            folder = Folder(path / f"{scene}.toml", path)
            planted = plant(folder)
            try:
                with reading(*patches):
                    judge = judge_folder(planted)
                found = sorted({key for (_, key), worst in judge.checks.items() if not judge.passes(key, worst)})
            except Exception as error:
                found = [f"cannot be read: {error!r}"]
            print(f"{name}: {', '.join(found) or 'NOT FOUND'}", flush=True)
            missed += [] if found else [name]
    for name, reason in ELSEWHERE.items():
        print(f"{name}: {reason}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) > 1 else __doc__)

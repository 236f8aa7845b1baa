"""Remakes the reference values of validation/*/case.toml and compares them digit by digit; `run.py` starts it.

Arguments: the folder of the cases, the table to write, and the names of cases (none: all). Status 1 when one differs
by more than its rounding to the last printed digit, or when a value is remade by nothing.
"""

import re
import sys
import time
import tomllib
from pathlib import Path

from mpmath import mp, mpf, nstr, pi

import energy
import pendulums
from scene import Scene
from states import Machine

MP_DIGITS = 60
ROUNDED = mpf("0.51")  # units of the last printed digit: every value is printed correctly rounded
LBF, INCH = "4.4482216152605", "0.0254"  # N, m
# Where the literature is not as exact as it is printed: by how much at most (part of the largest of its kind), who agrees.
CORRECTIONS = {
    ("andrews", "y_at_0.03"): ("1.4e-6", "the energy integral here (25 digits) and Dwell's integration: the published angles "
                               "at 0.03 s are 1.5e-9 rad off, accelerations and multipliers 1.3e-6 of their largest"),
}


class Comparison:
    """The values of one table of a case: how many, of how many digits, and the largest difference in last digits."""

    def __init__(self, case, table, kind):
        self.case, self.table, self.kind = case, table, kind
        self.count, self.digits, self.worst, self.where, self.wrong = 0, [], mpf(0), "", []

    def add(self, name, printed, value, scale):
        text = str(printed)
        digits = re.sub(r"^-?0*\.?0*|\.|[eE].*$", "", text.replace("-", "", 1) if text[0] == "-" else text)
        given = mpf(text)
        if given == 0:
            last = scale * mpf(10) ** (-29 if self.kind == "literature" else -45)  # rounding of 30 and of 50 digits
        else:
            mantissa, _, exponent = text.lower().partition("e")
            last = mpf(10) ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
            self.digits.append(len(digits))
        off = abs(value - given) / last
        self.count += 1
        if off > self.worst:
            self.worst, self.where = off, name
        if off > ROUNDED:
            self.wrong.append((name, text, value))

    def line(self):
        span = f"{min(self.digits)}–{max(self.digits)}" if self.digits else "exact zeros"
        return f"| {self.case} | {self.table} | {self.kind} | {self.count} | {span} | {nstr(self.worst, 2)} | {self.where} |"


def numbers(state_, machine):
    return [[mpf(str(state_[k][c])) for c in machine.scene.actuators] for k in ("q", "q_dot", "q_ddot")]


def states(case, data, machine):
    """The samples that list values of states."""
    found = Comparison(case, "samples", data.get("kind"))
    for k, sample in enumerate(data["samples"]):
        state = machine.state(*numbers(sample, machine))
        scale = max(abs(mpf(v)) for v in sample["values"].values())
        for name, printed in sample["values"].items():
            found.add(f"{name} of sample {k + 1}", printed, state.value(name), scale)
    return found


def coefficients(case, data, machine):
    """The samples that list m, half of its derivative, a and b of reactions, points and angles."""
    found = Comparison(case, "samples", data.get("kind"))
    for k, sample in enumerate(data["samples"]):
        turned, _, parts = str(sample["q"]).partition("*pi/")
        q = mpf(turned) * pi / mpf(parts) if parts else mpf(turned)
        run_a, run_b = machine.state([q], [mpf(0)], [mpf(1)]), machine.state([q], [mpf(1)], [mpf(0)])
        m, half = run_b.unit_runs()
        if abs(m - run_a.value("phi.actuator_force")) > 1e-40 or abs(half - run_b.value("phi.actuator_force")) > 1e-40:
            raise ValueError(f"{case}: the energy and the actuator's multiplier disagree at sample {k + 1}")
        label = f" of sample {k + 1}"
        for name, printed in sample.items():
            if name == "reactions":
                for reaction, pair in printed.items():
                    for run, symbol in ((run_a, "a"), (run_b, "b")):
                        found.add(f"{symbol} of {reaction}{label}", pair[symbol], run.value(reaction), mpf(1))
            elif name in ("m", "half_dm"):
                found.add(name + label, printed, m if name == "m" else half, mpf(1))
            elif name.startswith("theta_"):
                found.add(name + label, printed, run_a.value(name[6:-4] + ".angle"), mpf(1))
            elif name.endswith("_m"):
                body = next(p for p in machine.scene.points if p.endswith("." + name[:-2]))
                for axis, p in zip("xy", printed):
                    found.add(f"{name}.{axis}{label}", p, run_a.value(f"{body}.{axis}"), mpf(1))
    return found


def exact_definition(data, machine):
    """Where the case is defined by exact numbers that the scene can only round: the inertia of uniform bars."""
    lengths = [mpf(str(data["definition"][b])) for b in machine.names]
    for b, mass, length in zip(machine.names, data["definition"]["masses"], lengths):
        machine.scene.bodies[b] = (mpf(mass), mpf(mass) * length ** 2 / 12)


def unloaded(case, data, machine):
    """Period and energy of a motion without loads."""
    given, found = data["free_motion"], Comparison(case, "free_motion", data["free_motion"].get("kind"))
    if "definition" in data:
        start, speed = mpf(data["definition"]["phi0_deg"]) * pi / 180, mpf(data["definition"]["phidot0_rad_s"])
    else:
        start, speed = mpf(given["phi0"]), mpf(given["phidot0"])
    m, m0 = energy.turn(machine, 23), energy.unit_energy(machine, start)
    key = "crank_inertia_for_period_exactly_5_42_s"
    inertia = machine.scene.bodies["crank"][1]
    values = {"period_s": energy.period(m, m0, speed), "energy_J": m0 * speed ** 2 / 2}
    if key in given:
        values[key] = energy.crank_inertia(m, m0, inertia, mpf("5.42"))
    for name in values.keys() & given.keys():
        found.add(name, given[name], values[name], mpf(1))
    return [found]


def pendulum(case, data, machine):
    given, motion = data["published"], Comparison(case, "free_motion", data["free_motion"].get("kind"))
    rows = Comparison(case, "published", given.get("kind"))
    rows.add("period_s", given["period_s"], pendulums.a01_period(), mpf(1))
    for row in given["rows"]:
        for name, printed, value in zip(given["columns"].split(",")[1:], row[1:], pendulums.a01(mpf(row[0]))):
            rows.add(f"{name} at {row[0]} s", printed, value, mpf(1))
    for state in data["free_motion"]["states"]:
        x, y, vx, vy, tension, angle, rate = pendulums.a01(mpf(state["t"]))
        turns = round(float((mpf(state["values"]["phi"]) - angle) / (2 * pi)))  # of the crossings of +-180 degrees
        values = {"phi": angle + 2 * pi * turns, "phi.velocity": rate, "A.x": -tension * x, "A.y": -tension * y}
        for name, printed in state["values"].items():
            motion.add(name, printed, values[name], mpf(1))
    return [rows, motion]


def windows(case, data, machine):
    given, motion = data["published"], Comparison(case, "free_motion", data["free_motion"].get("kind"))
    rows = Comparison(case, "published", given.get("kind"))
    for row in given["rows"]:
        phi, rate = pendulums.a02(mpf(row[0]))
        c, s = mp.cos(phi), mp.sin(phi)
        for k, value in enumerate((phi, rate, c, s, -rate * s, rate * c)):
            rows.add(f"column {k + 1} at {row[0]} s", row[k + 1], value, mpf(1))
    for state in data["free_motion"]["states"]:
        phi, rate = pendulums.a02(mpf(str(state["t"])))
        for name, value in (("phi", phi), ("phi.velocity", rate)):
            motion.add(name, state["values"][name], value, mpf(1))
    return [rows, motion]


def double(case, data, machine):
    s, found = machine.scene, Comparison(case, "free_motion", data["free_motion"].get("kind"))
    pin = {p: s.points[p][1][0] for p in ("one.A", "one.B", "two.B")}
    start = [s.guess("p"), s.guess("q"), *(mpf(v) for v in s.motion["initial-velocity"].values())]
    for state in data["free_motion"]["states"]:
        y = pendulums.double(list(s.bodies.values()), pin["one.B"] - pin["one.A"], (-pin["one.A"], -pin["two.B"]), start,
                             mpf(state["t"]), 250)
        for name, value in zip(("p", "q", "p.velocity", "q.velocity"), y):
            found.add(name, state["values"][name], value, mpf(1))
    return [found]


def squeezer(case, data, machine):
    given, motion = data["published"], Comparison(case, "free_motion", data["free_motion"].get("kind"))
    start, found = mpf(given["q"][0]), []
    free = lambda q, v: machine.state([q], [v], [free_acceleration(machine, q, v)])
    mp.dps = 38
    q, v = energy.Squeezer(machine, start).at(mpf("0.03"), mpf(given["y_at_0.03"][0]), 32)
    first, last = free(start, mpf(0)), free(q, v)
    mp.dps = MP_DIGITS
    for name, printed in data["free_motion"]["states"][0]["values"].items():
        motion.add(name, printed, last.value({"beta": "k1.angle", "beta.velocity": "k1.angular_velocity"}.get(name, name)),
                   mpf(1))
    for table, state, column in (("q", first, 0), ("qdd", first, 14), ("lambda", first, 21), ("y_at_0.03", last, 0),
                                 ("y_at_0.03_at_25_digits", last, 0)):
        kind = "independent" if "25" in table else given.get("kind")
        found.append(Comparison(case, f"published.{table}", kind))
        scales = test_set(state)
        for k, (printed, value) in enumerate(zip(given[table], test_set(state)[column:])):
            group = scales[k + column - (k + column) % 7:][:7] if k + column < 21 else scales[21:]
            found[-1].add(f"component {k + column + 1}", printed, value, max(map(abs, group)) or mpf(1))
            if kind == "literature":
                found[-1].relative = max(getattr(found[-1], "relative", mpf(0)),
                                         abs(value - mpf(printed)) / (max(map(abs, group)) or 1))
    found.append(Comparison(case, "published.samples", given.get("kind")))
    for name, printed in given["samples"][0]["values"].items():
        found[-1].add(name, printed, first.value(name), 20000 if "acceleration" in name else 100)
    return [motion, *found]


def free_acceleration(machine, q, v):
    """The one at which the actuator has nothing to do."""
    return -machine.state([q], [v], [mpf(0)]).value("beta.actuator_force") / energy.unit_energy(machine, q)


def test_set(state):
    """Angles, velocities, accelerations and multipliers in the order of the Test Set for IVP Solvers."""
    y = []
    for name in ("angle", "angular_velocity", "angular_acceleration"):
        k1, k2, k3, k4, k5, k6, k7 = (state.value(f"k{k}.{name}") for k in range(1, 8))
        y += [k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7]
    return y + [state.value(f"E-{k}.{axis}") for k in ("k3", "k4", "k6") for axis in "xy"]


def textbook(case, data, machine):
    given, found = data["published"], Comparison(case, "published", data["published"].get("kind"))
    state = machine.state(*numbers(data["samples"][0], machine))
    values = {"F12x_lbf": state.value("A.x") / mpf(LBF), "F12y_lbf": state.value("A.y") / mpf(LBF),
              "T12_lbf_in": state.value("phi.actuator_force") / mpf(LBF) / mpf(INCH)}
    for k, body in ((3, "coupler"), (4, "rocker")):
        values[f"omega{k}_rad_s"] = state.value(body + ".angular_velocity")
        values[f"alpha{k}_rad_s2"] = state.value(body + ".angular_acceleration")
    for name, value in values.items():
        found.add(name, given[name], value, mpf(1))
    return [found]


def ratios(case, data, machine):
    """Ratios in closed form: Willis's of the gear, and the times of Whitworth's quick return between the ram's rests."""
    given, found = data["published"], Comparison(case, "published", data["published"].get("kind"))
    if case == "planetary":
        state = machine.state([mpf(1)], [mpf(1)], [mpf(0)])
        values = {"arm_per_sun": state.value("arm.angle"), "planet_per_sun": state.value("planet.angle")}
    else:
        speed = lambda q: machine.state([q], [mpf(1)], [mpf(0)]).value("stroke.velocity")
        rests = [mp.findroot(speed, (q, q + mpf("0.01")), tol=1e-40) for q in (mpf("-0.53"), mpf("3.66"))]
        forward = rests[1] - rests[0]
        values = {"time_ratio": forward / (2 * pi - forward)}
    for name, value in values.items():
        found.add(name, given[name], value, mpf(1))
    return [found]


SPECIAL = {"single-dwell": unloaded, "crank-rocker": unloaded, "pendulum-a01": pendulum, "n-four-bar-a02": windows,
           "double-pendulum": double, "andrews": squeezer, "four-bar": textbook, "planetary": ratios, "whitworth": ratios,
           "exported-model": unloaded}
# Cases whose scene is a reduced model that was exported: the mechanism from which it came.
ORIGINALS = {"exported-model": "crank-rocker"}


def remake(folder):
    case, data = folder.name, tomllib.loads((folder / "case.toml").read_text())
    mp.dps = MP_DIGITS
    if not data.keys() & {"samples", "free_motion", "published"}:
        return []
    if case not in SPECIAL and data.keys() & {"free_motion", "published"}:
        raise ValueError(f"{case}: nothing remakes its free motion or published values")
    if case in ORIGINALS:
        folder = folder.parent / ORIGINALS[case]
        data["definition"] = tomllib.loads((folder / "case.toml").read_text())["definition"]
    machine, found = Machine(Scene(folder)), []
    if "definition" in data:
        exact_definition(data, machine)
    if "samples" in data:
        found.append((states if "values" in data["samples"][0] else coefficients)(case, data, machine))
    if case in SPECIAL:
        found += SPECIAL[case](case, data, machine)
    return found


def main():
    home, table, *names = sys.argv[1:]
    folders = sorted(p.parent for p in Path(home).glob("*/case.toml") if not names or p.parent.name in names)
    if names and len(folders) < len(set(names)):
        sys.exit(f"no such case: {', '.join(set(names) - {f.name for f in folders})}")
    lines, failed, corrections = [], [], []
    for folder in folders:
        begun = time.time()
        for c in remake(folder):
            lines.append(c.line())
            known = CORRECTIONS.get((c.case, c.table.partition(".")[2]))
            if known and c.wrong:
                corrections.append(f"| {c.case} | {c.table} | {nstr(c.relative, 2)} | {known[1]} |")
                if c.relative > mpf(known[0]):
                    failed.append(f"{c.case}, {c.table}: off by {nstr(c.relative, 3)} of the largest, known is {known[0]}")
                continue
            for name, printed, value in c.wrong:
                failed.append(f"{c.case}, {c.table}: {name} is {printed}, remade {nstr(value, 28)}")
        print(f"{folder.name}: {time.time() - begun:.0f} s", flush=True)
    Path(table).write_text(document(lines, corrections))
    print(*lines, *failed, sep="\n")
    if failed:
        sys.exit(f"{len(failed)} of the reference values are not as remade")


def document(lines, corrections):
    """The table as a page."""
    return "\n".join([
        "# Reference values, remade", "",
        "Written by `just reference`: the program of validation/reference, which shares nothing with Dwell, has remade every",
        "reference value. The difference is in units of the last printed digit: at most half a unit where that is rounded. More is",
        "an error, but for literature whose error is known (second table).", "",
        "| case | table | kind | values | digits | largest difference | of |", "|---|---|---|---:|---|---:|---|", *lines, "",
        "## Literature that is less exact than printed", "",
        "| case | table | largest difference, of the largest of the kind | who agrees |", "|---|---|---:|---|", *corrections, ""])


if __name__ == "__main__":
    main()

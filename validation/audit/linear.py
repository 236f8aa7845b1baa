"""Matrices and eigenvalues of `linearise`."""

import csv

import numpy as np

from files import result, split_heading
from jets import Jet
from points import Unknown, eigenvalues, modes


def read_matrices(text):
    """Reads A, B, C and D of `linearise` by the names of their rows and columns."""
    matrices, columns = {}, []
    for line in csv.reader(text.splitlines()):
        if line[0] == "matrix":
            columns = [split_heading(head)[0] for head in line[2:]]
        else:
            row = split_heading(line[1])[0]
            matrices.setdefault(line[0], {})[row] = {c: float(v) for c, v in zip(columns, line[2:])}
    return matrices


def judge_linear(judge, scene, text, npz, summary, reduced, equilibria):
    """Judges the eigenvalues by the characteristic polynomial of the written A, the matrices in both files, and the rows of states."""
    matrices = read_matrices(text)
    rates = list(matrices["A"])
    states = list(matrices["A"][rates[0]])
    for name, rows in matrices.items():
        if npz is not None and name in npz:
            table = np.array([[rows[r][c] for c in rows[r]] for r in rows]).reshape(npz[name].shape)
            judge.compare("archive", (table - npz[name]).ravel(), 1.0, "SI", f"matrix {name}")
    # The rate of a coordinate is its velocity; an output that is a state has a row of the unit matrix.
    for matrix, row, wanted in [("A", f"d({s.removesuffix('.velocity')})/dt", s) for s in states if s.endswith(".velocity")] + \
            [("C", s, s) for s in states if s in matrices["C"]]:
        entries = np.array([matrices[matrix][row][s] - (s == wanted) for s in states])
        judge.compare("matrices", entries, 1.0, "SI", f"row {row} of {matrix}")
    if npz is not None and "rates" in npz and "state" in npz:
        state = dict(zip(map(str, npz["states"]), npz["state"].ravel()))
        for rate, value in zip(rates, npz["rates"].ravel()):
            of = rate[2:].split(")/dt")[0]
            if f"{of}.velocity" in state:
                judge.compare("matrices", value - state[f"{of}.velocity"], max(1.0, abs(value)), "SI", f"rate {rate}")
    for coordinate in scene.actuators:
        start = scene.initial("initial-coordinate", coordinate)
        start = scene.start_of(coordinate) if start is None else start
        at, stated = (result(summary, f"equilibrium.{coordinate.name}{end}") for end in ("", ".from_start"))
        if None not in (start, at, stated):
            judge.compare("equilibria", stated - (at - start), max(1.0, abs(start)), "SI", f"{coordinate.name} from the start")
        # At an equilibrium all velocities are zero.
        is_initial = bool(eigenvalues(summary, "initial"))
        speed = (scene.initial("initial-velocity", coordinate) or 0.0) if is_initial else 0.0
        if (stated := result(summary, f"state.{coordinate.name}.velocity")) is not None:
            judge.compare("matrices", stated - speed, max(1.0, abs(speed)), "SI", f"velocity of {coordinate.name}")
    state = {s: result(summary, f"state.{s}") for s in states}
    for name, value in state.items():
        at = result(summary, f"equilibrium.{name}")
        if at is not None and value is not None:
            judge.compare("matrices", value - at, max(1.0, abs(at)), "SI", f"state {name}")
    if all(value is not None for value in state.values()):
        by_reduced(judge, matrices, state, reduced)
    a = np.array([[matrices["A"][r][s] for s in states] for r in rates])
    for name in ("equilibrium", "initial"):
        values = eigenvalues(summary, name)
        if not values:
            continue
        modes(judge, summary, name)
        if name == "equilibrium":
            nearest(judge, values, summary, equilibria)
        judge.require("eigenvalues", len(values) == len(a), f"{len(values)} eigenvalues of {len(a)} states")
        size = max(*map(abs, values), np.linalg.norm(a) * 1e-8, 1e-300)
        error = (result(summary, f"{name}.error.eigenvalues") or 0.0) * 4.0
        for k, value in enumerate(values, 1):
            judge.compare("eigenvalues", max(distance_of_root(a, value, size) - error, 0.0), size, "1/s", f"{name}, eigenvalue {k}")
        judge.compare("eigenvalues", sum(values).real - np.trace(a), size, "1/s", f"{name}: their sum with the trace of A")


def distance_of_root(a, value, size):
    """The distance of a number from a root of det(A − λ), by a step of Newton's method."""
    aside = 1e-6 * size * (1.0 + 1.0j)
    determinant = lambda at: np.linalg.det((a - at * np.eye(len(a))) / size)
    here = determinant(value)
    change = determinant(value + aside) - here
    return 0.0 if here == 0.0 else abs(here) / abs(change) * abs(aside)


def nearest(judge, values, summary, equilibria):
    """The operating point is the equilibrium in the table of `equilibria` nearest to the start, with the same eigenvalues."""
    names = [key.removeprefix("equilibrium.").removesuffix(".from_start") for key in summary["results"] if key.endswith(".from_start")]
    if equilibria is None or not names or any(".neutral" in key for key in equilibria["results"]):
        return
    of = lambda of_summary, name, end="": np.array([result(of_summary, f"{name}.{n}{end}") for n in names], float)
    this, count = of(summary, "equilibrium"), int(result(equilibria, "equilibria") or 0)
    away = [np.linalg.norm(of(equilibria, f"equilibrium.{k + 1}", ".from_start")) for k in range(count)]
    if not away:
        return
    best = f"equilibrium.{int(np.argmin(away)) + 1}"
    # Two equilibria at the same distance are both accepted.
    excess = max(np.linalg.norm(of(summary, "equilibrium", ".from_start")) - min(away), 0.0)
    judge.compare("nearest", excess, max(1.0, min(away)), "SI", "distance of the equilibrium from the start")
    if len(away) == 1 or np.partition(away, 1)[1] > (1.0 + 1e-6) * min(away) or np.allclose(this, of(equilibria, best), rtol=0.0, atol=1e-6):
        judge.compare("nearest", np.abs(this - of(equilibria, best)), max(1.0, np.abs(this).max()), "SI", f"place of {best}")
        others = eigenvalues(equilibria, best)
        scale = max([*map(abs, values), 1e-300])
        judge.require("nearest", len(others) == len(values), f"{len(values)} eigenvalues, and {len(others)} of {best}")
        if len(others) == len(values):
            difference = [abs(a - b) for a, b in zip(values, others)]
            judge.compare("nearest", difference, scale, "1/s", f"eigenvalues of {best}")


# Matrices from the reduced model.

STENCIL = np.array([-2.0, -1.0, 1.0, 2.0]), np.array([1.0, -8.0, 8.0, -1.0]) / 12.0


class States:
    """Columns of states under the names that a drive reads."""

    def __init__(self, values):
        self.values = values

    def get(self, name):
        return self.values.get(name)

    def __contains__(self, name):
        return name in self.values


def by_reduced(judge, matrices, state, reduced):
    """A, B, C and D by differences of m q̈ = Σ w F + drives − ½m′ q̇² and of R = a q̈ + b q̇² + Σ c F."""
    if reduced is None:
        judge.skip("A, B, C and D", "no file of `reduce`")
        return
    q = reduced.name
    if list(state)[:2] != [q, f"{q}.velocity"] or len(reduced.scene.actuators) != 1 or reduced.scene.stops:
        judge.skip("A, B, C and D", "several coordinates, or stops")
        return
    inputs = list(next(iter(matrices["B"].values()))) if matrices.get("B") else []
    try:
        columns = {name: slopes_by(reduced, state, name, name in inputs) for name in [*state, *inputs]}
    except Unknown as reason:
        judge.skip("A, B, C and D", str(reason))
        return
    pairs = [(of_states, of_inputs) for of_states, of_inputs in (("A", "B"), ("C", "D"))]
    for of_states, of_inputs in pairs:
        for row in matrices[of_states]:
            if not all(row in columns[name] for name in columns):
                continue
            entries = matrices[of_states][row] | matrices.get(of_inputs, {}).get(row, {})
            difference = np.array([entries[name] - columns[name][row] for name in columns])
            sizes = np.array([abs(columns[name][row]) * natural(state, name) for name in columns])
            kinds = [natural(state, name) for name in columns]
            scale = max(sizes.max(), scale_of(matrices, row, state), 1e-6)  # where nothing acts all is rounding
            judge.compare("linear", difference * kinds, scale, "SI", f"row {row} of {of_states}, {of_inputs}")


def natural(state, name):
    """A typical change of a state or an input."""
    return max(1.0, abs(state.get(name, 1.0)))


def scale_of(matrices, row, state):
    """The largest change of all outputs of reactions: one may be zero throughout."""
    if row not in matrices["C"] or row in state:
        return 0.0
    return max(abs(v) * natural(state, n) for r in matrices["C"] if r not in state for n, v in matrices["C"][r].items())


def slopes_by(reduced, state, name, is_input):
    """Slopes of all rates and outputs by a state or an input, to the fourth order."""
    places, weights = STENCIL
    step = 1e-3 * natural(state, name)
    values = {n: np.full(4, v) for n, v in state.items()}
    inputs = {}
    if is_input:
        inputs[name.rpartition(".")[0]] = step * places
    else:
        values[name] = values[name] + step * places
    refuse_switches(reduced, values)
    rows = rates_and_outputs(reduced, values, inputs)
    return {row: float(weights @ column) / step for row, column in rows.items()}


def refuse_switches(reduced, values):
    """Rejects states at which a load or a drive switches, because there is no slope."""
    signals = lambda name: Jet(values[name]) if name in values else Jet(np.zeros(4)) if name == "t" else None
    for of in [*reduced.scene.loads, *reduced.scene.drives]:
        for switch in of.magnitude.switches if of.magnitude else []:
            try:
                at = np.broadcast_to(switch(signals).value, 4)
            except (ValueError, AttributeError) as error:
                raise Unknown("a magnitude depends on other coordinates") from error
            if at.min() <= 0.0 <= at.max() and np.ptp(at) > 0.0:
                raise Unknown(f"`{of.name}` switches there")


def rates_and_outputs(reduced, state, inputs):
    q, v, name = state[reduced.name], state[f"{reduced.name}.velocity"], reduced.name
    zero = np.zeros_like(q)
    of = lambda column: reduced.at(column, q)[0]
    drives = reduced.drives(Jet(q, v, zero), zero, States(state), inputs)
    numbers = reduced.load_numbers(q, v, zero)
    force = reduced.force(q, v, zero)[0] + sum((d.force() for d in drives.values()), zero)
    inertia = of("m") + sum(d.numbers["rotor"] for d in drives.values())
    acceleration = (force - of("half_dm") * v**2) / inertia
    found = {f"d({name})/dt": v, f"d({name}.velocity)/dt": acceleration, name: q, f"{name}.velocity": v}
    for column, _ in reduced.rows.ending(".a"):
        channels = {load: f"{column}.c.{load}" for load in numbers}
        if all(c in reduced.rows for c in channels.values()):
            of_loads = sum((of(c) * numbers[load] for load, c in channels.items()), zero)
            found[column] = of(f"{column}.a") * acceleration + of(f"{column}.b") * v**2 + of_loads
    for drive, forces in drives.items():
        found[f"{drive}.actuator_force"] = forces.force() + zero
        if f"{drive}.current" in state:
            found[f"d({drive}.current)/dt"] = forces.current_rate
        if f"{drive}.integral" in state:
            found[f"d({drive}.integral)/dt"] = forces.magnitude - v
    return found

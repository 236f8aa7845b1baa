"""Faults that the audit cannot find, with their reasons: patterns of the names that the self-test gives them."""

import re

import numpy as np

from parts import judge_folder


ESTIMATE = "an estimate that a program makes of its own error, or a count of its work"
PRODUCT = "it takes another run of the program: `crates/validation/src/written` has it"
PATTERNS = [
    (r": relative_error,", ESTIMATE),
    (r"json: (.*\.)?error\.", ESTIMATE),
    (r"json: (rounding_error|.*\.estimated_error|tolerance$|steps|rejected_steps|evaluations|jacobians|factorisations|decompositions)", ESTIMATE),
    (r"json: (power_balance_residual|energy_balance_error|largest_kinetic_energy)", "a bound: the rows must be within it"),
    (r"json: .*positions$|check\.json: coordinate_sweep\.|check\.json: inertia\..*\.(min|max)$", PRODUCT),
    (r"json: kinetic_energy_at", "a number of the whole range: check 5 of the product"),
    (r"json: .*count_in_second_run", ESTIMATE),
    (r"statics: .*velocity_ratio", "rows at rest at uneven distances, between which no rule integrates"),
    (r"reduce\.json: table\.", "how the table is made"),
    (r"json: period", "an integral of the whole motion: check 5 of the product"),
    (r"json: floquet_multiplier", PRODUCT),
    (r"cycle\.json: flywheel\.inertia|cycle: .*velocity, 1e-6|cycle: .*acceleration, 1e-6|cycle: .*\.(work|current|integral), 1e-6",
     "a cycle with friction, or whose loads need other coordinates, is judged between its rows alone, to 1e-5"),
    (r"json: (equilibria$|searched\.|neutral|.*\.neutral|.*stability)", PRODUCT),
    (r"cycle\.json: .*work", "the work of a whole cycle may be rounding beside the works within it"),
    (r"check\.json: (degrees_of_freedom\.counted|redundant|reactions\.)", "the structure of the scene: " + PRODUCT),
    (r"check\.json: (group\.|size\.|range\.|load\.|drive\.|separation|closest|prescribed\.positions|free_motion\.events|load|.*\.mode\.)",
     "what `check` says of structure and requests: " + PRODUCT),
    (r"check\.json: (mass\.center|start\.)", "judged where a file has a row at the assembly"),
    (r"sweep\.json: rows\.|sweep\.json: points\.failed", "counts of the store of rows"),
    (r"bending_moment\.(station|at)", "the place of the largest cut of the rows"),
    (r"json: (min|max) of .*(\.direction|\.efficiency|balance|residual|\.friction\.)", "a column that jumps between rows"),
    (r"json: (min|max) of .*\.rotation\.", "of the rows"),
]


def reason(name, folder):
    """The reason why a fault cannot be found; None if the audit must find it."""
    direction = re.match(r"([\w-]+): (.+)\.direction, ", name)
    if direction:
        table = folder.csv(direction[1])
        force = table.get(f"{direction[2]}.magnitude") if table else None
        if force is not None and np.nanmax(force) < 1e-9:
            return "the direction of a force that is zero"
    if name.startswith("reduced: ") and folder.csv("reduced") and np.ptp(folder.csv("reduced").get("m")) < 1e-9 * folder.csv("reduced").get("m")[0]:
        return "nothing depends on the coordinate"
    table = name.split(": ")[0]
    if "json: static_force" in name and re.search(r"^\[(prescribed|coordinate-sweep|drives|friction)", folder.scene_text, re.MULTILINE):
        return "the rows of `statics` are other positions, or drives and friction act: " + PRODUCT
    has_teeth = re.search(r"\b(gear|rack|rolling) *=", folder.scene_text)
    if has_teeth and re.match(r"scene: (assembly\.|joints\..*\.(rack|normals)\.)", name):
        return "the places at which teeth mesh are those of the first row"
    if "cycle.json: flywheel.coefficient_of_fluctuation" in name and folder.csv("cycle-flywheel") is None:
        return "what was asked for, in no file"
    if re.search(r"cycle.json: .*_speed\.at$", name) and all(np.ptp(v) < 1e-9 * np.max(np.abs(v)) for _, v in folder.csv("cycle").ending(".velocity")):
        return "the speed is constant"
    if name.startswith("scene: assembly.") and name.endswith((".turn.0", ".turn.1", ".turn.2")) and folder.scene_text.count("spherical") > 1:
        return "the idle rotation of a body between two balls begins where it is assembled"
    if is_rounding(name, table, folder):
        return "all numbers of this unit are rounding"
    if name.startswith("statics: ") and "velocity_ratio" in name and "[prescribed" not in folder.scene_text:
        return None
    if name.startswith("reduced: ") and any("same positions" in line for line in judge_folder(folder).skipped):
        return "no other file has rows of the same positions"
    if "cycle: " in name and np.ptp(folder.csv("cycle").columns.get(name[7:].split(",")[0], np.zeros(2))) < 1e-6:
        return "it does not change in a cycle but for rounding"
    if bends_between_rows(name, folder):
        return "the rows are too far apart for a polynomial, and the curve bends by more from row to row"
    return next((why for pattern, why in PATTERNS if re.search(pattern, name)), None)


def is_rounding(name, table, folder):
    """Whether no column of a table's unit is above rounding, of motions with speeds of about one."""
    rows, column = folder.csv(table), name[len(table) + 2 :].rpartition(", ")[0]
    if table not in ("motion", "run-i", "run-ii", "runs") or rows is None or column not in rows.columns:
        return False
    return max(np.nanmax(np.abs(values), initial=0.0) for n, values in rows.columns.items() if rows.units[n] == rows.units[column]) < 1e-9


def bends_between_rows(name, folder):
    """Whether a curve bends by more than the planted 1 % from row to row where it is smallest or largest."""
    found = re.match(r"(\w+)\.json: (min|max) of (.+)$", name)
    end = {"simulate": "motion"}.get(found[1], found[1]) if found else None
    values = folder.csv(end).get(found[3]) if found and folder.csv(end) else None
    if values is None:
        return False
    k = int(np.nanargmin(values) if found[2] == "min" else np.nanargmax(values))
    around = values[max(k - 3, 0) : k + 4]
    return 1.5 * np.nanmax(np.abs(np.diff(around, 2)), initial=0.0) > 0.009 * abs(values[k])

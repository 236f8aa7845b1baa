"""Exported FMUs in a second importer, fmi-rs: `just fmi-rs`, or `python3 validation/fmu/second_importer.py`.

Installs fmi-rs's simulator into a scratch folder (minutes; its build needs libclang). It simulates the single-dwell mechanism and the
four-bar with a motor, in both versions of FMI and by both kinds, from cells and from `--exact`: the period, and every column against
`dwell simulate` and between the kinds. The four-bar also gets another voltage than its scene's, by an input file. Failures are printed,
with status 1.

What fmi-rs 0.7.0 does not do:
- Its reader of FMI 3.0 knows neither `unit` of a Float64 nor `A` of a BaseUnit, and refuses a file with an attribute that it does not
  know. The standard's schema has both, and FMI 2.0 passes with them: so its FMI 3.0 gets copies without units.
- By model exchange it has Euler's method alone. Runs by halved steps are extrapolated to the step zero.
"""

import csv
import math
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from run import HOME, MAX_STEP, PERIOD, compare_with_simulate, passage

VERSION = "0.7.0"
DWELL = HOME / "target" / "release" / "dwell"
# How long a case moves, s.
CASES = {"single-dwell": 6.0, "four-bar": 0.6}
ROWS = 600
# Euler's steps between two rows. Each extrapolation takes the next power of the step out of the error.
EULER = [8, 16, 32, 64]
# Of the period, s, and of each column's largest value.
ALLOWED_PERIOD, ALLOWED = 1e-10, 1e-6


def simulator():
    """The path of fmi-rs's simulator, which is built where it is missing: outside the workspace, with its own lock file."""
    folder = Path(tempfile.gettempdir()) / f"dwell-fmi-rs-{VERSION}"
    program = folder / "bin" / "fmi-sim"
    if not program.exists():
        folder.mkdir(exist_ok=True)
        command = ["cargo", "install", "--quiet", "fmi-sim", "--version", f"={VERSION}", "--locked", "--root", folder]
        if subprocess.run(command, cwd=folder).returncode:
            sys.exit(f"fmi-sim {VERSION} could not be built; its build needs libclang, such as by `apt-get install libclang-dev`")
    return program


def without_units(fmu):
    """A copy of an FMU whose description has no units."""
    copy = fmu.with_name(f"unitless_{fmu.name}")
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(copy, "w") as target:
        for entry in source.infolist():
            data = source.read(entry)
            if entry.filename == "modelDescription.xml":
                data = re.sub(rb"<UnitDefinitions>.*</UnitDefinitions>", b"", data, flags=re.DOTALL)
                data = re.sub(rb' unit="[^"]*"', b"", data)
            target.writestr(entry, data)
    return copy


def simulate(program, fmu, kind, stop, steps, input_file, max_step):
    """The columns of fmi-rs's CSV at ROWS + 1 instants, with `steps` steps from one to the next."""
    out = fmu.with_suffix(".csv")
    command = [program, "--model", fmu, "-o", out, *(["-i", input_file] if input_file else []), kind, "-f", repr(stop)]
    command += ["--output-interval", repr(stop / ROWS / steps), "--init-values", f"parameters.max_step={max_step}"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"fmi-rs, {kind}, status {done.returncode}: {done.stderr.strip()[:300]}"
    with open(out, encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    # At an event it writes two rows of one instant: the last of them counts.
    at = {round(float(row[0]) / stop * ROWS, 5): row for row in rows}
    assert all(k in at for k in range(ROWS + 1)), f"fmi-rs: {len(rows)} rows, and not at all instants"
    columns = {name: [float(at[k][column]) for k in range(ROWS + 1)] for column, name in enumerate(names)}
    # A comparison with what is no number could pass.
    assert all(math.isfinite(x) for column in columns.values() for x in column), f"fmi-rs, {kind}: a result is not finite"
    return columns


def extrapolated(runs):
    """Richardson's extrapolation of runs by steps each half as long as the one before."""
    for power in range(1, len(runs)):
        weight = 2**power
        runs = [{name: [(weight * y - x) / (weight - 1) for x, y in zip(coarse[name], fine[name])] for name in coarse}
                for coarse, fine in zip(runs, runs[1:])]
    return runs[0]


def compare_kinds(results):
    """The largest difference of the two kinds at any instant, relative to the largest of its column, and the column's name."""
    first, second = results.values()
    worst = (0.0, "")
    for name in first:
        largest = max(map(abs, first[name]))
        # A column that is zero but for rounding says nothing; the count of periods steps.
        if name not in ("time", "periods") and largest > 1e-12:
            worst = max(worst, (max(abs(x - y) for x, y in zip(first[name], second[name])) / largest, name))
    return worst


def judge_one(program, scene, fmu, label, stop, input_file):
    """One FMU by both kinds: the period and its count, and its columns against `dwell simulate` and between the kinds."""
    step = MAX_STEP.get(scene.parent.name, 1e-3)
    results = {"CoSimulation": simulate(program, fmu, "co-simulation", stop, 1, input_file, step)}
    results["ModelExchange"] = extrapolated([simulate(program, fmu, "model-exchange", stop, n, input_file, step) for n in EULER])
    for kind, result in results.items():
        turns = int(result["phi"][-1] / 6.283185307179586)
        assert round(result["periods"][-1]) == turns > 0, f"{label}, {kind}: {result['periods'][-1]} periods, not {turns}"
        if scene.stem == "single-dwell":
            error = passage(result, "phi", 6.283185307179586) - PERIOD
            assert abs(error) <= ALLOWED_PERIOD, f"{label}, {kind}: the period is off by {error:.1e} s"
            print(f"{label}, {kind}: period off by {error:.1e} s")
    for kind, text in compare_with_simulate(DWELL, scene, results, stop, ALLOWED).items():
        print(f"{label}, {kind}: {text}")
    error, name = compare_kinds(results)
    assert error < ALLOWED, f"{label}: by the two kinds {name} differs by {error:.1e} of its largest"
    print(f"{label}: both kinds within {error:.1e} at {ROWS + 1} instants ({name})", flush=True)


def export(scene, target, exact):
    """The FMU of a scene as fmi-rs can read it."""
    out = scene.parent / f"{target}-{exact}"
    accuracy = ["--exact"] if exact else ["--accuracy", "1e-11"]
    subprocess.run([DWELL, "export", scene, "--to", target, "--out", out, *accuracy], check=True, capture_output=True)
    fmu = out / f"{scene.stem.replace('-', '_')}.fmu"
    return without_units(fmu) if target == "fmu" else fmu


def other_voltage(scene):
    """The four-bar's scene at 36 V, and the input by which the FMU of the scene at 48 V does the same."""
    text = scene.read_text(encoding="utf-8")
    assert text.count("voltage = 48") == 1, "the voltage of the four-bar's scene is not where it was"
    other, file = scene.with_name("other.toml"), scene.with_name("voltage.csv")
    other.write_text(text.replace("voltage = 48", "voltage = 36"), encoding="utf-8")
    file.write_text("time,inputs.voltage_motor\n0.0,36.0\n10.0,36.0\n", encoding="utf-8")
    return other, file


def judge_case(program, scene, target, exact, stop):
    """A case in one version of FMI; the four-bar at both voltages."""
    label = f"{scene.stem}, FMI {3 if target == 'fmu' else 2}{', exact' if exact else ''}"
    try:
        fmu = export(scene, target, exact)
        judge_one(program, scene, fmu, label, stop, None)
        if scene.stem == "four-bar":
            other, file = other_voltage(scene)
            judge_one(program, other, fmu, f"{label}, 36 V", stop, file)
    except (AssertionError, subprocess.CalledProcessError) as error:
        # What `dwell` itself says is bytes in the error.
        print(f"FAILED {label}: {error} {getattr(error, 'stderr', b'').decode()}", flush=True)
        return False
    return True


def main():
    program, passed = simulator(), []
    with tempfile.TemporaryDirectory() as folder:
        for case, stop in CASES.items():
            scene = Path(folder) / case / f"{case}.toml"
            scene.parent.mkdir()
            scene.write_bytes((HOME / "validation" / case / "scene.toml").read_bytes())
            passed += [judge_case(program, scene, target, exact, stop) for target in ("fmu", "fmu2") for exact in (False, True)]
    if not all(passed):
        sys.exit(f"{passed.count(False)} of {len(passed)} FMUs fail in fmi-rs")
    print("all FMUs pass in fmi-rs")


if __name__ == "__main__":
    main()

"""Exported FMUs, judged by FMPy and by the standard's schemas: `just export`.

Installs FMPy into a scratch environment. For each case and both versions of FMI: FMPy's validation and the schemas accept the
FMU, both kinds simulate it, and a saved state continues bit for bit. The single-dwell mechanism has its period.
"""
import csv
import os
import shutil
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path
from xml.etree import ElementTree

HOME = Path(__file__).resolve().parents[2]
# The folder of a scene, how long it moves (s), and what both kinds may differ from `dwell simulate` in the largest value of a column.
CASES = {
    "single-dwell/scene": (6.0, 1e-7),
    "four-bar/scene": (0.6, 1e-6),
    "crank-rocker/scene": (1.0, 1e-6),
    "slotted-rocker/scene": (0.5, 1e-6),
    "spatial/bricard-a04": (1.0, 1e-6),
}
# By quadrature on the exact model, and by the independent program of the case.
PERIOD = 5.41966267706


# Largest step of co-simulation, s: the current of this motor settles in 2.5 ms. By steps of 1 ms it is 2.4e-5 off at 10 ms.
MAX_STEP = {"four-bar": 2e-4}


def environment():
    """The Python of an environment with FMPy."""
    folder = Path(tempfile.gettempdir()) / "dwell-fmpy"
    python = folder / "bin" / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", "fmpy", "lxml"], check=True)
    return python


def passage(result, column, value):
    """When a column passes a value, by Hermite's cubic between rows."""
    t, q, v = result["time"], result[column], result[column + ".velocity"]
    i = next(i for i in range(1, len(t)) if q[i - 1] < value <= q[i] and t[i] > t[i - 1])
    h, low, high = t[i] - t[i - 1], 0.0, 1.0
    for _ in range(60):
        x = 0.5 * (low + high)
        y = (q[i - 1] * (1 - 3 * x**2 + 2 * x**3) + q[i] * (3 * x**2 - 2 * x**3)
             + h * x * (1 - x) * (v[i - 1] * (1 - x) - v[i] * x))
        low, high = (x, high) if y < value else (low, x)
    return t[i - 1] + h * low


def check_schema(fmu, version):
    """The model description against the schema that FMPy brings along."""
    import fmpy
    from lxml import etree
    name = "fmi3/fmi3ModelDescription.xsd" if version == 3 else "fmi2/fmi2ModelDescription.xsd"
    schema = etree.XMLSchema(etree.parse(str(Path(fmpy.__file__).parent / "schema" / name)))
    with zipfile.ZipFile(fmu) as archive:
        schema.assertValid(etree.fromstring(archive.read("modelDescription.xml")))


def check_restored(fmu, version):
    """A saved co-simulation continues bit for bit, and a hundred instances leave nothing."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave
    description = read_model_description(fmu)
    folder = extract(fmu)
    references = [v.valueReference for v in description.modelVariables if v.causality == "output" and v.variability != "discrete"]

    def run(instance, steps):
        values = []
        for k in steps:
            instance.doStep(0.01 * k, 0.01)
            values += instance.getFloat64(references) if version == 3 else instance.getReal(references)
        return values

    def open_one():
        slave = (FMU3Slave if version == 3 else FMU2Slave)(
            guid=description.guid, unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier, instanceName="a")
        slave.instantiate()
        if version == 2:
            slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        return slave

    slave = open_one()
    run(slave, range(50))
    saved = slave.getFMUState() if version == 3 else slave.getFMUstate()
    first = run(slave, range(50, 100))
    (slave.setFMUState if version == 3 else slave.setFMUstate)(saved)
    assert first == run(slave, range(50, 100)), "a restored state continues otherwise"
    (slave.freeFMUState if version == 3 else slave.freeFMUstate)(saved)
    slave.terminate()
    slave.freeInstance()
    for _ in range(100):
        one = open_one()
        one.terminate()
        one.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


def compare_with_reference(fmu, result, allowed):
    """The co-simulation against the results that the FMU brings along, and their manifest."""
    folder = "extra/org.fmi-standard.fmi-ls-ref/"
    with zipfile.ZipFile(fmu) as archive:
        manifest = ElementTree.fromstring(archive.read(folder + "fmi-ls-manifest.xml"))
        related = {related.get("role"): related.get("source") for related in manifest}
        assert set(related) == {"model", "result"}, related
        assert archive.read(folder + related["model"]).strip(), "the scene is empty"
        rows = list(csv.reader(archive.read(folder + related["result"]).decode().splitlines()))
    row = {round(t, 6): k for k, t in enumerate(result["time"])}
    compared = 0
    for k, name in enumerate(rows[0]):
        values = [float(r[k]) for r in rows[1:] if round(float(r[0]), 6) in row]
        largest = max(map(abs, values))
        if name in ("time", "periods") or largest < 1e-12:
            continue
        at = [row[round(float(r[0]), 6)] for r in rows[1:] if round(float(r[0]), 6) in row]
        error = max(abs(result[name][i] - value) for i, value in zip(at, values)) / largest
        assert error < allowed, f"{name} differs from the reference results by {error:.1e}"
        compared += 1
    assert compared > 3 and len(at) > 5, (compared, len(at))


def compare_with_simulate(dwell, scene, results, stop, allowed):
    """Every output of an FMU against the column of that name in the rows of `dwell simulate` at the same instants."""
    times, out = scene.with_suffix(".times"), scene.parent / "simulate"
    instants = [k * stop / 20 for k in range(21)]
    times.write_text("\n".join(map(repr, instants)))
    command = [dwell, "simulate", scene, "--method", "dop853", "--rtol", "1e-12", "--pictures", "none"]
    subprocess.run([*command, "--times", times, "--out", out], check=True, capture_output=True)
    with open(out / f"{scene.stem}-motion.csv", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    columns = {name.split(" [")[0]: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}
    shutil.rmtree(out)
    found = {}
    for kind, result in results.items():
        common = [name for name in result if name in columns and name != "time"]
        assert len(common) > 1, f"{scene.stem}: only {common} can be compared"
        # At an event an importer writes two rows of one instant: the last of them counts.
        row = {round(20 * t / stop, 6): k for k, t in enumerate(result["time"])}
        worst = (0.0, "")
        for name in common:
            largest = max(abs(value) for value in columns[name])
            # A column that is zero but for rounding says nothing.
            if largest > 1e-12:
                error = max(abs(result[name][row[k]] - columns[name][k]) for k in range(21)) / largest
                worst = max(worst, (error, name))
        assert worst[0] < allowed, f"{scene.stem}, {kind}: {worst[1]} differs from simulate by {worst[0]:.1e} of its largest"
        found[kind] = f"{len(common)} columns within {worst[0]:.1e} of simulate ({worst[1]})"
    return found


def judge_one(dwell, scene, version, out, target, stop, allowed):
    """One FMU of a case: its validation, schema and saved state, and its motion by both kinds."""
    from fmpy import read_model_description, simulate_fmu
    from fmpy.validation import validate_fmu
    command = [dwell, "export", scene, "--to", target, "--out", out, "--accuracy", "1e-11"]
    subprocess.run(command, check=True, capture_output=True)
    fmu = str(out / f"{scene.stem.replace('-', '_')}.fmu")
    problems = validate_fmu(fmu)
    assert not problems, f"{scene.stem}: {problems}"
    check_schema(fmu, version)
    check_restored(fmu, version)
    coordinate = read_model_description(fmu).modelVariables[1].name
    results = {}
    for kind, allowed_period in [("CoSimulation", 1e-10), ("ModelExchange", 1e-7)]:
        values = {"parameters.max_step": MAX_STEP.get(scene.stem, 1e-3)}
        result = simulate_fmu(
            fmu, fmi_type=kind, stop_time=stop, output_interval=stop / 600, relative_tolerance=1e-10, start_values=values)
        result = {name: result[name] for name in result.dtype.names}
        results[kind] = result
        if scene.stem == "single-dwell":
            error = passage(result, coordinate, 6.283185307179586) - PERIOD
            assert abs(error) <= allowed_period, f"{kind}: the period is off by {error:.1e} s"
            print(f"{scene.stem}, FMI {version}, {kind}: period off by {error:.1e} s")
    compare_with_reference(fmu, results["CoSimulation"], allowed)
    for kind, text in compare_with_simulate(dwell, scene, results, stop, allowed).items():
        print(f"{scene.stem}, FMI {version}, {kind}: {text}")


def judge():
    """All cases, in the environment with FMPy."""
    dwell = HOME / "target" / "release" / "dwell"
    with tempfile.TemporaryDirectory() as folder:
        for case, (stop, allowed) in CASES.items():
            name = case.split("/")[0] if case.endswith("/scene") else case.split("/")[1]
            scene = Path(folder) / f"{name}.toml"
            text = (HOME / "validation" / f"{case}.toml").read_text(encoding="utf-8")
            # The linkages in space stand without a motion.
            scene.write_text(text if "\n[motion]" in text else f"{text}\n[motion]\nduration = {stop}\n", encoding="utf-8")
            for version, target in [(3, "fmu"), (2, "fmu2")]:
                judge_one(dwell, scene, version, Path(folder) / target, target, stop, allowed)
    print("all FMUs pass")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        judge()
    else:
        # By its full path: the interpreter finds its environment by the name it is called by.
        python = environment()
        os.execv(python, [str(python), __file__, "judge"])

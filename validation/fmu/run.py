"""Exported FMUs, judged by FMPy and by the standard's schemas: `just export`.

Installs FMPy into a scratch environment. For each case and both versions of FMI: FMPy's validation and the schemas accept the
FMU, both kinds simulate it, and a saved state continues bit for bit. The single-dwell mechanism has its period.
"""
import os
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

HOME = Path(__file__).resolve().parents[2]
CASES = ["single-dwell", "four-bar", "slider-crank", "scotch-yoke"]
# By quadrature on the exact model, and by the independent program of the case.
PERIOD = 5.41966267706


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
    import zipfile
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


def judge():
    """All cases, in the environment with FMPy."""
    from fmpy import read_model_description, simulate_fmu
    from fmpy.validation import validate_fmu
    dwell = HOME / "target" / "release" / "dwell"
    with tempfile.TemporaryDirectory() as folder:
        for case in CASES:
            scene = Path(folder) / f"{case}.toml"
            shutil.copy(HOME / "validation" / case / "scene.toml", scene)
            for version, target in [(3, "fmu"), (2, "fmu2")]:
                out = Path(folder) / target
                command = [dwell, "export", scene, "--to", target, "--out", out, "--accuracy", "1e-11"]
                subprocess.run(command, check=True, capture_output=True)
                fmu = str(out / f"{case.replace('-', '_')}.fmu")
                problems = validate_fmu(fmu)
                assert not problems, f"{case}: {problems}"
                check_schema(fmu, version)
                check_restored(fmu, version)
                names = [v.name for v in read_model_description(fmu).modelVariables]
                coordinate = names[1]
                ends = {}
                for kind, allowed in [("CoSimulation", 1e-10), ("ModelExchange", 1e-7)]:
                    stop = 6.0 if case == "single-dwell" else 0.1
                    result = simulate_fmu(fmu, fmi_type=kind, stop_time=stop, output_interval=0.01, relative_tolerance=1e-10)
                    ends[kind] = result[-1]
                    line = f"{case}, FMI {version}, {kind}: {len(result)} rows"
                    if case == "single-dwell":
                        error = passage(result, coordinate, 6.283185307179586) - PERIOD
                        assert abs(error) <= allowed, f"{line}: the period is off by {error:.1e} s"
                        line += f", period off by {error:.1e} s"
                    print(line)
                difference = abs(ends["CoSimulation"][coordinate] - ends["ModelExchange"][coordinate])
                assert difference < 1e-6 * (1 + abs(ends["CoSimulation"][coordinate])), f"{case}: kinds differ by {difference}"
    print("all FMUs pass")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        judge()
    else:
        os.execv(environment(), ["python", __file__, "judge"])

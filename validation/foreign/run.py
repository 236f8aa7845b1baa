"""The paper's MATLAB part in GNU Octave on the same exported runs as `dwell reduce --from`: `just octave`.

Octave is installed by the distribution's packages where it is missing. For each pair of runs `reduce.m` combines them, integrates the
free motion and compares with what Dwell wrote and with the period that the independent program of validation/reference gives.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Relative tolerance of m, ½m′, a, b and of the period. Own runs: 8.2e-10 is measured, the error of Octave's splines through 720
# positions. Exudyn's: 1.4e-3 and 5.1e-6 are measured, the difference of Octave's splines and Dwell's polynomials where run ii, which
# has other positions than run i, is interpolated.
EXPORTS = [
    ("single-dwell", None, "phi", "phi.actuator_force", "slide.normal", 3e-9),
    ("single-dwell", "exudyn", "angle", "moment", "force x=joint.x", 3e-3),
    ("crank-rocker", "exudyn", "angle", "moment", "force x=joint.x", 2e-5),
]


def octave():
    """The path of Octave, which is installed where it is missing."""
    if not shutil.which("octave-cli"):
        install = ["apt-get", "install", "--yes", "--no-install-recommends", "octave"]
        as_root = [] if os.geteuid() == 0 else ["sudo"]
        if not shutil.which("apt-get") or subprocess.run(as_root + install).returncode:
            sys.exit("octave-cli is missing, and could not be installed: install GNU Octave, such as by `apt-get install octave`")
    return shutil.which("octave-cli")


def period_and_energy(case):
    """Of the free motion of a case, in s and J: the independent program's values."""
    text = tomllib.loads((HERE.parent / case / "case.toml").read_text())
    motion = text["free_motion"]
    if "energy_J" in motion:
        return motion["period_s"], motion["energy_J"]
    at_start = next(s for s in text["samples"] if float(s["q"]) == float(motion["phi0"]))
    return motion["period_s"], str(0.5 * float(at_start["m"]) * float(motion["phidot0"]) ** 2)


def main():
    program = ROOT / "target" / "release" / "dwell"
    subprocess.run(["cargo", "build", "--quiet", "--release", "--workspace", "--bins"], cwd=ROOT, check=True)
    cli, failed = octave(), 0
    with tempfile.TemporaryDirectory() as folder:
        def dwell(*arguments):
            result = subprocess.run([program, *map(str, arguments), "--out", folder, "--pictures", "none"],
                                    capture_output=True, text=True)
            if result.returncode:
                sys.exit(result.stderr)
            return result.stdout

        for case, of, coordinate, moment, reaction, tolerance in EXPORTS:
            columns, name = [], f"{case}-{of or 'dwell'}"
            if of is None:
                dwell("runs", HERE.parent / case / "scene.toml", "--points", 721)
                runs = [Path(folder) / f"{case}-run-{run}.csv" for run in ("i", "ii")]
            else:
                runs = [HERE / f"{case}-run-{run}.csv" for run in ("i", "ii")]
                columns = ["--columns", HERE / "columns.toml"]
            printed = dwell("reduce", "--from", *runs, *columns, "--name", name)
            period = re.search(r"period of ([0-9.]+) s", printed)
            print(f"{case}, runs of {of or 'Dwell'}; Dwell finds a period of {period[1]} s")
            done = subprocess.run([cli, "--quiet", HERE / "reduce.m", *runs, coordinate, moment, reaction,
                                   f"{folder}/{name}-reduced.csv", *period_and_energy(case), str(tolerance)],
                                  stderr=subprocess.PIPE, text=True)
            # Octave 7 prints this whenever a script calls exit.
            errors = [line for line in done.stderr.splitlines() if "while preparing to exit" not in line]
            sys.stderr.write("".join(line + "\n" for line in errors))
            failed += done.returncode != 0
    sys.exit(f"{failed} of {len(EXPORTS)} comparisons fail" if failed else 0)


if __name__ == "__main__":
    main()

"""Runs the program: `optimise` within limits, and `sweep` for the results of designs."""
import csv
import os
import resource
import shutil
import signal
import subprocess

LONGEST = 30
LARGEST_MEMORY = 4 << 30
# On the clock, s.
MOST_PATIENCE = 240


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST + 2))
    resource.setrlimit(resource.RLIMIT_AS, (LARGEST_MEMORY, LARGEST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def run(program, arguments, folder):
    """Status and all that is printed; status None where it takes too long."""
    environment = {"NO_COLOR": "1", "LC_ALL": "C.UTF-8", "RAYON_NUM_THREADS": "1", "COLUMNS": "400"}
    try:
        done = subprocess.run(
            [program, *arguments], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, timeout=MOST_PATIENCE,
            preexec_fn=limit, env=environment | {"PATH": os.environ.get("PATH", "")},
        )
    except subprocess.TimeoutExpired:
        return None, ""
    slow = done.returncode in (-signal.SIGXCPU, -signal.SIGKILL)
    return None if slow else done.returncode, (done.stdout + done.stderr).decode(errors="replace")


class Refused(Exception):
    """The sweep does not compute the results of a scene."""


def sweep(program, folder, scene, results, vary, tied=(), samples=None, seed=1):
    """Rows of a sweep: of each the inputs and the results by their names, or None where it has a message."""
    out = folder / "sweep"
    shutil.rmtree(out, ignore_errors=True)
    arguments = ["sweep", str(scene), "--result", ",".join(dict.fromkeys(results)), "--pictures", "none", "--export", "csv", "--out", "sweep"]
    for text in vary:
        arguments += ["--vary", text]
    for path, text in tied:
        arguments += ["--tied", f"{path}={text}"]
    if samples:
        arguments += ["--samples", str(samples), "--seed", str(seed)]
    status, text = run(program, arguments, folder)
    tables = list(out.glob("*-sweep.csv"))
    if status != 0 or not tables:
        raise Refused(f"status {status}: {text[:600]}")
    with tables[0].open() as file:
        header, *rows = csv.reader(file)
    names = [name.rsplit(" [", 1)[0] for name in header]
    found = []
    for row in rows:
        values = dict(zip(names, row))
        is_left_out = values["message"] != ""
        found.append(None if is_left_out else {k: float(v) for k, v in values.items() if k not in ("index", "message") and v != ""})
    return found

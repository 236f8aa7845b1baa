"""Ten million single-dwell mechanisms, killed twice on the way: `python3 validation/designs/run.py [POINTS]`, or `just designs`.

Runs `dwell sweep` over two dimensions, kills it (SIGKILL) twice, lets it finish, and installs Polars, DuckDB and pandas into a
scratch environment to read the Parquet files as docs/sweep.md shows: every row must be there once, and its mean and extremes must
be those of the printed summary. Needs the network, and about 60 bytes of disk for each point.
"""

import json
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

PACKAGES = ["duckdb==2.0.0", "pandas==3.1.1", "polars==2.1.0", "pyarrow==26.0.1"]
HOME = Path(__file__).resolve().parent.parent.parent
SCENE = HOME / "validation" / "single-dwell" / "scene.toml"
KILLS = 2


def command(points, out):
    vary = ["--vary", "coupler.points.C[0]±2%", "--vary", "crank.points.B[0]±2%", "--samples", str(points)]
    return [HOME / "target" / "release" / "dwell", "sweep", SCENE, *vary, "--out", out]


def run_and_kill(points, out):
    """The time of a run until it is killed, when it has written about a third of what is missing."""
    folder = out / "single-dwell-sweep"
    parts = lambda: len(list(folder.glob("part-*.parquet")))
    missing = -(-points // 65536) - parts()
    wanted = parts() + max(1, missing // 3)
    start = time.monotonic()
    run = subprocess.Popen(command(points, out), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while parts() < wanted:
        if run.poll() is not None:
            sys.exit("the run ended before it was killed: more points are needed")
        time.sleep(0.01)
    run.kill()
    run.wait()
    elapsed = time.monotonic() - start
    print(f"killed after {elapsed:.1f} s with {parts()} parts")
    return elapsed


def blocks(text):
    """The Python of a page."""
    return [part.split("```")[0] for part in text.split("```python\n")[1:]]


def main():
    points = int(sys.argv[1]) if sys.argv[1:] else 10_000_000
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        out = scratch / "reports"
        elapsed = sum(run_and_kill(points, out) for _ in range(KILLS))
        start = time.monotonic()
        subprocess.run(command(points, out), check=True)
        elapsed += time.monotonic() - start
        size = sum(part.stat().st_size for part in out.glob("*/part-*.parquet"))
        print(f"{points} variants in {elapsed:.1f} s, with {KILLS} kills, the summary and its picture; {size / points:.1f} bytes a variant")
        print(f"at this speed 100 million take {elapsed * 1e8 / points / 60:.0f} min")

        venv.create(scratch / "env", with_pip=True)
        python = scratch / "env" / "bin" / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
        for block in blocks((HOME / "docs" / "sweep.md").read_text(encoding="utf-8")):
            print(block)
            start = time.monotonic()
            subprocess.run([python, "-c", block], cwd=scratch, check=True)
            print(f"{time.monotonic() - start:.2f} s\n")
        results = json.loads((out / "single-dwell-sweep.json").read_text())["results"]
        said = [results[f"period.{what}"]["value"] for what in ("mean", "smallest", "largest")]
        done = subprocess.run([python, "-c", CHECK, str(points), *map(repr, said)], cwd=scratch)
    sys.exit(done.returncode)


CHECK = """
import duckdb, sys
points, mean, smallest, largest = [float(word) for word in sys.argv[1:]]
found = duckdb.sql('''select count(*), count(distinct "index"), min("index"), max("index"), count("message"),
    avg("period [s]"), min("period [s]"), max("period [s]") from 'reports/single-dwell-sweep/*.parquet' ''').fetchall()[0]
print(found)
rows = found[:5] == (points, points, 0, points - 1, 0)
values = abs(found[5] / mean - 1) < 1e-12 and found[6:] == (smallest, largest)
print("every row once:", rows, " mean and extremes of the summary:", values)
sys.exit(not (rows and values))
"""


if __name__ == "__main__":
    main()

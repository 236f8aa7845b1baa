"""Dwell beside Exudyn, Pinocchio and MuJoCo, in one run: `python3 validation/peers/run.py`, or `just peers`.

Installs the three into a scratch environment, measures them on two cases in the plane and three in space, then Dwell, and writes
reports/peers.csv (theirs), .md and .png.
Needs Python 3.11 or later on x86-64 Linux, the network and about eight minutes.
"""

import os
import subprocess
import tempfile
import venv
from pathlib import Path

PACKAGES = ["exudyn==1.13.6", "pin==4.1.0", "mujoco==4.0.0", "numpy"]
HERE = Path(__file__).resolve().parent
HOME = HERE.parent.parent


def main():
    example = ["cargo", "run", "--release", "--quiet", "--example", "peers", "--"]
    subprocess.run([*example[:1], "build", *example[2:-1]], cwd=HOME, check=True)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        venv.create(scratch / "env", with_pip=True)
        python = scratch / "env" / "bin" / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
        print("load:", *(f"{load:.1f}" for load in os.getloadavg()), flush=True)
        theirs = HOME / "reports" / "peers.csv"
        subprocess.run([python, "-W", "ignore", HERE / "peers.py", HERE.parent, theirs], cwd=scratch, check=True)
        subprocess.run([*example, theirs], cwd=HOME, check=True)
        print("load:", *(f"{load:.1f}" for load in os.getloadavg()))


if __name__ == "__main__":
    main()

"""Remakes the reference values: `python3 validation/reference/run.py [CASES]`, or `just reference [CASES]`.

Installs mpmath and numpy into a scratch environment, remakes every value and compares it; writes reports/reference.md
when all cases are remade. Needs Python 3.11 or later, the network and a few minutes.
"""

import subprocess
import sys
import tempfile
import venv
from pathlib import Path

PACKAGES = ["mpmath==1.4.1", "numpy==2.4.6"]
HERE = Path(__file__).resolve().parent


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        venv.create(scratch / "env", with_pip=True)
        python = scratch / "env" / "bin" / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
        table = scratch / "some.md" if sys.argv[1:] else HERE.parent.parent / "reports" / "reference.md"
        done = subprocess.run([python, HERE / "remake.py", HERE.parent, table, *sys.argv[1:]])
    sys.exit(done.returncode)


if __name__ == "__main__":
    main()

#!/usr/bin/env bash
# Builds the Python package into a scratch environment and tests it: its doctests, its tests against the command, the
# notebooks, and its types. `crates/python/run.sh FOLDER` puts the environment there; else it is in target/python.
set -euo pipefail
cd "$(dirname "$0")"
top=$(cd ../.. && pwd)
env="${1:-$top/target/python}"
[ -x "$env/bin/python" ] || python3 -m venv "$env"
"$env/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.9.4,<2' numpy scipy pandas pandas-stubs matplotlib sympy tqdm pytest mypy 'dask[distributed]' pyarrow
rm -rf "$top/target/wheels"
"$env/bin/maturin" build --quiet --release --compression-level 9 --out "$top/target/wheels"
"$env/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps "$top"/target/wheels/dwell-*.whl
"$env/bin/python" -m pytest --pyargs dwell tests
"$env/bin/python" -m mypy --strict python/dwell typed
"$env/bin/python" -m mypy.stubtest dwell --allowlist tests/stubtest.txt --mypy-config-file pyproject.toml
"$env/bin/python" benchmark.py

"""Paths of the repository and of the command."""

import os
import pathlib
import subprocess

import pytest

TOP = pathlib.Path(__file__).resolve().parents[3]
COMMAND = pathlib.Path(os.environ.get("DWELL_COMMAND", TOP / "target/release/dwell"))
CASES = sorted(path.parent.name for path in (TOP / "validation").glob("*/scene.toml"))


@pytest.fixture(scope="session")
def command():
    """Runs the `dwell` command; skips the test if the command is not built."""
    if not COMMAND.exists():
        pytest.skip("the command is not built: cargo build --release -p dwell-cli")

    def run(*arguments):
        return subprocess.run([COMMAND, *arguments], capture_output=True, text=True, env={**os.environ, "NO_COLOR": "1"})

    return run


@pytest.fixture(scope="session")
def slider():
    import dwell

    return dwell.read(str(TOP / "docs/slider.toml"))


@pytest.fixture(scope="session")
def single_dwell():
    import dwell

    return dwell.read(str(TOP / "validation/single-dwell/scene.toml"))

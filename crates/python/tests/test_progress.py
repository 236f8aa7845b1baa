"""The progress display during a computation."""

import io
import sys
import types

import dwell
import pytest
from conftest import TOP
from dwell import _progress

FOUR_BAR = TOP / "validation/four-bar/scene.toml"
SHARES = {"crank.mass": "=1:2:300", "rocker.mass": "=1:2:300"}


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture(params=["tqdm", "without tqdm"])
def terminal(request, monkeypatch):
    """A terminal in which progress is shown without delay."""
    if request.param == "tqdm":
        pytest.importorskip("tqdm")
    else:
        monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    shown = Terminal()
    # pytest itself exchanges sys.stderr before a test begins.
    monkeypatch.setattr(_progress, "sys", types.SimpleNamespace(stderr=shown, modules=sys.modules))
    monkeypatch.setattr(_progress, "SILENT", 0.0)
    return shown


def test_a_sweep_shows_how_far_it_is(terminal):
    found = dwell.sweep(dwell.Scene.read(FOUR_BAR), SHARES, ["m", "B.x.max_abs"])
    assert found.rows == 90000
    lines = [line for line in terminal.getvalue().split("\r") if "%" in line]
    parts = [int(line.split("%")[0].split()[-1]) for line in lines]
    assert "sweep" in lines[0] and parts == sorted(parts) and 0 < parts[-1] <= 100
    # The progress line is erased at the end.
    assert terminal.getvalue().rstrip(" \r").count("sweep") >= 1 and terminal.getvalue().endswith("\r")


def test_work_of_unknown_length_shows_its_time(terminal):
    with _progress.Progress("simulate") as progress:
        progress(0, 0)
    assert "simulate: 0" in terminal.getvalue()


def test_short_work_and_files_stay_clean(monkeypatch, capfd):
    dwell.Scene.read(FOUR_BAR).kinetostatics()
    monkeypatch.setattr(_progress, "SILENT", 0.0)
    dwell.sweep(dwell.Scene.read(FOUR_BAR), SHARES, ["m"])
    assert capfd.readouterr().err == ""

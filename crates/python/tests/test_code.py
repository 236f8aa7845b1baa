"""Exports, closed forms and the verification, against the command and the reduced model."""

import subprocess

import dwell
import numpy as np
import pytest
from conftest import COMMAND, TOP

FOUR_BAR = TOP / "validation/four-bar/scene.toml"


@pytest.mark.parametrize("case, target", [("four-bar", "c"), ("four-bar", "rust"), ("four-bar", "matlab"), ("five-bar", "c")])
def test_files_are_those_of_the_command(case, target, tmp_path):
    path = TOP / f"validation/{case}/scene.toml"
    written = dwell.Scene.read(path).export(target, tmp_path / "here", accuracy=1e-7)
    arguments = [COMMAND, "export", path, "--to", target, "--accuracy", "1e-7", "--out", tmp_path / "there"]
    subprocess.run(arguments, check=True, capture_output=True)
    assert len(written) >= 2
    for path in written:
        assert path.read_bytes() == (tmp_path / "there" / path.relative_to(tmp_path / "here")).read_bytes(), path


def test_exact_code_is_that_of_the_command(tmp_path):
    written = dwell.Scene.read(FOUR_BAR).export("exact-c", tmp_path / "here")
    arguments = [COMMAND, "export", FOUR_BAR, "--to", "c", "--exact", "--out", tmp_path / "there"]
    subprocess.run(arguments, check=True, capture_output=True)
    assert all(path.read_bytes() == (tmp_path / "there" / path.name).read_bytes() for path in written)


@pytest.mark.parametrize("target, options", [("fmu", []), ("exact-fmu", ["--exact"]), ("fmu2", [])])
def test_fmus_are_those_of_the_command(target, options, tmp_path):
    (written,) = dwell.Scene.read(FOUR_BAR).export(target, tmp_path / "here")
    arguments = [COMMAND, "export", FOUR_BAR, "--to", target.removeprefix("exact-"), *options, "--out", tmp_path / "there"]
    subprocess.run(arguments, check=True, capture_output=True)
    assert written.read_bytes() == (tmp_path / "there" / written.name).read_bytes()


def test_what_cannot_be_exported_says_why(tmp_path):
    with pytest.raises(dwell.SceneError, match="five-bar|freedom|actuators"):
        dwell.Scene.read(TOP / "validation/five-bar/scene.toml").export("rust", tmp_path)
    with pytest.raises(ValueError, match="'exact-c'"):
        dwell.Scene.read(FOUR_BAR).export("fortran", tmp_path)
    for accuracy in (0.0, -1.0, float("nan"), 5.0):
        with pytest.raises(dwell.DwellError, match="between 1e-14 and 1e-2"):
            dwell.Scene.read(FOUR_BAR).export("c", tmp_path, accuracy=accuracy)
    assert not list(tmp_path.iterdir())


def test_closed_forms_are_the_reduced_model():
    sympy = pytest.importorskip("sympy")
    scene = dwell.Scene.read(FOUR_BAR)
    forms = scene.symbolic("B.x")
    q = np.linspace(0, 6, 7)
    at = scene.reduce(q, ["B.x"])
    for name, values in {"m": at.m, "half_dm": at.half_dm, "a": at.a["B.x"], "b": at.b["B.x"]}.items():
        function = sympy.lambdify(forms.coordinate, forms.numeric(name))
        assert np.allclose([function(x) for x in q], values, rtol=0, atol=1e-12 * np.abs(values).max()), name
    # ½m′ is half the derivative of m, by SymPy's own rules.
    slope = sympy.lambdify(forms.coordinate, sympy.diff(forms.numeric("m"), forms.coordinate) / 2)
    assert np.allclose([slope(x) for x in q], at.half_dm, rtol=0, atol=1e-11 * np.abs(at.half_dm).max())
    # The constants are symbols with their values: a crank of another length is another four-bar.
    assert forms.meanings["m"].startswith("generalised inertia") and forms.constants[sympy.Symbol("l_1", real=True)] == 0.127
    assert forms.expressions["x_B"] == sympy.cos(forms.coordinate) * sympy.Symbol("l_1", real=True)


def test_the_words_of_a_scene_are_not_run():
    pytest.importorskip("sympy")
    text = FOUR_BAR.read_text().replace('title = "Four-bar of a textbook"', r'title = """x\"\"\" + __import__("os")\n    m = 0"""')
    forms = dwell.Scene(text).symbolic("B.x")
    plain = dwell.Scene.read(FOUR_BAR).symbolic("B.x")
    assert forms.expressions == plain.expressions and forms.constants == plain.constants and len(plain.constants) > 10
    hostile = 'def reduced(q):\n    x = __import__("os").system("true")\n    y = cos.__class__\n    z = 2.0 * cos(q)\n        "z": z,\n'
    from dwell._closed_form import closed_form

    assert set(closed_form(hostile).expressions) == {"z"}


def test_no_closed_form_says_why():
    pytest.importorskip("sympy")
    with pytest.raises(dwell.SceneError):
        dwell.Scene.read(TOP / "validation/class-three-six-bar/scene.toml").symbolic()


def test_an_installation_is_verified(tmp_path):
    printed = dwell.validate("pendulum-a01", folder=tmp_path, repository=TOP, command=str(COMMAND))
    assert "findings pass" in printed and (tmp_path / "pendulum-a01.md").exists()
    with pytest.raises(dwell.DwellError, match="there is no case|no-such-case"):
        dwell.validate("no-such-case", folder=tmp_path, repository=TOP, command=str(COMMAND))
    with pytest.raises(dwell.DwellError, match="cannot be run"):
        dwell.validate(folder=tmp_path, command="no-such-command")

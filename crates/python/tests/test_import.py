"""Models of other programs."""

import pathlib

import dwell
import pytest

FOLDER = pathlib.Path(__file__).parents[3] / "validation" / "imported"


def test_an_imported_mechanism_needs_the_torque_that_another_engine_computes() -> None:
    four_bar = dwell.import_model(FOLDER / "m1-fourbar.xml").assemble()
    assert four_bar.at(0.0, 1.2, -0.7).actuator_force("q_A") == pytest.approx(-0.584460101605, abs=1e-11)
    five_bar = dwell.import_model(
        FOLDER / "u3-fivebar.urdf", loops=FOLDER / "u3-fivebar.yaml", start={"q1": 2.2, "q2": 0.9, "p1": -1.4, "p2": 1.3}
    )
    state = five_bar.assemble().at([0.0, 0.0], [1.2, -0.8], [-0.7, 0.5])
    assert state.actuator_force("q_q2") == pytest.approx(1.313683833318, abs=1e-11)


def test_what_is_lost_is_an_error_unless_it_is_allowed() -> None:
    with pytest.raises(dwell.DwellError, match="fluid forces"):
        dwell.import_model(FOLDER / "x1-unsupported.xml")
    with pytest.warns(UserWarning, match="muscle actuator"):
        assert dwell.import_model(FOLDER / "x1-unsupported.xml", allow=True).title.startswith("x1")
    with pytest.raises(dwell.DwellError, match="give --drive"):
        dwell.import_model(FOLDER / "m4-sixbar.xml")

"""Mechanisms in space, against closed forms, against the plane and against the command."""

import dwell
import numpy as np
import pytest
from conftest import TOP

SPATIAL = TOP / "validation/spatial"
CASES = sorted(path.stem for path in SPATIAL.glob("*.toml"))
G = 9.81

PENDULUM = """
bodies.ground.points = { O = [0, 0, 0] }
bodies.bob = { points = { O = [0, 0, 0], P = [0.5, 0, 0.2] }, mass = 2.0, center = [0.5, 0, 0.2], inertia = [0.1, 0.2, 0.3] }
joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 0, 1] }
actuators.phi = { angle = "O" }
assembly.phi = 0.0
loads.weight = { gravity = [0, -9.81, 0] }
"""


def test_a_pendulum_has_its_closed_form():
    bob = dwell.Scene(PENDULUM).assemble()
    q, speed, acceleration = 0.3, 2.0, -1.5
    at = bob.at(q, speed, acceleration)
    radial, across = np.array([np.cos(q), np.sin(q), 0]), np.array([-np.sin(q), np.cos(q), 0])
    assert np.allclose(at.position("bob.P"), 0.5 * radial + [0, 0, 0.2], rtol=0, atol=1e-15)
    assert np.allclose(at.velocity("bob.P"), 0.5 * speed * across, rtol=0, atol=1e-15)
    a = 0.5 * (acceleration * across - speed**2 * radial)
    assert np.allclose(at.acceleration("bob.P"), a, rtol=0, atol=1e-14)
    assert np.allclose(at.rotation("bob")[:, 0], radial, rtol=0, atol=1e-15)
    assert at.angular_velocity("bob").tolist() == [0, 0, speed]
    assert abs(at.reaction("O.x") - 2.0 * a[0]) < 1e-12
    assert abs(at.reaction("O.y") - 2.0 * (a[1] + G)) < 1e-12
    torque = (0.3 + 2.0 * 0.25) * acceleration + 2.0 * G * 0.5 * np.cos(q)
    assert abs(at.actuator_force("phi") - torque) < 1e-12
    model = bob.reduced(["O.x"])
    found = model(np.array([[0.0, q]]))
    assert found.m.shape == (1, 2) and np.allclose(found.m, 0.8, rtol=1e-15)
    assert abs(found.w["weight"][0, 1] + 2.0 * 0.5 * np.cos(q)) < 1e-14
    table = model.table(1e-9)
    assert table.error_bound <= 1e-9 and abs(table(q).m - 0.8) < 1e-9 and abs(table(q).w["weight"] + np.cos(q)) < 1e-9
    with pytest.raises(dwell.DwellError):
        model.table(1e-30)


def test_a_mechanism_is_built_and_loaded_by_a_function():
    m = dwell.Builder("Pendulum")
    m.body("ground", O=(0, 0, 0))
    m.body("bob", O=(0, 0, 0), P=(0.5, 0, 0.2), mass=2.0, center=(0.5, 0, 0.2), inertia=(0.1, 0.2, 0.3))
    m.joint("O", revolute=("ground.O", "bob.O"), axis=(0, 0, 1)).actuator("phi", angle="O").assembly(phi=0.0)
    m.load("push", torque="bob", axis=(0, 0, 1), magnitude=(["phi", "phi.velocity"], lambda q, v: 3.0 * q - 0.5 * v), breakpoints=False)
    at = m.assemble().at(0.3, 2.0, -1.5)
    # The torque of the actuator and that of the load accelerate the bob.
    assert abs(at.actuator_force("phi") + 3.0 * 0.3 - 0.5 * 2.0 - (0.3 + 2.0 * 0.25) * -1.5) < 1e-12
    assert at.coordinate("phi") == (0.3, 2.0, -1.5)
    assert np.allclose(at.rotation("bob")[0], [np.cos(0.3), -np.sin(0.3), 0.0], rtol=0, atol=1e-15)
    with pytest.raises(dwell.DwellError, match="axes"):
        at.angle("bob")
    with pytest.raises(AttributeError, match="dwell.read"):
        dwell.space.Scene


def test_points_move_along_their_paths():
    rssr = dwell.read(SPATIAL / "rssr.toml")
    q = np.linspace(0.0, 6.0, 7)
    paths = rssr.paths(["crank.B", "rocker.C"], q)
    assert paths.shape == (7, 2, 3)
    for k, one in enumerate(q):
        assert np.array_equal(paths[k, 1], rssr.at(one).position("rocker.C"))


def test_the_equation_of_motion_is_that_of_a_pendulum():
    f, jacobian, start = dwell.Scene(PENDULUM + "motion = { duration = 3.0, initial-velocity = 1.0 }\n").assemble().rhs()
    assert start.tolist() == [0.0, 1.0]
    q = 0.3
    assert np.allclose(f(0.0, np.array([q, 2.0])), [2.0, -2.0 * G * 0.5 * np.cos(q) / 0.8], rtol=0, atol=1e-13)
    assert np.allclose(jacobian(0.0, np.array([q, 2.0])), [[0.0, 1.0], [2.0 * G * 0.5 * np.sin(q) / 0.8, 0.0]], rtol=0, atol=1e-13)


def test_a_motion_its_period_and_its_equilibria():
    text = PENDULUM + "motion = { duration = 3.0, initial-velocity = 1.0 }\n"
    bob = dwell.Scene(text).assemble()
    motion = bob.simulate(1e-9)
    assert motion.early_stop is None and motion.estimated_error <= 1e-9
    energy = motion["energy.kinetic"] + motion["energy.potential"]
    assert np.ptp(energy) < 1e-8 * motion["energy.kinetic"].max()
    found = bob.period()
    assert abs(found.energy - 0.5 * 0.8) < 1e-12
    assert [round(np.degrees(e.coordinates[0])) % 360 for e in bob.equilibria()] in ([90, 270], [270, 90])
    assert abs(bob.linearise().a[1, 0] + 2.0 * G * 0.5 / 0.8) < 1e-9
    with pytest.raises(dwell.DwellError):
        bob.cycle()


@pytest.mark.parametrize("case", CASES)
def test_columns_are_those_of_the_command(case, command, tmp_path):
    """Results equal the files of the command bit for bit."""
    path = SPATIAL / f"{case}.toml"
    mechanism = dwell.read(path)
    for name in ("kinematics", "statics"):
        ran = command(name, str(path), "--out", str(tmp_path / name), "--pictures", "none")
        if ran.returncode != 0:
            with pytest.raises(dwell.DwellError):
                getattr(mechanism, name)()
            continue
        results = getattr(mechanism, name)()
        written = np.load(next((tmp_path / name).glob("*.npz")))
        compared = [column for column in results if column in written.files]
        assert len(compared) > 3
        for column in compared:
            assert np.array_equal(written[column], results[column], equal_nan=True), (case, name, column)


def test_it_is_checked_and_exported_as_by_the_command(command, tmp_path):
    path = SPATIAL / "rssr.toml"
    scene = dwell.Scene.read(path)
    assert len(scene.check()) > 500 and command("check", str(path)).stdout.startswith(scene.check())
    written = scene.export("c", tmp_path / "here", accuracy=1e-7)
    assert command("export", str(path), "--to", "c", "--accuracy", "1e-7", "--out", str(tmp_path / "there")).returncode == 0
    assert len(written) == 2
    for file in written:
        assert file.read_bytes() == (tmp_path / "there" / file.name).read_bytes(), file
    with pytest.raises(dwell.SceneError, match="Newton"):
        scene.export("exact-c", tmp_path)


def test_it_is_drawn(tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    rssr = dwell.read(SPATIAL / "rssr.toml")
    axes = rssr.plot(0.5)
    assert axes.name == "3d" and [line.get_label() for line in axes.get_lines() if line.get_label()[0] != "_"] == list(rssr.points)[1:]
    # The coupler's line has the coupler's length.
    x, y, z = next(line for line in axes.get_lines() if line.get_label() == "coupler").get_data_3d()
    state = rssr.at(0.5)
    length = np.linalg.norm(state.position("coupler.B") - state.position("coupler.C"))
    assert abs(np.linalg.norm(np.diff([x, y, z])[:, 0]) - length) < 1e-12
    # The bodies are in the legend, and the axes of the ground in a corner.
    assert all(f">{word}<" in "".join(rssr._repr_svg_().split()) for word in [*list(rssr.points)[1:], "x", "y", "z"])
    rssr.animate(frames=4).save(tmp_path / "rssr.gif")


def test_a_sweep_varies_an_axis():
    scene = dwell.Scene.read(SPATIAL / "rssr.toml")
    found = dwell.sweep(scene, {"joints.A.axis[0]": [-0.01, 0.0]}, ["m"])
    assert found.messages == [None, None]
    largest = [scene.with_value("joints.A.axis[0]", tilt).reduce(np.linspace(0, 2 * np.pi, 7201), []).m.max() for tilt in (-0.01, 0.0)]
    assert np.allclose(found["m.max"], largest, rtol=1e-6) and largest[0] != largest[1]


def test_what_is_wrong_is_named():
    with pytest.raises(dwell.SceneError, match="revolte") as error:
        dwell.Scene(PENDULUM.replace("revolute", "revolte"))
    assert error.value.line == 4
    bricard = dwell.read(SPATIAL / "bricard-a04.toml")
    with pytest.raises(dwell.DwellError, match="redundant"):
        bricard.at(0.3).reaction("P0.x")
    with pytest.raises(dwell.DwellError, match="crank.C"):
        dwell.read(SPATIAL / "rssr.toml").at(0.3).position("crank.C")
    assert bricard.reduced().reactions

"""Results in Python against closed forms and against the command."""

import warnings

import dwell
import numpy as np
import pytest
from conftest import CASES, TOP

G = 9.81


def pendulum(**motion):
    """A bob of 2 kg at 0.5 m on a massless rod; its angle is from the horizontal."""
    m = dwell.Builder("Pendulum")
    m.body("ground", O=(0, 0))
    m.body("bob", O=(0, 0), P=(0.5, 0), mass=2.0, center="P", inertia=0.0)
    m.pin("O", "ground", "bob").actuator("phi", angle=("ground", "bob"))
    m.load("weight", gravity=(0, -G))
    return m.motion(**motion) if motion else m


def test_inverse_dynamics_is_the_closed_form():
    bob = pendulum().assemble()
    q, speed, acceleration = 0.3, 2.0, -1.5
    at = bob.at(q, speed, acceleration)
    a = 0.5 * np.array(
        [-(acceleration * np.sin(q) + speed**2 * np.cos(q)), acceleration * np.cos(q) - speed**2 * np.sin(q)]
    )
    assert abs(at.actuator_force("phi") - (2.0 * 0.25 * acceleration + 2.0 * G * 0.5 * np.cos(q))) < 1e-12
    assert abs(at.reaction("O.x") - 2.0 * a[0]) < 1e-12
    assert abs(at.reaction("O.y") - 2.0 * (a[1] + G)) < 1e-12
    assert np.allclose(at.acceleration("bob.P"), a, rtol=0, atol=1e-14)
    assert at.coordinate("phi") == (q, speed, acceleration)


def test_the_reduced_model_is_that_of_single_positions(slider):
    q = np.linspace(-3.0, 9.0, 60).reshape(3, 4, 5)
    at = slider.reduce(q, ["A", "guide.normal"])
    assert at.m.shape == q.shape and set(at.a) == {"A.x", "A.y", "guide.normal"} and set(at.w) == {"weight", "gas"}
    one = slider.reduced(["A", "guide.normal"])(q[1, 2, 3])
    assert one.m.shape == () and one.m == at.m[1, 2, 3] and one.c["gas"]["A.x"] == at.c["gas"]["A.x"][1, 2, 3]
    # The torque of the equation of motion, and a reaction, are those of the inverse dynamics without time-dependent loads.
    state = slider.at(q[1, 2, 3], 150.0, 20.0)
    gas = 400 * (1 + np.cos(q[1, 2, 3]))
    torque = one.m * 20 + one.half_dm * 150**2 - one.w["weight"] * G - one.w["gas"] * gas
    assert abs(torque - state.actuator_force("phi")) < 1e-9
    normal = one.a["guide.normal"] * 20 + one.b["guide.normal"] * 150**2
    normal += one.c["weight"]["guide.normal"] * G + one.c["gas"]["guide.normal"] * gas
    assert abs(normal - state.reaction("guide.normal")) < 1e-9


def test_paths_are_those_of_single_positions(slider, single_dwell):
    for mechanism, names in ((slider, ["crank.B", "piston.C"]), (single_dwell, ["coupler.P"])):
        q = np.linspace(-3.0, 9.0, 24).reshape(4, 6)
        paths = mechanism.paths(names, q)
        assert paths.shape == (4, 6, len(names), 2)
        for k, name in enumerate(names):
            single = [[mechanism.at(value).position(name) for value in row] for row in q]
            assert np.array_equal(paths[:, :, k], single)
            assert np.array_equal(mechanism.paths(name, q), paths[:, :, k])
    # The crank's pin runs on a circle.
    assert np.allclose(slider.paths("crank.B", 0.7), 0.08 * np.array([np.cos(0.7), np.sin(0.7)]), rtol=0, atol=1e-15)
    with pytest.raises(dwell.DwellError, match="crank.X"):
        slider.paths("crank.X", 0.0)


def test_paths_of_two_coordinates():
    arm = dwell.read(str(TOP / "validation/double-pendulum/scene.toml"))
    body, points = [item for item in arm.points.items() if item[0] != "ground"][-1]
    name, q = f"{body}.{points[-1]}", np.array([[0.1, 0.2], [0.3, -0.4], [2.0, 1.0]])
    assert np.array_equal(arm.paths(name, q), [arm.at(row).position(name) for row in q])
    with pytest.raises(ValueError, match="2 actuators"):
        arm.paths(name, [0.1, 0.2, 0.3])


def test_arrays_come_as_they_are_given(slider):
    reduced = slider.reduced([])
    q = np.linspace(0, 6, 1001)
    whole = reduced(q)
    assert np.array_equal(reduced(q[::2]).m, whole.m[::2])
    assert np.array_equal(reduced(list(q)).m, whole.m)
    assert np.array_equal(reduced(q.astype(np.float32).astype(float), threads=1).m, reduced(q.astype(np.float32)).m)
    assert reduced([]).m.shape == (0,)
    assert np.array_equal(reduced(q, threads=1).m, whole.m) and np.array_equal(reduced(q, threads=2).half_dm, whole.half_dm)


def test_a_table_keeps_its_bound(slider):
    reduced = slider.reduced(["A"])
    table = reduced.table(1e-8)
    q = np.linspace(0.1, 6.1, 37)
    exact = reduced(q)
    scale = np.abs(exact.b["A.x"]).max()
    assert table.error_bound <= 1e-8
    assert max(abs(table(x).b["A.x"] - b) for x, b in zip(q, exact.b["A.x"])) < 1e-8 * scale
    assert "dwell" in table.to_text()


def test_small_oscillations_and_dense_output():
    motion = pendulum(duration=1.0, initial_coordinate={"phi": -np.pi / 2 + 1e-4}).assemble().simulate(1e-10)
    assert motion.early_stop is None and motion.estimated_error < 1e-10
    t = np.linspace(0, 1, 777)
    expected = -np.pi / 2 + 1e-4 * np.cos(np.sqrt(G / 0.5) * t)
    assert np.abs(motion(t)["phi"] - expected).max() < 1e-11
    with pytest.raises(ValueError, match="lasts from"):
        motion(1.5)


def test_a_function_does_what_its_expression_does():
    def build(magnitude, **given):
        m = pendulum(duration=1.0, initial_coordinate={"phi": 0.3})
        return m.load("spring", torque="bob", magnitude=magnitude, **given).assemble().simulate(1e-8)

    one = build("-6*phi - 0.8*phi.velocity^3")
    two = build((["phi", "phi.velocity"], lambda q, v: -6 * q - 0.8 * v**3), breakpoints=False)
    assert np.abs(one["phi"] - two["phi"]).max() < 1e-12
    with pytest.warns(UserWarning, match="step over"):
        build((["phi"], lambda q: 0.0 * q))


def test_a_function_with_named_jumps_does_what_its_expression_does():
    def build(magnitude, **given):
        m = pendulum(duration=1.0, initial_coordinate={"phi": 0.3})
        return m.load("brake", torque="bob", magnitude=magnitude, **given).assemble().simulate(1e-8)

    jumps = {"phi.velocity": [-2.0, 1], "t": [0.4]}
    one = build("if(phi.velocity < -2, 5, 0) + if(phi.velocity < 1, 0, -3) + if(t < 0.4, 1, -1)")
    two = build(
        (["phi.velocity", "t"], lambda v, t: 5 * (v < -2) - 3 * (v >= 1) + (1 if t < 0.4 else -1)), breakpoints=jumps
    )
    assert np.abs(one["phi"] - two["phi"]).max() < 1e-12
    with pytest.raises(dwell.SceneError, match="breakpoints .* of `q`"):
        build((["t"], lambda t: t), breakpoints={"q": [1.0]})


def test_a_function_that_fails_says_which_load():
    m = pendulum(duration=1.0)
    m.load("broken", torque="bob", magnitude=(["t"], lambda t: 1 / 0), breakpoints=False)
    with pytest.raises(dwell.DwellError, match="broken"):
        m.assemble().simulate(1e-6)


def test_equilibrium_linear_motion_and_period():
    bob = pendulum(duration=1.0, initial_coordinate={"phi": -np.pi / 2 + 0.1}).assemble()
    omega = np.sqrt(G / 0.5)
    hanging = next(e for e in bob.equilibria() if e.stability == "centre")
    assert abs(hanging.modes[0][0] - omega) < 1e-9
    linear = bob.linearise()
    assert linear.states == ["phi [rad]", "phi.velocity [rad/s]"] and linear.b.shape == (2, 0)
    assert abs(linear.a[1, 0] + omega**2) < 1e-9
    # T = 4 K(sin(θ₀/2)) / ω, the elliptic integral by the arithmetic-geometric mean.
    a, b = 1.0, np.cos(0.05)
    for _ in range(6):
        a, b = (a + b) / 2, np.sqrt(a * b)
    assert abs(bob.period().period - 2 * np.pi / a / omega) < 1e-13


def test_a_gradient_is_homogeneous_in_the_masses():
    (inertia,) = pendulum(duration=1.0).assemble().gradient(["m.max"])
    of_masses = [inertia[p] * v for p, v in zip(inertia.paths, inertia.values) if p.endswith((".mass", ".inertia"))]
    assert abs(sum(of_masses) - inertia.value) < 1e-12 * inertia.value
    assert inertia["nothing"] == 0.0 and np.all(inertia.errors == 0.0)


def test_the_published_period(single_dwell):
    assert abs(single_dwell.period().period - 5.41966267706427) < 1e-12


def test_own_integrators_take_the_equation_of_motion(single_dwell):
    integrate = pytest.importorskip("scipy.integrate")
    f, jacobian, y = single_dwell.rhs()
    own = integrate.solve_ivp(f, (0, 5.0), y, method="Radau", jac=jacobian, rtol=1e-11, atol=1e-12)
    ours = single_dwell.simulate(1e-10)
    assert abs(own.y[0, -1] - ours(5.0)["phi"]) < 1e-8
    # The Jacobian, by central differences.
    y, h = np.array([0.7, 1.3]), 1e-6
    columns = [(f(0.0, y + h * e) - f(0.0, y - h * e)) / (2 * h) for e in np.eye(2)]
    assert np.allclose(jacobian(0.0, y), np.array(columns).T, rtol=0, atol=1e-8)


def test_errors_point_into_the_scene():
    text = 'bodies.ground.points = { A = [0, 0] }\nbodies.bar.points = { A = [0, 0] }\njoints.A = { revolute = ["ground.A", "baar.A"] }\n'
    with pytest.raises(dwell.SceneError) as raised:
        dwell.Scene(text)
    assert (raised.value.line, raised.value.column) == (3, 38)
    assert "baar" in str(raised.value) and "╭─" in str(raised.value) and "bar" in raised.value.help
    with pytest.raises(dwell.SceneError, match="no file"):
        dwell.Scene.read("nothing.toml")
    with pytest.raises(dwell.DwellError, match="did you mean|guide"):
        dwell.read(str(TOP / "docs/slider.toml")).at(0.0).reaction("guide.norml")
    with pytest.raises(dwell.DwellError, match="one for each actuator"):
        dwell.read(str(TOP / "docs/slider.toml")).at([0.0, 1.0])
    with pytest.raises(ValueError, match="twice"):
        pendulum().load("weight", gravity=(0, 1))
    with pytest.raises(TypeError, match="cannot stand in a scene"):
        pendulum().load("odd", torque="bob", magnitude=object()).to_toml()
    with pytest.raises(dwell.DwellError, match="no method"):
        pendulum(duration=1.0).assemble().simulate(method="euler")


def test_a_mechanism_shows_itself(slider):
    from xml.etree import ElementTree

    ElementTree.fromstring(slider._repr_svg_())
    m = pendulum()
    m.title = '<script>alert(1)</script>&"'
    picture = m.assemble()._repr_svg_()
    ElementTree.fromstring(picture)
    assert "<script" not in picture


def test_results_know_their_units(slider):
    results = slider.kinetostatics()
    assert results.units["phi.actuator_force"] == "N m" and len(results["t"]) == 361
    assert abs(np.abs(results["phi.actuator_force"]).max() - 128.076) < 1e-3
    with pytest.raises(KeyError, match="did you mean"):
        results["phi.actuator_forc"]
    pandas = pytest.importorskip("pandas")
    assert isinstance(results.to_pandas(), pandas.DataFrame)


def test_a_sweep_is_that_of_single_scenes():
    scene = dwell.Scene.read(TOP / "docs/slider.toml")
    swept = dwell.sweep(scene, {"rod.mass": [0.9, 1.2, 1.5]}, ["m.max"])
    for mass, largest in zip(swept["rod.mass"], swept["m.max"]):
        m = scene.with_value("rod.mass", mass).reduce(np.linspace(0, 2 * np.pi, 20001), []).m.max()
        assert 0 <= largest - m < 1e-7 * m
    assert swept.messages == [None] * 3


def test_other_threads_go_on():
    import threading

    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1

    counter = threading.Thread(target=count)
    counter.start()
    pendulum(duration=2000.0, initial_coordinate={"phi": 0.3}).assemble().simulate(method="tr-bdf2", tolerance=1e-7)
    done.set()
    counter.join()
    assert counted[0] > 10000


@pytest.mark.parametrize("case", CASES)
def test_columns_are_those_of_the_command(case, command, tmp_path):
    """Kinetostatics and simulate of every case equal the files of the command bit for bit."""
    path = TOP / "validation" / case / "scene.toml"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mechanism = dwell.read(str(path))
    for name, compute in [("kinetostatics", mechanism.kinetostatics), ("simulate", mechanism.simulate)]:
        ran = command(name, str(path), "--out", str(tmp_path / name), "--pictures", "none")
        tables = sorted((tmp_path / name).glob("*.npz")) if (tmp_path / name).exists() else []
        if ran.returncode == 2 or not tables:
            with pytest.raises((dwell.DwellError, ValueError)):
                compute()
            continue
        try:
            results = compute()
        except dwell.DwellError:
            assert ran.returncode == 1
            continue
        written = np.load(tables[0])
        for column, values in results.items():
            key = column if column in written.files else None
            if key is not None:
                assert np.array_equal(written[key], values, equal_nan=True), (case, name, column)
        assert any(column in written.files for column in results)

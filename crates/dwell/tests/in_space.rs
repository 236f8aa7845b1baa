//! Mechanisms in space by the same calls: built in a program, with loads of its own, against scene files and expressions.
#![allow(clippy::unwrap_used, reason = "a test")]

use dwell::{
    Actuator, Error, Joint, Load, Magnitude, Mechanism, Motion, MotionResults, Scene, Solver,
};

/// The spatial crank-rocker of `validation/spatial/rssr.toml`, with a load on its crank.
fn rssr(brake: impl Into<Magnitude>) -> Result<Mechanism, Error> {
    let mut m = Mechanism::builder("Spatial crank-rocker with two balls");
    m.ground()
        .point("A", [0.0, 0.0, 0.0])
        .point("D", [0.25, 0.06, -0.04]);
    let crank = m.body("crank").point("A", [0.0, 0.0, 0.0]);
    let inertia = [0.0004, 0.0011, 0.0013, -0.0001, 5e-5, 8e-5];
    crank
        .point("B", [0.1, 0.0, 0.0])
        .mass(0.8, [0.04, 0.01, 0.005], inertia);
    let coupler = m.body("coupler").point("B", [0.0, 0.0, 0.0]);
    let inertia = [0.0002, 0.0045, 0.0045];
    coupler
        .point("C", [0.3, 0.0, 0.0])
        .mass(0.6, [0.14, 0.0, 0.0], inertia);
    let rocker = m.body("rocker").point("C", [0.25, 0.0, 0.0]);
    let inertia = [0.0006, 0.005, 0.0054, 0.0003, -0.0002, 0.0001];
    rocker
        .point("D", [0.0, 0.0, 0.0])
        .mass(0.9, [0.12, 0.02, -0.01], inertia);
    m.joint(
        "A",
        Joint::revolute("ground.A", "crank.A").with("axis", [0.0, 0.0, 1.0]),
    );
    m.joint("B", Joint::spherical("crank.B", "coupler.B"));
    m.joint("C", Joint::spherical("coupler.C", "rocker.C"));
    m.joint(
        "D",
        Joint::revolute("ground.D", "rocker.D").with("axis", [0.0, 1.0, 0.0]),
    );
    m.actuator("q", Actuator::joint_angle("A"));
    m.assembly("q", 0.0);
    m.placement("coupler", [0.1, 0.0, 0.0], [0.2476, -0.7121, 0.3176]);
    m.placement("rocker", [0.25, 0.06, -0.04], [0.0, -1.3127, 0.0]);
    m.load("weight", Load::gravity([0.0, 0.0, -9.81]));
    m.load(
        "brake",
        Load::torque("crank", brake).with("axis", [0.0, 0.0, 1.0]),
    );
    m.motion(Motion::seconds(1.0).initial_velocity("q", 12.0));
    m.assemble()
}

#[test]
fn what_a_program_builds_is_the_mechanism_of_the_file() {
    let built = rssr(0.0).unwrap();
    let read = Scene::read("../../validation/spatial/rssr.toml").unwrap();
    let read = read.assemble().unwrap();
    assert_eq!(built.dimension(), 3);
    for k in 0..12 {
        let q = 0.5 * f64::from(k);
        let [built, read] =
            [&built, &read].map(|m| m.inverse_dynamics(0.0, &[q], &[3.0], &[-2.0]).unwrap());
        for name in ["A.x", "B.z", "C.y", "D.moment-z"] {
            assert_eq!(built.reaction(name).unwrap(), read.reaction(name).unwrap());
        }
        // The length of the force in a ball.
        let parts = ["B.x", "B.y", "B.z"].map(|name| built.reaction(name).unwrap());
        let length = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!((built.reaction("B.magnitude").unwrap() - length).abs() < 1e-12 * length);
    }
}

/// The largest difference of two motions in a column, as a part of its largest value.
fn difference(one: &MotionResults, other: &MotionResults, column: &str) -> f64 {
    let [one, other] = [one, other].map(|motion| motion.column(column).unwrap());
    assert_eq!(one.len(), other.len());
    let largest = one.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    let pairs = one.iter().zip(&other);
    pairs.fold(0.0_f64, |max, (a, b)| max.max((a - b).abs())) / largest
}

#[test]
fn a_load_of_the_program_is_that_of_the_expression() {
    let solver = Solver::accuracy(1e-8).sample_interval(0.01);
    let expected = rssr("if(q.velocity > 9, -2, -0.5)").unwrap();
    let brake = Magnitude::function(&["q.velocity"], |s| if s[0] > 9.0 { -2.0 } else { -0.5 });
    let own = rssr(brake.breakpoints("q.velocity", &[9.0])).unwrap();
    let [expected, own] = [expected, own].map(|m| m.simulate(&solver).unwrap());
    assert!(own.early_stop.is_none());
    for column in ["q", "q.velocity", "B.x", "energy.kinetic"] {
        let off = difference(&expected, &own, column);
        assert!(off < 1e-12, "{column} differs by {off:e}");
    }
}

#[test]
fn the_equation_of_motion_conserves_energy() {
    let free = rssr(0.0).unwrap();
    let mut equation = free.equation_of_motion().unwrap();
    let energy = |free: &Mechanism, y: &[f64]| {
        let m = free.reduced([]).unwrap().at(y[0]).unwrap().m;
        let at = free.kinematics(&[y[0]], &[y[1]], &[0.0]).unwrap();
        let heights = [("crank", 0.8), ("coupler", 0.6), ("rocker", 0.9)];
        let centers = [[0.04, 0.01, 0.005], [0.14, 0.0, 0.0], [0.12, 0.02, -0.01]];
        let origins = ["crank.A", "coupler.B", "rocker.D"];
        let potential = heights.iter().zip(centers).zip(origins);
        let potential = potential.map(|(((body, mass), center), origin)| {
            let [_, _, z] = at.position(origin).unwrap();
            let axes = at.axes(body).unwrap();
            let lifted: f64 = (0..3).map(|k| axes[k][2] * center[k]).sum();
            mass * 9.81 * (z + lifted)
        });
        0.5 * m * y[1] * y[1] + potential.sum::<f64>()
    };
    // The fourth-order method of Runge and Kutta, with steps of 1 ms.
    let mut y = equation.initial_state();
    let start = energy(&free, &y);
    let dt = 1e-3;
    for k in 0..400 {
        let t = f64::from(k) * dt;
        let shifted = |y: &[f64], rates: &[f64], by: f64| -> Vec<f64> {
            y.iter().zip(rates).map(|(y, rate)| y + by * rate).collect()
        };
        let k1 = equation.rates(t, &y).unwrap().to_vec();
        let k2 = shifted(&y, &k1, 0.5 * dt);
        let k2 = equation.rates(t + 0.5 * dt, &k2).unwrap().to_vec();
        let k3 = shifted(&y, &k2, 0.5 * dt);
        let k3 = equation.rates(t + 0.5 * dt, &k3).unwrap().to_vec();
        let k4 = shifted(&y, &k3, dt);
        let k4 = equation.rates(t + dt, &k4).unwrap().to_vec();
        for (i, y) in y.iter_mut().enumerate() {
            *y += dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    let end = energy(&free, &y);
    assert!(
        (end - start).abs() < 1e-7 * start.abs(),
        "{start} J became {end} J"
    );
}

#[test]
fn what_a_vector_does_not_have_is_refused_by_name() {
    let rssr = rssr(0.0).unwrap();
    let at = rssr.positions(&[0.3]).unwrap();
    let text = |error: Error| error.to_string();
    let two = at.position::<2>("crank.B").map_err(text);
    assert_eq!(
        two,
        Err("2 numbers asked of a vector, where 3 can be given".to_owned())
    );
    let angle = at.angle("crank").map_err(text);
    assert!(angle.unwrap_err().contains("`axes` has its orientation"));
    let form = rssr.scene().closed_form(dwell::Language::C, None);
    assert!(form.unwrap_err().to_string().contains("in space"));
}

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
    let said = "a vector was taken as 2 components, but it has 3".to_owned();
    assert_eq!(two, Err(said.clone()));
    assert_eq!(
        at.angular_velocity::<2>("crank").map_err(text),
        Err(said.clone())
    );
    // Also where there is nothing to compute.
    assert_eq!(rssr.paths::<2>(["crank.B"], &[]).map_err(text), Err(said));
    let angle = at.angle("crank").map_err(text);
    assert!(angle.unwrap_err().contains("`axes` has its orientation"));
    let form = rssr.scene().closed_form(dwell::Language::C, None);
    assert!(form.unwrap_err().to_string().contains("in space"));
    let slider = Scene::read("../../docs/slider.toml").unwrap();
    let slider = slider.assemble().unwrap();
    let at = slider.positions(&[0.3]).unwrap();
    for error in [
        at.position::<1>("crank.B").map(drop),
        at.position::<4>("crank.B").map(drop),
        at.angular_velocity::<2>("crank").map(drop),
    ] {
        assert!(matches!(error, Err(Error::Components { .. })));
    }
}

/// Points of several coordinates follow one another as the coordinates do.
#[test]
fn paths_of_several_coordinates_are_the_positions() {
    let governor = Scene::read("../../validation/spatial/governor.toml").unwrap();
    let governor = governor.assemble().unwrap();
    let start = governor.start();
    let q: Vec<f64> = (0..4)
        .flat_map(|k| [start[0] + 0.4 * f64::from(k), start[1]])
        .collect();
    let names: Vec<String> = governor
        .points()
        .into_iter()
        .skip(1)
        .filter_map(|(body, points)| Some(format!("{body}.{}", points.first()?)))
        .collect();
    let wanted = || names.iter().map(String::as_str);
    let paths: Vec<[f64; 3]> = governor.paths(wanted(), &q).unwrap();
    assert_eq!(paths.len(), 4 * names.len());
    for (k, q) in q.chunks(2).enumerate() {
        let at = governor.positions(q).unwrap();
        for (i, name) in wanted().enumerate() {
            assert_eq!(paths[k * names.len() + i], at.position(name).unwrap());
        }
    }
}

/// Parallel cranks: the third is redundant.
#[test]
fn what_redundant_constraints_share_is_left_out_or_refused() {
    let cranks = Scene::read("../../validation/parallelogram-three-cranks/scene.toml").unwrap();
    let cranks = cranks.assemble().unwrap();
    let determined = cranks.determined_reactions();
    let open: Vec<String> = cranks
        .reactions()
        .into_iter()
        .filter(|r| !determined.contains(r))
        .collect();
    assert!(!open.is_empty());
    let refused = cranks.reduced([&open[0][..]]).map(drop).unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("redundant constraints share the load"),
        "{refused}"
    );
    let all = cranks
        .reduced(determined.iter().map(String::as_str))
        .unwrap();
    assert_eq!(all.reactions(), determined);
    let unknown = cranks
        .reduced(["nowhere"])
        .map(drop)
        .unwrap_err()
        .to_string();
    let joint = cranks.reactions()[0].split('.').next().unwrap().to_owned();
    assert_eq!(
        unknown.matches(&format!("`{joint}`")).count(),
        1,
        "{unknown}"
    );
    // The axes of a body in the plane turn about z.
    let at = cranks.positions(&cranks.start()).unwrap();
    let (body, _) = cranks.points()[1];
    let [x, y, z] = at.axes(body).unwrap();
    let angle = at.angle(body).unwrap();
    assert!((x[0] - angle.cos()).abs() < 1e-15 && (x[1] - angle.sin()).abs() < 1e-15);
    assert!(y == [-x[1], x[0], 0.0] && z == [0.0, 0.0, 1.0]);
}

/// Many coordinates at once have the values of one after the other, and the first that cannot be reached is named.
#[test]
fn a_batch_is_the_same_as_one_by_one() {
    let rssr = rssr("if(q.velocity > 9, -2, -0.5)").unwrap();
    let reduced = rssr.reduced(["B", "D.moment-z"]).unwrap();
    let q: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k)).collect();
    let batch = reduced.batch(&q).unwrap();
    let [reactions, loads] = [reduced.reactions().len(), reduced.loads().len()];
    for (k, &q) in q.iter().enumerate() {
        let at = reduced.at(q).unwrap();
        assert_eq!((batch.m[k], batch.half_dm[k]), (at.m, at.half_dm));
        assert_eq!(batch.a[k * reactions..][..reactions], at.a);
        assert_eq!(batch.w[k * loads..][..loads], at.w);
        let c: Vec<f64> = at.c.into_iter().flatten().collect();
        assert_eq!(batch.c[k * loads * reactions..][..loads * reactions], c);
    }
    // The linkage of Bricard has limits: the first coordinate beyond them is named.
    let bricard = Scene::read("../../validation/spatial/bricard-a04.toml").unwrap();
    let bricard = bricard.assemble().unwrap();
    let (low, high) = bricard.limits().unwrap();
    let beyond = |k: u32| low + (high - low) * (0.1 + 0.02 * f64::from(k));
    let beyond: Vec<f64> = (0..60).map(beyond).collect();
    let error = bricard.reduced([]).unwrap().batch(&beyond).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("3.74897 rad is outside its range"),
        "{error}"
    );
}

/// The function stays where a number of the scene changes, and an error names the load.
#[test]
fn a_function_survives_another_number_of_the_scene() {
    let brake = Magnitude::function(&["q.velocity"], |s| -0.1 * s[0]);
    let scene = rssr(brake.clone()).unwrap().scene().clone();
    let heavier = scene
        .with_value("crank.mass", 1.6)
        .unwrap()
        .assemble()
        .unwrap();
    let at = |m: &Mechanism| m.inverse_dynamics(0.0, &[0.3], &[5.0], &[0.0]).unwrap();
    let without = rssr(0.0)
        .unwrap()
        .scene()
        .with_value("crank.mass", 1.6)
        .unwrap();
    let without = without.assemble().unwrap();
    let [loaded, free] = [&heavier, &without].map(|m| at(m).actuator_force("q").unwrap());
    // The actuator carries the brake's torque.
    assert!((loaded - free - 0.5).abs() < 1e-12);
    let text = |error: Error| error.to_string();
    let unknown = scene
        .with_magnitude("break", &brake)
        .map(drop)
        .map_err(text);
    assert!(unknown.unwrap_err().contains("there is no load `break`"));
    let other = Magnitude::function(&["p.velocity"], |s| s[0]);
    let other = scene
        .with_magnitude("brake", &other)
        .map(drop)
        .map_err(text);
    assert!(other.unwrap_err().contains("depends on `p.velocity`"));
}

/// The Jacobian is the difference of the rates.
#[test]
fn the_jacobian_is_the_slope_of_the_rates() {
    let braked = rssr("-0.1*q.velocity").unwrap();
    let mut equation = braked.equation_of_motion().unwrap();
    // The coordinate, its velocity, and the work of the brake.
    let y = [0.7, 4.0, 0.0];
    let jacobian = equation.jacobian(0.0, &y).unwrap();
    let step = 1e-6;
    for column in 0..3 {
        let mut at = |by: f64| {
            let mut y = y;
            y[column] += by;
            equation.rates(0.0, &y).unwrap().to_vec()
        };
        let [above, below] = [at(step), at(-step)];
        for row in 0..3 {
            let slope = (above[row] - below[row]) / (2.0 * step);
            let found = jacobian[3 * row + column];
            assert!(
                (found - slope).abs() < 1e-6 * (1.0 + slope.abs()),
                "{row} {column}: {found} {slope}"
            );
        }
    }
    assert!(matches!(
        equation.rates(0.0, &[1.0]),
        Err(Error::State { .. })
    ));
}

//! Free motions under loads and drives, against closed forms, published values and their own Jacobian.

use dwell_dynamics::{
    CoordinateMode, DenseOutput, Machine, MachineOde, Method, OdeState, OdeSystem, Options,
    StepControl, integrate,
};
use dwell_kinetostatics::{
    Drive, DriveKind, Friction, FrictionContact, Guide, Load, LoadKind, LoadShape as _,
    MachineModel as _, Magnitude, Model, Motor, SpeedController, Strength,
};
use dwell_scene::PlaneScene;
use dwell_tests::cases::CASES;
use dwell_tests::fixtures::scene;

/// The machine of a scene, all coordinates free, with more loads and drives.
pub(crate) fn machine(scene: &PlaneScene, more: &[Load], drives: &[Drive]) -> Machine {
    let loads = [&scene.loads, more].concat();
    let start = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[]).expect("a model");
    let free = vec![CoordinateMode::Free; model.plan().actuators()];
    Machine::new(model, &loads, free, drives).expect("a machine")
}

/// The state at a time.
pub(crate) fn final_state(
    machine: &Machine,
    y: &[f64],
    until: f64,
    method: Method,
    tolerance: f64,
) -> Vec<f64> {
    let mut ode = MachineOde::new(machine, 0.0, y).expect("a start");
    let start = OdeState {
        t: 0.0,
        y: y.to_vec(),
    };
    let options = Options::new(method, tolerance);
    let mut observer = |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
    let termination =
        integrate(&mut ode, &start, Some(until), &options, &mut observer).expect("a run");
    assert_eq!(termination.error, None);
    println!(
        "{} {tolerance:e}: {:?}",
        method.name(),
        termination.statistics
    );
    termination.state.y
}

pub(crate) fn parse(text: &str) -> PlaneScene {
    PlaneScene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e:?}"))
}

/// What a machine without loads does by its two unit runs alone is what inverse dynamics and its mass matrix say, and so is the
/// Jacobian.
#[test]
fn without_loads_the_unit_runs_are_enough() {
    let mut largest = [0.0_f64; 2];
    for case in CASES {
        let scene = case.scene();
        let start = scene.assembly.to_configuration();
        let model = Model::new(&scene.mechanism, &scene.masses, &start, &[]).expect("a model");
        let q = scene.assembly.coordinates[0];
        for flywheel in [0.0, 0.04] {
            let machine = Machine::new(model.clone(), &[], vec![CoordinateMode::Free], &[]);
            let machine = machine.expect("a machine").with_flywheel(0, flywheel);
            // With a load that is zero it is evaluated as any other machine.
            let nothing = Load {
                name: "nothing".to_owned(),
                kind: LoadKind::Gravity {
                    direction: dwell_geometry::vec2(1.0, 0.0),
                },
                magnitude: Magnitude::Constant(0.0),
            };
            let loaded = Machine::new(model.clone(), &[nothing], vec![CoordinateMode::Free], &[]);
            let loaded = loaded.expect("a machine").with_flywheel(0, flywheel);
            for q_dot in [-2.5, 0.0, 1.3] {
                let y = [q, q_dot];
                let values = [&machine, &loaded].map(|machine| {
                    let mut ode = MachineOde::new(machine, 0.0, &y).expect("a start");
                    let (mut rates, mut jacobian) = ([0.0; 2], [0.0; 4]);
                    ode.rhs(0.0, &y, &mut rates).expect("rates");
                    ode.jacobian(0.0, &y, &mut jacobian).expect("a Jacobian");
                    (rates, jacobian)
                });
                let [(one, of_one), (two, of_two)] = values;
                let relative = |a: &[f64], b: &[f64]| {
                    let scale = b.iter().fold(1e-300, |scale: f64, b| scale.max(b.abs()));
                    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs() / scale);
                    differences.fold(0.0, f64::max)
                };
                largest[0] = largest[0].max(relative(&one, &two));
                largest[1] = largest[1].max(relative(&of_one, &of_two));
            }
        }
    }
    println!("{largest:?}");
    assert!(largest[0] < 1e-14 && largest[1] < 1e-13, "{largest:?}");
}

/// Andrews' squeezer at 0.03 s against the 25-digit values of an energy quadrature.
#[test]
fn val_squeezer() {
    let scene = scene("andrews");
    let machine = machine(&scene, &[], &[]);
    let y = machine.initial_state(&scene.assembly.coordinates, &[0.0]);
    let (beta, speed) = (15.810_771_195_153_707_f64, 1_139.920_302_259_106_f64);
    // Measured errors of angle (rad) and speed: 4e-12 and 6e-14, 7e-10 and 2e-11, 8e-8 and 2e-9, 8e-6 and 3e-7.
    for (method, tolerance, bounds) in [
        (Method::Dop853, 1e-13, [1e-10, 2e-12]),
        (Method::Tsit45, 1e-13, [1e-10, 2e-12]),
        (Method::Bdf, 1e-13, [1e-9, 1e-10]),
        (Method::Esdirk34, 1e-11, [2e-7, 1e-8]),
        (Method::TrBdf2, 1e-9, [3e-5, 1e-6]),
    ] {
        let end = final_state(&machine, &y, 0.03, method, tolerance);
        println!(
            "{} {:e} {:e}",
            method.name(),
            end[0] - beta,
            end[1] / speed - 1.0
        );
        assert!(
            (end[0] - beta).abs() < bounds[0],
            "{} {:e}",
            method.name(),
            end[0] - beta
        );
        assert!(
            (end[1] / speed - 1.0).abs() < bounds[1],
            "{} {}",
            method.name(),
            end[1]
        );
        // The motor's torque is constant: its work is that times the angle.
        let work = 0.033 * (end[0] - y[0]);
        // It is integrated beside it, linearly: rounding, by every method.
        assert!((end[2] - work).abs() < 1e-13, "{} {work}", end[2]);
    }
}

pub(crate) const DOUBLE: &str = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.one]
points = { A = [0, 0], B = [0.6, 0] }
mass = 1.3
center = [0.35, 0]
inertia = 0.05
[bodies.two]
points = { B = [0, 0] }
mass = 0.8
center = [0.25, 0]
inertia = 0.02
[joints]
A = { revolute = ["ground.A", "one.A"] }
B = { revolute = ["one.B", "two.B"] }
[actuators.p]
angle = ["ground", "one"]
[actuators.q]
angle = ["ground", "two"]
[assembly]
p = 0.4
q = -0.3
[loads]
weight = { gravity = [0, -9.81] }
"#;

/// A double pendulum in absolute angles against its equations of motion written by hand:
/// α θ₁″ + β cos(θ₁−θ₂) θ₂″ + β sin(θ₁−θ₂) θ₂′² = −g (m₁ c₁ + m₂ l) cos θ₁, and the like.
#[test]
fn a_double_pendulum_by_hand() {
    let scene = parse(DOUBLE);
    let machine = machine(&scene, &[], &[]);
    let y = [0.4, -0.3, 1.7, -2.2];
    let mut ode = MachineOde::new(&machine, 0.0, &y).expect("a start");
    let mut rates = [0.0; 4];
    ode.rhs(0.0, &y, &mut rates).expect("rates");
    let (m1, c1, i1, l, m2, c2, i2, g) = (1.3, 0.35, 0.05, 0.6, 0.8, 0.25, 0.02, 9.81);
    let alpha = i1 + m1 * c1 * c1 + m2 * l * l;
    let (beta, gamma) = (m2 * l * c2, i2 + m2 * c2 * c2);
    let (s, c) = (y[0] - y[1]).sin_cos();
    let f1 = -beta * s * y[3] * y[3] - g * (m1 * c1 + m2 * l) * y[0].cos();
    let f2 = beta * s * y[2] * y[2] - g * m2 * c2 * y[1].cos();
    let determinant = alpha * gamma - beta * beta * c * c;
    let expected = [
        (gamma * f1 - beta * c * f2) / determinant,
        (alpha * f2 - beta * c * f1) / determinant,
    ];
    for (rate, expected) in rates[2..].iter().zip(expected) {
        assert!((rate / expected - 1.0).abs() < 1e-13, "{rate} {expected}");
    }
    // Nothing is lost: kinetic and potential energy stay.
    let mut workspace = machine.workspace();
    let state = machine.evaluate(0.0, &y, &mut workspace).expect("a state");
    let before: f64 = state.energy().iter().sum();
    let end = final_state(&machine, &y, 5.0, Method::Tsit45, 1e-13);
    let state = machine
        .evaluate(5.0, &end, &mut workspace)
        .expect("a state");
    let after: f64 = state.energy().iter().sum();
    // Tsit45 errs by some tens of its tolerance of the energies exchanged, about 10 J.
    assert!((after - before).abs() < 1e-10, "{before} {after}");
}

/// A double pendulum with every kind of load and drive at once, and a state of it.
pub(crate) fn everything() -> (Machine, Vec<f64>) {
    let text = DOUBLE.to_owned()
        + r#"
spring = { spring = ["ground.A", "two.B"], stiffness = "40 + 5*sin(p)*q.velocity", free-length = 0.1 }
drag = { rotational-damper = ["one", "two"], damping = 0.3 }
push = { torque = "two", magnitude = { table = [[-4, 1], [0, 2], [4, -1]], of = "q.velocity" } }
"#;
    let scene = parse(&text);
    let friction = |name: &str, j: usize| Load {
        name: name.to_owned(),
        kind: LoadKind::couple(scene.mechanism.joints[j].bodies),
        magnitude: Magnitude::Friction(Friction {
            joint: dwell_geometry::JointId(j),
            coefficient: 0.4,
            static_coefficient: 0.4,
            contact: FrictionContact::Pin { radius: 0.05 },
            regularization_speed: Some(1.5),
        }),
    };
    let drives = [
        Drive {
            name: "motor".into(),
            coordinate: scene.mechanism.actuators[0].coordinate(),
            kind: DriveKind::Motor(Motor {
                voltage: Magnitude::Constant(12.0),
                torque_constant: 0.1,
                resistance: 2.0,
                inductance: 0.05,
                gear_ratio: 3.0,
                rotor_inertia: 0.001,
                is_torque_speed_line: false,
            }),
        },
        Drive {
            name: "regulator".into(),
            coordinate: scene.mechanism.actuators[1].coordinate(),
            kind: DriveKind::SpeedController(SpeedController {
                reference_speed: Magnitude::Constant(1.0),
                proportional_gain: 0.4,
                integral_gain: 0.7,
                limit: 100.0,
            }),
        },
    ];
    let machine = machine(
        &scene,
        &[friction("rub-a", 0), friction("rub-b", 1)],
        &drives,
    );
    let mut y = machine.initial_state(&[0.4, -0.3], &[1.7, -1.2]);
    (y[4], y[5]) = (2.0, 0.3);
    (machine, y)
}

/// The Jacobian from dual numbers against central differences of the rates, with every kind of load and
/// drive at once.
#[test]
fn jacobians_agree_with_differences() {
    let (machine, y) = everything();
    let n = machine.state_count();
    let mut moving = MachineOde::new(&machine, 0.0, &y).expect("a start");
    let mut jacobian = vec![0.0; n * n];
    moving.jacobian(0.0, &y, &mut jacobian).expect("a Jacobian");
    let scale = jacobian.iter().fold(0.0_f64, |max, j| max.max(j.abs()));
    for j in 0..n {
        let h = 1e-4;
        let mut at = |times: f64| {
            let mut perturbed = y.clone();
            perturbed[j] += times * h;
            let mut out = vec![0.0; n];
            moving.rhs(0.0, &perturbed, &mut out).expect("rates");
            out
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(&mut at);
        for i in 0..n {
            let slope = (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (12.0 * h);
            let error = (slope - jacobian[i * n + j]).abs();
            // Rounding over h, and h⁴ times a fifth derivative of order 10⁴: measured 1.5e-12.
            assert!(
                error < 3e-11 * scale,
                "∂{i}/∂{j}: {slope} {}",
                jacobian[i * n + j]
            );
        }
    }
}

const BLOCK: &str = r#"
[bodies.ground]
points = { O = [0, 0] }
[bodies.block]
points = { P = [0, 0] }
mass = 2.0
center = "P"
inertia = 0.1
[joints]
slide = { prismatic = ["ground.O", "block.P"], axis = [0.8, -0.6] }
[actuators.s]
length = "slide"
[loads]
weight = { gravity = [0, -9.81] }
"#;

/// A block slides down an incline with friction: g (sin α − µ cos α); and one that is pushed against
/// its guide from above, at an angle at which more push means more friction than drive, jams.
#[test]
fn a_block_on_an_incline() {
    let scene = parse(BLOCK);
    let joint = &scene.mechanism.joints[0];
    let friction = |coefficient| Load {
        name: "rub".into(),
        kind: LoadKind::slide_force(Guide {
            bodies: joint.bodies,
            points: joint.points,
            axis: dwell_geometry::vec2(0.8, -0.6),
        }),
        magnitude: Magnitude::Friction(Friction {
            joint: dwell_geometry::JointId(0),
            coefficient,
            static_coefficient: coefficient,
            contact: FrictionContact::Guide { length: 0.0 },
            regularization_speed: Some(1e-3),
        }),
    };
    let machine = machine(&scene, &[friction(0.3)], &[]);
    let y = machine.initial_state(&[0.0], &[1.0]);
    let mut moving = MachineOde::new(&machine, 0.0, &y).expect("a start");
    let mut rates = vec![0.0; machine.state_count()];
    moving.rhs(0.0, &y, &mut rates).expect("rates");
    let expected = 9.81 * (0.6 - 0.3 * 0.8);
    assert!(
        (rates[1] - expected).abs() < 1e-14 * expected,
        "{}",
        rates[1]
    );
    // The work of friction is what is lost.
    let normal = 2.0 * 9.81 * 0.8;
    assert!((rates[2] + 0.3 * normal).abs() < 1e-14 * normal);
}

/// Every action and every reaction is one line: M q̈ + (what speeds alone make) + Σ c_ℓ F_ℓ, on every
/// case with loads, whatever its number of coordinates; and w of what has a potential is its slope.
#[test]
// Long: one sum, term by term.
fn reactions_are_the_sum_of_their_channels() {
    let mut kinds = std::collections::HashSet::new();
    for case in [
        "andrews",
        "boom",
        "cam",
        "four-bar",
        "five-bar",
        "massless-coupler",
        "rack-pinion",
        "whitworth",
        "watt-six-bar",
    ] {
        let scene = scene(case);
        let start = scene.assembly.to_configuration();
        let all = scene.mechanism.reactions();
        let bare = Model::new(&scene.mechanism, &scene.masses, &start, &all).expect("a model");
        let mut empty = (bare.workspace::<f64>(), bare.result_buffer::<f64>());
        let model = bare.clone().with_loads(scene.loads.clone()).expect("loads");
        let n = model.plan().actuators();
        let q: Vec<f64> = start.q.iter().map(|q| q + 1e-3).collect();
        let q_dot: Vec<f64> = (0..n).map(|i| 1.3 - 0.4 * i as f64).collect();
        let q_ddot: Vec<f64> = (0..n).map(|i| -2.1 + 0.9 * i as f64).collect();
        let t = 0.01;
        let (mut workspace, mut total) = (model.workspace(), model.result_buffer());
        let state = model
            .kinetostatics(t, &q, &q_dot, &q_ddot, &mut workspace, &mut total)
            .expect("a state");
        let loads = state.loads().magnitude.clone();
        let resisted: Vec<f64> = model
            .loads()
            .iter()
            .zip(&loads)
            .map(|(load, &f)| match load.kind {
                LoadKind::Along(along, Strength::Viscous) => {
                    f * state.bodies().coordinate(along)[1]
                }
                _ => f,
            })
            .collect();
        // What speeds alone make, without loads, by their products.
        let mut unloaded = bare
            .kinematic_state(&q, &q_dot, &mut empty.0)
            .expect("a state");
        let mut sum = bare.result_buffer::<f64>();
        for i in 0..n {
            for j in i..n {
                unloaded.christoffel_terms([i, j], &mut empty.1);
                let times = q_dot[i] * q_dot[j];
                let pairs = [
                    (&mut sum.tau, &empty.1.tau),
                    (&mut sum.reactions, &empty.1.reactions),
                ];
                for (sum, run) in pairs {
                    for (sum, value) in sum.iter_mut().zip(run) {
                        *sum += value * times;
                    }
                }
            }
        }
        let mut scale =
            [&sum.tau, &sum.reactions].map(|v| v.iter().map(|x| x.abs()).fold(0.0, f64::max));
        let mut run = model.result_buffer();
        let mut add = |run: &dwell_kinetostatics::InverseDynamics<f64>, times: f64| {
            let pairs = [
                (&mut sum.tau, &run.tau),
                (&mut sum.reactions, &run.reactions),
            ];
            for ((sum, run), scale) in pairs.into_iter().zip(&mut scale) {
                for (sum, value) in sum.iter_mut().zip(run) {
                    *sum += value * times;
                    *scale = scale.max((value * times).abs());
                }
            }
        };
        let mut state = state.into_kinematic_state();
        let mut other = model.workspace();
        for (i, &q_ddot) in q_ddot.iter().enumerate() {
            state.mass_matrix_column(i, &mut run);
            add(&run, q_ddot);
        }
        for (load, &f) in resisted.iter().enumerate() {
            state
                .unit_load_response(load, &mut run)
                .expect("a direction");
            add(&run, f);
            let kind = &model.loads()[load].kind;
            kinds.insert((std::mem::discriminant(kind), kind.unit()));
            if n == 1 && model.is_conservative(load) {
                let h = 1e-4;
                let mut potential = |x: f64| {
                    let beside = model.kinematic_state(&[q[0] + x], &q_dot, &mut other);
                    let potential = beside.expect("a state").potential_energy(load);
                    potential.expect("a potential")
                };
                let slope = (8.0 * (potential(h) - potential(-h))
                    - (potential(2.0 * h) - potential(-2.0 * h)))
                    / (12.0 * h);
                let w = -run.tau[0] * f;
                let size = w.abs().max(1e-3 * potential(0.0).abs());
                // Rounding of V over h, and h⁴ times its fifth derivative.
                assert!(
                    (slope + w).abs() < 1e-8 * size.max(1e-6),
                    "{case} {load}: {slope} {w}"
                );
            }
        }
        let pairs = [(&sum.tau, &total.tau), (&sum.reactions, &total.reactions)];
        for ((sum, total), scale) in pairs.into_iter().zip(scale) {
            for (k, (sum, total)) in sum.iter().zip(total).enumerate() {
                // Rounding of some dozens of terms: measured 5e-16.
                assert!(
                    (sum - total).abs() <= 3e-14 * scale,
                    "{case} {k}: {sum} {total}"
                );
            }
        }
    }
    assert!(kinds.len() >= 5, "only {} kinds of load", kinds.len());
}

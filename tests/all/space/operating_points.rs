//! Equilibria, linearised motions, steady cycles and tables in space, each against the dense equations in body coordinates.

use dwell_dynamics::{Event, EventKind, Method, OdeState, Options, Stability, solve};
use dwell_geometry::JointId;
use dwell_geometry::space::{Placement, Plan};
use dwell_kinetostatics::space::{Coordinate, LoadKind};
use dwell_kinetostatics::{
    MachineModel as _, Magnitude, ReducedModel as _, TableDomain, TableQuantity, UnitLoadResponses,
};
use dwell_scene::SpaceScene;
use dwell_study::reduce::compute::{ReducedScene as _, TabulatedScene as _};
use dwell_study::{
    CycleSearch, OperatingPoint, PreparedSpaceScene, SolverSettings, compute_cycle,
    compute_equilibria, compute_linearisation,
};
use dwell_verify::space::DenseSpace;

/// A scene of `validation/spatial` with other sections behind it.
fn scene(name: &str, more: &str) -> SpaceScene {
    let path = format!(
        "{}/../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("a scene") + more;
    SpaceScene::parse(name, &text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A scene with its plan, for the dense equations at coordinates.
struct Dense<'a> {
    scene: &'a SpaceScene,
    plan: &'a Plan,
}

impl Dense<'_> {
    /// What the actuators do at coordinates, speeds and accelerations, under gravity and other loads.
    fn actions(&self, [q, q_dot, q_ddot]: [&[f64]; 3], more: &[(LoadKind, f64)]) -> Vec<f64> {
        let mut pose = self.plan.pose();
        self.plan.positions(q, &mut pose).expect("a pose");
        let bodies = 0..self.scene.mechanism.bodies.len();
        let placements: Vec<Placement> = bodies.map(|b| self.plan.placement(&pose, b)).collect();
        let gravity = self.scene.loads.iter().filter_map(|load| match load {
            load if load.name == "weight" => match load.magnitude {
                Magnitude::Constant(magnitude) => Some((load.kind, magnitude)),
                _ => None,
            },
            _ => None,
        });
        let loads: Vec<_> = gravity.chain(more.iter().copied()).collect();
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        let dense = DenseSpace::new(mechanism, masses, &placements, [q_dot, q_ddot], &loads);
        dense.expect("singular values").actuator_actions
    }

    /// What holds a mechanism of one coordinate at rest; its static force is the opposite.
    fn holding(&self, q: f64) -> f64 {
        self.actions([&[q], &[0.0], &[0.0]], &[])[0]
    }

    /// The accelerations without actuators: M q̈ = −τ(q, q̇, 0), by Cramer's rule for one or two coordinates.
    fn free_accelerations(&self, q: &[f64], q_dot: &[f64]) -> Vec<f64> {
        let zero = vec![0.0; q.len()];
        let bias = self.actions([q, q_dot, &zero], &[]);
        let at_rest = self.actions([q, &zero, &zero], &[]);
        let column = |i: usize| {
            let mut unit = zero.clone();
            unit[i] = 1.0;
            let with = self.actions([q, &zero, &unit], &[]);
            let column = with.iter().zip(&at_rest).map(|(a, b)| a - b);
            column.collect::<Vec<_>>()
        };
        let m: Vec<Vec<f64>> = (0..q.len()).map(column).collect();
        match &m[..] {
            [one] => vec![-bias[0] / one[0]],
            [x, y] => {
                let det = x[0] * y[1] - y[0] * x[1];
                let first = y[0] * bias[1] - bias[0] * y[1];
                let second = x[1] * bias[0] - x[0] * bias[1];
                vec![first / det, second / det]
            }
            _ => panic!("one or two coordinates"),
        }
    }
}

/// The slope by central differences, extrapolated once: its error is of the fourth order in the step.
fn slope(f: impl Fn(f64) -> f64) -> f64 {
    let central = |h: f64| (f(h) - f(-h)) / (2.0 * h);
    (4.0 * central(1e-3) - central(2e-3)) / 3.0
}

/// Where the dense static force changes its sign, there is an equilibrium, and nowhere else; its eigenvalues are λ² = Q′/m.
#[test]
fn equilibria_are_where_the_dense_static_force_vanishes() {
    for name in [
        "rssr",
        "rsur",
        "slider-crank-haug",
        "bricard-a04",
        "bennett",
    ] {
        let scene = scene(name, "");
        let found = compute_equilibria(&scene).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let plan = found.prepared.machine.model().plan();
        let dense = Dense {
            scene: &scene,
            plan,
        };
        let curves = found.curves.as_ref().expect("of one coordinate");
        let held: Vec<f64> = curves.q.iter().map(|&q| dense.holding(q)).collect();
        let largest = held.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        for (force, [static_force, _]) in held.iter().zip(&curves.force_and_potential) {
            assert!((force + static_force).abs() < 1e-11 * largest, "{name}");
        }
        let changes = held.windows(2).filter(|pair| pair[0] * pair[1] < 0.0);
        assert_eq!(changes.count(), found.found.len(), "{name}");
        for one in &found.found {
            let q = one.y[0];
            assert!(dense.holding(q).abs() < 1e-12 * largest, "{name} at {q}");
            let stiffness = slope(|h| -dense.holding(q + h));
            let inertia = dense.actions([&[q], &[0.0], &[1.0]], &[])[0] - dense.holding(q);
            let square = stiffness / inertia;
            let [re, im] = one.eigenvalues[0];
            let found = if square > 0.0 { re * re } else { -im * im };
            assert!(
                (found / square - 1.0).abs() < 1e-8,
                "{name} at {q}: λ² = {found} for {square}"
            );
            let stability = match square > 0.0 {
                true => Stability::Unstable,
                false => Stability::Centre,
            };
            assert_eq!(one.stability, stability, "{name} at {q}");
        }
    }
}

/// The state matrix of the governor as it turns: the accelerations of the dense equations by differences of coordinates and speeds.
/// The massless gimbals of the gyroscope are in line where its rotor stands or hangs, and the inertia is singular there. Each of the two is
/// one equilibrium all the same, neutral in both coordinates about the vertical, with λ² = ± m g l / I for the distance l of the centre of
/// mass from the axis of nutation.
#[test]
fn a_gyroscope_at_rest_stands_or_hangs() {
    let scene = scene("gyroscope", "");
    let found = compute_equilibria(&scene).expect("equilibria");
    let square = 0.3 * 9.81 * 0.05 / (0.001 + 0.3 * 0.05 * 0.05);
    let mut squares: Vec<f64> = Vec::new();
    for equilibrium in &found.found {
        assert_eq!(equilibrium.neutral.len(), 2);
        assert!(equilibrium.y[1].sin().abs() < 1e-7);
        // The square of the greatest eigenvalue, real or imaginary.
        let parts = equilibrium.eigenvalues.iter();
        let signed = parts.map(|[re, im]| re * re - im * im);
        squares.extend(signed.max_by(|a, b| a.abs().total_cmp(&b.abs())));
    }
    squares.sort_by(f64::total_cmp);
    assert_eq!(squares.len(), 2, "{squares:?}");
    for (found, expected) in squares.iter().zip([-square, square]) {
        // Seen: 5.6e-16 of it.
        assert!((found - expected).abs() < 5e-14 * square, "{found}");
    }
}

#[test]
fn the_state_matrix_is_the_slope_of_the_dense_accelerations() {
    let text = "\n[motion]\nduration = 1\ninitial-velocity.q = 0.7\ninitial-velocity.s = 4.0\n";
    let scene = scene("governor", text);
    let motion = compute_linearisation(&scene, OperatingPoint::InitialState);
    let motion = motion.unwrap_or_else(|e| panic!("{e:?}"));
    let plan = motion.prepared.machine.model().plan();
    let dense = Dense {
        scene: &scene,
        plan,
    };
    let start = motion.state[..4].to_vec();
    assert_eq!(start[2..], [0.7, 4.0]);
    let rate = |y: &[f64]| {
        let accelerations = dense.free_accelerations(&y[..2], &y[2..]);
        [y[2], y[3], accelerations[0], accelerations[1]]
    };
    for (row, wanted) in rate(&start).iter().enumerate() {
        let found = motion.linear.state_derivative[row];
        assert!(
            (found - wanted).abs() < 1e-10 * wanted.abs().max(1.0),
            "{found}"
        );
    }
    let largest = motion.linear.a.iter().flatten();
    let largest = largest.fold(0.0_f64, |a, b| a.max(b.abs()));
    for column in 0..4 {
        for row in 0..4 {
            let wanted = slope(|h| {
                let mut y = start.clone();
                y[column] += h;
                rate(&y)[row]
            });
            let found = motion.linear.a[row][column];
            assert!(
                (found - wanted).abs() < 1e-8 * largest,
                "{row} {column}: {found} for {wanted}"
            );
        }
    }
}

const DRIVEN: &str = r#"
rub = { rotational-damper = "D", damping = 0.004 }
[drives]
motor = { motor = "q", voltage = 6.0, torque-constant = 0.05, resistance = 2.0, gear-ratio = 4 }
[motion]
duration = 1
initial-velocity = 20
"#;

/// The steady cycle of a spatial crank-rocker with a motor and a damper: at each of its samples the acceleration is that of the dense equations
/// with the motor's torque by hand, its works cancel, and a long motion arrives at its period.
#[test]
fn a_long_motion_arrives_at_the_steady_cycle() {
    let scene = scene("rssr", DRIVEN);
    let settings = SolverSettings {
        method: Method::Dop853,
        rtol: 1e-11,
        atol: 1e-11,
        ..SolverSettings::default()
    };
    let CycleSearch::Steady(found) =
        compute_cycle(&scene, &settings, None).unwrap_or_else(|e| panic!("{e:?}"))
    else {
        panic!("there is a steady cycle")
    };
    let machine = &found.prepared.machine;
    let dense = Dense {
        scene: &scene,
        plan: machine.model().plan(),
    };
    let joint = |name: &str| {
        let joints = &scene.mechanism.joints;
        JointId(
            joints
                .iter()
                .position(|j| j.name == name)
                .expect("the joint"),
        )
    };
    let column = |name: &str| {
        let columns = &found.samples.columns;
        columns.iter().position(|c| c.name == name).expect(name)
    };
    let [q, speed, acceleration] = ["q", "q.velocity", "q.acceleration"].map(column);
    for row in found.samples.rows.iter().step_by(40) {
        let torque = 4.0 * 0.05 * (6.0 - 4.0 * 0.05 * row[speed]) / 2.0;
        let loads = [
            (LoadKind::couple(joint("A")), torque),
            (LoadKind::rotational_damper(joint("D")), 0.004),
        ];
        let held = dense.actions([&[row[q]], &[row[speed]], &[row[acceleration]]], &loads);
        let inertia = dense.actions([&[row[q]], &[0.0], &[1.0]], &[])[0] - dense.holding(row[q]);
        let error = held[0] / inertia;
        assert!(error.abs() < 1e-9 * row[speed].powi(2), "{error}");
    }
    let works = &found.steady.works;
    let sum: f64 = works.iter().sum();
    assert!(works[0].abs() > 0.01 && sum.abs() < 1e-9, "{works:?}");
    // From another speed, until the disturbance is gone.
    let model = machine.model();
    let angle = model.coordinate_function(Coordinate::Angle(joint("A")));
    let turn = Event {
        kind: EventKind::Revolution(angle.expect("an angle")),
        terminal: None,
    };
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[0.0], &[20.0]),
    };
    let options = Options {
        atol: 1e-12,
        ..Options::new(Method::Dop853, 1e-12)
    };
    let motion = solve(machine, model, &start, 40.0, &options, &[turn]).expect("a motion");
    let times: Vec<f64> = motion.event_occurrences.iter().map(|e| e.state.t).collect();
    let [.., before, last] = times[..] else {
        panic!("{} revolutions", times.len())
    };
    let error = (last - before) / found.steady.period - 1.0;
    assert!(
        error.abs() < 1e-9,
        "{error:.1e} after {} turns",
        times.len()
    );
}

/// A table of the reduced parameters keeps its accuracy against the exact model, and m is that of the dense equations.
#[test]
fn tables_keep_their_accuracy() {
    for name in ["rssr", "bricard-a04", "slider-crank-haug", "wobble-plate"] {
        let scene = scene(name, "");
        let prepared = PreparedSpaceScene::new(&scene).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let accuracy = 1e-8;
        let table = prepared.tabulated(accuracy, TableDomain::Full);
        let table = table.expect("loads that fit");
        let table = table.unwrap_or_else(|e| panic!("{name}: {e:?}"));
        let [from, to] = table.domain();
        let at = |k: usize| from + (to - from) * (k as f64 + 0.37) / 500.0;
        let q: Vec<f64> = (0..500).map(at).collect();
        let exact = prepared.coefficients(&q).expect("poses");
        let columns = prepared.unit_loads(&q).expect("poses");
        let columns = columns.map_or_else(Vec::new, |loads| loads.columns(&prepared));
        let column = |name: &str| {
            let found = columns.iter().find(|(c, _)| c.name == name);
            found.map_or_else(|| panic!("no {name}"), |(_, values)| values)
        };
        let names = prepared.reaction_units();
        let plan = prepared.model.model().plan();
        let dense = Dense {
            scene: &scene,
            plan,
        };
        let mut coefficients = prepared.model.model().coefficient_buffer();
        let mut responses: UnitLoadResponses = table.response_buffer();
        let bounds = table.bounds();
        for (k, (&q, exact)) in q.iter().zip(&exact).enumerate() {
            table
                .coefficients(q, &mut (), &mut coefficients)
                .expect("within");
            table
                .unit_load_responses(q, &mut responses)
                .expect("within");
            for bound in bounds {
                let (found, wanted) = match bound.quantity {
                    TableQuantity::M => (coefficients.m, exact.m),
                    TableQuantity::HalfDm => (coefficients.half_dm, exact.half_dm),
                    TableQuantity::A { reaction } => (coefficients.a[reaction], exact.a[reaction]),
                    TableQuantity::B { reaction } => (coefficients.b[reaction], exact.b[reaction]),
                    TableQuantity::W { load } => (responses.w[load], column("weight.w")[k]),
                    TableQuantity::C { load, reaction } => {
                        assert_eq!(load, 0);
                        let of = format!("{}.c.weight", names[reaction].0);
                        (responses.c[reaction], column(&of)[k])
                    }
                    ref other => panic!("{other}"),
                };
                let allowed = bound.error * bound.scale;
                assert!(bound.error <= accuracy, "{name}");
                assert!(
                    (found - wanted).abs() <= allowed,
                    "{name} at {q}: {found} for {wanted}, {allowed:.1e} allowed"
                );
            }
            if k % 50 == 0 {
                let m = dense.actions([&[q], &[0.0], &[1.0]], &[])[0] - dense.holding(q);
                assert!((coefficients.m / m - 1.0).abs() < 2.0 * accuracy, "{name}");
            }
        }
    }
}

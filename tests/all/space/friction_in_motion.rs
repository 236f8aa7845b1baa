//! Free motions with dry friction in space: blocks that come to rest on guides in any direction, and planar machines that are
//! the same in an oblique plane.

use super::friction::{block, rubbing};
use super::oblique::{G, SMOOTH, oblique_slider_crank, planar_slider_crank, scene, tilt, written};
use dwell_dynamics::{
    ContactEvent, ContactMode, CoordinateMode, Machine, Method, MovingModel, OdeState, Options,
    Solution, solve,
};
use dwell_geometry::space::{Vec3, vec3};
use dwell_kinetostatics::MachineModel;
use dwell_kinetostatics::space::Model;
use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::machines::MachineScene;
use dwell_study::{
    MotionSolver, SolverSettings, StudyError, compute_free_motion, model_with_loads, no_progress,
};

/// A tight tolerance of a method, and the error of a motion in it.
fn tolerance(method: Method) -> [f64; 2] {
    match method {
        Method::TrBdf2 => [1e-12, 1e-8],
        Method::Esdirk34 | Method::Bdf => [1e-13, 1e-9],
        Method::Tsit45 | Method::Dop853 => [1e-13, 1e-10],
    }
}

/// The machine of a scene, all of whose coordinates are free.
pub(super) fn machine(scene: &SpaceScene) -> Machine<Model> {
    MachineScene::machine(scene, &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A motion from a coordinate and a speed.
pub(super) fn motion<M: MovingModel>(
    machine: &Machine<M>,
    model: &M,
    [q, q_dot]: [f64; 2],
    end: f64,
    (method, rtol): (Method, f64),
) -> Solution {
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[q], &[q_dot]),
    };
    let options = Options::new(method, rtol);
    let solution = solve(machine, model, &start, end, &options, &[]);
    let solution = solution.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(solution.error, None);
    solution
}

/// The times at which surfaces take a mode of a kind.
fn times(solution: &Solution, is: impl Fn(ContactMode) -> bool) -> Vec<f64> {
    let of_kind = |event: &ContactEvent| match event {
        ContactEvent::Friction { t, to, .. } => is(*to).then_some(*t),
        ContactEvent::Stop { .. } | ContactEvent::Switch { .. } => None,
    };
    solution.contact_events.iter().filter_map(of_kind).collect()
}

fn holds(mode: ContactMode) -> bool {
    mode == ContactMode::Holds
}

/// How far kinetic and potential energy less all works vary, over the largest of them.
pub(super) fn energy_error<M: MovingModel>(machine: &Machine<M>, steps: &[OdeState]) -> f64 {
    let mut workspace = machine.workspace();
    let (mut low, mut high, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for step in steps {
        let state = machine.evaluate(step.t, &step.y, &mut workspace);
        let [kinetic, potential] = state.expect("a state").energy();
        let works: f64 = step.y[machine.work_offset()..].iter().sum();
        largest = largest.max(kinetic).max(works.abs());
        low = low.min(kinetic + potential - works);
        high = high.max(kinetic + potential - works);
    }
    (high - low) / largest
}

/// A guide whose slope is this: the sine of its angle with the horizontal.
fn guide(slope: f64) -> Vec3 {
    let flat = (1.0 - slope * slope).sqrt();
    vec3(0.6 * flat, -0.8 * flat, slope)
}

/// Pushed up an oblique guide at 3 m/s a block stops after v/(g (sin + µ cos)). Where tan < µₛ it stays there; where not, it slides back
/// with g (sin − µ cos).
#[test]
fn a_block_on_an_oblique_guide_stops_and_stays_or_slides_back() {
    let (mu, v) = (0.3, 3.0);
    for (degrees, stays) in [(14.0_f64, true), (17.5, true), (25.0, false)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let keys = format!("coefficient = {mu}, static-coefficient = 0.32");
        let scene = scene(&block(guide(sin), vec3(0.0, 0.0, 0.0), &keys, ""));
        let machine = machine(&scene);
        let model = machine.model().clone();
        let stop = v / (G * (sin + mu * cos));
        let height = 0.5 * v * stop;
        for method in Method::ALL {
            let [rtol, allowed] = tolerance(method);
            let end = 2.0;
            let solution = motion(&machine, &model, [0.0, v], end, (method, rtol));
            let rests = times(&solution, holds);
            let last = solution.steps.last().expect("steps");
            let (rest, back) = (end - stop, G * (sin - mu * cos));
            let wanted = match stays {
                true => [height, 0.0],
                false => [height - 0.5 * back * rest * rest, -back * rest],
            };
            assert_eq!(rests.len(), usize::from(stays), "{degrees}, {method:?}");
            for t in &rests {
                assert!((t - stop).abs() < allowed, "{method:?}: {t} for {stop}");
            }
            for (found, wanted) in last.y[..2].iter().zip(wanted) {
                let off = (found - wanted).abs();
                assert!(off < allowed, "{degrees}, {method:?}: {found} for {wanted}");
            }
            if stays {
                assert_eq!(last.y[1], 0.0, "{method:?}");
            }
            let off = energy_error(&machine, &solution.steps);
            assert!(off < allowed, "{method:?}: {off:.1e}");
        }
    }
}

/// A block at rest holds until a force that grows beyond µₛ N plus its weight along the guide; then it slides with µ.
#[test]
fn a_block_breaks_away_at_the_static_limit() {
    let axis = guide(0.1);
    let keys = "coefficient = 0.2, static-coefficient = 0.35";
    let push = "loads.push = { slide-force = \"guide\", magnitude = \"10*t\" }\n\
                [motion]\ninitial-velocity = 0\nduration = 2.0\n";
    let scene = scene(&block(axis, vec3(0.02, 0.01, 0.0), keys, push));
    let weight = 2.3 * G;
    let across = weight * (1.0_f64 - 0.01).sqrt();
    let wanted = (0.35 * across + 0.1 * weight) / 10.0;
    let solver = MotionSolver::Settings(SolverSettings {
        method: Method::Dop853,
        rtol: 1e-12,
        atol: 1e-14,
        ..SolverSettings::default()
    });
    let found = compute_free_motion(&scene, &solver, &no_progress);
    let found = found.unwrap_or_else(|e| panic!("{e}"));
    assert!(found.computed.early_stop.is_none());
    let [(t, name)] = &found.events[..] else {
        panic!("{:?}", found.events)
    };
    assert_eq!(name, "guide breaks away");
    // Seen: 2e-16.
    assert!((t - wanted).abs() < 2e-14, "{t} for {wanted}");
    // Up to there the guide holds with what is applied; behind it with µ N.
    let table = &found.computed.table;
    let column = |name: &str| {
        let columns = table.columns.iter();
        let found = columns.clone().position(|c| c.name == name);
        found.unwrap_or_else(|| panic!("{name}"))
    };
    let [time, speed, force] = ["t", "x.velocity", "guide.friction.load_force"].map(column);
    let balance = column("power.residual");
    for row in &table.rows {
        let wanted = match row[time] < wanted {
            true => 0.1 * weight - 10.0 * row[time],
            false => -0.2 * across,
        };
        assert!((row[force] - wanted).abs() < 1e-12 * weight, "{row:?}");
        assert!((row[speed] == 0.0) == (row[time] <= *t), "{row:?}");
        assert!(row[balance].abs() < 1e-11 * weight, "{row:?}");
    }
}

/// A pendulum on a tilted axis is one in the plane whose gravity is that part of gravity across its axis: with friction that holds it
/// comes to rest at the same time and at the same angle, off its equilibrium.
#[test]
fn a_pendulum_on_a_tilted_axis_is_a_planar_one() {
    let frame = tilt();
    let pull = vec3(0.3, -0.9, 0.2);
    let local = frame.rotation.apply_inverse(pull.scaled(G));
    let keys = "coefficient = 0.2, static-coefficient = 0.25, radius = 0.2";
    let planar = format!(
        "bodies.ground.points = {{ O = [0, 0] }}\n\
         bodies.bob = {{ points = {{ O = [0, 0] }}, mass = 2.0, center = [0.5, 0.1], inertia = 0.03 }}\n\
         joints.O = {{ revolute = [\"ground.O\", \"bob.O\"] }}\n\
         actuators.phi = {{ angle = [\"ground\", \"bob\"] }}\nassembly.phi = 0.0\n\
         loads.weight = {{ gravity = [{:?}, {:?}] }}\nfriction.O = {{ {keys} }}\n",
        local.x, local.y
    );
    let axes = |k: usize| written(frame.rotation.columns[k]);
    let oblique = format!(
        "bodies.ground.points = {{ O = {} }}\n\
         bodies.bob = {{ points = {{ O = [0, 0, 0] }}, mass = 2.0, center = [0.5, 0.1, 0], inertia = [0.01, 0.02, 0.03] }}\n\
         joints.O = {{ revolute = [\"ground.O\", \"bob.O\"], axes = [{}, [0, 0, 1]], normals = [{}, [1, 0, 0]] }}\n\
         actuators.phi = {{ angle = \"O\" }}\nassembly.phi = 0.0\n\
         loads.weight = {{ gravity = {} }}\nfriction.O = {{ {keys} }}\n",
        written(frame.position),
        axes(2),
        axes(0),
        written(pull.scaled(G)),
    );
    let plane = PlaneScene::parse("plane.toml", &planar).unwrap_or_else(|e| panic!("{e:?}"));
    let space = scene(&oblique);
    let one = MachineScene::machine(&plane, &[]).unwrap_or_else(|e| panic!("{e}"));
    let other = machine(&space);
    let start = [0.0, 9.0];
    let by = (Method::Dop853, 1e-12);
    let wanted = motion(&one, &one.model().clone(), start, 12.0, by);
    let found = motion(&other, &other.model().clone(), start, 12.0, by);
    let changes = |solution: &Solution| times(solution, |_| true);
    let (a, b) = (changes(&wanted), changes(&found));
    assert!(a.len() >= 2 && a.len() == b.len(), "{a:?} {b:?}");
    let ends = [&wanted, &found].map(|s| s.steps.last().expect("steps").y[..2].to_vec());
    let mut largest = (ends[0][0] - ends[1][0]).abs();
    assert_eq!([ends[0][1], ends[1][1]], [0.0; 2]);
    for (a, b) in a.iter().zip(&b) {
        largest = largest.max((a - b).abs());
    }
    // Seen: 3e-15.
    println!(
        "tilted pendulum: {largest:.1e} after {} changes, at rest at {}",
        a.len(),
        ends[1][0]
    );
    assert!(largest < 3e-13, "{largest:.1e}");
    // At rest its weight turns it by less than the static limit allows.
    let q = ends[1][0];
    let center = vec3(
        0.5 * q.cos() - 0.1 * q.sin(),
        0.5 * q.sin() + 0.1 * q.cos(),
        0.0,
    );
    let turning = 2.0 * (center.x * local.y - center.y * local.x);
    let limit = 0.25 * 0.2 * 2.0 * f64::hypot(local.x, local.y);
    assert!(
        turning.abs() <= limit && turning != 0.0,
        "{turning} of {limit}"
    );
}

/// The slider-crank with its motor and friction in all joints moves in an oblique plane as it does in the plane, also where the guide and
/// the crank's pin hold.
#[test]
fn a_machine_with_friction_moves_in_an_oblique_plane_as_in_the_plane() {
    let motor = "[drives]\nmotor = { motor = \"phi\", voltage = 48, torque-constant = 0.1, resistance = 0.4, inductance = 0.001, \
                 gear-ratio = 5, inertia = 1e-4 }\n[motion]\ninitial-velocity = 30\nduration = 0.25\n";
    let plane = planar_slider_crank();
    let space = oblique_slider_crank(SMOOTH, motor);
    let [one, other] = [
        compare(&plane, 0.25, [0.5, 30.0]),
        compare(&space, 0.25, [0.5, 30.0]),
    ];
    let mut largest = 0.0_f64;
    for (a, b) in one.0.iter().zip(&other.0) {
        largest = largest.max((a - b).abs() / a.abs().max(1.0));
    }
    // Seen: 3e-10 after six turns, each within the tolerance of its own steps.
    println!("oblique slider-crank, smooth: {largest:.1e}");
    assert!(largest < 1e-8, "{largest:.1e}");
    assert!(
        one.1 < 1e-9 && other.1 < 1e-9,
        "{:.1e} {:.1e}",
        one.1,
        other.1
    );
    // Without motor, with friction that holds: the gas drives it back and forth, and it stops and lets go dozens of times.
    let text = std::fs::read_to_string(format!(
        "{}/../validation/slider-crank-friction/scene.toml",
        env!("CARGO_MANIFEST_DIR")
    ));
    let text = text.expect("the file");
    let (head, _) = text.split_once("[drives]").expect("drives");
    let sticking = head
        .replace(
            "C = { coefficient = 0.08, radius = 8, regularization-speed = 0.5 }\n",
            "",
        )
        .replace("radius = 12, regularization-speed = 0.5", "radius = 12")
        .replace(
            "guide-length = 60, regularization-speed = 5",
            "guide-length = 60",
        );
    let plane = PlaneScene::parse("sticking.toml", &sticking).unwrap_or_else(|e| panic!("{e:?}"));
    let friction = SMOOTH
        .replace("radius = 12, regularization-speed = 0.5", "radius = 12")
        .replace(
            "guide-length = 60, regularization-speed = 5",
            "guide-length = 60",
        );
    let space = oblique_slider_crank(&friction, "");
    let [one, other] = [
        compare(&plane, 3.0, [0.5, 12.0]),
        compare(&space, 3.0, [0.5, 12.0]),
    ];
    assert!(
        one.2.len() >= 20 && one.2.len() == other.2.len(),
        "{:?} {:?}",
        one.2,
        other.2
    );
    let mut largest = 0.0_f64;
    for (a, b) in one
        .2
        .iter()
        .zip(&other.2)
        .chain(one.0.iter().zip(&other.0).take(2))
    {
        largest = largest.max((a - b).abs());
    }
    println!(
        "oblique slider-crank, sticking: {largest:.1e}, {} changes until {:?}",
        one.2.len(),
        one.2.last()
    );
    // Seen: 6e-9 at the end and in the times of 78 changes.
    assert!(largest < 5e-7, "{largest:.1e}");
}

/// The state at the end of a motion, without works; the error of its energy; and the times of all changes of contacts.
pub(super) fn compare<S: MachineScene>(
    scene: &S,
    end: f64,
    start: [f64; 2],
) -> (Vec<f64>, f64, Vec<f64>)
where
    S::Model: MovingModel,
{
    let machine = scene.machine(&[]).unwrap_or_else(|e| panic!("{e}"));
    let model = machine.model().clone();
    let solution = motion(&machine, &model, start, end, (Method::Dop853, 1e-12));
    let last = solution.steps.last().expect("steps");
    let state = last.y[..machine.drive_states().end].to_vec();
    (
        state,
        energy_error(&machine, &solution.steps),
        times(&solution, |_| true),
    )
}

/// The energy balance of motions of spatial loops with friction closes, and what friction does is lost.
#[test]
fn energy_balances_close_with_friction() {
    for (name, keys) in [
        (
            "rssr",
            "friction.A = { coefficient = 0.2, radius = 0.02, bearing-distance = 0.05 }\n\
             friction.D = { coefficient = 0.15, radius = 0.015 }\n",
        ),
        (
            "slider-crank-haug",
            "friction.A = { coefficient = 0.1, radius = 0.01, regularization-speed = 0.3 }\n\
             friction.D = { coefficient = 0.12, guide-length = 0.06, regularization-speed = 0.01 }\n",
        ),
    ] {
        let scene = rubbing(name, keys, "");
        let machine = machine(&scene);
        let model = machine.model().clone();
        let start = [scene.assembly.q[0], 12.0];
        let solution = motion(&machine, &model, start, 3.0, (Method::Dop853, 1e-12));
        let off = energy_error(&machine, &solution.steps);
        let last = solution.steps.last().expect("steps");
        let works = &last.y[machine.work_offset()..];
        // Seen: 1e-13 and 6e-13.
        println!("{name}: {off:.1e}, works {works:?}, speed {}", last.y[1]);
        assert!(off < 5e-11, "{name}: {off:.1e}");
        assert!(works.iter().all(|work| *work < 0.0), "{name}: {works:?}");
        let lost: Vec<_> = solution
            .steps
            .iter()
            .map(|s| s.y[machine.work_offset()])
            .collect();
        assert!(lost.windows(2).all(|w| w[1] <= w[0]), "{name}");
    }
}

/// What analyses of smooth motions refuse in the plane they refuse in space, in the same words.
#[test]
fn smooth_analyses_refuse_friction_that_holds() {
    let keys = "friction.A = { coefficient = 0.2, radius = 0.02 }\n";
    let scene = rubbing(
        "rssr",
        keys,
        "[motion]\ninitial-velocity = 3\nperiods = 1\n",
    );
    let text = |error: StudyError| match error {
        StudyError::Scene(error) => format!("{error:?}"),
        other => panic!("{other}"),
    };
    let point = dwell_study::OperatingPoint::InitialState;
    let error = dwell_study::compute_linearisation(&scene, point).err();
    let said = text(error.expect("a refusal"));
    assert!(
        said.contains("the dry friction of joint `A` holds at rest"),
        "{said}"
    );
    assert!(said.contains("regularization-speed"), "{said}");
    let error = dwell_study::compute_period(&scene).err();
    let said = text(error.expect("a refusal"));
    assert!(said.contains("a load without a potential"), "{said}");
    // A cylindrical joint slides in two directions: friction does not hold there.
    let keys = "friction.B = { coefficient = 0.2, radius = 0.1, regularization-speed = 0.1 }\n";
    let scene = rubbing("planar-oblique-rcsr", keys, "");
    let model = model_with_loads(&scene, &[]).expect("a model");
    assert!((0..2).all(|k| model.sticking_friction(k).is_none()));
    let modes = vec![CoordinateMode::Free];
    let machine = Machine::new(model, &scene.loads, modes, &[]).expect("a machine");
    assert_eq!(machine.contact_loads().count(), 0);
}

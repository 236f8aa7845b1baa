//! End stops in space: blocks and pendulums with closed forms, and planar machines that are the same in an oblique plane.

use super::oblique::{G, oblique_slider_crank, scene, tilt, written};
use dwell_dynamics::{
    ContactEvent, Machine, Method, MovingModel, OdeState, Options, Solution, StopChange, solve,
};
use dwell_geometry::space::vec3;
use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::machines::MachineScene;
use dwell_study::{
    MotionSolver, PictureSpan, SolverSettings, StudyError, compute_free_motion, no_progress,
    simulate_within,
};
use std::f64::consts::PI;

/// A tight tolerance of a method, and the error of a motion in it.
pub(super) fn tolerance(method: Method) -> [f64; 2] {
    match method {
        Method::TrBdf2 => [1e-12, 1e-7],
        Method::Esdirk34 | Method::Bdf => [1e-13, 1e-9],
        Method::Tsit45 | Method::Dop853 => [1e-13, 1e-10],
    }
}

/// The motion of a scene, with its machine.
pub(super) fn motion<S: MachineScene>(
    scene: &S,
    end: f64,
    (method, rtol): (Method, f64),
) -> (Machine<S::Model>, Solution) {
    let machine = scene.machine(&[]).unwrap_or_else(|e| panic!("{e}"));
    let start = scene.motion_start();
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&start.coordinates, &start.velocities),
    };
    let options = Options::new(method, rtol);
    let solution = solve(&machine, machine.model(), &start, end, &options, &[]);
    let solution = solution.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(solution.error, None);
    (machine, solution)
}

/// The times at which end stops change so.
pub(super) fn times(solution: &Solution, is: impl Fn(&StopChange) -> bool) -> Vec<f64> {
    let of_kind = |event: &ContactEvent| match event {
        ContactEvent::Stop { t, change, .. } => is(change).then_some(*t),
        ContactEvent::Friction { .. } | ContactEvent::Switch { .. } => None,
    };
    solution.contact_events.iter().filter_map(of_kind).collect()
}

pub(super) fn is_impact(change: &StopChange) -> bool {
    matches!(change, StopChange::Impact { .. })
}

/// How far kinetic and potential energy less all works vary, over the largest of them.
fn energy_error<M: MovingModel>(machine: &Machine<M>, steps: &[OdeState]) -> f64 {
    let mut workspace = machine.workspace();
    let (mut low, mut high, mut largest) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64);
    for step in steps {
        let energy = machine.energy(step.t, &step.y, &mut workspace);
        let [kinetic, potential] = energy.expect("a state");
        let works: f64 = step.y[machine.work_offset()..].iter().sum();
        largest = largest.max(kinetic).max(works.abs());
        low = low.min(kinetic + potential - works);
        high = high.max(kinetic + potential - works);
    }
    (high - low) / largest
}

/// A block on a guide with a slope, between end stops.
fn block(slope: f64, stops: &str, start: &str) -> SpaceScene {
    scene(&block_text(slope, stops, start))
}

/// Its direction upwards.
pub(super) fn up(slope: f64) -> String {
    let flat = (1.0 - slope * slope).sqrt();
    written(vec3(0.6 * flat, -0.8 * flat, slope))
}

pub(super) fn block_text(slope: f64, stops: &str, start: &str) -> String {
    format!(
        "bodies.ground.points = {{ A = [0.1, 0.2, 0.3] }}\n\
         bodies.block = {{ points = {{ A = [0, 0, 0] }}, mass = 2.3, center = [0.02, 0.1, 0], inertia = [0.01, 0.02, 0.015] }}\n\
         joints.guide = {{ prismatic = [\"ground.A\", \"block.A\"], axis = {} }}\n\
         actuators.x = {{ travel = \"guide\" }}\nassembly.x = 0.0\n\
         loads.weight = {{ gravity = [0, 0, -{G}] }}\nstops.ends = {{ coordinate = \"x\", {stops} }}\n\
         [motion]\n{start}\n",
        up(slope),
    )
}

/// A stop that yields is a spring with a damper as long as it pushes: from the depth's d̈ = 0 at first to d̈ = 0 again,
///
/// ```text
/// d = (v/b) e^(−at) sin bt,   a = c/2m,   b² = k/m − a²,     tan bt₁ = 2ab/(a² − b²)
/// ```
#[test]
fn a_block_rebounds_from_a_stop_that_yields() {
    let (v, mass, stiffness, damping) = (3.0, 2.3, 800.0, 12.0);
    let scene = block(
        0.0,
        "max = 0.5, stiffness = 800, damping = 12",
        "initial-velocity = 3\nduration = 1.0",
    );
    let a: f64 = damping / (2.0 * mass);
    let b = (stiffness / mass - a * a).sqrt();
    let time = (PI - (2.0 * a * b / (b * b - a * a)).atan()) / b;
    let (sin, cos) = (b * time).sin_cos();
    let decay = (-a * time).exp();
    let [depth, speed] = [v / b * decay * sin, v * decay * (cos - a / b * sin)];
    let touches = 0.5 / v;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let (machine, solution) = motion(&scene, 1.0, (method, rtol));
        for (change, wanted) in [
            (StopChange::Touches, touches),
            (StopChange::Leaves, touches + time),
        ] {
            let found = times(&solution, |of| *of == change);
            assert_eq!(found.len(), 1, "{method:?}: {found:?}");
            let late = (found[0] - wanted).abs();
            println!("{method:?}: {change:?} {late:.1e} s beside {wanted} s");
            assert!(late < allowed, "{method:?}: {late:e} s");
        }
        let last = &solution.steps.last().expect("steps").y;
        let at = 0.5 + depth + speed * (1.0 - touches - time);
        let off = (last[0] - at).abs() + (last[1] - speed).abs();
        assert!(off < 10.0 * allowed, "{method:?}: {off:e}");
        let off = energy_error(&machine, &solution.steps);
        assert!(off < 10.0 * allowed, "{method:?}: {off:e}");
    }
}

/// Between two stops on a level guide it keeps e of its speed at each, so that each way takes 1/e times as long as the last.
#[test]
fn a_block_bounces_between_two_stops() {
    let (v, e, low, high) = (3.0, 0.8_f64, -0.2, 0.5);
    let scene = block(
        0.0,
        "min = -0.2, max = 0.5, restitution = 0.8",
        "initial-velocity = 3\nduration = 2.0",
    );
    let way = (high - low) / v;
    let mut wanted = vec![high / v];
    while let Some(next) = wanted
        .last()
        .map(|t| t + way * e.powi(-(wanted.len() as i32)))
    {
        if next > 2.0 {
            break;
        }
        wanted.push(next);
    }
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let (machine, solution) = motion(&scene, 2.0, (method, rtol));
        let found = times(&solution, is_impact);
        assert_eq!(found.len(), wanted.len(), "{method:?}: {found:?}");
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!(
                (found - wanted).abs() < allowed,
                "{method:?}: {found} for {wanted}"
            );
        }
        let last = &solution.steps.last().expect("steps").y;
        let speed = v * e.powi(wanted.len() as i32);
        assert!(
            (last[1].abs() - speed).abs() < allowed,
            "{method:?}: {}",
            last[1]
        );
        let off = energy_error(&machine, &solution.steps);
        assert!(off < allowed, "{method:?}: {off:.1e}");
    }
    // Rows at wanted times, in the middle of steps, are on the same broken line.
    let at: Vec<f64> = (1..20).map(|k| 0.1 * f64::from(k)).collect();
    let solver = MotionSolver::Settings(SolverSettings::default());
    let done = simulate_within(
        &scene,
        &solver,
        Some(&at),
        PictureSpan::default(),
        &no_progress,
    );
    let done = done.unwrap_or_else(|e| panic!("{e}"));
    let mut files = done.outcome.files.iter();
    let (_, bytes) = files
        .find(|(path, _)| path.to_string_lossy() == "scene-motion.csv")
        .expect("rows");
    let text = std::str::from_utf8(bytes).expect("text");
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| {
        heads
            .iter()
            .position(|head| *head == name)
            .expect("a column")
    };
    let [time, place] = ["t [s]", "x [m]"].map(column);
    let mut rows = 0;
    for line in lines {
        let row: Vec<f64> = line
            .split(',')
            .map(|v| v.parse().expect("a number"))
            .collect();
        let t = row[time];
        let k = wanted.iter().filter(|at| **at <= t).count();
        let from = if k == 0 {
            0.0
        } else if k % 2 == 1 {
            high
        } else {
            low
        };
        let since = t - if k == 0 { 0.0 } else { wanted[k - 1] };
        let x = from + since * v * (-e).powi(k as i32);
        // Seen: 3e-13 in a thousand rows.
        assert!(
            (row[place] - x).abs() < 1e-11,
            "t = {t}: {} for {x}",
            row[place]
        );
        rows += 1;
    }
    assert_eq!(rows, 20);
}

/// Down a slope it falls √(2h/g′) and rests where its rebounds accumulate, after (1 + e)/(1 − e) times that.
#[test]
fn a_block_comes_to_rest_on_the_lower_stop() {
    let (slope, e) = (0.3, 0.5);
    let scene = block(slope, "min = -0.7, restitution = 0.5", "duration = 3.0");
    let first = (2.0 * 0.7 / (G * slope)).sqrt();
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let (machine, solution) = motion(&scene, 3.0, (method, rtol));
        let rests = times(&solution, |change| *change == StopChange::Rests);
        let wanted = first * (1.0 + e) / (1.0 - e);
        assert_eq!(rests.len(), 1, "{method:?}");
        let late = (rests[0] - wanted).abs();
        println!("{method:?} rests {late:.1e} s beside {wanted} s");
        // Each of some twenty rebounds begins anew, BDF with its first order.
        let spread = match method {
            Method::TrBdf2 | Method::Esdirk34 | Method::Bdf => 1e-6,
            Method::Tsit45 | Method::Dop853 => 2e-9,
        };
        assert!(late < spread, "{method:?}: {late:.1e} s");
        assert_eq!(solution.steps.last().expect("steps").y[..2], [-0.7, 0.0]);
        let off = energy_error(&machine, &solution.steps);
        assert!(off < allowed.max(spread), "{method:?}: {off:.1e}");
        // What the impacts lose is the work of the stop: all of the weight's.
        let work = solution.steps.last().expect("steps").y[machine.work_offset()];
        let lost = 2.3 * G * slope * 0.7;
        assert!(
            (work + lost).abs() < 10.0 * allowed.max(spread) * lost,
            "{method:?}: {work} for {lost}"
        );
    }
}

/// Legendre's integral K(sin A/2) by the arithmetic and the geometric mean: a quarter of the period of a pendulum of amplitude A.
fn quarter(amplitude: f64, frequency: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, (0.5 * amplitude).cos());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    0.5 * PI / (a * frequency)
}

/// A pendulum on a tilted axis that meets a stop at its lowest point: each swing has cos A′ = 1 − e² (1 − cos A), and the pin takes the
/// impulse of the centre of mass.
#[test]
fn a_pendulum_strikes_a_stop_at_its_lowest_point() {
    let (mass, length, inertia, e, amplitude) = (2.0, 0.4, 0.05, 0.7_f64, 1.3);
    let frame = tilt();
    let axes = |k: usize| written(frame.rotation.columns[k]);
    let down = frame.rotation.columns[0].scaled(G);
    let scene = scene(&format!(
        "bodies.ground.points = {{ O = {} }}\n\
         bodies.bob = {{ points = {{ O = [0, 0, 0] }}, mass = {mass:?}, center = [{length}, 0, 0], inertia = [0.01, 0.02, {inertia}] }}\n\
         joints.O = {{ revolute = [\"ground.O\", \"bob.O\"], axes = [{}, [0, 0, 1]], normals = [{}, [1, 0, 0]] }}\n\
         actuators.phi = {{ angle = \"O\" }}\nassembly.phi = {amplitude}\n\
         loads.weight = {{ gravity = {} }}\n\
         stops.wall = {{ coordinate = \"phi\", min = 0, restitution = {e} }}\n\
         [motion]\nduration = 4\n",
        written(frame.position),
        axes(2),
        axes(0),
        written(down),
    ));
    let frequency = (mass * G * length / (inertia + mass * length * length)).sqrt();
    let mut wanted = vec![quarter(amplitude, frequency)];
    let mut swing = amplitude;
    for _ in 0..40 {
        swing = (1.0 - e * e * (1.0 - swing.cos())).acos();
        wanted.push(wanted[wanted.len() - 1] + 2.0 * quarter(swing, frequency));
    }
    wanted.retain(|t| *t < 4.0);
    assert!(wanted.len() > 3);
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let (machine, solution) = motion(&scene, 4.0, (method, rtol));
        let found = times(&solution, is_impact);
        assert_eq!(found.len(), wanted.len(), "{method:?}: {found:?}");
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!(
                (found - wanted).abs() < allowed,
                "{method:?}: {found} for {wanted}"
            );
        }
        let off = energy_error(&machine, &solution.steps);
        assert!(off < allowed, "{method:?}: {off:.1e}");
    }
    let settings = SolverSettings {
        method: Method::Dop853,
        rtol: 1e-13,
        ..SolverSettings::default()
    };
    let solver = MotionSolver::Settings(settings);
    let done = simulate_within(&scene, &solver, None, PictureSpan::default(), &no_progress);
    let done = done.unwrap_or_else(|e| panic!("{e}"));
    let mut files = done.outcome.files.iter();
    let (_, bytes) = files
        .find(|(path, _)| path.to_string_lossy() == "scene-motion-events.csv")
        .expect("events");
    let text = std::str::from_utf8(bytes).expect("text");
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let column = |name: &str| heads.iter().position(|head| *head == name);
    let impulses =
        ["x", "y", "z"].map(|axis| column(&format!("O.{axis}.impulse [N s]")).expect("an impulse"));
    let (speed, mut first) = (column("phi.velocity [rad/s]").expect("a speed"), None);
    for line in lines {
        let row: Vec<f64> = line
            .split(',')
            .map(|v| v.parse().expect("a number"))
            .collect();
        first.get_or_insert(row[0]);
        // Behind the impact it is e times what it was.
        let change = row[speed] * (1.0 + 1.0 / e);
        let wanted = frame.rotation.columns[1].scaled(mass * length * change);
        let found = vec3(row[impulses[0]], row[impulses[1]], row[impulses[2]]);
        // Seen: 3e-16.
        assert!((found - wanted).norm() < 2e-14 * wanted.norm(), "{line}");
    }
    let late = first.map_or(f64::NAN, |t| t - wanted[0]);
    // Seen: 4e-13 s, by DOP853.
    assert!(late.abs() < 4e-12, "{late:e} s");
    assert!(
        done.outcome.summary.contains("wall is struck (event 1)"),
        "{}",
        done.outcome.summary
    );
}

/// A slider-crank that strikes a rigid stop with its crank and is thrown back by one that yields does the same in an oblique plane as in
/// the plane.
#[test]
fn a_machine_with_end_stops_moves_in_an_oblique_plane_as_in_the_plane() {
    let rest = "[stops]\nwall = { coordinate = \"phi\", max = 2.4, restitution = 0.6 }\n\
                cushion = { coordinate = \"phi\", min = -0.3, stiffness = 900, damping = 3 }\n\
                [motion]\ninitial-velocity = 9\nduration = 1.2\n";
    let space = oblique_slider_crank("", rest);
    let text = std::fs::read_to_string(format!(
        "{}/../validation/slider-crank-friction/scene.toml",
        env!("CARGO_MANIFEST_DIR")
    ));
    let text = text.expect("the file");
    let (head, _) = text.split_once("[friction]").expect("friction");
    let planar = format!("{head}{rest}");
    let plane = PlaneScene::parse("stops.toml", &planar).unwrap_or_else(|e| panic!("{e:?}"));
    let by = (Method::Dop853, 1e-13);
    let (one, wanted) = motion(&plane, 1.2, by);
    let (other, found) = motion(&space, 1.2, by);
    let all = |solution: &Solution| times(solution, |_| true);
    let (a, b) = (all(&wanted), all(&found));
    assert!(a.len() >= 8 && a.len() == b.len(), "{a:?} {b:?}");
    assert!(times(&found, is_impact).len() >= 3);
    let ends = [&wanted, &found].map(|s| s.steps.last().expect("steps").y[..2].to_vec());
    let pairs = a.iter().zip(&b).chain(ends[0].iter().zip(&ends[1]));
    let largest = pairs.fold(0.0_f64, |max, (a, b)| max.max((a - b).abs()));
    println!(
        "oblique slider-crank with stops: {largest:.1e} after {} events",
        a.len()
    );
    // Seen: 1.7e-11.
    assert!(largest < 1e-9, "{largest:.1e}");
    for off in [
        energy_error(&one, &wanted.steps),
        energy_error(&other, &found.steps),
    ] {
        assert!(off < 1e-11, "{off:.1e}");
    }
}

/// What is refused in the plane is refused in space, in the same words.
#[test]
fn analyses_of_motions_without_stops_refuse_them() {
    let text = |error: StudyError| match error {
        StudyError::Scene(error) => format!("{error:?}"),
        other => panic!("{other}"),
    };
    let scene = block(0.3, "min = -0.7", "periods = 1");
    let solver = MotionSolver::Settings(SolverSettings::default());
    let error = compute_free_motion(&scene, &solver, &no_progress).err();
    assert!(text(error.expect("a refusal")).contains("give a `duration` in s"));
    let point = dwell_study::OperatingPoint::InitialState;
    let error = dwell_study::compute_linearisation(&scene, point).err();
    assert!(text(error.expect("a refusal")).contains("end stop `ends`"));
    let beyond = block(0.3, "min = 0.1", "duration = 1");
    let error = compute_free_motion(&beyond, &solver, &no_progress).err();
    assert!(text(error.expect("a refusal")).contains("beyond end stop `ends`"));
}

//! Change points in space: parallelograms in an oblique plane pass them on their branch, as those in the plane do.

use super::ONE_COORDINATE;
use super::oblique::{G, scene, tilt, written};
use super::reference::Reference;
use dwell_dynamics::{DynamicsError, Method, OdeState, Options, solve};
use dwell_geometry::PositionError;
use dwell_geometry::space::{Rotation, vec3};
use dwell_kinetostatics::{ExactModel, ReducedModel};
use dwell_scene::{PlaneScene, SpaceScene};
use dwell_study::machines::MachineScene;
use dwell_study::{
    MotionSolver, PictureSpan, SolverSettings, StudyError, compute_free_motion, model_with_loads,
    no_progress, simulate_within,
};
use std::f64::consts::{PI, TAU};

/// The angles of coupler and rocker of a parallelogram at 1 rad of its crank: parallel, and crossed.
const PARALLEL: [f64; 2] = [0.0, 1.0];
const CROSSED: [f64; 2] = [-1.045_889_4, -2.045_889_4];

const MOTION: &str = "[motion]\ninitial-velocity = 12\nduration = 2\n";

/// In the plane.
fn planar([coupler, rocker]: [f64; 2]) -> PlaneScene {
    let text = format!(
        "[bodies.ground]\npoints = {{ A = [0, 0], D = [0.4, 0] }}\n\
         [bodies.crank]\npoints = {{ A = [0, 0], B = [0.2, 0] }}\nmass = 1.0\ncenter = \"B\"\n\
         [bodies.coupler]\npoints = {{ B = [0, 0], C = [0.4, 0] }}\nmass = 2.0\ncenter = [0.2, 0.05]\ninertia = 0.03\n\
         [bodies.rocker]\npoints = {{ D = [0, 0], C = [0.2, 0] }}\nmass = 0.5\ncenter = [0.1, 0]\ninertia = 0.002\n\
         [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"coupler.B\"] }}\n\
         C = {{ revolute = [\"coupler.C\", \"rocker.C\"] }}\nD = {{ revolute = [\"ground.D\", \"rocker.D\"] }}\n\
         [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n\
         [assembly]\nphi = 1.0\ncoupler = {coupler}\nrocker = {rocker}\n\
         [loads]\nweight = {{ gravity = [0, -{G}] }}\n{MOTION}"
    );
    PlaneScene::parse("plane.toml", &text).unwrap_or_else(|e| panic!("{e:?}"))
}

/// In an oblique plane, with these kinds of the joints B and C; other sections follow.
fn oblique([coupler, rocker]: [f64; 2], [b, c]: [&str; 2], rest: &str) -> SpaceScene {
    let frame = tilt();
    let turn = |x: f64, y: f64, z: f64| written(frame.rotation.apply(vec3(x, y, z)));
    let point = |x: f64, y: f64| written(frame.position + frame.rotation.apply(vec3(x, y, 0.0)));
    let placed = |at: String, angle: f64| {
        let own = Rotation::of_vector(vec3(0.0, 0.0, angle));
        let turn = written(frame.rotation.after(&own).vector());
        format!("{{ at = {at}, turn = {turn} }}")
    };
    let axis = |kind: &str| {
        if kind == "spherical" {
            ""
        } else {
            ", axis = [0, 0, 1]"
        }
    };
    let (sin, cos) = 1.0_f64.sin_cos();
    let (z, x) = (turn(0.0, 0.0, 1.0), turn(1.0, 0.0, 0.0));
    let axes = format!("axes = [{z}, [0, 0, 1]], normals = [{x}, [1, 0, 0]]");
    scene(&format!(
        "[bodies.ground]\npoints = {{ A = {a}, D = {d} }}\n\
         [bodies.crank]\npoints = {{ A = [0, 0, 0], B = [0.2, 0, 0] }}\nmass = 1.0\ncenter = \"B\"\n\
         [bodies.coupler]\npoints = {{ B = [0, 0, 0], C = [0.4, 0, 0] }}\nmass = 2.0\ncenter = [0.2, 0.05, 0]\ninertia = [0.03, 0.03, 0.03]\n\
         [bodies.rocker]\npoints = {{ D = [0, 0, 0], C = [0.2, 0, 0] }}\nmass = 0.5\ncenter = [0.1, 0, 0]\ninertia = [0.002, 0.002, 0.002]\n\
         [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"], {axes} }}\n\
         B = {{ {b} = [\"crank.B\", \"coupler.B\"]{of_b} }}\nC = {{ {c} = [\"coupler.C\", \"rocker.C\"]{of_c} }}\n\
         D = {{ revolute = [\"ground.D\", \"rocker.D\"], {axes} }}\n\
         [actuators]\nphi = {{ angle = \"A\" }}\n\
         [assembly]\nphi = 1.0\ncrank = {crank}\ncoupler = {coupler}\nrocker = {rocker}\n\
         [loads]\nweight = {{ gravity = {weight} }}\n{rest}",
        a = point(0.0, 0.0),
        d = point(0.4, 0.0),
        of_b = axis(b),
        of_c = axis(c),
        crank = placed(point(0.0, 0.0), 1.0),
        coupler = placed(point(0.2 * cos, 0.2 * sin), coupler),
        rocker = placed(point(0.4, 0.0), rocker),
        weight = turn(0.0, -G, 0.0),
    ))
}

/// All hinges, with three redundant constraints; and without redundant ones, with a ball that is or is not in the tree.
const KINDS: [[&str; 2]; 3] = [
    ["revolute", "revolute"],
    ["cylindrical", "spherical"],
    ["spherical", "cylindrical"],
];

#[test]
fn change_points_are_found_where_the_parallelogram_is_flat() {
    let mut largest = 0.0_f64;
    for kinds in KINDS {
        for angles in [PARALLEL, CROSSED] {
            let scene = oblique(angles, kinds, "");
            let model = model_with_loads(&scene, &[]).unwrap_or_else(|e| panic!("{e}"));
            let found = model.plan().change_points();
            assert_eq!(found.len(), 2, "{kinds:?} {angles:?}: {found:?}");
            for (point, wanted) in found.iter().zip([PI, TAU]) {
                largest = largest.max((point.q - wanted).abs());
            }
            if angles == PARALLEL {
                let reduced = ExactModel::new(model.without_reactions()).expect("one actuator");
                let mut workspace = reduced.workspace();
                for k in 0..40 {
                    let q = 0.013 + f64::from(k) * 0.157;
                    let (m, half_dm) = reduced.inertia(q, &mut workspace).expect("a pose");
                    assert!(
                        (m - 0.127).abs() < 1e-11 && half_dm.abs() < 1e-7,
                        "{q}: {m} {half_dm}"
                    );
                }
            }
        }
    }
    // Seen: 5.4e-12.
    println!("change points: {largest:.1e}");
    assert!(largest < 2e-11, "{largest:.1e}");
    for name in ONE_COORDINATE {
        let (model, _) = Reference::read(name).model();
        assert_eq!(model.plan().change_points(), [], "{name}");
    }
}

/// At rest the acceleration falls as the inertia grows by a flywheel, within a window and outside of it.
#[test]
fn a_flywheel_counts_on_a_fit() {
    let (m, flywheel) = (0.127, 0.7);
    let scene = oblique(PARALLEL, KINDS[1], "");
    let machine = scene.machine(&[]).unwrap_or_else(|e| panic!("{e}"));
    let machine = machine.with_change_points(1e-9);
    let heavier = machine.clone().with_flywheel(0, flywheel);
    let window = &machine.change_point_windows()[0];
    let outside = window.at.q + 1.5 * window.half_width;
    for (q, is_fitted) in [(window.at.q, true), (outside, false)] {
        let at_rest = machine.initial_state(&[q], &[0.0]);
        assert_eq!(machine.is_in_fit_window(&at_rest), is_fitted, "{q}");
        let [lighter, heavier] = [&machine, &heavier].map(|machine| {
            let mut workspace = machine.workspace();
            let state = machine.evaluate(0.0, &at_rest, &mut workspace);
            state.expect("a pose").q_ddot()[0]
        });
        let ratio = lighter / heavier;
        // Seen: 1.4e-12.
        assert!(
            (ratio / (1.0 + flywheel / m) - 1.0).abs() < 1e-10,
            "{q}: {ratio}"
        );
    }
}

/// The summary of a motion by quadrature says the required accuracy, and the change points that it passes.
#[test]
fn a_motion_by_quadrature_says_its_accuracy_and_change_points() {
    let scene = oblique(PARALLEL, KINDS[1], MOTION);
    let solver = MotionSolver::Accuracy {
        accuracy: 1e-6,
        sample_interval: None,
    };
    let span = PictureSpan::default();
    let done = simulate_within(&scene, &solver, None, span, &no_progress);
    let text = done.unwrap_or_else(|e| panic!("{e}")).outcome.summary;
    for words in [
        "  accuracy 1e-6: quadrature (conservative, periodic motion), ",
        " of the largest reaction\n",
        " s: change point crossed\n",
        "  change point at 3.14159: crossed by a polynomial fit",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

/// The error of a motion at a tolerance of 1e-12: of the method, after five revolutions.
fn allowed(method: Method) -> f64 {
    match method {
        // Seen: 3e-8, 9e-8 and 1e-9.
        Method::TrBdf2 | Method::Esdirk34 | Method::Bdf => 1e-6,
        Method::Tsit45 | Method::Dop853 => 1e-8,
    }
}

/// As a parallelogram it is a pendulum with m = 0.127 kg m² and V = 0.65 kg m · g sin φ: after k periods it is where it was, having
/// passed 2 k change points.
#[test]
fn a_parallelogram_moves_as_a_pendulum_through_its_change_points() {
    let energy = |q: f64| 0.5 * 0.127 * 144.0 + 0.65 * G * (1.0_f64.sin() - q.sin());
    let points = 400;
    let density = |k: i32| (0.127 / (2.0 * energy(TAU * f64::from(k) / f64::from(points)))).sqrt();
    let period = TAU / f64::from(points) * (0..points).map(density).sum::<f64>();
    let mut largest = 0.0_f64;
    for kinds in KINDS {
        let scene = oblique(PARALLEL, kinds, "");
        let machine = MachineScene::machine(&scene, &[]).unwrap_or_else(|e| panic!("{e}"));
        let machine = machine.with_change_points(1e-12);
        let start = OdeState {
            t: 0.0,
            y: machine.initial_state(&[1.0], &[12.0]),
        };
        for method in Method::ALL {
            let options = Options::new(method, 1e-12);
            let solution = solve(
                &machine,
                machine.model(),
                &start,
                5.0 * period,
                &options,
                &[],
            );
            let solution = solution.unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(solution.error, None);
            let end = &solution.steps.last().expect("steps").y;
            let off = (end[0] - 1.0 - 5.0 * TAU)
                .abs()
                .max((end[1] - 12.0).abs() / 12.0);
            println!("{kinds:?}, {method:?}: {off:.1e}");
            assert!(off < allowed(method), "{kinds:?}, {method:?}: {off:.1e}");
            if method == Method::Dop853 {
                largest = largest.max(off);
            }
        }
    }
    println!("parallelogram after ten change points: {largest:.1e}");
    // Seen: 8e-11, the errors of the fits.
    assert!(largest < 1e-9, "{largest:.1e}");
}

/// The same rows as in the plane, parallel and crossed: the crossed one's inertia varies and it stays crossed.
#[test]
fn parallelograms_move_in_an_oblique_plane_as_in_the_plane() {
    let solver = MotionSolver::Settings(SolverSettings {
        method: Method::Dop853,
        rtol: 1e-12,
        atol: 1e-14,
        ..SolverSettings::default()
    });
    for angles in [PARALLEL, CROSSED] {
        let plane = planar(angles);
        let wanted = compute_free_motion(&plane, &solver, &no_progress);
        let wanted = wanted.unwrap_or_else(|e| panic!("{e}")).computed;
        assert!(wanted.early_stop.is_none());
        for kinds in KINDS {
            let space = oblique(angles, kinds, MOTION);
            let found = compute_free_motion(&space, &solver, &no_progress);
            let found = found.unwrap_or_else(|e| panic!("{e}")).computed;
            assert!(found.early_stop.is_none());
            let column = |table: &dwell_findings::Table, name: &str| {
                let columns = table.columns.iter();
                columns
                    .clone()
                    .position(|c| c.name == name)
                    .expect("a column")
            };
            let of = ["t", "phi", "phi.velocity"];
            let [a, b] =
                [&wanted.table, &found.table].map(|table| of.map(|name| column(table, name)));
            let (mut compared, mut largest) = (0, 0.0_f64);
            for row in &found.table.rows {
                let same = |other: &&Vec<f64>| other[a[0]] == row[b[0]];
                let Some(other) = wanted.table.rows.iter().find(same) else {
                    continue;
                };
                compared += 1;
                let off = (other[a[1]] - row[b[1]]).abs();
                largest = largest.max(off.max((other[a[2]] - row[b[2]]).abs() / 12.0));
            }
            println!("{angles:?} {kinds:?}: {largest:.1e} in {compared} rows");
            assert!(compared > 900, "{compared}");
            // Seen: 1.8e-11.
            assert!(largest < 1e-9, "{angles:?} {kinds:?}: {largest:.1e}");
        }
    }
}

/// Friction depends on reactions that grow beyond all bounds there: the motion ends in front of the change point, which is named.
#[test]
fn a_motion_with_friction_ends_at_a_change_point() {
    let rest = format!("[friction]\nA = {{ coefficient = 0.02, radius = 0.01 }}\n{MOTION}");
    let scene = oblique(PARALLEL, KINDS[1], &rest);
    let machine = MachineScene::machine(&scene, &[]).unwrap_or_else(|e| panic!("{e}"));
    let machine = machine.with_change_points(1e-10);
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[1.0], &[12.0]),
    };
    let options = Options::new(Method::Dop853, 1e-10);
    let solution = solve(&machine, machine.model(), &start, 2.0, &options, &[]);
    let solution = solution.unwrap_or_else(|e| panic!("{e}"));
    let Some(DynamicsError::Position(PositionError::Singular { q, .. })) = solution.error else {
        panic!("{:?}", solution.error)
    };
    assert!((q - PI).abs() < 1e-9, "{q}");
    let end = &solution.steps.last().expect("steps").y;
    assert!(PI - end[0] > 0.0 && PI - end[0] < 0.05, "{}", end[0]);
    let solver = MotionSolver::Settings(SolverSettings::default());
    let done = compute_free_motion(&scene, &solver, &no_progress);
    let done = done.unwrap_or_else(|e| panic!("{e}"));
    let Some(StudyError::Scene(error)) = done.computed.early_stop else {
        panic!("it goes on")
    };
    let said = format!("{error:?}");
    assert!(
        said.contains("singular position at `phi` = 3.14159"),
        "{said}"
    );
}

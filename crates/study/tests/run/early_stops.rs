//! Trajectories that end early, and scenes that define no trajectory.

use crate::table::{Table, WEIGHTS, analyse, case, file, scene};
use dwell_study::equilibria::compute::SearchedRange;
use dwell_study::{
    Analysis, MotionSolver, OperatingPoint, SolverSettings, StudyError, analyse_trajectory, check,
    compute_free_motion, equilibria, free_motion_page, linearise, no_progress,
};

/// Crank 0.3, coupler 0.2, rocker 0.25 on a base of 0.4 m.
fn limited(sweep: &str) -> String {
    WEIGHTS
        .replace("B = [0.1, 0]", "B = [0.3, 0]")
        .replace("C = [0.35, 0]", "C = [0.2, 0]")
        .replace("C = [0.3, 0]", "C = [0.25, 0]")
        .replace("coupler = 0.6", "coupler = 0.2")
        .replace("phi = [0.0, 6.283185307179586]", sweep)
}

/// Where coupler and rocker are in line, by the law of cosines.
fn limit() -> f64 {
    let cosine: f64 = (0.3_f64.powi(2) + 0.4_f64.powi(2) - 0.45_f64.powi(2)) / (2.0 * 0.3 * 0.4);
    cosine.acos()
}

#[test]
fn a_sweep_stops_at_a_limit_position_and_keeps_what_it_found() {
    for command in [
        Analysis::Kinematics,
        Analysis::Statics,
        Analysis::Kinetostatics,
    ] {
        let result = analyse(&scene(&limited("phi = [0.5, 6.0]")), command, 111);
        let table = Table::parse(&file(&result, &format!("-{}.csv", command.name())));
        let phi = table.column("phi");
        // Positions are 0.05 rad apart.
        assert!(*phi.last().unwrap() < limit() && phi.last().unwrap() + 0.05 > limit());
        let Some(StudyError::Scene(stop_error)) = result.early_stop else {
            panic!("it did not stop");
        };
        let stated = stop_error.message.split("phi = ").nth(1).unwrap();
        let stated: f64 = stated.split(' ').next().unwrap().parse().unwrap();
        // Eight digits are printed.
        assert!((stated - limit()).abs() < 1e-7, "{stated} {}", limit());
        assert!(
            stop_error.message.contains("`coupler`, `rocker`"),
            "{}",
            stop_error.message
        );
        let pointed: Vec<_> = stop_error
            .labelled()
            .iter()
            .map(|(text, _)| (*text).to_owned())
            .collect();
        assert!(
            pointed.contains(&"[coordinate-sweep]".to_owned()),
            "{pointed:?}"
        );
    }
}

/// With steps longer than the gap of the range, no position is out of range; it must not jump it.
#[test]
fn a_sweep_does_not_jump_over_what_it_cannot_pass() {
    let result = analyse(
        &scene(&limited("phi = [1.0, 13.56637061435917]")),
        Analysis::Kinematics,
        3,
    );
    assert!(result.early_stop.is_some());
    let table = Table::parse(&file(&result, "-kinematics.csv"));
    assert_eq!(table.column("phi"), [1.0]);
}

/// A follower lifted by 10 mm a radian, under a force.
const LIFT: &str = r#"
[bodies.ground]
points = { O = [0, 0] }
[bodies.cam]
points = { O = [0, 0] }
[bodies.follower]
points = { P = [0, 0] }
mass = 1
center = "P"
[joints]
O = { revolute = ["ground.O", "cam.O"] }
slide = { prismatic = ["ground.O", "follower.P"], axis = [0, 1] }
lift = { coupling = ["rise", "phi"], expression = "0.01*x" }
[actuators]
phi = { angle = ["ground", "cam"] }
[coordinates]
rise = { travel = "slide" }
[loads]
push = { force = "follower.P", direction = [0, 1], magnitude = 1 }
[prescribed]
duration = 5
phi = { speed = 1.0 }
"#;

/// With some of it changed: how many of 51 positions are reached, and what is said of the next,
/// with the text it points at.
fn changed(old: &str, new: &str) -> (usize, String, String) {
    let scene = scene(&LIFT.replace(old, new));
    let message_and_label = |error: &StudyError| match error {
        StudyError::Scene(e) => (e.message.clone(), e.labelled()[0].0.to_owned()),
        other => panic!("{other}"),
    };
    match analyse_trajectory(&scene, Analysis::Kinetostatics, Some(51), &no_progress) {
        Err(error) => {
            let (message, at) = message_and_label(&error);
            (0, message, at)
        }
        Ok(result) => {
            let table = Table::parse(&file(&result, "-kinetostatics.csv"));
            let (message, at) = result
                .early_stop
                .as_ref()
                .map(message_and_label)
                .unwrap_or_default();
            (table.column("t").len(), message, at)
        }
    }
}

/// A pendulum that an engine turns by a table from −1 to 2 rad: 6 − 7⁄3 (φ + 1) less its weight crosses zero at one place of this interval.
const DRIVEN: &str = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.bar]
points = { A = [0, 0] }
mass = 1
center = [0.1, 0]
inertia = 0.02
[joints]
A = { revolute = ["ground.A", "bar.A"] }
[actuators]
phi = { angle = ["ground", "bar"] }
[loads]
engine = { torque = "bar", magnitude = { table = [[-1, 6], [2, -1]], interpolation = "linear", of = "phi" } }
weight = { gravity = [0, -9.81] }
[motion]
duration = 1
initial-coordinate = { phi = START }
"#;

/// A load is undefined beyond its table: equilibria are searched for within it, and a state beyond it is not
/// linearised.
#[test]
fn equilibria_are_those_within_the_tables_of_loads() {
    let started = |at: &str| scene(&DRIVEN.replace("START", at));
    let from_inside = started("0.5");
    let results = dwell_study::compute_equilibria(&from_inside).unwrap();
    let SearchedRange::Interval([from, to]) = results.searched else {
        panic!("one coordinate has an interval");
    };
    assert_eq!([from, to], [-1.0, 2.0]);
    let force = |q: f64| 6.0 - 7.0 / 3.0 * (q + 1.0) - 0.981 * q.cos();
    // One rounding of 6 N m is 1.3e-15 of them.
    let places: Vec<f64> = results.found.iter().map(|e| e.y[0]).collect();
    assert!(
        places.len() == 1 && force(places[0]).abs() < 1e-13,
        "{places:?}"
    );
    let said = equilibria(&from_inside).unwrap().summary;
    assert!(
        said.contains("the table of load `engine` ends there"),
        "{said}"
    );
    let outside = started("-1.5");
    let message = "the table of load `engine` covers phi from -1 rad (-57.2958°) to 2 rad (114.592°), but phi is \
                   -1.5 rad (-85.9437°) at the start";
    let error = equilibria(&outside).unwrap_err().to_string();
    assert_eq!(error, message);
    let error = linearise(&outside, OperatingPoint::InitialState).unwrap_err();
    assert_eq!(error.to_string(), message.replace("at the start", "there"));
    assert!(linearise(&from_inside, OperatingPoint::InitialState).is_ok());
}

#[test]
fn a_way_ends_where_a_load_leaves_its_table() {
    let table = "{ table = [[0, 1], [2, 2], [3, 1]], of = \"phi\" }";
    let (reached, message, at) = changed("magnitude = 1", &format!("magnitude = {table}"));
    // Positions are 0.1 rad apart, the thirty-first at 3 rad, the end of the table.
    assert_eq!((reached, at.as_str()), (31, table));
    assert_eq!(
        message,
        "the table of load `push` covers phi from 0 rad (0°) to 3 rad (171.887°), but phi is 3.1 rad \
         (177.617°) soon after t = 3 s, phi = 3 rad (171.887°)"
    );
    let late = "{ table = [[1, 1], [9, 2]] }";
    let (reached, message, at) = changed("magnitude = 1", &format!("magnitude = {late}"));
    assert_eq!((reached, at.as_str()), (0, late));
    assert_eq!(
        message,
        "the table of load `push` covers t from 1 s to 9 s, but t is 0 s at the first position, \
         t = 0 s, phi = 0 rad (0°)"
    );
    let whole = "magnitude = { table = [[0, 1], [5, 2]], of = \"phi\" }";
    assert_eq!(changed("magnitude = 1", whole).0, 51);
}

/// A motion is undefined beyond the end of a table: it has no events there and does not end by them.
#[test]
fn a_motion_ends_where_a_load_leaves_its_table() {
    let text = r#"
bodies.ground.points = { O = [0, 0] }
bodies.cart = { points = { P = [0, 0] }, mass = 2, center = "P" }
joints.way = { prismatic = ["ground.O", "cart.P"], axis = [1, 0] }
actuators.x = { length = "way" }
assembly.x = 0
loads.push = { force = "cart.P", direction = [1, 0], magnitude = { table = [[-1, 0], [0.55, 0]], of = "x" } }
[motion]
duration = 1
initial-velocity = { x = 1 }
events = { early = { reaches = "x", value = 0.2 }, late = { reaches = "x", value = 0.8, stop = true } }
"#;
    let settings = SolverSettings {
        sample_interval: Some(0.1),
        ..SolverSettings::default()
    };
    let solvers = [
        MotionSolver::Settings(settings),
        MotionSolver::Accuracy {
            accuracy: 1e-6,
            sample_interval: Some(0.1),
        },
    ];
    for solver in solvers {
        let motion = compute_free_motion(&scene(text), &solver, &no_progress).unwrap();
        assert_eq!(motion.computed.table.rows.len(), 6);
        let stop = motion.computed.early_stop.unwrap().to_string();
        assert!(stop.contains("the table of load `push` covers x from -1 m to 0.55 m, but x is 0.6 m soon after t = 0.5 s"), "{stop}");
        let [(t, name)] = &motion.events[..] else {
            panic!("{:?}", motion.events);
        };
        assert!((t - 0.2).abs() < 1e-9 && name == "early", "{name} at {t}");
        let (page, _) = free_motion_page(&scene(text), &solver, &no_progress).unwrap();
        assert_eq!(page.events.len(), 1);
        let said = &page.printed;
        assert!(said.starts_with("  0.5 of 1 s"), "{said}");
        assert!(
            said.contains("early: once") && said.contains("late: never\n"),
            "{said}"
        );
    }
}

#[test]
fn a_way_ends_where_a_relation_jumps_or_is_not_finite() {
    let relation = |text: &str| changed("\"0.01*x\"", &format!("\"{text}\""));
    let (reached, message, at) = relation("0.01*x + if(x > 3.05, 1, 0)");
    assert_eq!(
        (reached, at.as_str()),
        (31, "expression = \"0.01*x + if(x > 3.05, 1, 0)\"")
    );
    assert_eq!(
        message,
        "the function of coupling `lift` is discontinuous soon after t = 3 s, phi = 3 rad (171.887°), \
         at x = 3.05"
    );
    let (reached, message, at) = relation("sqrt(3.05 - x)");
    assert_eq!(
        (reached, at.as_str()),
        (31, "expression = \"sqrt(3.05 - x)\"")
    );
    assert_eq!(
        message,
        "the function of coupling `lift` has no finite value at x = 3.05, soon after t = 3.05 s, \
         phi = 3.05 rad (174.752°)"
    );
    let (_, message, at) = relation("sqrt(x)");
    assert_eq!(at, "expression = \"sqrt(x)\"");
    assert_eq!(
        message,
        "the function of coupling `lift` has no finite slope at x = 0, at the assembly coordinates"
    );
    // A bend is no jump.
    assert_eq!(relation("0.01*abs(x - 3.05)").0, 51);
}

#[test]
fn a_law_that_jumps_or_turns_too_far_is_refused() {
    let law = |text: &str| changed("speed = 1.0", &format!("expression = \"{text}\""));
    for (text, expected_text) in [
        (
            "t + floor(t/3.05)",
            "jumps at t = 3.05 s, from 3.05 to 4.05",
        ),
        (
            "1 - 0.001*sign(t - 0.1)",
            "jumps at t = 0.1 s, from 1.001 to 1",
        ),
        ("3e5*t", "is more than 1e6 rad at t = 3.4 s"),
    ] {
        let expected = (
            0,
            format!("the law of `phi` {expected_text}"),
            "phi".to_owned(),
        );
        assert_eq!(law(text), expected);
    }
    for text in ["1.9e5*t", "if(t < 2, t^2, 4*t - 4)", "max(t, 2*t - 3)"] {
        assert_eq!(law(text).0, 51, "{text}");
    }
}

#[test]
fn without_ends_a_sweep_fills_the_range_but_for_a_thousandth() {
    let result = analyse(&scene(&limited("")), Analysis::Kinematics, 21);
    assert!(result.early_stop.is_none());
    let phi = Table::parse(&file(&result, "-kinematics.csv")).column("phi");
    for (at, end) in [(phi[0], -limit()), (phi[20], limit())] {
        // The ends of the range are found by halving, to about 1e-13.
        assert!((at - end * 0.998).abs() < 1e-9, "{at} {end}");
    }
}

/// A rod that slides in an arm leads a slider on a line 0.1 m above the arm's pivot: pushed out, it
/// never comes to an end.
const RAM: &str = r#"
[bodies.ground]
points = { A = [0, 0], S = [0, 0.1] }
[bodies.arm]
points = { A = [0, 0] }
[bodies.rod]
points = { P = [0, 0] }
[bodies.slider]
points = { P = [0, 0] }
mass = 1
center = "P"
[joints]
A = { revolute = ["ground.A", "arm.A"] }
T = { prismatic = ["arm.A", "rod.P"], axis = [1, 0] }
P = { revolute = ["rod.P", "slider.P"] }
S = { prismatic = ["ground.S", "slider.P"], axis = [1, 0] }
[actuators]
d = { length = "T" }
[assembly]
d = 0.2
arm = 0.5
[coordinate-sweep]
"#;

#[test]
fn where_the_search_gave_up_is_no_end_of_the_mechanism() {
    let summary = check(&scene(RAM)).unwrap().summary;
    assert!(
        summary.contains("m; no upper limit was found up to there"),
        "{summary}"
    );
    let swept = analyse(&scene(RAM), Analysis::Statics, 11);
    assert!(swept.early_stop.is_none());
    let d = Table::parse(&file(&swept, "-statics.csv")).column("d");
    // From its one end, a thousandth left out, to a part of its size beyond the start: the ends are
    // found to about 1e-13.
    let (low, high) = (0.1, 0.2 + 0.25 * 0.1);
    assert!(
        (d[0] - low - 1e-3 * (high - low)).abs() < 1e-9 && d[10] == high,
        "{d:?}"
    );
    let far = analyse(&scene(&format!("{RAM}d = [1, 100]")), Analysis::Statics, 11);
    let Some(StudyError::Scene(error)) = far.early_stop else {
        panic!("it was followed without end");
    };
    assert!(
        error
            .message
            .contains("no limit position was found, and positions beyond are not available"),
        "{}",
        error.message
    );
}

#[test]
fn check_knows_which_columns_there_are() {
    let text = WEIGHTS.replace("[requests]", "[requests]\nvariables = [\"rocker.angel\"]");
    let Err(StudyError::Scene(error)) = check(&scene(&text)) else {
        panic!("there is no such column");
    };
    assert_eq!(error.message, "there is no column `rocker.angel`");
}

#[test]
fn a_scene_that_does_not_say_its_way_is_told_what_to_add() {
    let mut unmoved = case("five-bar");
    unmoved.prescribed = None;
    let still = case("crank-rocker");
    for (scene, command) in [
        (&unmoved, Analysis::Kinematics),
        (&unmoved, Analysis::Statics),
        (&still, Analysis::Kinetostatics),
    ] {
        let Err(StudyError::Scene(error)) = analyse_trajectory(scene, command, None, &no_progress)
        else {
            panic!("there is no trajectory");
        };
        let help = error.help.unwrap();
        assert!(
            help.contains("[prescribed]") && help.contains("[coordinate-sweep]"),
            "{help}"
        );
        assert!(!error.labels.is_empty());
    }
}

#[test]
fn columns_are_chosen_by_name_and_by_their_first_words() {
    let chosen = |names: &str| {
        let text = WEIGHTS.replace("[requests]", &format!("[requests]\nvariables = {names}"));
        analyse_trajectory(&scene(&text), Analysis::Statics, Some(5), &no_progress)
            .map(|result| Table::parse(&file(&result, "-statics.csv")).names)
    };
    assert_eq!(
        chosen(r#"["rocker.angle", "coupler.C", "A.x"]"#).unwrap(),
        ["phi", "coupler.C.x", "coupler.C.y", "rocker.angle", "A.x"]
    );
    assert_eq!(chosen(r#"["rocker.angular_velocity"]"#).unwrap(), ["phi"]);
    for (name, help) in [
        ("rockr.angle", "did you mean `rocker.angle`?"),
        ("rocker.angel", "did you mean `rocker.angle`?"),
        (
            "weight.force",
            "of the columns of `weight` there is only `weight.power`",
        ),
    ] {
        let Err(StudyError::Scene(error)) = chosen(&format!("[\"crank\", \"{name}\"]")) else {
            panic!("{name} is no column");
        };
        assert_eq!(error.message, format!("there is no column `{name}`"));
        assert_eq!(
            error.labelled(),
            [(&*format!("\"{name}\""), "unknown column")]
        );
        assert_eq!(error.help.unwrap(), help);
    }
}

/// A starter that begins at the very end of a motion has not moved anything: what rounding leaves of its energy is no error of the motion.
#[test]
fn a_body_at_rest_until_a_load_begins_at_the_end_is_a_result() {
    let text = r#"
        title = "A starter"
        [bodies.ground]
        points = { O = [0, 0] }
        [bodies.block]
        points = { P = [0, 0] }
        mass = 2.0
        center = "P"
        inertia = 0.01
        [joints]
        guide = { prismatic = ["ground.O", "block.P"], axis = [1, 0] }
        [actuators]
        x = { length = "guide" }
        [assembly]
        x = -0.5
        [drives]
        starter = { applied-force = "x", magnitude = "floor(0.5 * t)" }
        [motion]
        initial-velocity = { x = 0.0 }
        duration = 2.0
    "#;
    let settings = MotionSolver::Settings(SolverSettings::default());
    let motion = compute_free_motion(&scene(text), &settings, &no_progress).unwrap();
    assert!(motion.computed.early_stop.is_none());
    // Of each row the time, then x.
    let rows = &motion.computed.table.rows;
    assert!(rows.iter().all(|row| (row[1] + 0.5).abs() < 1e-12));
}

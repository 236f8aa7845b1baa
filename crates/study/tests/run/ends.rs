//! Ways that end early, and scenes that do not say their way.

use crate::table::{Table, WEIGHTS, case, file, follow, scene};
use dwell_study::{Command, StudyError, run, silent};

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
        Command::Kinematics,
        Command::Statics,
        Command::Kinetostatics,
    ] {
        let followed = follow(&scene(&limited("phi = [0.5, 6.0]")), command, 111);
        let table = Table::parse(&file(&followed, &format!("-{}.csv", command.name())));
        let phi = table.column("phi");
        // Positions are 0.05 rad apart.
        assert!(*phi.last().unwrap() < limit() && phi.last().unwrap() + 0.05 > limit());
        let Some(StudyError::Scene(stopped)) = followed.stopped else {
            panic!("it did not stop");
        };
        let told = stopped.message.split("phi = ").nth(1).unwrap();
        let told: f64 = told.split(' ').next().unwrap().parse().unwrap();
        // Eight digits are told.
        assert!((told - limit()).abs() < 1e-7, "{told} {}", limit());
        assert!(
            stopped.message.contains("`coupler`, `rocker`"),
            "{}",
            stopped.message
        );
        let pointed: Vec<_> = stopped
            .labelled()
            .iter()
            .map(|(text, _)| (*text).to_owned())
            .collect();
        assert!(pointed.contains(&"[sweep]".to_owned()), "{pointed:?}");
    }
}

/// With steps longer than the gap of the range, no position is out of range; it must not jump it.
#[test]
fn a_sweep_does_not_jump_over_what_it_cannot_pass() {
    let followed = follow(
        &scene(&limited("phi = [1.0, 13.56637061435917]")),
        Command::Kinematics,
        3,
    );
    assert!(followed.stopped.is_some());
    let table = Table::parse(&file(&followed, "-kinematics.csv"));
    assert_eq!(table.column("phi"), [1.0]);
}

#[test]
fn without_ends_a_sweep_fills_the_range_but_for_a_thousandth() {
    let followed = follow(&scene(&limited("")), Command::Kinematics, 21);
    assert!(followed.stopped.is_none());
    let phi = Table::parse(&file(&followed, "-kinematics.csv")).column("phi");
    for (at, end) in [(phi[0], -limit()), (phi[20], limit())] {
        // The ends of the range are found by halving, to about 1e-13.
        assert!((at - end * 0.998).abs() < 1e-9, "{at} {end}");
    }
}

#[test]
fn a_scene_that_does_not_say_its_way_is_told_what_to_add() {
    let mut unmoved = case("five-bar");
    unmoved.prescribed = None;
    let still = case("crank-rocker");
    for (scene, command) in [
        (&unmoved, Command::Kinematics),
        (&unmoved, Command::Statics),
        (&still, Command::Kinetostatics),
    ] {
        let Err(StudyError::Scene(error)) = run(scene, command, None, &silent) else {
            panic!("there is no way to take");
        };
        let help = error.help.unwrap();
        assert!(
            help.contains("[prescribed]") && help.contains("[sweep]"),
            "{help}"
        );
        assert!(!error.labels.is_empty());
    }
}

#[test]
fn columns_are_chosen_by_name_and_by_their_first_words() {
    let chosen = |names: &str| {
        let text = WEIGHTS.replace("[requests]", &format!("[requests]\nvariables = {names}"));
        run(&scene(&text), Command::Statics, Some(5), &silent)
            .map(|followed| Table::parse(&file(&followed, "-statics.csv")).names)
    };
    assert_eq!(
        chosen(r#"["rocker.angle", "coupler.C", "A.x"]"#).unwrap(),
        ["phi", "coupler.C.x", "coupler.C.y", "rocker.angle", "A.x"]
    );
    assert_eq!(chosen(r#"["rocker.speed"]"#).unwrap(), ["phi"]);
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

//! Kinetostatic states with every joint, every drive and every load, checked; and faults detected.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test, its producer of states too"
)]

mod energies;
#[path = "../subjects/gauss.rs"]
mod gauss;
mod mechanisms;
mod plain;
mod setup;

use dwell_findings::{Finding, all_pass};
use dwell_geometry::space::vec3;
use dwell_geometry::{BodyId, JointKind, vec2};
use dwell_verify::{
    Case, CheckedMechanism, ClaimedState, Pose, Range, check_states, rank, spread, verify_all,
};
use mechanisms::all;
use setup::Setup;

fn describe(findings: &[Finding]) -> String {
    let line = |f: &Finding| {
        format!(
            "{} {} {:.1e} of {:.1e} at {}\n",
            if f.pass { "pass" } else { "FAIL" },
            f.key,
            f.relative_difference,
            f.tolerance,
            f.worst_at
        )
    };
    findings.iter().map(line).collect()
}

fn findings_for(setup: &Setup, states: &[ClaimedState]) -> Vec<Finding> {
    setup.check(|assembled| check_states(assembled, states, 0))
}

#[test]
fn val_plain_solutions_pass() {
    for setup in all() {
        let findings = findings_for(&setup, &setup.states());
        println!("{}\n{}", setup.name, describe(&findings));
        assert_eq!(findings.len(), 9);
        assert!(
            all_pass(&findings),
            "{}\n{}",
            setup.name,
            describe(&findings)
        );
        // No check is so inaccurate that its tolerance was widened.
        for f in &findings {
            assert!(
                f.tolerance < 1e-10,
                "{}: {}",
                setup.name,
                describe(&findings)
            );
        }
    }
}

/// Every joint kind and drive occurs in some mechanism of the tests.
#[test]
fn nothing_is_left_untried() {
    let setups = all();
    let kinds = setups.iter().flat_map(|s| &s.mechanism.joints);
    let mut kinds_found: Vec<_> = kinds.map(|j| std::mem::discriminant(&j.kind)).collect();
    kinds_found.sort_by_key(|d| format!("{d:?}"));
    kinds_found.dedup();
    assert_eq!(kinds_found.len(), 9);
    let actuators = setups.iter().flat_map(|s| &s.mechanism.actuators);
    let mut kinds_found: Vec<_> = actuators.map(|a| std::mem::discriminant(&a.kind)).collect();
    kinds_found.sort_by_key(|d| format!("{d:?}"));
    kinds_found.dedup();
    assert_eq!(kinds_found.len(), 3);
}

fn failing(findings: &[Finding]) -> Vec<&str> {
    let failed = findings.iter().filter(|f| !f.pass);
    failed.map(|f| f.key.as_str()).collect()
}

/// A change of any number of a state by a millionth of the largest of its kind is found.
#[test]
fn every_number_counts() {
    for setup in all() {
        let states = setup.states();
        let count = |s: &ClaimedState| {
            [
                s.q.len(),
                s.q_dot.len(),
                s.q_ddot.len(),
                s.reactions.len(),
                s.tau.len(),
            ]
        };
        for (field, length) in count(&states[0]).into_iter().enumerate() {
            for k in 0..length {
                let mut wrong = states.clone();
                let s = &mut wrong[1];
                let values = [
                    &mut s.q,
                    &mut s.q_dot,
                    &mut s.q_ddot,
                    &mut s.reactions,
                    &mut s.tau,
                ];
                let Some(values) = values.into_iter().nth(field) else {
                    continue;
                };
                let largest = values.iter().fold(1e-2_f64, |m, v| m.max(v.abs()));
                values[k] += 1e-6 * largest;
                let findings = findings_for(&setup, &wrong);
                assert!(
                    !all_pass(&findings),
                    "{}: field {field}, number {k}\n{}",
                    setup.name,
                    describe(&findings)
                );
            }
        }
        for body in 1..setup.mechanism.bodies.len() {
            for c in 0..3 {
                for field in 0..3 {
                    let mut wrong = states.clone();
                    let s = &mut wrong[1];
                    let mut change = [0.0; 3];
                    change[c] = 1e-6;
                    let moved =
                        |[x, y, angle]: [f64; 3]| [x + change[0], y + change[1], angle + change[2]];
                    match field {
                        0 => s.poses[body] = moved(s.poses[body].in_plane()).into(),
                        1 => s.velocities[body] = moved(s.velocities[body].in_plane()).into(),
                        _ => s.accelerations[body] = moved(s.accelerations[body].in_plane()).into(),
                    }
                    let findings = findings_for(&setup, &wrong);
                    assert!(!all_pass(&findings), "{}: {body} {c} {field}", setup.name);
                }
            }
        }
    }
}

/// A load that was left out, and one that acts elsewhere.
#[test]
fn loads_count() {
    for setup in all() {
        let states = setup.states();
        let findings = |change: &dyn Fn(&mut ClaimedState)| {
            let mut wrong = states.clone();
            change(&mut wrong[2]);
            findings_for(&setup, &wrong)
        };
        let without = findings(&|s| {
            s.load_wrenches.remove(0);
        });
        let failed = failing(&without);
        for key in [
            "state-reactions",
            "state-newton-euler",
            "state-newton-euler-differences",
            "state-momentum",
        ] {
            assert!(
                failed.contains(&key),
                "{}\n{}",
                setup.name,
                describe(&without)
            );
        }
        let elsewhere = findings(&|s| s.load_wrenches[0].point += vec3(1e-3, 1e-3, 0.0));
        assert!(failing(&elsewhere).contains(&"state-reactions"));
    }
}

/// Missing or non-finite values are rejected with a message, not with a panic.
#[test]
fn broken_states_are_refused() {
    let setup = &all()[0];
    let failure_message = |change: &dyn Fn(&mut ClaimedState)| {
        let mut states = setup.states();
        change(&mut states[0]);
        let findings = findings_for(setup, &states);
        assert!(findings.iter().all(|f| !f.pass), "{}", describe(&findings));
        findings[0].worst_at.clone()
    };
    let message = failure_message(&|s| {
        s.reactions.pop();
    });
    assert!(
        message.ends_with("9 reactions where there are 10"),
        "{message}"
    );
    let message = failure_message(&|s| s.load_wrenches[0].body = BodyId(40));
    assert!(message.ends_with("a load acts on body 40, but there are 5 bodies"));
    failure_message(&|s| s.poses[1].position.x = f64::NAN);
    failure_message(&|s| s.velocities.clear());
    assert!(findings_for(setup, &[]).iter().all(|f| !f.pass));
}

/// In a geared mechanism the arm is elsewhere after a whole revolution.
#[test]
fn a_turn_that_was_lost_is_found() {
    use std::f64::consts::TAU;
    let setup = all().into_iter().find(|s| s.name == "epicyclic").unwrap();
    let mut states = setup.states();
    assert!(all_pass(&findings_for(&setup, &states)));
    states[0].q[0] += TAU;
    let findings = findings_for(&setup, &states);
    assert_eq!(findings[0].key, "state-poses");
    assert!(!findings[0].pass);
    // Elsewhere it is.
    let setup = all().into_iter().find(|s| s.name == "five-bar").unwrap();
    let mut states = setup.states();
    states[0].q[0] += TAU;
    assert!(all_pass(&findings_for(&setup, &states)));
}

/// The position of the mechanism has no influence: the producer's rounding at a kilometre, in plain
/// coordinates, is 1e-13 m.
#[test]
fn val_mechanisms_far_away_pass() {
    for setup in all() {
        let far = setup.moved(vec2(800.0, -300.0));
        let findings = findings_for(&far, &far.states());
        assert!(all_pass(&findings), "{}\n{}", far.name, describe(&findings));
    }
}

/// The checks of the reduced model pass with every joint, and for a coordinate that is a length.
#[test]
fn val_reduced_checks_with_every_joint() {
    for (name, range) in [
        ("epicyclic", Range::Limited(-1.0, 2.0)),
        ("wedge", Range::Limited(0.5, 0.7)),
        ("cam", Range::Limited(0.4, 1.2)),
    ] {
        let setup = all().into_iter().find(|s| s.name == name).unwrap();
        let case = Case {
            mechanism: CheckedMechanism::Plane(&setup.mechanism, (&setup.masses).into()),
            range,
            positions: spread(range, 6),
        };
        let findings = verify_all(&case, &setup, &[]);
        println!("{name}\n{}", describe(&findings));
        assert!(
            findings.len() > 12 && all_pass(&findings),
            "{name}\n{}",
            describe(&findings)
        );
    }
}

#[test]
fn val_all_are_determinate_and_of_full_rank() {
    for setup in all() {
        let state = &setup.states()[0];
        let frames: Vec<[f64; 3]> = state.poses.iter().map(Pose::in_plane).collect();
        let ranks = rank(&setup.mechanism, &frames).unwrap();
        let actuators = setup.mechanism.actuators.len();
        assert_eq!(
            ranks.with_actuators.degrees_of_freedom(),
            0,
            "{}",
            setup.name
        );
        assert_eq!(ranks.with_actuators.redundant_count(), 0, "{}", setup.name);
        assert_eq!(
            ranks.joints.degrees_of_freedom(),
            actuators,
            "{}",
            setup.name
        );
        assert!(
            ranks.joints.dependent_rows.is_empty()
                && ranks.with_actuators.movable_bodies.is_empty()
        );
    }
    // One guide more than the slider needs: its moment is held twice.
    let mut setup = all().into_iter().find(|s| s.name == "wedge").unwrap();
    let second_guide = setup.mechanism.joints[0].clone();
    assert!(matches!(second_guide.kind, JointKind::Prismatic { .. }));
    setup.mechanism.joints.push(second_guide);
    let ranks = rank(&setup.mechanism, &setup.assembly_poses).unwrap();
    let last = setup.mechanism.reactions().len();
    assert_eq!(ranks.joints.redundant_count(), 2);
    assert_eq!(ranks.joints.dependent_rows, [0, 1, last - 2, last - 1]);
    assert!(ranks.joints.singular_values.is_sorted_by(|a, b| a >= b));
    // Whatever the two guides share, only the sum must balance: 3 and −3 more than one of them alone.
    let mut single = all().into_iter().find(|s| s.name == "wedge").unwrap();
    let mut states = single.states();
    for state in &mut states {
        state.reactions[0] += 3.0;
        state.reactions.extend([-3.0, 0.0]);
    }
    let findings = findings_for(&setup, &states);
    assert!(all_pass(&findings), "{}", describe(&findings));
    states[0].reactions[last - 2] += 0.01;
    let failed = findings_for(&setup, &states);
    let failed = failed.iter().filter(|f| !f.pass).map(|f| f.key.as_str());
    assert!(failed.collect::<Vec<_>>().contains(&"state-newton-euler"));
    // Without its drive nothing is determined.
    single.mechanism.actuators.clear();
    let findings = findings_for(&single, &[ClaimedState::default()]);
    assert_eq!(findings.len(), 1);
    assert!(
        findings[0].worst_at.contains("not determinate"),
        "{}",
        findings[0].worst_at
    );
}

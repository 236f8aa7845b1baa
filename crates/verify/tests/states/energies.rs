//! The checks of kinetic energy and virtual work on every mechanism of the tests: they agree with a plain
//! solution, and see every number of it that is wrong.

use crate::mechanisms::all;
use crate::setup::Setup;
use crate::{describe, failing};
use dwell_findings::{Finding, all_pass};
use dwell_verify::{ClaimedState, check_energies};

/// M, row by row, from a run at unit acceleration for each coordinate.
fn inertias(setup: &Setup, state: &ClaimedState) -> Vec<f64> {
    let n = state.q.len();
    let columns: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            setup.unloaded_at([state.q.clone(), vec![0.0; n], unit]).tau
        })
        .collect();
    (0..n * n).map(|k| columns[k % n][k / n]).collect()
}

fn with_inertias(setup: &Setup, states: &[ClaimedState]) -> Vec<ClaimedState> {
    let with_own = |state: &ClaimedState| ClaimedState {
        inertias: inertias(setup, state),
        ..state.clone()
    };
    states.iter().map(with_own).collect()
}

fn findings_for(setup: &Setup, states: &[ClaimedState]) -> Vec<Finding> {
    let states = with_inertias(setup, states);
    setup.check(|assembled| check_energies(assembled, &states))
}

#[test]
fn val_plain_solutions_have_their_energies() {
    for setup in all() {
        let findings = findings_for(&setup, &setup.states());
        let keys: Vec<&str> = findings.iter().map(|f| f.key.as_str()).collect();
        assert_eq!(
            keys,
            [
                "state-mass-matrix",
                "state-kinetic-energy",
                "state-lagrange",
                "state-released"
            ]
        );
        assert!(
            all_pass(&findings),
            "{}\n{}",
            setup.name,
            describe(&findings)
        );
    }
}

/// A reaction or action that is off by a millionth of the largest, and one whose sign is wrong.
#[test]
fn every_action_and_reaction_counts() {
    for setup in all() {
        let states = setup.states();
        for k in 0..states[1].tau.len() {
            let mut wrong = states.clone();
            wrong[1].tau[k] += 1e-6 * wrong[1].tau[k].abs().max(1.0);
            let findings = findings_for(&setup, &wrong);
            assert_eq!(
                failing(&findings),
                ["state-lagrange"],
                "{} {k}\n{}",
                setup.name,
                describe(&findings)
            );
        }
        for k in 0..states[1].reactions.len() {
            let largest = states[1]
                .reactions
                .iter()
                .fold(1.0_f64, |m, r| m.max(r.abs()));
            let mut wrong = states.clone();
            wrong[1].reactions[k] += 1e-6 * largest;
            let findings = findings_for(&setup, &wrong);
            assert_eq!(
                failing(&findings),
                ["state-released"],
                "{} {k}\n{}",
                setup.name,
                describe(&findings)
            );
        }
    }
}

/// Every omitted term of the equations is found: those of speeds, of accelerations, and of a load.
#[test]
fn every_term_counts() {
    let mut detected = [0; 3];
    for setup in all() {
        let states = setup.states();
        let terms: [fn(&mut ClaimedState); 3] = [
            |s| s.q_dot.fill(0.0),
            |s| s.q_ddot.fill(0.0),
            |s| {
                s.load_wrenches
                    .truncate(s.load_wrenches.len().saturating_sub(1));
            },
        ];
        for (term, detected) in terms.into_iter().zip(&mut detected) {
            // Forces of the whole state, compared with equations without the term.
            let mut wrong = states.clone();
            term(&mut wrong[1]);
            if wrong == states {
                continue;
            }
            let findings = findings_for(&setup, &wrong);
            let failed = failing(&findings);
            *detected += usize::from(
                failed.contains(&"state-lagrange") || failed.contains(&"state-released"),
            );
        }
    }
    // A term may have no part in a mechanism that moves straight, or a load none in one that rests on it.
    assert!(
        detected.iter().all(|&detected| detected + 2 >= all().len()),
        "{detected:?} of {}",
        all().len()
    );
}

/// Inertias and velocities that are off.
#[test]
fn every_inertia_and_velocity_counts() {
    for setup in all() {
        let states = setup.states();
        let sound = with_inertias(&setup, &states);
        for k in 0..sound[1].inertias.len() {
            let mut wrong = sound.clone();
            let (n, own) = (states[1].q.len(), &sound[1].inertias);
            let size = (own[k / n * (n + 1)] * own[k % n * (n + 1)]).sqrt();
            wrong[1].inertias[k] -= 1e-9 * size;
            let findings = setup.check(|assembled| check_energies(assembled, &wrong));
            assert!(
                failing(&findings).contains(&"state-mass-matrix"),
                "{}\n{}",
                setup.name,
                describe(&findings)
            );
        }
        let mut wrong = states.clone();
        for velocity in &mut wrong[1].velocities {
            *velocity = velocity.in_plane().map(|v| v * (1.0 + 1e-6)).into();
        }
        let findings = findings_for(&setup, &wrong);
        assert_eq!(
            failing(&findings),
            ["state-kinetic-energy"],
            "{}\n{}",
            setup.name,
            describe(&findings)
        );
    }
}

#[test]
fn what_is_not_claimed_fails() {
    let mut setup = all().remove(0);
    let states = setup.states();
    let findings = setup.check(|assembled| check_energies(assembled, &states));
    assert_eq!(
        failing(&findings),
        ["state-mass-matrix", "state-kinetic-energy"]
    );
    setup.masses.remove(0);
    let findings = setup.check(|assembled| check_energies(assembled, &states));
    assert!(!all_pass(&findings));
}

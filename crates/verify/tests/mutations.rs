//! Every check fails on the faults that it is meant to detect, and only there.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test")]

mod subjects;

use dwell_geometry::Mechanism;
use dwell_verify::{Case, CheckedMechanism, Coefficients, Subject, SubjectError, verify_all};
use subjects::dense::{DenseSubject, Mutation};
use subjects::mechanisms::{Setup, crank_rocker, inverted_slider_crank, single_dwell};
use subjects::mutated::MutatedSubject;

/// Keys of the findings that fail, in order.
fn failing(case: &Case<'_>, subject: &dyn Subject) -> Vec<String> {
    let findings = verify_all(case, subject, &[]);
    findings
        .into_iter()
        .filter(|f| !f.pass)
        .map(|f| f.key)
        .collect()
}

/// Exactly these findings fail.
fn assert_failing(setup: &Setup, subject: &dyn Subject, keys: &[&str]) {
    assert_eq!(failing(&setup.case(12), subject), keys);
}

const SLOPE: [&str; 3] = ["half-dm-differences", "half-dm-power", "half-dm-spectral"];

fn index(mechanism: &Mechanism, name: &str) -> usize {
    let named = |&r: &dwell_geometry::Reaction| mechanism.reaction_name(r) == name;
    let reactions = mechanism.reactions();
    reactions.iter().position(named).expect(name)
}

/// The slip of the paper's own notation: m′ for ½ m′.
#[test]
fn the_whole_slope_instead_of_half() {
    let setup = crank_rocker();
    let subject = setup.subject();
    let mutated = MutatedSubject::new(&subject)
        .coefficients(|c| c.half_dm *= 2.0)
        .inverse_dynamics(|a, c, [q_dot, _]| a.tau += c.half_dm * q_dot * q_dot);
    let keys = [&SLOPE[..], &["power", "momentum-moment", "euler-moment"]].concat();
    assert_failing(&setup, &mutated, &keys);
}

/// An inner reaction cancels in the balance of the whole; only single bodies show it.
#[test]
fn a_flipped_inner_reaction() {
    let setup = crank_rocker();
    let subject = setup.subject();
    let k = index(&setup.mechanism, "B.x");
    let mutated = MutatedSubject::new(&subject)
        .coefficients(move |c| (c.a[k], c.b[k]) = (-c.a[k], -c.b[k]))
        .inverse_dynamics(move |a, _, _| a.reactions[k] = -a.reactions[k]);
    let keys = [
        "a-released",
        "b-released",
        "b-virtual-power",
        "newton-force",
        "euler-moment",
    ];
    assert_failing(&setup, &mutated, &keys);
}

/// In the inverted slider-crank the ground is the second body of O.
#[test]
fn a_flipped_ground_reaction() {
    let setup = inverted_slider_crank();
    let subject = setup.subject();
    for name in ["O.x", "O.y", "A.x", "A.y"] {
        let k = index(&setup.mechanism, name);
        let mutated = MutatedSubject::new(&subject)
            .coefficients(move |c| (c.a[k], c.b[k]) = (-c.a[k], -c.b[k]))
            .inverse_dynamics(move |a, _, _| a.reactions[k] = -a.reactions[k]);
        let mut keys = vec![
            "a-released",
            "b-released",
            "b-virtual-power",
            "momentum-force",
        ];
        // A stands in the origin, the middle of the ground's attachments is elsewhere: both give
        // moments.
        keys.extend(["momentum-moment", "newton-force", "euler-moment"]);
        // The ground's middle lies on the line x = 0 of both pins: no moment from a y force.
        if name.ends_with('y') {
            keys.retain(|&k| k != "momentum-moment");
        }
        assert_failing(&setup, &mutated, &keys);
    }
}

fn with_mutation(setup: &Setup, mutation: Mutation) -> DenseSubject {
    let mut subject = setup.subject();
    subject.mutation = mutation;
    subject
}

/// Everything that depends on q̇² is wrong, nothing that depends on q̈ is. A dropped centrifugal force acts at the
/// centre of mass, so the moments about it do not change.
#[test]
fn a_dropped_velocity_term() {
    let setup = inverted_slider_crank();
    let keys = [
        &SLOPE[..],
        &["b-released", "b-virtual-power", "power"],
        &["momentum-force", "momentum-moment", "newton-force"],
    ]
    .concat();
    assert_failing(
        &setup,
        &with_mutation(&setup, Mutation::NoCentrifugal),
        &keys,
    );
    let keys = [&keys[..], &["euler-moment"]].concat();
    assert_failing(
        &setup,
        &with_mutation(&setup, Mutation::NoVelocityProduct),
        &keys,
    );
}

/// A rotary inertia misread by a half: it changes everything except the poses.
#[test]
fn a_halved_inertia() {
    let setup = single_dwell();
    for body in 1..5 {
        let mut masses = setup.masses.clone();
        masses[body].inertia *= 0.5;
        let failing = failing(&setup.case(12), &setup.subject_with(&masses));
        for key in ["m-energy", "m-energy-varying", "euler-moment"] {
            assert!(failing.iter().any(|f| f == key), "body {body}: {failing:?}");
        }
        // The crank's does not vary, so that its slope is right: only the others' slope is not.
        let slope = failing.iter().any(|f| f == "half-dm-spectral");
        assert_eq!(slope, body != 1, "body {body}: {failing:?}");
    }
}

#[test]
fn the_moment_of_a_prismatic_joint_omitted() {
    let setup = inverted_slider_crank();
    let subject = setup.subject();
    let k = index(&setup.mechanism, "slot.moment");
    let mutated = MutatedSubject::new(&subject)
        .coefficients(move |c| (c.a[k], c.b[k]) = (0.0, 0.0))
        .inverse_dynamics(move |a, _, _| a.reactions[k] = 0.0);
    let keys = [
        "a-released",
        "b-released",
        "b-virtual-power",
        "euler-moment",
    ];
    assert_failing(&setup, &mutated, &keys);
}

/// A part in 1e9 of one answer at a time.
#[test]
fn a_part_in_a_thousand_million() {
    const BY: f64 = 1.0 + 1e-9;
    let setup = single_dwell();
    let subject = setup.subject();
    let whole = |alter: fn(&mut Coefficients)| MutatedSubject::new(&subject).coefficients(alter);
    assert_failing(
        &setup,
        &whole(|c| c.m *= BY),
        &["m-energy", "m-energy-varying"],
    );
    assert_failing(&setup, &whole(|c| c.half_dm *= BY), &SLOPE);
    let scale = |values: &mut Vec<f64>| values.iter_mut().for_each(|v| *v *= BY);
    let mutated = MutatedSubject::new(&subject).coefficients(|c| scale(&mut c.a));
    assert_failing(&setup, &mutated, &["a-released"]);
    let mutated = MutatedSubject::new(&subject).coefficients(|c| scale(&mut c.b));
    assert_failing(&setup, &mutated, &["b-released", "b-virtual-power"]);
    let mutated = MutatedSubject::new(&subject).inverse_dynamics(|a, _, _| a.tau *= BY);
    assert_failing(
        &setup,
        &mutated,
        &["power", "momentum-moment", "euler-moment"],
    );
    let mutated = MutatedSubject::new(&subject).inverse_dynamics(|a, _, _| scale(&mut a.reactions));
    let keys = [
        "momentum-force",
        "momentum-moment",
        "newton-force",
        "euler-moment",
    ];
    assert_failing(&setup, &mutated, &keys);
    let mutated = MutatedSubject::new(&subject).poses(|_, poses| poses[3][2] += 1e-9);
    // Every other check starts from the poses closed again, which are right.
    assert_failing(&setup, &mutated, &["closure"]);
}

/// A flywheel of nearly all the inertia hides an error in the rest from m, not from its varying
/// part.
#[test]
fn an_error_behind_a_flywheel() {
    let mut setup = single_dwell();
    setup.masses[1].inertia = 1e4;
    let subject = setup.subject();
    let mutated = MutatedSubject::new(&subject).coefficients(|c| c.m += 3e-10 * (c.m - 1e4));
    let failing = failing(&setup.case(12), &mutated);
    assert!(!failing.contains(&"m-energy".to_owned()));
    assert!(failing.contains(&"m-energy-varying".to_owned()));
}

/// Both branches close, so that only following them shows a change from one to the other.
#[test]
fn a_change_of_branch() {
    let setup = crank_rocker();
    let mut mirrored = crank_rocker();
    for pose in &mut mirrored.initial_guess {
        pose[2] = -pose[2];
    }
    let (upper, lower) = (setup.subject(), mirrored.subject());
    let mutated = MutatedSubject::new(&upper).poses(|q, poses| {
        if q > 3.0 {
            poses.clone_from_slice(&lower.frames(q).unwrap());
        }
    });
    let failing = failing(&setup.case(12), &mutated);
    assert!(!failing.contains(&"closure".to_owned()));
    assert!(failing.contains(&"branch".to_owned()));
}

/// Missing answers, NaN, and too few numbers give failed findings, not a panic.
#[test]
fn a_subject_without_answers() {
    struct Silent;
    impl Subject for Silent {
        fn poses(&self, q: f64) -> Result<Vec<dwell_verify::Pose>, SubjectError> {
            self.coefficients(q).map(|_| Vec::new())
        }
        fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
            let message = "no idea".into();
            Err(SubjectError { q, message })
        }
        fn inverse_dynamics(
            &self,
            q: f64,
            _: f64,
            _: f64,
        ) -> Result<dwell_verify::InverseDynamics, SubjectError> {
            self.poses(q).map(|_| unreachable!())
        }
    }
    let setup = crank_rocker();
    let case = setup.case(4);
    let findings = verify_all(&case, &Silent, &[]);
    assert!(findings.iter().all(|f| !f.pass));
    assert!(
        findings[0].worst_at.contains("no idea"),
        "{}",
        findings[0].worst_at
    );

    let subject = setup.subject();
    let all: Vec<_> = verify_all(&case, &subject, &[])
        .into_iter()
        .map(|f| f.key)
        .collect();
    let nan = MutatedSubject::new(&subject)
        .coefficients(|c| {
            (c.m, c.half_dm) = (f64::NAN, f64::NAN);
            c.a.fill(f64::NAN);
            c.b.fill(f64::NAN);
        })
        .inverse_dynamics(|a, _, _| {
            a.tau = f64::NAN;
            a.reactions.fill(f64::NAN);
        });
    assert_eq!(failing(&case, &nan), all[2..]);
    let short = MutatedSubject::new(&subject)
        .coefficients(|c| c.a.truncate(3))
        .inverse_dynamics(|a, _, _| a.reactions.truncate(3));
    let failed = failing(&case, &short);
    assert!(
        failed.contains(&"a-released".to_owned()) && failed.contains(&"newton-force".to_owned())
    );
    let lost = MutatedSubject::new(&subject).poses(|_, poses| poses[2][0] = f64::INFINITY);
    assert!(failing(&case, &lost).contains(&"closure".to_owned()));

    let mut nowhere = setup.case(0);
    assert!(verify_all(&nowhere, &subject, &[]).iter().all(|f| !f.pass));
    nowhere.mechanism = CheckedMechanism::Plane(&setup.mechanism, (&setup.masses[1..]).into());
    let findings = verify_all(&nowhere, &subject, &[]);
    assert_eq!(findings.len(), 1);
    assert_eq!(findings[0].worst_at, "3 masses for 4 bodies");
}

//! The quick part of the fault study of `tests/faults`: all faults, on a few machines on which each is
//! one.

#[path = "../faults/claims.rs"]
mod claims;
#[path = "../faults/machine.rs"]
mod machine;
#[path = "../faults/motions.rs"]
mod motions;
#[path = "../faults/operations.rs"]
mod operations;
#[path = "../faults/plain.rs"]
mod plain;
#[path = "../faults/published.rs"]
mod published;
#[path = "../faults/reduced.rs"]
mod reduced;
#[path = "../faults/standing.rs"]
mod standing;
#[path = "../faults/study.rs"]
#[allow(dead_code, reason = "the whole study asks for more")]
mod study;
#[path = "../faults/verdict.rs"]
#[allow(dead_code, reason = "the whole study asks for more")]
mod verdict;
#[path = "../faults/watched.rs"]
#[allow(dead_code, reason = "the whole study asks for more")]
mod watched;
#[path = "../faults/wrench.rs"]
mod wrench;

use dwell_findings::Finding;
use machine::{By, Machine};
use operations::{Outcome, Slipped};
use study::{Study, scene};
use verdict::Verdict;
use watched::{Operation, Place, Slip};

/// Every kind of load and joint that a fault needs.
const MACHINES: [&str; 3] = ["cross-slide", "planetary", "slider-crank-friction"];

#[test]
fn every_fault_in_an_equation_is_caught_by_two_truths() {
    let models = study::models().into_iter();
    let some = models.filter(|m| ["single-dwell", "turning-rail"].contains(&m.scene.name.as_str()));
    let some: Vec<_> = some.collect();
    let study = Study::of(MACHINES.map(scene).to_vec(), &some);
    assert_eq!(study.holes(), Vec::<String>::new());
    assert!(study.blind.is_empty(), "{:?}", study.blind);
    // It would be a bad sign if evaluating met few operations, or if few of their faults were felt.
    let felt = study
        .slips
        .iter()
        .filter(|s| matches!(s.outcome, Outcome::Judged(..)));
    assert!(felt.count() > 1000, "of {}", study.slips.len());
}

/// The paper's own case: a swapped branch conserves energy, and is caught by [assembly] and by publication.
#[test]
fn the_other_branch_is_caught_by_the_assembly_and_by_published_values() {
    let models = study::models();
    let verdict = models[0].judge(Some(reduced::Fault::OtherBranch));
    let verdict = verdict.expect("it is another branch");
    let caught: Vec<usize> = (0..10).filter(|&truth| verdict.caught(truth)).collect();
    assert_eq!(caught, [0, 9]);
}

/// A dropped velocity term, as in published programs, is seen by at least nine digits.
#[test]
fn a_dropped_centrifugal_term_cannot_be_missed() {
    for model in study::models() {
        let verdict = model.judge(Some(reduced::Fault::NoCentrifugal));
        let verdict = verdict.expect("off-centre bodies");
        let digits = verdict
            .digits
            .iter()
            .flatten()
            .fold(0.0_f64, |m, d| m.max(*d));
        assert!(
            verdict.count() >= 4 && digits > 9.0,
            "{}: {verdict:?}",
            model.scene.name
        );
    }
}

/// Without a fault nothing slips, and a slip is one of the line that it names alone.
#[test]
fn a_slip_is_of_one_line() {
    let machine = Machine::new(scene("cross-slide"), By::States);
    assert_eq!(machine.moved(None), Some(0.0));
    let places = machine.places();
    let of_motion =
        |p: &&Place| p.file.ends_with("motion.rs") && p.operation == Operation::Difference;
    let mut felt = 0;
    for &place in places.iter().filter(of_motion) {
        let elsewhere = Place { line: 1, ..place };
        assert_eq!(machine.moved(Some((elsewhere, Slip::Sign))), Some(0.0));
        let moved = machine.moved(Some((place, Slip::Sign)));
        felt += usize::from(moved.is_none_or(|by| by > machine::SAME));
    }
    assert!(felt >= 5, "{felt}");
    assert_eq!(machine.moved(None), Some(0.0));
}

/// One truth is not enough, and two findings of one truth are one.
#[test]
fn a_fault_that_one_truth_catches_is_a_hole() {
    let failed = |truth: &str, relative: f64| Finding {
        truth: truth.into(),
        relative,
        tolerance: 1e-12,
        ..Finding::default()
    };
    let slipped = |findings: &[Finding]| Slipped {
        place: Place {
            file: "",
            line: 1,
            column: 1,
            operation: Operation::Sum,
            link: 0,
        },
        slip: Slip::Sign,
        outcome: Outcome::Judged(Verdict::of(findings), Vec::new()),
    };
    let twice = [failed("0 closure", 1.0), failed("0 closure", f64::NAN)];
    assert!(slipped(&twice).missed());
    assert!(slipped(&[failed("0 closure", 1.0), failed("8 each body", 5e-12)]).missed());
    assert!(!slipped(&[failed("0 closure", 1.0), failed("8 each body", 1e-9)]).missed());
}

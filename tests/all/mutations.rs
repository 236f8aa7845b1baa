//! The quick part of the fault study of `tests/mutations`: all faults, on a few machines on which each is
//! one.

use dwell_findings::{Check, Finding};
use dwell_tests::fixtures::repository_root;
use dwell_tests::mutations::detection::Detection;
use dwell_tests::mutations::mutating_scalar::{MutationKind, Operation, SourceOperation};
use dwell_tests::mutations::operations::{MutationOutcome, MutationResult};
use dwell_tests::mutations::reduced_model;
use dwell_tests::mutations::source::SourceFiles;
use dwell_tests::mutations::study::{self, Study, scene};
use dwell_tests::mutations::tallies;
use dwell_tests::mutations::tested_mechanism::{self, CheckMode, TestedMechanism};

/// Every kind of load and joint that a fault needs.
const MECHANISMS: [&str; 3] = ["cross-slide", "planetary", "slider-crank-friction"];

#[test]
fn every_fault_in_an_equation_is_detected_by_two_checks() {
    let models = study::tested_models().into_iter();
    let some = models.filter(|m| ["single-dwell", "turning-rail"].contains(&m.scene.name.as_str()));
    let some: Vec<_> = some.collect();
    let study = Study::run(MECHANISMS.map(scene).to_vec(), &some);
    assert_eq!(study.gaps(), Vec::<String>::new());
    assert!(study.ignored.is_empty(), "{:?}", study.ignored);
    // Every function in which an operation was changed belongs to a step.
    let operations = study.operation_results.iter().map(|r| r.operation);
    let source = SourceFiles::read(&repository_root(), operations);
    assert!(
        tallies::by_step(&study.operation_results, &source, tallies::evaluation_step).len() > 15
    );
    // It would be a bad sign if evaluating met few operations, or if few of their faults were felt.
    let effective = study
        .operation_results
        .iter()
        .filter(|s| matches!(s.outcome, MutationOutcome::Checked(..)));
    assert!(
        effective.count() > 1000,
        "of {}",
        study.operation_results.len()
    );
}

/// The paper's own case: a swapped branch conserves energy, and is caught by [assembly] and by publication.
#[test]
fn the_other_branch_is_caught_by_the_assembly_and_by_published_values() {
    let models = study::tested_models();
    let detection = models[0].check(Some(reduced_model::Mutation::OtherBranch));
    let detection = detection.expect("it is another branch");
    let caught: Vec<usize> = (0..10).filter(|&check| detection.detects(check)).collect();
    assert_eq!(caught, [0, 9]);
}

/// A dropped velocity term, as in published programs, is seen by at least nine digits.
#[test]
fn a_dropped_centrifugal_term_cannot_be_missed() {
    for model in study::tested_models() {
        let detection = model.check(Some(reduced_model::Mutation::NoCentrifugal));
        let detection = detection.expect("off-centre bodies");
        let digits = detection
            .digits
            .iter()
            .flatten()
            .fold(0.0_f64, |m, d| m.max(*d));
        assert!(
            detection.check_count() >= 4 && digits > 9.0,
            "{}: {detection:?}",
            model.scene.name
        );
    }
}

/// Without a mutation nothing is mutated, and a mutation is one of the line that it names alone.
#[test]
fn a_mutation_is_of_one_line() {
    let machine = TestedMechanism::new(scene("cross-slide"), CheckMode::States);
    assert_eq!(machine.change(None), Some(0.0));
    let operations = machine.operations();
    let of_motion = |p: &&SourceOperation| {
        p.file.ends_with("motion.rs") && p.operation == Operation::Difference
    };
    let mut effective = 0;
    for &operation in operations.iter().filter(of_motion) {
        let elsewhere = SourceOperation {
            line: 1,
            ..operation
        };
        assert_eq!(
            machine.change(Some((elsewhere, MutationKind::Sign))),
            Some(0.0)
        );
        let change = machine.change(Some((operation, MutationKind::Sign)));
        effective +=
            usize::from(change.is_none_or(|by| by > tested_mechanism::UNCHANGED_TOLERANCE));
    }
    assert!(effective >= 5, "{effective}");
    assert_eq!(machine.change(None), Some(0.0));
}

/// One check is not enough, and two findings of one check count once.
#[test]
fn a_fault_that_one_check_detects_is_a_gap() {
    let failed = |check: Check, relative: f64| Finding {
        check,
        relative_difference: relative,
        tolerance: 1e-12,
        ..Finding::default()
    };
    let result = |findings: &[Finding]| MutationResult {
        operation: SourceOperation {
            file: "",
            line: 1,
            column: 1,
            operation: Operation::Sum,
            link: 0,
        },
        kind: MutationKind::Sign,
        outcome: MutationOutcome::Checked(Detection::from_findings(findings), Vec::new()),
    };
    let detected_by_two = [
        failed(Check::ConstraintClosure, 1.0),
        failed(Check::ConstraintClosure, f64::NAN),
    ];
    assert!(result(&detected_by_two).undetected());
    assert!(
        result(&[
            failed(Check::ConstraintClosure, 1.0),
            failed(Check::NewtonEuler, 5e-12)
        ])
        .undetected()
    );
    assert!(
        !result(&[
            failed(Check::ConstraintClosure, 1.0),
            failed(Check::NewtonEuler, 1e-9)
        ])
        .undetected()
    );
}

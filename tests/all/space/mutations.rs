//! The mutation study in space: all faults of single operations, and that a check of states can fail.

use dwell_tests::fixtures::repository_root;
use dwell_tests::mutations::operations::{MutatedSubject as _, MutationOutcome};
use dwell_tests::mutations::source::SourceFiles;
use dwell_tests::mutations::space::{steps, study, tested::TestedSpace};
use dwell_tests::mutations::tallies;

/// On all mechanisms of the study: a fault may be felt on several and seen on some.
#[test]
fn every_fault_of_an_operation_in_space_is_detected_by_two_checks() {
    let scenes = study::scenes();
    let study = study::run_operations(&scenes);
    assert_eq!(study.gaps(), Vec::<String>::new());
    let mut ignored = study.ignored.iter().map(|(name, ..)| name.as_str());
    assert_eq!(ignored.next(), None);
    // Every function in which an operation was changed belongs to a step.
    let operations = study.operation_results.iter().map(|r| r.operation);
    let source = SourceFiles::read(&repository_root(), operations);
    let steps = tallies::by_step(&study.operation_results, &source, steps::evaluation_step);
    assert!(steps.len() > 12, "{}", steps.len());
    // It would be a bad sign if evaluating met few operations, or if few of their faults were felt.
    let effective = study
        .operation_results
        .iter()
        .filter(|s| matches!(s.outcome, MutationOutcome::Checked(..)));
    let count = effective.count();
    assert!(count > 1200, "{count} of {}", study.operation_results.len());
}

/// The gyroscopic term does no work: inertias, energies and power are blind to it, and reactions are not.
#[test]
fn the_gyroscopic_term_is_seen_by_reactions_and_balances_alone() {
    let scene = study::scene("rsur");
    let tested = TestedSpace::new(&scene);
    let source = SourceFiles::read(&repository_root(), tested.operations().into_iter());
    let line = "tensor(motion.angular_acceleration) + w.cross(";
    let terms = tested.operations().into_iter().filter(|o| {
        let is_sum = o.operation == dwell_tests::mutations::mutating_scalar::Operation::Sum;
        is_sum && source.line(*o).contains(line)
    });
    let forgotten = dwell_tests::mutations::mutating_scalar::MutationKind::SecondTermOmitted;
    let terms: Vec<_> = terms.collect();
    assert_eq!(terms.len(), 2, "{terms:?}");
    for operation in terms {
        let detection = tested.check(Some((operation, forgotten)));
        let seen: Vec<usize> = (0..10).filter(|n| detection.detects(*n)).collect();
        assert_eq!(seen, [3, 7, 8], "{operation:?}");
    }
}

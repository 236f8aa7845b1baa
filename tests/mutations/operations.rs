//! Every sign and every term of every step of a plan, in the product's own lines.

use super::detection::{Detection, REQUIRED_CHECKS};
use super::mutating_scalar::{MutationKind, SourceOperation};
use super::tested_mechanism::{CheckMode, OperationMutation, TestedMechanism, UNCHANGED_TOLERANCE};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What the faults are tried on.
pub trait MutatedSubject: Sync {
    fn name(&self) -> &str;
    /// How it is checked.
    fn mode(&self) -> CheckMode;
    /// Every operation of its evaluation.
    fn operations(&self) -> BTreeSet<SourceOperation>;
    /// How far a mutation changes the results, relative to the largest of each kind; none where there is
    /// no result at all.
    fn change(&self, mutation: OperationMutation) -> Option<f64>;
    /// What the checks detect.
    fn check(&self, mutation: OperationMutation) -> Detection;
}

impl MutatedSubject for TestedMechanism {
    fn name(&self) -> &str {
        &self.name
    }

    fn mode(&self) -> CheckMode {
        self.mode
    }

    fn operations(&self) -> BTreeSet<SourceOperation> {
        self.operations()
    }

    fn change(&self, mutation: OperationMutation) -> Option<f64> {
        self.change(mutation)
    }

    fn check(&self, mutation: OperationMutation) -> Detection {
        self.check(mutation)
    }
}

/// What became of a fault.
#[derive(Debug, Clone, PartialEq)]
pub enum MutationOutcome {
    /// No answer of any machine moves: it is no fault in an equation, such as another guess of
    /// Newton's method.
    Unchanged,
    /// Every machine on which it is felt refuses to answer.
    NoResult,
    /// Judged, on these machines.
    Checked(Detection, Vec<String>),
}

/// A fault in one operation, and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MutationResult {
    pub operation: SourceOperation,
    pub kind: MutationKind,
    pub outcome: MutationOutcome,
}

impl MutationResult {
    /// Whether it is a fault that fewer checks detect than must.
    pub fn undetected(&self) -> bool {
        matches!(&self.outcome, MutationOutcome::Checked(verdict, _) if verdict.check_count() < REQUIRED_CHECKS)
    }
}

/// The places that the machines meet, each with the machines that meet it, the cheapest to judge
/// first.
pub fn operations_of<M: MutatedSubject>(machines: &[M]) -> BTreeMap<SourceOperation, Vec<&M>> {
    let mut operations: BTreeMap<SourceOperation, Vec<&M>> = BTreeMap::new();
    for machine in machines {
        for operation in machine.operations() {
            operations.entry(operation).or_default().push(machine);
        }
    }
    operations
}

/// Every fault of every place that the machines meet.
pub fn mutate_operations<M: MutatedSubject>(machines: &[M]) -> Vec<MutationResult> {
    let operations = operations_of(machines);
    let mutations: Vec<(SourceOperation, MutationKind, &[&M])> = operations
        .iter()
        .flat_map(|(&operation, machines)| {
            let each = operation.operation.mutations().iter();
            each.map(move |&kind| (operation, kind, machines.as_slice()))
        })
        .collect();
    mutations
        .par_iter()
        .map(|&(operation, kind, machines)| MutationResult {
            operation,
            kind,
            outcome: outcome(operation, kind, machines),
        })
        .collect()
}

/// Judges a fault where it is felt: once by the reduced model and once by states, and on more machines
/// while fewer checks detect it than must.
fn outcome<M: MutatedSubject>(
    operation: SourceOperation,
    kind: MutationKind,
    machines: &[&M],
) -> MutationOutcome {
    let mutation = Some((operation, kind));
    let (mut detection, mut on) = (Detection::default(), Vec::new());
    let (mut refused, mut kinds, mut no_number) = (false, Vec::new(), Vec::new());
    for machine in machines {
        if kinds.contains(&machine.mode()) && detection.check_count() >= REQUIRED_CHECKS {
            continue;
        }
        match machine.change(mutation) {
            None => refused = true,
            Some(change) if change <= UNCHANGED_TOLERANCE => (),
            Some(change) if change.is_infinite() => no_number.push(*machine),
            Some(_) => {
                detection = detection.merge(&machine.check(mutation));
                kinds.push(machine.mode());
                on.push(machine.name().to_owned());
            }
        }
    }
    // What is no number anybody sees; it counts only where there is nothing else.
    for machine in no_number {
        if detection.check_count() < REQUIRED_CHECKS {
            detection = detection.merge(&machine.check(mutation));
            on.push(machine.name().to_owned());
        }
    }
    match (on.is_empty(), refused) {
        (false, _) => MutationOutcome::Checked(detection, on),
        (true, true) => MutationOutcome::NoResult,
        (true, false) => MutationOutcome::Unchanged,
    }
}

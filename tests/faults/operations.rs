//! Every sign and every term of every step of a plan, in the product's own lines.

use super::machine::{Machine, SAME};
use super::verdict::{ENOUGH, Verdict};
use super::watched::{Place, Slip};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What became of a fault.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Outcome {
    /// No answer of any machine moves: it is no fault in an equation, such as another guess of
    /// Newton's method.
    Same,
    /// Every machine on which it is felt refuses to answer.
    Refused,
    /// Judged, on these machines.
    Judged(Verdict, Vec<String>),
}

/// A fault in one operation, and what became of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Slipped {
    pub(crate) place: Place,
    pub(crate) slip: Slip,
    pub(crate) outcome: Outcome,
}

impl Slipped {
    /// Whether it is a fault that fewer truths catch than must.
    pub(crate) fn missed(&self) -> bool {
        matches!(&self.outcome, Outcome::Judged(verdict, _) if verdict.count() < ENOUGH)
    }
}

/// The places that the machines meet, each with the machines that meet it, the cheapest to judge
/// first.
pub(crate) fn places(machines: &[Machine]) -> BTreeMap<Place, Vec<&Machine>> {
    let mut met: BTreeMap<Place, Vec<&Machine>> = BTreeMap::new();
    for machine in machines {
        for place in machine.places() {
            met.entry(place).or_default().push(machine);
        }
    }
    met
}

/// Every fault of every place that the machines meet.
pub(crate) fn study(machines: &[Machine]) -> Vec<Slipped> {
    let met = places(machines);
    let faults: Vec<(Place, Slip, &[&Machine])> = met
        .iter()
        .flat_map(|(&place, machines)| {
            let each = place.operation.slips().iter();
            each.map(move |&slip| (place, slip, machines.as_slice()))
        })
        .collect();
    faults
        .par_iter()
        .map(|&(place, slip, machines)| Slipped {
            place,
            slip,
            outcome: outcome(place, slip, machines),
        })
        .collect()
}

/// Judges a fault where it is felt: once by the reduced model and once by states, and on more machines
/// while fewer truths catch it than must.
fn outcome(place: Place, slip: Slip, machines: &[&Machine]) -> Outcome {
    let fault = Some((place, slip));
    let (mut verdict, mut on) = (Verdict::default(), Vec::new());
    let (mut refused, mut kinds, mut no_number) = (false, Vec::new(), Vec::new());
    for machine in machines {
        if kinds.contains(&machine.by) && verdict.count() >= ENOUGH {
            continue;
        }
        match machine.moved(fault) {
            None => refused = true,
            Some(by) if by <= SAME => (),
            Some(by) if by.is_infinite() => no_number.push(*machine),
            Some(_) => {
                verdict = verdict.and(&machine.judge(fault));
                kinds.push(machine.by);
                on.push(machine.name.clone());
            }
        }
    }
    // What is no number anybody sees; it counts only where there is nothing else.
    for machine in no_number {
        if verdict.count() < ENOUGH {
            verdict = verdict.and(&machine.judge(fault));
            on.push(machine.name.clone());
        }
    }
    match (on.is_empty(), refused) {
        (false, _) => Outcome::Judged(verdict, on),
        (true, true) => Outcome::Refused,
        (true, false) => Outcome::Same,
    }
}

//! What the errors are measured from, and how well that is known.
//!
//! Of a conservative motion of one freedom it is the quadrature, which knows no integrator; how well, tells the
//! same of a start changed by its rounding. Of all others it is the method that changes least from one tolerance
//! to the next, at its finest, and how well, tells the second best of another method.

use super::combination::{Effort, Errors};
use super::evaluator::{Evaluator, Reactions};
use super::run::{Ladder, along, follow};
use super::subject::Subject;
use dwell_dynamics::{DynamicsError, MachineWork, Orbit};

/// Below this no integrator keeps a tolerance in double precision.
const FINEST: f64 = 1e-14;
/// Steps that a truth may take, in those of any other run.
const LONGER: usize = 3;
/// Roundings of a start, relative.
const ROUNDINGS: f64 = 2.0 * f64::EPSILON;
/// Roundings of a result, relative: of sums of energies and forces, and of a phase that Newton's method finds.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// The truth with what is compared with it.
pub(super) struct Known<'s> {
    subject: &'s Subject,
    work: MachineWork<f64>,
    pub(super) by: String,
    pub(super) states: Vec<Vec<f64>>,
    reactions: Vec<Vec<f64>>,
    /// By reaction: the largest of its unit.
    scales: Vec<f64>,
    /// The largest kinetic energy, J, and the energy at the start.
    kinetic: f64,
    began: f64,
    pub(super) floor: Errors,
}

/// A motion, how it was found, and others that tell how well it is known.
struct Candidate {
    by: String,
    states: Vec<Vec<f64>>,
    others: Vec<Vec<Vec<f64>>>,
    /// What these do not tell, rad or m.
    unknown: f64,
}

impl<'s> Known<'s> {
    /// Finds the truth: `ladders` are the runs of the mechanism itself by each method.
    ///
    /// # Errors
    /// [`DynamicsError`] where there are no two runs to be compared, or a state cannot be evaluated.
    pub(super) fn new(
        subject: &'s Subject,
        exact: &dyn Evaluator,
        ladders: &[Ladder],
        effort: &Effort,
    ) -> Result<Self, DynamicsError> {
        let orbit = subject.orbit.as_ref();
        let Candidate {
            by,
            states,
            others,
            unknown,
        } = match orbit.and_then(|orbit| by_quadrature(subject, orbit)) {
            Some(found) => found,
            None => by_steps(subject, exact, ladders, effort)?,
        };
        let mut known = Self {
            subject,
            work: subject.machine.work(),
            by,
            states,
            reactions: Vec::new(),
            scales: Vec::new(),
            kinetic: 0.0,
            began: 0.0,
            floor: Errors {
                coordinate: 0.0,
                energy: 0.0,
                reaction: 0.0,
            },
        };
        known.measure(exact)?;
        for other in &others {
            let there = known.errors(other, &mut exact.reactions())?;
            known.floor.coordinate = known.floor.coordinate.max(there.coordinate);
            known.floor.reaction = known.floor.reaction.max(there.reaction);
        }
        known.floor.coordinate += unknown;
        known.floor.reaction += ROUNDED;
        if known.scales.iter().all(|scale| *scale == 0.0) {
            known.floor.reaction = f64::NAN;
        }
        Ok(known)
    }

    /// Evaluates everything at the states of the truth.
    fn measure(&mut self, exact: &dyn Evaluator) -> Result<(), DynamicsError> {
        let [kinetic, potential] = self.energies(0.0, &self.subject.start.y)?;
        (self.kinetic, self.began) = (kinetic, kinetic + potential);
        let mut size = kinetic + potential.abs();
        let mut find = exact.reactions();
        let count = self.subject.reactions.len();
        let mut largest = vec![0.0_f64; count];
        for k in 0..self.states.len() {
            let t = self.subject.times[k];
            let y = std::mem::take(&mut self.states[k]);
            let [kinetic, potential] = self.energies(t, &y)?;
            self.kinetic = self.kinetic.max(kinetic);
            size = size.max(kinetic + potential.abs());
            let mut reactions = vec![0.0; count];
            let point = dwell_dynamics::Point { t, y };
            find(&point, &mut reactions)?;
            self.states[k] = point.y;
            for (most, value) in largest.iter_mut().zip(&reactions) {
                *most = most.max(value.abs());
            }
            self.reactions.push(reactions);
        }
        let unit = |k: usize| self.subject.reaction_unit(k);
        let of_unit = |k: usize| {
            let same = (0..count).filter(|&other| unit(other) == unit(k));
            same.map(|other| largest[other]).fold(0.0, f64::max)
        };
        self.scales = (0..count).map(of_unit).collect();
        self.floor.energy = ROUNDED * size / self.kinetic;
        Ok(())
    }

    /// Kinetic energy, and potential energy less the works, at a state of the exact machine, J.
    fn energies(&mut self, t: f64, y: &[f64]) -> Result<[f64; 2], DynamicsError> {
        let machine = &self.subject.machine;
        machine.evaluate(t, y, &mut self.work)?;
        let [kinetic, potential] = machine.energy(&self.work);
        let works: f64 = y[machine.first_work()..].iter().sum();
        Ok([kinetic, potential - works])
    }

    /// The errors of some states at the subject's times, with reactions as they are evaluated there.
    pub(super) fn errors(
        &mut self,
        states: &[Vec<f64>],
        find: &mut Reactions<'_>,
    ) -> Result<Errors, DynamicsError> {
        let none = self.scales.iter().all(|scale| *scale == 0.0);
        let mut errors = Errors {
            coordinate: apart(self.subject, states, &self.states),
            energy: 0.0,
            reaction: if none { f64::NAN } else { 0.0 },
        };
        let mut reactions = vec![0.0; self.scales.len()];
        for (k, y) in states.iter().enumerate() {
            let t = self.subject.times[k];
            let [kinetic, rest] = self.energies(t, y)?;
            let drift = (kinetic + rest - self.began).abs() / self.kinetic;
            errors.energy = largest(errors.energy, drift);
            find(&dwell_dynamics::Point { t, y: y.clone() }, &mut reactions)?;
            let pairs = reactions.iter().zip(&self.reactions[k]).zip(&self.scales);
            for ((value, truth), scale) in pairs.filter(|(_, scale)| **scale > 0.0) {
                errors.reaction = largest(errors.reaction, (value - truth).abs() / scale);
            }
        }
        Ok(errors)
    }
}

/// The larger one; what is no number stays none.
fn largest(most: f64, value: f64) -> f64 {
    if value > most || value.is_nan() {
        value
    } else {
        most
    }
}

/// How far two motions are apart in the free coordinates, rad or m.
fn apart(subject: &Subject, one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let free = subject.machine.free().len();
    let mut most = 0.0;
    for (one, other) in one.iter().zip(other) {
        for (a, b) in one.iter().zip(other).take(free) {
            most = largest(most, (a - b).abs());
        }
    }
    most
}

fn by_quadrature(subject: &Subject, orbit: &Orbit) -> Option<Candidate> {
    let state = subject.state();
    let mut others = Vec::new();
    for side in [-1.0, 1.0] {
        let mut beside = state;
        beside.q_dot *= 1.0 + side * ROUNDINGS;
        // At rest it is the place that counts.
        if state.q_dot == 0.0 {
            beside.q += side * ROUNDINGS * (1.0 + state.q.abs());
        }
        let beside = Orbit::loaded(&subject.machine, beside).ok()?;
        others.push(along(&beside, &subject.times));
    }
    let states = along(orbit, &subject.times);
    let [low, high] = subject.reach;
    let fastest = states.iter().fold(0.0_f64, |most, y| most.max(y[1].abs()));
    let farthest = low.abs().max(high.abs()).max(high - low);
    Some(Candidate {
        by: format!(
            "quadrature over the coordinate ({} points), which knows no integrator; known as well as a start \
             that is changed by its rounding tells",
            orbit.points
        ),
        states,
        others,
        unknown: orbit.rounding * orbit.period * fastest + ROUNDED * farthest,
    })
}

/// The run of the method that changes least from one tolerance to the next, with that of the second best.
fn by_steps(
    subject: &Subject,
    exact: &dyn Evaluator,
    ladders: &[Ladder],
    effort: &Effort,
) -> Result<Candidate, DynamicsError> {
    let mut found: Vec<(f64, String, Vec<Vec<f64>>)> = Vec::new();
    for ladder in ladders {
        let [.., (_, before), (fine, last)] = ladder.runs.as_slice() else {
            continue;
        };
        let finer = (0.1 * fine).max(FINEST);
        let budget = LONGER * effort.budget;
        let at = (ladder.method, finer);
        // What the budget stopped before the last tolerance is not the best.
        let ended = effort.finest() == Some(*fine) && ladder.next() < budget as f64;
        let again = match ended && finer < 0.5 * fine {
            true => follow(exact, subject, at, budget).ok(),
            false => None,
        };
        let name = |tolerance: f64| format!("{} at {tolerance:.0e}", ladder.method.name());
        let (change, told, states) = match again {
            Some(again) => (
                apart(subject, &again.states, &last.states),
                name(finer),
                again.states,
            ),
            // A change over two decades is a change over one, and more.
            None => (
                apart(subject, &before.states, &last.states),
                name(*fine),
                last.states.clone(),
            ),
        };
        if change.is_finite() {
            found.push((change, told, states));
        }
    }
    found.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let mut found = found.into_iter();
    let (Some((_, by, states)), Some((_, check, other))) = (found.next(), found.next()) else {
        return Err(DynamicsError::Budget {
            t: 0.0,
            steps: effort.budget,
        });
    };
    let farthest = states.iter().map(|y| y[0].abs()).fold(0.0, f64::max);
    Ok(Candidate {
        by: format!("{by}, known as well as it agrees with {check}"),
        states,
        others: vec![other],
        unknown: ROUNDED * farthest,
    })
}

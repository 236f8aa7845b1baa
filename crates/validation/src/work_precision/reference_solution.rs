//! The reference of the errors, and its own error.
//!
//! For a conservative motion of one degree of freedom it is the quadrature, which uses no integrator; its error is the
//! change caused by rounding of the initial state. For other motions it is the method that changes least from one tolerance
//! to the next, at its finest tolerance; its error is the difference from the second best method.

use super::combination::{Effort, Errors, ReferenceInfo};
use super::evaluator::{Evaluator, ReactionFn};
use super::run::{ToleranceSeries, orbit_states, solve};
use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_dynamics::{DynamicsError, MachineWorkspace, OdeState, Orbit};
use dwell_kinetostatics::MachineModel as _;

/// Smallest tolerance that an integrator can keep in double precision.
const MIN_TOLERANCE: f64 = 1e-14;
/// Maximum number of steps of a reference, relative to that of other runs.
const STEP_FACTOR: usize = 3;
/// Relative rounding error of the initial state.
const START_ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Relative rounding error of a result: of sums of energies and forces, and of a phase computed by Newton's method.
const RESULT_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Fraction of the largest reaction, at the size of the mechanism, below which a reaction is a rounding error.
const ZERO: f64 = 1e-12;

/// The reference with its values.
pub(super) struct ReferenceSolution<'s, S: StudiedScene> {
    subject: &'s Subject<S>,
    workspace: MachineWorkspace<f64, S::Model>,
    pub(super) info: ReferenceInfo,
    pub(super) states: Vec<Vec<f64>>,
    reactions: Vec<Vec<f64>>,
    /// By reaction: the largest reaction of its unit.
    scales: Vec<f64>,
    /// The largest kinetic energy, J, and the energy at the start.
    max_kinetic_energy: f64,
    initial_energy: f64,
}

/// A motion with its method, and motions for its error.
struct Candidate {
    method: String,
    states: Vec<Vec<f64>>,
    comparisons: Vec<Vec<Vec<f64>>>,
    /// Error that these do not show, rad or m.
    extra_error: f64,
}

impl<'s, S: StudiedScene> ReferenceSolution<'s, S> {
    /// Computes the reference; `all_series` are the runs of the mechanism itself by each method.
    ///
    /// # Errors
    /// [`DynamicsError`] if there are no two runs to compare, or a state cannot be evaluated.
    pub(super) fn new(
        subject: &'s Subject<S>,
        exact: &dyn Evaluator,
        all_series: &[ToleranceSeries],
        effort: &Effort,
    ) -> Result<Self, DynamicsError> {
        let orbit = subject.orbit.as_ref();
        let found = match orbit.and_then(|orbit| from_quadrature(subject, orbit)) {
            Some(found) => found,
            None => from_integrators(subject, exact, all_series, effort)?,
        };
        let mut reference = Self {
            subject,
            workspace: subject.machine.workspace(),
            info: ReferenceInfo {
                method: found.method,
                error: Errors::default(),
            },
            states: found.states,
            reactions: Vec::new(),
            scales: Vec::new(),
            max_kinetic_energy: 0.0,
            initial_energy: 0.0,
        };
        reference.evaluate_reference(exact)?;
        for other in &found.comparisons {
            let errors = reference.errors(other, &mut exact.reactions())?;
            let own = &mut reference.info.error;
            own.coordinate = own.coordinate.max(errors.coordinate);
            own.reaction = own.reaction.max(errors.reaction);
        }
        let own = &mut reference.info.error;
        own.coordinate += found.extra_error;
        own.reaction += RESULT_ROUNDING;
        if reference.scales.iter().all(|scale| *scale == 0.0) {
            own.reaction = f64::NAN;
        }
        Ok(reference)
    }

    /// Evaluates everything at the states of the reference.
    fn evaluate_reference(&mut self, exact: &dyn Evaluator) -> Result<(), DynamicsError> {
        let [kinetic, potential] = self.energies(0.0, &self.subject.initial_state.y)?;
        (self.max_kinetic_energy, self.initial_energy) = (kinetic, kinetic + potential);
        let mut size = kinetic + potential.abs();
        let mut find = exact.reactions();
        let count = self.subject.reaction_units.len();
        for (t, y) in self.subject.times.iter().zip(self.states.clone()) {
            let [kinetic, potential] = self.energies(*t, &y)?;
            self.max_kinetic_energy = self.max_kinetic_energy.max(kinetic);
            size = size.max(kinetic + potential.abs());
            let mut reactions = vec![0.0; count];
            find(&OdeState { t: *t, y }, &mut reactions)?;
            self.reactions.push(reactions);
        }
        let unit = |k: usize| &self.subject.reaction_units[k];
        let of_unit = |k: usize| {
            let same = (0..count).filter(|&other| unit(other) == unit(k));
            let values = same.flat_map(|other| self.reactions.iter().map(move |row| row[other]));
            values.fold(0.0_f64, |max, value| max.max(value.abs()))
        };
        self.scales = (0..count).map(of_unit).collect();
        // If all moments, or all forces, are zero within rounding, they are not compared.
        let size = self.subject.machine.model().size();
        let levers: Vec<f64> = (0..count)
            .map(|k| if unit(k) == "N" { 1.0 } else { 1.0 / size })
            .collect();
        let in_newtons = self.scales.iter().zip(&levers).map(|(s, lever)| s * lever);
        let largest = in_newtons.fold(0.0_f64, f64::max);
        for (scale, lever) in self.scales.iter_mut().zip(&levers) {
            if *scale * lever < ZERO * largest {
                *scale = 0.0;
            }
        }
        self.info.error.energy = RESULT_ROUNDING * size / self.max_kinetic_energy;
        Ok(())
    }

    /// Kinetic energy, and potential energy less the works, at a state of the exact machine, J.
    fn energies(&mut self, t: f64, y: &[f64]) -> Result<[f64; 2], DynamicsError> {
        let machine = &self.subject.machine;
        let [kinetic, potential] = machine.evaluate(t, y, &mut self.workspace)?.energy();
        let works: f64 = y[machine.work_offset()..].iter().sum();
        Ok([kinetic, potential - works])
    }

    /// The errors of some states at the subject's times, with reactions evaluated there.
    pub(super) fn errors(
        &mut self,
        states: &[Vec<f64>],
        find: &mut ReactionFn<'_>,
    ) -> Result<Errors, DynamicsError> {
        let no_reactions = self.scales.iter().all(|scale| *scale == 0.0);
        let mut errors = Errors {
            coordinate: difference(self.subject, states, &self.states),
            energy: 0.0,
            reaction: if no_reactions { f64::NAN } else { 0.0 },
        };
        let mut reactions = vec![0.0; self.scales.len()];
        for (k, y) in states.iter().enumerate() {
            let t = self.subject.times[k];
            let [kinetic, rest] = self.energies(t, y)?;
            let drift = (kinetic + rest - self.initial_energy).abs() / self.max_kinetic_energy;
            errors.energy = nan_max(errors.energy, drift);
            find(&OdeState { t, y: y.clone() }, &mut reactions)?;
            let pairs = reactions.iter().zip(&self.reactions[k]).zip(&self.scales);
            for ((value, expected), scale) in pairs.filter(|(_, scale)| **scale > 0.0) {
                errors.reaction = nan_max(errors.reaction, (value - expected).abs() / scale);
            }
        }
        Ok(errors)
    }
}

/// The larger number; NaN remains NaN.
fn nan_max(max: f64, value: f64) -> f64 {
    if value > max || value.is_nan() {
        value
    } else {
        max
    }
}

/// The largest difference of two motions in the free coordinates, rad or m.
fn difference<S: StudiedScene>(subject: &Subject<S>, one: &[Vec<f64>], other: &[Vec<f64>]) -> f64 {
    let free = subject.machine.free().len();
    let mut max = 0.0;
    for (one, other) in one.iter().zip(other) {
        for (a, b) in one.iter().zip(other).take(free) {
            max = nan_max(max, (a - b).abs());
        }
    }
    max
}

fn from_quadrature<S: StudiedScene>(subject: &Subject<S>, orbit: &Orbit) -> Option<Candidate> {
    let state = subject.reduced_state();
    let mut others = Vec::new();
    for sign in [-1.0, 1.0] {
        let mut perturbed = state;
        perturbed.q_dot *= 1.0 + sign * START_ROUNDING;
        // At rest the coordinate is decisive.
        if state.q_dot == 0.0 {
            perturbed.q += sign * START_ROUNDING * (1.0 + state.q.abs());
        }
        let perturbed = Orbit::loaded(&subject.machine, perturbed).ok()?;
        others.push(orbit_states(&perturbed, &subject.times));
    }
    let states = orbit_states(orbit, &subject.times);
    let [low, high] = subject.coordinate_range;
    let max_velocity = states.iter().fold(0.0_f64, |max, y| max.max(y[1].abs()));
    let max_coordinate = low.abs().max(high.abs()).max(high - low);
    Some(Candidate {
        method: format!(
            "quadrature over the coordinate ({} points), which uses no integrator; its error is how much it changes when the initial state is perturbed by rounding",
            orbit.points
        ),
        states,
        comparisons: others,
        extra_error: orbit.tail * orbit.period * max_velocity + RESULT_ROUNDING * max_coordinate,
    })
}

/// The run of the method that changes least from one tolerance to the next, with that of the second best.
fn from_integrators<S: StudiedScene>(
    subject: &Subject<S>,
    exact: &dyn Evaluator,
    all_series: &[ToleranceSeries],
    effort: &Effort,
) -> Result<Candidate, DynamicsError> {
    let finest = effort.tolerance_exponents.last().map(|&k| 10_f64.powi(k));
    let mut found: Vec<(f64, String, Vec<Vec<f64>>)> = Vec::new();
    for series in all_series {
        let [.., (_, before), (fine, last)] = series.runs.as_slice() else {
            continue;
        };
        let finer_tolerance = (0.1 * fine).max(MIN_TOLERANCE);
        let max_steps = STEP_FACTOR * effort.max_steps;
        let solve_finer = || solve(exact, subject, series.method, finer_tolerance, max_steps).ok();
        // A series that the step limit stopped before the last tolerance is not eligible.
        let complete = finest == Some(*fine) && series.predicted_steps() < max_steps as f64;
        let finer = (complete && finer_tolerance < 0.5 * fine).then(solve_finer);
        // A change over two decades bounds that over one.
        let (tolerance, before, states) = match finer.flatten() {
            Some(finer) => (finer_tolerance, &last.states, finer.states),
            None => (*fine, &before.states, last.states.clone()),
        };
        let change = difference(subject, before, &states);
        if change.is_finite() {
            let name = format!("{} at {tolerance:.0e}", series.method.name());
            found.push((change, name, states));
        }
    }
    found.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
    let mut found = found.into_iter();
    let (Some((_, by, states)), Some((_, check, other))) = (found.next(), found.next()) else {
        return Err(DynamicsError::MaxStepsReached {
            t: 0.0,
            max_steps: effort.max_steps,
        });
    };
    let max_coordinate = states.iter().map(|y| y[0].abs()).fold(0.0, f64::max);
    Ok(Candidate {
        method: format!("{by}; its error is the difference from {check}"),
        states,
        comparisons: vec![other],
        extra_error: RESULT_ROUNDING * max_coordinate,
    })
}

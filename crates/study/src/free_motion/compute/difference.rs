//! The difference of two computations of one motion.

use crate::estimate::{beyond_rounding, error_scale, relative};
use crate::explain::StudyError;
use crate::free_motion::compute::description::imbalance;
use crate::free_motion::compute::{ChartedProblem, MotionOf, MotionProblem, SegmentedMotion};
use crate::machines::MachineScene as _;
use crate::trajectory::compute::{RowScene as _, TrajectorySample, force_scales};
use dwell_dynamics::DynamicsError;
use dwell_kinetostatics::{KinematicState, MachineModel};

/// Samples at which reactions are compared, along the whole motion.
const COMPARED_SAMPLES: usize = 64;

/// The largest differences of two computations at their common sample times.
pub(crate) struct Difference {
    /// Of the free coordinates: rad, or for lengths relative to the largest change.
    pub(crate) coordinate: f64,
    /// Of the kinetic energy and of the energy balance, relative to the largest kinetic energy.
    energy: f64,
    /// What the energy balance of the first computation shows of its error beyond rounding, relative to the largest kinetic energy.
    imbalance: f64,
    /// Of the reactions, relative to the largest of their unit.
    pub(crate) reactions: f64,
    /// Of the end time, relative to it.
    pub(crate) end: f64,
}

impl Difference {
    /// The largest of all.
    pub(crate) fn largest(&self) -> f64 {
        let others = [self.energy_error(), self.reactions, self.end];
        // NaN counts as largest.
        others.into_iter().fold(self.coordinate, |largest, other| {
            if other <= largest { largest } else { other }
        })
    }

    /// Of the energies: no less than what the balance shows.
    pub(crate) fn energy_error(&self) -> f64 {
        nan_max(self.imbalance, self.energy)
    }

    /// The same where the balance shows this error.
    pub(crate) fn with_imbalance(self, imbalance: f64) -> Self {
        Self { imbalance, ..self }
    }

    /// The sums of both.
    pub(crate) fn plus(self, other: &Self) -> Self {
        Self {
            imbalance: nan_max(self.imbalance, other.imbalance),
            coordinate: self.coordinate + other.coordinate,
            energy: self.energy + other.energy,
            reactions: self.reactions + other.reactions,
            end: self.end + other.end,
        }
    }

    /// No less than this in the coordinates and the energy.
    pub(crate) fn with_minimum(self, minimum: f64) -> Self {
        Self {
            coordinate: nan_max(minimum, self.coordinate),
            energy: nan_max(minimum, self.energy),
            ..self
        }
    }

    /// All differences times a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            coordinate: factor * self.coordinate,
            energy: factor * self.energy,
            reactions: factor * self.reactions,
            end: factor * self.end,
            ..self
        }
    }
}

/// The reactions of the first or the second computation (0 or 1) at a sample.
type ReactionsOf<'r> = &'r dyn Fn(usize, &TrajectorySample) -> Result<Vec<f64>, DynamicsError>;

/// What of two computations of one motion is compared.
struct Compared<'s> {
    /// The samples of both.
    samples: [&'s [TrajectorySample]; 2],
    /// When they end, s.
    ends: [f64; 2],
    /// The size of the mechanism, m.
    size: f64,
    /// The units of the reactions.
    units: Vec<&'static str>,
}

impl Compared<'_> {
    /// The difference of the second computation from the first.
    fn difference(
        &self,
        problem: &impl MotionProblem,
        reactions: ReactionsOf<'_>,
    ) -> Result<Difference, DynamicsError> {
        let [first, second] = self.samples;
        let pairs = pair_by_time(first, second);
        let max_abs = |of: &dyn Fn(&TrajectorySample) -> f64| {
            let values = first.iter().map(|s| of(s).abs());
            values.fold(0.0, f64::max)
        };
        let max_difference = |of: &dyn Fn(&TrajectorySample) -> f64| {
            let differences = pairs.iter().map(|(a, b)| (of(a) - of(b)).abs());
            differences.fold(0.0, nan_max)
        };
        let mut coordinate = 0.0_f64;
        for &i in problem.machine().free() {
            let value = |s: &TrajectorySample| s.coordinate(i);
            let start = first.first().map_or(0.0, value);
            let scale = match problem.is_angle(i) {
                true => 1.0,
                false => error_scale(max_abs(&|s| value(s) - start), self.size),
            };
            coordinate = nan_max(coordinate, relative(max_difference(&value), scale));
        }
        let balance_index = problem.balance_index();
        let balance = |s: &TrajectorySample| s.extra_values[balance_index];
        let [kinetic, potential] = [0, 1].map(|k| max_abs(&|s| s.extra_values[k]));
        let [end_one, end_two] = self.ends;
        let scale = error_scale(kinetic, potential);
        // A motion that is late has the right balance and other energies.
        let differences = [
            max_difference(&|s| s.extra_values[0]),
            max_difference(&balance),
        ];
        Ok(Difference {
            coordinate,
            energy: relative(differences.into_iter().fold(0.0, nan_max), scale),
            imbalance: relative(
                beyond_rounding(max_abs(&balance), kinetic, potential),
                scale,
            ),
            reactions: self.reaction_difference(reactions, &pairs, kinetic)?,
            end: relative((end_one - end_two).abs(), end_one.max(end_two)),
        })
    }

    fn reaction_difference(
        &self,
        reactions: ReactionsOf<'_>,
        pairs: &[(&TrajectorySample, &TrajectorySample)],
        kinetic: f64,
    ) -> Result<f64, DynamicsError> {
        let mut differences = vec![0.0_f64; self.units.len()];
        let mut sizes = differences.clone();
        let stride = pairs.len().div_ceil(COMPARED_SAMPLES).max(1);
        for (a, b) in pairs.iter().step_by(stride) {
            let (first, second) = (reactions(0, a)?, reactions(1, b)?);
            let cells = differences.iter_mut().zip(&mut sizes);
            for ((difference, size), (v, w)) in cells.zip(first.iter().zip(&second)) {
                // Next to a change point a reaction may be undefined in both.
                if !(v.is_nan() && w.is_nan()) {
                    *difference = nan_max(*difference, (v - w).abs());
                    *size = size.max(v.abs());
                }
            }
        }
        let of_unit = |unit: &str| {
            let alike = sizes.iter().zip(&self.units).filter(|(_, u)| **u == unit);
            alike.fold(0.0, |scale: f64, (size, _)| scale.max(*size))
        };
        // Where all of a unit are zero but for rounding, their difference is that of two roundings.
        let [force, moment] = ["N", "N m"].map(of_unit);
        let references = force_scales(self.size, [force, moment], kinetic);
        let force = error_scale(force, references[0]);
        let moment = error_scale(moment, references[1]);
        let parts = differences
            .iter()
            .zip(&self.units)
            .map(|(&difference, unit)| {
                let scale = if *unit == "N" { force } else { moment };
                relative(difference, scale)
            });
        Ok(parts.fold(0.0, nan_max))
    }
}

/// The difference of a second computation of a motion from a first, with what the balance of the first shows.
pub(crate) fn difference_of<P: ChartedProblem>(
    problem: &P,
    motions: [&MotionOf<P>; 2],
) -> Result<Difference, StudyError> {
    let found = difference(problem, motions).map_err(|error| problem.explain(&error))?;
    Ok(found.with_imbalance(imbalance(problem, motions[0])))
}

/// The difference of a second computation of a motion from a first.
pub(crate) fn difference<P: ChartedProblem>(
    problem: &P,
    motions: [&MotionOf<P>; 2],
) -> Result<Difference, DynamicsError> {
    let [first, second] = motions.map(|motion| problem.samples(motion));
    let (first, second) = (first?, second?);
    let model = P::Scene::model_of(problem.rows());
    let units = problem.scene().reaction_units(model).into_iter();
    let units: Vec<_> = units.map(|(_, unit)| unit).collect();
    let compared = Compared {
        samples: [&first, &second],
        ends: motions.map(SegmentedMotion::end_time),
        size: model.size(),
        units: units[..problem.result_reactions()].to_vec(),
    };
    let sources = motions.map(|motion| problem.row_source(motion));
    let charts = [0, 1].map(|which| sources[which].charts_or(problem.rows()));
    compared.difference(problem, &|which, sample| {
        let (_, rows) = charts[which][sample.chart];
        reactions_at(P::Scene::model_of(rows), sample)
    })
}

/// All reactions of a model at a sample.
fn reactions_at<M: MachineModel>(
    model: &M,
    sample: &TrajectorySample,
) -> Result<Vec<f64>, DynamicsError> {
    let (mut workspace, mut results) = (model.pass_workspace(), model.result_buffer());
    let at = [&sample.q[..], &sample.q_dot[..]];
    let state = KinematicState::new(model, at, &mut workspace)?;
    let mut state = state.apply_loads(sample.t)?;
    for &(load, magnitude) in &sample.drive_magnitudes {
        state.set_magnitude(load, magnitude);
    }
    state.evaluate(&sample.q_ddot, &mut results)?;
    Ok(results.reactions)
}

/// The samples at common times. Next to a change point one of them may lack samples.
pub(crate) fn pair_by_time<'s>(
    one: &'s [TrajectorySample],
    two: &'s [TrajectorySample],
) -> Vec<(&'s TrajectorySample, &'s TrajectorySample)> {
    let mut others = two.iter().peekable();
    let pair = |a: &'s TrajectorySample| {
        while others.next_if(|b| b.t < a.t).is_some() {}
        others.next_if(|b| b.t == a.t).map(|b| (a, b))
    };
    one.iter().filter_map(pair).collect()
}

/// The larger of two numbers; NaN counts as larger.
fn nan_max(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
}

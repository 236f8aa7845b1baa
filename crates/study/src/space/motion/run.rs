//! A free motion in space by a method, or by the cheapest way to an accuracy, with its estimated error.

use super::problem::SpaceMotionProblem;
use crate::estimate;
use crate::explain::StudyError;
use crate::free_motion::compute::{
    DEFAULT_SAMPLES, MotionSolver, check_sample_interval, pair_by_time,
};
use crate::models::SolverSettings;
use crate::ranges::extent;
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{Method, ObservedMachine, Options, Orbit, Solution, solve, solve_orbit};
use rayon::join;

/// Tolerances of an integration to an accuracy, as parts of it.
const TOLERANCES: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];
/// No tolerance is finer.
const MIN_TOLERANCE: f64 = 1e-14;

/// A computed motion.
pub(crate) struct Run {
    pub(super) solution: Solution,
    /// The second run, whose difference shows the errors.
    pub(super) second: Option<Solution>,
    /// The orbit that it was computed from, by quadrature, and the part of all times by which it may be late.
    pub(super) orbit: Option<(Orbit, f64)>,
    pub(super) method_text: String,
    /// The options of the rows between its steps.
    pub(super) options: Options,
    /// The accuracy that was required.
    pub(super) accuracy: Option<f64>,
}

/// By free coordinate: its error, and whether that is no result; then the error of the energy as a part of the largest.
pub(super) struct Errors {
    pub(super) coordinates: Vec<f64>,
    pub(super) energy: f64,
    /// The largest, of angles in rad, of lengths relative to their change.
    pub(super) largest: f64,
}

impl SpaceMotionProblem<'_> {
    /// The motion by a solver over a duration, s.
    pub(super) fn run(&self, solver: &MotionSolver, duration: f64) -> Result<Run, StudyError> {
        let (MotionSolver::Settings(SolverSettings {
            sample_interval, ..
        })
        | MotionSolver::Accuracy {
            sample_interval, ..
        }) = solver;
        let interval = match *sample_interval {
            Some(interval) => check_sample_interval(interval, duration)?,
            None => duration / DEFAULT_SAMPLES,
        };
        match solver {
            MotionSolver::Settings(settings) => {
                let options = Options {
                    atol: settings.atol,
                    max_step: settings.max_step,
                    sample_interval: Some(interval),
                    ..Options::new(settings.method, settings.rtol)
                };
                self.integrated(duration, options, settings.describe())
            }
            MotionSolver::Accuracy { accuracy, .. } => {
                if let Some(run) = self.by_quadrature(*accuracy, duration, interval) {
                    return Ok(run);
                }
                self.to_accuracy(*accuracy, duration, interval)
            }
        }
    }

    /// The motion by one method, with a second run at a tenth of the tolerance.
    fn integrated(
        &self,
        duration: f64,
        options: Options,
        method_text: String,
    ) -> Result<Run, StudyError> {
        let start = self.initial_state();
        let barriers = self.barriers();
        let of_barriers = barriers.iter().map(|(event, _)| *event);
        let events: Vec<_> = self.events.iter().copied().chain(of_barriers).collect();
        let by = |options: &Options, end: f64| {
            let (machine, model) = (&self.machine, &self.event_model);
            let mut solution = solve(machine, model, &start, end, options, &events)?;
            self.end_at_barrier(&mut solution, &barriers);
            solution.sample_end();
            Ok(solution)
        };
        let finer = estimate::comparison_options(&options);
        let (first, second) = join(|| by(&options, duration), || by(&finer, duration));
        let solution: Solution =
            first.map_err(|e: dwell_dynamics::DynamicsError| self.explain(&e))?;
        let end = solution.steps.last().map_or(0.0, |step| step.t);
        let second = match (&solution.error, end > 0.0) {
            (Some(_), true) => by(&finer, end).ok(),
            (Some(_), false) => None,
            (None, _) => second.ok(),
        };
        Ok(Run {
            solution,
            second: second.filter(|second| second.error.is_none()),
            orbit: None,
            method_text,
            options,
            accuracy: None,
        })
    }

    /// The motion by quadrature, if it is conservative and periodic.
    fn by_quadrature(&self, accuracy: f64, duration: f64, interval: f64) -> Option<Run> {
        if self.machine.free().len() != self.spec.laws.len() {
            return None;
        }
        let orbit = self.orbit(1.0).ok()?;
        let late = estimate::of_period(&orbit, |factor| self.orbit(factor)).ok()?;
        let options = Options {
            sample_interval: Some(interval),
            rtol: accuracy,
            // What an event must pass its value by is relative to the motion, whatever its size.
            atol: f64::MIN_POSITIVE,
            ..Options::new(Method::Dop853, 1e-13)
        };
        let observed = ObservedMachine::new(&self.machine, &self.event_model);
        let solution = solve_orbit(&orbit, observed, duration, &options, &self.events);
        let mut solution = solution.ok().filter(|s| s.error.is_none())?;
        solution.sample_end();
        let late = late / orbit.period;
        // The same, as much later.
        let mut second = solution.clone();
        for sample in &mut second.samples {
            let at = orbit.state_at(sample.t * (1.0 + late));
            sample.y[0] = at.q;
            sample.y[1] = at.q_dot;
        }
        let points = orbit.points;
        Some(Run {
            solution,
            second: Some(second),
            orbit: Some((orbit, late)),
            method_text: format!(
                "quadrature (conservative, periodic motion), {points} quadrature points"
            ),
            options,
            accuracy: Some(accuracy),
        })
    }

    /// The motion by the loosest tolerance of DOP853 whose estimated error keeps an accuracy.
    fn to_accuracy(&self, accuracy: f64, duration: f64, interval: f64) -> Result<Run, StudyError> {
        let mut best = None;
        for part in TOLERANCES {
            let tolerance = (part * accuracy).max(MIN_TOLERANCE);
            let options = Options {
                sample_interval: Some(interval),
                ..Options::new(Method::Dop853, tolerance)
            };
            let text = format!("{}, tolerance {tolerance:e}", Method::Dop853.name());
            let mut run = self.integrated(duration, options, text)?;
            run.accuracy = Some(accuracy);
            let keeps = self.errors(&run).is_some_and(|e| e.largest <= accuracy);
            let failed = run.solution.error.is_some();
            best = Some(run);
            if keeps || failed || tolerance <= MIN_TOLERANCE {
                break;
            }
        }
        // There is one tolerance at least.
        let options = Options::new(Method::Dop853, MIN_TOLERANCE);
        best.map_or_else(|| self.integrated(duration, options, String::new()), Ok)
    }

    /// The errors of a motion from its second run; none where it has none.
    pub(super) fn errors(&self, run: &Run) -> Option<Errors> {
        let samples = self.samples(&run.solution).ok()?;
        let others = self.samples(run.second.as_ref()?).ok()?;
        let pairs = pair_by_time(&samples, &others);
        let over = |of: &dyn Fn(&TrajectorySample) -> f64, rounding: f64| {
            let values = pairs.iter().map(|(a, b)| (of(a), of(b)));
            let (one, two): (Vec<f64>, Vec<f64>) = values.unzip();
            estimate::over_motion(&one, &two, rounding)
        };
        let mut errors = Errors {
            coordinates: Vec::new(),
            energy: 0.0,
            largest: 0.0,
        };
        for &i in self.machine.free() {
            let [from, to] = extent(pairs.iter().map(|(a, _)| a.q[i]));
            let rounding =
                4.0 * f64::EPSILON * from.abs().max(to.abs()) + f64::EPSILON * (to - from);
            let error = over(&|s| s.q[i], rounding);
            let relative = match self.is_angle(i) {
                true => error,
                false => error / (to - from).max(f64::MIN_POSITIVE),
            };
            errors.largest = errors.largest.max(relative);
            errors.coordinates.push(error);
        }
        let kinetic = samples
            .iter()
            .map(|s| s.extra_values[0])
            .fold(0.0, f64::max);
        if kinetic > 0.0 {
            let balance = self.balance_index();
            let drift = over(&|s| s.extra_values[balance], 0.0).max(
                samples
                    .iter()
                    .map(|s| s.extra_values[balance].abs())
                    .fold(0.0, f64::max),
            );
            errors.energy = drift / kinetic + 4.0 * f64::EPSILON;
            errors.largest = errors.largest.max(errors.energy);
        }
        Some(errors)
    }
}

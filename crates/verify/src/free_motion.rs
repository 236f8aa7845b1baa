//! The free motion against references that need no integrator: energy (check 4), the period and the whole
//! time history by quadrature (check 5), and periodicity. It also yields the runs at all
//! tolerances, from which cost can be read against error.

mod convergence;

use convergence::{check_convergence, check_jacobian, fitted_slope};
use dwell_dynamics::{
    DynamicsError, Event, EventKind, Method, Options, Orbit, ReducedCoordinate, ReducedOde,
    ReducedOutputs, ReducedState, Solution, solve_reduced,
};
use dwell_findings::Check::{Period, Power};
use dwell_findings::Finding;
use dwell_kinetostatics::ReducedModel;
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::time::Instant;

/// Tolerance at which the integrators are checked.
const CHECK_TOLERANCE: f64 = 1e-13;
/// The finest and the coarsest tolerance, as powers of ten.
const TOLERANCE_EXPONENTS: std::ops::RangeInclusive<i32> = -13..=-4;
/// Number of runs whose shortest wall time is used, because other threads run at the same time.
const TIMED_RUNS: usize = 3;
/// States of a run at which its reactions are compared with the exact ones.
const COMPARED_STATES: usize = 400;

/// A free motion to be checked.
#[derive(Debug, Clone)]
pub struct FreeMotionCase {
    /// The start.
    pub initial_state: ReducedState,
    /// Revolutions to follow.
    pub revolutions: usize,
    /// By reaction of the model: name and unit.
    pub reactions: Vec<(String, &'static str)>,
    /// A reference value of the period (s), with its source, if there is one.
    pub period: Option<(f64, String)>,
}

/// One tolerance of one integrator.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceRun {
    /// The integrator.
    pub method: Method,
    /// Relative and absolute tolerance.
    pub tolerance: f64,
    /// Steps, rejected steps, evaluations and Jacobians.
    pub statistics: dwell_dynamics::Statistics,
    /// Least wall time of three runs, s.
    pub wall_time: f64,
    /// |time of the first revolution − period| / period.
    pub period_error: f64,
    /// Largest |E / E₀ − 1| at the steps.
    pub drift: f64,
    /// Largest reaction error at the steps, relative to the largest reaction of its unit.
    pub reaction_error: f64,
    /// (time, |E / E₀ − 1|) at the steps.
    pub drift_over_time: Vec<[f64; 2]>,
}

impl ToleranceRun {
    /// Time and value of the largest drift.
    fn largest_drift(&self) -> [f64; 2] {
        let drifts = self.drift_over_time.iter();
        drifts.fold([0.0, 0.0], |w, d| if d[1] > w[1] { *d } else { w })
    }
}

/// The results.
#[derive(Debug, Clone)]
pub struct CheckedFreeMotion {
    /// The motion by quadrature.
    pub orbit: Orbit,
    /// By method and then from the coarsest tolerance to the finest.
    pub tolerance_runs: Vec<ToleranceRun>,
    /// Fitted slope of log drift over log tolerance, BDF.
    pub drift_slope: f64,
    /// The findings.
    pub findings: Vec<Finding>,
}

/// Checks a free motion.
///
/// # Errors
/// [`DynamicsError`] when it has no period or an integration fails.
pub fn check_free_motion<R: ReducedModel>(
    model: &R,
    case: &FreeMotionCase,
) -> Result<CheckedFreeMotion, DynamicsError> {
    let orbit = Orbit::new(model, case.initial_state)?;
    let motion = Motion::new(model, case, &orbit)?;
    let methods = [Method::Bdf, Method::Tsit45].into_iter();
    let tasks = methods.flat_map(|m| TOLERANCE_EXPONENTS.rev().map(move |power| (m, power)));
    let tasks: Vec<(Method, i32)> = tasks.collect();
    let run = |&(method, exponent): &(Method, i32)| motion.run(method, 10_f64.powi(exponent));
    let runs: Vec<_> = tasks.par_iter().map(run).collect::<Result<_, _>>()?;
    let mut findings: Vec<Finding> = check_quadrature(case, &orbit).into_iter().collect();
    for (run, solution) in &runs {
        if run.tolerance <= CHECK_TOLERANCE * 1.5 {
            findings.extend(motion.check_run(run, solution)?);
        }
    }
    let tolerance_runs: Vec<ToleranceRun> = runs.into_iter().map(|(run, _)| run).collect();
    let drift_slope = fitted_slope(&tolerance_runs);
    // Where nothing but rounding drifts (a balanced rotor), there is no slope to check.
    if tolerance_runs.iter().any(|r| r.drift > 1e-11) {
        findings.push(check_convergence(drift_slope));
    }
    findings.push(check_jacobian(model, case, &orbit)?);
    Ok(CheckedFreeMotion {
        orbit,
        tolerance_runs,
        drift_slope,
        findings,
    })
}

/// A motion with its references.
struct Motion<'a, R> {
    model: &'a R,
    case: &'a FreeMotionCase,
    orbit: &'a Orbit,
    /// The largest speed over a revolution, and by reaction the largest of its unit.
    speed_scale: f64,
    reaction_scales: Vec<f64>,
}

/// The largest change of the velocity and its time, and that of a reaction as [`Motion::reaction_difference`].
type Periodicity = ((f64, f64), ((f64, f64, usize), f64));

impl<'a, R: ReducedModel> Motion<'a, R> {
    fn new(
        model: &'a R,
        case: &'a FreeMotionCase,
        orbit: &'a Orbit,
    ) -> Result<Self, DynamicsError> {
        let mut outputs = ReducedOutputs::new(model);
        let (mut speed, mut largest) = (0.0_f64, vec![0.0_f64; case.reactions.len()]);
        for i in 0..COMPARED_STATES {
            let t = case.initial_state.t + orbit.period * i as f64 / COMPARED_STATES as f64;
            let state = orbit.state_at(t);
            speed = speed.max(state.q_dot.abs());
            for (max, value) in largest.iter_mut().zip(reactions(&mut outputs, state)?) {
                *max = max.max(value.abs());
            }
        }
        let of_unit = |unit: &str| {
            let all = case.reactions.iter().zip(&largest);
            let same = all.filter(|((_, u), _)| *u == unit).map(|(_, v)| *v);
            same.fold(0.0, f64::max)
        };
        let reaction_scales = case.reactions.iter().map(|(_, u)| of_unit(u)).collect();
        Ok(Self {
            model,
            case,
            orbit,
            speed_scale: speed,
            reaction_scales,
        })
    }

    /// Largest difference of the reactions in two states, relative to their scales and absolute, and of which reaction.
    fn reaction_difference(
        &self,
        outputs: &mut ReducedOutputs<'_, R>,
        [one, other]: [ReducedState; 2],
    ) -> Result<(f64, f64, usize), DynamicsError> {
        let (r, s) = (reactions(outputs, one)?, reactions(outputs, other)?);
        let mut worst = (0.0, 0.0, 0);
        for (k, ((r, s), scale)) in r.iter().zip(&s).zip(&self.reaction_scales).enumerate() {
            let difference = (r - s).abs();
            if difference > worst.0 * scale {
                worst = (difference / scale, difference, k);
            }
        }
        Ok(worst)
    }

    fn run(
        &self,
        method: Method,
        tolerance: f64,
    ) -> Result<(ToleranceRun, Solution), DynamicsError> {
        let start = self.case.initial_state;
        let options = Options {
            // A slow motion must not hide below the absolute tolerance on its speed.
            atol: tolerance * start.q_dot.abs().min(1.0),
            ..Options::new(method, tolerance)
        };
        let revolutions = Event {
            kind: EventKind::Revolution(ReducedCoordinate),
            terminal: NonZeroUsize::new(self.case.revolutions.max(1)),
        };
        let timed = || -> Result<(f64, Solution), DynamicsError> {
            let began = Instant::now();
            let solution = solve_reduced(self.model, start, None, &options, &[revolutions])?;
            Ok((began.elapsed().as_secs_f64(), solution.completed()?))
        };
        let (mut wall_time, solution) = timed()?;
        // The last step ends at the last revolution, on the dense output: its error is not that of a step.
        let mut steps: Vec<ReducedState> = solution.steps.iter().map(ReducedState::from).collect();
        steps.truncate(steps.len().max(2) - 1);
        for _ in 1..TIMED_RUNS {
            wall_time = wall_time.min(timed()?.0);
        }
        let mut equation = ReducedOde::new(self.model);
        let mut drift_over_time = Vec::with_capacity(steps.len());
        for state in &steps {
            let energy = equation.kinetic_energy(state.q, state.q_dot)?;
            drift_over_time.push([state.t, (energy / self.orbit.energy - 1.0).abs()]);
        }
        let mut outputs = ReducedOutputs::new(self.model);
        let mut reaction_error = 0.0_f64;
        if self.model.reactions() > 0 {
            for state in steps.iter().step_by(steps.len() / COMPARED_STATES + 1) {
                let exact = self.orbit.state_at(state.t);
                let both = [*state, exact];
                let error = self.reaction_difference(&mut outputs, both)?.0;
                reaction_error = reaction_error.max(error);
            }
        }
        let run = ToleranceRun {
            method,
            tolerance,
            statistics: solution.statistics,
            wall_time,
            period_error: self.first_revolution_error(&solution) / self.orbit.period,
            drift: drift_over_time.iter().map(|d| d[1]).fold(0.0, f64::max),
            reaction_error,
            drift_over_time,
        };
        Ok((run, solution))
    }

    /// |time of the first revolution − period|, s.
    fn first_revolution_error(&self, solution: &Solution) -> f64 {
        let first = solution.event_occurrences.first();
        let duration = first.map_or(f64::NAN, |o| o.state.t - self.case.initial_state.t);
        (duration - self.orbit.period).abs()
    }

    /// The largest change of the velocity after a revolution, and of a reaction with its index, each with its time.
    fn periodicity(&self, solution: &Solution) -> Result<Periodicity, DynamicsError> {
        let start = self.case.initial_state;
        let (mut velocity, mut reaction) = ((0.0, 0.0), ((0.0, 0.0, 0), 0.0));
        let mut outputs = ReducedOutputs::new(self.model);
        for occurrence in &solution.event_occurrences {
            let state = ReducedState::from(&occurrence.state);
            let change = (state.q_dot - start.q_dot).abs();
            if change > velocity.0 {
                velocity = (change, state.t);
            }
            let both = [state, start];
            let difference = self.reaction_difference(&mut outputs, both)?;
            if difference.0 > reaction.0.0 {
                reaction = (difference, state.t);
            }
        }
        Ok((velocity, reaction))
    }

    /// Period, energy and periodicity of a run at the finest tolerance.
    fn check_run(
        &self,
        run: &ToleranceRun,
        solution: &Solution,
    ) -> Result<Vec<Finding>, DynamicsError> {
        let (case, orbit) = (self.case, self.orbit);
        let (name, lower) = (run.method.name(), run.method.name().to_lowercase());
        let ([period, energy], reason) = tolerances(run.method);
        // Measured over ten revolutions; the energy error grows in proportion to them.
        let energy = energy * (case.revolutions as f64 / 10.0).max(1.0);
        let over = |revolutions: String| format!("{revolutions}, tolerance {CHECK_TOLERANCE:.0e}");
        let finding = |key: &str, check, numbers, tolerance: f64| Finding {
            domain: over(format!("{} revolutions", case.revolutions)),
            tolerance_reason: reason.into(),
            integrated: true,
            ..Finding::new(&format!("{key}-{lower}"), check, numbers, tolerance)
        };
        let late = self.first_revolution_error(solution);
        let [t, drift] = run.largest_drift();
        let ((change, after), (reaction, late_at)) = self.periodicity(solution)?;
        let periodic = [change, change / self.speed_scale];
        let mut findings = vec![
            Finding {
                comparison: format!("the first revolution of {name} with the quadrature"),
                domain: over("one revolution".to_owned()),
                unit: "s".into(),
                scale: "the period".into(),
                worst_at: format!("t = {:.6} s", orbit.period),
                ..finding("period", Period, [late, late / orbit.period], period)
            },
            Finding {
                comparison: format!("E = ½ m q̇² of {name} with its initial value"),
                unit: "J".into(),
                scale: "the energy".into(),
                worst_at: format!("t = {t:.3} s"),
                ..finding("energy", Power, [drift * orbit.energy, drift], energy)
            },
            Finding {
                comparison: format!("q̇ after each revolution of {name} with q̇ at the start"),
                unit: "rad/s".into(),
                scale: "the largest speed".into(),
                worst_at: format!("t = {after:.3} s"),
                tolerance_reason:
                    "the accuracy required of the energy; the speed errs by half as much".into(),
                ..finding("periodic-velocity", Period, periodic, energy)
            },
        ];
        let (relative, absolute, k) = reaction;
        findings.extend(case.reactions.get(k).map(|(reaction, unit)| Finding {
            comparison: format!("reactions after each revolution of {name} with the initial ones"),
            unit: (*unit).into(),
            scale: "the largest reaction of the unit".into(),
            worst_at: format!("{reaction}, t = {late_at:.3} s"),
            tolerance_reason:
                "the accuracy required of the energy, on which a reaction depends linearly".into(),
            ..finding("periodic-reactions", Period, [absolute, relative], energy)
        }));
        Ok(findings)
    }
}

/// The reactions in a state of the free motion, with q̈ from the equation of motion.
fn reactions<R: ReducedModel>(
    outputs: &mut ReducedOutputs<'_, R>,
    state: ReducedState,
) -> Result<Vec<f64>, DynamicsError> {
    outputs.evaluate(state.q, state.q_dot)?;
    Ok(outputs.reactions.clone())
}

/// Compares the quadrature with a reference value, if there is one.
fn check_quadrature(case: &FreeMotionCase, orbit: &Orbit) -> Option<Finding> {
    let (known, source) = case.period.as_ref()?;
    let (period, points) = (orbit.period, orbit.points);
    let difference = (period - known).abs();
    let numbers = [difference, difference / period];
    Some(Finding {
        comparison: format!("T = ∮ √(m / 2E) dq = {period:.14} s with {known:.14} s ({source})"),
        domain: format!("one revolution, {points} points of the trapezoid rule"),
        unit: "s".into(),
        scale: "the period".into(),
        worst_at: "the whole revolution".into(),
        tolerance_reason:
            "a spectral rule on an exact integrand leaves only the rounding of its sum".into(),
        ..Finding::new("period-quadrature", Period, numbers, 4e-14)
    })
}

/// Tolerances of a method at the checked tolerance: of the period, and of energy and periodicity.
fn tolerances(method: Method) -> ([f64; 2], &'static str) {
    match method {
        Method::Bdf | Method::Esdirk34 | Method::TrBdf2 => (
            [1e-10, 1e-9],
            "BDF's energy error grows with time to hundreds of times its tolerance; measured 1e-10 to \
             2e-10 in ten revolutions, 1e-11 in a period",
        ),
        Method::Tsit45 | Method::Dop853 => (
            [5e-12, 1e-10],
            "Tsit45 errs by some tens of its tolerance in ten revolutions; measured 1e-12 to 4e-12, and 1e-13 \
             in a period",
        ),
    }
}

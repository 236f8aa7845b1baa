//! The free motion against what needs no integrator: energy (check 4), the period and the whole
//! time history by quadrature (check 5), and periodicity. Beside the findings it yields the ladder
//! of tolerances from which cost can be read against error.

mod convergence;

use convergence::{check_convergence, check_jacobian, fitted_slope};
use dwell_dynamics::{
    DynamicsError, Event, EventKind, Method, Options, Orbit, ReducedCoordinate, ReducedOde,
    ReducedOutputs, ReducedState, Solution, solve_reduced,
};
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::ReducedModel;
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::time::Instant;

/// Tolerance at which the integrators are checked.
const CHECK_TOLERANCE: f64 = 1e-13;
/// The finest and the coarsest tolerance of the ladder, as powers of ten.
const TOLERANCE_EXPONENTS: std::ops::RangeInclusive<i32> = -13..=-4;
/// Runs of which the shortest wall time is taken; other threads run beside them.
const TIMED_RUNS: usize = 3;
/// States of a run at which its reactions are compared with the exact ones.
const COMPARED_STATES: usize = 400;

/// A free motion to be checked.
#[derive(Debug, Clone)]
pub struct FreeMotionCase {
    /// The start.
    pub initial_state: ReducedState,
    /// Whole turns to follow.
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
    /// |time of the first whole turn − period| / period.
    pub period_error: f64,
    /// Largest |E / E₀ − 1| at the steps.
    pub drift: f64,
    /// Largest reaction error at the steps, relative to the largest reaction of its unit.
    pub reaction_error: f64,
    /// (time, |E / E₀ − 1|) at the steps.
    pub drift_over_time: Vec<[f64; 2]>,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct CheckedFreeMotion {
    /// The motion by quadrature.
    pub orbit: Orbit,
    /// The ladder, by method and then from the coarsest tolerance to the finest.
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
    let scales = MotionScales::new(model, case, &orbit)?;
    let tasks: Vec<(Method, i32)> = [Method::Bdf, Method::Tsit45]
        .into_iter()
        .flat_map(|method| {
            TOLERANCE_EXPONENTS
                .rev()
                .map(move |exponent| (method, exponent))
        })
        .collect();
    let runs: Vec<(ToleranceRun, Solution)> = tasks
        .par_iter()
        .map(|&(method, exponent)| tolerance_run(model, case, &orbit, &scales, method, exponent))
        .collect::<Result<_, _>>()?;
    let drift_slope = fitted_slope(&runs);
    let mut findings: Vec<Finding> = check_quadrature(case, &orbit).into_iter().collect();
    for (tolerance_run, solution) in &runs {
        if tolerance_run.tolerance <= CHECK_TOLERANCE * 1.5 {
            findings.extend(check_run(
                model,
                case,
                &orbit,
                &scales,
                tolerance_run,
                solution,
            )?);
        }
    }
    // Where nothing but rounding drifts (a balanced rotor), there is no slope to judge.
    if runs.iter().any(|(r, _)| r.drift > 1e-11) {
        findings.push(check_convergence(drift_slope));
    }
    findings.push(check_jacobian(model, case, &orbit)?);
    Ok(CheckedFreeMotion {
        tolerance_runs: runs
            .into_iter()
            .map(|(tolerance_run, _)| tolerance_run)
            .collect(),
        orbit,
        drift_slope,
        findings,
    })
}

/// The largest speed, reactions and coefficients over a turn.
struct MotionScales {
    speed: f64,
    /// By reaction: the largest of its unit.
    reactions: Vec<f64>,
}

impl MotionScales {
    fn new<R: ReducedModel>(
        model: &R,
        case: &FreeMotionCase,
        orbit: &Orbit,
    ) -> Result<Self, DynamicsError> {
        let mut reaction_evaluator = ReactionEvaluator::new(model);
        let (mut speed, mut largest) = (0.0_f64, vec![0.0_f64; case.reactions.len()]);
        for i in 0..COMPARED_STATES {
            let t = case.initial_state.t + orbit.period * i as f64 / COMPARED_STATES as f64;
            let state = orbit.state_at(t);
            speed = speed.max(state.q_dot.abs());
            for (max, value) in largest.iter_mut().zip(reaction_evaluator.reactions(state)?) {
                *max = max.max(value.abs());
            }
        }
        let of_unit = |unit: &str| {
            let same = case.reactions.iter().zip(&largest);
            same.filter(|((_, u), _)| *u == unit)
                .map(|(_, v)| *v)
                .fold(0.0, f64::max)
        };
        let reactions = case.reactions.iter().map(|(_, u)| of_unit(u)).collect();
        Ok(Self { speed, reactions })
    }
}

/// Evaluates reactions in a state of the free motion, with q̈ from the equation of motion.
struct ReactionEvaluator<'a, R: ReducedModel>(ReducedOutputs<'a, R>);

impl<'a, R: ReducedModel> ReactionEvaluator<'a, R> {
    fn new(model: &'a R) -> Self {
        Self(ReducedOutputs::new(model))
    }

    fn reactions(&mut self, state: ReducedState) -> Result<Vec<f64>, DynamicsError> {
        self.0.evaluate(state.q, state.q_dot)?;
        Ok(self.0.reactions.clone())
    }

    /// Largest difference of the reactions in two states, relative to their scales, and whose it is.
    fn difference(
        &mut self,
        one: ReducedState,
        other: ReducedState,
        scales: &MotionScales,
    ) -> Result<(f64, f64, usize), DynamicsError> {
        let (r, s) = (self.reactions(one)?, self.reactions(other)?);
        let mut worst = (0.0, 0.0, 0);
        for (k, ((r, s), scale)) in r.iter().zip(&s).zip(&scales.reactions).enumerate() {
            let difference = (r - s).abs();
            if difference > worst.0 * scale {
                worst = (difference / scale, difference, k);
            }
        }
        Ok(worst)
    }
}

fn tolerance_run<R: ReducedModel>(
    model: &R,
    case: &FreeMotionCase,
    orbit: &Orbit,
    scales: &MotionScales,
    method: Method,
    exponent: i32,
) -> Result<(ToleranceRun, Solution), DynamicsError> {
    let tolerance = 10_f64.powi(exponent);
    let options = Options {
        // A slow motion must not hide below the absolute tolerance on its speed.
        atol: tolerance * case.initial_state.q_dot.abs().min(1.0),
        ..Options::new(method, tolerance)
    };
    let revolutions = Event {
        kind: EventKind::Revolution(ReducedCoordinate),
        terminal: NonZeroUsize::new(case.revolutions.max(1)),
    };
    let timed = || -> Result<(f64, Solution), DynamicsError> {
        let began = Instant::now();
        let solution = solve_reduced(model, case.initial_state, None, &options, &[revolutions])?;
        Ok((began.elapsed().as_secs_f64(), solution.completed()?))
    };
    let (mut seconds, solution) = timed()?;
    // The last step ends at the last revolution, on the dense output: its error is not that of a step.
    let steps: Vec<ReducedState> = solution.steps.iter().map(ReducedState::from).collect();
    let steps = &steps[..steps.len().max(2) - 1];
    for _ in 1..TIMED_RUNS {
        seconds = seconds.min(timed()?.0);
    }
    let mut equation = ReducedOde::new(model);
    let mut drift_in_time = Vec::with_capacity(steps.len());
    for state in steps {
        let energy = equation.kinetic_energy(state.q, state.q_dot)?;
        drift_in_time.push([state.t, (energy / orbit.energy - 1.0).abs()]);
    }
    let mut reaction_evaluator = ReactionEvaluator::new(model);
    let mut reaction_error = 0.0_f64;
    if model.reactions() > 0 {
        for state in steps.iter().step_by(steps.len() / COMPARED_STATES + 1) {
            let exact = orbit.state_at(state.t);
            reaction_error =
                reaction_error.max(reaction_evaluator.difference(*state, exact, scales)?.0);
        }
    }
    let tolerance_run = ToleranceRun {
        method,
        tolerance,
        statistics: solution.statistics,
        wall_time: seconds,
        period_error: first_revolution_error(&solution, case, orbit) / orbit.period,
        drift: drift_in_time.iter().map(|d| d[1]).fold(0.0, f64::max),
        reaction_error,
        drift_over_time: drift_in_time,
    };
    Ok((tolerance_run, solution))
}

/// |time of the first whole turn − period|, s.
fn first_revolution_error(solution: &Solution, case: &FreeMotionCase, orbit: &Orbit) -> f64 {
    solution.event_occurrences.first().map_or(f64::NAN, |o| {
        (o.state.t - case.initial_state.t - orbit.period).abs()
    })
}

/// The quadrature against a reference value, where there is one.
fn check_quadrature(case: &FreeMotionCase, orbit: &Orbit) -> Option<Finding> {
    let (reference, source) = case.period.as_ref()?;
    let difference = (orbit.period - reference).abs();
    let relative_difference = difference / orbit.period;
    Some(Finding {
        key: "period-quadrature".into(),
        check: Check::Period,
        comparison: format!(
            "T = ∮ √(m / 2E) dq = {:.14} s with {reference:.14} s ({source})",
            orbit.period
        ),
        domain: format!("one turn, {} points of the trapezoid rule", orbit.points),
        absolute_difference: difference,
        unit: "s".into(),
        relative_difference,
        scale: "the period".into(),
        worst_at: "the whole turn".into(),
        tolerance: 4e-14,
        tolerance_reason:
            "a spectral rule on an exact integrand leaves only the rounding of its sum".into(),
        pass: relative_difference <= 4e-14,
        ..Finding::default()
    })
}

/// What a method is held to at the judged tolerance: period, and energy and periodicity.
fn tolerances(method: Method) -> ([f64; 2], &'static str) {
    match method {
        Method::Bdf | Method::Esdirk34 | Method::TrBdf2 => (
            [1e-10, 1e-9],
            "BDF's energy error grows with time to hundreds of times its tolerance; measured 1e-10 to \
             2e-10 in ten turns, 1e-11 in a period",
        ),
        Method::Tsit45 | Method::Dop853 => (
            [5e-12, 1e-10],
            "Tsit45 errs by some tens of its tolerance in ten turns; measured 1e-12 to 4e-12, and 1e-13 \
             in a period",
        ),
    }
}

/// Period, energy and periodicity of a run at the finest tolerance.
fn check_run<R: ReducedModel>(
    model: &R,
    case: &FreeMotionCase,
    orbit: &Orbit,
    scales: &MotionScales,
    tolerance_run: &ToleranceRun,
    solution: &Solution,
) -> Result<Vec<Finding>, DynamicsError> {
    let name = tolerance_run.method.name();
    let lower = name.to_lowercase();
    let domain = format!(
        "{} turns, tolerance {CHECK_TOLERANCE:.0e}",
        case.revolutions
    );
    let ([period, energy], tolerance_reason) = tolerances(tolerance_run.method);
    // Measured over ten turns; the energy error grows in proportion to them.
    let energy = energy * (case.revolutions as f64 / 10.0).max(1.0);
    let difference = first_revolution_error(solution, case, orbit);
    let relative_difference = difference / orbit.period;
    let mut findings = vec![Finding {
        key: format!("period-{lower}"),
        check: Check::Period,
        comparison: format!(
            "the first whole turn of {name}, located on its dense output, with the quadrature"
        ),
        domain: format!("one turn, tolerance {CHECK_TOLERANCE:.0e}"),
        absolute_difference: difference,
        unit: "s".into(),
        relative_difference,
        scale: "the period".into(),
        worst_at: format!("t = {:.6} s", orbit.period),
        tolerance: period,
        tolerance_reason: tolerance_reason.into(),
        integrated: true,
        pass: relative_difference <= period,
        ..Finding::default()
    }];
    let worst = tolerance_run
        .drift_over_time
        .iter()
        .fold([0.0, 0.0], |w, d| if d[1] > w[1] { *d } else { w });
    findings.push(Finding {
        key: format!("energy-{lower}"),
        check: Check::Power,
        comparison: format!("E = ½ m q̇² of {name} with its initial value"),
        domain: domain.clone(),
        absolute_difference: worst[1] * orbit.energy,
        unit: "J".into(),
        relative_difference: worst[1],
        scale: "the energy".into(),
        worst_at: format!("t = {:.3} s", worst[0]),
        tolerance: energy,
        tolerance_reason: tolerance_reason.into(),
        integrated: true,
        pass: worst[1] <= energy,
        ..Finding::default()
    });
    let (mut speed, mut reaction) = ((0.0_f64, 0.0), (0.0_f64, 0.0, 0, 0.0));
    let mut reaction_evaluator = ReactionEvaluator::new(model);
    for occurrence in &solution.event_occurrences {
        let state = ReducedState::from(&occurrence.state);
        let speed_change = (state.q_dot - case.initial_state.q_dot).abs();
        if speed_change > speed.0 {
            speed = (speed_change, state.t);
        }
        let (relative, absolute, k) =
            reaction_evaluator.difference(state, case.initial_state, scales)?;
        if relative > reaction.0 {
            reaction = (relative, absolute, k, state.t);
        }
    }
    findings.push(Finding {
        key: format!("periodic-velocity-{lower}"),
        check: Check::Period,
        comparison: format!("q̇ at each whole turn of {name} with q̇ at the start"),
        domain: domain.clone(),
        absolute_difference: speed.0,
        unit: "rad/s".into(),
        relative_difference: speed.0 / scales.speed,
        scale: "the largest speed".into(),
        worst_at: format!("t = {:.3} s", speed.1),
        tolerance: energy,
        tolerance_reason: "the accuracy asked of the energy; the speed errs by half as much".into(),
        integrated: true,
        pass: speed.0 <= energy * scales.speed,
        ..Finding::default()
    });
    if let Some((name_k, unit)) = case.reactions.get(reaction.2) {
        findings.push(Finding {
            key: format!("periodic-reactions-{lower}"),
            check: Check::Period,
            comparison: format!(
                "requested reactions at each whole turn of {name} with those at the start"
            ),
            domain,
            absolute_difference: reaction.1,
            unit: (*unit).into(),
            relative_difference: reaction.0,
            scale: "the largest reaction of the unit".into(),
            worst_at: format!("{name_k}, t = {:.3} s", reaction.3),
            tolerance: energy,
            tolerance_reason:
                "the accuracy asked of the energy, on which a reaction depends linearly".into(),
            integrated: true,
            pass: reaction.0 <= energy,
            ..Finding::default()
        });
    }
    Ok(findings)
}

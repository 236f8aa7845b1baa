//! The free motion against what needs no integrator: energy (truth 4), the period and the whole
//! time history by quadrature (truth 5), and periodicity. Beside the findings it yields the ladder
//! of tolerances from which cost can be read against error.

use dwell_dynamics::{
    DynamicsError, Equation, Method, Options, Orbit, Run, State, Until, simulate,
};
use dwell_findings::Finding;
use dwell_kinetostatics::{Coefficients, Reduced};
use rayon::prelude::*;
use std::time::Instant;

/// Tolerance at which the integrators are judged.
const JUDGED_AT: f64 = 1e-13;
/// The finest and the coarsest tolerance of the ladder, as powers of ten.
const LADDER: std::ops::RangeInclusive<i32> = -13..=-4;
/// The drift's slope is fitted over tolerances from 1e-13 to this power of ten.
const FITTED_TO: i32 = -8;
/// Runs of which the shortest wall time is taken; other threads run beside them.
const TIMED: usize = 3;
/// States of a run at which its reactions are compared with the exact ones.
const COMPARED: usize = 400;

/// A free motion to be judged.
#[derive(Debug, Clone)]
pub struct FreeMotionCase {
    /// The start.
    pub start: State,
    /// Whole turns to follow.
    pub turns: usize,
    /// By reaction of the model: name and unit.
    pub reactions: Vec<(String, &'static str)>,
    /// A reference value of the period (s), with its source, if there is one.
    pub period: Option<(f64, String)>,
}

/// One tolerance of one integrator.
#[derive(Debug, Clone, PartialEq)]
pub struct Rung {
    /// The integrator.
    pub method: Method,
    /// Relative and absolute tolerance.
    pub tolerance: f64,
    /// Steps, rejected steps, evaluations and Jacobians.
    pub work: dwell_dynamics::Statistics,
    /// Least wall time of three runs, s.
    pub seconds: f64,
    /// |time of the first whole turn − period| / period.
    pub period_error: f64,
    /// Largest |E / E₀ − 1| at the steps.
    pub drift: f64,
    /// Largest reaction error at the steps, relative to the largest reaction of its unit.
    pub reaction_error: f64,
    /// (time, |E / E₀ − 1|) at the steps.
    pub drift_in_time: Vec<[f64; 2]>,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct FreeMotion {
    /// The motion by quadrature.
    pub turn: Orbit,
    /// The ladder, by method and then from the coarsest tolerance to the finest.
    pub rungs: Vec<Rung>,
    /// Fitted slope of log drift over log tolerance, BDF.
    pub slope: f64,
    /// The findings.
    pub findings: Vec<Finding>,
}

/// Judges a free motion.
///
/// # Errors
/// [`DynamicsError`] when it has no period or an integration fails.
pub fn free_motion<R: Reduced>(
    model: &R,
    case: &FreeMotionCase,
) -> Result<FreeMotion, DynamicsError> {
    let turn = Orbit::new(model, case.start)?;
    let scales = Scales::new(model, case, &turn)?;
    let tasks: Vec<(Method, i32)> = [Method::Bdf, Method::Tsit45]
        .into_iter()
        .flat_map(|method| LADDER.rev().map(move |power| (method, power)))
        .collect();
    let runs: Vec<(Rung, Run)> = tasks
        .par_iter()
        .map(|&(method, power)| rung(model, case, &turn, &scales, method, power))
        .collect::<Result<_, _>>()?;
    let slope = fitted_slope(&runs);
    let mut findings: Vec<Finding> = quadrature(case, &turn).into_iter().collect();
    for (rung, run) in &runs {
        if rung.tolerance <= JUDGED_AT * 1.5 {
            findings.extend(judge(model, case, &turn, &scales, rung, run)?);
        }
    }
    // Where nothing but rounding drifts (a balanced rotor), there is no slope to judge.
    if runs.iter().any(|(r, _)| r.drift > 1e-11) {
        findings.push(convergence(slope));
    }
    findings.push(jacobian(model, case, &turn)?);
    Ok(FreeMotion {
        rungs: runs.into_iter().map(|(rung, _)| rung).collect(),
        turn,
        slope,
        findings,
    })
}

/// The largest speed, reactions and coefficients over a turn.
struct Scales {
    speed: f64,
    /// By reaction: the largest of its unit.
    reactions: Vec<f64>,
}

impl Scales {
    fn new<R: Reduced>(
        model: &R,
        case: &FreeMotionCase,
        turn: &Orbit,
    ) -> Result<Self, DynamicsError> {
        let mut eye = Eye::new(model);
        let (mut speed, mut largest) = (0.0_f64, vec![0.0_f64; case.reactions.len()]);
        for i in 0..COMPARED {
            let t = case.start.t + turn.period * i as f64 / COMPARED as f64;
            let state = turn.at(t);
            speed = speed.max(state.q_dot.abs());
            for (most, value) in largest.iter_mut().zip(eye.reactions(state)?) {
                *most = most.max(value.abs());
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

/// Evaluates reactions in a state of the free motion.
struct Eye<'a, R: Reduced> {
    model: &'a R,
    work: R::Work,
    at: Coefficients,
}

impl<'a, R: Reduced> Eye<'a, R> {
    fn new(model: &'a R) -> Self {
        Self {
            model,
            work: model.work(),
            at: Coefficients {
                a: vec![0.0; model.reactions()],
                b: vec![0.0; model.reactions()],
                ..Coefficients::default()
            },
        }
    }

    /// R = a q̈ + b q̇² with q̈ from the equation of motion.
    fn reactions(&mut self, state: State) -> Result<Vec<f64>, DynamicsError> {
        self.model
            .coefficients(state.q, &mut self.work, &mut self.at)?;
        let square = state.q_dot * state.q_dot;
        let q_ddot = -self.at.half_dm * square / self.at.m;
        let both = self.at.a.iter().zip(&self.at.b);
        Ok(both.map(|(a, b)| a * q_ddot + b * square).collect())
    }

    /// Largest difference of the reactions in two states, relative to their scales, and whose it is.
    fn apart(
        &mut self,
        one: State,
        other: State,
        scales: &Scales,
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

fn rung<R: Reduced>(
    model: &R,
    case: &FreeMotionCase,
    turn: &Orbit,
    scales: &Scales,
    method: Method,
    power: i32,
) -> Result<(Rung, Run), DynamicsError> {
    let tolerance = 10_f64.powi(power);
    let options = Options {
        // A slow motion must not hide below the absolute tolerance on its speed.
        absolute: tolerance * case.start.q_dot.abs().min(1.0),
        ..Options::new(method, tolerance)
    };
    let timed = || -> Result<(f64, Run), DynamicsError> {
        let began = Instant::now();
        let run = simulate(model, case.start, Until::Turns(case.turns), &options)?;
        Ok((began.elapsed().as_secs_f64(), run))
    };
    let (mut seconds, run) = timed()?;
    for _ in 1..TIMED {
        seconds = seconds.min(timed()?.0);
    }
    let mut equation = Equation::new(model);
    let mut drift_in_time = Vec::with_capacity(run.steps.len());
    for state in &run.steps {
        let energy = equation.energy(state.q, state.q_dot)?;
        drift_in_time.push([state.t, (energy / turn.energy - 1.0).abs()]);
    }
    let mut eye = Eye::new(model);
    let mut reaction_error = 0.0_f64;
    if model.reactions() > 0 {
        for state in run.steps.iter().step_by(run.steps.len() / COMPARED + 1) {
            let exact = turn.at(state.t);
            reaction_error = reaction_error.max(eye.apart(*state, exact, scales)?.0);
        }
    }
    let rung = Rung {
        method,
        tolerance,
        work: run.statistics,
        seconds,
        period_error: first_turn_error(&run, case, turn) / turn.period,
        drift: drift_in_time.iter().map(|d| d[1]).fold(0.0, f64::max),
        reaction_error,
        drift_in_time,
    };
    Ok((rung, run))
}

/// |time of the first whole turn − period|, s.
fn first_turn_error(run: &Run, case: &FreeMotionCase, turn: &Orbit) -> f64 {
    run.turns
        .first()
        .map_or(f64::NAN, |s| (s.t - case.start.t - turn.period).abs())
}

/// The quadrature against a reference value, where there is one.
fn quadrature(case: &FreeMotionCase, turn: &Orbit) -> Option<Finding> {
    let (reference, source) = case.period.as_ref()?;
    let difference = (turn.period - reference).abs();
    let relative = difference / turn.period;
    Some(Finding {
        key: "period-quadrature".into(),
        truth: "5 period by quadrature".into(),
        compared: format!(
            "T = ∮ √(m / 2E) dq = {:.14} s with {reference:.14} s ({source})",
            turn.period
        ),
        over: format!("one turn, {} points of the trapezoid rule", turn.points),
        absolute: difference,
        unit: "s".into(),
        relative,
        scale: "the period".into(),
        worst: "the whole turn".into(),
        tolerance: 4e-14,
        why: "a spectral rule on an exact integrand leaves only the rounding of its sum".into(),
        pass: relative <= 4e-14,
        ..Finding::default()
    })
}

/// What a method is held to at the judged tolerance: period, and energy and periodicity.
fn allowed(method: Method) -> ([f64; 2], &'static str) {
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
fn judge<R: Reduced>(
    model: &R,
    case: &FreeMotionCase,
    turn: &Orbit,
    scales: &Scales,
    rung: &Rung,
    run: &Run,
) -> Result<Vec<Finding>, DynamicsError> {
    let name = rung.method.name();
    let lower = name.to_lowercase();
    let over = format!("{} turns, tolerance {JUDGED_AT:.0e}", case.turns);
    let ([period, energy], why) = allowed(rung.method);
    // Measured over ten turns; the energy error grows in proportion to them.
    let energy = energy * (case.turns as f64 / 10.0).max(1.0);
    let difference = first_turn_error(run, case, turn);
    let relative = difference / turn.period;
    let mut findings = vec![Finding {
        key: format!("period-{lower}"),
        truth: "5 period by quadrature".into(),
        compared: format!(
            "the first whole turn of {name}, located on its dense output, with the quadrature"
        ),
        over: format!("one turn, tolerance {JUDGED_AT:.0e}"),
        absolute: difference,
        unit: "s".into(),
        relative,
        scale: "the period".into(),
        worst: format!("t = {:.6} s", turn.period),
        tolerance: period,
        why: why.into(),
        integrated: true,
        pass: relative <= period,
        ..Finding::default()
    }];
    let worst = rung
        .drift_in_time
        .iter()
        .fold([0.0, 0.0], |w, d| if d[1] > w[1] { *d } else { w });
    findings.push(Finding {
        key: format!("energy-{lower}"),
        truth: "4 energy".into(),
        compared: format!("E = ½ m q̇² of {name} with its initial value"),
        over: over.clone(),
        absolute: worst[1] * turn.energy,
        unit: "J".into(),
        relative: worst[1],
        scale: "the energy".into(),
        worst: format!("t = {:.3} s", worst[0]),
        tolerance: energy,
        why: why.into(),
        integrated: true,
        pass: worst[1] <= energy,
        ..Finding::default()
    });
    let (mut speed, mut reaction) = ((0.0_f64, 0.0), (0.0_f64, 0.0, 0, 0.0));
    let mut eye = Eye::new(model);
    for state in &run.turns {
        let apart = (state.q_dot - case.start.q_dot).abs();
        if apart > speed.0 {
            speed = (apart, state.t);
        }
        let (relative, absolute, k) = eye.apart(*state, case.start, scales)?;
        if relative > reaction.0 {
            reaction = (relative, absolute, k, state.t);
        }
    }
    findings.push(Finding {
        key: format!("periodic-speed-{lower}"),
        truth: "5 periodicity".into(),
        compared: format!("q̇ at each whole turn of {name} with q̇ at the start"),
        over: over.clone(),
        absolute: speed.0,
        unit: "rad/s".into(),
        relative: speed.0 / scales.speed,
        scale: "the largest speed".into(),
        worst: format!("t = {:.3} s", speed.1),
        tolerance: energy,
        why: "the accuracy asked of the energy; the speed errs by half as much".into(),
        integrated: true,
        pass: speed.0 <= energy * scales.speed,
        ..Finding::default()
    });
    if let Some((name_k, unit)) = case.reactions.get(reaction.2) {
        findings.push(Finding {
            key: format!("periodic-reactions-{lower}"),
            truth: "5 periodicity".into(),
            compared: format!(
                "requested reactions at each whole turn of {name} with those at the start"
            ),
            over,
            absolute: reaction.1,
            unit: (*unit).into(),
            relative: reaction.0,
            scale: "the largest reaction of the unit".into(),
            worst: format!("{name_k}, t = {:.3} s", reaction.3),
            tolerance: energy,
            why: "the accuracy asked of the energy, on which a reaction depends linearly".into(),
            integrated: true,
            pass: reaction.0 <= energy,
            ..Finding::default()
        });
    }
    Ok(findings)
}

/// Slope of a straight line through log drift over log tolerance, BDF at 1e-8 and finer.
fn fitted_slope(runs: &[(Rung, Run)]) -> f64 {
    let coarsest = 10_f64.powi(FITTED_TO) * 1.5;
    let points: Vec<[f64; 2]> = runs
        .iter()
        .map(|(rung, _)| rung)
        .filter(|r| r.method == Method::Bdf && r.tolerance <= coarsest)
        .map(|r| [r.tolerance.log10(), r.drift.log10()])
        .collect();
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let (above, below) = points.iter().fold((0.0, 0.0), |(a, b), p| {
        (a + (p[0] - x) * (p[1] - y), b + (p[0] - x).powi(2))
    });
    above / below
}

fn convergence(slope: f64) -> Finding {
    let short = (0.6 - slope).max(0.0);
    Finding {
        key: "convergence-bdf".into(),
        truth: "4 energy".into(),
        compared: format!(
            "the fitted slope of log drift over log tolerance, {slope:.2}, with at least 0.6"
        ),
        over: "BDF at tolerances 1e-13 to 1e-8".into(),
        absolute: short,
        unit: "(missing slope)".into(),
        relative: short,
        scale: "one".into(),
        worst: "the fit".into(),
        tolerance: 0.0,
        why:
            "an integrator that obeys its tolerance has a slope near 1; its changes of order make \
              it wander, and below 0.6 it would not be following"
                .into(),
        integrated: true,
        pass: slope >= 0.6,
        ..Finding::default()
    }
}

/// ½m″, on which the Jacobian of the equation of motion rests. BDF only converges more slowly with
/// a wrong one, so it is checked by itself, against differences of ½m′.
fn jacobian<R: Reduced>(
    model: &R,
    case: &FreeMotionCase,
    turn: &Orbit,
) -> Result<Finding, DynamicsError> {
    let mut work = model.work();
    let (mut worst, mut largest) = ((0.0_f64, 0.0), 0.0_f64);
    const POSITIONS: usize = 48;
    for i in 0..POSITIONS {
        let t = case.start.t + turn.period * (i as f64 + 0.37) / POSITIONS as f64;
        let q = turn.at(t).q;
        let at = model.curvature(q, &mut work)?;
        let exact = at.half_ddm;
        let mut slope = |h: f64| -> Result<f64, DynamicsError> {
            let [(_, ahead), (_, back)] = [
                model.inertia(q + h, &mut work)?,
                model.inertia(q - h, &mut work)?,
            ];
            Ok((ahead - back) / (2.0 * h))
        };
        // Three central differences, extrapolated twice (Richardson), from several steps: the best of
        // them, since a long one suits a smooth inertia and a short one a sharp one.
        let mut difference = f64::INFINITY;
        for h in [8e-3, 2e-3, 5e-4, 1e-4] {
            let [d1, d2, d3] = [slope(h)?, slope(h / 2.0)?, slope(h / 4.0)?];
            let (e1, e2) = ((4.0 * d2 - d1) / 3.0, (4.0 * d3 - d2) / 3.0);
            difference = difference.min(((16.0 * e2 - e1) / 15.0 - exact).abs());
        }
        // A balanced rotor's inertia has no curvature at all: rounding is then relative to m.
        largest = largest.max(exact.abs()).max(1e-2 * at.m);
        if difference > worst.0 || difference.is_nan() {
            worst = (difference, q);
        }
    }
    let relative = if worst.0 == 0.0 {
        0.0
    } else {
        worst.0 / largest
    };
    Ok(Finding {
        key: "curvature".into(),
        truth: "2 finite differences".into(),
        compared: "½m″ by dual numbers with Richardson differences of ½m′".into(),
        over: format!("{POSITIONS} positions of the turn"),
        absolute: worst.0,
        unit: "kg m²/rad²".into(),
        relative,
        scale: "the largest ½m″, or a hundredth of m if that is more".into(),
        worst: format!("q = {:.4} rad", worst.1),
        tolerance: 1e-9,
        why:
            "the rounding of ½m′ over a step of 1e-3 rad, 1e-12, and the sixth power of 4e-3 times \
              the eighth derivative of m, which is up to 1e6 times m where the inertia is sharp"
                .into(),
        pass: relative <= 1e-9,
        ..Finding::default()
    })
}

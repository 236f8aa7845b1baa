//! The measured properties of an export: errors, operations and the error of its step, measured before it is written.

use super::Export;
use crate::counted::Counted;
use crate::evaluator::{Evaluator, MotionTerms, ReactionTerms};
use crate::fit::sample_values;
use crate::machine::{FunctionSampler, LoadEffect, MachineDescription, PartKind};
use crate::part::Precision;
use dwell_numerics::Real;

/// Positions at which the errors are measured, steps of the golden section over the domain.
const POSITIONS: usize = 4096;
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Rows of the self-test.
pub(crate) const SELF_TEST_ROWS: usize = 12;
/// The step whose error is stated, s, and the steps over which it is measured.
pub const STATED_STEP: f64 = 1e-3;
const STATED_STEPS: usize = 1000;
/// Parts of a step of the motion that the step is compared with.
const REFINEMENT: usize = 16;

/// The largest errors of the exported functions, each relative to its scale.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Errors {
    /// Error of m.
    pub m: f64,
    /// Error of ½m′.
    pub half_dm: f64,
    /// Error of every w and potential.
    pub loads: f64,
    /// Error of every a and b.
    pub reactions: f64,
    /// Error of every c.
    pub load_reactions: f64,
    /// Error of every position.
    pub positions: f64,
}

impl Errors {
    /// The largest of them.
    pub fn max(&self) -> f64 {
        let Self {
            m,
            half_dm,
            loads,
            reactions,
            load_reactions,
            positions,
        } = *self;
        [half_dm, loads, reactions, load_reactions, positions]
            .into_iter()
            .fold(m, f64::max)
    }
}

/// A row of the self-test: a coordinate, and the exact values of all functions there.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfTestRow {
    /// The coordinate, as the exported code stores it.
    pub q: f64,
    /// m, ½m′, w of every load, a, b, c and positions.
    pub values: Vec<f64>,
}

/// A motion of the self-test: the state after some steps from a state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SelfTestMotion {
    /// The step, s.
    pub step: f64,
    /// How many.
    pub steps: usize,
    /// q and q̇ at the beginning.
    pub from: [f64; 2],
    /// q and q̇ at the end, of a motion with much smaller steps, and how far the code may be off; none if it leaves the domain.
    pub end: Option<[[f64; 2]; 2]>,
}

/// Everything that is measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// The largest errors.
    pub errors: Errors,
    /// Additions, multiplications and divisions of the terms of motion, of those of motion and reactions, and of a step.
    pub operations: [u64; 3],
    /// The error of q (rad or m) and q̇ after a second of steps of a millisecond from the initial state; none if the motion
    /// leaves the domain before.
    pub step_error: Option<[f64; 2]>,
    /// Rows of the self-test.
    pub rows: Vec<SelfTestRow>,
    /// By value of a row: how far the code may be off.
    pub tolerances: Vec<f64>,
    /// The motion of the self-test.
    pub motion: SelfTestMotion,
}

/// Measures the functions of an export against the exact ones, by the scale of each value of a row.
///
/// # Errors
/// Those of the sampler.
pub(crate) fn measure<S: FunctionSampler>(
    export: &Export,
    scales: &[f64],
    sampler: &mut S,
) -> Result<Measured, S::Error> {
    let (machine, precision) = (&export.machine, export.request.precision);
    let double = export.evaluator::<f64>();
    let float = export.evaluator::<f32>();
    let mut errors = vec![0.0_f64; scales.len()];
    let mut rows = Vec::new();
    for i in 0..POSITIONS {
        let part = (0.5 + i as f64 * GOLDEN).fract();
        let q = precision.round(machine.domain.from + part * machine.domain.length());
        let q = q.clamp(machine.domain.from, machine.domain.to);
        let mut one = |kind| sample_values(machine, kind, q, sampler);
        let exact = [
            one(PartKind::Motion)?,
            one(PartKind::Reactions)?,
            one(PartKind::Positions)?,
        ];
        let values = row(machine, exact.each_ref().map(|values| &values[..]), -2.0);
        let found = match precision {
            Precision::Double => values_of(machine, &double, q),
            Precision::Float => values_of(machine, &float, q as f32),
        };
        for (error, (found, value)) in errors.iter_mut().zip(found.iter().zip(&values)) {
            let difference = (found - value).abs();
            *error = error.max(if difference.is_nan() {
                f64::INFINITY
            } else {
                difference
            });
        }
        if i < SELF_TEST_ROWS {
            rows.push(SelfTestRow { q, values });
        }
    }
    let relative = errors.iter().zip(scales);
    let relative: Vec<f64> = relative.map(|(error, scale)| error / scale).collect();
    let rounding = match precision {
        Precision::Double => 1e-14,
        Precision::Float => 1e-6,
    };
    let tolerances = errors.iter().zip(scales);
    let (step_error, motion) = measure_steps(export);
    Ok(Measured {
        errors: by_kind(machine, &relative),
        operations: operations(export),
        step_error,
        rows,
        // At other positions, and by another compiler, an error may be somewhat larger.
        tolerances: tolerances
            .map(|(error, scale)| 2.0 * error + rounding * scale)
            .collect(),
        motion,
    })
}

/// A row of the self-test from the [values](sample_values) of all parts, or from their scales: the w of a conservative load is `by` times half the
/// slope of its potential.
pub(crate) fn row(
    machine: &MachineDescription,
    [motion, reactions, positions]: [&[f64]; 3],
    by: f64,
) -> Vec<f64> {
    let columns = 2 * machine.curves(PartKind::Motion).len();
    let w = machine.loads.iter().enumerate().map(|(k, load)| {
        let place = machine.place(k);
        if load.effect.is_conservative() {
            by * motion[2 * place + 1]
        } else {
            motion[columns + place]
        }
    });
    let rest = reactions.iter().chain(positions).copied();
    motion[..2].iter().copied().chain(w).chain(rest).collect()
}

/// The exported values of a row.
pub(crate) fn values_of<R: Real>(
    machine: &MachineDescription,
    evaluator: &Evaluator<R>,
    q: R,
) -> Vec<f64> {
    let count = 2
        + machine.loads.len()
        + machine.reactions.len() * (2 + machine.loads.len())
        + 2 * machine.points.len();
    let all = || {
        let MotionTerms { m, half_dm, w, .. } = evaluator.motion_terms(q)?;
        let ReactionTerms { a, b, c } = evaluator.reaction_terms(q)?;
        let positions = evaluator.positions(q)?;
        let rest = [w, a, b, c, positions].into_iter().flatten();
        let values = [m, half_dm].into_iter().chain(rest);
        Ok(values.map(Real::to_f64).collect())
    };
    all().unwrap_or_else(|_: crate::evaluator::Status| vec![f64::NAN; count])
}

/// The largest relative errors by kind.
fn by_kind(machine: &MachineDescription, relative: &[f64]) -> Errors {
    let (loads, reactions) = (machine.loads.len(), machine.reactions.len());
    let max = |from: usize, count: usize| {
        let some = relative.iter().skip(from).take(count);
        some.copied().fold(0.0, f64::max)
    };
    let first = 2 + loads;
    Errors {
        m: max(0, 1),
        half_dm: max(1, 1),
        loads: max(2, loads),
        reactions: max(first, 2 * reactions),
        load_reactions: max(first + 2 * reactions, loads * reactions),
        positions: max(first + (2 + loads) * reactions, usize::MAX),
    }
}

/// Counts of operations: the same at every coordinate, except for the subtraction of periods.
fn operations(export: &Export) -> [u64; 3] {
    let counting = export.evaluator::<Counted>();
    // Below a periodic domain the period is added.
    let domain = export.machine.domain;
    let below = match domain.revolutions {
        0 => domain.from,
        _ => -0.25 * domain.length(),
    };
    let q = Counted::of(below);
    let motion = Counted::operations(|| _ = counting.motion_terms(q));
    let reactions = Counted::operations(|| _ = counting.reaction_terms(q));
    let mut state = counting.state([below, 0.0]);
    let step = Counted::operations(|| _ = counting.step(Counted::of(0.0), &mut state));
    [motion, motion + reactions, step]
}

/// The error of the step from the initial state, and the motion of the self-test.
fn measure_steps(export: &Export) -> (Option<[f64; 2]>, SelfTestMotion) {
    let machine = &export.machine;
    let [q, q_dot] = machine.initial;
    // Some scenes have no initial state, or rest: a motion of one unit a second shows the step's error.
    let moves = machine.loads.iter().any(|l| match l.effect {
        LoadEffect::Conservative { .. } | LoadEffect::Constant { .. } => true,
        LoadEffect::Damper { .. } | LoadEffect::VariableDamper { .. } => false,
        LoadEffect::Input { .. } | LoadEffect::Motor(_) => l.effect.scene_value() != 0.0,
    });
    let from = [q, if q_dot == 0.0 && !moves { 1.0 } else { q_dot }];
    // In double precision: the rounding of floats is stated with the functions.
    let exact = export.evaluator::<f64>();
    let run = |steps: usize, refinement: usize| {
        let mut state = exact.state(from);
        for _ in 0..steps * refinement {
            exact
                .step(STATED_STEP / refinement as f64, &mut state)
                .ok()?;
        }
        let length = machine.domain.length();
        let whole = f64::from(state.periods) * length;
        Some([state.y[0] + whole, state.y[1]])
    };
    let step_error = run(STATED_STEPS, 1).zip(run(STATED_STEPS, REFINEMENT));
    let step_error = step_error.map(|(one, many)| [0, 1].map(|k| (one[k] - many[k]).abs()));
    let steps = 100;
    let rounding = match export.request.precision {
        Precision::Double => 1e-12,
        Precision::Float => 2e-5,
    };
    let end = run(steps, 1).zip(run(steps, REFINEMENT));
    let end = end.map(|(one, many)| {
        let tolerance =
            |k: usize| 2.0 * (one[k] - many[k]).abs() + rounding * many[k].abs().max(1.0);
        [many, [0, 1].map(tolerance)]
    });
    let motion = SelfTestMotion {
        step: STATED_STEP,
        steps,
        from,
        end,
    };
    (step_error, motion)
}

//! Where a motion can go no further: the end of a range, or a singular position, behind which nothing can be evaluated.
//!
//! Methods of diffsol shorten a step that fails to three tenths, take it, and lengthen the next. In front of such an end their steps
//! become shorter than the rounding of time or of the state, go nowhere and never end: 2 000 000 steps of ESDIRK34 for a screw jack that
//! comes to the end of its range, where now it takes 67.

use crate::integration_parts::Part;
use crate::ode::OdeState;
use crate::pace::Pace;

/// A change of the state below this part of its tolerance is none, and so is a step below this part of the time that has passed: next to a
/// large coordinate that moves slowly, much time passes in steps below the rounding of the coordinate.
const IMMATERIAL: f64 = 1e-3;
/// So many steps in a row that changed nothing where longer ones failed are the end. Each is at most three tenths of one that failed: together
/// they would lead 1e10 times as near to a place that is not the end.
const MAX_FAILED: usize = 20;
/// After so many steps that failed, not in a row, their pace is looked at.
const FAILED_AT_A_PACE: usize = 20;

/// Counts the steps that fail, or change nothing because longer ones do.
pub(super) struct Impasse {
    start: f64,
    relative: f64,
    /// By state.
    pub(super) absolute: Vec<f64>,
    failed: usize,
    pub(super) pace: Pace,
    /// Of the steps that failed since they were looked at last: how many, and how many steps and which time, s, there were then.
    slow: (usize, usize, f64),
    is_slow: bool,
    /// The length of a step that could not be evaluated and was not shortened, s; none where it is below the rounding of time.
    pub(super) failed_step: Option<f64>,
}

impl Impasse {
    /// Of an integration, to an absolute tolerance by state.
    pub(super) fn new(of: &Part, absolute: Vec<f64>) -> Self {
        Self {
            start: of.start.t,
            relative: of.options.rtol,
            absolute,
            failed: 0,
            pace: Pace::new(of),
            slow: (0, 0, of.start.t),
            is_slow: false,
            failed_step: None,
        }
    }

    /// After a step.
    pub(super) fn step_taken(&mut self, ends: [&OdeState; 2]) {
        if self.failed > 0 && self.is_material(ends) {
            self.failed = 0;
        }
    }

    /// After a step before which longer ones have failed.
    pub(super) fn step_shortened(&mut self, ends: [&OdeState; 2]) {
        self.failed += 1;
        self.step_taken(ends);
        self.slow.0 += 1;
        if self.slow.0 == FAILED_AT_A_PACE {
            let (t, steps) = (ends[1].t, self.pace.steps());
            let (_, before, from) = std::mem::replace(&mut self.slow, (0, steps, t));
            self.is_slow = self.pace.is_too_slow(steps + 1 - before, t, t - from);
        }
    }

    /// After a step of a length, s, that could not be taken, because an evaluation failed or for another reason.
    pub(super) fn step_failed(&mut self, is_evaluation: bool, length: f64) {
        self.failed += 1;
        self.failed_step = Some(length).filter(|length| is_evaluation && *length > 0.0);
    }

    /// Whether nothing leads on.
    pub(super) fn is_reached(&self) -> bool {
        self.failed >= MAX_FAILED || self.is_slow
    }

    fn is_material(&self, [from, to]: [&OdeState; 2]) -> bool {
        let states = from.y.iter().zip(&to.y).zip(&self.absolute);
        let mut changes = states.map(|((from, to), absolute)| {
            (to - from).abs() / (absolute + self.relative * to.abs())
        });
        let passed = to.t - self.start;
        to.t - from.t > IMMATERIAL * passed || changes.any(|c| c > IMMATERIAL)
    }
}

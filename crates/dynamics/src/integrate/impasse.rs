//! Where a motion can go no further: the end of a range, or a singular position, behind which nothing can be evaluated.
//!
//! Methods of diffsol shorten a step that fails to three tenths, take it, and lengthen the next. In front of such an end their steps
//! become shorter than the rounding of time or of the state, go nowhere and never end: 2 000 000 steps of ESDIRK34 for a screw jack that
//! comes to the end of its range, where now it takes 67.

use crate::ode::OdeState;

/// A change of the state below this part of its tolerance is none, and so is a step below this part of the time that has passed: next to a
/// large coordinate that moves slowly, much time passes in steps below the rounding of the coordinate.
const IMMATERIAL: f64 = 1e-3;
/// So many steps in a row that changed nothing where longer ones failed are the end. Each is at most three tenths of one that failed: together
/// they would lead 1e10 times as near to a place that is not the end.
const MAX_FAILED: usize = 20;

/// Counts the steps that fail, or change nothing because longer ones do.
pub(super) struct Impasse {
    start: f64,
    relative: f64,
    /// By state.
    pub(super) absolute: Vec<f64>,
    failed: usize,
    /// The length of a step that could not be evaluated and was not shortened, s; none where it is below the rounding of time.
    pub(super) failed_step: Option<f64>,
}

impl Impasse {
    /// Of an integration from a time, s, to a relative tolerance and an absolute one by state.
    pub(super) fn new(start: f64, relative: f64, absolute: Vec<f64>) -> Self {
        Self {
            start,
            relative,
            absolute,
            failed: 0,
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
    }

    /// After a step of a length, s, that could not be taken, because an evaluation failed or for another reason.
    pub(super) fn step_failed(&mut self, is_evaluation: bool, length: f64) {
        self.failed += 1;
        self.failed_step = Some(length).filter(|length| is_evaluation && *length > 0.0);
    }

    /// Whether nothing leads on.
    pub(super) fn is_reached(&self) -> bool {
        self.failed >= MAX_FAILED
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

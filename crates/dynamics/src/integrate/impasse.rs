//! Detects positions at which a motion cannot continue: the end of a range, or a singular position beyond which nothing can be
//! evaluated.
//!
//! Methods of diffsol shorten a step that fails to three tenths, take it, and lengthen the next. Before such an end their steps become
//! shorter than the rounding of time or of the state, make no progress and never end: ESDIRK34 took 2 000 000 steps for a screw jack at
//! the end of its range, and takes 67 with this detection.

use crate::integration_parts::Part;
use crate::ode::OdeState;
use crate::pace::Pace;

/// A change of the state below this part of its tolerance is none, and so is a step below this part of the time that has passed: next to a
/// large coordinate that moves slowly, much time passes in steps below the rounding of the coordinate.
const IMMATERIAL: f64 = 1e-3;
/// Number of successive steps without a change, after longer ones failed, that mark the end. Each is at most three tenths of a failed step:
/// together they would come 1e10 times nearer to a position that is not the end.
const MAX_FAILED: usize = 20;
/// Number of failed steps, not successive, after which their pace is checked.
const FAILED_AT_A_PACE: usize = 20;
/// Steps that fail belong together where no more lie between them.
const RECENT: usize = 1000;
/// A balance that changes by this fraction of the kinetic energy while steps fail is broken: next to singular positions, changes by 0.3
/// to 10 times the kinetic energy were observed, otherwise changes of the size of the tolerance.
const BROKEN: f64 = 0.01;

/// Counts the steps that fail, and those that are so short after failures that they change nothing.
pub(super) struct Impasse {
    start: f64,
    relative: f64,
    /// By state.
    pub(super) absolute: Vec<f64>,
    failed: usize,
    pub(super) pace: Pace,
    /// The number of failed steps since the last check, and the number of steps and the time, s, at that check.
    slow: (usize, usize, f64),
    is_slow: bool,
    /// The kinetic energy and the balance, J, before the first of the steps that fail, and after how many steps one has failed last.
    before: Option<([f64; 2], usize)>,
    /// The length of a step that could not be evaluated and was not shortened, s; `None` if it is below the rounding of time.
    pub(super) failed_step: Option<f64>,
}

impl Impasse {
    /// The detection for an integration with an absolute tolerance for each state; `function` is the first load given
    /// as a function of a program.
    pub(super) fn new(of: &Part, absolute: Vec<f64>, function: Option<usize>) -> Self {
        Self {
            start: of.start.t,
            relative: of.options.rtol,
            absolute,
            failed: 0,
            pace: Pace::new(of, function),
            slow: (0, 0, of.start.t),
            is_slow: false,
            before: None,
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
            self.is_slow = self.pace.is_too_slow(t, 1.0, steps + 1 - before, t - from);
        }
    }

    /// After a step of a length, s, that could not be taken, because an evaluation failed or for another reason.
    pub(super) fn step_failed(&mut self, is_evaluation: bool, length: f64) {
        self.failed += 1;
        self.failed_step = Some(length).filter(|length| is_evaluation && *length > 0.0);
    }

    /// After a step before which longer ones have failed: whether the energies less the works have changed. Next to a singular position
    /// steps lead on that are none of the motion: rounding decides their speeds.
    pub(super) fn breaks_balance(
        &mut self,
        [from, to]: [&OdeState; 2],
        balance: &dyn Fn(&OdeState) -> Option<[f64; 2]>,
    ) -> bool {
        let steps = self.pace.steps();
        let before = match self.before {
            Some((before, last)) if steps - last < RECENT => Some(before),
            _ => balance(from),
        };
        self.before = before.map(|before| (before, steps));
        let both = before.zip(balance(to));
        both.is_some_and(|([kinetic, before], [_, now])| (now - before).abs() > BROKEN * kinetic)
    }

    /// Whether the motion cannot continue.
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

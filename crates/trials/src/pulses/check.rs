//! The findings on the pulses.

use super::run::{PulseResult, PulseRun, RunKind};
use crate::drawn::{Drawn, finding, largest, refused};
use dwell_findings::Finding;

/// Above this part of its effect a pulse was missed: half of it would be gone.
const MISSED: f64 = 0.5;
/// A method may err so many times as much as where it is restarted by hand at the switches.
pub(super) const MAX_ERROR_RATIO: f64 = 10.0;
/// Below this error an estimate is one of roundings, and an error is known where it is so many times that of the
/// reference.
const ROUNDING: f64 = 1e-13;
const KNOWN: f64 = 3.0;
/// The part of the runs that may be refused.
const MAX_REFUSED: f64 = 0.05;

/// The findings: all pulses seen, accuracies kept, estimates not below the errors, errors as with restarts by hand, few
/// refused.
pub fn check(results: &[PulseResult]) -> Vec<Finding> {
    let of = |key: &str, words: [&str; 3], largest| finding(results, key, words, largest, 1.0);
    let missed = |run: &PulseRun| Some(run.missed / MISSED);
    let restarted = |run: &PulseRun| Some(run.restart_ratio()? / MAX_ERROR_RATIO);
    vec![
        of(
            "pulses-missed",
            [
                "the speed after a pulse: from its impulse, or from restarts by hand",
                "half of what the pulse changes the speed by",
                "a pulse that is stepped over has an error of 2",
            ],
            largest(results, missed),
        ),
        of(
            "pulses-accuracy",
            [
                "the coordinate after a pulse to a required accuracy: from the impulse, or from restarts by hand",
                "the required accuracy",
                "what is promised is kept",
            ],
            largest(results, PulseRun::accuracy_ratio),
        ),
        of(
            "pulses-error-estimate",
            [
                "the error of the coordinate after a pulse to a required accuracy, where it is above 1e-13",
                "the estimated error",
                "an estimate below the error would hide a wrong number",
            ],
            largest(results, PulseRun::estimate_shortfall),
        ),
        of(
            "pulses-restarts",
            [
                "the error of a method against that of the same method restarted by hand at the switches",
                "ten times the error with restarts by hand and that of a tolerance in coordinate and speed",
                "switches must not cost accuracy; where restarts by hand err less than a tolerance, that is chance",
            ],
            largest(results, restarted),
        ),
        finding(
            results,
            "pulses-refused",
            [
                "motions that are refused or end early",
                "all runs",
                "a refusal is no answer",
            ],
            refused(results),
            MAX_REFUSED,
        ),
    ]
}

impl Drawn for PulseResult {
    type Run = PulseRun;
    const NAME: &'static str = "pulses";

    fn runs(&self) -> &[PulseRun] {
        &self.runs
    }

    fn location(&self, run: &PulseRun) -> String {
        let (subject, shape) = (self.subject.name(), self.shape.name());
        format!(
            "pulse {}: {shape} of {:.1e} of {} s on a {subject} at {:.2} per s, {}",
            self.number,
            self.relative_width,
            self.span,
            self.speed,
            run.kind.name()
        )
    }

    fn refusal(run: &PulseRun) -> Option<&str> {
        run.refused.as_deref()
    }
}

impl RunKind {
    /// Its name in tables.
    pub fn name(self) -> String {
        match self {
            Self::Fixed(method, tolerance) => format!("{} at {tolerance:.0e}", method.name()),
            Self::Accuracy(accuracy) => format!("accuracy {accuracy:.0e}"),
        }
    }

    /// The method or the required accuracy, whatever the tolerance.
    pub(super) fn group(self) -> String {
        match self {
            Self::Fixed(method, _) => method.name().to_owned(),
            Self::Accuracy(_) => self.name(),
        }
    }
}

impl PulseRun {
    /// The true error over the required accuracy, where one is required.
    pub fn accuracy_ratio(&self) -> Option<f64> {
        match self.kind {
            RunKind::Accuracy(accuracy) => Some((self.error - self.rounding) / accuracy),
            RunKind::Fixed(..) => None,
        }
    }

    /// The error over the estimated one, of a required accuracy, where it is above rounding and known.
    pub fn estimate_shortfall(&self) -> Option<f64> {
        let is_known = self.error > ROUNDING && self.error > KNOWN * self.rounding;
        let beyond = self.error - self.rounding;
        match self.kind {
            RunKind::Accuracy(_) => is_known.then(|| beyond / self.estimate),
            RunKind::Fixed(..) => None,
        }
    }

    /// The true error over that of restarts by hand, of a method.
    pub fn restart_ratio(&self) -> Option<f64> {
        match self.kind {
            RunKind::Fixed(_, tolerance) => {
                // Below a tolerance in coordinate and speed the error by hand is chance: of 1193 runs of seed 2 three had 17 to 72
                // times as much, from a speed that was wrong by 1.8 to 5 tolerances.
                let floor = self.rounding + tolerance * (1.0 + self.speed_effect);
                Some(self.error / (self.error_by_hand? + floor))
            }
            RunKind::Accuracy(_) => None,
        }
    }
}

//! Two coordinates coupled by a law, y − f(x). In space an angle is known without its whole revolutions; then those of x are taken at
//! which the row is nearest to closed, so that a wrong count of revolutions cannot be copied from what is checked.

use super::terms::Term;
use crate::pose::Pose;
use dwell_laws::Law;
use std::f64::consts::TAU;

/// Whole revolutions of x that are tried to each side.
const MAX_REVOLUTIONS: i32 = 16;
/// A row is closed below this, rad or m: the fewest revolutions with which it is are taken.
const CLOSED: f64 = 1e-7;
/// A row is opened by less than this, rad or m, where it is differentiated: then the fewest with which it is.
const OPENED: f64 = 0.05;

/// y and x, and the law.
#[derive(Debug, Clone)]
pub(crate) struct Coupling {
    pub(crate) both: [Term; 2],
    pub(crate) law: Law,
}

impl Coupling {
    /// y − f(x) − imposed at an x, to the nearest revolution of y.
    fn residual_at(&self, x: f64, poses: &[Pose], imposed: f64) -> f64 {
        let y = &self.both[0];
        let residual = y.value(poses) - self.law.eval(x)[0] - imposed;
        match y {
            Term::Angle(_) => residual - TAU * (residual / TAU).round(),
            _ => residual,
        }
    }

    /// x with its revolutions, where the row has an imposed value.
    fn variable(&self, poses: &[Pose], imposed: f64) -> f64 {
        let wrapped = self.both[1].value(poses);
        if !matches!(self.both[1], Term::Angle(_)) {
            return wrapped;
        }
        let counts = std::iter::once(0).chain((1..=MAX_REVOLUTIONS).flat_map(|k| [k, -k]));
        let all = counts.map(|k| wrapped + TAU * f64::from(k));
        let on_table = all.filter(|x| self.law.end_passed(*x).is_none());
        let open = |x: f64| self.residual_at(x, poses, imposed).abs();
        let is_open_by = |limit: f64| move |x: &f64| open(*x) < limit;
        let (closed, opened) = (is_open_by(CLOSED), is_open_by(OPENED));
        let found = on_table.clone().find(closed);
        let found = found.or_else(|| on_table.clone().find(opened));
        let nearest = |a: &f64, b: &f64| open(*a).total_cmp(&open(*b));
        found
            .or_else(|| on_table.min_by(nearest))
            .unwrap_or(wrapped)
    }

    /// How far it is from an imposed value.
    pub(crate) fn residual(&self, poses: &[Pose], imposed: f64) -> f64 {
        self.residual_at(self.variable(poses, imposed), poses, imposed)
    }

    /// f′ and f″.
    pub(crate) fn slopes(&self, poses: &[Pose]) -> [f64; 2] {
        let [_, slope, bend, _] = self.law.eval(self.variable(poses, 0.0));
        [slope, bend]
    }
}

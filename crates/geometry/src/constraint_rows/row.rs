//! One scalar equation: a sum of terms, a pair of gears, or a coupling by a law.

use super::gear::Gear;
use super::terms::{BodyCoordinates, Column, ConstraintTerm};
use dwell_laws::Law;
use std::f64::consts::TAU;

/// One row. An imposed value is subtracted from each.
#[derive(Debug, Clone)]
pub(super) enum ConstraintRow {
    /// Σ factor × term − constant.
    Sum(Vec<(f64, ConstraintTerm)>, f64),
    /// angle − constant, to the nearest whole revolution.
    PeriodicAngle(ConstraintTerm, f64),
    Gear(Gear),
    /// dependent − law(independent).
    Coupling([ConstraintTerm; 2], Law),
}

/// The angle less the nearest whole number of revolutions.
fn wrap_angle(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl ConstraintRow {
    /// term − constant.
    pub(super) fn single(term: ConstraintTerm, constant: f64) -> Self {
        Self::Sum(vec![(1.0, term)], constant)
    }

    pub(super) fn periodic_angle(columns: [Column; 2], constant: f64) -> Self {
        Self::PeriodicAngle(ConstraintTerm::RelativeAngle(columns), constant)
    }

    /// Calls `term` for every term of the row, with the row's derivative by it.
    pub(super) fn each_term(
        &self,
        at: &BodyCoordinates<'_>,
        mut term: impl FnMut(f64, &ConstraintTerm),
    ) {
        match self {
            Self::Sum(terms, _) => terms.iter().for_each(|(f, m)| term(*f, m)),
            Self::PeriodicAngle(angle, _) => term(1.0, angle),
            Self::Gear(gear) => gear.terms().iter().for_each(|(f, m)| term(*f, m)),
            Self::Coupling([dependent, independent], law) => {
                term(1.0, dependent);
                term(-law.eval(independent.value(at))[1], independent);
            }
        }
    }

    pub(super) fn residual(&self, at: &BodyCoordinates<'_>, x: &[f64], prescribed: f64) -> f64 {
        match self {
            Self::Sum(terms, constant) => {
                let sum: f64 = terms.iter().map(|(f, m)| f * m.value(at)).sum();
                sum - constant - prescribed
            }
            Self::PeriodicAngle(angle, constant) => {
                wrap_angle(angle.value(at) - constant - prescribed)
            }
            Self::Gear(gear) => gear.residual(at, x, prescribed),
            Self::Coupling([dependent, independent], law) => {
                dependent.value(at) - law.eval(independent.value(at))[0] - prescribed
            }
        }
    }

    pub(super) fn velocity_product(&self, at: &BodyCoordinates<'_>, x_dot: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each_term(at, |factor, term| {
            sum += factor * term.velocity_product(at, x_dot);
        });
        if let Self::Coupling([_, by], law) = self {
            let rate = by.rate(at, x_dot);
            sum -= law.eval(by.value(at))[2] * rate * rate;
        }
        sum
    }
}

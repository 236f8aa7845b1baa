//! One scalar equation: a sum of terms, a pair of gears, or a coupling by a law.

use super::gear::Gear;
use super::terms::{BodyCoordinates, Column, ConstraintTerm};
use dwell_laws::Law;
use std::f64::consts::TAU;

/// One row. An imposed value is subtracted from each.
#[derive(Debug, Clone)]
pub(super) enum ConstraintRow {
    /// Σ factor × term − constant, to the nearest whole revolution if `periodic`.
    Sum {
        terms: Vec<(f64, ConstraintTerm)>,
        constant: f64,
        periodic: bool,
    },
    Gear(Gear),
    /// of − law(by).
    Coupling {
        dependent: ConstraintTerm,
        independent: ConstraintTerm,
        law: Law,
    },
}

/// The angle less the nearest whole number of revolutions.
fn wrap_angle(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl ConstraintRow {
    /// term − constant.
    pub(super) fn single(term: ConstraintTerm, constant: f64) -> Self {
        Self::sum(vec![(1.0, term)], constant)
    }

    pub(super) fn sum(terms: Vec<(f64, ConstraintTerm)>, constant: f64) -> Self {
        Self::Sum {
            terms,
            constant,
            periodic: false,
        }
    }

    pub(super) fn periodic_angle(columns: [Column; 2], constant: f64) -> Self {
        Self::Sum {
            terms: vec![(1.0, ConstraintTerm::RelativeAngle(columns))],
            constant,
            periodic: true,
        }
    }

    /// Calls `term` for every term of the row, with the row's derivative by it.
    pub(super) fn each_term(
        &self,
        at: &BodyCoordinates<'_>,
        mut term: impl FnMut(f64, &ConstraintTerm),
    ) {
        match self {
            Self::Sum { terms, .. } => terms.iter().for_each(|(f, m)| term(*f, m)),
            Self::Gear(gear) => gear.terms().iter().for_each(|(f, m)| term(*f, m)),
            Self::Coupling {
                dependent,
                independent,
                law,
            } => {
                term(1.0, dependent);
                term(-law.eval(independent.value(at))[1], independent);
            }
        }
    }

    pub(super) fn residual(&self, at: &BodyCoordinates<'_>, x: &[f64], prescribed: f64) -> f64 {
        match self {
            Self::Sum {
                terms,
                constant,
                periodic,
            } => {
                let sum: f64 = terms.iter().map(|(f, m)| f * m.value(at)).sum();
                let residual = sum - constant - prescribed;
                if *periodic {
                    wrap_angle(residual)
                } else {
                    residual
                }
            }
            Self::Gear(gear) => gear.residual(at, x, prescribed),
            Self::Coupling {
                dependent: of,
                independent,
                law,
            } => of.value(at) - law.eval(independent.value(at))[0] - prescribed,
        }
    }

    pub(super) fn velocity_product(&self, at: &BodyCoordinates<'_>, x_dot: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each_term(at, |factor, term| {
            sum += factor * term.velocity_product(at, x_dot);
        });
        if let Self::Coupling {
            independent: by,
            law,
            ..
        } = self
        {
            let rate = by.rate(at, x_dot);
            sum -= law.eval(by.value(at))[2] * rate * rate;
        }
        sum
    }
}

//! The inertia of the bodies as the checks take it.

use dwell_kinetostatics::{Mass, VaryingInertia};
use dwell_numerics::PiecewiseQuintic;
use std::f64::consts::TAU;

/// The masses of all bodies, and those whose moment of inertia is a function of their angle.
#[derive(Debug, Clone, Copy)]
pub struct Inertias<'a> {
    /// One mass per body.
    pub masses: &'a [Mass],
    /// Varying moments of inertia, in addition to the constant ones.
    pub varying: &'a [VaryingInertia],
}

impl<'a> From<&'a [Mass]> for Inertias<'a> {
    fn from(masses: &'a [Mass]) -> Self {
        Self {
            masses,
            varying: &[],
        }
    }
}

impl<'a> From<&'a Vec<Mass>> for Inertias<'a> {
    fn from(masses: &'a Vec<Mass>) -> Self {
        masses.as_slice().into()
    }
}

impl Inertias<'_> {
    /// The varying part of a body, over its angle, rad.
    pub(crate) fn varying_of(&self, body: usize) -> Option<PiecewiseQuintic> {
        let found = self.varying.iter().find(|varying| varying.body.0 == body);
        found.map(|varying| varying.inertia.clone())
    }
}

/// I and ½I′ at an angle of any number of revolutions, kg m²: zero without a varying part, NaN if it is unknown.
pub(crate) fn at_angle(varying: Option<&PiecewiseQuintic>, angle: f64) -> [f64; 2] {
    let Some(varying) = varying else {
        return [0.0; 2];
    };
    let angle = angle - TAU * ((angle - varying.middle()) / TAU).round();
    let [inertia, slope, ..] = varying.eval(angle).unwrap_or([f64::NAN; 5]);
    [inertia, 0.5 * slope]
}

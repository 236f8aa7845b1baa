//! After how many revolutions a mechanism or machine repeats itself.

use crate::error::Result;
use std::f64::consts::TAU;

/// Revolutions after which a motion without repetition counts as not periodic.
const MAX_REVOLUTIONS: u32 = 8;
/// Numbers that differ by less, relatively, count as equal: solutions of large groups differ by some rounding.
pub(crate) const PERIODICITY_TOLERANCE: f64 = 1e-9;

/// The angle after which samples at some `phases` (parts of a revolution from `q`) are the same, rad; none if they
/// never are. `same` compares two samples, by the size of all of them.
pub(crate) fn repetition_angle<S>(
    q: f64,
    phases: &[f64],
    mut sample: impl FnMut(f64) -> Result<S>,
    same: impl Fn(&[S], &S, &S) -> bool,
) -> Result<Option<f64>> {
    let mut samples = Vec::with_capacity(phases.len());
    for part in phases {
        samples.push(sample(q + TAU * part)?);
    }
    for revolutions in 1..=MAX_REVOLUTIONS {
        let angle = TAU * f64::from(revolutions);
        let mut repeats = true;
        for (part, here) in phases.iter().zip(&samples) {
            // Outside its range it does not repeat itself.
            let Ok(there) = sample(q + TAU * part + angle) else {
                return Ok(None);
            };
            repeats &= same(&samples, here, &there);
        }
        if repeats {
            return Ok(Some(angle));
        }
    }
    Ok(None)
}

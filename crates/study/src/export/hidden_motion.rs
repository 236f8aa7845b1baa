//! Motions of a coupling within such a small part of the coordinate that no function of an export resolves them.

use super::OVER_COORDINATE;
use super::description::ExportedScene;
use crate::explain::{StudyError, explain_position, own_coordinate, scene_error};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// Intervals of the domain, as many as the fit searches for narrow peaks.
const INTERVALS: u32 = 8192;
/// Parts of a radian, or of the mechanism's size, that are rounding.
const ROUNDING: f64 = 1e-9;

/// Allowed relative error of the trapezoidal rule if the rates at both points are similar.
const STEEPEST: f64 = 0.02;

/// Rejects a coupling if the change of its coordinate between two points does not follow from its rates at both, nor from their
/// difference: the error of the trapezoidal rule is smaller if the points resolve the law.
pub(super) fn reject_hidden_motion(
    scene: &PlaneScene,
    exported: &ExportedScene<'_>,
) -> Result<(), StudyError> {
    let (mechanism, model) = (&exported.loaded.mechanism, &exported.model);
    let dependent = mechanism.couplings.iter().map(|of| of.dependent);
    let coupled = dependent.filter_map(|of| {
        let rounding = ROUNDING * if of.is_angle() { 1.0 } else { mechanism.size() };
        let period = if of.is_angle() { TAU } else { f64::INFINITY };
        Some((CoordinateFunction::find(mechanism, of)?, rounding, period))
    });
    let coupled: Vec<_> = coupled.collect();
    if coupled.is_empty() {
        return Ok(());
    }
    let domain = exported.description.domain;
    let step = domain.length() / f64::from(INTERVALS);
    let mut workspace = model.workspace::<f64>();
    let mut before: Vec<[f64; 2]> = Vec::new();
    for k in 0..=INTERVALS {
        let q = domain.from + step * f64::from(k);
        let state = model.kinematic_state(&[q], &[1.0], &mut workspace);
        let state = state.map_err(|error| explain_position(scene, model.plan(), &error))?;
        let now: Vec<[f64; 2]> = coupled.iter().map(|of| state.coordinate(of.0)).collect();
        for ((_, rounding, period), ([from, slow], [to, fast])) in
            coupled.iter().zip(before.iter().zip(&now))
        {
            let hidden = to - from - 0.5 * step * (slow + fast);
            let hidden = (hidden - period.min(f64::MAX) * (hidden / period).round()).abs();
            // Where the rates are alike the law may be steepest between them.
            let resolved = (fast - slow).abs() + STEEPEST * slow.abs().max(fast.abs());
            if hidden > step * resolved + rounding {
                let [from, to] =
                    [q - step, q].map(|q| own_coordinate(scene, q, model.plan().is_angle(0)));
                let message = format!(
                    "no export: a coupling moves its bodies within so small a part of the range, between {from} and {to}, that no cell shows it"
                );
                let help = "give an interval without it with --from and --until, or a smoother law";
                return Err(scene_error(scene, message, help, [OVER_COORDINATE]));
            }
        }
        before = now;
    }
    Ok(())
}

//! The periods of free motions by quadrature, with those of the reference.

use super::reference::Reference;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use dwell_dynamics::{CoordinateMode, Machine, Orbit, ReducedState};
use dwell_findings::{Check, Finding};
use dwell_study::PreparedSpaceScene;
use dwell_verify::FindingSpec;

const PERIOD: FindingSpec<'_> = FindingSpec {
    key: "reference-period",
    check: Check::Period,
    comparison: "the period by quadrature with the reference",
    scale: "the period",
    tolerance: 1e-12,
    tolerance_reason: "the quadrature converges to rounding",
};

/// The finding, if the reference has periods.
pub(super) fn period(
    prepared: &PreparedSpaceScene<'_>,
    reference: &Reference,
) -> Result<Option<Finding>, ValidationError> {
    let mut worst = Differences::default();
    let motions = reference.motions();
    for motion in &motions {
        let model = prepared.model_for(&[])?;
        let loads = match motion.is_loaded {
            true => prepared.scene.loads.clone(),
            false => Vec::new(),
        };
        let machine = Machine::new(model, &loads, vec![CoordinateMode::Free], &[]);
        let [q, q_dot] = motion.start;
        let start = ReducedState { t: 0.0, q, q_dot };
        let orbit = machine
            .ok()
            .and_then(|machine| Orbit::loaded(&machine, start).ok());
        let found = orbit.map_or(f64::NAN, |orbit| orbit.period);
        let place = || format!("from {q_dot} rad/s at q = {q:.4}");
        worst.compare([found, motion.period, motion.period], "s", place);
    }
    let domain = match motions.len() {
        1 => "1 free motion".to_owned(),
        n => format!("{n} free motions"),
    };
    Ok(worst.finding(&PERIOD, &domain))
}

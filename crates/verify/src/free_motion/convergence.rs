//! Whether BDF's drift follows its tolerance, and ½m″, on which its Jacobian rests.

use super::{FreeMotionCase, ToleranceRun};
use dwell_dynamics::{DynamicsError, Method, Orbit};
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::ReducedModel;

/// The drift's slope is fitted over tolerances from 1e-13 to this power of ten.
const FIT_TO_EXPONENT: i32 = -8;

/// Slope of a straight line through log drift over log tolerance, BDF at 1e-8 and finer.
pub(super) fn fitted_slope(runs: &[ToleranceRun]) -> f64 {
    let coarsest = 10_f64.powi(FIT_TO_EXPONENT) * 1.5;
    let is_fitted = |r: &&ToleranceRun| r.method == Method::Bdf && r.tolerance <= coarsest;
    let points = runs.iter().filter(is_fitted);
    let points = points.map(|r| [r.tolerance.log10(), r.drift.log10()]);
    let points: Vec<[f64; 2]> = points.collect();
    let n = points.len() as f64;
    let [x, y] = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / n);
    let (numerator, denominator) = points.iter().fold((0.0, 0.0), |(a, b), p| {
        (a + (p[0] - x) * (p[1] - y), b + (p[0] - x).powi(2))
    });
    numerator / denominator
}

pub(super) fn check_convergence(slope: f64) -> Finding {
    let short = (0.6 - slope).max(0.0);
    Finding {
        comparison: format!(
            "the slope of log drift over log tolerance, {slope:.2}, with at least 0.6"
        ),
        domain: "BDF at tolerances 1e-13 to 1e-8".into(),
        unit: "(missing slope)".into(),
        scale: "one".into(),
        worst_at: "the fit".into(),
        tolerance_reason:
            "an integrator that obeys its tolerance has a slope near 1; its changes of order make \
              it vary, and below 0.6 it would not follow its tolerance"
                .into(),
        integrated: true,
        pass: slope >= 0.6,
        ..Finding::new("drift-convergence-bdf", Check::Power, [short; 2], 0.0)
    }
}

/// Checks ½m″, which the Jacobian of the equation of motion contains, against differences of ½m′. With a wrong ½m″, BDF
/// would only converge more slowly, so that the check of the motion does not detect it.
pub(super) fn check_jacobian<R: ReducedModel>(
    model: &R,
    case: &FreeMotionCase,
    orbit: &Orbit,
) -> Result<Finding, DynamicsError> {
    const POSITIONS: usize = 48;
    let mut workspace = model.workspace();
    let ((mut worst, mut worst_at), mut largest) = ((0.0_f64, 0.0), 0.0_f64);
    for i in 0..POSITIONS {
        let t = case.initial_state.t + orbit.period * (i as f64 + 0.37) / POSITIONS as f64;
        let q = orbit.state_at(t).q;
        let at = model.inertia_derivatives(q, &mut workspace)?;
        let mut slope = |h: f64| -> Result<f64, DynamicsError> {
            let (_, ahead) = model.inertia(q + h, &mut workspace)?;
            let (_, back) = model.inertia(q - h, &mut workspace)?;
            Ok((ahead - back) / (2.0 * h))
        };
        // Three central differences, extrapolated twice (Richardson), from several steps: the best of
        // them, since a long one suits a smooth inertia and a short one a sharp one.
        let mut difference = f64::INFINITY;
        for h in [8e-3, 2e-3, 5e-4, 1e-4] {
            let [d1, d2, d3] = [slope(h)?, slope(h / 2.0)?, slope(h / 4.0)?];
            let (e1, e2) = ((4.0 * d2 - d1) / 3.0, (4.0 * d3 - d2) / 3.0);
            difference = difference.min(((16.0 * e2 - e1) / 15.0 - at.half_ddm).abs());
        }
        // A balanced rotor's inertia has no curvature at all: rounding is then relative to m.
        largest = largest.max(at.half_ddm.abs()).max(1e-2 * at.m);
        if difference > worst || difference.is_nan() {
            (worst, worst_at) = (difference, q);
        }
    }
    let relative = if worst == 0.0 { 0.0 } else { worst / largest };
    Ok(Finding {
        comparison: "½m″ by dual numbers with Richardson differences of ½m′".into(),
        domain: format!("{POSITIONS} positions of the revolution"),
        unit: "kg m²/rad²".into(),
        scale: "the largest ½m″, or a hundredth of m if that is more".into(),
        worst_at: format!("q = {worst_at:.4} rad"),
        tolerance_reason:
            "the rounding of ½m′ over a step of 1e-3 rad, 1e-12, and the sixth power of 4e-3 times \
              the eighth derivative of m, which is up to 1e6 times m where the inertia is sharp"
                .into(),
        ..Finding::new("half-ddm", Check::EnergySlope, [worst, relative], 1e-9)
    })
}

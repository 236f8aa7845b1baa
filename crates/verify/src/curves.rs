//! The error of a finite difference against its step: the V-shaped curve.
//!
//! Down from a long step the error falls as a power of h, the order of the difference; below some step it rises again
//! as 1/h, because the differenced energy is rounded. The best result of a plain central difference is at the tip of
//! the V; the reduced model gives the line far below it.

use crate::context::{CheckContext, CheckedPosition};
use crate::differences::central_difference;

/// Error against step for one quantity at one position.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCurve {
    /// The differenced quantity, such as `slide.normal, b`.
    pub quantity: String,
    /// The position, rad.
    pub q: f64,
    /// The value errors are taken from: the subject's.
    pub reference: f64,
    /// The scale of the errors: the largest quantity of the same kind.
    pub scale: f64,
    /// (step, relative error) of the plain central difference, from the longest step down.
    pub second_order: Vec<(f64, f64)>,
    /// The errors after one extrapolation, from h and h/2.
    pub fourth_order: Vec<(f64, f64)>,
    /// The errors after two extrapolations, from h, h/2 and h/4.
    pub sixth_order: Vec<(f64, f64)>,
}

/// Steps per decade, and decades below 0.1 rad.
const PER_DECADE: i32 = 4;
const DECADES: i32 = 12;

/// The curve for ½ m′ as the slope of E_c, with steps in q. `None` where the subject has no answer.
pub fn half_dm_curve(context: &CheckContext<'_>, position: &CheckedPosition) -> Option<ErrorCurve> {
    let half_dm = context.subject.coefficients(position.q).ok()?.half_dm;
    let scale = context.scales.half_dm;
    let energy = |h: f64| context.energy_at(position, h);
    let difference = |order, h| central_difference(order, h, energy);
    let name = "½m′".to_owned();
    Some(ErrorCurve::new(
        name, position.q, half_dm, scale, difference,
    ))
}

/// The curve for b of one reaction as ∂m₁₂/∂q₁ − ½ ∂m₁/∂q₂ with the constraint really released. The step is that of q₁
/// in rad; the released row opens by an amount with a similar effect on the mechanism. `None` if the subject has no
/// answer for this reaction.
pub fn reaction_curve(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    reaction: usize,
) -> Option<ErrorCurve> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let name = dense.row_names[..row].get(reaction)?;
    let coefficients = context.subject.coefficients(position.q).ok()?;
    let reference = *coefficients.b.get(reaction)?;
    let [_, scale] = context.coefficient_scales(reaction);
    let w = position.unit_velocities.get(reaction)?;
    let per_step = dense.scaled_norm(position.unit_velocity()) / dense.scaled_norm(w);
    let m12 = |h: f64| {
        let configuration = context.stepped(position, h)?;
        let [u1, u2] = [row, reaction].map(|k| dense.unit_velocity(&configuration, k));
        Some(dense.inertia(&configuration, &u1, &u2))
    };
    let m1 = |h: f64| context.opened_m(position, reaction, h);
    let difference = |order, h| {
        let m12 = central_difference(order, h, m12)?;
        Some(m12 - 0.5 * central_difference(order, h * per_step, m1)?)
    };
    let name = format!("{name}, b");
    Some(ErrorCurve::new(
        name, position.q, reference, scale, difference,
    ))
}

impl ErrorCurve {
    fn new(
        quantity: String,
        q: f64,
        reference: f64,
        scale: f64,
        difference: impl Fn(u32, f64) -> Option<f64>,
    ) -> Self {
        let steps = (0..=PER_DECADE * DECADES).map(|i| f64::from(i) / f64::from(PER_DECADE));
        let steps = steps.map(|decades| 10_f64.powf(-1.0 - decades));
        // At the steps the mechanism can take.
        let error = |order, h| Some((h, (difference(order, h)? - reference).abs() / scale));
        let curve = |order| steps.clone().filter_map(|h| error(order, h)).collect();
        Self {
            quantity,
            q,
            reference,
            scale,
            second_order: curve(2),
            fourth_order: curve(4),
            sixth_order: curve(6),
        }
    }
}

//! The error of a finite difference against its step: the V-shaped curve.
//!
//! Down from a long step the error falls as a power of h, the order of the difference; below some
//! step it rises again as 1/h, because the differenced energy is rounded. What a person would get
//! with a plain central difference is at the tip of the V, and what the reduced model gives
//! directly is the line far below it.

use crate::bench::{Bench, Site};
use crate::differences::at_step;

/// Error against step for one quantity at one position.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorCurve {
    /// What is differenced, such as `slide.normal, b`.
    pub quantity: String,
    /// The position, rad.
    pub q: f64,
    /// The value errors are taken from: the subject's.
    pub reference: f64,
    /// What the errors are relative to: the largest quantity of the same kind.
    pub scale: f64,
    /// (step, relative error) of the plain central difference, from the longest step down.
    pub second_order: Vec<(f64, f64)>,
    /// The same extrapolated once, from h and h/2.
    pub fourth_order: Vec<(f64, f64)>,
    /// The same extrapolated twice, from h, h/2 and h/4.
    pub sixth_order: Vec<(f64, f64)>,
}

/// Steps per decade, and decades below 0.1 rad.
const PER_DECADE: i32 = 4;
const DECADES: i32 = 12;

/// The curve for ½ m′ as the slope of E_c, with steps in q. `None` where the subject has no answer.
pub fn half_dm_curve(bench: &Bench<'_>, site: &Site) -> Option<ErrorCurve> {
    let reference = bench.subject.coefficients(site.q).ok()?.half_dm;
    let curve = |order| {
        errors(reference, bench.scales.half_dm, |h| {
            at_step(order, h, |h| energy(bench, site, h))
        })
    };
    Some(ErrorCurve {
        quantity: "½m′".to_owned(),
        q: site.q,
        reference,
        scale: bench.scales.half_dm,
        second_order: curve(2),
        fourth_order: curve(4),
        sixth_order: curve(6),
    })
}

/// The curve for b of one reaction as ∂m₁₂/∂q₁ − ½ ∂m₁/∂q₂ with the constraint really released.
/// The step is that of q₁ in rad; the released row opens by as much as turns or moves the
/// mechanism alike. `None` where the subject has no answer for that reaction.
pub fn reaction_curve(bench: &Bench<'_>, site: &Site, reaction: usize) -> Option<ErrorCurve> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let named = *bench.reactions.get(reaction)?;
    let reference = *bench.subject.coefficients(site.q).ok()?.b.get(reaction)?;
    let scale = bench.b_scale(reaction);
    let w = site.unit_speeds.get(reaction)?;
    let per_step = dense.reach(site.speed()) / dense.reach(w);
    let m12 = |h: f64| {
        let closed = dense
            .step(&site.closed, row, site.speed(), site.q + h)
            .ok()?;
        let [u1, u2] = [row, reaction].map(|k| dense.unit_speed(&closed, k));
        Some(dense.inertia(&closed, &u1, &u2))
    };
    let m1 = |h: f64| {
        let opened = dense.step(&site.closed, reaction, w, h).ok()?;
        let u1 = dense.unit_speed(&opened, row);
        Some(dense.inertia(&opened, &u1, &u1))
    };
    let curve = |order| {
        errors(reference, scale, |h| {
            Some(at_step(order, h, m12)? - 0.5 * at_step(order, h * per_step, m1)?)
        })
    };
    let name = bench.case.mechanism.reaction_name(named);
    Some(ErrorCurve {
        quantity: format!("{name}, b"),
        q: site.q,
        reference,
        scale,
        second_order: curve(2),
        fourth_order: curve(4),
        sixth_order: curve(6),
    })
}

fn energy(bench: &Bench<'_>, site: &Site, h: f64) -> Option<f64> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let closed = dense
        .step(&site.closed, row, site.speed(), site.q + h)
        .ok()?;
    Some(dense.kinetic_energy(&closed, &[(row, 1.0)]))
}

/// Relative errors at the steps the mechanism can take.
fn errors(reference: f64, scale: f64, difference: impl Fn(f64) -> Option<f64>) -> Vec<(f64, f64)> {
    (0..=PER_DECADE * DECADES)
        .filter_map(|i| {
            let h = 10_f64.powf(-1.0 - f64::from(i) / f64::from(PER_DECADE));
            Some((h, (difference(h)? - reference).abs() / scale))
        })
        .collect()
}

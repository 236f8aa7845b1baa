//! Truth 3: the coefficients of every reaction, by really releasing its constraint.
//!
//! The row of reaction k is given a value, Φₖ(x) = q₂, and becomes a second coordinate: the
//! "constraint actuator" (Jordi, Zayas & Cardona 2008, figure 1). The kinetic energy then is
//!
//! ```text
//! 2 E_c = m₁(q₁,q₂) q̇₁² + m₂(q₁,q₂) q̇₂² + 2 m₁₂(q₁,q₂) q̇₁ q̇₂  (1)  (ibid., eq. 2)
//! ```
//!
//! and Lagrange's equation of q₂, taken at q̈₂ = q̇₂ = q₂ = 0, is the reaction:
//!
//! ```text
//! a_k = m₁₂                                                  (2)  (ibid., eq. 3 and ii)
//! b_k = ∂m₁₂/∂q₁ − ½ ∂m₁/∂q₂                                 (3)  (ibid., eq. 3 and i)
//! ```
//!
//! The mechanism is closed again at q₁ ± h and, opened, at q₂ ± h; only dense positions and
//! velocities are used. In the last finding the same b is the power of the inertia forces with the
//! released speed (principle of virtual power), which has no step but uses dense accelerations:
//!
//! ```text
//! b_k = Σ m v_G(u₂)·a_G + I ω(u₂) α  at q̇₁ = 1, q̈₁ = 0        (4)
//! ```

use super::row_step;
use crate::bench::{Bench, Site};
use crate::differences::{Estimate, Order, derivatives};
use crate::judge::{Check, Reading};
use dwell_findings::Finding;

/// Three findings: a, b by differences, b by virtual power.
pub fn released(bench: &Bench<'_>) -> Vec<Finding> {
    let [a, b, power] = bench.each_site_into(|site, [a, b, power]| {
        let subject = bench.subject.coefficients(site.q)?;
        if subject.a.len() != bench.reactions.len() || subject.b.len() != bench.reactions.len() {
            for worst in [a, b, power] {
                worst.refuse("the subject does not answer for every reaction".into());
            }
            return Ok(());
        }
        for (k, b_k) in b_by_differences(bench, site).iter().enumerate() {
            // Of a reaction that is not determined there is no single value.
            let Some(b_k) = b_k else { continue };
            let place = || bench.place_of(site.q, k);
            let moment = bench.reactions[k].component.unit() != "N";
            let (a_unit, b_unit) = if moment {
                ("N m per rad/s2", "N m per (rad/s)2")
            } else {
                ("N per rad/s2", "N per (rad/s)2")
            };
            let reading = Reading {
                difference: subject.a[k] - site.exact.a[k],
                scale: bench.a_scale(k),
                own: site.noise.a[k],
                unit: a_unit,
                condition: site.condition,
            };
            a.meet(&reading, place);
            let reading = Reading {
                difference: subject.b[k] - b_k.value,
                scale: bench.b_scale(k),
                own: b_k.error,
                unit: b_unit,
                condition: site.condition,
            };
            b.meet(&reading, place);
            let reading = Reading {
                difference: subject.b[k] - site.exact.b[k],
                scale: bench.b_scale(k),
                own: site.noise.b[k],
                unit: b_unit,
                condition: site.condition,
            };
            power.meet(&reading, place);
        }
        Ok(())
    });
    let determined = bench.dense.unique[..bench.reactions.len()].iter();
    let determined = determined.filter(|&&unique| unique).count();
    let mut over = format!("{determined} reactions at {}", bench.over());
    if determined < bench.reactions.len() {
        let rest = bench.reactions.len() - determined;
        over += &format!("; {rest} that joints share are not determined");
    }
    let check = |key, truth, compared, scale, tolerance, why| Check {
        key,
        truth,
        compared,
        over: over.clone(),
        scale,
        tolerance,
        why,
    };
    vec![
        check(
            "a-released",
            "3 released constraint",
            "every a with m12, each constraint released as a second coordinate",
            "the largest a of the same unit",
            1e-13,
            "no step; the released speed is a dense solution",
        )
        .judge(a),
        check(
            "b-released",
            "3 released constraint",
            "every b with dm12/dq1 - half dm1/dq2, each constraint really opened and closed again",
            "the largest b of the same unit",
            1e-11,
            "rounding of m1 and m12 over the shortest step that the extrapolation uses",
        )
        .judge(b),
        check(
            "b-virtual-power",
            "3 released constraint, virtual power",
            "every b with the power of the inertia forces at the released speed",
            "the largest b of the same unit",
            1e-13,
            "no step; dense speeds and accelerations one after the other",
        )
        .judge(power),
    ]
}

/// Eq. (3) for every reaction that is determined.
fn b_by_differences(bench: &Bench<'_>, site: &Site) -> Vec<Option<Estimate>> {
    let (dense, row) = (&bench.dense, bench.dense.actuator_row());
    let u = site.speed();
    // All m₁₂ along q₁ at once: the released speeds are columns of one inverse.
    let along_q1 = derivatives(
        Order::First,
        row_step(bench, u),
        site.energy_rounding(),
        |h| {
            let closed = dense.step(&site.closed, row, u, site.q + h).ok()?;
            let speeds = dense.unit_speeds(&closed);
            let u1 = speeds.last()?;
            let m12 = |u2: &Vec<f64>| dense.inertia(&closed, u1, u2);
            Some(speeds[..row].iter().map(m12).collect())
        },
    );
    let along_q2 = |k: usize| {
        let w = &site.unit_speeds[k];
        let m1 = derivatives(
            Order::First,
            row_step(bench, w),
            site.energy_rounding(),
            |h| {
                let opened = dense.step(&site.closed, k, w, h).ok()?;
                let u1 = dense.unit_speed(&opened, row);
                Some(vec![dense.inertia(&opened, &u1, &u1)])
            },
        );
        m1.first().copied()
    };
    (0..row)
        .map(|k| {
            let estimate = || match (along_q1.get(k), along_q2(k)) {
                (Some(m12), Some(m1)) => Estimate {
                    value: m12.value - 0.5 * m1.value,
                    error: m12.error + 0.5 * m1.error,
                },
                _ => Estimate {
                    value: f64::NAN,
                    error: f64::NAN,
                },
            };
            dense.unique[k].then(estimate)
        })
        .collect()
}

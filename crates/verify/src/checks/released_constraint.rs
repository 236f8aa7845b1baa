//! Check 3: the coefficients of every reaction, by releasing its constraint.
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
use crate::comparison::FindingSpec;
use crate::context::{CheckContext, CheckedPosition};
use crate::differences::{DerivativeOrder, Extrapolated, NO_ESTIMATE, derivatives};
use dwell_findings::{Check, Finding};

/// Three findings: a, b by differences, b by virtual power. None where joints share all reactions.
pub fn released_constraint(context: &CheckContext<'_>) -> Vec<Finding> {
    if context.dense.determinate[..context.reactions.len()]
        .iter()
        .all(|&is_determinate| !is_determinate)
    {
        return Vec::new();
    }
    let [a, b, power] = context.for_each_position_into(|position, [a, b, power]| {
        let subject = context.subject.coefficients(position.q)?;
        if subject.a.len() != context.reactions.len() || subject.b.len() != context.reactions.len()
        {
            for worst in [a, b, power] {
                worst.record_failure("the subject does not answer for every reaction".into());
            }
            return Ok(());
        }
        for (k, b_k) in b_by_differences(context, position).iter().enumerate() {
            // Of a reaction that is not determined there is no single value.
            let Some(b_k) = b_k else { continue };
            let location = || context.reaction_location(position.q, k);
            let moment = context.reactions[k].component.unit() != "N";
            let (a_unit, b_unit) = if moment {
                ("N m per rad/s2", "N m per (rad/s)2")
            } else {
                ("N per rad/s2", "N per (rad/s)2")
            };
            let comparison = position.comparison(
                subject.a[k] - position.reference.a[k],
                context.a_scale(k),
                position.rounding_bound.a[k],
                a_unit,
            );
            a.record(&comparison, location);
            let comparison = position.comparison(
                subject.b[k] - b_k.value,
                context.b_scale(k),
                b_k.error,
                b_unit,
            );
            b.record(&comparison, location);
            let comparison = position.comparison(
                subject.b[k] - position.reference.b[k],
                context.b_scale(k),
                position.rounding_bound.b[k],
                b_unit,
            );
            power.record(&comparison, location);
        }
        Ok(())
    });
    let determinate = context.dense.determinate[..context.reactions.len()].iter();
    let determinate = determinate
        .filter(|&&is_determinate| is_determinate)
        .count();
    let mut domain = format!("{determinate} reactions at {}", context.domain());
    if determinate < context.reactions.len() {
        let indeterminate = context.reactions.len() - determinate;
        domain += &format!("; {indeterminate} that joints share are not determined");
    }
    let spec = |key, compared, scale, tolerance, why| FindingSpec {
        key,
        check: Check::ReleasedConstraint,
        comparison: compared,
        scale,
        tolerance,
        tolerance_reason: why,
    };
    vec![
        spec(
            "a-released",
            "every a with m12, each constraint released as a second coordinate",
            "the largest a of the same unit",
            1e-13,
            "no step; the released speed is a dense solution",
        )
        .finding(domain.clone(), a),
        spec(
            "b-released",
            "every b with dm12/dq1 - half dm1/dq2, each constraint really opened and closed again",
            "the largest b of the same unit",
            1e-11,
            "rounding of m1 and m12 over the shortest step that the extrapolation uses",
        )
        .finding(domain.clone(), b),
        spec(
            "b-virtual-power",
            "every b with the power of the inertia forces at the released speed",
            "the largest b of the same unit",
            1e-13,
            "no step; dense speeds and accelerations one after the other",
        )
        .finding(domain, power),
    ]
}

/// Eq. (3) for every reaction that is determined.
fn b_by_differences(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
) -> Vec<Option<Extrapolated>> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let u = position.unit_velocity();
    // All m₁₂ along q₁ at once: the released speeds are columns of one inverse.
    let along_q1 = derivatives(
        DerivativeOrder::First,
        row_step(context, u),
        position.energy_rounding(),
        |h| {
            let configuration = dense
                .step_row(&position.configuration, row, u, position.q + h)
                .ok()?;
            let velocities = dense.unit_velocities(&configuration);
            let u1 = velocities.last()?;
            let m12 = |u2: &Vec<f64>| dense.inertia(&configuration, u1, u2);
            Some(velocities[..row].iter().map(m12).collect())
        },
    );
    let along_q2 = |k: usize| {
        let w = &position.unit_velocities[k];
        let m1 = derivatives(
            DerivativeOrder::First,
            row_step(context, w),
            position.energy_rounding(),
            |h| {
                let opened = dense.step_row(&position.configuration, k, w, h).ok()?;
                let u1 = dense.unit_velocity(&opened, row);
                Some(vec![dense.inertia(&opened, &u1, &u1)])
            },
        );
        m1.first().copied()
    };
    (0..row)
        .map(|k| {
            let estimate = || match (along_q1.get(k), along_q2(k)) {
                (Some(m12), Some(m1)) => Extrapolated {
                    value: m12.value - 0.5 * m1.value,
                    error: m12.error + 0.5 * m1.error,
                },
                _ => NO_ESTIMATE,
            };
            dense.determinate[k].then(estimate)
        })
        .collect()
}

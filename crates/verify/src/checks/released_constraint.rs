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

use super::{coefficient_units, row_step};
use crate::comparison::FindingSpec;
use crate::context::{CheckContext, CheckedPosition};
use crate::differences::{DerivativeOrder, Extrapolated, NO_ESTIMATE, derivatives, slope};
use dwell_findings::{Check, Finding};

const A: FindingSpec<'_> = FindingSpec {
    key: "a-released",
    check: Check::ReleasedConstraint,
    comparison: "every a with m12, each constraint released as a second coordinate",
    scale: "the largest a of the same unit",
    tolerance: 1e-13,
    tolerance_reason: "no step; the released speed is a dense solution",
};
const B: FindingSpec<'_> = FindingSpec {
    key: "b-released",
    comparison: "every b with dm12/dq1 - half dm1/dq2, each constraint opened and closed again",
    scale: "the largest b of the same unit",
    tolerance: 1e-11,
    tolerance_reason: "rounding of m1 and m12 over the shortest step that the extrapolation uses",
    ..A
};
const POWER: FindingSpec<'_> = FindingSpec {
    key: "b-virtual-power",
    comparison: "every b with the power of the inertia forces at the released speed",
    tolerance: 1e-13,
    tolerance_reason: "no step; dense speeds and accelerations one after the other",
    ..B
};

/// Three findings: a, b by differences, b by virtual power. None where joints share all reactions.
pub(crate) fn released_constraint(context: &CheckContext<'_>) -> Vec<Finding> {
    let count = context.dense.actuator_row();
    let determinate = context.dense.determinate[..count].iter();
    let determinate = determinate.filter(|&&is| is).count();
    if determinate == 0 {
        return Vec::new();
    }
    let [a, b, power] = context.for_each_position(|position, [a, b, power]| {
        let subject = context.subject.coefficients(position.q)?;
        let given = [&subject.a, &subject.b];
        if given
            .iter()
            .any(|of| of.len() != context.dense.reactions.len())
        {
            for worst in [a, b, power] {
                worst.record_failure("the subject does not give every reaction".into());
            }
            return Ok(());
        }
        let [own_a, own_b] = given.map(|of| context.by_row(position, of));
        for (k, b_k) in b_by_differences(context, position).iter().enumerate() {
            // Of a reaction that is not determined there is no single value.
            if !context.dense.determinate[k] {
                continue;
            }
            let location = || context.reaction_location(position.q, k);
            let [a_unit, b_unit] = coefficient_units(context.dense.angular[k]);
            let (reference, bound) = (&position.reference, &position.rounding_bound);
            let [a_scale, b_scale] = context.coefficient_scales(k);
            let numbers = [own_a[k] - reference.a[k], a_scale, bound.a[k]];
            position.record(a, numbers, a_unit, location);
            if let Some(b_k) = b_k {
                let numbers = [own_b[k] - b_k.value, b_scale, b_k.error];
                position.record(b, numbers, b_unit, location);
            }
            let numbers = [own_b[k] - reference.b[k], b_scale, bound.b[k]];
            position.record(power, numbers, b_unit, location);
        }
        Ok(())
    });
    let mut domain = format!("{determinate} reactions at {}", context.domain());
    if determinate < count {
        let indeterminate = count - determinate;
        domain += &format!("; {indeterminate} that joints share are not determined");
    }
    // Teeth in space are rows of velocities: with another constraint open, there is no coordinate of theirs to differentiate by.
    let by_differences = (!context.dense.rows.has_teeth_in_space()).then_some((B, b));
    let findings = [Some((A, a)), by_differences, Some((POWER, power))];
    let finding = |(spec, worst): (FindingSpec<'_>, _)| spec.finding(domain.clone(), worst);
    findings.into_iter().flatten().map(finding).collect()
}

/// Eq. (3) for every reaction that is determined.
fn b_by_differences(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
) -> Vec<Option<Extrapolated>> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let rounding = position.energy_rounding();
    let step = row_step(context, position.unit_velocity());
    // All m₁₂ along q₁ at once: the released velocities are columns of one inverse.
    let along_q1 = derivatives(DerivativeOrder::First, step, rounding, |h| {
        let configuration = context.stepped(position, h)?;
        let velocities = dense.unit_velocities(&configuration);
        let u1 = velocities.last()?;
        let m12 = |u2: &Vec<f64>| dense.inertia(&configuration, u1, u2);
        Some(velocities[..row].iter().map(m12).collect())
    });
    let along_q2 = |k: usize| {
        let step = row_step(context, &position.unit_velocities[k]);
        slope(step, rounding, |h| context.opened_m(position, k, h))
    };
    let estimate = |k: usize| match (along_q1.get(k), along_q2(k)) {
        (Some(m12), Some(m1)) => Extrapolated {
            value: m12.value - 0.5 * m1.value,
            error: m12.error + 0.5 * m1.error,
        },
        _ => NO_ESTIMATE,
    };
    let differs = !dense.rows.has_teeth_in_space();
    let of = |k: usize| (differs && dense.determinate[k]).then(|| estimate(k));
    (0..row).map(of).collect()
}

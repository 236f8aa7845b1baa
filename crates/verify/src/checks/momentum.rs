//! Check 7: the forces and moments of the ground are the rate of the mechanism's momentum.
//!
//! ```text
//! Σ F of the ground on the mechanism = d/dt Σ m v_G                          (1)
//! Σ M of the ground on the mechanism about O = d/dt Σ (r_G × m v_G + I ω)    (2)
//! ```
//!
//! without loads, O fixed in the ground. Every internal reaction cancels, so this checks the ground
//! reactions and the actuator together, with the momentum differenced in time from dense velocities.
//!
//! Signs: a reaction is the action of a joint's first body on its second. Where the ground is the
//! first body, this is the action of the ground; where it is the second, the opposite. The force of a
//! prismatic joint acts at the second body's point along the first body's normal, with the joint's
//! moment as a couple.

use super::balance::{ForceBalance, force_and_moment};
use super::{motions_domain, state_at, time_step};
use crate::comparison::FindingSpec;
use crate::context::{CheckContext, CheckedPosition};
use crate::differences::{DerivativeOrder, NO_ESTIMATE, derivatives};
use crate::wrenches::{DenseWrench, NetWrench};
use dwell_findings::{Check, Finding};
use dwell_geometry::Vec2;
use dwell_laws::Polynomial;

const FORCE: FindingSpec<'_> = FindingSpec {
    key: "momentum-force",
    check: Check::Momentum,
    comparison: "the ground's forces with the rate of the momentum, differenced in time",
    scale: "the largest sum of absolute forces of the same motion",
    tolerance: 1e-12,
    tolerance_reason: "rounding of the momentum over the shortest time step that the extrapolation uses",
};
const MOMENT: FindingSpec<'_> = FindingSpec {
    key: "momentum-moment",
    comparison: "the ground's moments with the rate of the angular momentum, differenced in time",
    scale: "the largest sum of absolute moments of the same motion",
    ..FORCE
};

/// Two findings: force and moment.
pub fn momentum(context: &CheckContext<'_>) -> Vec<Finding> {
    let [force, moment] = force_and_moment(context, |position, motion, wrenches| {
        vec![momentum_balance(context, position, motion, wrenches)]
    });
    let domain = motions_domain(context);
    vec![
        FORCE.finding(domain.clone(), force),
        MOMENT.finding(domain, moment),
    ]
}

fn momentum_balance(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    motion: [f64; 2],
    wrenches: &[DenseWrench],
) -> ForceBalance {
    let law = Polynomial::motion(position.q, motion[0], motion[1]);
    let rates = derivatives(
        DerivativeOrder::First,
        time_step(context, position, motion),
        position.energy_rounding(),
        |t| {
            let (configuration, x_dot) = state_at(context, position, &law, t)?;
            Some(context.dense.momentum(&configuration, &x_dot).to_vec())
        },
    );
    let rate: [_; 3] = std::array::from_fn(|c| rates.get(c).copied().unwrap_or(NO_ESTIMATE));
    let force = rate[0].value.abs().max(rate[1].value.abs());
    let mut net = NetWrench {
        sum: [0.0; 3],
        terms: [force, force, rate[2].value.abs()],
    };
    let ground = context.case.mechanism.ground;
    for wrench in wrenches.iter().filter(|wrench| wrench.body == ground) {
        net.add(wrench, Vec2::ZERO);
    }
    // The ground's action on the mechanism is opposite to what acts on the ground.
    net.sum = std::array::from_fn(|c| -net.sum[c] - rate[c].value);
    ForceBalance {
        body: None,
        net,
        reference_error: rate.map(|rate| rate.error),
    }
}

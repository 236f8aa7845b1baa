//! Check 8: Newton's and Euler's equations of each body.
//!
//! ```text
//! Σ F on the body = m a_G                                    (1)
//! Σ M on the body about G = I α                              (2)
//! ```
//!
//! The accelerations are second differences, in time, of dense *positions* along
//! q(t) = q + q̇ t + ½ q̈ t². No velocity and no acceleration is computed on this side, so an error in
//! such code cannot occur on both sides. Every reaction of every joint is checked, in the state it is
//! used in.
//!
//! Positions are closed to about 2e-16 of the size; a second difference divides that error by h². With
//! the steps used here, a few hundredths of a radian and more, 1e-12 of the largest force remains.

use super::balance::{ForceBalance, force_and_moment};
use super::{motions_domain, time_step};
use crate::comparison::FindingSpec;
use crate::context::{CheckContext, CheckedPosition};
use crate::differences::{Extrapolated, NO_ESTIMATE};
use crate::wrenches::{DenseWrench, NetWrench};
use dwell_findings::{Check, Finding};
use dwell_laws::Polynomial;

const FORCE: FindingSpec<'_> = FindingSpec {
    key: "newton-force",
    check: Check::NewtonEuler,
    comparison: "the forces on each body with m a_G, positions differenced twice in time",
    scale: "the largest sum of absolute forces on a body in the same motion",
    tolerance: 2e-11,
    tolerance_reason: "rounding of the positions over the square of the shortest time step used",
};
const MOMENT: FindingSpec<'_> = FindingSpec {
    key: "euler-moment",
    comparison: "the moments on each body about its centre of mass with I alpha, positions differenced twice",
    scale: "the largest sum of absolute moments on a body in the same motion",
    ..FORCE
};

/// Two findings: Newton's equation and Euler's.
pub fn newton_euler(context: &CheckContext<'_>) -> Vec<Finding> {
    let [force, moment] = force_and_moment(context, |position, motion, wrenches| {
        body_balances(context, position, motion, wrenches)
    });
    let domain = format!("every body at {}", motions_domain(context));
    vec![
        FORCE.finding(domain.clone(), force),
        MOMENT.finding(domain, moment),
    ]
}

fn body_balances(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    motion: [f64; 2],
    wrenches: &[DenseWrench],
) -> Vec<ForceBalance> {
    let dense = &context.dense;
    let second = accelerations(context, position, motion);
    let moving = dense
        .bodies
        .iter()
        .enumerate()
        .filter(|(_, b)| b.column.is_some());
    let balances = moving.enumerate().map(|(i, (body, of))| {
        let mass = of.mass;
        let inertias = [mass.mass, mass.mass, mass.inertia];
        let second = |c: usize| second.get(3 * i + c).copied().unwrap_or(NO_ESTIMATE);
        let rate: [f64; 3] = std::array::from_fn(|c| inertias[c] * second(c).value);
        let mut net = NetWrench {
            sum: rate.map(|rate| -rate),
            terms: rate.map(f64::abs),
        };
        let center = dense.center(of, &position.configuration);
        for wrench in wrenches.iter().filter(|wrench| wrench.body == body) {
            net.add(wrench, center);
        }
        ForceBalance {
            body: Some(body),
            net,
            reference_error: std::array::from_fn(|c| inertias[c] * second(c).error),
        }
    });
    balances.collect()
}

/// Accelerations of every moving body's centre of mass and angle, from positions alone.
fn accelerations(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    motion: [f64; 2],
) -> Vec<Extrapolated> {
    let law = Polynomial::motion(position.q, motion[0], motion[1]);
    context.dense.second_differences(
        &position.configuration,
        time_step(context, position, motion),
        position.pose_rounding(),
        |t, q| q[0] = law.eval(t)[0],
    )
}

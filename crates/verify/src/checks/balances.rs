//! Checks 4, 7 and 8: the balances of power, of momentum, and of the forces on each body.
//!
//! A position is passed in several motions q(t) = q + q̇ t + ½ q̈ t², without loads. In each of them
//!
//! ```text
//! τ q̇ = dE_c/dt                                                              (1)  check 4
//! Σ F of the ground on the mechanism = d/dt Σ m v_G                          (2)  check 7
//! Σ M of the ground on the mechanism about O = d/dt Σ (r_G × m v_G + I ω)    (3)
//! Σ F on a body = m a_G                                                      (4)  check 8
//! Σ M on a body about G = I α                                                (5)
//! ```
//!
//! with O fixed in the ground. The rates in (1) to (3) are differences in time of the energy and the momentum of dense
//! velocities. In (2) and (3) every internal reaction cancels, so they check the reactions of the ground and the actuator
//! together. The accelerations in (4) and (5) are second differences of dense *positions*: no velocity and no
//! acceleration is computed on this side, so an error in such code cannot occur on both sides. Every reaction of every
//! joint is checked, in the state it is used in.
//!
//! Positions are closed to about 2e-16 of the size; a second difference divides that error by h². With
//! the steps used here, a few hundredths of a radian and more, 1e-12 of the largest force remains.
//!
//! Signs: a reaction is the force or moment of a joint's first body on its second. If the ground is the first body, this
//! is the action of the ground; if it is the second, the opposite. The force of a prismatic joint acts at the second
//! body's point along the first body's normal, with the joint's moment as a couple.

use super::row_step;
use crate::comparison::{ComparisonSet, FindingSpec, LargestDifference};
use crate::constraint_closing::Configuration;
use crate::context::{CheckContext, CheckedPosition, FORCE_MIN_SHARE};
use crate::dense::DenseBody;
use crate::differences::{DerivativeOrder, Extrapolated, NO_ESTIMATE, derivatives};
use crate::pose::{Columns, Pose, Twist};
use crate::subject::SubjectError;
use crate::wrenches::{BodyWrench, NetWrench};
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Vec3, Wrench, vec3};
use dwell_laws::Polynomial;
use rayon::prelude::*;

/// The (q̇, q̈) that a position is passed with, rad/s and rad/s²: both signs of each, of like
/// size, so that no term of a balance is small in all of them.
const MOTIONS: [[f64; 2]; 3] = [[1.0, 0.7], [-0.8, 0.5], [0.6, -1.2]];

const POWER: FindingSpec<'_> = FindingSpec {
    key: "power",
    check: Check::Power,
    comparison: "tau times q_dot with dE_c/dt, differenced in time along the motion",
    scale: "the largest power of the same motion",
    tolerance: 3e-12,
    tolerance_reason: "rounding of E_c over the shortest time step that the extrapolation uses",
};
const MOMENTUM_FORCE: FindingSpec<'_> = FindingSpec {
    key: "momentum-force",
    check: Check::Momentum,
    comparison: "the ground's forces with the rate of the momentum, differenced in time",
    scale: "the largest sum of absolute forces of the same motion",
    tolerance: 1e-12,
    tolerance_reason: "rounding of the momentum over the shortest time step that the extrapolation uses",
};
const MOMENTUM_MOMENT: FindingSpec<'_> = FindingSpec {
    key: "momentum-moment",
    comparison: "the ground's moments with the rate of the angular momentum, differenced in time",
    scale: "the largest sum of absolute moments of the same motion",
    ..MOMENTUM_FORCE
};
const NEWTON: FindingSpec<'_> = FindingSpec {
    key: "newton-force",
    check: Check::NewtonEuler,
    comparison: "the forces on each body with m a_G, positions differenced twice in time",
    scale: "the largest sum of absolute forces on a body in the same motion",
    tolerance: 2e-11,
    tolerance_reason: "rounding of the positions over the square of the shortest time step used",
};
const EULER: FindingSpec<'_> = FindingSpec {
    key: "euler-moment",
    comparison: "the moments on each body about its centre of mass with I alpha, positions differenced twice",
    scale: "the largest sum of absolute moments on a body in the same motion",
    ..NEWTON
};
/// The findings with the units of their differences: power, then force and moment of the mechanism and of the bodies.
const FINDINGS: [(FindingSpec<'_>, &str); 5] = [
    (POWER, "W"),
    (MOMENTUM_FORCE, "N"),
    (MOMENTUM_MOMENT, "N m"),
    (NEWTON, "N"),
    (EULER, "N m"),
];

/// One balance in one motion at one position: its index in [`FINDINGS`], the body, and the difference with the sum of
/// absolute terms and the error of the reference.
type Balance = (usize, Option<usize>, [f64; 3]);

/// The five findings. The scale of a balance is the largest of its kind in the same motion at any position.
pub(crate) fn balances(context: &CheckContext<'_>) -> Vec<Finding> {
    let of = |position| MOTIONS.map(|motion| balances_in_motion(context, position, motion));
    let all: Vec<[Result<Vec<Balance>, SubjectError>; 3]> =
        context.positions.par_iter().map(of).collect();
    let mut worst: [LargestDifference; 5] = Default::default();
    for (i, motion @ [q_dot, q_ddot]) in MOTIONS.into_iter().enumerate() {
        let mut sets: [ComparisonSet; 5] = Default::default();
        // Where nothing but q̈ does work the terms m q̇ q̈ are the largest there are.
        sets[0].scale = 1e-3 * context.scales.m * (q_dot * q_ddot).abs();
        for (position, motions) in context.positions.iter().zip(&all) {
            match &motions[i] {
                Ok(balances) => {
                    for &(finding, body, numbers) in balances {
                        let comparison = position.comparison(numbers, FINDINGS[finding].1);
                        sets[finding].add(comparison, location(context, position.q, motion, body));
                    }
                }
                Err(error) => worst.iter_mut().for_each(|w| w.record_error(error)),
            }
        }
        for force in [1, 3] {
            let by_moments = FORCE_MIN_SHARE * sets[force + 1].scale / context.dense.size();
            sets[force].scale = sets[force].scale.max(by_moments);
        }
        worst = LargestDifference::merge_each(worst, sets.map(ComparisonSet::largest));
    }
    let (domain, count) = (context.domain(), MOTIONS.len());
    let domain = format!("{domain}, each passed in {count} motions");
    let finding = |((spec, _), worst): (&(FindingSpec<'_>, _), _)| match spec.check {
        Check::NewtonEuler => spec.finding(format!("every body at {domain}"), worst),
        _ => spec.finding(domain.clone(), worst),
    };
    FINDINGS.iter().zip(worst).map(finding).collect()
}

/// `phi = 1.3 rad, 1 rad/s, 0.7 rad/s2, coupler`.
fn location(context: &CheckContext<'_>, q: f64, motion: [f64; 2], body: Option<usize>) -> String {
    let [q_dot, q_ddot] = motion;
    let (location, unit) = (context.location(q), context.unit());
    let of_body = body.map(|body| format!(", {}", context.dense.bodies[body].name));
    let of_body = of_body.unwrap_or_default();
    format!("{location}, {q_dot} {unit}/s, {q_ddot} {unit}/s2{of_body}")
}

/// All balances of one motion at one position.
fn balances_in_motion(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    [q_dot, q_ddot]: [f64; 2],
) -> Result<Vec<Balance>, SubjectError> {
    let dense = &context.dense;
    let claimed = (context.subject).inverse_dynamics(position.q, q_dot, q_ddot)?;
    let at = &position.configuration;
    let wrenches = dense.joint_wrenches(&at.poses, &claimed.reactions, &[claimed.tau]);
    let law = Polynomial::motion(position.q, q_dot, q_ddot);
    // The time it takes to go one step of q: |q̇| t + ½ |q̈| t² = h.
    let h = row_step(context, position.unit_velocity());
    let step = 2.0 * h / (q_dot.abs() + (q_dot * q_dot + 2.0 * q_ddot.abs() * h).sqrt());
    let (order, rounding) = (DerivativeOrder::First, position.energy_rounding());
    let rate = |of: &dyn Fn(&Configuration, &[f64]) -> Vec<f64>| {
        derivatives(order, step, rounding, |t| {
            let (configuration, x_dot) = state_at(context, position, &law, t)?;
            Some(of(&configuration, &x_dot))
        })
    };
    let component = |all: &[Extrapolated], c: usize| all.get(c).copied().unwrap_or(NO_ESTIMATE);
    let energy_rates = rate(&|at, x_dot| vec![0.5 * dense.inertia(at, x_dot, x_dot)]);
    let energy_rate = component(&energy_rates, 0);
    let difference = claimed.tau * q_dot - energy_rate.value;
    let power = [difference, energy_rate.value.abs(), energy_rate.error];
    let mut balances = vec![(0, None, power)];
    let pose_rounding = position.pose_rounding();
    let second = dense.second_differences(at, step, pose_rounding, |t, q| q[0] = law.eval(t)[0]);
    let x_dot: Vec<f64> = position.unit_velocity().iter().map(|u| u * q_dot).collect();
    let momentum_rates = rate(&|at, x_dot| dense.momentum(at, x_dot).to_vec());
    let mut momentum: [Extrapolated; 6] = std::array::from_fn(|c| component(&momentum_rates, c));
    for (b, body) in dense.moving_bodies() {
        let omega = body.columns.twist(&x_dot).angular.z;
        let alpha = second.of(b).angular.z;
        momentum[5].value += body.varying_moment(at.poses[b].angle, omega, alpha).z;
    }
    balances.extend(momentum_balance(context, &wrenches, momentum));
    for (b, body) in dense.moving_bodies() {
        let pose = &at.poses[b];
        let omega = body.columns.twist(&x_dot).angular;
        let balance = body_balance(body, pose, omega, second.of(b), second.errors(b));
        balances.extend(balance.with(&wrenches, b, body.center(pose)));
    }
    Ok(balances)
}

/// The mechanism at time `t` of a motion through a position, with its velocities.
fn state_at(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    law: &Polynomial,
    t: f64,
) -> Option<(Configuration, Vec<f64>)> {
    let (dense, row) = (&context.dense, context.dense.actuator_row());
    let [q, q_dot, ..] = law.eval(t);
    let (from, direction) = (&position.configuration, position.unit_velocity());
    let configuration = dense.step_row(from, row, direction, q).ok()?;
    let unit = dense.unit_velocity(&configuration, row);
    Some((configuration, unit.iter().map(|u| u * q_dot).collect()))
}

/// (2) and (3), with the errors of the rates.
fn momentum_balance(
    context: &CheckContext<'_>,
    wrenches: &[BodyWrench],
    rate: [Extrapolated; 6],
) -> impl Iterator<Item = Balance> {
    let [x, y, z, a, b, c] = rate.map(|rate| rate.value);
    let (force, moment) = (vec3(x, y, z), vec3(a, b, c));
    let ground = context.dense.ground;
    let on_ground = wrenches.iter().filter(|wrench| wrench.body.0 == ground);
    let mut net = NetWrench::of(on_ground, Vec3::ZERO);
    // The ground's action on the mechanism is opposite to what acts on the ground.
    net.sum.force = -net.sum.force - force;
    net.sum.moment = -net.sum.moment - moment;
    net.terms[0] += force.norm();
    net.terms[1] += moment.norm();
    let errors = rate.map(|rate| rate.error);
    let columns = context.dense.whole();
    components(1, None, columns, net, errors)
}

/// (4) and (5) of a body with the second derivatives of its centre of mass and rotation, and their errors.
fn body_balance(
    body: &DenseBody,
    pose: &Pose,
    omega: Vec3,
    second: Twist,
    errors: Twist,
) -> BodyBalance {
    let rate = Wrench {
        force: second.linear.scaled(body.mass.mass),
        moment: body.inertia_moment(pose, omega, second.angular),
    };
    let moment_error = body.angular_momentum(pose, errors.angular);
    let force_error = errors.linear.scaled(body.mass.mass);
    BodyBalance {
        columns: body.columns,
        rate,
        errors: [
            force_error.x,
            force_error.y,
            force_error.z,
            moment_error.x,
            moment_error.y,
            moment_error.z,
        ],
    }
}

/// The rate of the momenta of a body, with its errors.
struct BodyBalance {
    columns: Columns,
    rate: Wrench,
    errors: [f64; 6],
}

impl BodyBalance {
    /// Adds the wrench on the body, about its centre of mass.
    fn with(
        self,
        wrenches: &[BodyWrench],
        body: usize,
        center: Vec3,
    ) -> impl Iterator<Item = Balance> {
        let acting = wrenches.iter().filter(|wrench| wrench.body.0 == body);
        let mut net = NetWrench::of(acting, center);
        net.sum.force -= self.rate.force;
        net.sum.moment -= self.rate.moment;
        net.terms[0] += self.rate.force.norm();
        net.terms[1] += self.rate.moment.norm();
        components(3, Some(body), self.columns, net, self.errors)
    }
}

/// A balance of forces and moments: findings `first` and the next.
fn components(
    first: usize,
    body: Option<usize>,
    columns: Columns,
    net: NetWrench,
    [x, y, z, a, b, c]: [f64; 6],
) -> impl Iterator<Item = Balance> {
    let sums = columns.components(net.sum.force, net.sum.moment);
    let errors = columns.components(vec3(x, y, z), vec3(a, b, c));
    sums.zip(errors).map(move |((sum, is_moment), (error, _))| {
        let terms = net.terms[usize::from(is_moment)];
        (first + usize::from(is_moment), body, [sum, terms, error])
    })
}

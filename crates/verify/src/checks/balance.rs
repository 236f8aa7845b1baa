//! Balances of forces and moments, which checks 7 and 8 share: each motion has its own scale.

use super::{MOTIONS, motion_location};
use crate::comparison::LargestDifference;
use crate::context::{CheckContext, CheckedPosition, FORCE_MIN_SHARE};
use crate::subject::SubjectError;
use crate::wrenches::{DenseWrench, NetWrench};
use rayon::prelude::*;

/// A balance of x, y and moment in one motion at one position: of a body, or of the whole mechanism.
pub(super) struct ForceBalance {
    pub(super) body: Option<usize>,
    pub(super) net: NetWrench,
    pub(super) reference_error: [f64; 3],
}

/// The largest differences of force and of moment over all positions and motions. `balances` yields
/// the balances from the position, the motion [q̇, q̈] and the wrenches of joints and actuator there.
pub(super) fn force_and_moment(
    context: &CheckContext<'_>,
    balances: impl Fn(&CheckedPosition, [f64; 2], &[DenseWrench]) -> Vec<ForceBalance> + Sync,
) -> [LargestDifference; 2] {
    let all: Vec<[Result<Vec<ForceBalance>, SubjectError>; 3]> = context
        .positions
        .par_iter()
        .map(|position| {
            MOTIONS.map(|motion| {
                let subject = context
                    .subject
                    .inverse_dynamics(position.q, motion[0], motion[1])?;
                let wrenches = context.dense.joint_wrenches(
                    &position.configuration,
                    &subject.reactions,
                    &[subject.tau],
                );
                Ok(balances(position, motion, &wrenches))
            })
        })
        .collect();
    let mut worst = [LargestDifference::default(), LargestDifference::default()];
    for (i, motion) in MOTIONS.into_iter().enumerate() {
        let largest = |components: std::ops::Range<usize>| {
            let balances = all.iter().flat_map(|motions| &motions[i]).flatten();
            balances
                .flat_map(|b| b.net.terms[components.clone()].iter().copied())
                .fold(0.0, f64::max)
        };
        let moments = largest(2..3);
        let forces = largest(0..2).max(FORCE_MIN_SHARE * moments / context.dense.size());
        for (position, motions) in context.positions.iter().zip(&all) {
            match &motions[i] {
                Ok(balances) => {
                    for balance in balances {
                        record(
                            context,
                            position,
                            motion,
                            balance,
                            [forces, moments],
                            &mut worst,
                        );
                    }
                }
                Err(error) => worst.iter_mut().for_each(|worst| worst.record_error(error)),
            }
        }
    }
    worst
}

fn record(
    context: &CheckContext<'_>,
    position: &CheckedPosition,
    motion: [f64; 2],
    balance: &ForceBalance,
    scales: [f64; 2],
    worst: &mut [LargestDifference; 2],
) {
    for (c, difference) in balance.net.sum.into_iter().enumerate() {
        let kind = usize::from(c == 2);
        let comparison = position.comparison(
            difference,
            scales[kind],
            balance.reference_error[c],
            ["N", "N m"][kind],
        );
        worst[kind].record(&comparison, || {
            let location = motion_location(context, position.q, motion);
            match balance.body {
                Some(body) => format!("{location}, {}", context.case.mechanism.bodies[body].name),
                None => location,
            }
        });
    }
}

//! The pose nearest to some placements that meets all rows: Newton's method with the smallest steps.

use super::DensePose;
use super::rows::{Bodies, Sides, mesh_error};
use crate::error::{DenseError, Result};
use dwell_geometry::space::{ActuatorKind, Mechanism, Placement, Rotation, vec3};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Steps at most.
const MAX_STEPS: usize = 8;
/// Residuals this small are rounding, in parts of the size or rad; a pose whose residuals stay above the second is not closed.
const ROUNDING: f64 = 1e-14;
const OPEN: f64 = 1e-11;

/// How far the coordinate of an actuator is from its value; of an angle without whole revolutions.
pub(super) fn coordinate_error(
    mechanism: &Mechanism,
    kind: ActuatorKind,
    placements: &[Placement],
    wanted: f64,
) -> f64 {
    let sides = Sides::of(&mechanism.joints[kind.joint().0], placements);
    match kind {
        ActuatorKind::Length(_) => sides.d.norm() - wanted,
        ActuatorKind::Travel(_) => sides.d.dot(sides.u) - wanted,
        ActuatorKind::Angle(_) => {
            let difference = sides.angle() - wanted;
            difference - TAU * (difference / TAU).round()
        }
    }
}

/// The residuals of all rows, those of the joints first. Those of gears are what their teeth have travelled since other placements.
fn residuals(
    mechanism: &Mechanism,
    placements: &[Placement],
    (q, before): (&[f64], Option<&[Placement]>),
) -> Vec<f64> {
    let bodies = Bodies::at_rest(mechanism, placements);
    let (_, of_joint) = bodies.all_rows();
    let mut all = Vec::new();
    for (joint, rows) in mechanism.joints.iter().zip(of_joint) {
        // A driven distance holds nothing by itself.
        if rows.is_empty() {
            continue;
        }
        let mesh = before.and_then(|before| mesh_error(joint, [before, placements]));
        match mesh {
            Some(error) => all.push(error),
            None => all.extend(bodies.residuals(joint)),
        }
    }
    let actuators = mechanism.actuators.iter().zip(q);
    all.extend(actuators.map(|(a, q)| coordinate_error(mechanism, a.kind, placements, *q)));
    all
}

impl<'a> DensePose<'a> {
    /// The equations at the pose nearest to these placements whose coordinates have these values, and in which gears mesh as they did at
    /// others before.
    ///
    /// # Errors
    /// [`DenseError::NotClosed`] where there is none, [`DenseError`] where the equations have no singular values.
    pub(super) fn nearest(
        mechanism: &'a Mechanism,
        placements: &'a [Placement],
        (q, before): (&[f64], Option<&[Placement]>),
        size: f64,
    ) -> Result<Self> {
        let finite = |p: &Placement| {
            p.position.is_finite() && p.rotation.columns.iter().all(|c| c.is_finite())
        };
        if !placements.iter().all(finite) {
            return Err(DenseError::InvalidPoses);
        }
        let mut pose = Self::new(mechanism, placements)?;
        let scale = size.max(1.0);
        let mut largest = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            let open = residuals(mechanism, &pose.placements, (q, before));
            let before = largest;
            largest = open.iter().fold(0.0, |max, r| r.abs().max(max));
            if largest <= ROUNDING * scale || largest >= before {
                break;
            }
            let mut moved = pose.placements.into_owned();
            let steps = pose.system.step(&open);
            for (placement, step) in moved.iter_mut().zip(steps.chunks(6)) {
                placement.position += vec3(step[0], step[1], step[2]);
                let turn = Rotation::of_vector(vec3(step[3], step[4], step[5]));
                placement.rotation = turn.after(&placement.rotation);
            }
            pose = Self::at(mechanism, Cow::Owned(moved))?;
        }
        match largest <= OPEN * scale {
            true => Ok(pose),
            false => Err(DenseError::NotClosed {
                steps: MAX_STEPS,
                last_step: largest / size,
            }),
        }
    }
}

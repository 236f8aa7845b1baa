//! The description of a mechanism for the checks, in the plane or in space: bodies with coordinates, rows, and the action of each
//! reaction on the bodies.

pub(crate) mod action;
pub(crate) mod plane;
pub(crate) mod space;

use crate::pose::{Columns, Pose};
use crate::rows::row::Row;
use action::Action;
use dwell_geometry::space::{IdleBody, Vec3};
use dwell_kinetostatics::space::Mass;
use dwell_numerics::PiecewiseQuintic;
use std::ops::Range;

/// A mechanism in rows.
#[derive(Debug, Clone)]
pub(crate) struct Description {
    pub(crate) ground: usize,
    pub(crate) bodies: Vec<DescribedBody>,
    pub(crate) joints: Vec<DescribedJoint>,
    /// The rows of the joints, then one row for each actuator.
    pub(crate) rows: Vec<DescribedRow>,
    pub(crate) reactions: Vec<DescribedReaction>,
    /// By actuator: the action of a unit of its force.
    pub(crate) actuators: Vec<Action>,
    /// The points at which joints and actuators act on bodies.
    pub(crate) attachments: Vec<(usize, Vec3)>,
    /// Bodies with an idle rotation about a line.
    pub(crate) idle: Vec<IdleBody>,
    /// The size of the mechanism, m, by which angles are compared with lengths.
    pub(crate) size: f64,
    /// Whether rows depend on whole revolutions of a body.
    pub(crate) counts_revolutions: bool,
}

/// A body.
#[derive(Debug, Clone)]
pub(crate) struct DescribedBody {
    pub(crate) name: String,
    pub(crate) columns: Columns,
    pub(crate) mass: Mass,
    /// An additional moment of inertia about z as a function of the angle of a body in the plane.
    pub(crate) varying: Option<PiecewiseQuintic>,
}

/// Which rows and reactions are a joint's.
#[derive(Debug, Clone)]
pub(crate) struct DescribedJoint {
    pub(crate) name: String,
    pub(crate) rows: Range<usize>,
    pub(crate) reactions: Range<usize>,
    /// Whether its reactions are the components of force and moment about its point, not the multipliers of its rows.
    pub(crate) is_wrench: bool,
    /// Its second body.
    pub(crate) second: usize,
    /// Its point, of a body.
    pub(crate) point: (usize, Vec3),
}

impl DescribedJoint {
    /// Its second body, and the position of its point.
    pub(crate) fn at(&self, poses: &[Pose]) -> (usize, Vec3) {
        (self.second, poses[self.point.0].point(self.point.1))
    }
}

/// A row with its name.
#[derive(Debug, Clone)]
pub(crate) struct DescribedRow {
    pub(crate) row: Row,
    /// Whether it is an angle (rad), not a length (m).
    pub(crate) is_angle: bool,
    pub(crate) name: String,
}

/// A reaction with its name.
#[derive(Debug, Clone)]
pub(crate) struct DescribedReaction {
    pub(crate) name: String,
    pub(crate) is_moment: bool,
    /// The action of a unit of it.
    pub(crate) action: Action,
}

impl Description {
    /// Gives all points in frames whose origins are at these points of the bodies.
    pub(crate) fn shift(&mut self, origins: &[Vec3]) {
        let mut shift = |body: usize, point: &mut Vec3| *point -= origins[body];
        for row in &mut self.rows {
            row.row.each_ends(|ends| {
                for (body, point) in ends.bodies.into_iter().zip(&mut ends.points) {
                    shift(body, point);
                }
            });
        }
        for idle in &mut self.idle {
            shift(idle.body.0, &mut idle.point);
        }
        for joint in &mut self.joints {
            shift(joint.point.0, &mut joint.point.1);
        }
        let reactions = self.reactions.iter_mut().map(|r| &mut r.action);
        for action in reactions.chain(&mut self.actuators) {
            action.each_point(&mut shift);
        }
    }

    /// By body: the mean of its attachments.
    pub(crate) fn attachment_means(&self) -> Vec<Vec3> {
        let mut sums = vec![(Vec3::ZERO, 0_u32); self.bodies.len()];
        for (body, point) in &self.attachments {
            sums[*body].0 += *point;
            sums[*body].1 += 1;
        }
        let mean = |(sum, count): (Vec3, u32)| sum.scaled(1.0 / f64::from(count.max(1)));
        sums.into_iter().map(mean).collect()
    }
}

//! Forces on bodies at points, and couples.

use crate::dense::DenseMechanism;
use crate::description::plane::lifted;
use crate::pose::Pose;
use dwell_geometry::space::{Vec3, Wrench, vec3};
use dwell_geometry::{BodyId, Vec2};

/// A force on one body. What acts between two bodies has two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyWrench {
    /// The body.
    pub body: BodyId,
    /// The force, N, in the axes of the ground.
    pub force: Vec3,
    /// The point where it acts, m.
    pub point: Vec3,
    /// The couple, N·m.
    pub couple: Vec3,
}

impl BodyWrench {
    /// A force in the plane z = 0 and a couple about z.
    pub fn in_plane(body: BodyId, force: Vec2, point: Vec2, couple: f64) -> Self {
        Self {
            body,
            force: lifted(force),
            point: lifted(point),
            couple: vec3(0.0, 0.0, couple),
        }
    }

    /// Force and moment about a point.
    pub(crate) fn about(&self, point: Vec3) -> Wrench {
        Wrench {
            force: self.force,
            moment: (self.point - point).cross(self.force) + self.couple,
        }
    }

    /// A force at a point and a couple on the second body, and their opposites on the first.
    pub(crate) fn pair(
        [first, second]: [BodyId; 2],
        force: Vec3,
        point: Vec3,
        couple: Vec3,
    ) -> [Self; 2] {
        [(first, -force, -couple), (second, force, couple)].map(|(body, force, couple)| Self {
            body,
            force,
            point,
            couple,
        })
    }
}

/// A sum of forces and moments about a point.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NetWrench {
    pub(crate) sum: Wrench,
    /// Sums of absolute forces and of absolute moments: what rounding is relative to.
    pub(crate) terms: [f64; 2],
}

impl NetWrench {
    pub(crate) fn of<'a>(wrenches: impl Iterator<Item = &'a BodyWrench>, about: Vec3) -> Self {
        let mut net = Self::default();
        wrenches.for_each(|wrench| net.add(wrench, 1.0, about));
        net
    }

    /// Adds a multiple.
    pub(crate) fn add(&mut self, wrench: &BodyWrench, factor: f64, about: Vec3) {
        let Wrench { force, moment } = wrench.about(about);
        self.sum.force += force.scaled(factor);
        self.sum.moment += moment.scaled(factor);
        self.terms[0] += force.norm();
        self.terms[1] += (wrench.point - about).norm() * force.norm() + wrench.couple.norm();
    }
}

impl DenseMechanism {
    /// Forces on bodies with their points from the ground's moved origin.
    pub(crate) fn shifted_wrenches(&self, wrenches: &[BodyWrench]) -> Vec<BodyWrench> {
        let ground = self.bodies[self.ground].shift;
        let shifted = wrenches.iter().map(|wrench| BodyWrench {
            // A pure couple acts nowhere, and its point, wherever it was put, must not cost digits.
            point: match wrench.force == Vec3::ZERO {
                true => Vec3::ZERO,
                false => wrench.point - ground,
            },
            ..*wrench
        });
        shifted.collect()
    }

    /// Adds `sign` times forces on bodies, at points from the ground's moved origin, to the forces of the coordinates.
    pub(crate) fn add_wrenches<'w>(
        &self,
        poses: &[Pose],
        wrenches: impl IntoIterator<Item = &'w BodyWrench>,
        sign: f64,
        forces: &mut [f64],
    ) {
        for wrench in wrenches {
            let body = wrench.body.0;
            let at_origin = wrench.about(poses[body].position);
            self.bodies[body].columns.add(&at_origin, sign, forces);
        }
    }

    /// All forces of joints and actuators on bodies, the ground among them, at points from the ground's moved origin.
    pub(crate) fn joint_wrenches(
        &self,
        poses: &[Pose],
        reactions: &[f64],
        tau: &[f64],
    ) -> Vec<BodyWrench> {
        let actions = self.reactions.iter().map(|reaction| &reaction.action);
        let all = actions.zip(reactions).chain(self.actuators.iter().zip(tau));
        all.flat_map(|(action, value)| action.wrenches(poses, *value))
            .collect()
    }
}

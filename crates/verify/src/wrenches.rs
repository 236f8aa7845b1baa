//! Forces on bodies at points, and couples.

use crate::pose::lifted;
use dwell_geometry::space::{Vec3, Wrench, vec3};
use dwell_geometry::{BodyId, Vec2};

/// A force on one body. An action between two bodies is a pair of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyWrench {
    /// The body.
    pub body: BodyId,
    /// The force, N, in the axes of the ground.
    pub force: Vec3,
    /// The point of application, m.
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
    /// Sums of absolute forces and of absolute moments: the scale of rounding.
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

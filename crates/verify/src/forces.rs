//! Forces on bodies as forces of the coordinates, and those of joints and actuators on bodies.

use crate::dense::DenseMechanism;
use crate::description::DescribedJoint;
use crate::pose::Pose;
use crate::wrenches::BodyWrench;
use dwell_geometry::space::Vec3;

impl DenseMechanism {
    /// Forces on bodies with their points from the ground's moved origin.
    pub(crate) fn shifted_wrenches(&self, wrenches: &[BodyWrench]) -> Vec<BodyWrench> {
        let ground = self.bodies[self.ground].shift;
        let shifted = wrenches.iter().map(|wrench| BodyWrench {
            // A pure couple acts nowhere, and its point, wherever it was put, must not cost digits.
            point: if wrench.force == Vec3::ZERO {
                Vec3::ZERO
            } else {
                wrench.point - ground
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

    /// The power of so much of the reactions of a joint at speeds of all coordinates, W.
    pub(crate) fn power_of(
        &self,
        joint: &DescribedJoint,
        poses: &[Pose],
        reactions: &[f64],
        u: &[f64],
    ) -> f64 {
        let both = self.reactions[joint.reactions.clone()]
            .iter()
            .zip(reactions);
        let wrenches = both.flat_map(|(reaction, value)| reaction.action.wrenches(poses, *value));
        let power = |wrench: BodyWrench| {
            let body = wrench.body.0;
            let twist = self.bodies[body].columns.twist(u);
            twist.power(&wrench.about(poses[body].position))
        };
        wrenches.map(power).sum()
    }
}

//! The forces of loads in the tables; those of springs and dampers follow from their length or angle and its rate.

use dwell_geometry::BodyId;
use dwell_geometry::space::{CoordinateFunction, Plan, Pose, Vec3};
use dwell_kinetostatics::Strength;
use dwell_kinetostatics::space::{Load, LoadKind};
use dwell_scene::SpaceScene;

/// How the force or the moment of a load follows from its magnitude.
#[derive(Debug, Clone, Copy)]
pub(super) enum LoadForce {
    /// The force is the magnitude.
    Magnitude,
    /// By a law, from a coordinate and its rate.
    Along(CoordinateFunction, Strength),
    /// Against the velocity of a point of a body, in its frame.
    Drag(BodyId, Vec3),
}

impl LoadForce {
    /// The force of every load, then of every drive; `None` for weights.
    pub(super) fn of_all(scene: &SpaceScene, plan: &Plan) -> Vec<Option<Self>> {
        let loads = scene.loads.iter().map(|load| Self::of(scene, plan, load));
        let drives = scene.drives.iter().map(|_| Some(Self::Magnitude));
        loads.chain(drives).collect()
    }

    fn of(scene: &SpaceScene, plan: &Plan, load: &Load) -> Option<Self> {
        match load.kind {
            LoadKind::Gravity { .. } => None,
            LoadKind::Force { .. }
            | LoadKind::Special(_)
            | LoadKind::Along(_, Strength::Direct) => Some(Self::Magnitude),
            LoadKind::Along(along, law) => {
                let function = plan.coordinate_function(&scene.mechanism, along).ok()?;
                Some(Self::Along(function, law))
            }
            LoadKind::Drag { body, point } => Some(Self::Drag(body, point)),
        }
    }

    /// The force, N, or the moment, N·m, at a pose by a magnitude.
    pub(super) fn at(self, plan: &Plan, pose: &Pose, magnitude: f64) -> f64 {
        match self {
            Self::Magnitude => magnitude,
            Self::Along(along, law) => {
                let [value, rate, _] = plan.coordinate(pose, along);
                match law {
                    // Not −0 without stretch.
                    Strength::Elastic { free } => magnitude * (free - value),
                    law => law.force(magnitude, || value, || rate),
                }
            }
            Self::Drag(body, point) => {
                let placement = plan.placement(pose, body.0);
                let motion = plan.body_motion(pose, body.0);
                let velocity = motion.point_velocity(placement.rotation.apply(point));
                Strength::Quadratic.force(magnitude, || 0.0, || velocity.norm())
            }
        }
    }
}

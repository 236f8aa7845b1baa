//! The forces of loads in the tables: what a load exerts, of a spring and a damper by their length or angle and its rate.

use dwell_geometry::space::{Coordinate, CoordinateFunction, Plan, Pose};
use dwell_kinetostatics::Drive;
use dwell_kinetostatics::space::{Load, LoadKind};
use dwell_scene::SpaceScene;

/// How the force or the moment of a load follows from its magnitude.
#[derive(Debug, Clone, Copy)]
pub(super) enum LoadForce {
    /// It is the magnitude.
    Magnitude,
    /// Stiffness × (free length or angle − the present one).
    Spring(CoordinateFunction, f64),
    /// −damping × the rate of the length or the angle.
    Damper(CoordinateFunction),
}

impl LoadForce {
    /// Of every load, then of every drive; none of weights.
    pub(super) fn of_all(scene: &SpaceScene, plan: &Plan) -> Vec<Option<Self>> {
        let loads = scene.loads.iter().map(|load| Self::of(scene, plan, load));
        let drives = scene.drives.iter().map(|_| Some(Self::Magnitude));
        loads.chain(drives).collect()
    }

    fn of(scene: &SpaceScene, plan: &Plan, load: &Load) -> Option<Self> {
        let along = |coordinate| plan.coordinate_function(&scene.mechanism, coordinate).ok();
        match load.kind {
            LoadKind::Gravity(_) => None,
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::PointToPointForce { .. }
            | LoadKind::JointTorque(_)
            | LoadKind::SlideForce(_) => Some(Self::Magnitude),
            LoadKind::Spring {
                bodies,
                points,
                free_length,
            } => Some(Self::Spring(
                along(Coordinate::Distance { bodies, points })?,
                free_length,
            )),
            LoadKind::TorsionSpring { joint, free_angle } => {
                Some(Self::Spring(along(Coordinate::Angle(joint))?, free_angle))
            }
            LoadKind::Damper { bodies, points } => {
                let distance = along(Coordinate::Distance { bodies, points })?;
                Some(Self::Damper(distance))
            }
            LoadKind::RotationalDamper(joint) => {
                Some(Self::Damper(along(Coordinate::Angle(joint))?))
            }
            LoadKind::SlideDamper(joint) => Some(Self::Damper(along(Coordinate::Travel(joint))?)),
        }
    }

    /// The force, N, or the moment, N·m, at a pose by a magnitude.
    pub(super) fn at(self, plan: &Plan, pose: &Pose, magnitude: f64) -> f64 {
        match self {
            Self::Magnitude => magnitude,
            Self::Spring(of, free) => {
                let [value, ..] = plan.coordinate(pose, of);
                magnitude * (free - value)
            }
            Self::Damper(of) => {
                let [_, rate, _] = plan.coordinate(pose, of);
                -magnitude * rate
            }
        }
    }
}

/// Unit and meaning of the force of a load.
pub(super) fn described_load(load: &Load) -> (&'static str, &'static str) {
    match load.kind {
        LoadKind::Gravity(_) | LoadKind::Force { .. } => ("N", "force along its direction"),
        LoadKind::Torque { .. } => ("N m", "moment about its axis on the second body"),
        LoadKind::Spring { .. } | LoadKind::Damper { .. } | LoadKind::PointToPointForce { .. } => {
            ("N", BETWEEN_POINTS)
        }
        LoadKind::JointTorque(_)
        | LoadKind::TorsionSpring { .. }
        | LoadKind::RotationalDamper(_) => ("N m", ABOUT_AXIS),
        LoadKind::SlideForce(_) | LoadKind::SlideDamper(_) => ("N", ALONG_AXIS),
    }
}

const BETWEEN_POINTS: &str = "force between the points; positive pushes them apart";
const ABOUT_AXIS: &str = "moment about the axis, of the first body on the second";
const ALONG_AXIS: &str = "force along the axis, of the first body on the second";

/// The same of a drive.
pub(super) fn described_drive(drive: &Drive<Coordinate>) -> (&'static str, &'static str) {
    match drive.coordinate {
        Coordinate::Angle(_) => ("N m", ABOUT_AXIS),
        Coordinate::Travel(_) => ("N", ALONG_AXIS),
        Coordinate::Distance { .. } => ("N", BETWEEN_POINTS),
    }
}

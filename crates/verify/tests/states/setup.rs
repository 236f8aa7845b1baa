//! A mechanism ready to be checked, and the states and results of a plain solution for it.

use super::plain;
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{ActuatorKind, BodyId, Coordinate, Mechanism, Vec2};
use dwell_kinetostatics::{LoadKind, Mass};
use dwell_verify::{
    AssembledMechanism, CheckedMechanism, ClaimedState, Coefficients, Finding, InverseDynamics,
    Pose, Subject, SubjectError,
};

/// A mechanism with its assembly, its loads and its motion.
pub(crate) struct Setup {
    pub(crate) name: &'static str,
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) assembly_poses: Vec<[f64; 3]>,
    pub(crate) loads: Vec<(LoadKind, f64)>,
    /// [q, q̇, q̈] of every actuator, state by state.
    pub(crate) motions: Vec<[Vec<f64>; 3]>,
}

impl Setup {
    /// The findings of a check of its assembled mechanism.
    pub(crate) fn check(
        &self,
        check: impl Fn(&AssembledMechanism<'_>) -> Vec<Finding>,
    ) -> Vec<Finding> {
        check(&AssembledMechanism {
            mechanism: CheckedMechanism::Plane(&self.mechanism, (&self.masses).into()),
            q: &[],
            poses: &Pose::all_in_plane(&self.assembly_poses),
        })
    }

    pub(crate) fn states(&self) -> Vec<ClaimedState> {
        let motions = self.motions.iter().cloned();
        motions
            .map(|m| {
                plain::state(
                    &self.mechanism,
                    &self.masses,
                    &self.assembly_poses,
                    &self.loads,
                    m,
                )
            })
            .collect()
    }

    fn unloaded(&self, q: f64, q_dot: f64, q_ddot: f64) -> ClaimedState {
        self.unloaded_at([vec![q], vec![q_dot], vec![q_ddot]])
    }

    /// Without loads, with [q, q̇, q̈] of every actuator.
    pub(crate) fn unloaded_at(&self, motion: [Vec<f64>; 3]) -> ClaimedState {
        plain::state(
            &self.mechanism,
            &self.masses,
            &self.assembly_poses,
            &[],
            motion,
        )
    }

    /// The mechanism at another position.
    pub(crate) fn moved(mut self, by: Vec2) -> Self {
        let ground = BodyId(self.mechanism.ground);
        let shift = |bodies: [BodyId; 2], points: &mut [Vec2; 2]| {
            for (body, point) in bodies.into_iter().zip(points) {
                if body == ground {
                    *point += by;
                }
            }
        };
        for joint in &mut self.mechanism.joints {
            shift(joint.bodies, &mut joint.points);
        }
        for actuator in &mut self.mechanism.actuators {
            if let ActuatorKind::Length(points) = &mut actuator.kind {
                shift(actuator.bodies, points);
            }
        }
        for relation in &mut self.mechanism.couplings {
            for coordinate in [&mut relation.dependent, &mut relation.independent] {
                if let Coordinate::Length { bodies, points } = coordinate {
                    shift(*bodies, points);
                }
            }
        }
        for (load, _) in &mut self.loads {
            if let LoadKind::Along(CoordinateFunction::Length { bodies, points }, _) = load {
                shift(*bodies, points);
            }
        }
        for (body, pose) in self.assembly_poses.iter_mut().enumerate() {
            if body != ground.0 {
                pose[0] += by.x;
                pose[1] += by.y;
            }
        }
        self
    }
}

/// Without its loads, and with its first actuator's coordinate.
impl Subject for Setup {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        Ok(self.unloaded(q, 0.0, 0.0).poses)
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let (b, a) = (self.unloaded(q, 1.0, 0.0), self.unloaded(q, 0.0, 1.0));
        Ok(Coefficients {
            m: a.tau[0],
            half_dm: b.tau[0],
            a: a.reactions,
            b: b.reactions,
        })
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let state = self.unloaded(q, q_dot, q_ddot);
        Ok(InverseDynamics {
            tau: state.tau[0],
            reactions: state.reactions,
        })
    }
}

//! From a description to a plan that is assembled and followed, or to what is wrong with it.

use super::{Plan, Start};
use crate::error::{AssemblyError, StructureError};
use crate::mechanism::{ActuatorId, BodyId, Coordinate, Drive, JointId, JointKind, Mechanism};
use crate::mobility::{Mobility, mobility};
use crate::plan::Pose;
use crate::plane::{Vec2, vec2};
use crate::rough::Rough;

/// Constraints too many that stay open by less than this part of the mechanism's size were meant to
/// repeat each other; if they stay open by more, there are simply too many.
const NEARLY: f64 = 0.01;

/// Gears mesh when their distance is that of their radii to this part: a wrong radius is farther off,
/// and what a tooth's play allows is closer.
const MESHING: f64 = 2e-3;

impl Plan {
    /// Compiles a mechanism: finds its structure, assembles it at the start on the branch asked
    /// for, and follows that branch over the range of a single actuator.
    ///
    /// # Errors
    /// [`AssemblyError`] when the structure is not driven by its actuators, the bodies do not
    /// reach each other, or the branch is not told.
    pub fn compile(mechanism: &Mechanism, start: &Start) -> Result<Self, AssemblyError> {
        Self::compile_counting(mechanism, start, &[])
    }

    /// [`Plan::compile`], with the whole turns of these bodies counted from their rough angles, as
    /// where a relation needs them: for loads that feel an angle.
    ///
    /// # Errors
    /// As [`Plan::compile`].
    pub fn compile_counting(
        mechanism: &Mechanism,
        start: &Start,
        felt: &[BodyId],
    ) -> Result<Self, AssemblyError> {
        check(mechanism, start)?;
        if felt.iter().any(|b| b.0 >= mechanism.bodies.len()) {
            let what = "a body that is not there";
            return Err(StructureError::Malformed { what }.into());
        }
        let error = match Self::assembled(mechanism, start, felt, false) {
            Ok(mut plan) => {
                if !plan.frames.spare.is_empty() {
                    plan.note_unique(mechanism, mobility(mechanism, start).as_ref());
                }
                return Ok(plan);
            }
            Err(error) => error,
        };
        let by_rank = matches!(
            error,
            AssemblyError::Structure(
                StructureError::OverConstrained { .. } | StructureError::UnderDriven { .. }
            ) | AssemblyError::SingularStart { .. }
        );
        match mobility(mechanism, start).filter(|_| by_rank) {
            Some(found) => Self::despite(mechanism, start, felt, &found, error),
            None => Err(error),
        }
    }

    /// What can be done where counting and matching found something wrong: joints that repeat each
    /// other are solved together; what is wrong by rank too is told by rank.
    fn despite(
        mechanism: &Mechanism,
        start: &Start,
        felt: &[BodyId],
        found: &Mobility,
        error: AssemblyError,
    ) -> Result<Self, AssemblyError> {
        let reactions = mechanism.reactions();
        let mut twice: Vec<JointId> = reactions
            .iter()
            .zip(&found.unique)
            .filter(|(_, unique)| !**unique)
            .map(|(r, _)| r.joint)
            .collect();
        twice.dedup();
        let actuators: Vec<_> = (0..mechanism.actuators.len())
            .filter(|a| !found.unique[reactions.len() + a])
            .map(ActuatorId)
            .collect();
        let over = matches!(
            error,
            AssemblyError::Structure(StructureError::OverConstrained { .. })
        );
        if let Some(gap) = found.gap {
            // Several actuators for fewer freedoms are not joints that repeat each other.
            if (1..found.actuators).contains(&found.freedom()) {
                return Err(error);
            }
            return Err(match error {
                AssemblyError::Structure(StructureError::OverConstrained {
                    joints,
                    excess,
                    ..
                }) if !joints.is_empty() && gap < NEARLY * found.size => {
                    AssemblyError::Inconsistent {
                        joints,
                        excess,
                        gap,
                    }
                }
                other => other,
            });
        }
        if !found.free.is_empty() {
            return Err(StructureError::UnderDriven {
                dof: found.freedom(),
                actuators: found.actuators,
                bodies: found.free.clone(),
                twice,
            }
            .into());
        }
        if !actuators.is_empty() {
            return Err(StructureError::OverConstrained {
                excess: found.excess,
                joints: Vec::new(),
                actuators,
            }
            .into());
        }
        if !over || found.excess == 0 {
            return Err(error);
        }
        let mut plan = Self::assembled(mechanism, start, felt, true)?;
        plan.note_unique(mechanism, Some(found));
        Ok(plan)
    }

    /// That gears and racks stand at the distance of their pitch radii.
    fn check_meshing(&self, mechanism: &Mechanism, pose: &Pose<f64>) -> Result<(), AssemblyError> {
        let meshes =
            |kind: JointKind| matches!(kind, JointKind::Gear { .. } | JointKind::Rack { .. });
        if !mechanism.joints.iter().any(|j| meshes(j.kind)) {
            return Ok(());
        }
        let frames = self.body_frames(mechanism, pose);
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let [one, two] = [0, 1].map(|i| {
                let [x, y, angle] = frames[joint.bodies[i].0];
                vec2(x, y) + joint.points[i].turn(Vec2::from_angle(angle))
            });
            let turn = Vec2::from_angle(frames[joint.bodies[0].0][2]);
            let (distance, wanted) = match joint.kind {
                JointKind::Gear { radii, internal } => {
                    let sum = if internal {
                        radii[0] - radii[1]
                    } else {
                        radii[0] + radii[1]
                    };
                    ((two - one).norm(), sum.abs())
                }
                JointKind::Rack { axis, radius } => (axis.turn(turn).perp().dot(two - one), radius),
                _ => continue,
            };
            if (distance - wanted).abs() > MESHING * wanted.abs() {
                return Err(AssemblyError::NotMeshing {
                    joint: JointId(j),
                    distance,
                    wanted,
                });
            }
        }
        Ok(())
    }

    fn note_unique(&mut self, mechanism: &Mechanism, found: Option<&Mobility>) {
        let reactions = mechanism.reactions();
        self.unique = match found {
            Some(found) if found.gap.is_none() => found.unique[..reactions.len()].to_vec(),
            // Too large to tell: no reaction is promised to be unique.
            _ => vec![false; reactions.len()],
        };
    }

    fn assembled(
        mechanism: &Mechanism,
        start: &Start,
        felt: &[BodyId],
        repeated: bool,
    ) -> Result<Self, AssemblyError> {
        let mut plan = Self::structure(mechanism, felt, repeated)?;
        plan.start.clone_from(&start.q);
        let pose = plan.assemble(&Rough::new(mechanism, &plan.lowered, start))?;
        plan.check_meshing(mechanism, &pose)?;
        plan.follow(&pose)?;
        plan.home = Some(Box::new(pose));
        Ok(plan)
    }
}

/// Refuses a description whose parts refer to what is not there.
fn check(mechanism: &Mechanism, start: &Start) -> Result<(), StructureError> {
    let bodies = mechanism.bodies.len();
    let ends = mechanism.joints.iter().map(|j| j.bodies);
    let mut ends = ends.chain(mechanism.actuators.iter().map(|a| a.bodies));
    let finite = |angle: &Option<f64>| angle.is_none_or(f64::is_finite);
    let travels = |joint: JointId| {
        let kind = mechanism.joints.get(joint.0).map(|j| j.kind);
        matches!(
            kind,
            Some(JointKind::Prismatic { .. } | JointKind::Slot { .. } | JointKind::Rolling { .. })
        )
    };
    let measurable = |coordinate: Coordinate| match coordinate {
        Coordinate::Angle(pair) | Coordinate::Length { bodies: pair, .. } => {
            pair.iter().all(|b| b.0 < bodies)
        }
        Coordinate::Travel(joint) => travels(joint),
    };
    let related = |kind: JointKind| match kind {
        JointKind::Relation(r) => r < mechanism.relations.len(),
        _ => true,
    };
    let what = if mechanism.ground >= bodies || !ends.all(|e| e.iter().all(|b| b.0 < bodies)) {
        "a body that is not there"
    } else if !mechanism.joints.iter().all(|j| related(j.kind))
        || !mechanism
            .relations
            .iter()
            .all(|r| measurable(r.of) && measurable(r.by))
        || mechanism
            .actuators
            .iter()
            .any(|a| matches!(a.drive, Drive::Travel(joint) if !travels(joint)))
        || (start.joints.iter().zip(&mechanism.joints))
            .any(|(rough, joint)| rough.is_some() && joint.kind.told().is_none())
    {
        "a coordinate that is not there"
    } else if start.q.len() != mechanism.actuators.len() || start.rough.len() != bodies {
        "the start needs a coordinate for each actuator and a place for each body"
    } else if ![0, mechanism.joints.len()].contains(&start.joints.len()) {
        "the start tells of each joint or of none"
    } else if !start.q.iter().all(|q| q.is_finite())
        || !start.rough.iter().chain(&start.joints).all(finite)
    {
        "an angle or a length that is not a finite number"
    } else {
        return Ok(());
    };
    Err(StructureError::Malformed { what })
}

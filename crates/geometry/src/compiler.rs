//! From a description to a plan that is assembled, with its range, or to the error in the description.

mod build;
mod frame_vectors;

use crate::assembly::initial_guess::InitialGuess;
use crate::error::{AssemblyError, StructureError};
use crate::mechanism::{
    ActuatorId, ActuatorKind, BodyId, Condition, Coordinate, JointId, JointKind, Mechanism,
};
use crate::mobility::{Mobility, mobility};
use crate::plan::Pose;
use crate::plan::{AssemblyConfiguration, Plan};
use crate::plane::{Vec2, vec2};

/// Redundant constraints with a gap below this fraction of the mechanism's size are probably meant to be consistent.
/// With a larger gap the mechanism is over-constrained.
const NEARLY_CLOSED: f64 = 0.01;

/// Gears mesh if their centre distance agrees with their radii to this relative tolerance: a wrong radius differs by
/// more, backlash by less.
const MESHING_TOLERANCE: f64 = 2e-3;

/// The error of a mechanism whose best pose leaves a gap, m; `error` is the result of counting or matching.
fn not_closed(found: &Mobility, gap: f64, error: AssemblyError) -> AssemblyError {
    // More actuators than degrees of freedom are not redundant joints.
    let over_actuated = (1..found.actuators).contains(&found.degrees_of_freedom());
    match error {
        AssemblyError::Structure(StructureError::OverConstrained {
            joints,
            redundant_count,
            ..
        }) if !over_actuated && !joints.is_empty() && gap < NEARLY_CLOSED * found.size => {
            AssemblyError::Inconsistent {
                joints,
                redundant_count,
                gap,
            }
        }
        other => other,
    }
}

impl Plan {
    /// Compiles a mechanism: finds its structure, assembles it in the assembly mode nearest to the initial guess, and
    /// follows that branch over the range of a single actuator.
    ///
    /// # Errors
    /// [`AssemblyError`] when the actuators do not determine the motion, the loops cannot be closed, or several
    /// assembly modes are equally near to the initial guess.
    pub fn compile(
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
    ) -> Result<Self, AssemblyError> {
        Self::compile_counting_revolutions(mechanism, configuration, &[])
    }

    /// [`Plan::compile`], with the whole revolutions of these bodies counted from their approximate angles, as
    /// for couplings: needed by loads that depend on an angle.
    ///
    /// # Errors
    /// As [`Plan::compile`].
    pub fn compile_counting_revolutions(
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
        counted_bodies: &[BodyId],
    ) -> Result<Self, AssemblyError> {
        check(mechanism, configuration)?;
        if counted_bodies.iter().any(|b| b.0 >= mechanism.bodies.len()) {
            let reason = "it refers to a body that does not exist";
            return Err(StructureError::Malformed { reason }.into());
        }
        let error = match Self::try_compile(mechanism, configuration, counted_bodies, false) {
            Ok(mut plan) => {
                if !plan.frames.redundant_pairs.is_empty() {
                    plan.set_determinate(mechanism, mobility(mechanism, configuration).as_ref());
                }
                return Ok(plan);
            }
            Err(error) => error,
        };
        let by_rank = matches!(
            error,
            AssemblyError::Structure(
                StructureError::OverConstrained { .. } | StructureError::UnderActuated { .. }
            ) | AssemblyError::SingularAssembly { .. }
        );
        match mobility(mechanism, configuration).filter(|_| by_rank) {
            Some(found) => {
                Self::compile_redundant(mechanism, configuration, counted_bodies, &found, error)
            }
            None => Err(error),
        }
    }

    /// Compiles a mechanism that counting or matching rejected: redundant constraints are solved together. If the rank
    /// rejects it too, the error states the rank.
    fn compile_redundant(
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
        counted_bodies: &[BodyId],
        found: &Mobility,
        error: AssemblyError,
    ) -> Result<Self, AssemblyError> {
        let reactions = mechanism.reactions();
        let by_reaction = reactions.iter().zip(&found.determinate);
        let redundant = by_reaction.filter(|(_, determinate)| !**determinate);
        let mut redundant_joints: Vec<JointId> = redundant.map(|(r, _)| r.joint).collect();
        redundant_joints.dedup();
        let actuators: Vec<_> = (0..mechanism.actuators.len())
            .filter(|a| !found.determinate[reactions.len() + a])
            .map(ActuatorId)
            .collect();
        let over = matches!(
            error,
            AssemblyError::Structure(StructureError::OverConstrained { .. })
        );
        if let Some(gap) = found.gap {
            return Err(not_closed(found, gap, error));
        }
        if !found.free_bodies.is_empty() {
            return Err(StructureError::UnderActuated {
                degrees_of_freedom: found.degrees_of_freedom(),
                actuators: found.actuators,
                bodies: found.free_bodies.clone(),
                redundant_joints,
            }
            .into());
        }
        if !actuators.is_empty() {
            return Err(StructureError::OverConstrained {
                redundant_count: found.redundant_count,
                joints: Vec::new(),
                actuators,
            }
            .into());
        }
        if !over || found.redundant_count == 0 {
            return Err(error);
        }
        let mut plan = Self::try_compile(mechanism, configuration, counted_bodies, true)?;
        plan.set_determinate(mechanism, Some(found));
        Ok(plan)
    }

    /// Checks that gears and racks stand at the distance of their pitch radii.
    fn check_meshing(&self, mechanism: &Mechanism, pose: &Pose<f64>) -> Result<(), AssemblyError> {
        let frames = self.body_frames(mechanism, pose);
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let [one, two] = [0, 1].map(|i| {
                let [x, y, angle] = frames[joint.bodies[i].0];
                vec2(x, y) + joint.points[i].rotate(Vec2::from_angle(angle))
            });
            let rotation = Vec2::from_angle(frames[joint.bodies[0].0][2]);
            let Some(condition) = joint
                .kind
                .conditions()
                .next()
                .filter(|_| joint.kind.has_teeth())
            else {
                continue;
            };
            let (distance, required) = match condition {
                Condition::Meshed { radii, internal } => {
                    let sum = if internal {
                        radii[0] - radii[1]
                    } else {
                        radii[0] + radii[1]
                    };
                    ((two - one).norm(), sum.abs())
                }
                Condition::Rolled { axis, radius } => {
                    (axis.rotate(rotation).perp().dot(two - one), radius)
                }
                _ => continue,
            };
            if (distance - required).abs() > MESHING_TOLERANCE * required.abs() {
                return Err(AssemblyError::NotMeshing {
                    joint: JointId(j),
                    distance,
                    required,
                });
            }
        }
        Ok(())
    }

    fn set_determinate(&mut self, mechanism: &Mechanism, found: Option<&Mobility>) {
        let reactions = mechanism.reactions();
        self.determinate = match found {
            Some(found) if found.gap.is_none() => found.determinate[..reactions.len()].to_vec(),
            // Too large for the rank: no reaction is claimed to be unique.
            _ => vec![false; reactions.len()],
        };
    }

    fn try_compile(
        mechanism: &Mechanism,
        configuration: &AssemblyConfiguration,
        counted_bodies: &[BodyId],
        allow_redundant: bool,
    ) -> Result<Self, AssemblyError> {
        let mut plan = Self::structure(mechanism, counted_bodies, allow_redundant)?;
        plan.assembly_coordinates.clone_from(&configuration.q);
        let pose = plan.assemble(&InitialGuess::new(mechanism, &plan.lowered, configuration))?;
        plan.check_meshing(mechanism, &pose)?;
        plan.follow_branch(&pose)?;
        plan.assembly_pose = Some(Box::new(pose));
        Ok(plan)
    }
}

/// Refuses a description that refers to bodies, joints or coordinates that do not exist.
//
// Long: one condition after another, and every kind of joint by its name.
fn check(
    mechanism: &Mechanism,
    configuration: &AssemblyConfiguration,
) -> Result<(), StructureError> {
    let bodies = mechanism.bodies.len();
    let body_pairs = mechanism.joints.iter().map(|j| j.bodies);
    let mut body_pairs = body_pairs.chain(mechanism.actuators.iter().map(|a| a.bodies));
    let (mut couplings, mut actuators) = (mechanism.couplings.iter(), mechanism.actuators.iter());
    let finite = |angle: &Option<f64>| angle.is_none_or(f64::is_finite);
    let guesses = configuration.initial_guess.iter();
    let mut guesses = guesses.chain(&configuration.branch_hints);
    let travels = |joint: JointId| {
        let joint = mechanism.joints.get(joint.0);
        joint.is_some_and(|j| j.kind.travel_axis().is_some())
    };
    let measurable = |coordinate: Coordinate| match coordinate {
        Coordinate::Angle(pair) | Coordinate::Length { bodies: pair, .. } => {
            pair.iter().all(|b| b.0 < bodies)
        }
        Coordinate::Travel(joint) => travels(joint),
    };
    let count = mechanism.couplings.len();
    let is_unrelated = |kind| matches!(kind, JointKind::Coupling(r) if r >= count);
    let reason = if mechanism.ground >= bodies
        || !body_pairs.all(|e| e.iter().all(|b| b.0 < bodies))
    {
        "it refers to a body that does not exist"
    } else if mechanism.joints.iter().any(|j| is_unrelated(j.kind))
        || !couplings.all(|r| measurable(r.dependent) && measurable(r.independent))
        || actuators.any(|a| matches!(a.kind, ActuatorKind::Travel(joint) if !travels(joint)))
        || (configuration.branch_hints.iter().zip(&mechanism.joints))
            .any(|(hint, joint)| hint.is_some() && joint.kind.branch_hint().is_none())
    {
        "it refers to a coordinate that does not exist"
    } else if configuration.q.len() != mechanism.actuators.len()
        || configuration.initial_guess.len() != bodies
    {
        "the assembly needs one coordinate per actuator and one entry of the initial guess per body"
    } else if ![0, mechanism.joints.len()].contains(&configuration.branch_hints.len()) {
        "the branch hints must have one entry per joint, or none"
    } else if !configuration.q.iter().all(|q| q.is_finite()) || !guesses.all(finite) {
        "an angle or a length is not a finite number"
    } else {
        return Ok(());
    };
    Err(StructureError::Malformed { reason })
}

//! Couplings of mechanisms in the plane and in space, and their faults: functions that are not finite or jump, and tables that end.

use super::position::TABLE_HELP;
use crate::explain::{Labels, StudyError, labels, scene_error};
use crate::number_format::{digits, number};
use dwell_geometry::{Coupling, JointId, JointKind, Mechanism, space};
use dwell_laws::Law;
use dwell_scene::{SceneFile, SceneLocation};

/// Help for a discontinuous function.
pub(crate) const CONTINUITY_HELP: &str = "the function must be continuous: make its pieces meet, or join them with a \
     rise such as `cycloidal`; let an angle grow past 2π instead of resetting it";

/// The location of a discontinuity between two neighbouring numbers.
pub(crate) fn jump_location(a: f64, b: f64) -> String {
    // Bisection is certain to these digits.
    digits(if a.abs() > b.abs() { a } else { b }, 9)
}

/// A coupling: joint, function, and the independent coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CouplingLaw<'a, K> {
    pub(crate) joint: JointId,
    pub(crate) law: &'a Law,
    pub(crate) variable: K,
}

/// A mechanism with couplings, in the plane or in space.
pub(crate) trait CoupledMechanism {
    type Coordinate: Copy + PartialEq;

    /// Its couplings.
    fn coupling_laws(&self) -> Vec<CouplingLaw<'_, Self::Coordinate>>;

    /// By actuator.
    fn driven_coordinates(&self) -> Vec<Self::Coordinate>;

    fn joint_name(&self, joint: JointId) -> &str;
}

/// The laws of couplings, of joints that have these numbers among them.
fn laws_of<K: Copy>(
    couplings: &[Coupling<K>],
    of_joints: impl Iterator<Item = Option<usize>>,
) -> Vec<CouplingLaw<'_, K>> {
    let laws = of_joints.enumerate().filter_map(|(j, index)| {
        let coupling = couplings.get(index?)?;
        Some(CouplingLaw {
            joint: JointId(j),
            law: &coupling.law,
            variable: coupling.independent,
        })
    });
    laws.collect()
}

impl CoupledMechanism for Mechanism {
    type Coordinate = dwell_geometry::Coordinate;

    fn coupling_laws(&self) -> Vec<CouplingLaw<'_, Self::Coordinate>> {
        let joints = self.joints.iter().map(|joint| match joint.kind {
            JointKind::Coupling(index) => Some(index),
            _ => None,
        });
        laws_of(&self.couplings, joints)
    }

    fn driven_coordinates(&self) -> Vec<Self::Coordinate> {
        self.actuators.iter().map(|a| a.coordinate()).collect()
    }

    fn joint_name(&self, joint: JointId) -> &str {
        &self.joints[joint.0].name
    }
}

impl CoupledMechanism for space::Mechanism {
    type Coordinate = space::Coordinate;

    fn coupling_laws(&self) -> Vec<CouplingLaw<'_, Self::Coordinate>> {
        let joints = self.joints.iter().map(|joint| match joint.kind {
            space::JointKind::Coupling { index, .. } => Some(index),
            _ => None,
        });
        laws_of(&self.couplings, joints)
    }

    fn driven_coordinates(&self) -> Vec<Self::Coordinate> {
        let actuators = self.actuators.iter();
        let driven = actuators.map(|a| a.kind.coordinate(&self.joints[a.kind.joint().0]));
        driven.collect()
    }

    fn joint_name(&self, joint: JointId) -> &str {
        &self.joints[joint.0].name
    }
}

/// The first coupling of an actuator coordinate whose function has no finite value or derivative at
/// `q` (rad or m): joint, value of the variable, and what is not finite.
pub(crate) fn non_finite_coupling(
    mechanism: &impl CoupledMechanism,
    q: &[f64],
) -> Option<NonFiniteCoupling> {
    let driven = mechanism.driven_coordinates();
    mechanism.coupling_laws().into_iter().find_map(|of| {
        let x = *q.get(driven.iter().position(|driven| *driven == of.variable)?)?;
        let order = of.law.eval(x)[..3].iter().position(|d| !d.is_finite())?;
        let (joint, what) = (of.joint, ["value", "slope", "curvature"][order]);
        Some(NonFiniteCoupling { joint, x, what })
    })
}

/// A coupling function whose `what` (value, slope, curvature) is not finite at `x` (SI).
pub(crate) struct NonFiniteCoupling {
    joint: JointId,
    x: f64,
    what: &'static str,
}

/// The error of such a function.
pub(crate) fn non_finite_coupling_error(
    file: &SceneFile,
    mechanism: &impl CoupledMechanism,
    &NonFiniteCoupling { joint, x, what }: &NonFiniteCoupling,
    position: &str,
) -> StudyError {
    let fault = format!("no finite {what} at x = {}", number(x));
    let name = mechanism.joint_name(joint);
    scene_error(
        file,
        format!("the function of coupling `{name}` has {fault}, {position}"),
        "a coupling function needs a finite value and two finite derivatives everywhere",
        [(SceneLocation::CouplingLaw(joint), fault)],
    )
}

/// The error of a coupling whose function jumps between two values of its variable, SI; `when` says where.
pub(crate) fn discontinuous_coupling_error(
    file: &SceneFile,
    mechanism: &impl CoupledMechanism,
    joint: JointId,
    between: [f64; 2],
    when: &str,
) -> StudyError {
    let (name, x) = (
        mechanism.joint_name(joint),
        jump_location(between[0], between[1]),
    );
    let message = format!("the function of coupling `{name}` is discontinuous {when}, at x = {x}");
    let location = SceneLocation::CouplingLaw(joint);
    scene_error(
        file,
        message,
        CONTINUITY_HELP,
        [(location, format!("jumps at x = {x}"))],
    )
}

/// The error of a coupling whose table has no value at a position.
pub(crate) fn uncovered_coupling_error(
    file: &SceneFile,
    mechanism: &impl CoupledMechanism,
    joint: JointId,
    at: &str,
) -> StudyError {
    let name = mechanism.joint_name(joint);
    let message = format!("the table of coupling `{name}` has no value at {at}");
    let table = [SceneLocation::CouplingLaw(joint)].into_iter();
    scene_error(
        file,
        message,
        TABLE_HELP,
        labels(table, "has no value there"),
    )
}

/// The error of a coupling whose table has no value at the assembly; `start` are the places of its coordinates.
pub(crate) fn uncovered_start_error(
    file: &SceneFile,
    mechanism: &impl CoupledMechanism,
    joint: JointId,
    start: Labels,
) -> StudyError {
    let name = mechanism.joint_name(joint);
    let message = format!("the table of coupling `{name}` has no value at the start");
    let table = [SceneLocation::CouplingLaw(joint)];
    let mut places = labels(table.into_iter(), "does not reach the start");
    places.extend(start);
    scene_error(file, message, TABLE_HELP, places)
}

//! Coupling functions that are not finite.

use crate::explain::{StudyError, scene_error};
use crate::number_format::number;
use dwell_geometry::{Coordinate, JointId, JointKind, Mechanism};
use dwell_laws::Law;
use dwell_scene::{PlaneScene, SceneLocation};

/// The couplings of a mechanism: joint, function, and the independent coordinate.
pub(crate) fn couplings(
    mechanism: &Mechanism,
) -> impl Iterator<Item = (JointId, &Law, Coordinate)> {
    let joints = mechanism.joints.iter().enumerate();
    joints.filter_map(|(j, joint)| {
        let JointKind::Coupling(k) = joint.kind else {
            return None;
        };
        let coupling = mechanism.couplings.get(k)?;
        Some((JointId(j), &coupling.law, coupling.independent))
    })
}

/// The first coupling of an actuator coordinate whose function has no finite value or derivative at
/// `q` (rad or m): joint, value of the variable, and what is not finite.
pub(crate) fn non_finite_coupling(mechanism: &Mechanism, q: &[f64]) -> Option<NonFiniteCoupling> {
    couplings(mechanism).find_map(|(joint, law, variable)| {
        let mut actuators = mechanism.actuators.iter();
        let x = *q.get(actuators.position(|a| a.coordinate() == variable)?)?;
        let order = law.eval(x)[..3].iter().position(|d| !d.is_finite())?;
        let what = ["value", "slope", "curvature"][order];
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
    scene: &PlaneScene,
    &NonFiniteCoupling { joint, x, what }: &NonFiniteCoupling,
    position: &str,
) -> StudyError {
    let fault = format!("no finite {what} at x = {}", number(x));
    let name = &scene.mechanism.joints[joint.0].name;
    scene_error(
        scene,
        format!("the function of coupling `{name}` has {fault}, {position}"),
        "a coupling function needs a finite value and two finite derivatives everywhere",
        [(SceneLocation::CouplingLaw(joint), fault)],
    )
}

//! The period of a conservative free motion.

use crate::explain::{StudyError, missing_section_label, scene_error};
use crate::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
use dwell_dynamics::Orbit;
use dwell_scene::Scene;

/// The period (s) and the energy (J) of the free motion of a scene, by quadrature: for one free coordinate and conservative
/// loads.
///
/// # Errors
/// [`StudyError`] where the scene has no motion, or it is not conservative or does not repeat itself.
///
/// ```
/// # let scene = dwell_scene::Scene::read("../../validation/single-dwell/scene.toml")?;
/// let orbit = dwell_study::compute_period(&scene)?;
/// assert!((orbit.period - 5.41966267706427).abs() < 1e-12);
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn compute_period(scene: &Scene) -> Result<Orbit, StudyError> {
    let Some(spec) = &scene.motion else {
        return Err(scene_error(
            scene,
            "the scene has no [motion]",
            "add a motion",
            missing_section_label("motion"),
        ));
    };
    let problem = FreeMotionProblem::new(scene, scene, spec)?;
    problem.orbit(1.0).map_err(|e| problem.explain(&e))
}

//! The period of a conservative free motion.

use crate::explain::{StudyError, missing_section_label, scene_error};
use crate::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
use dwell_dynamics::Orbit;
use dwell_scene::PlaneScene;

/// The period (s) and the energy (J) of the free motion of a scene in the plane, by quadrature.
pub(crate) fn orbit_in_plane(scene: &PlaneScene) -> Result<Orbit, StudyError> {
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

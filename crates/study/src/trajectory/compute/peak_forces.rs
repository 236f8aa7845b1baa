//! The largest actuator forces and reactions along a trajectory, and nothing else: what a parameter sweep
//! needs of thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::{Analysis, ForceEvaluator, Trajectory};
use dwell_kinetostatics::{InverseDynamics, Model};
use dwell_scene::Scene;

/// The largest absolute values of statics or kinetostatics along the scene's trajectory.
///
/// # Errors
/// [`StudyError::Scene`] where the scene defines no trajectory, or it ends early.
pub(crate) fn peak_forces(
    scene: &Scene,
    model: &Model,
    analysis: Analysis,
) -> Result<InverseDynamics<f64>, StudyError> {
    let plan = model.plan();
    let trajectory = Trajectory::new(scene, plan, analysis, None)?;
    trajectory.check_laws(scene)?;
    let mut evaluator = ForceEvaluator::new(scene, model, analysis);
    // Only couplings have functions that may jump.
    let has_couplings = !scene.mechanism.couplings.is_empty();
    let mut peaks = model.result_buffer();
    let early_stop = trajectory.follow(plan, |_, sample| {
        evaluator.evaluate(sample, trajectory.load_time(sample))?;
        if has_couplings {
            evaluator.fill_states(sample)?;
        }
        raise_to(&mut peaks.reactions, &evaluator.results.reactions);
        raise_to(&mut peaks.tau, &evaluator.results.tau);
        Ok(())
    });
    match early_stop {
        Some(stop) => Err(stop.explain(scene)),
        None => Ok(peaks),
    }
}

fn raise_to(peaks: &mut [f64], values: &[f64]) {
    for (peaks, values) in peaks.iter_mut().zip(values) {
        *peaks = peaks.max(values.abs());
    }
}

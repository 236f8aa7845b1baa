//! The largest actuator forces and reactions along a trajectory, and nothing else: what a parameter sweep
//! needs of thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::{Analysis, ForceEvaluator, Trajectory};
use dwell_kinetostatics::Model;
use dwell_scene::Scene;

/// The largest absolute values along a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PeakForces {
    /// By reaction of the model, N or N·m.
    pub(crate) reactions: Vec<f64>,
    /// By actuator, N·m or N.
    pub(crate) actuator_forces: Vec<f64>,
}

/// Evaluates statics or kinetostatics along the scene's trajectory.
///
/// # Errors
/// [`StudyError::Scene`] where the scene defines no trajectory, or it ends early.
pub(crate) fn peak_forces(
    scene: &Scene,
    model: &Model,
    analysis: Analysis,
) -> Result<PeakForces, StudyError> {
    let plan = model.plan();
    let trajectory = Trajectory::new(scene, plan, analysis, None)?;
    trajectory.check_laws(scene)?;
    let mut evaluator = ForceEvaluator::new(scene, model, analysis);
    // Only couplings have functions that may jump.
    let has_couplings = !scene.mechanism.couplings.is_empty();
    let mut peaks = PeakForces {
        reactions: vec![0.0; model.reactions().len()],
        actuator_forces: vec![0.0; plan.actuators()],
    };
    let early_stop = trajectory.follow(plan, |_, sample| {
        evaluator.evaluate(sample, trajectory.load_time(sample, analysis))?;
        if has_couplings {
            evaluator.fill_states(sample)?;
        }
        raise_to(&mut peaks.reactions, &evaluator.results.reactions);
        raise_to(&mut peaks.actuator_forces, &evaluator.results.tau);
        Ok(())
    });
    match early_stop {
        Some(stop) => Err(stop.explain(scene, plan, &trajectory)),
        None => Ok(peaks),
    }
}

fn raise_to(peaks: &mut [f64], values: &[f64]) {
    for (peaks, values) in peaks.iter_mut().zip(values) {
        *peaks = peaks.max(values.abs());
    }
}

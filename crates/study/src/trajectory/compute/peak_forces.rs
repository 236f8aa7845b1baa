//! The largest actuator forces and reactions along a trajectory, and nothing else: what a parameter sweep
//! needs of thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::{
    Analysis, StopCause, Trajectory, TrajectoryMonitor, TrajectorySample,
};
use dwell_geometry::body_states::BodyStates;
use dwell_geometry::{Motion, Plan};
use dwell_kinetostatics::{InverseDynamics, Model, Workspace};
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
    let mut evaluator = ForceEvaluator {
        model,
        analysis,
        workspace: model.workspace(),
        results: model.result_buffer(),
        motion_buffer: plan.motion(),
        body_states: BodyStates::new(plan),
        monitor: TrajectoryMonitor::new(scene),
        has_couplings: !scene.mechanism.couplings.is_empty(),
    };
    let mut peaks = PeakForces {
        reactions: vec![0.0; model.reactions().len()],
        actuator_forces: vec![0.0; plan.actuators()],
    };
    let early_stop = trajectory.follow(plan, |_, sample| {
        evaluator.evaluate(plan, sample, trajectory.load_time(sample, analysis))?;
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

struct ForceEvaluator<'a> {
    model: &'a Model,
    analysis: Analysis,
    workspace: Workspace<f64>,
    results: InverseDynamics<f64>,
    motion_buffer: Motion<f64>,
    body_states: BodyStates,
    monitor: TrajectoryMonitor<'a>,
    /// Whether there are couplings, whose functions may jump.
    has_couplings: bool,
}

impl ForceEvaluator<'_> {
    fn evaluate(
        &mut self,
        plan: &Plan,
        sample: &TrajectorySample,
        t: f64,
    ) -> Result<(), StopCause> {
        let (model, workspace, results) = (self.model, &mut self.workspace, &mut self.results);
        let TrajectorySample {
            q, q_dot, q_ddot, ..
        } = sample;
        match self.analysis {
            Analysis::Statics => model.statics(t, q, workspace, results)?,
            _ => model.kinetostatics(t, q, q_dot, q_ddot, workspace, results)?,
        }
        if let Some(fault) = self.monitor.off_table(t, workspace.states()) {
            return Err(StopCause::Fault(fault));
        }
        if self.has_couplings {
            let (pose, motion) = (&workspace.pose, &mut self.motion_buffer);
            plan.velocities(pose, q_dot, motion);
            plan.accelerations(pose, q_ddot, motion);
            self.body_states.fill(plan, pose, motion);
            if let Some(fault) = self.monitor.discontinuity(&self.body_states) {
                return Err(StopCause::Fault(fault));
            }
        }
        Ok(())
    }
}

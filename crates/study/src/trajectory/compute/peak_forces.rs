//! The largest actuator forces and reactions along a trajectory, and nothing else: what a parameter sweep
//! needs of thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::{
    Analysis, EarlyStop, StopCause, Trajectory, TrajectoryMonitor, TrajectorySample,
    unreachable_error,
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
    // A static sweep has no time.
    let timed = trajectory.swept_actuator().is_none() || analysis != Analysis::Statics;
    let mut evaluator = ForceEvaluator {
        model,
        analysis,
        workspace: model.workspace(),
        inverse_dynamics: model.result_buffer(),
        motion_buffer: plan.motion(),
        body_states: BodyStates::new(plan),
        monitor: TrajectoryMonitor::new(scene),
        has_couplings: !scene.mechanism.couplings.is_empty(),
    };
    let mut peaks = PeakForces {
        reactions: vec![0.0; model.reactions().len()],
        actuator_forces: vec![0.0; plan.actuators()],
    };
    let mut previous: Option<f64> = None;
    for k in 0..trajectory.points {
        let fraction = trajectory.fraction_at(k);
        let sample = trajectory.sample_at(fraction);
        let unreachable = previous
            .filter(|_| plan.actuators() == 1)
            .and_then(|q| unreachable_error(plan, q, sample.q[0]));
        let done = match unreachable {
            Some(error) => Err(error.into()),
            None => evaluator.evaluate(plan, &sample, if timed { sample.t } else { 0.0 }),
        };
        if let Err(cause) = done {
            let reached = if k > 0 {
                trajectory.fraction_at(k - 1)
            } else {
                fraction
            };
            let early_stop = EarlyStop::find(plan, &trajectory, [reached, fraction], cause);
            return Err(early_stop.explain(scene, plan, &trajectory));
        }
        previous = sample.q.first().copied();
        raise_to(&mut peaks.reactions, &evaluator.inverse_dynamics.reactions);
        raise_to(&mut peaks.actuator_forces, &evaluator.inverse_dynamics.tau);
    }
    Ok(peaks)
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
    inverse_dynamics: InverseDynamics<f64>,
    motion_buffer: Motion<f64>,
    body_states: BodyStates,
    monitor: TrajectoryMonitor<'a>,
    /// Whether there are relations, whose functions may jump.
    has_couplings: bool,
}

impl ForceEvaluator<'_> {
    fn evaluate(
        &mut self,
        plan: &Plan,
        sample: &TrajectorySample,
        t: f64,
    ) -> Result<(), StopCause> {
        let (workspace, inverse_dynamics) = (&mut self.workspace, &mut self.inverse_dynamics);
        let TrajectorySample {
            q, q_dot, q_ddot, ..
        } = sample;
        let state = match self.analysis {
            Analysis::Statics => self.model.statics(t, q, workspace, inverse_dynamics)?,
            _ => self
                .model
                .kinetostatics(t, q, q_dot, q_ddot, workspace, inverse_dynamics)?,
        };
        if let Some(fault) = self.monitor.off_table(t, state.bodies()) {
            return Err(StopCause::Fault(fault));
        }
        if self.has_couplings {
            plan.velocities(state.pose(), q_dot, &mut self.motion_buffer);
            plan.accelerations(state.pose(), q_ddot, &mut self.motion_buffer);
            self.body_states
                .fill(plan, state.pose(), &self.motion_buffer);
            if let Some(fault) = self.monitor.discontinuity(&self.body_states) {
                return Err(StopCause::Fault(fault));
            }
        }
        Ok(())
    }
}

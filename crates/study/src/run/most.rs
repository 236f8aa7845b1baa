//! The largest actions and reactions along a way, and nothing else: what a sweep asks of thousands of
//! scenes.

use crate::error::StudyError;
use crate::run::Command;
use crate::run::stop::{End, Stop, is_cut_off};
use crate::run::watch::Watch;
use crate::run::way::{Sample, Way};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{Motion, Plan};
use dwell_kinetostatics::{Actions, Model, Workspace};
use dwell_scene::Scene;

/// The largest absolute values along a way.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Most {
    /// By reaction of the model, N or N·m.
    pub(crate) reactions: Vec<f64>,
    /// By actuator, N·m or N.
    pub(crate) actions: Vec<f64>,
}

/// Follows a scene along the way of statics or kinetostatics, at its own positions.
///
/// # Errors
/// [`StudyError::Scene`] where the way is not known, or ends early.
pub(crate) fn most(scene: &Scene, model: &Model, command: Command) -> Result<Most, StudyError> {
    let plan = model.plan();
    let way = Way::new(scene, plan, command, None)?;
    way.check(scene)?;
    // A sweep of statics has no time.
    let timed = way.swept().is_none() || command != Command::Statics;
    let mut probe = Probe {
        model,
        command,
        work: model.workspace(),
        actions: model.actions(),
        motion: plan.motion(),
        moving: BodyStates::new(plan),
        watch: Watch::new(scene),
        related: !scene.mechanism.relations.is_empty(),
    };
    let mut most = Most {
        reactions: vec![0.0; model.reactions().len()],
        actions: vec![0.0; plan.actuators()],
    };
    let mut before: Option<f64> = None;
    for k in 0..way.points {
        let part = way.part(k);
        let sample = way.at(part);
        let cut = before
            .filter(|_| plan.actuators() == 1)
            .and_then(|q| is_cut_off(plan, q, sample.q[0]));
        let done = match cut {
            Some(error) => Err(error.into()),
            None => probe.evaluate(plan, &sample, if timed { sample.t } else { 0.0 }),
        };
        if let Err(end) = done {
            let reached = if k > 0 { way.part(k - 1) } else { part };
            let stop = Stop::find(plan, &way, [reached, part], end);
            return Err(stop.explain(scene, plan, &way));
        }
        before = sample.q.first().copied();
        raise(&mut most.reactions, &probe.actions.reactions);
        raise(&mut most.actions, &probe.actions.tau);
    }
    Ok(most)
}

fn raise(most: &mut [f64], now: &[f64]) {
    for (most, now) in most.iter_mut().zip(now) {
        *most = most.max(now.abs());
    }
}

struct Probe<'a> {
    model: &'a Model,
    command: Command,
    work: Workspace<f64>,
    actions: Actions<f64>,
    motion: Motion<f64>,
    moving: BodyStates,
    watch: Watch<'a>,
    /// Whether there are relations, whose functions may jump.
    related: bool,
}

impl Probe<'_> {
    fn evaluate(&mut self, plan: &Plan, sample: &Sample, t: f64) -> Result<(), End> {
        let (work, actions) = (&mut self.work, &mut self.actions);
        let Sample {
            q, q_dot, q_ddot, ..
        } = sample;
        match self.command {
            Command::Statics => self.model.statics(t, q, work, actions)?,
            _ => self
                .model
                .kinetostatics(t, q, q_dot, q_ddot, work, actions)?,
        }
        if let Some(fault) = self.watch.off_table(t, work.states()) {
            return Err(End::Fault(fault));
        }
        if self.related {
            plan.speeds(&work.pose, q_dot, &mut self.motion);
            plan.accelerations(&work.pose, q_ddot, &mut self.motion);
            self.moving.fill(plan, &work.pose, &self.motion);
            if let Some(fault) = self.watch.jump(&self.moving) {
                return Err(End::Fault(fault));
            }
        }
        Ok(())
    }
}

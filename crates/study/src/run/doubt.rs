//! What rounding does to a run: some of its positions are evaluated again with 32 digits.

use dwell_geometry::Wide;
use dwell_kinetostatics::{Actions, Model, Workspace};
use dwell_scene::Scene;

/// Positions that are evaluated again, along the whole way.
const POSITIONS: usize = 48;

/// Estimated errors of actions and reactions, forces and moments apart.
pub(crate) struct Doubt {
    every: usize,
    work: Workspace<Wide>,
    errors: Actions<f64>,
    /// By actuator and by reaction: whether it is a force.
    forces: [Vec<bool>; 2],
    /// The largest error and the largest value, of moments and of forces.
    most: [[f64; 2]; 2],
}

impl Doubt {
    /// None so far, of a way of so many positions.
    pub(crate) fn new(scene: &Scene, model: &Model, points: usize) -> Self {
        let actuators = scene.mechanism.actuators.iter();
        let reactions = model.reactions().iter();
        Self {
            every: points.div_ceil(POSITIONS).max(1),
            work: model.workspace(),
            errors: model.actions(),
            forces: [
                actuators.map(|a| !a.coordinate().is_angle()).collect(),
                reactions.map(|r| r.component.unit() == "N").collect(),
            ],
            most: [[0.0; 2]; 2],
        }
    }

    /// Takes in position `k`, at (t, q, q̇, q̈), if it is one of those.
    pub(crate) fn take(
        &mut self,
        k: usize,
        model: &Model,
        t: f64,
        at: [&[f64]; 3],
        actions: &Actions<f64>,
    ) {
        if !k.is_multiple_of(self.every) {
            return;
        }
        let done = model.action_errors(t, at, actions, &mut self.work, &mut self.errors);
        // Where plain numbers found a pose at the very edge, longer ones may see that there is none.
        if done.is_err() {
            return;
        }
        let errors = [&self.errors.tau, &self.errors.reactions];
        let values = [&actions.tau, &actions.reactions];
        for ((errors, values), forces) in errors.into_iter().zip(values).zip(&self.forces) {
            for ((error, value), &force) in errors.iter().zip(values).zip(forces) {
                let [most, largest] = &mut self.most[usize::from(force)];
                *most = most.max(*error);
                *largest = largest.max(value.abs());
            }
        }
    }

    /// The largest error as a part of the largest value of its unit.
    pub(crate) fn largest(&self) -> f64 {
        let part = |[error, value]: [f64; 2]| if error > 0.0 { error / value } else { 0.0 };
        self.most.map(part).into_iter().fold(0.0, f64::max)
    }
}

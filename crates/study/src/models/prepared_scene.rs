//! A scene with the exact reduced model of its requests.

use crate::explain::StudyError;
use crate::machines::MachineScene as _;
use crate::models::{determinate_model, exact_model, requested_reaction_bodies};
use crate::ranges::equally_spaced;
use dwell_dynamics::ReducedState;
use dwell_kinetostatics::{ExactModel, ReducedModel};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// A scene and the reduced model of its requests.
#[derive(Debug)]
pub struct PreparedScene<'a> {
    /// The scene.
    pub scene: &'a PlaneScene,
    /// The model, with the requested statically determinate reactions in the order of the scene.
    pub model: ExactModel,
}

impl<'a> PreparedScene<'a> {
    /// Compiles the requests of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together or does not have one
    /// degree of freedom.
    pub fn new(scene: &'a PlaneScene) -> Result<Self, StudyError> {
        let model = exact_model(scene, determinate_model(scene)?)?;
        Ok(Self { scene, model })
    }

    /// Compiles the requests of a scene, without the groups that affect neither inertia nor a requested
    /// reaction. For analyses that ignore loads.
    ///
    /// # Errors
    /// As [`PreparedScene::new`].
    pub fn without_loads(scene: &'a PlaneScene) -> Result<Self, StudyError> {
        let model = determinate_model(scene)?;
        let pruned = model.pruned_for(&requested_reaction_bodies(scene));
        let model = exact_model(scene, pruned)?;
        Ok(Self { scene, model })
    }

    /// Whether the coordinate is an angle; otherwise it is a length.
    pub fn is_angle(&self) -> bool {
        self.model.model().plan().is_angle(0)
    }

    /// The name of the coordinate.
    pub fn coordinate_name(&self) -> &str {
        &self.scene.mechanism.actuators[0].name
    }

    /// Names and units (of a force or a moment) of the reactions of the model.
    pub fn reaction_units(&self) -> Vec<(String, &'static str)> {
        self.scene.reaction_units(self.model.model())
    }

    /// The initial state of the free motion, if the scene has one.
    pub fn initial_state(&self) -> Option<ReducedState> {
        initial_reduced_state(self.scene)
    }

    /// `count` + 1 equally spaced coordinates over the range, rad, of an angle: over a revolution from 0, or between
    /// the limit positions, of which a thousandth is left out, because the coefficients grow without bound there.
    pub fn range_positions(&self, count: usize) -> Vec<f64> {
        let (from, to) = match self.model.range().limits() {
            None => (0.0, TAU),
            Some((from, to)) => {
                let margin = 1e-3 * (to - from);
                (from + margin, to - margin)
            }
        };
        equally_spaced([from, to], count)
    }
}

/// The initial state of the free motion of one degree of freedom, if the scene has one.
pub(crate) fn initial_reduced_state(scene: &PlaneScene) -> Option<ReducedState> {
    let spec = scene.motion.as_ref()?;
    Some(ReducedState {
        t: 0.0,
        q: *spec.initial_coordinates.first()?,
        q_dot: *spec.initial_velocities.first()?,
    })
}

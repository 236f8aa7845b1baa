//! A scene made ready: its exact reduced model for what it requests.

use crate::error::{StudyError, explain_model, not_one_actuator};
use dwell_dynamics::State;
use dwell_geometry::{ActuatorId, Reaction, Start};
use dwell_kinetostatics::{Exact, Model, Reduced};
use dwell_scene::{Place, Scene};
use std::f64::consts::TAU;

/// A scene and the reduced model of what it requests.
#[derive(Debug)]
pub struct Prepared<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The model, with the requested reactions in the order of the scene.
    pub model: Exact,
}

/// A reduced model of a scene for some reactions.
pub(crate) fn model(scene: &Scene, reactions: &[Reaction]) -> Result<Exact, StudyError> {
    let start = Start {
        q: scene.assembly.start.clone(),
        rough: scene.assembly.rough.clone(),
    };
    let model = Model::new(&scene.mechanism, &scene.masses, &start, reactions)
        .map_err(|e| explain_model(scene, &e))?;
    Exact::new(model).ok_or_else(|| not_one_actuator(scene))
}

impl<'a> Prepared<'a> {
    /// Compiles what a scene requests.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together or does not have one
    /// degree of freedom.
    pub fn new(scene: &'a Scene) -> Result<Self, StudyError> {
        let model = model(scene, &scene.requests.reactions)?;
        Ok(Self { scene, model })
    }

    /// Compiles what a scene requests, for those who show an angle and know no loads.
    ///
    /// # Errors
    /// As [`Prepared::new`]; where a length is driven, or (for a motion, which they would change)
    /// where there are loads.
    pub(crate) fn for_angle(scene: &'a Scene, motion: bool) -> Result<Self, StudyError> {
        let prepared = Self::new(scene)?;
        let label = |place, word: &str| [(place, word.to_owned())];
        if !prepared.model.model().plan().is_angle(0) {
            return Err(scene
                .error(
                    "the reduced model of a driven length cannot be shown yet".to_owned(),
                    Some(
                        "`dwell kinetostatics` knows driven lengths; or drive an angle".to_owned(),
                    ),
                    &label(Place::Actuator(ActuatorId(0)), "drives a length"),
                )
                .into());
        }
        if motion && !scene.loads.is_empty() {
            return Err(scene
                .error(
                    "loads do not act in a free motion yet".to_owned(),
                    Some("`dwell kinetostatics` knows loads, along a prescribed motion".to_owned()),
                    &label(Place::Load(0), "this load would be left out"),
                )
                .into());
        }
        Ok(prepared)
    }

    /// The name of the coordinate.
    pub fn coordinate(&self) -> &str {
        &self.scene.mechanism.actuators[0].name
    }

    /// Names and units (of a force or a moment) of the requested reactions.
    pub fn reactions(&self) -> Vec<(String, &'static str)> {
        let mechanism = &self.scene.mechanism;
        let named = |&r: &Reaction| (mechanism.reaction_name(r), r.component.unit());
        self.scene.requests.reactions.iter().map(named).collect()
    }

    /// Where the free motion starts, if the scene has one.
    pub fn start(&self) -> Option<State> {
        let motion = self.scene.motion.as_ref()?;
        Some(State {
            t: 0.0,
            q: motion.start[0],
            q_dot: motion.speed[0],
        })
    }

    /// `count` + 1 equally spaced coordinates over the range, rad: over a turn from 0, or between
    /// the limit positions, of which a thousandth is left out where everything grows.
    pub fn sweep(&self, count: usize) -> Vec<f64> {
        let (from, to) = match self.model.range().limits() {
            None => (0.0, TAU),
            Some((from, to)) => {
                let margin = 1e-3 * (to - from);
                (from + margin, to - margin)
            }
        };
        let at = |i: usize| from + (to - from) * i as f64 / count as f64;
        (0..=count).map(at).collect()
    }
}

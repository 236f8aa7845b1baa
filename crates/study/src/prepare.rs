//! A scene made ready: its exact reduced model for what it requests.

use crate::error::{StudyError, explain_model, not_one_actuator};
use dwell_dynamics::State;
use dwell_geometry::{ActuatorId, BodyId, Plan, Reaction};
use dwell_kinetostatics::{Exact, Model, Reduced};
use dwell_scene::{Place, Scene};
use std::collections::HashSet;
use std::f64::consts::TAU;

/// A scene and the reduced model of what it requests.
#[derive(Debug)]
pub struct Prepared<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The model, with the requested reactions that the loads determine in the order of the scene.
    pub model: Exact,
}

/// A model of a scene for some reactions.
pub(crate) fn compiled(scene: &Scene, reactions: &[Reaction]) -> Result<Model, StudyError> {
    let start = scene.assembly.to_start();
    Model::new(&scene.mechanism, &scene.masses, &start, reactions)
        .map_err(|e| explain_model(scene, &e))
}

/// A reduced model of a scene for some reactions.
pub(crate) fn model(scene: &Scene, reactions: &[Reaction]) -> Result<Exact, StudyError> {
    Exact::new(compiled(scene, reactions)?).ok_or_else(|| not_one_actuator(scene))
}

/// The requested reactions that the loads do not determine: no result of any command.
pub(crate) fn shared(scene: &Scene, plan: &Plan) -> HashSet<Reaction> {
    let all = scene.mechanism.reactions().into_iter().enumerate();
    all.filter(|&(k, _)| !plan.is_unique(k))
        .map(|(_, reaction)| reaction)
        .filter(|reaction| scene.requests.reactions.contains(reaction))
        .collect()
}

/// A model of a scene for the requested reactions that the loads determine.
pub(crate) fn determined(scene: &Scene) -> Result<Model, StudyError> {
    let requested = &scene.requests.reactions;
    let model = compiled(scene, requested)?;
    let shared = shared(scene, model.plan());
    if shared.is_empty() {
        return Ok(model);
    }
    let mut left = requested.clone();
    left.retain(|reaction| !shared.contains(reaction));
    model
        .for_reactions(&scene.mechanism, &left)
        .map_err(|e| explain_model(scene, &e))
}

impl<'a> Prepared<'a> {
    /// Compiles what a scene requests.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together or does not have one
    /// degree of freedom.
    pub fn new(scene: &'a Scene) -> Result<Self, StudyError> {
        Self::of(scene, determined(scene)?)
    }

    fn of(scene: &'a Scene, model: Model) -> Result<Self, StudyError> {
        let model = Exact::new(model).ok_or_else(|| not_one_actuator(scene))?;
        Ok(Self { scene, model })
    }

    /// Compiles what a scene requests, and no group that neither inertia nor a requested reaction
    /// needs, for those who show an angle and know no loads.
    ///
    /// # Errors
    /// As [`Prepared::new`]; where a length is driven, or (for a motion, which they would change)
    /// where there are loads.
    pub(crate) fn for_angle(scene: &'a Scene, motion: bool) -> Result<Self, StudyError> {
        let model = determined(scene)?;
        let lean = model.only_for(&scene.mechanism, &reacting(scene));
        let prepared = Self::of(scene, lean)?;
        let label = |place, word: &str| [(place, word.to_owned())];
        if !prepared.model.model().plan().is_angle(0) {
            return Err(scene
                .error(
                    "the reduced model is shown for driven angles alone".to_owned(),
                    Some(
                        "`dwell simulate` and `kinetostatics` know driven lengths; or drive an angle".to_owned(),
                    ),
                    &label(Place::Actuator(ActuatorId(0)), "drives a length"),
                )
                .into());
        }
        if motion && !scene.loads.is_empty() {
            return Err(scene
                .error(
                    "a value is fitted to the period of a motion without loads".to_owned(),
                    Some("leave the loads out, or try values with `dwell simulate`".to_owned()),
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

    /// Names and units (of a force or a moment) of the reactions of the model.
    pub fn reactions(&self) -> Vec<(String, &'static str)> {
        let mechanism = &self.scene.mechanism;
        let named = |&r: &Reaction| (mechanism.reaction_name(r), r.component.unit());
        let reactions = self.model.model().reactions();
        reactions.iter().map(named).collect()
    }

    /// What a summary says of the requested reactions that are in no table.
    pub(crate) fn told_shared(&self) -> String {
        let shared = shared(self.scene, self.model.model().plan());
        let asked = self.scene.requests.reactions.iter();
        let names = asked.filter(|r| shared.contains(r));
        not_in_a_table(names.map(|&r| self.scene.mechanism.reaction_name(r)))
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

/// The bodies of the joints whose reactions are requested.
pub(crate) fn reacting(scene: &Scene) -> Vec<BodyId> {
    let joints = scene.requests.reactions.iter();
    let joints = joints.map(|r| &scene.mechanism.joints[r.joint.0]);
    joints.flat_map(|joint| joint.bodies).collect()
}

/// The line of a summary that names the reactions which the loads do not determine.
pub(crate) fn not_in_a_table(names: impl Iterator<Item = String>) -> String {
    let names: Vec<String> = names.collect();
    if names.is_empty() {
        return String::new();
    }
    format!(
        "  in no table, because constraints that repeat each other share them: {}\n",
        names.join(", ")
    )
}

//! Which columns of an analysis a scene requests: what it does not is neither kept, searched for extrema, written nor
//! drawn.
//!
//! A scene that lists `variables` requests these, and the reactions that it lists. One that lists only `reactions`
//! requests, of an analysis of forces, these, the coordinates and forces of its actuators, its paths and its dwell; and
//! of a free motion what only its integration yields. Every other scene requests everything.

use crate::trajectory::compute::{Analysis, Column, Quantity};
use dwell_geometry::{BodyId, JointId, Reaction, Vec2};
use dwell_scene::PlaneScene;

/// The columns that an analysis of a scene yields.
#[derive(Clone, Copy)]
pub(crate) struct RequestedColumns<'a> {
    scene: &'a PlaneScene,
    /// The reactions of the model, to which the columns refer.
    reactions: &'a [Reaction],
    /// Whether there is a list at all.
    is_limited: bool,
}

impl<'a> RequestedColumns<'a> {
    pub(crate) fn new(
        scene: &'a PlaneScene,
        reactions: &'a [Reaction],
        analysis: Analysis,
    ) -> Self {
        let requests = &scene.requests;
        let lists_reactions = requests.lists_reactions && analysis != Analysis::Kinematics;
        Self {
            scene,
            reactions,
            is_limited: requests.variables.is_some() || lists_reactions,
        }
    }

    /// Whether the scene requests less than everything.
    pub(crate) fn is_limited(self) -> bool {
        self.is_limited
    }

    /// Whether a column is in the tables.
    pub(crate) fn are_with(self, column: &Column) -> bool {
        let quantity = column.quantity;
        !self.is_limited
            || matches!(
                quantity,
                Quantity::Time | Quantity::ActuatorCoordinate(_, 0)
            )
            || is_requested(self.scene, column)
            || self.is_of_listed_reaction(quantity)
            || (self.scene.requests.variables.is_none() && self.goes_with_reactions(quantity))
    }

    /// Whether a column is needed for pictures.
    pub(crate) fn draw(self, column: &Column) -> bool {
        matches!(column.quantity, Quantity::PointCoordinate(body, at, _) if self.is_path(body, at))
    }

    /// Whether it is a listed reaction, or a force of a joint all of whose reactions are listed.
    fn is_of_listed_reaction(self, quantity: Quantity) -> bool {
        let requests = &self.scene.requests;
        if !requests.lists_reactions {
            return false;
        }
        let is_listed_whole = |joint: JointId| {
            let components = self.scene.mechanism.components(joint).iter();
            let mut reactions = components.map(|&component| Reaction { joint, component });
            reactions.all(|reaction| requests.reactions.contains(&reaction))
        };
        match quantity {
            Quantity::Reaction(k) => requests.reactions.contains(&self.reactions[k]),
            Quantity::BodyFrameForce(joint, ..)
            | Quantity::ForceMagnitude(joint)
            | Quantity::ForceDirection(joint) => is_listed_whole(joint),
            Quantity::LoadForce(k) => {
                let teeth = self.scene.loads[k].pressure_angle();
                teeth.is_some_and(|teeth| is_listed_whole(teeth.joint))
            }
            _ => false,
        }
    }

    /// Whether a scene that lists reactions, and no variables, gets it as well.
    fn goes_with_reactions(self, quantity: Quantity) -> bool {
        let dwell = self.scene.requests.dwell.as_ref();
        match quantity {
            Quantity::ActuatorCoordinate(..)
            | Quantity::ActuatorForce(_)
            | Quantity::KnownReaction(..)
            | Quantity::Extra(_) => true,
            Quantity::BodyAngle(body, _) => dwell.is_some_and(|dwell| dwell.body == body),
            Quantity::PointCoordinate(body, at, _) => self.is_path(body, at),
            _ => false,
        }
    }

    fn is_path(self, body: BodyId, at: Vec2) -> bool {
        let mut paths = self.scene.requests.paths.iter();
        paths.any(|path| path.body == body && path.at == at)
    }
}

/// Whether a scene requests a column by name.
pub(crate) fn is_requested(scene: &PlaneScene, column: &Column) -> bool {
    let names = scene.requests.variables.iter().flatten();
    names.into_iter().any(|n| column.matches(n))
}

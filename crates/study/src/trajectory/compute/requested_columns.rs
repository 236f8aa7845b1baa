//! The columns of an analysis that a scene requests. Other columns are not stored, searched for extrema, written or
//! drawn.
//!
//! A scene that lists `variables` requests these, and the reactions that it lists. One that lists only `reactions`
//! requests, of an analysis of forces, these, the coordinates and forces of its actuators, its paths and its dwell; and
//! of a free motion the columns that only its integration yields. Every other scene requests everything.

use crate::trajectory::compute::{Analysis, Column, ColumnRequests, Quantity, RowScene};

/// The columns that an analysis of a scene yields.
pub(crate) struct RequestedColumns<'a, S: RowScene> {
    scene: &'a S,
    rows: &'a S::Rows,
    requests: ColumnRequests<'a>,
    /// Whether there is a list at all.
    pub(crate) is_limited: bool,
}

impl<'a, S: RowScene> RequestedColumns<'a, S> {
    pub(crate) fn new(scene: &'a S, rows: &'a S::Rows, analysis: Analysis) -> Self {
        let requests = scene.requests();
        let lists_reactions = requests.lists_reactions && analysis != Analysis::Kinematics;
        Self {
            scene,
            rows,
            is_limited: requests.variables.is_some() || lists_reactions,
            requests,
        }
    }

    /// Whether a column is in the tables.
    pub(crate) fn are_with(&self, column: &Column) -> bool {
        let (quantity, requests) = (column.quantity, &self.requests);
        !self.is_limited
            || matches!(
                quantity,
                Quantity::Time | Quantity::ActuatorCoordinate(_, 0)
            )
            || requests.name(column)
            || (requests.lists_reactions && self.scene.is_of_listed_reaction(self.rows, quantity))
            || (requests.variables.is_none() && requests.goes_with_reactions(quantity))
    }

    /// Whether a column is needed for pictures.
    pub(crate) fn draw(&self, column: &Column) -> bool {
        S::LAYOUT.draws_paths && self.requests.is_of_path(column.quantity)
    }
}

impl ColumnRequests<'_> {
    /// Whether a column is requested by name.
    pub(crate) fn name(&self, column: &Column) -> bool {
        let mut names = self.variables.unwrap_or_default().iter();
        names.any(|name| column.matches(name))
    }

    /// Whether a scene that lists reactions, and no variables, gets it as well.
    fn goes_with_reactions(&self, quantity: Quantity) -> bool {
        match quantity {
            Quantity::ActuatorCoordinate(..)
            | Quantity::ActuatorForce(_)
            | Quantity::KnownReaction(..)
            | Quantity::Extra(_) => true,
            Quantity::Rotation(body, ..) => self.dwell == Some(body),
            _ => self.is_of_path(quantity),
        }
    }

    fn is_of_path(&self, quantity: Quantity) -> bool {
        matches!(quantity, Quantity::Point(body, at, ..) if self.paths.contains(&(body, at)))
    }
}

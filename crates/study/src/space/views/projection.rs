//! The shapes in a direction of view, the far parts first.

use super::direction::View;
use dwell_report::Shape;

/// Parts of a picture with their distances.
#[derive(Debug)]
pub(super) struct Picture {
    pub(super) view: View,
    parts: Vec<(f64, Vec<Shape>)>,
}

impl Picture {
    pub(super) fn new(view: View) -> Self {
        Self {
            view,
            parts: Vec::new(),
        }
    }

    /// Adds shapes that are as near as this.
    pub(super) fn add(&mut self, nearness: f64, shapes: Vec<Shape>) {
        self.parts.push((nearness, shapes));
    }

    /// All shapes, the farthest first; those of equal distance in the order in which they were added.
    pub(super) fn into_shapes(mut self) -> Vec<Shape> {
        self.parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.parts
            .into_iter()
            .flat_map(|(_, shapes)| shapes)
            .collect()
    }
}

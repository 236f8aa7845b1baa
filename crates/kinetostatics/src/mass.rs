//! The inertia of a body.

use dwell_geometry::Vec2;

/// Mass properties of one body, SI. A massless link has all of them zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mass {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the body's frame, m.
    pub center: Vec2,
    /// Moment of inertia about the centre of mass, kg m².
    pub inertia: f64,
}

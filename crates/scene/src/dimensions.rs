//! The plane and space: the types of a scene, and the notation of points and inertias.

use crate::keys::{TableSchema, table};
use crate::table_reader::TableReader;
use crate::units::Unit;
use crate::value::Value;
use dwell_geometry::Vec2;
use dwell_kinetostatics::Mass;
use std::fmt::Debug;
use std::hash::Hash;

/// The plane or space, as the types of the parts of a scene.
pub trait Dimensions: Clone + Debug + 'static {
    /// A point, m.
    type Point: Copy + Default + PartialEq + Debug;
    /// Mass, centre of mass and inertia.
    type Mass: Copy + Default + Debug;
    /// Bodies, joints and actuators.
    type Mechanism: Clone + Debug;
    /// Where and how the mechanism is put together at the start.
    type Assembly: Clone + Debug;
    /// A coordinate of a mechanism.
    type Coordinate: Copy + PartialEq + Debug;
    /// A component of the action of a joint's first body on its second.
    type Reaction: Copy + Eq + Hash + Debug;
    /// The shape of a load.
    type LoadKind: Clone + Debug;
}

/// The plane.
#[derive(Debug, Clone)]
pub enum Plane {}

/// Space.
#[derive(Debug, Clone)]
pub enum Space {}

/// How points and inertias are written in the plane or in space.
pub(crate) trait Notation: Dimensions {
    /// The suffix of the ids of tables that differ from those of the plane.
    const SUFFIX: &'static str;
    /// How a point is written.
    const POINT: &'static str;
    /// The notation of the origin.
    const ORIGIN: &'static str;

    /// A point, in m.
    fn point(value: Value<'_>, what: &str) -> Option<Self::Point>;

    /// A mass (kg) with its centre and the inertia that a body's table gives.
    fn mass(mass: f64, center: Self::Point, fields: &TableReader<'_>) -> Self::Mass;

    /// The description of a table.
    fn table(id: &str) -> &'static TableSchema {
        table(&format!("{id}{}", Self::SUFFIX))
    }
}

impl Notation for Plane {
    const SUFFIX: &'static str = "";
    const POINT: &'static str = "[x, y]";
    const ORIGIN: &'static str = "[0, 0]";

    fn point(value: Value<'_>, what: &str) -> Option<Vec2> {
        value.point(what)
    }

    fn mass(mass: f64, center: Vec2, fields: &TableReader<'_>) -> Mass {
        let inertia = mass_or_inertia(fields, "inertia", &fields.units().inertia);
        Mass {
            mass,
            center,
            inertia: inertia.unwrap_or(0.0),
        }
    }
}

/// A mass or an inertia, in SI: not negative.
pub(crate) fn mass_or_inertia(fields: &TableReader<'_>, key: &str, unit: &Unit) -> Option<f64> {
    let value = fields.get(key)?.value;
    let what = format!("{key} of {}", fields.what);
    let si = value.quantity(unit, &what)?;
    if si < 0.0 {
        let message = format!("the {what} is negative");
        return value.reject(message, "expected 0 or more", "");
    }
    Some(si)
}

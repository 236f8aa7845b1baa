//! What differs between bodies in the plane and in space: how points and inertias are written.

use crate::table_reader::TableReader;
use crate::units::Unit;
use crate::value::Value;
use dwell_geometry::Vec2;
use dwell_kinetostatics::Mass;
use std::fmt::Debug;

/// The plane or space.
pub(crate) trait Dimensions: Debug + 'static {
    /// A point, m.
    type Point: Copy + Default + Debug;
    /// Mass, centre of mass and inertia.
    type Mass: Copy + Default + Debug;
    /// The id of a body's table in the description of the keys.
    const BODY: &'static str;
    /// How a point is written.
    const POINT: &'static str;
    /// The origin as it is written.
    const ORIGIN: &'static str;

    /// A point, in m.
    fn point(value: Value<'_>, what: &str) -> Option<Self::Point>;

    /// A mass (kg) with its centre and the inertia that a body's table gives.
    fn mass(mass: f64, center: Self::Point, fields: &TableReader<'_>) -> Self::Mass;
}

/// The plane.
#[derive(Debug)]
pub(crate) enum Plane {}

impl Dimensions for Plane {
    type Point = Vec2;
    type Mass = Mass;
    const BODY: &'static str = "body";
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

//! Units of a scene. They are converted once, here, and everything after is SI.

use crate::diagnostics::Span;
use std::f64::consts::PI;

/// A unit as a ratio to SI. Two numbers rather than one: 200 mm is then 200 / 1000, the very
/// number that 0.2 m is, while 200 × 0.001 is not.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unit {
    pub(crate) name: String,
    pub(crate) factor: f64,
    pub(crate) divisor: f64,
}

/// A unit of SI, whatever its name.
pub(crate) static SI: Unit = Unit {
    name: String::new(),
    factor: 1.0,
    divisor: 1.0,
};

impl Unit {
    pub(crate) fn new(name: &str, factor: f64, divisor: f64) -> Self {
        Self {
            name: name.to_owned(),
            factor,
            divisor,
        }
    }

    /// `value` of this unit, in SI.
    pub(crate) fn to_si(&self, value: f64) -> f64 {
        value * self.factor / self.divisor
    }

    /// A number in SI as one of this unit.
    pub(crate) fn to_scene_unit(&self, si: f64) -> f64 {
        si * self.divisor / self.factor
    }
}

/// (name, factor, divisor). All the factors are exact: the inch is 25.4 mm (1959), the pound
/// 0.453 592 37 kg, the ounce a sixteenth of it.
pub(crate) type KnownUnit = (&'static str, f64, f64);
pub(crate) const LENGTHS: [KnownUnit; 7] = [
    ("m", 1.0, 1.0),
    ("mm", 1.0, 1e3),
    ("cm", 1.0, 1e2),
    ("um", 1.0, 1e6),
    ("km", 1e3, 1.0),
    ("in", 254.0, 1e4),
    ("ft", 3048.0, 1e4),
];
pub(crate) const MASSES: [KnownUnit; 5] = [
    ("kg", 1.0, 1.0),
    ("g", 1.0, 1e3),
    ("t", 1e3, 1.0),
    ("lb", 45_359_237.0, 1e8),
    ("oz", 45_359_237.0, 16e8),
];
pub(crate) const ANGLES: [KnownUnit; 2] = [("rad", 1.0, 1.0), ("deg", PI, 180.0)];

/// The units of one scene.
#[derive(Debug, Clone)]
pub(crate) struct Units {
    pub(crate) length: Unit,
    pub(crate) mass: Unit,
    pub(crate) inertia: Unit,
    pub(crate) angle: Unit,
    /// The place of a unit other than SI's that requires an inertia unit, if there is none.
    pub(crate) missing_inertia_unit: Option<Span>,
}

impl Default for Units {
    fn default() -> Self {
        Self {
            length: Unit::new("m", 1.0, 1.0),
            mass: Unit::new("kg", 1.0, 1.0),
            inertia: Unit::new("kg m2", 1.0, 1.0),
            angle: Unit::new("rad", 1.0, 1.0),
            missing_inertia_unit: None,
        }
    }
}

impl Units {
    /// The unit of an angle, or of a length.
    pub(crate) fn coordinate_unit(&self, is_angle: bool) -> &Unit {
        if is_angle { &self.angle } else { &self.length }
    }
}

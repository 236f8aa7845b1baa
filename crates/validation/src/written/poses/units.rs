//! The units of a scene's numbers, by factors of their own, as the international definitions give them.

use toml::{Table, Value};

/// The units in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    pub(crate) length: f64,
    pub(crate) mass: f64,
    pub(crate) inertia: f64,
    pub(crate) angle: f64,
}

/// Lengths in m: the inch is 25.4 mm.
pub(crate) const LENGTHS: [(&str, f64); 7] = [
    ("m", 1.0),
    ("mm", 0.001),
    ("cm", 0.01),
    ("um", 0.000_001),
    ("km", 1000.0),
    ("in", 0.0254),
    ("ft", 0.3048),
];
/// Masses in kg: the pound is 0.453 592 37 kg, the ounce a sixteenth of it.
pub(crate) const MASSES: [(&str, f64); 5] = [
    ("kg", 1.0),
    ("g", 0.001),
    ("t", 1000.0),
    ("lb", 0.453_592_37),
    ("oz", 0.453_592_37 / 16.0),
];
/// Angles in rad.
pub(crate) const ANGLES: [(&str, f64); 2] = [("rad", 1.0), ("deg", std::f64::consts::PI / 180.0)];

fn factor(of: &[(&str, f64)], name: &str) -> Option<f64> {
    of.iter()
        .find(|(known, _)| *known == name)
        .map(|(_, factor)| *factor)
}

impl Units {
    /// The units of a scene; none if one is unknown.
    pub(crate) fn read(scene: &Table) -> Option<Self> {
        let units = scene.get("units").and_then(Value::as_table);
        let text = |key: &str| units.and_then(|u| u.get(key)).and_then(Value::as_str);
        let inertia = text("inertia").unwrap_or("kg m2");
        let (mass, length) = inertia.split_once(' ')?;
        let length = length.trim_end_matches(['2', '²', '^']);
        Some(Self {
            length: factor(&LENGTHS, text("length").unwrap_or("m"))?,
            mass: factor(&MASSES, text("mass").unwrap_or("kg"))?,
            inertia: factor(&MASSES, mass)? * factor(&LENGTHS, length)?.powi(2),
            angle: factor(&ANGLES, text("angle").unwrap_or("rad"))?,
        })
    }
}

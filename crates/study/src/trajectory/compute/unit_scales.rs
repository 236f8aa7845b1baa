//! Reference sizes of the quantities of each unit along a trajectory. Relative to them, some quantities are zero within
//! rounding.
//!
//! All quantities of a unit may be zero within rounding, such as the only moment of a mechanism. Therefore the
//! reference of a unit also includes the others, converted by the size of the mechanism: a moment of 3e-16 N m is
//! negligible relative to forces of 10 N at 0.5 m.

use crate::estimate::is_rounding;
use crate::trajectory::compute::{Column, Quantity};
use std::collections::BTreeMap;

/// By unit: the reference relative to which a quantity is zero within rounding.
#[derive(Debug, Clone, Default)]
pub(crate) struct UnitScales(BTreeMap<&'static str, f64>);

/// The references of a quantity of points and of the same of angles, each by the other over an arm (m).
fn with_arm(arm: f64, [of_points, of_angles]: [f64; 2]) -> [f64; 2] {
    if arm > 0.0 {
        let largest = of_points.max(arm * of_angles);
        [largest, largest / arm]
    } else {
        [of_points, of_angles]
    }
}

/// The references of forces (N) and of moments (N m), each by the other over an arm (m) and by the centripetal force of
/// a kinetic energy (J).
pub(crate) fn force_scales(arm: f64, [force, moment]: [f64; 2], kinetic: f64) -> [f64; 2] {
    if arm > 0.0 {
        let force = force.max(moment.max(kinetic) / arm);
        [force, force * arm]
    } else {
        [force, moment]
    }
}

impl UnitScales {
    /// Whether the references depend on the columns of a unit.
    pub(crate) fn depend_on(unit: &str) -> bool {
        matches!(
            unit,
            "m/s" | "rad/s" | "m/s2" | "rad/s2" | "N" | "N m" | "W" | "J"
        )
    }

    /// The scales from the columns of a trajectory, each with its largest magnitude; `size` is that of the mechanism,
    /// m.
    pub(crate) fn new(columns: &[(&Column, f64)], size: f64) -> Self {
        let of_unit = |unit: &str| {
            let alike = columns.iter().filter(|(column, _)| column.unit == unit);
            alike.fold(0.0_f64, |scale, &(_, value)| scale.max(value))
        };
        let is_kinetic = |column: &Column| column.quantity == Quantity::Power(4);
        let kinetic = columns.iter().find(|(column, _)| is_kinetic(column));
        let kinetic = kinetic.map_or(0.0, |&(_, value)| value);
        let [velocity, angular] = with_arm(size, ["m/s", "rad/s"].map(of_unit));
        // Centripetal, by what rotates: a point far outside the mechanism is faster, and no measure of it.
        let centripetal = of_unit("rad/s").powi(2);
        let [acceleration, angular_acceleration] =
            with_arm(size, [of_unit("m/s2"), of_unit("rad/s2").max(centripetal)]);
        let [force, moment] = force_scales(size, ["N", "N m"].map(of_unit), kinetic);
        let power = of_unit("W").max(force * velocity);
        Self(BTreeMap::from([
            ("m", size),
            ("rad", 1.0),
            ("m/s", velocity),
            ("rad/s", angular),
            ("m/s2", acceleration),
            ("rad/s2", angular_acceleration),
            ("N", force),
            ("N m", moment),
            ("W", power),
            ("J", of_unit("J")),
        ]))
    }

    /// Whether a quantity whose largest magnitude is `size` is zero within rounding.
    pub(crate) fn is_rounding(&self, unit: &str, size: f64) -> bool {
        size == 0.0 || is_rounding(size, self.of(unit))
    }

    /// The reference of a unit; zero if there is none.
    pub(crate) fn of(&self, unit: &str) -> f64 {
        self.0.get(unit).copied().unwrap_or(0.0)
    }
}

//! Reads a reference of 25 digits: samples of the reduced parameters, and periods of free motions.

use crate::error::ValidationError;
use dwell_geometry::space::{Placement, Rotation, vec3};
use dwell_laws::Expression;
use serde_json::Value;
use std::path::Path;

/// A reference with its samples.
pub(super) struct Reference {
    data: Value,
}

/// A free motion of the reference.
pub(super) struct ReferenceMotion {
    /// Whether the loads of the scene act.
    pub(super) is_loaded: bool,
    /// Coordinate (rad) and speed (rad/s) at its start.
    pub(super) start: [f64; 2],
    /// Its period, s.
    pub(super) period: f64,
}

/// A number, or an exact expression.
fn number(value: &Value) -> Option<f64> {
    let text = match value {
        Value::Number(number) => return number.as_f64(),
        Value::String(text) => text,
        _ => return None,
    };
    let parsed = text.parse().ok();
    parsed.or_else(|| {
        let expression = Expression::parse(&text.replace("**", "^"), &[]);
        Some(expression.ok()?.eval(&[]))
    })
}

/// Three numbers.
fn vector(value: &Value) -> Option<[f64; 3]> {
    let [x, y, z] = value.as_array()?.as_slice() else {
        return None;
    };
    Some([number(x)?, number(y)?, number(z)?])
}

impl Reference {
    /// The reference in a file.
    pub(super) fn read(path: &Path) -> Result<Self, ValidationError> {
        let fault = |reason: String| ValidationError::Reference {
            path: path.display().to_string(),
            reason,
        };
        let text = std::fs::read_to_string(path).map_err(|e| fault(e.to_string()))?;
        let data = serde_json::from_str(&text).map_err(|e| fault(e.to_string()))?;
        Ok(Self { data })
    }

    /// Where it comes from.
    pub(super) fn source(&self) -> &str {
        self.data["source"].as_str().unwrap_or_default()
    }

    /// Its samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = Sample<'_>> {
        let all = self.data["samples"].as_array();
        all.into_iter().flatten().map(|data| Sample { data })
    }

    /// Of a mechanism with several coordinates: the times of the motion of the scene, s, with the coordinates there, rad or m.
    pub(super) fn coordinates(&self) -> Vec<(f64, Vec<f64>)> {
        let read = |state: &Value| {
            let coordinates = state["q"].as_array()?.iter().map(number);
            Some((
                number(&state["t"])?,
                coordinates.collect::<Option<Vec<f64>>>()?,
            ))
        };
        let all = self.data["motion"]["states"].as_array();
        all.into_iter().flatten().filter_map(read).collect()
    }

    /// Of a mechanism with two coordinates: its samples.
    pub(super) fn of_two_coordinates(&self) -> impl Iterator<Item = SampleOfTwo<'_>> {
        let is_of_two = self.data.get("two_coordinates").is_some();
        let all = self.data["samples"].as_array().filter(|_| is_of_two);
        all.into_iter().flatten().map(|data| SampleOfTwo { data })
    }

    /// Its free motions whose start is given by coordinate and speed.
    pub(super) fn motions(&self) -> Vec<ReferenceMotion> {
        let read = |motion: &Value| {
            let is_loaded = match motion["loads"].as_str()? {
                "none" => false,
                "as defined" => true,
                _ => return None,
            };
            Some(ReferenceMotion {
                is_loaded,
                start: [number(&motion["q0"])?, number(&motion["qdot0"])?],
                period: number(&motion["period_s"])?,
            })
        };
        let all = self.data["free_motion"].as_array();
        all.into_iter().flatten().filter_map(read).collect()
    }
}

/// The reference at one position.
pub(super) struct Sample<'a> {
    data: &'a Value,
}

impl Sample<'_> {
    /// A number by its name: q, m or ½m′.
    pub(super) fn number(&self, name: &str) -> Option<f64> {
        number(&self.data[name])
    }

    /// Where a body is.
    pub(super) fn placement(&self, body: &str) -> Option<Placement> {
        let body = &self.data["bodies"][body];
        let [x, y, z] = vector(&body["position"])?;
        let [one, two, three] = body["rotation_rows"].as_array()?.as_slice() else {
            return None;
        };
        let rows = [vector(one)?, vector(two)?, vector(three)?];
        Some(Placement {
            position: vec3(x, y, z),
            rotation: Rotation::of_rows(rows)?,
        })
    }

    /// w of the whole weight.
    pub(super) fn weight(&self) -> Option<f64> {
        number(&self.data["w"]["gravity"])
    }

    /// a, b and c of the whole weight of a reaction, of which each may be missing.
    pub(super) fn reaction(&self, name: &str) -> [Option<f64>; 3] {
        let reaction = &self.data["reactions"][reference_name(name)];
        let c = &reaction["c"]["gravity"];
        [&reaction["a"], &reaction["b"], c].map(number)
    }
}

/// The reference's name of a component: `P0.Mx` of `P0.moment-x`.
fn reference_name(column: &str) -> String {
    let (joint, component) = column.split_once('.').unwrap_or((column, ""));
    let axis = component.chars().last().unwrap_or('x');
    let letter = match component.starts_with("moment") {
        true => 'M',
        false => 'F',
    };
    format!("{joint}.{letter}{axis}")
}

/// The reference at one position of two coordinates, b and s.
pub(super) struct SampleOfTwo<'a> {
    data: &'a Value,
}

/// A value by what each product of rates, or the weight, gives it.
fn combined(parts: &Value, [q_dot, q_ddot]: [&[f64]; 2]) -> Option<f64> {
    let ([b, s], [b2, s2]) = (q_dot, q_ddot) else {
        return None;
    };
    let products = [
        ("b''", *b2),
        ("s''", *s2),
        ("b'b'", b * b),
        ("s's'", s * s),
        ("b's'", b * s),
    ];
    products.into_iter().try_fold(0.0, |sum, (name, product)| {
        Some(sum + number(&parts[name])? * product)
    })
}

impl SampleOfTwo<'_> {
    /// Its coordinates, rad.
    pub(super) fn coordinates(&self) -> Option<[f64; 2]> {
        Some([number(&self.data["beta"])?, number(&self.data["sigma"])?])
    }

    /// The generalised inertias, row by row.
    pub(super) fn inertias(&self) -> Option<[f64; 4]> {
        let [b, mixed, s] = ["M_bb", "M_bs", "M_ss"].map(|name| number(&self.data[name]));
        Some([b?, mixed?, mixed?, s?])
    }

    /// The actuators' actions under the weight at speeds and accelerations.
    pub(super) fn actions(&self, rates: [&[f64]; 2]) -> Option<[f64; 2]> {
        let of = |name: &str| {
            let parts = &self.data["generalised_inertia_forces"][format!("tau_{name}")];
            let weight = number(&self.data["w_gravity"][name])?;
            Some(combined(parts, rates)? - weight)
        };
        Some([of("beta")?, of("sigma")?])
    }

    /// The components of the reactions under the weight at speeds and accelerations: joint, number of the component, value.
    pub(super) fn reactions(&self, rates: [&[f64]; 2]) -> Vec<(String, usize, f64)> {
        let all = self.data["reactions"].as_object();
        let read = |(name, parts): (&'_ String, &Value)| {
            let (joint, component) = name.split_once('.')?;
            let of = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"];
            let component = of.iter().position(|of| *of == component)?;
            let value = combined(parts, rates)? + number(&parts["gravity"])?;
            Some((joint.to_owned(), component, value))
        };
        all.into_iter().flatten().filter_map(read).collect()
    }
}

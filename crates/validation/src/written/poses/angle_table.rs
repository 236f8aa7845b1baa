//! A moment of inertia over the angle of its body, read from the scene's text once more, and evaluated otherwise than the
//! program does: a whole revolution by barycentric weights (Henrici 1979) of the values themselves, part of one by Hermite's
//! four cubic polynomials.

use super::law::number;
use super::units::Units;
use std::f64::consts::TAU;
use toml::{Table, Value};

/// The lists of a table over the angle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AngleTable {
    angles: Vec<f64>,
    inertia: Vec<f64>,
    half_slope: Vec<f64>,
    is_series: bool,
    pub(crate) reactions: Vec<AngleReaction>,
}

/// A reaction over the angle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AngleReaction {
    pub(crate) name: String,
    is_moment: bool,
    /// a and b.
    lists: [Vec<f64>; 2],
}

/// A reaction at an angle.
pub(crate) struct ReactionAt<'a> {
    pub(crate) name: &'a str,
    pub(crate) is_moment: bool,
    /// Of the angular acceleration.
    pub(crate) a: f64,
    /// a α + b ω².
    pub(crate) value: f64,
}

impl AngleTable {
    /// The table of a body; none where it has none, or no half slope: then there is nothing to compare with.
    pub(crate) fn read(body: &Table, units: &Units) -> Option<Self> {
        let table = body.get("varying-inertia")?.as_table()?;
        let list = |table: &Table, key: &str, unit: f64| -> Option<Vec<f64>> {
            let all = table.get(key)?.as_array()?.iter();
            all.map(|value| Some(number(Some(value))? * unit)).collect()
        };
        let mut angles = list(table, "angle", units.angle)?;
        let count = angles.len();
        let step = angles.get(1)? - angles[0];
        let ends_twice = (angles[count - 1] - angles[0] - TAU).abs() < 1e-6 * step;
        let rows = if ends_twice { count - 1 } else { count };
        let equal = |k: usize| (angles[k] - angles[0] - TAU * k as f64 / rows as f64).abs();
        let is_whole = (0..rows).all(|k| equal(k) < 1e-6 * step);
        let named = table.get("interpolation").and_then(Value::as_str);
        angles.truncate(rows);
        let cut = |mut values: Vec<f64>| {
            values.truncate(rows);
            values
        };
        let reactions = table.get("reactions").and_then(Value::as_table);
        let reaction = |(name, of): (&String, &Value)| {
            let of = of.as_table()?;
            let lists = [list(of, "a", 1.0)?, list(of, "b", 1.0)?];
            Some(AngleReaction {
                name: name.clone(),
                is_moment: of.get("unit")?.as_str()? == "N m",
                lists: lists.map(cut),
            })
        };
        Some(Self {
            inertia: cut(list(table, "inertia", units.inertia)?),
            half_slope: cut(list(table, "half-slope", units.inertia)?),
            reactions: reactions
                .into_iter()
                .flatten()
                .map(reaction)
                .collect::<Option<_>>()?,
            is_series: is_whole && named != Some("cubic"),
            angles,
        })
    }

    /// I and ½I′ at an angle.
    pub(crate) fn at(&self, angle: f64) -> [f64; 2] {
        match self.is_series {
            true => [
                self.series(&self.inertia, angle),
                self.series(&self.half_slope, angle),
            ],
            false => self.hermite(angle),
        }
    }

    /// a α + b ω² of each reaction; none where curves of unknown slopes are between the angles.
    pub(crate) fn reactions_at(&self, angle: f64, [omega, alpha]: [f64; 2]) -> Vec<ReactionAt<'_>> {
        let all = self.reactions.iter().filter(|_| self.is_series);
        all.map(|reaction| {
            let [a, b] = [0, 1].map(|k| self.series(&reaction.lists[k], angle));
            ReactionAt {
                name: &reaction.name,
                is_moment: reaction.is_moment,
                a,
                value: a * alpha + b * omega * omega,
            }
        })
        .collect()
    }

    /// The trigonometric interpolant of values at equal distances.
    fn series(&self, values: &[f64], angle: f64) -> f64 {
        let is_even = values.len().is_multiple_of(2);
        let mut sums = [0.0; 2];
        for (k, value) in values.iter().enumerate() {
            let half = 0.5 * (angle - self.angles[0] - TAU * k as f64 / values.len() as f64);
            let (sin, cos) = half.sin_cos();
            if sin.abs() < 1e-15 {
                return *value;
            }
            let weight = if is_even { cos / sin } else { 1.0 / sin };
            let weight = if k % 2 == 0 { weight } else { -weight };
            sums = [sums[0] + weight * value, sums[1] + weight];
        }
        sums[0] / sums[1]
    }

    fn hermite(&self, angle: f64) -> [f64; 2] {
        let last = self.angles.len() - 1;
        let middle = 0.5 * (self.angles[0] + self.angles[last]);
        let angle = angle - TAU * ((angle - middle) / TAU).round();
        let k = self
            .angles
            .iter()
            .rposition(|&at| at <= angle)
            .unwrap_or(0)
            .min(last - 1);
        let h = self.angles[k + 1] - self.angles[k];
        let u = (angle - self.angles[k]) / h;
        let (f, g) = (self.inertia[k], self.inertia[k + 1]);
        let (df, dg) = (
            2.0 * h * self.half_slope[k],
            2.0 * h * self.half_slope[k + 1],
        );
        let v = 1.0 - u;
        let value = f * v * v * (1.0 + 2.0 * u) + g * u * u * (3.0 - 2.0 * u) + df * u * v * v
            - dg * u * u * v;
        let slope = 6.0 * u * v * (g - f) + df * v * (1.0 - 3.0 * u) - dg * u * (2.0 - 3.0 * u);
        [value, 0.5 * slope / h]
    }
}

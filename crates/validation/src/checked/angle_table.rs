//! Reactions over the angle of a body of varying inertia, read from the scene's text once more, and evaluated otherwise than the program does:
//! by barycentric weights (Henrici 1979) of the values themselves.

use crate::written::poses::scene_text::number;
use crate::written::poses::units::Units;
use std::f64::consts::TAU;
use toml::{Table, Value};

/// The lists of a table over the angle.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AngleTable {
    angles: Vec<f64>,
    reactions: Vec<AngleReaction>,
}

/// A reaction over the angle.
#[derive(Debug, Clone, PartialEq)]
struct AngleReaction {
    name: String,
    is_moment: bool,
    /// a and b.
    lists: [Vec<f64>; 2],
}

/// A reaction at an angle.
pub(crate) struct ReactionAt<'a> {
    pub(crate) name: &'a str,
    pub(crate) is_moment: bool,
    /// a α + b ω².
    pub(crate) value: f64,
}

impl AngleTable {
    /// The table of a body; without reactions if curves of unknown slopes are between the angles, and none where the body has none.
    pub(crate) fn read(body: &Table, units: &Units) -> Option<Self> {
        let table = body.get("varying-inertia")?.as_table()?;
        let list = |table: &Table, key: &str| -> Option<Vec<f64>> {
            let all = table.get(key)?.as_array()?.iter();
            all.map(|value| number(Some(value))).collect()
        };
        let angles = list(table, "angle")?;
        let mut angles: Vec<f64> = angles.iter().map(|angle| angle * units.angle).collect();
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
            let lists = [list(of, "a")?, list(of, "b")?];
            Some(AngleReaction {
                name: name.clone(),
                is_moment: of.get("unit")?.as_str()? == "N m",
                lists: lists.map(cut),
            })
        };
        let is_series = is_whole && named != Some("cubic");
        let reactions = reactions.into_iter().flatten().filter(|_| is_series);
        Some(Self {
            reactions: reactions.map(reaction).collect::<Option<_>>()?,
            angles,
        })
    }

    /// a α + b ω² of each reaction.
    pub(crate) fn reactions_at(&self, angle: f64, [omega, alpha]: [f64; 2]) -> Vec<ReactionAt<'_>> {
        let all = self.reactions.iter();
        all.map(|reaction| {
            let [a, b] = [0, 1].map(|k| self.series(&reaction.lists[k], angle));
            ReactionAt {
                name: &reaction.name,
                is_moment: reaction.is_moment,
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
}

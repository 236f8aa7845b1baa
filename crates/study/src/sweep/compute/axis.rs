//! An axis of a sweep: one number of the scene over a grid, a list, or at random.

use crate::explain::SweepError;
use crate::ranges::extent;
use crate::sweep::compute::{normal, uniform};
use dwell_scene::SceneFile;

/// Maximum number of values of a grid.
const MAX_VALUES: u64 = 1_000_000;
const FORMS: &str = "write PATH=FROM:TO:COUNT, PATH=A,B,C, PATH~normal(MEAN,SD), PATH~uniform(FROM,TO), \
                     PATH±TOLERANCE or PATH±PERCENT%";

/// A number of the scene and how it varies, in the scene's own unit.
#[derive(Debug)]
pub(crate) struct Axis {
    pub(crate) path: String,
    pub(crate) unit: String,
    pub(crate) kind: VariationKind,
}

/// How a number varies.
#[derive(Debug)]
pub(crate) enum VariationKind {
    /// Equally spaced values, both ends included.
    Grid { from: f64, to: f64, count: u64 },
    /// A list of values.
    Listed(Vec<f64>),
    /// Normally distributed.
    Normal { mean: f64, deviation: f64 },
    /// Uniformly distributed between two values.
    Uniform { from: f64, to: f64 },
}

impl Axis {
    /// Reads an axis: a path of the scene, and how its number varies.
    ///
    /// # Errors
    /// [`SweepError::Axis`].
    pub(crate) fn parse(scene: &SceneFile, given: &str) -> Result<Self, SweepError> {
        Self::read(scene, given).map_err(|Fault(reason, help)| SweepError::Axis {
            option: "--vary",
            given: given.to_owned(),
            reason,
            help,
        })
    }

    fn read(scene: &SceneFile, given: &str) -> Result<Self, Fault> {
        let separators = ["=", "~", "±", "+-"].into_iter();
        let found = separators.filter_map(|s| Some((given.find(s)?, s)));
        let Some((at, separator)) = found.min_by_key(|(at, _)| *at) else {
            return Err(fault("the values to vary over are missing", FORMS));
        };
        let (path, variation) = (given[..at].trim(), given[at + separator.len()..].trim());
        let nominal = scene.value(path);
        let nominal = nominal.map_err(|e| Fault(e.message, e.help.unwrap_or_default()))?;
        let kind = match separator {
            "=" if variation.contains(':') => grid(variation)?,
            "=" => {
                VariationKind::Listed(variation.split(',').map(number).collect::<Result<_, _>>()?)
            }
            "~" => random(variation)?,
            _ => tolerance(nominal, variation)?,
        };
        Ok(Self {
            path: path.to_owned(),
            unit: scene.unit_of(path),
            kind,
        })
    }

    /// Whether it is random.
    pub(crate) fn is_random(&self) -> bool {
        use VariationKind::{Normal, Uniform};
        matches!(self.kind, Normal { .. } | Uniform { .. })
    }

    /// The range of its values; of a normal distribution a standard deviation about the mean, either way.
    pub(crate) fn span(&self) -> [f64; 2] {
        match &self.kind {
            VariationKind::Grid { from, to, .. } | VariationKind::Uniform { from, to } => {
                [*from, *to]
            }
            VariationKind::Listed(values) => extent(values.iter().copied()),
            VariationKind::Normal { mean, deviation } => [mean - deviation, mean + deviation],
        }
    }

    /// Number of values; 1 if it is random.
    pub(crate) fn count(&self) -> u64 {
        match &self.kind {
            VariationKind::Grid { count, .. } => *count,
            VariationKind::Listed(values) => values.len() as u64,
            VariationKind::Normal { .. } | VariationKind::Uniform { .. } => 1,
        }
    }

    /// Its value: the one at `index`, or if it is random that of a `sample` of axis `number`.
    pub(crate) fn value(&self, index: u64, seed: u64, number: u32, sample: u64) -> f64 {
        match &self.kind {
            // Exact at the end.
            VariationKind::Grid { to, count, .. } if index + 1 == *count => *to,
            VariationKind::Grid { from, to, count } => {
                from + (to - from) * index as f64 / (count - 1) as f64
            }
            // The index is below the count.
            VariationKind::Listed(values) => {
                values.get(index as usize).copied().unwrap_or(f64::NAN)
            }
            VariationKind::Normal { mean, deviation } => {
                mean + deviation * normal(seed, number, sample)
            }
            VariationKind::Uniform { from, to } => {
                let [fraction, _] = uniform(seed, number, sample);
                from * (1.0 - fraction) + to * fraction
            }
        }
    }
}

/// The fault of an axis, and a suggestion.
struct Fault(String, String);

fn fault(reason: impl Into<String>, help: &str) -> Fault {
    Fault(reason.into(), help.to_owned())
}

type Parsed = Result<VariationKind, Fault>;

fn number(text: &str) -> Result<f64, Fault> {
    let text = text.trim();
    let not_a_number = |_| fault(format!("`{text}` is not a number"), FORMS);
    let value: f64 = text.parse().map_err(not_a_number)?;
    if value.is_finite() {
        return Ok(value);
    }
    Err(fault(format!("{value} is not finite"), FORMS))
}

/// `FROM:TO:COUNT`, the ends among them.
fn grid(variation: &str) -> Parsed {
    let parts: Vec<&str> = variation.split(':').collect();
    let [from, to, count] = parts.as_slice() else {
        return Err(fault(format!("`{variation}` is not FROM:TO:COUNT"), FORMS));
    };
    let (from, to) = (number(from)?, number(to)?);
    let count: u64 = count.trim().parse().map_err(|_| {
        let reason = format!("`{}` is not a count of values", count.trim());
        fault(reason, "a whole number of 2 or more, the ends among them")
    })?;
    if !(2..=MAX_VALUES).contains(&count) {
        return Err(fault(
            format!("{count} values from {from} to {to}"),
            "a grid has from 2 to a million values, including both ends; write a single value as PATH=VALUE",
        ));
    }
    if from == to {
        let reason = format!("the range from {from} to {to} is empty");
        return Err(fault(reason, "write a single value as PATH=VALUE"));
    }
    Ok(VariationKind::Grid { from, to, count })
}

/// `normal(MEAN,SD)` or `uniform(FROM,TO)`.
fn random(variation: &str) -> Parsed {
    let inner = variation.strip_suffix(')');
    let inner = inner.and_then(|variation| variation.split_once('('));
    let known = |name: &str| matches!(name, "normal" | "uniform");
    let Some((name, inner)) = inner.filter(|(name, _)| known(name.trim())) else {
        let reason = format!("`{variation}` is not a distribution");
        return Err(fault(reason, "use normal(MEAN,SD) or uniform(FROM,TO)"));
    };
    let parts: Vec<&str> = inner.split(',').collect();
    let [first, second] = parts.as_slice() else {
        let reason = format!("`{variation}` does not have two numbers");
        return Err(fault(reason, FORMS));
    };
    let (from, to) = (number(first)?, number(second)?);
    if name.trim() == "normal" {
        let (mean, deviation) = (from, to);
        if deviation <= 0.0 {
            let reason =
                format!("the standard deviation is {deviation}, but must be greater than zero");
            return Err(fault(reason, FORMS));
        }
        return Ok(VariationKind::Normal { mean, deviation });
    }
    if from >= to {
        let reason = format!("the range from {from} to {to} is empty");
        return Err(fault(reason, "give the smaller end first"));
    }
    Ok(VariationKind::Uniform { from, to })
}

/// Uniform within a tolerance of the scene's value, in its unit or in percent of it.
fn tolerance(nominal: f64, variation: &str) -> Parsed {
    let width = match variation.strip_suffix('%') {
        Some(percent) => number(percent)? / 100.0 * nominal.abs(),
        None => number(variation)?,
    };
    if width <= 0.0 {
        let help = "a percentage needs a value other than zero";
        return Err(fault(
            format!("the tolerance is {width}, but must be greater than zero"),
            help,
        ));
    }
    Ok(VariationKind::Uniform {
        from: nominal - width,
        to: nominal + width,
    })
}

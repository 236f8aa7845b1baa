//! What varies: one number of the scene over a grid, a list, or at random.

use super::error::SweepError;
use super::random::{normal, uniform};
use dwell_scene::Scene;

/// Most values of a grid.
const MOST_VALUES: u64 = 1_000_000;

const FORMS: &str = "write PATH=FROM:TO:COUNT, PATH=A,B,C, PATH~normal(MEAN,SD), PATH~uniform(FROM,TO), \
                     PATH±TOLERANCE or PATH±PERCENT%";

/// A number of the scene and how it varies, in the scene's own unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    pub(crate) path: String,
    pub(crate) unit: String,
    pub(crate) kind: Kind,
}

/// How a number varies.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Kind {
    /// Equal steps between two values, both among them.
    Grid { from: f64, to: f64, count: u64 },
    /// These values, one after another.
    Listed(Vec<f64>),
    /// At random about a mean.
    Normal { mean: f64, deviation: f64 },
    /// At random, evenly between two values.
    Uniform { from: f64, to: f64 },
}

impl Axis {
    /// Reads an axis: a path of the scene, and how its number varies.
    ///
    /// # Errors
    /// [`SweepError::Axis`].
    pub(crate) fn parse(scene: &Scene, given: &str) -> Result<Self, SweepError> {
        let refuse = |reason: String, help: &str| SweepError::Axis {
            given: given.to_owned(),
            reason,
            help: help.to_owned(),
        };
        let separators = ["=", "~", "±", "+-"];
        let split = separators
            .iter()
            .filter_map(|s| Some((given.find(s)?, *s)))
            .min_by_key(|(at, _)| *at);
        let Some((at, separator)) = split else {
            return Err(refuse("does not say how it varies".to_owned(), FORMS));
        };
        let (path, how) = (given[..at].trim(), given[at + separator.len()..].trim());
        let nominal = scene
            .value(path)
            .map_err(|e| refuse(e.message, &e.help.unwrap_or_default()))?;
        let number = |text: &str| -> Result<f64, SweepError> {
            let value: f64 = text
                .trim()
                .parse()
                .map_err(|_| refuse(format!("`{}` is not a number", text.trim()), FORMS))?;
            if value.is_finite() {
                Ok(value)
            } else {
                Err(refuse(format!("{value} is not finite"), FORMS))
            }
        };
        let kind = match separator {
            "=" if how.contains(':') => grid(how, &number, &refuse)?,
            "=" => Kind::Listed(how.split(',').map(number).collect::<Result<_, _>>()?),
            "~" => random(how, &number, &refuse)?,
            _ => tolerance(nominal, how, &number, &refuse)?,
        };
        Ok(Self {
            path: path.to_owned(),
            unit: scene.unit_of(path).to_owned(),
            kind,
        })
    }

    /// Whether it is drawn at random.
    pub(crate) fn is_random(&self) -> bool {
        matches!(self.kind, Kind::Normal { .. } | Kind::Uniform { .. })
    }

    /// How many values it lists; one where it is drawn at random.
    pub(crate) fn count(&self) -> u64 {
        match &self.kind {
            Kind::Grid { count, .. } => *count,
            Kind::Listed(values) => values.len() as u64,
            Kind::Normal { .. } | Kind::Uniform { .. } => 1,
        }
    }

    /// Its value: the `place`th of those listed, or that of a `sample` of the `number`th axis.
    pub(crate) fn value(&self, place: u64, (seed, number, sample): (u64, u32, u64)) -> f64 {
        match &self.kind {
            // Both ends to the last digit.
            Kind::Grid { to, count, .. } if place + 1 == *count => *to,
            Kind::Grid { from, to, count } => {
                from + (to - from) * place as f64 / (count - 1) as f64
            }
            // The place is below the count.
            Kind::Listed(values) => values.get(place as usize).copied().unwrap_or(f64::NAN),
            Kind::Normal { mean, deviation } => mean + deviation * normal(seed, number, sample),
            Kind::Uniform { from, to } => {
                let [part, _] = uniform(seed, number, sample);
                from * (1.0 - part) + to * part
            }
        }
    }

    /// Its heading in tables.
    pub(crate) fn heading(&self) -> String {
        heading(&self.path, &self.unit)
    }

    /// The axis to every digit, as the store holds it.
    pub(crate) fn exact(&self) -> String {
        let path = &self.path;
        match &self.kind {
            Kind::Grid { from, to, count } => format!("{path}={from:?}:{to:?}:{count}"),
            Kind::Listed(values) => {
                let values: Vec<String> = values.iter().map(|v| format!("{v:?}")).collect();
                format!("{path}={}", values.join(","))
            }
            Kind::Normal { mean, deviation } => format!("{path}~normal({mean:?},{deviation:?})"),
            Kind::Uniform { from, to } => format!("{path}~uniform({from:?},{to:?})"),
        }
    }
}

/// `name [unit]`.
pub(crate) fn heading(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

type Number<'a> = &'a dyn Fn(&str) -> Result<f64, SweepError>;
type Refuse<'a> = &'a dyn Fn(String, &str) -> SweepError;

/// `FROM:TO:COUNT`, the ends among them.
fn grid(how: &str, number: Number<'_>, refuse: Refuse<'_>) -> Result<Kind, SweepError> {
    let parts: Vec<&str> = how.split(':').collect();
    let [from, to, count] = parts.as_slice() else {
        let reason = format!("`{how}` is not FROM:TO:COUNT");
        return Err(refuse(reason, FORMS));
    };
    let (from, to) = (number(from)?, number(to)?);
    let count: u64 = count.trim().parse().map_err(|_| {
        let reason = format!("`{}` is not a count of values", count.trim());
        refuse(reason, "a whole number of 2 or more, the ends among them")
    })?;
    if !(2..=MOST_VALUES).contains(&count) {
        return Err(refuse(
            format!("{count} values from {from} to {to}"),
            "a grid has from 2 to a million values, the ends among them; a single one is written PATH=VALUE",
        ));
    }
    if from == to {
        let reason = format!("the range from {from} to {to} is empty");
        return Err(refuse(reason, "a single value is written PATH=VALUE"));
    }
    Ok(Kind::Grid { from, to, count })
}

/// `normal(MEAN,SD)` or `uniform(FROM,TO)`.
fn random(how: &str, number: Number<'_>, refuse: Refuse<'_>) -> Result<Kind, SweepError> {
    let inner = how.strip_suffix(')').and_then(|how| how.split_once('('));
    let known = |name: &str| matches!(name, "normal" | "uniform");
    let Some((name, inner)) = inner.filter(|(name, _)| known(name.trim())) else {
        return Err(refuse(
            format!("`{how}` is no distribution"),
            "there are normal(MEAN,SD) and uniform(FROM,TO)",
        ));
    };
    let parts: Vec<&str> = inner.split(',').collect();
    let [first, second] = parts.as_slice() else {
        return Err(refuse(format!("`{how}` does not have two numbers"), FORMS));
    };
    let (first, second) = (number(first)?, number(second)?);
    match name.trim() {
        "normal" if second <= 0.0 => Err(refuse(
            format!("a standard deviation of {second} is not above zero"),
            FORMS,
        )),
        "normal" => Ok(Kind::Normal {
            mean: first,
            deviation: second,
        }),
        _ if first >= second => Err(refuse(
            format!("the range from {first} to {second} is empty"),
            "give the smaller end first",
        )),
        _ => Ok(Kind::Uniform {
            from: first,
            to: second,
        }),
    }
}

/// Evenly within a tolerance of the scene's own value, in its unit or in percent of it.
fn tolerance(
    nominal: f64,
    how: &str,
    number: Number<'_>,
    refuse: Refuse<'_>,
) -> Result<Kind, SweepError> {
    let width = match how.strip_suffix('%') {
        Some(percent) => number(percent)? / 100.0 * nominal.abs(),
        None => number(how)?,
    };
    if width <= 0.0 {
        let help = "a tolerance is above zero; a percentage needs a value that is not zero";
        return Err(refuse(format!("a tolerance of {width}"), help));
    }
    Ok(Kind::Uniform {
        from: nominal - width,
        to: nominal + width,
    })
}

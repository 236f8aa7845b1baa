//! The spread of results whose numbers vary at random: by first order, by second order and by samples.
//!
//! With independent symmetric distributions and the derivatives g, H at their means, the mean of a result is displaced by ½ Σ Hₖₖ σₖ², and
//! its variance is Σ gₖ² σₖ² + ¼ Σ Hₖₖ² (μ₄ₖ − σₖ⁴) + ½ Σ Hₖₗ² σₖ² σₗ² over k ≠ l (exact for a result that is quadratic). H is the difference of
//! exact gradients one standard deviation either way.

use super::differences::{STEP, difference};
use super::machine_numbers::GradientScene;
use super::slopes::{Gradient, ResultGradient, gradient_by};
use crate::explain::{StudyError, SweepError};
use crate::progress::{Progress, no_progress};
use crate::sweep::compute::{
    Axis, Design, Moments, RequestedQuantities, Row, SweepRequest, compute_rows,
};
use dwell_scene::ResultLimit;
use rayon::prelude::*;

/// The normal quantile of an interval of 95 %.
const OF_95_PERCENT: f64 = 1.959_963_984_540_054;
/// First order is negligible where its standard deviation is below this part of that by second order.
const NEGLIGIBLE: f64 = 0.1;
const FORMS: &str =
    "write PATH±TOLERANCE, PATH±PERCENT%, PATH~normal(MEAN,SD) or PATH~uniform(FROM,TO)";

/// A number that varies at random.
#[derive(Debug, Clone, PartialEq)]
pub struct TolerancedNumber {
    /// Its path.
    pub path: String,
    /// Its unit, as in the scene.
    pub unit: String,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

/// The spread of a result by derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Its mean less its value at the means of the numbers.
    pub shift: f64,
    /// The standard deviation.
    pub deviation: f64,
    /// The contribution of each number to the variance.
    pub parts: Vec<f64>,
}

/// The spread of a result over the samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// Mean less the value at the means of the numbers.
    pub shift: f64,
    /// The standard deviation.
    pub deviation: f64,
    /// The standard error of the mean.
    pub shift_error: f64,
    /// The standard error of the standard deviation.
    pub deviation_error: f64,
}

/// The tolerance of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultTolerance {
    /// Name, unit, value and what is to be said of the gradient, with the numbers at their means.
    pub nominal: ResultGradient,
    /// By the gradient.
    pub first: Spread,
    /// By the gradient and the second derivatives, or why there is none.
    pub second: Result<Spread, String>,
    /// By the samples that have a value.
    pub sampled: Sampled,
    /// The samples; not a number where there is none.
    pub values: Vec<f64>,
}

/// The share of the samples within a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleShare {
    /// The share.
    pub share: f64,
    /// Its interval of confidence of 95 % (Wilson, 1927).
    pub interval: [f64; 2],
}

/// The yield of a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitYield {
    /// The limit.
    pub limit: ResultLimit,
    /// By the samples; one without a value is beyond the limit.
    pub sampled: SampleShare,
    /// By the normal distribution of first order.
    pub first: f64,
}

/// The tolerances of results.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// The numbers.
    pub numbers: Vec<TolerancedNumber>,
    /// By result.
    pub results: Vec<ResultTolerance>,
    /// By limit.
    pub limits: Vec<LimitYield>,
    /// The share of the samples within all limits.
    pub within_all: SampleShare,
    /// By sample, the reason why not all of its results could be computed.
    pub messages: Vec<Option<String>>,
}

impl ResultTolerance {
    /// Whether the second derivatives decide, as at an optimum.
    pub fn is_first_order_negligible(&self) -> bool {
        let negligible = |second: &Spread| self.first.deviation < NEGLIGIBLE * second.deviation;
        self.second.as_ref().is_ok_and(negligible)
    }

    /// The parts of the variance by second order, or by first order where there is no other.
    pub fn parts(&self) -> &[f64] {
        &self.second.as_ref().unwrap_or(&self.first).parts
    }
}

/// Computes the tolerances of results: `vary` of the request are the distributions of numbers, `requests` the results.
///
/// # Errors
/// [`StudyError`] where a number has no distribution, the scene has no such result, or cannot be evaluated at the means.
pub fn compute_tolerance<S: GradientScene>(
    scene: &S,
    request: &SweepRequest<'_>,
    progress: Progress<'_>,
) -> Result<Tolerance, StudyError> {
    if request.samples.is_some_and(|samples| samples < 2) {
        let message = "a standard deviation needs at least 2 samples: give more --samples";
        return Err(SweepError::Design(message.to_owned()).into());
    }
    for given in request.vary {
        let axis = Axis::parse(scene, given).map_err(|error| of_option(error, given))?;
        if axis.moments().is_none() {
            let reason = "the number has no distribution".to_owned();
            return Err(tolerance_error(given, reason, FORMS.to_owned()).into());
        }
    }
    let (design, mut requested) = request.prepare(scene)?;
    // Samples beyond a limit count, too.
    let limits = std::mem::take(&mut requested.limits);
    let study = Study {
        scene,
        design: &design,
        requested: &requested,
        moments: design.axes.iter().filter_map(Axis::moments).collect(),
    };
    let center = study.slopes(&study.at(None))?;
    let second = study.second_derivatives();
    let rows = compute_rows(scene, &design, &requested, progress)?;
    let results = center.gradient.results.into_iter().enumerate();
    let results: Vec<ResultTolerance> = results
        .map(|(r, nominal)| {
            let values: Vec<f64> = rows.iter().map(|row| row.result.values[r]).collect();
            let second = second.as_ref().map_err(Clone::clone);
            ResultTolerance {
                first: spread(&study.moments, &center.slopes[r], None),
                second: second
                    .map(|of| spread(&study.moments, &center.slopes[r], Some(&of[r])))
                    .and_then(finite),
                sampled: sampled(&values, nominal.value),
                values,
                nominal,
            }
        })
        .collect();
    let each = limits
        .iter()
        .map(|(r, limit)| limit_yield(limit, &results[*r]));
    let all = |row: &&Row| {
        limits
            .iter()
            .all(|(r, of)| holds(of, row.result.values[*r]))
    };
    Ok(Tolerance {
        numbers: study.numbers(),
        limits: each.collect(),
        within_all: SampleShare::new(rows.iter().filter(all).count(), rows.len()),
        results,
        messages: rows.into_iter().map(|row| row.result.message).collect(),
    })
}

/// An error of an option with one that names it.
fn tolerance_error(given: &str, reason: String, help: String) -> SweepError {
    SweepError::Axis {
        option: "--tolerance",
        given: given.to_owned(),
        reason,
        help,
    }
}

/// The error of a variation as one of a tolerance, whose forms are fewer.
fn of_option(error: SweepError, given: &str) -> SweepError {
    match error {
        SweepError::Axis { reason, help, .. } if help.contains("PATH=") => {
            tolerance_error(given, reason, FORMS.to_owned())
        }
        SweepError::Axis { reason, help, .. } => tolerance_error(given, reason, help),
        other => other,
    }
}

/// A spread that exists.
fn finite(spread: Spread) -> Result<Spread, String> {
    match spread.deviation.is_finite() && spread.shift.is_finite() {
        true => Ok(spread),
        false => Err("a derivative is missing one standard deviation away".to_owned()),
    }
}

/// The means and deviations of the numbers of a scene.
struct Study<'a, S> {
    scene: &'a S,
    design: &'a Design,
    requested: &'a RequestedQuantities,
    moments: Vec<Moments>,
}

/// The gradient at some values of the numbers.
struct Slopes {
    gradient: Gradient,
    /// By result and number, with all that follows from it.
    slopes: Vec<Vec<f64>>,
}

impl<S: GradientScene> Study<'_, S> {
    /// The means, of which one number may be displaced by a multiple of its deviation.
    fn at(&self, displaced: Option<(usize, f64)>) -> Vec<f64> {
        let mut values: Vec<f64> = self.moments.iter().map(|of| of.mean).collect();
        if let Some((k, by)) = displaced {
            values[k] += by * self.moments[k].deviation;
        }
        values
    }

    fn numbers(&self) -> Vec<TolerancedNumber> {
        let each = self.design.axes.iter().zip(&self.moments);
        let number = |(axis, of): (&Axis, &Moments)| TolerancedNumber {
            path: axis.path.clone(),
            unit: axis.unit.clone(),
            mean: of.mean,
            deviation: of.deviation,
        };
        each.map(number).collect()
    }

    /// The derivatives of all results by the numbers, at some values of these.
    fn slopes(&self, values: &[f64]) -> Result<Slopes, StudyError> {
        let numbers = self.design.numbers(values);
        let assigned = self.design.assigned(&numbers);
        let varied = self.scene.varied(&assigned)?;
        let is_wanted = |path: &str| assigned.iter().any(|(of, _)| *of == path);
        let gradient = gradient_by(&varied, self.requested, &is_wanted, false, &no_progress)?;
        let mut slopes = vec![Vec::new(); gradient.results.len()];
        for k in 0..values.len() {
            let effects = self.design.slopes(&numbers, k);
            let mut differences = None;
            for (r, result) in gradient.results.iter().enumerate() {
                let mut pairs = assigned.iter().zip(&effects).filter(|(_, e)| **e != 0.0);
                let sum = pairs.try_fold(0.0, |sum, ((path, _), effect)| {
                    Some(sum + effect * partial(&gradient, result, path)?)
                });
                // Numbers that change together only, as equal links do.
                let whole = || differences.get_or_insert_with(|| self.differences(values, k))[r];
                slopes[r].push(sum.unwrap_or_else(whole));
            }
        }
        Ok(Slopes { gradient, slopes })
    }

    /// The derivatives of all results by a number, from differences.
    fn differences(&self, values: &[f64], k: usize) -> Vec<f64> {
        let at = |value: f64| {
            let mut values = values.to_vec();
            values[k] = value;
            let numbers = self.design.numbers(&values);
            let assigned = self.design.assigned(&numbers);
            self.requested.evaluate(self.scene, &assigned).values
        };
        let (count, scale) = (self.requested.quantities.len(), self.moments[k].deviation);
        let found = difference(&at, count, values[k], scale / STEP);
        found.iter().map(|of| of.slope).collect()
    }

    /// The second derivatives by result, or why there are none.
    fn second_derivatives(&self) -> Result<Vec<Vec<Vec<f64>>>, String> {
        let count = self.moments.len();
        let rows = (0..count).into_par_iter().map(|k| {
            let away = |by: f64| self.slopes(&self.at(Some((k, by)))).map(|of| of.slopes);
            let (after, before) = (away(1.0)?, away(-1.0)?);
            let step = 2.0 * self.moments[k].deviation;
            let row = |(a, b): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| (a - b) / step).collect()
            };
            Ok(after.iter().zip(&before).map(row).collect())
        });
        let rows: Result<Vec<Vec<Vec<f64>>>, StudyError> = rows.collect();
        let rows = rows.map_err(|error| error.to_string())?;
        let entry = |r: usize, k: usize, l: usize| 0.5 * (rows[k][r][l] + rows[l][r][k]);
        let row = |r, k| (0..count).map(|l| entry(r, k, l)).collect();
        let matrix = |r| (0..count).map(|k| row(r, k)).collect();
        Ok((0..self.requested.quantities.len()).map(matrix).collect())
    }
}

/// The derivative of a result by a number alone; `None` if it has none.
fn partial(gradient: &Gradient, result: &ResultGradient, path: &str) -> Option<f64> {
    let is_fixed = gradient.fixed.iter().any(|(of, _)| of == path);
    if is_fixed || result.undefined.iter().any(|of| of == path) {
        return None;
    }
    let found = result.numbers.iter().find(|of| of.path == path);
    Some(found.map_or(0.0, |of| of.slope))
}

/// The spread by first order, or with second derivatives.
fn spread(moments: &[Moments], slopes: &[f64], second: Option<&Vec<Vec<f64>>>) -> Spread {
    let bend = |k: usize, l: usize| second.map_or(0.0, |second| second[k][l]);
    let part = |k: usize| {
        let squares = moments.iter().enumerate().map(|(l, other)| {
            let moment = if k == l { other.kurtosis - 1.0 } else { 2.0 };
            0.25 * moment * (bend(k, l) * moments[k].deviation * other.deviation).powi(2)
        });
        (slopes[k] * moments[k].deviation).powi(2) + squares.sum::<f64>()
    };
    let parts: Vec<f64> = (0..moments.len()).map(part).collect();
    let each = moments.iter().enumerate();
    Spread {
        shift: each
            .map(|(k, of)| 0.5 * bend(k, k) * of.deviation.powi(2))
            .sum(),
        deviation: parts.iter().sum::<f64>().sqrt(),
        parts,
    }
}

/// The spread of samples, with standard errors that do not suppose a normal distribution.
fn sampled(values: &[f64], nominal: f64) -> Sampled {
    let shifts = values.iter().map(|v| v - nominal).filter(|v| v.is_finite());
    let shifts: Vec<f64> = shifts.collect();
    let count = shifts.len() as f64;
    let shift = shifts.iter().sum::<f64>() / count;
    let moment = |power| shifts.iter().map(|v| (v - shift).powi(power)).sum::<f64>();
    let variance = moment(2) / (count - 1.0);
    let of_variance = ((moment(4) / count - variance * variance) / count)
        .max(0.0)
        .sqrt();
    let deviation = variance.sqrt();
    Sampled {
        shift,
        deviation,
        shift_error: deviation / count.sqrt(),
        deviation_error: if variance > 0.0 {
            of_variance / (2.0 * deviation)
        } else {
            0.0
        },
    }
}

/// Whether a value is within a limit.
fn holds(limit: &ResultLimit, value: f64) -> bool {
    match limit.is_upper {
        true => value <= limit.limit,
        false => value >= limit.limit,
    }
}

/// The yield of a limit of a result.
fn limit_yield(limit: &ResultLimit, of: &ResultTolerance) -> LimitYield {
    let within = of.values.iter().filter(|value| holds(limit, **value));
    let room = limit.limit - of.nominal.value;
    let room = if limit.is_upper { room } else { -room };
    LimitYield {
        limit: limit.clone(),
        sampled: SampleShare::new(within.count(), of.values.len()),
        first: match of.first.deviation > 0.0 {
            true => normal_share(room / of.first.deviation),
            false => f64::from(u8::from(room >= 0.0)),
        },
    }
}

impl SampleShare {
    fn new(within: usize, count: usize) -> Self {
        let (count, share) = (count as f64, within as f64 / count as f64);
        let z = OF_95_PERCENT;
        let middle = (share + z * z / (2.0 * count)) / (1.0 + z * z / count);
        let root = (share * (1.0 - share) / count + (z / (2.0 * count)).powi(2)).sqrt();
        let half = z * root / (1.0 + z * z / count);
        Self {
            share,
            interval: [(middle - half).max(0.0), (middle + half).min(1.0)],
        }
    }
}

/// The part of a normal distribution that is at most `z` deviations above its mean, by a series (Marsaglia, J. Stat. Softw. 11(4), 2004).
fn normal_share(z: f64) -> f64 {
    // Beyond that the rest is below 1e-15.
    if z.abs() > 8.0 {
        return if z > 0.0 { 1.0 } else { 0.0 };
    }
    let (mut sum, mut term, mut odd) = (z, z, 1.0);
    while term.abs() > f64::EPSILON * sum.abs() {
        odd += 2.0;
        term *= z * z / odd;
        sum += term;
    }
    0.5 + sum * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt()
}

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
    Axis, Design, RequestedQuantities, SweepRequest, VariationKind, compute_rows,
};
use dwell_scene::ResultLimit;
use rayon::prelude::*;

/// The normal quantile of an interval of 95 %.
const OF_95_PERCENT: f64 = 1.959_963_984_540_054;
/// First order is negligible where its standard deviation is below this part of that by second order.
const NEGLIGIBLE: f64 = 0.1;

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
    /// The mean fourth power of what it is from its mean, over that of the deviation.
    pub kurtosis: f64,
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

/// The tolerance of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultTolerance {
    /// Name, unit, value and what is to be said of the gradient, with the numbers at their means.
    pub nominal: ResultGradient,
    /// By the gradient.
    pub first: Spread,
    /// By the second derivatives, too; `None` where there are no derivatives one standard deviation from the means.
    pub second: Option<Spread>,
    /// By the samples.
    pub sampled: Spread,
    /// The standard errors of their mean and of their standard deviation.
    pub sampling_errors: [f64; 2],
    /// The samples; not a number where there is none.
    pub values: Vec<f64>,
}

/// The share of variants within a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitYield {
    /// The limit; `None` for all limits together.
    pub limit: Option<ResultLimit>,
    /// The share of the samples; one without a value is beyond the limit.
    pub share: f64,
    /// Its interval of confidence of 95 % (Wilson, 1927).
    pub interval: [f64; 2],
    /// By the normal distribution of first order, of a single limit.
    pub first: Option<f64>,
}

/// The tolerances of results.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// The numbers.
    pub numbers: Vec<TolerancedNumber>,
    /// By result.
    pub results: Vec<ResultTolerance>,
    /// By limit; of several, then of all together.
    pub yields: Vec<LimitYield>,
    /// By sample, the reason why not all of its results could be computed.
    pub messages: Vec<Option<String>>,
}

impl ResultTolerance {
    /// Whether the second derivatives decide, as at an optimum.
    pub fn is_first_order_negligible(&self) -> bool {
        let negligible = |second: &Spread| self.first.deviation < NEGLIGIBLE * second.deviation;
        self.second.as_ref().is_some_and(negligible)
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
    let given = request.vary.iter();
    let numbers = given.map(|of| Axis::parse(scene, of).and_then(|axis| toleranced(&axis, of)));
    let numbers: Vec<TolerancedNumber> = numbers.collect::<Result<_, _>>().map_err(of_option)?;
    if request.samples.is_some_and(|samples| samples < 2) {
        let message = "a standard deviation needs at least 2 samples: give more --samples";
        return Err(SweepError::Design(message.to_owned()).into());
    }
    let (design, mut requested) = request.prepare(scene)?;
    // Samples beyond a limit count, too.
    let limits = std::mem::take(&mut requested.limits);
    let study = DesignSlopes {
        scene,
        design: &design,
        requested: &requested,
        numbers: &numbers,
    };
    let (gradient, slopes) = study.slopes(&study.away(None))?;
    let second = study.second_derivatives();
    let rows = compute_rows(scene, &design, &requested, progress)?;
    let failures = rows.iter().filter_map(|row| row.result.message.as_ref());
    if failures.clone().count() + 2 > rows.len() {
        let reason = failures.clone().next().map_or("", String::as_str);
        let help = "give smaller tolerances, or tie numbers that change together, as with --tied";
        let message = format!("the samples have no results ({reason}): {help}");
        return Err(SweepError::Design(message).into());
    }
    let mut results = Vec::new();
    for (r, nominal) in gradient.results.into_iter().enumerate() {
        let values: Vec<f64> = rows.iter().map(|row| row.result.values[r]).collect();
        let (sampled, sampling_errors) = sampled(&values, nominal.value);
        let second = second
            .as_ref()
            .map(|of| spread(&numbers, &slopes[r], Some(&of[r])));
        results.push(ResultTolerance {
            first: spread(&numbers, &slopes[r], None),
            second: second.filter(|of| (of.shift + of.deviation).is_finite()),
            sampled,
            sampling_errors,
            values,
            nominal,
        });
    }
    Ok(Tolerance {
        yields: yields(&limits, &results),
        numbers,
        results,
        messages: rows.into_iter().map(|row| row.result.message).collect(),
    })
}

/// The error of a variation as one of a tolerance.
fn of_option(error: SweepError) -> SweepError {
    match error {
        SweepError::Axis {
            given,
            reason,
            help,
            ..
        } => SweepError::Axis {
            option: "--tolerance",
            given,
            reason,
            help,
        },
        other => other,
    }
}

/// The number of an axis that is random.
fn toleranced(axis: &Axis, given: &str) -> Result<TolerancedNumber, SweepError> {
    let (mean, deviation, kurtosis) = match &axis.kind {
        VariationKind::Normal { mean, deviation } => (*mean, *deviation, 3.0),
        VariationKind::Uniform { from, to } => {
            (0.5 * (from + to), (to - from) / 12.0_f64.sqrt(), 1.8)
        }
        VariationKind::Grid { .. } | VariationKind::Listed(_) => {
            let forms =
                "PATH±TOLERANCE, PATH±PERCENT%, PATH~normal(MEAN,SD) or PATH~uniform(FROM,TO)";
            return Err(SweepError::Axis {
                option: "--tolerance",
                given: given.to_owned(),
                reason: "the number has no distribution".to_owned(),
                help: format!("write {forms}"),
            });
        }
    };
    Ok(TolerancedNumber {
        path: axis.path.clone(),
        unit: axis.unit.clone(),
        mean,
        deviation,
        kurtosis,
    })
}

/// The derivatives of results by numbers.
pub(crate) struct DesignSlopes<'a, S> {
    pub(crate) scene: &'a S,
    pub(crate) design: &'a Design,
    pub(crate) requested: &'a RequestedQuantities,
    /// The numbers that vary; their deviations are the steps of differences.
    pub(crate) numbers: &'a [TolerancedNumber],
}

/// By result and number.
type Matrix = Vec<Vec<f64>>;

impl<S: GradientScene> DesignSlopes<'_, S> {
    /// The means, of which one number may be displaced by a multiple of its deviation.
    fn away(&self, displaced: Option<(usize, f64)>) -> Vec<f64> {
        let mut values: Vec<f64> = self.numbers.iter().map(|of| of.mean).collect();
        if let Some((k, by)) = displaced {
            values[k] += by * self.numbers[k].deviation;
        }
        values
    }

    /// The gradient at some values of the numbers, and the derivatives by these with all that follows from them.
    pub(crate) fn slopes(&self, values: &[f64]) -> Result<(Gradient, Matrix), StudyError> {
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
        Ok((gradient, slopes))
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
        let (count, scale) = (self.requested.quantities.len(), self.numbers[k].deviation);
        let found = difference(&at, count, values[k], scale / STEP);
        found.iter().map(|of| of.slope).collect()
    }

    /// The second derivatives by result; `None` if there are none.
    fn second_derivatives(&self) -> Option<Vec<Matrix>> {
        let count = self.numbers.len();
        let rows = (0..count).into_par_iter().map(|k| {
            let slopes = |by: f64| Some(self.slopes(&self.away(Some((k, by)))).ok()?.1);
            let step = 2.0 * self.numbers[k].deviation;
            let row = |(after, before): (Vec<f64>, Vec<f64>)| {
                let pairs = after.iter().zip(&before);
                pairs.map(|(a, b)| (a - b) / step).collect()
            };
            let pairs = slopes(1.0)?.into_iter().zip(slopes(-1.0)?);
            Some(pairs.map(row).collect::<Matrix>())
        });
        let rows: Vec<Matrix> = rows.collect::<Option<_>>()?;
        let entry = |r: usize, k: usize, l: usize| 0.5 * (rows[k][r][l] + rows[l][r][k]);
        let row = |r, k| (0..count).map(|l| entry(r, k, l)).collect();
        let matrix = |r| (0..count).map(|k| row(r, k)).collect();
        Some((0..self.requested.quantities.len()).map(matrix).collect())
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
fn spread(numbers: &[TolerancedNumber], slopes: &[f64], second: Option<&Matrix>) -> Spread {
    let bend = |k: usize, l: usize| {
        second.map_or(0.0, |second| second[k][l]) * numbers[k].deviation * numbers[l].deviation
    };
    let part = |k: usize| {
        let squares = numbers.iter().enumerate().map(|(l, other)| {
            let moment = if k == l { other.kurtosis - 1.0 } else { 2.0 };
            0.25 * moment * bend(k, l).powi(2)
        });
        (slopes[k] * numbers[k].deviation).powi(2) + squares.sum::<f64>()
    };
    let parts: Vec<f64> = (0..numbers.len()).map(part).collect();
    Spread {
        shift: (0..numbers.len()).map(|k| 0.5 * bend(k, k)).sum(),
        deviation: parts.iter().sum::<f64>().sqrt(),
        parts,
    }
}

/// The spread of samples, with standard errors that do not suppose a normal distribution.
fn sampled(values: &[f64], nominal: f64) -> (Spread, [f64; 2]) {
    let shifts = values.iter().map(|v| v - nominal);
    let shifts: Vec<f64> = shifts.filter(|v| v.is_finite()).collect();
    let count = shifts.len() as f64;
    let shift = shifts.iter().sum::<f64>() / count;
    let moment = |power| shifts.iter().map(|v| (v - shift).powi(power)).sum::<f64>();
    let variance = moment(2) / (count - 1.0);
    let of_variance = ((moment(4) / count - variance * variance).max(0.0) / count).sqrt();
    let deviation = variance.sqrt();
    let spread = Spread {
        shift,
        deviation,
        parts: Vec::new(),
    };
    let of_deviation = of_variance / (2.0 * deviation.max(f64::MIN_POSITIVE));
    (spread, [deviation / count.sqrt(), of_deviation])
}

/// The yields of limits, each of the result at this index.
fn yields(limits: &[(usize, ResultLimit)], results: &[ResultTolerance]) -> Vec<LimitYield> {
    let holds = |(r, limit): &(usize, ResultLimit), k: usize| match limit.is_upper {
        true => results[*r].values[k] <= limit.limit,
        false => results[*r].values[k] >= limit.limit,
    };
    let samples = results.first().map_or(0, |of| of.values.len());
    let mut yields = Vec::new();
    for of in limits {
        let (nominal, deviation) = (results[of.0].nominal.value, results[of.0].first.deviation);
        let room = (of.1.limit - nominal) * if of.1.is_upper { 1.0 } else { -1.0 };
        let first = if room == 0.0 {
            0.5
        } else {
            normal_share(room / deviation)
        };
        let within = (0..samples).filter(|k| holds(of, *k)).count();
        yields.push(LimitYield::new(
            Some(of.1.clone()),
            within,
            samples,
            Some(first),
        ));
    }
    if limits.len() > 1 {
        let within = (0..samples).filter(|k| limits.iter().all(|of| holds(of, *k)));
        yields.push(LimitYield::new(None, within.count(), samples, None));
    }
    yields
}

impl LimitYield {
    fn new(limit: Option<ResultLimit>, within: usize, samples: usize, first: Option<f64>) -> Self {
        let (count, share) = (samples as f64, within as f64 / samples as f64);
        let (z, total) = (OF_95_PERCENT, 1.0 + OF_95_PERCENT.powi(2) / count);
        let middle = (share + z * z / (2.0 * count)) / total;
        let root = (share * (1.0 - share) / count + (z / (2.0 * count)).powi(2)).sqrt();
        let half = z * root / total;
        Self {
            limit,
            share,
            interval: [(middle - half).max(0.0), (middle + half).min(1.0)],
            first,
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

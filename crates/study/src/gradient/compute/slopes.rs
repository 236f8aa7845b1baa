//! The gradients of results by the numbers of a scene: by their exact routes, or by differences.

use super::changes::{Change, Varied, change, varied_numbers};
use super::differences::{Difference, difference};
use super::machine_numbers::GradientScene;
use super::recorded_machine::RecordedMachine;
use super::routes::{Route, routes};
use crate::explain::{StudyError, SweepError};
use crate::progress::{Progress, Step};
use crate::sweep::compute::RequestedQuantities;
use crate::trajectory::compute::Signal;

/// How a derivative was computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SlopeMethod {
    /// By a reverse sweep through the recorded operations.
    Exact,
    /// By differences of results, with this estimated error.
    Differences(f64),
}

/// The derivative of a result by a number of the scene.
///
/// Of a number that is zero a change of 1 % is one of 1 % of the size of the mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberSlope {
    /// The path of the number.
    pub path: String,
    /// Its value and its unit, as in the scene.
    pub value: f64,
    /// Its unit; empty if it has none, or if the scene does not name it.
    pub unit: String,
    /// Its magnitude; of a number that is zero the size of the mechanism, or 1.
    pub scale: f64,
    /// The derivative, in the unit of the result per unit of the number.
    pub slope: f64,
    /// How it was computed.
    pub method: SlopeMethod,
    /// The derivative by differences of results, with its estimated error, if it was wanted for a check.
    pub check: Option<[f64; 2]>,
}

/// A result with its gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultGradient {
    /// The name of the result.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// The numbers on which it depends, the strongest percentage first.
    pub numbers: Vec<NumberSlope>,
    /// The numbers that cannot be changed without that the result loses its value.
    pub undefined: Vec<String>,
    /// Why derivatives are differences, if they are.
    pub differenced: Option<&'static str>,
    /// Coordinates of the first actuator (rad or m) at which other extrema are as large: the derivative is that of one of them.
    pub ties: Vec<f64>,
}

impl ResultGradient {
    /// The change of the result, in %, for a change of a number by 1 %; `None` of a result that is zero.
    pub fn percent(&self, of: &NumberSlope) -> Option<f64> {
        (self.value != 0.0).then(|| of.slope * of.scale / self.value)
    }
}

/// Gradients of results.
#[derive(Debug, Clone, PartialEq)]
pub struct Gradient {
    /// By result.
    pub results: Vec<ResultGradient>,
    /// The numbers that cannot be varied by themselves, each with the reason.
    pub fixed: Vec<(String, String)>,
}

/// Computes the gradients of results that a sweep has, by all numbers of the scene, on which a step of progress is reported each.
///
/// # Errors
/// [`StudyError`] where the scene has no such result or cannot be evaluated.
pub fn compute_gradient<S: GradientScene>(
    scene: &S,
    results: &[String],
    has_check: bool,
    progress: Progress<'_>,
) -> Result<Gradient, StudyError> {
    if results.is_empty() {
        let message = "no result is named: name some with --of, as in --of m.max,period";
        return Err(SweepError::Design(message.to_owned()).into());
    }
    let requested = RequestedQuantities::within(scene, results, &[])?;
    gradient_by(scene, &requested, &|_| true, has_check, progress)
}

/// The gradients of requested results by those numbers of the scene whose paths are wanted.
///
/// # Errors
/// [`StudyError`] where the scene cannot be evaluated.
pub(super) fn gradient_by<S: GradientScene>(
    scene: &S,
    requested: &RequestedQuantities,
    is_wanted: &dyn Fn(&str) -> bool,
    has_check: bool,
    progress: Progress<'_>,
) -> Result<Gradient, StudyError> {
    let base = requested.evaluate(scene, &[]);
    if let Some(message) = base.message {
        return Err(scene.error(message, None, &[]).into());
    }
    let rows = scene.rows()?;
    let routes = routes(scene, &rows, requested, &base.values)?;
    let signals = routes.iter().flatten().map(Route::signal);
    let signals: Vec<Signal> = signals.cloned().collect();
    let mut machine = RecordedMachine::new(scene, S::model_of(&rows), &signals);
    let exact = routes
        .iter()
        .map(|route| route.as_ref()?.gradient(machine.as_mut()?));
    let exact: Vec<Option<Vec<f64>>> = exact.collect();
    let mut found = Gradient::without_numbers(requested, &base.values, &routes, &exact);
    let mut numbers = varied_numbers(scene, &rows);
    numbers.retain(|number| is_wanted(&number.path));
    for number in &numbers {
        let change = match &machine {
            Some(machine) => change(scene, machine, number),
            None => Change::More,
        };
        let is_open = |exact: &Option<Vec<f64>>| exact.is_none() || matches!(change, Change::More);
        let differences = match (&change, has_check || exact.iter().any(is_open)) {
            (Change::Fixed(_), _) | (_, false) => Vec::new(),
            (_, true) => {
                let at = |value| requested.evaluate(scene, &[(&number.path, value)]).values;
                difference(&at, exact.len(), number.value, number.scale)
            }
        };
        found.add(scene, number, change, &exact, &differences);
        progress(Step {
            total: numbers.len(),
            done: "numbers",
        });
    }
    for result in &mut found.results {
        let effect = |of: &NumberSlope| (of.slope * of.scale).abs();
        result
            .numbers
            .sort_by(|a, b| effect(b).total_cmp(&effect(a)));
    }
    Ok(found)
}

impl Gradient {
    /// The results, without derivatives yet.
    fn without_numbers(
        requested: &RequestedQuantities,
        values: &[f64],
        routes: &[Option<Route>],
        exact: &[Option<Vec<f64>>],
    ) -> Self {
        let quantities = requested.quantities.iter().zip(values);
        let each = quantities.zip(routes.iter().zip(exact));
        let results = each.map(|((quantity, value), (route, exact))| ResultGradient {
            name: quantity.name.clone(),
            unit: quantity.unit.clone(),
            value: *value,
            numbers: Vec::new(),
            undefined: Vec::new(),
            differenced: match (route, exact) {
                (_, Some(_)) => None,
                (None, None) => Some("this result has no exact derivative here"),
                (Some(_), None) => Some("this machine cannot be recorded"),
            },
            ties: route
                .as_ref()
                .map_or_else(Vec::new, |route| route.ties.clone()),
        });
        Self {
            results: results.collect(),
            fixed: Vec::new(),
        }
    }

    /// Adds the derivatives by a number.
    fn add<S: GradientScene>(
        &mut self,
        scene: &S,
        number: &Varied,
        change: Change,
        exact: &[Option<Vec<f64>>],
        differences: &[Difference],
    ) {
        if let Change::Fixed(reason) = change {
            self.fixed.push((number.path.clone(), reason));
            return;
        }
        for (k, (result, exact)) in self.results.iter_mut().zip(exact).enumerate() {
            let differenced = differences.get(k).copied();
            match number_slope(scene, number, &change, exact.as_deref(), differenced) {
                Some(slope) if slope.slope.is_nan() => result.undefined.push(slope.path),
                slope => result.numbers.extend(slope),
            }
        }
    }
}

/// The derivative of a result by a number, if it has an effect.
fn number_slope<S: GradientScene>(
    scene: &S,
    number: &Varied,
    change: &Change,
    exact: Option<&[f64]>,
    differenced: Option<Difference>,
) -> Option<NumberSlope> {
    let by_differences = |of: Difference| (of.slope, SlopeMethod::Differences(of.error));
    let (slope, method) = match (change, exact) {
        (Change::None, Some(_)) | (Change::Fixed(_), _) => return None,
        (Change::Numbers(rates), Some(gradient)) => {
            let sum = rates.iter().map(|(k, rate)| gradient[*k] * rate).sum();
            (sum, SlopeMethod::Exact)
        }
        (Change::More, _) | (_, None) => by_differences(differenced?),
    };
    let check = differenced.filter(|_| method == SlopeMethod::Exact);
    (slope != 0.0).then(|| NumberSlope {
        path: number.path.clone(),
        value: number.value,
        scale: number.scale,
        unit: scene.unit_of(&number.path),
        slope,
        method,
        check: check.map(|of| [of.slope, of.error]),
    })
}

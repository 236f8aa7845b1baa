//! Finds a scene value by the period of the free motion.

use crate::explain::{StudyError, explain_motion};
use crate::models::reduced_model;
use crate::number_format::{digits, number};
use dwell_dynamics::Orbit;
use dwell_numerics::root;
use dwell_scene::{Scene, SceneLocation};

/// A calibrated value.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationResult {
    /// The path of the value in the scene.
    pub path: String,
    /// Its unit in the scene.
    pub unit: String,
    /// The value the scene has.
    pub current: f64,
    /// The period it gives, s.
    pub current_period: f64,
    /// The value found.
    pub value: f64,
    /// The required period, s.
    pub period: f64,
}

/// Largest factor between the value in the scene and a trial value, and the first factor.
const MAX_FACTOR: f64 = 1e6;
const FIRST_FACTOR: f64 = 1.0 + 1.0 / 64.0;
/// Number of bisections after a step to a value that has no period.
const BISECTIONS: usize = 12;

/// Finds the value at `path` that gives the `period` (s): brackets it outwards from the present value, then
/// refines to rounding.
///
/// # Errors
/// [`StudyError::Scene`] when there is no such value, the motion has no period, or no value between
/// a millionth and a million times the present one gives it.
pub fn find_value(scene: &Scene, path: &str, period: f64) -> Result<CalibrationResult, StudyError> {
    let current = scene.value(path)?;
    let unit = scene.unit_of(path).to_owned();
    let refuse = |message: String, help: &str| -> StudyError {
        let at = [(scene.location_of(path), "the value to calibrate".to_owned())];
        scene.error(message, Some(help.to_owned()), &at).into()
    };
    if !(period.is_finite() && period > 0.0) {
        return Err(scene
            .error(
                format!("the required period {period} s is not a positive time"),
                Some("give a time in seconds, such as 5.42".to_owned()),
                &[(
                    SceneLocation::Calibration,
                    "the period of this motion".to_owned(),
                )],
            )
            .into());
    }
    let current_period = period_of(scene)?;
    let result = |calibrated_value: f64| CalibrationResult {
        path: path.to_owned(),
        unit: unit.clone(),
        current,
        current_period,
        value: calibrated_value,
        period,
    };
    if current_period == period {
        return Ok(result(current));
    }
    if current == 0.0 {
        return Err(refuse(
            format!("`{path}` is zero, and the search multiplies the present value by factors"),
            "give an approximate value in the scene first",
        ));
    }
    let period_with = |value: f64| period_of(&scene.with_value(path, value)?);
    let search = BracketSearch::outwards(current, current_period, period, &period_with);
    let Some((a, b)) = search.bracket else {
        let [from, to] = search.values.map(|v| digits(v, 3));
        let [shortest, longest] = search.periods.map(number);
        let periods_text = if shortest == longest {
            format!("the period stays {shortest} s")
        } else {
            format!("it gives periods from {shortest} to {longest} s")
        };
        return Err(refuse(
            format!(
                "no value of `{path}` gives the period {} s: from {from} to {to} {unit} {periods_text}",
                number(period)
            ),
            if search.left_range {
                "beyond these values the motion has no period"
            } else {
                "calibrate another value, or require a period within this interval"
            },
        ));
    };
    let residual = |value: f64| -> Result<f64, StudyError> { Ok(period_with(value)? - period) };
    let calibrated_value = root::find(residual, a, b)?.ok_or_else(|| {
        refuse(
            format!(
                "the period is discontinuous at {} s, between {} and {} {unit} of `{path}`",
                number(period),
                number(a),
                number(b)
            ),
            "the mechanism changes its assembly mode there",
        )
    })?;
    Ok(result(calibrated_value))
}

/// The search for a bracket of the required period.
struct BracketSearch {
    /// Two values whose periods bracket the required one.
    bracket: Option<(f64, f64)>,
    /// The smallest and the largest value that have a period.
    values: [f64; 2],
    /// The shortest and the longest period found, s.
    periods: [f64; 2],
    /// Whether a trial value had no period.
    left_range: bool,
}

impl BracketSearch {
    /// Searches outwards from a value in both directions, squaring the factor each time. Before a value
    /// without a period it bisects, so that the values near that limit are tried as well.
    fn outwards(
        current: f64,
        current_period: f64,
        target_period: f64,
        period_with: &impl Fn(f64) -> Result<f64, StudyError>,
    ) -> Self {
        let mut search = Self {
            bracket: None,
            values: [current; 2],
            periods: [current_period; 2],
            left_range: false,
        };
        // Whether a value has a period; sets the bracket if the required period is passed.
        let try_value = |search: &mut Self, last: f64, next: f64| {
            let Ok(period) = period_with(next) else {
                search.left_range = true;
                return false;
            };
            if (period - target_period) * (current_period - target_period) <= 0.0 {
                search.bracket = Some((last, next));
            }
            search.values = [search.values[0].min(next), search.values[1].max(next)];
            search.periods = [search.periods[0].min(period), search.periods[1].max(period)];
            true
        };
        let mut outermost = [Some(current), Some(current)];
        let mut factor = FIRST_FACTOR;
        loop {
            for (outer, next) in outermost
                .iter_mut()
                .zip([current * factor, current / factor])
            {
                let Some(last) = *outer else { continue };
                *outer = try_value(&mut search, last, next).then_some(next);
                if outer.is_none() {
                    let (mut good, mut bad) = (last, next);
                    for _ in 0..BISECTIONS {
                        let middle = 0.5 * (good + bad);
                        if search.bracket.is_some() {
                            break;
                        } else if try_value(&mut search, good, middle) {
                            good = middle;
                        } else {
                            bad = middle;
                        }
                    }
                }
                if search.bracket.is_some() {
                    return search;
                }
            }
            if factor >= MAX_FACTOR {
                return search;
            }
            factor = (factor * factor).min(MAX_FACTOR);
        }
    }
}

fn period_of(scene: &Scene) -> Result<f64, StudyError> {
    let exact = reduced_model(scene, &[])?;
    let Some(spec) = &scene.motion else {
        return Err(scene
            .error(
                "a period needs a [motion]".to_owned(),
                Some("add [motion] with `speed` and `periods`".to_owned()),
                &[(
                    SceneLocation::Whole,
                    "there is no [motion] in this file".to_owned(),
                )],
            )
            .into());
    };
    let start = dwell_dynamics::ReducedState {
        t: 0.0,
        q: spec.initial_coordinates[0],
        q_dot: spec.initial_velocities[0],
    };
    let orbit =
        Orbit::new(&exact, start).map_err(|e| explain_motion(scene, exact.model().plan(), &e))?;
    Ok(orbit.period)
}

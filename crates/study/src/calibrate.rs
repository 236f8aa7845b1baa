//! `dwell calibrate`: the scene value that gives a wanted period of the free motion.

use crate::error::StudyError;
use crate::motion_error::explain_motion;
use crate::outcome::Outcome;
use crate::prepare::{Prepared, model};
use crate::words::{digits, number};
use dwell_dynamics::{Orbit, root};
use dwell_scene::{Place, Scene};

/// A calibrated value.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// The path of the value in the scene.
    pub path: String,
    /// Its unit in the scene.
    pub unit: String,
    /// The value the scene has.
    pub present: f64,
    /// The period it gives, s.
    pub present_period: f64,
    /// The value found.
    pub found: f64,
    /// The period that was wanted, s.
    pub period: f64,
}

/// Farthest a value is sought from the present one, as a factor, and the first step on the way.
const FARTHEST: f64 = 1e6;
const FIRST: f64 = 1.0 + 1.0 / 64.0;
/// How often a step is halved that takes the mechanism apart.
const HALVINGS: usize = 12;

/// Finds the value at `path` that gives the `period` (s): outwards from the present value until
/// the period is passed, then to rounding.
///
/// # Errors
/// [`StudyError::Scene`] when there is no such value, the motion has no period, or no value between
/// a millionth and a million times the present one gives it.
pub fn find_value(scene: &Scene, path: &str, period: f64) -> Result<Calibrated, StudyError> {
    let present = scene.value(path)?;
    let unit = scene.unit_of(path).to_owned();
    let refuse = |message: String, help: &str| -> StudyError {
        let at = [(scene.place_of(path), "the value to be found".to_owned())];
        scene.error(message, Some(help.to_owned()), &at).into()
    };
    if !(period.is_finite() && period > 0.0) {
        return Err(scene
            .error(
                format!("the wanted period {period} s is not a positive time"),
                Some("give a time in seconds, such as 5.42".to_owned()),
                &[(Place::Calibration, "the period of this motion".to_owned())],
            )
            .into());
    }
    let present_period = period_of(scene)?;
    let calibrated = |found: f64| Calibrated {
        path: path.to_owned(),
        unit: unit.clone(),
        present,
        present_period,
        found,
        period,
    };
    if present_period == period {
        return Ok(calibrated(present));
    }
    if present == 0.0 {
        return Err(refuse(
            format!("`{path}` is zero, and a value is sought from the present one outwards"),
            "give it a rough value in the scene first",
        ));
    }
    let period_with = |value: f64| period_of(&scene.with_value(path, value)?);
    let search = Search::outwards(present, present_period, period, &period_with);
    let Some((a, b)) = search.bracket else {
        let [from, to] = search.values.map(|v| digits(v, 3));
        let [shortest, longest] = search.periods.map(number);
        let met = if shortest == longest {
            format!("the period stays {shortest} s")
        } else {
            format!("it gives periods from {shortest} to {longest} s")
        };
        return Err(refuse(
            format!(
                "no value of `{path}` gives the period {} s: from {from} to {to} {unit} {met}",
                number(period)
            ),
            if search.ended {
                "beyond these values there is no turning motion to have a period"
            } else {
                "set another value, or ask for a period between these"
            },
        ));
    };
    let miss = |value: f64| -> Result<f64, StudyError> { Ok(period_with(value)? - period) };
    let found = root::zero(miss, a, b)?.ok_or_else(|| {
        refuse(
            format!(
                "the period jumps over {} s between {} and {} {unit} of `{path}`",
                number(period),
                number(a),
                number(b)
            ),
            "the mechanism changes its assembly branch there",
        )
    })?;
    Ok(calibrated(found))
}

/// What the search for a wanted period met.
struct Search {
    /// Two values between which the period is passed.
    bracket: Option<(f64, f64)>,
    /// The smallest and the largest value tried with success.
    values: [f64; 2],
    /// The shortest and the longest period met, s.
    periods: [f64; 2],
    /// Whether the mechanism came apart, or lost its whole turns, on the way.
    ended: bool,
}

impl Search {
    /// Outwards from a value, both ways, in steps that double. Where a step takes the mechanism
    /// apart it is halved, so that the values near the end are tried as well.
    fn outwards(
        present: f64,
        present_period: f64,
        wanted: f64,
        period_with: &impl Fn(f64) -> Result<f64, StudyError>,
    ) -> Self {
        let mut search = Self {
            bracket: None,
            values: [present; 2],
            periods: [present_period; 2],
            ended: false,
        };
        // Whether the mechanism moves with a value; the bracket, if the period is passed.
        let moves = |search: &mut Self, last: f64, next: f64| {
            let Ok(period) = period_with(next) else {
                search.ended = true;
                return false;
            };
            if (period - wanted) * (present_period - wanted) <= 0.0 {
                search.bracket = Some((last, next));
            }
            search.values = [search.values[0].min(next), search.values[1].max(next)];
            search.periods = [search.periods[0].min(period), search.periods[1].max(period)];
            true
        };
        let mut ends = [Some(present), Some(present)];
        let mut factor = FIRST;
        loop {
            for (end, next) in ends.iter_mut().zip([present * factor, present / factor]) {
                let Some(last) = *end else { continue };
                *end = moves(&mut search, last, next).then_some(next);
                if end.is_none() {
                    let (mut good, mut bad) = (last, next);
                    for _ in 0..HALVINGS {
                        let middle = 0.5 * (good + bad);
                        if search.bracket.is_some() {
                            break;
                        } else if moves(&mut search, good, middle) {
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
            if factor >= FARTHEST {
                return search;
            }
            factor = (factor * factor).min(FARTHEST);
        }
    }
}

fn period_of(scene: &Scene) -> Result<f64, StudyError> {
    let exact = model(scene, &[])?;
    let Some(motion) = &scene.motion else {
        return Err(scene
            .error(
                "a period needs a [motion]".to_owned(),
                Some("add [motion] with `speed` and `periods`".to_owned()),
                &[(Place::Whole, "there is no [motion] in this file".to_owned())],
            )
            .into());
    };
    let start = dwell_dynamics::State {
        t: 0.0,
        q: motion.start[0],
        q_dot: motion.speed[0],
    };
    let turn =
        Orbit::new(&exact, start).map_err(|e| explain_motion(scene, exact.model().plan(), &e))?;
    Ok(turn.period)
}

/// `dwell calibrate`, with the path and the period of the scene's `[calibration]` where none is given.
///
/// # Errors
/// As [`find_value`]; when neither the caller nor the scene says what is wanted; when a length is
/// driven or there are loads, which a free motion does not know.
pub fn calibrate(
    scene: &Scene,
    path: Option<&str>,
    period: Option<f64>,
) -> Result<Outcome, StudyError> {
    Prepared::for_angle(scene, true)?;
    let wanted = scene.calibration.as_ref();
    let path = path.or(wanted.map(|c| c.path.as_str()));
    let period = period.or(wanted.map(|c| c.period));
    let (Some(path), Some(period)) = (path, period) else {
        return Err(scene
            .error(
                "nothing says which value to set, or the wanted period".to_owned(),
                Some(
                    "give --set BODY.inertia and --period SECONDS, or a [calibration] in the scene"
                        .to_owned(),
                ),
                &[(
                    Place::Whole,
                    "there is no [calibration] in this file".to_owned(),
                )],
            )
            .into());
    };
    let found = find_value(scene, path, period)?;
    Ok(Outcome {
        summary: format!(
            "{}: {} = {} {} gives the period {} s\n  the scene has {} {}, which gives {} s\n",
            scene.title,
            found.path,
            digits(found.found, 12),
            found.unit,
            digits(found.period, 12),
            digits(found.present, 12),
            found.unit,
            digits(found.present_period, 13),
        ),
        ..Outcome::default()
    })
}

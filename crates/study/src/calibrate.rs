//! `dwell calibrate`: the scene value that gives a wanted period of the free motion.

use crate::error::{StudyError, explain_motion};
use crate::outcome::Outcome;
use crate::prepare::{Prepared, model};
use dwell_dynamics::{FreeTurn, root};
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

/// Farthest a value is sought from the present one, as a factor.
const FARTHEST: f64 = 1e6;

/// Finds the value at `path` that gives the `period` (s): outwards from the present value until
/// the period is passed, then to rounding.
///
/// # Errors
/// [`StudyError::Scene`] when there is no such value, the motion has no period, or no value between
/// a millionth and a million times the present one gives it.
pub fn find_value(scene: &Scene, path: &str, period: f64) -> Result<Calibrated, StudyError> {
    let present = scene.value(path)?;
    let refuse = |message: String, help: &str| -> StudyError {
        let at = [(Place::Calibration, String::new())];
        scene.error(message, Some(help.to_owned()), &at).into()
    };
    if !(period.is_finite() && period > 0.0) {
        return Err(refuse(
            format!("the wanted period {period} s is not a positive time"),
            "give a period in seconds, such as --period 5.42",
        ));
    }
    let present_period = period_of(scene)?;
    let miss = |value: f64| -> Result<f64, StudyError> {
        Ok(period_of(&scene.with_value(path, value)?)? - period)
    };
    let here = present_period - period;
    if here == 0.0 || present == 0.0 {
        if present == 0.0 {
            return Err(refuse(
                format!("{path} is zero, and a value is sought from the present one outwards"),
                "give it a rough value first",
            ));
        }
        return Ok(Calibrated {
            found: present,
            path: path.to_owned(),
            unit: scene.unit_of(path).to_owned(),
            present,
            present_period,
            period,
        });
    }
    let found = bracket(present, here, &miss).map_or_else(
        || {
            Err(refuse(
                format!(
                    "no value of {path} between {:e} and {:e} gives the period {period} s",
                    present / FARTHEST,
                    present * FARTHEST
                ),
                "the period may not depend on it, or a change of it may take the mechanism apart",
            ))
        },
        |(a, b)| {
            root::zero(&miss, a, b)?.ok_or_else(|| {
                refuse(
                    format!("the period does not pass {period} s between {path} = {a} and {b}"),
                    "it jumps there: look at the assembly branch",
                )
            })
        },
    )?;
    Ok(Calibrated {
        path: path.to_owned(),
        unit: scene.unit_of(path).to_owned(),
        present,
        present_period,
        found,
        period,
    })
}

/// Two values between which the period is passed, in steps that double. A value that takes the
/// mechanism apart ends the search on its side.
fn bracket(
    present: f64,
    here: f64,
    miss: &impl Fn(f64) -> Result<f64, StudyError>,
) -> Option<(f64, f64)> {
    let (mut up, mut down) = (Some(present), Some(present));
    let mut factor = 1.0 + 1.0 / 64.0;
    while factor < FARTHEST {
        for (end, next) in [(&mut up, present * factor), (&mut down, present / factor)] {
            let Some(last) = *end else { continue };
            *end = match miss(next) {
                Ok(value) if value == 0.0 || value.signum() != here.signum() => {
                    return Some((last, next));
                }
                Ok(_) => Some(next),
                Err(_) => None,
            };
        }
        factor *= factor;
    }
    None
}

fn period_of(scene: &Scene) -> Result<f64, StudyError> {
    let exact = model(scene, &[])?;
    let Some(motion) = &scene.motion else {
        return Err(scene
            .error(
                "a period needs a [motion]".to_owned(),
                Some("add [motion] with start and speed".to_owned()),
                &[(Place::Whole, String::new())],
            )
            .into());
    };
    let start = dwell_dynamics::State {
        t: 0.0,
        q: motion.start[0],
        q_dot: motion.speed[0],
    };
    let turn = FreeTurn::new(&exact, start)
        .map_err(|e| explain_motion(scene, exact.model().plan(), &e))?;
    Ok(turn.period)
}

/// `dwell calibrate`, with the path and the period of the scene's `[calibration]` where none is given.
///
/// # Errors
/// As [`find_value`]; and when neither the caller nor the scene says what is wanted.
pub fn calibrate(
    scene: &Scene,
    path: Option<&str>,
    period: Option<f64>,
) -> Result<Outcome, StudyError> {
    Prepared::new(scene)?;
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
                &[(Place::Whole, String::new())],
            )
            .into());
    };
    let found = find_value(scene, path, period)?;
    Ok(Outcome {
        summary: format!(
            "{}: {} = {:.12} {} gives the period {} s\n  the scene has {} {}, which gives {:.12} s\n",
            scene.title,
            found.path,
            found.found,
            found.unit,
            found.period,
            found.present,
            found.unit,
            found.present_period,
        ),
        ..Outcome::default()
    })
}

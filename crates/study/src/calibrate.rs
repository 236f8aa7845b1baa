//! `dwell calibrate`: the scene value that gives a required period of the free motion.

use crate::estimate;
use crate::explain::{StudyError, explain_machine, missing_section_label, scene_error};
use crate::machines::MachineScene;
use crate::models::{compile_model, reduced_model};
use crate::number_format::{digits, number};
use crate::ranges::extent;
use crate::space::PreparedSpaceScene;
use crate::sweep::compute::SweptScene;
#[cfg(feature = "output")]
use crate::{number_format::digits_within, output::Outcome};
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, MovingModel, Orbit, ReducedState};
#[cfg(feature = "output")]
use dwell_findings::Record;
use dwell_kinetostatics::{ExactModel, Load, Model, space};
use dwell_numerics::root;
use dwell_scene::{PlaneScene, SceneLocation, SpaceScene};

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
    /// The estimated error of that period, s.
    pub current_period_error: f64,
    /// The value found.
    pub value: f64,
    /// Its estimated error: the error of the period over the derivative of the period by the value.
    pub value_error: f64,
    /// The required period, s.
    pub period: f64,
}

/// Largest factor between the value in the scene and a trial value, and the first factor.
const MAX_FACTOR: f64 = 1e6;
const FIRST_FACTOR: f64 = 1.0 + 1.0 / 64.0;
/// Relative change of the value for the slope of the period.
const DIFFERENCE: f64 = 1e-5;
/// Number of bisections after a step to a value that has no period.
const BISECTIONS: usize = 12;

/// Finds the value at `path` that gives the `period` (s): brackets it outwards from the present value, then
/// refines to rounding.
///
/// # Errors
/// [`StudyError::Scene`] when there is no such value, the motion has no period, or no value between
/// a millionth and a million times the present one gives it.
pub fn find_value(
    scene: &impl CalibratedScene,
    path: &str,
    period: f64,
) -> Result<CalibrationResult, StudyError> {
    let current = scene.value(path)?;
    let unit = scene.unit_of(path);
    let refuse = |message: String, help: &str| {
        let place = (scene.location_of(path), "the value to calibrate");
        scene_error(scene, message, help, [place])
    };
    if !(period.is_finite() && period > 0.0) {
        return Err(scene_error(
            scene,
            format!("the required period {period} s is not a positive time"),
            "give a time in seconds, such as 5.42",
            [(SceneLocation::Calibration, "the period of this motion")],
        ));
    }
    scene.reject_unknown_columns()?;
    let (current_period, current_period_error) = period_with_error(scene)?;
    let period_with = |value: f64| period_of(&scene.varied(&[(path, value)])?);
    let result = |value: f64| {
        Ok(CalibrationResult {
            path: path.to_owned(),
            unit: unit.clone(),
            current,
            current_period,
            current_period_error,
            value,
            value_error: value_error(scene, path, value, period)?,
            period,
        })
    };
    if current_period == period {
        return result(current);
    }
    if current == 0.0 {
        let message = "is zero, but the search multiplies the value in the scene by factors";
        let help = "give an approximate value in the scene first";
        return Err(refuse(format!("`{path}` {message}"), help));
    }
    let search = BracketSearch::outwards(current, current_period, period, &period_with);
    let (a, b) = search.bracket.ok_or_else(|| {
        let (found, help) = search.describe(&unit);
        let required = number(period);
        let message = format!("no value of `{path}` gives the period {required} s: {found}");
        refuse(message, help)
    })?;
    let residual = |value: f64| -> Result<f64, StudyError> { Ok(period_with(value)? - period) };
    let value = root::find(residual, a, b)?.ok_or_else(|| {
        let [period, a, b] = [period, a, b].map(number);
        let between = format!("between {a} and {b} {unit} of `{path}`");
        let message = format!("the period is discontinuous at {period} s, {between}");
        refuse(message, "the mechanism changes its assembly mode there")
    })?;
    result(value)
}

/// The error of a value that gives a period (s): the error of the period over its derivative by the value.
fn value_error(
    scene: &impl CalibratedScene,
    path: &str,
    value: f64,
    period: f64,
) -> Result<f64, StudyError> {
    let (_, error) = period_with_error(&scene.varied(&[(path, value)])?)?;
    let step = DIFFERENCE * value.abs().max(f64::MIN_POSITIVE);
    let period_with = |value: f64| period_of(&scene.varied(&[(path, value)])?);
    let slope = match (period_with(value + step), period_with(value - step)) {
        (Ok(above), Ok(below)) => 0.5 * (above - below).abs() / step,
        // Next to a value without a period.
        (Ok(beside), Err(_)) | (Err(_), Ok(beside)) => (beside - period).abs() / step,
        (Err(error), Err(_)) => return Err(error),
    };
    Ok(error / slope + f64::EPSILON * value.abs())
}

/// The search for a bracket of the required period.
struct BracketSearch {
    /// Two values whose periods bracket the required one.
    bracket: Option<(f64, f64)>,
    /// The values that have a period, each with its period, s.
    found: Vec<[f64; 2]>,
    /// Whether a trial value had no period.
    left_range: bool,
}

impl BracketSearch {
    /// The values tried with their periods, and a suggestion.
    fn describe(&self, unit: &str) -> (String, &'static str) {
        let extent_of = |k: usize| extent(self.found.iter().map(|found| found[k]));
        let [from, to] = extent_of(0).map(|v| digits(v, 3));
        let periods = match extent_of(1).map(number) {
            [shortest, longest] if shortest == longest => format!("the period stays {shortest} s"),
            [shortest, longest] => format!("it gives periods from {shortest} to {longest} s"),
        };
        let help = if self.left_range {
            "beyond these values the motion has no period"
        } else {
            "calibrate another value, or require a period within this interval"
        };
        (format!("from {from} to {to} {unit} {periods}"), help)
    }

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
            found: vec![[current, current_period]],
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
            search.found.push([next, period]);
            true
        };
        let mut outermost = [Some(current), Some(current)];
        let mut factor = FIRST_FACTOR;
        loop {
            let next = [current * factor, current / factor];
            for (outer, next) in outermost.iter_mut().zip(next) {
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

fn period_of(scene: &impl CalibratedScene) -> Result<f64, StudyError> {
    Ok(orbit_of(scene)?.0.period)
}

/// A scene that can be calibrated.
pub trait CalibratedScene: SweptScene {
    /// The equation of motion of its only coordinate, without losses, drives and prescribed motions.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if it has drives or losses, or several coordinates.
    fn conservative_motion(&self) -> Result<ConservativeMotion<Self::Model>, StudyError>;

    /// The path and the period, s, of its `[calibration]`, if it has one.
    fn calibration(&self) -> Option<(&str, f64)> {
        None
    }
}

/// The equation of motion of a scene without losses, drives and prescribed motions.
#[derive(Debug)]
pub enum ConservativeMotion<M: MovingModel> {
    /// The equation of motion of a driven angle without loads.
    Unloaded(Box<ExactModel>),
    /// The equation of motion of a length, or with loads that all have a potential, or in space.
    Loaded(Box<Machine<M>>),
}

impl<M: MovingModel> ConservativeMotion<M> {
    fn orbit(&self, start: ReducedState) -> Result<Orbit, DynamicsError> {
        match self {
            Self::Unloaded(exact) => Orbit::new(exact.as_ref(), start),
            Self::Loaded(machine) => Orbit::loaded(machine, start),
        }
    }
}

impl CalibratedScene for PlaneScene {
    fn conservative_motion(&self) -> Result<ConservativeMotion<Model>, StudyError> {
        // A separating force changes no motion.
        let is_loaded = self.loads.iter().any(Load::does_work);
        refuse_drives(self)?;
        let has_no_potential = |load: &Load| load.does_work() && !load.is_conservative();
        if let Some(load) = self.loads.iter().position(has_no_potential) {
            return Err(without_potential(self, load));
        }
        let exact = reduced_model(self, &[])?;
        if !is_loaded && exact.model().plan().is_angle(0) {
            return Ok(ConservativeMotion::Unloaded(Box::new(exact)));
        }
        let model = compile_model(self, &[])?;
        let machine = Machine::new(model, &self.loads, vec![CoordinateMode::Free], &[])
            .map_err(|e| explain_machine(self, e))?;
        Ok(ConservativeMotion::Loaded(Box::new(machine)))
    }

    fn calibration(&self) -> Option<(&str, f64)> {
        let section = self.calibration.as_ref()?;
        Some((&section.path, section.period))
    }
}

impl CalibratedScene for SpaceScene {
    fn conservative_motion(&self) -> Result<ConservativeMotion<space::Model>, StudyError> {
        refuse_drives(self)?;
        let has_no_potential = |load: &space::Load| !load.is_conservative();
        if let Some(load) = self.loads.iter().position(has_no_potential) {
            return Err(without_potential(self, load));
        }
        // Its error names the actuators where there are several.
        PreparedSpaceScene::new(self)?;
        Ok(ConservativeMotion::Loaded(Box::new(self.machine(&[])?)))
    }
}

fn refuse_drives(scene: &impl MachineScene) -> Result<(), StudyError> {
    if scene.drives().is_empty() {
        return Ok(());
    }
    Err(scene_error(
        scene,
        "calibration needs the period of a motion without drives",
        "remove the drives, or try values with `dwell simulate` or `dwell sweep --result cycle`",
        [(SceneLocation::Drive(0), "this drive would be ignored")],
    ))
}

fn without_potential(scene: &impl MachineScene, load: usize) -> StudyError {
    scene_error(
        scene,
        format!(
            "calibration needs the period of a motion without losses: `{}` has no potential",
            scene.load_name(load).unwrap_or_default()
        ),
        "remove it, or try values with `dwell sweep --result motion`",
        [(SceneLocation::Load(load), "no potential")],
    )
}

/// An error of the motion in the names of the scene.
fn explained(scene: &impl CalibratedScene, error: &DynamicsError) -> StudyError {
    match scene.machine(&[]) {
        Ok(machine) => scene.explain(machine.model(), error),
        Err(other) => other,
    }
}

/// The period of a scene's motion, and its error, s.
fn period_with_error(scene: &impl CalibratedScene) -> Result<(f64, f64), StudyError> {
    let (orbit, motion, start) = orbit_of(scene)?;
    let perturbed = |factor: f64| {
        let q_dot = start.q_dot * factor;
        motion.orbit(ReducedState { q_dot, ..start })
    };
    let error = estimate::of_period(&orbit, perturbed).map_err(|e| explained(scene, &e))?;
    Ok((orbit.period, error))
}

/// An orbit, its equation of motion, and its initial state.
type FoundOrbit<M> = (Orbit, ConservativeMotion<M>, ReducedState);

fn orbit_of<S: CalibratedScene>(scene: &S) -> Result<FoundOrbit<S::Model>, StudyError> {
    let motion = scene.conservative_motion()?;
    let start = scene.motion_start();
    let (true, Some(&q), Some(&q_dot)) = (
        scene.has_motion(),
        start.coordinates.first(),
        start.velocities.first(),
    ) else {
        return Err(scene_error(
            scene,
            "a period needs a [motion]",
            "add [motion] with `speed` and `periods`",
            missing_section_label("motion"),
        ));
    };
    let start = ReducedState { t: 0.0, q, q_dot };
    let orbit = motion.orbit(start).map_err(|e| explained(scene, &e))?;
    Ok((orbit, motion, start))
}

/// `dwell calibrate`, with the path and the period of the scene's `[calibration]` as defaults.
///
/// # Errors
/// As [`find_value`]; when neither the caller nor the scene gives path and period; when there are drives, or loads without
/// a potential.
#[cfg(feature = "output")]
pub fn calibrate<S: CalibratedScene>(
    scene: &S,
    path: Option<&str>,
    period: Option<f64>,
) -> Result<Outcome, StudyError> {
    scene.conservative_motion()?;
    let note = scene.assembly_note(scene.machine(&[])?.model());
    let section = scene.calibration();
    let path = path.or(section.map(|(path, _)| path));
    let period = period.or(section.map(|(_, period)| period));
    let (Some(path), Some(period)) = (path, period) else {
        return Err(scene_error(
            scene,
            "the value to calibrate or the required period is not given",
            "give --parameter BODY.inertia and --period SECONDS, or a [calibration] in the scene",
            missing_section_label("calibration"),
        ));
    };
    let result = find_value(scene, path, period)?;
    let (title, unit) = (&scene.title, &result.unit);
    let [value_error, period_error] = [result.value_error, result.current_period_error];
    let mut record = Record::default();
    record.add("required_period", "s", period);
    record.add_within(path, unit, result.value, value_error);
    record.add("error.value", unit, value_error);
    record.add("scene.value", unit, result.current);
    record.add_within("scene.period", "s", result.current_period, period_error);
    record.add("error.period", "s", period_error);
    let [period, current] = [result.period, result.current].map(|v| digits(v, 12));
    let value = digits_within(result.value, value_error, 12);
    let current_period = digits_within(result.current_period, period_error, 13);
    Ok(Outcome {
        record,
        summary: format!(
            "{title}: {path} = {value} {unit} gives the period {period} s\n  the scene has {current} {unit}, which gives \
             {current_period} s\n  estimated errors: {value_error:.1e} {unit}, {period_error:.1e} s\n{note}"
        ),
        ..Outcome::default()
    })
}

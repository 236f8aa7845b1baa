//! What rounding does to a scene's results: its states evaluated in three lengths of numbers, of which the
//! longest tells the errors of the others.

use crate::error::StudyError;
use crate::run::model;
use dwell_findings::Finding;
use dwell_geometry::{Scalar, Wide};
use dwell_kinetostatics::{KinetostaticsError, Model};
use dwell_scene::Scene;
use dwell_verify::State;
use rayon::prelude::*;

/// The truth's name.
const TRUTH: &str = "10 more digits";
/// What a plain evaluation may lose: measured over all cases, 3e-15; a sum of a hundred rounded terms.
const PLAIN: f64 = 1e-13;
/// The error of every actuator's action and every reaction in one state, as a part of the largest of its unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rounded {
    /// Time, s.
    pub(crate) t: f64,
    /// The worst of `f64`.
    pub(crate) plain: f64,
    /// Of what.
    pub(crate) worst: String,
    /// The worst of `f32`; none where there is no pose in them.
    pub(crate) short: Option<f64>,
}

/// All states of a case.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rounding {
    pub(crate) states: Vec<Rounded>,
}

/// Actions and reactions in one state, in any kind of number.
fn evaluate<T: Scalar>(model: &Model, state: &State) -> Result<Vec<T>, KinetostaticsError> {
    let lift = |values: &[f64]| -> Vec<T> { values.iter().map(|&v| T::lift(v)).collect() };
    let (mut work, mut actions) = (model.workspace(), model.actions());
    let [q, q_dot, q_ddot] = [&state.q, &state.q_dot, &state.q_ddot].map(|v| lift(v));
    model.kinetostatics(state.t, &q, &q_dot, &q_ddot, &mut work, &mut actions)?;
    let mut all = actions.tau;
    all.extend(actions.reactions);
    Ok(all)
}

impl Rounding {
    /// Evaluates states of a scene in `f32`, `f64` and two words.
    ///
    /// # Errors
    /// [`StudyError`] when the mechanism cannot be put together.
    pub(crate) fn new(scene: &Scene, states: &[State]) -> Result<Self, StudyError> {
        let model = model(scene)?;
        let wide: Vec<Option<Vec<Wide>>> = states
            .par_iter()
            .map(|state| evaluate(&model, state).ok())
            .collect();
        let mechanism = &scene.mechanism;
        let drives = mechanism.actuators.iter().map(|a| {
            let unit = if a.coordinate().is_angle() {
                "N m"
            } else {
                "N"
            };
            (a.name.clone(), unit)
        });
        let reactions = mechanism.reactions().into_iter();
        let reactions = reactions.map(|r| (mechanism.reaction_name(r), r.component.unit()));
        let named: Vec<(String, &str)> = drives.chain(reactions).collect();
        let largest = |unit: &str| {
            let of = |all: &Vec<Wide>| {
                let some = named.iter().zip(all).filter(|((_, u), _)| *u == unit);
                some.fold(0.0_f64, |most, (_, v)| most.max(v.value().abs()))
            };
            wide.iter().flatten().map(of).fold(0.0, f64::max)
        };
        let scales: Vec<f64> = named.iter().map(|(_, unit)| largest(unit)).collect();
        let judged = states.par_iter().zip(&wide).filter_map(|(state, wide)| {
            let wide = wide.as_ref()?;
            let (plain, k) = worst(&evaluate::<f64>(&model, state).ok()?, wide, &scales);
            let short = evaluate::<f32>(&model, state).ok();
            Some(Rounded {
                t: state.t,
                plain,
                worst: named.get(k).map_or(String::new(), |n| n.0.clone()),
                short: short.map(|short| worst(&short, wide, &scales).0),
            })
        });
        Ok(Self {
            states: judged.collect(),
        })
    }

    /// The largest errors of `f64`, with its state, and of `f32`.
    pub(crate) fn worst(&self) -> Option<(&Rounded, Option<f64>)> {
        let plain = self
            .states
            .iter()
            .max_by(|a, b| a.plain.total_cmp(&b.plain))?;
        let short = self.states.iter().filter_map(|s| s.short);
        Some((plain, short.reduce(f64::max)))
    }
}

/// The largest difference from the wide values, and which it is.
fn worst<T: Scalar>(values: &[T], wide: &[Wide], scales: &[f64]) -> (f64, usize) {
    let mut found = (0.0, 0);
    for (k, ((&value, &wide), &scale)) in values.iter().zip(wide).zip(scales).enumerate() {
        let off = (Wide::lift(value.value()) - wide).abs().value();
        let part = if off == 0.0 { 0.0 } else { off / scale };
        if part > found.0 || part.is_nan() {
            found = (part, k);
        }
    }
    found
}

/// The one finding: the error of `f64`.
pub(crate) fn finding(rounding: &Rounding) -> Option<Finding> {
    let (plain, short) = rounding.worst()?;
    let (condition, lost) = match short {
        None => (1.0, "no pose in f32".to_owned()),
        Some(short) => (
            short / f64::from(f32::EPSILON),
            format!("f32 errs by {short:.0e}, which tells the condition"),
        ),
    };
    Some(Finding {
        key: "rounding".to_owned(),
        truth: TRUTH.to_owned(),
        compared: "actions and reactions in f64 with the same in numbers of 32 digits".to_owned(),
        over: format!("{} states", rounding.states.len()),
        absolute: plain.plain,
        unit: String::new(),
        relative: plain.plain,
        scale: "the largest of the same unit in all states".to_owned(),
        worst: format!("t = {} s, {}", plain.t, plain.worst),
        tolerance: PLAIN,
        why: format!("roundings of a plain evaluation; {lost}"),
        condition,
        integrated: false,
        pass: plain.plain <= PLAIN,
    })
}

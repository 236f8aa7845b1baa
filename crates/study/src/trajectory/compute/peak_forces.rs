//! The largest actuator forces and reactions along a trajectory, without other results, for parameter sweeps with
//! thousands of scenes.

use crate::explain::StudyError;
use crate::trajectory::compute::{
    Analysis, ForceEvaluator, Point, RowScene, Trajectory, highest_between,
};
use dwell_kinetostatics::{InverseDynamics, Model};
use dwell_scene::PlaneScene;

/// Number of local maxima of a force around which its largest value is searched for between the positions.
const REFINED: usize = 2;

/// The forces whose largest values are wanted, by their indices.
#[derive(Debug, Default)]
pub(crate) struct WantedForces {
    /// Among the reactions of the mechanism.
    pub(crate) reactions: Vec<usize>,
    /// Among the actuators.
    pub(crate) actuators: Vec<usize>,
}

/// The analysis for peak forces: along the scene's motion or sweep, or statics over its range.
pub(crate) fn peak_analysis(scene: &impl RowScene) -> Option<Analysis> {
    if let (Some(_), _) | (_, Some(_)) = scene.prescribed() {
        return Some(Analysis::Kinetostatics);
    }
    let is_single = scene.assembly_coordinates().len() == 1;
    (is_single && !scene.load_names().is_empty()).then_some(Analysis::Statics)
}

/// The largest absolute values of statics or kinetostatics along the scene's trajectory: of the wanted forces also between
/// its positions.
///
/// # Errors
/// [`StudyError::Scene`] where the scene defines no trajectory, or it ends early.
pub(crate) fn peak_forces(
    scene: &PlaneScene,
    model: &Model,
    analysis: Analysis,
    wanted: &WantedForces,
) -> Result<InverseDynamics<f64>, StudyError> {
    let followed = scene.followed(model);
    let trajectory = Trajectory::new(&followed, analysis, None)?;
    trajectory.check_laws(&followed)?;
    let mut evaluator = ForceEvaluator::new(scene, model, analysis);
    // Only couplings have functions that may jump.
    let has_couplings = !scene.mechanism.couplings.is_empty();
    let mut peaks = model.result_buffer();
    let mut curves = [
        vec![Vec::<Point>::new(); wanted.reactions.len()],
        vec![Vec::new(); wanted.actuators.len()],
    ];
    let early_stop = trajectory.follow::<PlaneScene>(model, |k, sample| {
        evaluator.evaluate(sample, trajectory.load_time(sample))?;
        if has_couplings {
            evaluator.fill_states(sample)?;
        }
        let results = &evaluator.results;
        raise_to(&mut peaks.reactions, &results.reactions);
        raise_to(&mut peaks.tau, &results.tau);
        let [reactions, actuators] = &mut curves;
        let u = trajectory.fraction_at(k);
        for (curve, &r) in reactions.iter_mut().zip(&wanted.reactions) {
            curve.push([u, results.reactions[r].abs()]);
        }
        for (curve, &i) in actuators.iter_mut().zip(&wanted.actuators) {
            curve.push([u, results.tau[i].abs()]);
        }
        Ok(())
    });
    if let Some(stop) = early_stop {
        return Err(scene.explain_stop(model, stop));
    }
    let [reactions, actuators] = &curves;
    let mut largest = |curve: &[Point], pick: &dyn Fn(&InverseDynamics<f64>) -> f64| {
        let mut value = |u: f64| {
            let sample = trajectory.sample_at(u);
            let t = trajectory.load_time(&sample);
            evaluator.evaluate(&sample, t).ok()?;
            Some(pick(&evaluator.results).abs()).filter(|value| value.is_finite())
        };
        highest_between(curve, REFINED, &mut value).map_or(f64::NAN, |[_, value]| value)
    };
    for (curve, &r) in reactions.iter().zip(&wanted.reactions) {
        peaks.reactions[r] = largest(curve, &|results| results.reactions[r]);
    }
    for (curve, &i) in actuators.iter().zip(&wanted.actuators) {
        peaks.tau[i] = largest(curve, &|results| results.tau[i]);
    }
    Ok(peaks)
}

fn raise_to(peaks: &mut [f64], values: &[f64]) {
    for (peaks, values) in peaks.iter_mut().zip(values) {
        *peaks = peaks.max(values.abs());
    }
}

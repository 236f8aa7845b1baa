//! The results that a sweep computes from a scene, in the plane or in space.

use crate::explain::StudyError;
use crate::sweep::compute::available::Available;
use crate::sweep::compute::motions::{
    cycle_quantities, cycle_values, motion_quantities, motion_values,
};
use crate::sweep::compute::point::{ResultKind, Results};
use crate::sweep::compute::signals::{along_values, signals};
use crate::sweep::compute::targets::Target;
use crate::sweep::compute::{RequestedQuantities, SweptScene};
use crate::trajectory::compute::{analysis_along, peak_analysis};
use dwell_dynamics::{DynamicsError, Orbit, ReducedState};
use dwell_kinetostatics::ReducibleModel as _;

/// Every quantity that the sections of a scene allow.
///
/// # Errors
/// [`StudyError`] if it cannot be assembled.
pub(super) fn available_quantities(scene: &impl SweptScene) -> Result<Available, StudyError> {
    let compiled = scene.unloaded_rows()?;
    let mut all = Available {
        notes: scene.notes(&compiled)?,
        ..Available::default()
    };
    let has_peaks = peak_analysis(scene).is_some();
    let actuators: Vec<(&str, bool)> = (0..).map_while(|k| scene.actuator(k)).collect();
    let reactions = || scene.swept_reactions(&compiled);
    if let [(_, is_angle)] = actuators[..] {
        all.add_inertia(is_angle);
        if is_conservative(scene, &compiled) {
            let of_motion = if has_peaks { Vec::new() } else { reactions() };
            all.add_orbit(is_angle, of_motion);
        }
    }
    if has_peaks {
        all.add_peaks(actuators.into_iter(), reactions());
    }
    all.add_all(ResultKind::Motion, motion_quantities(scene, &compiled));
    all.add_all(ResultKind::Cycle, cycle_quantities(scene));
    if let Some(analysis) = analysis_along(scene) {
        all.targets = Target::all(scene)?;
        let signals = signals(scene, &compiled, analysis, &all.targets);
        for (k, target) in all.targets.iter().enumerate() {
            target.check(scene, k, &signals)?;
        }
        all.add_along(&signals, analysis);
    }
    Ok(all)
}

/// The names of all results of a scene.
///
/// # Errors
/// As of [`available_quantities`].
pub(crate) fn result_names(scene: &impl SweptScene) -> Result<Vec<String>, StudyError> {
    let all = available_quantities(scene)?.quantities.into_iter();
    Ok(all.map(|quantity| quantity.name).collect())
}

/// Computes the requested quantities of a scene, which is compiled once for all of them.
///
/// # Errors
/// [`StudyError`] if nothing can be computed; single failures are recorded in the results.
pub(super) fn compute_results<S: SweptScene>(
    scene: &S,
    requested: &RequestedQuantities,
    results: &mut Results<'_>,
) -> Result<(), StudyError> {
    use ResultKind::{
        Cycle, FreeReaction, FreeReactionPlace, Inertia, InertiaPlace, Motion, Orbit as OrbitKind,
        Range,
    };
    let compiled = scene.unloaded_rows()?;
    let includes = |kinds: &[ResultKind]| requested.includes(kinds);
    if let Some((from, to)) = S::model_of(&compiled).range().limits() {
        results.set(Range, Ok(vec![from, to]));
    }
    if includes(&[Motion]) {
        results.set_named(Motion, motion_values(scene, &compiled));
    }
    if includes(&[Cycle]) {
        results.set(Cycle, cycle_values(scene));
    }
    if includes(&[Inertia, InertiaPlace]) {
        results.set_points([Inertia, InertiaPlace], scene.inertia_extremes(&compiled));
    }
    scene.reject_open(&compiled, requested)?;
    let of_reactions = includes(&[FreeReaction, FreeReactionPlace]);
    if (of_reactions || includes(&[OrbitKind]))
        && let Some(orbit) = free_orbit(scene, &compiled)
    {
        if let (true, Ok(orbit)) = (of_reactions, &orbit) {
            scene.compute_free_reactions(&compiled, orbit.energy, requested, results);
        }
        results.set(
            OrbitKind,
            orbit.map(|orbit| vec![orbit.period, orbit.energy]),
        );
    }
    let analysis = analysis_along(scene).filter(|_| requested.along().next().is_some());
    if let Some(analysis) = analysis {
        let rows = scene.with_all_loads(compiled)?;
        results.set_along(along_values(scene, &rows, analysis, requested));
    }
    Ok(())
}

/// The start of the motion of the only coordinate; `None` if a law prescribes it, or a drive acts on it.
fn start_of_free_motion(scene: &impl SweptScene) -> Option<ReducedState> {
    let start = scene.motion_start();
    let is_free = start.laws.iter().all(Option::is_none) && scene.drives().is_empty();
    let ([q], [q_dot]) = (&start.coordinates[..], &start.velocities[..]) else {
        return None;
    };
    (is_free && scene.has_motion()).then_some(ReducedState {
        t: 0.0,
        q: *q,
        q_dot: *q_dot,
    })
}

/// The orbit of the free motion of one coordinate.
fn free_orbit<S: SweptScene>(scene: &S, compiled: &S::Rows) -> Option<Result<Orbit, StudyError>> {
    let start = start_of_free_motion(scene)?;
    Some(scene.free_machine(compiled).and_then(|machine| {
        let orbit = Orbit::loaded(&machine, start);
        orbit.map_err(|error| scene.explain(machine.model(), &error))
    }))
}

/// Whether the scene has a conservative free motion of one coordinate.
fn is_conservative<S: SweptScene>(scene: &S, compiled: &S::Rows) -> bool {
    let Some(start) = start_of_free_motion(scene) else {
        return false;
    };
    scene.free_machine(compiled).is_ok_and(|machine| {
        let orbit = Orbit::loaded(&machine, start);
        !matches!(orbit, Err(DynamicsError::NotConservative { .. }))
    })
}

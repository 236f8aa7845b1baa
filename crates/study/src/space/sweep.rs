//! What scenes in space are swept for.

use super::explain::explain_position;
use super::motion::SpaceMotionProblem;
use super::prepared::{compile, range_limits};
use super::trajectory::{JointReactions, computed_rows};
use crate::explain::StudyError;
use crate::free_motion::compute::MotionSolver;
use crate::machines::MachineScene;
use crate::models::{SolverSettings, end_stops};
use crate::number_format::coordinate_unit;
use crate::progress::no_progress;
use crate::sweep::compute::{
    Available, Design, IndexedReaction, NamedUnit, RangeCurves, RequestedQuantities, ResultKind,
    Results, STATISTICS, SweptScene, VariantFamily, cycle_quantities, cycle_values, statistics,
};
use crate::trajectory::compute::{Analysis, ComputedTrajectory, Quantity};
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, Orbit, ReducedState};
use dwell_geometry::space::ActuatorKind;
use dwell_kinetostatics::ExactModel;
use dwell_kinetostatics::space::{Component, Model, Reaction};
use dwell_scene::{SceneError, SpaceScene};

impl SweptScene for SpaceScene {
    fn available_quantities(&self) -> Result<Available, StudyError> {
        let (reactions, _) = JointReactions::new(self)?;
        let mut all = Available::default();
        let has_peaks = peak_analysis(self).is_some();
        if let [actuator] = &self.mechanism.actuators[..] {
            let is_angle = matches!(actuator.kind, ActuatorKind::Angle(_));
            all.add_inertia(is_angle);
            if is_conservative(self) {
                let of_motion = match has_peaks {
                    true => Vec::new(),
                    false => indexed(self, &reactions),
                };
                all.add_orbit(is_angle, of_motion);
            }
        }
        if has_peaks {
            let actuators = self.mechanism.actuators.iter();
            let actuators =
                actuators.map(|a| (a.name.as_str(), matches!(a.kind, ActuatorKind::Angle(_))));
            all.add_peaks(actuators, indexed(self, &reactions));
        }
        all.add_all(ResultKind::Motion, motion_quantities(self, &reactions));
        all.add_all(ResultKind::Cycle, cycle_quantities(self));
        Ok(all)
    }

    fn compute_results(
        &self,
        requested: &RequestedQuantities,
        results: &mut Results<'_>,
    ) -> Result<(), StudyError> {
        let (reactions, model) = JointReactions::new(self)?;
        let includes = |kind: ResultKind| requested.includes(kind);
        if let Some((from, to)) = model.plan().range().limits() {
            results.set(ResultKind::Range, Ok(vec![from, to]));
        }
        if includes(ResultKind::Motion) {
            results.set_named(ResultKind::Motion, motion_values(self, &reactions));
        }
        if includes(ResultKind::Cycle) {
            results.set(ResultKind::Cycle, cycle_values(self));
        }
        if includes(ResultKind::Inertia) || includes(ResultKind::InertiaPlace) {
            let curves = range_curves(self, compile(self, &[])?, RangeCurves::of_inertia);
            let extremes = curves.map(|curves| curves.extremes());
            results.set_points([ResultKind::Inertia, ResultKind::InertiaPlace], extremes);
        }
        reject_open(self, &reactions, requested)?;
        compute_orbit(self, &reactions, requested, results);
        if (includes(ResultKind::Reaction) || includes(ResultKind::ActuatorForce))
            && let Some(analysis) = peak_analysis(self)
        {
            match peaks(self, (&reactions, &model), analysis) {
                Ok([of_reactions, of_actuators]) => {
                    results.set_named(ResultKind::Reaction, Ok(of_reactions));
                    results.set_named(ResultKind::ActuatorForce, Ok(of_actuators));
                }
                Err(error) => results.set(ResultKind::Reaction, Err(error)),
            }
        }
        Ok(())
    }

    fn varied(&self, values: &[(&str, f64)]) -> Result<Self, SceneError> {
        let mut scene = self.with_values(values)?;
        // Without a list, the components that are requested depend on the directions of the axes.
        scene.reactions.clone_from(&self.reactions);
        Ok(scene)
    }

    fn family(&self, _: &Design, _: &RequestedQuantities) -> Option<VariantFamily> {
        // Each variant is compiled: only mechanisms in the plane have their structure apart from their numbers.
        None
    }
}

/// The requested reactions that are determined, by their index.
fn indexed(scene: &SpaceScene, reactions: &JointReactions) -> Vec<IndexedReaction> {
    let all = reactions.requested.iter().enumerate();
    let named = all.map(|(k, reaction)| {
        let unit = match reaction.component {
            Component::Force(..) => "N",
            Component::Moment(..) => "N m",
        };
        (k, scene.reaction_name(*reaction), unit)
    });
    named.collect()
}

/// The analysis for peak forces, as in the plane: along the scene's motion or sweep, or statics over its range.
fn peak_analysis(scene: &SpaceScene) -> Option<Analysis> {
    if scene.prescribed.is_some() || scene.sweep.is_some() {
        return Some(Analysis::Kinetostatics);
    }
    let is_single = scene.mechanism.actuators.len() == 1;
    (is_single && !scene.loads.is_empty()).then_some(Analysis::Statics)
}

/// A variant may leave open what the scene as it is determines: its point says so.
fn reject_open(
    scene: &SpaceScene,
    reactions: &JointReactions,
    requested: &RequestedQuantities,
) -> Result<(), StudyError> {
    let mut open = reactions.indeterminate.iter();
    let open = open.find(|r| is_requested(requested, &scene.reaction_name(**r)));
    match open {
        None => Ok(()),
        Some(&reaction) => {
            let name = scene.reaction_name(reaction);
            let message = format!("redundant constraints leave the reaction `{name}` open");
            Err(scene.error(message, None, &[]).into())
        }
    }
}

/// Whether the largest magnitude of a reaction is requested.
fn is_requested(requested: &RequestedQuantities, reaction: &str) -> bool {
    let mut quantities = requested.quantities.iter();
    quantities.any(|q| {
        let name = q.name.strip_suffix(".max_abs");
        let name = name.map(|name| name.strip_prefix("place.").unwrap_or(name));
        name == Some(reaction)
    })
}

/// The largest magnitudes of reactions and of actuator forces, also between the rows.
fn peaks(
    scene: &SpaceScene,
    (reactions, model): (&JointReactions, &Model),
    analysis: Analysis,
) -> Result<[Vec<(String, f64)>; 2], StudyError> {
    // The abscissa is among them.
    let is_wanted = |quantity: Quantity| {
        matches!(
            quantity,
            Quantity::Time
                | Quantity::ActuatorCoordinate(_, 0)
                | Quantity::ActuatorForce(_)
                | Quantity::Reaction(_)
        )
    };
    let study = (analysis, None);
    let (computed, _) = computed_rows(scene, (reactions, model), study, &is_wanted, &no_progress)?;
    let ComputedTrajectory {
        results,
        early_stop: None,
        ..
    } = computed
    else {
        return Err(computed.early_stop.unwrap_or_else(|| ended_early(scene)));
    };
    let columns = results.columns.iter().zip(&results.extrema.of_columns);
    let [mut of_reactions, mut of_actuators] = [const { Vec::new() }; 2];
    for (column, ends) in columns {
        let largest = ends.iter().flatten();
        let largest = largest.map(|end| end.value.abs()).fold(f64::NAN, f64::max);
        let named = (format!("{}.max_abs", column.name), largest);
        match column.quantity {
            Quantity::Reaction(_) => of_reactions.push(named),
            Quantity::ActuatorForce(_) => of_actuators.push(named),
            _ => {}
        }
    }
    Ok([of_reactions, of_actuators])
}

fn ended_early(scene: &SpaceScene) -> StudyError {
    let message = "the trajectory ends early".to_owned();
    scene.error(message, None, &[]).into()
}

/// Curves over the range of the only actuator.
fn range_curves(
    scene: &SpaceScene,
    model: Model,
    of: impl Fn(
        ExactModel<Model>,
        [f64; 2],
    ) -> Result<RangeCurves<Model>, dwell_geometry::PositionError>,
) -> Result<RangeCurves<Model>, StudyError> {
    let plan = model.plan().clone();
    let (limits, ..) = range_limits(scene, &plan);
    let Some(exact) = ExactModel::new(model) else {
        let message = "the reduced model needs exactly one actuator".to_owned();
        return Err(scene.error(message, None, &[]).into());
    };
    of(exact, limits).map_err(|e| explain_position(scene, &plan, &e))
}

/// The motion of the only coordinate, from its start; none where a law prescribes it, or something drives it.
fn start_of_free_motion(scene: &SpaceScene) -> Option<ReducedState> {
    let spec = scene.motion.as_ref()?;
    let is_free = spec.laws.iter().all(Option::is_none) && scene.drives.is_empty();
    let [(&q, &q_dot)] = spec
        .initial_coordinates
        .iter()
        .zip(&spec.initial_velocities)
        .collect::<Vec<_>>()[..]
    else {
        return None;
    };
    is_free.then_some(ReducedState { t: 0.0, q, q_dot })
}

fn free_machine(scene: &SpaceScene) -> Result<Machine<Model>, StudyError> {
    let modes = vec![CoordinateMode::Free; scene.mechanism.actuators.len()];
    let machine = Machine::new(compile(scene, &[])?, &scene.loads, modes, &scene.drives);
    let machine = machine.and_then(|machine| machine.with_stops(&end_stops(&scene.stops)));
    machine.map_err(|error| super::machine_scene::explain_machine(scene, &error))
}

/// Whether the scene has a conservative free motion of one coordinate.
fn is_conservative(scene: &SpaceScene) -> bool {
    let Some(start) = start_of_free_motion(scene) else {
        return false;
    };
    free_machine(scene).is_ok_and(|machine| {
        let orbit = Orbit::loaded(&machine, start);
        !matches!(orbit, Err(DynamicsError::NotConservative { .. }))
    })
}

/// The results of the conservative free motion.
fn compute_orbit(
    scene: &SpaceScene,
    reactions: &JointReactions,
    requested: &RequestedQuantities,
    results: &mut Results<'_>,
) {
    let named: Vec<(Reaction, String)> = reactions
        .requested
        .iter()
        .map(|r| (*r, scene.reaction_name(*r)))
        .filter(|(_, name)| is_requested(requested, name))
        .collect();
    let of_motion = requested.includes(ResultKind::FreeReaction)
        || requested.includes(ResultKind::FreeReactionPlace);
    let Some(start) =
        start_of_free_motion(scene).filter(|_| requested.includes(ResultKind::Orbit) || of_motion)
    else {
        return;
    };
    let orbit = free_machine(scene).and_then(|machine| {
        let orbit = Orbit::loaded(&machine, start);
        orbit.map_err(|error| MachineScene::explain(scene, machine.model(), &error))
    });
    if of_motion && let Ok(orbit) = &orbit {
        match largest_in_motion(scene, &named, orbit.energy) {
            Ok([values, places]) => {
                results.set_named(ResultKind::FreeReaction, Ok(values));
                results.set_named(ResultKind::FreeReactionPlace, Ok(places));
            }
            Err(error) => results.set(ResultKind::FreeReaction, Err(error)),
        }
    }
    let values = orbit.map(|orbit| vec![orbit.period, orbit.energy]);
    results.set(ResultKind::Orbit, values);
}

/// The largest magnitudes of reactions in the free rotation of an energy, J, and their places.
fn largest_in_motion(
    scene: &SpaceScene,
    named: &[(Reaction, String)],
    energy: f64,
) -> Result<[Vec<(String, f64)>; 2], StudyError> {
    let wanted: Vec<Reaction> = named.iter().map(|(reaction, _)| *reaction).collect();
    let curves = range_curves(scene, compile(scene, &wanted)?, |exact, limits| {
        RangeCurves::of_free_reactions(exact, limits, energy)
    })?;
    let indices: Vec<usize> = (0..named.len()).collect();
    let points = named.iter().zip(curves.largest(&indices));
    let both = points.map(|((_, name), [place, value])| {
        let name = format!("{name}.max_abs");
        ((name.clone(), value), (format!("place.{name}"), place))
    });
    let (values, places) = both.unzip();
    Ok([values, places])
}

/// The columns of a free motion whose results can be swept: coordinates with their speeds, and requested reactions.
fn motion_columns(scene: &SpaceScene, reactions: &JointReactions) -> Vec<NamedUnit> {
    let mut all: Vec<NamedUnit> = Vec::new();
    for actuator in &scene.mechanism.actuators {
        let unit = coordinate_unit(matches!(actuator.kind, ActuatorKind::Angle(_)));
        all.push((actuator.name.clone(), unit.to_owned()));
        all.push((format!("{}.velocity", actuator.name), format!("{unit}/s")));
    }
    let reactions = indexed(scene, reactions).into_iter();
    all.extend(reactions.map(|(_, name, unit)| (name, unit.to_owned())));
    all
}

/// The results of a free motion, in their order.
fn motion_quantities(scene: &SpaceScene, reactions: &JointReactions) -> Vec<NamedUnit> {
    if scene.motion.is_none() {
        return Vec::new();
    }
    let mut all = vec![("motion.end".to_owned(), "s".to_owned())];
    for (column, unit) in motion_columns(scene, reactions) {
        all.extend(STATISTICS.map(|of| (format!("motion.{column}.{of}"), unit.clone())));
    }
    all
}

/// The values of [`motion_quantities`], with their names.
fn motion_values(
    scene: &SpaceScene,
    reactions: &JointReactions,
) -> Result<Vec<(String, f64)>, StudyError> {
    let solver = MotionSolver::Settings(SolverSettings::default());
    let problem = SpaceMotionProblem::new(scene)?.for_solver(&solver);
    let mut computed = problem.simulate(&solver, None, &no_progress)?.computed;
    if let Some(error) = computed.early_stop.take() {
        return Err(error);
    }
    let columns = motion_columns(scene, reactions);
    let values = statistics(&computed, columns.iter().map(|(name, _)| name))?;
    let names = motion_quantities(scene, reactions).into_iter();
    Ok(names.map(|(name, _)| name).zip(values).collect())
}

//! One point of a sweep: the scene with its input values, and the results.

use crate::branch_note::branch_note;
use crate::explain::{StudyError, SweepError, explain_machine, explain_motion};
use crate::former_names;
use crate::models::{compile_model, initial_reduced_state, with_loads};
use crate::number_format::{coordinate_unit, force_unit};
use crate::sweep::compute::extremes::{ExtremeValues, RangeCurves};
use crate::sweep::compute::motions::{
    cycle_quantities, cycle_values, motion_quantities, motion_values,
};
use crate::trajectory::compute::{
    Analysis, WantedForces, check_variables, is_prefix_of, peak_forces,
};
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, Orbit, ReducedState};
use dwell_kinetostatics::Model;
use dwell_scene::Scene;
use std::collections::BTreeSet;

/// What a result is computed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ResultKind {
    /// Smallest and largest m, smallest and largest ½m′.
    Inertia,
    /// The coordinates at which they occur: only on request.
    InertiaPlace,
    /// Lower and upper end of the range.
    Range,
    /// Period and energy of the free motion.
    Orbit,
    /// Largest absolute values, by reaction of the mechanism.
    Reaction,
    /// Largest absolute values in the free rotation without loads, by reaction of the mechanism.
    FreeReaction,
    /// The coordinates at which they occur: only on request.
    FreeReactionPlace,
    /// Largest absolute values, by actuator.
    ActuatorForce,
    /// Results of the free motion: computed only on request, as they take an integration.
    Motion,
    /// Results of the steady cycle: computed only on request.
    Cycle,
}

/// A result by its name and unit.
#[derive(Debug)]
pub(crate) struct SweepQuantity {
    pub(crate) name: String,
    /// The name it had before it was renamed, which a request may still use.
    former: Option<String>,
    pub(crate) unit: String,
    pub(super) kind: ResultKind,
    /// Its index among the results of its kind.
    pub(super) index: usize,
}

impl ResultKind {
    /// Whether a result is computed only if a request names it, and by what word.
    fn on_request(self) -> Option<&'static str> {
        match self {
            Self::Motion => Some("motion"),
            Self::Cycle => Some("cycle"),
            Self::InertiaPlace | Self::FreeReactionPlace => Some("place"),
            _ => None,
        }
    }
}

impl SweepQuantity {
    /// Whether it is the smallest or largest value along a motion or a range.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for the summary"))]
    pub(crate) fn is_extremum(&self) -> bool {
        use ResultKind::{ActuatorForce, FreeReaction, Inertia, Reaction};
        matches!(self.kind, Inertia | Reaction | FreeReaction | ActuatorForce)
    }

    /// Whether a request names it: its whole name, the part before one of its dots, or its former name.
    fn matches(&self, request: &str) -> bool {
        is_prefix_of(request, &self.name) || self.matches_former(request)
    }

    fn matches_former(&self, request: &str) -> bool {
        let former = self.former.as_deref();
        former.is_some_and(|former| is_prefix_of(request, former))
            && !is_prefix_of(request, &self.name)
    }
}

/// The results to compute at every point.
#[derive(Debug)]
pub(crate) struct RequestedQuantities {
    pub(crate) quantities: Vec<SweepQuantity>,
    /// A line for each request that uses a former name, and for each body far from its approximate angle.
    pub(crate) notes: String,
}

/// The results of a point: a value for each quantity, NaN where there is none, and the reason.
#[derive(Clone)]
pub(crate) struct PointResult {
    pub(crate) values: Vec<f64>,
    pub(crate) message: Option<String>,
}

/// A finished point.
#[derive(Clone)]
pub(crate) struct Row {
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for the store"))]
    pub(crate) index: u64,
    pub(crate) inputs: Vec<f64>,
    pub(crate) result: PointResult,
}

impl RequestedQuantities {
    /// The requested quantities, or all that the scene has.
    ///
    /// # Errors
    /// [`StudyError`] where the unchanged scene cannot be assembled; [`SweepError::Result`].
    pub(crate) fn new(scene: &Scene, requests: &[String]) -> Result<Self, StudyError> {
        let model = compile_model(scene, &scene.mechanism.reactions())?;
        check_variables(scene, &model)?;
        let mut quantities = available_quantities(scene, &model);
        for request in requests {
            if !quantities.iter().any(|q| q.matches(request)) {
                let name = request.clone();
                // Of the many results that are computed on request the first word is enough.
                let always = quantities.iter().filter(|q| q.kind.on_request().is_none());
                let mut known: Vec<String> = always.map(|q| q.name.clone()).collect();
                let words = quantities.iter().filter_map(|q| q.kind.on_request());
                let words: BTreeSet<&str> = words.collect();
                known.extend(words.into_iter().map(str::to_owned));
                return Err(SweepError::Result { name, known }.into());
            }
        }
        if quantities.is_empty() {
            let message = "this scene has no results to sweep: add a [prescribed] motion or a [coordinate-sweep]";
            return Err(SweepError::Design(message.to_owned()).into());
        }
        let notes = requests.iter().map(|request| {
            let renamed = quantities.iter().filter(|q| q.matches_former(request));
            former_names::note(request, renamed.map(|q| &q.name))
        });
        let mut notes: String = notes.collect();
        notes += &branch_note(scene, model.plan());
        quantities.retain(|q| match requests {
            [] => q.kind.on_request().is_none(),
            requests => requests.iter().any(|request| q.matches(request)),
        });
        if quantities.is_empty() {
            let message = "no result is computed unless it is requested: name some with --result, as in --result motion or --result cycle";
            return Err(SweepError::Design(message.to_owned()).into());
        }
        Ok(Self { quantities, notes })
    }

    /// Computes them with some numbers of the scene replaced. What fails has no value, but a message.
    pub(crate) fn evaluate(&self, scene: &Scene, values: &[(&str, f64)]) -> PointResult {
        let mut result = PointResult {
            values: vec![f64::NAN; self.quantities.len()],
            message: None,
        };
        let varied = scene.with_values(values).map_err(StudyError::from);
        let done = varied.and_then(|scene| self.compute(&scene, &mut result.values));
        result.message = done.err().map(|error| first_message(&error));
        result
    }

    /// Compiles the mechanism once, for all requested quantities. Returns the first error, with the values of the
    /// others.
    fn compute(&self, scene: &Scene, cells: &mut [f64]) -> Result<(), StudyError> {
        let model = compile_model(scene, &scene.mechanism.reactions())?;
        let includes = |kind: ResultKind| self.quantities.iter().any(|q| q.kind == kind);
        let mut results = Results {
            quantities: &self.quantities,
            cells,
            failed: None,
        };
        if let Some((from, to)) = model.plan().range().limits() {
            results.set(ResultKind::Range, Ok(vec![from, to]));
        }
        if includes(ResultKind::Motion) {
            results.set(ResultKind::Motion, motion_values(scene, &model));
        }
        if includes(ResultKind::Cycle) {
            results.set(ResultKind::Cycle, cycle_values(scene));
        }
        if includes(ResultKind::Inertia) || includes(ResultKind::InertiaPlace) {
            let extremes = RangeCurves::of_inertia(scene, &model).map(|curves| curves.extremes());
            results.set_points([ResultKind::Inertia, ResultKind::InertiaPlace], extremes);
        }
        self.compute_orbit(scene, &model, &mut results);
        if (includes(ResultKind::Reaction) || includes(ResultKind::ActuatorForce))
            && let Some(analysis) = peak_analysis(scene)
        {
            let wanted = WantedForces {
                reactions: self.indices(&[ResultKind::Reaction]),
                actuators: self.indices(&[ResultKind::ActuatorForce]),
            };
            match peak_forces(scene, &with_loads(scene, model)?, analysis, &wanted) {
                Ok(peaks) => {
                    results.set(ResultKind::Reaction, Ok(peaks.reactions));
                    results.set(ResultKind::ActuatorForce, Ok(peaks.tau));
                }
                Err(error) => results.set(ResultKind::Reaction, Err(error)),
            }
        }
        results.failed.map_or(Ok(()), Err)
    }

    /// The results of the conservative free motion.
    fn compute_orbit(&self, scene: &Scene, model: &Model, results: &mut Results<'_>) {
        let kinds = [ResultKind::FreeReaction, ResultKind::FreeReactionPlace];
        let reactions = self.indices(&kinds);
        let is_requested = self.quantities.iter().any(|q| q.kind == ResultKind::Orbit);
        let start = initial_reduced_state(scene);
        let Some(start) = start.filter(|_| is_requested || !reactions.is_empty()) else {
            return;
        };
        let orbit = orbit(scene, start, model);
        if !reactions.is_empty()
            && let Ok(orbit) = &orbit
        {
            let curves = RangeCurves::of_free_reactions(scene, model, &reactions, orbit.energy);
            results.set_points(kinds, curves.map(|curves| curves.largest(&reactions)));
        }
        let values = orbit.map(|orbit| vec![orbit.period, orbit.energy]);
        results.set(ResultKind::Orbit, values);
    }

    /// The indices of the requested quantities of some kinds.
    fn indices(&self, kinds: &[ResultKind]) -> Vec<usize> {
        let quantities = self.quantities.iter().filter(|q| kinds.contains(&q.kind));
        let indices: BTreeSet<usize> = quantities.map(|q| q.index).collect();
        indices.into_iter().collect()
    }
}

/// The results of a point as they are computed, and the first error.
struct Results<'a> {
    quantities: &'a [SweepQuantity],
    cells: &'a mut [f64],
    failed: Option<StudyError>,
}

impl Results<'_> {
    fn set(&mut self, kind: ResultKind, computed: Result<Vec<f64>, StudyError>) {
        match computed {
            Err(error) => {
                self.failed.get_or_insert(error);
            }
            Ok(values) => {
                let cells = self.quantities.iter().zip(&mut *self.cells);
                for (quantity, cell) in cells.filter(|(q, _)| q.kind == kind) {
                    *cell = values.get(quantity.index).copied().unwrap_or(f64::NAN);
                }
            }
        }
    }

    /// Values with their places.
    fn set_points(
        &mut self,
        [values, places]: [ResultKind; 2],
        computed: Result<ExtremeValues, StudyError>,
    ) {
        match computed {
            Err(error) => self.set(values, Err(error)),
            Ok(points) => {
                self.set(values, Ok(points.iter().map(|[_, value]| *value).collect()));
                self.set(places, Ok(points.iter().map(|[place, _]| *place).collect()));
            }
        }
    }
}

/// The first sentence of an error: of several, the first.
fn first_message(error: &StudyError) -> String {
    match error {
        StudyError::Scene(scene) => {
            let first = scene.errors().first();
            first.map_or_else(String::new, |first| first.message.clone())
        }
        other => other.to_string(),
    }
}

/// The analysis for peak forces: along the scene's motion or sweep, or statics over its range.
fn peak_analysis(scene: &Scene) -> Option<Analysis> {
    if scene.prescribed.is_some() || scene.sweep.is_some() {
        return Some(Analysis::Kinetostatics);
    }
    let single = scene.mechanism.actuators.len() == 1;
    (single && !scene.loads.is_empty()).then_some(Analysis::Statics)
}

/// Every quantity that the sections of a scene allow.
fn available_quantities(scene: &Scene, model: &Model) -> Vec<SweepQuantity> {
    let mut all = Vec::new();
    let mut add = |name: String, unit: &str, kind, index| {
        all.push(SweepQuantity {
            former: former_names::former_result(&name),
            name,
            unit: unit.to_owned(),
            kind,
            index,
        });
    };
    if model.plan().actuators() == 1 {
        let angle = model.plan().is_angle(0);
        let (m, half_dm) = if angle {
            ("kg m2", "kg m2/rad")
        } else {
            ("kg", "kg/m")
        };
        let place_unit = coordinate_unit(angle);
        for (k, (name, unit)) in [("m", m), ("half_dm", half_dm)].into_iter().enumerate() {
            for (index, end) in [(2 * k, "min"), (2 * k + 1, "max")] {
                add(format!("{name}.{end}"), unit, ResultKind::Inertia, index);
                let place = format!("place.{name}.{end}");
                add(place, place_unit, ResultKind::InertiaPlace, index);
            }
        }
        add("range.lower".to_owned(), place_unit, ResultKind::Range, 0);
        add("range.upper".to_owned(), place_unit, ResultKind::Range, 1);
        if is_conservative(scene, model) {
            add("period".to_owned(), "s", ResultKind::Orbit, 0);
            add("energy".to_owned(), "J", ResultKind::Orbit, 1);
            if peak_analysis(scene).is_none() {
                for (k, name, unit) in determinate_reactions(scene, model) {
                    add(format!("{name}.max_abs"), unit, ResultKind::FreeReaction, k);
                    let place = format!("place.{name}.max_abs");
                    add(place, place_unit, ResultKind::FreeReactionPlace, k);
                }
            }
        }
    }
    if peak_analysis(scene).is_some() {
        for (k, actuator) in scene.mechanism.actuators.iter().enumerate() {
            let unit = force_unit(model.plan().is_angle(k));
            let name = format!("{}.actuator_force.max_abs", actuator.name);
            add(name, unit, ResultKind::ActuatorForce, k);
        }
        for (k, name, unit) in determinate_reactions(scene, model) {
            add(format!("{name}.max_abs"), unit, ResultKind::Reaction, k);
        }
    }
    for (kind, quantities) in [
        (ResultKind::Motion, motion_quantities(scene, model)),
        (ResultKind::Cycle, cycle_quantities(scene)),
    ] {
        for (index, (name, unit)) in quantities.into_iter().enumerate() {
            add(name, &unit, kind, index);
        }
    }
    all
}

/// The requested reactions that are results, with their index in the model, name and unit: not those that are statically
/// indeterminate.
fn determinate_reactions(scene: &Scene, model: &Model) -> Vec<(usize, String, &'static str)> {
    let all = model.reactions().iter().enumerate();
    let determinate = all.filter(|&(k, reaction)| {
        model.plan().is_determinate(k) && scene.requests.reactions.contains(reaction)
    });
    let named = determinate.map(|(k, reaction)| {
        let name = scene.mechanism.reaction_name(*reaction);
        (k, name, reaction.component.unit())
    });
    named.collect()
}

/// Whether the scene has a conservative free motion.
fn is_conservative(scene: &Scene, model: &Model) -> bool {
    let laws = scene.motion.iter().flat_map(|spec| &spec.laws);
    let is_free = laws.into_iter().all(Option::is_none) && scene.drives.is_empty();
    let Some(start) = initial_reduced_state(scene).filter(|_| is_free) else {
        return false;
    };
    orbit_machine(scene, model).is_ok_and(|machine| {
        let orbit = Orbit::loaded(&machine, start);
        !matches!(orbit, Err(DynamicsError::NotConservative { .. }))
    })
}

fn orbit_machine(scene: &Scene, model: &Model) -> Result<Machine, StudyError> {
    let (model, modes) = (model.without_reactions(), vec![CoordinateMode::Free]);
    Machine::new(model, &scene.loads, modes, &scene.drives).map_err(|e| explain_machine(scene, e))
}

fn orbit(scene: &Scene, start: ReducedState, model: &Model) -> Result<Orbit, StudyError> {
    let machine = orbit_machine(scene, model)?;
    Orbit::loaded(&machine, start).map_err(|e| explain_motion(scene, model.plan(), &e))
}

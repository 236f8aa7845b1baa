//! One point of a sweep: the scene with its input values, and the results.

use crate::branch_note::branch_note;
use crate::explain::{StudyError, SweepError, explain_machine, explain_motion, explain_position};
use crate::former_names;
use crate::models::{compile_model, exact_model, initial_reduced_state, with_loads};
use crate::number_format::{coordinate_unit, force_unit};
use crate::sweep::compute::motions::{
    cycle_quantities, cycle_values, motion_quantities, motion_values,
};
use crate::trajectory::compute::{
    Analysis, Point, WantedForces, check_variables, default_limits, is_prefix_of, largest_between,
    peak_forces,
};
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, Orbit, ReducedState};
use dwell_kinetostatics::{Model, ReducedModel};
use dwell_scene::Scene;

/// Intervals of the range at which m and ½m′ are evaluated, those of `dwell reduce`; and the local extrema of them about
/// which the largest and smallest values are looked for between these positions.
const INTERVALS: usize = 720;
const REFINED: usize = 2;

/// What a result is computed with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ResultKind {
    /// Smallest and largest m, smallest and largest ½m′.
    Inertia,
    /// Lower and upper end of the range.
    Range,
    /// Period and energy of the free motion.
    Orbit,
    /// Largest absolute values, by reaction of the mechanism.
    Reaction,
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
    kind: ResultKind,
    /// Its index among the results of its kind.
    index: usize,
}

impl SweepQuantity {
    /// Whether it is the smallest or largest value along a motion or a range.
    #[cfg_attr(not(feature = "output"), expect(dead_code, reason = "for the summary"))]
    pub(crate) fn is_extremum(&self) -> bool {
        use ResultKind::{ActuatorForce, Inertia, Reaction};
        matches!(self.kind, Inertia | Reaction | ActuatorForce)
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
pub(crate) struct PointResult {
    pub(crate) values: Vec<f64>,
    pub(crate) message: Option<String>,
}

/// A finished point.
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
                // Of the many results of motions and cycles the first word is enough.
                let short = |q: SweepQuantity| match q.kind {
                    ResultKind::Motion => "motion".to_owned(),
                    ResultKind::Cycle => "cycle".to_owned(),
                    _ => q.name,
                };
                let mut known: Vec<String> = quantities.into_iter().map(short).collect();
                known.dedup();
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
            [] => !matches!(q.kind, ResultKind::Motion | ResultKind::Cycle),
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
        let mut failed: Option<StudyError> = None;
        let mut set = |kind: ResultKind, computed: Result<Vec<f64>, StudyError>| match computed {
            Err(error) => {
                failed.get_or_insert(error);
            }
            Ok(values) => {
                let cells = self.quantities.iter().zip(&mut *cells);
                for (quantity, cell) in cells.filter(|(q, _)| q.kind == kind) {
                    *cell = values.get(quantity.index).copied().unwrap_or(f64::NAN);
                }
            }
        };
        if let Some((from, to)) = model.plan().range().limits() {
            set(ResultKind::Range, Ok(vec![from, to]));
        }
        if includes(ResultKind::Motion) {
            set(ResultKind::Motion, motion_values(scene, &model));
        }
        if includes(ResultKind::Cycle) {
            set(ResultKind::Cycle, cycle_values(scene));
        }
        if includes(ResultKind::Inertia) {
            set(ResultKind::Inertia, inertia_extrema(scene, &model));
        }
        if includes(ResultKind::Orbit)
            && let Some(start) = initial_reduced_state(scene)
        {
            let orbit = orbit(scene, start, &model);
            let values = orbit.map(|orbit| vec![orbit.period, orbit.energy]);
            set(ResultKind::Orbit, values);
        }
        if (includes(ResultKind::Reaction) || includes(ResultKind::ActuatorForce))
            && let Some(analysis) = peak_analysis(scene)
        {
            let of_kind = |kind: ResultKind| {
                let quantities = self.quantities.iter().filter(|q| q.kind == kind);
                quantities.map(|q| q.index).collect()
            };
            let wanted = WantedForces {
                reactions: of_kind(ResultKind::Reaction),
                actuators: of_kind(ResultKind::ActuatorForce),
            };
            match peak_forces(scene, &with_loads(scene, model)?, analysis, &wanted) {
                Ok(peaks) => {
                    set(ResultKind::Reaction, Ok(peaks.reactions));
                    set(ResultKind::ActuatorForce, Ok(peaks.tau));
                }
                Err(error) => set(ResultKind::Reaction, Err(error)),
            }
        }
        failed.map_or(Ok(()), Err)
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
        for (k, (name, unit)) in [("m", m), ("half_dm", half_dm)].into_iter().enumerate() {
            add(format!("{name}.min"), unit, ResultKind::Inertia, 2 * k);
            add(format!("{name}.max"), unit, ResultKind::Inertia, 2 * k + 1);
        }
        let unit = coordinate_unit(angle);
        add("range.lower".to_owned(), unit, ResultKind::Range, 0);
        add("range.upper".to_owned(), unit, ResultKind::Range, 1);
        if is_conservative(scene, model) {
            add("period".to_owned(), "s", ResultKind::Orbit, 0);
            add("energy".to_owned(), "J", ResultKind::Orbit, 1);
        }
    }
    if peak_analysis(scene).is_some() {
        let mechanism = &scene.mechanism;
        for (k, actuator) in mechanism.actuators.iter().enumerate() {
            let unit = force_unit(model.plan().is_angle(k));
            let name = format!("{}.actuator_force.max_abs", actuator.name);
            add(name, unit, ResultKind::ActuatorForce, k);
        }
        for (k, reaction) in model.reactions().iter().enumerate() {
            // Statically indeterminate reactions are no results.
            if model.plan().is_determinate(k) && scene.requests.reactions.contains(reaction) {
                let name = format!("{}.max_abs", mechanism.reaction_name(*reaction));
                add(name, reaction.component.unit(), ResultKind::Reaction, k);
            }
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

/// The smallest and the largest m, and the smallest and the largest ½m′, over the range, also between its positions.
fn inertia_extrema(scene: &Scene, model: &Model) -> Result<Vec<f64>, StudyError> {
    let exact = exact_model(scene, model.without_reactions())?;
    let mut workspace = exact.workspace();
    let ([from, to], ..) = default_limits(scene, model.plan());
    let mut curves: [Vec<Point>; 2] = [Vec::new(), Vec::new()];
    for k in 0..=INTERVALS {
        let fraction = k as f64 / INTERVALS as f64;
        let q = from * (1.0 - fraction) + to * fraction;
        let evaluated = exact.inertia(q, &mut workspace);
        let here = evaluated.map_err(|e| explain_position(scene, model.plan(), &e))?;
        curves[0].push([q, here.0]);
        curves[1].push([q, here.1]);
    }
    let mut extremum = |k: usize, sign: f64| {
        let curve: Vec<Point> = curves[k].iter().map(|[q, v]| [*q, sign * v]).collect();
        let mut value = |q: f64| {
            let (m, half_dm) = exact.inertia(q, &mut workspace).ok()?;
            Some(sign * [m, half_dm][k]).filter(|value| value.is_finite())
        };
        largest_between(&curve, REFINED, &mut value).map_or(f64::NAN, |value| sign * value)
    };
    let extrema = [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)];
    Ok(extrema.map(|(k, sign)| extremum(k, sign)).to_vec())
}

//! One point of a sweep: the scene with its input values, and the results.

use crate::explain::{StudyError, SweepError, explain_machine, explain_motion, explain_position};
use crate::former_names;
use crate::models::{compile_model, with_loads};
use crate::sweep::compute::heading;
use crate::trajectory::compute::{Analysis, is_prefix_of, peak_forces, swept_range};
use dwell_dynamics::{CoordinateMode, DynamicsError, Machine, Orbit, ReducedState};
use dwell_kinetostatics::{ExactModel, Model, ReducedModel};
use dwell_scene::{FreeMotionSpec, Scene};

/// Intervals of the range at which m and ½m′ are evaluated: those of `dwell reduce`.
const INTERVALS: usize = 720;

/// The kind of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SweepQuantityKind {
    MinInertia,
    MaxInertia,
    MinHalfDm,
    MaxHalfDm,
    RangeLower,
    RangeUpper,
    Period,
    Energy,
    /// Largest absolute value of a reaction, by its index in the mechanism, or of an actuator force.
    Reaction(usize),
    ActuatorForce(usize),
}

/// A result by its name and unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SweepQuantity {
    pub(crate) name: String,
    /// The name it had before it was renamed, which a request may still use.
    former: Option<String>,
    pub(crate) unit: &'static str,
    kind: SweepQuantityKind,
}

impl SweepQuantity {
    pub(crate) fn heading(&self) -> String {
        heading(&self.name, self.unit)
    }

    /// Whether a request names it: its whole name, the part before one of its dots, or its former name.
    fn matches(&self, request: &str) -> bool {
        is_prefix_of(request, &self.name) || self.matches_former(request)
    }

    fn matches_former(&self, request: &str) -> bool {
        let former = self.former.as_deref();
        former.is_some_and(|former| {
            is_prefix_of(request, former) && !is_prefix_of(request, &self.name)
        })
    }
}

/// The results to compute at every point.
#[derive(Debug, Clone)]
pub(crate) struct RequestedQuantities {
    pub(crate) quantities: Vec<SweepQuantity>,
    /// A line for each request that uses a former name.
    pub(crate) notes: String,
}

/// The results of a point: a value for each quantity, NaN where there is none, and the reason.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PointResult {
    pub(crate) values: Vec<f64>,
    pub(crate) message: Option<String>,
}

impl RequestedQuantities {
    /// The requested quantities, or all that the scene has.
    ///
    /// # Errors
    /// [`StudyError`] where the unchanged scene cannot be assembled; [`SweepError::Result`].
    pub(crate) fn new(scene: &Scene, requests: &[String]) -> Result<Self, StudyError> {
        let all = available_quantities(scene)?;
        let names = || all.iter().map(|q| q.name.clone()).collect();
        for request in requests {
            if !all.iter().any(|q| q.matches(request)) {
                return Err(SweepError::Result {
                    name: request.clone(),
                    known: names(),
                }
                .into());
            }
        }
        if all.is_empty() {
            return Err(SweepError::Design(
                "this scene has no results to sweep: add a [prescribed] motion or a [coordinate-sweep]"
                    .to_owned(),
            )
            .into());
        }
        let mut quantities = all;
        let notes = requests.iter().filter_map(|request| {
            let renamed = quantities.iter().filter(|q| q.matches_former(request));
            let current: Vec<&str> = renamed.map(|q| q.name.as_str()).collect();
            (!current.is_empty()).then(|| former_names::note(request, &current))
        });
        let notes = notes.collect();
        if !requests.is_empty() {
            quantities.retain(|q| requests.iter().any(|request| q.matches(request)));
        }
        Ok(Self { quantities, notes })
    }

    /// Computes them with some numbers of the scene replaced. What fails has no value, but a message.
    pub(crate) fn evaluate(&self, scene: &Scene, values: &[(&str, f64)]) -> PointResult {
        let mut result = PointResult {
            values: vec![f64::NAN; self.quantities.len()],
            message: None,
        };
        let done = scene
            .with_values(values)
            .map_err(StudyError::from)
            .and_then(|scene| self.compute(&scene, &mut result));
        if let Err(error) = done {
            result.message.get_or_insert(first_message(&error));
        }
        result
    }

    fn includes(&self, is: impl Fn(SweepQuantityKind) -> bool) -> bool {
        self.quantities.iter().any(|q| is(q.kind))
    }

    /// Compiles the mechanism once, for all requested quantities.
    fn compute(&self, scene: &Scene, result: &mut PointResult) -> Result<(), StudyError> {
        let model = compile_model(scene, &scene.mechanism.reactions())?;
        let mut set = |value: &dyn Fn(SweepQuantityKind) -> Option<f64>| {
            for (quantity, cell) in self.quantities.iter().zip(&mut result.values) {
                if let Some(value) = value(quantity.kind) {
                    *cell = value;
                }
            }
        };
        if let Some((from, to)) = model.plan().range().limits() {
            set(&|kind| match kind {
                SweepQuantityKind::RangeLower => Some(from),
                SweepQuantityKind::RangeUpper => Some(to),
                _ => None,
            });
        }
        let mut failed: Option<StudyError> = None;
        if self.includes(SweepQuantityKind::is_inertia) {
            match inertia_extrema(scene, &model) {
                Ok(inertia) => set(&|kind| inertia.value(kind)),
                Err(error) => failed = Some(error),
            }
        }
        if self.includes(SweepQuantityKind::is_orbit)
            && let Some(motion) = &scene.motion
        {
            match orbit(scene, motion, &model) {
                Ok(orbit) => set(&|kind| match kind {
                    SweepQuantityKind::Period => Some(orbit.period),
                    SweepQuantityKind::Energy => Some(orbit.energy),
                    _ => None,
                }),
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        if self.includes(SweepQuantityKind::is_peak)
            && let Some(command) = peak_analysis(scene)
        {
            let loaded = with_loads(scene, model)?;
            match peak_forces(scene, &loaded, command) {
                Ok(peaks) => set(&|kind| match kind {
                    SweepQuantityKind::Reaction(k) => peaks.reactions.get(k).copied(),
                    SweepQuantityKind::ActuatorForce(k) => peaks.actuator_forces.get(k).copied(),
                    _ => None,
                }),
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        failed.map_or(Ok(()), Err)
    }
}

impl SweepQuantityKind {
    fn is_inertia(self) -> bool {
        use SweepQuantityKind::{MaxHalfDm, MaxInertia, MinHalfDm, MinInertia};
        matches!(self, MinInertia | MaxInertia | MinHalfDm | MaxHalfDm)
    }

    fn is_orbit(self) -> bool {
        matches!(self, Self::Period | Self::Energy)
    }

    fn is_peak(self) -> bool {
        matches!(self, Self::Reaction(_) | Self::ActuatorForce(_))
    }
}

/// The first sentence of an error: of several, the first.
fn first_message(error: &StudyError) -> String {
    match error {
        StudyError::Scene(scene) => scene
            .errors()
            .first()
            .map_or_else(String::new, |first| first.message.clone()),
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
fn available_quantities(scene: &Scene) -> Result<Vec<SweepQuantity>, StudyError> {
    let model = compile_model(scene, &scene.mechanism.reactions())?;
    let mut all = Vec::new();
    let mut add = |name: String, unit, kind| {
        all.push(SweepQuantity {
            former: former_names::former_result(&name),
            name,
            unit,
            kind,
        });
    };
    if model.plan().actuators() == 1 {
        let angle = model.plan().is_angle(0);
        let pick = |of: [&'static str; 2]| if angle { of[0] } else { of[1] };
        let (m, half_dm_unit) = (pick(["kg m2", "kg"]), pick(["kg m2/rad", "kg/m"]));
        add("m.min".to_owned(), m, SweepQuantityKind::MinInertia);
        add("m.max".to_owned(), m, SweepQuantityKind::MaxInertia);
        add(
            "half_dm.min".to_owned(),
            half_dm_unit,
            SweepQuantityKind::MinHalfDm,
        );
        add(
            "half_dm.max".to_owned(),
            half_dm_unit,
            SweepQuantityKind::MaxHalfDm,
        );
        let unit = pick(["rad", "m"]);
        add(
            "range.lower".to_owned(),
            unit,
            SweepQuantityKind::RangeLower,
        );
        add(
            "range.upper".to_owned(),
            unit,
            SweepQuantityKind::RangeUpper,
        );
        if is_conservative(scene, &model) {
            add("period".to_owned(), "s", SweepQuantityKind::Period);
            add("energy".to_owned(), "J", SweepQuantityKind::Energy);
        }
    }
    if peak_analysis(scene).is_some() {
        let mechanism = &scene.mechanism;
        for (k, actuator) in mechanism.actuators.iter().enumerate() {
            let unit = if model.plan().is_angle(k) { "N m" } else { "N" };
            let name = format!("{}.actuator_force.max_abs", actuator.name);
            add(name, unit, SweepQuantityKind::ActuatorForce(k));
        }
        for (k, reaction) in model.reactions().iter().enumerate() {
            // Statically indeterminate reactions are no results.
            if model.plan().is_determinate(k) && scene.requests.reactions.contains(reaction) {
                let name = format!("{}.max_abs", mechanism.reaction_name(*reaction));
                add(
                    name,
                    reaction.component.unit(),
                    SweepQuantityKind::Reaction(k),
                );
            }
        }
    }
    Ok(all)
}

/// Whether the scene has a conservative free motion.
fn is_conservative(scene: &Scene, model: &Model) -> bool {
    let Some(spec) = &scene.motion else {
        return false;
    };
    let free = spec.laws.iter().all(Option::is_none) && scene.drives.is_empty();
    free && orbit_machine(scene, model).is_ok_and(|machine| {
        let orbit = Orbit::loaded(&machine, initial_state(spec));
        !matches!(orbit, Err(DynamicsError::NotConservative { .. }))
    })
}

pub(crate) fn orbit_machine(scene: &Scene, model: &Model) -> Result<Machine, StudyError> {
    Machine::new(
        model.without_reactions(),
        &scene.loads,
        vec![CoordinateMode::Free],
        &scene.drives,
    )
    .map_err(|e| explain_machine(scene, e))
}

fn initial_state(spec: &FreeMotionSpec) -> ReducedState {
    ReducedState {
        t: 0.0,
        q: spec.initial_coordinates.first().copied().unwrap_or(0.0),
        q_dot: spec.initial_velocities.first().copied().unwrap_or(0.0),
    }
}

fn orbit(scene: &Scene, spec: &FreeMotionSpec, model: &Model) -> Result<Orbit, StudyError> {
    let machine = orbit_machine(scene, model)?;
    Orbit::loaded(&machine, initial_state(spec))
        .map_err(|e| explain_motion(scene, model.plan(), &e))
}

/// The extrema of m and of ½m′ over the range.
struct InertiaExtrema {
    m: [f64; 2],
    half_dm: [f64; 2],
}

impl InertiaExtrema {
    fn value(&self, kind: SweepQuantityKind) -> Option<f64> {
        match kind {
            SweepQuantityKind::MinInertia => Some(self.m[0]),
            SweepQuantityKind::MaxInertia => Some(self.m[1]),
            SweepQuantityKind::MinHalfDm => Some(self.half_dm[0]),
            SweepQuantityKind::MaxHalfDm => Some(self.half_dm[1]),
            _ => None,
        }
    }
}

fn inertia_extrema(scene: &Scene, model: &Model) -> Result<InertiaExtrema, StudyError> {
    let plan = model.plan();
    let Some(exact) = ExactModel::new(model.without_reactions()) else {
        return Err(crate::explain::not_one_actuator(scene));
    };
    let mut workspace = exact.workspace();
    let [from, to] = swept_range(scene, plan);
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let (mut m, mut half_dm_range) = (none, none);
    for k in 0..=INTERVALS {
        let fraction = k as f64 / INTERVALS as f64;
        let q = from * (1.0 - fraction) + to * fraction;
        let evaluated = exact.inertia(q, &mut workspace);
        let (m_here, half_dm) = evaluated.map_err(|e| explain_position(scene, plan, &e))?;
        m = [m[0].min(m_here), m[1].max(m_here)];
        half_dm_range = [half_dm_range[0].min(half_dm), half_dm_range[1].max(half_dm)];
    }
    Ok(InertiaExtrema {
        m,
        half_dm: half_dm_range,
    })
}

//! One point of a study: the scene with its values, and what it comes to.

use super::axes::heading;
use super::error::SweepError;
use crate::error::{StudyError, explain_machine, explain_model};
use crate::motion_error::{explain_motion, explain_place};
use crate::run::{Command, most, over_range, with_loads};
use dwell_dynamics::{DynamicsError, Guidance, Machine, Orbit, State};
use dwell_kinetostatics::{Exact, Model, Reduced};
use dwell_scene::{Motion, Scene};

/// Intervals of the range at whose ends m and ½m′ are looked at: those of `dwell reduce`.
const INTERVALS: usize = 720;

/// A result of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    LeastInertia,
    MostInertia,
    LeastSlope,
    MostSlope,
    RangeFrom,
    RangeTo,
    Period,
    Energy,
    /// Largest size of a reaction, by its index in the mechanism, and of an actuator's action.
    Reaction(usize),
    Action(usize),
}

/// A result by its name and unit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Quantity {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    kind: Kind,
}

impl Quantity {
    pub(crate) fn heading(&self) -> String {
        heading(&self.name, self.unit)
    }

    /// Whether a wish names it: the whole name, or what stands before one of its dots.
    fn answers_to(&self, wish: &str) -> bool {
        let rest = self.name.strip_prefix(wish);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    }
}

/// What is computed at every point.
#[derive(Debug, Clone)]
pub(crate) struct Wanted {
    pub(crate) quantities: Vec<Quantity>,
}

/// What a point came to: a value for each quantity, NaN where there is none, and why.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Found {
    pub(crate) values: Vec<f64>,
    pub(crate) message: Option<String>,
}

impl Wanted {
    /// The quantities that are asked for, or all that the scene has.
    ///
    /// # Errors
    /// [`StudyError`] where the scene as it is cannot be put together; [`SweepError::Result`].
    pub(crate) fn new(scene: &Scene, wishes: &[String]) -> Result<Self, StudyError> {
        let all = all(scene)?;
        let names = || all.iter().map(|q| q.name.clone()).collect();
        for wish in wishes {
            if !all.iter().any(|q| q.answers_to(wish)) {
                return Err(SweepError::Result {
                    name: wish.clone(),
                    known: names(),
                }
                .into());
            }
        }
        if all.is_empty() {
            return Err(SweepError::Design(
                "nothing can be computed of this scene without a [prescribed] motion or a [sweep]"
                    .to_owned(),
            )
            .into());
        }
        let mut quantities = all;
        if !wishes.is_empty() {
            quantities.retain(|q| wishes.iter().any(|wish| q.answers_to(wish)));
        }
        Ok(Self { quantities })
    }

    /// Computes them with some numbers of the scene replaced. What fails is told, and is no value.
    pub(crate) fn at(&self, scene: &Scene, values: &[(&str, f64)]) -> Found {
        let mut found = Found {
            values: vec![f64::NAN; self.quantities.len()],
            message: None,
        };
        let done = scene
            .with_values(values)
            .map_err(StudyError::from)
            .and_then(|scene| self.compute(&scene, &mut found));
        if let Err(error) = done {
            found.message.get_or_insert(told(&error));
        }
        found
    }

    fn wants(&self, is: impl Fn(Kind) -> bool) -> bool {
        self.quantities.iter().any(|q| is(q.kind))
    }

    /// The mechanism is compiled once, for all that is wanted of it.
    fn compute(&self, scene: &Scene, found: &mut Found) -> Result<(), StudyError> {
        let model = compiled(scene)?;
        let mut put = |value: &dyn Fn(Kind) -> Option<f64>| {
            for (quantity, place) in self.quantities.iter().zip(&mut found.values) {
                if let Some(value) = value(quantity.kind) {
                    *place = value;
                }
            }
        };
        if let Some((from, to)) = model.plan().range().limits() {
            put(&|kind| match kind {
                Kind::RangeFrom => Some(from),
                Kind::RangeTo => Some(to),
                _ => None,
            });
        }
        let mut failed: Option<StudyError> = None;
        if self.wants(Kind::is_inertia) {
            match inertia(scene, &model) {
                Ok(inertia) => put(&|kind| inertia.of(kind)),
                Err(error) => failed = Some(error),
            }
        }
        if self.wants(Kind::is_free)
            && let Some(motion) = &scene.motion
        {
            match orbit(scene, motion, &model) {
                Ok(orbit) => put(&|kind| match kind {
                    Kind::Period => Some(orbit.period),
                    Kind::Energy => Some(orbit.energy),
                    _ => None,
                }),
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        if self.wants(Kind::is_peak)
            && let Some(command) = followed_by(scene)
        {
            let loaded = with_loads(scene, model)?;
            match most(scene, &loaded, command) {
                Ok(most) => put(&|kind| match kind {
                    Kind::Reaction(k) => most.reactions.get(k).copied(),
                    Kind::Action(k) => most.actions.get(k).copied(),
                    _ => None,
                }),
                Err(error) => failed = failed.or(Some(error)),
            }
        }
        failed.map_or(Ok(()), Err)
    }
}

impl Kind {
    fn is_inertia(self) -> bool {
        use Kind::{LeastInertia, LeastSlope, MostInertia, MostSlope};
        matches!(self, LeastInertia | MostInertia | LeastSlope | MostSlope)
    }

    fn is_free(self) -> bool {
        matches!(self, Self::Period | Self::Energy)
    }

    fn is_peak(self) -> bool {
        matches!(self, Self::Reaction(_) | Self::Action(_))
    }
}

/// The first sentence of an error: of several, the first.
fn told(error: &StudyError) -> String {
    match error {
        StudyError::Scene(scene) => scene
            .errors()
            .first()
            .map_or_else(String::new, |first| first.message.clone()),
        other => other.to_string(),
    }
}

fn compiled(scene: &Scene) -> Result<Model, StudyError> {
    let start = scene.assembly.to_start();
    let reactions = scene.mechanism.reactions();
    Model::new(&scene.mechanism, &scene.masses, &start, &reactions)
        .map_err(|e| explain_model(scene, &e))
}

/// Along what actions and reactions are looked at: as the scene says, or over its range at rest.
fn followed_by(scene: &Scene) -> Option<Command> {
    if scene.prescribed.is_some() || scene.sweep.is_some() {
        return Some(Command::Kinetostatics);
    }
    let single = scene.mechanism.actuators.len() == 1;
    (single && !scene.loads.is_empty()).then_some(Command::Statics)
}

/// Every quantity that the sections of a scene allow.
fn all(scene: &Scene) -> Result<Vec<Quantity>, StudyError> {
    let model = compiled(scene)?;
    let mut all = Vec::new();
    let mut add = |name: String, unit, kind| all.push(Quantity { name, unit, kind });
    if model.plan().actuators() == 1 {
        let angle = model.plan().is_angle(0);
        let pick = |of: [&'static str; 2]| if angle { of[0] } else { of[1] };
        let (m, slope) = (pick(["kg m2", "kg"]), pick(["kg m2/rad", "kg/m"]));
        add("m.least".to_owned(), m, Kind::LeastInertia);
        add("m.most".to_owned(), m, Kind::MostInertia);
        add("half_dm.least".to_owned(), slope, Kind::LeastSlope);
        add("half_dm.most".to_owned(), slope, Kind::MostSlope);
        let unit = pick(["rad", "m"]);
        add("range.from".to_owned(), unit, Kind::RangeFrom);
        add("range.to".to_owned(), unit, Kind::RangeTo);
        if is_conservative(scene, &model) {
            add("period".to_owned(), "s", Kind::Period);
            add("energy".to_owned(), "J", Kind::Energy);
        }
    }
    if followed_by(scene).is_some() {
        let mechanism = &scene.mechanism;
        for (k, actuator) in mechanism.actuators.iter().enumerate() {
            let unit = if model.plan().is_angle(k) { "N m" } else { "N" };
            let name = format!("{}.action.peak", actuator.name);
            add(name, unit, Kind::Action(k));
        }
        for (k, reaction) in model.reactions().iter().enumerate() {
            // What constraints that repeat each other share is no result.
            if model.plan().is_unique(k) && scene.requests.reactions.contains(reaction) {
                let name = format!("{}.peak", mechanism.reaction_name(*reaction));
                add(name, reaction.component.unit(), Kind::Reaction(k));
            }
        }
    }
    Ok(all)
}

/// Whether the scene has a free motion that keeps its energy.
fn is_conservative(scene: &Scene, model: &Model) -> bool {
    let Some(motion) = &scene.motion else {
        return false;
    };
    let free = motion.laws.iter().all(Option::is_none) && scene.drives.is_empty();
    free && machine(scene, model).is_ok_and(|machine| {
        let orbit = Orbit::loaded(&machine, start(motion));
        !matches!(orbit, Err(DynamicsError::NotConservative { .. }))
    })
}

fn machine(scene: &Scene, model: &Model) -> Result<Machine, StudyError> {
    let (mechanism, loads) = (&scene.mechanism, &scene.loads);
    // Friction alone needs reactions, and whatever rubs is not conservative.
    let bare = model.without_reactions();
    Machine::new(mechanism, bare, loads, vec![Guidance::Free], &scene.drives)
        .map_err(|e| explain_machine(scene, e))
}

fn start(motion: &Motion) -> State {
    State {
        t: 0.0,
        q: motion.start.first().copied().unwrap_or(0.0),
        q_dot: motion.speed.first().copied().unwrap_or(0.0),
    }
}

fn orbit(scene: &Scene, motion: &Motion, model: &Model) -> Result<Orbit, StudyError> {
    let machine = machine(scene, model)?;
    Orbit::loaded(&machine, start(motion)).map_err(|e| explain_motion(scene, model.plan(), &e))
}

/// The extremes of m and of ½m′ at the positions of a table over the range.
struct Inertia {
    m: [f64; 2],
    slope: [f64; 2],
}

impl Inertia {
    fn of(&self, kind: Kind) -> Option<f64> {
        match kind {
            Kind::LeastInertia => Some(self.m[0]),
            Kind::MostInertia => Some(self.m[1]),
            Kind::LeastSlope => Some(self.slope[0]),
            Kind::MostSlope => Some(self.slope[1]),
            _ => None,
        }
    }
}

fn inertia(scene: &Scene, model: &Model) -> Result<Inertia, StudyError> {
    let plan = model.plan();
    let Some(exact) = Exact::new(model.without_reactions()) else {
        return Err(crate::error::not_one_actuator(scene));
    };
    let mut work = exact.work();
    let [from, to] = over_range(scene, plan);
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let (mut m, mut slope) = (none, none);
    for k in 0..=INTERVALS {
        let part = k as f64 / INTERVALS as f64;
        let q = from * (1.0 - part) + to * part;
        let at = exact.inertia(q, &mut work);
        let (here, half_dm) = at.map_err(|e| explain_place(scene, plan, &e))?;
        m = [m[0].min(here), m[1].max(here)];
        slope = [slope[0].min(half_dm), slope[1].max(half_dm)];
    }
    Ok(Inertia { m, slope })
}

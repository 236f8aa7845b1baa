//! A way that ends early: where, and who is to blame.

use crate::error::{StudyError, broken, joint_labels, names_or_whole};
use crate::run::watch::{Fault, broken_relation, table_of};
use crate::run::way::{Sample, Way};
use crate::words::{digits, number};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{PlaceError, Plan};
use dwell_kinetostatics::{KinetostaticsError, LoadKind, Signal};
use dwell_scene::{Place, Scene};
use std::f64::consts::TAU;

/// Halvings between the last position that was reached and the first that was not.
const HALVINGS: usize = 60;
/// Part of a step from a limit position to where its cause is looked for.
const BEYOND: f64 = 1e-6;
/// A body that turns so many times as fast as its actuator races: a limit position is near.
const RACING: f64 = 1e3;

/// Whether a position of the only actuator is in the turn of the one before: whole turns on, the
/// mechanism may close again, but there is no way from here to there.
pub(crate) fn is_cut_off(plan: &Plan, before: f64, q: f64) -> Option<PlaceError> {
    let (from, to) = plan.range().limits()?;
    let turn = |q: f64| ((q - from) / TAU).floor();
    (plan.is_angle(0) && to - from < TAU && turn(before) != turn(q))
        .then_some(PlaceError::OutOfRange { q, from, to })
}

/// Why a way ends.
#[derive(Debug, Clone, Copy)]
pub(crate) enum End {
    /// There is no pose, or a load does not act.
    Unsolved(KinetostaticsError),
    /// There is a pose that a scene does not mean.
    Fault(Fault),
}

impl<E: Into<KinetostaticsError>> From<E> for End {
    fn from(error: E) -> Self {
        Self::Unsolved(error.into())
    }
}

/// Where a way ends.
#[derive(Debug)]
pub(crate) struct Stop {
    /// Why.
    pub(crate) end: End,
    /// The last position that can be reached; the first of the way if not even that can be.
    pub(crate) last: Sample,
    /// One a little behind it that cannot be reached.
    beyond: Sample,
    begun: bool,
}

impl Stop {
    /// Finds the end of a way between two positions, the first of which is reached.
    pub(crate) fn find(plan: &Plan, way: &Way<'_>, [reached, beyond]: [f64; 2], end: End) -> Self {
        let (mut low, mut high) = (reached, beyond);
        if matches!(end, End::Unsolved(KinetostaticsError::Place(_))) {
            let start = way.at(reached).q;
            let mut pose = plan.pose();
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                let q = way.at(middle).q;
                let cut = plan.actuators() == 1 && is_cut_off(plan, start[0], q[0]).is_some();
                if !cut && plan.place(&q, &mut pose).is_ok() {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        Self {
            end,
            last: way.at(low),
            beyond: way.at((high + BEYOND * (beyond - reached)).min(beyond)),
            begun: beyond > reached,
        }
    }

    /// The end in words, pointing into the scene.
    pub(crate) fn explain(&self, scene: &Scene, plan: &Plan, way: &Way<'_>) -> StudyError {
        let place = where_it_is(scene, plan, way, &self.last);
        let when = match self.begun {
            true => format!("soon after {place}"),
            false => format!("at the first position, {place}"),
        };
        match self.end {
            End::Unsolved(KinetostaticsError::Place(error)) => {
                self.limit(scene, plan, way, &place, &error)
            }
            End::Unsolved(KinetostaticsError::NoDirection { load }) => scene
                .error(
                    format!(
                        "load `{}` has no direction {when}: its two points meet",
                        load_name(scene, load)
                    ),
                    Some(match scene.loads.get(load).map(|l| l.kind) {
                        Some(LoadKind::Spring { .. }) => {
                            "a spring of free length 0 needs none; or keep the points apart".into()
                        }
                        _ => "it acts along the line of its points: keep them apart".into(),
                    }),
                    &[(Place::Load(load), "between two points".to_owned())],
                )
                .into(),
            End::Unsolved(KinetostaticsError::Jams { load }) => scene
                .error(
                    format!("friction jams the mechanism {when}: no single motion balances"),
                    Some("take a smaller coefficient, or push where the joints bear less".into()),
                    &[(Place::Load(load), "with the other frictions".to_owned())],
                )
                .into(),
            End::Unsolved(KinetostaticsError::MagnitudeNotFinite { load }) => scene
                .error(
                    format!(
                        "the magnitude of load `{}` is not finite {when}",
                        load_name(scene, load)
                    ),
                    Some("check its expression there: a root, a logarithm or a division".into()),
                    &[(Place::Magnitude(load), "not a finite number".to_owned())],
                )
                .into(),
            End::Fault(Fault::OffTable { load, value }) => off_table(scene, load, value, &when),
            End::Fault(Fault::Jump {
                joint,
                between: [a, b],
            }) => scene
                .error(
                    format!(
                        "the function of relation `{}` jumps {when}, where its variable passes x = {}",
                        scene.mechanism.joints[joint.0].name,
                        between(a, b)
                    ),
                    Some(NO_JUMP.to_owned()),
                    &[(Place::Law(joint), format!("jumps at x = {}", between(a, b)))],
                )
                .into(),
        }
    }

    fn limit(
        &self,
        scene: &Scene,
        plan: &Plan,
        way: &Way<'_>,
        place: &str,
        error: &PlaceError,
    ) -> StudyError {
        if let Some(relation) = broken_relation(&scene.mechanism, &self.beyond.q) {
            let at = if self.begun { "soon after" } else { "at" };
            return broken(scene, relation, &format!("{at} {place}"));
        }
        if !self.begun {
            return self.unreached(scene, plan, way, place, error);
        }
        let in_the_middle = match *error {
            // Out of the range on a side where no end was met.
            PlaceError::OutOfRange { q, to, .. } => plan.ends()[usize::from(q > to)].is_none(),
            _ => false,
        };
        if in_the_middle {
            return scene
                .error(
                    format!(
                        "the mechanism is followed only so far from its start, to {place}: no end \
                         was met before, and no position is known beyond"
                    ),
                    Some("the results end there; start nearer, or end the motion before".into()),
                    &[(way.place, "goes on beyond it".to_owned())],
                )
                .into();
        }
        let group = error.group().or_else(|| racing(plan, &self.last.q));
        let bodies = group.map(|g| plan.group_bodies(g)).unwrap_or_default();
        let joints = group.map(|g| plan.group_joints(g)).unwrap_or_default();
        let who = names_or_whole(&scene.mechanism, &bodies);
        let why = match error {
            PlaceError::NotFinite { .. } => "a coordinate is not a finite number beyond".to_owned(),
            PlaceError::Unreachable { .. } => format!("{who} cannot reach each other beyond"),
            PlaceError::Singular { .. } => {
                format!("{who} are in line there, and the actuators do not determine their motion")
            }
            PlaceError::OtherBranch { .. } => {
                format!("{who} can be placed on another assembly branch only beyond")
            }
            PlaceError::NotClosed { .. } | PlaceError::Apart { .. } => {
                format!("{who} could not be placed beyond")
            }
            PlaceError::OutOfRange { .. } if group.is_some() => {
                format!(
                    "{who} are in line there, at the end of the range, and cannot follow beyond"
                )
            }
            PlaceError::OutOfRange { .. } => "the range ends there".to_owned(),
        };
        let mut labels = joint_labels(&joints, "cannot stay joined beyond");
        labels.push((way.place, "goes on beyond it".to_owned()));
        let help =
            "the results end there; end the motion or the sweep before it, or change a length";
        scene
            .error(
                format!("a limit position is reached at {place}: {why}"),
                Some(help.to_owned()),
                &labels,
            )
            .into()
    }
}

impl Stop {
    /// The error where not even the first position can be reached.
    fn unreached(
        &self,
        scene: &Scene,
        plan: &Plan,
        way: &Way<'_>,
        place: &str,
        error: &PlaceError,
    ) -> StudyError {
        let joints = error.group().map(|g| plan.group_joints(g));
        let mut labels = joint_labels(&joints.unwrap_or_default(), "cannot be joined there");
        labels.push((way.place, "begins there".to_owned()));
        let range = match plan.range().limits() {
            Some((from, to)) => {
                let unit = if plan.is_angle(0) { "rad" } else { "m" };
                let [from, to] = [from, to].map(number);
                match plan.ends() {
                    [Some(_), Some(_)] => format!(", outside the range of {from} to {to} {unit}"),
                    _ => format!(", and the mechanism is followed from {from} to {to} {unit} only"),
                }
            }
            None => String::new(),
        };
        scene
            .error(
                format!("the first position cannot be reached: {place}{range}"),
                Some("begin where the mechanism can be; `dwell check` shows its range".to_owned()),
                &labels,
            )
            .into()
    }
}

/// Help where a function of a coordinate jumps.
pub(crate) const NO_JUMP: &str = "nothing moves by a jump: let its pieces meet, or join them by a rise \
     such as `cycloidal`; an angle may grow over whole turns";

/// Two neighbouring numbers: where something jumps.
pub(crate) fn between(a: f64, b: f64) -> String {
    // To the digits in which a step found by halving is certain.
    digits(if a.abs() > b.abs() { a } else { b }, 9)
}

fn load_name(scene: &Scene, load: usize) -> &str {
    scene.loads.get(load).map_or("", |l| l.name.as_str())
}

/// The error where a load's table does not reach to a value of its signal.
fn off_table(scene: &Scene, load: usize, value: f64, when: &str) -> StudyError {
    let table = scene.loads.get(load).and_then(|l| table_of(&l.magnitude));
    let (signal, [first, last]) = match table {
        Some((signal, spline)) => (signal, spline.range()),
        None => (Signal::Time, [f64::NAN; 2]),
    };
    let (name, angle) = match signal {
        Signal::Time => ("t".to_owned(), false),
        Signal::Value(c) => (scene.name_of(c), c.is_angle()),
        Signal::Speed(c) => (format!("{}.speed", scene.name_of(c)), false),
    };
    let unit = match signal {
        Signal::Time => "s",
        Signal::Value(c) if c.is_angle() => "rad",
        Signal::Value(_) => "m",
        Signal::Speed(c) if c.is_angle() => "rad/s",
        Signal::Speed(_) => "m/s",
    };
    let told = |value: f64| match angle {
        true => format!("{} rad ({}°)", number(value), number(value.to_degrees())),
        false => format!("{} {unit}", number(value)),
    };
    let reach = format!("from {} to {}", told(first), told(last));
    let help = match angle {
        true => format!(
            "give it rows as far as the angle goes, which counts whole turns; or write an expression, \
             in which `{name} - tau*floor({name}/tau)` is the angle within a turn"
        ),
        false => "give it rows as far as that, or write an expression".to_owned(),
    };
    scene
        .error(
            format!(
                "the table of load `{}` goes {reach}, and {name} is {} {when}",
                load_name(scene, load),
                told(value)
            ),
            Some(help),
            &[(Place::Magnitude(load), reach)],
        )
        .into()
}

/// The actuators' coordinates, and the time of a prescribed motion.
fn where_it_is(scene: &Scene, plan: &Plan, way: &Way<'_>, at: &Sample) -> String {
    let one = |(i, q): (usize, &f64)| {
        let name = &scene.mechanism.actuators[i].name;
        match plan.is_angle(i) {
            true => format!(
                "{name} = {} rad ({}°)",
                digits(*q, 8),
                number(q.to_degrees())
            ),
            false => format!("{name} = {} m", digits(*q, 8)),
        }
    };
    let all: Vec<_> = at.q.iter().enumerate().map(one).collect();
    let all = all.join(", ");
    match way.swept() {
        Some(_) => all,
        None => format!("t = {} s, {all}", digits(at.t, 6)),
    }
}

/// The first group whose bodies race at unit speed of the actuators.
fn racing(plan: &Plan, q: &[f64]) -> Option<usize> {
    let (mut pose, mut motion) = (plan.pose(), plan.motion());
    plan.place(q, &mut pose).ok()?;
    plan.speeds(&pose, &vec![1.0; q.len()], &mut motion);
    let mut states = BodyStates::new(plan);
    states.fill(plan, &pose, &motion);
    (0..plan.group_kinds().len()).find(|&g| {
        let bodies = plan.group_bodies(g);
        bodies.iter().any(|&b| states.body(b).spin.abs() > RACING)
    })
}

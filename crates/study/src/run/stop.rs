//! A way that ends early: where, and who is to blame.

use crate::error::{StudyError, joint_labels, names};
use crate::run::way::{Sample, Way};
use crate::words::{digits, number};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::{PlaceError, Plan, Range};
use dwell_kinetostatics::KinetostaticsError;
use dwell_scene::{Place, Scene};
use std::f64::consts::TAU;

/// Halvings between the last position that was reached and the first that was not.
const HALVINGS: usize = 60;
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

/// Where a way ends.
#[derive(Debug)]
pub(crate) struct Stop {
    /// Why.
    pub(crate) error: KinetostaticsError,
    /// The last position that can be reached; the first of the way if not even that can be.
    pub(crate) last: Sample,
    begun: bool,
}

impl Stop {
    /// Finds the end of a way between two positions, the first of which is reached.
    pub(crate) fn find(
        plan: &Plan,
        way: &Way<'_>,
        [reached, beyond]: [f64; 2],
        error: KinetostaticsError,
    ) -> Self {
        let (mut low, mut high) = (reached, beyond);
        if matches!(error, KinetostaticsError::Place(_)) {
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
            error,
            last: way.at(low),
            begun: beyond > reached,
        }
    }

    /// The end in words, pointing into the scene.
    pub(crate) fn explain(&self, scene: &Scene, plan: &Plan, way: &Way<'_>) -> StudyError {
        let place = where_it_is(scene, plan, way, &self.last);
        match self.error {
            KinetostaticsError::Place(error) => self.limit(scene, plan, way, &place, &error),
            KinetostaticsError::NoDirection { load } => {
                let name = scene.loads.get(load).map_or("", |l| l.name.as_str());
                scene
                    .error(
                        format!(
                            "load `{name}` has no direction soon after {place}: its two points meet"
                        ),
                        Some(
                            "a spring of free length 0 needs none; or keep the points apart".into(),
                        ),
                        &[(Place::Load(load), "between two points".to_owned())],
                    )
                    .into()
            }
            KinetostaticsError::Jams { load } => {
                let name = scene.loads.get(load).map_or("", |l| l.name.as_str());
                scene
                    .error(
                        format!(
                            "friction jams the mechanism soon after {place}: no single balance"
                        ),
                        Some(
                            "take a smaller coefficient, or push where the joints bear less".into(),
                        ),
                        &[(
                            Place::Load(load),
                            format!("`{name}` and the other frictions"),
                        )],
                    )
                    .into()
            }
            KinetostaticsError::MagnitudeNotFinite { load } => {
                let name = scene.loads.get(load).map_or("", |l| l.name.as_str());
                scene
                    .error(
                        format!("the magnitude of load `{name}` is not finite soon after {place}"),
                        Some(
                            "check its expression there: a root, a logarithm or a division".into(),
                        ),
                        &[(Place::Magnitude(load), "not a finite number".to_owned())],
                    )
                    .into()
            }
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
        if !self.begun {
            return self.unreached(scene, plan, way, place, error);
        }
        let in_the_middle = matches!(plan.range(), Range::Followed(..))
            && matches!(error, PlaceError::OutOfRange { .. });
        if in_the_middle {
            return scene
                .error(
                    format!(
                        "the mechanism is followed only so far from its start, to {place}: it did not \
                         come back before, and no position is known beyond"
                    ),
                    Some("the results end there; start nearer, or end the motion before".into()),
                    &[(way.place, "goes on beyond it".to_owned())],
                )
                .into();
        }
        let group = error.group().or_else(|| racing(plan, &self.last.q));
        let bodies = group.map(|g| plan.group_bodies(g)).unwrap_or_default();
        let joints = group.map(|g| plan.group_joints(g)).unwrap_or_default();
        let who = match names(&scene.mechanism, &bodies) {
            none if none.is_empty() => "the mechanism".to_owned(),
            names => names,
        };
        let why = match error {
            PlaceError::NotFinite { .. } => "a coordinate is not a finite number beyond".to_owned(),
            PlaceError::Unreachable { .. } => format!("{who} cannot reach each other beyond"),
            PlaceError::Singular { .. } => {
                format!("{who} are in line there, and the actuators do not determine their motion")
            }
            PlaceError::OtherBranch { .. } => {
                format!("{who} can be placed on another assembly branch only beyond")
            }
            PlaceError::NotClosed { .. } => format!("{who} could not be placed beyond"),
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
                format!(
                    ", outside the range of {} to {} {unit}",
                    number(from),
                    number(to)
                )
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

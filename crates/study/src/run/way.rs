//! Where the actuators are, one position after another: a prescribed motion, a sweep, or the range
//! of a single actuator.

use crate::error::StudyError;
use crate::run::Command;
use crate::run::stop::{NO_JUMP, between};
use crate::words::{count, digits};
use dwell_geometry::{ActuatorId, Plan, Range};
use dwell_kinetostatics::Model;
use dwell_scene::{LARGEST_ANGLE, Place, Prescribed, Scene};
use std::f64::consts::TAU;

/// Positions where neither the scene nor the command says how many.
const POINTS: usize = 361;
/// Part of a range that is left out next to a limit position, where speeds grow without bound.
const MARGIN: f64 = 1e-3;
/// Half of the stroke of a length without ends, in sizes of the mechanism.
const STROKE: f64 = 0.25;

/// The actuators at one position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sample {
    /// Time since the start, s.
    pub(crate) t: f64,
    /// By actuator: coordinate (rad or m), speed and acceleration (per s, per s²).
    pub(crate) q: Vec<f64>,
    pub(crate) q_dot: Vec<f64>,
    pub(crate) q_ddot: Vec<f64>,
    /// Of a free motion: the chart it is in, and the coordinate of the only actuator with its speed and
    /// acceleration where the chart has another.
    pub(crate) chart: usize,
    pub(crate) own: Option<[f64; 3]>,
    /// Of a free motion: the magnitude of each drive, by its load.
    pub(crate) given: Vec<(usize, f64)>,
    /// Of a free motion: what its integration tells, by [`Told`].
    pub(crate) told: Vec<f64>,
}

/// What an integration tells beside the motion: name, unit and meaning of a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Told {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) meaning: String,
}

/// A way of the actuators, as a function of the part of it that is done.
#[derive(Debug, Clone)]
pub(crate) struct Way<'a> {
    kind: Kind<'a>,
    /// Positions, the ends among them.
    pub(crate) points: usize,
    /// What it follows, in words.
    pub(crate) words: String,
    /// How its positions were come by.
    pub(crate) how: String,
    /// Where the scene says so.
    pub(crate) place: Place,
    /// Whether it begins and ends next to a limit position.
    pub(crate) at_limits: [bool; 2],
    /// What can be added to the coordinate of the only actuator without a change of the pose, rad.
    pub(crate) period: Option<f64>,
}

#[derive(Debug, Clone)]
enum Kind<'a> {
    Prescribed(&'a Prescribed),
    /// A free motion, sampled.
    Free {
        samples: Vec<Sample>,
        told: Vec<Told>,
        /// By actuator: whether it is led by a law.
        led: Vec<bool>,
        /// By chart: the mechanism in its coordinate.
        charts: Vec<Model>,
    },
    Swept {
        actuator: usize,
        from: f64,
        to: f64,
        held: Vec<f64>,
        speed: f64,
    },
}

/// The ends of a sweep that the scene does not give.
struct Ends {
    from: f64,
    to: f64,
    at_limits: [bool; 2],
    words: &'static str,
}

/// What is not integrated has no method and no tolerance.
fn at_positions(points: usize) -> String {
    format!("the mechanism at {}", count(points, "position"))
}

impl<'a> Way<'a> {
    /// The way that a command takes through a scene, at `points` positions if these are given.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the scene does not say where the actuators are.
    pub(crate) fn new(
        scene: &'a Scene,
        plan: &Plan,
        command: Command,
        points: Option<usize>,
    ) -> Result<Self, StudyError> {
        if let Some(prescribed) = &scene.prescribed {
            let points = points.unwrap_or(prescribed.points).max(2);
            return Ok(Self {
                points,
                how: at_positions(points),
                words: format!(
                    "the prescribed motion of {} s",
                    digits(prescribed.duration, 6)
                ),
                kind: Kind::Prescribed(prescribed),
                place: Place::Prescribed,
                at_limits: [false; 2],
                period: plan.range().period(),
            });
        }
        let (actuator, range, held, wanted, speed, place) = match &scene.sweep {
            Some(sweep) => (
                sweep.actuator.0,
                sweep.range,
                sweep.held.clone(),
                Some(sweep.points),
                sweep.speed,
                Place::Sweep,
            ),
            None if plan.actuators() != 1 || command == Command::Kinetostatics => {
                return Err(unsaid(scene, command));
            }
            None => (0, None, plan.start().to_vec(), None, 1.0, Place::Whole),
        };
        let ends = match range {
            Some([from, to]) => Ends {
                from,
                to,
                at_limits: [false; 2],
                words: "the sweep",
            },
            None if plan.actuators() == 1 => ends(scene, plan),
            None if plan.is_angle(actuator) => Ends {
                from: held[actuator],
                to: held[actuator] + TAU,
                at_limits: [false; 2],
                words: "one turn",
            },
            None => return Err(open_ends(scene, actuator)),
        };
        let unit = if plan.is_angle(actuator) { "rad" } else { "m" };
        let name = &scene.mechanism.actuators[actuator].name;
        let points = points.or(wanted).unwrap_or(POINTS).max(2);
        Ok(Self {
            how: at_positions(points),
            words: format!(
                "{} of {name} from {} to {} {unit}",
                ends.words,
                digits(ends.from, 6),
                digits(ends.to, 6)
            ),
            kind: Kind::Swept {
                actuator,
                from: ends.from,
                to: ends.to,
                held,
                speed,
            },
            points,
            place,
            at_limits: ends.at_limits,
            period: plan.range().period(),
        })
    }

    /// A free motion that was followed already: two samples or more.
    pub(crate) fn free(
        plan: &Plan,
        samples: Vec<Sample>,
        told: Vec<Told>,
        led: Vec<bool>,
        charts: Vec<Model>,
    ) -> Self {
        let last = samples.last().map_or(0.0, |s| s.t);
        Self {
            points: samples.len(),
            how: at_positions(samples.len()),
            words: format!("a free motion of {} s", digits(last, 6)),
            kind: Kind::Free {
                samples,
                told,
                led,
                charts,
            },
            place: Place::Motion,
            at_limits: [false; 2],
            period: plan.range().period(),
        }
    }

    /// The models in which its positions are, by chart; none where it is that of the scene.
    pub(crate) fn charts(&self) -> &[Model] {
        match &self.kind {
            Kind::Free { charts, .. } => charts,
            Kind::Prescribed(_) | Kind::Swept { .. } => &[],
        }
    }

    /// Whether an actuator acts: in a free motion only those that are led do.
    pub(crate) fn acts(&self, actuator: usize) -> bool {
        match &self.kind {
            Kind::Free { led, .. } => led[actuator],
            Kind::Prescribed(_) | Kind::Swept { .. } => true,
        }
    }

    /// The columns that its integration tells.
    pub(crate) fn told(&self) -> &[Told] {
        match &self.kind {
            Kind::Free { told, .. } => told,
            Kind::Prescribed(_) | Kind::Swept { .. } => &[],
        }
    }

    /// Refuses a law that has no finite value, speed or acceleration at one of the points, turns
    /// too far to keep its digits, or jumps between two points.
    pub(crate) fn check(&self, scene: &Scene) -> Result<(), StudyError> {
        let Kind::Prescribed(prescribed) = &self.kind else {
            return Ok(());
        };
        let actuators = &scene.mechanism.actuators;
        let mut before: Option<f64> = None;
        for k in 0..self.points {
            let t = self.part(k) * prescribed.duration;
            for (a, (actuator, law)) in actuators.iter().zip(&prescribed.laws).enumerate() {
                let refuse = |what: String, help: &str, label: String| {
                    let message = format!("the law of `{}` {what}", actuator.name);
                    let labels = [(Place::Motor(ActuatorId(a)), label)];
                    Err(scene.error(message, Some(help.to_owned()), &labels).into())
                };
                let at = law.at(t);
                let names = ["value", "speed", "acceleration"];
                if let Some(order) = at[..3].iter().position(|v| !v.is_finite()) {
                    let what = format!("no finite {}", names[order]);
                    return refuse(
                        format!("has {what} at t = {} s", digits(t, 6)),
                        "a motion needs its value and two derivatives everywhere",
                        what,
                    );
                }
                if actuator.coordinate().is_angle() && at[0].abs() > LARGEST_ANGLE {
                    return refuse(
                        format!(
                            "is more than {LARGEST_ANGLE:e} rad at t = {} s",
                            digits(t, 6)
                        ),
                        "so large an angle has lost its last digits: end the motion before, or check \
                         the numbers",
                        "too many turns".to_owned(),
                    );
                }
                if let Some([from, to]) = before.and_then(|before| law.jump(before, t)) {
                    let time = between(from, to);
                    let [p, q] = [from, to].map(|t| digits(law.at(t)[0], 6));
                    return refuse(
                        format!("jumps at t = {time} s, from {p} to {q}"),
                        NO_JUMP,
                        format!("jumps at t = {time} s"),
                    );
                }
            }
            before = Some(t);
        }
        Ok(())
    }

    /// The actuators when `part` of the way is done, from 0 to 1.
    pub(crate) fn at(&self, part: f64) -> Sample {
        match &self.kind {
            Kind::Prescribed(prescribed) => {
                let t = part * prescribed.duration;
                let derivative = |k: usize| prescribed.laws.iter().map(|l| l.at(t)[k]).collect();
                Sample {
                    t,
                    q: derivative(0),
                    q_dot: derivative(1),
                    q_ddot: derivative(2),
                    chart: 0,
                    own: None,
                    given: Vec::new(),
                    told: Vec::new(),
                }
            }
            Kind::Free { samples, .. } => {
                let last = samples.len().saturating_sub(1);
                let k = (part * last as f64).round() as usize;
                samples[k.min(last)].clone()
            }
            Kind::Swept {
                actuator,
                from,
                to,
                held,
                speed,
            } => {
                let rest = vec![0.0; held.len()];
                let mut sample = Sample {
                    t: part * (to - from).abs() / speed,
                    q: held.clone(),
                    q_dot: rest.clone(),
                    q_ddot: rest,
                    chart: 0,
                    own: None,
                    given: Vec::new(),
                    told: Vec::new(),
                };
                // Both ends to the last digit.
                sample.q[*actuator] = from * (1.0 - part) + to * part;
                sample.q_dot[*actuator] = speed.copysign(to - from);
                sample
            }
        }
    }

    /// The part of the way that is done at the `k`th position.
    pub(crate) fn part(&self, k: usize) -> f64 {
        k as f64 / (self.points - 1) as f64
    }

    /// The actuator that is swept; none in a prescribed motion.
    pub(crate) fn swept(&self) -> Option<usize> {
        match &self.kind {
            Kind::Prescribed(_) | Kind::Free { .. } => None,
            Kind::Swept { actuator, .. } => Some(*actuator),
        }
    }
}

/// The ends of the way over the range of the only actuator.
pub(crate) fn over_range(scene: &Scene, plan: &Plan) -> [f64; 2] {
    let Ends { from, to, .. } = ends(scene, plan);
    [from, to]
}

/// The way over the range of the only actuator.
fn ends(scene: &Scene, plan: &Plan) -> Ends {
    let start = plan.start()[0];
    let around = STROKE * reach(scene);
    let between = |from, to, at_limits, words| Ends {
        from,
        to,
        at_limits,
        words,
    };
    match plan.range() {
        Range::Full => between(0.0, TAU, [false; 2], "one turn"),
        Range::Turns(turns) => {
            let end = start + TAU * f64::from(turns);
            between(start, end, [false; 2], "the period")
        }
        Range::Between(from, to) => {
            let margin = MARGIN * (to - from);
            between(from + margin, to - margin, [true; 2], "the range")
        }
        Range::Stroke(from, to) => {
            // An end that was not met is only as far as it was followed.
            let met = plan.ends().map(|end| end.is_some());
            let around = if plan.is_angle(0) { TAU } else { around };
            let low = if met[0] { from } else { start - around };
            let high = if met[1] { to } else { start + around };
            let margin = MARGIN * (high - low);
            let cut = |met: bool| if met { margin } else { 0.0 };
            between(low + cut(met[0]), high - cut(met[1]), met, "the range")
        }
        Range::Endless | Range::Followed(..) if plan.is_angle(0) => {
            between(start, start + TAU, [false; 2], "one turn")
        }
        Range::Endless | Range::Followed(..) => {
            between(start - around, start + around, [false; 2], "a stroke")
        }
    }
}

/// The largest distance of two points of a body, m.
fn reach(scene: &Scene) -> f64 {
    let of_body = |points: &Vec<(String, dwell_geometry::Vec2)>| {
        let pairs = points
            .iter()
            .flat_map(|(_, p)| points.iter().map(move |(_, r)| (*p - *r).norm()));
        pairs.fold(0.0, f64::max)
    };
    let largest = scene.points.iter().map(of_body).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// The error where the scene does not say how the actuators move.
fn unsaid(scene: &Scene, command: Command) -> StudyError {
    let actuators = &scene.mechanism.actuators;
    let label = |a| (Place::Actuator(ActuatorId(a)), "where is it?".to_owned());
    let mut labels: Vec<_> = (0..actuators.len()).map(label).collect();
    if labels.is_empty() {
        labels.push((Place::Whole, "there are no [actuators] in this file".into()));
    }
    let message = match command {
        Command::Kinetostatics => {
            "the scene does not say how it moves, so there are no accelerations".to_owned()
        }
        _ => format!(
            "the scene has {} and does not say where they are",
            count(actuators.len(), "actuator")
        ),
    };
    let example = actuators.first().map_or("phi", |a| a.name.as_str());
    let help = format!(
        "add [prescribed] with a `duration` and a law for each, as in `{example} = {{ speed = 1.0 }}`; or \
         [sweep] with a range for one of them, as in `{example} = [0.0, 1.0]`"
    );
    scene.error(message, Some(help), &labels).into()
}

/// The error where a driven length among others has no ends.
fn open_ends(scene: &Scene, actuator: usize) -> StudyError {
    let name = &scene.mechanism.actuators[actuator].name;
    scene
        .error(
            format!("[sweep] does not say from where to where `{name}` goes"),
            Some(format!(
                "add `{name} = [from, to]`: with several actuators its range is not known"
            )),
            &[(Place::Sweep, "from where to where?".to_owned())],
        )
        .into()
}

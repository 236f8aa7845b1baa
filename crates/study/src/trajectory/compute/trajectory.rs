//! The coordinates that an analysis follows: a prescribed motion, a free motion, or a sweep.

use crate::explain::{CONTINUITY_HELP, StudyError, jump_location, scene_error};
use crate::number_format::{count, digits};
use crate::progress::{Progress, Step};
use crate::trajectory::compute::{Analysis, Column, EarlyStop, FollowedScene, RowScene, StopCause};
use dwell_geometry::{ActuatorId, Plan, Range};
use dwell_scene::{CoordinateSweep, MAX_ANGLE, PlaneScene, PrescribedMotion, SceneLocation};
use std::f64::consts::TAU;

/// Positions per step of progress.
const POSITIONS_PER_STEP: usize = 500;
/// Number of positions if neither the scene nor the caller gives one.
const DEFAULT_POINTS: usize = 361;
/// Fraction of a range left out at a limit position, where velocities grow without bound.
const LIMIT_MARGIN: f64 = 1e-3;
/// Half the stroke of a driven length without limits, in sizes of the mechanism.
const DEFAULT_STROKE: f64 = 0.25;

/// The actuator coordinates and their derivatives at one position.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TrajectorySample {
    /// Time since the start, s.
    pub(crate) t: f64,
    /// By actuator: coordinate (rad or m), speed and acceleration (per s, per s²).
    pub(crate) q: Vec<f64>,
    pub(crate) q_dot: Vec<f64>,
    pub(crate) q_ddot: Vec<f64>,
    /// For a free motion: its chart, and, if the chart uses another coordinate, that of the only actuator with its
    /// first and second derivatives.
    pub(crate) chart: usize,
    pub(crate) actuator_coordinate: Option<[f64; 3]>,
    /// For a free motion: (load, magnitude) of each drive.
    pub(crate) drive_magnitudes: Vec<(usize, f64)>,
    /// For a free motion: the values that only its integration yields, such as energies.
    pub(crate) extra_values: Vec<f64>,
}

impl TrajectorySample {
    /// Coordinates, velocities and accelerations at which an analysis evaluates it: those of statics are at `rest`.
    pub(crate) fn state<'s>(&'s self, analysis: Analysis, rest: &'s [f64]) -> [&'s [f64]; 3] {
        match analysis {
            Analysis::Statics => [&self.q, rest, rest],
            Analysis::Kinematics | Analysis::Kinetostatics | Analysis::FreeMotion => {
                [&self.q, &self.q_dot, &self.q_ddot]
            }
        }
    }

    /// The coordinate of an actuator, whichever coordinate its chart uses.
    pub(crate) fn coordinate(&self, actuator: usize) -> f64 {
        let own = self.actuator_coordinate;
        own.map_or(self.q[actuator], |derivatives| derivatives[0])
    }
}

/// A trajectory of the actuator coordinates, as a function of the completed fraction (0 to 1).
pub struct Trajectory<'a> {
    kind: TrajectoryKind<'a>,
    /// The analysis that follows it.
    pub(crate) analysis: Analysis,
    /// Number of positions, both ends included.
    pub points: usize,
    /// Description for summaries.
    pub description: String,
    /// The method that computed its positions, for captions.
    pub method_text: String,
    /// Whether its start and its end are next to a limit position.
    pub ends_at_limit_position: [bool; 2],
    /// Period of the pose in the coordinate of the only actuator, rad.
    pub period: Option<f64>,
}

/// The fractions of its duration at which a prescribed motion is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spacing {
    /// At equal intervals of time.
    EqualTimes,
    /// At equal distances of a uniformly accelerated motion from rest: it covers a fraction of the distance in the square
    /// root of this fraction of the time.
    FromRest,
}

impl Spacing {
    fn fraction_of_time(self, fraction: f64) -> f64 {
        match self {
            Self::EqualTimes => fraction,
            Self::FromRest => fraction.sqrt(),
        }
    }
}

enum TrajectoryKind<'a> {
    Prescribed(&'a PrescribedMotion, Spacing),
    Free(FreeTrajectory),
    /// A sweep, and from where to where.
    Swept(CoordinateSweep, [f64; 2]),
}

/// A free motion, sampled.
pub(crate) struct FreeTrajectory {
    /// Two samples or more.
    pub(crate) samples: Vec<TrajectorySample>,
    /// The columns of [`TrajectorySample::extra_values`].
    pub(crate) extra_columns: Vec<Column>,
    /// By actuator: whether its coordinate is prescribed.
    pub(crate) prescribed: Vec<bool>,
    /// Whether it may be in other coordinates than the scene's.
    pub(crate) in_charts: bool,
}

/// The limits of a sweep: first and last coordinate, whether these are next to a limit position, and a description.
pub(crate) type SweepLimits = ([f64; 2], [bool; 2], &'static str);

impl<'a> Trajectory<'a> {
    /// The trajectory that an analysis of a scene follows, at `points` positions if given.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the scene does not define the actuator coordinates.
    pub(crate) fn new(
        scene: &FollowedScene<'a>,
        analysis: Analysis,
        points: Option<usize>,
    ) -> Result<Self, StudyError> {
        let Some(prescribed) = scene.prescribed else {
            return Self::swept(scene, analysis, points);
        };
        let points = points.unwrap_or(prescribed.points);
        Ok(Self::prescribed(
            prescribed,
            Spacing::EqualTimes,
            scene.period,
            analysis,
            points,
        ))
    }

    /// A prescribed motion.
    pub(crate) fn prescribed(
        motion: &'a PrescribedMotion,
        spacing: Spacing,
        period: Option<f64>,
        analysis: Analysis,
        points: usize,
    ) -> Self {
        let duration = digits(motion.duration, 6);
        let description = format!("the prescribed motion of {duration} s");
        let kind = TrajectoryKind::Prescribed(motion, spacing);
        Self::at_positions(kind, period, analysis, points, description)
    }

    /// The sweep of a scene; or else over the range of its only actuator.
    fn swept(
        scene: &FollowedScene<'_>,
        analysis: Analysis,
        points: Option<usize>,
    ) -> Result<Self, StudyError> {
        let sweep = match scene.sweep {
            Some(sweep) => sweep.clone(),
            None if scene.coordinates.len() != 1 || analysis == Analysis::Kinetostatics => {
                return Err(scene.no_trajectory(analysis));
            }
            None => CoordinateSweep {
                actuator: ActuatorId(0),
                range: None,
                fixed_coordinates: scene.start.clone(),
                points: DEFAULT_POINTS,
                speed: 1.0,
            },
        };
        let actuator = sweep.actuator.0;
        let start = sweep.fixed_coordinates[actuator];
        let (name, is_angle) = scene.coordinates[actuator];
        let ([from, to], ends_at_limit_position, what) = match (sweep.range, scene.default_limits) {
            (Some(range), _) => (range, [false; 2], "the sweep"),
            (None, Some(limits)) => limits,
            (None, None) if is_angle => one_revolution(start),
            (None, None) => return Err(scene.open_sweep(actuator)),
        };
        let in_scene_unit = |q| scene.file.to_scene_unit(q, is_angle);
        let [(first, unit), (last, _)] = [from, to].map(in_scene_unit);
        let [first, last] = [first, last].map(|q| digits(q, 6));
        let description = format!("{what} of {name} from {first} to {last} {unit}");
        let points = points.unwrap_or(sweep.points);
        let kind = TrajectoryKind::Swept(sweep, [from, to]);
        Ok(Self {
            ends_at_limit_position,
            ..Self::at_positions(kind, scene.period, analysis, points, description)
        })
    }

    /// A computed free motion that ended at `end` (s).
    pub(crate) fn of_free_motion(period: Option<f64>, motion: FreeTrajectory, end: f64) -> Self {
        let (points, duration) = (motion.samples.len(), digits(end, 6));
        let description = format!("a free motion of {duration} s");
        let kind = TrajectoryKind::Free(motion);
        Self::at_positions(kind, period, Analysis::FreeMotion, points, description)
    }

    fn at_positions(
        kind: TrajectoryKind<'a>,
        period: Option<f64>,
        analysis: Analysis,
        points: usize,
        description: String,
    ) -> Self {
        let points = points.max(2);
        Self {
            kind,
            analysis,
            points,
            description,
            method_text: format!("the mechanism at {}", count(points, "position")),
            ends_at_limit_position: [false; 2],
            period,
        }
    }

    /// The abscissa at the wanted beginning and end: s, or rad or m of a swept coordinate.
    #[cfg(feature = "output")]
    pub(crate) fn wanted_extent(&self) -> [f64; 2] {
        match &self.kind {
            TrajectoryKind::Prescribed(prescribed, _) => [0.0, prescribed.duration],
            TrajectoryKind::Swept(_, extent) => *extent,
            TrajectoryKind::Free(motion) => {
                let end = motion.samples.last();
                [0.0, end.map_or(0.0, |sample| sample.t)]
            }
        }
    }

    /// Reports the progress at the `k`th position, if a step ends there.
    pub(crate) fn report(&self, k: usize, progress: Progress<'_>) {
        if k.is_multiple_of(POSITIONS_PER_STEP) {
            progress(Step {
                total: self.points.div_ceil(POSITIONS_PER_STEP),
                done: "positions",
            });
        }
    }

    /// The place of its definition in the scene.
    pub(crate) fn location(&self, scene: &PlaneScene) -> SceneLocation {
        match &self.kind {
            TrajectoryKind::Prescribed(..) => SceneLocation::Prescribed,
            TrajectoryKind::Free(_) => SceneLocation::Motion,
            TrajectoryKind::Swept(..) if scene.sweep.is_some() => SceneLocation::CoordinateSweep,
            TrajectoryKind::Swept(..) => SceneLocation::Whole,
        }
    }

    pub(crate) fn free_motion(&self) -> Option<&FreeTrajectory> {
        match &self.kind {
            TrajectoryKind::Free(motion) => Some(motion),
            TrajectoryKind::Prescribed(..) | TrajectoryKind::Swept(..) => None,
        }
    }

    /// The swept actuator; `None` if the trajectory is a motion in time.
    pub(crate) fn swept_actuator(&self) -> Option<usize> {
        match &self.kind {
            TrajectoryKind::Prescribed(..) | TrajectoryKind::Free(_) => None,
            TrajectoryKind::Swept(sweep, _) => Some(sweep.actuator.0),
        }
    }

    /// Whether its tables have a time: a static sweep has none.
    pub(crate) fn is_timed(&self) -> bool {
        self.swept_actuator().is_none() || self.analysis != Analysis::Statics
    }

    /// The time at which the loads of a sample are evaluated: without time, at t = 0.
    pub(crate) fn load_time(&self, sample: &TrajectorySample) -> f64 {
        if self.is_timed() { sample.t } else { 0.0 }
    }

    /// Visits one position after another of a model until a visit fails. Returns where and why it ends early, if it does.
    pub(crate) fn follow<'s, S: RowScene>(
        &'s self,
        model: &S::Model,
        mut visit: impl FnMut(usize, &TrajectorySample) -> Result<(), StopCause>,
    ) -> Option<EarlyStop<'s>> {
        let in_own_coordinate = self.free_motion().is_none_or(|motion| !motion.in_charts);
        let mut last: Option<TrajectorySample> = None;
        for k in 0..self.points {
            let fraction = self.fraction_at(k);
            let sample = self.sample_at(fraction);
            let before = last.as_ref().filter(|_| in_own_coordinate);
            let visited = match before.and_then(|at| S::unreachable(model, [at, &sample])) {
                Some(error) => Err(error.into()),
                None => visit(k, &sample),
            };
            if let Err(cause) = visited {
                return Some(EarlyStop {
                    trajectory: self,
                    fractions: [self.fraction_at(k.saturating_sub(1)), fraction],
                    cause,
                    last,
                    failed: sample,
                });
            }
            last = Some(sample);
        }
        None
    }

    /// Rejects a law that has no finite value, speed or acceleration at a position, exceeds the largest
    /// angle that keeps its digits, or is discontinuous between two positions.
    pub(crate) fn check_laws(&self, scene: &FollowedScene<'_>) -> Result<(), StudyError> {
        let TrajectoryKind::Prescribed(prescribed, spacing) = &self.kind else {
            return Ok(());
        };
        let mut previous: Option<f64> = None;
        for k in 0..self.points {
            let t = spacing.fraction_of_time(self.fraction_at(k)) * prescribed.duration;
            let time = || format!("t = {} s", digits(t, 6));
            let laws = scene.coordinates.iter().zip(&prescribed.laws);
            for (a, (&(name, is_angle), law)) in laws.enumerate() {
                let reject = |what: String, help: &str, label: String| {
                    let message = format!("the law of `{name}` {what}");
                    let place = (SceneLocation::PrescribedLaw(ActuatorId(a)), label);
                    Err(scene_error(scene.file, message, help, [place]))
                };
                let at = law.eval(t);
                let names = ["value", "speed", "acceleration"];
                if let Some(order) = at[..3].iter().position(|v| !v.is_finite()) {
                    let what = format!("no finite {}", names[order]);
                    return reject(
                        format!("has {what} at {}", time()),
                        "a prescribed motion needs a finite value and two finite derivatives everywhere",
                        what,
                    );
                }
                if is_angle && at[0].abs() > MAX_ANGLE {
                    return reject(
                        format!("is more than {MAX_ANGLE:e} rad at {}", time()),
                        "so large an angle has lost its last digits: end the motion earlier, or check the numbers",
                        "angle too large".to_owned(),
                    );
                }
                let jump = previous.and_then(|previous| law.discontinuity(previous, t));
                if let Some([from, to]) = jump {
                    let jumps = format!("jumps at t = {} s", jump_location(from, to));
                    let [p, q] = [from, to].map(|t| digits(law.eval(t)[0], 6));
                    return reject(format!("{jumps}, from {p} to {q}"), CONTINUITY_HELP, jumps);
                }
            }
            previous = Some(t);
        }
        Ok(())
    }

    /// The actuator coordinates at a completed fraction, from 0 to 1.
    pub(crate) fn sample_at(&self, fraction: f64) -> TrajectorySample {
        match &self.kind {
            TrajectoryKind::Prescribed(prescribed, spacing) => {
                let t = spacing.fraction_of_time(fraction) * prescribed.duration;
                let mut sample = TrajectorySample {
                    t,
                    ..TrajectorySample::default()
                };
                for law in &prescribed.laws {
                    let derivatives = law.eval(t);
                    sample.q.push(derivatives[0]);
                    sample.q_dot.push(derivatives[1]);
                    sample.q_ddot.push(derivatives[2]);
                }
                sample
            }
            TrajectoryKind::Free(FreeTrajectory { samples, .. }) => {
                let last = samples.len().saturating_sub(1);
                let k = (fraction * last as f64).round() as usize;
                samples[k.min(last)].clone()
            }
            TrajectoryKind::Swept(sweep, [from, to]) => {
                let (q, actuator) = (sweep.fixed_coordinates.clone(), sweep.actuator.0);
                let mut sample = TrajectorySample {
                    t: fraction * (to - from).abs() / sweep.speed,
                    q_dot: vec![0.0; q.len()],
                    q_ddot: vec![0.0; q.len()],
                    q,
                    ..TrajectorySample::default()
                };
                // Exact at both ends.
                sample.q[actuator] = from * (1.0 - fraction) + to * fraction;
                sample.q_dot[actuator] = sweep.speed.copysign(to - from);
                sample
            }
        }
    }

    /// The completed fraction at the `k`th position.
    pub(crate) fn fraction_at(&self, k: usize) -> f64 {
        k as f64 / (self.points - 1) as f64
    }
}

pub(crate) fn one_revolution(start: f64) -> SweepLimits {
    ([start, start + TAU], [false; 2], "one revolution")
}

/// The range between two ends, without a margin at those that are limit positions.
pub(crate) fn range_to_draw([low, high]: [f64; 2], is_limit: [bool; 2]) -> SweepLimits {
    let margin = LIMIT_MARGIN * (high - low);
    let [below, above] = is_limit.map(|is_limit| if is_limit { margin } else { 0.0 });
    ([low + below, high - above], is_limit, "the range")
}

/// The default sweep over the range of the only actuator.
pub(crate) fn default_limits(scene: &PlaneScene, plan: &Plan) -> SweepLimits {
    let start = plan.assembly_coordinates()[0];
    let half_stroke = DEFAULT_STROKE * scene.mechanism.size();
    match plan.range() {
        Range::Full => one_revolution(0.0),
        Range::Revolutions(revolutions) => {
            let end = start + TAU * f64::from(revolutions);
            ([start, end], [false; 2], "the period")
        }
        Range::Limited(from, to) => range_to_draw([from, to], [true; 2]),
        Range::Stroke(from, to) => {
            // A limit that was not found is only where the search stopped.
            let found = plan.range_limits().map(|end| end.is_some());
            let half_stroke = if plan.is_angle(0) { TAU } else { half_stroke };
            let low = if found[0] { from } else { start - half_stroke };
            let high = if found[1] { to } else { start + half_stroke };
            range_to_draw([low, high], found)
        }
        Range::Unbounded | Range::Unresolved(..) if plan.is_angle(0) => one_revolution(start),
        Range::Unbounded | Range::Unresolved(..) => (
            [start - half_stroke, start + half_stroke],
            [false; 2],
            "a stroke",
        ),
    }
}

/// Names of the energies' columns.
pub(crate) const KINETIC: &str = "energy.kinetic";
pub(crate) const POTENTIAL: &str = "energy.potential";
pub(crate) const BALANCE: &str = "energy.balance_error";

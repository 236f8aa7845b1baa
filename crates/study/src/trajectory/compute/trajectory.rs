//! The samples and the events of a motion as tables.

use crate::bodies::max_point_distance;
use crate::explain::StudyError;
use crate::number_format::{count, digits};
use crate::trajectory::compute::{Analysis, CONTINUITY_HELP, jump_location};
use dwell_geometry::{ActuatorId, Plan, Range};
use dwell_kinetostatics::Model;
use dwell_scene::{MAX_ANGLE, PrescribedMotion, Scene, SceneLocation};
use std::f64::consts::TAU;

/// Number of positions if neither the scene nor the caller gives one.
const DEFAULT_POINTS: usize = 361;
/// Fraction of a range left out at a limit position, where velocities grow without bound.
const LIMIT_MARGIN: f64 = 1e-3;
/// Half the stroke of a driven length without limits, in sizes of the mechanism.
const DEFAULT_STROKE: f64 = 0.25;

/// The actuator coordinates and their derivatives at one position.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TrajectorySample {
    /// Time since the start, s.
    pub(crate) t: f64,
    /// By actuator: coordinate (rad or m), speed and acceleration (per s, per s²).
    pub(crate) q: Vec<f64>,
    pub(crate) q_dot: Vec<f64>,
    pub(crate) q_ddot: Vec<f64>,
    /// Of a free motion: its chart; and where the chart uses another coordinate, that of the only actuator
    /// with its first and second derivatives.
    pub(crate) chart: usize,
    pub(crate) actuator_coordinate: Option<[f64; 3]>,
    /// Of a free motion: (load, magnitude) of each drive.
    pub(crate) drive_magnitudes: Vec<(usize, f64)>,
    /// Of a free motion: the values of its [`ExtraColumn`]s.
    pub(crate) extra_values: Vec<f64>,
}

/// A column that only the integration of a free motion yields, such as an energy.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ExtraColumn {
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) meaning: String,
}

/// A trajectory of the actuator coordinates, as a function of the completed fraction (0 to 1).
#[derive(Debug, Clone)]
pub(crate) struct Trajectory<'a> {
    kind: TrajectoryKind<'a>,
    /// Number of positions, both ends included.
    pub(crate) points: usize,
    /// Description for summaries.
    pub(crate) description: String,
    /// The method that computed its positions, for captions.
    pub(crate) method_text: String,
    /// Where the scene defines it.
    pub(crate) location: SceneLocation,
    /// Whether its start and its end are next to a limit position.
    pub(crate) ends_at_limit_position: [bool; 2],
    /// Period of the pose in the coordinate of the only actuator, rad.
    pub(crate) period: Option<f64>,
}

#[derive(Debug, Clone)]
enum TrajectoryKind<'a> {
    Prescribed(&'a PrescribedMotion),
    /// A free motion, sampled.
    Free {
        samples: Vec<TrajectorySample>,
        extra_columns: Vec<ExtraColumn>,
        /// By actuator: whether its coordinate is prescribed.
        prescribed: Vec<bool>,
        /// By chart: the model in its coordinate.
        charts: Vec<Model>,
    },
    Swept {
        actuator: usize,
        from: f64,
        to: f64,
        fixed_coordinates: Vec<f64>,
        speed: f64,
    },
}

/// The limits of a sweep.
struct SweepLimits {
    from: f64,
    to: f64,
    ends_at_limit_position: [bool; 2],
    description: &'static str,
}

/// The method text of a trajectory that is not integrated.
fn positions_text(points: usize) -> String {
    format!("the mechanism at {}", count(points, "position"))
}

impl<'a> Trajectory<'a> {
    /// The trajectory that an analysis of a scene follows, at `points` positions if given.
    ///
    /// # Errors
    /// [`StudyError::Scene`] if the scene does not define the actuator coordinates.
    pub(crate) fn new(
        scene: &'a Scene,
        plan: &Plan,
        analysis: Analysis,
        points: Option<usize>,
    ) -> Result<Self, StudyError> {
        if let Some(prescribed) = &scene.prescribed {
            let points = points.unwrap_or(prescribed.points).max(2);
            return Ok(Self {
                points,
                method_text: positions_text(points),
                description: format!(
                    "the prescribed motion of {} s",
                    digits(prescribed.duration, 6)
                ),
                kind: TrajectoryKind::Prescribed(prescribed),
                location: SceneLocation::Prescribed,
                ends_at_limit_position: [false; 2],
                period: plan.range().period(),
            });
        }
        let (actuator, range, fixed_coordinates, requested, speed, location) = match &scene.sweep {
            Some(sweep) => (
                sweep.actuator.0,
                sweep.range,
                sweep.fixed_coordinates.clone(),
                Some(sweep.points),
                sweep.speed,
                SceneLocation::CoordinateSweep,
            ),
            None if plan.actuators() != 1 || analysis == Analysis::Kinetostatics => {
                return Err(no_trajectory_error(scene, analysis));
            }
            None => (
                0,
                None,
                plan.assembly_coordinates().to_vec(),
                None,
                1.0,
                SceneLocation::Whole,
            ),
        };
        let limits = match range {
            Some([from, to]) => SweepLimits {
                from,
                to,
                ends_at_limit_position: [false; 2],
                description: "the sweep",
            },
            None if plan.actuators() == 1 => default_limits(scene, plan),
            None if plan.is_angle(actuator) => SweepLimits {
                from: fixed_coordinates[actuator],
                to: fixed_coordinates[actuator] + TAU,
                ends_at_limit_position: [false; 2],
                description: "one turn",
            },
            None => return Err(open_sweep_error(scene, actuator)),
        };
        let unit = if plan.is_angle(actuator) { "rad" } else { "m" };
        let name = &scene.mechanism.actuators[actuator].name;
        let points = points.or(requested).unwrap_or(DEFAULT_POINTS).max(2);
        Ok(Self {
            method_text: positions_text(points),
            description: format!(
                "{} of {name} from {} to {} {unit}",
                limits.description,
                digits(limits.from, 6),
                digits(limits.to, 6)
            ),
            kind: TrajectoryKind::Swept {
                actuator,
                from: limits.from,
                to: limits.to,
                fixed_coordinates,
                speed,
            },
            points,
            location,
            ends_at_limit_position: limits.ends_at_limit_position,
            period: plan.range().period(),
        })
    }

    /// A computed free motion of two samples or more.
    pub(crate) fn of_free_motion(
        plan: &Plan,
        samples: Vec<TrajectorySample>,
        extra_columns: Vec<ExtraColumn>,
        prescribed: Vec<bool>,
        charts: Vec<Model>,
    ) -> Self {
        let last = samples.last().map_or(0.0, |s| s.t);
        Self {
            points: samples.len(),
            method_text: positions_text(samples.len()),
            description: format!("a free motion of {} s", digits(last, 6)),
            kind: TrajectoryKind::Free {
                samples,
                extra_columns,
                prescribed,
                charts,
            },
            location: SceneLocation::Motion,
            ends_at_limit_position: [false; 2],
            period: plan.range().period(),
        }
    }

    /// The models by chart; empty if the scene's own model applies throughout.
    pub(crate) fn charts(&self) -> &[Model] {
        match &self.kind {
            TrajectoryKind::Free { charts, .. } => charts,
            TrajectoryKind::Prescribed(_) | TrajectoryKind::Swept { .. } => &[],
        }
    }

    /// Whether an actuator exerts a force: in a free motion only prescribed ones do.
    pub(crate) fn exerts_force(&self, actuator: usize) -> bool {
        match &self.kind {
            TrajectoryKind::Free { prescribed, .. } => prescribed[actuator],
            TrajectoryKind::Prescribed(_) | TrajectoryKind::Swept { .. } => true,
        }
    }

    /// The columns that its integration adds.
    pub(crate) fn extra_columns(&self) -> &[ExtraColumn] {
        match &self.kind {
            TrajectoryKind::Free { extra_columns, .. } => extra_columns,
            TrajectoryKind::Prescribed(_) | TrajectoryKind::Swept { .. } => &[],
        }
    }

    /// Rejects a law that has no finite value, speed or acceleration at a position, exceeds the largest
    /// angle that keeps its digits, or is discontinuous between two positions.
    pub(crate) fn check_laws(&self, scene: &Scene) -> Result<(), StudyError> {
        let TrajectoryKind::Prescribed(prescribed) = &self.kind else {
            return Ok(());
        };
        let actuators = &scene.mechanism.actuators;
        let mut previous: Option<f64> = None;
        for k in 0..self.points {
            let t = self.fraction_at(k) * prescribed.duration;
            for (a, (actuator, law)) in actuators.iter().zip(&prescribed.laws).enumerate() {
                let reject = |what: String, help: &str, label: String| {
                    let message = format!("the law of `{}` {what}", actuator.name);
                    let labels = [(SceneLocation::PrescribedLaw(ActuatorId(a)), label)];
                    Err(scene.error(message, Some(help.to_owned()), &labels).into())
                };
                let at = law.eval(t);
                let names = ["value", "speed", "acceleration"];
                if let Some(order) = at[..3].iter().position(|v| !v.is_finite()) {
                    let what = format!("no finite {}", names[order]);
                    return reject(
                        format!("has {what} at t = {} s", digits(t, 6)),
                        "a prescribed motion needs a finite value and two finite derivatives everywhere",
                        what,
                    );
                }
                if actuator.coordinate().is_angle() && at[0].abs() > MAX_ANGLE {
                    return reject(
                        format!("is more than {MAX_ANGLE:e} rad at t = {} s", digits(t, 6)),
                        "so large an angle has lost its last digits: end the motion earlier, or check \
                         the numbers",
                        "angle too large".to_owned(),
                    );
                }
                if let Some([from, to]) =
                    previous.and_then(|previous| law.discontinuity(previous, t))
                {
                    let time = jump_location(from, to);
                    let [p, q] = [from, to].map(|t| digits(law.eval(t)[0], 6));
                    return reject(
                        format!("jumps at t = {time} s, from {p} to {q}"),
                        CONTINUITY_HELP,
                        format!("jumps at t = {time} s"),
                    );
                }
            }
            previous = Some(t);
        }
        Ok(())
    }

    /// The actuator coordinates at a completed fraction, from 0 to 1.
    pub(crate) fn sample_at(&self, fraction: f64) -> TrajectorySample {
        match &self.kind {
            TrajectoryKind::Prescribed(prescribed) => {
                let t = fraction * prescribed.duration;
                let derivative = |k: usize| prescribed.laws.iter().map(|l| l.eval(t)[k]).collect();
                TrajectorySample {
                    t,
                    q: derivative(0),
                    q_dot: derivative(1),
                    q_ddot: derivative(2),
                    chart: 0,
                    actuator_coordinate: None,
                    drive_magnitudes: Vec::new(),
                    extra_values: Vec::new(),
                }
            }
            TrajectoryKind::Free { samples, .. } => {
                let last = samples.len().saturating_sub(1);
                let k = (fraction * last as f64).round() as usize;
                samples[k.min(last)].clone()
            }
            TrajectoryKind::Swept {
                actuator,
                from,
                to,
                fixed_coordinates,
                speed,
            } => {
                let zeros = vec![0.0; fixed_coordinates.len()];
                let mut sample = TrajectorySample {
                    t: fraction * (to - from).abs() / speed,
                    q: fixed_coordinates.clone(),
                    q_dot: zeros.clone(),
                    q_ddot: zeros,
                    chart: 0,
                    actuator_coordinate: None,
                    drive_magnitudes: Vec::new(),
                    extra_values: Vec::new(),
                };
                // Exact at both ends.
                sample.q[*actuator] = from * (1.0 - fraction) + to * fraction;
                sample.q_dot[*actuator] = speed.copysign(to - from);
                sample
            }
        }
    }

    /// The completed fraction at the `k`th position.
    pub(crate) fn fraction_at(&self, k: usize) -> f64 {
        k as f64 / (self.points - 1) as f64
    }

    /// The swept actuator; `None` if the trajectory is a motion in time.
    pub(crate) fn swept_actuator(&self) -> Option<usize> {
        match &self.kind {
            TrajectoryKind::Prescribed(_) | TrajectoryKind::Free { .. } => None,
            TrajectoryKind::Swept { actuator, .. } => Some(*actuator),
        }
    }
}

/// The limits of the default sweep over the range of the only actuator, rad or m.
pub(crate) fn swept_range(scene: &Scene, plan: &Plan) -> [f64; 2] {
    let SweepLimits { from, to, .. } = default_limits(scene, plan);
    [from, to]
}

/// The default sweep over the range of the only actuator.
fn default_limits(scene: &Scene, plan: &Plan) -> SweepLimits {
    let start = plan.assembly_coordinates()[0];
    let half_stroke = DEFAULT_STROKE * max_point_distance(scene);
    let limits = |from, to, ends_at_limit_position, description| SweepLimits {
        from,
        to,
        ends_at_limit_position,
        description,
    };
    match plan.range() {
        Range::Full => limits(0.0, TAU, [false; 2], "one turn"),
        Range::Revolutions(revolutions) => {
            let end = start + TAU * f64::from(revolutions);
            limits(start, end, [false; 2], "the period")
        }
        Range::Limited(from, to) => {
            let margin = LIMIT_MARGIN * (to - from);
            limits(from + margin, to - margin, [true; 2], "the range")
        }
        Range::Stroke(from, to) => {
            // A limit that was not found is only where the search stopped.
            let found = plan.range_limits().map(|end| end.is_some());
            let half_stroke = if plan.is_angle(0) { TAU } else { half_stroke };
            let low = if found[0] { from } else { start - half_stroke };
            let high = if found[1] { to } else { start + half_stroke };
            let margin = LIMIT_MARGIN * (high - low);
            let margin_at = |found: bool| if found { margin } else { 0.0 };
            limits(
                low + margin_at(found[0]),
                high - margin_at(found[1]),
                found,
                "the range",
            )
        }
        Range::Unbounded | Range::Unresolved(..) if plan.is_angle(0) => {
            limits(start, start + TAU, [false; 2], "one turn")
        }
        Range::Unbounded | Range::Unresolved(..) => limits(
            start - half_stroke,
            start + half_stroke,
            [false; 2],
            "a stroke",
        ),
    }
}

/// The error of a scene that prescribes no actuator coordinates.
fn no_trajectory_error(scene: &Scene, analysis: Analysis) -> StudyError {
    let actuators = &scene.mechanism.actuators;
    let label = |a| {
        (
            SceneLocation::Actuator(ActuatorId(a)),
            "no coordinate is given".to_owned(),
        )
    };
    let mut labels: Vec<_> = (0..actuators.len()).map(label).collect();
    if labels.is_empty() {
        labels.push((
            SceneLocation::Whole,
            "there are no [actuators] in this file".into(),
        ));
    }
    let message = match analysis {
        Analysis::Kinetostatics => {
            "the scene prescribes no motion, so there are no accelerations".to_owned()
        }
        _ => format!(
            "the scene has {} and no coordinates for them",
            count(actuators.len(), "actuator")
        ),
    };
    let example = actuators.first().map_or("phi", |a| a.name.as_str());
    let help = format!(
        "add [prescribed] with a `duration` and a law for each, as in `{example} = {{ speed = 1.0 }}`; or \
         [coordinate-sweep] with a range for one of them, as in `{example} = [0.0, 1.0]`"
    );
    scene.error(message, Some(help), &labels).into()
}

/// The error of a swept length that has no limits, in a mechanism with several actuators.
fn open_sweep_error(scene: &Scene, actuator: usize) -> StudyError {
    let name = &scene.mechanism.actuators[actuator].name;
    scene
        .error(
            format!("[coordinate-sweep] gives no range for `{name}`"),
            Some(format!(
                "add `{name} = [from, to]`: the range is computed for a single actuator only"
            )),
            &[(SceneLocation::CoordinateSweep, "no range".to_owned())],
        )
        .into()
}

/// Names of the energies' columns.
pub(crate) const KINETIC: &str = "energy.kinetic";
pub(crate) const POTENTIAL: &str = "energy.potential";
pub(crate) const BALANCE: &str = "energy.balance_error";

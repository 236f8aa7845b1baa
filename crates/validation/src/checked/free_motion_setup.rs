//! A free motion for a scene without `[motion]`: about one revolution, or one swing.

use crate::cases::reference::Reference;
use crate::checked::multibody::FreeMotionRun;
use dwell_scene::{FreeMotionSpec, MotionDuration, Scene};
use dwell_study::StudyError;
use dwell_study::models::compile_model;
use dwell_study::number_format::digits;
use std::f64::consts::TAU;

/// What is left of a motion that ends by itself, and of the range next to a limit position, where everything
/// grows.
const KEPT_FRACTION: f64 = 0.9;
const RANGE_MARGIN: f64 = 0.02;
/// Steps of the integrator at least: a long one would hide a whole turn.
const MIN_STEPS: f64 = 100.0;

/// A scene with a motion of its own making.
pub(crate) struct FreeMotionSetup {
    pub(crate) scene: Scene,
    actuator: usize,
    /// A whole turn, rad, or the width of the range, m.
    full_travel: f64,
    /// Where the motion is cut: the range, or the sweep, without its margins.
    allowed_range: [f64; 2],
}

impl FreeMotionSetup {
    /// Sets every actuator free: the swept one, or else the first, in the middle of its sweep or where the
    /// mechanism is put together, with the speed of the sweep, else the fastest of the reference, else 1 rad/s
    /// or m/s; the others at rest.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together.
    pub(crate) fn new(scene: &Scene, reference: &Reference) -> Result<Self, StudyError> {
        let model = compile_model(scene, &[])?;
        let plan = model.plan();
        let mut start = scene.assembly.coordinates.clone();
        let sweep = scene.sweep.as_ref();
        let actuator = sweep.map_or(0, |sweep| sweep.actuator.0);
        if let Some(sweep) = sweep {
            start.clone_from(&sweep.fixed_coordinates);
            if let Some([from, to]) = sweep.range {
                start[actuator] = 0.5 * (from + to);
            }
        }
        let speed = sweep.map(|sweep| sweep.speed);
        let speed = speed.or_else(|| reference.max_velocity()).unwrap_or(1.0);
        let points = scene.points.iter().flatten();
        let size = points.fold(0.0_f64, |max, (_, at)| max.max(at.norm()));
        let full_travel = match plan.range().limits() {
            _ if plan.is_angle(actuator) => TAU,
            Some((from, to)) if plan.actuators() == 1 => to - from,
            _ if size > 0.0 => size,
            _ => 1.0,
        };
        let sweep_range = sweep.and_then(|sweep| sweep.range);
        let limits = plan.range().limits().filter(|_| plan.actuators() == 1);
        let allowed_range = match (sweep_range, limits) {
            (Some([a, b]), _) | (None, Some((a, b))) => {
                let margin = RANGE_MARGIN * (b - a).abs();
                [a.min(b) + margin, a.max(b) - margin]
            }
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let count = start.len();
        let mut velocities = vec![0.0; count];
        velocities[actuator] = speed;
        let motion = FreeMotionSpec {
            initial_coordinates: start,
            initial_velocities: velocities,
            laws: vec![None; count],
            duration: MotionDuration::Seconds(full_travel / speed),
            events: Vec::new(),
        };
        let mut free_scene = scene.clone();
        free_scene.motion = Some(motion);
        Ok(Self {
            scene: free_scene,
            actuator,
            full_travel,
            allowed_range,
        })
    }

    /// The longest step of its integration, s.
    pub(crate) fn max_step(&self) -> Option<f64> {
        match self.scene.motion.as_ref()?.duration {
            MotionDuration::Seconds(duration) => Some(duration / MIN_STEPS),
            MotionDuration::Periods(_) => None,
        }
    }

    /// Ends a run after one turn or one swing, and short of where it stopped by itself; says so.
    pub(crate) fn truncate(&self, run: &mut FreeMotionRun) {
        let stop_reason = run.stop_reason.take();
        let end = run.steps.last().map_or(0.0, |last| last.t);
        let of = |k: usize| run.coordinates[k][self.actuator];
        let (mut reversals, mut kept_steps, mut cause) =
            (0, run.steps.len(), "the time of one turn");
        for k in 1..run.steps.len() {
            reversals += usize::from(of(k)[1] * of(k - 1)[1] < 0.0);
            let [low, high] = self.allowed_range;
            let limit = of(k)[0] < low || of(k)[0] > high;
            let stops = stop_reason.is_some() && run.steps[k].t > KEPT_FRACTION * end;
            let before_end = limit || stops;
            let over = [
                (limit, "short of a limit position or the end of the sweep"),
                (stops, "short of where it stops"),
                ((of(k)[0] - of(0)[0]).abs() >= self.full_travel, "one turn"),
                (reversals > 2, "one swing"),
            ];
            if let Some((_, text)) = over.into_iter().find(|(over, _)| *over) {
                (kept_steps, cause) = (k + usize::from(!before_end), text);
                break;
            }
        }
        run.steps.truncate(kept_steps);
        run.coordinates.truncate(kept_steps);
        let (Some(first), Some(last)) = (run.coordinates.first(), run.steps.last()) else {
            return;
        };
        let [q, speed] = first[self.actuator];
        let actuator = &self.scene.mechanism.actuators[self.actuator];
        let unit = if actuator.coordinate().is_angle() {
            "rad"
        } else {
            "m"
        };
        run.setup = format!(
            "set free at {} = {} {unit} with {} {unit}/s, until t = {} s: {cause}",
            actuator.name,
            digits(q, 6),
            digits(speed, 6),
            digits(last.t, 4)
        );
        if let Some(reason) = stop_reason.filter(|_| cause.starts_with("short of where")) {
            run.setup += &format!(" ({})", reason.lines().next().unwrap_or(""));
        }
    }
}

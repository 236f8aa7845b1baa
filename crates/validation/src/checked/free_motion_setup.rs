//! A free motion for a scene without `[motion]`: about one revolution, or one oscillation.

use crate::cases::reference::Reference;
use crate::checked::multibody::FreeMotionRun;
use dwell_scene::{FreeMotionSpec, MotionDuration, PlaneScene};
use dwell_study::StudyError;
use dwell_study::models::compile_model;
use dwell_study::number_format::digits;
use std::f64::consts::TAU;

/// The part that is kept of a motion that ends by itself, and the margin at a limit position, where everything
/// grows.
const KEPT_FRACTION: f64 = 0.9;
const RANGE_MARGIN: f64 = 0.02;
/// Steps of the integrator at least: a long one would hide a whole revolution.
const MIN_STEPS: f64 = 100.0;

/// A scene that is given a free motion.
pub(crate) struct FreeMotionSetup {
    pub(crate) scene: PlaneScene,
    /// The longest step of its integration, s.
    pub(crate) max_step: f64,
    actuator: usize,
    /// A revolution, rad, or the width of the range, m.
    full_travel: f64,
    /// Where the motion is cut: the range, or the sweep, without its margins.
    allowed_range: [f64; 2],
}

impl FreeMotionSetup {
    /// Sets every actuator free: the swept one, or else the first, in the middle of its sweep or at
    /// assembly, with the speed of the sweep, else the fastest of the reference, else 1 rad/s
    /// or m/s; the others at rest.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together.
    pub(crate) fn new(scene: &PlaneScene, reference: &Reference) -> Result<Self, StudyError> {
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
        let limits = plan.range().limits().filter(|_| plan.actuators() == 1);
        let full_travel = match limits {
            _ if plan.is_angle(actuator) => TAU,
            Some((from, to)) => to - from,
            None => scene.mechanism.size(),
        };
        let sweep_range = sweep.and_then(|sweep| sweep.range);
        let allowed_range = match sweep_range.or(limits.map(|(a, b)| [a, b])) {
            Some([a, b]) => {
                let margin = RANGE_MARGIN * (b - a).abs();
                [a.min(b) + margin, a.max(b) - margin]
            }
            None => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let duration = full_travel / speed;
        let count = start.len();
        let mut velocities = vec![0.0; count];
        velocities[actuator] = speed;
        let motion = FreeMotionSpec {
            initial_coordinates: start,
            initial_velocities: velocities,
            laws: vec![None; count],
            duration: MotionDuration::Seconds(duration),
            events: Vec::new(),
        };
        let mut free_scene = scene.clone();
        free_scene.motion = Some(motion);
        Ok(Self {
            scene: free_scene,
            max_step: duration / MIN_STEPS,
            actuator,
            full_travel,
            allowed_range,
        })
    }

    /// A state of the moving actuator as text.
    fn state_text(&self, state: [f64; 2]) -> String {
        let actuator = &self.scene.mechanism.actuators[self.actuator];
        let (name, unit) = (&actuator.name, actuator.coordinate().unit());
        let [q, speed] = state.map(|v| digits(v, 6));
        format!("{name} = {q} {unit} with {speed} {unit}/s")
    }

    /// Ends a run after one revolution or one oscillation, and short of its own end; describes it.
    pub(crate) fn truncate(&self, run: &mut FreeMotionRun) {
        let stop_reason = run.stop_reason.take();
        let end = run.steps.last().map_or(0.0, |last| last.t);
        let of = |k: usize| run.coordinates[k][self.actuator];
        let (mut reversals, mut kept_steps) = (0, run.steps.len());
        let mut cause = "the time of one revolution";
        for k in 1..run.steps.len() {
            reversals += usize::from(of(k)[1] * of(k - 1)[1] < 0.0);
            let [low, high] = self.allowed_range;
            let limit = of(k)[0] < low || of(k)[0] > high;
            let stops = stop_reason.is_some() && run.steps[k].t > KEPT_FRACTION * end;
            let before_end = limit || stops;
            let travel = (of(k)[0] - of(0)[0]).abs();
            let over = [
                (limit, "short of a limit position or the end of the sweep"),
                (stops, "short of its end"),
                (travel >= self.full_travel, "one revolution"),
                (reversals > 2, "one oscillation"),
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
        let (start, end) = (self.state_text(first[self.actuator]), digits(last.t, 4));
        run.setup = format!("set free at {start}, until t = {end} s: {cause}");
        if let Some(reason) = stop_reason.filter(|_| cause == "short of its end") {
            run.setup += &format!(" ({})", reason.lines().next().unwrap_or(""));
        }
    }
}

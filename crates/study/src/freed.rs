//! A scene without `[motion]`, set free to be judged in motion: about one turn, or one swing.

use crate::error::StudyError;
use crate::multibody::FreeRun;
use crate::prepare::compiled;
use crate::reference::Reference;
use crate::words::digits;
use dwell_scene::{Length, Motion, Scene};
use std::f64::consts::TAU;

/// What is left of a motion that ends by itself, and of the range next to a limit position, where everything
/// grows.
const SHORT: f64 = 0.9;
const MARGIN: f64 = 0.02;
/// Steps of the integrator at least: a long one would hide a whole turn.
const STEPS: f64 = 100.0;

/// A scene with a motion of its own making.
pub(crate) struct Freed {
    pub(crate) scene: Scene,
    actuator: usize,
    /// A whole turn, rad, or the width of the range, m.
    way: f64,
    /// Where the motion is cut: the range, or the sweep, without its margins.
    inside: [f64; 2],
}

impl Freed {
    /// Sets every actuator free: the swept one, or else the first, in the middle of its sweep or where the
    /// mechanism is put together, with the speed of the sweep, else the fastest of the reference, else 1 rad/s
    /// or m/s; the others at rest.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be put together.
    pub(crate) fn new(scene: &Scene, reference: &Reference) -> Result<Self, StudyError> {
        let model = compiled(scene, &[])?;
        let plan = model.plan();
        let mut start = scene.assembly.start.clone();
        let sweep = scene.sweep.as_ref();
        let actuator = sweep.map_or(0, |sweep| sweep.actuator.0);
        if let Some(sweep) = sweep {
            start.clone_from(&sweep.held);
            if let Some([from, to]) = sweep.range {
                start[actuator] = 0.5 * (from + to);
            }
        }
        let speed = sweep.map(|sweep| sweep.speed);
        let speed = speed.or_else(|| reference.fastest()).unwrap_or(1.0);
        let points = scene.points.iter().flatten();
        let size = points.fold(0.0_f64, |most, (_, at)| most.max(at.norm()));
        let way = match plan.range().limits() {
            _ if plan.is_angle(actuator) => TAU,
            Some((from, to)) if plan.actuators() == 1 => to - from,
            _ if size > 0.0 => size,
            _ => 1.0,
        };
        let swept = sweep.and_then(|sweep| sweep.range);
        let limits = plan.range().limits().filter(|_| plan.actuators() == 1);
        let inside = match (swept, limits) {
            (Some([a, b]), _) | (None, Some((a, b))) => {
                let margin = MARGIN * (b - a).abs();
                [a.min(b) + margin, a.max(b) - margin]
            }
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        };
        let count = start.len();
        let mut speeds = vec![0.0; count];
        speeds[actuator] = speed;
        let motion = Motion {
            start,
            speed: speeds,
            laws: vec![None; count],
            length: Length::Duration(way / speed),
            events: Vec::new(),
        };
        let mut freed = scene.clone();
        freed.motion = Some(motion);
        Ok(Self {
            scene: freed,
            actuator,
            way,
            inside,
        })
    }

    /// The longest step of its integration, s.
    pub(crate) fn longest(&self) -> Option<f64> {
        match self.scene.motion.as_ref()?.length {
            Length::Duration(duration) => Some(duration / STEPS),
            Length::Periods(_) => None,
        }
    }

    /// Ends a run after one turn or one swing, and short of where it stopped by itself; says so.
    pub(crate) fn cut(&self, run: &mut FreeRun) {
        let stopped = run.stopped.take();
        let end = run.steps.last().map_or(0.0, |last| last.t);
        let of = |k: usize| run.coordinates[k][self.actuator];
        let (mut back, mut keep, mut why) = (0, run.steps.len(), "the time of one turn");
        for k in 1..run.steps.len() {
            back += usize::from(of(k)[1] * of(k - 1)[1] < 0.0);
            let [low, high] = self.inside;
            let limit = of(k)[0] < low || of(k)[0] > high;
            let stops = stopped.is_some() && run.steps[k].t > SHORT * end;
            let short = limit || stops;
            let over = [
                (limit, "short of a limit position or the end of the sweep"),
                (stops, "short of where it stops"),
                ((of(k)[0] - of(0)[0]).abs() >= self.way, "one turn"),
                (back > 2, "one swing"),
            ];
            if let Some((_, words)) = over.into_iter().find(|(over, _)| *over) {
                (keep, why) = (k + usize::from(!short), words);
                break;
            }
        }
        run.steps.truncate(keep);
        run.coordinates.truncate(keep);
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
        run.told = format!(
            "set free at {} = {} {unit} with {} {unit}/s, until t = {} s: {why}",
            actuator.name,
            digits(q, 6),
            digits(speed, 6),
            digits(last.t, 4)
        );
        if let Some(reason) = stopped.filter(|_| why.starts_with("short of where")) {
            run.told += &format!(" ({})", reason.lines().next().unwrap_or(""));
        }
    }
}

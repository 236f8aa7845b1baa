//! The estimated error of a motion: a second run at a tenth of the tolerance, compared where both were sampled.

use super::{Free, Moved};
use crate::error::StudyError;
use crate::estimate;
use crate::motion_error::explain_motion;
use crate::run::Sample;
use dwell_dynamics::{DynamicsError, Options};
use dwell_scene::Scene;
use std::fmt::Write as _;

impl Free<'_> {
    /// What is said of the error at the end of a motion with these samples.
    pub(super) fn estimated(
        &self,
        scene: &Scene,
        moved: &Moved,
        options: &Options,
    ) -> Result<String, StudyError> {
        let duration = moved.end();
        if duration == 0.0 {
            return Ok(String::new());
        }
        let explain = |e: &DynamicsError| explain_motion(self.scene, self.shown.plan(), e);
        let samples = &self.samples(moved).map_err(|e| explain(&e))?;
        let finer = estimate::second(options);
        let tried = if finer.method == options.method {
            "a tenth of the tolerance".to_owned()
        } else {
            format!("the same tolerance by {}", finer.method.name())
        };
        let again = self.follow(scene, duration, &finer);
        let again = again
            .ok()
            .and_then(|moved: Moved| self.samples(&moved).ok());
        // The last samples may be missing where an event ends one of the runs first.
        let pairs: Vec<(&Sample, &Sample)> = match &again {
            Some(again) => samples.iter().zip(again).collect(),
            None => Vec::new(),
        };
        let same = pairs.iter().take_while(|(a, b)| a.t == b.t).count();
        let pairs = &pairs[..same];
        let Some(((first, _), (last, _))) = pairs.first().zip(pairs.last()) else {
            let none = format!("  no error can be estimated: a second run, at {tried}, fails\n");
            return Ok(none);
        };
        let until = |of: &dyn Fn(&Sample) -> f64, rounding: f64| {
            let [one, two] = [0, 1].map(|side| {
                let pick = |&(a, b): &(&Sample, &Sample)| of(if side == 0 { a } else { b });
                pairs.iter().map(pick).collect::<Vec<f64>>()
            });
            estimate::of_motion(&one, &two, rounding)
        };
        let at = if last.t < duration {
            format!("at t = {} s", crate::words::digits(last.t, 6))
        } else {
            "at the end".to_owned()
        };
        // Writing to a string cannot fail.
        let mut text = format!("  estimated error {at}:");
        for &i in self.machine.free() {
            let value = |s: &Sample| s.own.map_or(s.q[i], |own| own[0]);
            let unknown = self.start_error(i) * (value(last) - value(first)).abs();
            let rounding = 4.0 * f64::EPSILON * value(last).abs() + unknown;
            let unit = if self.shown.plan().is_angle(i) {
                "rad"
            } else {
                "m"
            };
            let name = &self.scene.mechanism.actuators[i].name;
            let error = until(&value, rounding);
            let _ = write!(text, " {error:.1e} {unit} in {name},");
        }
        let kinetic = |s: &Sample| s.told.first().copied().unwrap_or(0.0);
        let largest = samples.iter().map(kinetic).fold(0.0, f64::max);
        if largest > 0.0 {
            let sum = 2 + self.machine.workers().len();
            let balance = |s: &Sample| s.told.get(sum).copied().unwrap_or(f64::NAN);
            let error = until(&balance, 4.0 * f64::EPSILON * largest) / largest;
            let _ = write!(text, " {error:.1e} of the largest kinetic energy,");
        }
        Ok(text + &format!(" from a second run at {tried}\n"))
    }

    /// The relative rounding error of the speed at the start, from that of the only coordinate's inertia.
    fn start_error(&self, coordinate: usize) -> f64 {
        let model = self.machine.model();
        if model.plan().actuators() != 1 {
            return f64::EPSILON;
        }
        let start = self.motion.start[coordinate];
        match estimate::reduced(&model.without_reactions(), start) {
            Ok((at, error)) if at.m > 0.0 => 0.5 * error.m / at.m,
            _ => f64::EPSILON,
        }
    }
}

//! The estimated error of a motion, from a second run at a tenth of the tolerance.

use crate::estimate;
use crate::explain::{StudyError, explain_motion};
use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{DynamicsError, Options};
use dwell_scene::Scene;
use std::fmt::Write as _;

impl FreeMotionProblem<'_> {
    /// The line of the summary about the error at the end of a motion.
    pub(crate) fn estimate_error(
        &self,
        scene: &Scene,
        motion: &SegmentedMotion,
        options: &Options,
    ) -> Result<String, StudyError> {
        let duration = motion.end_time();
        if duration == 0.0 {
            return Ok(String::new());
        }
        let explain =
            |e: &DynamicsError| explain_motion(self.loaded_scene, self.output_model.plan(), e);
        let samples = &self.samples(motion).map_err(|e| explain(&e))?;
        let finer = estimate::comparison_options(options);
        let refinement = if finer.method == options.method {
            "a tenth of the tolerance".to_owned()
        } else {
            format!("the same tolerance by {}", finer.method.name())
        };
        let second = self.solve(scene, duration, &finer);
        let second = second
            .ok()
            .and_then(|motion: SegmentedMotion| self.samples(&motion).ok());
        // The last samples may be missing if an event ends one of the runs earlier.
        let pairs: Vec<(&TrajectorySample, &TrajectorySample)> = match &second {
            Some(second) => samples.iter().zip(second).collect(),
            None => Vec::new(),
        };
        let common = pairs.iter().take_while(|(a, b)| a.t == b.t).count();
        let pairs = &pairs[..common];
        let Some(((first, _), (last, _))) = pairs.first().zip(pairs.last()) else {
            let none = format!("  no error estimate: a second run, at {refinement}, fails\n");
            return Ok(none);
        };
        let error_of = |of: &dyn Fn(&TrajectorySample) -> f64, rounding: f64| {
            let [one, two] = [0, 1].map(|side| {
                let pick = |&(a, b): &(&TrajectorySample, &TrajectorySample)| {
                    of(if side == 0 { a } else { b })
                };
                pairs.iter().map(pick).collect::<Vec<f64>>()
            });
            estimate::of_motion(&one, &two, rounding)
        };
        let at = if last.t < duration {
            format!("at t = {} s", crate::number_format::digits(last.t, 6))
        } else {
            "at the end".to_owned()
        };
        // Writing to a string cannot fail.
        let mut text = format!("  estimated error {at}:");
        for &i in self.machine.free() {
            let value = |s: &TrajectorySample| {
                s.actuator_coordinate
                    .map_or(s.q[i], |derivatives| derivatives[0])
            };
            let unknown = self.initial_speed_error(i) * (value(last) - value(first)).abs();
            let rounding = 4.0 * f64::EPSILON * value(last).abs() + unknown;
            let unit = if self.output_model.plan().is_angle(i) {
                "rad"
            } else {
                "m"
            };
            let name = &self.loaded_scene.mechanism.actuators[i].name;
            let error = error_of(&value, rounding);
            let _ = write!(text, " {error:.1e} {unit} in {name},");
        }
        let kinetic = |s: &TrajectorySample| s.extra_values.first().copied().unwrap_or(0.0);
        let max_kinetic = samples.iter().map(kinetic).fold(0.0, f64::max);
        if max_kinetic > 0.0 {
            let balance_index = 2 + self.machine.nonconservative_sources().len();
            let balance = |s: &TrajectorySample| {
                s.extra_values
                    .get(balance_index)
                    .copied()
                    .unwrap_or(f64::NAN)
            };
            let error = error_of(&balance, 4.0 * f64::EPSILON * max_kinetic) / max_kinetic;
            let _ = write!(text, " {error:.1e} of the largest kinetic energy,");
        }
        Ok(text + &format!(" from a second run at {refinement}\n"))
    }

    /// The relative rounding error of the initial speed, from that of the only coordinate's inertia.
    fn initial_speed_error(&self, coordinate: usize) -> f64 {
        let model = self.machine.model();
        if model.plan().actuators() != 1 {
            return f64::EPSILON;
        }
        let start = self.spec.initial_coordinates[coordinate];
        match estimate::coefficients_with_errors(&model.without_reactions(), start) {
            Ok((at, error)) if at.m > 0.0 => 0.5 * error.m / at.m,
            _ => f64::EPSILON,
        }
    }
}

//! The estimated error of a motion, from a second run at a tenth of the tolerance.

use crate::estimate::{self, is_rounding};
use crate::explain::StudyError;
use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::number_format::{coordinate_unit, digits};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::Options;
use dwell_scene::Scene;

/// A sample of each of two runs at the same time.
type SamplePair<'a> = (&'a TrajectorySample, &'a TrajectorySample);

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
        let samples = self.samples(motion).map_err(|e| self.explain(&e))?;
        let finer = estimate::comparison_options(options);
        let refinement = if finer.method == options.method {
            "a tenth of the tolerance".to_owned()
        } else {
            format!("the same tolerance by {}", finer.method.name())
        };
        let second = self.solve(scene, duration, &finer).ok();
        let second = second.and_then(|motion| self.samples(&motion).ok());
        // The last samples may be missing if an event ends one of the runs earlier.
        let pairs = samples.iter().zip(second.iter().flatten());
        let pairs: Vec<SamplePair<'_>> = pairs.take_while(|(a, b)| a.t == b.t).collect();
        let Some((last, _)) = pairs.last() else {
            return Ok(format!(
                "  no error estimate: a second run, at {refinement}, fails\n"
            ));
        };
        let at = if last.t < duration {
            format!("at t = {} s", digits(last.t, 6))
        } else {
            "at the end".to_owned()
        };
        let [kinetic, potential] = [0, 1].map(|k| {
            let energies = samples.iter().map(|s| s.extra_values[k].abs());
            energies.fold(0.0, f64::max)
        });
        let errors = self.error_texts(&pairs, [kinetic, potential]);
        Ok(format!(
            "  estimated error {at}:{errors} from a second run at {refinement}\n"
        ))
    }

    /// The error of each free coordinate, and of the energy balance if anything moves.
    fn error_texts(
        &self,
        pairs: &[SamplePair<'_>],
        [max_kinetic, max_potential]: [f64; 2],
    ) -> String {
        let error_of = |of: &dyn Fn(&TrajectorySample) -> f64, rounding: f64| {
            let values = pairs.iter().map(|(a, b)| (of(a), of(b)));
            let (one, two): (Vec<f64>, Vec<f64>) = values.unzip();
            estimate::of_motion(&one, &two, rounding)
        };
        let ends = pairs.first().zip(pairs.last());
        let mut text = String::new();
        for &i in self.machine.free() {
            let [start, end] = ends.map_or([0.0; 2], |((first, _), (last, _))| {
                [first.coordinate(i), last.coordinate(i)]
            });
            let unknown = self.initial_speed_error(i) * (end - start).abs();
            let rounding = 4.0 * f64::EPSILON * end.abs() + unknown;
            let error = error_of(&|s| s.coordinate(i), rounding);
            let unit = coordinate_unit(self.output_model.plan().is_angle(i));
            let name = &self.loaded_scene.mechanism.actuators[i].name;
            text += &format!(" {error:.1e} {unit} in {name},");
        }
        if !is_rounding(max_kinetic, max_potential) {
            let rounding = 4.0 * f64::EPSILON * max_kinetic;
            let error = error_of(&|s| self.energy_balance(s), rounding) / max_kinetic;
            text += &format!(" {error:.1e} of the largest kinetic energy,");
        }
        text
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

//! The summary of a motion in space.

use super::charts::Motion;
use super::problem::SpaceMotionProblem;
use super::run::Run;
use crate::estimate;
use crate::explain::{StepLimits, StudyError, explain_max_steps, scene_error};
use crate::free_motion::compute::{Energies, MotionSolver, height_between};
use crate::number_format::{coordinate_unit, digits, digits_within, how_often};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{DynamicsError, MotionClass, motion_class};
use dwell_findings::Record;
use dwell_scene::SceneLocation;

/// An error of this part of a coordinate's change, or of the largest kinetic energy, is no result: its second digit is wrong.
const LARGE_ERROR: f64 = 0.01;

impl SpaceMotionProblem<'_> {
    /// What is said of a motion, and the numbers in it.
    pub(super) fn summary(&self, run: &Run, duration: f64) -> (String, Record) {
        let mut record = Record::default();
        let end = run.motion.end();
        let of_all = match end < duration {
            true => format!(" of {}", digits(duration, 7)),
            false => String::new(),
        };
        record.add("end", "s", end);
        record.add("duration", "s", duration);
        let mut text = format!("  {}{of_all} s by {}\n", digits(end, 7), run.method_text);
        for (i, event) in self.spec.events.iter().enumerate() {
            let happened = self.describe_event(run, (i, &event.name), &mut record);
            let any = times_of(&run.motion, i).next().is_some();
            let stopped = match any && event.terminal {
                true => "; the motion ends there",
                false => "",
            };
            text += &format!("  {}: {happened}{stopped}\n", event.name);
        }
        let contacts = self.contacts();
        let changes = |motion: &Motion| -> Vec<_> {
            let parts = motion.parts.iter();
            let of_part = parts.map(|(chart, solution)| contacts.occurrences(*chart, solution));
            of_part.flatten().collect()
        };
        let second = run.second.as_ref().map(changes);
        text += &contacts.describe(&changes(&run.motion), second.as_deref(), &mut record);
        text += &self.describe_changes(run);
        let cost = run.motion.statistics();
        for (name, count) in [
            ("steps", cost.steps),
            ("rejected_steps", cost.rejected_steps),
            ("evaluations", cost.evaluations),
            ("jacobians", cost.jacobians),
            ("factorisations", cost.factorisations),
        ] {
            record.add_count(name, count);
        }
        text += &format!(
            "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations\n",
            cost.steps, cost.rejected_steps, cost.evaluations, cost.jacobians, cost.factorisations
        );
        text += &self.describe_class(&mut record);
        text += &self.describe_energy(run, &mut record);
        text += &self.describe_errors(run, &mut record);
        (text, record)
    }

    /// How often an event happens in a motion and when first, with the error of that time.
    fn describe_event(&self, run: &Run, (i, name): (usize, &str), record: &mut Record) -> String {
        let own: Vec<f64> = times_of(&run.motion, i).collect();
        record.add_count(format!("event.{name}.count"), own.len());
        let mut text = how_often(own.len());
        let second = run.second.as_ref();
        let others: Option<Vec<f64>> = second.map(|second| times_of(second, i).collect());
        if let Some(others) = others.as_ref().filter(|others| others.len() != own.len()) {
            text += &format!(
                " ({} in a second run: within its error it is not certain)",
                how_often(others.len())
            );
        }
        let Some(&first) = own.first() else {
            return text;
        };
        let late = run.orbit.as_ref().map_or(0.0, |(_, late)| late * first);
        let other = others.as_ref().and_then(|others| others.first());
        let key = format!("event.{name}.first");
        text + &match other {
            Some(other) => {
                let error = estimate::of_number(first, *other) + late;
                record.add_within(key, "s", first, error);
                let first = digits_within(first, error, 13);
                format!(", first at t = {first} s (estimated error {error:.1e} s)")
            }
            None => {
                record.add(key, "s", first);
                format!(", first at t = {} s", digits(first, 6))
            }
        }
    }

    /// The class of a conservative motion of one coordinate, from its energy, and its period.
    fn describe_class(&self, record: &mut Record) -> String {
        let is_prescribed = self.spec.laws.iter().any(Option::is_some);
        if is_prescribed || self.machine.free().len() != 1 || !self.scene().drives.is_empty() {
            return String::new();
        }
        let (name, unit) = (
            &self.scene().mechanism.actuators[0].name,
            coordinate_unit(self.is_angle(0)),
        );
        let class = match motion_class(&self.machine, self.initial_reduced_state()) {
            Ok(MotionClass::Rotation {
                kinetic_at_maximum, ..
            }) => {
                let key = "kinetic_energy_at_potential_maximum";
                record.add(key, "J", kinetic_at_maximum);
                let kinetic = digits(kinetic_at_maximum, 6);
                format!("rotation; kinetic energy at the potential maximum {kinetic} J")
            }
            Ok(MotionClass::Libration { turning_points }) => {
                for (end, q) in ["lower", "upper"].into_iter().zip(turning_points) {
                    record.add(format!("turning_point.{end}"), unit, q);
                }
                let [a, b] = turning_points.map(|q| digits(q, 10));
                format!("libration between {name} = {a} and {b} {unit}")
            }
            Ok(MotionClass::Asymptotic { to }) => {
                record.add("asymptotic_to", unit, to);
                let to = digits(to, 10);
                return format!("  by energy: asymptotic to {name} = {to} {unit} (separatrix)\n");
            }
            _ => return String::new(),
        };
        let period = match self.orbit(1.0) {
            Ok(orbit) => match estimate::of_period(&orbit, |factor| self.orbit(factor)) {
                Ok(error) => {
                    record.add_within("period", "s", orbit.period, error);
                    let period = digits_within(orbit.period, error, 13);
                    format!("; period {period} s (estimated error {error:.1e} s) by quadrature")
                }
                Err(_) => {
                    record.add("period", "s", orbit.period);
                    format!(
                        "; period {} s (its error is not known) by quadrature",
                        digits(orbit.period, 3)
                    )
                }
            },
            Err(_) => String::new(),
        };
        format!("  by energy: {class}{period}\n")
    }

    /// The error of the energy balance.
    fn describe_energy(&self, run: &Run, record: &mut Record) -> String {
        let at_steps = self.energies(&self.steps_as_samples(run).unwrap_or_default());
        let Ok(samples) = self.samples(&run.motion) else {
            return String::new();
        };
        let samples: Vec<_> = samples
            .into_iter()
            .map(|sample| (sample.t, sample))
            .collect();
        let at_samples = self.energies(&samples);
        let both = || at_steps.iter().chain(&at_samples);
        let largest = |of: fn(&Energies) -> f64| both().map(|e| of(e).abs()).fold(0.0, f64::max);
        let (kinetic, potential) = (largest(|e| e.kinetic), largest(|e| e.potential));
        // Steps are counted from zero, samples from the start.
        let drift = at_samples
            .iter()
            .map(|e| e.balance.abs())
            .fold(0.0, f64::max);
        let (kind, scale) = match estimate::is_rounding(kinetic, potential) {
            true => ("potential", potential),
            false => ("kinetic", kinetic),
        };
        if kinetic == 0.0 {
            return "  the mechanism stays at rest: no force moves it\n".to_owned();
        }
        let relative = drift / scale;
        record.add("energy_balance_error", "", relative);
        let value = |at: &Energies| match kind {
            "kinetic" => at.kinetic,
            _ => at.potential.abs(),
        };
        let error = drift.max(height_between(&at_samples, value));
        record.add_within(format!("largest_{kind}_energy"), "J", scale, error);
        let energy = digits_within(scale, error, 6);
        format!(
            "  energy balance closes to {relative:.1e} of the largest {kind} energy, {energy} J\n"
        )
    }

    /// The energies of states of the motion.
    fn energies(&self, states: &[(f64, TrajectorySample)]) -> Vec<Energies> {
        let balance = self.balance_index();
        let one = |(t, sample): &(f64, TrajectorySample)| Energies {
            t: *t,
            kinetic: sample.extra_values[0],
            potential: sample.extra_values[1],
            balance: sample.extra_values[balance],
        };
        states.iter().map(one).collect()
    }

    /// The estimated errors.
    fn describe_errors(&self, run: &Run, record: &mut Record) -> String {
        if let Some((_, (text, numbers))) = &run.found {
            record.extend(numbers.clone());
            return text.clone();
        }
        let Some(errors) = self.errors(run) else {
            return "  no error estimate: a second run fails\n".to_owned();
        };
        let mut text = "  estimated error over the whole motion:".to_owned();
        for (&i, error) in self.machine.free().iter().zip(&errors.coordinates) {
            let (name, unit) = (
                &self.scene().mechanism.actuators[i].name,
                coordinate_unit(self.is_angle(i)),
            );
            record.add(format!("error.{name}"), unit, *error);
            text += &format!(" {error:.1e} {unit} in {name},");
        }
        record.add("error.kinetic_energy", "", errors.energy);
        let from = match run.orbit {
            Some(_) => "from the rounding of its start",
            None => "from a second run at a tenth of the tolerance",
        };
        format!(
            "{text} {:.1e} of the largest kinetic energy, {from}\n",
            errors.energy
        )
    }

    /// Why a motion is not what was required: it ended early, or is less accurate.
    pub(super) fn shortfall(&self, run: &Run, solver: &MotionSolver) -> Option<StudyError> {
        if let Some(&DynamicsError::MaxStepsReached { t, max_steps }) = run.motion.error() {
            let limits = StepLimits::of(solver);
            return Some(explain_max_steps(self.scene(), t, max_steps, &limits));
        }
        if let Some(error) = run.motion.explained_error(self) {
            return Some(error);
        }
        let not_resolved = |what: String| {
            let message = format!("the motion is not resolved: {what}");
            let help = "use a smaller --rtol, or --accuracy; what is chaotic is known for a shorter time only";
            scene_error(
                self.scene(),
                message,
                help,
                [(SceneLocation::Duration, "over this time")],
            )
        };
        let Some(errors) = self.errors(run) else {
            return Some(not_resolved(
                "its error cannot be estimated: a second run fails".to_owned(),
            ));
        };
        if errors.energy > LARGE_ERROR {
            let error = errors.energy;
            return Some(not_resolved(format!(
                "the estimated error of the energy is {error:.1e} of the largest kinetic energy"
            )));
        }
        let samples = self.samples(&run.motion).ok()?;
        for (&i, &error) in self.machine.free().iter().zip(&errors.coordinates) {
            let [from, to] = crate::ranges::extent(samples.iter().map(|s| s.coordinate(i)));
            if error > LARGE_ERROR * (to - from) + 100.0 * run.options.atol {
                let name = &self.scene().mechanism.actuators[i].name;
                let unit = coordinate_unit(self.is_angle(i));
                return Some(not_resolved(format!(
                    "the estimated error of {name} is {error:.1e} {unit}, and it moves by {} {unit}",
                    digits(to - from, 3)
                )));
            }
        }
        let (accuracy, error) = (run.accuracy?, self.largest_error(run)?);
        let message = format!(
            "an accuracy of {accuracy:e} is not reached: the estimated error is {error:.1e}"
        );
        let help = "the results are written with the error above; require that accuracy, or a shorter motion";
        let place = (SceneLocation::Duration, "the error grows with the duration");
        (error > accuracy).then(|| scene_error(self.scene(), message, help, [place]))
    }
}

/// The times of an event, s.
fn times_of(motion: &Motion, event: usize) -> impl Iterator<Item = f64> + '_ {
    let all = motion
        .solutions()
        .flat_map(|solution| &solution.event_occurrences);
    all.filter(move |o| o.event == event).map(|o| o.state.t)
}

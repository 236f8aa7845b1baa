//! The summary of a motion in space.

use super::problem::SpaceMotionProblem;
use super::run::Run;
use crate::explain::StudyError;
use crate::free_motion::compute::{
    ChartedProblem as _, Energies, LARGE_ERROR, MotionProblem as _, MotionSolver, NamedContacts,
    balance_line, class_line, cost_line, event_line, is_at_rest, large_energy_error, large_error,
    not_accurate, not_resolved, times_of, too_many_steps,
};
use crate::number_format::digits;
use crate::ranges::extent;
use crate::trajectory::compute::TrajectorySample;
use dwell_findings::Record;

impl SpaceMotionProblem<'_> {
    /// What is said of a motion, and the numbers in it.
    pub(in crate::space) fn summary(&self, run: &Run, duration: f64) -> (String, Record) {
        let mut record = Record::default();
        let end = run.motion.end_time();
        let of_all = match end < duration {
            true => format!(" of {}", digits(duration, 7)),
            false => String::new(),
        };
        record.add("end", "s", end);
        record.add("duration", "s", duration);
        let mut text = format!("  {}{of_all} s by {}\n", digits(end, 7), run.method_text);
        let parts = &run.motion.segments;
        let second = run.second.as_ref().map(|motion| &motion.segments[..]);
        let late = run.orbit.as_ref().map_or(0.0, |(_, late)| *late);
        for (i, event) in self.spec.events.iter().enumerate() {
            let own = times_of(parts, i);
            let others = second.map(|parts| times_of(parts, i));
            let named = (&event.name[..], event.terminal);
            text += &event_line(named, (&own, others.as_deref()), late, &mut record);
        }
        text += &NamedContacts::new(self).describe(parts, second, &mut record);
        text += &self.describe_changes(run);
        text += &cost_line(&run.motion.statistics, &mut record);
        text += &class_line(self, (parts, second), |_| None, &mut record);
        text += &self.describe_energy(run, &mut record);
        text += &self.describe_errors(run, &mut record);
        (text, record)
    }

    /// The error of the energy balance.
    fn describe_energy(&self, run: &Run, record: &mut Record) -> String {
        let steps = self.steps_as_samples(&run.motion, 0).unwrap_or_default();
        let at_steps = self.energies(steps.iter().map(|(_, sample)| sample));
        let Ok(samples) = self.samples(&run.motion) else {
            return String::new();
        };
        let at_samples = self.energies(samples.iter());
        let both = || at_steps.iter().chain(&at_samples);
        let largest = |of: fn(&Energies) -> f64| both().map(|e| of(e).abs()).fold(0.0, f64::max);
        let (kinetic, potential) = (largest(|e| e.kinetic), largest(|e| e.potential));
        // Steps are counted from zero, samples from the start.
        let drift = at_samples
            .iter()
            .map(|e| e.balance.abs())
            .fold(0.0, f64::max);
        if kinetic == 0.0 {
            return "  the mechanism stays at rest: no force moves it\n".to_owned();
        }
        let (_, line) = balance_line([kinetic, potential], drift, &at_samples, record);
        line
    }

    /// The energies of states of the motion.
    fn energies<'s>(&self, states: impl Iterator<Item = &'s TrajectorySample>) -> Vec<Energies> {
        let balance = self.balance_index();
        let one = |sample: &TrajectorySample| Energies {
            t: sample.t,
            kinetic: sample.extra_values[0],
            potential: sample.extra_values[1],
            balance: sample.extra_values[balance],
        };
        states.map(one).collect()
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
            let (name, unit) = self.named_coordinate(i);
            record.add(format!("error.{name}"), unit, *error);
            text += &format!(" {error:.1e} {unit} in {name},");
        }
        record.add("error.kinetic_energy", "", errors.kinetic);
        let from = match run.orbit {
            Some(_) => "from the rounding of its start",
            None => "from a second run at a tenth of the tolerance",
        };
        format!(
            "{text} {:.1e} of the largest kinetic energy, {from}\n",
            errors.kinetic
        )
    }

    /// Why a motion is not what was required: it ended early, or is less accurate.
    pub(super) fn shortfall(&self, run: &Run, solver: &MotionSolver) -> Option<StudyError> {
        let error = too_many_steps(self.scene(), run.motion.failure.as_ref(), solver);
        error
            .or_else(|| self.explained_end(&run.motion))
            .or_else(|| self.inaccuracy(run))
            .or_else(|| not_accurate(self.scene(), [run.accuracy?, self.largest_error(run)?]))
    }

    /// Why a motion is no result although nothing ended it.
    fn inaccuracy(&self, run: &Run) -> Option<StudyError> {
        let Some(errors) = self.errors(run) else {
            let why = "its error cannot be estimated: a second run fails";
            return Some(not_resolved(self.scene(), why));
        };
        let (samples, atol) = (self.samples(&run.motion).ok()?, run.options.atol);
        let change = |i: usize| {
            let [from, to] = extent(samples.iter().map(|s| s.coordinate(i)));
            to - from
        };
        // Of what is at rest, the energy is that of its rounding.
        let moves = |&i: &usize| !is_at_rest(change(i), atol);
        if errors.energy > LARGE_ERROR && self.machine.free().iter().any(moves) {
            let why = large_energy_error(errors.energy);
            return Some(not_resolved(self.scene(), &why));
        }
        let mut each = self.machine.free().iter().zip(&errors.coordinates);
        let why = each
            .find_map(|(&i, &error)| large_error(self.named_coordinate(i), error, change(i), atol));
        why.map(|why| not_resolved(self.scene(), &why))
    }
}

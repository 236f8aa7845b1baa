//! What is said of a motion.

use super::{Accuracy, Free, Moved};
use crate::words::digits;
use dwell_dynamics::{Fate, MachineWork, Method, Options, Orbit, Point, fate, follow};
use std::fmt::Write as _;

/// Largest part of the energies exchanged that may be lost without a remark.
const ENERGY_KEPT: f64 = 1e-6;
/// A method is said to be far cheaper if it would take so many times fewer evaluations.
const FAR_CHEAPER: f64 = 4.0;

impl Free<'_> {
    /// What becomes of a conservative motion of one freedom, by its energy alone.
    fn fate(&self) -> String {
        let led = self.motion.laws.iter().any(Option::is_some);
        if led || self.machine.free().len() != 1 || !self.scene.drives.is_empty() {
            return String::new();
        }
        let name = &self.scene.mechanism.actuators[0].name;
        let angle = self.shown.plan().is_angle(0);
        let unit = if angle { "rad" } else { "m" };
        let period = || match Orbit::loaded(&self.machine, self.state()) {
            Ok(orbit) => format!("; period {} s by quadrature", digits(orbit.period, 13)),
            Err(_) => String::new(),
        };
        match fate(&self.machine, self.state()) {
            Ok(Fate::Turns { spare, .. }) => format!(
                "  by its energy it passes its highest potential, with {} J to spare{}\n",
                digits(spare, 6),
                period()
            ),
            Ok(Fate::Swings { between: [a, b] }) => format!(
                "  by its energy it swings between {name} = {} and {} {unit}{}\n",
                digits(a, 10),
                digits(b, 10),
                period()
            ),
            Ok(Fate::Creeps { to }) => format!(
                "  by its energy it creeps towards {name} = {} {unit} and does not arrive\n",
                digits(to, 10)
            ),
            _ => String::new(),
        }
    }

    pub(super) fn summary(&self, moved: &Moved, how: &str, duration: f64) -> String {
        let end = moved.end();
        // Writing to a string cannot fail.
        let mut text = String::new();
        let reached = if end < duration {
            format!("{} of {} s", digits(end, 7), digits(duration, 7))
        } else {
            format!("{} s", digits(end, 7))
        };
        let _ = writeln!(text, "  {reached} by {how}");
        for (i, event) in self.motion.events.iter().enumerate() {
            let times: Vec<_> = moved.occurrences().filter(|(_, o)| o.event == i).collect();
            let first = times
                .first()
                .map(|(_, o)| format!(", first at t = {} s", digits(o.at.t, 13)));
            let stopped = if event.stop && !times.is_empty() {
                ", where it ends"
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "  {}: {} times{}{stopped}",
                event.name,
                times.len(),
                first.unwrap_or_default()
            );
        }
        for change in &moved.changes {
            let _ = writeln!(text, "  {change}");
        }
        let work = moved.statistics;
        let _ = writeln!(
            text,
            "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations",
            work.steps, work.rejected, work.evaluations, work.jacobians, work.factorisations,
        );
        text + &self.fate() + &self.energy(moved)
    }

    /// How well the energies add up.
    fn energy(&self, moved: &Moved) -> String {
        let (mut began, mut largest, mut apart) = (None, 0.0_f64, 0.0_f64);
        let mut works: Vec<Option<MachineWork>> = Vec::new();
        for (chart, point) in moved.steps() {
            let machine = self.machine(moved, chart);
            works.resize_with(works.len().max(chart + 1), || None);
            let work = works[chart].get_or_insert_with(|| machine.work());
            if machine.evaluate(point.t, &point.y, work).is_err() {
                break;
            }
            let [kinetic, potential] = machine.energy(work);
            let sum = kinetic + potential - point.y[machine.first_work()..].iter().sum::<f64>();
            let began = *began.get_or_insert(sum);
            largest = largest.max(kinetic);
            apart = apart.max((sum - began).abs());
        }
        if largest == 0.0 {
            return "  it stays at rest: nothing moves it\n".to_owned();
        }
        let lost = apart / largest;
        let kinetic = digits(largest, 6);
        let mut text = format!(
            "  energy balance kept to {lost:.1e} of the largest kinetic energy, {kinetic} J\n"
        );
        if lost > ENERGY_KEPT {
            text += "  that is much: take a smaller --rtol\n";
        }
        text
    }

    /// Whether another method would be far cheaper, by how long this one's steps are against what its
    /// accuracy and its stability ask for.
    pub(super) fn hint(&self, moved: &Moved, accuracy: &Accuracy) -> String {
        let end = moved.end();
        let other = if accuracy.method.implicit() {
            Method::Dop853
        } else {
            Method::Bdf
        };
        if moved.statistics.steps < 100 || end <= 0.0 || moved.legs.len() > 1 {
            return String::new();
        }
        // The costliest tenth of the motion, by the other method: what is stiff is so only at times.
        let steps: Vec<&Point> = moved.steps().map(|(_, point)| point).collect();
        let until = |k: usize| 0.1 * k as f64 * end;
        let first = |k: usize| steps.partition_point(|p| p.t < until(k));
        let costliest = (0..10)
            .max_by_key(|&k| first(k + 1) - first(k))
            .unwrap_or(0);
        let (from, to) = (first(costliest), first(costliest + 1));
        let Some(&start) = steps.get(from).filter(|p| p.t < until(costliest + 1)) else {
            return String::new();
        };
        let options = Options {
            absolute: accuracy.absolute,
            budget: moved.statistics.steps.max(100),
            ..Options::new(other, accuracy.relative)
        };
        let (end, events) = (until(costliest + 1), &[]);
        let tried = follow(&self.machine, &self.shown, start, end, &options, events);
        let cost = |method: Method, work: dwell_dynamics::Statistics| {
            // A Jacobian takes two evaluations in dual numbers for each free coordinate.
            let columns = 4 * self.machine.free().len() * usize::from(method.implicit());
            (work.evaluations + columns * work.jacobians) as f64
        };
        let Ok(tried) = tried else {
            return String::new();
        };
        let share = (to - from) as f64 / steps.len() as f64;
        let here = cost(accuracy.method, moved.statistics) * share;
        let there = cost(other, tried.statistics);
        if tried.failed.is_some() || here < FAR_CHEAPER * there {
            return String::new();
        }
        format!(
            "  hint: --method {} takes about {:.0} times fewer evaluations from t = {} to {} s\n",
            other.name().to_lowercase(),
            here / there,
            digits(start.t, 3),
            digits(end, 3),
        )
    }
}

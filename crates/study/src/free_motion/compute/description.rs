//! The summary of a motion.

use crate::estimate::is_rounding;
use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::models::SolverSettings;
use crate::number_format::{coordinate_unit, digits};
use dwell_dynamics::{
    MachineWorkspace, Method, MotionClass, OdeState, Options, Orbit, Statistics, motion_class,
    solve,
};

/// Largest relative error of the energy balance that is not commented on.
const MAX_ENERGY_LOSS: f64 = 1e-6;
/// Another method is suggested if it takes this many times fewer evaluations.
const HINT_COST_RATIO: f64 = 4.0;

impl FreeMotionProblem<'_> {
    /// The motion class of a conservative motion of one degree of freedom, from its energy.
    fn describe_motion_class(&self) -> String {
        let is_prescribed = self.spec.laws.iter().any(Option::is_some);
        if is_prescribed || self.machine.free().len() != 1 || !self.loaded_scene.drives.is_empty() {
            return String::new();
        }
        let name = &self.loaded_scene.mechanism.actuators[0].name;
        let unit = coordinate_unit(self.output_model.plan().is_angle(0));
        let start = self.initial_reduced_state();
        let period = || match Orbit::loaded(&self.machine, start) {
            Ok(orbit) => format!("; period {} s by quadrature", digits(orbit.period, 13)),
            Err(_) => String::new(),
        };
        let class = match motion_class(&self.machine, start) {
            Ok(MotionClass::Rotation {
                kinetic_at_maximum, ..
            }) => {
                let kinetic = digits(kinetic_at_maximum, 6);
                let period = period();
                format!("rotation; kinetic energy at the potential maximum {kinetic} J{period}")
            }
            Ok(MotionClass::Libration { turning_points }) => {
                let [a, b] = turning_points.map(|q| digits(q, 10));
                format!("libration between {name} = {a} and {b} {unit}{}", period())
            }
            Ok(MotionClass::Asymptotic { to }) => {
                let to = digits(to, 10);
                format!("asymptotic to {name} = {to} {unit} (separatrix)")
            }
            _ => return String::new(),
        };
        format!("  by energy: {class}\n")
    }

    pub(crate) fn summary(
        &self,
        motion: &SegmentedMotion,
        method_text: &str,
        duration: f64,
    ) -> String {
        let end = motion.end_time();
        let of_all = match end < duration {
            true => format!(" of {}", digits(duration, 7)),
            false => String::new(),
        };
        let mut text = format!("  {}{of_all} s by {method_text}\n", digits(end, 7));
        for (i, event) in self.spec.events.iter().enumerate() {
            let times = motion.occurrences().filter(|(_, o)| o.event == i);
            let times: Vec<_> = times.collect();
            let first = times.first();
            let first = first.map(|(_, o)| format!(", first at t = {} s", digits(o.state.t, 13)));
            let stopped = match first {
                Some(_) if event.terminal => "; the motion ends there",
                _ => "",
            };
            let (name, count) = (&event.name, times.len());
            let first = first.unwrap_or_default();
            text += &format!("  {name}: {count} times{first}{stopped}\n");
        }
        for change in &motion.chart_changes {
            text += &format!("  {change}\n");
        }
        let cost = motion.statistics;
        text += &format!("  {} steps, {} rejected, ", cost.steps, cost.rejected_steps);
        text += &format!(
            "{} evaluations, {} Jacobians, ",
            cost.evaluations, cost.jacobians
        );
        text += &format!("{} factorisations\n", cost.factorisations);
        text + &self.describe_motion_class() + &self.describe_energy_balance(motion)
    }

    /// The error of the energy balance.
    fn describe_energy_balance(&self, motion: &SegmentedMotion) -> String {
        let (mut initial, mut max_difference) = (None, 0.0_f64);
        let (mut max_kinetic, mut max_potential) = (0.0_f64, 0.0_f64);
        let mut workspaces: Vec<Option<MachineWorkspace>> = Vec::new();
        for (chart, point) in motion.steps() {
            let machine = self.machine(motion, chart);
            workspaces.resize_with(workspaces.len().max(chart + 1), || None);
            let workspace = workspaces[chart].get_or_insert_with(|| machine.workspace());
            let Ok(state) = machine.evaluate(point.t, &point.y, workspace) else {
                break;
            };
            let [kinetic, potential] = state.energy();
            let sum = kinetic + potential - point.y[machine.work_offset()..].iter().sum::<f64>();
            let initial = *initial.get_or_insert(sum);
            max_kinetic = max_kinetic.max(kinetic);
            max_potential = max_potential.max(potential.abs());
            max_difference = max_difference.max((sum - initial).abs());
        }
        if max_kinetic == 0.0 {
            return "  the mechanism stays at rest: no force moves it\n".to_owned();
        }
        let (kind, largest) = match is_rounding(max_kinetic, max_potential) {
            true => ("potential", max_potential),
            false => ("kinetic", max_kinetic),
        };
        let (relative_loss, energy) = (max_difference / largest, digits(largest, 6));
        let mut text = format!(
            "  energy balance closes to {relative_loss:.1e} of the largest {kind} energy, {energy} J\n"
        );
        // By quadrature it is part of the estimated error.
        if relative_loss > MAX_ENERGY_LOSS && motion.orbit.is_none() {
            text += "  this is large: use a smaller --rtol\n";
        }
        text
    }

    /// Suggests another method if it is much cheaper on the costliest tenth of the motion.
    pub(crate) fn method_hint(
        &self,
        motion: &SegmentedMotion,
        settings: &SolverSettings,
    ) -> String {
        let end = motion.end_time();
        if motion.statistics.steps < 100 || end <= 0.0 || motion.segments.len() > 1 {
            return String::new();
        }
        let other = match settings.method.is_implicit() {
            true => Method::Dop853,
            false => Method::Bdf,
        };
        // A motion may be stiff in parts only, so the costliest tenth is repeated by the other method.
        let steps: Vec<&OdeState> = motion.steps().map(|(_, point)| point).collect();
        let until = |k: usize| 0.1 * k as f64 * end;
        let first = |k: usize| steps.partition_point(|p| p.t < until(k));
        let costliest = (0..10).max_by_key(|&k| first(k + 1) - first(k));
        let costliest = costliest.unwrap_or(0);
        let (from, to) = (first(costliest), first(costliest + 1));
        let Some(&start) = steps.get(from).filter(|p| p.t < until(costliest + 1)) else {
            return String::new();
        };
        let options = Options {
            atol: settings.atol,
            max_steps: motion.statistics.steps.max(100),
            ..Options::new(other, settings.rtol)
        };
        let end = until(costliest + 1);
        let repeated = solve(&self.machine, &self.output_model, start, end, &options, &[]);
        let Some(repeated) = repeated.ok().filter(|s| s.error.is_none()) else {
            return String::new();
        };
        let cost = |method: Method, statistics: Statistics| {
            // A Jacobian takes two evaluations in dual numbers for each free coordinate.
            let columns = 4 * self.machine.free().len() * usize::from(method.is_implicit());
            (statistics.evaluations + columns * statistics.jacobians) as f64
        };
        let share = (to - from) as f64 / steps.len() as f64;
        let cost_here = cost(settings.method, motion.statistics) * share;
        let other_cost = cost(other, repeated.statistics);
        if cost_here < HINT_COST_RATIO * other_cost {
            return String::new();
        }
        let (name, ratio) = (other.name().to_lowercase(), cost_here / other_cost);
        let [from, to] = [start.t, end].map(|t| digits(t, 3));
        format!(
            "  hint: --method {name} takes about {ratio:.0} times fewer evaluations from t = {from} to {to} s\n"
        )
    }
}

//! The summary of a motion.

use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::models::SolverSettings;
use crate::number_format::digits;
use dwell_dynamics::{
    MachineWorkspace, Method, MotionClass, OdeState, Options, Orbit, motion_class, solve,
};
use std::fmt::Write as _;

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
        let angle = self.output_model.plan().is_angle(0);
        let unit = if angle { "rad" } else { "m" };
        let period = || match Orbit::loaded(&self.machine, self.initial_reduced_state()) {
            Ok(orbit) => format!("; period {} s by quadrature", digits(orbit.period, 13)),
            Err(_) => String::new(),
        };
        match motion_class(&self.machine, self.initial_reduced_state()) {
            Ok(MotionClass::Rotation {
                kinetic_at_maximum, ..
            }) => format!(
                "  by energy: rotation; kinetic energy at the potential maximum {} J{}\n",
                digits(kinetic_at_maximum, 6),
                period()
            ),
            Ok(MotionClass::Libration {
                turning_points: [a, b],
            }) => format!(
                "  by energy: libration between {name} = {} and {} {unit}{}\n",
                digits(a, 10),
                digits(b, 10),
                period()
            ),
            Ok(MotionClass::Asymptotic { to }) => format!(
                "  by energy: asymptotic to {name} = {} {unit} (separatrix)\n",
                digits(to, 10)
            ),
            _ => String::new(),
        }
    }

    pub(crate) fn summary(
        &self,
        motion: &SegmentedMotion,
        method_text: &str,
        duration: f64,
    ) -> String {
        let end = motion.end_time();
        // Writing to a string cannot fail.
        let mut text = String::new();
        let reached = if end < duration {
            format!("{} of {} s", digits(end, 7), digits(duration, 7))
        } else {
            format!("{} s", digits(end, 7))
        };
        let _ = writeln!(text, "  {reached} by {method_text}");
        for (i, event) in self.spec.events.iter().enumerate() {
            let times: Vec<_> = motion.occurrences().filter(|(_, o)| o.event == i).collect();
            let first = times
                .first()
                .map(|(_, o)| format!(", first at t = {} s", digits(o.state.t, 13)));
            let stopped = if event.terminal && !times.is_empty() {
                "; the motion ends there"
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
        for change in &motion.chart_changes {
            let _ = writeln!(text, "  {change}");
        }
        let statistics = motion.statistics;
        let _ = writeln!(
            text,
            "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations",
            statistics.steps,
            statistics.rejected_steps,
            statistics.evaluations,
            statistics.jacobians,
            statistics.factorisations,
        );
        text + &self.describe_motion_class() + &self.describe_energy_balance(motion)
    }

    /// The error of the energy balance.
    fn describe_energy_balance(&self, motion: &SegmentedMotion) -> String {
        let (mut initial, mut max_kinetic, mut max_difference) = (None, 0.0_f64, 0.0_f64);
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
            max_difference = max_difference.max((sum - initial).abs());
        }
        if max_kinetic == 0.0 {
            return "  the mechanism stays at rest: no force moves it\n".to_owned();
        }
        let relative_loss = max_difference / max_kinetic;
        let kinetic = digits(max_kinetic, 6);
        let mut text = format!(
            "  energy balance closes to {relative_loss:.1e} of the largest kinetic energy, {kinetic} J\n"
        );
        if relative_loss > MAX_ENERGY_LOSS {
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
        let other = if settings.method.is_implicit() {
            Method::Dop853
        } else {
            Method::Bdf
        };
        if motion.statistics.steps < 100 || end <= 0.0 || motion.segments.len() > 1 {
            return String::new();
        }
        // A motion may be stiff in parts only, so the costliest tenth is repeated by the other method.
        let steps: Vec<&OdeState> = motion.steps().map(|(_, point)| point).collect();
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
            atol: settings.atol,
            max_steps: motion.statistics.steps.max(100),
            ..Options::new(other, settings.rtol)
        };
        let (end, events) = (until(costliest + 1), &[]);
        let other_solution = solve(
            &self.machine,
            &self.output_model,
            start,
            end,
            &options,
            events,
        );
        let cost = |method: Method, statistics: dwell_dynamics::Statistics| {
            // A Jacobian takes two evaluations in dual numbers for each free coordinate.
            let columns = 4 * self.machine.free().len() * usize::from(method.is_implicit());
            (statistics.evaluations + columns * statistics.jacobians) as f64
        };
        let Ok(other_solution) = other_solution else {
            return String::new();
        };
        let share = (to - from) as f64 / steps.len() as f64;
        let cost_here = cost(settings.method, motion.statistics) * share;
        let other_cost = cost(other, other_solution.statistics);
        if other_solution.error.is_some() || cost_here < HINT_COST_RATIO * other_cost {
            return String::new();
        }
        format!(
            "  hint: --method {} takes about {:.0} times fewer evaluations from t = {} to {} s\n",
            other.name().to_lowercase(),
            cost_here / other_cost,
            digits(start.t, 3),
            digits(end, 3),
        )
    }
}

//! The summary of a motion.

use crate::estimate::{self, is_rounding};
use crate::free_motion::compute::{ComputedMotion, FreeMotionProblem, SegmentedMotion};
use crate::models::SolverSettings;
use crate::number_format::{coordinate_unit, digits, digits_within, how_often};
use dwell_dynamics::{
    DynamicsError, EventOccurrence, MachineWorkspace, Method, MotionClass, OdeState, Options,
    Orbit, ReducedState, Statistics, eigenvalues_about, is_equilibrium, linearise, motion_class,
    solve,
};
use dwell_findings::Record;

/// Largest relative error of the energy balance that is not commented on.
const MAX_ENERGY_LOSS: f64 = 1e-6;
/// A kinetic energy below this part of what the loads can do is that of rounding: it takes 1e-13 of the size of the
/// mechanism to gain it.
const REST: f64 = 1e-26;
/// Another method is suggested if it takes this many times fewer evaluations.
const HINT_COST_RATIO: f64 = 4.0;

/// The energies of a motion at a time (s), and what the balance of energies and works keeps constant, J.
pub(crate) struct Energies {
    pub(crate) t: f64,
    pub(crate) kinetic: f64,
    pub(crate) potential: f64,
    pub(crate) balance: f64,
}

/// By how much a quantity may be higher between points than at the highest of them: the height of the parabola through it and
/// its neighbours.
pub(crate) fn height_between(points: &[Energies], value: impl Fn(&Energies) -> f64) -> f64 {
    let highest =
        (0..points.len()).max_by(|&a, &b| value(&points[a]).total_cmp(&value(&points[b])));
    let around = highest.and_then(|k| points.get(k.checked_sub(1)?..k + 2));
    let Some([before, at, after]) = around else {
        return 0.0;
    };
    let slope = |a: &Energies, b: &Energies| (value(b) - value(a)) / (b.t - a.t);
    let (rising, falling) = (slope(before, at), slope(at, after));
    let bend = (rising - falling) / (0.5 * (after.t - before.t));
    let share = (at.t - before.t) / (after.t - before.t);
    let there = rising * (1.0 - share) + falling * share;
    match bend > 0.0 && bend.is_finite() {
        true => 0.5 * there * there / bend,
        false => 0.0,
    }
}

impl FreeMotionProblem<'_> {
    /// The motion class of a conservative motion of one degree of freedom, from its energy.
    fn describe_motion_class(&self, record: &mut Record) -> String {
        let is_prescribed = self.spec.laws.iter().any(Option::is_some);
        if is_prescribed || self.machine.free().len() != 1 || !self.loaded_scene.drives.is_empty() {
            return String::new();
        }
        let name = &self.loaded_scene.mechanism.actuators[0].name;
        let unit = coordinate_unit(self.output_model.plan().is_angle(0));
        let start = self.initial_reduced_state();
        let period = |record: &mut Record| match Orbit::loaded(&self.machine, start) {
            Ok(orbit) => {
                let period = self.period_text(&orbit, start, record);
                format!("; period {period} by quadrature")
            }
            Err(_) => String::new(),
        };
        let class = match motion_class(&self.machine, start) {
            Ok(MotionClass::Rotation {
                kinetic_at_maximum, ..
            }) => {
                let kinetic = digits(kinetic_at_maximum, 6);
                record.add(
                    "kinetic_energy_at_potential_maximum",
                    "J",
                    kinetic_at_maximum,
                );
                let period = period(record);
                format!("rotation; kinetic energy at the potential maximum {kinetic} J{period}")
            }
            Ok(MotionClass::Libration { turning_points }) => {
                let errors = self.turning_point_errors(start, turning_points);
                let [a, b] = [0, 1].map(|k| digits_within(turning_points[k], errors[k], 10));
                for (k, end) in ["lower", "upper"].into_iter().enumerate() {
                    let end = format!("turning_point.{end}");
                    record.add_within(end, unit, turning_points[k], errors[k]);
                }
                format!(
                    "libration between {name} = {a} and {b} {unit}{}",
                    period(record)
                )
            }
            Ok(MotionClass::Asymptotic { to }) => {
                record.add("asymptotic_to", unit, to);
                let to = digits(to, 10);
                format!("asymptotic to {name} = {to} {unit} (separatrix)")
            }
            _ => return String::new(),
        };
        format!("  by energy: {class}\n")
    }

    /// A period (s) with its error.
    fn period_text(&self, orbit: &Orbit, start: ReducedState, record: &mut Record) -> String {
        let perturbed = |factor: f64| {
            let q_dot = start.q_dot * factor;
            Orbit::loaded(&self.machine, ReducedState { q_dot, ..start })
        };
        match estimate::of_period(orbit, perturbed) {
            Ok(error) => {
                record.add_within("period", "s", orbit.period, error);
                let period = digits_within(orbit.period, error, 13);
                format!("{period} s (estimated error {error:.1e} s)")
            }
            Err(_) => {
                record.add("period", "s", orbit.period);
                format!("{} s (its error is not known)", digits(orbit.period, 3))
            }
        }
    }

    /// The errors of turning points (rad or m), from their change under the rounding of the start.
    fn turning_point_errors(&self, start: ReducedState, turning_points: [f64; 2]) -> [f64; 2] {
        let mut errors = turning_points.map(|q| 4.0 * f64::EPSILON * q.abs().max(start.q.abs()));
        for side in [-1.0, 1.0] {
            let rounding = 2.0 * side * f64::EPSILON;
            let near = ReducedState {
                q: start.q + rounding * start.q.abs().max(1.0),
                q_dot: start.q_dot * (1.0 + rounding),
                ..start
            };
            match motion_class(&self.machine, near) {
                Ok(MotionClass::Libration {
                    turning_points: others,
                }) => {
                    for (error, (a, b)) in errors.iter_mut().zip(turning_points.iter().zip(others))
                    {
                        *error = error.max((a - b).abs());
                    }
                }
                // Within rounding it is another motion.
                _ => errors = turning_points.map(f64::abs),
            }
        }
        errors
    }

    pub(super) fn summary(
        &self,
        computed: &ComputedMotion,
        duration: f64,
        record: &mut Record,
    ) -> String {
        let (motion, method_text) = (&computed.motion, &computed.method_text);
        let end = motion.end_time();
        let of_all = match end < duration {
            true => format!(" of {}", digits(duration, 7)),
            false => String::new(),
        };
        let end_error = match &computed.comparison {
            Some(second) if end < duration => estimate::of_number(end, second.end_time()),
            _ => 0.0,
        };
        record.add_within("end", "s", end, end_error);
        record.add("duration", "s", duration);
        // All digits, as in the headline and the table; what they are worth stands beside them.
        let error = match end_error > 1e-7 * end {
            true => format!(" (estimated error {} s)", digits(end_error, 2)),
            false => String::new(),
        };
        let end = digits(end, 7);
        let mut text = format!("  {end}{of_all} s{error} by {method_text}\n");
        for (i, event) in self.spec.events.iter().enumerate() {
            let happened = event_text(computed, (i, &event.name), record);
            let stopped = match motion.occurrences().any(|(_, o)| o.event == i) {
                true if event.terminal => "; the motion ends there",
                _ => "",
            };
            text += &format!("  {}: {happened}{stopped}\n", event.name);
        }
        text += &self.describe_contacts(computed, record);
        for change in &motion.chart_changes {
            text += &format!("  {change}\n");
        }
        let cost = motion.statistics;
        for (name, count) in [
            ("steps", cost.steps),
            ("rejected_steps", cost.rejected_steps),
            ("evaluations", cost.evaluations),
            ("jacobians", cost.jacobians),
            ("factorisations", cost.factorisations),
        ] {
            record.add_count(name, count);
        }
        text += &format!("  {} steps, {} rejected, ", cost.steps, cost.rejected_steps);
        text += &format!(
            "{} evaluations, {} Jacobians, ",
            cost.evaluations, cost.jacobians
        );
        text += &format!("{} factorisations\n", cost.factorisations);
        text + &self.describe_motion_class(record)
            + &self.describe_energy_balance(motion, duration, record)
    }

    /// What the loads and the initial speed can do over a duration (s), J: the energies beside which others are rounding.
    fn energy_scale(&self, duration: f64, max_potential: f64) -> f64 {
        self.machine.largest_work(0.0, duration).max(max_potential)
    }

    /// Whether a motion starts at rest in an unstable equilibrium, within rounding, and leaves it.
    pub(crate) fn leaves_unstable_equilibrium(&self, motion: &SegmentedMotion) -> bool {
        self.starts_unstable() && self.moves(motion)
    }

    /// Whether it starts at rest in an unstable equilibrium, within rounding.
    fn starts_unstable(&self) -> bool {
        let start = self.initial_state();
        if self.machine.depends_on_time() || self.machine.free().is_empty() {
            return false;
        }
        let unstable = || {
            let linear = linearise(&self.machine, start.t, &start.y)?;
            if !is_equilibrium(&self.machine, start.t, &start.y, &linear)? {
                return Ok(false);
            }
            let found = eigenvalues_about(&self.machine, start.t, &start.y, &[], &linear);
            let (values, errors) = found?;
            Ok::<_, DynamicsError>(
                values
                    .iter()
                    .zip(&errors)
                    .any(|([re, _], error)| re > error),
            )
        };
        unstable().unwrap_or(false)
    }

    /// Whether a motion has more kinetic energy than rounding.
    fn moves(&self, motion: &SegmentedMotion) -> bool {
        let scale = self.energy_scale(motion.end_time(), 0.0);
        let at_steps = self.energies(motion, motion.steps());
        let moves = |at: &Energies| at.kinetic > REST * scale.max(at.potential.abs());
        at_steps.iter().any(moves)
    }

    /// The energies at some points of a motion, as far as they can be evaluated.
    fn energies<'m>(
        &self,
        motion: &SegmentedMotion,
        points: impl Iterator<Item = (usize, &'m OdeState)>,
    ) -> Vec<Energies> {
        let mut workspaces: Vec<Option<MachineWorkspace>> = Vec::new();
        let at = |(chart, point): (usize, &OdeState)| {
            let machine = self.machine(motion, chart);
            workspaces.resize_with(workspaces.len().max(chart + 1), || None);
            let workspace = workspaces[chart].get_or_insert_with(|| machine.workspace());
            let [kinetic, potential] = machine.energy(point.t, &point.y, workspace).ok()?;
            let works = &point.y[machine.work_offset()..];
            Some(Energies {
                t: point.t,
                kinetic,
                potential,
                balance: kinetic + potential - works.iter().sum::<f64>(),
            })
        };
        points.map_while(at).collect()
    }

    /// The error of the energy balance.
    fn describe_energy_balance(
        &self,
        motion: &SegmentedMotion,
        duration: f64,
        record: &mut Record,
    ) -> String {
        let at_steps = self.energies(motion, motion.steps());
        let at_samples = self.energies(motion, motion.samples());
        let initial = at_steps.first().map_or(0.0, |at| at.balance);
        let differences = at_steps.iter().map(|at| (at.balance - initial).abs());
        let max_difference = differences.fold(0.0, f64::max);
        let both = || at_steps.iter().chain(&at_samples);
        let max_kinetic = both().map(|at| at.kinetic).fold(0.0, f64::max);
        let max_potential = both().map(|at| at.potential.abs()).fold(0.0, f64::max);
        if max_kinetic <= REST * self.energy_scale(duration, max_potential) {
            let rounding = if max_kinetic == 0.0 {
                ""
            } else {
                " within rounding"
            };
            let mut text = format!("  the mechanism stays at rest{rounding}: no force moves it\n");
            if self.starts_unstable() {
                text += "  it starts in an unstable equilibrium, which the least disturbance would end\n";
            }
            return text;
        }
        let (kind, largest) = match is_rounding(max_kinetic, max_potential) {
            true => ("potential", max_potential),
            false => ("kinetic", max_kinetic),
        };
        let relative_loss = max_difference / largest;
        record.add("energy_balance_error", "", relative_loss);
        let value = |at: &Energies| match kind {
            "kinetic" => at.kinetic,
            _ => at.potential.abs(),
        };
        let error = max_difference.max(height_between(&at_samples, value));
        record.add_within(format!("largest_{kind}_energy"), "J", largest, error);
        let energy = digits_within(largest, error, 6);
        let mut text = format!(
            "  energy balance closes to {relative_loss:.1e} of the largest {kind} energy, {energy} J\n"
        );
        // By quadrature it is part of the estimated error.
        if relative_loss > MAX_ENERGY_LOSS && motion.orbit.is_none() {
            text += "  this is large: a finer tolerance is needed\n";
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
            max_step: settings.max_step,
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

/// How often an event happens in a motion and when first, with the error of that time.
fn event_text(
    computed: &ComputedMotion,
    (event, name): (usize, &str),
    record: &mut Record,
) -> String {
    let times = |motion: &SegmentedMotion| -> Vec<f64> {
        let all = motion.occurrences().map(|(_, o): (_, &EventOccurrence)| o);
        let of_event = all.filter(|o| o.event == event);
        of_event.map(|o| o.state.t).collect()
    };
    let own = times(&computed.motion);
    let others = computed.comparison.as_ref().map(times);
    record.add_count(format!("event.{name}.count"), own.len());
    let mut text = how_often(own.len());
    if let Some(others) = others.as_ref().filter(|others| others.len() != own.len()) {
        text += &format!(
            " ({} in a second run: within its error it is not certain)",
            how_often(others.len())
        );
        record.add_count(format!("event.{name}.count_in_second_run"), others.len());
    }
    let Some(&first) = own.first() else {
        return text;
    };
    let delay = computed.delay.unwrap_or_default();
    let other = others.as_ref().and_then(|others| others.first());
    let error = other.map(|other| estimate::of_number(first, *other) + delay * first);
    let first_name = format!("event.{name}.first");
    text + &match error {
        Some(error) => {
            record.add_within(first_name, "s", first, error);
            let first = digits_within(first, error, 13);
            format!(", first at t = {first} s (estimated error {error:.1e} s)")
        }
        None => {
            record.add(first_name, "s", first);
            format!(", first at t = {} s", digits(first, 6))
        }
    }
}

//! The summary of a motion.

use crate::estimate::{self, beyond_rounding, error_scale, relative};
use crate::free_motion::compute::summary_lines::{
    Energies, balance_line, class_line, cost_line, event_line, times_of,
};
use crate::free_motion::compute::{
    ChartedProblem, ComputedMotion, ModelOf, MotionOf, NamedContacts,
};
use crate::models::SolverSettings;
use crate::number_format::digits;
use dwell_dynamics::{
    DynamicsError, MachineWorkspace, Method, MotionClass, OdeState, Options, ReducedState,
    Statistics, eigenvalues_about, is_equilibrium, linearise, motion_class, solve,
};
use dwell_findings::Record;

/// Largest relative error of the energy balance that is not commented on.
const MAX_ENERGY_LOSS: f64 = 1e-6;
/// A kinetic energy below this part of what the loads can do is that of rounding: it takes 1e-13 of the size of the
/// mechanism to gain it.
const REST: f64 = 1e-26;
/// Another method is suggested if it takes this many times fewer evaluations.
const HINT_COST_RATIO: f64 = 4.0;

/// The errors of turning points (rad or m), from their change under the rounding of the start.
fn turning_point_errors<P: ChartedProblem>(problem: &P, turning_points: [f64; 2]) -> [f64; 2] {
    let start = problem.initial_reduced_state();
    let mut errors = turning_points.map(|q| 4.0 * f64::EPSILON * q.abs().max(start.q.abs()));
    for side in [-1.0, 1.0] {
        let rounding = 2.0 * side * f64::EPSILON;
        let near = ReducedState {
            q: start.q + rounding * start.q.abs().max(1.0),
            q_dot: start.q_dot * (1.0 + rounding),
            ..start
        };
        match motion_class(problem.machine(), near) {
            Ok(MotionClass::Libration {
                turning_points: others,
            }) => {
                for (error, (a, b)) in errors.iter_mut().zip(turning_points.iter().zip(others)) {
                    *error = error.max((a - b).abs());
                }
            }
            // Within rounding it is another motion.
            _ => errors = turning_points.map(f64::abs),
        }
    }
    errors
}

pub(crate) fn summary<P: ChartedProblem>(
    problem: &P,
    computed: &ComputedMotion<P::Chart>,
    duration: f64,
) -> (String, Record) {
    let mut record = Record::default();
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
    let second = computed.comparison.as_ref();
    let second = second.map(|motion| &motion.segments[..]);
    for (i, event) in problem.spec().events.iter().enumerate() {
        let name = &event.name;
        let own = times_of(&motion.segments, i);
        let others = second.map(|parts| times_of(parts, i));
        let times = (&own[..], others.as_deref());
        let late = computed.delay.unwrap_or_default();
        text += &event_line((name, event.terminal), times, late, &mut record);
    }
    text += &NamedContacts::new(problem).describe(&motion.segments, second, &mut record);
    for change in problem.describe_changes(motion) {
        text += &format!("  {change}\n");
    }
    text += &cost_line(&motion.statistics, &mut record);
    let turning_point_errors = |points| Some(turning_point_errors(problem, points));
    text += &class_line(
        problem,
        (&motion.segments, second),
        turning_point_errors,
        &mut record,
    );
    text += &describe_energy_balance(problem, motion, duration, &mut record);
    (text, record)
}

/// What the loads and the initial speed can do over a duration (s), J: the energies beside which others are rounding.
fn energy_scale<P: ChartedProblem>(problem: &P, duration: f64, max_potential: f64) -> f64 {
    problem
        .machine()
        .largest_work(0.0, duration)
        .max(max_potential)
}

/// Whether it starts at rest in an unstable equilibrium, within rounding.
pub(crate) fn starts_unstable<P: ChartedProblem>(problem: &P) -> bool {
    let start = problem.initial_state();
    if problem.machine().depends_on_time() || problem.machine().free().is_empty() {
        return false;
    }
    let unstable = || {
        let linear = linearise(problem.machine(), start.t, &start.y)?;
        if !is_equilibrium(problem.machine(), start.t, &start.y, &linear)? {
            return Ok(false);
        }
        let found = eigenvalues_about(problem.machine(), start.t, &start.y, &[], &linear);
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
pub(crate) fn moves<P: ChartedProblem>(problem: &P, motion: &MotionOf<P>) -> bool {
    let scale = energy_scale(problem, motion.end_time(), 0.0);
    let at_steps = energies(problem, motion, motion.steps());
    let moves = |at: &Energies| at.kinetic > REST * scale.max(at.potential.abs());
    at_steps.iter().any(moves)
}

/// The energies at some points of a motion, as far as they can be evaluated.
fn energies<'m, P: ChartedProblem>(
    problem: &P,
    motion: &MotionOf<P>,
    points: impl Iterator<Item = (usize, &'m OdeState)>,
) -> Vec<Energies> {
    let mut workspaces: Vec<Option<MachineWorkspace<f64, ModelOf<P::Scene>>>> = Vec::new();
    let at = |(chart, point): (usize, &OdeState)| {
        let machine = problem.machine_in(motion, chart);
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

/// The largest kinetic energy and potential energy of a motion and the largest error of its energy balance, J; and the energies at its
/// samples.
pub(crate) fn balance<P: ChartedProblem>(
    problem: &P,
    motion: &MotionOf<P>,
) -> ([f64; 2], f64, Vec<Energies>) {
    let at_steps = energies(problem, motion, motion.steps());
    let at_samples = energies(problem, motion, motion.samples());
    let initial = at_steps.first().map_or(0.0, |at| at.balance);
    let differences = at_steps.iter().map(|at| (at.balance - initial).abs());
    let max_difference = differences.fold(0.0, f64::max);
    let both = || at_steps.iter().chain(&at_samples);
    let max_kinetic = both().map(|at| at.kinetic).fold(0.0, f64::max);
    let max_potential = both().map(|at| at.potential.abs()).fold(0.0, f64::max);
    ([max_kinetic, max_potential], max_difference, at_samples)
}

/// The largest error of the energy balance of a motion beyond its rounding, as a part of the largest kinetic energy, or of the potential energy where that
/// is a rounding.
pub(crate) fn imbalance<P: ChartedProblem>(problem: &P, motion: &MotionOf<P>) -> f64 {
    let ([kinetic, potential], difference, _) = balance(problem, motion);
    let difference = beyond_rounding(difference, kinetic, potential);
    relative(difference, error_scale(kinetic, potential))
}

/// The error of the energy balance.
fn describe_energy_balance<P: ChartedProblem>(
    problem: &P,
    motion: &MotionOf<P>,
    duration: f64,
    record: &mut Record,
) -> String {
    let (largest, max_difference, at_samples) = balance(problem, motion);
    let [max_kinetic, max_potential] = largest;
    if max_kinetic <= REST * energy_scale(problem, duration, max_potential) {
        let rounding = if max_kinetic == 0.0 {
            ""
        } else {
            " within rounding"
        };
        let mut text = format!("  the mechanism stays at rest{rounding}: no force moves it\n");
        if starts_unstable(problem) {
            text +=
                "  it starts in an unstable equilibrium, which the least disturbance would end\n";
        }
        return text;
    }
    let (relative_loss, mut text) = balance_line(largest, max_difference, &at_samples, record);
    // By quadrature it is part of the estimated error.
    if relative_loss > MAX_ENERGY_LOSS && motion.orbit.is_none() {
        text += "  this is large: a finer tolerance is needed\n";
    }
    text
}

/// Suggests another method if it is much cheaper on the costliest tenth of the motion.
pub(crate) fn method_hint<P: ChartedProblem>(
    problem: &P,
    motion: &MotionOf<P>,
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
        method: other,
        max_steps: motion.statistics.steps.max(100),
        ..settings.options()
    };
    let end = until(costliest + 1);
    let (_, output_model) = problem.events();
    let repeated = solve(problem.machine(), output_model, start, end, &options, &[]);
    let Some(repeated) = repeated.ok().filter(|s| s.error.is_none()) else {
        return String::new();
    };
    let cost = |method: Method, statistics: Statistics| {
        // A Jacobian takes two evaluations in dual numbers for each free coordinate.
        let columns = 4 * problem.machine().free().len() * usize::from(method.is_implicit());
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

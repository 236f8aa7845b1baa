//! Lines of the summary of a motion, in the plane or in space.

use crate::estimate::{self, ZERO_RATIO, beyond_rounding, is_rounding};
use crate::free_motion::compute::MotionProblem;
use crate::machines::MachineScene as _;
use crate::number_format::{digits, digits_within, how_often};
use dwell_dynamics::{
    DynamicsError, MotionClass, OdeState, Orbit, Solution, Statistics, motion_class,
};
use dwell_findings::Record;

/// Of many changes so many are listed.
const MAX_LISTED: usize = 6;
/// Part of its way by which a motion without a second run may miss its orbit in the first period.
const MISSED: f64 = 0.05;
/// Part of it that is rounding of an integration.
const ROUNDING: f64 = 1e-10;
/// Steps of a period that are compared with an orbit.
const COMPARED: usize = 8;

/// The first of some changes, and how many more there are.
pub(crate) fn first_changes(mut all: Vec<String>) -> Vec<String> {
    if let more @ 1.. = all.len().saturating_sub(MAX_LISTED) {
        all.truncate(MAX_LISTED);
        all.push(format!("and {more} more changes"));
    }
    all
}

/// The times of an event of the scene, s.
pub(crate) fn times_of(parts: &[(usize, Solution)], event: usize) -> Vec<f64> {
    let all = parts.iter().flat_map(|(_, s)| &s.event_occurrences);
    let all = all.filter(|o| o.event == event);
    all.map(|o| o.state.t).collect()
}

/// How often an event happens in a motion and when first, with the error of that time: from a second run, and from the part of all
/// times by which the motion may be late.
pub(crate) fn event_line(
    (name, ends_motion): (&str, bool),
    (own, second): (&[f64], Option<&[f64]>),
    late: f64,
    record: &mut Record,
) -> String {
    let mut text = format!("  {name}: {}", how_often(own.len()));
    record.add_count(format!("event.{name}.count"), own.len());
    if let Some(others) = second.filter(|others| others.len() != own.len()) {
        record.add_count(format!("event.{name}.count_in_second_run"), others.len());
        text += &format!(
            " ({} in a second run, so this number is not certain)",
            how_often(others.len())
        );
    }
    if let Some(&first) = own.first() {
        let other = second.and_then(|others| others.first().copied());
        text += &first_time(name, first, other, late, record);
        text += if ends_motion {
            "; the motion ends there"
        } else {
            ""
        };
    }
    text + "\n"
}

/// When an event happens first, s, with the error of that time.
pub(super) fn first_time(
    event: &str,
    first: f64,
    in_second_run: Option<f64>,
    late: f64,
    record: &mut Record,
) -> String {
    let name = format!("event.{event}.first");
    match in_second_run {
        Some(other) => {
            let error = estimate::of_number(first, other) + late * first;
            record.add_within(name, "s", first, error);
            let first = digits_within(first, error, 13);
            format!(", first at t = {first} s (estimated error {error:.1e} s)")
        }
        None => {
            record.add(name, "s", first);
            format!(", first at t = {} s", digits(first, 6))
        }
    }
}

/// The work done.
pub(crate) fn cost_line(cost: &Statistics, record: &mut Record) -> String {
    for (name, count) in [
        ("steps", cost.steps),
        ("rejected_steps", cost.rejected_steps),
        ("evaluations", cost.evaluations),
        ("jacobians", cost.jacobians),
        ("factorisations", cost.factorisations),
    ] {
        record.add_count(name, count);
    }
    format!(
        "  {} steps, {} rejected, {} evaluations, {} Jacobians, {} factorisations\n",
        cost.steps, cost.rejected_steps, cost.evaluations, cost.jacobians, cost.factorisations
    )
}

/// The parts of a run, each with its branch.
type Parts<'a> = &'a [(usize, Solution)];

/// The class of a conservative motion of one degree of freedom, from its energy, and its period; the turning points with their errors
/// (rad or m), where these are known. The period is that of `parts`, unless the orbit does not follow these and their second run. A motion that an event
/// ended before it could turn back is no libration.
pub(crate) fn class_line(
    problem: &impl MotionProblem,
    (parts, second): (Parts<'_>, Option<Parts<'_>>),
    turning_point_errors: impl Fn([f64; 2]) -> Option<[f64; 2]>,
    record: &mut Record,
) -> String {
    let is_prescribed = problem.spec().laws.iter().any(Option::is_some);
    let has_drives = !problem.scene().drives().is_empty();
    if is_prescribed || problem.machine().free().len() != 1 || has_drives {
        return String::new();
    }
    let (name, unit) = problem.named_coordinate(0);
    let class = match motion_class(problem.machine(), problem.initial_reduced_state()) {
        Ok(MotionClass::Rotation {
            kinetic_at_maximum, ..
        }) => {
            let key = "kinetic_energy_at_potential_maximum";
            record.add(key, "J", kinetic_at_maximum);
            let kinetic = digits(kinetic_at_maximum, 6);
            format!("rotation; kinetic energy at the potential maximum {kinetic} J")
        }
        Ok(MotionClass::Libration { turning_points }) => {
            if is_ended_before_it_turns(problem, parts) {
                return String::new();
            }
            let errors = turning_point_errors(turning_points);
            let ends = ["lower", "upper"].map(|end| format!("turning_point.{end}"));
            for (k, end) in ends.into_iter().enumerate() {
                match errors {
                    Some(errors) => record.add_within(end, unit, turning_points[k], errors[k]),
                    None => record.add(end, unit, turning_points[k]),
                }
            }
            let errors = errors.unwrap_or_default();
            let [a, b] = [0, 1].map(|k| digits_within(turning_points[k], errors[k], 10));
            format!("libration between {name} = {a} and {b} {unit}")
        }
        Ok(MotionClass::Asymptotic { to }) => {
            record.add("asymptotic_to", unit, to);
            let to = digits(to, 10);
            return format!("  by energy: asymptotic to {name} = {to} {unit} (separatrix)\n");
        }
        _ => return String::new(),
    };
    format!(
        "  by energy: {class}{}\n",
        period_text(problem, (parts, second), record)
    )
}

/// How far a motion in one part, without impacts, is from an orbit during the first period, how fast it is, and how far it moves; none
/// where it cannot be compared.
fn missed(orbit: &Orbit, parts: &[(usize, Solution)]) -> Option<[f64; 3]> {
    let [(_, solution)] = parts else {
        return None;
    };
    let start = orbit.initial_state();
    let begins = solution.steps.first().and_then(|step| step.y.first());
    // It may have begun in another coordinate, next to a dead point.
    if begins != Some(&start.q) || !solution.contact_events.is_empty() {
        return None;
    }
    let in_first = |step: &&OdeState| step.t - start.t <= orbit.period;
    let steps: Vec<&OdeState> = solution.steps.iter().take_while(in_first).collect();
    let moved = steps.iter().filter_map(|step| step.y.first());
    let moved = moved.fold(0.0_f64, |most, q| most.max((q - start.q).abs()));
    let [mut far, mut fast] = [0.0_f64; 2];
    for step in steps.iter().rev().step_by(steps.len().div_ceil(COMPARED)) {
        let there = orbit.state_at(step.t);
        far = far.max((there.q - step.y.first()?).abs());
        fast = fast.max(there.q_dot.abs());
    }
    Some([far, fast, moved])
}

/// Whether a motion is on an orbit, within the estimated errors of both. A second run at a smaller tolerance comes closer to the orbit,
/// unless that missed a peak of the inertia: then both runs are as far from it.
fn is_followed(
    orbit: &Orbit,
    (parts, second): (Parts<'_>, Option<Parts<'_>>),
    period_error: f64,
) -> bool {
    let Some([far, fast, moved]) = missed(orbit, parts) else {
        return true;
    };
    match second.and_then(|parts| missed(orbit, parts)) {
        Some([finer, ..]) => {
            let rounding = fast * period_error + ROUNDING * moved;
            finer <= estimate::over_motion(&[far], &[finer], rounding)
        }
        None => far <= MISSED * moved,
    }
}

/// Whether an event ended a motion within half its period.
fn is_ended_before_it_turns(problem: &impl MotionProblem, parts: &[(usize, Solution)]) -> bool {
    let ended = parts.last().filter(|(_, last)| last.terminated_by_event);
    let end = ended.and_then(|(_, last)| last.steps.last());
    end.is_some_and(|end| {
        let orbit = problem.orbit(1.0);
        orbit.is_ok_and(|orbit| end.t < 0.5 * orbit.period)
    })
}

/// The period of a motion with its error, where it has one.
fn period_text(
    problem: &impl MotionProblem,
    (parts, second): (Parts<'_>, Option<Parts<'_>>),
    record: &mut Record,
) -> String {
    let orbit = match problem.orbit(1.0) {
        Ok(orbit) => orbit,
        Err(DynamicsError::NotResolved { .. }) => {
            return "; its period is not known: the quadrature does not resolve the inertia"
                .to_owned();
        }
        Err(_) => return String::new(),
    };
    let error = estimate::of_period(&orbit, |factor| problem.orbit(factor));
    if !is_followed(&orbit, (parts, second), *error.as_ref().unwrap_or(&0.0)) {
        return "; its period is not known: the quadrature and the integrated motion disagree"
            .to_owned();
    }
    let period = match error {
        Ok(error) => {
            record.add_within("period", "s", orbit.period, error);
            let period = digits_within(orbit.period, error, 13);
            format!("{period} s (estimated error {error:.1e} s)")
        }
        Err(_) => {
            record.add("period", "s", orbit.period);
            format!("{} s (its error is not known)", digits(orbit.period, 3))
        }
    };
    format!("; period {period} by quadrature")
}

/// The energies of a motion at a time (s), and what the balance of energies and works keeps constant, J.
pub(crate) struct Energies {
    pub(crate) t: f64,
    pub(crate) kinetic: f64,
    pub(crate) potential: f64,
    pub(crate) balance: f64,
}

/// By how much a quantity may be higher between points than at the highest of them: the height of the parabola through it and
/// its neighbours.
fn height_between(points: &[Energies], value: impl Fn(&Energies) -> f64) -> f64 {
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

/// To what the balance of energies closes, as a part of the largest energy, and the line about it: `drift` is the largest error of the
/// balance, J, and the largest energies are those at all known states, of which `samples` are some.
pub(crate) fn balance_line(
    [kinetic, potential]: [f64; 2],
    drift: f64,
    samples: &[Energies],
    record: &mut Record,
) -> (f64, String) {
    let is_at_rest = is_rounding(kinetic, potential);
    let (kind, largest) = match is_at_rest {
        true => ("potential", potential),
        false => ("kinetic", kinetic),
    };
    let relative = drift / largest;
    record.add("energy_balance_error", "", relative);
    let value = |at: &Energies| match is_at_rest {
        true => at.potential.abs(),
        false => at.kinetic,
    };
    let error = drift.max(height_between(samples, value));
    record.add_within(format!("largest_{kind}_energy"), "J", largest, error);
    let energy = digits_within(largest, error, 6);
    // Beside a large potential energy: no error of the motion.
    let is_unknown = beyond_rounding(drift, kinetic, potential) == 0.0;
    let cause = match is_unknown && relative > ZERO_RATIO {
        true => ", by the rounding of the potential energy",
        false => "",
    };
    let line = format!(
        "  energy balance closes to {relative:.1e} of the largest {kind} energy, {energy} J{cause}\n"
    );
    (relative, line)
}

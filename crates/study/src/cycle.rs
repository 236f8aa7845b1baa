//! `dwell cycle`: the steady cycle of a driven machine, and the flywheel that evens it.

use crate::driven::Driven;
use crate::error::StudyError;
use crate::figures;
use crate::outcome::Outcome;
use crate::provenance::picture;
use crate::simulate::Accuracy;
use crate::words::{count, digits};
use dwell_dynamics::{
    Cycle, DynamicsError, Flywheel, Machine, Options, flywheel, run_up, steady_cycle,
};
use dwell_geometry::ActuatorId;
use dwell_report::{Column, Table};
use dwell_scene::{Place, Scene};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// Turns from the start to the guess.
const RUN_UP: u32 = 3;
/// Tolerance of the way there.
const GUESS: f64 = 1e-6;
/// Most steps of an integration: a machine that has not got round by then never does.
const BUDGET: usize = 100_000;

/// The steady cycle of a scene, and the flywheel for a coefficient of fluctuation if one is wanted.
///
/// # Errors
/// [`StudyError`] when nothing turns fully, something follows time, or no steady cycle is found.
pub fn cycle(
    scene: &Scene,
    accuracy: &Accuracy,
    fluctuation: Option<f64>,
) -> Result<Outcome, StudyError> {
    let driven = Driven::new(scene)?;
    turns(&driven)?;
    driven.timeless("a steady cycle")?;
    let options = Options {
        absolute: accuracy.absolute,
        budget: BUDGET,
        longest: accuracy.longest,
        ..Options::new(accuracy.method, accuracy.relative)
    };
    let machine = &driven.machine;
    // A guess need not be exact, and from rest a coarse one starts more easily.
    let coarse = Options {
        absolute: options.absolute.max(GUESS),
        relative: options.relative.max(GUESS),
        ..options
    };
    let guess = run_up(machine, &driven.start(), RUN_UP, &coarse);
    let guess = guess.map_err(|e| never_round(&driven, &e))?;
    let explain = |e: DynamicsError| driven.explain(&e);
    let steady = from_zero(steady_cycle(machine, &guess, &options).map_err(explain)?);
    let even = match fluctuation {
        None => None,
        Some(wanted) => {
            let even = flywheel(machine, &steady.start, wanted, &options);
            let even = even.map_err(explain)?;
            Some(Flywheel {
                cycle: from_zero(even.cycle),
                ..even
            })
        }
    };
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-cycle{rest}", scene.name);
    let samples = table(&driven, machine, &steady)?;
    outcome.files.add(name(".csv"), samples.csv()?);
    outcome.files.add(name(".npz"), samples.npz()?);
    outcome
        .files
        .add(name("-work.csv"), works(&driven, &steady).csv()?);
    let other = match &even {
        Some(even) if even.inertia > 0.0 => {
            let heavier = machine.clone();
            let heavier = heavier.with_flywheel(0, machine.flywheel(0) + even.inertia);
            let samples = table(&driven, &heavier, &even.cycle)?;
            outcome.files.add(name("-flywheel.csv"), samples.csv()?);
            outcome.files.add(name("-flywheel.npz"), samples.npz()?);
            Some((&even.cycle, samples))
        }
        _ => None,
    };
    let other = other.as_ref().map(|(cycle, table)| (*cycle, table));
    let figure = figures::cycle(&driven, (&steady, &samples), other, accuracy);
    outcome.files.add(name(".png"), picture(scene, &figure)?);
    outcome.summary = summary(&driven, &steady);
    if let (Some(wanted), Some(even)) = (fluctuation, &even) {
        outcome.summary += &evened(&driven, wanted, even);
    }
    Ok(outcome)
}

/// The same cycle in the first round of the coordinate.
fn from_zero(mut cycle: Cycle) -> Cycle {
    let past = cycle.turn * (cycle.start[0] / cycle.turn).floor();
    cycle.start[0] -= past;
    for point in &mut cycle.samples {
        point.y[0] -= past;
    }
    for extreme in [&mut cycle.slowest, &mut cycle.fastest] {
        extreme[0] = (extreme[0] - past).rem_euclid(cycle.turn);
    }
    cycle
}

/// Refuses a machine whose coordinate does not turn.
fn turns(driven: &Driven<'_>) -> Result<(), StudyError> {
    let free = driven.machine.free();
    if driven.machine.workers().is_empty() {
        return Err(driven.refused(
            "nothing drives the machine: what neither gains nor loses energy goes on at any speed"
                .to_owned(),
            "add a drive, as in `[drives]`; `dwell simulate` shows the free motion and its period",
            &[driven.began("of this motion")],
        ));
    }
    let label = |i: usize, words: &str| (Place::Actuator(ActuatorId(i)), words.to_owned());
    if free.len() != 1 {
        let labels: Vec<_> = free.iter().take(8).map(|&i| label(i, "free")).collect();
        return Err(driven.refused(
            format!(
                "a steady cycle is that of one coordinate, and {} are free",
                free.len()
            ),
            "lead the others by constant laws in [motion]",
            &labels,
        ));
    }
    let (only, angle) = driven.only();
    let range = driven.machine.model().plan().range();
    let reach = match range.limits() {
        None if angle => return Ok(()),
        None => "is a length".to_owned(),
        Some((from, to)) => {
            let unit = if angle { "rad" } else { "m" };
            let [from, to] = [from, to].map(|end| digits(end, 6));
            format!("goes only from {from} to {to} {unit}")
        }
    };
    Err(driven.refused(
        format!(
            "`{}` {reach}: it does not turn, and has no steady cycle",
            driven.name(only)
        ),
        "take the angle of a body that turns fully as the actuator",
        &[label(only, "does not turn fully")],
    ))
}

/// Explains a machine that does not get round from its start.
fn never_round(driven: &Driven<'_>, error: &DynamicsError) -> StudyError {
    let DynamicsError::Budget { t, steps } = *error else {
        return driven.explain(error);
    };
    driven.refused(
        format!(
            "the machine does not get round: {} take it to t = {} s, and it has not made {} from \
             its start",
            count(steps, "step"),
            digits(t, 2),
            count(RUN_UP as usize, "turn")
        ),
        "a drive has to carry it over its hardest place, or a start be fast enough; `dwell simulate` \
         shows how it moves",
        &[driven.began("from here")],
    )
}

/// One cycle: time, states, acceleration and the works since its start.
fn table(driven: &Driven<'_>, machine: &Machine, cycle: &Cycle) -> Result<Table, StudyError> {
    let mut columns = vec![Column::new("t", "s")];
    let mut states = driven.states().into_iter();
    columns.extend(states.by_ref().take(2));
    let (only, _) = driven.only();
    let name = driven.name(only);
    columns.push(Column::new(format!("{name}.acceleration"), "rad/s2"));
    columns.extend(states);
    for worker in machine.workers() {
        let name = format!("{}.work", driven.worker(*worker));
        columns.push(Column::new(name, "J"));
    }
    let mut work = machine.work();
    let mut rows = Vec::with_capacity(cycle.samples.len());
    for point in &cycle.samples {
        let evaluated = machine.evaluate(point.t, &point.y, &mut work);
        evaluated.map_err(|e| driven.explain(&e))?;
        let mut row = vec![point.t, point.y[0], point.y[1], work.q_ddot[only]];
        row.extend(&point.y[2..]);
        rows.push(row);
    }
    Ok(Table { columns, rows })
}

/// The work of each load and drive over the cycle, and what is left of their sum.
fn works(driven: &Driven<'_>, cycle: &Cycle) -> Table {
    let workers = driven.machine.workers().iter();
    let mut columns: Vec<Column> = workers
        .map(|worker| Column::new(driven.worker(*worker), "J"))
        .collect();
    let mut row = cycle.works.clone();
    columns.push(Column::new("sum", "J"));
    row.push(cycle.works.iter().sum());
    Table {
        columns,
        rows: vec![row],
    }
}

/// A speed with its turns in a minute.
fn speed(value: f64) -> String {
    let minute = digits(value * 30.0 / PI, 6);
    format!("{} rad/s ({minute} 1/min)", digits(value, 9))
}

fn summary(driven: &Driven<'_>, cycle: &Cycle) -> String {
    let (only, _) = driven.only();
    let turn = count((cycle.turn / TAU).round() as usize, "turn");
    let place = |[q, _]: [f64; 2]| driven.place(only, q);
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: steady cycle of {}, {turn} in {} s\n  mean speed {}\n  slowest {} at {}\n  fastest {} \
         at {}\n  coefficient of fluctuation {}",
        driven.scene.title,
        driven.name(only),
        digits(cycle.period, 9),
        speed(cycle.mean_speed),
        speed(cycle.slowest[1]),
        place(cycle.slowest),
        speed(cycle.fastest[1]),
        place(cycle.fastest),
        digits(cycle.fluctuation, 9),
    );
    let multipliers = cycle.multipliers.iter().map(|&z| complex(z, 6));
    let multipliers: Vec<String> = multipliers.collect();
    let verdict = if cycle.stable() {
        "stable: of a disturbance a cycle leaves"
    } else {
        "unstable: a cycle makes of a disturbance"
    };
    let _ = writeln!(
        text,
        "  {verdict} {} times as much (Floquet multipliers)",
        multipliers.join(", ")
    );
    let workers = driven.machine.workers().iter().zip(&cycle.works);
    for (worker, work) in workers {
        let name = driven.worker(*worker);
        let _ = writeln!(text, "  work of {name} in a cycle {} J", digits(*work, 9));
    }
    let sum: f64 = cycle.works.iter().sum();
    let size: f64 = cycle.works.iter().map(|work| work.abs()).sum();
    if size > 0.0 {
        let _ = writeln!(
            text,
            "  these works add up to zero within {:.1e} of their sizes",
            (sum / size).abs()
        );
    }
    text
}

/// What a flywheel does.
fn evened(driven: &Driven<'_>, wanted: f64, even: &Flywheel) -> String {
    let wanted = digits(wanted, 6);
    if even.inertia == 0.0 {
        return format!("  no flywheel is needed for a fluctuation of {wanted}\n");
    }
    let (only, _) = driven.only();
    format!(
        "  for a fluctuation of {wanted}: a flywheel of {} kg m² along {}\n  with it mean speed {}, \
         from {} to {}\n",
        digits(even.inertia, 9),
        driven.name(only),
        speed(even.cycle.mean_speed),
        speed(even.cycle.slowest[1]),
        speed(even.cycle.fastest[1]),
    )
}

/// A complex number.
fn complex([re, im]: [f64; 2], count: usize) -> String {
    if im == 0.0 {
        digits(re, count)
    } else {
        let sign = if im < 0.0 { '−' } else { '+' };
        format!("{} {sign} {}i", digits(re, count), digits(im.abs(), count))
    }
}

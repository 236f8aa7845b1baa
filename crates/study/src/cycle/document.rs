//! The summary of a steady cycle.

use crate::models::SceneMachine;
use crate::number_format::{count, digits};
use dwell_dynamics::{Cycle, Flywheel};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// An angular velocity in rad/s and revolutions per minute.
fn speed_text(value: f64) -> String {
    let minute = digits(value * 30.0 / PI, 6);
    format!("{} rad/s ({minute} 1/min)", digits(value, 9))
}

pub(crate) fn summary(scene_machine: &SceneMachine<'_>, cycle: &Cycle) -> String {
    let (coordinate, _) = scene_machine.first_free_coordinate();
    let revolutions = count((cycle.cycle_angle / TAU).round() as usize, "revolution");
    let position = |[q, _]: [f64; 2]| scene_machine.describe_coordinate(coordinate, q);
    // Writing to a string cannot fail.
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: steady cycle of {}, {revolutions} in {} s\n  mean speed {}\n  slowest {} at {}\n  fastest {} \
         at {}\n  coefficient of fluctuation {}",
        scene_machine.scene.title,
        scene_machine.coordinate_name(coordinate),
        digits(cycle.period, 9),
        speed_text(cycle.mean_speed),
        speed_text(cycle.slowest[1]),
        position(cycle.slowest),
        speed_text(cycle.fastest[1]),
        position(cycle.fastest),
        digits(cycle.fluctuation, 9),
    );
    let multipliers = cycle
        .floquet_multipliers
        .iter()
        .map(|&z| complex_text(z, 6));
    let multipliers: Vec<String> = multipliers.collect();
    let stability = if cycle.is_stable() {
        "stable"
    } else {
        "unstable"
    };
    let _ = writeln!(
        text,
        "  {stability}: a disturbance changes by these factors per cycle (Floquet multipliers): {}",
        multipliers.join(", ")
    );
    let sources = scene_machine
        .machine
        .nonconservative_sources()
        .iter()
        .zip(&cycle.works);
    for (source, work) in sources {
        let name = scene_machine.source_name(*source);
        let _ = writeln!(text, "  work of {name} per cycle {} J", digits(*work, 9));
    }
    let sum: f64 = cycle.works.iter().sum();
    let size: f64 = cycle.works.iter().map(|work| work.abs()).sum();
    if size > 0.0 {
        let _ = writeln!(
            text,
            "  sum of these works: {:.1e} of the sum of their absolute values",
            (sum / size).abs()
        );
    }
    text
}

/// The flywheel and its effect.
pub(crate) fn flywheel_text(
    scene_machine: &SceneMachine<'_>,
    target: f64,
    with_flywheel: &Flywheel,
) -> String {
    let target = digits(target, 6);
    if with_flywheel.inertia == 0.0 {
        return format!("  no flywheel is needed for a coefficient of fluctuation of {target}\n");
    }
    let (coordinate, _) = scene_machine.first_free_coordinate();
    format!(
        "  for a coefficient of fluctuation of {target}: flywheel of {} kg m² on {}\n  with it: mean speed {}, \
         from {} to {}\n",
        digits(with_flywheel.inertia, 9),
        scene_machine.coordinate_name(coordinate),
        speed_text(with_flywheel.cycle.mean_speed),
        speed_text(with_flywheel.cycle.slowest[1]),
        speed_text(with_flywheel.cycle.fastest[1]),
    )
}

/// A complex number.
fn complex_text([re, im]: [f64; 2], count: usize) -> String {
    if im == 0.0 {
        digits(re, count)
    } else {
        let sign = if im < 0.0 { '−' } else { '+' };
        format!("{} {sign} {}i", digits(re, count), digits(im.abs(), count))
    }
}

//! Equilibria and eigenvalues as text.

use crate::equilibria::compute::without_rounding;
use crate::models::SceneMachine;
use crate::number_format::{count, digits};
use dwell_dynamics::{Equilibrium, Stability};
use std::f64::consts::TAU;

pub(crate) fn summary(
    scene_machine: &SceneMachine<'_>,
    found: &[Equilibrium],
    interval: Option<[f64; 2]>,
) -> String {
    let (coordinate, is_angle) = scene_machine.first_free_coordinate();
    let mut text = match interval {
        Some([from, to]) => {
            let is_whole_period = is_angle && (to - from) >= TAU * (1.0 - 1e-12);
            let endpoint = |q: f64| {
                if is_angle {
                    format!("{}°", digits(q.to_degrees(), 6))
                } else {
                    format!("{} m", digits(q, 6))
                }
            };
            format!(
                "{}: {} of {} between {} and {}{}\n",
                scene_machine.scene.title,
                match found.len() {
                    0 => "no equilibrium".to_owned(),
                    1 => "1 equilibrium".to_owned(),
                    n => format!("{n} equilibria"),
                },
                scene_machine.coordinate_name(coordinate),
                endpoint(from),
                endpoint(to),
                if is_whole_period {
                    ", one revolution around the start"
                } else {
                    ""
                }
            )
        }
        None => format!(
            "{}: the equilibrium of {} that Newton's method finds from the start\n",
            scene_machine.scene.title,
            count(scene_machine.machine.free().len(), "free coordinate")
        ),
    };
    for equilibrium in found {
        text += &describe_equilibrium(scene_machine, equilibrium);
    }
    text
}

/// An equilibrium as text.
pub(crate) fn describe_equilibrium(
    scene_machine: &SceneMachine<'_>,
    equilibrium: &Equilibrium,
) -> String {
    let start = scene_machine.initial_state();
    let free = scene_machine.machine.free().iter().enumerate();
    let positions: Vec<String> = free
        .map(|(k, &i)| {
            let deflection = equilibrium.y[k] - start[k];
            let deflection = match scene_machine.is_angle(i) {
                true => format!("{} rad", digits(deflection, 6)),
                false => format!("{} m", digits(deflection, 6)),
            };
            let position = scene_machine.describe_coordinate(i, equilibrium.y[k]);
            format!("{position}, {deflection} from the start")
        })
        .collect();
    let stability = match equilibrium.stability {
        Stability::Asymptotic => "asymptotically stable",
        Stability::Centre => "stable without damping (centre)",
        Stability::Unstable => "unstable",
        Stability::Undecided => "stability is not decided by the linearisation",
    };
    let eigenvalues = describe_eigenvalues(&equilibrium.eigenvalues);
    format!("  {}: {stability}\n{eigenvalues}", positions.join("; "))
}

/// Eigenvalues as text: a complex pair once, with its frequency and damping.
pub(crate) fn describe_eigenvalues(values: &[[f64; 2]]) -> String {
    let one = |&z: &[f64; 2]| {
        let [re, im] = without_rounding(z);
        let size = re.hypot(im);
        match im {
            0.0 => format!("    eigenvalue {} 1/s\n", digits(re, 9)),
            im if im < 0.0 => String::new(),
            _ => format!(
                "    eigenvalues {} ± {}i 1/s: {} rad/s = {} Hz, damping ratio {}\n",
                digits(re, 9),
                digits(im, 9),
                digits(size, 9),
                digits(size / TAU, 9),
                digits(if re == 0.0 { 0.0 } else { -re / size }, 6)
            ),
        }
    };
    values.iter().map(one).collect()
}

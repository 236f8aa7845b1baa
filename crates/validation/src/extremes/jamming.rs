//! Friction near a jam, and motions of very many periods.

use super::closed_forms::{dd, four_bar, root_inertia_integral};
use super::in_scenes::{StatedTable, column};
use super::mechanisms::{CRANK_ROCKER, FourBar, scene};
use super::series::{ParameterSeries, Requirement, RunResult, decades, scaled_cell};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_study::{MotionSolver, compute_free_motion, no_progress};
use std::f64::consts::TAU;

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = ("use", "Friction near a jam, and many periods");
/// The crank where the motion starts, rad.
const START_ANGLE: f64 = 1.125;
/// Points of the rule for the period; with half as many, the result differs by 1e-28.
const QUADRATURE_POINTS: usize = 256;

pub(super) fn series() -> Vec<ParameterSeries> {
    vec![jamming(), periods()]
}

/// A wedge under a lift of 1 N, with a slope of 3 : 4 and friction µ between: it jams at µ = 4/3.
fn jamming() -> ParameterSeries {
    let run = |gap: f64| -> RunResult {
        let coefficient = (4.0 - gap) / 3.0;
        let text = format!(
            "[bodies]\nground = {{ points = {{ O = [0, 0] }} }}\nwedge = {{ points = {{ P = [0, 0] }} }}\nlift = {{ points = {{ P = [0, 0] }} }}\n\
             [joints]\nfloor = {{ prismatic = [\"ground.O\", \"wedge.P\"], axis = [1, 0] }}\n\
             shaft = {{ prismatic = [\"ground.O\", \"lift.P\"], axis = [0, 1] }}\n\
             face = {{ slot = [\"wedge.P\", \"lift.P\"], axis = [4, 3] }}\n\
             [actuators]\nx = {{ length = \"floor\" }}\n[assembly]\nx = -0.5\n\
             [friction]\nface = {{ coefficient = {coefficient} }}\n\
             [loads]\nweight = {{ force = \"lift.P\", direction = [0, -1], magnitude = 1 }}\n\
             [prescribed]\nduration = 1\nx = {{ speed = -0.25 }}\n[requests]\nreactions = [\"face.normal\"]\n"
        );
        let found = StatedTable::kinetostatics(&text, 3)?;
        let (three, four, friction) = (dd(3.0), dd(4.0), dd(coefficient));
        let slack = four - three * friction;
        let force = -(three + four * friction) / slack;
        found.compare(&[
            vec![("x.actuator_force", vec![force; 3])],
            vec![("face.normal", vec![dd(5.0) / slack; 3])],
        ])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "jamming".into(),
        description:
            "Wedge under a lift, as kinetostatics writes it: distance of the friction from the jam"
                .into(),
        parameter: ("4 − 3 µ", ""),
        values: decades(0, -15),
        quantities: &["drive force", "normal force"],
        reference: "drive (3 + 4µ)/(4 − 3µ) and normal force 5/(4 − 3µ) of a lift of 1 N on a slope of 3 : 4",
        reason: "coefficient and slope are known to their rounding, and the forces grow as the inverse of the distance: 16 roundings; beyond 1e8 the mechanism may be called self-locking",
        requirement: Box::new(|gap, _| Requirement::from_rounding(16.0, 4.0 / gap)),
        run: Box::new(run),
    }
}

/// The crank-rocker after many periods, as `simulate` writes it.
fn periods() -> ParameterSeries {
    let run = |count: f64| -> RunResult {
        let m = four_bar(&CRANK_ROCKER, dd(START_ANGLE)).m;
        let period = root_inertia_integral(&CRANK_ROCKER, QUADRATURE_POINTS) / m.sqrt();
        let exact = period * dd(count);
        let duration = exact.value();
        let assembled = FourBar {
            assembly: [START_ANGLE, 0.4],
            ..CRANK_ROCKER
        };
        let motion = format!(
            "rocker = 1.5\n[motion]\ninitial-coordinate = {{ phi = {START_ANGLE} }}\ninitial-velocity = {{ phi = 1 }}\n\
             duration = {duration:?}\n[requests]\nvariables = [\"phi\", \"phi.velocity\"]\n"
        );
        let scene = scene(&(assembled.text() + &motion))?;
        let solver = MotionSolver::Accuracy {
            accuracy: 1e-10,
            sample_interval: Some(duration),
        };
        let motion = compute_free_motion(&scene, &solver, &no_progress)?;
        let angles = column(&motion.computed.table, "phi")?;
        let end = angles.last().ok_or("no rows")?;
        // The rounding of the duration changes the final angle, which is taken into account.
        let late = dd(duration) - exact;
        let angle = dd(START_ANGLE) + DoubleDouble::from_revolutions(count) + late;
        let error = motion.estimated_error.unwrap_or(f64::NAN);
        Ok(vec![scaled_cell((*end, error), angle, TAU)])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "periods-by-quadrature".into(),
        description: "Free motion of a four-bar by quadrature, as simulate writes it: periods"
            .into(),
        parameter: ("periods n", ""),
        values: decades(0, 7),
        quantities: &["angle at the end"],
        reference: "the period by quadrature of a closed form in 32 digits: the crank is where it was",
        reason: "the period is known to some roundings, and the angle errs by 2π n of them: 16 roundings. The error is stated, with status 1 where it is above the required 1e-10",
        requirement: Box::new(|count, _| Requirement::from_rounding(16.0, 2.0 * count)),
        run: Box::new(run),
    }
}

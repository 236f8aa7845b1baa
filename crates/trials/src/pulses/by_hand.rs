//! The same motion restarted by hand: an integration of its own for each piece of the magnitude, by the same method or,
//! for a reference, by the finest one.

use super::subject::PulsedMotion;
use dwell_dynamics::{Method, OdeState, Options, solve};
use dwell_scene::PlaneScene;
use dwell_study::models::build_machine;

/// Tolerance of the reference.
const FINEST: f64 = 1e-13;

/// Coordinate and speed at the end.
///
/// # Errors
/// Where a piece cannot be integrated, as text.
pub(super) fn restarted(
    motion: &PulsedMotion,
    method: Method,
    tolerance: f64,
) -> Result<[f64; 2], String> {
    let (mut t, mut y) = (0.0, vec![0.0, motion.speed]);
    for (magnitude, end) in motion.pulse.pieces() {
        let scene = PlaneScene::parse("piece.toml", &motion.scene(&magnitude))
            .map_err(|e| e.to_string())?;
        let spec = scene.motion.as_ref().ok_or("no motion")?;
        let machine = build_machine(&scene, spec, &[]).map_err(|e| e.to_string())?;
        // The works begin at zero again: they do not act on the motion.
        let start = OdeState {
            t,
            y: machine.initial_state(&y[..1], &y[1..2]),
        };
        let options = Options::new(method, tolerance);
        let solution = solve(&machine, machine.model(), &start, end, &options, &[]);
        let solution = solution.and_then(|solution| solution.completed());
        let last = solution.map_err(|e| e.to_string())?.steps.pop();
        y = last.ok_or("no steps")?.y;
        t = end;
    }
    Ok([y[0], y[1]])
}

/// The true coordinate and speed at the end, and how far two references are apart where there is no closed form.
///
/// # Errors
/// As [`restarted`].
pub(super) fn reference(motion: &PulsedMotion) -> Result<([f64; 2], [f64; 2]), String> {
    if let Some(exact) = motion.closed_form() {
        return Ok((exact, [0.0; 2]));
    }
    let fine = restarted(motion, Method::Dop853, FINEST)?;
    let other = restarted(motion, Method::Tsit45, FINEST)?;
    Ok((fine, [0, 1].map(|k| (fine[k] - other[k]).abs())))
}

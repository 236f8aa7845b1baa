//! Motions over hills of a potential whose class is known.

use super::*;
use dwell_geometry::Range;

/// A point of unit inertia with a potential, which counts its evaluations.
struct Hill {
    /// V and −V′.
    potential: fn(f64) -> [f64; 2],
    evaluations: usize,
    follows_functions: bool,
}

impl ConservativeSystem for Hill {
    fn energy_terms(&mut self, q: f64) -> Result<EnergyTerms> {
        self.evaluations += 1;
        let [potential, force] = (self.potential)(q);
        Ok(EnergyTerms {
            m: 1.0,
            potential,
            force,
        })
    }

    fn range(&self) -> Range {
        Range::Full
    }

    fn is_angle(&self) -> bool {
        true
    }

    fn turns(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    fn follows_functions(&self) -> bool {
        self.follows_functions
    }
}

fn class(potential: fn(f64) -> [f64; 2], q: f64, q_dot: f64) -> (MotionClass, usize) {
    class_of(potential, false, [q, q_dot])
}

fn class_of(
    potential: fn(f64) -> [f64; 2],
    follows_functions: bool,
    [q, q_dot]: [f64; 2],
) -> (MotionClass, usize) {
    let mut hill = Hill {
        potential,
        evaluations: 0,
        follows_functions,
    };
    let start = ReducedState { t: 0.0, q, q_dot };
    let (_, class) = EnergyScan::new(&mut hill, start).unwrap();
    (class, hill.evaluations)
}

/// Joined steps give the closed form of a pendulum, with fewer evaluations than steps.
#[test]
fn steps_in_which_nothing_happens_are_one() {
    let pendulum = |q: f64| [-q.cos(), -q.sin()];
    let (rotation, evaluations) = class(pendulum, 0.3, 2.5);
    let MotionClass::Rotation {
        potential_maximum_at,
        ..
    } = rotation
    else {
        panic!("{rotation:?}")
    };
    assert!((potential_maximum_at - TAU / 2.0).abs() < 1e-14);
    // Of a period of 512 steps.
    assert!(evaluations < 200, "{evaluations}");
    for (amplitude, allowed) in [(1e-3, 1e-11), (1.0, 1e-14), (3.1, 1e-13)] {
        let (libration, evaluations) = class(pendulum, amplitude, 0.0);
        let MotionClass::Libration {
            turning_points: [a, b],
        } = libration
        else {
            panic!("{libration:?}")
        };
        let off = (a + amplitude).abs().max((b - amplitude).abs());
        println!("{amplitude}: {off:.1e}, {evaluations} evaluations");
        assert!(off < allowed, "{amplitude}: {off:e}");
        // Seen: 113.
        assert!(evaluations < 200, "{evaluations}");
    }
    let speed = 2.0 * (0.5 * (1.0 + 0.3_f64.cos())).sqrt();
    let (class, _) = class(pendulum, 0.3, speed);
    assert!(matches!(class, MotionClass::Asymptotic { .. }), "{class:?}");
}

/// A narrow hill on a slope that fits the cubic elsewhere is met, whichever of the steps it stands in.
#[test]
fn a_narrow_hill_is_not_passed_over() {
    let hill = |q: f64| {
        let width = 0.03;
        let at = ((q - 1.0 + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU) / width;
        let bump = 3.0 * (-at * at).exp();
        [bump - q.cos(), 2.0 * at / width * bump - q.sin()]
    };
    for k in 0..40 {
        let q = -0.6 + 0.02 * f64::from(k);
        let (found, _) = class(hill, q, 2.1);
        let MotionClass::Libration { turning_points } = found else {
            panic!("{found:?} from {q}")
        };
        assert!(turning_points[1] < 1.0, "{turning_points:?} from {q}");
    }
}

/// The hill of a cam begins and ends within a few steps: nothing beside it shows it, so that no steps are left out.
#[test]
fn the_hill_of_a_cam_is_not_passed_over() {
    let hill = |q: f64| {
        let width = 0.02;
        let at = ((q - 1.0 + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU) / width;
        let inside = (1.0 - at * at).max(0.0);
        let bump = 3.0 * inside * inside;
        [bump - q.cos(), 12.0 * at / width * inside - q.sin()]
    };
    for k in 0..40 {
        let q = -0.6 + 0.02 * f64::from(k);
        let (found, _) = class_of(hill, true, [q, 2.1]);
        let MotionClass::Libration { turning_points } = found else {
            panic!("{found:?} from {q}")
        };
        assert!(turning_points[1] < 1.0, "{turning_points:?} from {q}");
    }
}

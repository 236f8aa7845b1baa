//! Integration of order 8, on equations whose solutions are known.

use dwell_dynamics::integrate::integrate;
use dwell_dynamics::{DynamicsError, Method, OdeState, OdeSystem, Options, StepControl};

/// ẏ = f(t, y) of any size, without a Jacobian.
struct FnSystem<const N: usize, F: Fn(f64, &[f64]) -> Result<[f64; N], DynamicsError>>(F);

impl<const N: usize, F: Fn(f64, &[f64]) -> Result<[f64; N], DynamicsError>> OdeSystem
    for FnSystem<N, F>
{
    fn size(&self) -> usize {
        N
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        out.copy_from_slice(&(self.0)(t, y)?);
        Ok(())
    }

    fn jacobian(&mut self, _: f64, _: &[f64], _: &mut [f64]) -> Result<(), DynamicsError> {
        unreachable!("an explicit method asks for none")
    }
}

fn initial_state(y: &[f64]) -> OdeState {
    OdeState {
        t: 0.0,
        y: y.to_vec(),
    }
}

fn fixed_step(step: f64) -> Options {
    Options {
        max_step: Some(step),
        // So loose that only the longest step counts.
        ..Options::new(Method::Dop853, 1e-3)
    }
}

/// Kepler's ellipse of eccentricity 0.2, which has rates of every kind: at equal steps the error falls as
/// h⁸ at their ends, and as h⁷ at least within them.
#[test]
fn errors_fall_with_the_order() {
    let e = 0.2_f64;
    let orbit = |_: f64, y: &[f64]| {
        let r3 = y[0].hypot(y[1]).powi(3);
        Ok([y[2], y[3], -y[0] / r3, -y[1] / r3])
    };
    // M = E − e sin E, and x = cos E − e.
    let exact = |t: f64| {
        let mut anomaly = t;
        for _ in 0..50 {
            anomaly -= (anomaly - e * anomaly.sin() - t) / (1.0 - e * anomaly.cos());
        }
        anomaly.cos() - e
    };
    let from = initial_state(&[1.0 - e, 0.0, 0.0, ((1.0 + e) / (1.0 - e)).sqrt()]);
    let errors = |parts: f64| {
        let (mut ends, mut inside) = (0.0_f64, 0.0_f64);
        let mut watch = |a: &OdeState, b: &OdeState, dense: dwell_dynamics::DenseOutput<'_>| {
            ends = ends.max((b.y[0] - exact(b.t)).abs());
            for part in [0.2, 0.5, 0.9] {
                let (t, mut y) = (a.t + part * (b.t - a.t), [0.0; 4]);
                dense(t, &mut y)?;
                inside = inside.max((y[0] - exact(t)).abs());
            }
            Ok(StepControl::Continue)
        };
        let options = fixed_step(6.0 / parts);
        let ended = integrate(&mut FnSystem(orbit), &from, Some(6.0), &options, &mut watch);
        assert_eq!(ended.expect("a start").error, None);
        [ends, inside]
    };
    let (coarse, fine) = (errors(24.0), errors(48.0));
    println!("{coarse:?} {fine:?}");
    // Measured: 181 and 184 times; 2⁸ is 256, 2⁷ is 128.
    assert!(coarse[0] / fine[0] > 150.0 && coarse[0] / fine[0] < 600.0);
    assert!(coarse[1] / fine[1] > 100.0 && coarse[1] / fine[1] < 600.0);
}

/// The step control keeps what it is asked for, forwards in time and with time itself in the rates.
#[test]
fn tolerances_are_kept() {
    let swing = |t: f64, y: &[f64]| Ok([y[1], -y[0] + (2.0 * t).cos()]);
    // y = (4 cos t − cos 2t)/3.
    let exact = |t: f64| (4.0 * t.cos() - (2.0 * t).cos()) / 3.0;
    for power in 3..14 {
        let tolerance = 10_f64.powi(-power);
        let options = Options::new(Method::Dop853, tolerance);
        let from = initial_state(&[1.0, 0.0]);
        let mut go_on = |_: &OdeState, _: &OdeState, _: dwell_dynamics::DenseOutput<'_>| {
            Ok(StepControl::Continue)
        };
        let ended = integrate(
            &mut FnSystem(swing),
            &from,
            Some(20.0),
            &options,
            &mut go_on,
        );
        let ended = ended.expect("a start");
        assert_eq!((ended.error.clone(), ended.state.t), (None, 20.0));
        let error = (ended.state.y[0] - exact(20.0)).abs();
        println!("{tolerance:e} {error:e} {:?}", ended.statistics);
        // Measured: 0.15 to 0.5 tolerances in twenty seconds.
        assert!(error < 2.0 * tolerance, "{tolerance:e}: {error:e}");
    }
}

/// ẏ = y² from 1 has no value at t = 1; a wall says itself what it is; a rate that is no number is not a small error.
#[test]
fn what_cannot_go_on_says_why() {
    let options = Options::new(Method::Dop853, 1e-8);
    let run = |system: &mut dyn OdeSystem| {
        let mut go_on = |_: &OdeState, _: &OdeState, _: dwell_dynamics::DenseOutput<'_>| {
            Ok(StepControl::Continue)
        };
        let ended = integrate(
            system,
            &initial_state(&[1.0]),
            Some(2.0),
            &options,
            &mut go_on,
        );
        let ended = ended.expect("a start");
        (ended.state, ended.error)
    };
    let (at, failed) = run(&mut FnSystem(|_, y: &[f64]| Ok([y[0] * y[0]])));
    println!("{:e}", at.t - 1.0);
    assert!((at.t - 1.0).abs() < 1e-6, "{at:?}");
    assert!(matches!(failed, Some(DynamicsError::StepTooSmall { .. })));

    let wall = DynamicsError::NoInertia { q: 1.5, m: 0.0 };
    let messages = wall.clone();
    let (at, failed) = run(&mut FnSystem(move |_, y: &[f64]| {
        if y[0] < 1.5 {
            Ok([1.0])
        } else {
            Err(messages.clone())
        }
    }));
    assert_eq!(failed, Some(wall));
    println!("{:e}", at.y[0] - 1.5);
    assert!((at.y[0] - 1.5).abs() < 1e-9 && at.y[0] < 1.5, "{at:?}");

    let (at, failed) = run(&mut FnSystem(|t, _: &[f64]| {
        Ok([if t < 0.5 { 1.0 } else { f64::NAN }])
    }));
    assert!(matches!(failed, Some(DynamicsError::StepTooSmall { .. })));
    assert!(at.y[0].is_finite() && at.t < 0.5, "{at:?}");
}

/// Twenty thousand steps at a constant rate: without the sum that keeps what rounding loses, the last digits
/// would wander.
#[test]
fn rounding_does_not_add_up() {
    let steps = 20_000.0;
    let mut counted = 0.0;
    let options = fixed_step(1e-3);
    let mut go_on = |_: &OdeState, _: &OdeState, _: dwell_dynamics::DenseOutput<'_>| {
        counted += 1.0;
        Ok(StepControl::Continue)
    };
    let mut even = FnSystem(|_, _: &[f64]| Ok([0.1]));
    let ended = integrate(
        &mut even,
        &initial_state(&[0.0]),
        Some(1e-3 * steps),
        &options,
        &mut go_on,
    );
    let at = ended.expect("a start").state;
    assert!(counted >= steps);
    // Measured: 1.3e-15, of which the weights' own sum has a part. Without what is put back: 6e-13.
    let error = at.y[0] - 0.1 * at.t;
    assert!(error.abs() < 5e-15, "{error:e}");
}

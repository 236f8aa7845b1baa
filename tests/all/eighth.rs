//! Integration of order 8, on equations whose solutions are known.

use dwell_dynamics::driver::integrate;
use dwell_dynamics::{DynamicsError, Method, Next, Options, Point, System};

/// ẏ = f(t, y) of any size, without a Jacobian.
struct By<const N: usize, F: Fn(f64, &[f64]) -> Result<[f64; N], DynamicsError>>(F);

impl<const N: usize, F: Fn(f64, &[f64]) -> Result<[f64; N], DynamicsError>> System for By<N, F> {
    fn size(&self) -> usize {
        N
    }

    fn rates(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        out.copy_from_slice(&(self.0)(t, y)?);
        Ok(())
    }

    fn jacobian(&mut self, _: f64, _: &[f64], _: &mut [f64]) -> Result<(), DynamicsError> {
        unreachable!("an explicit method asks for none")
    }
}

fn start(y: &[f64]) -> Point {
    Point {
        t: 0.0,
        y: y.to_vec(),
    }
}

fn fixed(step: f64) -> Options {
    Options {
        longest: Some(step),
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
    let from = start(&[1.0 - e, 0.0, 0.0, ((1.0 + e) / (1.0 - e)).sqrt()]);
    let errors = |parts: f64| {
        let (mut ends, mut inside) = (0.0_f64, 0.0_f64);
        let mut watch = |a: &Point, b: &Point, dense: dwell_dynamics::Dense<'_>| {
            ends = ends.max((b.y[0] - exact(b.t)).abs());
            for part in [0.2, 0.5, 0.9] {
                let (t, mut y) = (a.t + part * (b.t - a.t), [0.0; 4]);
                dense(t, &mut y)?;
                inside = inside.max((y[0] - exact(t)).abs());
            }
            Ok(Next::GoOn)
        };
        let options = fixed(6.0 / parts);
        let ended = integrate(&mut By(orbit), &from, Some(6.0), &options, &mut watch);
        assert_eq!(ended.expect("a start").failed, None);
        [ends, inside]
    };
    let (coarse, fine) = (errors(24.0), errors(48.0));
    println!("{coarse:?} {fine:?}");
    // Measured: 220 and 170 times; 2⁸ is 256, 2⁷ is 128.
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
        let from = start(&[1.0, 0.0]);
        let mut go_on = |_: &Point, _: &Point, _: dwell_dynamics::Dense<'_>| Ok(Next::GoOn);
        let ended = integrate(&mut By(swing), &from, Some(20.0), &options, &mut go_on);
        let ended = ended.expect("a start");
        assert_eq!((ended.failed.clone(), ended.at.t), (None, 20.0));
        let off = (ended.at.y[0] - exact(20.0)).abs();
        println!("{tolerance:e} {off:e} {:?}", ended.statistics);
        // Measured: 0.2 to 30 tolerances in twenty seconds.
        assert!(off < 100.0 * tolerance, "{tolerance:e}: {off:e}");
    }
}

/// ẏ = y² from 1 has no value at t = 1; a wall says itself what it is; a rate that is no number is not a small error.
#[test]
fn what_cannot_go_on_says_why() {
    let options = Options::new(Method::Dop853, 1e-8);
    let run = |system: &mut dyn System| {
        let mut go_on = |_: &Point, _: &Point, _: dwell_dynamics::Dense<'_>| Ok(Next::GoOn);
        let ended = integrate(system, &start(&[1.0]), Some(2.0), &options, &mut go_on);
        let ended = ended.expect("a start");
        (ended.at, ended.failed)
    };
    let (at, failed) = run(&mut By(|_, y: &[f64]| Ok([y[0] * y[0]])));
    assert!((at.t - 1.0).abs() < 1e-6, "{at:?}");
    assert!(matches!(failed, Some(DynamicsError::SmallStep { .. })));

    let wall = DynamicsError::NoInertia { q: 1.5, m: 0.0 };
    let said = wall.clone();
    let (at, failed) = run(&mut By(move |_, y: &[f64]| {
        if y[0] < 1.5 {
            Ok([1.0])
        } else {
            Err(said.clone())
        }
    }));
    assert_eq!(failed, Some(wall));
    assert!((at.y[0] - 1.5).abs() < 1e-9 && at.y[0] < 1.5, "{at:?}");

    let (at, failed) = run(&mut By(|t, _: &[f64]| {
        Ok([if t < 0.5 { 1.0 } else { f64::NAN }])
    }));
    assert!(matches!(failed, Some(DynamicsError::SmallStep { .. })));
    assert!(at.y[0].is_finite() && at.t < 0.5, "{at:?}");
}

/// Twenty thousand steps at a constant rate: without the sum that keeps what rounding loses, the last digits
/// would wander.
#[test]
fn rounding_does_not_add_up() {
    let steps = 20_000.0;
    let mut counted = 0.0;
    let options = fixed(1e-3);
    let mut go_on = |_: &Point, _: &Point, _: dwell_dynamics::Dense<'_>| {
        counted += 1.0;
        Ok(Next::GoOn)
    };
    let mut even = By(|_, _: &[f64]| Ok([0.1]));
    let ended = integrate(
        &mut even,
        &start(&[0.0]),
        Some(1e-3 * steps),
        &options,
        &mut go_on,
    );
    let at = ended.expect("a start").at;
    assert!(counted >= steps);
    // Measured: 1.3e-15, of which the weights' own sum has a part. Without what is put back: 6e-13.
    let off = at.y[0] - 0.1 * at.t;
    assert!(off.abs() < 5e-15, "{off:e}");
}

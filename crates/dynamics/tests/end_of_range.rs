//! Motions that reach a position beyond which nothing can be evaluated, and motions that only come near it.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

use dwell_dynamics::{
    DynamicsError, Method, OdeState, OdeSystem, Options, StepControl, Termination, integrate,
};

const TOLERANCE: f64 = 1e-9;

/// q̈ = a − k q, which can be evaluated up to a coordinate.
struct Bounded {
    end: f64,
    acceleration: f64,
    stiffness: f64,
}

impl OdeSystem for Bounded {
    fn size(&self) -> usize {
        2
    }

    fn rhs(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        if y[0] > self.end {
            return Err(DynamicsError::NoInertia { q: y[0], m: 0.0 });
        }
        out[0] = y[1];
        out[1] = self.acceleration - self.stiffness * y[0];
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        self.rhs(t, y, &mut [0.0; 2])?;
        out.copy_from_slice(&[0.0, 1.0, -self.stiffness, 0.0]);
        Ok(())
    }
}

fn integrated(of: &mut Bounded, start: &OdeState, until: f64, method: Method) -> Termination {
    let options = Options::new(method, TOLERANCE);
    let mut go_on =
        |_: &OdeState, _: &OdeState, _: dwell_dynamics::DenseOutput<'_>| Ok(StepControl::Continue);
    integrate(of, start, Some(until), &options, &mut go_on).expect("a start")
}

/// All methods come to the end itself, within their tolerance, and stop there, wherever on the axis of time and of the coordinate it is and
/// however fast they come: the closed form of q̈ = a. Seen: at most 8.5e-16 of the coordinate short, 2.0e-11 after 1e4 s, 7.7e-11 late, and 250
/// steps (2 000 000 before).
#[test]
fn motions_stop_at_the_end_of_what_can_be_evaluated() {
    let mut worst = (0.0_f64, 0);
    for method in Method::ALL {
        for (t, from, distance, speed, acceleration) in [
            (0.0, 0.0, 1.0, 1.0, 0.0),
            (0.0, 0.0, 50.0, 1.5, 3700.0),
            (1e4, -3.0, 2.5, 0.7, 0.1),
            // Slowly: steps below the rounding of q pass much time.
            (0.0, 100.0, 1.0, 1e-3, 0.0),
            (2.0, 700.0, 1e-4, 1e-4, 0.0),
            (0.0, -0.2, 0.2, 3.0, -20.0),
        ] {
            let end = from + distance;
            let mut of = Bounded {
                end,
                acceleration,
                stiffness: 0.0,
            };
            let start = OdeState {
                t,
                y: vec![from, speed],
            };
            let root = (speed * speed + 2.0 * acceleration * distance).sqrt();
            let expected = 2.0 * distance / (speed + root);
            let done = integrated(&mut of, &start, t + 3.0 * expected, method);
            let name = method.name();
            assert!(
                matches!(done.error, Some(DynamicsError::NoInertia { q, .. }) if q > end),
                "{name}: {:?}",
                done.error
            );
            let steps = done.statistics.steps;
            assert!(steps < 1000, "{name}: {steps} steps");
            let short = (end - done.state.y[0]) / end.abs().max(1.0);
            let late = (done.state.t - t - expected) * root / end.abs().max(1.0);
            // DOP853 ends where a tenth of a step is below the rounding of time.
            let allowed = 8e-14 + 50.0 * f64::EPSILON * t * root / end.abs().max(1.0);
            assert!(
                (0.0..allowed).contains(&short) && late.abs() < 7.0 * TOLERANCE,
                "{name} from {from} by {distance}: {short:.1e} short, {late:.1e} late"
            );
            worst = (worst.0.max(short), worst.1.max(steps));
        }
    }
    println!("{:.1e} short, {} steps", worst.0, worst.1);
}

/// A motion that reverses just before the end continues: q = A sin t, whose trial steps repeatedly go beyond it.
#[test]
fn motions_that_turn_back_in_front_of_it_go_on() {
    for method in Method::ALL {
        for gap in [1e-3, 1e-5] {
            let mut of = Bounded {
                end: 1.0,
                acceleration: 0.0,
                stiffness: 1.0,
            };
            let start = OdeState {
                t: 0.0,
                y: vec![0.0, 1.0 - gap],
            };
            let until = 40.0;
            let done = integrated(&mut of, &start, until, method);
            let name = method.name();
            assert!(
                done.error.is_none() && done.state.t == until,
                "{name}, gap {gap:e}: {:?} at {}",
                done.error,
                done.state.t
            );
            let off = done.state.y[0] - (1.0 - gap) * until.sin();
            println!("{name} {gap:e}: {off:.1e}, {} steps", done.statistics.steps);
            // After 40 rad; a fifth of the bound and less is seen.
            let allowed = match method {
                Method::Bdf => 1e-6,
                Method::Esdirk34 | Method::TrBdf2 => 2e-5,
                Method::Tsit45 | Method::Dop853 => 3e-8,
            };
            assert!(off.abs() < allowed, "{name}: {off:.1e}");
        }
    }
}

//! m and its derivatives: by two unit runs, by energy and power, by dual numbers, by differences.

use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel};
use dwell_numerics::Dual;
use dwell_tests::cases::CASES;
use dwell_tests::changes::{Setup, positions};

/// Largest step of the differences, rad, and the number of halvings.
const STEP: f64 = 0.08;
const HALVINGS: usize = 6;

/// f′(q) by central differences at steps h, h/2, h/4, …, each column of Richardson's table free of
/// one more even power of h (Richardson 1911); the entry that differs least from the two it was
/// made from (Ridders 1982).
fn richardson(f: impl Fn(f64) -> f64, q: f64, largest: f64) -> f64 {
    let (mut best, mut error_estimate) = (f64::NAN, f64::INFINITY);
    let mut before: Vec<f64> = Vec::new();
    for halvings in 0..HALVINGS {
        let h = largest * 0.5_f64.powi(halvings as i32);
        let mut row = vec![(f(q + h) - f(q - h)) / (2.0 * h)];
        let mut power = 1.0;
        for k in 0..before.len() {
            power *= 4.0;
            let better = row[k] + (row[k] - before[k]) / (power - 1.0);
            let spread = (better - row[k]).abs().max((better - before[k]).abs());
            if spread < error_estimate {
                (best, error_estimate) = (better, spread);
            }
            row.push(better);
        }
        before = row;
    }
    best
}

/// Positions for differences: where the range ends, the steps must stay well inside it.
fn inner(model: &ExactModel) -> Vec<(f64, f64)> {
    let step = |q: f64| match model.range().limits() {
        None => STEP,
        Some((from, to)) => STEP.min(0.3 * (q - from).min(to - q)),
    };
    let at = positions(model.range(), 24);
    at.into_iter().map(|q| (q, step(q))).collect()
}

#[test]
fn val_m_second_by_dual_numbers_is_the_difference_quotient_of_half_m_prime() {
    for case in CASES {
        let model = Setup::of(&case.scene()).model().expect("a model");
        let half_dm = |q: f64| model.inertia(q, &mut model.workspace()).expect("a pose").1;
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for (q, step) in inner(&model) {
            let exact = model
                .inertia_derivatives(q, &mut model.workspace())
                .expect("a pose");
            let (m, half) = model.inertia(q, &mut model.workspace()).expect("a pose");
            let difference = richardson(half_dm, q, step);
            assert!(exact.half_ddm.is_finite() && difference.is_finite());
            largest = largest.max(m).max(exact.half_ddm.abs());
            worst = worst.max((exact.half_ddm - difference).abs());
            // The values that come with the derivative are those of the plain evaluation.
            assert!((exact.m - m).abs() <= 1e-14 * m, "{} at {q}", case.name);
            assert!((exact.half_dm - half).abs() <= 1e-14 * largest);
        }
        println!("{:20} m'' {:8.1e} of {largest:.3e}", case.name, worst);
        assert!(worst < 1e-11 * largest, "{}: {worst:e}", case.name);
    }
}

/// ½m′ is the action of the actuator in a unit run, the other derivative is that of the action in
/// the other run: nothing but the pose is common to both.
#[test]
fn val_half_m_prime_by_the_unit_run_is_the_derivative_of_m() {
    for case in CASES {
        let model = Setup::of(&case.scene()).model().expect("a model");
        let model = model.model();
        let mut workspace = model.workspace::<Dual>();
        let mut at: Coefficients<Dual> = model.coefficient_buffer();
        let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
        for q in positions(model.plan().range(), 48) {
            let q = Dual::variable(q);
            model.reduce(q, &mut workspace, &mut at).expect("a pose");
            assert!(at.m.d.is_finite() && at.half_dm.v.is_finite());
            largest = largest.max(at.m.v);
            worst = worst.max((at.m.d - 2.0 * at.half_dm.v).abs());
        }
        println!("{:20} m'  {:8.1e} of {largest:.3e}", case.name, worst);
        assert!(worst < 1e-12 * largest, "{}: {worst:e}", case.name);
    }
}

/// m by the unit run is twice the kinetic energy at unit speed, ½m′ the power of the inertia forces.
#[test]
fn m_is_twice_the_energy_and_half_m_prime_the_power_of_every_case() {
    for case in CASES {
        let model = Setup::of(&case.scene()).model().expect("a model");
        let model = model.model();
        let (mut workspace, mut at) = (model.workspace::<f64>(), model.coefficient_buffer());
        for q in positions(model.plan().range(), 48) {
            model.reduce(q, &mut workspace, &mut at).expect("a pose");
            let mut state = model
                .kinematic_state(&[q], &[1.0], &mut workspace)
                .expect("a pose");
            let [energy, power] = model.inertia_sums(state.bodies_at(&[0.0]));
            let size = energy.max(power.abs());
            assert!((at.m - energy).abs() < 1e-13 * size, "{}", case.name);
            assert!((at.half_dm - power).abs() < 1e-13 * size, "{}", case.name);
        }
    }
}

//! Laws that hold for every crank-rocker and slider-crank, on random ones: energy and power,
//! similarity, closed forms. A failure is noted in `tests/proptest-regressions`, to be committed.

use crate::machines::random_mechanism;
use dwell_geometry::{Component, Range};
use dwell_kinetostatics::{Coefficients, ExactModel, ReducedModel};
use dwell_tests::changes::Setup;
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use std::f64::consts::{PI, TAU};

fn config() -> ProptestConfig {
    let failures = FileFailurePersistence::Direct("proptest-regressions/scaling.txt");
    ProptestConfig {
        failure_persistence: Some(Box::new(failures)),
        ..ProptestConfig::default()
    }
}

fn reduce(model: &ExactModel, q: f64) -> Coefficients {
    let mut out = model.model().coefficient_buffer();
    let mut workspace = model.workspace();
    model
        .coefficients(q, &mut workspace, &mut out)
        .expect("a pose");
    let all = [out.m, out.half_dm].into_iter();
    let mut all = all.chain(out.a.iter().chain(&out.b).copied());
    assert!(all.all(f64::is_finite), "{out:?}");
    out
}

/// Twelve positions over a turn that starts anywhere.
fn revolution(from: f64) -> impl Iterator<Item = f64> {
    (0..12).map(move |k| from + TAU * f64::from(k) / 12.0)
}

/// A similar mechanism of `by` times the size, the masses being the same.
fn larger(setup: &Setup, factor: f64) -> Setup {
    let mut setup = setup.clone();
    for joint in &mut setup.mechanism.joints {
        joint.points = joint.points.map(|p| p * factor);
    }
    for mass in &mut setup.masses {
        mass.center = mass.center * factor;
        mass.inertia *= factor * factor;
    }
    setup
}

/// The same mechanism with all masses and inertias multiplied.
fn heavier(setup: &Setup, factor: f64) -> Setup {
    let mut setup = setup.clone();
    for mass in &mut setup.masses {
        mass.mass *= factor;
        mass.inertia *= factor;
    }
    setup
}

/// What the coefficients become when forces are multiplied by one factor and all else by another.
fn multiplied(setup: &Setup, c: &Coefficients, forces: f64, rest: f64) -> Vec<f64> {
    let mut all = vec![c.m * rest, c.half_dm * rest];
    for (k, reaction) in setup.mechanism.reactions().iter().enumerate() {
        let factor = match reaction.component {
            Component::Moment => rest,
            _ => forces,
        };
        all.extend([c.a[k] * factor, c.b[k] * factor]);
    }
    all
}

/// Largest difference of two lists, relative to the largest of each kind: m with ½m′ and the
/// couples, and the forces.
fn difference(setup: &Setup, got: &[f64], want: &[f64]) -> f64 {
    let force = |i: usize| i > 1 && reaction_is_force(setup, (i - 2) / 2);
    [true, false].into_iter().fold(0.0, |worst: f64, kind| {
        let of_kind = || (0..want.len()).filter(|&i| force(i) == kind);
        let size = of_kind().fold(0.0_f64, |s, i| s.max(want[i].abs()));
        let gap = of_kind().fold(0.0_f64, |s, i| s.max((got[i] - want[i]).abs()));
        worst.max(gap / size)
    })
}

fn reaction_is_force(setup: &Setup, k: usize) -> bool {
    setup.mechanism.reactions()[k].component != Component::Moment
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn val_m_in_closed_form(machine in random_mechanism(), from in -PI..PI) {
        let model = machine.setup().model().expect("a model");
        prop_assert_eq!(model.range(), Range::Full);
        for phi in revolution(from) {
            let (got, want) = (reduce(&model, phi).m, machine.closed_form(phi));
            prop_assert!((got - want).abs() < 1e-13 * want, "{} {}", got, want);
        }
    }

    #[test]
    fn m_is_twice_the_energy_and_half_m_prime_the_power(machine in random_mechanism(), from in -PI..PI) {
        let model = machine.setup().model().expect("a model");
        let model = model.model();
        let (mut workspace, mut at) = (model.workspace::<f64>(), model.coefficient_buffer());
        for phi in revolution(from) {
            model.reduce(phi, &mut workspace, &mut at).expect("a pose");
            let state = model.kinematic_state(&[phi], &[1.0], &mut workspace);
            let [energy, power] = model.inertia_sums(state.expect("a pose").bodies_at(&[0.0]));
            prop_assert!(at.m > 0.0);
            prop_assert!((at.m - energy).abs() < 1e-13 * energy, "{} {}", at.m, energy);
            prop_assert!((at.half_dm - power).abs() < 1e-13 * energy, "{} {}", at.half_dm, power);
        }
    }

    /// m has period 2π, so the derivative of its trigonometric interpolant converges faster than any
    /// power of the number N of samples. At sample i, with h = 2π/N and N even (Trefethen 2000,
    /// Spectral Methods in MATLAB, eq. 3.9), it is Σ ½ (−1)^(i−j) cot(½(i − j)h) m_j over j ≠ i.
    #[test]
    fn half_m_prime_is_half_the_spectral_derivative_of_m(machine in random_mechanism(), from in -PI..PI) {
        const N: usize = 128;
        let model = machine.setup().model().expect("a model");
        let h = TAU / N as f64;
        let at: Vec<_> = (0..N).map(|i| reduce(&model, from + i as f64 * h)).collect();
        let largest = at.iter().fold(0.0_f64, |s, c| s.max(c.m).max(c.half_dm.abs()));
        let weight: Vec<f64> = (1..N)
            .map(|k| 0.5 * (-1.0_f64).powi(k as i32) / (0.5 * k as f64 * h).tan())
            .collect();
        for i in 0..N {
            let derivative: f64 = (1..N).map(|k| weight[k - 1] * at[(i + N - k) % N].m).sum();
            let gap = (at[i].half_dm - 0.5 * derivative).abs();
            prop_assert!(gap < 1e-12 * largest, "sample {}: {:e} of {:e}", i, gap, largest);
        }
    }

    /// Lengths multiplied by k, masses the same: m, ½m′ and couples by k², forces by k. Masses
    /// multiplied by k: everything by k.
    #[test]
    fn similar_mechanisms(machine in random_mechanism(), k in 0.01..100.0_f64, from in -PI..PI) {
        let setup = machine.setup();
        let model = setup.model().expect("a model");
        let large = larger(&setup, k).model().expect("a model");
        let heavy = heavier(&setup, k).model().expect("a model");
        for phi in revolution(from) {
            let at = reduce(&model, phi);
            for (other, forces, rest) in [(&large, k, k * k), (&heavy, k, k)] {
                let want = multiplied(&setup, &at, forces, rest);
                let got = multiplied(&setup, &reduce(other, phi), 1.0, 1.0);
                let gap = difference(&setup, &got, &want);
                prop_assert!(gap < 1e-13, "{:e}", gap);
            }
        }
    }

    /// A power of two changes exponents only, in every product, sum, quotient and square root of
    /// quantities that have a unit: the digits are the same to the last bit.
    #[test]
    fn powers_of_two_keep_every_bit(machine in random_mechanism(), power in -20..20_i32, from in -PI..PI) {
        let k = 2.0_f64.powi(power);
        let setup = machine.setup();
        let model = setup.model().expect("a model");
        let large = larger(&setup, k).model().expect("a model");
        let heavy = heavier(&setup, k).model().expect("a model");
        for phi in revolution(from) {
            let at = reduce(&model, phi);
            for (other, forces, rest) in [(&large, k, k * k), (&heavy, k, k)] {
                let want = multiplied(&setup, &at, forces, rest);
                let got = multiplied(&setup, &reduce(other, phi), 1.0, 1.0);
                prop_assert_eq!(bits(&got), bits(&want));
            }
        }
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

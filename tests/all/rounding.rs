//! Numbers of 32 digits and of 7: what rounding does, and that nothing plain is left in what judges it.

use dwell_kinetostatics::{Model, Workspace};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::{case_names, scene};

/// The cases of one actuator whose relations have no laws: those are evaluated in plain numbers.
fn models() -> Vec<(String, Model, Vec<f64>)> {
    let model = |name: String| {
        let scene: PlaneScene = scene(&name);
        let start = scene.assembly.to_configuration();
        let reactions = scene.mechanism.reactions();
        let model =
            Model::new(&scene.mechanism, &scene.masses, &start, &reactions).expect("a model");
        let range = match model.plan().range().limits() {
            Some((from, to)) => [from + 0.1 * (to - from), to - 0.1 * (to - from)],
            None => [start.q[0], start.q[0] + 6.0],
        };
        let at = |k: usize| range[0] + (range[1] - range[0]) * k as f64 / 7.0;
        (name, model, (0..8).map(at).collect::<Vec<f64>>())
    };
    let plain = case_names().into_iter().filter(|name| name != "cam");
    let all = plain.map(model);
    all.filter(|(_, model, _)| model.plan().actuators() == 1)
        .collect()
}

fn inertia(
    model: &Model,
    q: DoubleDouble,
    workspace: &mut Workspace<DoubleDouble>,
) -> [DoubleDouble; 2] {
    let mut at = model.coefficient_buffer();
    model.reduce(q, workspace, &mut at).expect("a pose");
    [at.m, at.half_dm]
}

/// ½m′ is half the slope of m: by differences over 1e-3 and its halves, extrapolated five times, it is known
/// to h¹² and 1e-32/h. A plain number anywhere on the way would leave 1e-16.
#[test]
fn val_wide_inertia_has_its_derivative_to_twenty_three_digits() {
    let mut compared = 0;
    for (name, model, positions) in models() {
        let mut workspace = model.workspace();
        for &q in &positions {
            let [_, half_dm] = inertia(&model, DoubleDouble::from_f64(q), &mut workspace);
            let mut table: Vec<DoubleDouble> = Vec::new();
            for level in 0..6 {
                let h = DoubleDouble::from_f64(1e-3 / f64::from(1 << level));
                let [ahead, behind] = [h, -h]
                    .map(|h| inertia(&model, DoubleDouble::from_f64(q) + h, &mut workspace)[0]);
                let mut slope = (ahead - behind) / (DoubleDouble::from_f64(4.0) * h);
                for (k, entry) in table.iter_mut().enumerate() {
                    let gain = DoubleDouble::from_f64(4_f64.powi(k as i32 + 1));
                    let better = slope + (slope - *entry) / (gain - DoubleDouble::from_f64(1.0));
                    (*entry, slope) = (slope, better);
                }
                table.push(slope);
            }
            let difference = (table[5] - half_dm).abs().value();
            let [m, _] = inertia(&model, DoubleDouble::from_f64(q), &mut workspace);
            // Of a mechanism that is steep the twelfth derivative is large.
            assert!(
                difference <= 1e-23 * (m.value() + half_dm.value().abs()),
                "{name} at {q}: {difference:e}"
            );
            compared += 1;
        }
    }
    assert!(compared > 150, "{compared}");
}

/// Short and plain numbers lose the same digits: what is lost belongs to the mechanism.
#[test]
fn short_and_plain_numbers_lose_alike() {
    let difference =
        |value: f64, wide: DoubleDouble| (DoubleDouble::from_f64(value) - wide).abs().value();
    for (name, model, positions) in models() {
        let (mut short, mut plain, mut wide) = (
            model.workspace::<f32>(),
            model.workspace(),
            model.workspace(),
        );
        let (mut s, mut p, mut w) = (
            model.coefficient_buffer::<f32>(),
            model.coefficient_buffer(),
            model.coefficient_buffer(),
        );
        let [mut by_short, mut by_plain, mut m] = [0.0_f64; 3];
        for &q in &positions {
            // The coordinate as the short number has it.
            let q = q as f32;
            model.reduce(q, &mut short, &mut s).expect("a pose");
            model
                .reduce(f64::from(q), &mut plain, &mut p)
                .expect("a pose");
            model
                .reduce(DoubleDouble::from_f64(f64::from(q)), &mut wide, &mut w)
                .expect("a pose");
            by_short = by_short.max(difference(f64::from(s.m), w.m));
            by_plain = by_plain.max(difference(p.m, w.m));
            m = m.max(w.m.value());
        }
        // 155 places are the most that are lost, on the three cranks, one of which is too many.
        let precisions = [
            (by_short, f64::from(f32::EPSILON)),
            (by_plain, f64::EPSILON),
        ];
        for (difference, precision) in precisions {
            assert!(
                difference <= 1000.0 * precision * m,
                "{name}: {:e}",
                difference / m
            );
        }
    }
}

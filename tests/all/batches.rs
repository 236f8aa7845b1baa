//! Many coordinates at once: lanes, blocks and threads change no bit.

use dwell_geometry::PositionError;
use dwell_kinetostatics::{Batch, Coefficients, ExactModel, ReducedModel};
use dwell_numerics::Lanes;
use dwell_tests::cases::CASES;
use dwell_tests::changes::{Rng, Setup, positions};
use dwell_tests::fixtures::{case_names, scene};

/// Holds a batch against single evaluations, bit for bit, and gives the part of its fours that go together.
// Long: one comparison for each output of a batch.
pub(crate) fn compare_batch(model: &ExactModel, q: &[f64]) -> Result<f64, String> {
    let mut batch = Batch::default();
    model.reduce_batch(q, &mut batch);
    let (mut workspace, mut out) = (model.workspace(), model.model().coefficient_buffer());
    let reactions = model.reactions();
    let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    let mut errors = Vec::new();
    for (i, &q) in q.iter().enumerate() {
        let [a, b] = [&batch.a, &batch.b].map(|all| &all[i * reactions..][..reactions]);
        if let Err(error) = model.coefficients(q, &mut workspace, &mut out) {
            errors.push((i, error));
            let nothing = a.iter().chain(b).all(|v| v.is_nan());
            if !nothing || !batch.m[i].is_nan() || !batch.half_dm[i].is_nan() {
                return Err(format!("a value at {q}, where there is no pose"));
            }
            continue;
        }
        for (one, all) in [
            (&[out.m][..], &batch.m[i..=i]),
            (&[out.half_dm], &batch.half_dm[i..=i]),
            (&out.a, a),
            (&out.b, b),
        ] {
            if bits(one) != bits(all) {
                return Err(format!("{one:?} alone and {all:?} in the batch at {q}"));
            }
        }
    }
    // A NaN is not equal to itself.
    if format!("{errors:?}") != format!("{:?}", batch.errors) {
        return Err(format!(
            "errors {errors:?}, in the batch {:?}",
            batch.errors
        ));
    }
    // What goes together, and lanes without the registers of this processor.
    let (mut lanes, mut several) = (
        model.model().workspace(),
        model.model().coefficient_buffer(),
    );
    let (fours, _) = q.as_chunks::<4>();
    let mut together = 0;
    for (i, four) in fours.iter().enumerate() {
        let done = model.model().reduce(Lanes(*four), &mut lanes, &mut several);
        if done.is_err() {
            continue;
        }
        together += 1;
        let [m, half_dm] = [&batch.m, &batch.half_dm].map(|all| &all[4 * i..][..4]);
        let mut pairs = vec![
            (several.m.0.to_vec(), m.to_vec()),
            (several.half_dm.0.to_vec(), half_dm.to_vec()),
        ];
        for (several, all) in [(&several.a, &batch.a), (&several.b, &batch.b)] {
            for (k, value) in several.iter().enumerate() {
                let all = (0..4).map(|lane| all[(4 * i + lane) * reactions + k]);
                pairs.push((value.0.to_vec(), all.collect()));
            }
        }
        for (several, all) in pairs {
            if bits(&several) != bits(&all) {
                return Err(format!("{several:?} in lanes and {all:?} in the batch"));
            }
        }
    }
    Ok(f64::from(together) / fours.len().max(1) as f64)
}

/// The reduced models of every case of one actuator.
fn models() -> Vec<(String, ExactModel)> {
    let read = case_names().into_iter().map(|case| scene(&case));
    let scenes = CASES.iter().map(|case| case.scene()).chain(read);
    scenes
        .filter(|scene| scene.mechanism.actuators.len() == 1)
        .map(|scene| {
            (
                scene.name.clone(),
                Setup::of(&scene).model().expect("a model"),
            )
        })
        .collect()
}

#[test]
fn a_batch_has_the_bits_of_single_evaluations() {
    let mut fractions = Vec::new();
    for (name, model) in models() {
        // In order, in no order, and an odd number that leaves lanes over.
        let mut q = positions(model.range(), 90);
        let shuffled: Vec<f64> = Rng(5).order(q.len()).into_iter().map(|i| q[i]).collect();
        q.extend(shuffled);
        q.push(q[1]);
        let together = compare_batch(&model, &q).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(
            together == 0.0 || together == 1.0,
            "{name}: {together} of its fours"
        );
        assert_eq!(
            together == 1.0,
            model.model().plan().supports_lanes(),
            "{name}"
        );
        if together == 0.0 {
            fractions.push(name);
        }
    }
    fractions.sort();
    fractions.dedup();
    // Placed by Newton's method; with a law, by least squares, or with counted turns.
    let newton = ["class-three-six-bar", "stephenson-six-bar"];
    let others = ["cam", "parallelogram-three-cranks", "planetary"];
    let mut expected = [&newton[..], &others].concat();
    expected.sort_unstable();
    assert_eq!(fractions, expected);
}

#[test]
fn where_one_lane_has_no_pose_the_others_have_theirs() {
    let mut limited = 0;
    for (name, model) in models() {
        let (from, to) = match model.range().limits() {
            Some((from, to)) => (from, to),
            None => (model.model().plan().assembly_coordinates()[0], f64::NAN),
        };
        limited += usize::from(to.is_finite());
        let inside = from + 1e-3 * if to.is_nan() { 1.0 } else { to - from };
        for lane in 0..4 {
            for outside in [f64::NAN, f64::INFINITY, to + 1e-3, from - 1e-3] {
                let mut q = [inside; 11];
                q[4 + lane] = outside;
                compare_batch(&model, &q).unwrap_or_else(|e| panic!("{name}: {e}"));
            }
        }
    }
    assert!(limited > 3, "{limited} cases have a limited range");
}

#[test]
fn blocks_and_what_a_batch_held_before_do_not_matter() {
    for name in ["single-dwell", "class-three-six-bar"] {
        let case = CASES.iter().find(|case| case.name == name).expect("a case");
        let model = Setup::of(&case.scene()).model().expect("a model");
        let some = positions(model.range(), 24);
        let many: Vec<f64> = some.iter().copied().cycle().take(5000).collect();
        let (mut once, mut again) = (Batch::default(), Batch::default());
        model.reduce_batch(&some, &mut once);
        model.reduce_batch(&many, &mut again);
        for (i, m) in again.m.iter().enumerate() {
            assert_eq!(
                m.to_bits(),
                once.m[i % some.len()].to_bits(),
                "{name} at {i}"
            );
        }
        let mut wrong = many;
        wrong[4097] = f64::NAN;
        wrong[1] = f64::NAN;
        model.reduce_batch(&wrong, &mut again);
        let places: Vec<usize> = again.errors.iter().map(|(i, _)| *i).collect();
        assert_eq!(places, [1, 4097]);
        model.reduce_batch(&some, &mut again);
        assert_eq!(again, once);
        model.reduce_batch(&[], &mut again);
        assert_eq!(again, Batch::default());
    }
}

#[test]
fn numbers_side_by_side_are_refused_where_groups_part() {
    let case = CASES.iter().find(|case| case.largest > 2).expect("a case");
    let model = Setup::of(&case.scene()).model().expect("a model");
    let start = model.model().plan().assembly_coordinates()[0];
    let mut workspace = model.model().workspace::<Lanes<2>>();
    let mut out: Coefficients<Lanes<2>> = model.model().coefficient_buffer();
    let refused = model
        .model()
        .reduce(Lanes([start; 2]), &mut workspace, &mut out);
    assert_eq!(refused, Err(PositionError::LanesDiverge { q: start }));
}

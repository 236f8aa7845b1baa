//! A pose depends on its coordinate alone: the same bits come out whatever was evaluated before,
//! in whatever memory and in whatever thread.

use dwell_geometry::{Pose, Vec2};
use dwell_kinetostatics::{Coefficients, ExactModel, ExactWorkspace, ReducedModel};
use dwell_tests::cases::{CASES, Case};
use dwell_tests::changes::{Rng, Setup, positions};
use std::f64::consts::TAU;

/// Everything a position yields, bit for bit.
type Bits = Vec<u64>;

/// One thread's memory.
struct ThreadWorkspace {
    pose: Pose<f64>,
    workspace: ExactWorkspace,
    coefficients: Coefficients,
}

impl ThreadWorkspace {
    fn new(model: &ExactModel) -> Self {
        Self {
            pose: model.model().plan().pose(),
            workspace: model.workspace(),
            coefficients: model.model().coefficient_buffer(),
        }
    }

    /// Evaluates a position; none where it is refused.
    fn evaluate(&mut self, model: &ExactModel, q: f64) -> Option<Bits> {
        let Self {
            pose,
            workspace,
            coefficients,
        } = self;
        let positions = model.model().plan().positions(&[q], pose);
        let curvature = model.inertia_derivatives(q, workspace);
        let inertia = model.inertia(q, workspace);
        let reduced = model.coefficients(q, workspace, coefficients);
        let ((), curvature, inertia, ()) = (
            positions.ok()?,
            curvature.ok()?,
            inertia.ok()?,
            reduced.ok()?,
        );
        let mut numbers = vec![curvature.m, curvature.half_dm, curvature.half_ddm];
        numbers.extend([inertia.0, inertia.1, coefficients.m, coefficients.half_dm]);
        for list in [
            &coefficients.a,
            &coefficients.b,
            &pose.q,
            &pose.slide_travel,
            &pose.closure_travel,
        ] {
            numbers.extend(list);
        }
        numbers.extend(
            pose.rotation
                .iter()
                .chain(&pose.vector)
                .flat_map(|v| [v.x, v.y]),
        );
        Some(numbers.into_iter().map(f64::to_bits).collect())
    }
}

/// A case's model, positions, and what each yields in fresh memory.
fn reference(case: Case) -> (ExactModel, Vec<f64>, Vec<Bits>) {
    let model = Setup::of(&case.scene()).model().expect("a model");
    let at = positions(model.range(), 24);
    let fresh = |&q: &f64| {
        ThreadWorkspace::new(&model)
            .evaluate(&model, q)
            .expect("a pose")
    };
    let bits = at.iter().map(fresh).collect();
    (model, at, bits)
}

#[test]
fn the_order_of_evaluation_does_not_matter() {
    for case in CASES {
        let (model, at, bits) = reference(case);
        let mut workspace = ThreadWorkspace::new(&model);
        for k in 1..at.len() {
            for i in [0, k, 0] {
                assert_eq!(workspace.evaluate(&model, at[i]).as_ref(), Some(&bits[i]));
            }
        }
        for seed in 1..8 {
            for i in Rng(seed).order(at.len()) {
                assert_eq!(workspace.evaluate(&model, at[i]).as_ref(), Some(&bits[i]));
            }
        }
    }
}

#[test]
fn what_the_memory_holds_does_not_matter() {
    for case in CASES {
        let (model, at, bits) = reference(case);
        let mut workspace = ThreadWorkspace::new(&model);
        for (i, &q) in at.iter().enumerate() {
            // Refused positions leave something half done behind; so does a pose of nonsense.
            for refused in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                assert_eq!(workspace.evaluate(&model, refused), None, "{}", case.name);
            }
            if let Some((from, to)) = model.range().limits() {
                let outside = 0.5 * (to + from + TAU);
                assert_eq!(workspace.evaluate(&model, outside), None, "{}", case.name);
            }
            spoil(&mut workspace.pose);
            assert_eq!(workspace.evaluate(&model, q).as_ref(), Some(&bits[i]));
        }
    }
}

#[test]
fn threads_share_a_model() {
    for case in CASES {
        let (model, at, bits) = reference(case);
        let run = |seed| {
            let mut workspace = ThreadWorkspace::new(&model);
            for round in 0..20_u64 {
                for i in Rng(seed + round).order(at.len()) {
                    assert_eq!(workspace.evaluate(&model, at[i]).as_ref(), Some(&bits[i]));
                }
            }
        };
        std::thread::scope(|scope| {
            for seed in [100, 200] {
                scope.spawn(move || run(seed));
            }
        });
    }
}

#[test]
fn a_model_made_again_is_the_same() {
    for case in CASES {
        let (model, at, bits) = reference(case);
        let (rebuilt, _, _) = reference(case);
        assert_eq!(model.model(), rebuilt.model());
        let mut workspace = ThreadWorkspace::new(&model);
        for (q, bits) in at.iter().zip(&bits) {
            assert_eq!(workspace.evaluate(&rebuilt, *q).as_ref(), Some(bits));
        }
    }
}

/// Fills a pose with numbers that no position has, but for the ground, which never turns.
fn spoil(pose: &mut Pose<f64>) {
    for rotation in &mut pose.rotation[1..] {
        *rotation = Vec2 { x: 7.0, y: -3.0 };
    }
    pose.slide_travel.fill(55.0);
    pose.q.fill(0.5);
}

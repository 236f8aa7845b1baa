//! Limit positions, where a branch of the assembly ends, and dead points, where no motion can start.

use crate::refusals::refusal;
use dwell_geometry::{AssemblyError, PositionError, vec2};
use dwell_kinetostatics::ReducedModel;
use dwell_tests::changes::{Setup, positions};
use dwell_tests::fixtures::scene;
use dwell_tests::sketch::{FourBar, Sketch, slider_crank};
use std::f64::consts::TAU;

/// Towards a limit position m grows as 1/(distance), because the velocity ratios grow as one over
/// the distance's root. The class III mechanism evaluates up to the very end; beyond it, it refuses.
#[test]
fn val_the_inertia_near_a_limit_position_and_the_refusal_beyond_it() {
    let model = Setup::of(&scene("class-three-six-bar"))
        .model()
        .expect("a model");
    let Some((from, to)) = model.range().limits() else {
        panic!("{:?}", model.range());
    };
    let mut workspace = model.workspace();
    for (end, inwards) in [(from, 1.0), (to, -1.0)] {
        let mut times_distance = |distance: f64| {
            let q = end + inwards * distance;
            distance * model.inertia(q, &mut workspace).expect("a pose").0
        };
        let limit = times_distance(1e-7);
        // The end is found to some 1e-13 rad: 1e-11 rad away from it, that is a per cent or so.
        for (distance, tolerance) in [(1e-8, 1e-3), (1e-9, 2e-3), (1e-10, 0.01), (1e-11, 0.1)] {
            let value = times_distance(distance);
            assert!(
                (value / limit - 1.0).abs() < tolerance,
                "{distance:e}: {value}"
            );
        }
        assert!(model.inertia(end, &mut workspace).is_ok());
        // Outside the range, as far as the other end seen after a whole turn.
        let gap = from + TAU - to;
        for outside in [1e-12, 1e-6, 0.1, 0.5 * gap, gap - 1e-12] {
            let q = end - inwards * outside;
            let error = model.inertia(q, &mut workspace).unwrap_err();
            assert_eq!(error, PositionError::OutOfRange { q, from, to });
        }
    }
    // Whole turns away the pose is the same.
    let mut inertia = |q: f64| model.inertia(q, &mut workspace).expect("a pose");
    for q in positions(model.range(), 12) {
        let (m, half_dm) = inertia(q);
        for revolutions in [-2.0, 1.0, 7.0] {
            let (there, slope) = inertia(q + revolutions * TAU);
            assert!(
                (there - m).abs() < 1e-12 * m,
                "{q} {revolutions}: {there} {m}"
            );
            assert!((slope - half_dm).abs() < 1e-12 * m.max(half_dm.abs()));
        }
    }
}

/// The crank of a four-bar stops where coupler and rocker are stretched (+) or folded (−) in one
/// line, at the distance |b ± c| from B to D:
///
/// ```text
/// cos φ = (a² + d² − (b ± c)²)/(2 a d)
/// ```
///
/// In a triple rocker (shortest and longest bar are longer than the other two together) both ends
/// are of one kind; in a double rocker there is one of each.
#[test]
fn val_limit_positions_of_triple_and_double_rockers() {
    let end = |[a, b, c, d]: [f64; 4], sign: f64| {
        let stretched_length = b + sign * c;
        ((a * a + d * d - stretched_length * stretched_length) / (2.0 * a * d)).acos()
    };
    let stretched = [2.0, 1.5, 1.6, 4.0];
    let folded = [2.0, 5.2, 2.5, 3.0];
    let double = [3.0, 1.0, 2.5, 3.2];
    for (lengths, low, high, start) in [
        (stretched, -end(stretched, 1.0), end(stretched, 1.0), 0.1),
        (folded, end(folded, -1.0), TAU - end(folded, -1.0), 2.0),
        (double, end(double, -1.0), end(double, 1.0), 0.8),
    ] {
        let bars = FourBar::actuated(lengths);
        for guess in [1.0, -1.0] {
            let model = bars.setup(start, guess).model().expect("a model");
            let Some((from, to)) = model.range().limits() else {
                panic!("{lengths:?}: {:?}", model.range());
            };
            // Found by steps down to 2e-14 (1 + |φ|), each up to half of what is left.
            assert!((from - low).abs() < 1e-12, "{lengths:?}: {from} {low}");
            assert!((to - high).abs() < 1e-12, "{lengths:?}: {to} {high}");
            for q in [low - 1e-9, high + 1e-9] {
                let error = model.inertia(q, &mut model.workspace()).unwrap_err();
                assert_eq!(error, PositionError::OutOfRange { q, from, to });
            }
        }
    }
}

/// A crank-rocker driven at its rocker, which is held at the end of its swing: there crank and
/// coupler lie in one line from (0, 0) to C = (3, 4), and the rocker does not tell the crank where
/// to turn. All the numbers are exact (3² + 4² = (1 + 4)²).
#[test]
fn a_dead_point_is_no_start() {
    let bars = |base: [f64; 2]| {
        let mut bars = FourBar::new([1.0, 4.0, 2.0, 0.0]);
        bars.sketch.mechanism.joints[3].points[0] = vec2(base[0], base[1]);
        bars.sketch.actuate("psi", [Sketch::GROUND, bars.rocker]);
        bars
    };
    let dead = bars([1.0, 4.0]);
    let want = AssemblyError::SingularAssembly {
        bodies: vec![dead.crank, dead.coupler],
        joints: vec![dead.c],
    };
    assert_eq!(refusal(&dead.sketch.setup(&[0.0])), want);
    assert_eq!(refusal(&dead.setup(0.0, 0.9)), want);
    // A hair inside, the two assemblies are one to a thousandth of a degree; a hair outside there
    // is none.
    let inside = bars([1.0 - 1e-12, 4.0]).setup(0.0, 0.9);
    assert!(matches!(refusal(&inside), AssemblyError::Ambiguous { .. }));
    let outside = bars([1.0 + 1e-12, 4.0]).setup(0.0, 0.9);
    assert!(matches!(
        refusal(&outside),
        AssemblyError::NoAssembly { .. }
    ));
    // The rod of a slider-crank across its guide is the same thing.
    let (sketch, rod) = slider_crank(1.0, 1.0);
    let error = refusal(&sketch.setup(&[0.0]));
    assert!(matches!(error, AssemblyError::SingularAssembly { bodies, .. } if bodies == [rod]));
}

//! Class III groups stay on the branch of their assembly over the whole range: every pose is
//! compared with one that was reached by following the bars from the start in very small steps.

use dwell_geometry::{BodyId, PositionError, Range, Vec2, vec2};
use dwell_kinetostatics::ReducedModel;
use dwell_tests::changes::{Setup, direction};
use dwell_tests::sketch::Sketch;
use std::f64::consts::TAU;

/// A Stephenson III six-bar like the one in `validation/`, driven by the angle of the floating
/// link E F: A at the origin, D on the x axis, E beside the coupler B C.
#[derive(Debug, Clone, Copy)]
struct SixBar {
    crank: f64,
    coupler: f64,
    rocker: f64,
    link5: f64,
    link6: f64,
    d: f64,
    e: [f64; 2],
    g: [f64; 2],
    start: f64,
}

/// Angles of crank, coupler, rocker and link 6, rad.
type Angles = [f64; 4];
const INITIAL_GUESS: Angles = [2.7, 0.6, 1.8, -2.4];
/// Step in which the bars are followed, rad.
const STEP: f64 = 2e-5;

impl SixBar {
    fn setup(&self) -> Setup {
        let mut sketch = Sketch::new();
        let [crank, coupler, rocker, link6] =
            ["crank", "coupler", "rocker", "link6"].map(|name| sketch.body(name));
        let link5 = sketch.body("link5");
        let (ground, o) = (Sketch::GROUND, [0.0, 0.0]);
        sketch.revolute("A", (ground, o), (crank, o));
        sketch.revolute("B", (crank, [self.crank, 0.0]), (coupler, o));
        sketch.revolute(
            "C",
            (coupler, [self.coupler, 0.0]),
            (rocker, [self.rocker, 0.0]),
        );
        sketch.revolute("D", (ground, [self.d, 0.0]), (rocker, o));
        sketch.revolute("E", (coupler, self.e), (link5, o));
        sketch.revolute("F", (link5, [self.link5, 0.0]), (link6, [self.link6, 0.0]));
        sketch.revolute("G", (ground, self.g), (link6, o));
        sketch.actuate("q", [ground, link5]);
        let mut setup = sketch.setup(&[self.start]);
        setup.assembly.initial_guess[1..5].copy_from_slice(&INITIAL_GUESS.map(Some));
        setup
    }

    /// The loops A B C D and A B E F G, and their derivatives with the four angles.
    fn loop_closures(&self, q: f64, x: &Angles) -> ([f64; 4], [[f64; 4]; 4]) {
        let [crank, coupler, rocker, link6] = x.map(Vec2::from_angle);
        let b = crank * self.crank;
        let c = coupler * self.coupler;
        let to_c = rocker * self.rocker;
        let e = vec2(self.e[0], self.e[1]).rotate(coupler);
        let to_f = link6 * self.link6;
        let one = b + c - to_c - vec2(self.d, 0.0);
        let two = b + e + Vec2::from_angle(q) * self.link5 - to_f - vec2(self.g[0], self.g[1]);
        let columns = [
            [b.perp(), b.perp()],
            [c.perp(), e.perp()],
            [-to_c.perp(), Vec2::ZERO],
            [Vec2::ZERO, -to_f.perp()],
        ];
        let row = |pick: &dyn Fn(&[Vec2; 2]) -> f64| columns.each_ref().map(pick);
        let jacobian = [
            row(&|c| c[0].x),
            row(&|c| c[0].y),
            row(&|c| c[1].x),
            row(&|c| c[1].y),
        ];
        ([one.x, one.y, two.x, two.y], jacobian)
    }

    /// Newton's method from a pose close by.
    fn solve_closure(&self, q: f64, mut x: Angles) -> Angles {
        for _ in 0..20 {
            let (residual, jacobian) = self.loop_closures(q, &x);
            let step = solve(jacobian, residual);
            for (angle, step) in x.iter_mut().zip(step) {
                *angle -= step;
            }
            if step.iter().all(|s| s.abs() < 1e-13) {
                break;
            }
        }
        x
    }

    /// The four angles at coordinates that lie in order, followed from the start in small steps.
    fn continue_branch(&self, at: impl Iterator<Item = f64>) -> Vec<(f64, Angles)> {
        let (mut q, mut x) = (self.start, self.solve_closure(self.start, INITIAL_GUESS));
        let follow = |to: f64| {
            let steps = ((to - q).abs() / STEP).ceil().max(1.0);
            for k in 1..=steps as u32 {
                x = self.solve_closure(q + (to - q) * f64::from(k) / steps, x);
            }
            q = to;
            (to, x)
        };
        at.map(follow).collect()
    }

    /// How many of 4000 positions inside the range are refused, and how many are elsewhere than the
    /// bars, followed from the start, are.
    fn refused_and_elsewhere(&self) -> (usize, usize) {
        let setup = self.setup();
        let model = setup.model().expect("a model");
        let plan = model.model().plan();
        let Some((from, to)) = model.range().limits() else {
            panic!("{:?}", model.range());
        };
        let mut pose = plan.pose();
        let (mut refused, mut elsewhere) = (0, 0);
        for end in [from, to] {
            let inside = |k: u32| self.start + (end - self.start) * f64::from(k) / 2001.0;
            for (q, angles) in self.continue_branch((1..=2000).map(inside)) {
                if plan.positions(&[q], &mut pose).is_err() {
                    refused += 1;
                    continue;
                }
                let away = |(i, angle): (usize, &f64)| {
                    let found = direction(plan, &pose, BodyId(i + 1));
                    (found - Vec2::from_angle(*angle)).norm() > 1e-9
                };
                elsewhere += usize::from(angles.iter().enumerate().any(away));
            }
        }
        (refused, elsewhere)
    }
}

/// Solves A x = b by elimination with row exchanges.
fn solve(mut a: [[f64; 4]; 4], mut b: [f64; 4]) -> [f64; 4] {
    for k in 0..4 {
        let best = (k..4).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()));
        let best = best.unwrap_or(k);
        a.swap(k, best);
        b.swap(k, best);
        for i in k + 1..4 {
            let ratio = a[i][k] / a[k][k];
            let pivot = a[k];
            for (entry, above) in a[i].iter_mut().zip(pivot) {
                *entry -= ratio * above;
            }
            b[i] -= ratio * b[k];
        }
    }
    for k in (0..4).rev() {
        let solution: f64 = (k + 1..4).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - solution) / a[k][k];
    }
    b
}

/// The mechanism of `validation/class-three-six-bar`.
const WELL_CONDITIONED: SixBar = SixBar {
    crank: 0.25,
    coupler: 0.6,
    rocker: 0.45,
    link5: 0.35,
    link6: 0.55,
    d: 0.4,
    e: [0.15, 0.25],
    g: [0.45, 0.6],
    start: -0.6,
};

#[test]
fn val_the_class_three_six_bar_stays_on_its_branch() {
    assert_eq!(WELL_CONDITIONED.refused_and_elsewhere(), (0, 0));
}

/// At q = 0.83, far from both ends of its range of −1.46 to 1.53, this one is nearly singular.
#[test]
fn a_nearly_singular_six_bar_stays_on_its_branch() {
    let bars = SixBar {
        crank: 0.22,
        coupler: 0.39,
        rocker: 0.46,
        link5: 0.45,
        link6: 0.46,
        d: 0.32,
        e: [0.18, 0.3],
        g: [0.35, 0.47],
        start: -1.4,
    };
    assert_eq!(bars.refused_and_elsewhere(), (0, 0));
}

/// The same up to its upper end of 0.4614, with the limit position alone.
#[test]
fn a_six_bar_stays_on_its_branch_up_to_the_limit_position() {
    let bars = SixBar {
        crank: 0.27,
        coupler: 0.5,
        rocker: 0.67,
        link5: 0.51,
        link6: 0.42,
        d: 0.35,
        e: [0.22, 0.37],
        g: [0.29, 0.39],
        start: -0.9,
    };
    assert_eq!(bars.refused_and_elsewhere(), (0, 0));
}

/// This one turns back by more than a whole turn, and is elsewhere after it, while forward it meets
/// a limit position.
const MORE_THAN_A_TURN: SixBar = SixBar {
    crank: 0.28,
    coupler: 0.8,
    rocker: 0.61,
    link5: 0.41,
    link6: 0.59,
    d: 0.31,
    e: [0.21, 0.35],
    g: [0.23, 0.3],
    start: -0.7,
};

#[test]
fn a_branch_that_does_not_close_is_the_same_from_behind() {
    let bars = MORE_THAN_A_TURN;
    let (seen, from_behind) = (bars.setup(), bars.setup().mirrored());
    match (seen.model(), from_behind.model()) {
        (Ok(one), Ok(two)) => {
            let (Range::Limited(a, b), Range::Limited(c, d)) =
                (from_behind.range(one.range()), two.range())
            else {
                panic!("{:?} {:?}", one.range(), two.range());
            };
            assert!((a - c).abs() + (b - d).abs() < 1e-9, "{a} {b}, {c} {d}");
        }
        (Err(_), Err(_)) => {}
        (one, two) => panic!("{:?}\n{:?}", one.map(|m| m.range()), two.map(|m| m.range())),
    }
}

/// Over more than a turn, whole turns away is another pose: beyond a limit position there is none.
#[test]
fn a_coordinate_beyond_a_range_of_more_than_a_turn_is_refused() {
    let model = MORE_THAN_A_TURN.setup().model().expect("a model");
    let Some((from, to)) = model.range().limits() else {
        panic!("{:?}", model.range());
    };
    assert!(to - from > TAU, "{from} {to}");
    assert_eq!(MORE_THAN_A_TURN.refused_and_elsewhere(), (0, 0));
    for q in [from - 0.01, to + 0.01, to + TAU] {
        let error = model.inertia(q, &mut model.workspace()).unwrap_err();
        assert_eq!(error, PositionError::OutOfRange { q, from, to });
    }
}

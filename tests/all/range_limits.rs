//! Where every kind of group ends: limit positions against closed forms, or against Newton's method
//! on the closing conditions together with their determinant.

use dwell_geometry::{BodyId, Coordinate, Coupling, JointKind, Plan, Range, Vec2, vec2};
use dwell_laws::{Law, Polynomial};
use dwell_tests::sketch::{FourBar, Sketch, slider_crank};
use std::f64::consts::{PI, TAU};

const GROUND: BodyId = Sketch::GROUND;

/// A limit is found to this part of a turn or of the coordinate.
const LIMIT_TOLERANCE: f64 = 1e-12;

/// The range of a sketch that starts at `q`, and how its last group is solved.
fn range(sketch: &Sketch, q: f64, guesses: &[(BodyId, f64)]) -> (Range, &'static str, Plan) {
    let mut setup = sketch.setup(&[q]);
    for &(body, angle) in guesses {
        setup.assembly.initial_guess[body.0] = Some(angle);
    }
    let plan = Plan::compile(&setup.mechanism, &setup.assembly).expect("it assembles");
    let kind = plan
        .group_methods()
        .last()
        .map_or("none", |(_, kind)| *kind);
    (plan.range(), kind, plan)
}

/// Holds the ends of a range against those expected.
fn check_limits(
    kind: &str,
    sketch: &Sketch,
    q: f64,
    guesses: &[(BodyId, f64)],
    expected: [f64; 2],
) {
    let (range, solved, plan) = range(sketch, q, guesses);
    assert_eq!(solved, kind);
    let limits = plan.range_limits().map(|end| end.map(|end| end.q));
    let [Some(from), Some(to)] = limits else {
        panic!("{kind}: {range:?}");
    };
    for (found, expected) in [(from, expected[0]), (to, expected[1])] {
        let error = (found - expected).abs();
        assert!(
            error <= LIMIT_TOLERANCE * expected.abs().max(1.0),
            "{kind}: {found} {expected}"
        );
    }
}

/// A crank that is driven, pinned at the origin.
fn crank() -> (Sketch, BodyId) {
    let mut sketch = Sketch::new();
    let crank = sketch.body("crank");
    sketch.revolute("A", (GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    sketch.actuate("phi", [GROUND, crank]);
    (sketch, crank)
}

#[test]
// Long: a table of cases.
fn val_every_kind_of_limit_is_found() {
    // RRR: coupler and rocker in line.
    let [a, b, c, d] = [3.0, 1.0, 2.5, 3.2_f64];
    let end = |reach: f64| ((a * a + d * d - reach * reach) / (2.0 * a * d)).acos();
    let bars = FourBar::actuated([a, b, c, d]);
    let guesses = [(bars.coupler, 1.0)];
    check_limits(
        "pinned dyad, closed form",
        &bars.sketch,
        0.8,
        &guesses,
        [end(b - c), end(b + c)],
    );

    // RRP: the rod across its guide, r sin φ − h = ±l.
    let (rod, height) = (0.4, 0.05);
    let (sketch, bar) = slider_crank(rod, height);
    let end = |sign: f64| ((height + sign * rod) / 0.5_f64).asin();
    check_limits(
        "guided point, closed form",
        &sketch,
        0.1,
        &[(bar, 0.0)],
        [end(-1.0), end(1.0)],
    );

    // RPR: a slot that passes its pivot at a distance of e = |BD|.
    let (r, d, e) = (0.3, 0.4, 0.2_f64);
    let (mut sketch, one) = crank();
    let guide = sketch.body("guide");
    sketch.revolute("D", (GROUND, [d, 0.0]), (guide, [0.0, 0.0]));
    let axis = vec2(1.0, 0.0);
    sketch.joint(
        "slot",
        (guide, [0.0, e]),
        (one, [r, 0.0]),
        JointKind::Slot { axis },
    );
    let end = ((r * r + d * d - e * e) / (2.0 * r * d)).acos();
    check_limits(
        "guided point, closed form",
        &sketch,
        2.0,
        &[(guide, 0.0)],
        [end, TAU - end],
    );

    // PRP: a slot along the guide of the block in it; the block goes to infinity.
    let (mut sketch, one) = crank();
    let block = sketch.body("block");
    sketch.prismatic("guide", (GROUND, [0.0, 0.5]), (block, [0.0, 0.0]), axis);
    sketch.joint(
        "slot",
        (one, [0.0, 0.1]),
        (block, [0.0, 0.0]),
        JointKind::Slot { axis },
    );
    check_limits("slides, closed form", &sketch, 1.0, &[], [0.0, PI]);

    // A length that is driven: the boom in line with the ground.
    let (boom, base) = (1.5, 2.2);
    let mut sketch = Sketch::new();
    let arm = sketch.body("boom");
    sketch.revolute("A", (GROUND, [0.0, 0.0]), (arm, [0.0, 0.0]));
    sketch.actuate_length("l", [GROUND, arm], [vec2(base, 0.0), vec2(boom, 0.0)]);
    check_limits(
        "pinned dyad of variable length, closed form",
        &sketch,
        2.0,
        &[(arm, 1.0)],
        [base - boom, base + boom],
    );

    // A travel that is driven: crank and rod in line.
    let (rod, height) = (1.2, 0.1);
    let (mut sketch, rod_body) = slider_crank(rod, height);
    sketch.mechanism.actuators.clear();
    let (slider, guide) = (BodyId(3), dwell_geometry::JointId(3));
    sketch.actuate_travel("s", [GROUND, slider], guide);
    let end = |reach: f64| (reach * reach - height * height).sqrt();
    check_limits(
        "pinned dyad of variable length, closed form",
        &sketch,
        1.2,
        &[(rod_body, 0.3)],
        [end(rod - 0.5), end(rod + 0.5)],
    );

    // A dyad with a cylinder in it, as long as the crank has turned far: |BD| = c + s, s = s₀ + k φ. The
    // end is the root of an equation with a cosine in it, by Newton's method.
    let (r, d, c) = (0.3, 1.0, 0.4);
    let (from, gain) = (0.35, 0.05);
    let (mut sketch, one) = crank();
    let [rod, barrel, rocker] = ["rod", "barrel", "rocker"].map(|name| sketch.body(name));
    sketch.revolute("B", (one, [r, 0.0]), (barrel, [0.0, 0.0]));
    let cylinder = sketch.prismatic("cylinder", (barrel, [0.0, 0.0]), (rod, [0.0, 0.0]), axis);
    sketch.revolute("C", (rod, [0.0, 0.0]), (rocker, [c, 0.0]));
    sketch.revolute("D", (GROUND, [d, 0.0]), (rocker, [0.0, 0.0]));
    let law = Law::Polynomial(Polynomial::motion(from, gain, 0.0));
    let relation = Coupling {
        dependent: Coordinate::Travel(cylinder),
        independent: Coordinate::Angle([GROUND, one]),
        law,
    };
    sketch.couple("stretch", [barrel, rod], relation);
    let end = |mut phi: f64| {
        for _ in 0..30 {
            let reach = c + from + gain * phi;
            let value = r * r + d * d - 2.0 * r * d * phi.cos() - reach * reach;
            phi -= value / (2.0 * r * d * phi.sin() - 2.0 * gain * reach);
        }
        phi
    };
    let guesses = [(barrel, 0.4), (rocker, 2.5)];
    check_limits(
        "pinned dyad of variable length, closed form",
        &sketch,
        0.0,
        &guesses,
        [end(-0.5), end(0.8)],
    );

    // Geared cranks that a dyad joins: |BC| = d − 2 r cos φ.
    let (r, d, [l1, l2]) = (0.3, 1.0, [0.6, 0.5]);
    let (mut sketch, one) = crank();
    let two = sketch.body("second");
    sketch.revolute("D", (GROUND, [d, 0.0]), (two, [0.0, 0.0]));
    let kind = JointKind::Gear {
        radii: [0.5, 0.5],
        internal: false,
    };
    sketch.joint("gear", (one, [0.0, 0.0]), (two, [0.0, 0.0]), kind);
    let [left, right] = ["left", "right"].map(|name| sketch.body(name));
    sketch.revolute("B", (one, [r, 0.0]), (left, [0.0, 0.0]));
    sketch.revolute("C", (two, [r, 0.0]), (right, [0.0, 0.0]));
    sketch.revolute("E", (left, [l1, 0.0]), (right, [l2, 0.0]));
    let end = ((d - l1 - l2) / (2.0 * r)).acos();
    let guesses = [(two, PI), (left, 1.0)];
    check_limits(
        "pinned dyad, closed form",
        &sketch,
        0.0,
        &guesses,
        [-end, end],
    );
}

/// A change point: where a determinant crosses zero the range stops a little short, and its end is told.
#[test]
fn val_a_change_point_is_told_where_it_is() {
    let bars = FourBar::actuated([1.0, 3.0, 1.0, 3.0]);
    let guesses = [(bars.coupler, 0.0), (bars.rocker, 1.0)];
    let (range, _, plan) = range(&bars.sketch, 1.0, &guesses);
    let [Some(low), Some(high)] = plan.range_limits() else {
        panic!("{range:?}");
    };
    assert!(low.change_point && high.change_point);
    // The determinant is the root of a difference: a millionth from its end, where the range stops,
    // rounding is 1e-16 over 1e-6 of it, and so is what follows for the end.
    assert!(low.q.abs() < 1e-9 && (high.q - PI).abs() < 1e-9);
    let Some((from, to)) = range.limits() else {
        panic!("{range:?}");
    };
    for short in [from, PI - to] {
        assert!(short > 1e-9 && short < 1e-5, "{short:e}");
    }
}

/// A plate on three bars, the first of them on the crank: a group of class III by Newton's method.
struct Plate {
    crank: f64,
    pivots: [Vec2; 2],
    corners: [Vec2; 3],
    bars: [f64; 3],
}

impl Plate {
    /// Put together with the crank at `q` and the plate at (x, y, θ).
    fn at(q: f64, [x, y, angle]: [f64; 3]) -> (Self, [Vec2; 3]) {
        let mut plate = Self {
            crank: 1.0,
            pivots: [vec2(4.0, -0.5), vec2(3.0, 3.2)],
            corners: [vec2(0.0, 0.0), vec2(1.5, 0.2), vec2(0.7, 1.1)],
            bars: [0.0; 3],
        };
        let frame_vectors = plate.frame_vectors([x, y, angle, q]);
        plate.bars = frame_vectors.map(Vec2::norm);
        (plate, frame_vectors)
    }

    /// From the foot of each bar to its end on the plate.
    fn frame_vectors(&self, [x, y, angle, q]: [f64; 4]) -> [Vec2; 3] {
        let [two, three] = self.pivots;
        let feet = [Vec2::from_angle(q) * self.crank, two, three];
        [0, 1, 2].map(|i| vec2(x, y) + self.corners[i].rotate(Vec2::from_angle(angle)) - feet[i])
    }

    /// What is zero at a limit: the closing conditions of the bars, and the determinant of their
    /// slopes by the plate's coordinates.
    fn limit_conditions(&self, at: [f64; 4]) -> [f64; 4] {
        let frame_vectors = self.frame_vectors(at);
        let slopes = [0, 1, 2].map(|i| {
            let corner = self.corners[i].rotate(Vec2::from_angle(at[2]));
            [
                frame_vectors[i].x,
                frame_vectors[i].y,
                corner.cross(frame_vectors[i]),
            ]
        });
        let [one, two, three] = slopes;
        let minor = |i: usize, j: usize| two[i] * three[j] - two[j] * three[i];
        let determinant = one[0] * minor(1, 2) - one[1] * minor(0, 2) + one[2] * minor(0, 1);
        let closing =
            [0, 1, 2].map(|i| frame_vectors[i].dot(frame_vectors[i]) - self.bars[i] * self.bars[i]);
        [closing[0], closing[1], closing[2], determinant]
    }

    /// Newton's method; slopes by differences are good enough for it.
    fn limit_position(&self, mut at: [f64; 4]) -> [f64; 4] {
        for _ in 0..30 {
            let here = self.limit_conditions(at);
            let mut rows = [[0.0; 5]; 4];
            for j in 0..4 {
                let step = 1e-6;
                let (mut ahead, mut back) = (at, at);
                ahead[j] += step;
                back[j] -= step;
                let both = self
                    .limit_conditions(ahead)
                    .into_iter()
                    .zip(self.limit_conditions(back));
                for (row, (a, b)) in rows.iter_mut().zip(both) {
                    row[j] = (a - b) / (2.0 * step);
                }
            }
            for (row, value) in rows.iter_mut().zip(here) {
                row[4] = value;
            }
            for (x, step) in at.iter_mut().zip(solve_linear(rows)) {
                *x -= step;
            }
        }
        at
    }
}

/// The solution of four linear equations.
fn solve_linear(mut rows: [[f64; 5]; 4]) -> [f64; 4] {
    for k in 0..4 {
        let pivot = (k..4).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()));
        rows.swap(k, pivot.expect("rows"));
        for i in (0..4).filter(|&i| i != k) {
            let part = rows[i][k] / rows[k][k];
            let pivot = rows[k];
            for (value, pivot) in rows[i].iter_mut().zip(pivot).skip(k) {
                *value -= part * pivot;
            }
        }
    }
    [0, 1, 2, 3].map(|k| rows[k][4] / rows[k][k])
}

#[test]
fn val_the_limits_of_a_group_by_newtons_method_are_found() {
    let (plate, frame_vectors) = Plate::at(0.6, [2.0, 1.0, 0.1]);
    let (mut sketch, one) = crank();
    let body = sketch.body("plate");
    let bars = ["first", "second", "third"].map(|name| sketch.body(name));
    let [two, three] = plate.pivots;
    let feet = [
        (one, [plate.crank, 0.0]),
        (GROUND, [two.x, two.y]),
        (GROUND, [three.x, three.y]),
    ];
    for i in 0..3 {
        let corner = plate.corners[i];
        sketch.revolute(["B", "D", "F"][i], feet[i], (bars[i], [0.0, 0.0]));
        let end = (body, [corner.x, corner.y]);
        sketch.revolute(["C", "E", "G"][i], (bars[i], [plate.bars[i], 0.0]), end);
    }
    let mut guesses: Vec<_> = bars
        .into_iter()
        .zip(frame_vectors.map(Vec2::angle))
        .collect();
    guesses.push((body, 0.1));
    let (range, kind, plan) = range(&sketch, 0.6, &guesses);
    assert_eq!(kind, "Newton from stored poses");
    let Some((from, to)) = range.limits() else {
        panic!("{range:?}");
    };
    let mut pose = plan.pose();
    for found in [from, to] {
        plan.positions(&[found], &mut pose).expect("a pose");
        let poses = plan.body_frames(&sketch.mechanism, &pose);
        let [x, y, angle] = poses[body.0];
        let at = plate.limit_position([x, y, angle, found]);
        assert!((found - at[3]).abs() < LIMIT_TOLERANCE, "{found} {at:?}");
    }
}

//! Periods where the inertia has a narrow peak: a body swings by half a turn within a small part of the coordinate.

use crate::table::scene;
use dwell_scene::SpaceScene;
use dwell_study::{TableRequest, compute_period, reduce};
use std::f64::consts::{PI, TAU};

/// ∫ √(of(x′, y′)) dz from 0 to π, where tan x = √c tan z and tan y = tan z / √c: the trapezoidal rule.
fn integral(c: f64, of: impl Fn(f64, f64) -> f64) -> f64 {
    let root = c.sqrt();
    let points = (40.0 / root).ceil().max(512.0);
    let value = |k: usize| {
        let (sin, cos) = (PI * k as f64 / points).sin_cos();
        let (sin, cos) = (sin * sin, cos * cos);
        of(root / (cos + c * sin), root / (c * cos + sin)).sqrt()
    };
    (0..points as usize).map(value).sum::<f64>() * PI / points
}

/// Numbers of a seed from 0 to 1, by Knuth's linear congruence.
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn power(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * self.next())
    }
}

/// The pin of a crank of 1 m passes the pivot of its guide at 10^-1 to 3·10^-6 m, inside or outside of its path.
#[test]
fn a_period_holds_the_swing_of_a_guide_whose_pivot_the_pin_passes() {
    let mut draws = Draws(47);
    for _ in 0..30 {
        let distance = draws.power(-5.5, -1.0);
        let radius = if draws.next() < 0.5 {
            1.0 - distance
        } else {
            1.0 + distance
        };
        let (at, guide) = (0.5 + 5.0 * draws.next(), draws.power(-6.0, 2.0));
        let [x, y] = [radius * at.cos(), radius * at.sin()];
        let angle = (-y).atan2(1.0 - x);
        let text = format!(
            "[bodies]\nground.points = {{ A = [0, 0], Q = [{x}, {y}] }}\ncrank = {{ points = {{ A = [0, 0], B = [1, 0] }}, inertia = 1 }}\n\
             guide = {{ points = {{ Q = [0, 0] }}, inertia = {guide} }}\nblock.points = {{ B = [0, 0] }}\n[joints]\n\
             A = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"block.B\"] }}\n\
             Q = {{ revolute = [\"ground.Q\", \"guide.Q\"] }}\ns = {{ prismatic = [\"guide.Q\", \"block.B\"], axis = [1, 0] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n[assembly]\nphi = 0\nguide = {angle}\nblock = {angle}\n\
             [motion]\ninitial-velocity = {{ phi = 1 }}\nperiods = 1\n"
        );
        let found = compute_period(&scene(&text)).unwrap().period;
        let gap = x.hypot(y) - 1.0;
        let c = (gap / (gap + 2.0)).abs();
        let sign = gap.signum();
        let root_m = integral(c, |x, y| 4.0 * x * x + guide * (x - sign * y).powi(2));
        let rate = (1.0 - x) / ((1.0 - x).powi(2) + y * y);
        let period = root_m / (1.0 + guide * rate * rate).sqrt();
        // The gap is known to eps/d.
        let error = (found / period - 1.0).abs();
        assert!(
            error < 1e-12 + 1e-15 / distance,
            "{distance:e} {guide:e}: {found} {period} {error:e}"
        );
    }
}

fn hooke(c: f64, [input, output]: [f64; 2]) -> f64 {
    let (sine, turn) = (((1.0 - c) * (1.0 + c)).sqrt(), c.acos());
    let text = format!(
        "[bodies]\nground.points = {{ A = [0, 0, 0], D = [0, 0, 0] }}\n\
         i = {{ points = {{ A = [0, 0, 0], U = [0, 0, 0] }}, mass = 1, center = [0, 0, 0], inertia = [{input}, {input}, {input}] }}\n\
         o = {{ points = {{ D = [0, 0, 0], U = [0, 0, 0] }}, mass = 1, center = [0, 0, 0], inertia = [{output}, {output}, {output}] }}\n\
         [joints]\nA = {{ revolute = [\"ground.A\", \"i.A\"], axis = [1, 0, 0] }}\n\
         D = {{ revolute = [\"ground.D\", \"o.D\"], axes = [[{c}, {sine}, 0], [1, 0, 0]] }}\n\
         U = {{ universal = [\"i.U\", \"o.U\"], axes = [[0, 0, 1], [0, 1, 0]] }}\n\
         [actuators]\nq = {{ angle = \"A\" }}\n[assembly]\nq = 0.0\no = {{ turn = [0, 0, {turn}] }}\n\
         [motion]\ninitial-velocity = {{ q = 10 }}\nperiods = 1\n"
    );
    let scene = SpaceScene::parse("hooke.toml", &text).unwrap();
    compute_period(&scene).unwrap().period
}

/// A Hooke joint near a right angle turns its output by half a turn while the input turns by cos β.
#[test]
fn a_period_holds_the_swing_of_a_hooke_joint_near_a_right_angle() {
    // 89°, then 89.99°.
    let mut joints = vec![
        (0.017_452_406_437_283_51, [0.02, 0.03]),
        (0.000_174_532_924_313_387_17, [0.02, 0.03]),
    ];
    let mut draws = Draws(48);
    joints.extend((0..30).map(|_| (draws.power(-6.0, -0.3), [1.0, draws.power(-5.0, 2.0)])));
    for (c, inertias) in joints {
        let [input, output] = inertias;
        let root_m = 2.0 * integral(c, |x, y| input * x * x + output * y * y);
        let period = root_m / (10.0 * (input + output * c * c).sqrt());
        assert!(period > 0.1 * TAU);
        let found = hooke(c, inertias);
        let error = (found / period - 1.0).abs();
        assert!(
            error < 1e-12 + 1e-15 / c,
            "{c:e} {output:e}: {found} {period} {error:e}"
        );
    }
}

/// A follower that rises within a hundredth or a thousandth of a radian: a table says that its cells are too wide, in no absurd number.
#[test]
fn a_table_of_a_steep_cam_is_refused_for_its_steepness() {
    for width in [1e-2, 1e-3, 1e-5] {
        let text = format!(
            "[bodies]\nground = {{ points = {{ O = [0, 0] }} }}\n\
             cam = {{ points = {{ O = [0, 0] }}, inertia = 0.001 }}\n\
             follower = {{ points = {{ F = [0, 0] }}, mass = 0.4, center = \"F\" }}\n\
             [joints]\nO = {{ revolute = [\"ground.O\", \"cam.O\"] }}\n\
             guide = {{ prismatic = [\"ground.O\", \"follower.F\"], axis = [0, 1] }}\n\
             contact = {{ coupling = [\"rise\", \"phi\"], expression = \"0.01*tanh((x - 1.57)/{width})\" }}\n\
             [coordinates]\nrise = {{ travel = \"guide\" }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"cam\"] }}\n[assembly]\nphi = 0\nfollower = 0\n"
        );
        let request = TableRequest {
            accuracy: 1e-9,
            interval: None,
            required: true,
        };
        let refused = reduce(&scene(&text), Some(5), Some(request)).map(drop);
        let message = refused.unwrap_err().to_string();
        assert!(
            message.contains("varies within so small a part"),
            "{message}"
        );
    }
}

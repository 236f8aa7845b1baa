//! Narrow peaks of the inertia: a body that rotates by half a revolution within a small interval of the coordinate.
//!
//! In both mechanisms a body rotates by y while the coordinate changes by x, with tan y = tan x / c. As functions of z, with tan z = tan x / √c, both
//! have peaks of the width √c, and the period is the integral of a smooth periodic function of z:
//!
//! ```text
//! x′ = √c / (cos² z + c sin² z),   y′ = √c / (c cos² z + sin² z)                                    (1)
//! Hooke joint   c = cos β                          T = 2 ∫ √((I₁ x′² + I₂ y′²) / 2E) dz,  z = 0 … π  (2)
//! crank pin     c = d / (2 + d), pivot at 1 + d    T = ∫ √((4 I₁ x′² + I₂ (x′ − y′)²) / 2E) dz        (3)
//! ```

use super::closed_forms::dd;
use super::mechanisms::scene;
use super::run_pair::quadrature;
use super::series::{ParameterSeries, Requirement, RunResult, decades};
use dwell_dynamics::{CoordinateMode, Machine, MovingModel, Orbit, ReducedState};
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::SpaceScene;
use dwell_study::PreparedSpaceScene;
use dwell_study::models::compile_model;

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = ("narrow-peaks", "Narrow peaks of the inertia");
/// Number of points relative to 1/√c: the quadrature error of (2) and (3) is below a relative 1e-32.
const POINTS: f64 = 64.0;
/// Moments of inertia of the driving and of the swinging body, kg m², and the speed of the coordinate at the start, rad/s.
const INERTIAS: [f64; 2] = [1.0, 0.5];
const SPEED: f64 = 1.0;

/// Parameters down to where the assembly modes, or the positions, cannot be distinguished and an error is returned.
pub(super) fn series() -> Vec<ParameterSeries> {
    vec![
        row(
            "near-pivot",
            "Crank pin that passes the pivot of its guide: distance",
            ("distance d", "m"),
            "the angle of the guide in closed form, and the trapezoidal rule in 32 digits",
            near_pivot,
            -5,
        ),
        row(
            "hooke-near-right-angle",
            "Hooke joint in space, near a right angle: cosine of its angle",
            ("cos β", "1"),
            "the turn of the output in closed form, and the trapezoidal rule in 32 digits",
            hooke,
            -6,
        ),
    ]
}

/// A row down to 10 to the power `smallest`.
fn row(
    key: &str,
    description: &str,
    parameter: (&'static str, &'static str),
    reference: &'static str,
    run: fn(f64) -> RunResult,
    smallest: i32,
) -> ParameterSeries {
    ParameterSeries {
        figure: FIGURE,
        key: key.into(),
        description: description.into(),
        parameter,
        values: decades(-1, smallest),
        quantities: &["period by quadrature"],
        reference,
        reason: "lengths known to their rounding leave eps/d of the speeds within the peak, whose part of the period is a third: 16 roundings",
        requirement: Box::new(|at, _| Requirement::from_rounding(16.0, 1.0 / at)),
        run: Box::new(run),
    }
}

/// ∫ √(of(x′, y′)) dz from 0 to π, by (1).
fn integral(
    c: DoubleDouble,
    of: impl Fn(DoubleDouble, DoubleDouble) -> DoubleDouble,
) -> DoubleDouble {
    let root = c.sqrt();
    let points = (POINTS / root.value()).ceil().max(512.0);
    let mut sum = dd(0.0);
    let mut k = 0.0;
    while k < points {
        let (sin, cos) = (DoubleDouble::PI * dd(k) / dd(points)).sin_cos();
        let (sin, cos) = (sin * sin, cos * cos);
        let [x, y] = [cos + c * sin, c * cos + sin].map(|below| root / below);
        sum += of(x, y).sqrt();
        k += 1.0;
    }
    sum * DoubleDouble::PI / dd(points)
}

/// The period of a machine from q = 0, with its estimated error, against an integral of √m over 2π.
fn period<M: MovingModel>(
    machine: &Machine<M>,
    root_m: DoubleDouble,
    at_start: DoubleDouble,
) -> RunResult {
    let orbit = |stretch: f64| {
        let (t, q, q_dot) = (0.0, 0.0, SPEED * stretch);
        Orbit::loaded(machine, ReducedState { t, q, q_dot })
    };
    // √(2E) = √m q̇ at the start.
    Ok(vec![quadrature(
        orbit,
        root_m / (at_start.sqrt() * dd(SPEED)),
    )])
}

/// The pivot lies at 1 + d m on the line φ = 2 rad.
fn near_pivot(distance: f64) -> RunResult {
    let [crank, guide] = INERTIAS;
    let radius = 1.0 + distance;
    let [x, y] = [radius * 2.0_f64.cos(), radius * 2.0_f64.sin()];
    let angle = (0.0 - y).atan2(1.0 - x);
    let text = format!(
        "[bodies]\nground.points = {{ A = [0, 0], Q = [{x}, {y}] }}\ncrank = {{ points = {{ A = [0, 0], B = [1, 0] }}, inertia = {crank} }}\n\
         guide = {{ points = {{ Q = [0, 0] }}, inertia = {guide} }}\nblock.points = {{ B = [0, 0] }}\n[joints]\n\
         A = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"block.B\"] }}\n\
         Q = {{ revolute = [\"ground.Q\", \"guide.Q\"] }}\ns = {{ prismatic = [\"guide.Q\", \"block.B\"], axis = [1, 0] }}\n\
         [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n[assembly]\nphi = 0\nguide = {angle}\nblock = {angle}\n"
    );
    let model = compile_model(&scene(&text)?, &[]).map_err(|e| e.to_string())?;
    let machine = Machine::new(model, &[], vec![CoordinateMode::Free], &[]);
    // The distance of the rounded pivot.
    let gap = (dd(x) * dd(x) + dd(y) * dd(y)).sqrt() - dd(1.0);
    let c = gap / (gap + dd(2.0));
    let [one, two] = INERTIAS.map(dd);
    let root_m = integral(c, |x, y| dd(4.0) * one * x * x + two * (x - y) * (x - y));
    // The guide's rate where the crank is at q = 0: (P − Q)·(−y, x) of the crank's pin P = (1, 0), over |P − Q|².
    let away = dd(1.0) - dd(x);
    let rate = away / (away * away + dd(y) * dd(y));
    period(&machine?, root_m, one + two * rate * rate)
}

/// The output axis is inclined by β to the x axis of the input, and both yokes are in line at q = 0.
fn hooke(cosine: f64) -> RunResult {
    let [input, output] = INERTIAS;
    let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
    let turn = cosine.acos();
    let text = format!(
        "[bodies]\nground.points = {{ A = [0, 0, 0], D = [0, 0, 0] }}\n\
         i = {{ points = {{ A = [0, 0, 0], U = [0, 0, 0] }}, mass = 1, center = [0, 0, 0], inertia = [{input}, 1, 1] }}\n\
         o = {{ points = {{ D = [0, 0, 0], U = [0, 0, 0] }}, mass = 1, center = [0, 0, 0], inertia = [{output}, 0.4, 0.4] }}\n\
         [joints]\nA = {{ revolute = [\"ground.A\", \"i.A\"], axis = [1, 0, 0] }}\n\
         D = {{ revolute = [\"ground.D\", \"o.D\"], axes = [[{cosine}, {sine}, 0], [1, 0, 0]] }}\n\
         U = {{ universal = [\"i.U\", \"o.U\"], axes = [[0, 0, 1], [0, 1, 0]] }}\n\
         [actuators]\nq = {{ angle = \"A\" }}\n[assembly]\nq = 0.0\no = {{ turn = [0, 0, {turn}] }}\n"
    );
    let scene = SpaceScene::parse("scene.toml", &text)?;
    let model = PreparedSpaceScene::new(&scene)?.model_for(&[])?;
    let machine = Machine::new(model, &[], vec![CoordinateMode::Free], &[]);
    let (c, [one, two]) = (dd(cosine), INERTIAS.map(dd));
    let root_m = dd(2.0) * integral(c, |x, y| one * x * x + two * y * y);
    period(&machine?, root_m, one + two * c * c)
}

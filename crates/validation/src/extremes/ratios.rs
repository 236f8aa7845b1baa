//! Extreme ratios: of gears, of a cam's steepness, of links that are far longer than the crank, of the bars of a double pendulum.

use super::closed_forms::{UnitSpeedBody, at_rest, dd, exponential, four_bar};
use super::forms::Form;
use super::in_scenes::StatedTable;
use super::mechanisms::{CRANK_ROCKER, FourBar, body, mass};
use super::series::{
    ALLOWED_ROUNDINGS, DYAD_CONDITION, ParameterSeries, Requirement, RunResult, decades,
};
use dwell_geometry::{Vec2, vec2};
use dwell_kinetostatics::Mass;
use dwell_numerics::{DoubleDouble, Scalar};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Positions of a revolution or a motion.
const POINTS: usize = 181;

/// Figure of these rows, and its title.
pub(super) const FIGURE: (&str, &str) = (
    "ratios",
    "Gears, cams, long links, two freedoms, large groups",
);

pub(super) fn series(form: Form) -> Vec<ParameterSeries> {
    vec![gears(form), cam(form), long_links(form), double_pendulum()]
}

fn rounding(condition: f64) -> Requirement {
    Requirement::from_rounding(ALLOWED_ROUNDINGS, condition)
}

/// A pair of gears on fixed centres: the second turns −r₁/r₂ as fast.
fn gears(form: Form) -> ParameterSeries {
    let run = move |ratio: f64| -> RunResult {
        let (one, two) = (0.5, 0.25);
        let text = format!(
            "[bodies]\nground = {{ points = {{ A = [0, 0], B = [{}, 0] }} }}\n\
             one = {{ points = {{ A = [0, 0] }}, mass = 2, center = \"A\", inertia = {one} }}\n\
             two = {{ points = {{ B = [0, 0] }}, mass = 1, center = \"B\", inertia = {two} }}\n\
             [joints]\nA = {{ revolute = [\"ground.A\", \"one.A\"] }}\nB = {{ revolute = [\"ground.B\", \"two.B\"] }}\n\
             teeth = {{ gear = [\"one.A\", \"two.B\"], radii = [1, {ratio}] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"one\"] }}\n[assembly]\nphi = 0\none = 0\ntwo = 0\n\
             [requests]\nreactions = [\"teeth.tooth\"]\n",
            1.0 + ratio
        );
        let found = StatedTable::reduced(form, &text, POINTS)?;
        let speed = dd(1.0) / dd(ratio);
        let m = dd(one) + dd(two) * speed * speed;
        // The tooth force times its radius turns the second gear.
        let size = dd(two) * speed * speed;
        let tooth_force = found.column("teeth.tooth.a")?;
        let sign = tooth_force.first().map_or(1.0, |force| force.signum());
        found.compare(&[
            vec![("m", vec![m; POINTS])],
            vec![("teeth.tooth.a", vec![size * dd(sign); POINTS])],
        ])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "gear-ratio".into(),
        description: "Two gears on fixed centres, as reduce writes them: radius of the second over that of the first".into(),
        parameter: ("r₂ / r₁", ""),
        values: decades(-6, 6),
        quantities: &["m", "a of the tooth force"],
        reference: "m = I₁ + I₂ (r₁/r₂)², and the moment of the teeth on the second gear",
        reason: "products and quotients of the radii; 16 roundings",
        requirement: Box::new(|_, _| rounding(1.0)),
        run: Box::new(run),
    }
}

/// tanh in 32 digits.
fn tanh(x: DoubleDouble) -> DoubleDouble {
    let square = exponential(dd(-2.0 * x.value().abs()));
    let size = (dd(1.0) - square) / (dd(1.0) + square);
    if x.value() < 0.0 { -size } else { size }
}

/// A follower that a cam lifts by 20 mm within a small angle: s = h tanh((φ − φ₀)/β), with φ₀ 0.4 β from a row.
fn cam(form: Form) -> ParameterSeries {
    const RISE: f64 = 0.01;
    let run = move |angle: f64| -> RunResult {
        let center = FRAC_PI_2 + 0.4 * angle;
        let text = format!(
            "[bodies]\nground = {{ points = {{ O = [0, 0] }} }}\n\
             cam = {{ points = {{ O = [0, 0] }}, mass = 1.5, center = \"O\", inertia = 0.001 }}\n\
             follower = {{ points = {{ F = [0, 0] }}, mass = 0.4, center = \"F\" }}\n\
             [joints]\nO = {{ revolute = [\"ground.O\", \"cam.O\"] }}\n\
             guide = {{ prismatic = [\"ground.O\", \"follower.F\"], axis = [0, 1] }}\n\
             contact = {{ coupling = [\"rise\", \"phi\"], expression = \"{RISE}*tanh((x - {center})/{angle})\" }}\n\
             [coordinates]\nrise = {{ travel = \"guide\" }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"cam\"] }}\n[assembly]\nphi = 0\nfollower = 0\n\
             [requests]\nreactions = [\"contact.force\"]\n"
        );
        let found = StatedTable::reduced(form, &text, POINTS)?;
        let rows = found.column("phi")?.into_iter().map(|q| {
            let x = (dd(q) - dd(center)) / dd(angle);
            let value = tanh(x);
            let gain = (dd(1.0) - value) * (dd(1.0) + value);
            let first = dd(RISE) * gain / dd(angle);
            let second = dd(-2.0) * value * first / dd(angle);
            (
                dd(0.001) + dd(0.4) * first * first,
                dd(0.4) * first * second,
            )
        });
        let (m, half_dm) = rows.unzip();
        found.compare(&[vec![("m", m)], vec![("half_dm", half_dm)]])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "cam-steepness".into(),
        description:
            "Cam and follower, as reduce writes them: the angle within which the follower rises"
                .into(),
        parameter: ("angle β", "rad"),
        values: decades(0, -8),
        quantities: &["m", "½m′"],
        reference: "m = I + M s′² and ½m′ = M s′ s″ of s = h tanh((φ − φ₀)/β)",
        reason: "next to the row at π/2, which is a double-precision number as φ₀ is, their difference is exact; 16 roundings of a product of three functions",
        // For cells, the fraction of a revolution within which the follower rises is decisive.
        requirement: Box::new(move |angle, _| {
            let narrow = if form.is_fitted() { TAU / angle } else { 0.0 };
            rounding(DYAD_CONDITION.max(narrow))
        }),
        run: Box::new(run),
    }
}

/// The crank-rocker with longer coupler and rocker, which are nearly parallel and rotate slowly.
fn long_links(form: Form) -> ParameterSeries {
    let make = |length: f64| FourBar {
        lengths: [1.0, 2.5 + length, 1.0 + length],
        ..CRANK_ROCKER
    };
    let run = move |length: f64| -> RunResult {
        let parts = make(length);
        let four_bar_at = |q: f64| four_bar(&parts, dd(q));
        // Where C is at assembly.
        let (_, [bc, dc]) = super::closed_forms::four_bar_bodies(&parts, dd(0.0));
        let angle = |v: Vec2<DoubleDouble>| v.y.value().atan2(v.x.value());
        let assembled = FourBar {
            assembly: [0.0, angle(bc)],
            ..parts
        };
        let rest = format!(
            "rocker = {}\n[requests]\nreactions = [\"C.x\", \"C.y\"]\n",
            angle(dc)
        );
        let text = assembled.text() + &rest;
        let found = StatedTable::reduced(form, &text, POINTS)?;
        let all: Vec<_> = found.column("phi")?.into_iter().map(four_bar_at).collect();
        let m = all.iter().map(|at| at.m).collect();
        let half_dm = all.iter().map(|at| at.half_dm).collect();
        found.compare(&[vec![("m", m)], vec![("half_dm", half_dm)]])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "long-links".into(),
        description: "Four-bar, as reduce writes it: coupler and rocker are longer than its crank"
            .into(),
        parameter: ("length of coupler and rocker over the crank's", ""),
        values: decades(0, 6),
        quantities: &["m", "½m′"],
        reference: "circle and circle in 32 digits",
        reason: "lengths L are known to eps L, and their small difference decides the angle between coupler and rocker: L eps; 16 roundings of a dyad's 8",
        requirement: Box::new(|length, _| rounding(DYAD_CONDITION * length)),
        run: Box::new(run),
    }
}

/// The scene of two bars, the second pinned to the first at 1 m.
fn double_pendulum_text([one, two]: [&Mass; 2]) -> String {
    format!(
        "[bodies]\nground = {{ points = {{ A = [0, 0] }} }}\n{}{}\
             [joints]\nA = {{ revolute = [\"ground.A\", \"one.A\"] }}\nB = {{ revolute = [\"one.B\", \"two.B\"] }}\n\
             [actuators]\np = {{ angle = [\"ground\", \"one\"] }}\nq = {{ angle = [\"ground\", \"two\"] }}\n\
             [assembly]\np = 0.4\nq = -0.3\n\
             [prescribed]\nduration = 2\np = {{ sinusoid = {{ amplitude = 0.8, period = 2 }} }}\nq = {{ sinusoid = {{ amplitude = 1.2, period = 1 }} }}\n\
             [requests]\nvariables = [\"p\", \"p.velocity\", \"p.acceleration\", \"q\", \"q.velocity\", \"q.acceleration\", \"p.actuator_force\", \"q.actuator_force\"]\n",
        body("one", "A = [0, 0], B = [1, 0]", one),
        body("two", "B = [0, 0]", two)
    )
}

/// Two bars whose lengths differ by a ratio, with forces of a motion of both.
fn double_pendulum() -> ParameterSeries {
    let run = |ratio: f64| -> RunResult {
        let (one, two) = (
            mass(1.5, [0.5, 0.125], 0.25),
            mass(1.25, [0.5 * ratio, 0.125 * ratio], 0.125 * ratio * ratio),
        );
        let text = double_pendulum_text([&one, &two]);
        let found = StatedTable::kinetostatics(&text, POINTS)?;
        let motion = |name: &str| -> Result<Vec<[f64; 3]>, String> {
            let [at, velocity, acceleration] =
                ["", ".velocity", ".acceleration"].map(|end| found.column(&format!("{name}{end}")));
            let pairs = at?.into_iter().zip(velocity?).zip(acceleration?);
            Ok(pairs.map(|((q, v), a)| [q, v, a]).collect())
        };
        let rows = motion("p")?.into_iter().zip(motion("q")?).map(|(p, q)| {
            let turning = |[angle, rate, acceleration]: [f64; 3], origin, of: Mass| {
                let (sin, cos) = dd(angle).sin_cos();
                UnitSpeedBody::new(origin, vec2(cos, sin), [dd(rate), dd(acceleration)], of)
            };
            let first = turning(p, at_rest(Vec2::zero()), one);
            let pin = first.point_motion(vec2(dd(1.0), dd(0.0)));
            let second = turning(q, pin, two);
            // The moment of the second bar about B; and the moment of both bars about A.
            let about = |point| [first, second].map(|body| body.moment_terms(point)[1]);
            let [_, on_second] = about(pin[0]);
            let [by_first, by_second] = about(Vec2::zero());
            (by_first + by_second - on_second, on_second)
        });
        let (p, q) = rows.unzip();
        found.compare(&[vec![("p.actuator_force", p)], vec![("q.actuator_force", q)]])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "double-pendulum-ratio".into(),
        description:
            "Double pendulum of two drives, as kinetostatics writes it: length of the second bar"
                .into(),
        parameter: ("length of the second bar over that of the first", ""),
        values: decades(-6, 6),
        quantities: &["torque p", "torque q"],
        reference: "moments about B and A in 32 digits, at the coordinates, speeds and accelerations of the rows",
        reason: "sums of products, each relative to the largest of the motion: 16 roundings of a dyad's 8",
        requirement: Box::new(|_, _| rounding(DYAD_CONDITION)),
        run: Box::new(run),
    }
}

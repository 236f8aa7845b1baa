//! The mechanism of the paper without its flywheel: with the shortest possible crank, and with the guide's pivot as close as possible to
//! the path of P, where the guide rotates very fast.

use super::closed_forms::{Point, UnitSpeedBody, at_rest, dd, four_bar_bodies};
use super::forms::Form;
use super::in_scenes::StatedTable;
use super::mechanisms::{FourBar, mass};
use super::series::{
    DYAD_CONDITION, ParameterSeries, Requirement, RunResult, decades, scaled_cell,
};
use dwell_geometry::{Vec2, vec2};
use dwell_kinetostatics::Mass;
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// Allowed rounding errors of an evaluation: those of two successive dyads.
const ALLOWED_ROUNDINGS: f64 = 32.0;
/// The length of the coupler from B to C, and from C to P, m.
const LENGTH_BC: f64 = 0.25;
/// Guide and slider.
const GUIDE: Mass = mass(2.1, [0.35, 0.0], 0.08575);
const SLIDER: f64 = 0.5;
/// The crank angle where P is nearest to the guide's pivot: between two rows, rad.
const BETWEEN_ROWS: f64 = 1.0;
/// Positions of a revolution, one each degree.
const POINTS: usize = 361;

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = (
    "paper-mechanism",
    "The paper's mechanism without a flywheel",
);

pub(super) fn series(form: Form) -> Vec<ParameterSeries> {
    vec![short_crank(form), near_path(form), peak_between_rows()]
}

/// Crank, coupler and rocker, and where the guide turns on the ground.
#[derive(Debug, Clone, Copy)]
struct SingleDwell {
    four_bar: FourBar,
    pivot: Vec2,
}

impl SingleDwell {
    /// Hoeken's proportions with another crank.
    fn new(crank: f64) -> Self {
        let four_bar = FourBar {
            base: [Vec2::ZERO, vec2(0.2, 0.0)],
            lengths: [crank, LENGTH_BC, LENGTH_BC],
            masses: [
                mass(0.0, [0.0; 2], 0.0),
                mass(1.5, [LENGTH_BC, 0.0], 0.03125),
                mass(0.75, [0.125, 0.0], 0.00390625),
            ],
            assembly: [0.0, 1.0],
        };
        let pivot = vec2(-0.2, 0.4);
        Self { four_bar, pivot }
    }

    /// The mechanism with the guide's pivot at a distance from the path of P, at a crank angle. Nearer than 1e-6 m the
    /// two directions of the guide are not distinguished, which ends the range.
    fn pivot_off_path(angle: f64, distance: f64) -> Self {
        let wide = Self::new(0.1);
        let [place, velocity, _] = wide.point_p(dd(angle));
        let side = velocity.perp() * (dd(1.0) / velocity.dot(velocity).sqrt());
        let pivot = place + side * dd(distance);
        Self {
            pivot: vec2(pivot.x.value(), pivot.y.value()),
            ..wide
        }
    }

    /// The scene, as a user writes it.
    fn text(&self) -> String {
        let [crank, ..] = self.four_bar.lengths;
        let start = self.point_p(dd(0.0))[0] - self.pivot.cast();
        let guide = start.y.value().atan2(start.x.value());
        let Vec2 { x, y } = self.pivot;
        format!(
            "[bodies]\n\
             ground = {{ points = {{ A = [0, 0], O = [0.2, 0], Q = [{x}, {y}] }} }}\n\
             crank = {{ points = {{ A = [0, 0], B = [{crank}, 0] }} }}\n\
             coupler = {{ points = {{ B = [0, 0], C = [0.25, 0], P = [0.5, 0] }}, mass = 1.5, center = \"C\", inertia = 0.03125 }}\n\
             rocker = {{ points = {{ O = [0, 0], C = [0.25, 0] }}, mass = 0.75, center = [0.125, 0], inertia = 0.00390625 }}\n\
             guide = {{ points = {{ Q = [0, 0] }}, mass = 2.1, center = [0.35, 0], inertia = 0.08575 }}\n\
             slider = {{ points = {{ P = [0, 0] }}, mass = 0.5, center = \"P\" }}\n\
             [joints]\n\
             A = {{ revolute = [\"ground.A\", \"crank.A\"] }}\n\
             B = {{ revolute = [\"crank.B\", \"coupler.B\"] }}\n\
             C = {{ revolute = [\"coupler.C\", \"rocker.C\"] }}\n\
             O = {{ revolute = [\"ground.O\", \"rocker.O\"] }}\n\
             Q = {{ revolute = [\"ground.Q\", \"guide.Q\"] }}\n\
             P = {{ revolute = [\"coupler.P\", \"slider.P\"] }}\n\
             slide = {{ prismatic = [\"guide.Q\", \"slider.P\"], axis = [1, 0] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n\
             [assembly]\nphi = 0\ncoupler = 1.1\nrocker = 1.9\nguide = {guide}\nslider = {guide}\n\
             [requests]\nreactions = [\"slide.normal\"]\n"
        )
    }

    /// The coupler's end P: place, velocity and acceleration at unit speed of the crank.
    fn point_p(&self, q: DoubleDouble) -> [Point; 3] {
        let ([_, coupler, _], _) = four_bar_bodies(&self.four_bar, q);
        coupler.point_motion(vec2(dd(2.0 * LENGTH_BC), dd(0.0)))
    }

    /// m, ½m′, and a and b of the slide's normal reaction: guide and slider turn as the line from Q to P does, and the
    /// normal force alone turns the guide about Q.
    fn coefficients(&self, q: DoubleDouble) -> [DoubleDouble; 4] {
        let (bodies, _) = four_bar_bodies(&self.four_bar, q);
        let [place, velocity, acceleration] = self.point_p(q);
        let line = place - self.pivot.cast();
        let square = line.dot(line);
        let length = square.sqrt();
        let omega = line.cross(velocity) / square;
        let extension = line.dot(velocity) / length;
        let alpha = line.cross(acceleration) / square - dd(2.0) * extension * omega / length;
        let axis = line * (dd(1.0) / length);
        let pivot = at_rest(self.pivot.cast());
        let guide = UnitSpeedBody::new(pivot, axis, [omega, alpha], GUIDE);
        let mut sums = [
            dd(SLIDER) * velocity.dot(velocity),
            dd(SLIDER) * velocity.dot(acceleration),
        ];
        for body in bodies.iter().chain([&guide]) {
            let terms = body.inertia_terms();
            sums = [sums[0] + terms[0], sums[1] + terms[1]];
        }
        // The guide pushes the slider with N along the normal: −N s turns the guide.
        let [a, b] = guide.moment_terms(pivot[0]).map(|moment| -moment / length);
        [sums[0], sums[1], a, b]
    }

    /// Compares the table of `reduce` with the closed form at its positions.
    fn compare(&self, form: Form) -> RunResult {
        let found = StatedTable::reduced(form, &self.text(), POINTS)?;
        let positions = found.column("phi")?;
        let rows: Vec<[DoubleDouble; 4]> = positions
            .into_iter()
            .map(|q| self.coefficients(dd(q)))
            .collect();
        let column = |name, k: usize| (name, rows.iter().map(|row| row[k]).collect::<Vec<_>>());
        found.compare(&[
            vec![column("m", 0)],
            vec![column("half_dm", 1)],
            vec![column("slide.normal.a", 2), column("slide.normal.b", 3)],
        ])
    }

    /// The largest m within some width of a crank angle, where ½m′ is zero.
    fn peak(&self, near: f64, width: f64) -> DoubleDouble {
        let (mut low, mut high) = (dd(near - width), dd(near + width));
        for _ in 0..100 {
            let middle = (low + high) * dd(0.5);
            if self.coefficients(middle)[1].value() > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        self.coefficients(low)[0]
    }
}

const QUANTITIES: [&str; 3] = ["m", "½m′", "a and b of the slide"];
const REFERENCE: &str = "circle and circle, and the line from Q to P, in 32 digits";

fn short_crank(form: Form) -> ParameterSeries {
    ParameterSeries {
        figure: FIGURE,
        key: "short-crank".into(),
        description: "Single-dwell mechanism without a flywheel, as reduce writes it: its crank"
            .into(),
        parameter: ("crank's length", "m"),
        values: decades(-1, -7),
        quantities: &QUANTITIES,
        reference: REFERENCE,
        reason: "all velocities and accelerations are in proportion to the crank, and positions do not depend on it: two dyads' 8, 32 roundings",
        // In space the crank's end is a point of the whole mechanism.
        requirement: Box::new(move |crank, _| {
            let size = if form.is_in_space() {
                LENGTH_BC / crank
            } else {
                1.0
            };
            Requirement::from_rounding(ALLOWED_ROUNDINGS, DYAD_CONDITION * size.max(1.0))
        }),
        run: Box::new(move |crank| SingleDwell::new(crank).compare(form)),
    }
}

/// Magnification by the guide's distance d: m grows as d⁻², and so on.
fn near_requirement(distance: f64, quantity: usize) -> Requirement {
    let size = LENGTH_BC / distance;
    let factor = [2.0, 3.0, 3.0][quantity];
    Requirement::from_rounding(ALLOWED_ROUNDINGS, DYAD_CONDITION * factor * size)
}

fn near_path(form: Form) -> ParameterSeries {
    ParameterSeries {
        figure: FIGURE,
        key: "guide-near-path".into(),
        description: "Single-dwell mechanism, as reduce writes it: distance of the guide's pivot from the path of P, at a row"
            .into(),
        parameter: ("distance δ", "m"),
        values: decades(-2, -6),
        quantities: &QUANTITIES,
        reference: REFERENCE,
        reason: "places are known to their rounding, of 0.25 m: the line from Q to P to 0.25 eps/δ of its length, m as 2 of these, ½m′ and b as 3; 32 roundings of two dyads' 8",
        requirement: Box::new(near_requirement),
        run: Box::new(move |distance| {
            // Next to the peak, where ½m′ is largest: P moves by 0.07 m per rad there.
            let row = TAU * 60.0 / (POINTS - 1) as f64;
            SingleDwell::pivot_off_path(row + 5.0 * distance, distance).compare(form)
        }),
    }
}

fn peak_between_rows() -> ParameterSeries {
    let run = |distance: f64| -> RunResult {
        let mechanism = SingleDwell::pivot_off_path(BETWEEN_ROWS, distance);
        let scene = PlaneScene::parse("scene.toml", &mechanism.text())?;
        let printed = dwell_study::reduce(&scene, Some(POINTS), None)?
            .record
            .numbers;
        let peak = printed.into_iter().find(|number| number.name == "m.peak");
        let peak = peak.ok_or("no peak between the rows")?;
        let reference = mechanism.peak(BETWEEN_ROWS, 50.0 * distance);
        let value = (peak.value, peak.error.unwrap_or(f64::NAN));
        Ok(vec![scaled_cell(value, reference, reference.value())])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "peak-between-rows".into(),
        description: "Single-dwell mechanism, as reduce prints it: the peak of m between rows, by the distance of the guide's pivot from the path of P"
            .into(),
        parameter: ("distance δ", "m"),
        values: decades(-3, -6),
        quantities: &["largest m between the rows"],
        reference: "the zero of ½m′ of the same closed form, by halving in 32 digits",
        reason: "as at a row: 2 roundings of the places over δ; 32 roundings of two dyads' 8",
        requirement: Box::new(near_requirement),
        run: Box::new(run),
    }
}

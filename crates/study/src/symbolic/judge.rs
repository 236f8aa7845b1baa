//! Closed forms held against the numbers of the exact model.

use crate::error::size;
use crate::words::number;
use dwell_findings::Finding;
use dwell_geometry::{Reaction, Vec2};
use dwell_kinetostatics::{Coefficients, Exact, ExactWork, Reduced};
use dwell_scene::Scene;
use dwell_symbolic::{Form, Of};
use dwell_verify::spread;

/// Positions at which the forms are held against the numbers.
const POSITIONS: usize = 24;
/// The agreement asked for, of the largest quantity of its kind: some thousands of roundings.
const TOLERANCE: f64 = 1e-12;
/// What the forms themselves know no better widens the tolerance, up to this.
const BLUNTEST: f64 = 1e-8;

/// What is compared: its key, words, unit by what the coordinate is, and the scale.
const KINDS: [(&str, &str, &str); 5] = [
    (
        "symbolic-positions",
        "points, angles and travels by closed forms",
        "the mechanism's largest length, or 1 rad",
    ),
    ("symbolic-m", "m(q) by closed forms", "the largest m"),
    (
        "symbolic-half-dm",
        "½m′(q), differentiated as symbols",
        "the largest ½m′, or m over one radian or length",
    ),
    (
        "symbolic-a",
        "a of the reactions, the joint released as symbols: a = m₁₂",
        "the largest a of its unit",
    ),
    (
        "symbolic-b",
        "b of the reactions, the joint released as symbols: b = ∂m₁₂/∂q − ½ ∂m₁₁/∂q₂",
        "the largest b of its unit",
    ),
];

/// The largest difference of one kind.
#[derive(Debug, Clone, Default)]
struct Worst {
    absolute: f64,
    relative: f64,
    own: f64,
    place: String,
    met: bool,
}

/// Holds forms against the numbers at some positions.
pub(crate) struct Judge<'a> {
    scene: &'a Scene,
    exact: &'a Exact,
    at: Vec<(f64, Coefficients)>,
    work: ExactWork,
    size: f64,
    /// The largest m and ½m′, and of forces and moments a and b.
    scales: [f64; 2],
    reactions: [[f64; 2]; 2],
    worst: [Worst; 5],
    refused: Option<String>,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(scene: &'a Scene, exact: &'a Exact) -> Self {
        let mut judge = Self {
            scene,
            exact,
            at: Vec::new(),
            work: exact.work(),
            size: size(scene),
            scales: [0.0; 2],
            reactions: [[0.0; 2]; 2],
            worst: Default::default(),
            refused: None,
        };
        for q in spread(exact.range(), POSITIONS) {
            let mut out = exact.model().coefficients();
            match exact.coefficients(q, &mut judge.work, &mut out) {
                Ok(()) => judge.at.push((q, out)),
                Err(e) => judge.refused = Some(format!("at {}: {e}", number(q))),
            }
        }
        judge.scale();
        judge
    }

    /// The largest quantities of each kind; what may be zero throughout is measured by its neighbour.
    fn scale(&mut self) {
        let length = if self.size > 0.0 { self.size } else { 1.0 };
        let per = if self.exact.model().plan().is_angle(0) {
            1.0
        } else {
            length
        };
        for (_, out) in &self.at {
            self.scales[0] = self.scales[0].max(out.m.abs());
            self.scales[1] = self.scales[1].max(out.half_dm.abs());
            for (k, r) in self.exact.model().reactions().iter().enumerate() {
                let kind = &mut self.reactions[usize::from(r.component.unit() != "N")];
                kind[0] = kind[0].max(out.a[k].abs());
                kind[1] = kind[1].max(out.b[k].abs());
            }
        }
        self.scales[1] = self.scales[1].max(self.scales[0] / per);
        let [forces, moments] = &mut self.reactions;
        for j in 0..2 {
            moments[j] = moments[j].max(forces[j] * length);
        }
        for kind in &mut self.reactions {
            kind[1] = kind[1].max(kind[0] / per);
        }
    }

    pub(crate) fn hold(&mut self, form: &Form, reaction: Option<Reaction>) {
        let name = reaction.map(|r| self.scene.mechanism.reaction_name(r));
        for k in 0..self.at.len() {
            let q = self.at[k].0;
            let (found, own) = (form.evaluate(q), form.rounding(q));
            self.positions(form, q, &found, &own);
            let out = &self.at[k].1;
            let mut wanted = vec![(out.m, self.scales[0]), (out.half_dm, self.scales[1])];
            if let Some(reaction) = reaction {
                let all = self.exact.model().reactions();
                let at = all.iter().position(|&r| r == reaction).unwrap_or(0);
                let scale = self.reactions[usize::from(reaction.component.unit() != "N")];
                wanted.extend([(out.a[at], scale[0]), (out.b[at], scale[1])]);
            }
            let results = found.len() - wanted.len();
            for (j, (value, scale)) in wanted.into_iter().enumerate() {
                let difference = found[results + j] - value;
                let place = match (&name, j) {
                    (Some(name), 2..) => format!(", {name}"),
                    _ => String::new(),
                };
                self.meet(1 + j, (difference, own[results + j]), scale, q, &place);
            }
        }
    }

    /// Angles, travels and points.
    fn positions(&mut self, form: &Form, q: f64, found: &[f64], own: &[f64]) {
        let plan = self.exact.model().plan();
        let mut pose = plan.pose::<f64>();
        if plan.place(&[q], &mut pose).is_err() {
            return;
        }
        let mut roots = Vec::new();
        plan.roots(&pose, &mut roots);
        let axis = |v: Vec2, k: usize| if k == 0 { v.x } else { v.y };
        let length = if self.size > 0.0 { self.size } else { 1.0 };
        for (k, quantity) in form.quantities.iter().enumerate() {
            let (difference, scale) = match quantity.of {
                Of::Frame(frame) => {
                    let turn = Vec2::from_angle(found[k]).turn_back(pose.turn[frame]);
                    (turn.angle(), 1.0)
                }
                Of::Slide(slide) => (found[k] - pose.slide[slide], length),
                Of::Root(body, i) => {
                    let place = plan.tree().place[body].unwrap_or(0);
                    (found[k] - axis(roots[place], i), length)
                }
                Of::Closure(_) | Of::Centre(..) | Of::Coordinate | Of::Result => continue,
            };
            let place = format!(", {}", quantity.code);
            self.meet(0, (difference, own[k]), scale, q, &place);
        }
    }

    fn meet(&mut self, kind: usize, (difference, own): (f64, f64), scale: f64, q: f64, at: &str) {
        let absolute = difference.abs();
        let of = |x: f64| if x == 0.0 { 0.0 } else { x / scale };
        let relative = of(absolute);
        let worst = &mut self.worst[kind];
        worst.met = true;
        let own = of(own);
        worst.own = worst.own.max(if own.is_finite() { own } else { 0.0 });
        // What is no number is the worst.
        if worst.place.is_empty() || relative > worst.relative || relative.is_nan() {
            worst.absolute = absolute;
            worst.relative = if relative.is_nan() {
                f64::INFINITY
            } else {
                relative
            };
            let name = &self.scene.mechanism.actuators[0].name;
            worst.place = format!("{name} = {}{at}", number(q));
        }
    }

    pub(crate) fn findings(self) -> Vec<Finding> {
        let angle = self.exact.model().plan().is_angle(0);
        let units = if angle {
            [
                "m or rad",
                "kg m²",
                "kg m²",
                "kg m or kg m²",
                "kg m or kg m²",
            ]
        } else {
            ["m or rad", "kg", "kg/m", "kg or kg m", "kg/m or kg"]
        };
        let kinds = KINDS.into_iter().zip(units).zip(self.worst);
        let met = kinds.filter(|(_, worst)| worst.met);
        met.map(|(((key, compared, scale), unit), worst)| {
            // To a power of ten: every machine is to have the same one.
            let wide = (10.0 * worst.own).min(BLUNTEST);
            let tolerance = if wide > TOLERANCE {
                10.0_f64.powi(wide.log10().ceil() as i32)
            } else {
                TOLERANCE
            };
            let mut why = "both are computed from closed forms: thousands of roundings".to_owned();
            if tolerance > TOLERANCE {
                why = "ten times what a unit of rounding in the lengths does to the closed forms, \
                       to a power of ten"
                    .to_owned();
            }
            Finding {
                key: key.to_owned(),
                truth: "11 symbolic closed forms".to_owned(),
                compared: compared.to_owned(),
                over: format!("{} positions", self.at.len()),
                absolute: worst.absolute,
                unit: unit.to_owned(),
                relative: worst.relative,
                scale: scale.to_owned(),
                pass: self.refused.is_none() && worst.relative <= tolerance,
                worst: self.refused.clone().unwrap_or(worst.place),
                tolerance,
                why,
                condition: (worst.own / f64::EPSILON).max(1.0),
                integrated: false,
            }
        })
        .collect()
    }
}

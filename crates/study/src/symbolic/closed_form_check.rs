//! Comparison of closed forms with the exact numerical model.

use crate::estimate::relative;
use crate::number_format::number;
use dwell_findings::{Check, Finding};
use dwell_geometry::{Reaction, Vec2};
use dwell_kinetostatics::{Coefficients, ExactModel, ExactWorkspace, ReducedModel};
use dwell_scene::PlaneScene;
use dwell_symbolic::{ClosedForm, QuantityOrigin};
use dwell_verify::spread;

/// Number of positions of the comparison.
pub(crate) const POSITIONS: usize = 24;
/// Tolerance relative to the largest quantity of its kind: some thousands of roundings.
const TOLERANCE: f64 = 1e-12;
/// The rounding error of the closed forms widens the tolerance, up to this.
const MAX_TOLERANCE: f64 = 1e-8;
/// The comparisons: key, description and scale.
const KINDS: [(&str, &str, &str); 5] = [
    (
        "symbolic-positions",
        "points, angles and travels by closed forms",
        "the size of the mechanism, or 1 rad",
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
struct LargestDifference {
    absolute: f64,
    relative: f64,
    rounding: f64,
    /// Empty if nothing was compared.
    location: String,
}

/// Compares closed forms with the numerical model at some positions.
pub(crate) struct ClosedFormCheck<'a> {
    scene: &'a PlaneScene,
    exact: &'a ExactModel,
    exact_values: Vec<(f64, Coefficients)>,
    workspace: ExactWorkspace,
    size: f64,
    /// The largest m and ½m′; of forces and of moments, the largest a and b.
    scales: [f64; 2],
    reaction_scales: [[f64; 2]; 2],
    largest: [LargestDifference; 5],
    failure: Option<String>,
}

impl<'a> ClosedFormCheck<'a> {
    pub(crate) fn new(scene: &'a PlaneScene, exact: &'a ExactModel) -> Self {
        let mut check = Self {
            scene,
            exact,
            exact_values: Vec::new(),
            workspace: exact.workspace(),
            size: scene.mechanism.size(),
            scales: [0.0; 2],
            reaction_scales: [[0.0; 2]; 2],
            largest: Default::default(),
            failure: None,
        };
        for q in spread(exact.range(), POSITIONS) {
            let mut out = exact.model().coefficient_buffer();
            match exact.coefficients(q, &mut check.workspace, &mut out) {
                Ok(()) => check.exact_values.push((q, out)),
                Err(e) => check.failure = Some(format!("at {}: {e}", number(q))),
            }
        }
        check.compute_scales();
        check
    }

    /// The largest quantities of each kind; one that may be zero throughout is scaled by a related one.
    fn compute_scales(&mut self) {
        let per = if self.exact.model().plan().is_angle(0) {
            1.0
        } else {
            self.size
        };
        for (_, out) in &self.exact_values {
            self.scales[0] = self.scales[0].max(out.m.abs());
            self.scales[1] = self.scales[1].max(out.half_dm.abs());
            for (k, r) in self.exact.model().reactions().iter().enumerate() {
                let kind = &mut self.reaction_scales[usize::from(r.component.unit() != "N")];
                kind[0] = kind[0].max(out.a[k].abs());
                kind[1] = kind[1].max(out.b[k].abs());
            }
        }
        self.scales[1] = self.scales[1].max(self.scales[0] / per);
        let [forces, moments] = &mut self.reaction_scales;
        for j in 0..2 {
            moments[j] = moments[j].max(forces[j] * self.size);
        }
        for kind in &mut self.reaction_scales {
            kind[1] = kind[1].max(kind[0] / per);
        }
    }

    pub(crate) fn compare(&mut self, form: &ClosedForm, reaction: Option<Reaction>) {
        let name = reaction.map(|r| self.scene.mechanism.reaction_name(r));
        for k in 0..self.exact_values.len() {
            let q = self.exact_values[k].0;
            let (values, rounding) = (form.evaluate(q), form.rounding_error(q));
            self.compare_positions(form, q, &values, &rounding);
            let out = &self.exact_values[k].1;
            let mut expected = vec![(out.m, self.scales[0]), (out.half_dm, self.scales[1])];
            if let Some(reaction) = reaction {
                let all = self.exact.model().reactions();
                let at = all.iter().position(|&r| r == reaction).unwrap_or(0);
                let scale = self.reaction_scales[usize::from(reaction.component.unit() != "N")];
                expected.extend([(out.a[at], scale[0]), (out.b[at], scale[1])]);
            }
            let results = values.len() - expected.len();
            for (j, (value, scale)) in expected.into_iter().enumerate() {
                let difference = values[results + j] - value;
                let location = match (&name, j) {
                    (Some(name), 2..) => format!(", {name}"),
                    _ => String::new(),
                };
                let rounding = rounding[results + j];
                self.add_difference(1 + j, difference, rounding, scale, q, &location);
            }
        }
    }

    /// Angles, travels and points.
    fn compare_positions(&mut self, form: &ClosedForm, q: f64, values: &[f64], rounding: &[f64]) {
        let plan = self.exact.model().plan();
        let mut pose = plan.pose::<f64>();
        if plan.positions(&[q], &mut pose).is_err() {
            return;
        }
        let mut joint_origins = Vec::new();
        plan.joint_origins(&pose, &mut joint_origins);
        let axis = |v: Vec2, k: usize| if k == 0 { v.x } else { v.y };
        let length = self.size;
        for (k, quantity) in form.quantities.iter().enumerate() {
            let (difference, scale) = match quantity.origin {
                QuantityOrigin::Frame(frame) => {
                    let rotation = Vec2::from_angle(values[k]).rotate_inverse(pose.rotation[frame]);
                    (rotation.angle(), 1.0)
                }
                QuantityOrigin::Slide(slide) => (values[k] - pose.slide_travel[slide], length),
                QuantityOrigin::JointOrigin(body, i) => {
                    let location = plan.tree().joint_of_body[body].unwrap_or(0);
                    (values[k] - axis(joint_origins[location], i), length)
                }
                QuantityOrigin::Closure(_)
                | QuantityOrigin::MassCentre(..)
                | QuantityOrigin::Coordinate
                | QuantityOrigin::Result => continue,
            };
            let location = format!(", {}", quantity.code);
            self.add_difference(0, difference, rounding[k], scale, q, &location);
        }
    }

    fn add_difference(
        &mut self,
        kind: usize,
        difference: f64,
        rounding: f64,
        scale: f64,
        q: f64,
        location: &str,
    ) {
        let largest = &mut self.largest[kind];
        let rounding = relative(rounding, scale);
        if rounding.is_finite() {
            largest.rounding = largest.rounding.max(rounding);
        }
        let absolute = difference.abs();
        // NaN counts as the worst.
        let relative = match relative(absolute, scale) {
            relative if relative.is_nan() => f64::INFINITY,
            relative => relative,
        };
        if largest.location.is_empty() || relative > largest.relative || absolute.is_nan() {
            largest.absolute = absolute;
            largest.relative = relative;
            let name = &self.scene.mechanism.actuators[0].name;
            largest.location = format!("{name} = {}{location}", number(q));
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
        let kinds = KINDS.into_iter().zip(units).zip(self.largest);
        let compared_kinds = kinds.filter(|(_, largest)| !largest.location.is_empty());
        compared_kinds.map(|(((key, compared, scale), unit), largest)| {
            // Rounded to a power of ten, so that it is the same on every machine.
            let widened = (10.0 * largest.rounding).min(MAX_TOLERANCE);
            let tolerance = if widened > TOLERANCE {
                10.0_f64.powi(widened.log10().ceil() as i32)
            } else {
                TOLERANCE
            };
            let why = if tolerance > TOLERANCE {
                "ten times what a unit of rounding in the lengths does to the closed forms, to a power of ten"
            } else {
                "both are computed from closed forms: thousands of roundings"
            };
            Finding {
                key: key.to_owned(),
                check: Check::ClosedForms,
                comparison: compared.to_owned(),
                domain: format!("{} positions", self.exact_values.len()),
                absolute_difference: largest.absolute,
                unit: unit.to_owned(),
                relative_difference: largest.relative,
                scale: scale.to_owned(),
                pass: self.failure.is_none() && largest.relative <= tolerance,
                worst_at: self.failure.clone().unwrap_or(largest.location),
                tolerance,
                tolerance_reason: why.to_owned(),
                condition_number: (largest.rounding / f64::EPSILON).max(1.0),
                integrated: false,
            }
        })
        .collect()
    }
}

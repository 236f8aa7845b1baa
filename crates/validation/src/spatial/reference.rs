//! A case against a reference of 25 digits: samples of the reduced parameters, and free motions.

use super::claims::{COMPONENTS, NAMES, SpaceClaims};
use super::states::in_units;
use crate::cases::reference::{entries, number, numbers, read_file};
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_dynamics::{CoordinateMode, Machine, Orbit, ReducedState};
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Placement, Rotation, Vec3, vec3};
use dwell_kinetostatics::space::Axes;
use dwell_study::PreparedSpaceScene;
use dwell_study::number_format::count;
use dwell_study::reduce::compute::ReducedScene as _;
use dwell_verify::{ClaimedState, FindingSpec, Pose, SubjectError};
use serde_json::Value;
use std::path::Path;

const INERTIA: FindingSpec<'_> = FindingSpec {
    key: "reference-inertia",
    check: Check::ReferenceValues,
    comparison: "m, ½m′ and the weight's w with the reference of 25 digits",
    scale: "the largest of each",
    tolerance: 1e-12,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};
const REACTIONS: FindingSpec<'_> = FindingSpec {
    key: "reference-reactions",
    comparison: "a, b and the weight's c with the reference of 25 digits",
    ..INERTIA
};
const PLACEMENTS: FindingSpec<'_> = FindingSpec {
    key: "reference-placements",
    comparison: "positions and rotations of all bodies with the reference of 25 digits",
    scale: "the size of the mechanism, or one radian",
    // The largest seen in a case is 1.8e-14.
    ..INERTIA
};
const INERTIAS: FindingSpec<'_> = FindingSpec {
    key: "reference-inertias",
    comparison: "the generalised inertias with the reference of 25 digits",
    scale: "the largest of each position",
    ..INERTIA
};
const PERIOD: FindingSpec<'_> = FindingSpec {
    key: "reference-period",
    check: Check::Period,
    comparison: "the period by quadrature with the reference",
    scale: "the period",
    tolerance: 1e-12,
    tolerance_reason: "the quadrature converges to rounding",
};
const INERTIA_OF_TWO: FindingSpec<'_> = FindingSpec {
    comparison: "the generalised inertias and the actuators' actions with the reference of 25 digits",
    // The largest seen in a case is 6.5e-16.
    tolerance: 5e-14,
    ..INERTIA
};
const REACTIONS_OF_TWO: FindingSpec<'_> = FindingSpec {
    comparison: "the reactions under the weight, in motion, with the reference of 25 digits",
    scale: "the largest force or moment",
    // The largest seen in a case is 5.0e-15.
    tolerance: 5e-13,
    ..REACTIONS
};
/// Speeds and accelerations at which a reference of two coordinates is compared.
const RATES: [[f64; 4]; 2] = [[1.3, -0.7, 0.4, 0.2], [-0.9, 1.1, 0.6, -0.5]];

/// What is compared with a reference: poses and generalised inertias at coordinates.
pub type ClaimedAt<'a> = &'a dyn Fn(&[f64]) -> Result<ClaimedState, SubjectError>;

/// A reference as its file has it.
#[derive(Debug)]
pub struct SpaceReference(Value);

/// Coordinates and generalised inertias of a sample of two coordinates.
const OF_TWO: [&str; 5] = ["beta", "sigma", "M_bb", "M_bs", "M_ss"];

/// Where a body is in a sample.
fn placement(sample: &Value, body: &str) -> Option<Placement> {
    let vector = |value: &Value| match entries(value) {
        [x, y, z] => Some([number(x)?, number(y)?, number(z)?]),
        _ => None,
    };
    let body = &sample["bodies"][body];
    let rows = entries(&body["rotation_rows"]).iter().map(vector);
    let rows = rows.collect::<Option<Vec<_>>>()?.try_into().ok()?;
    let [x, y, z] = vector(&body["position"])?;
    Some(Placement {
        position: vec3(x, y, z),
        rotation: Rotation::of_rows(rows)?,
    })
}

/// The names of the components of a reaction in a reference.
const REFERENCE_NAMES: [&str; COMPONENTS] = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"];

/// a, b and c of the whole weight of a reaction in a sample. What the joint cannot transmit there is not in the reference: it is zero.
fn reaction(sample: &Value, column: &str) -> [f64; 3] {
    let (joint, component) = column.split_once('.').unwrap_or((column, ""));
    let component = NAMES.iter().position(|name| *name == component);
    let component = component.map_or("", |k| REFERENCE_NAMES[k]);
    let parts = &sample["reactions"][format!("{joint}.{component}")];
    let all = [&parts["a"], &parts["b"], &parts["c"]["gravity"]];
    all.map(|part| number(part).unwrap_or(0.0))
}

/// A value of a sample of two coordinates by what each product of rates gives it.
fn combined(parts: &Value, rates: [&[f64]; 2]) -> Option<f64> {
    let [[b, s], [b2, s2]] = rates else {
        return None;
    };
    let products = [*b2, *s2, b * b, s * s, b * s];
    let parts = numbers(parts, ["b''", "s''", "b'b'", "s's'", "b's'"])?;
    let pairs = parts.into_iter().zip(products);
    Some(pairs.fold(0.0, |sum, (part, product)| sum + part * product))
}

impl SpaceReference {
    /// The reference in a file.
    ///
    /// # Errors
    /// [`ValidationError::Reference`] where the file cannot be read.
    pub fn read(path: &Path) -> Result<Self, ValidationError> {
        read_file(path).map(Self)
    }

    /// Where it comes from.
    pub(super) fn source(&self) -> &str {
        self.0["source"].as_str().unwrap_or_default()
    }

    /// States of the motion of the scene: times, s, and coordinates, rad or m.
    pub(super) fn states(&self) -> Vec<(f64, Vec<f64>)> {
        let state = |state: &Value| {
            let q = entries(&state["q"]).iter().map(number);
            Some((number(&state["t"])?, q.collect::<Option<_>>()?))
        };
        let all = entries(&self.0["motion"]["states"]).iter();
        all.filter_map(state).collect()
    }

    fn samples(&self) -> &[Value] {
        entries(&self.0["samples"])
    }

    /// The samples that have numbers of these keys.
    fn samples_with<const N: usize>(
        &self,
        keys: [&'static str; N],
    ) -> impl Iterator<Item = (&Value, [f64; N])> {
        let all = self.samples().iter();
        all.filter_map(move |sample| Some((sample, numbers(sample, keys)?)))
    }

    fn domain(&self) -> String {
        format!("{} positions of the reference", self.samples().len())
    }

    /// The finding on placements; none where the reference has no placements.
    pub fn placements(&self, claims: &SpaceClaims<'_>, claimed: ClaimedAt<'_>) -> Option<Finding> {
        let mut worst = Differences::default();
        for (sample, [q]) in self.samples_with(["q"]) {
            let found = claimed(&[q]).unwrap_or_default().poses;
            for (b, body) in claims.scene().mechanism.bodies.iter().enumerate() {
                let Some(wanted) = placement(sample, &body.name) else {
                    continue;
                };
                let found = found.get(b);
                let error = found.map_or(f64::NAN, |found| apart(claims, b, found, &wanted));
                worst.add(error, 1.0, "", || format!("q = {q:.4}, {}", body.name));
            }
        }
        worst.finding(&PLACEMENTS, &self.domain())
    }

    /// The finding on generalised inertias.
    pub fn inertias(&self, claimed: ClaimedAt<'_>) -> Option<Finding> {
        let mut worst = Differences::default();
        let of_one = self.samples_with(["q", "m"]);
        let of_one = of_one.map(|(_, [q, m])| (vec![q], vec![m]));
        let of_two = self.samples_with(OF_TWO);
        let of_two = of_two.map(|(_, [b, s, bb, bs, ss])| (vec![b, s], vec![bb, bs, bs, ss]));
        for (q, inertias) in of_one.chain(of_two) {
            let found = claimed(&q).unwrap_or_default().inertias;
            let scale = largest(&inertias);
            for (k, wanted) in inertias.iter().enumerate() {
                let found = found.get(k).copied().unwrap_or(f64::NAN);
                worst.compare([found, *wanted, scale], "kg m2", || format!("q = {q:?}"));
            }
        }
        worst.finding(&INERTIAS, &self.domain())
    }

    /// The findings of a case of one coordinate.
    pub(super) fn findings_of_one(
        &self,
        claims: &SpaceClaims<'_>,
        prepared: &PreparedSpaceScene<'_>,
    ) -> Result<Vec<Finding>, ValidationError> {
        let [mut inertia, mut reactions] = <[Differences; 2]>::default();
        let samples = self.samples();
        let q = samples.iter().map(|sample| number(&sample["q"]));
        let q: Vec<f64> = q.map(|q| q.unwrap_or(f64::NAN)).collect();
        let found = prepared.coefficients(&q)?;
        let columns = prepared.unit_loads(&q)?;
        let columns = columns.map_or_else(Vec::new, |loads| loads.columns(prepared));
        let gravity = prepared.weight().unwrap_or(0.0);
        let column = |name: &str, k: usize| {
            let column = columns.iter().find(|(c, _)| c.name == name);
            column.map_or(0.0, |(_, values)| gravity * values[k])
        };
        let names = prepared.reaction_units();
        let scales = [0, 1, 2].map(|k| {
            let of_sample = |s| names.iter().map(move |(name, _)| reaction(s, name)[k]);
            largest(&samples.iter().flat_map(of_sample).collect::<Vec<_>>())
        });
        let weight = |sample: &Value| number(&sample["w"]["gravity"]);
        let w_max = largest(&samples.iter().filter_map(weight).collect::<Vec<_>>());
        for (k, (sample, at)) in samples.iter().zip(&found).enumerate() {
            let place = |what: &str| format!("q = {:.4}, {what}", q[k]);
            let [m, half_dm] = numbers(sample, ["m", "half_dm"]).unwrap_or([f64::NAN; 2]);
            inertia.compare([at.m, m, m], "kg m2", || place("m"));
            inertia.compare([at.half_dm, half_dm, m], "kg m2/rad", || place("½m′"));
            if let Some(w) = weight(sample) {
                inertia.compare([column("weight.w", k), w, w_max], "N m", || place("w"));
            }
            for (i, (name, _)) in names.iter().enumerate() {
                let found = [at.a[i], at.b[i], column(&format!("{name}.c.weight"), k)];
                for (j, wanted) in reaction(sample, name).into_iter().enumerate() {
                    reactions.compare([found[j], wanted, scales[j]], "", || place(name));
                }
            }
        }
        let found = [
            inertia.finding(&INERTIA, &self.domain()),
            reactions.finding(&REACTIONS, &self.domain()),
            self.period(prepared)?,
            self.placements(claims, &|q| claims.at_rest::<f64>(q)),
        ];
        Ok(found.into_iter().flatten().collect())
    }

    /// The periods of free motions by quadrature, of those whose start is given by coordinate and speed.
    fn period(
        &self,
        prepared: &PreparedSpaceScene<'_>,
    ) -> Result<Option<Finding>, ValidationError> {
        let mut worst = Differences::default();
        for motion in entries(&self.0["free_motion"]) {
            let loads = match motion["loads"].as_str() {
                Some("none") => &[][..],
                Some("as defined") => &prepared.scene.loads,
                _ => continue,
            };
            let Some([q, q_dot, period]) = numbers(motion, ["q0", "qdot0", "period_s"]) else {
                continue;
            };
            let model = prepared.model_for(&[])?;
            let machine = Machine::new(model, loads, vec![CoordinateMode::Free], &[]).ok();
            let start = ReducedState { t: 0.0, q, q_dot };
            let orbit = machine.and_then(|machine| Orbit::loaded(&machine, start).ok());
            let found = orbit.map_or(f64::NAN, |orbit| orbit.period);
            let place = || format!("from {q_dot} rad/s at q = {q:.4}");
            worst.compare([found, period, period], "s", place);
        }
        let domain = count(worst.count(), "free motion");
        Ok(worst.finding(&PERIOD, &domain))
    }

    /// The findings of a case of two coordinates.
    pub(super) fn findings_of_two(&self, claims: &SpaceClaims<'_>) -> Vec<Finding> {
        let [mut inertia, mut reactions] = <[Differences; 2]>::default();
        let rates = RATES.each_ref().map(|row| in_units(claims.model(), row));
        let rates = rates.each_ref().map(Vec::as_slice);
        let joints = &claims.scene().mechanism.joints;
        for (sample, [beta, sigma, bb, bs, ss]) in self.samples_with(OF_TWO) {
            let (q, inertias) = ([beta, sigma], [bb, bs, bs, ss]);
            let place = |what: &str| format!("q = {beta:.4} {sigma:.4}, {what}");
            let state = claims.state::<f64>(0.0, [&q, rates[0], rates[1]], Axes::Ground);
            let Ok(state) = state else {
                inertia.compare([f64::NAN, 0.0, 1.0], "", || place("no pose"));
                continue;
            };
            let scale = largest(&inertias);
            for (found, wanted) in state.inertias.iter().zip(inertias) {
                inertia.compare([*found, wanted, scale], "kg m2", || place("inertia"));
            }
            let actions = ["beta", "sigma"].map(|name| {
                let parts = &sample["generalised_inertia_forces"][format!("tau_{name}")];
                let weight = number(&sample["w_gravity"][name]);
                let action = combined(parts, rates).zip(weight);
                action.map_or(f64::NAN, |(inertial, weight)| inertial - weight)
            });
            let scale = largest(&actions);
            for (found, wanted) in state.tau.iter().zip(actions) {
                inertia.compare([*found, wanted, scale], "N m", || place("action"));
            }
            let all = sample["reactions"].as_object().into_iter().flatten();
            let all = all.filter_map(|(name, parts)| {
                let (joint, component) = name.split_once('.')?;
                let k = REFERENCE_NAMES.iter().position(|of| *of == component)?;
                let value = combined(parts, rates)? + number(&parts["gravity"])?;
                Some((joint, k, value))
            });
            let all: Vec<(&str, usize, f64)> = all.collect();
            let scales = [0, 1].map(|kind| {
                let of_kind = all.iter().filter(|(_, k, _)| k / 3 == kind);
                largest(of_kind.map(|(.., value)| value))
            });
            for (joint, k, wanted) in all {
                let index = joints.iter().position(|j| j.name == joint);
                let found = index.map_or(f64::NAN, |j| state.reactions[COMPONENTS * j + k]);
                let unit = ["N", "N m"][k / 3];
                reactions.compare([found, wanted, scales[k / 3]], unit, || place(joint));
            }
        }
        let found = [
            inertia.finding(&INERTIA_OF_TWO, &self.domain()),
            reactions.finding(&REACTIONS_OF_TWO, &self.domain()),
        ];
        found.into_iter().flatten().collect()
    }
}

/// How far a body is from where it should be, parts of the size or rad; how it stands about the line of its two balls is nobody's.
fn apart(claims: &SpaceClaims<'_>, body: usize, found: &Pose, wanted: &Placement) -> f64 {
    let mobility = claims.model().plan().mobility();
    let idle = mobility.idle.iter().find(|idle| idle.body.0 == body);
    let turned = |v: Vec3| (found.rotation.apply(v) - wanted.rotation.apply(v)).norm();
    let turn: f64 = match idle {
        Some(idle) => turned(idle.axis),
        None => Vec3::AXES.map(turned).into_iter().sum(),
    };
    let point = idle.map_or(Vec3::ZERO, |idle| idle.point);
    let gap = found.position + found.rotation.apply(point)
        - (wanted.position + wanted.rotation.apply(point));
    turn + gap.norm() / claims.size()
}

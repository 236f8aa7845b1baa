//! Reactions that a scene gives over the angle of a body of varying inertia: against its text, read and interpolated otherwise,
//! and against reference values of the mechanism that the body stands for.

use crate::cases::reference::Reference;
use crate::checked::angle_table::AngleTable;
use crate::written::poses::units::Units;
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::KnownReaction;
use dwell_scene::PlaneScene;

/// Angles that the scene's text is compared at, by the golden ratio: none at a position of the table.
const ANGLES: usize = 24;
/// Angular velocity, rad/s, and acceleration, rad/s², of the comparison: of one size, so that a and b both count.
const MOTION: [f64; 2] = [1.3, -1.7];
/// Polynomials through a series differ from it by 1e-13 of its largest value; some roundings of the series besides.
const TEXT_TOLERANCE: f64 = 5e-13;
/// As of every reference value: they have more digits than are computed.
const REFERENCE_TOLERANCE: f64 = 1e-12;

/// The findings of what one scene claims, where another is right; none without such reactions.
pub(crate) fn known_reaction_findings(
    right: &PlaneScene,
    claims: &PlaneScene,
    reference: &Reference,
) -> Vec<Finding> {
    let claimed: Vec<&KnownReaction> = of(claims);
    if of(right).is_empty() {
        return Vec::new();
    }
    let mut findings = vec![text_finding(right, &claimed)];
    if !reference.known_reactions.is_empty() {
        findings.push(reference_finding(&claimed, reference));
    }
    findings
}

/// The reaction of a name and a unit: a moment is not compared with a force.
fn find<'a>(
    claimed: &[&'a KnownReaction],
    name: &str,
    is_moment: bool,
) -> Option<&'a KnownReaction> {
    let mut claimed = claimed.iter().copied();
    claimed.find(|reaction| reaction.name == name && reaction.is_moment == is_moment)
}

fn of(scene: &PlaneScene) -> Vec<&KnownReaction> {
    let all = scene.varying_inertias.iter();
    all.flat_map(|varying| &varying.reactions).collect()
}

/// The largest difference of pairs of numbers, absolute and relative to the largest of the second ones.
#[derive(Default)]
struct Largest {
    difference: f64,
    scale: f64,
    at: String,
    count: usize,
}

impl Largest {
    fn add(&mut self, value: f64, expected: f64, at: impl Fn() -> String) {
        let difference = (value - expected).abs();
        if difference > self.difference || difference.is_nan() {
            (self.difference, self.at) = (difference, at());
        }
        self.scale = self.scale.max(expected.abs());
        self.count += 1;
    }

    fn finding(
        self,
        key: &str,
        check: Check,
        (comparison, scale, reason): (&str, &str, &str),
        tolerance: f64,
    ) -> Finding {
        let relative = if self.difference == 0.0 {
            0.0
        } else {
            self.difference / self.scale
        };
        Finding {
            comparison: comparison.to_owned(),
            domain: format!("{} values", self.count),
            unit: "N".to_owned(),
            scale: scale.to_owned(),
            worst_at: self.at,
            tolerance_reason: reason.to_owned(),
            pass: self.count > 0 && relative <= tolerance,
            ..Finding::new(key, check, [self.difference, relative], tolerance)
        }
    }
}

fn text_finding(right: &PlaneScene, claimed: &[&KnownReaction]) -> Finding {
    let mut largest = Largest::default();
    let root: toml::Table = right.source.inner().parse().unwrap_or_default();
    let bodies = root.get("bodies").and_then(toml::Value::as_table);
    let units = Units::read(&root);
    let tables = bodies.into_iter().flatten();
    let tables = tables.filter_map(|(_, body)| AngleTable::read(body.as_table()?, &units?));
    for table in tables {
        for k in 0..ANGLES {
            let angle = 0.2 + std::f64::consts::TAU * (0.618_033_988_749_895 * k as f64).fract();
            for expected in table.reactions_at(angle, MOTION) {
                let found = find(claimed, expected.name, expected.is_moment);
                let [speed, acceleration] = MOTION;
                let value = found.map_or(f64::NAN, |r| r.value(angle, speed, acceleration));
                largest.add(value, expected.value, || {
                    format!("theta = {angle:.6} rad, {}", expected.name)
                });
            }
        }
    }
    let comparison =
        "reactions within the mechanism of a varying inertia with those of the scene's text";
    let reason = "polynomials through a series differ from it by 1e-13";
    largest.finding(
        "known-reactions",
        Check::WrittenLaws,
        (comparison, "the largest of these reactions", reason),
        TEXT_TOLERANCE,
    )
}

fn reference_finding(claimed: &[&KnownReaction], reference: &Reference) -> Finding {
    let mut largest = Largest::default();
    for sample in &reference.known_reactions {
        let found = find(claimed, &sample.name, sample.is_moment);
        let value = |speed: f64, acceleration: f64| {
            found.map_or(f64::NAN, |r| r.value(sample.angle, speed, acceleration))
        };
        let at = || format!("theta = {:.6} rad, {}", sample.angle, sample.name);
        largest.add(value(0.0, 1.0), sample.a, at);
        largest.add(value(1.0, 0.0), sample.b, at);
    }
    let comparison =
        "a and b of reactions within the mechanism of a varying inertia with reference values";
    let reason = "published to more digits than are computed; a margin for the computation";
    largest.finding(
        "published-known-reactions",
        Check::ReferenceValues,
        (comparison, "the largest of these coefficients", reason),
        REFERENCE_TOLERANCE,
    )
}

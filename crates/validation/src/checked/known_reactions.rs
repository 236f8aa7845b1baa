//! Reactions that a scene gives over the angle of a body of varying inertia: against its text, read and interpolated otherwise,
//! and against reference values of the mechanism that the body stands for.

use crate::cases::reference::Reference;
use crate::checked::angle_table::AngleTable;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use crate::written::poses::units::Units;
use dwell_findings::{Check, Finding};
use dwell_kinetostatics::KnownReaction;
use dwell_scene::PlaneScene;
use dwell_verify::FindingSpec;

/// Angles that the scene's text is compared at, by the golden ratio: none at a position of the table.
const ANGLES: usize = 24;
/// Angular velocity, rad/s, and acceleration, rad/s², of the comparison: of one size, so that a and b both count.
const MOTION: [f64; 2] = [1.3, -1.7];
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

const TEXT: FindingSpec<'_> = FindingSpec {
    key: "known-reactions",
    check: Check::WrittenLaws,
    comparison: "reactions within the mechanism of a varying inertia with those of the scene's text",
    scale: "the largest of these reactions",
    // Polynomials through a series differ from it by 1e-13 of its largest value; some roundings of the series besides.
    tolerance: 5e-13,
    tolerance_reason: "polynomials through a series differ from it by 1e-13",
};
const REFERENCE: FindingSpec<'_> = FindingSpec {
    key: "published-known-reactions",
    check: Check::ReferenceValues,
    comparison: "a and b of reactions within the mechanism of a varying inertia with reference values",
    scale: "the largest of these coefficients",
    tolerance: 1e-12,
    tolerance_reason: "published to more digits than are computed; a margin for the computation",
};

/// A value, what it should be, and where.
type Compared = (f64, f64, String);

/// The finding of some values, relative to the largest that they should have; it fails where there are none.
fn finding(spec: &FindingSpec<'_>, values: Vec<Compared>) -> Finding {
    let scale = largest(values.iter().map(|(_, expected, _)| expected));
    let domain = format!("{} values", values.len());
    let mut worst = Differences::default();
    for (value, expected, place) in values {
        worst.compare([value, expected, scale], "N", || place);
    }
    if worst.count() == 0 {
        worst.fail("there are no values");
    }
    worst.finding(spec, &domain).unwrap_or_default()
}

fn text_finding(right: &PlaneScene, claimed: &[&KnownReaction]) -> Finding {
    let mut values = Vec::new();
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
                let place = format!("theta = {angle:.6} rad, {}", expected.name);
                values.push((value, expected.value, place));
            }
        }
    }
    finding(&TEXT, values)
}

fn reference_finding(claimed: &[&KnownReaction], reference: &Reference) -> Finding {
    let mut values = Vec::new();
    for sample in &reference.known_reactions {
        let found = find(claimed, &sample.name, sample.is_moment);
        let value = |speed: f64, acceleration: f64| {
            found.map_or(f64::NAN, |r| r.value(sample.angle, speed, acceleration))
        };
        let place = format!("theta = {:.6} rad, {}", sample.angle, sample.name);
        values.push((value(0.0, 1.0), sample.a, place.clone()));
        values.push((value(1.0, 0.0), sample.b, place));
    }
    finding(&REFERENCE, values)
}

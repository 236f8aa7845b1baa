//! Check 9: published values.

use super::coefficient_units;
use crate::case::Case;
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use crate::pose::lifted;
use crate::subject::{Subject, SubjectError};
use dwell_findings::{Check, Finding};
use dwell_geometry::{BodyId, Vec2};

/// A point of a body with its published position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedPoint {
    /// The body.
    pub body: BodyId,
    /// The point in the body's own frame, m.
    pub local: Vec2,
    /// Its published position, m.
    pub position: Vec2,
}

/// Published values at one position. Fields without a published value are empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PublishedSample {
    /// The coordinate, rad.
    pub q: f64,
    /// m, kg m².
    pub m: Option<f64>,
    /// ½ dm/dq, kg m²/rad.
    pub half_dm: Option<f64>,
    /// (reaction, a, b), the reaction by its index in
    /// [`dwell_geometry::Mechanism::reactions`].
    pub reactions: Vec<(usize, f64, f64)>,
    /// Points of bodies.
    pub points: Vec<PublishedPoint>,
}

/// Key, comparison and scale of each kind of value.
const QUANTITIES: [[&str; 3]; 5] = [
    [
        "published-m",
        "m with the published m",
        "the largest published m",
    ],
    [
        "published-half-dm",
        "half dm/dq with the published one",
        "the largest published half dm/dq",
    ],
    [
        "published-a",
        "a with the published a of the same reactions",
        "the largest published a of the same unit, m among the moments",
    ],
    [
        "published-b",
        "b with the published b of the same reactions",
        "the largest published b of the same unit, half dm/dq among the moments",
    ],
    [
        "published-points",
        "points of bodies with where they were published to be",
        "the largest published coordinate",
    ],
];

/// One finding for each kind of value that was published. A kind without published values has no finding.
///
/// Scales come from the published values themselves, over all samples.
pub fn published(
    case: &Case<'_>,
    subject: &dyn Subject,
    samples: &[PublishedSample],
) -> Vec<Finding> {
    let mut worst: [LargestDifference; 5] = Default::default();
    let Ok(dense) = case.mechanism.dense() else {
        return Vec::new();
    };
    let moments: Vec<bool> = dense.reactions.iter().map(|r| r.is_moment).collect();
    for sample in samples {
        let poses = subject.poses(sample.q).unwrap_or_default();
        let frames = dense.moved_frames(&poses);
        let condition_number = frames.map_or(1.0, |frames| dense.condition_number(&frames));
        let result = compare(&moments, subject, sample, |kind, k, difference, unit| {
            let comparison = Comparison {
                numbers: [difference, scale(&moments, samples, kind, k), 0.0],
                unit,
                condition_number,
            };
            worst[kind].record(&comparison, || {
                let name = match (kind, dense.reactions.get(k), dense.bodies.get(k)) {
                    (2 | 3, Some(reaction), _) => format!(", {}", reaction.name),
                    (4, _, body) => format!(", {}", body.map_or("?", |b| &b.name)),
                    _ => String::new(),
                };
                format!("q = {} rad{name}", sample.q)
            });
        });
        if let Err(error) = result {
            worst.iter_mut().for_each(|w| w.record_error(&error));
        }
    }
    let is_given = |kind: usize, sample: &PublishedSample| match kind {
        0 => sample.m.is_some(),
        1 => sample.half_dm.is_some(),
        2 | 3 => !sample.reactions.is_empty(),
        _ => !sample.points.is_empty(),
    };
    let all = QUANTITIES.into_iter().zip(worst).enumerate();
    let given = all.filter(|(kind, _)| samples.iter().any(|s| is_given(*kind, s)));
    let finding = |(_, ([key, comparison, scale], worst)): (usize, ([&str; 3], _))| {
        let spec = FindingSpec {
            key,
            check: Check::ReferenceValues,
            comparison,
            scale,
            tolerance: 1e-12,
            tolerance_reason: "published to more digits than are computed; a margin for the computation",
        };
        spec.finding(format!("{} published positions", samples.len()), worst)
    };
    given.map(finding).collect()
}

/// The largest published value of a kind; for a and b, of the unit of reaction `k`.
fn scale(moments: &[bool], samples: &[PublishedSample], kind: usize, k: usize) -> f64 {
    let is_moment = |k| moments.get(k) == Some(&true);
    let values = |s: &PublishedSample| -> Vec<f64> {
        let in_k = is_moment(k);
        let same = s.reactions.iter().filter(|r| is_moment(r.0) == in_k);
        let half_dm = s.half_dm.filter(|_| in_k);
        match kind {
            0 => s.m.into_iter().collect(),
            1 => s.half_dm.into_iter().collect(),
            2 => same.map(|r| r.1).chain(s.m.filter(|_| in_k)).collect(),
            3 => same.map(|r| r.2).chain(half_dm).collect(),
            _ => {
                let points = s.points.iter();
                points.flat_map(|p| [p.position.x, p.position.y]).collect()
            }
        }
    };
    let all = samples.iter().flat_map(values);
    all.fold(0.0, |max: f64, value| max.max(value.abs()))
}

/// Calls `record(kind, index, difference, unit)` for everything in a sample.
fn compare(
    moments: &[bool],
    subject: &dyn Subject,
    sample: &PublishedSample,
    mut record: impl FnMut(usize, usize, f64, &'static str),
) -> Result<(), SubjectError> {
    let coefficients = subject.coefficients(sample.q)?;
    if let Some(m) = sample.m {
        record(0, 0, coefficients.m - m, "kg m2");
    }
    if let Some(half_dm) = sample.half_dm {
        record(1, 0, coefficients.half_dm - half_dm, "kg m2/rad");
    }
    for &(k, a, b) in &sample.reactions {
        let units = coefficient_units(moments.get(k) == Some(&true));
        // An index that is not there is a difference that is not a number, and fails.
        let of = |values: &[f64]| values.get(k).copied().unwrap_or(f64::NAN);
        record(2, k, of(&coefficients.a) - a, units[0]);
        record(3, k, of(&coefficients.b) - b, units[1]);
    }
    if sample.points.is_empty() {
        return Ok(());
    }
    let poses = subject.poses(sample.q)?;
    for point in &sample.points {
        let gap = poses.get(point.body.0).map_or(f64::NAN, |pose| {
            (pose.point(lifted(point.local)) - lifted(point.position)).norm()
        });
        record(4, point.body.0, gap, "m");
    }
    Ok(())
}

//! Check 9: published values.

use crate::case::Case;
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use crate::context::unit_index;
use crate::dense::condition_number;
use crate::subject::{Subject, SubjectError};
use dwell_findings::{Check, Finding};
use dwell_geometry::{BodyId, Vec2};

/// A point of a body and where it was published to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PublishedPoint {
    /// The body.
    pub body: BodyId,
    /// The point in the body's own frame, m.
    pub local: Vec2,
    /// Where it is in the plane, m.
    pub position: Vec2,
}

/// Published values at one position. What was not published is left empty.
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

/// What a kind of value is called in its finding.
struct PublishedQuantity {
    key: &'static str,
    comparison: &'static str,
    scale: &'static str,
}

const PUBLISHED_QUANTITIES: [PublishedQuantity; 5] = [
    PublishedQuantity {
        key: "published-m",
        comparison: "m with the published m",
        scale: "the largest published m",
    },
    PublishedQuantity {
        key: "published-half-dm",
        comparison: "half dm/dq with the published one",
        scale: "the largest published half dm/dq",
    },
    PublishedQuantity {
        key: "published-a",
        comparison: "a with the published a of the same reactions",
        scale: "the largest published a of the same unit, m among the moments",
    },
    PublishedQuantity {
        key: "published-b",
        comparison: "b with the published b of the same reactions",
        scale: "the largest published b of the same unit, half dm/dq among the moments",
    },
    PublishedQuantity {
        key: "published-points",
        comparison: "points of bodies with where they were published to be",
        scale: "the largest published coordinate",
    },
];

/// One finding for each kind of value that was published. A kind of which nothing was published
/// gives none.
///
/// Scales come from the published values themselves, over all samples.
pub fn published(
    case: &Case<'_>,
    subject: &dyn Subject,
    samples: &[PublishedSample],
) -> Vec<Finding> {
    let reactions = case.mechanism.reactions();
    let unit = |k: usize| reactions.get(k).map_or(0, |&r| unit_index(r));
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let m = largest(&mut samples.iter().filter_map(|s| s.m));
    let half_dm = largest(&mut samples.iter().filter_map(|s| s.half_dm));
    let of_unit = |unit_kind: usize, pick: fn(&(usize, f64, f64)) -> f64| {
        let all = samples.iter().flat_map(|s| &s.reactions);
        largest(&mut all.filter(|r| unit(r.0) == unit_kind).map(pick))
    };
    let a = [of_unit(0, |r| r.1), of_unit(1, |r| r.1).max(m)];
    let b = [of_unit(0, |r| r.2), of_unit(1, |r| r.2).max(half_dm)];
    let all_points = || samples.iter().flat_map(|s| &s.points);
    let coordinate = largest(&mut all_points().flat_map(|p| [p.position.x, p.position.y]));

    let mut worst: [LargestDifference; 5] = Default::default();
    for sample in samples {
        let poses = subject.poses(sample.q).unwrap_or_default();
        let condition_number = condition_number(case.mechanism, &poses);
        let result = compare(case, subject, sample, |kind, k, difference, unit_name| {
            let scale = match kind {
                0 => m,
                1 => half_dm,
                2 => a[unit(k)],
                3 => b[unit(k)],
                _ => coordinate,
            };
            let comparison = Comparison {
                difference,
                scale,
                reference_error: 0.0,
                unit: unit_name,
                condition_number,
            };
            worst[kind].record(&comparison, || match (kind, reactions.get(k)) {
                (2 | 3, Some(&r)) => {
                    format!("q = {} rad, {}", sample.q, case.mechanism.reaction_name(r))
                }
                (4, _) => {
                    let name = case.mechanism.bodies.get(k).map_or("?", |b| &b.name);
                    format!("q = {} rad, {name}", sample.q)
                }
                _ => format!("q = {} rad", sample.q),
            });
        });
        if let Err(error) = result {
            for w in &mut worst {
                w.record_error(&error);
            }
        }
    }
    let given = [
        m > 0.0 || samples.iter().any(|s| s.m.is_some()),
        samples.iter().any(|s| s.half_dm.is_some()),
        samples.iter().any(|s| !s.reactions.is_empty()),
        samples.iter().any(|s| !s.reactions.is_empty()),
        all_points().next().is_some(),
    ];
    PUBLISHED_QUANTITIES
        .into_iter()
        .zip(worst)
        .zip(given)
        .filter(|(_, given)| *given)
        .map(|((kind, worst), _)| {
            FindingSpec {
                key: kind.key,
                check: Check::ReferenceValues,
                comparison: kind.comparison,
                scale: kind.scale,
                tolerance: 1e-12,
                tolerance_reason: "published to more digits than are computed; a margin for the computation",
            }
            .finding(format!("{} published positions", samples.len()), worst)
        })
        .collect()
}

/// Calls `record(kind, index, difference, unit)` for everything in a sample.
fn compare(
    case: &Case<'_>,
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
    let all = case.mechanism.reactions();
    for &(k, a, b) in &sample.reactions {
        let unit = all.get(k).map_or("N", |r| r.component.unit());
        let (a_unit, b_unit) = if unit == "N" {
            ("N per rad/s2", "N per (rad/s)2")
        } else {
            ("N m per rad/s2", "N m per (rad/s)2")
        };
        // An index that is not there is a difference that is not a number, and fails.
        let of = |values: &[f64]| values.get(k).copied().unwrap_or(f64::NAN);
        record(2, k, of(&coefficients.a) - a, a_unit);
        record(3, k, of(&coefficients.b) - b, b_unit);
    }
    if !sample.points.is_empty() {
        let poses = subject.poses(sample.q)?;
        for point in &sample.points {
            let gap = poses.get(point.body.0).map_or(f64::NAN, |&[x, y, angle]| {
                let arm = point.local.rotate(Vec2::from_angle(angle));
                (x + arm.x - point.position.x).hypot(y + arm.y - point.position.y)
            });
            record(4, point.body.0, gap, "m");
        }
    }
    Ok(())
}

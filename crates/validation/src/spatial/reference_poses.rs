//! Placements and generalised inertias of a reference, in plain numbers, against those of a subject.

use super::claims::SpaceClaims;
use super::reference::Reference;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Placement, Vec3};
use dwell_scene::SpaceScene;
use dwell_verify::{ClaimedState, FindingSpec, Pose, SubjectError};
use std::path::Path;

const PLACEMENTS: FindingSpec<'_> = FindingSpec {
    key: "reference-placements",
    check: Check::ReferenceValues,
    comparison: "positions and rotations of all bodies with the reference of 25 digits",
    scale: "the size of the mechanism, or one radian",
    // The largest seen in a case is 1.8e-14.
    tolerance: 1e-12,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};
const INERTIAS: FindingSpec<'_> = FindingSpec {
    key: "reference-inertias",
    check: Check::ReferenceValues,
    comparison: "the generalised inertias with the reference of 25 digits",
    scale: "the largest of each position",
    tolerance: 1e-12,
    tolerance_reason: "rounding, amplified by the condition of the equations",
};

/// What is compared with a reference: poses and generalised inertias at coordinates.
pub type ClaimedAt<'a> = &'a dyn Fn(&[f64]) -> Result<ClaimedState, SubjectError>;

/// A position of a reference.
#[derive(Debug)]
struct ReferencePose {
    q: Vec<f64>,
    placements: Vec<(usize, Placement)>,
    inertias: Vec<f64>,
}

/// The positions of a reference.
#[derive(Debug)]
pub struct ReferencePoses {
    poses: Vec<ReferencePose>,
}

impl ReferencePoses {
    /// Those of the reference of a scene in a file.
    ///
    /// # Errors
    /// [`ValidationError::Reference`] where the file cannot be read.
    pub fn read(scene: &SpaceScene, path: &Path) -> Result<Self, ValidationError> {
        Ok(Self::of(scene, &Reference::read(path)?))
    }

    pub(super) fn of(scene: &SpaceScene, reference: &Reference) -> Self {
        let of_one = reference.samples().filter_map(|sample| {
            let bodies = scene.mechanism.bodies.iter().enumerate();
            let placed = bodies.filter_map(|(b, body)| Some((b, sample.placement(&body.name)?)));
            Some(ReferencePose {
                q: vec![sample.number("q")?],
                placements: placed.collect(),
                inertias: vec![sample.number("m")?],
            })
        });
        let of_two = reference.of_two_coordinates().filter_map(|sample| {
            Some(ReferencePose {
                q: sample.coordinates()?.to_vec(),
                placements: Vec::new(),
                inertias: sample.inertias()?.to_vec(),
            })
        });
        Self {
            poses: of_one.chain(of_two).collect(),
        }
    }

    /// The finding on placements; none where the reference has no placements.
    pub fn placements(&self, claims: &SpaceClaims<'_>, claimed: ClaimedAt<'_>) -> Option<Finding> {
        let mut worst = Differences::default();
        for ReferencePose { q, placements, .. } in &self.poses {
            if placements.is_empty() {
                continue;
            }
            let found = claimed(q).unwrap_or_default().poses;
            for (body, wanted) in placements {
                let error = found
                    .get(*body)
                    .map_or(f64::NAN, |found| apart(claims, *body, found, wanted));
                let name = &claims.scene().mechanism.bodies[*body].name;
                worst.compare([error, 0.0, 1.0], "", || format!("q = {:.4}, {name}", q[0]));
            }
        }
        worst.finding(&PLACEMENTS, &self.domain())
    }

    /// The finding on generalised inertias.
    pub fn inertias(&self, claimed: ClaimedAt<'_>) -> Option<Finding> {
        let mut worst = Differences::default();
        for ReferencePose { q, inertias, .. } in &self.poses {
            let found = claimed(q).unwrap_or_default().inertias;
            let scale = largest(inertias);
            for (k, wanted) in inertias.iter().enumerate() {
                let found = found.get(k).copied().unwrap_or(f64::NAN);
                worst.compare([found, *wanted, scale], "kg m2", || format!("q = {q:?}"));
            }
        }
        worst.finding(&INERTIAS, &self.domain())
    }

    fn domain(&self) -> String {
        format!("{} positions of the reference", self.poses.len())
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

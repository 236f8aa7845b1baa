//! Placements and generalised inertias of a reference, in plain numbers, against those of a subject.

use super::reference::Reference;
use crate::error::ValidationError;
use crate::written::poses::difference::Differences;
use crate::written::poses::rows::largest;
use dwell_findings::{Check, Finding};
use dwell_geometry::space::{Placement, Vec3};
use dwell_scene::SpaceScene;
use dwell_verify::space::SpaceCase;
use dwell_verify::{FindingSpec, SubjectError};
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

/// What is compared with a reference. A question must have the same answer whatever was asked before.
pub trait SpaceSubject {
    /// Where the bodies are at coordinates, rad or m.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    fn placements(&self, q: &[f64]) -> Result<Vec<Placement>, SubjectError>;

    /// The generalised inertias at coordinates, row by row.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    fn inertias(&self, q: &[f64]) -> Result<Vec<f64>, SubjectError>;
}

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
    pub fn placements(&self, case: &SpaceCase<'_>, subject: &dyn SpaceSubject) -> Option<Finding> {
        let mut worst = Differences::default();
        for ReferencePose { q, placements, .. } in &self.poses {
            if placements.is_empty() {
                continue;
            }
            let found = subject.placements(q).unwrap_or_default();
            for (body, wanted) in placements {
                let error = found
                    .get(*body)
                    .map_or(f64::NAN, |found| apart(case, *body, [found, wanted]));
                let name = &case.mechanism.bodies[*body].name;
                worst.compare([error, 0.0, 1.0], "", || format!("q = {:.4}, {name}", q[0]));
            }
        }
        worst.finding(&PLACEMENTS, &self.domain())
    }

    /// The finding on generalised inertias.
    pub fn inertias(&self, subject: &dyn SpaceSubject) -> Option<Finding> {
        let mut worst = Differences::default();
        for ReferencePose { q, inertias, .. } in &self.poses {
            let found = subject.inertias(q).unwrap_or_default();
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
fn apart(case: &SpaceCase<'_>, body: usize, [found, wanted]: [&Placement; 2]) -> f64 {
    let idle = case.idle.iter().find(|idle| idle.body.0 == body);
    let turned = |v: Vec3| (found.rotation.apply(v) - wanted.rotation.apply(v)).norm();
    let turn: f64 = match idle {
        Some(idle) => turned(idle.axis),
        None => Vec3::AXES.map(turned).into_iter().sum(),
    };
    let point = idle.map_or(Vec3::ZERO, |idle| idle.point);
    let at = |p: &Placement| p.position + p.rotation.apply(point);
    turn + (at(found) - at(wanted)).norm() / case.size
}

//! Named faults in the reduced model: what has gone wrong in programs and papers, each a wrapper of the
//! checked subject.

use super::detection::Detection;
use super::unit_wrenches::{BodyMotion, UnitWrenches};
use dwell_findings::Check;
use dwell_geometry::{Component, JointKind, Vec2};
use dwell_kinetostatics::ReducedModel as _;
use dwell_scene::PlaneScene;
use dwell_validation::PlanSubject;
use dwell_verify::checks::PublishedSample;
use dwell_verify::{
    Case, CheckedMechanism, Coefficients, Finding, InverseDynamics, Pose, Subject, SubjectError,
    spread, verify_all,
};
use std::f64::consts::FRAC_PI_2;

/// Positions at which a fault is checked.
const POSITIONS: usize = 4;
/// A coefficient that changes by less, relative to the largest, is not changed.
const UNCHANGED_TOLERANCE: f64 = 1e-9;
/// Step of the derivatives that faults are made of, rad: an error of 1e-10 in a fault is no matter.
const DIFFERENCE_STEP: f64 = 1e-4;

/// A fault in the reduced model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mutation {
    NoCentrifugal,
    CentrifugalOutwards,
    NoTangential,
    HalvedInertia,
    InertiaTakenOff,
    NoParallelAxis,
    NoRootMoment,
    NoCoriolis,
    HalfCoriolis,
    MassForgotten,
    WholeSlope,
    NoSlope,
    SlopeReversed,
    HalfInertia,
    MisplacedBracket,
    NoSlopeAcross,
    WholeSlopeAcross,
    SlopeAcrossReversed,
    NoMixedSlope,
    OneReversed,
    TwoSwapped,
    AllReversed,
    UnitRunsSwapped,
    MomentAboutTheOtherPoint,
    MomentForgotten,
    NormalThatStays,
    OtherBranch,
    BranchThatChanges,
    PoseThatLags,
}

impl Mutation {
    pub const ALL: [Self; 29] = [
        Self::NoCentrifugal,
        Self::CentrifugalOutwards,
        Self::NoTangential,
        Self::HalvedInertia,
        Self::InertiaTakenOff,
        Self::NoParallelAxis,
        Self::NoRootMoment,
        Self::NoCoriolis,
        Self::HalfCoriolis,
        Self::MassForgotten,
        Self::WholeSlope,
        Self::NoSlope,
        Self::SlopeReversed,
        Self::HalfInertia,
        Self::MisplacedBracket,
        Self::NoSlopeAcross,
        Self::WholeSlopeAcross,
        Self::SlopeAcrossReversed,
        Self::NoMixedSlope,
        Self::OneReversed,
        Self::TwoSwapped,
        Self::AllReversed,
        Self::UnitRunsSwapped,
        Self::MomentAboutTheOtherPoint,
        Self::MomentForgotten,
        Self::NormalThatStays,
        Self::OtherBranch,
        Self::BranchThatChanges,
        Self::PoseThatLags,
    ];

    pub fn description(self) -> &'static str {
        match self {
            Self::NoCentrifugal => "centrifugal term of an off-centre body dropped",
            Self::CentrifugalOutwards => "centrifugal term with the other sign",
            Self::NoTangential => "tangential term of an off-centre body dropped",
            Self::HalvedInertia => "a moment of inertia halved",
            Self::InertiaTakenOff => "moment of inertia with the other sign",
            Self::NoParallelAxis => "parallel-axis term forgotten",
            Self::NoRootMoment => "moment of the root's acceleration forgotten",
            Self::NoCoriolis => "moving axis of a prismatic joint forgotten: no Coriolis force",
            Self::HalfCoriolis => "Coriolis force without its factor 2",
            Self::MassForgotten => "a body's mass forgotten",
            Self::WholeSlope => "m' for half m'",
            Self::NoSlope => "half m' forgotten",
            Self::SlopeReversed => "half m' with the other sign",
            Self::HalfInertia => "half m for m",
            Self::MisplacedBracket => "the paper's misplaced bracket in m_e1",
            Self::NoSlopeAcross => "b without half dm1/dq2",
            Self::WholeSlopeAcross => "b with dm1/dq2 for half of it",
            Self::SlopeAcrossReversed => "b with the other sign of half dm1/dq2",
            Self::NoMixedSlope => "b without dm12/dq1",
            Self::OneReversed => "one reaction's sign flipped",
            Self::TwoSwapped => "x and y of a reaction swapped",
            Self::AllReversed => "reactions of the second body on the first",
            Self::UnitRunsSwapped => "a for b and b for a",
            Self::MomentAboutTheOtherPoint => "moment of a slide about its other point",
            Self::MomentForgotten => "moment of a slide forgotten",
            Self::NormalThatStays => "normal of a slide that does not turn with its axis",
            Self::OtherBranch => "the other assembly branch",
            Self::BranchThatChanges => "another assembly branch from half of the range on",
            Self::PoseThatLags => "poses a thousandth behind the coordinate",
        }
    }
}

/// A mechanism on which the faults are tried.
pub struct TestedModel {
    pub scene: PlaneScene,
    subject: PlanSubject,
    /// The same mechanism put together the other way, where it can be.
    other_branch: Option<PlanSubject>,
    wrenches: UnitWrenches,
    published: Vec<PublishedSample>,
    positions: Vec<f64>,
}

impl TestedModel {
    /// A mechanism; `other` is the same on another branch.
    pub fn new(
        scene: PlaneScene,
        other: Option<&PlaneScene>,
        published: Vec<PublishedSample>,
    ) -> Self {
        let compile = |scene: &PlaneScene| PlanSubject::new(scene).expect("a subject");
        let subject = compile(&scene);
        let range = subject.exact().range();
        let positions = match scene.sweep.as_ref().and_then(|sweep| sweep.range) {
            Some([low, high]) => spread(dwell_geometry::Range::Limited(low, high), POSITIONS),
            None => spread(range, POSITIONS),
        };
        Self {
            other_branch: other.map(compile),
            wrenches: UnitWrenches::new(&scene),
            subject,
            published,
            positions,
            scene,
        }
    }

    /// What the checks detect in the mechanism with a fault, or without; nothing where the fault is none
    /// here.
    pub fn check(&self, mutation: Option<Mutation>) -> Option<Detection> {
        let mutated = MutatedSubject {
            model: self,
            mutation,
        };
        if mutation.is_some() && !self.has_effect(&mutated) {
            return None;
        }
        let case = Case {
            mechanism: CheckedMechanism::Plane(&self.scene.mechanism, (&self.scene.masses).into()),
            range: self.subject.exact().range(),
            positions: self.positions.clone(),
        };
        let mut findings = verify_all(&case, &mutated, &self.published);
        findings.push(self.assembly_finding(&mutated));
        Some(Detection::from_findings(&findings))
    }

    /// Whether a fault changes anything here.
    fn has_effect(&self, mutated: &MutatedSubject<'_>) -> bool {
        self.positions.iter().any(|&q| {
            let both = (self.subject.coefficients(q), mutated.coefficients(q));
            let (Ok(expected), Ok(mutated_values)) = both else {
                return true;
            };
            let changed = |a: &[f64], b: &[f64]| {
                let largest = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                a.iter()
                    .zip(b)
                    .any(|(a, b)| (a - b).abs() > UNCHANGED_TOLERANCE * largest)
            };
            let poses = match (self.subject.frames(q), mutated.frames(q)) {
                (Ok(a), Ok(b)) => changed(a.as_flattened(), b.as_flattened()),
                _ => true,
            };
            poses
                || changed(
                    &[expected.m, expected.half_dm],
                    &[mutated_values.m, mutated_values.half_dm],
                )
                || changed(&expected.a, &mutated_values.a)
                || changed(&expected.b, &mutated_values.b)
        })
    }

    /// Truth 0, against the scene's own words: every body that `[assembly]` names points, at the start,
    /// to the side that is said there. The cosine's sign: no rounding decides it.
    fn assembly_finding(&self, subject: &dyn Subject) -> Finding {
        let start = self.scene.assembly.to_configuration();
        let poses = subject.frames(start.q[0]).unwrap_or_default();
        let is_beyond = |(pose, guess): (&[f64; 3], &Option<f64>)| {
            guess.is_some_and(|guess| (pose[2] - guess).cos() < FRAC_PI_2.cos())
        };
        let misoriented = poses
            .iter()
            .zip(&start.initial_guess)
            .filter(|&both| is_beyond(both));
        let count = misoriented.count();
        Finding {
            key: "assembly".into(),
            check: Check::ConstraintClosure,
            comparison: "the bodies' directions at the start with those in [assembly]".into(),
            relative_difference: count as f64,
            pass: count == 0,
            ..Finding::default()
        }
    }
}

/// A subject with a fault.
struct MutatedSubject<'a> {
    model: &'a TestedModel,
    mutation: Option<Mutation>,
}

impl MutatedSubject<'_> {
    fn subject(&self, q: f64) -> &PlanSubject {
        let middle = self.model.positions.iter().sum::<f64>() / self.model.positions.len() as f64;
        match (self.mutation, &self.model.other_branch) {
            (Some(Mutation::OtherBranch), Some(other)) => other,
            (Some(Mutation::BranchThatChanges), Some(other)) if q > middle => other,
            _ => &self.model.subject,
        }
    }

    /// da_k/dq.
    fn a_derivatives(&self, q: f64) -> Result<Vec<f64>, SubjectError> {
        let of = |h: f64| Ok(self.model.subject.coefficients(q + h)?.a);
        let [low, high]: [Vec<f64>; 2] = [of(-DIFFERENCE_STEP)?, of(DIFFERENCE_STEP)?];
        let both = low.iter().zip(&high);
        Ok(both
            .map(|(a, b)| (b - a) / (2.0 * DIFFERENCE_STEP))
            .collect())
    }

    /// What a body's inertia is short of in a fault, as a force at its centre and a couple.
    fn missing_wrench(&self, body: &BodyMotion) -> Option<(Vec2, f64)> {
        let BodyMotion {
            mass,
            inertia,
            center_offset,
            angular_velocity,
            angular_acceleration,
            ..
        } = *body;
        let centrifugal = center_offset * (-mass * angular_velocity * angular_velocity);
        let coriolis = body.sliding_velocity.perp() * (2.0 * mass * body.carrier_angular_velocity);
        let none = (Vec2::ZERO, 0.0);
        Some(match self.mutation? {
            Mutation::NoCentrifugal => (centrifugal, 0.0),
            Mutation::CentrifugalOutwards => (centrifugal * 2.0, 0.0),
            Mutation::NoTangential => (center_offset.perp() * (mass * angular_acceleration), 0.0),
            Mutation::HalvedInertia => (Vec2::ZERO, 0.5 * inertia * angular_acceleration),
            Mutation::InertiaTakenOff => (Vec2::ZERO, 2.0 * inertia * angular_acceleration),
            Mutation::NoParallelAxis => (
                Vec2::ZERO,
                mass * center_offset.dot(center_offset) * angular_acceleration,
            ),
            Mutation::NoRootMoment => (
                Vec2::ZERO,
                mass * center_offset.cross(body.origin_acceleration),
            ),
            Mutation::NoCoriolis => (coriolis, 0.0),
            Mutation::HalfCoriolis => (coriolis * 0.5, 0.0),
            Mutation::MassForgotten if body.heaviest => (body.center_acceleration * mass, 0.0),
            Mutation::MassForgotten => none,
            _ => return None,
        })
    }
}

impl Subject for MutatedSubject<'_> {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        let lag = if self.mutation == Some(Mutation::PoseThatLags) {
            1e-3
        } else {
            0.0
        };
        self.subject(q).poses(q - lag)
    }

    // Long: an arm for each mutation.
    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let lag = if self.mutation == Some(Mutation::PoseThatLags) {
            1e-3
        } else {
            0.0
        };
        let mut c = self.subject(q).coefficients(q - lag)?;
        let Some(mutation) = self.mutation else {
            return Ok(c);
        };
        if let Some(missing) = self
            .model
            .wrenches
            .response(q, |body| self.missing_wrench(body))?
        {
            let [first, second] = &missing;
            c.half_dm -= first.tau[0];
            c.m -= second.tau[0];
            for (k, (a, b)) in c.a.iter_mut().zip(&mut c.b).enumerate() {
                *b -= first.reactions[k];
                *a -= second.reactions[k];
            }
            return Ok(c);
        }
        let mechanism = &self.model.scene.mechanism;
        let reactions = mechanism.reactions();
        let half = 0.5 * c.m;
        match mutation {
            Mutation::WholeSlope => c.half_dm *= 2.0,
            Mutation::NoSlope => c.half_dm = 0.0,
            Mutation::SlopeReversed => c.half_dm = -c.half_dm,
            Mutation::HalfInertia => c.m = half,
            Mutation::MisplacedBracket => {
                // (F_E − (m12′ − ½ m1,q2) q̇²) / q̈ printed as (F_E − (m12′ − ½ m1,q2 q̇²)) / q̈: at q̇ = 0 m12′ stays.
                c.a.iter_mut()
                    .zip(self.a_derivatives(q)?)
                    .for_each(|(a, slope)| *a -= slope);
            }
            Mutation::NoSlopeAcross => c.b = self.a_derivatives(q)?,
            Mutation::WholeSlopeAcross => {
                let slopes = self.a_derivatives(q)?;
                c.b.iter_mut()
                    .zip(slopes)
                    .for_each(|(b, slope)| *b = 2.0 * *b - slope);
            }
            Mutation::SlopeAcrossReversed => {
                let slopes = self.a_derivatives(q)?;
                c.b.iter_mut()
                    .zip(slopes)
                    .for_each(|(b, slope)| *b = 2.0 * slope - *b);
            }
            Mutation::NoMixedSlope => {
                let slopes = self.a_derivatives(q)?;
                c.b.iter_mut()
                    .zip(slopes)
                    .for_each(|(b, slope)| *b -= slope);
            }
            Mutation::OneReversed => {
                // Of an inner joint, so that it cancels in the whole.
                let k = reactions.len() / 2;
                (c.a[k], c.b[k]) = (-c.a[k], -c.b[k]);
            }
            Mutation::TwoSwapped => {
                let x = reactions.iter().rposition(|r| r.component == Component::X);
                if let Some(k) = x {
                    c.a.swap(k, k + 1);
                    c.b.swap(k, k + 1);
                }
            }
            Mutation::AllReversed => c.a.iter_mut().chain(&mut c.b).for_each(|v| *v = -*v),
            Mutation::UnitRunsSwapped => std::mem::swap(&mut c.a, &mut c.b),
            Mutation::MomentAboutTheOtherPoint
            | Mutation::MomentForgotten
            | Mutation::NormalThatStays => {
                for (k, r) in reactions.iter().enumerate() {
                    let joint = &mechanism.joints[r.joint.0];
                    let slides = matches!(
                        joint.kind,
                        JointKind::Prismatic { .. } | JointKind::Slot { .. }
                    );
                    match (mutation, r.component) {
                        (Mutation::MomentForgotten, Component::Moment) if slides => {
                            (c.a[k], c.b[k]) = (0.0, 0.0);
                        }
                        (Mutation::MomentAboutTheOtherPoint, Component::Moment) if slides => {
                            let travel = self.model.wrenches.travel(q, r.joint)?;
                            c.a[k] += travel * c.a[k - 1];
                            c.b[k] += travel * c.b[k - 1];
                        }
                        (Mutation::NormalThatStays, Component::Normal) if slides => {
                            let pose = self.model.subject.frames(q)?[joint.bodies[0].0];
                            let (sin, _) = (0.5 * pose[2]).sin_cos();
                            // cos θ = 1 − 2 sin²(θ/2): exactly 1 on a body that does not turn.
                            let part = 1.0 - 2.0 * sin * sin;
                            c.a[k] *= part;
                            c.b[k] *= part;
                        }
                        _ => {}
                    }
                }
            }
            _ => {}
        }
        Ok(c)
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let c = self.coefficients(q)?;
        let line = |a: f64, b: f64| a * q_ddot + b * q_dot * q_dot;
        Ok(InverseDynamics {
            tau: line(c.m, c.half_dm),
            reactions: c.a.iter().zip(&c.b).map(|(a, b)| line(*a, *b)).collect(),
        })
    }
}

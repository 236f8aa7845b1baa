//! Named faults in the reduced model: what has gone wrong in programs and papers, each a wrapper of the
//! judged subject.

use super::verdict::Verdict;
use super::wrench::{Moving, Wrenches};
use dwell_geometry::{Component, JointKind, Vec2};
use dwell_kinetostatics::Reduced as _;
use dwell_scene::Scene;
use dwell_study::PlanSubject;
use dwell_verify::truths::Sample;
use dwell_verify::{
    Actions, Case, Coefficients, Finding, Subject, SubjectError, spread, verify_all,
};
use std::f64::consts::FRAC_PI_2;

/// Positions at which a fault is judged.
const POSITIONS: usize = 4;
/// A coefficient that changes by less, relative to the largest, is not changed.
const SAME: f64 = 1e-9;
/// Step of the derivatives that faults are made of, rad: an error of 1e-10 in a fault is no matter.
const STEP: f64 = 1e-4;

/// A fault in the reduced model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
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

impl Fault {
    pub(crate) const ALL: [Self; 29] = [
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

    pub(crate) fn words(self) -> &'static str {
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
pub(crate) struct Model {
    pub(crate) scene: Scene,
    subject: PlanSubject,
    /// The same mechanism put together the other way, where it can be.
    other: Option<PlanSubject>,
    wrenches: Wrenches,
    published: Vec<Sample>,
    positions: Vec<f64>,
}

impl Model {
    /// A mechanism; `other` is the same on another branch.
    pub(crate) fn new(scene: Scene, other: Option<&Scene>, published: Vec<Sample>) -> Self {
        let compile = |scene: &Scene| PlanSubject::new(scene).expect("a subject");
        let subject = compile(&scene);
        let range = subject.exact().range();
        let positions = match scene.sweep.as_ref().and_then(|sweep| sweep.range) {
            Some([low, high]) => spread(dwell_geometry::Range::Between(low, high), POSITIONS),
            None => spread(range, POSITIONS),
        };
        Self {
            other: other.map(compile),
            wrenches: Wrenches::new(&scene),
            subject,
            published,
            positions,
            scene,
        }
    }

    /// What the truths say of the mechanism with a fault, or without; nothing where the fault is none
    /// here.
    pub(crate) fn judge(&self, fault: Option<Fault>) -> Option<Verdict> {
        let faulty = Faulty { model: self, fault };
        if fault.is_some() && !self.felt(&faulty) {
            return None;
        }
        let case = Case {
            mechanism: &self.scene.mechanism,
            masses: &self.scene.masses,
            range: self.subject.exact().range(),
            positions: self.positions.clone(),
        };
        let mut findings = verify_all(&case, &faulty, &self.published);
        findings.push(self.oriented(&faulty));
        Some(Verdict::of(&findings))
    }

    /// Whether a fault changes anything here.
    fn felt(&self, faulty: &Faulty<'_>) -> bool {
        self.positions.iter().any(|&q| {
            let both = (self.subject.coefficients(q), faulty.coefficients(q));
            let (Ok(right), Ok(wrong)) = both else {
                return true;
            };
            let moved = |a: &[f64], b: &[f64]| {
                let largest = a.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                a.iter().zip(b).any(|(a, b)| (a - b).abs() > SAME * largest)
            };
            let poses = match (self.subject.poses(q), faulty.poses(q)) {
                (Ok(a), Ok(b)) => moved(a.as_flattened(), b.as_flattened()),
                _ => true,
            };
            poses
                || moved(&[right.m, right.half_dm], &[wrong.m, wrong.half_dm])
                || moved(&right.a, &wrong.a)
                || moved(&right.b, &wrong.b)
        })
    }

    /// Truth 0, against the scene's own words: every body that `[assembly]` names points, at the start,
    /// to the side that is said there. The cosine's sign: no rounding decides it.
    fn oriented(&self, subject: &dyn Subject) -> Finding {
        let start = self.scene.assembly.to_start();
        let poses = subject.poses(start.q[0]).unwrap_or_default();
        let beyond = |(pose, rough): (&[f64; 3], &Option<f64>)| {
            rough.is_some_and(|rough| (pose[2] - rough).cos() < FRAC_PI_2.cos())
        };
        let turned = poses.iter().zip(&start.rough).filter(|&both| beyond(both));
        let count = turned.count();
        Finding {
            key: "assembly".into(),
            truth: "0 closure".into(),
            compared: "the bodies' directions at the start with those in [assembly]".into(),
            relative: count as f64,
            pass: count == 0,
            ..Finding::default()
        }
    }
}

/// A subject with a fault.
struct Faulty<'a> {
    model: &'a Model,
    fault: Option<Fault>,
}

impl Faulty<'_> {
    fn subject(&self, q: f64) -> &PlanSubject {
        let half = self.model.positions.iter().sum::<f64>() / self.model.positions.len() as f64;
        match (self.fault, &self.model.other) {
            (Some(Fault::OtherBranch), Some(other)) => other,
            (Some(Fault::BranchThatChanges), Some(other)) if q > half => other,
            _ => &self.model.subject,
        }
    }

    /// da_k/dq.
    fn slopes(&self, q: f64) -> Result<Vec<f64>, SubjectError> {
        let of = |h: f64| Ok(self.model.subject.coefficients(q + h)?.a);
        let [low, high]: [Vec<f64>; 2] = [of(-STEP)?, of(STEP)?];
        let both = low.iter().zip(&high);
        Ok(both.map(|(a, b)| (b - a) / (2.0 * STEP)).collect())
    }

    /// What a body's inertia is short of in a fault, as a force at its centre and a couple.
    fn missing(&self, body: &Moving) -> Option<(Vec2, f64)> {
        let Moving {
            mass,
            inertia,
            arm,
            spin,
            spin_rate,
            ..
        } = *body;
        let centrifugal = arm * (-mass * spin * spin);
        let coriolis = body.slip.perp() * (2.0 * mass * body.carrier);
        let none = (Vec2::ZERO, 0.0);
        Some(match self.fault? {
            Fault::NoCentrifugal => (centrifugal, 0.0),
            Fault::CentrifugalOutwards => (centrifugal * 2.0, 0.0),
            Fault::NoTangential => (arm.perp() * (mass * spin_rate), 0.0),
            Fault::HalvedInertia => (Vec2::ZERO, 0.5 * inertia * spin_rate),
            Fault::InertiaTakenOff => (Vec2::ZERO, 2.0 * inertia * spin_rate),
            Fault::NoParallelAxis => (Vec2::ZERO, mass * arm.dot(arm) * spin_rate),
            Fault::NoRootMoment => (Vec2::ZERO, mass * arm.cross(body.root)),
            Fault::NoCoriolis => (coriolis, 0.0),
            Fault::HalfCoriolis => (coriolis * 0.5, 0.0),
            Fault::MassForgotten if body.heaviest => (body.center * mass, 0.0),
            Fault::MassForgotten => none,
            _ => return None,
        })
    }
}

impl Subject for Faulty<'_> {
    fn poses(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError> {
        let lag = if self.fault == Some(Fault::PoseThatLags) {
            1e-3
        } else {
            0.0
        };
        self.subject(q).poses(q - lag)
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let lag = if self.fault == Some(Fault::PoseThatLags) {
            1e-3
        } else {
            0.0
        };
        let mut c = self.subject(q).coefficients(q - lag)?;
        let Some(fault) = self.fault else {
            return Ok(c);
        };
        if let Some(short) = self.model.wrenches.answer(q, |body| self.missing(body))? {
            let [first, second] = &short;
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
        match fault {
            Fault::WholeSlope => c.half_dm *= 2.0,
            Fault::NoSlope => c.half_dm = 0.0,
            Fault::SlopeReversed => c.half_dm = -c.half_dm,
            Fault::HalfInertia => c.m = half,
            Fault::MisplacedBracket => {
                // (F_E − (m12′ − ½ m1,q2) q̇²) / q̈ printed as (F_E − (m12′ − ½ m1,q2 q̇²)) / q̈: at q̇ = 0 m12′ stays.
                c.a.iter_mut()
                    .zip(self.slopes(q)?)
                    .for_each(|(a, slope)| *a -= slope);
            }
            Fault::NoSlopeAcross => c.b = self.slopes(q)?,
            Fault::WholeSlopeAcross => {
                let slopes = self.slopes(q)?;
                c.b.iter_mut()
                    .zip(slopes)
                    .for_each(|(b, slope)| *b = 2.0 * *b - slope);
            }
            Fault::SlopeAcrossReversed => {
                let slopes = self.slopes(q)?;
                c.b.iter_mut()
                    .zip(slopes)
                    .for_each(|(b, slope)| *b = 2.0 * slope - *b);
            }
            Fault::NoMixedSlope => {
                let slopes = self.slopes(q)?;
                c.b.iter_mut()
                    .zip(slopes)
                    .for_each(|(b, slope)| *b -= slope);
            }
            Fault::OneReversed => {
                // Of an inner joint, so that it cancels in the whole.
                let k = reactions.len() / 2;
                (c.a[k], c.b[k]) = (-c.a[k], -c.b[k]);
            }
            Fault::TwoSwapped => {
                let x = reactions.iter().rposition(|r| r.component == Component::X);
                if let Some(k) = x {
                    c.a.swap(k, k + 1);
                    c.b.swap(k, k + 1);
                }
            }
            Fault::AllReversed => c.a.iter_mut().chain(&mut c.b).for_each(|v| *v = -*v),
            Fault::UnitRunsSwapped => std::mem::swap(&mut c.a, &mut c.b),
            Fault::MomentAboutTheOtherPoint | Fault::MomentForgotten | Fault::NormalThatStays => {
                for (k, r) in reactions.iter().enumerate() {
                    let joint = &mechanism.joints[r.joint.0];
                    let slides = matches!(
                        joint.kind,
                        JointKind::Prismatic { .. } | JointKind::Slot { .. }
                    );
                    match (fault, r.component) {
                        (Fault::MomentForgotten, Component::Moment) if slides => {
                            (c.a[k], c.b[k]) = (0.0, 0.0);
                        }
                        (Fault::MomentAboutTheOtherPoint, Component::Moment) if slides => {
                            let travel = self.model.wrenches.travel(q, r.joint)?;
                            c.a[k] += travel * c.a[k - 1];
                            c.b[k] += travel * c.b[k - 1];
                        }
                        (Fault::NormalThatStays, Component::Normal) if slides => {
                            let pose = self.model.subject.poses(q)?[joint.bodies[0].0];
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

    fn actions(&self, q: f64, q_dot: f64, q_ddot: f64) -> Result<Actions, SubjectError> {
        let c = self.coefficients(q)?;
        let line = |a: f64, b: f64| a * q_ddot + b * q_dot * q_dot;
        Ok(Actions {
            tau: line(c.m, c.half_dm),
            reactions: c.a.iter().zip(&c.b).map(|(a, b)| line(*a, *b)).collect(),
        })
    }
}

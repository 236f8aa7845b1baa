//! Named faults in the equation of motion: the faulty equation is integrated, and its motion judged.

use super::verdict::Verdict;
use dwell_dynamics::State;
use dwell_geometry::{PlaceError, Range, Vec2};
use dwell_kinetostatics::{Coefficients, Exact, Inertia, LoadKind, Model, Reduced};
use dwell_scene::{Length, Scene};
use dwell_study::{PlanSubject, free_run};
use dwell_verify::{Finding, FreeMotionCase, free_motion};

/// A fault in an equation of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    WholeSlope,
    NoSlope,
    SlopeReversed,
    GravityForgotten,
    GravityReversed,
    HalvedInertia,
    MassAtTheJoint,
}

impl Fault {
    pub(crate) const ALL: [Self; 7] = [
        Self::WholeSlope,
        Self::NoSlope,
        Self::SlopeReversed,
        Self::GravityForgotten,
        Self::GravityReversed,
        Self::HalvedInertia,
        Self::MassAtTheJoint,
    ];

    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::WholeSlope => "m' for half m' in the equation of motion",
            Self::NoSlope => "half m' dropped from the equation of motion",
            Self::SlopeReversed => "half m' with the other sign in the equation of motion",
            Self::GravityForgotten => "gravity forgotten in the equation of motion",
            Self::GravityReversed => "gravity reversed in the equation of motion",
            Self::HalvedInertia => "an inertia halved in the equation of motion",
            Self::MassAtTheJoint => "a centre of mass at the joint in the equation of motion",
        }
    }

    /// The factor on ½m′, where that is the fault.
    fn factor(self) -> Option<f64> {
        match self {
            Self::WholeSlope => Some(2.0),
            Self::NoSlope => Some(0.0),
            Self::SlopeReversed => Some(-1.0),
            _ => None,
        }
    }
}

/// A reduced model whose ½m′ is wrong.
struct Wrong<'a> {
    of: &'a Exact,
    factor: f64,
}

impl Reduced for Wrong<'_> {
    type Work = <Exact as Reduced>::Work;

    fn work(&self) -> Self::Work {
        self.of.work()
    }

    fn reactions(&self) -> usize {
        self.of.reactions()
    }

    fn range(&self) -> Range {
        self.of.range()
    }

    fn inertia(&self, q: f64, work: &mut Self::Work) -> Result<(f64, f64), PlaceError> {
        let (m, half_dm) = self.of.inertia(q, work)?;
        Ok((m, self.factor * half_dm))
    }

    fn curvature(&self, q: f64, work: &mut Self::Work) -> Result<Inertia, PlaceError> {
        let mut at = self.of.curvature(q, work)?;
        at.half_dm *= self.factor;
        at.half_ddm *= self.factor;
        Ok(at)
    }

    fn coefficients(
        &self,
        q: f64,
        work: &mut Self::Work,
        out: &mut Coefficients,
    ) -> Result<(), PlaceError> {
        self.of.coefficients(q, work, out)?;
        out.half_dm *= self.factor;
        Ok(())
    }
}

/// The free motion of a reduced model with ½m′ wrong by a factor, judged over one turn.
pub(crate) fn reduced(scene: &Scene, fault: Option<Fault>) -> Option<Verdict> {
    let factor = match fault {
        None => 1.0,
        Some(fault) => fault.factor()?,
    };
    let subject = PlanSubject::new(scene).ok()?;
    let motion = scene.motion.as_ref()?;
    let reactions = scene.mechanism.reactions().into_iter();
    let named = reactions.map(|r| (scene.mechanism.reaction_name(r), r.component.unit()));
    let case = FreeMotionCase {
        start: State {
            t: 0.0,
            q: motion.start[0],
            q_dot: motion.speed[0],
        },
        turns: 1,
        reactions: named.collect(),
        period: None,
    };
    let wrong = Wrong {
        of: subject.exact(),
        factor,
    };
    let judged = free_motion(&wrong, &case).ok()?;
    Some(Verdict::of(&judged.findings))
}

/// The free motion of a scene under its weight alone, judged by the multibody equations (6) and by the
/// energy of what is claimed (4).
pub(crate) fn under_weight(scene: &Scene, fault: Option<Fault>) -> Option<Verdict> {
    let mut right = scene.clone();
    if let Some(motion) = &mut right.motion {
        motion.length = Length::Duration(0.5);
    }
    let mut wrong = right.clone();
    match fault {
        None => {}
        Some(Fault::GravityForgotten) => wrong.loads.clear(),
        Some(Fault::GravityReversed) => {
            for load in &mut wrong.loads {
                if let LoadKind::Gravity { direction } = &mut load.kind {
                    *direction = -*direction;
                }
            }
        }
        Some(Fault::HalvedInertia) => wrong.masses.iter_mut().for_each(|m| m.inertia *= 0.5),
        Some(Fault::MassAtTheJoint) => wrong.masses.iter_mut().for_each(|m| m.center = Vec2::ZERO),
        Some(_) => return None,
    }
    let run = free_run(&wrong).ok()??;
    let mut findings = run.judge(&right);
    findings.push(energy(&right, &run)?);
    Some(Verdict::of(&findings))
}

/// Kinetic and potential energy of the claimed coordinates and speeds, by the right description.
fn energy(scene: &Scene, run: &dwell_study::FreeRun) -> Option<Finding> {
    let start = scene.assembly.to_start();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[]).ok()?;
    let model = model
        .with_loads(&scene.mechanism, scene.loads.clone())
        .ok()?;
    let mut work = model.workspace::<f64>();
    let mut energies = Vec::new();
    for at in &run.coordinates {
        let [q, q_dot]: [Vec<f64>; 2] = [0, 1].map(|i| at.iter().map(|c| c[i]).collect());
        model.enter(0.0, &q, &q_dot, &mut work).ok()?;
        let potential: f64 = (0..scene.loads.len())
            .filter_map(|l| model.potential(l, &work))
            .sum();
        energies.push((model.kinetic(&work), potential));
    }
    let sums = energies
        .iter()
        .map(|(kinetic, potential)| kinetic + potential);
    let (least, most) = sums.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| {
        (a.min(e), b.max(e))
    });
    let largest = energies
        .iter()
        .fold(0.0_f64, |m, (kinetic, _)| m.max(*kinetic));
    let relative = (most - least) / largest;
    Some(Finding {
        key: "claimed-energy".into(),
        truth: "4 energy".into(),
        relative,
        tolerance: 1e-9,
        pass: relative <= 1e-9,
        ..Finding::default()
    })
}

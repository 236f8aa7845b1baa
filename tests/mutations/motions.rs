//! Named faults in the equation of motion: the faulty equation is integrated, and its motion checked.

use super::detection::Detection;
use dwell_dynamics::ReducedState;
use dwell_findings::Check;
use dwell_geometry::{PositionError, Range, Vec2};
use dwell_kinetostatics::{Coefficients, ExactModel, Inertia, LoadKind, Model, ReducedModel};
use dwell_scene::{MotionDuration, PlaneScene};
use dwell_validation::{PlanSubject, free_motion_run};
use dwell_verify::{Finding, FreeMotionCase, check_free_motion};

/// A fault in an equation of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mutation {
    WholeSlope,
    NoSlope,
    SlopeReversed,
    GravityForgotten,
    GravityReversed,
    HalvedInertia,
    MassAtTheJoint,
}

impl Mutation {
    pub const ALL: [Self; 7] = [
        Self::WholeSlope,
        Self::NoSlope,
        Self::SlopeReversed,
        Self::GravityForgotten,
        Self::GravityReversed,
        Self::HalvedInertia,
        Self::MassAtTheJoint,
    ];

    pub fn description(self) -> &'static str {
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
struct ScaledSlopeModel<'a> {
    model: &'a ExactModel,
    factor: f64,
}

impl ReducedModel for ScaledSlopeModel<'_> {
    type Workspace = <ExactModel as ReducedModel>::Workspace;

    fn workspace(&self) -> Self::Workspace {
        self.model.workspace()
    }

    fn reactions(&self) -> usize {
        self.model.reactions()
    }

    fn range(&self) -> Range {
        self.model.range()
    }

    fn inertia(
        &self,
        q: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<(f64, f64), PositionError> {
        let (m, half_dm) = self.model.inertia(q, workspace)?;
        Ok((m, self.factor * half_dm))
    }

    fn inertia_derivatives(
        &self,
        q: f64,
        workspace: &mut Self::Workspace,
    ) -> Result<Inertia, PositionError> {
        let mut at = self.model.inertia_derivatives(q, workspace)?;
        at.half_dm *= self.factor;
        at.half_ddm *= self.factor;
        Ok(at)
    }

    fn coefficients(
        &self,
        q: f64,
        workspace: &mut Self::Workspace,
        out: &mut Coefficients,
    ) -> Result<(), PositionError> {
        self.model.coefficients(q, workspace, out)?;
        out.half_dm *= self.factor;
        Ok(())
    }
}

/// The free motion of a reduced model with ½m′ wrong by a factor, checked over one revolution.
pub fn reduced(scene: &PlaneScene, mutation: Option<Mutation>) -> Option<Detection> {
    let factor = match mutation {
        None => 1.0,
        Some(mutation) => mutation.factor()?,
    };
    let subject = PlanSubject::new(scene).ok()?;
    let motion = scene.motion.as_ref()?;
    let reactions = scene.mechanism.reactions().into_iter();
    let named = reactions.map(|r| (scene.mechanism.reaction_name(r), r.component.unit()));
    let case = FreeMotionCase {
        initial_state: ReducedState {
            t: 0.0,
            q: motion.initial_coordinates[0],
            q_dot: motion.initial_velocities[0],
        },
        revolutions: 1,
        reactions: named.collect(),
        period: None,
    };
    let wrong = ScaledSlopeModel {
        model: subject.exact(),
        factor,
    };
    let run = check_free_motion(&wrong, &case).ok()?;
    Some(Detection::from_findings(&run.findings))
}

/// The free motion of a scene under its weight alone, checked by the multibody equations (6) and by the
/// energy of what is claimed (4).
pub fn under_gravity(scene: &PlaneScene, mutation: Option<Mutation>) -> Option<Detection> {
    let mut scene_unaltered = scene.clone();
    if let Some(motion) = &mut scene_unaltered.motion {
        motion.duration = MotionDuration::Seconds(0.5);
    }
    let mut altered = scene_unaltered.clone();
    match mutation {
        None => {}
        Some(Mutation::GravityForgotten) => altered.loads.clear(),
        Some(Mutation::GravityReversed) => {
            for load in &mut altered.loads {
                if let LoadKind::Gravity { direction } = &mut load.kind {
                    *direction = -*direction;
                }
            }
        }
        Some(Mutation::HalvedInertia) => altered.masses.iter_mut().for_each(|m| m.inertia *= 0.5),
        Some(Mutation::MassAtTheJoint) => altered
            .masses
            .iter_mut()
            .for_each(|m| m.center = Vec2::ZERO),
        Some(_) => return None,
    }
    let run = free_motion_run(&altered).ok()??;
    let mut findings = run.check(&scene_unaltered);
    findings.push(energy(&scene_unaltered, &run)?);
    Some(Detection::from_findings(&findings))
}

/// Kinetic and potential energy of the claimed coordinates and speeds, by the right description.
fn energy(scene: &PlaneScene, run: &dwell_validation::FreeMotionRun) -> Option<Finding> {
    let start = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[]).ok()?;
    let model = model.with_loads(scene.loads.clone()).ok()?;
    let mut workspace = model.workspace::<f64>();
    let mut energies = Vec::new();
    for at in &run.coordinates {
        let [q, q_dot]: [Vec<f64>; 2] = [0, 1].map(|i| at.iter().map(|c| c[i]).collect());
        let state = model.kinematic_state(&q, &q_dot, &mut workspace).ok()?;
        let loads = 0..scene.loads.len();
        let potential: f64 = loads.filter_map(|l| state.potential_energy(l)).sum();
        energies.push((state.kinetic_energy(), potential));
    }
    let sums = energies
        .iter()
        .map(|(kinetic, potential)| kinetic + potential);
    let (min, max) = sums.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), e| {
        (a.min(e), b.max(e))
    });
    let largest = energies
        .iter()
        .fold(0.0_f64, |m, (kinetic, _)| m.max(*kinetic));
    let relative = (max - min) / largest;
    Some(Finding {
        key: "claimed-energy".into(),
        check: Check::Power,
        relative_difference: relative,
        tolerance: 1e-9,
        pass: relative <= 1e-9,
        ..Finding::default()
    })
}

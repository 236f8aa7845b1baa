//! Named faults in states under loads: what is claimed comes from a wrong description or is altered on
//! its results, and is checked by the right one.

use super::detection::Detection;
use super::tested_mechanism::{CheckMode, TestedMechanism};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, JointKind, Vec2, vec2};
use dwell_kinetostatics::{Direction, LoadKind, Magnitude, Strength};
use dwell_scene::PlaneScene;
use dwell_verify::{ClaimedState, Twist};

/// A fault in states under loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mutation {
    GravityReversed,
    GravityForgotten,
    SpringReversed,
    HalfStiffness,
    NoFreeLength,
    OtherEnd,
    DamperReversed,
    HalfDamper,
    NoLever,
    ForceTurns,
    TorqueReversed,
    TorqueFromTheGround,
    PullForPush,
    FrictionReversed,
    FrictionForgotten,
    LoadForgotten,
    HalvedInertia,
    MassAtTheJoint,
    GearRatio,
    ActionReversed,
    ActionForgotten,
    ReactionsReversed,
    NoTransport,
    NoCurvature,
    InertiaForgotten,
}

impl Mutation {
    pub const ALL: [Self; 25] = [
        Self::GravityReversed,
        Self::GravityForgotten,
        Self::SpringReversed,
        Self::HalfStiffness,
        Self::NoFreeLength,
        Self::OtherEnd,
        Self::DamperReversed,
        Self::HalfDamper,
        Self::NoLever,
        Self::ForceTurns,
        Self::TorqueReversed,
        Self::TorqueFromTheGround,
        Self::PullForPush,
        Self::FrictionReversed,
        Self::FrictionForgotten,
        Self::LoadForgotten,
        Self::HalvedInertia,
        Self::MassAtTheJoint,
        Self::GearRatio,
        Self::ActionReversed,
        Self::ActionForgotten,
        Self::ReactionsReversed,
        Self::NoTransport,
        Self::NoCurvature,
        Self::InertiaForgotten,
    ];

    pub fn description(self) -> &'static str {
        match self {
            Self::GravityReversed => "gravity with the other sign",
            Self::GravityForgotten => "gravity forgotten",
            Self::SpringReversed => "a spring that pushes when it is long",
            Self::HalfStiffness => "half a spring's stiffness",
            Self::NoFreeLength => "a spring's free length or angle forgotten",
            Self::OtherEnd => "a spring on another point of its body",
            Self::DamperReversed => "a damper that drives",
            Self::HalfDamper => "half a damper's constant",
            Self::NoLever => "a force's lever forgotten",
            Self::ForceTurns => "a force in the wrong frame",
            Self::TorqueReversed => "a couple of the second body on the first",
            Self::TorqueFromTheGround => "a couple between bodies taken from the ground",
            Self::PullForPush => "a pull for a push",
            Self::FrictionReversed => "friction with the other sign",
            Self::FrictionForgotten => "dry friction forgotten",
            Self::LoadForgotten => "a load forgotten",
            Self::HalvedInertia => "a moment of inertia halved",
            Self::MassAtTheJoint => "a centre of mass taken at the frame's origin",
            Self::GearRatio => "a wrong gear ratio",
            Self::ActionReversed => "an actuator force on the first body",
            Self::ActionForgotten => "an actuator force forgotten",
            Self::ReactionsReversed => "reactions of the second body on the first",
            Self::NoTransport => "velocities on a moving guide without its own",
            Self::NoCurvature => "accelerations without what comes of speeds",
            Self::InertiaForgotten => "statics for dynamics: inertia forces forgotten",
        }
    }

    /// What the checks detect in a mechanism with this fault; nothing where it is none there.
    pub fn check(self, mechanism: &TestedMechanism) -> Option<Detection> {
        let mut claimed = mechanism.claims()?;
        if self.alter_claims(mechanism, &mut claimed) {
            return mechanism.check_claims(claimed);
        }
        let mut altered = mechanism.scene().clone();
        if !self.alter_scene(&mut altered) {
            return None;
        }
        let mut altered = TestedMechanism::from_scene(altered, CheckMode::States)?;
        altered.set_positions(mechanism.positions());
        mechanism.check_claims(altered.claims()?)
    }

    /// Describes the machine wrongly, if it can be.
    // Long: an arm for each mutation.
    fn alter_scene(self, scene: &mut PlaneScene) -> bool {
        match self {
            Self::HalvedInertia => {
                let masses = scene.masses.iter_mut().filter(|m| m.inertia > 0.0);
                return masses.map(|m| m.inertia *= 0.5).count() > 0;
            }
            Self::MassAtTheJoint => {
                let off_centre = scene.masses.iter_mut().filter(|m| m.center != Vec2::ZERO);
                return off_centre.map(|m| m.center = Vec2::ZERO).count() > 0;
            }
            Self::InertiaForgotten => {
                // Gravity would go with the masses.
                let weightless = !scene
                    .loads
                    .iter()
                    .any(|l| matches!(l.kind, LoadKind::Gravity { .. }));
                scene
                    .masses
                    .iter_mut()
                    .for_each(|m| (m.mass, m.inertia) = (0.0, 0.0));
                return weightless;
            }
            Self::GearRatio => {
                let mut found = false;
                for joint in &mut scene.mechanism.joints {
                    match &mut joint.kind {
                        JointKind::Gear { radii, .. } => radii[0] *= 1.001,
                        JointKind::Rack { radius, .. } => *radius *= 1.001,
                        _ => continue,
                    }
                    found = true;
                    break;
                }
                return found;
            }
            Self::GravityForgotten => {
                let before = scene.loads.len();
                scene
                    .loads
                    .retain(|l| !matches!(l.kind, LoadKind::Gravity { .. }));
                return scene.loads.len() < before;
            }
            Self::FrictionForgotten => {
                let before = scene.loads.len();
                scene
                    .loads
                    .retain(|l| !matches!(l.magnitude, Magnitude::Friction(_)));
                return scene.loads.len() < before;
            }
            Self::LoadForgotten => return scene.loads.pop().is_some(),
            _ => {}
        }
        let ground = BodyId(scene.mechanism.ground);
        let mut changed = false;
        for load in &mut scene.loads {
            changed |= match (&mut load.kind, &mut load.magnitude) {
                (kind, Magnitude::Constant(f)) => self.alter_load(kind, f, ground),
                _ => false,
            };
        }
        changed
    }

    fn alter_load(self, kind: &mut LoadKind, f: &mut f64, ground: BodyId) -> bool {
        use Strength::{Direct, Elastic, Quadratic, Viscous};
        match (self, kind) {
            (Self::GravityReversed, LoadKind::Gravity { .. })
            | (Self::SpringReversed, LoadKind::Along(_, Elastic { .. }))
            | (
                Self::DamperReversed,
                LoadKind::Along(_, Viscous | Quadratic) | LoadKind::Drag { .. },
            )
            | (
                Self::PullForPush,
                LoadKind::Along(
                    CoordinateFunction::Length { .. } | CoordinateFunction::Travel(_),
                    Direct,
                ),
            )
            | (Self::TorqueReversed, LoadKind::Along(CoordinateFunction::Angle(_), Direct)) => {
                *f = -*f;
            }
            (Self::HalfStiffness, LoadKind::Along(_, Elastic { .. }))
            | (Self::HalfDamper, LoadKind::Along(_, Viscous | Quadratic) | LoadKind::Drag { .. }) =>
            {
                *f *= 0.5;
            }
            (Self::NoFreeLength, LoadKind::Along(_, Elastic { free })) => *free = 0.0,
            (
                Self::OtherEnd,
                LoadKind::Along(CoordinateFunction::Length { points, .. }, Direct | Elastic { .. }),
            ) => points[1] += vec2(0.01, 0.0),
            (Self::NoLever, LoadKind::Force { point, .. } | LoadKind::Drag { point, .. }) => {
                *point = Vec2::ZERO;
            }
            (Self::ForceTurns, LoadKind::Force { direction, .. }) => {
                *direction = match *direction {
                    Direction::Ground(u) => Direction::Body(u),
                    Direction::Body(u) => Direction::Ground(u),
                };
            }
            (
                Self::TorqueFromTheGround,
                LoadKind::Along(CoordinateFunction::Angle(bodies), Direct),
            ) => bodies[0] = ground,
            _ => return false,
        }
        true
    }

    /// Alters what is claimed, if that is the fault.
    fn alter_claims(self, machine: &TestedMechanism, claimed: &mut [ClaimedState]) -> bool {
        let states = claimed.iter_mut();
        match self {
            Self::ActionReversed => states.for_each(|s| s.tau.iter_mut().for_each(|t| *t = -*t)),
            Self::ActionForgotten => states.for_each(|s| s.tau[0] = 0.0),
            Self::ReactionsReversed => {
                states.for_each(|s| s.reactions.iter_mut().for_each(|r| *r = -*r));
            }
            Self::NoTransport => states.for_each(|s| remove_carrier_velocity(machine.scene(), s)),
            Self::NoCurvature => {
                let straight = machine.accelerations_without_velocity(claimed);
                let states = claimed.iter_mut().zip(straight);
                states.for_each(|(state, straight)| state.accelerations = straight);
            }
            Self::FrictionReversed => return reverse_friction(machine, claimed),
            _ => return false,
        }
        true
    }
}

/// Actions and reactions with the part of friction reversed; whether there is any.
fn reverse_friction(machine: &TestedMechanism, claimed: &mut [ClaimedState]) -> bool {
    let mut frictionless = machine.scene().clone();
    if !Mutation::FrictionForgotten.alter_scene(&mut frictionless) {
        return false;
    }
    let without =
        TestedMechanism::from_scene(frictionless, CheckMode::States).and_then(|m| m.claims());
    let Some(without) = without else {
        return false;
    };
    for (state, without) in claimed.iter_mut().zip(without) {
        let actual = state.tau.iter_mut().chain(&mut state.reactions);
        let without_friction = without.tau.iter().chain(&without.reactions);
        actual
            .zip(without_friction)
            .for_each(|(value, without_friction)| *value = 2.0 * without_friction - *value);
    }
    true
}

/// Takes off the velocities of bodies on moving guides what these carry along.
fn remove_carrier_velocity(scene: &PlaneScene, state: &mut ClaimedState) {
    for joint in &scene.mechanism.joints {
        let [carrier, body] = joint.bodies.map(|b| b.0);
        if !matches!(joint.kind, JointKind::Prismatic { .. }) || body == scene.mechanism.ground {
            continue;
        }
        let Twist { linear, angular } = state.velocities[carrier];
        let arm = state.poses[body].position - state.poses[carrier].position;
        state.velocities[body].linear -= linear + angular.cross(arm);
    }
}

//! Named faults in states under loads: what is claimed comes from a wrong description or is altered on
//! the way out, and is judged by the right one.

use super::machine::{By, Claims, Machine};
use super::verdict::Verdict;
use dwell_geometry::{BodyId, JointKind, Vec2, vec2};
use dwell_kinetostatics::{LoadKind, Magnitude};
use dwell_scene::Scene;
use dwell_verify::State;

/// A fault in states under loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
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

impl Fault {
    pub(crate) const ALL: [Self; 25] = [
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

    pub(crate) fn words(self) -> &'static str {
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
            Self::ActionReversed => "actuator's action on its first body",
            Self::ActionForgotten => "an actuator's action forgotten",
            Self::ReactionsReversed => "reactions of the second body on the first",
            Self::NoTransport => "velocities on a moving guide without its own",
            Self::NoCurvature => "accelerations without what comes of speeds",
            Self::InertiaForgotten => "statics for dynamics: inertia forces forgotten",
        }
    }

    /// What the truths say of a machine with this fault; nothing where it is none there.
    pub(crate) fn judge(self, right: &Machine) -> Option<Verdict> {
        let mut claims = right.claims()?;
        if self.claim(right, &mut claims) {
            return right.judge_claims(claims);
        }
        let mut wrong = right.scene().clone();
        if !self.describe(&mut wrong) {
            return None;
        }
        let mut wrong = Machine::described(wrong, By::States)?;
        wrong.stand(right.positions());
        right.judge_claims(wrong.claims()?)
    }

    /// Describes the machine wrongly, if it can be.
    fn describe(self, scene: &mut Scene) -> bool {
        match self {
            Self::HalvedInertia => {
                let masses = scene.masses.iter_mut().filter(|m| m.inertia > 0.0);
                return masses.map(|m| m.inertia *= 0.5).count() > 0;
            }
            Self::MassAtTheJoint => {
                let off = scene.masses.iter_mut().filter(|m| m.center != Vec2::ZERO);
                return off.map(|m| m.center = Vec2::ZERO).count() > 0;
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
                (kind, Magnitude::Constant(f)) => self.load(kind, f, ground),
                _ => false,
            };
        }
        changed
    }

    fn load(self, kind: &mut LoadKind, f: &mut f64, ground: BodyId) -> bool {
        match (self, kind) {
            (Self::GravityReversed, LoadKind::Gravity { .. })
            | (Self::SpringReversed, LoadKind::Spring { .. } | LoadKind::TorsionSpring { .. })
            | (
                Self::DamperReversed,
                LoadKind::Damper { .. } | LoadKind::TorsionDamper { .. } | LoadKind::SlideDamper(_),
            )
            | (Self::PullForPush, LoadKind::Push { .. } | LoadKind::Slide(_))
            | (Self::TorqueReversed, LoadKind::Torque { .. }) => *f = -*f,
            (Self::HalfStiffness, LoadKind::Spring { .. } | LoadKind::TorsionSpring { .. })
            | (
                Self::HalfDamper,
                LoadKind::Damper { .. } | LoadKind::TorsionDamper { .. } | LoadKind::SlideDamper(_),
            ) => *f *= 0.5,
            (
                Self::NoFreeLength,
                LoadKind::Spring { free, .. } | LoadKind::TorsionSpring { free, .. },
            ) => {
                *free = 0.0;
            }
            (Self::OtherEnd, LoadKind::Spring { points, .. } | LoadKind::Push { points, .. }) => {
                points[1] += vec2(0.01, 0.0);
            }
            (Self::NoLever, LoadKind::Force { point, .. }) => *point = Vec2::ZERO,
            (Self::ForceTurns, LoadKind::Force { follows, .. }) => *follows = !*follows,
            (Self::TorqueFromTheGround, LoadKind::Torque { bodies }) => bodies[0] = ground,
            _ => return false,
        }
        true
    }

    /// Alters what is claimed, if that is the fault.
    fn claim(self, machine: &Machine, claims: &mut Claims) -> bool {
        let states = claims.0.iter_mut();
        match self {
            Self::ActionReversed => states.for_each(|s| s.tau.iter_mut().for_each(|t| *t = -*t)),
            Self::ActionForgotten => states.for_each(|s| s.tau[0] = 0.0),
            Self::ReactionsReversed => {
                states.for_each(|s| s.reactions.iter_mut().for_each(|r| *r = -*r));
            }
            Self::NoTransport => states.for_each(|s| transport(machine.scene(), s)),
            Self::NoCurvature => {
                let straight = machine.straight(claims);
                let states = claims.0.iter_mut().zip(straight);
                states.for_each(|(state, straight)| state.acceleration = straight);
            }
            Self::FrictionReversed => return reverse_friction(machine, claims),
            _ => return false,
        }
        true
    }
}

/// Actions and reactions with the part of friction reversed; whether there is any.
fn reverse_friction(machine: &Machine, claims: &mut Claims) -> bool {
    let mut smooth = machine.scene().clone();
    if !Fault::FrictionForgotten.describe(&mut smooth) {
        return false;
    }
    let without = Machine::described(smooth, By::States).and_then(|m| m.claims());
    let Some((without, _)) = without else {
        return false;
    };
    for (state, without) in claims.0.iter_mut().zip(without) {
        let own = state.tau.iter_mut().chain(&mut state.reactions);
        let free = without.tau.iter().chain(&without.reactions);
        own.zip(free)
            .for_each(|(value, free)| *value = 2.0 * free - *value);
    }
    true
}

/// Takes off the velocities of bodies on moving guides what these carry along.
fn transport(scene: &Scene, state: &mut State) {
    for joint in &scene.mechanism.joints {
        let [carrier, body] = joint.bodies.map(|b| b.0);
        if !matches!(joint.kind, JointKind::Prismatic { .. }) || body == scene.mechanism.ground {
            continue;
        }
        let [x, y, spin] = state.velocity[carrier];
        let [from, to] = [carrier, body].map(|b| vec2(state.bodies[b][0], state.bodies[b][1]));
        let carried = vec2(x, y) + (to - from).perp() * spin;
        state.velocity[body][0] -= carried.x;
        state.velocity[body][1] -= carried.y;
    }
}

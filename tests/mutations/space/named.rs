//! Faults in space that have a name.

use super::tested::TestedSpace;
use crate::mutations::detection::Detection;
use crate::mutations::mutating_scalar::{MutationKind, Operation, SourceOperation};
use crate::mutations::operations::MutatedSubject as _;
use crate::mutations::source::SourceFiles;
use crate::mutations::tested_mechanism::UNCHANGED_TOLERANCE;
use dwell_geometry::space::{JointKind, Vec3, vec3};
use dwell_kinetostatics::Strength;
use dwell_kinetostatics::space::{DirectedCouple, Direction, LoadKind};
use dwell_scene::SpaceScene;
use dwell_validation::SpaceClaims;
use dwell_verify::ClaimedState;

/// What goes wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mutation {
    NoGyroscopicTerm,
    GyroscopicTermReversed,
    NoCentrifugalTerm,
    ProductsOfInertiaReversed,
    MomentsOfInertiaExchanged,
    CentreAtOrigin,
    MassForgotten,
    AxisTurned,
    PointMoved,
    UniversalAxesExchanged,
    RodLonger,
    ThreadReversed,
    PitchPointMoved,
    GravityReversed,
    ForceInWrongFrame,
    FreeLengthForgotten,
    ReactionsReversed,
    MomentsForgotten,
    MomentsAboutOrigin,
    ActionsReversed,
    InertiasHalved,
    LoadPowerForgotten,
    VelocityTermsForgotten,
    StaticsForDynamics,
}

use Mutation::{
    ActionsReversed, AxisTurned, CentreAtOrigin, ForceInWrongFrame, FreeLengthForgotten,
    GravityReversed, GyroscopicTermReversed, InertiasHalved, LoadPowerForgotten, MassForgotten,
    MomentsAboutOrigin, MomentsForgotten, MomentsOfInertiaExchanged, NoCentrifugalTerm,
    NoGyroscopicTerm, PitchPointMoved, PointMoved, ProductsOfInertiaReversed, ReactionsReversed,
    RodLonger, StaticsForDynamics, ThreadReversed, UniversalAxesExchanged, VelocityTermsForgotten,
};

/// A small fault of a dimension: rad, or parts of the size.
const SMALL: f64 = 1e-3;

impl Mutation {
    /// Terms of the source, wrong descriptions, and wrong results.
    pub(super) const TERMS: [Self; 3] =
        [NoGyroscopicTerm, GyroscopicTermReversed, NoCentrifugalTerm];
    pub(super) const DESCRIPTIONS: [Self; 13] = [
        ProductsOfInertiaReversed,
        MomentsOfInertiaExchanged,
        CentreAtOrigin,
        MassForgotten,
        AxisTurned,
        PointMoved,
        UniversalAxesExchanged,
        RodLonger,
        ThreadReversed,
        PitchPointMoved,
        GravityReversed,
        ForceInWrongFrame,
        FreeLengthForgotten,
    ];
    pub(super) const RESULTS: [Self; 8] = [
        ReactionsReversed,
        MomentsForgotten,
        MomentsAboutOrigin,
        ActionsReversed,
        InertiasHalved,
        LoadPowerForgotten,
        VelocityTermsForgotten,
        StaticsForDynamics,
    ];

    pub(super) fn description(self) -> &'static str {
        match self {
            NoGyroscopicTerm => "gyroscopic term forgotten",
            GyroscopicTermReversed => "gyroscopic term with the other sign",
            NoCentrifugalTerm => "centrifugal term of a point of a body forgotten",
            ProductsOfInertiaReversed => "products of inertia with the other sign",
            MomentsOfInertiaExchanged => "two moments of inertia exchanged",
            CentreAtOrigin => "a centre of mass at its frame's origin",
            MassForgotten => "a body's mass forgotten",
            AxisTurned => "a joint's axis turned by a thousandth of a radian",
            PointMoved => "a joint's point moved by a thousandth of the size",
            UniversalAxesExchanged => "axis and normal of a universal joint exchanged",
            RodLonger => "a rod longer by a thousandth",
            ThreadReversed => "a thread to the other side",
            PitchPointMoved => "a pitch point moved by a thousandth of the size",
            GravityReversed => "gravity with the other sign",
            ForceInWrongFrame => "a force or torque in the wrong frame",
            FreeLengthForgotten => "a spring's free length or angle forgotten",
            ReactionsReversed => "reactions of the second body on the first",
            MomentsForgotten => "moments of reactions forgotten",
            MomentsAboutOrigin => "moments of reactions about the origin of the body",
            ActionsReversed => "actuators' actions with the other sign",
            InertiasHalved => "half the generalised inertias",
            LoadPowerForgotten => "power of the loads forgotten",
            VelocityTermsForgotten => "accelerations without what comes of speeds",
            StaticsForDynamics => "statics for dynamics: inertia forces forgotten",
        }
    }

    /// The line of the source and what goes wrong there, of a term.
    fn term(self) -> Option<(&'static str, &'static str, Operation, MutationKind)> {
        let gyroscopic = "tensor(motion.angular_acceleration) + w.cross(";
        match self {
            NoGyroscopicTerm => {
                let kind = MutationKind::SecondTermOmitted;
                Some(("space/mass.rs", gyroscopic, Operation::Sum, kind))
            }
            GyroscopicTermReversed => Some((
                "space/mass.rs",
                gyroscopic,
                Operation::Sum,
                MutationKind::Sign,
            )),
            NoCentrifugalTerm => {
                let line =
                    "self.angular_acceleration.cross(u) + self.angular_velocity.cross(first)";
                let kind = MutationKind::SecondTermOmitted;
                Some(("space/frames.rs", line, Operation::Sum, kind))
            }
            _ => None,
        }
    }

    /// What the checks detect on a mechanism; none where it is no fault of it.
    pub(super) fn check(self, tested: &TestedSpace<'_>, source: &SourceFiles) -> Option<Detection> {
        if let Some(term) = self.term() {
            return check_term(tested, source, term);
        }
        if Self::DESCRIPTIONS.contains(&self) {
            let scene = self.description_of(tested)?;
            // A loop that no longer closes is refused.
            let other = SpaceClaims::new(&scene).ok()?;
            let states = tested.states_of_another(&other)?;
            return tested.check_claims(&|q| other.at_rest::<f64>(q), &states);
        }
        let mut states = tested.states(None).ok()?;
        self.corrupt(tested, &mut states)?;
        tested.check_claims(&|q| tested.claims().at_rest::<f64>(q), &states)
    }

    /// The wrong description; none where the mechanism has no such thing.
    // Long: one arm for each fault.
    fn description_of(self, tested: &TestedSpace<'_>) -> Option<SpaceScene> {
        let mut scene = tested.scene().clone();
        let size = tested.claims().model().plan().size();
        let ground = scene.mechanism.ground;
        let joints = &mut scene.mechanism.joints;
        let moving = scene
            .masses
            .iter_mut()
            .enumerate()
            .filter(|(b, _)| *b != ground);
        let mut moving = moving.map(|(_, mass)| mass);
        match self {
            ProductsOfInertiaReversed => {
                let mut with_products = moving.filter(|m| m.inertia[3..] != [0.0; 3]);
                with_products.next()?.inertia[3..]
                    .iter_mut()
                    .for_each(|i| *i = -*i);
            }
            MomentsOfInertiaExchanged => {
                let mut unequal = moving.filter(|m| m.inertia[0] != m.inertia[2]);
                unequal.next()?.inertia.swap(0, 2);
            }
            CentreAtOrigin => moving.find(|m| m.center != Vec3::ZERO)?.center = Vec3::ZERO,
            MassForgotten => moving.find(|m| m.mass > 0.0)?.mass = 0.0,
            AxisTurned => {
                let mut others = joints.iter_mut().rev().filter(|j| {
                    matches!(
                        j.kind,
                        JointKind::Revolute | JointKind::Cylindrical | JointKind::Prismatic
                    )
                });
                let side = &mut others.next()?.sides[0];
                let across = side.axis.cross(side.normal);
                side.axis = (side.axis + across.scaled(SMALL)).unit()?;
            }
            PointMoved => {
                let of = |j: &&mut dwell_geometry::space::Joint| {
                    matches!(
                        j.kind,
                        JointKind::Spherical | JointKind::Revolute | JointKind::Universal
                    )
                };
                let side = &mut joints.iter_mut().rev().find(of)?.sides[1];
                side.point += side.axis.scaled(SMALL * size);
                side.point += side.normal.scaled(SMALL * size);
            }
            UniversalAxesExchanged => {
                let mut universal = joints.iter_mut().filter(|j| j.kind == JointKind::Universal);
                let side = &mut universal.next()?.sides[1];
                std::mem::swap(&mut side.axis, &mut side.normal);
            }
            RodLonger => {
                let lengths = joints.iter_mut().filter_map(|j| match &mut j.kind {
                    JointKind::Distance { length } => Some(length),
                    _ => None,
                });
                *lengths.last()? *= 1.0 + SMALL;
            }
            ThreadReversed => {
                let mut pitches = joints.iter_mut().filter_map(|j| match &mut j.kind {
                    JointKind::Helical { pitch } => Some(pitch),
                    _ => None,
                });
                *pitches.next()? *= -1.0;
            }
            PitchPointMoved => {
                let is_gear = |j: &&mut dwell_geometry::space::Joint| {
                    matches!(j.kind, JointKind::Gear { .. })
                };
                let joint = joints.iter_mut().find(is_gear)?;
                for side in &mut joint.sides {
                    let away = side.point.unit()?;
                    side.point += away.scaled(SMALL * size);
                }
            }
            GravityReversed | ForceInWrongFrame | FreeLengthForgotten => {
                let mut changed = 0;
                for load in &mut scene.loads {
                    let before = load.kind;
                    self.misread(&mut load.kind);
                    changed += usize::from(load.kind != before);
                }
                (changed > 0).then_some(())?;
            }
            _ => return None,
        }
        Some(scene)
    }

    /// A load that is read wrong.
    fn misread(self, kind: &mut LoadKind) {
        let other = |direction: Direction| match direction {
            Direction::Ground(u) => Direction::Body(u),
            Direction::Body(u) => Direction::Ground(u),
        };
        match (self, kind) {
            (GravityReversed, LoadKind::Gravity { direction: g }) => *g = -*g,
            (
                ForceInWrongFrame,
                LoadKind::Force { direction, .. }
                | LoadKind::Special(DirectedCouple { direction, .. }),
            ) => *direction = other(*direction),
            (FreeLengthForgotten, LoadKind::Along(_, Strength::Elastic { free })) => *free = 0.0,
            _ => {}
        }
    }

    /// Wrong results of right states; none where the mechanism has no such result.
    fn corrupt(self, tested: &TestedSpace<'_>, states: &mut [ClaimedState]) -> Option<()> {
        let mechanism = &tested.scene().mechanism;
        for state in states {
            match self {
                ReactionsReversed => state.reactions.iter_mut().for_each(|r| *r = -*r),
                MomentsForgotten => {
                    let joints = state.reactions.chunks_mut(6);
                    joints.for_each(|wrench| wrench[3..].fill(0.0));
                }
                MomentsAboutOrigin => {
                    let wrenches = state.reactions.chunks_mut(6);
                    for (joint, wrench) in mechanism.joints.iter().zip(wrenches) {
                        let pose = &state.poses[joint.side_body(1).0];
                        let arm = pose.rotation.apply(joint.sides[1].point);
                        let moment = arm.cross(vec3(wrench[0], wrench[1], wrench[2]));
                        let parts = [moment.x, moment.y, moment.z];
                        wrench[3..].iter_mut().zip(parts).for_each(|(m, p)| *m += p);
                    }
                }
                ActionsReversed => state.tau.iter_mut().for_each(|tau| *tau = -*tau),
                InertiasHalved => state.inertias.iter_mut().for_each(|m| *m *= 0.5),
                LoadPowerForgotten => state.load_power = Some(0.0),
                VelocityTermsForgotten => {
                    let zero = vec![0.0; state.q.len()];
                    let rates = [&state.q[..], &zero, &state.q_ddot];
                    state.accelerations = tested.claims().accelerations(rates).ok()?;
                }
                StaticsForDynamics => {
                    let zero = vec![0.0; state.q.len()];
                    let rates = [&state.q[..], &zero, &zero];
                    let ground = dwell_kinetostatics::space::Axes::Ground;
                    let still = tested.claims().state::<f64>(0.3, rates, ground).ok()?;
                    (state.tau, state.reactions) = (still.tau, still.reactions);
                }
                _ => return None,
            }
        }
        Some(())
    }
}

/// All operations of a kind on a line of the source, one of which is wrong: on the one that is detected least.
fn check_term(
    tested: &TestedSpace<'_>,
    source: &SourceFiles,
    (file, line, operation, kind): (&str, &str, Operation, MutationKind),
) -> Option<Detection> {
    let is_term = |o: &SourceOperation| {
        o.file.ends_with(file) && o.operation == operation && source.line(*o).contains(line)
    };
    let operations = tested.operations().into_iter().filter(is_term);
    let faults = operations.filter_map(|operation| {
        let mutation = Some((operation, kind));
        let change = tested.change(mutation)?;
        (change > UNCHANGED_TOLERANCE).then(|| tested.check(mutation))
    });
    faults.min_by_key(Detection::check_count)
}

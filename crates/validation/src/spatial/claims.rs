//! What a model in space says of itself, evaluated in any kind of number, for the checks of states.

use crate::cases::model_states::mass_matrix;
use crate::cases::subject::{Refusal, claimed_at};
use dwell_geometry::space::{
    BodyMotion, Coordinate, Frame, Joint, JointKind, Placement, Pose, Rotation, Vec3, vec3,
};
use dwell_geometry::{JointId, PositionError};
use dwell_kinetostatics::space::{Axes, Component, Load, LoadKind, Model, Reaction};
use dwell_kinetostatics::{
    Friction, FrictionContact, InverseDynamics, KinematicState, KinetostaticsError,
    MachineModel as _, Magnitude, Strength,
};
use dwell_numerics::Scalar;
use dwell_scene::SpaceScene;
use dwell_study::{StudyError, model_with_loads};
use dwell_verify::space::{DensePose, load_wrenches};
use dwell_verify::{
    AssembledMechanism, CheckedMechanism, ClaimedState, DenseError, Pose as BodyPose, SubjectError,
    Twist,
};

/// Components of a joint's reaction in one kind of axes.
pub(super) const COMPONENTS: usize = 6;

/// A scene with its loaded model, which has all reactions in the axes of the ground and in those of their joints.
#[derive(Debug)]
pub struct SpaceClaims<'a> {
    scene: &'a SpaceScene,
    model: Model,
    start: Vec<BodyPose>,
}

impl<'a> SpaceClaims<'a> {
    /// The claims of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be assembled, or a load does not fit it.
    pub fn new(scene: &'a SpaceScene) -> Result<Self, StudyError> {
        let all = all_reactions(scene, &[Axes::Ground, Axes::Joint]);
        let model = model_with_loads(scene, &all)?;
        let mut claims = Self {
            scene,
            model,
            start: Vec::new(),
        };
        // The mechanism was assembled there.
        let start = claims.placements::<f64>(&scene.assembly.q);
        claims.start = BodyPose::all_in_space(&start.unwrap_or_default());
        Ok(claims)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The scene.
    pub(super) fn scene(&self) -> &'a SpaceScene {
        self.scene
    }

    /// A length of the order of the mechanism, m.
    pub(super) fn size(&self) -> f64 {
        self.model.plan().size()
    }

    /// The mechanism for the checks.
    pub fn assembled(&self) -> AssembledMechanism<'_> {
        let (scene, idle) = (self.scene, &self.model.plan().mobility().idle);
        AssembledMechanism {
            mechanism: CheckedMechanism::Space(&scene.mechanism, &scene.masses, idle),
            q: &scene.assembly.q,
            poses: &self.start,
        }
    }

    /// The dense equations at placements of all bodies.
    ///
    /// # Errors
    /// [`DenseError`] where they have no singular values.
    pub(super) fn dense_pose<'p>(
        &'p self,
        placements: &'p [Placement],
    ) -> Result<DensePose<'p>, DenseError> {
        DensePose::new(&self.scene.mechanism, &self.scene.masses, placements)
    }

    /// The loads that have a direction of their own when they are alone, as what they are at magnitude one: of a damper a unit of its
    /// resistance.
    pub fn unit_loads(&self) -> Vec<(LoadKind, f64)> {
        let unit = |kind: LoadKind| match kind {
            LoadKind::Along(along, Strength::Viscous) => {
                (LoadKind::Along(along, Strength::Direct), -1.0)
            }
            LoadKind::Along(..)
            | LoadKind::Gravity { .. }
            | LoadKind::Force { .. }
            | LoadKind::Drag { .. }
            | LoadKind::Special(_) => (kind, 1.0),
        };
        self.model.loads().iter().map(|l| unit(l.kind)).collect()
    }

    /// Whether the loads determine each component of each joint's reaction in the axes of the ground, at coordinates.
    ///
    /// # Errors
    /// [`PositionError`] where there is no pose.
    pub fn determined(&self, q: &[f64]) -> Result<Vec<bool>, PositionError> {
        Ok(of_ground(
            &self.model.determined(q, &mut self.model.workspace())?,
        ))
    }

    fn placement<T: Scalar>(&self, pose: &Pose<T>, body: usize) -> Placement {
        let frame: &Frame<T> = self.model.plan().frame(pose, body);
        let own = self.model.plan().evaluation_frame(body);
        let rotation = Rotation {
            columns: frame.rotation.columns.map(plain),
        };
        let rotation = rotation.after(&own.rotation.inverse());
        Placement {
            position: self.model.plan().origin() + plain(frame.position)
                - rotation.apply(own.position),
            rotation,
        }
    }

    fn all_placements<T: Scalar>(&self, pose: &Pose<T>) -> Vec<Placement> {
        let bodies = 0..self.scene.mechanism.bodies.len();
        bodies.map(|b| self.placement(pose, b)).collect()
    }

    /// The reactions of one kind of axes in those of the ground.
    fn in_ground<T: Scalar>(&self, reactions: &[T], poses: &[BodyPose], of: Axes) -> Vec<f64> {
        let first = match of {
            Axes::Ground | Axes::Line => 0,
            Axes::Joint => COMPONENTS,
        };
        let of_joint = |(joint, all): (&Joint, &[T])| {
            let side = &joint.sides[0];
            let turned = |v: Vec3| poses[joint.side_body(0).0].rotation.apply(v);
            let axes = match of {
                Axes::Ground | Axes::Line => Vec3::AXES,
                Axes::Joint => [side.normal, side.axis.cross(side.normal), side.axis].map(turned),
            };
            let vector = |k: usize| {
                let parts = axes.iter().zip(&all[first + k..][..3]);
                parts.fold(Vec3::ZERO, |sum, (axis, part)| {
                    sum + axis.scaled(part.value())
                })
            };
            [vector(0), vector(3)].map(|v| [v.x, v.y, v.z]).concat()
        };
        let joints = self.scene.mechanism.joints.iter();
        joints
            .zip(reactions.chunks(2 * COMPONENTS))
            .flat_map(of_joint)
            .collect()
    }

    /// Poses and motions of all bodies, under loads with their magnitudes.
    fn motion<T: Scalar>(
        &self,
        rates: [&[f64]; 3],
        loads: &[(LoadKind, f64)],
    ) -> Result<ClaimedState, PositionError> {
        let plan = self.model.plan();
        let mut pose = plan.pose::<T>();
        let [q, q_dot, q_ddot] = rates.map(lifted);
        plan.positions(&q, &mut pose)?;
        plan.velocities(&q_dot, &mut pose);
        plan.accelerations(&q_ddot, &mut pose);
        let placements = self.all_placements(&pose);
        let motion = |b: usize| {
            let motion = plan.body_motion(&pose, b);
            BodyMotion {
                velocity: plain(motion.velocity),
                angular_velocity: plain(motion.angular_velocity),
                acceleration: plain(motion.acceleration),
                angular_acceleration: plain(motion.angular_acceleration),
            }
        };
        let motions: Vec<BodyMotion> = (0..placements.len()).map(motion).collect();
        let twists = |m: &BodyMotion| {
            let twist = |linear, angular| Twist { linear, angular };
            let velocity = twist(m.velocity, m.angular_velocity);
            (velocity, twist(m.acceleration, m.angular_acceleration))
        };
        let (velocities, accelerations) = motions.iter().map(twists).unzip();
        let (mechanism, masses) = (&self.scene.mechanism, &self.scene.masses);
        let bodies = (mechanism, &masses[..], &placements[..]);
        let [q, q_dot, q_ddot] = rates.map(<[f64]>::to_vec);
        let coordinates: Vec<String> = q.iter().map(|q| format!("{q:.4}")).collect();
        Ok(ClaimedState {
            name: format!("q = {}", coordinates.join(" ")),
            q,
            q_dot,
            q_ddot,
            load_wrenches: load_wrenches(bodies, &motions, loads),
            load_power: Some(0.0),
            poses: BodyPose::all_in_space(&placements),
            velocities,
            accelerations,
            ..ClaimedState::default()
        })
    }

    /// The accelerations of all bodies at coordinates, speeds and accelerations.
    ///
    /// # Errors
    /// [`PositionError`] where there is no pose.
    pub fn accelerations(&self, rates: [&[f64]; 3]) -> Result<Vec<Twist>, PositionError> {
        Ok(self.motion::<f64>(rates, &[])?.accelerations)
    }

    /// The magnitudes of the loads in plain numbers.
    pub(super) fn magnitudes(
        &self,
        t: f64,
        [q, q_dot]: [&[f64]; 2],
    ) -> Result<Vec<f64>, KinetostaticsError> {
        let mut workspace = self.model.workspace::<f64>();
        let state = self.model.kinematic_state(q, q_dot, &mut workspace)?;
        Ok(state.apply_loads(t)?.wrenches()?.magnitudes().to_vec())
    }

    /// A friction of a cylindrical joint that holds: one force along the velocity of the surface of a pin of this radius, m.
    fn surface_friction(&self, load: &Load) -> Option<(Friction, f64)> {
        let (friction, LoadKind::Along(Coordinate::Travel(joint), Strength::Direct)) =
            (load.friction()?, load.kind)
        else {
            return None;
        };
        let FrictionContact::Bearing { radius, .. } = friction.contact else {
            return None;
        };
        let kind = self.scene.mechanism.joints[joint.0].kind;
        let holds = kind == JointKind::Cylindrical && friction.regularization_speed.is_none();
        holds.then_some((friction, radius))
    }

    /// What a unit of a load is at rest, of a damper of its resistance.
    fn unit_parts(&self, q: &[f64], load: usize) -> Result<Vec<(LoadKind, f64)>, Refusal> {
        let Some((friction, radius)) = self.surface_friction(&self.model.loads()[load]) else {
            return Ok(self.unit_loads().get(load).copied().into_iter().collect());
        };
        let placements = self.placements::<f64>(q)?;
        let [along, turn] = self.dense_pose(&placements)?.sliding(&[1.0], &friction);
        let length = along.hypot(radius * turn);
        Ok(vec![
            (LoadKind::slide_force(friction.joint), along / length),
            (
                LoadKind::couple(friction.joint),
                radius * radius * turn / length,
            ),
        ])
    }

    /// The loads with their magnitudes in a state, those that are friction by the dense equations: what the model says of them is what is
    /// judged.
    fn loads(
        &self,
        rates: [&[f64]; 3],
        magnitudes: &[f64],
    ) -> Result<Vec<(LoadKind, f64)>, Refusal> {
        let [q, q_dot, q_ddot] = rates;
        let (mut loads, mut frictions) = (Vec::new(), Vec::new());
        for (load, magnitude) in self.model.loads().iter().zip(magnitudes) {
            loads.push((load.kind, *magnitude));
            frictions.push(load.friction());
            // What holds in a cylindrical joint is one load, and two here.
            if let Some((friction, _)) = self.surface_friction(load) {
                loads.push((LoadKind::couple(friction.joint), 0.0));
                frictions.push(Some(friction));
            }
        }
        if frictions.iter().all(Option::is_none) {
            return Ok(loads);
        }
        let placements = self.placements::<f64>(q)?;
        let dense = self.dense_pose(&placements)?;
        Ok(dense.with_friction([q_dot, q_ddot], (&loads, &frictions))?)
    }

    /// The state under all loads at time `t` (s), at coordinates, speeds and accelerations, with its reactions as they are read in these axes.
    ///
    /// # Errors
    /// [`SubjectError`] where it cannot be evaluated.
    pub fn state<T: Scalar>(
        &self,
        t: f64,
        rates: [&[f64]; 3],
        axes: Axes,
    ) -> Result<ClaimedState, SubjectError> {
        let [q, q_dot, _] = rates;
        claimed_at(q, || {
            let magnitudes = self.magnitudes(t, [q, q_dot])?;
            let mut claimed = self.motion::<T>(rates, &self.loads(rates, &magnitudes)?)?;
            let (mut workspace, mut result) = (self.model.workspace(), self.model.result_buffer());
            let of_numbers = rates.map(lifted::<T>);
            let at = of_numbers.each_ref().map(Vec::as_slice);
            let state = (self.model).kinetostatics(t, at, &mut workspace, &mut result)?;
            let powers = (0..magnitudes.len()).map(|load| state.load_power(load).value());
            claimed.load_power = Some(powers.sum());
            self.set_forces(&mut claimed, state.inverse_dynamics(), axes);
            claimed.inertias = mass_matrix(&self.model, &mut state.into_kinematic_state());
            Ok(claimed)
        })
    }

    /// Of one actuator: the two unit passes of the reduced model as states, that of unit speed first.
    ///
    /// # Errors
    /// [`SubjectError`] where they cannot be evaluated.
    pub fn unit_passes<T: Scalar>(
        &self,
        q: f64,
        axes: Axes,
    ) -> Result<[ClaimedState; 2], SubjectError> {
        claimed_at(&[q], || {
            let mut moving = self.motion::<T>([&[q], &[1.0], &[0.0]], &[])?;
            let mut found = self.model.coefficient_buffer::<T>();
            let mut workspace = self.model.workspace();
            (self.model).reduce(T::from_f64(q), &mut workspace, &mut found)?;
            moving.inertias = vec![found.m.value()];
            let mut from_rest = moving.clone();
            (from_rest.q_dot, from_rest.q_ddot) = (vec![0.0], vec![1.0]);
            let at_rest = vec![Twist::default(); moving.velocities.len()];
            from_rest.accelerations = std::mem::replace(&mut from_rest.velocities, at_rest);
            moving.tau = vec![found.half_dm.value()];
            from_rest.tau = vec![found.m.value()];
            moving.reactions = self.in_ground(&found.b, &moving.poses, axes);
            from_rest.reactions = self.in_ground(&found.a, &moving.poses, axes);
            Ok([moving, from_rest])
        })
    }

    /// The poses and the generalised inertias at coordinates.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    pub fn at_rest<T: Scalar>(&self, q: &[f64]) -> Result<ClaimedState, SubjectError> {
        claimed_at(q, || self.at_rest_under::<T>(q, &[], |_| Ok(())))
    }

    /// The response to a unit of a load, at rest.
    ///
    /// # Errors
    /// [`SubjectError`] where it cannot be evaluated.
    pub fn load_response<T: Scalar>(
        &self,
        q: &[f64],
        load: usize,
        axes: Axes,
    ) -> Result<ClaimedState, SubjectError> {
        claimed_at(q, || {
            let mut found = self.model.result_buffer::<T>();
            let respond = |state: &mut KinematicState<'_, T, Model>| {
                state.unit_load_response(load, &mut found)
            };
            let mut claimed = self.at_rest_under(q, &self.unit_parts(q, load)?, respond)?;
            self.set_forces(&mut claimed, &found, axes);
            Ok(claimed)
        })
    }

    /// The state at rest under loads with their magnitudes, where more is done with the kinematics.
    fn at_rest_under<T: Scalar>(
        &self,
        q: &[f64],
        loads: &[(LoadKind, f64)],
        more: impl FnOnce(&mut KinematicState<'_, T, Model>) -> Result<(), KinetostaticsError>,
    ) -> Result<ClaimedState, Refusal> {
        let zero = vec![0.0; q.len()];
        let mut claimed = self.motion::<T>([q, &zero, &zero], loads)?;
        let (mut workspace, q, zero) = (self.model.workspace(), lifted(q), lifted(&zero));
        let mut state = self.model.kinematic_state(&q, &zero, &mut workspace)?;
        claimed.inertias = mass_matrix(&self.model, &mut state);
        more(&mut state)?;
        Ok(claimed)
    }

    /// Where the bodies are at coordinates.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    pub fn placements<T: Scalar>(&self, q: &[f64]) -> Result<Vec<Placement>, SubjectError> {
        claimed_at(q, || {
            let mut pose = self.model.plan().pose::<T>();
            self.model.plan().positions(&lifted(q), &mut pose)?;
            Ok(self.all_placements(&pose))
        })
    }

    fn set_forces<T: Scalar>(
        &self,
        claimed: &mut ClaimedState,
        found: &InverseDynamics<T>,
        axes: Axes,
    ) {
        claimed.tau = found.tau.iter().map(|v| v.value()).collect();
        claimed.reactions = self.in_ground(&found.reactions, &claimed.poses, axes);
    }
}

/// What of all reactions is in the axes of the ground.
pub(super) fn of_ground<T: Copy>(all: &[T]) -> Vec<T> {
    let joints = all.chunks(2 * COMPONENTS);
    joints.flat_map(|of| &of[..COMPONENTS]).copied().collect()
}

/// All components of the reactions of all joints, joint by joint, in some kinds of axes.
pub(crate) fn all_reactions(scene: &SpaceScene, axes: &[Axes]) -> Vec<Reaction> {
    let joints = 0..scene.mechanism.joints.len();
    let kinds = joints.flat_map(|j| axes.iter().map(move |&axes| (j, axes)));
    let component = |(j, axes): (usize, Axes)| {
        (0..COMPONENTS).map(move |k| Reaction {
            joint: JointId(j),
            component: match k {
                0..3 => Component::Force(axes, k),
                _ => Component::Moment(axes, k - 3),
            },
        })
    };
    kinds.flat_map(component).collect()
}

/// Names of the components of a reaction, and the components themselves.
pub(super) const NAMES: [&str; COMPONENTS] = ["x", "y", "z", "moment-x", "moment-y", "moment-z"];

/// A load of constant magnitude.
pub(super) fn constant(load: &Load) -> Option<(LoadKind, f64)> {
    match load.magnitude {
        Magnitude::Constant(magnitude) => Some((load.kind, magnitude)),
        _ => None,
    }
}

fn lifted<T: Scalar>(values: &[f64]) -> Vec<T> {
    values.iter().map(|v| T::from_f64(*v)).collect()
}

fn plain<T: Scalar>(v: Vec3<T>) -> Vec3 {
    vec3(v.x.value(), v.y.value(), v.z.value())
}

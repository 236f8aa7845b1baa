//! What a model in space says of itself, evaluated in any kind of number, for the checks of states.

use super::reference_poses::SpaceSubject;
use dwell_geometry::space::{
    BodyMotion, Coordinate, Frame, Joint, JointKind, Placement, Pose, Rotation, Vec3, Wrench, vec3,
};
use dwell_geometry::{JointId, PositionError};
use dwell_kinetostatics::space::{Axes, Component, Load, LoadKind, Model, Reaction};
use dwell_kinetostatics::{
    Friction, FrictionContact, KinematicState, KinetostaticsError, MachineModel as _, Magnitude,
    Strength,
};
use dwell_numerics::Scalar;
use dwell_scene::SpaceScene;
use dwell_study::{StudyError, model_with_loads};
use dwell_verify::SubjectError;
use dwell_verify::space::{SpaceCase, SpaceState, sliding_in_space, with_friction_in_space};
use std::marker::PhantomData;

/// Components of a joint's reaction in one kind of axes.
const COMPONENTS: usize = 6;

/// A scene with its loaded model, which has all reactions in the axes of the ground and in those of their joints.
#[derive(Debug)]
pub struct SpaceClaims<'a> {
    scene: &'a SpaceScene,
    model: Model,
    start: Vec<Placement>,
}

impl<'a> SpaceClaims<'a> {
    /// The claims of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be assembled, or a load does not fit it.
    pub fn new(scene: &'a SpaceScene) -> Result<Self, StudyError> {
        let all = all_reactions(scene, &[Axes::Ground, Axes::Joint]);
        let model = model_with_loads(scene, &all)?;
        let mut pose = model.plan().pose::<f64>();
        // The mechanism was assembled there.
        let at_start = model.plan().positions(&scene.assembly.q, &mut pose);
        let mut claims = Self {
            scene,
            model,
            start: Vec::new(),
        };
        if at_start.is_ok() {
            claims.start = claims.all_placements(&pose);
        }
        Ok(claims)
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The mechanism for the checks.
    pub fn case(&self) -> SpaceCase<'_> {
        SpaceCase {
            mechanism: &self.scene.mechanism,
            masses: &self.scene.masses,
            size: self.model.plan().size(),
            idle: &self.model.plan().mobility().idle,
            start: (&self.scene.assembly.q, &self.start),
        }
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
        let all = self.model.determined(q, &mut self.model.workspace())?;
        let of_ground = all.chunks(2 * COMPONENTS).flat_map(|of| &of[..COMPONENTS]);
        Ok(of_ground.copied().collect())
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

    /// The reactions of one kind of axes as wrenches in those of the ground.
    fn wrenches<T: Scalar>(
        &self,
        reactions: &[T],
        placements: &[Placement],
        of: Axes,
    ) -> Vec<Wrench> {
        let first = match of {
            Axes::Ground => 0,
            Axes::Joint => COMPONENTS,
        };
        let of_joint = |(joint, all): (&Joint, &[T])| {
            let side = &joint.sides[0];
            let turned = |v: Vec3| placements[joint.side_body(0).0].rotation.apply(v);
            let axes = match of {
                Axes::Ground => Vec3::AXES,
                Axes::Joint => [side.normal, side.axis.cross(side.normal), side.axis].map(turned),
            };
            let vector = |k: usize| {
                let parts = axes.iter().zip(&all[first + k..][..3]);
                parts.fold(Vec3::ZERO, |sum, (axis, part)| {
                    sum + axis.scaled(part.value())
                })
            };
            Wrench {
                force: vector(0),
                moment: vector(3),
            }
        };
        let joints = self.scene.mechanism.joints.iter();
        joints
            .zip(reactions.chunks(2 * COMPONENTS))
            .map(of_joint)
            .collect()
    }

    /// Placements and motions of all bodies.
    fn motion<T: Scalar>(&self, rates: [&[f64]; 3]) -> Result<SpaceState, PositionError> {
        let plan = self.model.plan();
        let mut pose = plan.pose::<T>();
        let [q, q_dot, q_ddot] = rates.map(lifted);
        plan.positions(&q, &mut pose)?;
        plan.velocities(&q_dot, &mut pose);
        plan.accelerations(&q_ddot, &mut pose);
        let motion = |b: usize| {
            let motion = plan.body_motion(&pose, b);
            BodyMotion {
                velocity: plain(motion.velocity),
                angular_velocity: plain(motion.angular_velocity),
                acceleration: plain(motion.acceleration),
                angular_acceleration: plain(motion.angular_acceleration),
            }
        };
        let [q, q_dot, q_ddot] = rates.map(<[f64]>::to_vec);
        Ok(SpaceState {
            q,
            q_dot,
            q_ddot,
            placements: self.all_placements(&pose),
            motions: (0..self.scene.mechanism.bodies.len()).map(motion).collect(),
            ..SpaceState::default()
        })
    }

    /// The motions of all bodies at coordinates, speeds and accelerations.
    ///
    /// # Errors
    /// [`PositionError`] where there is no pose.
    pub fn motions(&self, rates: [&[f64]; 3]) -> Result<Vec<BodyMotion>, PositionError> {
        Ok(self.motion::<f64>(rates)?.motions)
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
    fn unit_parts(
        &self,
        q: &[f64],
        load: usize,
    ) -> Result<Vec<(LoadKind, f64)>, Box<dyn std::error::Error>> {
        let Some((friction, radius)) = self.surface_friction(&self.model.loads()[load]) else {
            return Ok(self.unit_loads().get(load).copied().into_iter().collect());
        };
        let placements = self.motion::<f64>([q, &[0.0], &[0.0]])?.placements;
        let [along, turn] = sliding_in_space(&self.case(), &placements, &[1.0], &friction)?;
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
    ) -> Result<Vec<(LoadKind, f64)>, Box<dyn std::error::Error>> {
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
        let placements = self.motion::<f64>([q, q_dot, q_ddot])?.placements;
        let given = (&loads[..], &frictions[..]);
        let rates = [q_dot, q_ddot];
        Ok(with_friction_in_space(
            &self.case(),
            &placements,
            rates,
            given,
        )?)
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
    ) -> Result<SpaceState, SubjectError> {
        let [q, q_dot, _] = rates;
        let explain = |e: &dyn std::fmt::Display| refused(q, e);
        let mut claimed = self.motion::<T>(rates).map_err(|e| explain(&e))?;
        let magnitudes = self.magnitudes(t, [q, q_dot]).map_err(|e| explain(&e))?;
        claimed.loads = (self.loads(rates, &magnitudes)).map_err(|e| explain(&e))?;
        let (mut workspace, mut result) = (self.model.workspace(), self.model.result_buffer());
        let of_numbers = rates.map(lifted::<T>);
        let at = of_numbers.each_ref().map(Vec::as_slice);
        let state = self.model.kinetostatics(t, at, &mut workspace, &mut result);
        let state = state.map_err(|e| explain(&e))?;
        let powers = (0..magnitudes.len()).map(|load| state.load_power(load).value());
        claimed.load_power = powers.sum();
        let found = state.inverse_dynamics();
        claimed.tau = found.tau.iter().map(|v| v.value()).collect();
        claimed.reactions = self.wrenches(&found.reactions, &claimed.placements, axes);
        claimed.inertias = self.mass_matrix(&mut state.into_kinematic_state(), q.len());
        Ok(claimed)
    }

    /// Of one actuator: the two unit passes of the reduced model as states, that of unit speed first.
    ///
    /// # Errors
    /// [`SubjectError`] where they cannot be evaluated.
    pub fn unit_passes<T: Scalar>(
        &self,
        q: f64,
        axes: Axes,
    ) -> Result<[SpaceState; 2], SubjectError> {
        let explain = |e: &dyn std::fmt::Display| refused(&[q], e);
        let mut moving = self
            .motion::<T>([&[q], &[1.0], &[0.0]])
            .map_err(|e| explain(&e))?;
        let mut workspace = self.model.workspace();
        let mut found = self.model.coefficient_buffer::<T>();
        let done = self
            .model
            .reduce(T::from_f64(q), &mut workspace, &mut found);
        done.map_err(|e| explain(&e))?;
        moving.inertias = vec![found.m.value()];
        let mut from_rest = moving.clone();
        (from_rest.q_dot, from_rest.q_ddot) = (vec![0.0], vec![1.0]);
        for motion in &mut from_rest.motions {
            *motion = BodyMotion {
                acceleration: motion.velocity,
                angular_acceleration: motion.angular_velocity,
                ..Default::default()
            };
        }
        moving.tau = vec![found.half_dm.value()];
        from_rest.tau = vec![found.m.value()];
        moving.reactions = self.wrenches(&found.b, &moving.placements, axes);
        from_rest.reactions = self.wrenches(&found.a, &moving.placements, axes);
        Ok([moving, from_rest])
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
    ) -> Result<SpaceState, SubjectError> {
        let explain = |e: &dyn std::fmt::Display| refused(q, e);
        let zero = vec![0.0; q.len()];
        let mut claimed = self
            .motion::<T>([q, &zero, &zero])
            .map_err(|e| explain(&e))?;
        let (mut workspace, mut found) = (self.model.workspace(), self.model.result_buffer::<T>());
        let rates = [lifted::<T>(q), lifted(&zero)];
        let state = self
            .model
            .kinematic_state(&rates[0], &rates[1], &mut workspace);
        let mut state = state.map_err(|e| explain(&e))?;
        let done = state.unit_load_response(load, &mut found);
        done.map_err(|e| explain(&e))?;
        claimed.tau = found.tau.iter().map(|v| v.value()).collect();
        claimed.reactions = self.wrenches(&found.reactions, &claimed.placements, axes);
        claimed.loads = self.unit_parts(q, load).map_err(|e| explain(&e))?;
        claimed.inertias = self.inertias::<T>(q)?;
        Ok(claimed)
    }

    /// Where the bodies are at coordinates.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    pub fn placements<T: Scalar>(&self, q: &[f64]) -> Result<Vec<Placement>, SubjectError> {
        let mut pose = self.model.plan().pose::<T>();
        let done = self.model.plan().positions(&lifted(q), &mut pose);
        done.map_err(|e| refused(q, &e))?;
        Ok(self.all_placements(&pose))
    }

    /// The generalised inertias at coordinates, row by row.
    ///
    /// # Errors
    /// [`SubjectError`] where there is no pose.
    pub fn inertias<T: Scalar>(&self, q: &[f64]) -> Result<Vec<f64>, SubjectError> {
        let (mut workspace, n) = (self.model.workspace(), q.len());
        let [q_of, rest] = [lifted::<T>(q), vec![T::default(); n]];
        let state = self.model.kinematic_state(&q_of, &rest, &mut workspace);
        let mut state = state.map_err(|e| refused(q, &e))?;
        Ok(self.mass_matrix(&mut state, n))
    }

    /// The generalised inertias of a state, row by row.
    fn mass_matrix<T: Scalar>(
        &self,
        state: &mut KinematicState<'_, T, Model>,
        n: usize,
    ) -> Vec<f64> {
        let mut unit = self.model.result_buffer::<T>();
        let mut inertias = vec![0.0; n * n];
        for j in 0..n {
            state.mass_matrix_column(j, &mut unit);
            for (i, tau) in unit.tau.iter().enumerate() {
                inertias[i * n + j] = tau.value();
            }
        }
        inertias
    }

    /// What is asked beside the states, in a kind of number.
    pub fn in_numbers<T: Scalar>(&self) -> ClaimsIn<'_, T> {
        ClaimsIn {
            claims: self,
            numbers: PhantomData,
        }
    }
}

/// Claims in a kind of number.
#[derive(Debug)]
pub struct ClaimsIn<'a, T> {
    claims: &'a SpaceClaims<'a>,
    numbers: PhantomData<T>,
}

impl<T: Scalar> SpaceSubject for ClaimsIn<'_, T> {
    fn placements(&self, q: &[f64]) -> Result<Vec<Placement>, SubjectError> {
        self.claims.placements::<T>(q)
    }

    fn inertias(&self, q: &[f64]) -> Result<Vec<f64>, SubjectError> {
        self.claims.inertias::<T>(q)
    }
}

/// All components of the reactions of all joints, joint by joint, in some kinds of axes.
pub(super) fn all_reactions(scene: &SpaceScene, axes: &[Axes]) -> Vec<Reaction> {
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

pub(super) fn components(wrench: &Wrench) -> [f64; COMPONENTS] {
    let (f, m) = (wrench.force, wrench.moment);
    [f.x, f.y, f.z, m.x, m.y, m.z]
}

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

fn refused(q: &[f64], why: &dyn std::fmt::Display) -> SubjectError {
    SubjectError {
        q: q.first().copied().unwrap_or(0.0),
        message: why.to_string(),
    }
}

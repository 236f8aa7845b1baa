//! A machine in a few lines, with its motion by the multibody equations and by the reduced ones.

use dwell_dynamics::{
    CoordinateMode, Machine, MachineOde, Method, OdeState, Options, StepControl, integrate,
};
use dwell_geometry::{
    Actuator, ActuatorId, ActuatorKind, AssemblyConfiguration, Body, BodyId, Coordinate, Joint,
    JointId, JointKind, Mechanism, Vec2, vec2,
};
use dwell_kinetostatics::{Drive as Driving, DriveKind, Load, LoadKind, Magnitude, Mass, Model};
use dwell_laws::Law;
use dwell_verify::{MotionSample, MultibodySystem};

pub(crate) const GROUND: BodyId = BodyId(0);
pub(crate) const DOWN: LoadKind = LoadKind::Gravity {
    direction: vec2(0.0, -1.0),
};

pub(crate) type On = (BodyId, [f64; 2]);

/// A mechanism with all that makes it move.
#[derive(Clone, Default)]
pub(crate) struct Plant {
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) initial_guess: Vec<Option<f64>>,
    /// The branch hint of each joint; empty without hints.
    pub(crate) branch_hints: Vec<Option<f64>>,
    pub(crate) loads: Vec<Load>,
    modes: Vec<CoordinateMode>,
    pub(crate) drives: Vec<Driving>,
    q: Vec<f64>,
    q_dot: Vec<f64>,
}

impl Plant {
    pub(crate) fn new() -> Self {
        let mut plant = Self::default();
        plant.body("ground", 0.0, [0.0; 2], 0.0, None);
        plant
    }

    /// A body by its mass, its centre, its inertia, and its rough angle.
    pub(crate) fn body(
        &mut self,
        name: &str,
        mass: f64,
        [x, y]: [f64; 2],
        inertia: f64,
        initial_guess: Option<f64>,
    ) -> BodyId {
        self.mechanism.bodies.push(Body::named(name));
        self.masses.push(Mass {
            mass,
            center: vec2(x, y),
            inertia,
        });
        self.initial_guess.push(initial_guess);
        BodyId(self.masses.len() - 1)
    }

    /// A uniform bar along the x axis of its frame.
    pub(crate) fn bar(
        &mut self,
        name: &str,
        mass: f64,
        length: f64,
        initial_guess: Option<f64>,
    ) -> BodyId {
        let inertia = mass * length * length / 12.0;
        self.body(name, mass, [0.5 * length, 0.0], inertia, initial_guess)
    }

    pub(crate) fn joint(&mut self, name: &str, one: On, two: On, kind: JointKind) -> JointId {
        let points = [one.1, two.1].map(|[x, y]| vec2(x, y));
        let joint = Joint::new(name, [one.0, two.0], points, kind);
        self.mechanism.joints.push(joint);
        JointId(self.mechanism.joints.len() - 1)
    }

    pub(crate) fn pin(&mut self, name: &str, one: On, two: On) -> JointId {
        self.joint(name, one, two, JointKind::Revolute)
    }

    fn actuator(
        &mut self,
        bodies: [BodyId; 2],
        kind: ActuatorKind,
        mode: CoordinateMode,
    ) -> ActuatorId {
        let id = ActuatorId(self.modes.len());
        let name = format!("q{}", id.0);
        self.mechanism
            .actuators
            .push(Actuator { name, bodies, kind });
        self.modes.push(mode);
        id
    }

    /// A free coordinate with its initial value and velocity.
    pub(crate) fn free(
        &mut self,
        bodies: [BodyId; 2],
        kind: ActuatorKind,
        [q, q_dot]: [f64; 2],
    ) -> ActuatorId {
        self.q.push(q);
        self.q_dot.push(q_dot);
        self.actuator(bodies, kind, CoordinateMode::Free)
    }

    /// An angle that is led by a law of time.
    pub(crate) fn prescribed(&mut self, bodies: [BodyId; 2], law: Law) {
        self.prescribed_along(bodies, ActuatorKind::Angle, law);
    }

    /// Any coordinate that is led.
    pub(crate) fn prescribed_along(&mut self, bodies: [BodyId; 2], kind: ActuatorKind, law: Law) {
        let [q, q_dot, _, _] = law.eval(0.0);
        self.q.push(q);
        self.q_dot.push(q_dot);
        self.actuator(bodies, kind, CoordinateMode::Prescribed(law));
    }

    pub(crate) fn load(&mut self, name: &str, kind: LoadKind, magnitude: Magnitude) {
        self.loads.push(Load {
            name: name.into(),
            kind,
            magnitude,
        });
    }

    pub(crate) fn constant(&mut self, name: &str, kind: LoadKind, magnitude: f64) {
        self.load(name, kind, Magnitude::Constant(magnitude));
    }

    pub(crate) fn drive(&mut self, actuator: ActuatorId, kind: DriveKind) {
        let coordinate = self.mechanism.actuators[actuator.0].coordinate();
        self.drive_along(coordinate, kind);
    }

    pub(crate) fn drive_along(&mut self, coordinate: Coordinate, kind: DriveKind) {
        let name = format!("drive {}", self.drives.len());
        self.drives.push(Driving {
            name,
            coordinate,
            kind,
        });
    }

    pub(crate) fn multibody(&self) -> MultibodySystem {
        MultibodySystem::new(
            &self.mechanism,
            &self.masses,
            &self.loads,
            &self.modes,
            &self.drives,
        )
        .unwrap()
    }

    /// Follows the multibody equations from given poses and velocities at t = 0.
    pub(crate) fn integrate(
        &self,
        bodies: Vec<[f64; 3]>,
        velocity: Vec<[f64; 3]>,
        times: &[f64],
    ) -> Vec<MotionSample> {
        let start = MotionSample {
            poses: bodies,
            velocities: velocity,
            ..MotionSample::default()
        };
        self.multibody().integrate(&start, times).unwrap()
    }

    /// The motion by the reduced equations, to the last digits that they give.
    pub(crate) fn model_motion(&self, until: f64, count: usize) -> Vec<MotionSample> {
        let start = AssemblyConfiguration {
            q: self.q.clone(),
            initial_guess: self.initial_guess.clone(),
            branch_hints: self.branch_hints.clone(),
        };
        let reactions = self.mechanism.reactions();
        let model = Model::new(&self.mechanism, &self.masses, &start, &reactions).unwrap();
        let model = model.with_loads(self.loads.clone()).unwrap();
        let modes = self.modes.clone();
        let machine = Machine::new(model, &self.loads, modes, &self.drives).unwrap();
        let mut at = OdeState {
            t: 0.0,
            y: machine.initial_state(&self.q, &self.q_dot),
        };
        let mut ode = MachineOde::new(&machine, 0.0, &at.y).unwrap();
        let mut samples = vec![self.model_sample(&machine, &at)];
        let options = Options::new(Method::Tsit45, 1e-13);
        for k in 1..=count {
            let to = until * k as f64 / count as f64;
            let mut observer = |_: &OdeState, _: &OdeState, _: dwell_dynamics::DenseOutput<'_>| {
                Ok(StepControl::Continue)
            };
            let result = integrate(&mut ode, &at, Some(to), &options, &mut observer).unwrap();
            assert_eq!(result.error, None);
            at = result.state;
            assert!(
                (at.t - to).abs() <= 4.0 * f64::EPSILON * to,
                "{} {to}",
                at.t
            );
            at.t = to;
            samples.push(self.model_sample(&machine, &at));
        }
        samples
    }

    fn model_sample(&self, machine: &Machine, at: &OdeState) -> MotionSample {
        let mut workspace = machine.workspace();
        let state = machine.evaluate(at.t, &at.y, &mut workspace).unwrap();
        let [kinetic, potential] = state.energy();
        let model = machine.model();
        let (mut model_workspace, mut result) = (model.workspace(), model.result_buffer());
        let outputs = state.outputs(model, &mut model_workspace, &mut result);
        let outputs = outputs.unwrap();
        let mut inverse_dynamics = outputs.inverse_dynamics().clone();
        // Nothing is left for an actuator that is free.
        let largest = inverse_dynamics
            .reactions
            .iter()
            .fold(1.0_f64, |m, r| m.max(r.abs()));
        for &free in machine.free() {
            assert!(
                inverse_dynamics.tau[free].abs() < 1e-10 * largest,
                "{}",
                inverse_dynamics.tau[free]
            );
            inverse_dynamics.tau[free] = 0.0;
        }
        let states = outputs.bodies();
        // There are more states: of what the lowering adds.
        let bodies = (0..self.masses.len()).map(BodyId);
        let pose = |body: BodyId| {
            let position = states.point(body, Vec2::ZERO).position;
            let state = states.body(body);
            let angle = state.angle.unwrap_or_else(|| state.rotation.angle());
            [position.x, position.y, angle]
        };
        let body_velocity = |body: BodyId| {
            let velocity = states.point(body, Vec2::ZERO).velocity;
            [velocity.x, velocity.y, states.body(body).angular_velocity]
        };
        MotionSample {
            t: at.t,
            poses: bodies.clone().map(pose).collect(),
            velocities: bodies.map(body_velocity).collect(),
            reactions: inverse_dynamics.reactions,
            tau: inverse_dynamics.tau,
            drive_forces: state.drive_forces().to_vec(),
            kinetic,
            potential,
            work: at.y[machine.work_offset()..].iter().sum(),
        }
    }
}

/// Where both agree to this part of the scale.
#[track_caller]
pub(crate) fn close(found: f64, wanted: f64, scale: f64, tolerance: f64) {
    let difference = (found - wanted).abs() / scale;
    assert!(
        difference <= tolerance,
        "{found} is not {wanted}: {difference:.1e}"
    );
}

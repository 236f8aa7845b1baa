//! A machine in a few lines, what the multibody equations make of it, and what the reduced ones claim.

use dwell_dynamics::{
    Drive as Driving, DriveKind, Guidance, Machine, Method, Moving, Next, Options, Point, integrate,
};
use dwell_geometry::{
    Actuator, ActuatorId, Body, BodyId, Coordinate, Drive, Joint, JointId, JointKind, Mechanism,
    Start, Vec2, vec2,
};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass, Model};
use dwell_laws::Law;
use dwell_verify::{MotionSample, Unreduced};

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
    pub(crate) rough: Vec<Option<f64>>,
    /// What is known roughly of each joint; empty where nothing is.
    pub(crate) told: Vec<Option<f64>>,
    pub(crate) loads: Vec<Load>,
    guidance: Vec<Guidance>,
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
        rough: Option<f64>,
    ) -> BodyId {
        self.mechanism.bodies.push(Body { name: name.into() });
        self.masses.push(Mass {
            mass,
            center: vec2(x, y),
            inertia,
        });
        self.rough.push(rough);
        BodyId(self.masses.len() - 1)
    }

    /// A uniform bar along the x axis of its frame.
    pub(crate) fn bar(&mut self, name: &str, mass: f64, length: f64, rough: Option<f64>) -> BodyId {
        let inertia = mass * length * length / 12.0;
        self.body(name, mass, [0.5 * length, 0.0], inertia, rough)
    }

    pub(crate) fn joint(&mut self, name: &str, one: On, two: On, kind: JointKind) -> JointId {
        self.mechanism.joints.push(Joint {
            name: name.into(),
            bodies: [one.0, two.0],
            points: [one.1, two.1].map(|[x, y]| vec2(x, y)),
            kind,
        });
        JointId(self.mechanism.joints.len() - 1)
    }

    pub(crate) fn pin(&mut self, name: &str, one: On, two: On) -> JointId {
        self.joint(name, one, two, JointKind::Revolute)
    }

    fn actuator(&mut self, bodies: [BodyId; 2], drive: Drive, guidance: Guidance) -> ActuatorId {
        let id = ActuatorId(self.guidance.len());
        let name = format!("q{}", id.0);
        self.mechanism.actuators.push(Actuator {
            name,
            bodies,
            drive,
        });
        self.guidance.push(guidance);
        id
    }

    /// A free coordinate, where it starts and how fast.
    pub(crate) fn free(
        &mut self,
        bodies: [BodyId; 2],
        drive: Drive,
        [q, q_dot]: [f64; 2],
    ) -> ActuatorId {
        self.q.push(q);
        self.q_dot.push(q_dot);
        self.actuator(bodies, drive, Guidance::Free)
    }

    /// An angle that is led by a law of time.
    pub(crate) fn led(&mut self, bodies: [BodyId; 2], law: Law) {
        self.led_along(bodies, Drive::Angle, law);
    }

    /// Any coordinate that is led.
    pub(crate) fn led_along(&mut self, bodies: [BodyId; 2], drive: Drive, law: Law) {
        let [q, q_dot, _, _] = law.at(0.0);
        self.q.push(q);
        self.q_dot.push(q_dot);
        self.actuator(bodies, drive, Guidance::Prescribed(law));
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

    pub(crate) fn truth(&self) -> Unreduced {
        Unreduced::new(
            &self.mechanism,
            &self.masses,
            &self.loads,
            &self.guidance,
            &self.drives,
        )
        .unwrap()
    }

    /// Follows the multibody equations from given poses and velocities at t = 0.
    pub(crate) fn run(
        &self,
        bodies: Vec<[f64; 3]>,
        velocity: Vec<[f64; 3]>,
        times: &[f64],
    ) -> Vec<MotionSample> {
        let start = MotionSample {
            bodies,
            velocity,
            ..MotionSample::default()
        };
        self.truth().run(&start, times).unwrap()
    }

    /// The motion by the reduced equations, to the last digits that they give.
    pub(crate) fn claims(&self, until: f64, count: usize) -> Vec<MotionSample> {
        let start = Start {
            q: self.q.clone(),
            rough: self.rough.clone(),
            joints: self.told.clone(),
        };
        let reactions = self.mechanism.reactions();
        let model = Model::new(&self.mechanism, &self.masses, &start, &reactions).unwrap();
        let model = model
            .with_loads(&self.mechanism, self.loads.clone())
            .unwrap();
        let guidance = self.guidance.clone();
        let machine =
            Machine::new(&self.mechanism, model, &self.loads, guidance, &self.drives).unwrap();
        let mut at = Point {
            t: 0.0,
            y: machine.start(&self.q, &self.q_dot),
        };
        let mut moving = Moving::new(&machine, 0.0, &at.y).unwrap();
        let mut claims = vec![self.claim(&machine, &at)];
        let options = Options::new(Method::Tsit45, 1e-13);
        for k in 1..=count {
            let to = until * k as f64 / count as f64;
            let mut watch = |_: &Point, _: &Point, _: dwell_dynamics::Dense<'_>| Ok(Next::GoOn);
            let ended = integrate(&mut moving, &at, Some(to), &options, &mut watch).unwrap();
            assert_eq!(ended.failed, None);
            at = ended.at;
            assert!(
                (at.t - to).abs() <= 4.0 * f64::EPSILON * to,
                "{} {to}",
                at.t
            );
            at.t = to;
            claims.push(self.claim(&machine, &at));
        }
        claims
    }

    fn claim(&self, machine: &Machine, at: &Point) -> MotionSample {
        let mut work = machine.work();
        machine.evaluate(at.t, &at.y, &mut work).unwrap();
        let [kinetic, potential] = machine.energy(&work);
        let model = machine.model();
        let (mut inner, mut actions) = (model.workspace(), model.actions());
        machine
            .show(model, at.t, &work, &mut inner, &mut actions)
            .unwrap();
        // Nothing is left for an actuator that is free.
        let most = actions
            .reactions
            .iter()
            .fold(1.0_f64, |m, r| m.max(r.abs()));
        for &free in machine.free() {
            assert!(
                actions.tau[free].abs() < 1e-10 * most,
                "{}",
                actions.tau[free]
            );
            actions.tau[free] = 0.0;
        }
        let states = inner.states();
        // There are more states: of what the lowering adds.
        let bodies = (0..self.masses.len()).map(BodyId);
        let pose = |body: BodyId| {
            let position = states.point(body, Vec2::ZERO).position;
            let state = states.body(body);
            let angle = state.angle.unwrap_or_else(|| state.turn.angle());
            [position.x, position.y, angle]
        };
        let speed = |body: BodyId| {
            let velocity = states.point(body, Vec2::ZERO).velocity;
            [velocity.x, velocity.y, states.body(body).spin]
        };
        MotionSample {
            t: at.t,
            bodies: bodies.clone().map(pose).collect(),
            velocity: bodies.map(speed).collect(),
            reactions: actions.reactions,
            tau: actions.tau,
            drives: work.action.clone(),
            kinetic,
            potential,
            work: at.y[machine.first_work()..].iter().sum(),
        }
    }
}

/// Where both agree to this part of the scale.
#[track_caller]
pub(crate) fn close(found: f64, wanted: f64, scale: f64, tolerance: f64) {
    let apart = (found - wanted).abs() / scale;
    assert!(apart <= tolerance, "{found} is not {wanted}: {apart:.1e}");
}

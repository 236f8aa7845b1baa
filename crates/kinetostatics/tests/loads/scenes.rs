//! Mechanisms under loads of every kind.

use crate::machines::{self, Machine};
use dwell_geometry::{BodyId, Coordinate, JointKind, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{
    Direction, EvaluatedState, InverseDynamics, Load, LoadKind, Magnitude, Mass, Model, Signal,
    Workspace,
};
use dwell_laws::{Expression, Law, Polynomial};
use dwell_scene::PlaneScene;
use std::path::Path;

const YOKE: &str = include_str!("yoke.toml");

/// Two degrees of freedom: a five-bar, its second actuator between two moving bodies.
const FIVE_BAR: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], E = [0.5, 0.02] }
    one = { points = { A = [0, 0], B = [0.2, 0] }, mass = 0.7, center = [0.1, 0.01], inertia = 3e-3 }
    two = { points = { B = [0, 0], C = [0.3, 0] }, mass = 0.9, center = [0.12, -0.02], inertia = 7e-3 }
    three = { points = { C = [0, 0], D = [0.45, 0] }, mass = 1.1, center = [0.2, 0.03], inertia = 9e-3 }
    four = { points = { D = [0, 0], E = [0.25, 0] } }
    [joints]
    A = { revolute = ["ground.A", "one.A"] }
    B = { revolute = ["two.B", "one.B"] }
    C = { revolute = ["two.C", "three.C"] }
    D = { revolute = ["three.D", "four.D"] }
    E = { revolute = ["ground.E", "four.E"] }
    [actuators]
    u = { angle = ["ground", "one"] }
    v = { angle = ["one", "two"] }
    [assembly]
    u = 2.0
    v = -1.3
    three = -0.5
    four = -1.6
"#;

/// An Oldham coupling: a prismatic joint that turns carries a body.
const OLDHAM: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], D = [0.04, 0.015] }
    input = { points = { A = [0, 0] }, mass = 0.8, center = [0.01, 0.02], inertia = 2e-3 }
    cross = { points = { M = [0.02, 0.01] }, mass = 0.6, center = [0.03, -0.01], inertia = 1e-3 }
    output = { points = { D = [0, 0] }, mass = 0.9, center = [-0.02, 0.01], inertia = 3e-3 }
    [joints]
    A = { revolute = ["ground.A", "input.A"] }
    D = { revolute = ["ground.D", "output.D"] }
    key = { prismatic = ["input.A", "cross.M"], axis = [1, 0] }
    slot = { prismatic = ["cross.M", "output.D"], axis = [0, 1] }
    [actuators]
    phi = { angle = ["ground", "input"] }
"#;

pub(crate) type Memory = (Workspace<f64>, InverseDynamics<f64>);

pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) mechanism: Mechanism,
    pub(crate) model: Model,
    pub(crate) masses: Vec<Mass>,
    /// How far states may lie from the start: 1 for an angle, less for a length.
    pub(crate) reach: f64,
    assembly_q: Vec<f64>,
}

impl Case {
    pub(crate) fn of(scene: &PlaneScene, loads: impl FnOnce(&Mechanism) -> Vec<Load>) -> Self {
        let assembly = scene.assembly.to_configuration();
        let machine = Machine {
            name: "",
            mechanism: scene.mechanism.clone(),
            masses: scene.masses.clone(),
            assembly,
        };
        Self {
            name: scene.name.clone(),
            ..Self::built(machine, loads)
        }
    }

    fn built(machine: Machine, loads: impl FnOnce(&Mechanism) -> Vec<Load>) -> Self {
        let Machine {
            name,
            mechanism,
            masses,
            assembly,
        } = machine;
        let model = Model::new(&mechanism, &masses, &assembly, &mechanism.reactions())
            .unwrap_or_else(|e| panic!("{name}: {e}"))
            .with_loads(loads(&mechanism))
            .expect("loads of the mechanism");
        Self {
            name: name.to_owned(),
            masses,
            // A length is driven over less than an angle.
            reach: if model.plan().is_angle(0) { 1.0 } else { 0.1 },
            assembly_q: assembly.q,
            mechanism,
            model,
        }
    }

    pub(crate) fn parse(text: &str, loads: impl FnOnce(&Mechanism) -> Vec<Load>) -> Self {
        Self::of(
            &PlaneScene::parse("test.toml", text).expect("a scene"),
            loads,
        )
    }

    pub(crate) fn body(&self, name: &str) -> BodyId {
        body(&self.mechanism, name)
    }

    pub(crate) fn memory(&self) -> Memory {
        (self.model.workspace(), self.model.result_buffer())
    }

    /// Evaluates at t, q, q̇, q̈.
    pub(crate) fn evaluate<'a>(
        &'a self,
        (workspace, result): &'a mut Memory,
        t: f64,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
    ) -> EvaluatedState<'a> {
        let state = self
            .model
            .kinetostatics(t, q, q_dot, q_ddot, workspace, result);
        state.expect("a pose")
    }

    /// The results at t, q, q̇, q̈.
    pub(crate) fn result(
        &self,
        t: f64,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
    ) -> InverseDynamics<f64> {
        let mut memory = self.memory();
        self.evaluate(&mut memory, t, q, q_dot, q_ddot);
        memory.1
    }

    /// The reaction of this name, such as `A.x`.
    pub(crate) fn reaction(&self, result: &InverseDynamics<f64>, name: &str) -> f64 {
        let mut all = self.model.reactions().iter().zip(&result.reactions);
        let found = all.find(|(r, _)| self.mechanism.reaction_name(**r) == name);
        *found.expect("a reaction of that name").1
    }

    /// Scattered states near the start: (t, q, q̇, q̈), the same in every run.
    pub(crate) fn states(&self) -> Vec<State> {
        let mut scatter = Scatter(0.37);
        let reach = self.reach;
        let n = self.assembly_q.len();
        (0..12)
            .map(|_| {
                let t = scatter.next(3.0);
                let q = self
                    .assembly_q
                    .iter()
                    .map(|q| q + scatter.next(0.3 * reach))
                    .collect();
                let mut rates = |by| (0..n).map(|_| scatter.next(by * reach)).collect();
                (t, q, rates(6.0), rates(40.0))
            })
            .collect()
    }
}

/// A time, the coordinates, their speeds and accelerations.
type State = (f64, Vec<f64>, Vec<f64>, Vec<f64>);

/// Numbers scattered evenly between −1 and 1.
pub(crate) struct Scatter(pub(crate) f64);

impl Scatter {
    pub(crate) fn next(&mut self, by: f64) -> f64 {
        // The golden section spreads best.
        self.0 = (self.0 + 0.618_033_988_749_894_8) % 1.0;
        by * (2.0 * self.0 - 1.0)
    }
}

pub(crate) fn body(mechanism: &Mechanism, name: &str) -> BodyId {
    let found = mechanism.bodies.iter().position(|b| b.name == name);
    BodyId(found.expect("a body of that name"))
}

pub(crate) fn load(name: &str, kind: LoadKind, magnitude: f64) -> Load {
    Load {
        name: name.to_owned(),
        kind,
        magnitude: Magnitude::Constant(magnitude),
    }
}

/// A load whose magnitude is a polynomial of a signal.
pub(crate) fn varied(name: &str, kind: LoadKind, signal: Signal, coefficients: &[f64]) -> Load {
    Load {
        name: name.to_owned(),
        kind,
        magnitude: Magnitude::Law(
            signal,
            Law::Polynomial(Polynomial {
                coefficients: coefficients.to_vec(),
            }),
        ),
    }
}

pub(crate) fn case(name: &str) -> PlaneScene {
    let validation = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(validation.join(name).join("scene.toml")).expect("a scene")
}

/// A load whose magnitude is an expression of time and of an angle with its speed.
fn formula(name: &str, kind: LoadKind, angle: Coordinate, text: &str) -> Load {
    let signals = vec![Signal::Time, Signal::Value(angle), Signal::Velocity(angle)];
    let expression = Expression::parse(text, &["t", "angle", "speed"]).expect("an expression");
    Load {
        name: name.to_owned(),
        kind,
        magnitude: Magnitude::Expression(expression, signals),
    }
}

/// The validation mechanisms, a yoke, a coupling, a five-bar and a machine for each kind of joint and drive, all under loads of every kind.
pub(crate) fn all() -> Vec<Case> {
    let cases = [
        case("single-dwell"),
        case("crank-rocker"),
        case("slotted-rocker"),
        case("class-three-six-bar"),
        PlaneScene::parse("yoke.toml", YOKE).expect("a scene"),
        PlaneScene::parse("oldham.toml", OLDHAM).expect("a scene"),
        PlaneScene::parse("five-bar.toml", FIVE_BAR).expect("a scene"),
    ];
    let scenes = cases.iter().map(|scene| Case::of(scene, every_kind));
    let machines = machines::all().into_iter();
    scenes
        .chain(machines.map(|machine| Case::built(machine, every_kind)))
        .collect()
}

/// Loads of every kind on every body, the ground too, with magnitudes of every signal.
pub(crate) fn every_kind(mechanism: &Mechanism) -> Vec<Load> {
    let ground = BodyId(mechanism.ground);
    let moving: Vec<_> = (0..mechanism.bodies.len())
        .map(BodyId)
        .filter(|&b| b != ground)
        .collect();
    let mut loads = vec![
        load(
            "gravity",
            LoadKind::Gravity {
                direction: vec2(0.6, -0.8),
            },
            9.81,
        ),
        varied(
            "shaken",
            LoadKind::Gravity {
                direction: vec2(1.0, 0.0),
            },
            Signal::Time,
            &[0.3, -1.0, 0.7],
        ),
        load(
            "pressed ground",
            LoadKind::Force {
                body: ground,
                point: vec2(0.3, 0.2),
                direction: Direction::Ground(vec2(0.0, 1.0)),
            },
            40.0,
        ),
    ];
    let mut scatter = Scatter(0.11);
    for (i, &body) in moving.iter().enumerate() {
        let next = *moving.get(i + 1).unwrap_or(&ground);
        let mut point = || vec2(scatter.next(0.2), scatter.next(0.2));
        let between = [body, next];
        let points = [point(), point()];
        let length = Coordinate::Length {
            bodies: between,
            points,
        };
        let angle = Coordinate::Angle([ground, body]);
        let force = |body_fixed| LoadKind::Force {
            body,
            point: points[0],
            direction: if body_fixed {
                Direction::Body(Vec2::from_angle(0.7 + points[1].x))
            } else {
                Direction::Ground(Vec2::from_angle(0.7 + points[1].x))
            },
        };
        let spring = LoadKind::spring(between, points, 0.13);
        let torque = |first| LoadKind::couple([first, body]);
        loads.extend([
            varied("force", force(false), Signal::Time, &[3.0, -2.0]),
            varied("follower", force(true), Signal::Value(angle), &[5.0, 1.0]),
            varied(
                "torque",
                torque(ground),
                Signal::Velocity(angle),
                &[0.4, -0.2],
            ),
            formula(
                "fan",
                torque(ground),
                angle,
                "-0.1*speed*abs(speed)*(2 + sin(t + angle))",
            ),
            load("couple", torque(next), 0.7),
            load("spring", spring, 120.0),
            varied("stiffening", spring, Signal::Value(length), &[10.0, 4.0]),
            load(
                "torsion",
                LoadKind::torsion_spring([ground, body], 0.2),
                2.0,
            ),
            load("damper", LoadKind::damper([body, ground], points), 8.0),
            varied(
                "damper²",
                LoadKind::damper(between, points),
                Signal::Velocity(length),
                &[1.0, 0.0, 3.0],
            ),
            load("torsion damper", LoadKind::rotational_damper(between), 0.3),
            load("rotational drag", LoadKind::rotational_drag(between), 0.2),
            load(
                "drag",
                LoadKind::Drag {
                    body,
                    point: points[0],
                },
                0.6,
            ),
        ]);
    }
    for (j, joint) in mechanism.joints.iter().enumerate() {
        if matches!(joint.kind, JointKind::Prismatic { .. }) {
            let travel = Coordinate::Travel(dwell_geometry::JointId(j));
            let push = LoadKind::Force {
                body: joint.bodies[1],
                point: joint.points[1],
                direction: Direction::Body(vec2(0.0, 1.0)),
            };
            loads.push(varied("push", push, Signal::Value(travel), &[1.0, 20.0]));
            loads.push(varied(
                "resistance",
                push,
                Signal::Velocity(travel),
                &[0.0, -6.0],
            ));
        }
    }
    loads
}

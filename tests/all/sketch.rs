//! A few lines to a mechanism: bodies and joints named where they are made.

use crate::changes::Setup;
use dwell_geometry::{
    Actuator, Body, BodyId, Drive, Joint, JointId, JointKind, Mechanism, Relation, Start, Vec2,
    vec2,
};
use dwell_kinetostatics::Mass;

/// A mechanism in the making. Its first body is the ground.
#[derive(Debug, Clone)]
pub(crate) struct Sketch {
    pub(crate) mechanism: Mechanism,
    masses: Vec<Mass>,
    rough: Vec<Option<f64>>,
}

/// A point of a body.
pub(crate) type On = (BodyId, [f64; 2]);

impl Sketch {
    pub(crate) const GROUND: BodyId = BodyId(0);

    pub(crate) fn new() -> Self {
        let mut sketch = Self {
            mechanism: Mechanism::default(),
            masses: Vec::new(),
            rough: Vec::new(),
        };
        sketch.body("ground");
        sketch
    }

    /// A massless body of which nothing is known.
    pub(crate) fn body(&mut self, name: &str) -> BodyId {
        self.mass(name, Mass::default(), None)
    }

    /// A body with its mass and its rough angle.
    pub(crate) fn mass(&mut self, name: &str, mass: Mass, rough: Option<f64>) -> BodyId {
        self.mechanism.bodies.push(Body { name: name.into() });
        self.masses.push(mass);
        self.rough.push(rough);
        BodyId(self.masses.len() - 1)
    }

    pub(crate) fn revolute(&mut self, name: &str, first: On, second: On) -> JointId {
        self.joint(name, first, second, JointKind::Revolute)
    }

    /// A prismatic joint along an axis that both bodies measure alike.
    pub(crate) fn prismatic(&mut self, name: &str, first: On, second: On, axis: Vec2) -> JointId {
        let axes = [axis, axis];
        self.joint(name, first, second, JointKind::Prismatic { axes })
    }

    pub(crate) fn joint(&mut self, name: &str, first: On, second: On, kind: JointKind) -> JointId {
        self.mechanism.joints.push(Joint {
            name: name.into(),
            bodies: [first.0, second.0],
            points: [first.1, second.1].map(|[x, y]| vec2(x, y)),
            kind,
        });
        JointId(self.mechanism.joints.len() - 1)
    }

    /// An actuator that turns the second body from the first.
    pub(crate) fn drive(&mut self, name: &str, bodies: [BodyId; 2]) {
        let name = name.into();
        self.mechanism.actuators.push(Actuator {
            name,
            bodies,
            drive: Drive::Angle,
        });
    }

    /// An actuator that drives the travel of a joint between the two bodies.
    pub(crate) fn drive_travel(&mut self, name: &str, bodies: [BodyId; 2], joint: JointId) {
        self.mechanism.actuators.push(Actuator {
            name: name.into(),
            bodies,
            drive: Drive::Travel(joint),
        });
    }

    /// An actuator that drives the distance of two points.
    pub(crate) fn drive_length(&mut self, name: &str, bodies: [BodyId; 2], points: [Vec2; 2]) {
        self.mechanism.actuators.push(Actuator {
            name: name.into(),
            bodies,
            drive: Drive::Length(points),
        });
    }

    /// A relation, as a joint between the two bodies of its first coordinate.
    pub(crate) fn relate(&mut self, name: &str, bodies: [BodyId; 2], relation: Relation) {
        let kind = JointKind::Relation(self.mechanism.relations.len());
        self.mechanism.relations.push(relation);
        self.mechanism.joints.push(Joint {
            name: name.into(),
            bodies,
            points: [Vec2::ZERO; 2],
            kind,
        });
    }

    /// What it takes to make a model of it, with the actuators at `q`.
    pub(crate) fn setup(&self, q: &[f64]) -> Setup {
        let start = Start {
            q: q.to_vec(),
            rough: self.rough.clone(),
            ..Start::default()
        };
        Setup::new(self.mechanism.clone(), self.masses.clone(), start)
    }
}

/// A four-bar A B C D of massless links, with A at the origin and D at (base, 0); no actuator yet.
pub(crate) struct FourBar {
    pub(crate) sketch: Sketch,
    pub(crate) crank: BodyId,
    pub(crate) coupler: BodyId,
    pub(crate) rocker: BodyId,
    pub(crate) c: JointId,
}

impl FourBar {
    pub(crate) fn new([crank, coupler, rocker, base]: [f64; 4]) -> Self {
        let mut sketch = Sketch::new();
        let bodies = ["crank", "coupler", "rocker"].map(|name| sketch.body(name));
        let [one, two, three] = bodies;
        sketch.revolute("A", (Sketch::GROUND, [0.0, 0.0]), (one, [0.0, 0.0]));
        sketch.revolute("B", (one, [crank, 0.0]), (two, [0.0, 0.0]));
        let c = sketch.revolute("C", (two, [coupler, 0.0]), (three, [rocker, 0.0]));
        sketch.revolute("D", (Sketch::GROUND, [base, 0.0]), (three, [0.0, 0.0]));
        Self {
            sketch,
            crank: one,
            coupler: two,
            rocker: three,
            c,
        }
    }

    /// Driven at the crank.
    pub(crate) fn driven(lengths: [f64; 4]) -> Self {
        let mut bars = Self::new(lengths);
        bars.sketch.drive("phi", [Sketch::GROUND, bars.crank]);
        bars
    }

    /// Assembled at `q`, with the coupler's angle near `rough`.
    pub(crate) fn setup(&self, q: f64, rough: f64) -> Setup {
        let mut setup = self.sketch.setup(&[q]);
        setup.start.rough[self.coupler.0] = Some(rough);
        setup
    }
}

/// A crank of 0.5 m, a connecting rod and a slider on a guide at some height.
pub(crate) fn slider_crank(rod: f64, height: f64) -> (Sketch, BodyId) {
    let mut sketch = Sketch::new();
    let [crank, coupler, slider] = ["crank", "rod", "slider"].map(|name| sketch.body(name));
    sketch.revolute("A", (Sketch::GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    sketch.revolute("B", (crank, [0.5, 0.0]), (coupler, [0.0, 0.0]));
    sketch.revolute("C", (coupler, [rod, 0.0]), (slider, [0.0, 0.0]));
    let guide = (Sketch::GROUND, [0.0, height]);
    sketch.prismatic("guide", guide, (slider, [0.0, 0.0]), vec2(1.0, 0.0));
    sketch.drive("phi", [Sketch::GROUND, crank]);
    (sketch, coupler)
}

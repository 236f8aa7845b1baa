//! A few lines to a mechanism: bodies and joints named where they are made.

use crate::changes::Setup;
use dwell_geometry::{
    Actuator, ActuatorKind, AssemblyConfiguration, Body, BodyId, Coupling, Joint, JointId,
    JointKind, Mechanism, Vec2, vec2,
};
use dwell_kinetostatics::Mass;

/// A mechanism in the making. Its first body is the ground.
#[derive(Debug, Clone)]
pub struct Sketch {
    pub mechanism: Mechanism,
    masses: Vec<Mass>,
    rough: Vec<Option<f64>>,
}

/// A point of a body.
pub type BodyPoint = (BodyId, [f64; 2]);

impl Default for Sketch {
    fn default() -> Self {
        Self::new()
    }
}

impl Sketch {
    pub const GROUND: BodyId = BodyId(0);

    pub fn new() -> Self {
        let mut sketch = Self {
            mechanism: Mechanism::default(),
            masses: Vec::new(),
            rough: Vec::new(),
        };
        sketch.body("ground");
        sketch
    }

    /// A massless body of which nothing is known.
    pub fn body(&mut self, name: &str) -> BodyId {
        self.mass(name, Mass::default(), None)
    }

    /// A body with its mass and its rough angle.
    pub fn mass(&mut self, name: &str, mass: Mass, initial_guess: Option<f64>) -> BodyId {
        self.mechanism.bodies.push(Body::named(name));
        self.masses.push(mass);
        self.rough.push(initial_guess);
        BodyId(self.masses.len() - 1)
    }

    pub fn revolute(&mut self, name: &str, first: BodyPoint, second: BodyPoint) -> JointId {
        self.joint(name, first, second, JointKind::Revolute)
    }

    /// A prismatic joint along an axis that both bodies measure alike.
    pub fn prismatic(
        &mut self,
        name: &str,
        first: BodyPoint,
        second: BodyPoint,
        axis: Vec2,
    ) -> JointId {
        let axes = [axis, axis];
        self.joint(name, first, second, JointKind::Prismatic { axes })
    }

    pub fn joint(
        &mut self,
        name: &str,
        first: BodyPoint,
        second: BodyPoint,
        kind: JointKind,
    ) -> JointId {
        let points = [first.1, second.1].map(|[x, y]| vec2(x, y));
        let joint = Joint::new(name, [first.0, second.0], points, kind);
        self.mechanism.joints.push(joint);
        JointId(self.mechanism.joints.len() - 1)
    }

    /// An actuator that turns the second body from the first.
    pub fn actuate(&mut self, name: &str, bodies: [BodyId; 2]) {
        self.mechanism.actuators.push(Actuator::angle(name, bodies));
    }

    /// An actuator that drives the travel of a joint between the two bodies.
    pub fn actuate_travel(&mut self, name: &str, bodies: [BodyId; 2], joint: JointId) {
        let actuator = Actuator::new(name, bodies, ActuatorKind::Travel(joint));
        self.mechanism.actuators.push(actuator);
    }

    /// An actuator that drives the distance of two points.
    pub fn actuate_length(&mut self, name: &str, bodies: [BodyId; 2], points: [Vec2; 2]) {
        let actuator = Actuator::new(name, bodies, ActuatorKind::Length(points));
        self.mechanism.actuators.push(actuator);
    }

    /// A relation, as a joint between the two bodies of its first coordinate.
    pub fn couple(&mut self, name: &str, bodies: [BodyId; 2], relation: Coupling) {
        let kind = JointKind::Coupling(self.mechanism.couplings.len());
        self.mechanism.couplings.push(relation);
        let joint = Joint::new(name, bodies, [Vec2::ZERO; 2], kind);
        self.mechanism.joints.push(joint);
    }

    /// What it takes to make a model of it, with the actuators at `q`.
    pub fn setup(&self, q: &[f64]) -> Setup {
        let start = AssemblyConfiguration {
            q: q.to_vec(),
            initial_guess: self.rough.clone(),
            ..AssemblyConfiguration::default()
        };
        Setup::new(self.mechanism.clone(), self.masses.clone(), start)
    }
}

/// A four-bar A B C D of massless links, with A at the origin and D at (base, 0); no actuator yet.
pub struct FourBar {
    pub sketch: Sketch,
    pub crank: BodyId,
    pub coupler: BodyId,
    pub rocker: BodyId,
    pub c: JointId,
}

impl FourBar {
    pub fn new([crank, coupler, rocker, base]: [f64; 4]) -> Self {
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
    pub fn actuated(lengths: [f64; 4]) -> Self {
        let mut four_bar = Self::new(lengths);
        four_bar
            .sketch
            .actuate("phi", [Sketch::GROUND, four_bar.crank]);
        four_bar
    }

    /// Assembled at `q`, with the coupler's angle near `rough`.
    pub fn setup(&self, q: f64, initial_guess: f64) -> Setup {
        let mut setup = self.sketch.setup(&[q]);
        setup.assembly.initial_guess[self.coupler.0] = Some(initial_guess);
        setup
    }
}

/// A crank of 0.5 m, a connecting rod and a slider on a guide at some height.
pub fn slider_crank(rod: f64, height: f64) -> (Sketch, BodyId) {
    let mut sketch = Sketch::new();
    let [crank, coupler, slider] = ["crank", "rod", "slider"].map(|name| sketch.body(name));
    sketch.revolute("A", (Sketch::GROUND, [0.0, 0.0]), (crank, [0.0, 0.0]));
    sketch.revolute("B", (crank, [0.5, 0.0]), (coupler, [0.0, 0.0]));
    sketch.revolute("C", (coupler, [rod, 0.0]), (slider, [0.0, 0.0]));
    let guide = (Sketch::GROUND, [0.0, height]);
    sketch.prismatic("guide", guide, (slider, [0.0, 0.0]), vec2(1.0, 0.0));
    sketch.actuate("phi", [Sketch::GROUND, crank]);
    (sketch, coupler)
}

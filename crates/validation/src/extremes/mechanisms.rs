//! The mechanisms of the grid.

use dwell_geometry::{
    Actuator, ActuatorKind, AssemblyConfiguration, Body, Joint, JointId, JointKind, Mechanism,
    Reaction, Vec2, vec2,
};
use dwell_kinetostatics::{ExactModel, Mass, Model, ModelError};

/// Mass in kg, centre of mass in m, moment of inertia in kg m².
pub(crate) const fn mass(mass: f64, [x, y]: [f64; 2], inertia: f64) -> Mass {
    Mass {
        mass,
        center: vec2(x, y),
        inertia,
    }
}

/// A mechanism with its masses and its assembly.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct TestMechanism {
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) assembly: AssemblyConfiguration,
}

impl TestMechanism {
    /// Bodies with their masses, after the ground.
    fn new(bodies: &[(&str, Mass)]) -> Self {
        let all = [&[("ground", Mass::default())], bodies].concat();
        let mut test = Self::default();
        for (name, mass) in all {
            test.mechanism.bodies.push(Body::named(name));
            test.masses.push(mass);
            test.assembly.initial_guess.push(None);
        }
        test
    }

    fn revolute(&mut self, name: &str, bodies: [usize; 2], points: [Vec2; 2]) {
        let joint = Joint::revolute(name, bodies, points);
        self.mechanism.joints.push(joint);
    }

    fn prismatic(&mut self, name: &str, bodies: [usize; 2], points: [Vec2; 2]) {
        let joint = Joint::prismatic(name, bodies, points, [0.0; 2]);
        self.mechanism.joints.push(joint);
    }

    /// Adds its actuator, with the coordinate at assembly.
    fn actuate(&mut self, bodies: [usize; 2], kind: ActuatorKind, start: f64) {
        self.mechanism.actuators = vec![Actuator::new("q", bodies, kind)];
        self.assembly.q = vec![start];
    }

    /// Its model, with some reactions.
    pub(crate) fn model(&self, reactions: &[Reaction]) -> Result<Model, ModelError> {
        Model::new(&self.mechanism, &self.masses, &self.assembly, reactions)
    }

    /// Its reduced model.
    pub(crate) fn exact_model(&self, reactions: &[Reaction]) -> Result<ExactModel, String> {
        let model = self.model(reactions).map_err(|e| e.to_string())?;
        ExactModel::new(model).ok_or_else(|| "not one actuator".to_owned())
    }

    /// Both components of a joint's reaction.
    pub(crate) fn reactions(&self, joint: &str) -> Vec<Reaction> {
        let named = |j: &JointId| self.mechanism.joints[j.0].name == joint;
        let joint = (0..self.mechanism.joints.len()).map(JointId).find(named);
        let all = self.mechanism.reactions().into_iter();
        all.filter(|r| Some(r.joint) == joint).collect()
    }
}

/// A four-bar from A over B and C to D. Links lie along the x axis of their frames, from A, B and D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FourBar {
    /// A and D on the ground, m.
    pub(crate) base: [Vec2; 2],
    /// Crank, coupler and rocker, m.
    pub(crate) lengths: [f64; 3],
    /// Of the same.
    pub(crate) masses: [Mass; 3],
    /// Coordinate and approximate angle of the coupler at assembly, rad.
    pub(crate) assembly: [f64; 2],
}

impl FourBar {
    pub(crate) fn build(&self) -> TestMechanism {
        let [crank, coupler, rocker] = self.lengths.map(|l| vec2(l, 0.0));
        let [one, two, three] = self.masses;
        let mut test = TestMechanism::new(&[("crank", one), ("coupler", two), ("rocker", three)]);
        let [a, d] = self.base;
        test.revolute("A", [0, 1], [a, Vec2::ZERO]);
        test.revolute("B", [1, 2], [crank, Vec2::ZERO]);
        test.revolute("C", [2, 3], [coupler, rocker]);
        test.revolute("D", [0, 3], [d, Vec2::ZERO]);
        let [q, initial_guess] = self.assembly;
        test.actuate([0, 1], ActuatorKind::Angle, q);
        test.assembly.initial_guess[2] = Some(initial_guess);
        test
    }

    /// The same with all lengths scaled.
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.base = self.base.map(|p| p * factor);
        self.lengths = self.lengths.map(|l| l * factor);
        for mass in &mut self.masses {
            mass.center = mass.center * factor;
            mass.inertia *= factor * factor;
        }
        self
    }
}

/// A crank-rocker in no special proportion; its numbers are exact in binary.
pub(crate) const CRANK_ROCKER: FourBar = FourBar {
    base: [Vec2::ZERO, vec2(4.0, 0.0)],
    lengths: [1.0, 3.5, 2.5],
    masses: [
        mass(2.0, [0.25, 0.125], 0.5),
        mass(1.5, [1.75, 0.25], 1.25),
        mass(1.0, [1.25, -0.125], 0.75),
    ],
    assembly: [0.0, 0.7],
};

/// A crank A B, a rod B C and a slider on a line parallel to x; links lie along the x axis of their frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SliderCrank {
    /// Crank and rod, m.
    pub(crate) lengths: [f64; 2],
    /// Height of the line above A, m.
    pub(crate) height: f64,
    /// Of crank, rod and slider.
    pub(crate) masses: [Mass; 3],
    /// Coordinate and approximate angle of the rod at assembly.
    pub(crate) assembly: [f64; 2],
}

impl SliderCrank {
    /// Driven at the crank, or at the slider.
    pub(crate) fn build(&self, actuated_slider: bool) -> TestMechanism {
        let [crank, rod] = self.lengths.map(|l| vec2(l, 0.0));
        let [one, two, three] = self.masses;
        let mut test = TestMechanism::new(&[("crank", one), ("rod", two), ("slider", three)]);
        test.revolute("A", [0, 1], [Vec2::ZERO; 2]);
        test.revolute("B", [1, 2], [crank, Vec2::ZERO]);
        test.revolute("C", [2, 3], [rod, Vec2::ZERO]);
        test.prismatic("guide", [0, 3], [vec2(0.0, self.height), Vec2::ZERO]);
        let [q, initial_guess] = self.assembly;
        if actuated_slider {
            test.actuate([0, 3], ActuatorKind::Travel(JointId(3)), q);
            test.assembly.initial_guess[1] = Some(initial_guess);
        } else {
            test.actuate([0, 1], ActuatorKind::Angle, q);
            test.assembly.initial_guess[2] = Some(initial_guess);
        }
        test
    }
}

/// A crank of 1 m in a slot across a slide: the slide's travel is cos q.
pub(crate) fn scotch_yoke(crank: f64, slide: f64) -> TestMechanism {
    let (crank, slide) = (mass(0.0, [0.0; 2], crank), mass(slide, [0.0; 2], 0.0));
    let mut test = TestMechanism::new(&[("crank", crank), ("yoke", slide)]);
    test.revolute("A", [0, 1], [Vec2::ZERO; 2]);
    let slot = JointKind::Slot {
        axis: vec2(0.0, 1.0),
    };
    let slot = Joint::new("slot", [2, 1], [Vec2::ZERO, Vec2::IDENTITY], slot);
    test.mechanism.joints.push(slot);
    test.prismatic("guide", [0, 2], [Vec2::ZERO; 2]);
    test.actuate([0, 1], ActuatorKind::Angle, 0.5);
    test
}

/// A body that slides along x.
pub(crate) fn slider(kilograms: f64) -> TestMechanism {
    let mut test = TestMechanism::new(&[("slider", mass(kilograms, [0.0; 2], 0.0))]);
    test.prismatic("guide", [0, 1], [Vec2::ZERO; 2]);
    test.actuate([0, 1], ActuatorKind::Travel(JointId(0)), 0.0);
    test
}

/// A body that rotates about a fixed point.
pub(crate) fn rotor(mass: Mass) -> TestMechanism {
    let mut test = TestMechanism::new(&[("rotor", mass)]);
    test.revolute("A", [0, 1], [Vec2::ZERO; 2]);
    test.actuate([0, 1], ActuatorKind::Angle, 0.0);
    test
}

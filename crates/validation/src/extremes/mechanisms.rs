//! The mechanisms of the grid, as the texts of scenes.

use dwell_geometry::{Vec2, vec2};
#[cfg(test)]
use dwell_kinetostatics::ExactModel;
use dwell_kinetostatics::Mass;
use dwell_scene::PlaneScene;
#[cfg(test)]
use dwell_study::models::reduced_model;

/// Mass in kg, centre of mass in m, moment of inertia in kg m².
pub const fn mass(mass: f64, [x, y]: [f64; 2], inertia: f64) -> Mass {
    Mass {
        mass,
        center: vec2(x, y),
        inertia,
    }
}

/// A body with its points, such as `A = [0, 0]`.
pub fn body(name: &str, points: &str, of: &Mass) -> String {
    let (Vec2 { x, y }, mass, inertia) = (of.center, of.mass, of.inertia);
    format!(
        "{name} = {{ points = {{ {points} }}, mass = {mass}, center = [{x}, {y}], inertia = {inertia} }}\n"
    )
}

/// The scene of a text.
pub fn scene(text: &str) -> Result<PlaneScene, String> {
    PlaneScene::parse("scene.toml", text).map_err(|e| e.to_string())
}

/// The reduced model of a text, with the reaction of a joint if there is one of this name.
#[cfg(test)]
pub fn reduced(text: &str, joint: &str) -> Result<ExactModel, String> {
    let scene = scene(text)?;
    let mut reactions = scene.mechanism.reactions();
    reactions.retain(|r| scene.mechanism.joints[r.joint.0].name == joint);
    reduced_model(&scene, &reactions).map_err(|e| e.to_string())
}

/// A four-bar from A over B and C to D. Links lie along the x axis of their frames, from A, B and D.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FourBar {
    /// A and D on the ground, m.
    pub base: [Vec2; 2],
    /// Crank, coupler and rocker, m.
    pub lengths: [f64; 3],
    /// Masses of crank, coupler and rocker.
    pub masses: [Mass; 3],
    /// Coordinate and approximate angle of the coupler at assembly, rad.
    pub assembly: [f64; 2],
}

impl FourBar {
    /// Its scene, up to the assembly.
    pub fn text(&self) -> String {
        let [a, d] = self.base;
        let [crank, coupler, rocker] = self.lengths;
        let [one, two, three] = &self.masses;
        let [q, initial_guess] = self.assembly;
        format!(
            "[bodies]\nground = {{ points = {{ A = [{}, {}], D = [{}, {}] }} }}\n{}{}{}\
             [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"coupler.B\"] }}\n\
             C = {{ revolute = [\"coupler.C\", \"rocker.C\"] }}\nD = {{ revolute = [\"ground.D\", \"rocker.D\"] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n[assembly]\nphi = {q}\ncoupler = {initial_guess}\n",
            a.x,
            a.y,
            d.x,
            d.y,
            body("crank", &format!("A = [0, 0], B = [{crank}, 0]"), one),
            body("coupler", &format!("B = [0, 0], C = [{coupler}, 0]"), two),
            body("rocker", &format!("D = [0, 0], C = [{rocker}, 0]"), three)
        )
    }

    /// Scales all lengths.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.base = self.base.map(|p| p * factor);
        self.lengths = self.lengths.map(|l| l * factor);
        for mass in &mut self.masses {
            mass.center = mass.center * factor;
            mass.inertia *= factor * factor;
        }
        self
    }
}

/// A crank-rocker without special proportions; its numbers are exact in binary.
pub const CRANK_ROCKER: FourBar = FourBar {
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
pub struct SliderCrank {
    /// Crank and rod, m.
    pub lengths: [f64; 2],
    /// Height of the line above A, m.
    pub height: f64,
    /// Masses of crank, rod and slider.
    pub masses: [Mass; 3],
    /// Coordinate and approximate angle of the rod at assembly.
    pub assembly: [f64; 2],
}

impl SliderCrank {
    /// Its scene, driven at the crank, or at the slider: then the angle at assembly is that of the crank.
    pub fn text(&self, actuated_slider: bool) -> String {
        let [crank, rod] = self.lengths;
        let [one, two, three] = &self.masses;
        let [q, initial_guess] = self.assembly;
        let (actuator, guessed) = if actuated_slider {
            ("length = \"guide\"", "crank")
        } else {
            ("angle = [\"ground\", \"crank\"]", "rod")
        };
        format!(
            "[bodies]\nground = {{ points = {{ A = [0, 0], G = [0, {}] }} }}\n{}{}{}\
             [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nB = {{ revolute = [\"crank.B\", \"rod.B\"] }}\n\
             C = {{ revolute = [\"rod.C\", \"slider.C\"] }}\nguide = {{ prismatic = [\"ground.G\", \"slider.C\"], axis = [1, 0] }}\n\
             [actuators]\nq = {{ {actuator} }}\n[assembly]\nq = {q}\n{guessed} = {initial_guess}\n",
            self.height,
            body("crank", &format!("A = [0, 0], B = [{crank}, 0]"), one),
            body("rod", &format!("B = [0, 0], C = [{rod}, 0]"), two),
            body("slider", "C = [0, 0]", three)
        )
    }
}

/// A crank of 1 m in a slot across a slide: the slide's travel is cos q.
pub fn scotch_yoke(crank: f64, slide: f64) -> String {
    let crank = mass(0.0, [0.0; 2], crank);
    format!(
        "[bodies]\nground = {{ points = {{ A = [0, 0] }} }}\n{}{}\
         [joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\nslot = {{ slot = [\"yoke.A\", \"crank.B\"], axis = [0, 1] }}\n\
         guide = {{ prismatic = [\"ground.A\", \"yoke.A\"], axis = [1, 0] }}\n\
         [actuators]\nq = {{ angle = [\"ground\", \"crank\"] }}\n[assembly]\nq = 0.5\n",
        body("crank", "A = [0, 0], B = [1, 0]", &crank),
        body("yoke", "A = [0, 0]", &mass(slide, [0.0; 2], 0.0))
    )
}

/// A body that slides along x.
pub fn slider(kilograms: f64) -> String {
    let slider = body("slider", "A = [0, 0]", &mass(kilograms, [0.0; 2], 0.0));
    format!(
        "[bodies]\nground = {{ points = {{ A = [0, 0] }} }}\n{slider}\
         [joints]\nguide = {{ prismatic = [\"ground.A\", \"slider.A\"], axis = [1, 0] }}\n\
         [actuators]\nq = {{ length = \"guide\" }}\n[assembly]\nq = 0\n"
    )
}

/// A body that rotates about a fixed point.
pub fn rotor(mass: &Mass) -> String {
    let rotor = body("rotor", "A = [0, 0]", mass);
    format!(
        "[bodies]\nground = {{ points = {{ A = [0, 0] }} }}\n{rotor}\
         [joints]\nA = {{ revolute = [\"ground.A\", \"rotor.A\"] }}\n\
         [actuators]\nq = {{ angle = [\"ground\", \"rotor\"] }}\n[assembly]\nq = 0\n"
    )
}

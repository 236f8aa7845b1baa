//! The builder of mechanisms.

use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::mechanism::parts::{
    Actuator, Coordinate, Drive, Friction, Joint, Keys, Law, Load, LoadFunction, Motion, NO_VALUE,
};
use crate::mechanism::scene::Scene;
use crate::value::{Value, key, quoted};
use std::fmt::Write as _;

/// Collects the parts of a mechanism; [`assemble`](MechanismBuilder::assemble) assembles it. All numbers are in
/// SI: m, rad, kg, s, N. Parts have the keys of a scene file, and errors are those of the file that
/// [`to_toml`](MechanismBuilder::to_toml) returns.
///
/// ```
/// use dwell::{Actuator, Joint, Mechanism};
///
/// let mut m = Mechanism::builder("Pendulum");
/// m.ground().point("O", [0.0, 0.0]);
/// m.body("bob").point("O", [0.0, 0.0]).mass(2.0, [0.5, 0.0], 0.0);
/// m.joint("O", Joint::revolute("ground.O", "bob.O"));
/// m.actuator("phi", Actuator::angle("ground", "bob"));
/// let pendulum = m.assemble()?;
/// assert_eq!(pendulum.reactions(), ["O.x", "O.y"]);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MechanismBuilder {
    title: String,
    bodies: Vec<(String, BodyKeys)>,
    /// The other sections, in the order of the file, each with its entries.
    sections: Vec<(&'static str, Keys)>,
    /// Text of the scene format, after everything else.
    text: String,
    functions: Vec<(String, LoadFunction)>,
    /// The parts that were added twice: section and name.
    given_twice: Vec<(&'static str, String)>,
}

/// The keys of one body.
#[derive(Debug, Clone, Default)]
struct BodyKeys {
    points: Keys,
    keys: Keys,
}

impl MechanismBuilder {
    pub(crate) fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            bodies: Vec::new(),
            sections: Vec::new(),
            text: String::new(),
            functions: Vec::new(),
            given_twice: Vec::new(),
        }
    }

    /// The ground, for adding points.
    ///
    /// ```
    /// let mut m = dwell::Mechanism::builder("Four-bar");
    /// m.ground().point("A", [0.0, 0.0]).point("D", [0.4, 0.0]);
    /// ```
    pub fn ground(&mut self) -> BodyBuilder<'_> {
        self.body("ground")
    }

    /// A new or existing body, for adding points and a mass. The returned builder borrows the mechanism:
    /// end the statement before adding the next part. A misspelt name adds another body, which is in no joint;
    /// [`assemble`](MechanismBuilder::assemble) then suggests the intended name.
    ///
    /// ```
    /// let mut m = dwell::Mechanism::builder("Four-bar");
    /// m.body("crank").point("A", [0.0, 0.0]).point("B", [0.1, 0.0]);
    /// ```
    pub fn body(&mut self, name: &str) -> BodyBuilder<'_> {
        let known = self.bodies.iter().position(|(known, _)| known == name);
        let index = known.unwrap_or_else(|| {
            self.bodies.push((name.to_owned(), BodyKeys::default()));
            self.bodies.len() - 1
        });
        BodyBuilder(&mut self.bodies[index].1)
    }

    /// Adds a joint or coupling.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.joint("A", dwell::Joint::revolute("ground.A", "crank.A"));
    /// ```
    pub fn joint(&mut self, name: &str, joint: Joint) -> &mut Self {
        self.add("joints", name, joint.0)
    }

    /// Adds a pin in the plane between points with the name of the joint: `pin("A", "ground", "crank")` joins `ground.A` and
    /// `crank.A`.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.pin("A", "ground", "crank").pin("B", "crank", "coupler");
    /// ```
    pub fn pin(&mut self, name: &str, first: &str, second: &str) -> &mut Self {
        let [first, second] = [first, second].map(|body| format!("{body}.{name}"));
        self.joint(name, Joint::revolute(&first, &second))
    }

    /// Adds an actuator: an independent coordinate.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.actuator("phi", dwell::Actuator::angle("ground", "crank"));
    /// ```
    pub fn actuator(&mut self, name: &str, actuator: Actuator) -> &mut Self {
        self.add("actuators", name, actuator.0)
    }

    /// Adds a named coordinate.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.coordinate("rise", dwell::Coordinate::travel("guide"));
    /// ```
    pub fn coordinate(&mut self, name: &str, coordinate: Coordinate) -> &mut Self {
        self.add("coordinates", name, coordinate.0)
    }

    /// Sets the exact coordinate of an actuator at assembly, or the initial guess of a body's angle, rad, or of a
    /// joint's travel, m. Initial guesses select the assembly mode.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.assembly("phi", 0.5).assembly("rocker", 1.2);
    /// ```
    pub fn assembly(&mut self, name: &str, value: f64) -> &mut Self {
        self.add("assembly", name, value)
    }

    /// Sets the initial guess of the placement of a body in space: its origin, m, and its rotation vector, rad, both in the axes of the
    /// ground. Initial guesses select the assembly mode.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.placement("rod", [0.1, 0.0, 0.0], [0.0, -0.7, 0.0]);
    /// ```
    pub fn placement(&mut self, body: &str, at: [f64; 3], turn: [f64; 3]) -> &mut Self {
        self.add("assembly", body, Keys::new("at", at).with("turn", turn))
    }

    /// Adds a load.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.load("weight", dwell::Load::gravity([0.0, -9.81]));
    /// ```
    pub fn load(&mut self, name: &str, load: Load) -> &mut Self {
        if let Some(function) = load.function {
            self.functions.push((name.to_owned(), function));
        }
        self.add("loads", name, load.keys)
    }

    /// Adds friction to a joint.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.friction("guide", dwell::Friction::slide(0.1));
    /// ```
    pub fn friction(&mut self, joint: &str, friction: Friction) -> &mut Self {
        self.add("friction", joint, friction.0)
    }

    /// Adds a drive.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.drive("engine", dwell::Drive::applied_force("phi", 2.0));
    /// ```
    pub fn drive(&mut self, name: &str, drive: Drive) -> &mut Self {
        self.add("drives", name, drive.0)
    }

    /// Prescribes the motion of an actuator over a duration, s, for [`kinetostatics`](Mechanism::kinetostatics).
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.prescribed(2.0, "phi", dwell::Law::speed(10.0));
    /// ```
    pub fn prescribed(&mut self, duration: f64, actuator: &str, law: Law) -> &mut Self {
        self.add("prescribed", "duration", duration);
        self.add("prescribed", actuator, law.0)
    }

    /// Sets the free motion, for [`simulate`](Mechanism::simulate) and [`period`](Mechanism::period).
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.motion(dwell::Motion::seconds(5.0).initial_velocity("phi", 3.0));
    /// ```
    pub fn motion(&mut self, motion: Motion) -> &mut Self {
        self.sections.retain(|(section, _)| *section != "motion");
        self.sections.push(("motion", motion.into_keys()));
        self
    }

    /// Restricts the reactions to these joints or components: `A`, `guide.normal`. By default all are computed.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.request_reactions(&["A", "guide.normal"]);
    /// ```
    pub fn request_reactions(&mut self, reactions: &[&str]) -> &mut Self {
        self.add("requests", "reactions", reactions.to_vec())
    }

    /// Appends text of the scene format: sections that have no function here, as `docs/scene-format.md` describes them.
    /// [`scene`](MechanismBuilder::scene) reports errors in it.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("Pendulum");
    /// # m.ground().point("O", [0.0, 0.0]);
    /// # m.body("bob").bar("O", "P", 0.5).mass(2.0, "P", 0.0);
    /// # m.pin("O", "ground", "bob").actuator("phi", dwell::Actuator::angle("ground", "bob"));
    /// m.toml("[coordinate-sweep]\nphi = [0.0, 1.5]\npoints = 46\nspeed = 10.0");
    /// let sweep = m.assemble()?.kinetostatics()?;
    /// assert_eq!(sweep.column("phi")?.len(), 46);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn toml(&mut self, text: &str) -> &mut Self {
        self.text += "\n";
        self.text += text;
        self
    }

    /// The mechanism as the text of a scene file. A load that is a function of your program has a comment and no value there.
    ///
    /// ```
    /// let mut m = dwell::Mechanism::builder("Pendulum");
    /// m.ground().point("O", [0.0, 0.0]);
    /// assert!(m.to_toml().contains("[bodies.ground]\npoints = { O = [0.0, 0.0] }"));
    /// ```
    pub fn to_toml(&self) -> String {
        let mut text = format!("title = {}\n", quoted(&self.title));
        // Writing to a string cannot fail.
        for (name, body) in &self.bodies {
            let _ = writeln!(text, "\n[bodies.{}]", key(name));
            let _ = writeln!(text, "points = {}", Value::from(body.points.clone()));
            write_keys(&mut text, &body.keys);
        }
        for (section, entries) in &self.sections {
            let _ = writeln!(text, "\n[{section}]");
            for (load, _) in self.functions.iter().filter(|_| *section == "loads") {
                let note = "is a function of a program: write an expression or a table in place of";
                let _ = writeln!(text, "# The magnitude of `{load}` {note} {NO_VALUE}.");
            }
            write_keys(&mut text, entries);
        }
        text + &self.text
    }

    /// The scene of this mechanism.
    ///
    /// # Errors
    /// [`Error::Study`] with all errors.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("Pendulum");
    /// # m.ground().point("O", [0.0, 0.0]);
    /// # m.body("bob").point("O", [0.0, 0.0]).mass(2.0, [0.5, 0.0], 0.0);
    /// # m.joint("O", dwell::Joint::revolute("ground.O", "bob.O"));
    /// # m.actuator("phi", dwell::Actuator::angle("ground", "bob"));
    /// let scene = m.scene()?;
    /// assert_eq!(scene.value("bob.mass")?, 2.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn scene(&self) -> Result<Scene, Error> {
        if let Some((section, name)) = self.given_twice.first() {
            let (section, name) = (*section, name.clone());
            return Err(Error::GivenTwice { section, name });
        }
        let mut scene = Scene::parse(&self.to_toml())?;
        for (load, function) in &self.functions {
            scene = scene.with_load_function(load, function)?;
        }
        Ok(scene)
    }

    /// Assembles the mechanism.
    ///
    /// # Errors
    /// [`Error::Study`] with all errors, which name bodies and joints.
    ///
    /// ```
    /// let m = dwell::Mechanism::builder("Nothing");
    /// assert!(m.assemble().unwrap_err().to_string().contains("bodies"));
    /// ```
    pub fn assemble(&self) -> Result<Mechanism, Error> {
        self.scene()?.assemble()
    }

    fn add(&mut self, section: &'static str, name: &str, value: impl Into<Value>) -> &mut Self {
        let known = self
            .sections
            .iter()
            .position(|(known, _)| *known == section);
        let index = known.unwrap_or_else(|| {
            self.sections.push((section, Keys::default()));
            self.sections.len() - 1
        });
        let (_, entries) = &mut self.sections[index];
        let is_part = !matches!(section, "assembly" | "prescribed" | "requests");
        if is_part && entries.0.iter().any(|(known, _)| known == name) {
            self.given_twice.push((section, name.to_owned()));
        }
        *entries = std::mem::take(entries).with(name, value);
        self
    }
}

fn write_keys(text: &mut String, keys: &Keys) {
    for (name, value) in &keys.0 {
        let _ = writeln!(text, "{} = {value}", key(name));
    }
}

/// The builder of a body.
///
/// ```
/// let mut m = dwell::Mechanism::builder("Four-bar");
/// m.body("crank").point("A", [0.0, 0.0]).point("B", [0.1, 0.0]).mass(1.2, [0.05, 0.0], 1e-3);
/// ```
#[derive(Debug)]
pub struct BodyBuilder<'m>(&'m mut BodyKeys);

impl BodyBuilder<'_> {
    /// Adds a point in the body's frame, m: `[x, y]`, or `[x, y, z]` of a mechanism in space.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.body("crank").point("A", [0.0, 0.0]).point("B", [0.1, 0.0]);
    /// ```
    #[expect(
        clippy::return_self_not_must_use,
        reason = "the point is added to the mechanism in any case"
    )]
    pub fn point<const N: usize>(self, name: &str, position: [f64; N]) -> Self {
        self.0.points = std::mem::take(&mut self.0.points).with(name, position);
        self
    }

    /// Adds the two points of a bar in the plane: one at the origin, the other on the x axis at a length, m.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.body("crank").bar("A", "B", 0.1).mass(1.2, [0.05, 0.0], 1e-3);
    /// ```
    #[expect(
        clippy::return_self_not_must_use,
        reason = "the points are added to the mechanism in any case"
    )]
    pub fn bar(self, first: &str, second: &str, length: f64) -> Self {
        self.point(first, [0.0, 0.0]).point(second, [length, 0.0])
    }

    /// Sets the mass, kg, the centre of mass (m in the body's frame, or the name of a point), and the moment of inertia about
    /// it, kg·m²; in space `[xx, yy, zz]`, or all six elements of the tensor (`docs/scene-format.md`). A body without mass is
    /// a massless link.
    ///
    /// ```
    /// # let mut m = dwell::Mechanism::builder("");
    /// m.body("rod").point("B", [0.0, 0.0]).mass(0.8, [0.1, 0.0], 2e-3);
    /// ```
    #[expect(
        clippy::return_self_not_must_use,
        reason = "the mass is given to the mechanism in any case"
    )]
    pub fn mass(self, mass: f64, center: impl Into<Value>, inertia: impl Into<Value>) -> Self {
        let keys = std::mem::take(&mut self.0.keys).with("mass", mass);
        self.0.keys = keys.with("center", center).with("inertia", inertia);
        self
    }
}

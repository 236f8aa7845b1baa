//! An assembled mechanism, and its results at one position.

pub(crate) mod builder;
mod equations;
pub(crate) mod kinematics;
mod machines;
mod motions;
pub(crate) mod parts;
mod paths;
mod reduction;
pub(crate) mod scene;

use crate::assembled::{Assemble, Assembled, Names};
use crate::error::Error;
use crate::mechanism::builder::MechanismBuilder;
use crate::mechanism::kinematics::{InverseDynamics, Kinematics};
use crate::mechanism::scene::Scene;
use dwell_study::with_dimension;
use std::sync::Arc;

/// An assembled mechanism, in the plane or in space: constant, cheap to clone, and shared between threads.
///
/// It is [built](Mechanism::builder) or [read](Scene::read). Coordinates are those of its
/// [actuators](Mechanism::actuators), in their order, in rad or m; all units are SI.
///
/// ```
/// use dwell::{Actuator, Joint, Load, Mechanism};
///
/// // A uniform bar of 2 kg and 1 m hangs from its end.
/// let mut m = Mechanism::builder("Bar");
/// m.ground().point("O", [0.0, 0.0]);
/// m.body("bar").point("O", [0.0, 0.0]).point("P", [1.0, 0.0]).mass(2.0, [0.5, 0.0], 2.0 / 12.0);
/// m.joint("O", Joint::revolute("ground.O", "bar.O"));
/// m.actuator("phi", Actuator::angle("ground", "bar"));
/// m.load("weight", Load::gravity([0.0, -9.81]));
/// let bar = m.assemble()?;
///
/// // Held horizontally, the actuator carries half its weight times its length.
/// let held = bar.inverse_dynamics(0.0, &[0.0], &[0.0], &[0.0])?;
/// assert!((held.actuator_force("phi")? - 0.5 * 2.0 * 9.81).abs() < 1e-12);
/// assert!((held.reaction("O.y")? - 2.0 * 9.81).abs() < 1e-12);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Mechanism {
    pub(crate) scene: Scene,
    pub(crate) names: Arc<Names>,
    pub(crate) assembled: Arc<dyn Assembled>,
}

impl Mechanism {
    /// Starts to build a mechanism.
    ///
    /// ```
    /// let m = dwell::Mechanism::builder("Four-bar");
    /// ```
    pub fn builder(title: &str) -> MechanismBuilder {
        MechanismBuilder::new(title)
    }

    pub(crate) fn new(scene: Scene) -> Result<Self, Error> {
        let (names, assembled) = with_dimension(scene.inner(), Assemble)?;
        Ok(Self {
            names: Arc::new(names),
            assembled,
            scene,
        })
    }

    /// A picture of the mechanism at the coordinates `q`, rad or m, as an SVG document.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert!(slider.svg(&[0.5])?.starts_with("<svg"));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error`] if the mechanism cannot reach them.
    #[cfg(feature = "pictures")]
    pub fn svg(&self, q: &[f64]) -> Result<String, Error> {
        self.assembled.svg(q, self.names.limits)
    }

    /// The scene from which it was assembled.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.scene().title(), "Offset slider-crank");
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Names of the actuators: the coordinates, in their order.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.actuators(), ["phi"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn actuators(&self) -> Vec<&str> {
        self.names.actuators.iter().map(String::as_str).collect()
    }

    /// Names of the reactions: `joint.component`. In space they are those that the scene requests; without a list, all in the axes of the
    /// ground.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.reactions()[..2], ["A.x", "A.y"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reactions(&self) -> Vec<String> {
        let all = self.names.reactions.iter();
        all.map(|reaction| reaction.name.clone()).collect()
    }

    /// The reactions that equilibrium determines, also with redundant constraints.
    ///
    /// ```
    /// # let bricard = dwell::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
    /// assert!(bricard.determined_reactions().len() < bricard.reactions().len());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn determined_reactions(&self) -> Vec<String> {
        let all = self.names.reactions.iter();
        let determined = all.filter(|reaction| reaction.place.is_some());
        determined.map(|reaction| reaction.name.clone()).collect()
    }

    /// The bodies with their named points, in the order of the scene; the ground is among them.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.points()[1], ("crank", vec!["A", "B"]));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn points(&self) -> Vec<(&str, Vec<&str>)> {
        let bodies = self.names.bodies.iter();
        let named = bodies.map(|body| {
            let points = body.points.iter().map(|(point, _)| point.as_str());
            (body.name.as_str(), points.collect())
        });
        named.collect()
    }

    /// The number of coordinates of a point: 2 in the plane, 3 in space.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.dimension(), 2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn dimension(&self) -> usize {
        self.names.dimension
    }

    /// The coordinates of the actuators at assembly, rad or m.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.start(), [0.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn start(&self) -> Vec<f64> {
        self.names.start.clone()
    }

    /// The limits of the only coordinate, rad or m, if it has limits: limit positions of the mechanism.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.limits(), None); // the crank rotates fully
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn limits(&self) -> Option<(f64, f64)> {
        self.names.limits
    }

    /// The positions of all bodies at the coordinates `q`.
    ///
    /// # Errors
    /// [`Error::Count`]; [`Error::Study`] if the mechanism cannot reach them.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.positions(&[0.5])?;
    /// let [x, y] = at.position("piston.C")?;
    /// assert!((y - 0.025).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn positions(&self, q: &[f64]) -> Result<Kinematics, Error> {
        let rest = vec![0.0; q.len()];
        self.kinematics(q, &rest, &rest)
    }

    /// Positions, velocities and accelerations of all bodies, from those of the coordinates.
    ///
    /// # Errors
    /// As [`Mechanism::positions`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.kinematics(&[0.5], &[100.0], &[0.0])?;
    /// let [velocity, _] = at.velocity("piston.C")?;
    /// # assert!(velocity < 0.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinematics(
        &self,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
    ) -> Result<Kinematics, Error> {
        self.check_counts([q, q_dot, q_ddot])?;
        let found = self.assembled.states([q, q_dot, q_ddot])?;
        Ok(Kinematics::new(Arc::clone(&self.names), found))
    }

    /// Inverse dynamics under all loads at time `t` (s): the actuator forces and all reactions for the motion with the
    /// coordinates `q`, velocities and accelerations. At rest this is statics.
    ///
    /// # Errors
    /// As [`Mechanism::positions`]; [`Error::Study`] if a load has no value or friction locks the mechanism.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let forces = slider.inverse_dynamics(0.0, &[0.5], &[150.0], &[0.0])?;
    /// let torque = forces.actuator_force("phi")?; // N·m
    /// let normal = forces.reaction("guide.normal")?; // N
    /// # assert!(torque.is_finite() && normal.is_finite());
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn inverse_dynamics(
        &self,
        t: f64,
        q: &[f64],
        q_dot: &[f64],
        q_ddot: &[f64],
    ) -> Result<InverseDynamics, Error> {
        self.check_counts([q, q_dot, q_ddot])?;
        let (found, forces) = self.assembled.forces(t, [q, q_dot, q_ddot])?;
        let kinematics = Kinematics::new(Arc::clone(&self.names), found);
        Ok(InverseDynamics::new(kinematics, forces))
    }

    fn check_counts(&self, lists: [&[f64]; 3]) -> Result<(), Error> {
        Error::check_counts(lists, self.names.actuators.len())
    }
}

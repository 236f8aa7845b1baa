//! An assembled mechanism.

use crate::error::Error;
use crate::scene::Scene;
use dwell_kinetostatics::Model;
use std::sync::Arc;

/// An assembled mechanism: constant, cheap to clone, and shared between threads.
///
/// It is [built](Mechanism::builder) or [read](Scene::read), and then asked. Coordinates are those of its
/// [actuators](Mechanism::actuators), in their order, in rad or m; everything is in SI.
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
    /// With all loads and reactions.
    pub(crate) model: Arc<Model>,
}

impl Mechanism {
    pub(crate) fn new(scene: Scene) -> Result<Self, Error> {
        let model = Arc::new(dwell_study::models::loaded_model(scene.inner())?);
        Ok(Self { scene, model })
    }

    /// The scene it was assembled from.
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
        let actuators = &self.scene.inner().mechanism.actuators;
        actuators.iter().map(|a| a.name.as_str()).collect()
    }

    /// Names of the reactions: `joint.component`.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.reactions()[..2], ["A.x", "A.y"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reactions(&self) -> Vec<String> {
        let mechanism = &self.scene.inner().mechanism;
        let all = mechanism.reactions().into_iter();
        all.map(|r| mechanism.reaction_name(r)).collect()
    }

    /// The limits of the only coordinate, rad or m, where it has limits: limit positions of the mechanism.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.limits(), None); // the crank rotates fully
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn limits(&self) -> Option<(f64, f64)> {
        self.model.plan().range().limits()
    }

    pub(crate) fn check_counts(&self, lists: [&[f64]; 3]) -> Result<(), Error> {
        let actuators = self.model.plan().actuators();
        let names = ["coordinates", "velocities", "accelerations"];
        match lists
            .iter()
            .zip(names)
            .find(|(list, _)| list.len() != actuators)
        {
            None => Ok(()),
            Some((list, what)) => Err(Error::Count {
                what,
                given: list.len(),
                actuators,
            }),
        }
    }
}

impl Scene {
    /// Assembles its mechanism.
    ///
    /// # Errors
    /// [`Error::Study`] where the mechanism cannot be assembled, does not move, or a load does not fit it.
    ///
    /// ```
    /// let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.actuators(), ["phi"]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn assemble(&self) -> Result<Mechanism, Error> {
        Mechanism::new(self.clone())
    }
}

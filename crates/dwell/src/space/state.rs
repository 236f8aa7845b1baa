//! The state of all bodies in space at one position, and the forces there.

use crate::error::Error;
use crate::space::mechanism::Mechanism;
use crate::space::scene::Scene;
use dwell_geometry::space::{BodyMotion, Placement, Vec3};

/// Positions, velocities and accelerations of all bodies, in the axes of the ground.
///
/// ```
/// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
/// let at = rssr.kinematics(&[0.3], &[10.0], &[0.0])?;
/// let [x, y, z] = at.position("crank.B")?;
/// assert!((x.hypot(y) - 0.1).abs() < 1e-12 && z.abs() < 1e-12);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Kinematics {
    scene: Scene,
    placements: Vec<Placement>,
    motions: Vec<BodyMotion>,
}

fn numbers(v: Vec3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

impl Kinematics {
    pub(super) fn new(scene: Scene, bodies: Vec<(Placement, BodyMotion)>) -> Self {
        let (placements, motions) = bodies.into_iter().unzip();
        Self {
            scene,
            placements,
            motions,
        }
    }

    /// Position of a point `body.point`, m.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// assert_eq!(rssr.positions(&[0.0])?.position("ground.D")?, [0.25, 0.06, -0.04]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn position(&self, point: &str) -> Result<[f64; 3], Error> {
        let (body, at) = self.scene.point(point)?;
        let placement = &self.placements[body.0];
        Ok(numbers(placement.position + placement.rotation.apply(at)))
    }

    /// Velocity of a point `body.point`, m/s.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let velocity = rssr.kinematics(&[0.0], &[10.0], &[0.0])?.velocity("crank.B")?;
    /// assert!((velocity[1] - 1.0).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn velocity(&self, point: &str) -> Result<[f64; 3], Error> {
        let (motion, arm) = self.of_point(point)?;
        Ok(numbers(motion.point_velocity(arm)))
    }

    /// Acceleration of a point `body.point`, m/s².
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let acceleration = rssr.kinematics(&[0.0], &[10.0], &[0.0])?.acceleration("crank.B")?;
    /// assert!((acceleration[0] + 10.0).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn acceleration(&self, point: &str) -> Result<[f64; 3], Error> {
        let (motion, arm) = self.of_point(point)?;
        Ok(numbers(motion.point_acceleration(arm)))
    }

    /// Orientation of a body: the axes x, y and z of its frame in the axes of the ground.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let [x, _, z] = rssr.positions(&[0.3])?.axes("crank")?;
    /// assert!((x[0] - 0.3_f64.cos()).abs() < 1e-12 && z == [0.0, 0.0, 1.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn axes(&self, body: &str) -> Result<[[f64; 3]; 3], Error> {
        let body = self.scene.body(body)?;
        Ok(self.placements[body.0].rotation.columns.map(numbers))
    }

    /// Angular velocity of a body, rad/s.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let at = rssr.kinematics(&[0.3], &[10.0], &[0.0])?;
    /// assert_eq!(at.angular_velocity("crank")?, [0.0, 0.0, 10.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angular_velocity(&self, body: &str) -> Result<[f64; 3], Error> {
        let body = self.scene.body(body)?;
        Ok(numbers(self.motions[body.0].angular_velocity))
    }

    /// Angular acceleration of a body, rad/s².
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let at = rssr.kinematics(&[0.3], &[10.0], &[2.0])?;
    /// assert_eq!(at.angular_acceleration("crank")?, [0.0, 0.0, 2.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angular_acceleration(&self, body: &str) -> Result<[f64; 3], Error> {
        let body = self.scene.body(body)?;
        Ok(numbers(self.motions[body.0].angular_acceleration))
    }

    /// The motion of a point's body, and the point's arm in the axes of the ground.
    fn of_point(&self, point: &str) -> Result<(&BodyMotion, Vec3), Error> {
        let (body, at) = self.scene.point(point)?;
        let arm = self.placements[body.0].rotation.apply(at);
        Ok((&self.motions[body.0], arm))
    }
}

/// Actuator forces and reactions at one position, with the state of all bodies.
///
/// ```
/// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
/// let forces = rssr.inverse_dynamics(0.0, &[0.3], &[0.0], &[0.0])?;
/// // At rest the ground carries the weight of 2.3 kg.
/// let lift = forces.reaction("A.z")? + forces.reaction("D.z")?;
/// assert!((lift - 2.3 * 9.81).abs() < 1e-11);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct InverseDynamics {
    mechanism: Mechanism,
    kinematics: Kinematics,
    result: dwell_kinetostatics::InverseDynamics<f64>,
}

impl InverseDynamics {
    pub(super) fn new(
        mechanism: Mechanism,
        kinematics: Kinematics,
        result: dwell_kinetostatics::InverseDynamics<f64>,
    ) -> Self {
        Self {
            mechanism,
            kinematics,
            result,
        }
    }

    /// The state of all bodies.
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let forces = rssr.inverse_dynamics(0.0, &[0.3], &[0.0], &[0.0])?;
    /// assert_eq!(forces.kinematics().angular_velocity("crank")?, [0.0; 3]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// A reaction `joint.component` of the joint's first body on its second, N or N·m about the joint's point.
    ///
    /// # Errors
    /// [`Error::Unknown`], also where redundant constraints leave it open.
    ///
    /// ```
    /// # let bricard = dwell::space::Scene::read("../../validation/spatial/bricard-a04.toml")?.assemble()?;
    /// let forces = bricard.inverse_dynamics(0.0, &[0.3], &[0.0], &[0.0])?;
    /// assert!(forces.reaction("P0.x").is_err()); // redundant constraints share it
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reaction(&self, name: &str) -> Result<f64, Error> {
        let scene = self.mechanism.scene.inner();
        let mut determined = self.mechanism.determined.iter();
        if let Some(k) = determined.position(|r| scene.reaction_name(*r) == name) {
            return Ok(self.result.reactions[k]);
        }
        let names = self.mechanism.reactions();
        if names.iter().any(|known| known == name) {
            return Err(Error::Unknown {
                what: "statically determinate reaction",
                name: name.to_owned(),
                help: "redundant constraints share the load".to_owned(),
            });
        }
        let names = names.iter().map(String::as_str);
        Err(Error::unknown("reaction", "reactions", name, names))
    }

    /// The force or moment of an actuator, N or N·m.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::space::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let forces = rssr.inverse_dynamics(0.0, &[0.3], &[10.0], &[0.0])?;
    /// assert!(forces.actuator_force("q")?.abs() > 0.01);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn actuator_force(&self, name: &str) -> Result<f64, Error> {
        let names = self.mechanism.actuators();
        let found = names.iter().position(|known| *known == name);
        let found = found
            .ok_or_else(|| Error::unknown("actuator", "actuators", name, names.iter().copied()));
        Ok(self.result.tau[found?])
    }
}

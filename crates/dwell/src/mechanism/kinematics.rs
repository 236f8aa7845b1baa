//! The state of all bodies at one position, and the forces there.

use crate::error::Error;
use crate::mechanism::Mechanism;
use crate::mechanism::scene::Scene;
use dwell_geometry::body_states::{BodyStates, CoordinateFunction, PointState};
use dwell_geometry::{BodyId, Vec2};

/// Positions, velocities and accelerations of all bodies, in the ground's frame.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let at = slider.kinematics(&[0.5], &[150.0], &[0.0])?;
/// let [x, y] = at.position("rod.C")?; // m
/// let omega = at.angular_velocity("rod")?; // rad/s
/// # assert!(x > 0.0 && y > 0.0 && omega.is_finite());
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Kinematics {
    scene: Scene,
    states: BodyStates,
}

impl Kinematics {
    pub(crate) fn new(scene: Scene, states: BodyStates) -> Self {
        Self { scene, states }
    }

    /// Position of a point `body.point`, m.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let [x, y] = slider.positions(&[0.0])?.position("crank.B")?;
    /// assert!((x - 0.08).abs() < 1e-12 && y.abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn position(&self, point: &str) -> Result<[f64; 2], Error> {
        Ok(pair(self.point(point)?.position))
    }

    /// Velocity of a point `body.point`, m/s.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let velocity = slider.kinematics(&[0.0], &[10.0], &[0.0])?.velocity("crank.B")?;
    /// assert!((velocity[1] - 0.8).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn velocity(&self, point: &str) -> Result<[f64; 2], Error> {
        Ok(pair(self.point(point)?.velocity))
    }

    /// Acceleration of a point `body.point`, m/s².
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let acceleration = slider.kinematics(&[0.0], &[10.0], &[0.0])?.acceleration("crank.B")?;
    /// assert!((acceleration[0] + 8.0).abs() < 1e-12); // towards A
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn acceleration(&self, point: &str) -> Result<[f64; 2], Error> {
        Ok(pair(self.point(point)?.acceleration))
    }

    /// Angle of a body from the ground, rad: within half a revolution, or with whole revolutions where actuators turn it.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.positions(&[0.5])?.angle("crank")?, 0.5);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angle(&self, body: &str) -> Result<f64, Error> {
        let state = self.states.body(self.body(body)?);
        let direction = state.rotation;
        Ok(state
            .angle
            .unwrap_or_else(|| direction.y.atan2(direction.x)))
    }

    /// Angular velocity of a body, rad/s.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.kinematics(&[0.5], &[150.0], &[0.0])?;
    /// assert_eq!(at.angular_velocity("crank")?, 150.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angular_velocity(&self, body: &str) -> Result<f64, Error> {
        Ok(self.states.body(self.body(body)?).angular_velocity)
    }

    /// Angular acceleration of a body, rad/s².
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.kinematics(&[0.5], &[150.0], &[20.0])?;
    /// assert_eq!(at.angular_acceleration("crank")?, 20.0);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angular_acceleration(&self, body: &str) -> Result<f64, Error> {
        Ok(self.states.body(self.body(body)?).angular_acceleration)
    }

    /// An actuator's or named coordinate with its first two derivatives: rad or m, per s, per s².
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.kinematics(&[0.5], &[150.0], &[0.0])?;
    /// assert_eq!(at.coordinate("phi")?, [0.5, 150.0, 0.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn coordinate(&self, name: &str) -> Result<[f64; 3], Error> {
        let scene = self.scene.inner();
        let function = scene.coordinate(name);
        let function = function.and_then(|c| CoordinateFunction::find(&scene.mechanism, c));
        let names = scene.mechanism.actuators.iter().map(|a| a.name.as_str());
        let names = names.chain(scene.coordinates.iter().map(|c| c.name.as_str()));
        let function =
            function.ok_or_else(|| Error::unknown("coordinate", "coordinates", name, names))?;
        Ok(self.states.coordinate(function))
    }

    fn body(&self, name: &str) -> Result<BodyId, Error> {
        self.scene.body(name)
    }

    fn point(&self, name: &str) -> Result<PointState, Error> {
        let (body, at) = self.scene.point(name)?;
        Ok(self.states.point(body, at))
    }
}

pub(super) fn pair(vector: Vec2) -> [f64; 2] {
    [vector.x, vector.y]
}

/// The forces of a motion at one instant.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let forces = slider.inverse_dynamics(0.0, &[0.5], &[150.0], &[0.0])?;
/// let [torque, normal] = [forces.actuator_force("phi")?, forces.reaction("guide.normal")?];
/// # assert!(torque.is_finite() && normal.is_finite());
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct InverseDynamics {
    mechanism: Mechanism,
    kinematics: Kinematics,
    result: dwell_kinetostatics::InverseDynamics<f64>,
}

impl InverseDynamics {
    pub(crate) fn new(
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

    /// The state of the bodies.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let forces = slider.inverse_dynamics(0.0, &[0.5], &[150.0], &[0.0])?;
    /// let [x, _] = forces.kinematics().position("piston.C")?;
    /// # assert!(x > 0.2);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// A reaction `joint.component`, N or N·m: the force or moment of the joint's first-named body on the second. The
    /// `magnitude` of a pin or a weld is the length of (x, y).
    ///
    /// # Errors
    /// [`Error::Unknown`], also where redundant constraints share the load, so that the reaction is statically
    /// indeterminate.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let forces = slider.inverse_dynamics(0.0, &[0.5], &[150.0], &[0.0])?;
    /// let [x, y] = [forces.reaction("A.x")?, forces.reaction("A.y")?];
    /// assert_eq!(forces.reaction("A.magnitude")?, x.hypot(y));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reaction(&self, name: &str) -> Result<f64, Error> {
        let names = self.mechanism.reactions();
        let find = |name: &str| names.iter().position(|known| known == name);
        if let Some((joint, "magnitude")) = name.rsplit_once('.')
            && let [Some(x), Some(y)] = ["x", "y"].map(|axis| find(&format!("{joint}.{axis}")))
        {
            return Ok(self.determinate(x, name)?.hypot(self.determinate(y, name)?));
        }
        let found = find(name).ok_or_else(|| {
            let names = names.iter().map(String::as_str);
            Error::unknown("reaction", "reactions", name, names)
        });
        self.determinate(found?, name)
    }

    fn determinate(&self, k: usize, name: &str) -> Result<f64, Error> {
        if self.mechanism.model.plan().is_determinate(k) {
            return Ok(self.result.reactions[k]);
        }
        Err(Error::Unknown {
            what: "statically determinate reaction",
            name: name.to_owned(),
            help: "redundant constraints share the load".to_owned(),
        })
    }

    /// The force, N, or torque, N·m, that an actuator must exert.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let torque = slider.inverse_dynamics(0.0, &[0.5], &[150.0], &[0.0])?.actuator_force("phi")?;
    /// # assert!(torque.is_finite());
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

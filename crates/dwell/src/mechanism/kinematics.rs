//! The state of all bodies at one position, and the forces there.

use crate::assembled::{NamedReaction, Names};
use crate::error::Error;
use dwell_study::assembled::{BodyStates, CoordinateValue, FoundStates};
use std::sync::Arc;

/// Positions, velocities and accelerations of all bodies, in the ground's frame.
///
/// The type to which a vector is assigned determines its number of components. In the plane positions, velocities and accelerations are
/// `[x, y]`, or `[x, y, z]` with z = 0; angular velocities and accelerations are `[z]`, or `[x, y, z]` with x = y = 0. In space all have
/// three components.
///
/// ```
/// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
/// let at = slider.kinematics(&[0.5], &[150.0], &[0.0])?;
/// let [x, y] = at.position("rod.C")?; // m
/// let [omega] = at.angular_velocity("rod")?; // rad/s
/// # assert!(x > 0.0 && y > 0.0 && omega.is_finite());
///
/// # let rssr = dwell::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
/// let at = rssr.kinematics(&[0.3], &[10.0], &[0.0])?;
/// let [x, y, z] = at.position("crank.B")?;
/// assert!((x.hypot(y) - 0.1).abs() < 1e-12 && z.abs() < 1e-12);
/// # Ok::<(), dwell::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Kinematics {
    names: Arc<Names>,
    states: Arc<dyn BodyStates>,
    /// In the order of the names.
    coordinates: Vec<CoordinateValue>,
}

/// The requested number of components of a position, velocity or acceleration.
pub(super) fn components<const N: usize>(
    vector: [f64; 3],
    dimension: usize,
) -> Result<[f64; N], Error> {
    let given = match (N, dimension) {
        (3, _) | (2, 2) => vector.get(..N),
        _ => None,
    };
    let components = match dimension {
        2 => "2, or 3 with z = 0",
        _ => "3",
    };
    let taken = given.and_then(|given| given.try_into().ok());
    taken.ok_or(Error::Components {
        asked: N,
        components,
    })
}

/// The requested number of components of an angular velocity or acceleration.
fn turning<const N: usize>(vector: [f64; 3], dimension: usize) -> Result<[f64; N], Error> {
    let given = match (N, dimension) {
        (3, _) => vector.get(..),
        (1, 2) => vector.get(2..),
        _ => None,
    };
    let components = match dimension {
        2 => "1, about z, or 3",
        _ => "3",
    };
    let taken = given.and_then(|given| given.try_into().ok());
    taken.ok_or(Error::Components {
        asked: N,
        components,
    })
}

impl Kinematics {
    pub(crate) fn new(names: Arc<Names>, (states, coordinates): FoundStates) -> Self {
        Self {
            names,
            states: states.into(),
            coordinates,
        }
    }

    /// Position of a point `body.point`, m.
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Components`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let [x, y] = slider.positions(&[0.0])?.position("crank.B")?;
    /// assert!((x - 0.08).abs() < 1e-12 && y.abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn position<const N: usize>(&self, point: &str) -> Result<[f64; N], Error> {
        self.of_point(point, 0)
    }

    /// Velocity of a point `body.point`, m/s.
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Components`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let [_, upwards] = slider.kinematics(&[0.0], &[10.0], &[0.0])?.velocity("crank.B")?;
    /// assert!((upwards - 0.8).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn velocity<const N: usize>(&self, point: &str) -> Result<[f64; N], Error> {
        self.of_point(point, 1)
    }

    /// Acceleration of a point `body.point`, m/s².
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Components`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let [towards_a, _] = slider.kinematics(&[0.0], &[10.0], &[0.0])?.acceleration("crank.B")?;
    /// assert!((towards_a + 8.0).abs() < 1e-12);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn acceleration<const N: usize>(&self, point: &str) -> Result<[f64; N], Error> {
        self.of_point(point, 2)
    }

    /// Angle of a body in the plane from the ground, rad: within half a revolution, or with whole revolutions if actuators determine it.
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::InSpace`] in space, where a body has [axes](Self::axes) instead.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// assert_eq!(slider.positions(&[0.5])?.angle("crank")?, 0.5);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angle(&self, body: &str) -> Result<f64, Error> {
        let angle = self.states.angle(self.names.body(body)?);
        angle.ok_or(Error::InSpace {
            what: "angle of a body",
            instead: "`axes` has its orientation",
        })
    }

    /// Orientation of a body: the axes x, y and z of its frame in the axes of the ground.
    ///
    /// # Errors
    /// [`Error::Unknown`].
    ///
    /// ```
    /// # let rssr = dwell::Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
    /// let [x, _, z] = rssr.positions(&[0.3])?.axes("crank")?;
    /// assert!((x[0] - 0.3_f64.cos()).abs() < 1e-12 && z == [0.0, 0.0, 1.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn axes(&self, body: &str) -> Result<[[f64; 3]; 3], Error> {
        Ok(self.states.axes(self.names.body(body)?))
    }

    /// Angular velocity of a body, rad/s.
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Components`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.kinematics(&[0.5], &[150.0], &[0.0])?;
    /// assert_eq!(at.angular_velocity("crank")?, [150.0]);
    /// assert_eq!(at.angular_velocity("crank")?, [0.0, 0.0, 150.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angular_velocity<const N: usize>(&self, body: &str) -> Result<[f64; N], Error> {
        let [velocity, _] = self.states.turning(self.names.body(body)?);
        turning(velocity, self.names.dimension)
    }

    /// Angular acceleration of a body, rad/s².
    ///
    /// # Errors
    /// [`Error::Unknown`]; [`Error::Components`].
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let at = slider.kinematics(&[0.5], &[150.0], &[20.0])?;
    /// assert_eq!(at.angular_acceleration("crank")?, [20.0]);
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn angular_acceleration<const N: usize>(&self, body: &str) -> Result<[f64; N], Error> {
        let [_, acceleration] = self.states.turning(self.names.body(body)?);
        turning(acceleration, self.names.dimension)
    }

    /// The coordinate of an actuator, or a named coordinate, with its first two derivatives: rad or m, per s, per s².
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
        let names = self.names.coordinates.iter().map(String::as_str);
        let found = names.clone().position(|known| known == name);
        let found =
            found.ok_or_else(|| Error::unknown("coordinate", "coordinates", name, names))?;
        self.coordinates[found].map_err(|reason| Error::Unknown {
            what: "value of coordinate",
            name: name.to_owned(),
            help: reason.to_owned(),
        })
    }

    /// The components of the position, velocity or acceleration of a point.
    fn of_point<const N: usize>(&self, point: &str, derivative: usize) -> Result<[f64; N], Error> {
        let (body, at) = self.names.point(point)?;
        let found = self.states.point(body, at)[derivative];
        components(found, self.names.dimension)
    }
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
    kinematics: Kinematics,
    result: dwell_kinetostatics::InverseDynamics<f64>,
}

impl InverseDynamics {
    pub(crate) fn new(
        kinematics: Kinematics,
        result: dwell_kinetostatics::InverseDynamics<f64>,
    ) -> Self {
        Self { kinematics, result }
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
    /// component `magnitude` is the magnitude of the force.
    ///
    /// # Errors
    /// [`Error::Unknown`], also if the reaction is statically indeterminate because of redundant
    /// constraints.
    ///
    /// ```
    /// # let slider = dwell::Scene::read("../../docs/slider.toml")?.assemble()?;
    /// let forces = slider.inverse_dynamics(0.0, &[0.5], &[150.0], &[0.0])?;
    /// let [x, y] = [forces.reaction("A.x")?, forces.reaction("A.y")?];
    /// assert_eq!(forces.reaction("A.magnitude")?, x.hypot(y));
    /// # Ok::<(), dwell::Error>(())
    /// ```
    pub fn reaction(&self, name: &str) -> Result<f64, Error> {
        let all = &self.kinematics.names.reactions;
        let find = |name: &str| all.iter().find(|known| known.name == name);
        if let Some((joint, "magnitude")) = name.rsplit_once('.') {
            let axes = &["x", "y", "z"][..self.kinematics.names.dimension];
            let parts = axes.iter().map(|axis| find(&format!("{joint}.{axis}")));
            if let Some(parts) = parts.collect::<Option<Vec<_>>>() {
                let mut parts = parts.into_iter();
                let length = |sum: f64, part| Ok(sum.hypot(self.determinate(part, name)?));
                return parts.try_fold(0.0, length);
            }
        }
        let found = find(name).ok_or_else(|| {
            let names = all.iter().map(|known| known.name.as_str());
            Error::unknown("reaction", "reactions", name, names)
        });
        self.determinate(found?, name)
    }

    fn determinate(&self, reaction: &NamedReaction, name: &str) -> Result<f64, Error> {
        let place = reaction.place.ok_or_else(|| Error::shared_load(name))?;
        Ok(self.result.reactions[place])
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
        let names = self.kinematics.names.actuators.iter().map(String::as_str);
        let found = names
            .clone()
            .position(|known| known == name)
            .ok_or_else(|| Error::unknown("actuator", "actuators", name, names));
        Ok(self.result.tau[found?])
    }
}

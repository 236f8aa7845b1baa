//! The names and places of a scene that messages about a motion need, in the plane or in space.

use dwell_geometry::{ActuatorId, BodyId};
use dwell_scene::{NamedStop, PlaneScene, SceneFile, SceneLocation, SpaceScene};
use std::ops::Deref;

/// A scene with the names of its parts.
///
/// ```
/// use dwell_scene::PlaneScene;
/// use dwell_study::explain::NamedScene as _;
///
/// let text = include_str!("../../tests/run/pendulum.toml");
/// let scene = PlaneScene::parse("pendulum.toml", text)?;
/// assert!(scene.actuator(0).is_some_and(|(_, is_angle)| is_angle));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait NamedScene: Deref<Target = SceneFile> {
    /// The name of an actuator, and whether it drives an angle; otherwise it drives a length.
    fn actuator(&self, actuator: usize) -> Option<(&str, bool)>;

    /// The name of a load, or of a drive, which follow the loads.
    fn load_name(&self, load: usize) -> Option<&str>;

    /// Its end stops.
    fn stops(&self) -> &[NamedStop];

    /// The name of an end stop, and its actuator.
    fn stop(&self, stop: usize) -> Option<(&str, ActuatorId)> {
        let stop = self.stops().get(stop)?;
        Some((&stop.name, stop.actuator))
    }

    /// The bodies but the ground.
    fn moving_bodies(&self) -> Vec<BodyId>;

    /// Whether there is a `[motion]`.
    fn has_motion(&self) -> bool;

    /// The place of the initial state: `[motion]`, or else the assembly.
    fn initial_state_location(&self) -> SceneLocation {
        if self.has_motion() {
            SceneLocation::Motion
        } else {
            SceneLocation::AssemblyCoordinate(ActuatorId(0))
        }
    }

    /// Whether the first coordinate is an angle.
    fn is_first_angle(&self) -> bool {
        self.actuator(0).is_none_or(|(_, is_angle)| is_angle)
    }

    /// The name of the first coordinate, quoted.
    fn quoted_coordinate(&self) -> String {
        match self.actuator(0) {
            Some((name, _)) => format!("`{name}`"),
            None => "the coordinate".to_owned(),
        }
    }
}

/// The bodies but one.
fn all_but(ground: usize, count: usize) -> Vec<BodyId> {
    (0..count).filter(|b| *b != ground).map(BodyId).collect()
}

impl NamedScene for PlaneScene {
    fn actuator(&self, actuator: usize) -> Option<(&str, bool)> {
        let actuator = self.mechanism.actuators.get(actuator)?;
        Some((&actuator.name, actuator.coordinate().is_angle()))
    }

    fn load_name(&self, load: usize) -> Option<&str> {
        // Where drives act, they are among the loads of the scene that is given.
        self.loads.get(load).map(|load| load.name.as_str())
    }

    fn stops(&self) -> &[NamedStop] {
        &self.stops
    }

    fn moving_bodies(&self) -> Vec<BodyId> {
        all_but(self.mechanism.ground, self.mechanism.bodies.len())
    }

    fn has_motion(&self) -> bool {
        self.motion.is_some()
    }
}

impl NamedScene for SpaceScene {
    fn actuator(&self, actuator: usize) -> Option<(&str, bool)> {
        let actuator = self.mechanism.actuators.get(actuator)?;
        let joint = &self.mechanism.joints[actuator.kind.joint().0];
        Some((&actuator.name, actuator.kind.coordinate(joint).is_angle()))
    }

    fn load_name(&self, load: usize) -> Option<&str> {
        let loads = self.loads.iter().map(|load| load.name.as_str());
        let drives = self.drives.iter().map(|drive| drive.name.as_str());
        loads.chain(drives).nth(load)
    }

    fn stops(&self) -> &[NamedStop] {
        &self.stops
    }

    fn moving_bodies(&self) -> Vec<BodyId> {
        all_but(self.mechanism.ground, self.mechanism.bodies.len())
    }

    fn has_motion(&self) -> bool {
        self.motion.is_some()
    }
}

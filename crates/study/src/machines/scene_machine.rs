//! The machine of a scene, as `cycle`, `equilibria` and `linearise` use it.

use super::machine_scene::{MachineScene, MotionStart};
use crate::explain::{Labels, StudyError, labels, scene_error};
use crate::models::drive_states;
use crate::number_format::{coordinate_unit, digits_within};
use dwell_dynamics::{DynamicsError, Machine};
use dwell_findings::Column;
use dwell_geometry::ActuatorId;
use dwell_kinetostatics::{MachineModel as _, Signal};
use dwell_scene::{PlaneScene, SceneLocation};

/// A scene, in the plane or in space, with its machine and its initial state.
pub struct SceneMachine<'a, S: MachineScene = PlaneScene> {
    /// The scene.
    pub scene: &'a S,
    start: MotionStart,
    /// Its machine without reactions.
    pub machine: Machine<S::Model>,
}

impl<'a, S: MachineScene> SceneMachine<'a, S> {
    pub(crate) fn new(scene: &'a S) -> Result<Self, StudyError> {
        let machine = scene.machine(&[])?;
        if machine.free().is_empty() {
            return Err(scene_error(
                scene,
                "the scene has no free coordinate",
                "declare the coordinate that moves, as in `[actuators.phi]`",
                [(SceneLocation::Whole, "none")],
            ));
        }
        Ok(Self {
            scene,
            start: scene.motion_start(),
            machine,
        })
    }

    /// A note if the assembly mode in use is far from the approximate angles of the scene.
    #[cfg(feature = "output")]
    pub(crate) fn branch_note(&self) -> String {
        self.scene.assembly_note(self.machine.model())
    }

    /// The initial state of `[motion]`, or else the assembly configuration at rest.
    pub(crate) fn initial_state(&self) -> Vec<f64> {
        let start = &self.start;
        self.machine
            .initial_state(&start.coordinates, &start.velocities)
    }

    pub(crate) fn explain(&self, error: &DynamicsError) -> StudyError {
        self.scene.explain(self.machine.model(), error)
    }

    pub(crate) fn error(
        &self,
        message: impl Into<String>,
        help: &str,
        labels: Labels,
    ) -> StudyError {
        scene_error(self.scene, message, help, labels)
    }

    /// The label of the scene's initial state.
    pub(crate) fn initial_state_label(&self, text: &str) -> Labels {
        labels([self.scene.initial_state_location()].into_iter(), text)
    }

    /// Rejects a machine that depends explicitly on time.
    pub(crate) fn require_autonomous(&self, subject: &str) -> Result<(), StudyError> {
        if !self.machine.depends_on_time() {
            return Ok(());
        }
        let loads = self.machine.model().loads().iter().enumerate();
        let loads = loads.filter(|(_, load)| load.magnitude.signals().contains(&Signal::Time));
        let loads = loads.map(|(k, _)| SceneLocation::Magnitude(k));
        let laws = self.start.laws.iter().enumerate();
        let laws = laws.filter(|(_, law)| law.is_some());
        let laws = laws.map(|(k, _)| SceneLocation::MotionLaw(ActuatorId(k)));
        let mut places = labels(loads, "depends on time");
        places.extend(labels(laws, "prescribed in time"));
        Err(self.error(
            format!("{subject} needs an autonomous system: no load, drive or prescribed motion may depend on time"),
            "remove `t` from expressions and tables, and prescribe constant coordinates only; \
             `dwell simulate` integrates time-dependent motions",
            places,
        ))
    }

    pub(crate) fn coordinate_name(&self, actuator: usize) -> &str {
        self.scene.actuator(actuator).map_or("", |(name, _)| name)
    }

    pub(crate) fn is_angle(&self, actuator: usize) -> bool {
        self.machine.model().is_angle(actuator)
    }

    /// The first free coordinate: (actuator, whether it is an angle).
    pub(crate) fn first_free_coordinate(&self) -> (usize, bool) {
        let actuator = self.machine.free().first().copied().unwrap_or(0);
        (actuator, self.is_angle(actuator))
    }

    /// A coordinate as text.
    pub fn describe_coordinate(&self, actuator: usize, value: f64) -> String {
        self.describe_coordinate_within(actuator, value, 0.0)
    }

    /// A coordinate as text, to the digits that its error leaves.
    pub(crate) fn describe_coordinate_within(
        &self,
        actuator: usize,
        value: f64,
        error: f64,
    ) -> String {
        let is_angle = self.is_angle(actuator);
        let name = self.coordinate_name(actuator);
        let in_scene_unit = |value: f64| self.scene.to_scene_unit(value, is_angle);
        let (in_unit, unit) = in_scene_unit(value);
        let text = digits_within(in_unit, in_scene_unit(error).0, 9);
        let other = match (is_angle, unit) {
            (true, "rad") => {
                let degrees = digits_within(value.to_degrees(), error.to_degrees(), 9);
                format!(" ({degrees}°)")
            }
            (true, _) => format!(" ({} rad)", digits_within(value, error, 9)),
            (false, _) => String::new(),
        };
        format!("{name} = {text} {unit}{other}")
    }

    /// Names and units of the states: coordinates, speeds, states of drives.
    pub(crate) fn state_columns(&self) -> Vec<Column> {
        let free = self.machine.free().iter();
        let unit = |i: usize| coordinate_unit(self.is_angle(i));
        let coordinate = |&i: &usize| Column::new(self.coordinate_name(i), unit(i));
        let speed = |&i: &usize| {
            let name = format!("{}.velocity", self.coordinate_name(i));
            Column::new(name, format!("{}/s", unit(i)))
        };
        let states = drive_states(self.scene.drives(), S::is_angle).into_iter();
        let states = states.map(|(name, unit, _)| Column::new(name, unit));
        let coordinates = free.clone().map(coordinate).chain(free.map(speed));
        coordinates.chain(states).collect()
    }
}

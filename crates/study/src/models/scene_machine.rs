//! The machine of a scene, as `cycle`, `equilibria` and `linearise` use it.

use crate::explain::{StudyError, explain_machine, explain_motion, initial_state_location};
use crate::models::build_machine;
use crate::number_format::digits;
use dwell_dynamics::{DynamicsError, Machine, NonconservativeSource, loads_with_drives};
use dwell_findings::Column;
use dwell_geometry::{ActuatorId, Reaction};
use dwell_kinetostatics::{DriveKind, Signal};
use dwell_scene::{FreeMotionSpec, MotionDuration, Scene, SceneLocation};

/// A scene with its machine and its initial state.
pub(crate) struct SceneMachine<'a> {
    pub(crate) scene: &'a Scene,
    /// The scene with the loads of its drives added.
    loaded_scene: Scene,
    spec: FreeMotionSpec,
    pub(crate) machine: Machine,
}

impl<'a> SceneMachine<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Result<Self, StudyError> {
        let loads = loads_with_drives(&scene.mechanism, &scene.loads, &scene.drives);
        let mut loaded_scene = scene.clone();
        loaded_scene.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
        let spec = scene
            .motion
            .clone()
            .unwrap_or_else(|| motion_from_rest(scene));
        let machine = build_machine(scene, &spec, &[])?;
        let scene_machine = Self {
            scene,
            loaded_scene,
            spec,
            machine,
        };
        if scene_machine.machine.free().is_empty() {
            let help = "declare the coordinate that moves, as in `[actuators.phi]`";
            let message = "the scene has no free coordinate".to_owned();
            return Err(scene_machine.error(
                message,
                help,
                &[(SceneLocation::Whole, "none".to_owned())],
            ));
        }
        Ok(scene_machine)
    }

    /// The machine with some reactions.
    pub(crate) fn machine_with_reactions(
        &self,
        reactions: &[Reaction],
    ) -> Result<Machine, StudyError> {
        build_machine(self.scene, &self.spec, reactions)
    }

    /// The initial state of `[motion]`, or else the assembly configuration at rest.
    pub(crate) fn initial_state(&self) -> Vec<f64> {
        self.machine.initial_state(
            &self.spec.initial_coordinates,
            &self.spec.initial_velocities,
        )
    }

    pub(crate) fn explain(&self, error: &DynamicsError) -> StudyError {
        explain_motion(&self.loaded_scene, self.machine.model().plan(), error)
    }

    pub(crate) fn error(
        &self,
        message: String,
        help: &str,
        labels: &[(SceneLocation, String)],
    ) -> StudyError {
        let error = self.scene.error(message, Some(help.to_owned()), labels);
        error.into()
    }

    /// The label of the scene's initial state.
    pub(crate) fn initial_state_label(&self, text: &str) -> (SceneLocation, String) {
        (initial_state_location(self.scene), text.to_owned())
    }

    /// Rejects a machine that depends explicitly on time.
    pub(crate) fn require_autonomous(&self, subject: &str) -> Result<(), StudyError> {
        if !self.machine.depends_on_time() {
            return Ok(());
        }
        let loads = self.loaded_scene.loads.iter().enumerate();
        let loads = loads.filter(|(_, load)| load.magnitude.signals().contains(&Signal::Time));
        let mut labels: Vec<(SceneLocation, String)> = loads
            .map(|(k, _)| (SceneLocation::Magnitude(k), "depends on time".to_owned()))
            .collect();
        let laws = self.spec.laws.iter().enumerate();
        let prescribed = laws.filter(|(_, law)| law.is_some());
        labels.extend(prescribed.map(|(k, _)| {
            (
                SceneLocation::MotionLaw(ActuatorId(k)),
                "prescribed in time".to_owned(),
            )
        }));
        Err(self.error(
            format!("{subject} needs an autonomous system: no load, drive or prescribed motion may depend on time"),
            "remove `t` from expressions and tables, and prescribe constant coordinates only; \
             `dwell simulate` integrates time-dependent motions",
            &labels,
        ))
    }

    pub(crate) fn coordinate_name(&self, actuator: usize) -> &str {
        &self.scene.mechanism.actuators[actuator].name
    }

    pub(crate) fn is_angle(&self, actuator: usize) -> bool {
        self.machine.model().plan().is_angle(actuator)
    }

    /// The first free coordinate: (actuator, whether it is an angle).
    pub(crate) fn first_free_coordinate(&self) -> (usize, bool) {
        let actuator = self.machine.free().first().copied().unwrap_or(0);
        (actuator, self.is_angle(actuator))
    }

    /// A coordinate as text.
    pub(crate) fn describe_coordinate(&self, actuator: usize, value: f64) -> String {
        let name = self.coordinate_name(actuator);
        if self.is_angle(actuator) {
            let degrees = digits(value.to_degrees(), 9);
            format!("{name} = {} rad ({degrees}°)", digits(value, 9))
        } else {
            format!("{name} = {} m", digits(value, 9))
        }
    }

    /// Names and units of the states: coordinates, speeds, states of drives.
    pub(crate) fn state_columns(&self) -> Vec<Column> {
        let unit = |i: usize| if self.is_angle(i) { "rad" } else { "m" };
        let free = self.machine.free();
        let coordinates = free
            .iter()
            .map(|&i| Column::new(self.coordinate_name(i), unit(i)));
        let speed = |&i: &usize| {
            let name = format!("{}.velocity", self.coordinate_name(i));
            Column::new(name, format!("{}/s", unit(i)))
        };
        let mut states: Vec<Column> = coordinates.chain(free.iter().map(speed)).collect();
        for drive in &self.scene.drives {
            match &drive.kind {
                DriveKind::Motor(motor) if motor.inductance > 0.0 => {
                    states.push(Column::new(format!("{}.current", drive.name), "A"));
                }
                DriveKind::SpeedController(regulator) if regulator.integral_gain > 0.0 => {
                    let unit = if drive.coordinate.is_angle() {
                        "rad"
                    } else {
                        "m"
                    };
                    states.push(Column::new(format!("{}.integral", drive.name), unit));
                }
                _ => {}
            }
        }
        states
    }

    pub(crate) fn source_name(&self, source: NonconservativeSource) -> String {
        match source {
            NonconservativeSource::Load(load) => self.scene.loads[load].name.clone(),
            NonconservativeSource::Drive(drive) => self.scene.drives[drive].name.clone(),
            NonconservativeSource::Prescribed(actuator) => {
                self.coordinate_name(actuator).to_owned()
            }
        }
    }
}

/// The motion of a scene without `[motion]`: every actuator free, at rest in the assembly configuration.
fn motion_from_rest(scene: &Scene) -> FreeMotionSpec {
    let start = scene.assembly.coordinates.clone();
    FreeMotionSpec {
        initial_velocities: vec![0.0; start.len()],
        laws: vec![None; start.len()],
        initial_coordinates: start,
        duration: MotionDuration::Seconds(1.0),
        events: Vec::new(),
    }
}

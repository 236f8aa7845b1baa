//! The machine of a scene in space.

use super::explain::{explain_load_error, explain_loads, explain_position};
use super::prepared::{PreparedSpaceScene, compile, reaction_unit, sort_reactions};
use super::views::page_drawing;
use crate::explain::{StudyError, explain_any_motion, scene_error};
use crate::machines::{MachineScene, MotionStart};
use crate::models::{coordinate_modes, end_stops};
use crate::trajectory::compute::reject_unknown_variables;
use dwell_dynamics::{DynamicsError, Machine, MachineError};
use dwell_kinetostatics::Drive;
use dwell_kinetostatics::space::{Coordinate, Model, Reaction};
use dwell_page::Drawing;
use dwell_scene::{SceneLocation, SpaceScene};

impl MachineScene for SpaceScene {
    type Model = Model;
    type Reaction = Reaction;

    fn motion_start(&self) -> MotionStart {
        MotionStart::new(self.motion.as_ref(), &self.assembly.q)
    }

    fn machine(&self, reactions: &[Reaction]) -> Result<Machine<Model>, StudyError> {
        let modes = coordinate_modes(&self.motion_start().laws);
        let machine = Machine::new(compile(self, reactions)?, &self.loads, modes, &self.drives);
        let machine = machine.and_then(|machine| machine.with_stops(&end_stops(&self.stops)));
        machine.map_err(|error| explain_machine(self, &error))
    }

    fn sorted_reactions(&self, _: &Model) -> Result<[Vec<Reaction>; 2], StudyError> {
        // The model of the machine has no reactions.
        sort_reactions(self, &compile(self, &self.requests.reactions)?)
    }

    fn reaction_units(&self, model: &Model) -> Vec<(String, &'static str)> {
        let named = |r: Reaction| (self.reaction_name(r), reaction_unit(&r));
        model.reactions().map(named).collect()
    }

    fn name_of_coordinate(&self, coordinate: Coordinate) -> String {
        self.name_of(coordinate)
    }

    fn name_of_reaction(&self, reaction: Reaction) -> String {
        self.reaction_name(reaction)
    }

    fn drives(&self) -> &[Drive<Coordinate>] {
        &self.drives
    }

    fn is_angle(coordinate: Coordinate) -> bool {
        coordinate.is_angle()
    }

    fn reject_unknown_columns(&self) -> Result<(), StudyError> {
        reject_unknown_variables(self)
    }

    fn drawing_along(&self, coordinate: &[f64]) -> Option<Drawing> {
        let rows = PreparedSpaceScene::new(self).ok()?.placements(coordinate);
        Some(page_drawing(self, rows.ok()?, Vec::new()))
    }

    fn assembly_note(&self, _: &Model) -> String {
        String::new()
    }

    fn explain(&self, model: &Model, error: &DynamicsError) -> StudyError {
        match error {
            DynamicsError::Position(position) => explain_position(self, model.plan(), position),
            DynamicsError::Load(load) => explain_loads(self, model.plan(), load),
            other => explain_any_motion(self, other),
        }
    }
}

/// Explains a machine that cannot be built.
fn explain_machine(scene: &SpaceScene, error: &MachineError) -> StudyError {
    let (help, place) = match error {
        MachineError::Load(load) => return explain_load_error(scene, load),
        MachineError::Drive(drive) => {
            let place = (SceneLocation::Drive(drive.drive), "this drive");
            ("drive the coordinate of an actuator", place)
        }
        MachineError::Stop(_) | MachineError::CoordinateModes => {
            ("", (SceneLocation::Motion, "this motion"))
        }
    };
    scene_error(scene, error.to_string(), help, [place])
}

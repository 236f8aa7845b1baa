//! The machine of a scene in the plane.

use super::machine_scene::{MachineScene, MotionStart};
use crate::branch_note::branch_note;
use crate::explain::{StudyError, explain_motion};
use crate::models::{machine_with_laws, requested_reactions, with_drive_loads};
use crate::page::drawing_along;
use crate::trajectory::compute::reject_unknown_variables;
use dwell_dynamics::{DynamicsError, Machine};
use dwell_geometry::Reaction;
use dwell_kinetostatics::{Drive, Model};
use dwell_page::Drawing;
use dwell_scene::PlaneScene;

impl MachineScene for PlaneScene {
    type Model = Model;
    type Reaction = Reaction;

    fn motion_start(&self) -> MotionStart {
        MotionStart::new(self.motion.as_ref(), &self.assembly.coordinates)
    }

    fn machine(&self, reactions: &[Reaction]) -> Result<Machine, StudyError> {
        // A drive that does not fit is named with the others before the machine is built.
        with_drive_loads(self)?;
        machine_with_laws(self, &self.motion_start().laws, reactions)
    }

    fn sorted_reactions(&self, model: &Model) -> Result<[Vec<Reaction>; 2], StudyError> {
        Ok(requested_reactions(self, model.plan()))
    }

    fn reaction_units(&self, model: &Model) -> Vec<(String, &'static str)> {
        let named = |r: &Reaction| (self.mechanism.reaction_name(*r), r.component.unit());
        model.reactions().iter().map(named).collect()
    }

    fn name_of_coordinate(&self, coordinate: dwell_geometry::Coordinate) -> String {
        self.name_of(coordinate)
    }

    fn name_of_reaction(&self, reaction: Reaction) -> String {
        self.mechanism.reaction_name(reaction)
    }

    fn drives(&self) -> &[Drive] {
        &self.drives
    }

    fn is_angle(coordinate: dwell_geometry::Coordinate) -> bool {
        coordinate.is_angle()
    }

    fn reject_unknown_columns(&self) -> Result<(), StudyError> {
        reject_unknown_variables(self)
    }

    fn drawing_along(&self, coordinate: &[f64]) -> Option<Drawing> {
        drawing_along(self, coordinate)
    }

    fn assembly_note(&self, model: &Model) -> String {
        branch_note(self, model.plan())
    }

    fn explain(&self, model: &Model, error: &DynamicsError) -> StudyError {
        match with_drive_loads(self) {
            Ok(loaded) => explain_motion(&loaded, model.plan(), error),
            Err(error) => error,
        }
    }
}

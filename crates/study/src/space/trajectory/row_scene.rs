//! The rows of a scene in space.

use super::columns::{actuator_meanings, add_joint_columns, add_load_columns};
use super::evaluator::SpaceEvaluator;
use super::reactions::SpaceRows;
use crate::explain::{
    NamedScene as _, StudyError, describe_coordinate, discontinuous_coupling_error, off_table_error,
};
use crate::number_format::digits;
use crate::space::explain::{explain_loads, explain_position};
use crate::space::prepared::range_limits;
use crate::trajectory::compute::{
    Analysis, Column, ColumnList, ColumnRequests, EarlyStop, Layout, Quantity, RowScene, StopCause,
    SweepLimits, Trajectory, TrajectorySample,
};
use dwell_geometry::JointId;
use dwell_geometry::space::{Coordinate, Vec3};
use dwell_kinetostatics::KinetostaticsError;
use dwell_kinetostatics::space::Model;
use dwell_scene::{CoordinateSweep, NamedCoordinate, PrescribedMotion, SpaceScene};

impl RowScene for SpaceScene {
    const LAYOUT: Layout = Layout {
        axes: &["x", "y", "z"],
        turns: &[(0, ".x"), (1, ".y"), (2, ".z")],
        rotation: [
            (
                "rotation",
                "rotation of the body's frame from that of the ground, as a vector along its axis; followed from row to row",
            ),
            ("angular_velocity", "angular velocity, ground's axes"),
            (
                "angular_acceleration",
                "angular acceleration, ground's axes",
            ),
        ],
        unwraps_angles: false,
        shaking: &[
            ("fx", "N"),
            ("fy", "N"),
            ("fz", "N"),
            ("mx", "N m"),
            ("my", "N m"),
            ("mz", "N m"),
        ],
        draws_paths: false,
    };

    type Rows = SpaceRows;

    type Evaluator<'a> = SpaceEvaluator<'a>;

    fn rows(&self) -> Result<SpaceRows, StudyError> {
        SpaceRows::new(self)
    }

    fn model_of(rows: &SpaceRows) -> &Model {
        &rows.model
    }

    fn evaluator<'a>(
        &'a self,
        _: &'a SpaceRows,
        rows: &'a SpaceRows,
        analysis: Analysis,
        _: &[Column],
    ) -> Result<SpaceEvaluator<'a>, StudyError> {
        Ok(SpaceEvaluator::new(self, rows, analysis))
    }

    fn explain_stop(&self, model: &Model, stop: EarlyStop<'_>) -> StudyError {
        let plan = model.plan();
        let when = || match &stop.last {
            Some(last) => format!("soon after {}", position_of(self, stop.trajectory, last)),
            None => {
                let position = position_of(self, stop.trajectory, &stop.failed);
                format!("at the first position, {position}")
            }
        };
        match stop.cause {
            StopCause::NoSolution(KinetostaticsError::Position(error)) => {
                explain_position(self, plan, &error)
            }
            StopCause::NoSolution(error) => explain_loads(self, plan, &error),
            StopCause::OffTable { load, value } => {
                let at = when();
                let magnitude = &self.loads[load].magnitude;
                let name_of = |c| self.name_of(c);
                let is_angle = |c: Coordinate| c.is_angle();
                off_table_error(self, magnitude, name_of, is_angle, load, value, &at)
                    .unwrap_or_else(|| {
                        let error = KinetostaticsError::MagnitudeNotFinite { load };
                        explain_loads(self, plan, &error)
                    })
            }
            StopCause::Discontinuity { joint, between } => {
                discontinuous_coupling_error(self, &self.mechanism, joint, between, &when())
            }
        }
    }

    fn prescribed(&self) -> (Option<&PrescribedMotion>, Option<&CoordinateSweep>) {
        (self.prescribed.as_ref(), self.sweep.as_ref())
    }

    fn default_limits(&self, model: &Model) -> SweepLimits {
        range_limits(self, model.plan())
    }

    fn requests(&self) -> ColumnRequests<'_> {
        let at = |Vec3 { x, y, z }: Vec3| [x, y, z];
        let paths = self.requests.paths.iter();
        ColumnRequests {
            variables: self.requests.variables.as_deref(),
            lists_reactions: self.requests.lists_reactions,
            paths: paths.map(|path| (path.body, at(path.at))).collect(),
            dwell: None,
        }
    }

    const TO_DETERMINE: &'static str = "replace a joint of the loop by one with more freedoms";

    fn open_reactions(&self, rows: &SpaceRows) -> Vec<String> {
        let open = rows.indeterminate.iter();
        open.map(|reaction| self.reaction_name(*reaction)).collect()
    }

    fn is_of_listed_reaction(&self, rows: &SpaceRows, quantity: Quantity) -> bool {
        match quantity {
            Quantity::Reaction(_) => true,
            Quantity::ForceMagnitude(joint) => rows.lists_whole(joint)[0],
            Quantity::MomentMagnitude(joint) => rows.lists_whole(joint)[1],
            _ => false,
        }
    }

    fn joint_names(&self) -> Vec<(&str, [&str; 2])> {
        let joints = self.mechanism.joints.iter();
        let named = joints.map(|joint| {
            let bodies = joint.bodies.map(|b| &*self.mechanism.bodies[b.0].name);
            (joint.name.as_str(), bodies)
        });
        named.collect()
    }

    fn named_coordinates(&self) -> &[NamedCoordinate<Coordinate>] {
        &self.coordinates
    }

    fn travel(joint: JointId) -> Coordinate {
        Coordinate::Travel(joint)
    }

    fn actuator_meanings(&self, actuator: usize) -> [String; 2] {
        actuator_meanings(self, actuator)
    }

    fn add_joint_columns(&self, rows: &SpaceRows, list: &mut ColumnList) {
        add_joint_columns(self, rows, list);
    }

    fn add_load_columns(&self, model: &Model, list: &mut ColumnList) {
        add_load_columns(self, model.plan(), list);
    }
}

/// Where a sample is, in the names of the scene.
fn position_of(
    scene: &SpaceScene,
    trajectory: &Trajectory<'_>,
    sample: &TrajectorySample,
) -> String {
    let timed = trajectory.is_timed();
    let time = timed.then(|| format!("t = {} s", digits(sample.t, 6)));
    let actuators = (0..sample.q.len()).filter_map(|i| Some((i, scene.actuator(i)?)));
    let coordinates = actuators.map(|(i, (name, is_angle))| {
        describe_coordinate(scene, name, sample.coordinate(i), is_angle)
    });
    let all: Vec<String> = time.into_iter().chain(coordinates).collect();
    all.join(", ")
}

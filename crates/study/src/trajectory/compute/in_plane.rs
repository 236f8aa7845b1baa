//! The rows of a scene in the plane.

use super::plane_columns::{PlaneColumns, actuator_meanings};
use crate::explain::StudyError;
use crate::models::{compile_model, loaded_model, requested_reaction_bodies, with_drive_loads};
use crate::trajectory::compute::{
    Analysis, Column, ColumnList, ColumnRequests, EarlyStop, Layout, PositionEvaluator, Quantity,
    RowScene, SectionedLink, SweepLimits, TrajectorySample, all_columns, default_limits,
    unreachable_error,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::{BodyId, Coordinate, Guide, JointId, PositionError, Reaction, Vec2};
use dwell_kinetostatics::Model;
use dwell_scene::{CoordinateSweep, NamedCoordinate, PlaneScene, PrescribedMotion};
use std::borrow::Cow;

/// A point of the plane in space, m.
pub(crate) fn lifted(at: Vec2) -> [f64; 3] {
    [at.x, at.y, 0.0]
}

impl RowScene for PlaneScene {
    const LAYOUT: Layout = Layout {
        axes: &["x", "y"],
        turns: &[(2, "")],
        rotation: [
            (
                "angle",
                "angle of the body frame from the ground frame, unwrapped along the trajectory",
            ),
            ("angular_velocity", "angular velocity"),
            ("angular_acceleration", "angular acceleration"),
        ],
        unwraps_angles: true,
        shaking: &[("fx", "N"), ("fy", "N"), ("moment", "N m")],
        draws_paths: true,
    };

    /// The model with every reaction.
    type Rows = Model;

    type Evaluator<'a> = PositionEvaluator<'a>;

    fn rows(&self) -> Result<Model, StudyError> {
        loaded_model(self)
    }

    fn unloaded_rows(&self) -> Result<Model, StudyError> {
        compile_model(self, &self.mechanism.reactions())
    }

    fn model_of(model: &Model) -> &Model {
        model
    }

    fn pruned<'r>(&self, model: &'r Model) -> Cow<'r, Model> {
        match requested_bodies(self, model) {
            None => Cow::Borrowed(model),
            Some(bodies) => Cow::Owned(model.clone().pruned_for(&bodies)),
        }
    }

    fn modelled(model: &Model) -> Vec<bool> {
        model.plan().placed_bodies()
    }

    fn bodies_of(&self, model: &Model, quantity: Quantity) -> Vec<BodyId> {
        use Quantity as Q;
        let joint = |j: JointId| self.mechanism.joints[j.0].bodies.to_vec();
        let coordinate = |k: usize| match self.coordinates.get(k) {
            Some(named) => named.coordinate,
            None => Coordinate::Travel(JointId(k - self.coordinates.len())),
        };
        match quantity {
            Q::Measured(k, _) => match CoordinateFunction::find(&self.mechanism, coordinate(k)) {
                Some(
                    CoordinateFunction::Angle(bodies)
                    | CoordinateFunction::Travel(Guide { bodies, .. })
                    | CoordinateFunction::Length { bodies, .. },
                ) => bodies.to_vec(),
                None => Vec::new(),
            },
            Q::Rotation(body, ..)
            | Q::VelocityRatio(body)
            | Q::MechanicalAdvantage(body, _)
            | Q::Pole(body, ..)
            | Q::Point(body, ..) => vec![body],
            Q::KnownReaction(i, _) => vec![self.varying_inertias[i].body],
            Q::TransmissionAngle(dyad) => dyad.bodies().to_vec(),
            Q::Reaction(k) => joint(model.reactions()[k].joint),
            Q::BodyFrameForce(j, ..)
            | Q::ForceMagnitude(j)
            | Q::ForceDirection(j)
            | Q::MomentMagnitude(j) => joint(j),
            // What the actuators and the loads act on is placed anyway, or does not move them.
            Q::Time
            | Q::ActuatorCoordinate(..)
            | Q::ActuatorForce(_)
            | Q::ShakingForce(_)
            | Q::LeastDeterminant
            | Q::Power(_)
            | Q::LoadForce(_)
            | Q::LoadPower(_)
            | Q::Extra(_) => Vec::new(),
        }
    }

    fn evaluator<'a>(
        &'a self,
        whole: &'a Model,
        model: &'a Model,
        analysis: Analysis,
        columns: &[Column],
    ) -> Result<PositionEvaluator<'a>, StudyError> {
        PositionEvaluator::new(self, whole.plan(), model, analysis, columns)
    }

    fn unreachable(
        model: &Model,
        [before, sample]: [&TrajectorySample; 2],
    ) -> Option<PositionError> {
        let is_only = model.plan().actuators() == 1;
        is_only.then(|| unreachable_error(model.plan(), before.q[0], sample.q[0]))?
    }

    fn explain_stop(&self, model: &Model, stop: EarlyStop<'_>) -> StudyError {
        stop.in_plane(self, model.plan())
    }

    fn prescribed(&self) -> (Option<&PrescribedMotion>, Option<&CoordinateSweep>) {
        (self.prescribed.as_ref(), self.sweep.as_ref())
    }

    fn default_limits(&self, model: &Model) -> SweepLimits {
        default_limits(self, model.plan())
    }

    fn requests(&self) -> ColumnRequests<'_> {
        let requests = &self.requests;
        let paths = requests.paths.iter();
        ColumnRequests {
            variables: requests.variables.as_deref(),
            lists_reactions: requests.lists_reactions,
            paths: paths.map(|path| (path.body, lifted(path.at))).collect(),
            dwell: requests.dwell.as_ref().map(|dwell| dwell.body),
        }
    }

    fn with_drive_loads(&self) -> Result<Cow<'_, Self>, StudyError> {
        Ok(Cow::Owned(with_drive_loads(self)?))
    }

    const TO_DETERMINE: &'static str = "remove one of the redundant joints";

    fn open_reactions(&self, model: &Model) -> Vec<String> {
        let all = model.reactions().iter().enumerate();
        let open = all.filter(|&(k, _)| !model.plan().is_determinate(k));
        let names = open.map(|(_, reaction)| self.mechanism.reaction_name(*reaction));
        names.collect()
    }

    fn is_of_listed_reaction(&self, model: &Model, quantity: Quantity) -> bool {
        let listed = &self.requests.reactions;
        let is_listed_whole = |joint: JointId| {
            let components = self.mechanism.components(joint).iter();
            let mut reactions = components.map(|&component| Reaction { joint, component });
            reactions.all(|reaction| listed.contains(&reaction))
        };
        match quantity {
            Quantity::Reaction(k) => listed.contains(&model.reactions()[k]),
            Quantity::BodyFrameForce(joint, ..)
            | Quantity::ForceMagnitude(joint)
            | Quantity::ForceDirection(joint) => is_listed_whole(joint),
            Quantity::LoadForce(k) => {
                let teeth = self.loads[k].pressure_angle();
                teeth.is_some_and(|teeth| is_listed_whole(teeth.joint))
            }
            _ => false,
        }
    }

    fn sectioned_links(&self) -> Vec<SectionedLink> {
        let sections = self.requests.sections.iter();
        sections
            .map(|link| SectionedLink::new(self, link))
            .collect()
    }

    fn joint_names(&self) -> Vec<(&str, [&str; 2])> {
        let joints = self.mechanism.joints.iter();
        let named = joints.map(|joint| {
            let bodies = joint.bodies.map(|b| self.mechanism.body_name(b));
            (joint.name.as_str(), bodies)
        });
        named.collect()
    }

    fn named_coordinates(&self) -> &[NamedCoordinate] {
        &self.coordinates
    }

    fn travel(joint: JointId) -> Coordinate {
        Coordinate::Travel(joint)
    }

    fn actuator_meanings(&self, actuator: usize) -> [String; 2] {
        actuator_meanings(self, actuator)
    }

    fn add_body_columns(&self, model: &Model, body: BodyId, list: &mut ColumnList) {
        columns(self, model, list).body(body);
    }

    fn add_joint_columns(&self, model: &Model, list: &mut ColumnList) {
        let mut columns = columns(self, model, list);
        columns.dyads();
        columns.reactions(model.reactions());
        columns.known_reactions();
    }

    fn add_load_columns(&self, model: &Model, list: &mut ColumnList) {
        columns(self, model, list).loads();
    }
}

fn columns<'a>(
    scene: &'a PlaneScene,
    model: &'a Model,
    list: &'a mut ColumnList,
) -> PlaneColumns<'a> {
    PlaneColumns {
        scene,
        plan: model.plan(),
        list,
    }
}

/// The bodies that the requests of a scene need; `None` if no `variables` are named, so that every
/// column is computed.
pub(crate) fn requested_bodies(scene: &PlaneScene, model: &Model) -> Option<Vec<BodyId>> {
    let requests = &scene.requests;
    let named = scene.requests();
    named.variables?;
    let mut bodies: Vec<BodyId> = requests.paths.iter().map(|p| p.body).collect();
    bodies.extend(requests.dwell.iter().map(|d| d.body));
    bodies.extend(requests.sections.iter().map(|s| s.body));
    // A scene that names no reactions requests all of them.
    if requests.reactions.len() < scene.mechanism.reactions().len() {
        bodies.extend(requested_reaction_bodies(scene));
    }
    let columns = all_columns(scene, model, true);
    let columns = columns.iter().filter(|column| named.name(column));
    bodies.extend(columns.flat_map(|column| scene.bodies_of(model, column.quantity)));
    Some(bodies)
}

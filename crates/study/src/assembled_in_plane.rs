//! An assembled mechanism in the plane.

use crate::assembled::{
    AskedScene, AssembledModel, BodyStates, FoundStates, NamedPoints, UnitModels,
};
use crate::explain::StudyError;
use crate::free_motion::compute::{FreeMotionProblem, MotionProblem as _, motion_to_simulate};
use crate::models::{compile_model, loaded_model, reduced_model, with_loads};
use dwell_dynamics::{DynamicsError, Machine};
use dwell_geometry::body_states::{BodyStates as PlaneStates, CoordinateFunction};
use dwell_geometry::{BodyId, PositionError, Reaction, Vec2};
use dwell_kinetostatics::{Batch, ExactModel, InverseDynamics, Model};
use dwell_scene::PlaneScene;

impl AskedScene for PlaneScene {
    const DIMENSION: usize = 2;

    fn assembled(&self) -> Result<AssembledModel<Self>, StudyError> {
        let model = loaded_model(self)?;
        let all = self.mechanism.reactions().into_iter().enumerate();
        let place = |k: usize| model.plan().is_determinate(k).then_some(k);
        let reactions = all.map(|(k, reaction)| (reaction, place(k))).collect();
        Ok(AssembledModel { model, reactions })
    }

    fn unit_models(&self, reactions: &[Reaction]) -> Result<UnitModels<Model>, StudyError> {
        let loaded = if self.loads.is_empty() {
            None
        } else {
            Some(with_loads(self, compile_model(self, reactions)?)?)
        };
        Ok(UnitModels {
            exact: reduced_model(self, reactions)?,
            loaded,
        })
    }

    fn inertial_batch(exact: &ExactModel, q: &[f64], batch: &mut Batch) {
        exact.reduce_batch(q, batch);
    }

    fn motion_machine(&self) -> Result<(Machine, Vec<f64>), StudyError> {
        let spec = motion_to_simulate(self, self.motion.as_ref())?;
        let problem = FreeMotionProblem::new(self, self, spec)?;
        let start = problem.initial_state().y;
        Ok((problem.machine, start))
    }

    fn named_points(&self) -> Vec<(&str, NamedPoints<'_>)> {
        let bodies = self.mechanism.bodies.iter().zip(&self.points);
        let named = bodies.map(|(body, points)| {
            let points = points.iter();
            let points = points.map(|(name, at)| (name.as_str(), [at.x, at.y, 0.0]));
            (body.name.as_str(), points.collect())
        });
        named.collect()
    }

    fn coordinate_names(&self) -> Vec<&str> {
        self.all_coordinates().map(|(name, _)| name).collect()
    }

    fn load_names(&self) -> Vec<&str> {
        self.loads.iter().map(|load| load.name.as_str()).collect()
    }

    fn assembly_coordinates(&self) -> &[f64] {
        &self.assembly.coordinates
    }

    fn paths(
        &self,
        model: &Model,
        points: &[(usize, [f64; 3])],
        q: &[f64],
    ) -> Result<Vec<[f64; 3]>, PositionError> {
        let plan = model.plan();
        let (mut pose, at_rest) = (plan.pose(), plan.motion());
        let mut bodies = PlaneStates::new(plan);
        let positions = q.chunks_exact(plan.actuators());
        let mut paths = Vec::with_capacity(points.len() * positions.len());
        for q in positions {
            plan.positions(q, &mut pose)?;
            bodies.fill_velocities(plan, &pose, &at_rest);
            paths.extend(points.iter().map(|&(body, [x, y, _])| {
                let at = bodies.point(BodyId(body), Vec2 { x, y }).position;
                [at.x, at.y, 0.0]
            }));
        }
        Ok(paths)
    }

    fn joint_of(&self, reaction: Reaction) -> &str {
        &self.mechanism.joints[reaction.joint.0].name
    }

    fn body_states(
        &self,
        model: &Model,
        [q, q_dot, q_ddot]: [&[f64]; 3],
    ) -> Result<FoundStates, DynamicsError> {
        let mut workspace = model.workspace();
        let mut state = model.kinematic_state(q, q_dot, &mut workspace)?;
        Ok(found(self, state.bodies_at(q_ddot)))
    }

    fn loaded_states(
        &self,
        model: &Model,
        t: f64,
        [q, q_dot, q_ddot]: [&[f64]; 3],
        forces: &mut InverseDynamics<f64>,
    ) -> Result<FoundStates, DynamicsError> {
        let mut workspace = model.workspace();
        let state = model.kinetostatics(t, q, q_dot, q_ddot, &mut workspace, forces)?;
        Ok(found(self, state.bodies()))
    }
}

fn found(scene: &PlaneScene, bodies: &PlaneStates) -> FoundStates {
    let functions = scene.all_coordinates();
    let functions = functions.map(|(_, c)| CoordinateFunction::find(&scene.mechanism, c));
    let missing = "no joint of the mechanism has it";
    let value = |of: Option<CoordinateFunction>| Ok(bodies.coordinate(of.ok_or(missing)?));
    (Box::new(bodies.clone()), functions.map(value).collect())
}

impl BodyStates for PlaneStates {
    fn point(&self, body: usize, [x, y, _]: [f64; 3]) -> [[f64; 3]; 3] {
        let at = self.point(BodyId(body), Vec2 { x, y });
        [at.position, at.velocity, at.acceleration].map(|v| [v.x, v.y, 0.0])
    }

    fn axes(&self, body: usize) -> [[f64; 3]; 3] {
        let Vec2 { x, y } = self.body(BodyId(body)).rotation;
        [[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]]
    }

    fn turning(&self, body: usize) -> [[f64; 3]; 2] {
        let state = self.body(BodyId(body));
        [state.angular_velocity, state.angular_acceleration].map(|z| [0.0, 0.0, z])
    }

    fn angle(&self, body: usize) -> Option<f64> {
        let state = self.body(BodyId(body));
        let direction = state.rotation;
        Some(
            state
                .angle
                .unwrap_or_else(|| direction.y.atan2(direction.x)),
        )
    }
}

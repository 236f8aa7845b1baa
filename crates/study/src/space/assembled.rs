//! An assembled mechanism in space.

use super::explain::{explain_load_error, with_loads};
use super::motion::SpaceMotionProblem;
use super::prepared::{PreparedSpaceScene, compile, sort_reactions};
use crate::assembled::{
    AskedScene, AssembledModel, BodyStates, FoundStates, NamedPoints, UnitModels,
};
use crate::explain::StudyError;
use crate::free_motion::compute::MotionProblem as _;
use dwell_dynamics::{DynamicsError, Machine};
use dwell_geometry::PositionError;
use dwell_geometry::space::{BodyMotion, Placement, Vec3, vec3};
use dwell_kinetostatics::space::{Model, Reaction};
use dwell_kinetostatics::{ExactModel, InverseDynamics, MachineModel as _};
use dwell_scene::SpaceScene;

impl AskedScene for SpaceScene {
    const DIMENSION: usize = 3;

    fn assembled(&self) -> Result<AssembledModel<Self>, StudyError> {
        let all = with_loads(self, compile(self, &self.requests.reactions)?)?;
        let [determined, _] = sort_reactions(self, &all)?;
        let model = with_loads(self, compile(self, &determined)?)?;
        let place = |reaction: &Reaction| determined.iter().position(|known| known == reaction);
        let requested = self.requests.reactions.iter();
        let reactions = requested.map(|r| (*r, place(r))).collect();
        Ok(AssembledModel { model, reactions })
    }

    fn unit_models(&self, reactions: &[Reaction]) -> Result<UnitModels<Model>, StudyError> {
        let model = compile(self, reactions)?.with_loads(self.loads.clone());
        let model = model.map_err(|error| explain_load_error(self, &error))?;
        let model = model.for_unit_loads();
        let loaded = (!self.loads.is_empty()).then(|| model.clone());
        match ExactModel::new(model) {
            Some(exact) => Ok(UnitModels { exact, loaded }),
            // Its error names the actuators.
            None => Err(match PreparedSpaceScene::new(self) {
                Err(error) => error,
                Ok(_) => self
                    .error("the reduced model needs one actuator".to_owned(), None, &[])
                    .into(),
            }),
        }
    }

    fn motion_machine(&self) -> Result<(Machine<Model>, Vec<f64>), StudyError> {
        let problem = SpaceMotionProblem::new(self)?;
        let start = problem.initial_state().y;
        Ok((problem.machine, start))
    }

    fn named_points(&self) -> Vec<(&str, NamedPoints<'_>)> {
        let bodies = self.mechanism.bodies.iter().zip(&self.points);
        let named = bodies.map(|(body, points)| {
            let points = points.iter();
            let points = points.map(|(name, at)| (name.as_str(), numbers(*at)));
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
        &self.assembly.q
    }

    fn paths(
        &self,
        model: &Model,
        points: &[(usize, [f64; 3])],
        q: &[f64],
    ) -> Result<Vec<[f64; 3]>, PositionError> {
        let plan = model.plan();
        let mut pose = plan.pose();
        let positions = q.chunks_exact(plan.actuators());
        let mut paths = Vec::with_capacity(points.len() * positions.len());
        for q in positions {
            plan.positions(q, &mut pose)?;
            let at = |&(body, [x, y, z]): &(usize, [f64; 3])| {
                let placement = plan.placement(&pose, body);
                numbers(placement.position + placement.rotation.apply(vec3(x, y, z)))
            };
            paths.extend(points.iter().map(at));
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
        let plan = model.plan();
        let mut pose = plan.pose();
        plan.positions(q, &mut pose)?;
        plan.velocities(q_dot, &mut pose);
        plan.accelerations(q_ddot, &mut pose);
        let bodies = 0..self.mechanism.bodies.len();
        let bodies = bodies.map(|b| (plan.placement(&pose, b), plan.body_motion(&pose, b)));
        let value = |of| Ok(plan.coordinate(&pose, model.coordinate_function(of)?));
        let coordinates = self.all_coordinates().map(|(_, c)| value(c)).collect();
        Ok((Box::new(SpaceStates(bodies.collect())), coordinates))
    }

    fn loaded_states(
        &self,
        model: &Model,
        t: f64,
        motion: [&[f64]; 3],
        forces: &mut InverseDynamics<f64>,
    ) -> Result<FoundStates, DynamicsError> {
        let found = self.body_states(model, motion)?;
        model.kinetostatics(t, motion, &mut model.workspace(), forces)?;
        Ok(found)
    }
}

/// The states of all bodies.
#[derive(Debug, Clone)]
pub(super) struct SpaceStates(pub(super) Vec<(Placement, BodyMotion)>);

fn numbers(v: Vec3) -> [f64; 3] {
    [v.x, v.y, v.z]
}

impl BodyStates for SpaceStates {
    fn point(&self, body: usize, [x, y, z]: [f64; 3]) -> [[f64; 3]; 3] {
        let (placement, motion) = &self.0[body];
        let arm = placement.rotation.apply(vec3(x, y, z));
        let velocity = motion.point_velocity(arm);
        let acceleration = motion.point_acceleration(arm);
        [placement.position + arm, velocity, acceleration].map(numbers)
    }

    fn axes(&self, body: usize) -> [[f64; 3]; 3] {
        self.0[body].0.rotation.columns.map(numbers)
    }

    fn turning(&self, body: usize) -> [[f64; 3]; 2] {
        let motion = &self.0[body].1;
        [motion.angular_velocity, motion.angular_acceleration].map(numbers)
    }

    fn angle(&self, _: usize) -> Option<f64> {
        None
    }
}

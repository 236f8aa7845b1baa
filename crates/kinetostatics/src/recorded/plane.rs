//! The recording of a state of a planar machine.

use super::{
    Described, Numbered, RecordableModel, StateInputs, StateRecordingError, first_order,
    signal_coordinates,
};
use crate::error::PositionResult;
use crate::load::{ForceSource, LoadKind, LoadPlaces, LoadState};
use crate::mass::Mass;
use crate::model::{Model, Workspace};
use crate::pass::{GivenMotion, InverseDynamics, PassModel, RecursivePass};
use dwell_geometry::body_states::{BodyStates, CoordinateFunction};
use dwell_geometry::{BodyId, Mechanism, Plan, Vec2};
use dwell_numerics::{Constant, RecordedNumber, Scalar};
use std::sync::Arc;

impl Model {
    /// The force on the ground and its moment about the origin: the loads less the rate of change of momentum.
    fn shaking(
        &self,
        weighted: &[(BodyId, Mass<RecordedNumber>)],
        states: &BodyStates<RecordedNumber, RecordedNumber>,
        loads: &LoadState<RecordedNumber>,
    ) -> [RecordedNumber; 3] {
        let zero = RecordedNumber::default();
        let (mut force, mut moment) = (Vec2::zero(), zero);
        for wrench in &loads.wrenches {
            let body = states.body(wrench.body);
            let at = states.origin().cast() + body.joint_origin + wrench.moment_arm;
            force += wrench.force;
            moment += at.cross(wrench.force) + wrench.couple;
        }
        for (body, mass) in weighted {
            let center = states.point(*body, mass.center);
            let rate = center.acceleration * mass.mass;
            let angular = states.body(*body).angular_acceleration;
            force += -rate;
            moment -= center.position.cross(rate) + mass.inertia * angular;
        }
        for varying in &self.pass_model.varying_inertias {
            let body = states.body(BodyId(varying.body));
            let ([inertia, half_slope], w) = (varying.at(body.rotation), body.angular_velocity);
            moment -= inertia * body.angular_acceleration + half_slope * w * w;
        }
        [force.x, force.y, moment]
    }

    /// The coordinates that are wanted, as functions.
    fn wanted_functions(of: Described<'_, Self>) -> Option<Vec<CoordinateFunction>> {
        let coordinates = of.wanted.coordinates.iter();
        let found = coordinates.map(|&c| CoordinateFunction::find(of.mechanism, c));
        found.collect()
    }
}

/// The moving bodies, with their masses.
fn weighted<C: Constant>(plan: &Plan<C>, masses: &[Mass<C>]) -> Vec<(BodyId, Mass<C>)> {
    let moving = plan.moving_bodies().iter().map(|moving| moving.body);
    let weighted = moving.filter_map(|body| Some((BodyId(body), *masses.get(body)?)));
    weighted.collect()
}

/// Adds the forces and moments of loads on all bodies, with the inputs of their magnitudes and with their numbers.
fn add_loads(
    of: Described<'_, Model>,
    mut magnitudes: impl Iterator<Item = RecordedNumber>,
    next: &mut impl FnMut(f64) -> RecordedNumber,
    weighted_bodies: &[(BodyId, Mass<RecordedNumber>)],
    states: &BodyStates<RecordedNumber, RecordedNumber>,
    loads: &mut LoadState<RecordedNumber>,
) -> Result<(), StateRecordingError> {
    for (k, load) in of.loads.iter().enumerate() {
        let kind: LoadKind<RecordedNumber> = load.kind.replaced(next);
        let signals = signal_coordinates(&load.magnitude).map(|(coordinate, is_velocity)| {
            let function = CoordinateFunction::find(of.mechanism, coordinate);
            let function = function.ok_or(StateRecordingError::Structure)?;
            let motion = states.coordinate(function.replaced(next));
            Ok(motion[usize::from(is_velocity)])
        });
        let magnitude = first_order(&mut magnitudes, signals)?;
        // A couple has the same effect at each point.
        let places = LoadPlaces {
            weighted_bodies,
            couple_points: [Vec2::zero(); 2],
        };
        kind.add_wrenches(magnitude, ForceSource::Load(k), &places, states, loads)
            .ok_or(StateRecordingError::NoDirection(k))?;
    }
    loads.sum_by_body();
    Ok(())
}

impl RecordableModel for Model {
    type Mechanism = Mechanism;
    type Mass = Mass;
    type Point = Vec2;

    fn numbers(&self, of: Described<'_, Self>) -> Option<Vec<f64>> {
        let mut numbers = self.plan().dimensions(of.mechanism)?;
        of.masses.iter().for_each(|mass| mass.list(&mut numbers));
        for load in of.loads {
            load.kind.list(&mut numbers);
            for (coordinate, _) in signal_coordinates(&load.magnitude) {
                CoordinateFunction::find(of.mechanism, coordinate)?.list(&mut numbers);
            }
        }
        for function in Self::wanted_functions(of)? {
            function.list(&mut numbers);
        }
        (of.wanted.points.iter()).for_each(|(_, point)| point.list(&mut numbers));
        Some(numbers)
    }

    fn at_numbers(&self, of: Described<'_, Self>) -> Option<Self> {
        let mut model = self.clone();
        let dimensions = model.plan().dimensions(of.mechanism)?;
        let fits = model.pass_model.set_numbers(&dimensions, of.masses);
        (model.mechanism, model.masses) = (Arc::new(of.mechanism.clone()), of.masses.to_vec());
        fits.then_some(model)
    }

    fn solution(&self, q: &[f64], workspace: &mut Workspace<f64>) -> PositionResult<Vec<f64>> {
        self.plan().positions(q, &mut workspace.pose)?;
        Ok(self.plan().iterated_values(&workspace.pose))
    }

    fn outputs(
        &self,
        of: Described<'_, Self>,
        at: &StateInputs<'_>,
    ) -> Result<Vec<RecordedNumber>, StateRecordingError> {
        let (dimensions, rest) = at.numbers.split_at(self.plan().dimension_count());
        let mut rest = rest.iter().copied();
        let mut next = |value: f64| rest.next().unwrap_or(Scalar::from_f64(value));
        let masses: Vec<Mass<RecordedNumber>> = of
            .masses
            .iter()
            .map(|mass| mass.replaced(&mut next))
            .collect();
        let mut model: PassModel<RecordedNumber> = self.pass_model.lifted();
        if !model.set_numbers(dimensions, &masses) {
            return Err(StateRecordingError::Structure);
        }
        let plan = &model.plan;
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        plan.positions_at_solution(at.q, at.solution, &mut pose)?;
        plan.velocities(&pose, at.q_dot, &mut motion);
        plan.accelerations(&pose, at.q_ddot, &mut motion);
        let mut states: BodyStates<RecordedNumber, RecordedNumber> = BodyStates::new(plan);
        states.fill(plan, &pose, &motion);
        let mut loads = self.loads.state::<RecordedNumber>(self.plan());
        let (magnitudes, weighted) = (at.magnitudes.iter().copied(), weighted(plan, &masses));
        add_loads(of, magnitudes, &mut next, &weighted, &states, &mut loads)?;
        let mut pass = RecursivePass::new(&model);
        pass.evaluate_loaded(&model, &pose, GivenMotion(&motion), &mut loads);
        let mut result = InverseDynamics::buffer(plan.actuators(), self.reactions().len());
        result.read_from(&model, &pose, &pass);
        let mut outputs = [result.tau, result.reactions].concat();
        let functions = Self::wanted_functions(of).ok_or(StateRecordingError::Structure)?;
        for function in functions {
            outputs.extend(states.coordinate(function.replaced(&mut next)));
        }
        for (body, point) in &of.wanted.points {
            let point = states.point(*body, point.replaced(&mut next));
            let vectors = [point.position, point.velocity, point.acceleration];
            outputs.extend(vectors.into_iter().flat_map(|v| [v.x, v.y]));
        }
        outputs.extend(self.shaking(&weighted, &states, &loads));
        Ok(outputs)
    }
}

//! Recursive inverse dynamics without loads or with them: the accelerations of all bodies, their inertia forces
//! carried down the spanning tree, the multipliers of the groups, and from these the actuators' actions and the
//! reactions.
//!
//! A pass depends on a [`PassModel`] only; the computations of a model with it are in [`crate::model`].

mod acceleration;
mod bodies;
mod recursive_pass;
mod replaced_vectors;
mod sources;

pub(crate) use acceleration::{AtRest, GivenMotion, UnitAcceleration, UnitMotions};
pub(crate) use bodies::{AcceleratedBody, InertialBody};
pub use recursive_pass::InverseDynamics;
pub(crate) use recursive_pass::RecursivePass;
pub(crate) use sources::ReactionSources;

use crate::mass::Mass;
use crate::varying_inertia::FrameInertia;
use dwell_geometry::{Mechanism, Plan, Vec2};
use dwell_numerics::{Constant, Lift};
use replaced_vectors::{replace_vector, vector_to};

/// The parts of a model that a pass reads: the plan, the inertia of the bodies, and the sources of the reactions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PassModel<C = f64> {
    pub(crate) plan: Plan<C>,
    pub(crate) inertial_bodies: Vec<InertialBody<C>>,
    /// The bodies whose origins move and that carry mass, each after the one that carries it.
    pub(crate) accelerated_bodies: Vec<AcceleratedBody<C>>,
    /// By frame: moment of inertia of its bodies about their origins, kg m².
    frame_inertia: Vec<C>,
    /// The bodies whose moment of inertia is a function of their angle; in most mechanisms none.
    pub(crate) varying_inertias: Vec<FrameInertia>,
    pub(crate) reaction_sources: ReactionSources<C>,
}

impl PassModel {
    /// A pass without reactions, for one mass per body.
    pub(crate) fn new(mechanism: &Mechanism, plan: Plan, masses: &[Mass]) -> Self {
        let origin_moves = bodies::moving_origins(&plan);
        let inertial_bodies = bodies::inertial_bodies(&plan, &origin_moves, masses);
        let mut frame_inertia = vec![0.0; plan.frames().frames.len()];
        for body in &inertial_bodies {
            frame_inertia[body.frame] += body.inertia_about_joint;
        }
        Self {
            accelerated_bodies: bodies::accelerated_bodies(&plan, &origin_moves, &inertial_bodies),
            inertial_bodies,
            frame_inertia,
            varying_inertias: Vec::new(),
            reaction_sources: ReactionSources::compile(mechanism, &plan, &[]),
            plan,
        }
    }

    /// The same with dimensions (m) and masses (kg) in another type: constants of it, until
    /// [`set_masses`](PassModel::set_masses) makes them what an evaluation depends on.
    pub(crate) fn lifted<C: Constant>(&self) -> PassModel<C> {
        let inertial = |body: &InertialBody| InertialBody {
            moving_body: body.moving_body,
            body: body.body,
            frame: body.frame,
            mass: C::lift(body.mass),
            inertia: C::lift(body.inertia),
            inertia_about_joint: C::lift(body.inertia_about_joint),
            first_moment: body.first_moment.map(Vec2::cast),
            fixed_origin: body.fixed_origin,
        };
        let accelerated = |body: &AcceleratedBody| AcceleratedBody {
            moving_body: body.moving_body,
            frame: body.frame,
            parent: body.parent,
            joint_vector: body.joint_vector,
            slide: body.slide,
            mass: C::lift(body.mass),
            first_moment: body.first_moment.map(Vec2::cast),
        };
        PassModel {
            plan: self.plan.lifted(),
            inertial_bodies: self.inertial_bodies.iter().map(inertial).collect(),
            accelerated_bodies: self.accelerated_bodies.iter().map(accelerated).collect(),
            frame_inertia: self.frame_inertia.iter().map(|&i| C::lift(i)).collect(),
            varying_inertias: self.varying_inertias.clone(),
            reaction_sources: self.reaction_sources.lifted(),
        }
    }
}

impl<C: Constant> PassModel<C> {
    /// Sets other masses, and takes over the dimensions of its plan. Returns false if the structure has no place for
    /// them: for the mass of a massless body, or for a centre of mass away from an origin.
    pub(crate) fn set_masses(&mut self, masses: &[Mass<C>]) -> bool {
        let mut fits = true;
        let mut with_mass = 0;
        self.frame_inertia.fill(C::from_f64(0.0));
        let mut accelerated = self.accelerated_bodies.iter_mut().peekable();
        for body in &mut self.inertial_bodies {
            let Mass {
                mass,
                center,
                inertia,
            } = masses[body.body];
            with_mass += usize::from(mass.value() > 0.0 || inertia.value() > 0.0);
            let to_center = vector_to(&self.plan, body.body, center);
            // Its inertia force has to have a place where its origin moves.
            let mut has_place = mass.value() == 0.0 || body.fixed_origin;
            fits &= replace_vector(&mut body.first_moment, to_center * mass);
            (body.mass, body.inertia) = (mass, inertia);
            body.inertia_about_joint = inertia + mass * to_center.dot(to_center);
            self.frame_inertia[body.frame] += body.inertia_about_joint;
            // Both are in the order of the tree.
            while let Some(other) = accelerated.next_if(|a| a.moving_body <= body.moving_body) {
                if other.moving_body == body.moving_body {
                    (other.mass, other.first_moment) = (body.mass, body.first_moment);
                    has_place = true;
                }
            }
            fits &= has_place;
        }
        let given = masses
            .iter()
            .filter(|m| m.mass.value() > 0.0 || m.inertia.value() > 0.0);
        fits && given.count() == with_mass
    }
}

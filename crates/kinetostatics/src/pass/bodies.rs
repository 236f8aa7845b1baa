//! The inertia of the bodies, in the order of the spanning tree.

use super::replaced_vectors::vector_to;
use crate::mass::Mass;
use dwell_geometry::plan::MovingBody;
use dwell_geometry::{Plan, Vec2};

/// A moving body that has inertia.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InertialBody<C = f64> {
    pub(crate) moving_body: usize,
    pub(crate) body: usize,
    pub(crate) frame: usize,
    pub(crate) mass: C,
    /// About the centre of mass, and about the body's origin, kg m².
    pub(crate) inertia: C,
    pub(crate) inertia_about_joint: C,
    /// Mass times the vector from the body's origin to its centre of mass, in its frame, kg m; none if zero.
    pub(crate) first_moment: Option<Vec2<C>>,
    /// Whether its origin is fixed to the ground.
    pub(crate) fixed_origin: bool,
}

/// A body whose origin moves, with the data of its inertia force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AcceleratedBody<C = f64> {
    pub(crate) moving_body: usize,
    pub(crate) frame: usize,
    /// The accelerated body that carries it; `None` if the origin of its carrier is fixed.
    pub(crate) parent: Option<usize>,
    /// The vector from its carrier's origin to its joint, with the frame that turns it.
    pub(crate) joint_vector: Option<(usize, usize)>,
    /// The slide that carries it, and the index of its direction.
    pub(crate) slide: Option<(usize, usize)>,
    /// Mass of the body alone, kg.
    pub(crate) mass: C,
    /// First moment of the body about its origin, in its frame, kg m; none if zero.
    pub(crate) first_moment: Option<Vec2<C>>,
}

/// By moving body: whether its origin moves.
pub(super) fn moving_origins(plan: &Plan) -> Vec<bool> {
    let mut origin_moves: Vec<bool> = Vec::with_capacity(plan.moving_bodies().len());
    for body in plan.moving_bodies() {
        let parent_moves = body.parent.is_some_and(|parent| origin_moves[parent]);
        origin_moves.push(parent_moves || body.joint_vector.is_some() || body.slide.is_some());
    }
    origin_moves
}

/// The moving bodies that have mass or inertia.
pub(super) fn inertial_bodies(
    plan: &Plan,
    origin_moves: &[bool],
    masses: &[Mass],
) -> Vec<InertialBody> {
    let inertial_body = |(i, body): (usize, &MovingBody)| {
        let given = masses.get(body.body).copied().unwrap_or_default();
        let (mass, inertia) = (given.mass, given.inertia);
        let to_center = vector_to(plan, body.body, given.center);
        let offset = Some(to_center).filter(|&local| local != Vec2::ZERO && mass > 0.0);
        (mass > 0.0 || inertia > 0.0).then(|| InertialBody {
            moving_body: i,
            body: body.body,
            frame: body.frame,
            mass,
            inertia_about_joint: inertia + offset.map_or(0.0, |r| mass * r.dot(r)),
            inertia,
            first_moment: offset.map(|r| r * mass),
            fixed_origin: !origin_moves[i],
        })
    };
    let bodies = plan.moving_bodies().iter().enumerate();
    bodies.filter_map(inertial_body).collect()
}

/// The bodies whose inertia forces must be carried down the tree: those whose origins move, if they or the bodies
/// that they carry have mass.
pub(super) fn accelerated_bodies(
    plan: &Plan,
    origin_moves: &[bool],
    inertial_bodies: &[InertialBody],
) -> Vec<AcceleratedBody> {
    let moving_bodies = plan.moving_bodies();
    // By moving body: mass and first moment.
    let mut own = vec![(0.0, None); moving_bodies.len()];
    for body in inertial_bodies {
        own[body.moving_body] = (body.mass, body.first_moment);
    }
    let mut has_subtree_mass: Vec<bool> = own.iter().map(|&(mass, _)| mass > 0.0).collect();
    for (i, body) in moving_bodies.iter().enumerate().rev() {
        if let (true, Some(parent)) = (has_subtree_mass[i], body.parent) {
            has_subtree_mass[parent] = true;
        }
    }
    let mut accelerated_bodies: Vec<AcceleratedBody> = Vec::new();
    let mut index = vec![None; moving_bodies.len()];
    for (i, body) in moving_bodies.iter().enumerate() {
        if origin_moves[i] && has_subtree_mass[i] {
            index[i] = Some(accelerated_bodies.len());
            accelerated_bodies.push(AcceleratedBody {
                moving_body: i,
                frame: body.frame,
                parent: body.parent.and_then(|parent| index[parent]),
                joint_vector: body.joint_vector.map(|vector| (vector, body.parent_frame)),
                slide: body.slide,
                mass: own[i].0,
                first_moment: own[i].1,
            });
        }
    }
    accelerated_bodies
}

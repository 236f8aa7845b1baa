//! The actions of reactions and actuators on bodies: forces at points and couples, from the definitions of the reactions and the
//! positions of the bodies, never from the rows.

use crate::pose::Pose;
use crate::rows::coupling::Coupling;
use crate::rows::terms::{Ends, Term, perpendicular};
use crate::wrenches::BodyWrench;
use dwell_geometry::BodyId;
use dwell_geometry::space::Vec3;

/// A direction.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Direction {
    Ground(Vec3),
    /// Fixed in a body.
    Body(usize, Vec3),
    /// The direction from the first point to the second.
    Line(Ends),
}

/// The action of a unit of a reaction or of an actuator's force, of the first body on the second.
#[derive(Debug, Clone)]
pub(crate) enum Action {
    Force {
        bodies: [usize; 2],
        along: Direction,
        /// A point of a body.
        at: (usize, Vec3),
        /// The vector from there to the point of application, fixed in a body.
        offset: (usize, Vec3),
    },
    Couple {
        bodies: [usize; 2],
        about: Direction,
    },
    /// The tooth force of two gears in the plane: it turns the second counter-clockwise.
    Tooth {
        centers: Ends,
        /// Pitch radius of the second, m.
        radius: f64,
        /// Whether the pitch point is beyond the second centre.
        beyond: bool,
    },
    /// A force along one coordinate of a law, with the reaction along the other: their works cancel.
    Coupled {
        dependent: Box<Action>,
        independent: Box<Action>,
        coupling: Box<Coupling>,
        /// The share of the second, if the first is a component of the action along one direction: a product of both.
        share: Option<[Direction; 2]>,
    },
}

impl Direction {
    fn vector(self, poses: &[Pose]) -> Vec3 {
        match self {
            Self::Ground(v) => v,
            Self::Body(body, v) => poses[body].rotation.apply(v),
            Self::Line(ends) => {
                let d = Self::gap(ends, poses);
                d.scaled(1.0 / d.norm())
            }
        }
    }

    fn gap(ends: Ends, poses: &[Pose]) -> Vec3 {
        let [from, to] = [0, 1].map(|k| poses[ends.bodies[k]].point(ends.points[k]));
        to - from
    }
}

impl Action {
    /// A force along a direction on the second body of two, at the second point.
    pub(crate) fn force(ends: Ends, along: Direction) -> Self {
        let second = ends.bodies[1];
        Self::Force {
            bodies: ends.bodies,
            along,
            at: (second, ends.points[1]),
            offset: (second, Vec3::ZERO),
        }
    }

    /// The forces of so much of it on bodies.
    pub(crate) fn wrenches(&self, poses: &[Pose], value: f64) -> Vec<BodyWrench> {
        let pair = |bodies: &[usize; 2], force: Vec3, point: Vec3, couple: Vec3| {
            BodyWrench::pair(bodies.map(BodyId), force, point, couple).to_vec()
        };
        match self {
            Self::Force {
                bodies,
                along,
                at,
                offset,
            } => {
                let point = poses[at.0].point(at.1) + poses[offset.0].rotation.apply(offset.1);
                let force = along.vector(poses).scaled(value);
                pair(bodies, force, point, Vec3::ZERO)
            }
            Self::Couple { bodies, about } => {
                let couple = about.vector(poses).scaled(value);
                pair(bodies, Vec3::ZERO, Vec3::ZERO, couple)
            }
            Self::Tooth {
                centers,
                radius,
                beyond,
            } => {
                // The pitch point is a radius from both centres: between them, or beyond the centre of the smaller one of an
                // internal pair.
                let line = Direction::Line(*centers).vector(poses);
                let outwards = if *beyond { line } else { -line };
                let second = poses[centers.bodies[1]].point(centers.points[1]);
                let force = perpendicular(outwards).scaled(value);
                pair(
                    &centers.bodies,
                    force,
                    second + outwards.scaled(*radius),
                    Vec3::ZERO,
                )
            }
            Self::Coupled {
                dependent,
                independent,
                coupling,
                share,
            } => {
                let [slope, _] = coupling.slopes(poses);
                let product = |[a, b]: &[Direction; 2]| a.vector(poses).dot(b.vector(poses));
                let share = share.as_ref().map_or(1.0, product);
                let mut all = dependent.wrenches(poses, value);
                all.extend(independent.wrenches(poses, -slope * share * value));
                all
            }
        }
    }

    /// Changes the points, which are given with their bodies.
    pub(crate) fn each_point(&mut self, change: &mut impl FnMut(usize, &mut Vec3)) {
        let mut of_ends = |ends: &mut Ends| {
            for (body, point) in ends.bodies.into_iter().zip(&mut ends.points) {
                change(body, point);
            }
        };
        match self {
            Self::Force { along, at, .. } => {
                if let Direction::Line(ends) = along {
                    of_ends(ends);
                }
                change(at.0, &mut at.1);
            }
            Self::Couple { about, .. } => {
                if let Direction::Line(ends) = about {
                    of_ends(ends);
                }
            }
            Self::Tooth { centers, .. } => of_ends(centers),
            Self::Coupled {
                dependent,
                independent,
                coupling,
                share,
            } => {
                for ends in coupling.both.iter_mut().filter_map(Term::ends_mut) {
                    of_ends(ends);
                }
                for direction in share.iter_mut().flatten() {
                    if let Direction::Line(ends) = direction {
                        of_ends(ends);
                    }
                }
                dependent.each_point(change);
                independent.each_point(change);
            }
        }
    }
}

//! The closures of loops: each joint outside the tree takes freedoms away, and each of these is a row of one of a few kinds,
//! with d = p_b − p_a:
//!
//! ```text
//! Point        e_k·d = 0        Parallel   n_a·w_b = 0        Along, InPlane   u_a·d = 0        Length   |d| = L
//! ```
//!
//! The gradient of a row is a wrench on the second body, a force f at its point and a couple m; the opposite acts on the
//! first body.

use super::coupling::Coupled;
use super::frames::{BodyMotion, Frame};
use super::joint_kinds::{Condition, CouplingAction, JointKind};
use super::mechanism::{Mechanism, Side};
use super::plan::Pose;
use super::tree::Tree;
use super::vector::Vec3;
use super::wrench::Wrench;
use crate::error::StructureError;
use crate::mechanism::JointId;
use dwell_numerics::{Constant, Lift, Scalar, map_array};
use std::ops::Range;

/// The condition of a row. Directions are in the internal frames of the bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RowKind<C = f64> {
    /// The points coincide along this axis of the ground.
    Point(usize),
    /// The points coincide along this direction of the first body.
    Along(Vec3<C>),
    /// A direction of the first body is at right angles to one of the second.
    Parallel(Vec3<C>, Vec3<C>),
    /// The second point lies in a plane of the first body through its point.
    InPlane(Vec3<C>),
    /// The points keep this distance, m.
    Length(C),
    /// The points have the distance that an actuator gives, the coordinate of this number.
    Driven(usize),
    /// The second body moves at the point as the first does along this direction of the carrier. Its residual is a sum over the freedoms
    /// of its path, by [`Closure::ratios`].
    Mesh(Vec3<C>),
    /// The second body, between two balls, does not turn about their line.
    NoSpin(Vec3<C>),
    /// Two coordinates are [coupled](super::coupling), with the axis of the first body along which it acts. Its residual and its
    /// derivatives are those of the closure's law.
    Coupled(CouplingAction, Vec3<C>),
}

impl<C: Copy> RowKind<C> {
    /// Whether its residual is a length, m, and not the cosine of an angle.
    pub(super) fn is_length(self) -> bool {
        match self {
            Self::Point(_) | Self::Along(_) | Self::InPlane(_) | Self::Length(_) => true,
            Self::Driven(_) | Self::Mesh(_) => true,
            Self::Coupled(action, _) => action != CouplingAction::Couple,
            Self::Parallel(..) | Self::NoSpin(_) => false,
        }
    }
}

/// A joint that closes a loop.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Closure<C = f64> {
    /// None for the row that holds an idle freedom.
    pub(super) joint: Option<JointId>,
    pub(super) bodies: [usize; 2],
    /// The bodies in whose frames the points are: the same, or the carrier of a gear pair.
    pub(super) on: [usize; 2],
    pub(super) points: [Vec3<C>; 2],
    /// For a gear pair: the travel of the teeth for a unit of each freedom of its path, m.
    pub(super) ratios: Vec<C>,
    pub(super) kinds: Vec<RowKind<C>>,
    /// The law of a coupling. The path is then that of its two freedoms, and there are no links.
    pub(super) coupled: Option<Box<Coupled<C>>>,
    /// By body: the normal of the [plane](super::planes) to which it keeps and along which its rows are, if it does.
    pub(super) plane: Option<[Vec3; 2]>,
    /// The range of its rows among all rows.
    pub(super) rows: Range<usize>,
    /// The links on the path from the first body to the second, with their signs: those towards the second are positive.
    pub(super) links: Vec<(usize, f64)>,
    /// The freedoms on that path, with their signs.
    pub(super) path: Vec<(usize, f64)>,
    /// By row and freedom of the path: whether the freedom never changes the row, since the closure keeps to a [plane](super::planes). Empty
    /// where that is not known.
    pub(super) unmoved: Vec<bool>,
    /// Start of its entries in the Jacobian: row by row, one for each freedom of the path.
    pub(super) entries: usize,
}

/// A row's residual with its wrench on the second body: force at that body's point, and couple.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowValue<T> {
    pub(super) residual: T,
    pub(super) wrench: Wrench<T>,
}

/// All closures of a mechanism.
///
/// # Errors
/// [`StructureError::Malformed`] where a screw closes a loop, which [lowering](super::lower) prevents.
pub(super) fn closures(
    mechanism: &Mechanism,
    tree: &Tree,
    measured: &[Option<JointId>],
) -> Result<Vec<Closure>, StructureError> {
    let (mut rows, mut entries) = (0, 0);
    let mut found = Vec::new();
    let mut kinds_of_coupled = mechanism.coupled().zip(measured);
    let mut next_kind = || {
        let ((_, of), measured) = kinds_of_coupled.next()?;
        of.driven_kind(*measured)
    };
    for &id in &tree.closures {
        let joint = &mechanism.joints[id.0];
        let bodies = joint.bodies.map(|b| b.0);
        let on = [0, 1].map(|k| joint.side_body(k).0);
        let side = |k: usize| joint.sides[k].in_frame(&tree.internal[on[k]]);
        let sides = [side(0), side(1)];
        let driven = tree.driven_lengths.iter().find(|(j, _)| *j == id);
        let kinds = match driven {
            Some((_, freedom)) => Some(vec![RowKind::Driven(*freedom)]),
            None => rows_of(joint.kind, joint.numbers().number, &sides),
        };
        let Some(kinds) = kinds else {
            let reason = "a screw closes a loop";
            return Err(StructureError::Malformed { reason });
        };
        let points = [sides[0].point, sides[1].point];
        let mut closure = Closure::new(tree, Some(id), bodies, points, kinds, [rows, entries]);
        closure.on = on;
        if let Some((_, freedom)) = driven {
            closure.path.push((*freedom, 1.0));
        }
        if let JointKind::Coupling { index, .. } = joint.kind {
            let law = &mechanism.couplings[index].law;
            let kinds = [next_kind(), next_kind()];
            let coupled = match kinds {
                [Some(y), Some(x)] => Coupled::new(tree, law, [y, x]),
                _ => None,
            };
            let Some(coupled) = coupled else {
                let reason = "a coupled coordinate is not in the tree";
                return Err(StructureError::Malformed { reason });
            };
            closure.couple(coupled);
        }
        rows += closure.kinds.len();
        entries += closure.kinds.len() * closure.path.len();
        found.push(closure);
    }
    Ok(found)
}

/// The rows of a joint of a kind, with its number and its sides in the frames of the tree; none of a helical one.
pub(super) fn rows_of<C: Scalar>(
    kind: JointKind,
    number: C,
    [a, b]: &[Side<C>; 2],
) -> Option<Vec<RowKind<C>>> {
    use RowKind::{Coupled, InPlane, Length, Mesh, Parallel, Point};
    let across = a.axis.cross(a.normal);
    let of_condition = |condition: &Condition| {
        Some(match condition {
            Condition::Points => vec![Point(0), Point(1), Point(2)],
            Condition::OnLine => vec![InPlane(a.normal), InPlane(across)],
            Condition::InPlane => vec![InPlane(a.axis)],
            Condition::Axes => vec![Parallel(a.normal, b.axis), Parallel(across, b.axis)],
            Condition::AxesAcross => vec![Parallel(a.axis, b.axis)],
            Condition::Normals => vec![Parallel(a.normal, b.axis.cross(b.normal))],
            Condition::Teeth => vec![Mesh(a.axis)],
            Condition::Length => vec![Length(number)],
            Condition::Coupled(action) => vec![Coupled(*action, a.axis)],
            Condition::Thread => return None,
        })
    };
    let conditions = kind.conditions().iter();
    let rows: Option<Vec<Vec<RowKind<C>>>> = conditions.map(of_condition).collect();
    Some(rows?.concat())
}

/// The links on the path from one body to another: those towards the second are positive.
fn links_between(tree: &Tree, [a, b]: [usize; 2]) -> Vec<(usize, f64)> {
    let chain = |mut body: usize| {
        let mut links = Vec::new();
        while let Some(link) = tree.link_of[body] {
            links.push(link);
            body = tree.links[link].parent;
        }
        links
    };
    let (to_a, to_b) = (chain(a), chain(b));
    let part = |links: &[usize], others: &[usize], sign: f64| {
        let own = links.iter().filter(|l| !others.contains(l));
        own.map(|l| (*l, sign)).collect::<Vec<_>>()
    };
    let mut links = part(&to_a, &to_b, -1.0);
    links.extend(part(&to_b, &to_a, 1.0));
    links.sort_unstable_by_key(|(l, _)| *l);
    links
}

impl Closure {
    /// A closure of these rows between points of two bodies, whose rows and entries begin at these numbers.
    pub(super) fn new(
        tree: &Tree,
        joint: Option<JointId>,
        bodies: [usize; 2],
        points: [Vec3; 2],
        kinds: Vec<RowKind>,
        [rows, entries]: [usize; 2],
    ) -> Self {
        let links = links_between(tree, bodies);
        let freedoms = |&(l, sign): &(usize, f64)| {
            let freedoms = tree.links[l].freedoms.clone();
            freedoms.map(move |f| (f, sign))
        };
        Self {
            joint,
            bodies,
            on: bodies,
            points,
            ratios: Vec::new(),
            rows: rows..rows + kinds.len(),
            kinds,
            coupled: None,
            plane: None,
            path: links.iter().flat_map(freedoms).collect(),
            links,
            unmoved: Vec::new(),
            entries,
        }
    }

    /// Makes it the closure of a coupling, whose freedoms alone are on its path.
    fn couple(&mut self, coupled: Coupled) {
        self.links.clear();
        self.path = coupled.coordinates.map(|of| (of.freedom, 1.0)).to_vec();
        self.coupled = Some(Box::new(coupled));
    }

    /// How far the axes are from the same sense: of revolute and sliding joints they must not be opposite.
    pub(super) fn is_flipped(
        &self,
        frames: &[Frame<f64>],
        mechanism: &Mechanism,
        tree: &Tree,
    ) -> bool {
        let Some(joint) = self.joint.map(|j| &mechanism.joints[j.0]) else {
            return false;
        };
        let axis = |k: usize| {
            let side = joint.sides[k].in_frame(&tree.internal[self.bodies[k]]);
            frames[self.bodies[k]].rotation.apply(side.axis)
        };
        joint.kind.holds(Condition::Axes) && axis(0).dot(axis(1)) < 0.0
    }
}

impl<C: Constant> Closure<C> {
    /// Whether a freedom of the path, by its place there, changes a row.
    #[inline(always)]
    pub(super) fn is_moved(&self, row: usize, place: usize) -> bool {
        self.unmoved.is_empty() || !self.unmoved[row * self.path.len() + place]
    }

    /// Whether it is a distance that an actuator gives.
    pub(super) fn is_driven(&self) -> bool {
        matches!(self.kinds[..], [RowKind::Driven(_)])
    }

    /// The points of both bodies and their difference d.
    #[inline(always)]
    pub(super) fn ends<T: Lift<C>>(&self, frames: &[Frame<T>]) -> [Vec3<T>; 3] {
        let [a, b] = map_array([0, 1], |k| frames[self.on[k]].point(self.points[k]));
        [a, b, b - a]
    }

    /// The residual of a row and its wrench.
    #[inline(always)]
    pub(super) fn row<T: Lift<C>>(
        &self,
        kind: RowKind<C>,
        frames: &[Frame<T>],
        coordinates: &[T],
        d: Vec3<T>,
    ) -> RowValue<T> {
        let [a, b] = map_array(self.bodies, |body| &frames[body].rotation);
        let zero = Vec3::zero();
        let of = |residual, force, moment| RowValue {
            residual,
            wrench: Wrench { force, moment },
        };
        let distance = |length| {
            let distance = d.dot(d).sqrt();
            let along = d.scaled(T::from_f64(1.0) / distance);
            of(distance - length, along, zero)
        };
        match kind {
            RowKind::Point(k) => of(d.component(k), Vec3::AXES[k].cast(), zero),
            RowKind::Parallel(n, w) => {
                let (n, w) = (a.apply(n.cast()), b.apply(w.cast()));
                of(n.dot(w), zero, w.cross(n))
            }
            RowKind::Along(u) | RowKind::InPlane(u) => {
                let u = a.apply(u.cast());
                of(u.dot(d), u, zero)
            }
            RowKind::Length(length) => distance(T::lift(length)),
            RowKind::Driven(freedom) => distance(coordinates[freedom]),
            RowKind::Mesh(n) => {
                let path = self.path.iter().zip(&self.ratios);
                let travel = path.fold(T::from_f64(0.0), |sum, ((freedom, _), ratio)| {
                    sum + coordinates[*freedom] * T::lift(*ratio)
                });
                let n = frames[self.on[0]].rotation.apply(n.cast());
                of(travel, n, zero)
            }
            RowKind::NoSpin(e) => of(T::from_f64(0.0), zero, b.apply(e.cast())),
            RowKind::Coupled(action, u) => {
                let coupled = self.coupled.as_ref();
                let residual = coupled.map_or(T::from_f64(0.0), |c| c.residual(coordinates));
                match action {
                    CouplingAction::Couple => of(residual, zero, a.apply(u.cast())),
                    CouplingAction::Force => of(residual, a.apply(u.cast()), zero),
                    CouplingAction::Line => {
                        let along = d.scaled(T::from_f64(1.0) / d.dot(d).sqrt());
                        of(residual, along, zero)
                    }
                }
            }
        }
    }

    /// The difference d of the points with its first two derivatives, at the velocities and accelerations of the bodies.
    #[inline(always)]
    pub(super) fn point_motion<T: Lift<C>>(
        &self,
        frames: &[Frame<T>],
        states: &[BodyMotion<T>],
    ) -> [Vec3<T>; 3] {
        let [a, b] = map_array([0, 1], |k| {
            let (frame, state) = (&frames[self.on[k]], &states[self.on[k]]);
            let arm = frame.rotation.apply(self.points[k].cast());
            let (first, second) = state.direction_derivatives(arm);
            [
                frame.position + arm,
                state.velocity + first,
                state.acceleration + second,
            ]
        });
        [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
    }

    /// The second derivative of a row with respect to time, from the derivatives of the difference of the points.
    #[inline(always)]
    pub(super) fn row_acceleration<T: Lift<C>>(
        &self,
        kind: RowKind<C>,
        pose: &Pose<T>,
        [d, d1, d2]: [Vec3<T>; 3],
    ) -> T {
        let [a, b] = self.bodies;
        let (frames, states) = (&pose.frames, &pose.motion.states);
        let direction = |body: usize, u: Vec3<C>| {
            let u = frames[body].rotation.apply(u.cast());
            let (first, second) = states[body].direction_derivatives(u);
            (u, first, second)
        };
        let twice = T::from_f64(2.0);
        match kind {
            RowKind::Point(k) => d2.component(k),
            // d and ḋ are zero.
            RowKind::Along(u) => frames[a].rotation.apply(u.cast()).dot(d2),
            RowKind::Parallel(n, w) => {
                let ((n, n1, n2), (w, w1, w2)) = (direction(a, n), direction(b, w));
                n2.dot(w) + twice * n1.dot(w1) + n.dot(w2)
            }
            RowKind::InPlane(u) => {
                let (u, u1, u2) = direction(a, u);
                u2.dot(d) + twice * u1.dot(d1) + u.dot(d2)
            }
            // What the teeth travel is linear in the freedoms.
            RowKind::Mesh(_) => T::from_f64(0.0),
            RowKind::Length(_) | RowKind::Driven(_) => {
                let inverse = T::from_f64(1.0) / d.dot(d).sqrt();
                let along = d.dot(d1) * inverse;
                (d1.dot(d1) + d.dot(d2) - along * along) * inverse
            }
            RowKind::NoSpin(e) => {
                let e = frames[b].rotation.apply(e.cast());
                e.dot(states[b].angular_acceleration)
            }
            RowKind::Coupled(..) => match &self.coupled {
                Some(coupled) => coupled.acceleration(&pose.coordinates, &pose.motion.rates),
                None => T::from_f64(0.0),
            },
        }
    }
}

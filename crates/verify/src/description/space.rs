//! A mechanism in space in rows: products of directions and distances, for directions u, w and normals n, p of the first and second
//! body and d from the point of the first to that of the second,
//!
//! ```text
//! e·d = 0,    u·d = 0,    u·w = 0,    |d| − L = 0,    u·d − h θ = 0
//! ```
//!
//! with e of the ground, and the teeth of gears at their pitch point. A row holds the idle rotation of a body about the line through its
//! spherical joints.

use super::action::{Action, Direction};
use super::{DescribedBody, DescribedJoint, DescribedReaction, DescribedRow, Description};
use crate::error::{DenseError, Result};
use crate::pose::Columns;
use crate::rows::coupling::Coupling;
use crate::rows::mesh::Mesh;
use crate::rows::row::Row;
use crate::rows::terms::{Directions, Ends, Term};
use dwell_geometry::space::{
    Actuator, ActuatorKind, Coordinate, IdleBody, Joint, JointKind, Mechanism, Vec3,
};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::Mass;
use std::f64::consts::TAU;

/// The names of the components of a joint's reaction.
const COMPONENTS: [&str; 6] = [
    "force x", "force y", "force z", "moment x", "moment y", "moment z",
];

impl Description {
    /// The description of a mechanism in space, with the bodies that have an idle rotation about the line through their
    /// spherical joints.
    ///
    /// # Errors
    /// [`DenseError`] where there is not one mass for each body.
    pub(crate) fn in_space(
        mechanism: &Mechanism,
        masses: &[Mass],
        idle: &[IdleBody],
    ) -> Result<Self> {
        if masses.len() != mechanism.bodies.len() {
            return Err(DenseError::Masses {
                masses: masses.len(),
                bodies: mechanism.bodies.len(),
            });
        }
        let (mut joints, mut rows, mut reactions) = (vec![], vec![], vec![]);
        for (j, joint) in mechanism.joints.iter().enumerate() {
            let start = rows.len();
            // A driven distance holds nothing by itself.
            let drives = |a: &Actuator| a.kind == ActuatorKind::Length(JointId(j));
            if !mechanism.actuators.iter().any(drives) {
                let of_joint = rows_of(mechanism, joint).into_iter().enumerate();
                rows.extend(of_joint.map(|(k, (row, is_angle))| DescribedRow {
                    row,
                    is_angle,
                    name: format!("{}, constraint {}", joint.name, k + 1),
                }));
            }
            let from = reactions.len();
            reactions.extend(reactions_of(mechanism, joint));
            joints.push(DescribedJoint {
                name: joint.name.clone(),
                rows: start..rows.len(),
                reactions: from..reactions.len(),
                is_wrench: true,
                second: joint.bodies[1].0,
                point: (joint.side_body(1).0, joint.sides[1].point),
            });
        }
        rows.extend(idle.iter().map(|body| idle_row(mechanism, body)));
        rows.extend(
            mechanism
                .actuators
                .iter()
                .map(|a| actuator_row(mechanism, a)),
        );
        let actuators = mechanism.actuators.iter();
        Ok(Self {
            ground: mechanism.ground,
            bodies: bodies(mechanism, masses),
            joints,
            rows,
            reactions,
            actuators: actuators.map(|a| actuator_action(mechanism, a)).collect(),
            attachments: attachments(mechanism),
            idle: idle.to_vec(),
            size: mechanism.size(),
            counts_revolutions: false,
        })
    }
}

fn bodies(mechanism: &Mechanism, masses: &[Mass]) -> Vec<DescribedBody> {
    let ground = mechanism.ground;
    let both = mechanism.bodies.iter().zip(masses).enumerate();
    let described = both.map(|(b, (body, mass))| DescribedBody {
        name: body.name.clone(),
        columns: match b {
            b if b == ground => Columns::Fixed,
            b => Columns::Space(6 * (b - usize::from(b > ground))),
        },
        mass: *mass,
        varying: None,
    });
    described.collect()
}

fn ends(joint: &Joint) -> Ends {
    Ends {
        bodies: joint.bodies.map(|b| b.0),
        points: joint.sides.map(|side| side.point),
    }
}

/// The angle from the normal of the first side to that of the second about the axis of the first.
fn angle(joint: &Joint) -> Term {
    let [first, second] = &joint.sides;
    let bodies = joint.bodies.map(|b| b.0);
    let product = |u: Vec3| Directions {
        bodies,
        vectors: [u, second.normal],
    };
    Term::Angle([
        product(first.normal),
        product(first.axis.cross(first.normal)),
    ])
}

/// The rows of a joint, and whether each is an angle.
fn rows_of(mechanism: &Mechanism, joint: &Joint) -> Vec<(Row, bool)> {
    let [first, second] = &joint.sides;
    let (at, bodies) = (ends(joint), joint.bodies.map(|b| b.0));
    let across = [first.normal, first.axis.cross(first.normal)];
    let product = |u: Vec3, w: Vec3| {
        let vectors = [u, w];
        let directions = Directions { bodies, vectors };
        (Row::single(Term::Product(directions), 0.0), true)
    };
    let along = |u: Vec3| (Row::single(Term::AlongFirst(at, u), 0.0), false);
    let meets = || {
        Vec3::AXES
            .map(|e| (Row::single(Term::AlongGround(at, e), 0.0), false))
            .to_vec()
    };
    let parallel = || across.map(|v| product(v, second.axis)).to_vec();
    let on_line = || across.map(along).to_vec();
    let no_turn = || vec![product(first.normal, second.axis.cross(second.normal))];
    match joint.kind {
        JointKind::Weld => [meets(), parallel(), no_turn()].concat(),
        JointKind::Revolute => [meets(), parallel()].concat(),
        JointKind::Prismatic => [on_line(), parallel(), no_turn()].concat(),
        JointKind::Cylindrical => [on_line(), parallel()].concat(),
        JointKind::Helical { pitch } => {
            let travel = Term::AlongFirst(at, first.axis);
            let screw = Row::Sum {
                terms: vec![(1.0, travel), (-pitch, angle(joint))],
                constant: 0.0,
                period: Some((TAU * pitch).abs()),
            };
            [on_line(), parallel(), vec![(screw, false)]].concat()
        }
        JointKind::Universal => [meets(), vec![product(first.axis, second.axis)]].concat(),
        JointKind::Spherical => meets(),
        JointKind::Planar => [vec![along(first.axis)], parallel()].concat(),
        JointKind::PointOnLine => on_line(),
        JointKind::PointInPlane => vec![along(first.axis)],
        JointKind::Distance { length } => vec![(Row::single(Term::Distance(at), length), false)],
        JointKind::Gear { .. } => mesh(joint)
            .map(|mesh| (Row::Mesh(mesh), false))
            .into_iter()
            .collect(),
        JointKind::Coupling { index, .. } => {
            let is_angle = mechanism.couplings[index].dependent.is_angle();
            let coupling = Box::new(coupling(mechanism, index));
            vec![(Row::Coupling(coupling), is_angle)]
        }
    }
}

/// A coupling of the mechanism.
fn coupling(mechanism: &Mechanism, index: usize) -> Coupling {
    let coupling = &mechanism.couplings[index];
    Coupling {
        both: [coupling.dependent, coupling.independent].map(|of| term(mechanism, of)),
        law: coupling.law.clone(),
    }
}

fn distance_ends(bodies: [BodyId; 2], points: [Vec3; 2]) -> Ends {
    let bodies = bodies.map(|b| b.0);
    Ends { bodies, points }
}

/// A coordinate; an angle without whole revolutions.
fn term(mechanism: &Mechanism, of: Coordinate) -> Term {
    match of {
        Coordinate::Angle(id) => angle(&mechanism.joints[id.0]),
        Coordinate::Travel(id) => {
            let joint = &mechanism.joints[id.0];
            Term::AlongFirst(ends(joint), joint.sides[0].axis)
        }
        Coordinate::Distance { bodies, points } => Term::Distance(distance_ends(bodies, points)),
    }
}

/// A force or a couple along a coordinate, of its first body on its second, and its direction.
fn along(mechanism: &Mechanism, of: Coordinate) -> (Action, Direction) {
    match of {
        Coordinate::Angle(id) | Coordinate::Travel(id) => {
            let joint = &mechanism.joints[id.0];
            let at = ends(joint);
            let axis = Direction::Body(at.bodies[0], joint.sides[0].axis);
            let bodies = at.bodies;
            let action = if of.is_angle() {
                Action::Couple {
                    bodies,
                    about: axis,
                }
            } else {
                Action::force(at, axis)
            };
            (action, axis)
        }
        Coordinate::Distance { bodies, points } => {
            let at = distance_ends(bodies, points);
            let line = Direction::Line(at);
            (Action::force(at, line), line)
        }
    }
}

/// The teeth of a gear pair; none of other joints.
pub(crate) fn mesh(joint: &Joint) -> Option<Mesh> {
    let JointKind::Gear { carrier } = joint.kind else {
        return None;
    };
    let side = &joint.sides[0];
    Some(Mesh {
        wheels: joint.bodies.map(|b| b.0),
        pitch: Ends {
            bodies: [carrier.0; 2],
            points: [side.point; 2],
        },
        normal: side.axis,
    })
}

/// Force and moment of the first body on the second about the second's point (of gears the pitch point), in the axes of the ground.
fn reactions_of(mechanism: &Mechanism, joint: &Joint) -> impl Iterator<Item = DescribedReaction> {
    let bodies = joint.bodies.map(|b| b.0);
    let at = (joint.side_body(1).0, joint.sides[1].point);
    (0..6).map(move |k| {
        let direction = Direction::Ground(Vec3::AXES[k % 3]);
        let component = match k {
            0..3 => Action::Force {
                bodies,
                along: direction,
                at,
                offset: (at.0, Vec3::ZERO),
            },
            _ => Action::Couple {
                bodies,
                about: direction,
            },
        };
        DescribedReaction {
            name: format!("{}, {}", joint.name, COMPONENTS[k]),
            is_moment: k >= 3,
            action: match joint.kind {
                JointKind::Coupling { index, .. } => {
                    coupled(mechanism, index, component, direction)
                }
                _ => component,
            },
        }
    })
}

/// A component of the action of a coupling, a couple or a force along a direction, with its share of the action along the
/// independent coordinate.
fn coupled(mechanism: &Mechanism, index: usize, component: Action, direction: Direction) -> Action {
    let of = &mechanism.couplings[index];
    if of.dependent.is_angle() != matches!(component, Action::Couple { .. }) {
        return component;
    }
    let (_, axis) = along(mechanism, of.dependent);
    Action::Coupled {
        dependent: Box::new(component),
        independent: Box::new(along(mechanism, of.independent).0),
        coupling: Box::new(coupling(mechanism, index)),
        share: Some([axis, direction]),
    }
}

/// A body held from its idle rotation: ω·u = 0.
fn idle_row(mechanism: &Mechanism, idle: &IdleBody) -> DescribedRow {
    let body = idle.body.0;
    DescribedRow {
        row: Row::Idle(body, idle.axis),
        is_angle: true,
        name: format!("{}, idle rotation", mechanism.bodies[body].name),
    }
}

fn actuator_row(mechanism: &Mechanism, actuator: &Actuator) -> DescribedRow {
    let joint = &mechanism.joints[actuator.kind.joint().0];
    let at = ends(joint);
    let (row, is_angle) = match actuator.kind {
        ActuatorKind::Angle(_) => (Row::periodic(angle(joint), 0.0, TAU), true),
        ActuatorKind::Travel(_) => {
            let travel = Term::AlongFirst(at, joint.sides[0].axis);
            (Row::single(travel, 0.0), false)
        }
        ActuatorKind::Length(_) => (Row::single(Term::Distance(at), 0.0), false),
    };
    DescribedRow {
        row,
        is_angle,
        name: actuator.name.clone(),
    }
}

fn actuator_action(mechanism: &Mechanism, actuator: &Actuator) -> Action {
    let joint = &mechanism.joints[actuator.kind.joint().0];
    let at = ends(joint);
    let axis = Direction::Body(at.bodies[0], joint.sides[0].axis);
    match actuator.kind {
        ActuatorKind::Angle(_) => Action::Couple {
            bodies: at.bodies,
            about: axis,
        },
        ActuatorKind::Travel(_) => Action::force(at, axis),
        ActuatorKind::Length(_) => Action::force(at, Direction::Line(at)),
    }
}

fn attachments(mechanism: &Mechanism) -> Vec<(usize, Vec3)> {
    let sides = mechanism.joints.iter().flat_map(|joint| {
        let sides = joint.sides.iter().enumerate();
        sides.map(|(k, side)| (joint.side_body(k).0, side.point))
    });
    let coupled = mechanism.couplings.iter();
    let coupled = coupled.flat_map(|of| [of.dependent, of.independent]);
    let distances = coupled.flat_map(|of| match of {
        Coordinate::Distance { bodies, points } => {
            vec![(bodies[0].0, points[0]), (bodies[1].0, points[1])]
        }
        Coordinate::Angle(_) | Coordinate::Travel(_) => Vec::new(),
    });
    sides.chain(distances).collect()
}

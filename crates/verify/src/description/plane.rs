//! A planar mechanism lifted into space: z is across the plane, and its bodies have three coordinates each.
//!
//! With d = P2 − P1, t the first body's axis and n that axis turned +90°, and ψ the direction of d:
//!
//! ```text
//! revolute   d                                    (1)  two rows, m
//! prismatic  n·d                                  (2)  m
//!            (θ2 + α2) − (θ1 + α1)                (3)  rad, to the nearest turn; α the axis's angle
//! slot       n·d                                  (4)  m
//! weld       d, then θ2 − θ1 − angle              (5)  m, m, rad to the nearest turn
//! gear       r2 (θ2 − ψ) ± r1 (θ1 − ψ) − c        (6)  m; + external, − internal
//! rack       t·d + r (θ2 − θ1)                    (7)  m
//! rolling    n·d − r, then t·d + r (θ2 − θ1)      (8)  m
//! distance   |d| − length                         (9)  m
//! coupling   of − law(by)                         (10) rad or m
//! actuator   θ2 − θ1, or t·d, or |d|              (11) rad or m
//! ```
//!
//! Rows (6) to (8), and (10) with an angle, depend on whole revolutions of a body. In a mechanism with one of these, (11) uses the
//! counted angle, in any other the angle modulo one revolution.

use super::action::{Action, Direction};
use super::{DescribedBody, DescribedJoint, DescribedReaction, DescribedRow, Description};
use crate::error::{DenseError, Result};
use crate::inertias::Inertias;
use crate::pose::{Columns, lifted};
use crate::rows::coupling::Coupling;
use crate::rows::gear::Gear;
use crate::rows::row::Row;
use crate::rows::terms::{Ends, Term, perpendicular};
use dwell_geometry::constraint_rows::ConstraintRows;
use dwell_geometry::space::Vec3;
use dwell_geometry::{
    ActuatorKind, BodyId, Component, Coordinate, Joint, JointKind, Mechanism, Vec2,
};
use dwell_kinetostatics::space::Mass;
use std::f64::consts::TAU;

/// Two points of one body are one centre when they are this close, in pitch radii: it decides only the number of revolutions of the
/// line of centres.
const SAME_CENTRE: f64 = 1e-6;

fn ends(bodies: [BodyId; 2], points: [Vec2; 2]) -> Ends {
    Ends {
        bodies: bodies.map(|b| b.0),
        points: points.map(lifted),
    }
}

fn angle_of(v: Vec2) -> f64 {
    v.y.atan2(v.x)
}

impl Description {
    /// The description of a planar mechanism.
    ///
    /// # Errors
    /// [`DenseError`] if it refers to a part that does not exist, an axis is no unit vector, or there is not one mass for each body.
    pub(crate) fn in_plane(mechanism: &Mechanism, inertias: Inertias<'_>) -> Result<Self> {
        // References first: what follows indexes by them.
        ConstraintRows::new(mechanism)?;
        if inertias.masses.len() != mechanism.bodies.len() {
            return Err(DenseError::Masses {
                masses: inertias.masses.len(),
                bodies: mechanism.bodies.len(),
            });
        }
        check_axes(mechanism)?;
        let lift = Lift { mechanism };
        let (mut joints, mut rows, mut reactions) = (vec![], vec![], vec![]);
        for (joint, of_joint) in mechanism.joints.iter().zip(by_joint(mechanism)) {
            let start = rows.len();
            let both = lift.rows(joint).into_iter().zip(lift.actions(joint));
            for ((row, action), (name, is_angle)) in both.zip(of_joint) {
                rows.push(DescribedRow {
                    row,
                    is_angle,
                    name: name.clone(),
                });
                reactions.push(DescribedReaction {
                    name,
                    is_moment: is_angle,
                    action,
                });
            }
            joints.push(DescribedJoint {
                name: joint.name.clone(),
                rows: start..rows.len(),
                reactions: start..rows.len(),
                is_wrench: false,
                second: joint.bodies[1].0,
                point: (joint.bodies[1].0, lifted(joint.points[1])),
            });
        }
        let counts_revolutions = lift.counts_revolutions();
        rows.extend(lift.actuator_rows(counts_revolutions));
        let actuators = mechanism.actuators.iter();
        Ok(Self {
            ground: mechanism.ground,
            bodies: bodies(mechanism, inertias),
            joints,
            rows,
            reactions,
            actuators: actuators.map(|a| lift.along(a.coordinate())).collect(),
            attachments: attachments(mechanism),
            idle: Vec::new(),
            size: mechanism.size(),
            counts_revolutions,
        })
    }
}

/// By joint: the names of its reactions, and whether each is a moment.
fn by_joint(mechanism: &Mechanism) -> Vec<Vec<(String, bool)>> {
    let mut all = vec![vec![]; mechanism.joints.len()];
    for reaction in mechanism.reactions() {
        let is_moment = reaction.component == Component::Moment;
        all[reaction.joint.0].push((mechanism.reaction_name(reaction), is_moment));
    }
    all
}

fn bodies(mechanism: &Mechanism, inertias: Inertias<'_>) -> Vec<DescribedBody> {
    let ground = mechanism.ground;
    let described = |b: usize| {
        let mass = inertias.masses[b];
        DescribedBody {
            name: mechanism.bodies[b].name.clone(),
            columns: match b {
                b if b == ground => Columns::Fixed,
                b => Columns::Plane(3 * (b - usize::from(b > ground))),
            },
            mass: Mass {
                mass: mass.mass,
                center: lifted(mass.center),
                inertia: [0.0, 0.0, mass.inertia, 0.0, 0.0, 0.0],
            },
            varying: inertias.varying_of(b).filter(|_| b != ground),
        }
    };
    (0..mechanism.bodies.len()).map(described).collect()
}

/// A mechanism whose references are sound.
struct Lift<'a> {
    mechanism: &'a Mechanism,
}

impl Lift<'_> {
    fn rows(&self, joint: &Joint) -> Vec<Row> {
        let at = ends(joint.bodies, joint.points);
        let turn = Term::CountedAngle(at.bodies);
        let coincide = |e| Row::single(Term::AlongGround(at, e), 0.0);
        let along = |u: Vec2, constant| Row::single(Term::AlongFirst(at, lifted(u)), constant);
        let unrolled = |axis: Vec2, radius| Row::Sum {
            terms: vec![(1.0, Term::AlongFirst(at, lifted(axis))), (radius, turn)],
            constant: 0.0,
            period: None,
        };
        let [x, y] = [Vec3::AXES[0], Vec3::AXES[1]];
        match joint.kind {
            JointKind::Revolute => vec![coincide(x), coincide(y)],
            JointKind::Prismatic {
                axes: [first, second],
            } => vec![
                along(first.perp(), 0.0),
                Row::periodic(turn, angle_of(first) - angle_of(second), TAU),
            ],
            JointKind::Slot { axis } => vec![along(axis.perp(), 0.0)],
            JointKind::Weld { angle } => {
                vec![coincide(x), coincide(y), Row::periodic(turn, angle, TAU)]
            }
            JointKind::Gear { radii, internal } => {
                let tolerance = SAME_CENTRE * (radii[0] + radii[1]);
                let holders = [0, 1].map(|k| self.at_centre(joint, k, tolerance));
                let carrier = holders[0].iter().find(|b| holders[1].contains(b));
                let ground = self.mechanism.ground;
                let gear = Gear::new(at, radii, internal, carrier.copied(), ground);
                vec![Row::Gear(gear)]
            }
            JointKind::Rack { axis, radius } => vec![unrolled(axis, radius)],
            JointKind::Rolling { axis, radius } => {
                vec![along(axis.perp(), radius), unrolled(axis, radius)]
            }
            JointKind::Distance { length } => vec![Row::single(Term::Distance(at), length)],
            JointKind::Coupling(r) => {
                vec![Row::Coupling(Box::new(self.coupling(r)))]
            }
        }
    }

    fn actuator_rows(&self, counts_revolutions: bool) -> impl Iterator<Item = DescribedRow> {
        self.mechanism.actuators.iter().map(move |actuator| {
            let coordinate = actuator.coordinate();
            let term = self.term(coordinate);
            let is_angle = coordinate.is_angle();
            DescribedRow {
                row: if is_angle && !counts_revolutions {
                    Row::periodic(term, 0.0, TAU)
                } else {
                    Row::single(term, 0.0)
                },
                is_angle,
                name: actuator.name.clone(),
            }
        })
    }

    fn coupling(&self, r: usize) -> Coupling {
        let coupling = &self.mechanism.couplings[r];
        Coupling {
            both: [coupling.dependent, coupling.independent].map(|c| self.term(c)),
            law: coupling.law.clone(),
        }
    }

    fn term(&self, coordinate: Coordinate) -> Term {
        match coordinate {
            Coordinate::Angle(bodies) => Term::CountedAngle(bodies.map(|b| b.0)),
            Coordinate::Travel(joint) => {
                let joint = &self.mechanism.joints[joint.0];
                let axis = joint.kind.travel_axis().unwrap_or(Vec2::ZERO);
                Term::AlongFirst(ends(joint.bodies, joint.points), lifted(axis))
            }
            Coordinate::Length { bodies, points } => Term::Distance(ends(bodies, points)),
        }
    }

    /// The action of a unit of each reaction of a joint.
    fn actions(&self, joint: &Joint) -> Vec<Action> {
        let at = ends(joint.bodies, joint.points);
        let ([first, second], [x, y, z]) = (at.bodies, Vec3::AXES);
        let ground = |e| Action::force(at, Direction::Ground(e));
        let moment = || Action::Couple {
            bodies: at.bodies,
            about: Direction::Ground(z),
        };
        let body = |v: Vec2| Direction::Body(first, lifted(v));
        // At the second's point, or where a circle about it touches the line of the first.
        let on_line = |along: Vec2, axis: Vec2, radius: f64| Action::Force {
            bodies: at.bodies,
            along: body(along),
            at: (second, at.points[1]),
            offset: (first, perpendicular(lifted(axis)).scaled(-radius)),
        };
        match joint.kind {
            JointKind::Revolute => vec![ground(x), ground(y)],
            JointKind::Weld { .. } => vec![ground(x), ground(y), moment()],
            JointKind::Prismatic { axes } => {
                vec![Action::force(at, body(axes[0].perp())), moment()]
            }
            JointKind::Slot { axis } => vec![Action::force(at, body(axis.perp()))],
            JointKind::Gear { radii, internal } => vec![Action::Tooth {
                centers: at,
                radius: radii[1],
                beyond: internal && radii[0] > radii[1],
            }],
            JointKind::Rack { axis, radius } => vec![on_line(axis, axis, radius)],
            JointKind::Rolling { axis, radius } => vec![
                on_line(axis.perp(), axis, radius),
                on_line(axis, axis, radius),
            ],
            JointKind::Distance { .. } => vec![Action::force(at, Direction::Line(at))],
            JointKind::Coupling(r) => {
                let coupling = &self.mechanism.couplings[r];
                vec![Action::Coupled {
                    dependent: Box::new(self.along(coupling.dependent)),
                    independent: Box::new(self.along(coupling.independent)),
                    coupling: Box::new(self.coupling(r)),
                    share: None,
                }]
            }
        }
    }

    /// A force along a coordinate, of its first body on its second: it does positive work when the coordinate grows.
    fn along(&self, coordinate: Coordinate) -> Action {
        match coordinate {
            Coordinate::Angle(bodies) => Action::Couple {
                bodies: bodies.map(|b| b.0),
                about: Direction::Ground(Vec3::AXES[2]),
            },
            Coordinate::Travel(joint) => {
                let joint = &self.mechanism.joints[joint.0];
                let at = ends(joint.bodies, joint.points);
                let axis = joint.kind.travel_axis().unwrap_or(Vec2::ZERO);
                Action::force(at, Direction::Body(at.bodies[0], lifted(axis)))
            }
            Coordinate::Length { bodies, points } => {
                let at = ends(bodies, points);
                Action::force(at, Direction::Line(at))
            }
        }
    }

    /// Whether rows depend on whole revolutions of a body.
    fn counts_revolutions(&self) -> bool {
        self.mechanism.joints.iter().any(|joint| match joint.kind {
            JointKind::Gear { .. } | JointKind::Rack { .. } | JointKind::Rolling { .. } => true,
            JointKind::Coupling(r) => {
                let coupling = &self.mechanism.couplings[r];
                coupling.dependent.is_angle() || coupling.independent.is_angle()
            }
            _ => false,
        })
    }

    /// The bodies that have a point fixed in them at the centre of one gear, in which revolutes and welds keep it.
    fn at_centre(&self, gear: &Joint, k: usize, tolerance: f64) -> Vec<usize> {
        let mut found: Vec<(usize, Vec2)> = vec![(gear.bodies[k].0, gear.points[k])];
        let mut next = 0;
        while let Some(&(body, point)) = found.get(next) {
            next += 1;
            for joint in &self.mechanism.joints {
                if !matches!(joint.kind, JointKind::Revolute | JointKind::Weld { .. }) {
                    continue;
                }
                for (one, other) in [(0, 1), (1, 0)] {
                    let at_point = joint.bodies[one].0 == body
                        && (joint.points[one] - point).norm() <= tolerance;
                    let across = (joint.bodies[other].0, joint.points[other]);
                    if at_point && !found.iter().any(|&(b, _)| b == across.0) {
                        found.push(across);
                    }
                }
            }
        }
        found.into_iter().map(|(body, _)| body).collect()
    }
}

/// Any other length than one would scale a reaction silently.
fn check_axes(mechanism: &Mechanism) -> Result<()> {
    for (joint, described) in mechanism.joints.iter().enumerate() {
        let axes = match described.kind {
            JointKind::Prismatic { axes } => axes,
            JointKind::Slot { axis }
            | JointKind::Rack { axis, .. }
            | JointKind::Rolling { axis, .. } => [axis; 2],
            _ => continue,
        };
        for length in axes.map(Vec2::norm) {
            if length.is_nan() || (length - 1.0).abs() > 1e-12 {
                return Err(DenseError::AxisNotUnit { joint, length });
            }
        }
    }
    Ok(())
}

/// Every point that is given in a body's frame, with the body. A coupling is between coordinates: the points of its joint have no
/// meaning.
fn attachments(mechanism: &Mechanism) -> Vec<(usize, Vec3)> {
    let mut all = Vec::new();
    let mut pair = |bodies: [BodyId; 2], points: [Vec2; 2]| {
        let both = bodies.into_iter().zip(points);
        all.extend(both.map(|(body, point)| (body.0, lifted(point))));
    };
    for joint in &mechanism.joints {
        if !matches!(joint.kind, JointKind::Coupling(_)) {
            pair(joint.bodies, joint.points);
        }
    }
    for coupling in &mechanism.couplings {
        for coordinate in [coupling.dependent, coupling.independent] {
            if let Coordinate::Length { bodies, points } = coordinate
                && bodies.iter().all(|b| b.0 < mechanism.bodies.len())
            {
                pair(bodies, points);
            }
        }
    }
    for actuator in &mechanism.actuators {
        if let ActuatorKind::Length(points) = actuator.kind {
            pair(actuator.bodies, points);
        }
    }
    all
}

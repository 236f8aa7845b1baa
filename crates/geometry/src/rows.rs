//! The constraint rows of every joint and actuator in body coordinates, dense and plain: the
//! independent side of the workbench.
//!
//! **Coordinates.** Each moving body has three, x = [x, y, θ]: where the origin of its own frame
//! stands in the plane, and how its frame is turned. The ground stays at 0, 0, 0. The moving
//! bodies follow each other in the order of [`Mechanism::bodies`].
//!
//! **Rows.** One per reaction component in the order of [`Mechanism::reactions`], then one per
//! actuator. Row k reads Φₖ(x) − vₖ = 0. With the imposed value vₖ = 0 of a joint's row, the joint
//! is closed; any other value is the joint really opened by that much, which is what releasing a
//! constraint as a second coordinate means (Jordi, Zayas & Cardona 2008, figure 1). The value of
//! an actuator's row is its coordinate q.
//!
//! With d = P2 − P1, t the first body's axis and n that axis turned +90°, all in the plane's
//! directions, and ψ the direction of d:
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
//! relation   of − law(by)                         (10) rad or m
//! actuator   θ2 − θ1, or t·d, or |d|              (11) rad or m
//! ```
//!
//! **Counting.** Rows (6) to (8), and (10) with an angle, feel whole turns of a body. A mechanism
//! that has one of these is *counted*: its angles in x must be counted from the start on, and (11)
//! takes an angle as it is. In any other mechanism a body's turn is no different from none, and
//! (11) is taken to the nearest turn. ψ is counted with the body that holds both centres; where
//! there is none, to the turn that leaves the row least open. The constant c is set by
//! [`Rows::mesh`] at the start; until then it is zero.
//!
//! **Signs.** Since P2 enters with a plus, the multiplier λₖ of row k in Jᵀλ is the action of the
//! first-named body on the second, as [`crate::Component`] tells. In rows along an axis the
//! derivative with θ1 turns the axis too, so that both bodies feel the force at the *second*
//! body's point; the rows with r bring the couple that moves it to the pitch point. The
//! multiplier of (6) has the moment r2 λ on the second body. A relation's λ acts on the bodies of
//! `of`, and −λ dlaw/dby on those of `by`.

mod gear;
mod measure;
#[cfg(test)]
mod tests;

use crate::mechanism::{BodyId, Component, Coordinate, Joint, JointId, JointKind, Mechanism};
use crate::plane::{Vec2, vec2};
use dwell_laws::Law;
use gear::Gear;
use measure::{Column, End, Measure, Places};
use std::f64::consts::TAU;

/// Why rows cannot be written for a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RowsError {
    /// The fixed body is not among the bodies.
    #[error("the ground is body {ground}, but there are {bodies} bodies")]
    NoGround {
        /// Index given for the ground.
        ground: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A joint names a body that is not there.
    #[error("joint {joint} names body {body}, but there are {bodies} bodies")]
    JointBody {
        /// Index of the joint.
        joint: usize,
        /// Index it names.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// An actuator names a body that is not there.
    #[error("actuator {actuator} names body {body}, but there are {bodies} bodies")]
    ActuatorBody {
        /// Index of the actuator.
        actuator: usize,
        /// Index it names.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A relation names a body that is not there.
    #[error("relation {relation} names body {body}, but there are {bodies} bodies")]
    RelationBody {
        /// Index of the relation.
        relation: usize,
        /// Index it names.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A joint names a relation that is not there.
    #[error("joint {joint} names relation {relation}, but there are {relations} relations")]
    NoRelation {
        /// Index of the joint.
        joint: usize,
        /// Index it names.
        relation: usize,
        /// Number of relations.
        relations: usize,
    },
    /// A travel is asked of something that has none.
    #[error("joint {joint} has no travel: it is no prismatic joint and no slot")]
    NoTravel {
        /// Index of the joint.
        joint: usize,
    },
}

/// One row. An imposed value is subtracted from each.
#[derive(Debug, Clone)]
enum Row {
    /// Σ factor × measure − less, to the nearest turn or not.
    Sum {
        terms: Vec<(f64, Measure)>,
        less: f64,
        periodic: bool,
    },
    Gear(Gear),
    /// of − law(by).
    Relation {
        of: Measure,
        by: Measure,
        law: Law,
    },
}

/// The rows of a mechanism. Everything they need is copied, so they outlive it.
///
/// Slices given to the methods are `columns()` long for coordinates, `len()` long for rows, and
/// `len() × columns()` long, one row after the other, for the Jacobian.
#[derive(Debug, Clone)]
pub struct Rows {
    rows: Vec<Row>,
    angular: Vec<bool>,
    body_columns: Vec<Column>,
    columns: usize,
    counted: bool,
}

/// The angle less the nearest whole number of turns.
fn nearest_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

impl Row {
    fn one(measure: Measure) -> Self {
        Self::sum(vec![(1.0, measure)], 0.0)
    }

    fn sum(terms: Vec<(f64, Measure)>, less: f64) -> Self {
        Self::Sum {
            terms,
            less,
            periodic: false,
        }
    }

    fn direction(columns: [Column; 2], less: f64) -> Self {
        Self::Sum {
            terms: vec![(1.0, Measure::Turn(columns))],
            less,
            periodic: true,
        }
    }

    /// Hands every measure of the row to `term`, with the row's derivative by it.
    fn each_term(&self, at: &Places<'_>, mut term: impl FnMut(f64, &Measure)) {
        match self {
            Self::Sum { terms, .. } => terms.iter().for_each(|(f, m)| term(*f, m)),
            Self::Gear(gear) => gear.terms().iter().for_each(|(f, m)| term(*f, m)),
            Self::Relation { of, by, law } => {
                term(1.0, of);
                term(-law.at(by.value(at))[1], by);
            }
        }
    }

    fn residual(&self, at: &Places<'_>, x: &[f64], imposed: f64) -> f64 {
        match self {
            Self::Sum {
                terms,
                less,
                periodic,
            } => {
                let sum: f64 = terms.iter().map(|(f, m)| f * m.value(at)).sum();
                let open = sum - less - imposed;
                if *periodic { nearest_turn(open) } else { open }
            }
            Self::Gear(gear) => gear.residual(at, x, imposed),
            Self::Relation { of, by, law } => of.value(at) - law.at(by.value(at))[0] - imposed,
        }
    }

    fn curvature(&self, at: &Places<'_>, x_dot: &[f64]) -> f64 {
        let mut sum = 0.0;
        self.each_term(at, |factor, measure| {
            sum += factor * measure.curvature(at, x_dot);
        });
        if let Self::Relation { by, law, .. } = self {
            let rate = by.rate(at, x_dot);
            sum -= law.at(by.value(at))[2] * rate * rate;
        }
        sum
    }
}

/// What is needed to write the rows of a mechanism.
struct Writer<'a> {
    mechanism: &'a Mechanism,
    columns: &'a [Column],
}

impl Writer<'_> {
    fn ends(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> [End; 2] {
        [0, 1].map(|i| End {
            column: self.columns[bodies[i].0],
            point: points[i],
        })
    }

    fn joint(&self, index: usize, joint: &Joint) -> Result<Vec<Row>, RowsError> {
        let ends = self.ends(joint.bodies, joint.points);
        let columns = ends.map(|e| e.column);
        let along = |axis: Vec2| Row::one(Measure::Along(ends, axis));
        let coincide =
            || [vec2(1.0, 0.0), vec2(0.0, 1.0)].map(|u| Row::one(Measure::Fixed(ends, u)));
        let unrolled = |axis: Vec2, radius: f64| {
            let terms = vec![
                (1.0, Measure::Along(ends, axis)),
                (radius, Measure::Turn(columns)),
            ];
            Row::sum(terms, 0.0)
        };
        Ok(match joint.kind {
            JointKind::Revolute => coincide().into(),
            JointKind::Prismatic {
                axes: [first, second],
            } => vec![
                along(first.perp()),
                Row::direction(columns, first.angle() - second.angle()),
            ],
            JointKind::Slot { axis } => vec![along(axis.perp())],
            JointKind::Weld { angle } => {
                let mut rows = Vec::from(coincide());
                rows.push(Row::direction(columns, angle));
                rows
            }
            JointKind::Gear { radii, internal } => vec![Row::Gear(Gear::new(
                self.mechanism,
                joint,
                ends,
                radii,
                internal,
                self.columns,
            ))],
            JointKind::Rack { axis, radius } => vec![unrolled(axis, radius)],
            JointKind::Rolling { axis, radius } => vec![
                Row::sum(vec![(1.0, Measure::Along(ends, axis.perp()))], radius),
                unrolled(axis, radius),
            ],
            JointKind::Distance { length } => {
                vec![Row::sum(vec![(1.0, Measure::Length(ends))], length)]
            }
            JointKind::Relation(relation) => vec![self.relation(index, relation)?],
        })
    }

    fn relation(&self, joint: usize, relation: usize) -> Result<Row, RowsError> {
        let relations = &self.mechanism.relations;
        let described = relations.get(relation).ok_or(RowsError::NoRelation {
            joint,
            relation,
            relations: relations.len(),
        })?;
        let bodies = self.columns.len();
        let broken = |body| RowsError::RelationBody {
            relation,
            body,
            bodies,
        };
        Ok(Row::Relation {
            of: self.measure(described.of, broken)?,
            by: self.measure(described.by, broken)?,
            law: described.law.clone(),
        })
    }

    /// The measure of a coordinate; `broken` is the error for a body that is not there.
    fn measure(
        &self,
        coordinate: Coordinate,
        broken: impl Fn(usize) -> RowsError,
    ) -> Result<Measure, RowsError> {
        let there = |bodies: [BodyId; 2]| match self.absent(bodies) {
            Some(body) => Err(broken(body)),
            None => Ok(()),
        };
        match coordinate {
            Coordinate::Angle(bodies) => {
                there(bodies)?;
                Ok(Measure::Turn(bodies.map(|b| self.columns[b.0])))
            }
            Coordinate::Travel(JointId(joint)) => {
                let slides = self.mechanism.joints.get(joint);
                let (slides, axis) = match slides.map(|j| (j, j.kind)) {
                    Some((j, JointKind::Prismatic { axes })) => (j, axes[0]),
                    Some((j, JointKind::Slot { axis })) => (j, axis),
                    _ => return Err(RowsError::NoTravel { joint }),
                };
                there(slides.bodies)?;
                Ok(Measure::Along(
                    self.ends(slides.bodies, slides.points),
                    axis,
                ))
            }
            Coordinate::Length { bodies, points } => {
                there(bodies)?;
                Ok(Measure::Length(self.ends(bodies, points)))
            }
        }
    }

    fn absent(&self, bodies: [BodyId; 2]) -> Option<usize> {
        bodies
            .into_iter()
            .map(|b| b.0)
            .find(|&b| b >= self.columns.len())
    }
}

/// Whether a joint feels whole turns of a body.
fn counts(mechanism: &Mechanism, joint: &Joint) -> bool {
    match joint.kind {
        JointKind::Gear { .. } | JointKind::Rack { .. } | JointKind::Rolling { .. } => true,
        JointKind::Relation(r) => {
            let relation = mechanism.relations.get(r);
            relation.is_some_and(|r| r.of.is_angle() || r.by.is_angle())
        }
        _ => false,
    }
}

impl Rows {
    /// The rows of `mechanism`, or which of its references is broken. Axes are taken as the unit
    /// vectors they are documented to be.
    pub fn new(mechanism: &Mechanism) -> Result<Self, RowsError> {
        let bodies = mechanism.bodies.len();
        if mechanism.ground >= bodies {
            return Err(RowsError::NoGround {
                ground: mechanism.ground,
                bodies,
            });
        }
        let mut columns = 0;
        let body_columns: Vec<_> = (0..bodies)
            .map(|b| {
                (b != mechanism.ground).then(|| {
                    columns += 3;
                    columns - 3
                })
            })
            .collect();
        let writer = Writer {
            mechanism,
            columns: &body_columns,
        };
        let counted = mechanism.joints.iter().any(|j| counts(mechanism, j));
        for (joint, described) in mechanism.joints.iter().enumerate() {
            if let Some(body) = writer.absent(described.bodies) {
                return Err(RowsError::JointBody {
                    joint,
                    body,
                    bodies,
                });
            }
        }
        let mut rows = Vec::with_capacity(2 * mechanism.joints.len() + mechanism.actuators.len());
        for (joint, described) in mechanism.joints.iter().enumerate() {
            rows.extend(writer.joint(joint, described)?);
        }
        for (actuator, described) in mechanism.actuators.iter().enumerate() {
            let broken = |body| RowsError::ActuatorBody {
                actuator,
                body,
                bodies,
            };
            if let Some(body) = writer.absent(described.bodies) {
                return Err(broken(body));
            }
            rows.push(match writer.measure(described.coordinate(), broken)? {
                Measure::Turn(turned) if !counted => Row::direction(turned, 0.0),
                measure => Row::one(measure),
            });
        }
        let reactions = mechanism.reactions();
        let joints = reactions.iter().map(|r| r.component == Component::Moment);
        let drives = mechanism.actuators.iter();
        let angular = joints.chain(drives.map(|a| a.coordinate().is_angle()));
        Ok(Self {
            rows,
            angular: angular.collect(),
            body_columns,
            columns,
            counted,
        })
    }

    /// Number of coordinates: three per moving body.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows: one per reaction component, one per actuator.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no rows at all.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The column of the body's x coordinate, followed by those of y and θ; `None` for the ground.
    pub fn column(&self, body: BodyId) -> Option<usize> {
        self.body_columns.get(body.0).copied().flatten()
    }

    /// Whether each row is an angle (rad) rather than a length (m).
    pub fn angular(&self) -> &[bool] {
        &self.angular
    }

    /// Whether the rows feel whole turns of a body, so that the angles in x must be counted.
    pub fn counted(&self) -> bool {
        self.counted
    }

    /// Meshes the gears as they stand at `x_start`: their rows vanish there. Neither the Jacobian
    /// nor the curvature depends on it.
    pub fn mesh(&mut self, x_start: &[f64]) {
        let at = Places::new(x_start);
        for row in &mut self.rows {
            if let Row::Gear(gear) = row {
                gear.mesh(&at, x_start);
            }
        }
    }

    /// Φₖ(x) − vₖ into `out`, with the imposed values `imposed`.
    pub fn residual(&self, x: &[f64], imposed: &[f64], out: &mut [f64]) {
        let at = Places::new(x);
        for ((row, value), out) in self.rows.iter().zip(imposed).zip(out) {
            *out = row.residual(&at, x, *value);
        }
    }

    /// ∂Φ/∂x into `out`, row after row.
    pub fn jacobian(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let at = Places::new(x);
        for (k, row) in self.rows.iter().enumerate() {
            let out = &mut out[k * self.columns..(k + 1) * self.columns];
            row.each_term(&at, |factor, measure| {
                measure.gradient(&at, |c, derivative| {
                    for (out, d) in out[c..c + 3].iter_mut().zip(derivative) {
                        *out += factor * d;
                    }
                });
            });
        }
    }

    /// The velocity-squared terms Φ̇ₓ ẋ into `out`, so that Φ̈ = J ẍ + Φ̇ₓ ẋ: the second derivative
    /// of Φ along x + s ẋ at s = 0.
    pub fn curvature(&self, x: &[f64], x_dot: &[f64], out: &mut [f64]) {
        let at = Places::new(x);
        for (row, out) in self.rows.iter().zip(out) {
            *out = row.curvature(&at, x_dot);
        }
    }
}

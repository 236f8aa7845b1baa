//! Which rows a joint or an actuator has.

use super::ConstraintRowsError;
use super::gear::Gear;
use super::row::ConstraintRow;
use super::terms::{BodyPoint, Column, ConstraintTerm};
use crate::mechanism::{BodyId, Condition, Coordinate, Joint, JointId, Mechanism};
use crate::plane::{Vec2, vec2};

/// Writes the rows of a mechanism.
pub(super) struct RowWriter<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) columns: &'a [Column],
}

impl RowWriter<'_> {
    fn body_points(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> [BodyPoint; 2] {
        [0, 1].map(|i| BodyPoint {
            column: self.columns[bodies[i].0],
            point: points[i],
        })
    }

    pub(super) fn joint(
        &self,
        index: usize,
        joint: &Joint,
    ) -> Result<Vec<ConstraintRow>, ConstraintRowsError> {
        let points = self.body_points(joint.bodies, joint.points);
        let columns = points.map(|e| e.column);
        let component = |u: Vec2, constant: f64| {
            ConstraintRow::single(ConstraintTerm::BodyFixedComponent(points, u), constant)
        };
        let coincide =
            |u| ConstraintRow::single(ConstraintTerm::GroundFixedComponent(points, u), 0.0);
        let (x, y) = (vec2(1.0, 0.0), vec2(0.0, 1.0));
        let unrolled = |axis: Vec2, radius: f64| {
            let terms = vec![
                (1.0, ConstraintTerm::BodyFixedComponent(points, axis)),
                (radius, ConstraintTerm::RelativeAngle(columns)),
            ];
            ConstraintRow::Sum(terms, 0.0)
        };
        let mut rows = Vec::new();
        for condition in joint.kind.conditions() {
            match condition {
                Condition::Together => rows.extend([coincide(x), coincide(y)]),
                Condition::OnLine { axis, height } => rows.push(component(axis.perp(), height)),
                Condition::Turned { angle } => {
                    rows.push(ConstraintRow::periodic_angle(columns, angle));
                }
                Condition::Apart { length } => {
                    let distance = ConstraintTerm::Distance(points);
                    rows.push(ConstraintRow::single(distance, length));
                }
                Condition::Rolled { axis, radius } => rows.push(unrolled(axis, radius)),
                Condition::Meshed { radii, internal } => {
                    let (mechanism, columns) = (self.mechanism, self.columns);
                    let gear = Gear::new(mechanism, joint, points, radii, internal, columns);
                    rows.push(ConstraintRow::Gear(gear));
                }
                Condition::Coupled(coupling) => rows.push(self.coupling(index, coupling)?),
            }
        }
        Ok(rows)
    }

    fn coupling(
        &self,
        joint: usize,
        coupling: usize,
    ) -> Result<ConstraintRow, ConstraintRowsError> {
        let couplings = &self.mechanism.couplings;
        let described = couplings
            .get(coupling)
            .ok_or(ConstraintRowsError::NoCoupling {
                joint,
                coupling,
                couplings: couplings.len(),
            })?;
        let term = |coordinate| self.term("coupling", coupling, coordinate);
        let dependent = term(described.dependent)?;
        let independent = term(described.independent)?;
        let law = described.law.clone();
        Ok(ConstraintRow::Coupling([dependent, independent], law))
    }

    /// The term of a coordinate; `what` names it, of this number.
    pub(super) fn term(
        &self,
        what: &'static str,
        index: usize,
        coordinate: Coordinate,
    ) -> Result<ConstraintTerm, ConstraintRowsError> {
        let check = |bodies| self.check_bodies(what, index, bodies);
        match coordinate {
            Coordinate::Angle(bodies) => {
                check(bodies)?;
                Ok(ConstraintTerm::RelativeAngle(
                    bodies.map(|b| self.columns[b.0]),
                ))
            }
            Coordinate::Travel(JointId(joint)) => {
                let slides = self.mechanism.joints.get(joint);
                let with_axis = slides.and_then(|j| Some((j, j.kind.travel_axis()?)));
                let (slides, axis) = with_axis.ok_or(ConstraintRowsError::NoTravel { joint })?;
                check(slides.bodies)?;
                Ok(ConstraintTerm::BodyFixedComponent(
                    self.body_points(slides.bodies, slides.points),
                    axis,
                ))
            }
            Coordinate::Length { bodies, points } => {
                check(bodies)?;
                Ok(ConstraintTerm::Distance(self.body_points(bodies, points)))
            }
        }
    }

    /// Refuses bodies that do not exist; `what` names them: a joint, an actuator or a coupling, of this number.
    pub(super) fn check_bodies(
        &self,
        what: &'static str,
        index: usize,
        named: [BodyId; 2],
    ) -> Result<(), ConstraintRowsError> {
        let bodies = self.columns.len();
        match named.into_iter().find(|body| body.0 >= bodies) {
            Some(BodyId(body)) => Err(ConstraintRowsError::NoBody {
                what,
                index,
                body,
                bodies,
            }),
            None => Ok(()),
        }
    }
}

/// Whether the rows of a joint depend on whole revolutions of a body.
pub(super) fn joint_counts_revolutions(mechanism: &Mechanism, joint: &Joint) -> bool {
    joint.kind.conditions().any(|condition| match condition {
        Condition::Meshed { .. } | Condition::Rolled { .. } => true,
        Condition::Coupled(r) => {
            let coupling = mechanism.couplings.get(r);
            coupling.is_some_and(|r| r.dependent.is_angle() || r.independent.is_angle())
        }
        Condition::Together
        | Condition::OnLine { .. }
        | Condition::Turned { .. }
        | Condition::Apart { .. } => false,
    })
}

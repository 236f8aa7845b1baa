//! What the joints and the actuators do, as forces at points and couples: told from the words of
//! [`Component`](dwell_geometry::Component) and from where the bodies are, never from the rows.

use crate::closing::Closed;
use crate::dense::Dense;
use dwell_geometry::{BodyId, Coordinate, Joint, JointId, JointKind, Vec2, vec2};

/// One action on one body: a force at a point of the plane, and a couple.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Act {
    pub(crate) body: usize,
    pub(crate) force: Vec2,
    /// From the ground's moved origin.
    pub(crate) at: Vec2,
    pub(crate) couple: f64,
}

impl Act {
    /// Moment about a point.
    pub(crate) fn moment(&self, about: Vec2) -> f64 {
        (self.at - about).cross(self.force) + self.couple
    }

    /// Moment about a point with its terms taken as absolute values: what rounding is relative to.
    pub(crate) fn moment_terms(&self, about: Vec2) -> f64 {
        (self.at - about).norm() * self.force.norm() + self.couple.abs()
    }
}

/// Gathers actions in pairs: the first body acts on the second, and feels the opposite.
struct Pairs<'a> {
    dense: &'a Dense,
    at: &'a Closed,
    acts: Vec<Act>,
}

/// A joint's two points and its first body's turn, in the plane.
struct Place {
    bodies: [BodyId; 2],
    points: [Vec2; 2],
    turned: Vec2,
}

impl Pairs<'_> {
    fn add(&mut self, bodies: [BodyId; 2], force: Vec2, at: Vec2, couple: f64) {
        for (body, sign) in bodies.into_iter().zip([-1.0, 1.0]) {
            self.acts.push(Act {
                body: body.0,
                force: force * sign,
                at,
                couple: couple * sign,
            });
        }
    }

    fn force(&mut self, place: &Place, force: Vec2, at: Vec2) {
        self.add(place.bodies, force, at, 0.0);
    }

    fn couple(&mut self, bodies: [BodyId; 2], couple: f64) {
        self.add(bodies, Vec2::ZERO, Vec2::ZERO, couple);
    }

    fn place(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> Place {
        let of = |i: usize| &self.dense.bodies[bodies[i].0];
        let column = of(0).column;
        Place {
            bodies,
            points: [0, 1].map(|i| self.dense.placed(of(i), &self.at.x, points[i])),
            turned: column.map_or(Vec2::IDENTITY, |c| Vec2::from_angle(self.at.x[c + 2])),
        }
    }

    fn joint(&mut self, joint: &Joint, reaction: &[f64]) {
        let place = self.place(joint.bodies, joint.points);
        let [first, second] = place.points;
        let along = |axis: Vec2| axis.turn(place.turned);
        match (joint.kind, reaction) {
            (JointKind::Revolute, &[x, y]) => self.force(&place, vec2(x, y), second),
            (JointKind::Weld { .. }, &[x, y, moment]) => {
                self.add(joint.bodies, vec2(x, y), second, moment);
            }
            (JointKind::Prismatic { axes }, &[normal, moment]) => {
                let n = along(axes[0]).perp();
                self.add(joint.bodies, n * normal, second, moment);
            }
            (JointKind::Slot { axis }, &[normal]) => {
                self.force(&place, along(axis).perp() * normal, second);
            }
            (JointKind::Gear { radii, internal }, &[tooth]) => {
                // The pitch point is a radius from both centres: between them, or beyond the
                // centre of the smaller one of an internal pair.
                let line = unit(second - first);
                let outwards = if internal && radii[0] > radii[1] {
                    line
                } else {
                    -line
                };
                // Turns the second gear counter-clockwise.
                let force = outwards.perp() * tooth;
                self.force(&place, force, second + outwards * radii[1]);
            }
            (JointKind::Rack { axis, radius }, &[tooth]) => {
                let t = along(axis);
                self.force(&place, t * tooth, second - t.perp() * radius);
            }
            (JointKind::Rolling { axis, radius }, &[normal, tangent]) => {
                let (t, n) = (along(axis), along(axis).perp());
                self.force(&place, n * normal + t * tangent, second - n * radius);
            }
            (JointKind::Distance { .. }, &[axial]) => {
                self.force(&place, unit(second - first) * axial, second);
            }
            (JointKind::Relation(r), &[action]) => {
                let Some(relation) = self.dense.mechanism.relations.get(r) else {
                    return;
                };
                // No work is lost: what the law gives to one coordinate it takes from the other.
                let slope = relation.law.at(self.measured(relation.by))[1];
                self.along(relation.of, action);
                self.along(relation.by, -slope * action);
            }
            // Rows refused the mechanism, or the reactions are not those of the mechanism.
            _ => {}
        }
    }

    /// The joint that a travel belongs to, and its axis in the first body.
    fn slide(&self, joint: JointId) -> Option<(Place, Vec2)> {
        let joint = self.dense.mechanism.joints.get(joint.0)?;
        let axis = match joint.kind {
            JointKind::Prismatic { axes } => axes[0],
            JointKind::Slot { axis } => axis,
            _ => return None,
        };
        let place = self.place(joint.bodies, joint.points);
        let axis = axis.turn(place.turned);
        Some((place, axis))
    }

    /// An action along a coordinate, of its first body on its second: it does positive work when
    /// the coordinate grows.
    fn along(&mut self, coordinate: Coordinate, action: f64) {
        match coordinate {
            Coordinate::Angle(bodies) => self.couple(bodies, action),
            Coordinate::Travel(joint) => {
                if let Some((place, axis)) = self.slide(joint) {
                    self.force(&place, axis * action, place.points[1]);
                }
            }
            Coordinate::Length { bodies, points } => {
                let place = self.place(bodies, points);
                let line = unit(place.points[1] - place.points[0]);
                self.force(&place, line * action, place.points[1]);
            }
        }
    }

    fn measured(&self, coordinate: Coordinate) -> f64 {
        let angle = |b: BodyId| {
            let column = self.dense.bodies[b.0].column;
            column.map_or(0.0, |c| self.at.x[c + 2])
        };
        match coordinate {
            Coordinate::Angle([first, second]) => angle(second) - angle(first),
            Coordinate::Travel(joint) => self.slide(joint).map_or(0.0, |(place, axis)| {
                axis.dot(place.points[1] - place.points[0])
            }),
            Coordinate::Length { bodies, points } => {
                let [first, second] = self.place(bodies, points).points;
                (second - first).norm()
            }
        }
    }
}

fn unit(v: Vec2) -> Vec2 {
    v * (1.0 / v.norm())
}

impl Dense {
    /// Everything the joints and the actuators do, body by body, the ground among them.
    pub(crate) fn acts(&self, at: &Closed, reactions: &[f64], tau: &[f64]) -> Vec<Act> {
        let mut pairs = Pairs {
            dense: self,
            at,
            acts: Vec::new(),
        };
        let mut rest = reactions;
        for joint in &self.mechanism.joints {
            let rows = joint.kind.components(&self.mechanism.relations).len();
            let (of_joint, others) = rest.split_at(rows.min(rest.len()));
            pairs.joint(joint, of_joint);
            rest = others;
        }
        for (actuator, &tau) in self.mechanism.actuators.iter().zip(tau) {
            pairs.along(actuator.coordinate(), tau);
        }
        pairs.acts
    }
}

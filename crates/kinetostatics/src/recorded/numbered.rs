//! Descriptions with their numbers replaced by others of any type: by constants, by inputs of a recording. The same walk over a
//! description lists its numbers.

use crate::load::{AnyLoadKind, Direction, Mesh, PitchLines, Strength};
use crate::{mass, space};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_geometry::space::{Coordinate, JointNumbers, Side, Vec3, vec3};
use dwell_geometry::{Guide, Vec2, vec2};
use dwell_numerics::Constant;

/// A description that has numbers.
pub(crate) trait Numbered {
    /// The same with numbers of another type.
    type With<C: Constant>;

    /// The description with each number, in order, replaced by what a function makes of it.
    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Self::With<C>;

    /// Adds its numbers to a list.
    fn list(&self, numbers: &mut Vec<f64>) {
        let _ = self.replaced::<f64>(&mut |number| {
            numbers.push(number);
            number
        });
    }
}

impl<V: Numbered + Copy> Numbered for [V; 2] {
    type With<C: Constant> = [V::With<C>; 2];

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Self::With<C> {
        self.map(|one| one.replaced(by))
    }
}

impl Numbered for Vec2 {
    type With<C: Constant> = Vec2<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Vec2<C> {
        vec2(by(self.x), by(self.y))
    }
}

impl Numbered for Vec3 {
    type With<C: Constant> = Vec3<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Vec3<C> {
        vec3(by(self.x), by(self.y), by(self.z))
    }
}

impl Numbered for mass::Mass {
    type With<C: Constant> = mass::Mass<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> mass::Mass<C> {
        mass::Mass {
            mass: by(self.mass),
            center: self.center.replaced(by),
            inertia: by(self.inertia),
        }
    }
}

impl Numbered for space::Mass {
    type With<C: Constant> = space::Mass<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> space::Mass<C> {
        space::Mass {
            mass: by(self.mass),
            center: self.center.replaced(by),
            inertia: self.inertia.map(by),
        }
    }
}

impl Numbered for Side {
    type With<C: Constant> = Side<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Side<C> {
        Side {
            point: self.point.replaced(by),
            axis: self.axis.replaced(by),
            normal: self.normal.replaced(by),
        }
    }
}

impl Numbered for JointNumbers {
    type With<C: Constant> = JointNumbers<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> JointNumbers<C> {
        JointNumbers {
            sides: self.sides.replaced(by),
            number: by(self.number),
        }
    }
}

impl<V: Numbered + Copy> Numbered for Guide<V> {
    type With<C: Constant> = Guide<V::With<C>>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Self::With<C> {
        Guide {
            bodies: self.bodies,
            points: self.points.replaced(by),
            axis: self.axis.replaced(by),
        }
    }
}

impl Numbered for CoordinateFunction {
    type With<C: Constant> = CoordinateFunction<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> CoordinateFunction<C> {
        match self {
            Self::Angle(bodies) => CoordinateFunction::Angle(*bodies),
            Self::Travel(guide) => CoordinateFunction::Travel(guide.replaced(by)),
            Self::Length { bodies, points } => CoordinateFunction::Length {
                bodies: *bodies,
                points: points.replaced(by),
            },
        }
    }
}

impl Numbered for Coordinate {
    type With<C: Constant> = Coordinate<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Coordinate<C> {
        match self {
            Self::Angle(joint) => Coordinate::Angle(*joint),
            Self::Travel(joint) => Coordinate::Travel(*joint),
            Self::Distance { bodies, points } => Coordinate::Distance {
                bodies: *bodies,
                points: points.replaced(by),
            },
        }
    }
}

impl<V: Numbered> Numbered for Direction<V> {
    type With<C: Constant> = Direction<V::With<C>>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Self::With<C> {
        match self {
            Self::Ground(vector) => Direction::Ground(vector.replaced(by)),
            Self::Body(vector) => Direction::Body(vector.replaced(by)),
        }
    }
}

impl Numbered for Strength {
    type With<C: Constant> = Strength<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Strength<C> {
        match self {
            Self::Direct => Strength::Direct,
            Self::Elastic { free } => Strength::Elastic { free: by(*free) },
            Self::Viscous => Strength::Viscous,
            Self::Quadratic => Strength::Quadratic,
        }
    }
}

impl Numbered for Mesh {
    type With<C: Constant> = Mesh<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Mesh<C> {
        Mesh {
            bodies: self.bodies,
            points: self.points.replaced(by),
            pitch: match self.pitch {
                PitchLines::Circles { radii, internal } => PitchLines::Circles {
                    radii: radii.map(by),
                    internal,
                },
                PitchLines::Line { axis, radius } => PitchLines::Line {
                    axis: axis.replaced(by),
                    radius: by(radius),
                },
            },
        }
    }
}

impl Numbered for space::DirectedCouple {
    type With<C: Constant> = space::DirectedCouple<C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> space::DirectedCouple<C> {
        space::DirectedCouple {
            bodies: self.bodies,
            direction: self.direction.replaced(by),
        }
    }
}

impl<V: Numbered, K: Numbered, S: Numbered> Numbered for AnyLoadKind<V, K, S> {
    type With<C: Constant> = AnyLoadKind<V::With<C>, K::With<C>, S::With<C>, C>;

    fn replaced<C: Constant>(&self, by: &mut impl FnMut(f64) -> C) -> Self::With<C> {
        match self {
            Self::Gravity { direction } => AnyLoadKind::Gravity {
                direction: direction.replaced(by),
            },
            Self::Force {
                body,
                point,
                direction,
            } => AnyLoadKind::Force {
                body: *body,
                point: point.replaced(by),
                direction: direction.replaced(by),
            },
            Self::Along(coordinate, strength) => {
                AnyLoadKind::Along(coordinate.replaced(by), strength.replaced(by))
            }
            Self::Drag { body, point } => AnyLoadKind::Drag {
                body: *body,
                point: point.replaced(by),
            },
            Self::Special(special) => AnyLoadKind::Special(special.replaced(by)),
        }
    }
}

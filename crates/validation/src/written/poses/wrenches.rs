//! The forces of joints, actuators, loads and friction on the bodies, by the definitions of their components and the second
//! reading of the scene.

use super::jet::{Jet, JetVector};
use super::motion::Motion;
use super::reading::{
    Body, Friction, Joint, JointKind, Load, LoadKind, Magnitude, Measure, Place, Source,
};

/// A force at a point of the plane and a couple, on a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wrench {
    pub(crate) body: usize,
    pub(crate) force: [f64; 2],
    pub(crate) point: [f64; 2],
    pub(crate) couple: f64,
}

impl Wrench {
    /// A force on a body at a point.
    fn new(body: usize, force: [f64; 2], point: [f64; 2]) -> Self {
        let couple = 0.0;
        Self {
            body,
            force,
            point,
            couple,
        }
    }

    /// A multiple of it.
    pub(crate) fn times(&self, factor: f64) -> Self {
        Self {
            force: scaled(self.force, factor),
            couple: self.couple * factor,
            ..*self
        }
    }

    /// Its power on a moving body: the body's velocity at its point, and its angular velocity.
    pub(crate) fn power(&self, motion: &Motion<'_>) -> f64 {
        let frame = motion.bodies[self.body];
        let ([x, y], [vx, vy], omega) = (
            frame.origin.order(0),
            frame.origin.order(1),
            frame.angle.0[1],
        );
        let [fx, fy] = self.force;
        let at = match self.force {
            [0.0, 0.0] => [x, y],
            _ => self.point,
        };
        fx * (vx - omega * (at[1] - y)) + fy * (vy + omega * (at[0] - x)) + omega * self.couple
    }
}

/// The components of a joint, as its columns are named.
pub(crate) fn components(joint: &Joint) -> &'static [&'static str] {
    match &joint.kind {
        JointKind::Revolute => &["x", "y"],
        JointKind::Prismatic { .. } => &["normal", "moment"],
        JointKind::Slot { .. } => &["normal"],
        JointKind::Weld { .. } => &["x", "y", "moment"],
        JointKind::Gear { .. } | JointKind::Rack { .. } => &["tooth"],
        JointKind::Rolling { .. } => &["normal", "tangent"],
        JointKind::Distance { .. } => &["axial"],
        JointKind::Coupling {
            dependent: Measure::Angle(_),
            ..
        } => &["moment"],
        JointKind::Coupling { .. } => &["force"],
    }
}

fn scaled([x, y]: [f64; 2], factor: f64) -> [f64; 2] {
    [x * factor, y * factor]
}

fn plus([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a + c, b + d]
}

/// A force on the second body and its opposite on the first.
fn both([first, second]: [usize; 2], force: [f64; 2], point: [f64; 2], couple: f64) -> [Wrench; 2] {
    let on = |body: usize, force: [f64; 2], couple: f64| Wrench {
        couple,
        ..Wrench::new(body, force, point)
    };
    let opposite = on(first, scaled(force, -1.0), -couple);
    [opposite, on(second, force, couple)]
}

fn unit(gap: JetVector) -> [f64; 2] {
    let [x, y] = gap.order(0);
    scaled([x, y], 1.0 / x.hypot(y))
}

/// A force between two points along their line, on each body at its own point.
fn between(motion: &Motion<'_>, places: [Place; 2], force: f64) -> [Wrench; 2] {
    let line = unit(motion.gap(places));
    let on = |k: usize, sign: f64| {
        let point = motion.point(places[k]).order(0);
        Wrench::new(places[k].body, scaled(line, sign * force), point)
    };
    [on(0, -1.0), on(1, 1.0)]
}

/// A force along a coordinate, of its first body on its second: it does work when the coordinate grows.
pub(crate) fn along(motion: &Motion<'_>, measure: Measure, force: f64) -> [Wrench; 2] {
    let at = |places: [Place; 2], line: [f64; 2]| {
        let point = motion.point(places[1]).order(0);
        both(places.map(|p| p.body), scaled(line, force), point, 0.0)
    };
    match measure {
        Measure::Angle(bodies) => both(bodies, [0.0; 2], [0.0; 2], force),
        Measure::Travel(places, axis) => {
            at(places, motion.direction(places[0].body, axis).order(0))
        }
        Measure::Length(places) => between(motion, places, force),
    }
}

/// The forces of a joint with these components.
// Long: an arm for each kind of joint.
pub(crate) fn joint_wrenches(
    joint: &Joint,
    motion: &Motion<'_>,
    reaction: &[f64],
) -> Option<Vec<Wrench>> {
    let places = joint.places;
    let bodies = places.map(|p| p.body);
    let second = motion.point(places[1]).order(0);
    let axis = |axis: [f64; 2]| motion.direction(bodies[0], axis);
    let of = |k: usize| reaction.get(k).copied();
    let of_pair =
        |force: [f64; 2], point: [f64; 2], couple: f64| both(bodies, force, point, couple).to_vec();
    Some(match &joint.kind {
        JointKind::Revolute => of_pair([of(0)?, of(1)?], second, 0.0),
        JointKind::Weld { .. } => of_pair([of(0)?, of(1)?], second, of(2)?),
        JointKind::Prismatic { axes } => of_pair(
            scaled(axis(axes[0]).normal().order(0), of(0)?),
            second,
            of(1)?,
        ),
        JointKind::Slot { axis: t } => {
            of_pair(scaled(axis(*t).normal().order(0), of(0)?), second, 0.0)
        }
        JointKind::Gear { radii, is_internal } => {
            let line = unit(motion.gap(places));
            // The pitch point, seen from the second centre: towards the first, or of a ring around the second beyond it.
            let outwards = if *is_internal && radii[0] > radii[1] {
                line
            } else {
                scaled(line, -1.0)
            };
            let turned = [-outwards[1], outwards[0]];
            let pitch = plus(second, scaled(outwards, radii[1]));
            let tooth = of(0)?;
            let apart = scaled(outwards, -tooth.abs() * joint.pressure_angle.tan());
            of_pair(plus(scaled(turned, tooth), apart), pitch, 0.0)
        }
        JointKind::Rack { axis: t, radius } => {
            let (along, normal) = (axis(*t).order(0), axis(*t).normal().order(0));
            let tooth = of(0)?;
            let apart = scaled(
                normal,
                radius.signum() * tooth.abs() * joint.pressure_angle.tan(),
            );
            let point = plus(second, scaled(normal, -radius));
            of_pair(plus(scaled(along, tooth), apart), point, 0.0)
        }
        JointKind::Rolling { axis: t, radius } => {
            let (along, normal) = (axis(*t).order(0), axis(*t).normal().order(0));
            let force = plus(scaled(normal, of(0)?), scaled(along, of(1)?));
            of_pair(force, plus(second, scaled(normal, -radius)), 0.0)
        }
        JointKind::Distance { .. } => between(motion, places, of(0)?).to_vec(),
        JointKind::Coupling {
            dependent,
            independent,
            law,
        } => {
            let value = Jet([motion.measure(*independent).value(), 1.0, 0.0]);
            let slope = law.at(value, &|_| None)?.0[1];
            let mut all = along(motion, *dependent, of(0)?).to_vec();
            all.extend(along(motion, *independent, -slope * of(0)?));
            all
        }
    })
}

impl Magnitude {
    /// Its value in a row.
    pub(crate) fn at(&self, motion: &Motion<'_>) -> Option<f64> {
        let names = |name: &str| signal(motion, name);
        match self {
            Self::Expression(expression) => expression.at(&names).map(Jet::value),
            Self::Table { of, curve } => curve.at(names(of)?).map(Jet::value),
        }
    }
}

fn signal(motion: &Motion<'_>, name: &str) -> Option<Jet> {
    let coordinate = |name: &str| Some(motion.measure(motion.reading.coordinate(name)?.measure));
    if name == "t" {
        return Some(Jet::constant(motion.time()));
    }
    if let Some(coordinate) = coordinate(name) {
        return Some(Jet::constant(coordinate.value()));
    }
    let coordinate = coordinate(name.strip_suffix(".velocity")?)?;
    Some(Jet::constant(coordinate.0[1]))
}

impl Load {
    /// Its force or moment in a row, as its column has it; none of a weight.
    pub(crate) fn magnitude(&self, motion: &Motion<'_>) -> Option<f64> {
        match &self.kind {
            LoadKind::Gravity([x, y]) => Some(x.hypot(*y)),
            LoadKind::Force { magnitude, .. } | LoadKind::Along(_, Source::Given(magnitude)) => {
                magnitude.at(motion)
            }
            // Positive pushes apart, as the force of two points does.
            LoadKind::Along(measure, Source::Spring { stiffness, free }) => {
                Some(-stiffness.at(motion)? * (motion.measure(*measure).value() - free))
            }
            LoadKind::Along(measure, Source::Damper(damping)) => {
                Some(-damping.at(motion)? * motion.measure(*measure).0[1])
            }
        }
    }

    /// Its forces in a row.
    pub(crate) fn wrenches(&self, motion: &Motion<'_>) -> Option<Vec<Wrench>> {
        let magnitude = self.magnitude(motion)?;
        let unit = self.unit_wrenches(motion);
        Some(unit.iter().map(|wrench| wrench.times(magnitude)).collect())
    }

    /// The forces of it for a magnitude of 1.
    pub(crate) fn unit_wrenches(&self, motion: &Motion<'_>) -> Vec<Wrench> {
        match &self.kind {
            LoadKind::Gravity([x, y]) => {
                let size = x.hypot(*y);
                let bodies = motion.reading.bodies.iter().enumerate();
                let weight = |(body, of): (usize, &Body)| {
                    let force = scaled([*x, *y], if size > 0.0 { of.mass / size } else { 0.0 });
                    Wrench::new(body, force, motion.center(body).order(0))
                };
                bodies.map(weight).collect()
            }
            LoadKind::Force {
                at,
                direction,
                in_body,
                ..
            } => {
                let force = match in_body {
                    true => motion.direction(at.body, *direction).order(0),
                    false => *direction,
                };
                vec![Wrench::new(at.body, force, motion.point(*at).order(0))]
            }
            LoadKind::Along(measure, _) => along(motion, *measure, 1.0).to_vec(),
        }
    }
}

impl Friction {
    /// The friction of a joint with a reaction: dry and viscous, against the speed of its surfaces.
    pub(crate) fn wrenches(&self, motion: &Motion<'_>, reaction: &[f64]) -> Option<[Wrench; 2]> {
        let joint = &motion.reading.joints[self.joint];
        let of = |k: usize| reaction.get(k).copied();
        let (measure, pressure) = match joint.kind {
            JointKind::Revolute => {
                let measure = Measure::Angle(joint.places.map(|p| p.body));
                (measure, self.size * of(0)?.hypot(of(1)?))
            }
            JointKind::Prismatic { axes: [axis, _] } => {
                let measure = Measure::Travel(joint.places, axis);
                let lever = if self.size > 0.0 {
                    of(1)? / self.size
                } else {
                    0.0
                };
                let half = 0.5 * of(0)?;
                (measure, (half + lever).abs() + (half - lever).abs())
            }
            JointKind::Slot { axis } => (Measure::Travel(joint.places, axis), of(0)?.abs()),
            _ => return None,
        };
        let speed = motion.measure(measure).0[1];
        let direction = match self.regularization_speed {
            Some(v) => (speed / v).tanh(),
            None if speed == 0.0 => 0.0,
            None => speed.signum(),
        };
        let force = -self.coefficient * pressure * direction - self.viscous * speed;
        Some(along(motion, measure, force))
    }
}

//! Shapes of loads in the evaluation frames of a plan, and the forces and couples of each on the bodies.

use super::load::{Direction, LoadKind};
use dwell_geometry::BodyId;
use dwell_geometry::space::{Coordinate, CoordinateFunction, Mechanism, Plan, Pose, Vec3};
use dwell_numerics::Scalar;

/// How the force along a coordinate follows from its magnitude, its value and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Resistance {
    /// The magnitude itself.
    None,
    /// A spring, by its free length or angle.
    Spring(f64),
    Damper,
}

/// A shape in the evaluation frames of its bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CompiledKind {
    action: Action,
    resistance: Resistance,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Action {
    Gravity(Vec3),
    /// On a body, at an arm from the origin of its evaluation frame.
    Force(usize, Vec3, Direction),
    Torque([usize; 2], Direction),
    /// Along a coordinate.
    Along(CoordinateFunction),
}

/// On a body, at an arm from the origin of its evaluation frame, a force and a couple, in the axes of the ground.
pub(super) type BodyAction<T> = (usize, [Vec3<T>; 3]);

impl CompiledKind {
    /// Checks and compiles a shape.
    // Long because it has one arm for each kind of load.
    pub(super) fn new(
        kind: &LoadKind,
        mechanism: &Mechanism,
        plan: &Plan,
    ) -> Result<Self, &'static str> {
        let there = |body: &BodyId| body.0 < mechanism.bodies.len();
        if !kind.bodies(mechanism).iter().all(there) {
            return Err("it acts on a body that does not exist");
        }
        let frame = |body: BodyId| plan.evaluation_frame(body.0);
        let turned = |body: BodyId, direction: Direction| match direction {
            Direction::Ground(u) => Direction::Ground(u),
            Direction::Body(u) => Direction::Body(frame(body).rotation.apply_inverse(u)),
        };
        let along = |coordinate| {
            plan.coordinate_function(mechanism, coordinate)
                .map(Action::Along)
        };
        // Without the angle itself.
        let about = |joint| {
            plan.direction_function(mechanism, Coordinate::Angle(joint))
                .map(Action::Along)
        };
        let finite =
            "its points, directions and free value must be finite, its free length not negative";
        let is_finite = |direction: Direction| match direction {
            Direction::Ground(u) | Direction::Body(u) => u.is_finite(),
        };
        let (action, resistance) = match *kind {
            LoadKind::Gravity(u) if u.is_finite() => (Action::Gravity(u), Resistance::None),
            LoadKind::Force {
                body,
                point,
                direction,
            } if point.is_finite() && is_finite(direction) => {
                let frame = frame(body);
                let arm = frame.rotation.apply_inverse(point - frame.position);
                let action = Action::Force(body.0, arm, turned(body, direction));
                (action, Resistance::None)
            }
            LoadKind::Torque { bodies, direction } if is_finite(direction) => {
                let direction = turned(bodies[0], direction);
                let action = Action::Torque(bodies.map(|b| b.0), direction);
                (action, Resistance::None)
            }
            LoadKind::PointToPointForce { bodies, points } => (
                along(Coordinate::Distance { bodies, points })?,
                Resistance::None,
            ),
            LoadKind::Spring {
                bodies,
                points,
                free_length,
            } if free_length >= 0.0 && free_length.is_finite() => {
                let action = along(Coordinate::Distance { bodies, points })?;
                (action, Resistance::Spring(free_length))
            }
            LoadKind::Damper { bodies, points } => (
                along(Coordinate::Distance { bodies, points })?,
                Resistance::Damper,
            ),
            LoadKind::JointTorque(joint) => (about(joint)?, Resistance::None),
            LoadKind::TorsionSpring { joint, free_angle } if free_angle.is_finite() => (
                along(Coordinate::Angle(joint))?,
                Resistance::Spring(free_angle),
            ),
            LoadKind::RotationalDamper(joint) => (about(joint)?, Resistance::Damper),
            LoadKind::SlideForce(joint) => (along(Coordinate::Travel(joint))?, Resistance::None),
            LoadKind::SlideDamper(joint) => (along(Coordinate::Travel(joint))?, Resistance::Damper),
            LoadKind::Gravity(_)
            | LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Spring { .. }
            | LoadKind::TorsionSpring { .. } => return Err(finite),
        };
        if let Action::Along(CoordinateFunction::Distance { points, .. }) = action
            && !points.iter().all(|p| p.is_finite())
        {
            return Err(finite);
        }
        Ok(Self { action, resistance })
    }

    /// The shape of a unit of its resistance: the load itself, but of a damper a force against it; and its magnitude.
    pub(super) fn unit(&self) -> (Self, f64) {
        match self.resistance {
            Resistance::None | Resistance::Spring(_) => (*self, 1.0),
            Resistance::Damper => {
                let mut unit = *self;
                unit.resistance = Resistance::None;
                (unit, -1.0)
            }
        }
    }

    /// The work of a unit over the size of the mechanism, or a turn of one radian; zero of a damper.
    pub(super) fn work_lever(&self, size: f64, mass: f64) -> f64 {
        let length = match self.action {
            Action::Gravity(_) => return size * mass,
            Action::Force(..) => size,
            Action::Torque(..) | Action::Along(CoordinateFunction::Angle { .. }) => 1.0,
            Action::Along(
                CoordinateFunction::Travel { .. } | CoordinateFunction::Distance { .. },
            ) => size,
        };
        match self.resistance {
            Resistance::None => length,
            Resistance::Spring(_) => length * length,
            Resistance::Damper => 0.0,
        }
    }

    /// The potential energy of a unit of the load at a pose, J: zero at the origin of the ground's frame; none of one that has no potential.
    pub(super) fn potential(
        &self,
        plan: &Plan,
        pose: &Pose,
        masses: &[super::Mass],
    ) -> Option<f64> {
        let at = |body: usize, point: Vec3| plan.origin() + plan.frame(pose, body).point(point);
        match (self.action, self.resistance) {
            (Action::Gravity(direction), _) => {
                let weights = masses
                    .iter()
                    .enumerate()
                    .map(|(body, mass)| -mass.mass * at(body, mass.center).dot(direction));
                Some(weights.sum())
            }
            (Action::Force(body, arm, Direction::Ground(direction)), _) => {
                Some(-at(body, arm).dot(direction))
            }
            (Action::Along(coordinate), Resistance::Spring(free)) => {
                let [value, ..] = plan.coordinate(pose, coordinate);
                Some(0.5 * (value - free) * (value - free))
            }
            (Action::Force(..) | Action::Torque(..) | Action::Along(_), _) => None,
        }
    }

    /// Gives the forces and couples on the bodies at magnitude `f` to `add`; none where it has no direction.
    #[inline]
    pub(super) fn act<T: Scalar>(
        &self,
        f: T,
        (plan, pose): (&Plan, &Pose<T>),
        masses: &[super::Mass],
        mut add: impl FnMut(BodyAction<T>),
    ) -> Option<()> {
        let zero = Vec3::zero();
        let turned = |body: usize, direction: Direction| match direction {
            Direction::Ground(u) => u.cast(),
            Direction::Body(u) => plan.frame(pose, body).rotation.apply(u.cast()),
        };
        match self.action {
            Action::Gravity(direction) => {
                let pull = direction.cast().scaled(f);
                for (body, mass) in masses.iter().enumerate().filter(|(_, m)| m.mass > 0.0) {
                    let arm = plan.frame(pose, body).rotation.apply(mass.center.cast());
                    add((body, [arm, pull.scaled(T::from_f64(mass.mass)), zero]));
                }
            }
            Action::Force(body, arm, direction) => {
                let arm = plan.frame(pose, body).rotation.apply(arm.cast());
                add((body, [arm, turned(body, direction).scaled(f), zero]));
            }
            Action::Torque(bodies, direction) => {
                let couple = turned(bodies[0], direction).scaled(f);
                couples(bodies, couple, add);
            }
            Action::Along(of) => return self.act_along(of, f, (plan, pose), add),
        }
        Some(())
    }

    /// The same of a force or couple along a coordinate.
    #[inline]
    fn act_along<T: Scalar>(
        &self,
        of: CoordinateFunction,
        f: T,
        (plan, pose): (&Plan, &Pose<T>),
        mut add: impl FnMut(BodyAction<T>),
    ) -> Option<()> {
        let arm = |body: BodyId, point: Vec3| plan.frame(pose, body.0).rotation.apply(point.cast());
        let resisted = || match self.resistance {
            Resistance::None => f,
            Resistance::Spring(free) => {
                let [value, ..] = plan.coordinate(pose, of);
                -(f * (value - T::from_f64(free)))
            }
            Resistance::Damper => -(f * plan.coordinate_rate(pose, of)),
        };
        let (bodies, arms, force) = match of {
            CoordinateFunction::Angle { bodies, axis, .. } => {
                let couple = arm(bodies[0], axis).scaled(resisted());
                couples(bodies.map(|b| b.0), couple, add);
                return Some(());
            }
            CoordinateFunction::Travel(guide) => {
                let (bodies, points) = (guide.bodies, guide.points);
                let force = arm(bodies[0], guide.axis).scaled(resisted());
                let [d, ..] = plan.separation(pose, bodies, points);
                // On both bodies at the second body's point.
                let arms = [arm(bodies[0], points[0]) + d, arm(bodies[1], points[1])];
                (bodies, arms, force)
            }
            CoordinateFunction::Distance { bodies, points } => {
                let force = self.along_line(f, plan.separation(pose, bodies, points))?;
                (bodies, [0, 1].map(|k| arm(bodies[k], points[k])), force)
            }
        };
        for (k, force) in [-force, force].into_iter().enumerate() {
            add((bodies[k].0, [arms[k], force, Vec3::zero()]));
        }
        Some(())
    }

    /// The force on the second of two points at a distance; none where they coincide and a direction is needed.
    #[inline]
    fn along_line<T: Scalar>(&self, f: T, [d, velocity, _]: [Vec3<T>; 3]) -> Option<Vec3<T>> {
        let square = d.dot(d);
        let direction = (square.value() > 0.0).then(|| d.scaled(T::from_f64(1.0) / square.sqrt()));
        let none = || (f.value() == 0.0).then(Vec3::zero);
        match (self.resistance, direction) {
            (Resistance::None, Some(e)) => Some(e.scaled(f)),
            (Resistance::None, None) => none(),
            // −k d + k free e: the first part is smooth where the points meet.
            (Resistance::Spring(0.0), _) => Some(-d.scaled(f)),
            (Resistance::Spring(free), Some(e)) => {
                Some(e.scaled(f * T::from_f64(free)) - d.scaled(f))
            }
            (Resistance::Spring(_), None) => none(),
            (Resistance::Damper, Some(e)) => Some(-e.scaled(e.dot(velocity) * f)),
            (Resistance::Damper, None) => {
                let still = velocity.dot(velocity).value() == 0.0;
                if still { Some(Vec3::zero()) } else { none() }
            }
        }
    }
}

/// A couple on the second body and the opposite on the first.
#[inline]
fn couples<T: Scalar>(bodies: [usize; 2], couple: Vec3<T>, mut add: impl FnMut(BodyAction<T>)) {
    for (body, couple) in bodies.into_iter().zip([-couple, couple]) {
        add((body, [Vec3::zero(), Vec3::zero(), couple]));
    }
}

//! What laws and loads measure on bodies, from their frames and rates alone.

use super::{MultibodyError, MultibodySystem};
use crate::body_motion::BodyMotion;
use crate::loads::load_wrenches;
use crate::wrenches::BodyWrench;
use dwell_geometry::{BodyId, Coordinate, JointKind, Vec2, vec2};
use dwell_kinetostatics::{LoadKind, Magnitude, Signal};

/// Frames of all bodies and their rates at a time.
#[derive(Debug, Clone)]
pub(super) struct MultibodyState {
    pub(super) t: f64,
    pub(super) poses: Vec<[f64; 3]>,
    pub(super) velocities: Vec<[f64; 3]>,
}

impl MultibodyState {
    pub(super) fn motion(&self) -> BodyMotion<'_> {
        BodyMotion {
            poses: &self.poses,
            velocities: &self.velocities,
        }
    }

    /// Power of an act.
    pub(super) fn power(&self, wrench: &BodyWrench) -> f64 {
        let ([x, y, _], [vx, vy, omega]) =
            (self.poses[wrench.body.0], self.velocities[wrench.body.0]);
        let arm = wrench.point - vec2(x, y);
        wrench.force.dot(vec2(vx, vy) + arm.perp() * omega) + wrench.couple * omega
    }
}

impl MultibodySystem {
    /// Value and speed of a coordinate; none if the mechanism does not have it.
    pub(super) fn coordinate(
        &self,
        coordinate: Coordinate,
        at: &MultibodyState,
    ) -> Option<[f64; 2]> {
        match coordinate {
            Coordinate::Angle(bodies) => at.motion().angle(bodies),
            Coordinate::Length { bodies, points } => at.motion().length(bodies, points),
            Coordinate::Travel(joint) => {
                let joint = self.mechanism.joints.get(joint.0)?;
                let axis = match joint.kind {
                    JointKind::Prismatic { axes } => axes[0],
                    JointKind::Slot { axis } => axis,
                    JointKind::Revolute
                    | JointKind::Weld { .. }
                    | JointKind::Gear { .. }
                    | JointKind::Rack { .. }
                    | JointKind::Rolling { .. }
                    | JointKind::Distance { .. }
                    | JointKind::Coupling(_) => return None,
                };
                at.motion().travel(joint.bodies, joint.points, axis)
            }
        }
    }

    fn signal(&self, signal: Signal, at: &MultibodyState) -> Option<f64> {
        match signal {
            Signal::Time => Some(at.t),
            Signal::Value(coordinate) => Some(self.coordinate(coordinate, at)?[0]),
            Signal::Velocity(coordinate) => Some(self.coordinate(coordinate, at)?[1]),
        }
    }

    /// A magnitude; none if it needs a coordinate or a signal that is not there. What answers to reactions, and
    /// what another is to give, has none of its own.
    pub(super) fn magnitude(&self, magnitude: &Magnitude, at: &MultibodyState) -> Option<f64> {
        match magnitude {
            Magnitude::Constant(value) => Some(*value),
            Magnitude::Law(signal, law) => Some(law.eval(self.signal(*signal, at)?)[0]),
            Magnitude::Expression(expression, signals) => {
                let signals = signals.iter().map(|s| self.signal(*s, at));
                let values = signals.collect::<Option<Vec<f64>>>()?;
                let enough = expression.variables().len() <= values.len();
                enough.then(|| expression.eval(&values))
            }
            Magnitude::Function(function, signals) => {
                let signals = signals.iter().map(|s| self.signal(*s, at));
                Some(function.value(&signals.collect::<Option<Vec<f64>>>()?))
            }
            Magnitude::Friction(_) | Magnitude::Separating(_) | Magnitude::External(_) => None,
        }
    }

    /// What a load does with a magnitude.
    pub(super) fn wrenches(
        &self,
        load: usize,
        magnitude: f64,
        at: &MultibodyState,
    ) -> Vec<BodyWrench> {
        let kind = self.loads.get(load).map(|load| &load.kind);
        let wrenches = kind.and_then(|kind| {
            load_wrenches(
                kind,
                magnitude,
                self.mechanism.ground,
                &self.masses,
                &at.poses,
                &at.velocities,
            )
        });
        wrenches.unwrap_or_default()
    }

    /// Everything at the origin and at rest: to see what is there at all.
    pub(super) fn rest_state(&self) -> MultibodyState {
        let at_rest = vec![[0.0; 3]; self.masses.len()];
        MultibodyState {
            t: 0.0,
            poses: at_rest.clone(),
            velocities: at_rest,
        }
    }

    /// Every load must find its bodies and coordinates.
    pub(super) fn check_loads(&self) -> Result<(), MultibodyError> {
        let at = self.rest_state();
        for (i, load) in self.loads.iter().enumerate() {
            let wrong = |what| MultibodyError::Load { load: i, what };
            let (ground, masses) = (self.mechanism.ground, &self.masses);
            load_wrenches(&load.kind, 0.0, ground, masses, &at.poses, &at.velocities)
                .ok_or(wrong("it acts on a body that is not there"))?;
            match &load.magnitude {
                Magnitude::Friction(friction) => self.check_friction(&load.kind, friction),
                Magnitude::Separating(teeth) => self.check_teeth(&load.kind, teeth),
                other @ (Magnitude::Constant(_)
                | Magnitude::Law(..)
                | Magnitude::Expression(..)
                | Magnitude::Function(..)
                | Magnitude::External(_)) => self.magnitude(other, &at).is_some(),
            }
            .then_some(())
            .ok_or(wrong("its magnitude does not fit the mechanism"))?;
        }
        Ok(())
    }

    /// Kinetic energy of bodies and rotors, and the potential of the loads that have one, J.
    pub(super) fn energies(&self, at: &MultibodyState) -> [f64; 2] {
        let mut kinetic = 0.0;
        for (b, mass) in self.masses.iter().enumerate() {
            let v = at
                .motion()
                .point_velocity(BodyId(b), mass.center)
                .unwrap_or(Vec2::ZERO);
            let omega = at.velocities[b][2];
            kinetic += 0.5 * (mass.mass * v.dot(v) + mass.inertia * omega * omega);
        }
        kinetic += self.rotor_energy(at);
        let potential = |load| self.potential(load, at).unwrap_or(0.0);
        [kinetic, (0..self.loads.len()).map(potential).sum()]
    }

    /// ½ F s² of a spring, −F · displacement of weight and of a force that keeps its direction: where
    /// F is constant.
    pub(super) fn potential(&self, load: usize, at: &MultibodyState) -> Option<f64> {
        let load = self.loads.get(load)?;
        let Magnitude::Constant(size) = load.magnitude else {
            return None;
        };
        match load.kind {
            LoadKind::Gravity { direction } => {
                let mut sum = 0.0;
                for (b, mass) in self.masses.iter().enumerate() {
                    let height = at.motion().point(BodyId(b), mass.center)?.dot(direction);
                    sum -= mass.mass * size * height;
                }
                Some(sum)
            }
            LoadKind::Force {
                body,
                point,
                direction,
                body_fixed: false,
            } => Some(-size * at.motion().point(body, point)?.dot(direction)),
            LoadKind::Spring {
                bodies,
                points,
                free_length: free,
            } => {
                let stretch = at.motion().length(bodies, points)?[0] - free;
                Some(0.5 * size * stretch * stretch)
            }
            LoadKind::TorsionSpring {
                bodies,
                free_angle: free,
            } => {
                let stretch = at.motion().angle(bodies)?[0] - free;
                Some(0.5 * size * stretch * stretch)
            }
            LoadKind::Force {
                body_fixed: true, ..
            }
            | LoadKind::Torque { .. }
            | LoadKind::Damper { .. }
            | LoadKind::RotationalDamper { .. }
            | LoadKind::PointToPointForce { .. }
            | LoadKind::SlideForce(_)
            | LoadKind::SlideDamper(_)
            | LoadKind::SeparatingForce(_) => None,
        }
    }
}

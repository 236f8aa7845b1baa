//! What laws and loads measure on bodies, from their frames and rates alone.

use super::{Unreduced, UnreducedError};
use crate::loads::load_acts;
use crate::state::BodyAct;
use dwell_geometry::{BodyId, Coordinate, JointKind, Vec2, vec2};
use dwell_kinetostatics::{LoadKind, Magnitude, Signal};

/// Frames of all bodies and their rates at a time.
#[derive(Debug, Clone)]
pub(super) struct Instant {
    pub(super) t: f64,
    pub(super) bodies: Vec<[f64; 3]>,
    pub(super) velocity: Vec<[f64; 3]>,
}

impl Instant {
    pub(super) fn point(&self, body: BodyId, point: Vec2) -> Option<Vec2> {
        let [x, y, angle] = *self.bodies.get(body.0)?;
        Some(vec2(x, y) + point.turn(Vec2::from_angle(angle)))
    }

    fn speed(&self, body: BodyId, point: Vec2) -> Option<Vec2> {
        let angle = self.bodies.get(body.0)?[2];
        let [vx, vy, omega] = *self.velocity.get(body.0)?;
        Some(vec2(vx, vy) + point.turn(Vec2::from_angle(angle)).perp() * omega)
    }

    /// Power of an act.
    pub(super) fn power(&self, act: &BodyAct) -> f64 {
        let ([x, y, _], [vx, vy, omega]) = (self.bodies[act.body.0], self.velocity[act.body.0]);
        let arm = act.at - vec2(x, y);
        act.force.dot(vec2(vx, vy) + arm.perp() * omega) + act.couple * omega
    }

    fn gap(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> Option<[Vec2; 2]> {
        Some([
            self.point(bodies[1], points[1])? - self.point(bodies[0], points[0])?,
            self.speed(bodies[1], points[1])? - self.speed(bodies[0], points[0])?,
        ])
    }

    /// Angle of the second body from the first, counted as the frames are, and its speed.
    pub(super) fn angle(&self, [first, second]: [BodyId; 2]) -> Option<[f64; 2]> {
        let of = |all: &[[f64; 3]]| Some(all.get(second.0)?[2] - all.get(first.0)?[2]);
        Some([of(&self.bodies)?, of(&self.velocity)?])
    }

    /// t·(P₂ − P₁) along an axis of the first body, and its speed.
    pub(super) fn travel(
        &self,
        bodies: [BodyId; 2],
        points: [Vec2; 2],
        axis: Vec2,
    ) -> Option<[f64; 2]> {
        let [gap, rate] = self.gap(bodies, points)?;
        let along = axis.turn(Vec2::from_angle(self.bodies[bodies[0].0][2]));
        let turning = along.perp() * self.velocity[bodies[0].0][2];
        Some([along.dot(gap), along.dot(rate) + turning.dot(gap)])
    }

    fn length(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> Option<[f64; 2]> {
        let [gap, rate] = self.gap(bodies, points)?;
        let length = gap.norm();
        Some([length, gap.dot(rate) / length])
    }
}

impl Unreduced {
    /// Value and speed of a coordinate; none if the mechanism does not have it.
    pub(super) fn measure(&self, coordinate: Coordinate, at: &Instant) -> Option<[f64; 2]> {
        match coordinate {
            Coordinate::Angle(bodies) => at.angle(bodies),
            Coordinate::Length { bodies, points } => at.length(bodies, points),
            Coordinate::Travel(joint) => {
                let joint = self.mechanism.joints.get(joint.0)?;
                let axis = match joint.kind {
                    JointKind::Prismatic { axes } => axes[0],
                    JointKind::Slot { axis } => axis,
                    _ => return None,
                };
                at.travel(joint.bodies, joint.points, axis)
            }
        }
    }

    fn signal(&self, signal: Signal, at: &Instant) -> Option<f64> {
        match signal {
            Signal::Time => Some(at.t),
            Signal::Value(coordinate) => Some(self.measure(coordinate, at)?[0]),
            Signal::Speed(coordinate) => Some(self.measure(coordinate, at)?[1]),
        }
    }

    /// A magnitude; none if it needs a coordinate or a signal that is not there. Friction, and
    /// what another is to give, has none of its own.
    pub(super) fn magnitude(&self, magnitude: &Magnitude, at: &Instant) -> Option<f64> {
        match magnitude {
            Magnitude::Constant(value) => Some(*value),
            Magnitude::Law(signal, law) => Some(law.at(self.signal(*signal, at)?)[0]),
            Magnitude::Expression(expression, signals) => {
                let signals = signals.iter().map(|s| self.signal(*s, at));
                let values = signals.collect::<Option<Vec<f64>>>()?;
                let enough = expression.variables().len() <= values.len();
                enough.then(|| expression.at(&values))
            }
            Magnitude::Friction(_) | Magnitude::Given(_) => None,
        }
    }

    /// What a load does with a magnitude.
    pub(super) fn acts(&self, load: usize, magnitude: f64, at: &Instant) -> Vec<BodyAct> {
        let kind = self.loads.get(load).map(|load| &load.kind);
        let acts = kind.and_then(|kind| {
            load_acts(
                kind,
                magnitude,
                self.mechanism.ground,
                &self.masses,
                &at.bodies,
                &at.velocity,
            )
        });
        acts.unwrap_or_default()
    }

    /// Everything at the origin and at rest: to see what is there at all.
    pub(super) fn still(&self) -> Instant {
        let still = vec![[0.0; 3]; self.masses.len()];
        Instant {
            t: 0.0,
            bodies: still.clone(),
            velocity: still,
        }
    }

    /// Every load must find its bodies and coordinates.
    pub(super) fn check_loads(&self) -> Result<(), UnreducedError> {
        let at = self.still();
        for (i, load) in self.loads.iter().enumerate() {
            let wrong = |what| UnreducedError::Load { load: i, what };
            let (ground, masses) = (self.mechanism.ground, &self.masses);
            load_acts(&load.kind, 0.0, ground, masses, &at.bodies, &at.velocity)
                .ok_or(wrong("it acts on a body that is not there"))?;
            match &load.magnitude {
                Magnitude::Friction(friction) => self.check_friction(&load.kind, friction),
                other => self.magnitude(other, &at).is_some(),
            }
            .then_some(())
            .ok_or(wrong("its magnitude does not fit the mechanism"))?;
        }
        Ok(())
    }

    /// Kinetic energy of bodies and rotors, and the potential of the loads that have one, J.
    pub(super) fn energies(&self, at: &Instant) -> [f64; 2] {
        let mut kinetic = 0.0;
        for (b, mass) in self.masses.iter().enumerate() {
            let v = at.speed(BodyId(b), mass.center).unwrap_or(Vec2::ZERO);
            let omega = at.velocity[b][2];
            kinetic += 0.5 * (mass.mass * v.dot(v) + mass.inertia * omega * omega);
        }
        kinetic += self.rotor_energy(at);
        let potential = |load| self.potential(load, at).unwrap_or(0.0);
        [kinetic, (0..self.loads.len()).map(potential).sum()]
    }

    /// ½ F s² of a spring, −F · displacement of weight and of a force that keeps its direction: where
    /// F is constant.
    pub(super) fn potential(&self, load: usize, at: &Instant) -> Option<f64> {
        let load = self.loads.get(load)?;
        let Magnitude::Constant(size) = load.magnitude else {
            return None;
        };
        match load.kind {
            LoadKind::Gravity { direction } => {
                let mut sum = 0.0;
                for (b, mass) in self.masses.iter().enumerate() {
                    let height = at.point(BodyId(b), mass.center)?.dot(direction);
                    sum -= mass.mass * size * height;
                }
                Some(sum)
            }
            LoadKind::Force {
                body,
                point,
                direction,
                follows: false,
            } => Some(-size * at.point(body, point)?.dot(direction)),
            LoadKind::Spring {
                bodies,
                points,
                free,
            } => {
                let stretch = at.length(bodies, points)?[0] - free;
                Some(0.5 * size * stretch * stretch)
            }
            LoadKind::TorsionSpring { bodies, free } => {
                let stretch = at.angle(bodies)?[0] - free;
                Some(0.5 * size * stretch * stretch)
            }
            _ => None,
        }
    }
}

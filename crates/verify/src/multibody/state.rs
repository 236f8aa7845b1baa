//! A state of the multibody equations: coordinates, magnitudes of loads, energies.

use super::{MultibodyError, MultibodySystem, Result};
use crate::body_motion::BodyMotion;
use crate::loads::{load_wrenches, placed};
use crate::pose::{Pose, Twist};
use crate::wrenches::BodyWrench;
use dwell_geometry::{BodyId, Vec2};
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

    /// Power of forces on bodies.
    pub(super) fn power(&self, wrenches: &[BodyWrench]) -> f64 {
        let power = |wrench: &BodyWrench| {
            let body = wrench.body.0;
            let origin = Pose::from(self.poses[body]).position;
            Twist::from(self.velocities[body]).power(&wrench.about(origin))
        };
        wrenches.iter().map(power).sum()
    }
}

impl MultibodySystem {
    fn signal(&self, signal: Signal, at: &MultibodyState) -> Option<f64> {
        let coordinate = |of| at.motion().coordinate(&self.mechanism, of);
        match signal {
            Signal::Time => Some(at.t),
            Signal::Value(of) => Some(coordinate(of)?[0]),
            Signal::Velocity(of) => Some(coordinate(of)?[1]),
        }
    }

    fn signals(&self, signals: &[Signal], at: &MultibodyState) -> Option<Vec<f64>> {
        signals.iter().map(|s| self.signal(*s, at)).collect()
    }

    /// A magnitude; `None` if it needs a coordinate or a signal that does not exist. Magnitudes that depend on
    /// reactions, and external ones, have no value here.
    pub(super) fn magnitude(&self, magnitude: &Magnitude, at: &MultibodyState) -> Option<f64> {
        match magnitude {
            Magnitude::Constant(value) => Some(*value),
            Magnitude::Law(signal, law) => Some(law.eval(self.signal(*signal, at)?)[0]),
            Magnitude::Expression(expression, signals) => {
                let values = self.signals(signals, at)?;
                let enough = expression.variables().len() <= values.len();
                enough.then(|| expression.eval(&values))
            }
            Magnitude::Function(function, signals) => {
                Some(function.value(&self.signals(signals, at)?))
            }
            Magnitude::Friction(_) | Magnitude::Separating(_) | Magnitude::External(_) => None,
        }
    }

    /// The forces of a load of a given magnitude.
    pub(super) fn wrenches(&self, load: usize, force: f64, at: &MultibodyState) -> Vec<BodyWrench> {
        let wrenches = self.wrenches_of(&self.loads[load].kind, force, at);
        wrenches.unwrap_or_default()
    }

    fn wrenches_of(
        &self,
        kind: &LoadKind,
        force: f64,
        at: &MultibodyState,
    ) -> Option<Vec<BodyWrench>> {
        let (ground, masses) = (self.mechanism.ground, &self.masses);
        load_wrenches(kind, force, ground, masses, &at.poses, &at.velocities)
    }

    /// All bodies at the origin and at rest: to see which bodies and coordinates exist.
    pub(super) fn rest_state(&self) -> MultibodyState {
        let at_rest = vec![[0.0; 3]; self.masses.len()];
        MultibodyState {
            t: 0.0,
            poses: at_rest.clone(),
            velocities: at_rest,
        }
    }

    /// Every load must find its bodies and coordinates.
    pub(super) fn check_loads(&self) -> Result<()> {
        let at = self.rest_state();
        for (i, load) in self.loads.iter().enumerate() {
            let wrong = |what| MultibodyError::Load { load: i, what };
            self.wrenches_of(&load.kind, 0.0, &at)
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
            let v = at.motion().point_velocity(BodyId(b), mass.center);
            let v = v.unwrap_or(Vec2::ZERO);
            let omega = at.velocities[b][2];
            let varying = self.frames.bodies[b].varying_inertia(at.poses[b][2]);
            let inertia = mass.inertia + varying;
            kinetic += 0.5 * (mass.mass * v.dot(v) + inertia * omega * omega);
        }
        kinetic += self.rotor_energy(at);
        let potential = |load| self.potential(load, at).unwrap_or(0.0);
        [kinetic, (0..self.loads.len()).map(potential).sum()]
    }

    /// The potential of a load, if it has one.
    pub(super) fn potential(&self, load: usize, at: &MultibodyState) -> Option<f64> {
        let load = &self.loads[load];
        let Magnitude::Constant(size) = load.magnitude else {
            return None;
        };
        let ground = self.mechanism.ground;
        placed(&load.kind, ground, &self.masses, at.motion())?.potential(size)
    }
}

//! Bodies whose moment of inertia is a function of their angle: what stands for a mechanism of which only its reduced inertia
//! at the driven body is known, from the runs of another program.
//!
//! Such a body has the kinetic energy ½ I(θ) ω², so that a moment I α + ½ I′ ω² turns it (equation 1 of docs/theory.md).

use crate::error::ModelError;
use crate::model::Model;
use crate::pass::{AccelerationInput, PassModel};
use dwell_geometry::{ActuatorKind, BodyId, Pose, Vec2};
use dwell_numerics::{PiecewiseQuintic, Scalar};

/// The moment of inertia of a body as a function of its angle from the ground, besides its own constant one.
#[derive(Debug, Clone, PartialEq)]
pub struct VaryingInertia {
    /// The body.
    pub body: BodyId,
    /// I over the body's angle (rad), kg m².
    pub inertia: PiecewiseQuintic,
    /// The reactions within the mechanism that it stands for.
    pub reactions: Vec<KnownReaction>,
}

/// A reaction a θ̈ + b θ̇² within a mechanism that a [`VaryingInertia`] stands for: of its own inertia and its drive alone.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownReaction {
    /// Its name.
    pub name: String,
    /// Whether it is a moment (N m), else a force (N).
    pub is_moment: bool,
    /// a over the body's angle, kg m or kg m².
    pub a: PiecewiseQuintic,
    /// b over the body's angle, kg m or kg m².
    pub b: PiecewiseQuintic,
}

impl KnownReaction {
    /// Its value at an angle (rad), angular velocity (rad/s) and angular acceleration (rad/s²), N or N·m; NaN where it is not
    /// known.
    pub fn value(&self, angle: f64, velocity: f64, acceleration: f64) -> f64 {
        let at = |of: &PiecewiseQuintic| value_at(of, angle)[0];
        at(&self.a) * acceleration + at(&self.b) * velocity * velocity
    }
}

/// Value and derivatives at an angle of any number of whole revolutions; NaN outside.
fn value_at(of: &PiecewiseQuintic, angle: f64) -> [f64; 5] {
    let turns = ((of.middle() - angle) / std::f64::consts::TAU).round();
    let angle = angle + std::f64::consts::TAU * turns;
    // An end of the positions is met but for rounding.
    let angle = of.ends().map_or(angle, |[first, last]| {
        let rounding = 1e-12 * (last - first);
        let inside = (first - rounding..=last + rounding).contains(&angle);
        if inside {
            angle.clamp(first, last)
        } else {
            angle
        }
    });
    of.eval(angle).unwrap_or([f64::NAN; 5])
}

/// A varying inertia as a pass meets it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrameInertia {
    pub(crate) body: usize,
    pub(crate) frame: usize,
    /// From the frame to the body, (cos, sin).
    offset: Vec2,
    inertia: PiecewiseQuintic,
}

impl FrameInertia {
    /// I and ½I′ for the orientation of the body, (cos, sin).
    pub(crate) fn at<T: Scalar>(&self, rotation: Vec2<T>) -> [T; 2] {
        let angle = rotation.y.atan2(rotation.x);
        let [i, first, second, third, fourth] = value_at(&self.inertia, angle.value());
        let halves = [first, second, third, fourth].map(|derivative| 0.5 * derivative);
        [
            angle.compose(&[i, first, second, third]),
            angle.compose(&halves),
        ]
    }

    /// I α + ½ I′ ω² of each pass, N·m.
    pub(crate) fn moments<T: Scalar, const N: usize>(
        &self,
        pose: &Pose<T>,
        accelerations: impl AccelerationInput<T, N>,
    ) -> [T; N] {
        let [inertia, half_slope] = self.at(self.offset.cast().rotate(pose.rotation[self.frame]));
        let mut moments = accelerations.angular_acceleration(self.frame);
        let squares = accelerations.squared_angular_velocity(self.frame);
        for (moment, square) in moments.iter_mut().zip(squares) {
            *moment = inertia * *moment + half_slope * square;
        }
        moments
    }
}

impl Model {
    /// The same model with bodies of varying inertia. One that is not known over a whole revolution limits the range of the
    /// actuator that turns its body from the ground.
    ///
    /// # Errors
    /// [`ModelError::VaryingInertia`]: no such moving body, an inertia that is not above zero, or one over part of a revolution of
    /// a body that no actuator turns from the ground.
    pub fn with_varying_inertias(mut self, varying: &[VaryingInertia]) -> Result<Self, ModelError> {
        for one in varying {
            let refused = |what| ModelError::VaryingInertia {
                body: one.body,
                what,
            };
            let body = one.body.0;
            let moves = body < self.masses().len() && body != self.mechanism().ground;
            if !moves {
                return Err(refused("it is not a moving body"));
            }
            let [smallest, largest] = one.inertia.extent();
            if !(smallest > 0.0 && largest.is_finite()) {
                return Err(refused("its varying inertia is not above zero everywhere"));
            }
            if let Some(ends) = one.inertia.ends() {
                let of_body =
                    |bodies: [BodyId; 2]| bodies == [BodyId(self.mechanism().ground), one.body];
                let actuators = &self.mechanism().actuators;
                let [actuator] = actuators.as_slice() else {
                    return Err(refused(PART_OF_A_REVOLUTION));
                };
                if actuator.kind != ActuatorKind::Angle || !of_body(actuator.bodies) {
                    return Err(refused(PART_OF_A_REVOLUTION));
                }
                self.pass_model.plan.limit_range(ends);
            }
            let frame_inertia = FrameInertia::new(&self.pass_model, one);
            self.pass_model.varying_inertias.push(frame_inertia);
        }
        Ok(self)
    }
}

const PART_OF_A_REVOLUTION: &str =
    "its inertia is known over part of a revolution, and no actuator is its angle from the ground";

impl FrameInertia {
    fn new(model: &PassModel, of: &VaryingInertia) -> Self {
        let orientation = model.plan.frames().orientations[of.body.0];
        Self {
            body: of.body.0,
            frame: orientation.frame,
            offset: orientation.offset,
            inertia: of.inertia.clone(),
        }
    }
}

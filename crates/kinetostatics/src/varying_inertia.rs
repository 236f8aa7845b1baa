//! Bodies whose moment of inertia is a function of their angle. Such a body represents a mechanism of which only the reduced
//! inertia at the driven body is known, from the runs of another program.
//!
//! Such a body has the kinetic energy ½ I(θ) ω², so that a moment I α + ½ I′ ω² turns it (equation 1 of docs/theory.md).

use dwell_geometry::{BodyId, Pose, Vec2};
use dwell_numerics::{PiecewiseQuintic, Scalar};

/// The moment of inertia of a body as a function of its angle from the ground, in addition to its constant one.
#[derive(Debug, Clone, PartialEq)]
pub struct VaryingInertia {
    /// The body.
    pub body: BodyId,
    /// I over the body's angle (rad), kg m².
    pub inertia: PiecewiseQuintic,
    /// The reactions within the mechanism that it represents.
    pub reactions: Vec<KnownReaction>,
}

/// A reaction a θ̈ + b θ̇² within a mechanism that a [`VaryingInertia`] represents, caused by its inertia and its drive
/// alone.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownReaction {
    /// Its name.
    pub name: String,
    /// Whether it is a moment (N m); otherwise it is a force (N).
    pub is_moment: bool,
    /// a over the body's angle, kg m or kg m².
    pub a: PiecewiseQuintic,
    /// b over the body's angle, kg m or kg m².
    pub b: PiecewiseQuintic,
}

impl KnownReaction {
    /// Its value at an angle (rad), angular velocity (rad/s) and angular acceleration (rad/s²), N or N·m; NaN if it is
    /// unknown.
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
    /// A body turns with a frame, from which it has an orientation (cos, sin).
    pub(crate) fn new(of: &VaryingInertia, frame: usize, offset: Vec2) -> Self {
        Self {
            body: of.body.0,
            frame,
            offset,
            inertia: of.inertia.clone(),
        }
    }

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

    /// I α + ½ I′ ω² of each pass, N·m, from α and ω².
    pub(crate) fn moments<T: Scalar, const N: usize>(
        &self,
        pose: &Pose<T>,
        mut accelerations: [T; N],
        squares: [T; N],
    ) -> [T; N] {
        let [inertia, half_slope] = self.at(self.offset.cast().rotate(pose.rotation[self.frame]));
        for (alpha, square) in accelerations.iter_mut().zip(squares) {
            *alpha = inertia * *alpha + half_slope * square;
        }
        accelerations
    }
}

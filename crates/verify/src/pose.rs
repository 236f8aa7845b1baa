//! Where bodies are, how they move, and which of that are coordinates of the dense equations.

use dwell_geometry::Vec2;
use dwell_geometry::space::{Placement, Rotation, Vec3, Wrench, vec3};
use std::ops::Range;

/// A vector of the plane in space.
pub(crate) fn lifted(v: Vec2) -> Vec3 {
    vec3(v.x, v.y, 0.0)
}

/// Position (m) and rotation of a body's frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// The origin of the frame.
    pub position: Vec3,
    /// The rotation of the frame.
    pub rotation: Rotation,
    /// The angle about z of a body that moves in the plane, rad, counted over whole revolutions.
    pub angle: f64,
}

/// The rotation about z by an angle, rad.
fn about_z(angle: f64) -> Rotation {
    let (sin, cos) = angle.sin_cos();
    Rotation::IDENTITY.turned_about_z((sin, cos))
}

impl From<[f64; 3]> for Pose {
    /// The frame [x, y, θ] of a body in the plane z = 0, m and rad.
    fn from([x, y, angle]: [f64; 3]) -> Self {
        Self {
            position: vec3(x, y, 0.0),
            rotation: about_z(angle),
            angle,
        }
    }
}

impl From<Placement> for Pose {
    fn from(Placement { position, rotation }: Placement) -> Self {
        Self {
            position,
            rotation,
            angle: 0.0,
        }
    }
}

impl Pose {
    /// The poses of frames [x, y, θ] in the plane.
    pub fn all_in_plane(frames: &[[f64; 3]]) -> Vec<Self> {
        frames.iter().map(|frame| Self::from(*frame)).collect()
    }

    /// The poses of bodies in space.
    pub fn all_in_space(placements: &[Placement]) -> Vec<Self> {
        placements.iter().map(|at| Self::from(*at)).collect()
    }

    /// The frame [x, y, θ] of a body that moves in the plane.
    pub fn in_plane(&self) -> [f64; 3] {
        [self.position.x, self.position.y, self.angle]
    }

    /// Where a point of the body is.
    pub(crate) fn point(&self, point: Vec3) -> Vec3 {
        self.position + self.rotation.apply(point)
    }

    pub(crate) fn is_finite(&self) -> bool {
        let axes = self.rotation.columns;
        let is_rotation = axes.iter().all(|axis| axis.is_finite());
        self.position.is_finite() && self.angle.is_finite() && is_rotation
    }
}

/// Rates of a body's frame: of its origin and its angle (m/s, rad/s), or the rates of these.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Velocity of the origin, m/s.
    pub linear: Vec3,
    /// Angular velocity, rad/s.
    pub angular: Vec3,
}

impl From<[f64; 3]> for Twist {
    /// The rates of a frame [x, y, θ] in the plane.
    fn from([x, y, angle]: [f64; 3]) -> Self {
        Self {
            linear: vec3(x, y, 0.0),
            angular: vec3(0.0, 0.0, angle),
        }
    }
}

impl Twist {
    /// The rates of frames [x, y, θ] in the plane.
    pub fn all_in_plane(rates: &[[f64; 3]]) -> Vec<Self> {
        rates.iter().map(|rates| Self::from(*rates)).collect()
    }

    /// The rates of a frame [x, y, θ] in the plane.
    pub fn in_plane(&self) -> [f64; 3] {
        [self.linear.x, self.linear.y, self.angular.z]
    }
}

/// ω × (ω × arm), so that in the plane it is −ω² times the arm exactly.
pub(crate) fn centripetal(omega: Vec3, arm: Vec3) -> Vec3 {
    omega.scaled(omega.dot(arm)) - arm.scaled(omega.dot(omega))
}

impl Twist {
    /// The velocity of a point at this vector from the origin.
    pub(crate) fn at(&self, arm: Vec3) -> Vec3 {
        self.linear + self.angular.cross(arm)
    }

    /// The power of a force at the origin and a couple, W.
    pub(crate) fn power(&self, wrench: &Wrench) -> f64 {
        wrench.force.dot(self.linear) + wrench.moment.dot(self.angular)
    }
}

/// The coordinates of a body among all: none for the ground; x, y and the angle for a body in the plane; position and rotation
/// for a body in space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Columns {
    Fixed,
    Plane(usize),
    Space(usize),
}

impl Columns {
    pub(crate) fn range(self) -> Range<usize> {
        match self {
            Self::Fixed => 0..0,
            Self::Plane(first) => first..first + 3,
            Self::Space(first) => first..first + 6,
        }
    }

    pub(crate) fn is_fixed(self) -> bool {
        self == Self::Fixed
    }

    /// The components of a wrench, or of a twist, along the coordinates; and whether each is an angle's.
    pub(crate) fn components(
        self,
        linear: Vec3,
        angular: Vec3,
    ) -> impl Iterator<Item = (f64, bool)> {
        let all = [
            (linear.x, false),
            (linear.y, false),
            (linear.z, false),
            (angular.x, true),
            (angular.y, true),
            (angular.z, true),
        ];
        let kept: &[usize] = match self {
            Self::Fixed => &[],
            Self::Plane(_) => &[0, 1, 5],
            Self::Space(_) => &[0, 1, 2, 3, 4, 5],
        };
        kept.iter().map(move |&k| all[k])
    }

    /// Adds a multiple of a force at the origin and a couple to the forces of all coordinates.
    pub(crate) fn add(self, wrench: &Wrench, factor: f64, to: &mut [f64]) {
        let components = self.components(wrench.force, wrench.moment);
        for (to, (part, _)) in to[self.range()].iter_mut().zip(components) {
            *to += factor * part;
        }
    }

    /// The rates of the body, from those of all coordinates.
    pub(crate) fn twist(self, rates: &[f64]) -> Twist {
        match self {
            Self::Fixed => Twist::default(),
            Self::Plane(c) => Twist::from([rates[c], rates[c + 1], rates[c + 2]]),
            Self::Space(c) => Twist {
                linear: vec3(rates[c], rates[c + 1], rates[c + 2]),
                angular: vec3(rates[c + 3], rates[c + 4], rates[c + 5]),
            },
        }
    }

    /// A pose moved by a step of all coordinates.
    pub(crate) fn moved(self, pose: &Pose, step: &[f64]) -> Pose {
        let Twist { linear, angular } = self.twist(step);
        match self {
            Self::Fixed => *pose,
            Self::Plane(_) => {
                let to = pose.position + linear;
                Pose::from([to.x, to.y, pose.angle + angular.z])
            }
            Self::Space(_) => Pose {
                position: pose.position + linear,
                rotation: Rotation::of_vector(angular).after(&pose.rotation),
                angle: 0.0,
            },
        }
    }

    /// The rotation of a body: its counted angle in the plane; in space, the rotation vector from another pose.
    pub(crate) fn turn(self, from: &Pose, to: &Pose) -> Vec3 {
        match self {
            Self::Plane(_) => vec3(0.0, 0.0, to.angle),
            Self::Fixed | Self::Space(_) => self.step(from, to).angular,
        }
    }

    /// The step that leads from one pose to another.
    pub(crate) fn step(self, from: &Pose, to: &Pose) -> Twist {
        let angular = match self {
            Self::Fixed => Vec3::ZERO,
            Self::Plane(_) => vec3(0.0, 0.0, to.angle - from.angle),
            Self::Space(_) => to.rotation.after(&from.rotation.inverse()).vector(),
        };
        Twist {
            linear: to.position - from.position,
            angular,
        }
    }
}

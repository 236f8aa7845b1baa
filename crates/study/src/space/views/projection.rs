//! Directions of view, and what is drawn in one of them: the far parts first.

use dwell_geometry::space::{Vec3, vec3};
use dwell_report::Shape;

/// An orthographic view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// What points to the right and upwards in the picture: unit vectors at right angles.
    right: Vec3,
    up: Vec3,
}

impl View {
    /// From the front, against the y axis: x to the right, z upwards.
    pub(super) const FRONT: Self = Self {
        right: Vec3::AXES[0],
        up: Vec3::AXES[2],
    };
    /// From above: x to the right, y upwards.
    pub(super) const TOP: Self = Self {
        right: Vec3::AXES[0],
        up: Vec3::AXES[1],
    };
    /// From the right: y to the right, z upwards.
    pub(super) const SIDE: Self = Self {
        right: Vec3::AXES[1],
        up: Vec3::AXES[2],
    };

    /// From this azimuth about the z axis and elevation, rad.
    pub(super) fn axonometric(azimuth: f64, elevation: f64) -> Self {
        let ((sin, cos), (rise, level)) = (azimuth.sin_cos(), elevation.sin_cos());
        let toward = vec3(level * cos, level * sin, rise);
        let right = vec3(-sin, cos, 0.0);
        Self {
            right,
            up: toward.cross(right),
        }
    }

    /// The direction to the one who looks.
    pub(super) fn toward(&self) -> Vec3 {
        self.right.cross(self.up)
    }

    /// What points upwards in the picture.
    pub(super) fn up(&self) -> Vec3 {
        self.up
    }

    /// Where a point is in the picture, m.
    pub(super) fn place(&self, p: Vec3) -> [f64; 2] {
        [self.right.dot(p), self.up.dot(p)]
    }

    /// How near a point is, m.
    pub(super) fn nearness(&self, p: Vec3) -> f64 {
        self.toward().dot(p)
    }

    /// How long a direction is in the picture: of a unit vector 1 where it is seen from the side, and 0 from its end.
    pub(super) fn length(&self, direction: Vec3) -> f64 {
        let [x, y] = self.place(direction);
        x.hypot(y)
    }
}

/// Parts of a picture with their distances.
#[derive(Debug)]
pub(super) struct Picture {
    pub(super) view: View,
    parts: Vec<(f64, Vec<Shape>)>,
}

impl Picture {
    pub(super) fn new(view: View) -> Self {
        Self {
            view,
            parts: Vec::new(),
        }
    }

    /// Adds shapes that are as near as this.
    pub(super) fn add(&mut self, nearness: f64, shapes: Vec<Shape>) {
        self.parts.push((nearness, shapes));
    }

    /// All shapes, the farthest first; those of equal distance in the order in which they were added.
    pub(super) fn into_shapes(mut self) -> Vec<Shape> {
        self.parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.parts
            .into_iter()
            .flat_map(|(_, shapes)| shapes)
            .collect()
    }
}

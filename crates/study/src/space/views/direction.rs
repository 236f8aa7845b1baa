//! Directions of view.

use dwell_geometry::space::{Vec3, vec3};

/// Directions from which the axonometric view is chosen, degrees: azimuths and elevations.
const AZIMUTHS: [f64; 8] = [-62.0, -52.0, -42.0, -32.0, -22.0, 28.0, 38.0, 52.0];
const ELEVATIONS: [f64; 2] = [24.0, 33.0];

/// An orthographic view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// Unit vectors to the right and upwards in the picture, at right angles.
    right: Vec3,
    up: Vec3,
}

impl View {
    /// From the front, against the y axis: x to the right, z upwards.
    pub(super) const FRONT: Self = Self {
        right: Vec3::AXES[0],
        up: Vec3::AXES[2],
    };
    #[cfg(feature = "output")]
    /// From above: x to the right, y upwards.
    pub(super) const TOP: Self = Self {
        right: Vec3::AXES[0],
        up: Vec3::AXES[1],
    };
    #[cfg(feature = "output")]
    /// From the right: y to the right, z upwards.
    pub(super) const SIDE: Self = Self {
        right: Vec3::AXES[1],
        up: Vec3::AXES[2],
    };

    /// The view from this azimuth about the z axis and this elevation, rad.
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

    #[cfg(feature = "output")]
    /// The unit vector upwards in the picture.
    pub(super) fn up(&self) -> Vec3 {
        self.up
    }

    /// Where a point is in the picture, m.
    pub(super) fn place(&self, p: Vec3) -> [f64; 2] {
        [self.right.dot(p), self.up.dot(p)]
    }

    #[cfg(feature = "output")]
    /// How near a point is, m.
    pub(super) fn nearness(&self, p: Vec3) -> f64 {
        self.toward().dot(p)
    }

    /// The length of a direction in the picture: for a unit vector, 1 if seen from the side, 0 if seen from its end.
    pub(super) fn length(&self, direction: Vec3) -> f64 {
        let [x, y] = self.place(direction);
        x.hypot(y)
    }
}

/// The direction from which points that are apart are farthest apart in the picture.
pub(super) fn best_view(points: &[Vec3]) -> View {
    let size = points
        .iter()
        .flat_map(|a| points.iter().map(move |b| (*a - *b).norm()))
        .fold(0.0, f64::max);
    let clearance = |view: &View| {
        let pairs = points
            .iter()
            .enumerate()
            .flat_map(|(i, a)| points[..i].iter().map(move |b| *a - *b));
        let apart = pairs.filter(|d| d.norm() > 0.02 * size);
        apart
            .map(|d| view.length(d) / (d.norm() * size).sqrt())
            .fold(f64::INFINITY, f64::min)
    };
    let all = ELEVATIONS
        .iter()
        .flat_map(|e| AZIMUTHS.iter().map(move |a| [*a, *e]));
    let views = all.map(|[a, e]| View::axonometric(a.to_radians(), e.to_radians()));
    // Of equal ones the first.
    let better = |a: (f64, View), b: (f64, View)| if b.0 > 1.02 * a.0 { b } else { a };
    let best = views.map(|view| (clearance(&view), view)).reduce(better);
    best.map_or(View::FRONT, |(_, view)| view)
}

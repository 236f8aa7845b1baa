//! The row of a pair of gears in space: velocities of both wheels at the pitch point.

use super::terms::{Ends, Gradient, force_at};
use crate::pose::{Pose, Twist};
use dwell_geometry::space::{Placement, Vec3};

/// The velocity of the second wheel less that of the first, at the pitch point P and along the normal n of the teeth, both fixed in
/// the carrier c:
///
/// ```text
/// n·(ẋ₂ − ẋ₁) = 0,     ẋ_k = v_k + ω_k×(P − r_k),     J̇ẋ = (ω_c×n)·(ẋ₂ − ẋ₁) + n·Σ ± ω_k×(ẋ_c − v_k)
/// ```
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mesh {
    pub(crate) wheels: [usize; 2],
    /// The pitch point, twice of the carrier.
    pub(crate) pitch: Ends,
    /// The normal of the teeth, in the carrier.
    pub(crate) normal: Vec3,
}

impl Mesh {
    fn carrier(&self) -> usize {
        self.pitch.bodies[0]
    }

    /// The pitch point and the normal.
    fn teeth(&self, poses: &[Pose]) -> [Vec3; 2] {
        let carrier = &poses[self.carrier()];
        [
            carrier.point(self.pitch.points[0]),
            carrier.rotation.apply(self.normal),
        ]
    }

    pub(crate) fn gradients(&self, poses: &[Pose]) -> [Gradient; 2] {
        let [p, n] = self.teeth(poses);
        let [a, b] = self.wheels.map(|wheel| p - poses[wheel].position);
        [force_at(a, -n), force_at(b, n)]
    }

    pub(crate) fn velocity_product(&self, poses: &[Pose], twists: &[Twist]) -> f64 {
        let [p, n] = self.teeth(poses);
        let at = |body: usize| twists[body].at(p - poses[body].position);
        let carrier = self.carrier();
        let turned = |body: usize| {
            twists[body]
                .angular
                .cross(at(carrier) - twists[body].linear)
        };
        let [a, b] = self.wheels;
        let n1 = twists[carrier].angular.cross(n);
        n1.dot(at(b) - at(a)) + n.dot(turned(b) - turned(a))
    }

    /// The mismatch of the teeth after a motion between two poses, m: their travel on the second wheel minus that on the first, each
    /// relative to the carrier by the screw motion between the poses (its angle below half a revolution).
    pub(crate) fn travel(&self, from: &[Pose], to: &[Pose]) -> f64 {
        let travel = |wheel: usize| {
            let [before, after] = [from, to].map(|at| in_frame(&at[self.carrier()], &at[wheel]));
            let turned = after.rotation.after(&before.rotation.inverse());
            // Of the point of the carrier where the teeth are.
            let p = self.pitch.points[0];
            let moved = after.position + turned.apply(p - before.position) - p;
            self.normal.dot(along_screw(turned.vector(), moved))
        };
        let [first, second] = self.wheels.map(travel);
        second - first
    }
}

/// A body in the frame of another.
fn in_frame(frame: &Pose, body: &Pose) -> Placement {
    Placement {
        position: frame.rotation.apply_inverse(body.position - frame.position),
        rotation: frame.rotation.inverse().after(&body.rotation),
    }
}

/// The velocity of a point that a constant twist with this rotation vector w moves by d in unit time: the logarithm of a displacement
/// (Murray, Li and Sastry 1994, eq. 2.36),
///
/// ```text
/// v = d − ½ w×d + (1/θ² − (1 + cos θ)/(2 θ sin θ)) w×(w×d),     θ = |w|
/// ```
fn along_screw(w: Vec3, d: Vec3) -> Vec3 {
    let angle = w.norm();
    let factor = if angle < 1e-3 {
        1.0 / 12.0
    } else {
        1.0 / angle.powi(2) - (1.0 + angle.cos()) / (2.0 * angle * angle.sin())
    };
    let across = w.cross(d);
    d - across.scaled(0.5) + w.cross(across).scaled(factor)
}

//! Moments that nothing balances. A body between two spherical joints is free to turn about the line through them, and actuators
//! cannot balance a load that turns it.

use super::model::Model;
use crate::error::LoadError;
use crate::load::Magnitude;
use dwell_geometry::space::{IdleBody, Pose};

/// A moment about the line this small against the forces times the size of the mechanism is rounding: of poses that close to 1e-13 of the
/// size, and of the 1e-9 to which the inertia of the body may differ from that of a body of revolution.
const ROUNDING: f64 = 1e-9;
/// Steps of all coordinates from the assembly, rad or parts of the size: a moment that vanishes at all of them, a smooth function of the
/// coordinates, vanishes throughout.
const STEPS: [f64; 4] = [0.0, 0.031, -0.047, 0.089];

impl Model {
    /// Rejects loads that turn a body about such a line.
    ///
    /// # Errors
    /// [`LoadError`] for the first of them.
    pub(super) fn require_no_idle_moment(&self) -> Result<(), LoadError> {
        let idle = &self.plan().mobility().idle;
        if idle.is_empty() {
            return Ok(());
        }
        let mut pose = self.plan().pose::<f64>();
        for step in STEPS {
            let moved = self.start.iter().enumerate().map(|(i, start)| {
                let unit = if self.plan().is_angle(i) {
                    1.0
                } else {
                    self.plan().size()
                };
                // Coordinates that move by different parts.
                start + step * unit / (1.0 + 0.31 * i as f64)
            });
            if self
                .plan()
                .positions(&moved.collect::<Vec<_>>(), &mut pose)
                .is_err()
            {
                continue;
            }
            for (load, one) in self.loads.loads.iter().enumerate() {
                let acts = one.magnitude != Magnitude::Constant(0.0);
                if acts && idle.iter().any(|idle| self.is_turned(load, idle, &pose)) {
                    let what = "it turns a body about the line through its two spherical joints, and nothing balances that moment; let \
                                it act on that line, or replace one spherical joint by a universal joint";
                    return Err(LoadError { load, what });
                }
            }
        }
        Ok(())
    }

    /// Whether a unit of a load has a moment on the body about its line.
    fn is_turned(&self, load: usize, idle: &IdleBody, pose: &Pose<f64>) -> bool {
        let body = idle.body.0;
        let evaluated = self.plan().evaluation_frame(body);
        let to_ground = |v| {
            let frame = self.plan().frame(pose, body);
            frame.rotation.apply(evaluated.rotation.apply_inverse(v))
        };
        // Both from the origin of the evaluation frame, so that the place of the mechanism does not matter.
        let (axis, point) = (
            to_ground(idle.axis),
            to_ground(idle.point - evaluated.position),
        );
        for (kind, unit) in self.loads.kinds[load].directions() {
            let (mut moment, mut scale) = (0.0, 0.0);
            // Without a direction here it has one at the other poses.
            let _ = kind.act(
                unit,
                self.plan(),
                pose,
                self.inner_masses(),
                |(on, [arm, force, couple])| {
                    if on == body {
                        moment += axis.dot((arm - point).cross(force) + couple);
                        scale += force.norm() * self.plan().size() + couple.norm();
                    }
                },
            );
            if f64::abs(moment) > ROUNDING * scale {
                return true;
            }
        }
        false
    }
}

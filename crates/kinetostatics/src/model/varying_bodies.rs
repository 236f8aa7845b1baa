//! A model with bodies of varying inertia.

use super::Model;
use crate::error::ModelError;
use crate::varying_inertia::{FrameInertia, VaryingInertia};
use dwell_geometry::{ActuatorKind, BodyId};

impl Model {
    /// This model with bodies of varying inertia. An inertia that is not given over a whole revolution limits the range of
    /// the actuator that turns its body from the ground.
    ///
    /// # Errors
    /// [`ModelError::VaryingInertia`]: no such moving body, an inertia of zero or less, or one over part of a revolution of
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
                return Err(refused(
                    "its varying inertia must be greater than zero everywhere",
                ));
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
            let of_body = self.pass_model.plan.frames().orientations[body];
            let frame_inertia = FrameInertia::new(one, of_body.frame, of_body.offset);
            self.pass_model.varying_inertias.push(frame_inertia);
        }
        Ok(self)
    }
}

const PART_OF_A_REVOLUTION: &str =
    "its inertia is known over part of a revolution, and no actuator is its angle from the ground";

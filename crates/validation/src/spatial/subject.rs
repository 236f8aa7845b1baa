//! A scene in space as the subject of the checks of its reduced model.

use super::claims::{SpaceClaims, of_ground};
use crate::cases::subject::claimed_at;
use dwell_verify::{Coefficients, InverseDynamics, Pose, Subject, SubjectError};

/// Its reduced model, with all components of all joints in the axes of the ground.
impl Subject for SpaceClaims<'_> {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        Ok(Pose::all_in_space(&self.placements::<f64>(&[q])?))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let model = self.model();
        let (mut workspace, mut at) = (model.workspace(), model.coefficient_buffer());
        claimed_at(&[q], || Ok(model.reduce(q, &mut workspace, &mut at)?))?;
        (at.a, at.b) = (of_ground(&at.a), of_ground(&at.b));
        Ok(at)
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let model = self.model();
        let (mut workspace, mut found) = (model.workspace(), model.result_buffer());
        claimed_at(&[q], || {
            let (memory, found) = (&mut workspace, &mut found);
            Ok(model.inverse_dynamics(&[q], &[q_dot], &[q_ddot], memory, found)?)
        })?;
        Ok(InverseDynamics {
            tau: found.tau[0],
            reactions: of_ground(&found.reactions),
        })
    }
}

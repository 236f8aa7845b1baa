//! A scene in space as the subject of the checks of its reduced model.

use super::claims::{SpaceClaims, of_ground, refused};
use dwell_verify::{Coefficients, InverseDynamics, Pose, Subject, SubjectError};

/// Its reduced model, with all components of all joints in the axes of the ground.
impl Subject for SpaceClaims<'_> {
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError> {
        Ok(Pose::all_in_space(&self.placements::<f64>(&[q])?))
    }

    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError> {
        let (mut workspace, mut at) = (self.model().workspace(), self.model().coefficient_buffer());
        let done = self.model().reduce(q, &mut workspace, &mut at);
        done.map_err(|e| refused(&[q], &e))?;
        (at.a, at.b) = (of_ground(&at.a), of_ground(&at.b));
        Ok(at)
    }

    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError> {
        let (mut workspace, mut found) = (self.model().workspace(), self.model().result_buffer());
        let rates = [[q], [q_dot], [q_ddot]];
        let [q, q_dot, q_ddot] = rates.each_ref().map(|rate| &rate[..]);
        let done = (self.model()).inverse_dynamics(q, q_dot, q_ddot, &mut workspace, &mut found);
        done.map_err(|e| refused(q, &e))?;
        Ok(InverseDynamics {
            tau: found.tau[0],
            reactions: of_ground(&found.reactions),
        })
    }
}

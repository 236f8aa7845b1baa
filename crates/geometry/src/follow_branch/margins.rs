//! The margin of each group from the end of its branch: the size of its determinant, with its derivative by the
//! coordinate.

use super::step_buffers::StepBuffers;
use crate::motion::Motion;
use crate::plan::{Plan, Pose};
use crate::positions::InitialIterate;
use dwell_numerics::Dual;

impl Plan {
    /// By group, its margin at a pose. `None` if its branch has ended.
    pub(super) fn margins_of_pose(
        &self,
        at: &Pose<f64>,
        buffers: &mut StepBuffers,
    ) -> Option<Vec<Dual>> {
        if self.is_dyadic() {
            self.closed_form_margins(at, at.q[0], buffers, |_| true)
        } else {
            self.margins_by_duals(at, &mut buffers.with_slopes)
        }
    }

    /// The margins at a coordinate if every group is a closed form, with the pose there, whose revolutions are counted from
    /// another one; `None` if one of them is not clear of zero. The slopes follow from the motion at unit velocity, in a third
    /// of the operations of dual numbers.
    pub(super) fn closed_form_margins(
        &self,
        from: &Pose<f64>,
        q: f64,
        StepBuffers {
            reached, motion, ..
        }: &mut StepBuffers,
        is_clear: impl Fn(&Dual) -> bool,
    ) -> Option<Vec<Dual>> {
        if !self.is_explicit() {
            reached.start_from(from);
        }
        let mut margins = Vec::with_capacity(self.groups.len());
        let each = |group: usize, pose: &Pose<f64>, motion: &Motion<f64>| {
            let [product, slope] = self.determinant_and_slope(group, pose, motion);
            // The product of two vectors that are nearly parallel loses digits that the pose has.
            let size = (1.0 / pose.inverse_determinant[group]).abs();
            let margin = Dual {
                v: size,
                d: slope.copysign(slope * product),
            };
            margins.push(margin);
            is_clear(&margin)
        };
        let found = self.unit_motion_by_groups(q, reached, motion, each);
        found.is_ok_and(|all| all).then_some(margins)
    }

    /// The margins at a pose, by dual numbers.
    pub(super) fn margins_by_duals(
        &self,
        at: &Pose<f64>,
        pose: &mut Pose<Dual>,
    ) -> Option<Vec<Dual>> {
        pose.start_from(at);
        let q = [Dual::variable(at.q[0])];
        self.positions_from(&q, pose, InitialIterate::CurrentPose)
            .ok()?;
        let margin = |group: usize| {
            let determinant = self.group_determinant(group, pose);
            if determinant.v < 0.0 {
                -determinant
            } else {
                determinant
            }
        };
        Some((0..self.groups.len()).map(margin).collect())
    }
}

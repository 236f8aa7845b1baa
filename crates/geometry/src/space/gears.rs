//! Gear pairs: how far the teeth travel for a unit of each freedom between the wheels, and whether that is constant.

use super::closure::RowKind;
use super::plan::{Plan, Pose};
use crate::error::StructureError;
use crate::mechanism::JointId;

/// Travels that differ by no more, relative to the size, are the same.
const SAME_TRAVEL: f64 = 1e-9;

impl Plan {
    /// Measures the gear pairs. The joints between wheels and carriers are in the tree: whatever their coordinates are, the travel is
    /// the same if the wheels turn about, and slide along, lines of the carrier.
    ///
    /// # Errors
    /// [`StructureError::Gear`] where they do not, or where the normal of the teeth does not move a wheel.
    pub(super) fn measure_gears(&mut self) -> Result<(), StructureError> {
        let is_gear = |c: &usize| matches!(self.closures[*c].kinds[..], [RowKind::Mesh(_)]);
        let gears: Vec<usize> = (0..self.closures.len()).filter(is_gear).collect();
        if gears.is_empty() {
            return Ok(());
        }
        let mut poses = [self.pose(), self.pose()];
        // Any coordinates at which no two axes are parallel by chance.
        for (f, coordinate) in poses[1].coordinates.iter_mut().enumerate() {
            *coordinate = 0.3 + 0.37 * f as f64;
        }
        for c in gears {
            let joint = self.closures[c].joint.unwrap_or(JointId(0));
            let fault = |reason| Err(StructureError::Gear { joint, reason });
            self.closures[c].ratios = vec![0.0; self.closures[c].path.len()];
            let [at_zero, elsewhere] = poses.each_mut().map(|pose| self.travels(c, pose));
            let tolerance = SAME_TRAVEL * self.size;
            let mut pairs = at_zero.iter().zip(&elsewhere);
            if !pairs.all(|(a, b)| (a - b).abs() <= tolerance) {
                return fault("a wheel does not turn about, or slide along, a line of the carrier");
            }
            let moving = at_zero.iter().filter(|travel| travel.abs() > tolerance);
            if moving.count() < 2 {
                return fault("a wheel does not move along the normal of the teeth");
            }
            self.closures[c].ratios = at_zero;
        }
        Ok(())
    }

    /// By freedom of a gear pair's path: the travel of the teeth for a unit of it, at the coordinates in the pose.
    fn travels(&self, c: usize, pose: &mut Pose) -> Vec<f64> {
        self.evaluate_whole(pose);
        let closure = &self.closures[c];
        pose.entries[closure.entries..][..closure.path.len()].to_vec()
    }
}

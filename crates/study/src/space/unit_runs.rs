//! The two kinetostatic runs of a mechanism in space.

use super::prepared::{PreparedSpaceScene, range_limits};
use super::trajectory::{JointReactions, rows_along};
use crate::explain::StudyError;
use crate::progress::Progress;
use crate::unit_runs::compute::{UnitRun, UnitRunScene};
use dwell_findings::Table;
use dwell_scene::SpaceScene;

impl UnitRunScene for SpaceScene {
    type Prepared<'a> = PreparedSpaceScene<'a>;

    fn prepared_without_loads(&self) -> Result<PreparedSpaceScene<'_>, StudyError> {
        // Its model has none.
        PreparedSpaceScene::new(self)
    }

    fn run_table(
        &self,
        run: UnitRun,
        points: usize,
        progress: Progress<'_>,
    ) -> Result<Table, StudyError> {
        let mut scene = self.clone();
        scene.loads.clear();
        scene.drives.clear();
        scene.motion = None;
        scene.sweep = None;
        let (reactions, model) = JointReactions::new(&scene)?;
        let (limits, ..) = range_limits(&scene, model.plan());
        let period = model.plan().range().period();
        run.table(limits, (period, points), |trajectory| {
            let of_model = (&reactions, &model);
            let (computed, _) = rows_along(&scene, of_model, trajectory, &|_| true, progress)?;
            Ok((computed.table, computed.early_stop))
        })
    }
}

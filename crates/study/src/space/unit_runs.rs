//! The two kinetostatic runs of a mechanism in space.

use super::prepared::PreparedSpaceScene;
use crate::explain::StudyError;
use crate::unit_runs::compute::UnitRunScene;
use dwell_scene::SpaceScene;

impl UnitRunScene for SpaceScene {
    type Prepared<'a> = PreparedSpaceScene<'a>;

    fn prepared_without_loads(&self) -> Result<PreparedSpaceScene<'_>, StudyError> {
        // Its model has none.
        PreparedSpaceScene::new(self)
    }

    fn with_masses_alone(&self) -> Self {
        let mut scene = self.clone();
        scene.loads.clear();
        scene.drives.clear();
        scene.motion = None;
        scene.sweep = None;
        scene
    }
}

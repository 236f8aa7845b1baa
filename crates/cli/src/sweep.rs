//! The options of `dwell sweep`, of scenes in the plane and in space.

use crate::options::Command;
use crate::print_note;
use dwell_scene::SceneFile;
use dwell_study::ParameterSweep;
use std::path::Path;

/// The sweep that a command asks for; other commands ask for none.
pub(crate) fn parameter_sweep<'a>(
    command: &'a Command,
    scene: &SceneFile,
    folder: &'a Path,
) -> ParameterSweep<'a> {
    let nothing = ParameterSweep {
        vary: &[],
        samples: None,
        seed: 1,
        requests: &[],
        shard: None,
        export: None,
        store: None,
        folder,
    };
    let Command::Sweep {
        vary,
        samples,
        seed,
        results,
        shard,
        export,
        store,
        ..
    } = command
    else {
        return nothing;
    };
    for axis in vary {
        let path = axis.split(['=', '~', '±']).next().unwrap_or_default();
        note_former_path(scene, path.trim());
    }
    ParameterSweep {
        vary,
        samples: *samples,
        seed: *seed,
        requests: results,
        shard: *shard,
        export: *export,
        store: *store,
        folder,
    }
}

/// Says on standard error that the path of a number has a former name of a key.
pub(crate) fn note_former_path(scene: &SceneFile, path: &str) {
    if let Some(current) = scene.renamed_path(path) {
        print_note(&format!("note: {path} is now {current}"));
    }
}

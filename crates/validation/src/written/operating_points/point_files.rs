//! The findings over operating points of a case.

use super::equilibrium_files;
use super::linear_file::LinearFile;
use super::rest::Rest;
use super::slopes::Slopes;
use super::starts::Start;
use crate::written::poses::compared::Compared;
use crate::written::poses::printed_numbers::sentences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::scene_text::{Scene, text_of};
use crate::written::poses::stated::result;

/// Runs `linearise` about the initial state and `equilibria` on a scene with a motion, and compares their files. A
/// rejected run leaves nothing to compare.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
) -> Result<(), String> {
    if !scene.has("motion") {
        return Ok(());
    }
    let text = text_of(&scene.table)?;
    let linear = program.run("linear", &text, &["linearise", "--about", "initial"]);
    let rest = program.run("rest", &text, &["equilibria"]);
    for (run, command) in [(&linear, "linearise"), (&rest, "equilibria")] {
        if let Ok(run) = run {
            let summary = run.json(&format!("-{command}.json"))?;
            compared.merge("written-point-sentences", sentences(run, &summary));
        }
    }
    let about = program.run("about", &text, &["linearise"]);
    for (run, words) in [(&linear, "the initial state"), (&about, "its equilibrium")] {
        if let Ok(run) = run {
            let first = run.printed.lines().next().unwrap_or("");
            let is_said = first.ends_with(&format!(": linearised about {words}"));
            let found = compared.of("written-rest-words");
            found.require(is_said, || {
                format!("`linearise` about {words} prints `{first}`")
            });
        }
    }
    let rest = rest.as_ref().ok().zip(Some(about.as_ref().ok()));
    match scene.size() {
        // Moments of bodies without extent have no scale.
        0.0 => Ok(()),
        _ => other_starts(compared, program, scene, rest),
    }
}

/// Compares A, B, C and D with differences, the texts on equilibria, and the motion from them. A motion that cannot be linearised is
/// skipped.
fn other_starts(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
    rest: Option<(&Run, Option<&Run>)>,
) -> Result<(), String> {
    let text = text_of(&scene.everything())?;
    let Ok(run) = program.run("all", &text, &["linearise", "--about", "initial"]) else {
        return Ok(());
    };
    let linear = LinearFile::read(&run.text("-linear.csv")?);
    let linear = linear.ok_or("the file has no matrices")?;
    let archive = run.npz("-linear.npz")?;
    let is_coordinate = |name: &&String| scene.coordinate(name).is_some();
    let names = linear.columns.iter().filter(is_coordinate).cloned();
    let state = archive.columns.get("state");
    let state = state.ok_or("the archive has no state")?;
    let start = Start::new(scene, &names.collect::<Vec<_>>(), state);
    let start = start.ok_or("the start cannot be read")?;
    let slopes = Slopes {
        program,
        start: &start,
        linear: &linear,
    };
    slopes.compare(compared, &archive)?;
    let Some((rest, about)) = rest else {
        return Ok(());
    };
    equilibrium_files::compare(compared, program, &start, (rest, about))?;
    if result(&rest.json("-equilibria.json")?, "equilibria") == Some(0.0) {
        return Ok(());
    }
    let found = Rest {
        program,
        start: &start,
        rows: &rest.csv("-equilibria.csv")?,
        summary: &rest.json("-equilibria.json")?,
    };
    found.compare(compared)
}

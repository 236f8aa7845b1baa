//! Every picture of every scene of `validation/spatial`: no words lie on others, nothing is cut, and no legend names a curve that is not
//! there to see.

use super::{SCENES, scene};
use dwell_scene::SpaceScene;
use dwell_study::output::Picture;
use dwell_study::{Analysis, PictureSpan, analyse_trajectory_within, no_progress, reduce};
use rayon::prelude::*;

/// The defects of some pictures, and the number of pictures.
fn defects(study: &str, pictures: &[Picture]) -> (Vec<String>, usize) {
    let of = |picture: &Picture| {
        let layouts = picture.layouts().expect("a layout");
        let mut all: Vec<String> = layouts.iter().flat_map(|layout| layout.defects()).collect();
        // The frames of an animation are much alike.
        all.sort();
        all.dedup();
        let named = all
            .into_iter()
            .map(|defect| format!("{study}: {}: {defect}", picture.path));
        named.collect::<Vec<_>>()
    };
    (pictures.iter().flat_map(of).collect(), pictures.len())
}

/// A scene with a sweep; of several actuators the first is swept.
fn swept(name: &str) -> SpaceScene {
    let as_written = scene(name, "");
    let (first, start) = (
        &as_written.mechanism.actuators[0].name,
        as_written.assembly.q[0],
    );
    let range = match as_written.mechanism.actuators.len() {
        1 => String::new(),
        _ => format!("{first} = [{start}, {}]\n", start + 0.4),
    };
    scene(name, &format!("\n[coordinate-sweep]\npoints = 61\n{range}"))
}

fn of_scene(name: &&str) -> (Vec<String>, usize) {
    let scene = swept(name);
    let (mut all, mut count) = (Vec::new(), 0);
    let mut add = |study: &str, pictures: &[Picture]| {
        let (found, pictures) = defects(&format!("{name} {study}"), pictures);
        all.extend(found);
        count += pictures;
    };
    // The reduced model needs one actuator.
    if let Ok(done) = reduce(&scene, Some(61), None) {
        add("reduce", &done.pictures);
    }
    for analysis in [
        Analysis::Kinematics,
        Analysis::Statics,
        Analysis::Kinetostatics,
    ] {
        let span = PictureSpan::default();
        let done = analyse_trajectory_within(&scene, analysis, None, span, &no_progress)
            .unwrap_or_else(|e| panic!("{name}: {e:?}"));
        add(analysis.name(), &done.outcome.pictures);
    }
    (all, count)
}

#[test]
fn the_pictures_of_scenes_in_space_are_legible() {
    let all: Vec<_> = SCENES.par_iter().map(of_scene).collect();
    let found: Vec<String> = all.iter().flat_map(|(found, _)| found.clone()).collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
    let count: usize = all.iter().map(|(_, count)| count).sum();
    assert!(count > 300, "{count} pictures");
}

/// The pictures of a sweep say where the swept coordinate is, which need not be the first.
#[test]
fn pictures_of_a_sweep_say_where_the_swept_coordinate_is() {
    let scene = scene(
        "governor",
        "\n[coordinate-sweep]\npoints = 61\ns = [0.3, 0.7]\n",
    );
    let span = PictureSpan::default();
    let done = analyse_trajectory_within(&scene, Analysis::Kinematics, None, span, &no_progress)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let words = |ending: &str| {
        let mut pictures = done.outcome.pictures.iter();
        let picture = pictures.find(|picture| picture.path.ends_with(ending));
        let layouts = picture.expect("a picture").layouts().expect("a layout");
        let labels = layouts.iter().flat_map(|layout| &layout.labels);
        labels
            .map(|label| label.text.clone())
            .collect::<Vec<_>>()
            .join("\n")
    };
    assert!(words("mechanism.png").contains("Drawn at s = 17.2°"));
    let frames = words("mechanism.gif");
    assert!(
        frames.contains("s = 17.2°") && frames.contains("s = 40.1°"),
        "{frames}"
    );
}

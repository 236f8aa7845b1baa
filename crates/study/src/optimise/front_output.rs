//! Writes a Pareto front: summary, table, picture, the scene of its knee.

use super::compute::{Front, FrontPoint, optimise_front};
use super::output::add_scene;
use crate::explain::StudyError;
use crate::gradient::output::aligned;
use crate::number_format::{count, digits};
use crate::output::{Outcome, add_results_page, scene_caption};
use crate::progress::Progress;
use crate::study_scene::StudyScene;
use dwell_report::{Axis, Chart, Figure, Mark, Series, Stroke};
use dwell_scene::SceneFile;

/// The front of a job of a scene.
///
/// # Errors
/// [`StudyError`] as of [`optimise_front`].
pub(super) fn front<S: StudyScene>(
    scene: &S,
    job: usize,
    seed: u64,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let found = optimise_front(scene, job, seed, progress)?;
    let stem = format!("{}-optimise-{}", scene.name, found.job);
    let mut outcome = Outcome::default();
    for (k, point) in found.points.iter().enumerate() {
        for (i, (_, unit)) in found.goals.iter().enumerate() {
            outcome
                .record
                .add(format!("point[{k}].goal[{i}]"), unit, point.goals[i]);
        }
    }
    outcome.files.add(format!("{stem}.csv"), csv(&found));
    if let Some(knee) = found.knee() {
        let values: Vec<(&str, f64)> = knee
            .assigned
            .iter()
            .map(|(p, v)| (p.as_str(), *v))
            .collect();
        add_scene(&mut outcome.files, scene, &stem, &values)?;
    }
    outcome.summary = summary(&scene.title, &found);
    let figure = figure(scene, &found);
    add_results_page(&mut outcome, scene, "Pareto front", &stem, Some(figure));
    Ok(outcome)
}

fn summary(title: &str, found: &Front) -> String {
    let [a, b] = &found.goals;
    let mut text = format!(
        "{title}: job `{}`, front of {} and {}\n",
        found.job, a.0, b.0
    );
    let mut rows = vec![[a.0.clone(), b.0.clone(), "slope".to_owned(), String::new()]];
    let row = |of: &FrontPoint, note: &str| {
        let slope = of.slope.map_or(String::new(), |slope| digits(slope, 4));
        let [x, y] = of.goals.map(|goal| digits(goal, 6));
        [
            format!("{x} {}", a.1),
            format!("{y} {}", b.1),
            slope,
            note.to_owned(),
        ]
    };
    for point in &found.points {
        let is_knee = found.knee() == Some(point);
        let note = match (is_knee, point.is_converged) {
            (_, false) => "not converged",
            (true, true) => "the written scene",
            (false, true) => "",
        };
        rows.push(row(point, note));
    }
    if let Some([x, y]) = found.before {
        let [x, y] = [
            format!("{} {}", digits(x, 6), a.1),
            format!("{} {}", digits(y, 6), b.1),
        ];
        rows.push([x, y, String::new(), "the scene".to_owned()]);
    }
    text += &aligned(&rows);
    text += &format!("  {}", count(found.evaluations, "evaluation"));
    if found.is_interrupted {
        text += "; interrupted";
    }
    text.push('\n');
    text
}

fn csv(found: &Front) -> String {
    let [a, b] = &found.goals;
    let paths = found
        .points
        .first()
        .map_or(&[][..], |point| &point.assigned);
    let paths: Vec<&str> = paths.iter().map(|(path, _)| path.as_str()).collect();
    let mut text = format!(
        "{} [{}],{} [{}],slope,converged,{}\n",
        a.0,
        a.1,
        b.0,
        b.1,
        paths.join(",")
    );
    for of in &found.points {
        let slope = of.slope.map_or(String::new(), |slope| format!("{slope:?}"));
        let values: Vec<String> = of
            .assigned
            .iter()
            .map(|(_, value)| format!("{value:?}"))
            .collect();
        let [x, y] = of.goals;
        text += &format!(
            "{x:?},{y:?},{slope},{},{}\n",
            of.is_converged,
            values.join(",")
        );
    }
    text
}

fn figure(scene: &SceneFile, found: &Front) -> Figure {
    let points: Vec<[f64; 2]> = found.points.iter().map(|of| of.goals).collect();
    let mut series = vec![Series::line("front", points).stroke(Stroke::LineAndPoints)];
    series.extend(
        found
            .before
            .map(|at| Series::line("the scene", vec![at]).stroke(Stroke::Crosses)),
    );
    let knee = found.knee().map(|of| Mark::Point {
        at: of.goals,
        label: "written scene".to_owned(),
    });
    let [x, y] = found
        .goals
        .clone()
        .map(|(name, unit)| Axis::new(name, unit));
    let chart = Chart {
        x,
        y,
        series,
        marks: knee.into_iter().collect(),
        ..Chart::default()
    };
    let caption = "Designs of which none has a smaller value of one result without a larger one of the other.";
    Figure {
        name: "front".to_owned(),
        title: format!("{}: {}", scene.title, found.job),
        caption: scene_caption(scene, caption),
        provenance: "sequential quadratic programming with a limit of the second goal".to_owned(),
        columns: 1,
        panels: vec![chart.into()],
    }
}

//! Ten periods in the plane by Dwell: by each integrator on exact evaluation and on a table, and by quadrature.

use super::motion::min_time;
use super::motion::{EXACT, FROM_TEXT, Motion, QUADRATURE, QUADRATURE_ACCURACIES, Stages, TABLE};
use super::{PERIODS, Run};
use dwell_dynamics::{DynamicsError, Method, Options, Orbit, ReducedState, solve_reduced};
use dwell_kinetostatics::{ExactModel, Model, ReducedModel, TableDomain, TabulatedModel};
use dwell_scene::PlaneScene;
use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

/// A table is built to this part of the integrator's tolerance, but to no better than rounding lets it be.
const TABLE_ACCURACY_FACTOR: f64 = 0.1;
const MIN_TABLE_ACCURACY: f64 = 1e-13;

/// Where the crank is at the end.
fn integrate(
    motion: &Motion,
    model: &impl ReducedModel,
    options: &Options,
) -> Result<Vec<f64>, DynamicsError> {
    let run = solve_reduced(model, motion.start, Some(motion.end()), options, &[])?.completed()?;
    Ok(vec![run.steps.last().map_or(f64::NAN, |last| last.y[0])])
}

/// The same by quadrature, with its rule.
fn quadrature(
    motion: &Motion,
    model: &impl ReducedModel,
    accuracy: f64,
) -> Result<(Vec<f64>, Orbit), DynamicsError> {
    let orbit = Orbit::to_accuracy(model, motion.start, accuracy)?;
    Ok((motion.angles(&orbit), orbit))
}

/// All runs of a case.
pub(crate) fn measure(case: &str, folder: &Path) -> Result<(Vec<Run>, Stages), Box<dyn Error>> {
    let reference: toml::Table = std::fs::read_to_string(folder.join("case.toml"))?.parse()?;
    let period = reference["free_motion"]["period_s"].as_str();
    let period: f64 = period.ok_or("no period")?.parse()?;
    let file = folder.join("scene.toml");
    let name = file.display().to_string();
    let text = std::fs::read_to_string(&file)?;
    let read = || PlaneScene::parse(&name, &text);
    let scene = read()?;
    let motion = scene.motion.as_ref().ok_or("no motion")?;
    let start = ReducedState {
        t: 0.0,
        q: motion.initial_coordinates[0],
        q_dot: motion.initial_velocities[0],
    };
    let motion = Motion {
        case: case.to_owned(),
        start,
        known: vec![[PERIODS * period, start.q + 2.0 * PI * PERIODS]],
    };
    let exact = compile(&scene)?;

    let mut runs = integrator_runs(&motion, &exact);
    let exact_orbit = Orbit::new(&exact, start)?;
    let mut points = 0;
    for accuracy in QUADRATURE_ACCURACIES {
        let timed_run = min_time(|| quadrature(&motion, &exact, accuracy))?;
        let orbit = &timed_run.1.1;
        if orbit.points == points {
            continue;
        }
        points = orbit.points;
        runs.push(motion.quadrature_run(QUADRATURE, timed_run, &exact_orbit));
        let from_text = || -> Result<_, Box<dyn Error>> {
            Ok(quadrature(&motion, &compile(&read()?)?, accuracy)?)
        };
        runs.push(motion.quadrature_run(FROM_TEXT, min_time(from_text)?, &exact_orbit));
    }

    let stages = Stages {
        case: case.to_owned(),
        read: min_time(read)?.0,
        build: min_time(|| compile(&scene))?.0,
        table: Some(min_time(|| TabulatedModel::new(&exact, 1e-11, TableDomain::Full))?.0),
    };
    Ok((runs, stages))
}

/// Every method on exact evaluation, and on a table that is built in the same time.
fn integrator_runs(motion: &Motion, exact: &ExactModel) -> Vec<Run> {
    let mut runs = Vec::new();
    for method in Method::ALL {
        let exactly = |options: &Options| integrate(motion, exact, options).ok();
        runs.extend(motion.tolerance_runs(EXACT, method, &exactly));
        let tabulated = |options: &Options| {
            let accuracy = (TABLE_ACCURACY_FACTOR * options.rtol).max(MIN_TABLE_ACCURACY);
            let table = TabulatedModel::new(exact, accuracy, TableDomain::Full).ok()?;
            integrate(motion, &table, options).ok()
        };
        runs.extend(motion.tolerance_runs(TABLE, method, &tabulated));
    }
    runs
}

/// The reduced model without reactions: the motion needs none.
fn compile(scene: &PlaneScene) -> Result<ExactModel, Box<dyn Error>> {
    let start = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[])?;
    ExactModel::new(model).ok_or_else(|| "not one actuator".into())
}

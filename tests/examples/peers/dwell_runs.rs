//! Ten periods by Dwell: by each integrator on exact evaluation and on a table, and by quadrature.

use super::{ANGLE_ROUNDING, PERIODS, Run};
use dwell_dynamics::{DynamicsError, Method, Options, Orbit, ReducedState, solve_reduced};
use dwell_kinetostatics::{ExactModel, Model, ReducedModel, TableDomain, TabulatedModel};
use dwell_scene::Scene;
use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;
use std::time::{Duration, Instant};

/// The names of the ways.
pub(crate) const EXACT: &str = "Dwell, exact";
pub(crate) const TABLE: &str = "Dwell, table built anew";
pub(crate) const QUADRATURE: &str = "Dwell, quadrature";
pub(crate) const FROM_TEXT: &str = "from the scene's text: quadrature";

/// A time is the least of as many runs as fit into this, but of no fewer and no more than these.
const TIME_BUDGET: Duration = Duration::from_millis(250);
const MIN_REPETITIONS: usize = 5;
const MAX_REPETITIONS: usize = 2000;
/// What the rules of a quadrature leave, as a part of the mean.
const QUADRATURE_ACCURACIES: [f64; 5] = [1e-4, 1e-6, 1e-9, 1e-12, 0.0];
/// Times at which a rule is compared with that of all digits.
const COMPARED_TIMES: u32 = 23;
/// A method that takes longer than this is not asked for more digits, s.
const MAX_RUN_TIME: f64 = 0.2;
/// A table is built to this part of the integrator's tolerance, but to no better than rounding lets it be.
const TABLE_ACCURACY_FACTOR: f64 = 0.1;
const MIN_TABLE_ACCURACY: f64 = 1e-13;

/// What stands before the motion, s: reading a scene, building its model; and a table to 1e-11.
pub(crate) struct Stages {
    pub(crate) case: String,
    pub(crate) read: f64,
    pub(crate) build: f64,
    pub(crate) table: f64,
}

/// The motion of a case, and when it ends.
struct Motion {
    case: String,
    start: ReducedState,
    end: f64,
}

impl Motion {
    fn run(&self, tool: &str, setting: String, (wall, q): (f64, f64)) -> Run {
        Run {
            case: self.case.clone(),
            tool: tool.to_owned(),
            setting,
            wall_time: wall,
            error: (q - self.start.q - 2.0 * PI * PERIODS)
                .abs()
                .max(ANGLE_ROUNDING),
        }
    }

    /// Where the crank is at the end.
    fn integrate(
        &self,
        model: &impl ReducedModel,
        options: &Options,
    ) -> Result<f64, DynamicsError> {
        let run = solve_reduced(model, self.start, Some(self.end), options, &[])?.completed()?;
        Ok(run.steps.last().map_or(f64::NAN, |last| last.y[0]))
    }

    /// The same by quadrature, with its rule.
    fn quadrature(
        &self,
        model: &impl ReducedModel,
        accuracy: f64,
    ) -> Result<(f64, Orbit), DynamicsError> {
        let orbit = Orbit::to_accuracy(model, self.start, accuracy)?;
        Ok((orbit.state_at(self.end).q, orbit))
    }

    /// A run by quadrature. At a whole number of periods a rule is at its best, so it counts with what it is
    /// off in between, too, beside the rule with all digits.
    fn quadrature_run(
        &self,
        tool: &str,
        (wall, (q, orbit)): (f64, (f64, Orbit)),
        exact_orbit: &Orbit,
    ) -> Run {
        let mut run = self.run(tool, format!("{} points", orbit.points), (wall, q));
        for k in 0..COMPARED_TIMES {
            let t = self.end * (f64::from(k) + 0.37) / f64::from(COMPARED_TIMES);
            run.error = run
                .error
                .max((orbit.state_at(t).q - exact_orbit.state_at(t).q).abs());
        }
        run
    }
}

/// All runs of a case.
pub(crate) fn measure(case: &str, folder: &Path) -> Result<(Vec<Run>, Stages), Box<dyn Error>> {
    let reference: toml::Table = std::fs::read_to_string(folder.join("case.toml"))?.parse()?;
    let period = reference["free_motion"]["period_s"].as_str();
    let period: f64 = period.ok_or("no period")?.parse()?;
    let file = folder.join("scene.toml");
    let name = file.display().to_string();
    let text = std::fs::read_to_string(&file)?;
    let read = || Scene::parse(&name, &text);
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
        end: PERIODS * period,
    };
    let exact = compile(&scene)?;

    let mut runs = integrator_runs(&motion, &exact);
    let exact_orbit = Orbit::new(&exact, start)?;
    let mut points = 0;
    for accuracy in QUADRATURE_ACCURACIES {
        let timed_run = min_time(|| motion.quadrature(&exact, accuracy))?;
        let orbit = &timed_run.1.1;
        if orbit.points == points {
            continue;
        }
        points = orbit.points;
        runs.push(motion.quadrature_run(QUADRATURE, timed_run, &exact_orbit));
        let from_text = || -> Result<_, Box<dyn Error>> {
            Ok(motion.quadrature(&compile(&read()?)?, accuracy)?)
        };
        runs.push(motion.quadrature_run(FROM_TEXT, min_time(from_text)?, &exact_orbit));
    }

    let stages = Stages {
        case: case.to_owned(),
        read: min_time(read)?.0,
        build: min_time(|| compile(&scene))?.0,
        table: min_time(|| TabulatedModel::new(&exact, 1e-11, TableDomain::Full))?.0,
    };
    Ok((runs, stages))
}

/// Every method on exact evaluation, and on a table that is built in the same time.
fn integrator_runs(motion: &Motion, exact: &ExactModel) -> Vec<Run> {
    let mut runs = Vec::new();
    for method in Method::ALL {
        let exactly = |options: &Options| motion.integrate(exact, options).ok();
        runs.extend(tolerance_runs(motion, EXACT, method, &exactly));
        let tabulated = |options: &Options| {
            let accuracy = (TABLE_ACCURACY_FACTOR * options.rtol).max(MIN_TABLE_ACCURACY);
            let table = TabulatedModel::new(exact, accuracy, TableDomain::Full).ok()?;
            motion.integrate(&table, options).ok()
        };
        runs.extend(tolerance_runs(motion, TABLE, method, &tabulated));
    }
    runs
}

/// The reduced model without reactions: the motion needs none.
fn compile(scene: &Scene) -> Result<ExactModel, Box<dyn Error>> {
    let start = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[])?;
    ExactModel::new(model).ok_or_else(|| "not one actuator".into())
}

/// A method from tolerance to tolerance.
fn tolerance_runs(
    motion: &Motion,
    tool: &str,
    method: Method,
    run: &dyn Fn(&Options) -> Option<f64>,
) -> Vec<Run> {
    let mut runs = Vec::new();
    for digits in 4..=13 {
        let options = Options::new(method, 10_f64.powi(-digits));
        // A tolerance that cannot be kept ends a method's row.
        let Ok(timed_run) = min_time(|| run(&options).ok_or("refused")) else {
            break;
        };
        runs.push(motion.run(tool, format!("{}, 1e-{digits}", method.name()), timed_run));
        if timed_run.0 > MAX_RUN_TIME {
            break;
        }
    }
    runs
}

/// The least time of several runs, s, and what the last gave.
fn min_time<T, E>(mut run: impl FnMut() -> Result<T, E>) -> Result<(f64, T), E> {
    let (mut best, mut times, first) = (f64::INFINITY, 0, Instant::now());
    loop {
        let start = Instant::now();
        let value = run()?;
        best = best.min(start.elapsed().as_secs_f64());
        times += 1;
        if times >= MAX_REPETITIONS || (times >= MIN_REPETITIONS && first.elapsed() > TIME_BUDGET) {
            return Ok((best, value));
        }
    }
}

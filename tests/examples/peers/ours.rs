//! Ten periods by Dwell: by each integrator on exact evaluation and on a table, and by quadrature.

use super::{FLOOR, PERIODS, Run};
use dwell_dynamics::{DynamicsError, Method, Options, Orbit, State, Until, simulate};
use dwell_kinetostatics::{Exact, Extent, Model, Reduced, Table};
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
const SPENT: Duration = Duration::from_millis(250);
const FEWEST: usize = 5;
const MOST: usize = 2000;
/// What the rules of a quadrature leave, as a part of the mean.
const RULES: [f64; 5] = [1e-4, 1e-6, 1e-9, 1e-12, 0.0];
/// Times at which a rule is compared with that of all digits.
const COMPARED: u32 = 23;
/// A method that takes longer than this is not asked for more digits, s.
const LONG: f64 = 0.2;
/// A table is built to this part of the integrator's tolerance, but to no better than rounding lets it be.
const PART: f64 = 0.1;
const FINEST: f64 = 1e-13;

/// What stands before the motion, s: reading a scene, building its model; and a table to 1e-11.
pub(crate) struct Stages {
    pub(crate) case: String,
    pub(crate) read: f64,
    pub(crate) built: f64,
    pub(crate) table: f64,
}

/// The motion of a case, and when it ends.
struct Motion {
    case: String,
    start: State,
    end: f64,
}

impl Motion {
    fn run(&self, tool: &str, setting: String, (wall, q): (f64, f64)) -> Run {
        Run {
            case: self.case.clone(),
            tool: tool.to_owned(),
            setting,
            wall,
            error: (q - self.start.q - 2.0 * PI * PERIODS).abs().max(FLOOR),
        }
    }

    /// Where the crank is at the end.
    fn integrate(&self, model: &impl Reduced, options: &Options) -> Result<f64, DynamicsError> {
        let run = simulate(model, self.start, Until::Time(self.end), options)?;
        Ok(run.steps.last().map_or(f64::NAN, |last| last.q))
    }

    /// The same by quadrature, with its rule.
    fn quadrature(
        &self,
        model: &impl Reduced,
        accuracy: f64,
    ) -> Result<(f64, Orbit), DynamicsError> {
        let orbit = Orbit::within(model, self.start, accuracy)?;
        Ok((orbit.at(self.end).q, orbit))
    }

    /// A run by quadrature. At a whole number of periods a rule is at its best, so it counts with what it is
    /// off in between, too, beside the rule with all digits.
    fn by_rule(&self, tool: &str, (wall, (q, orbit)): (f64, (f64, Orbit)), all: &Orbit) -> Run {
        let mut run = self.run(tool, format!("{} points", orbit.points), (wall, q));
        for k in 0..COMPARED {
            let t = self.end * (f64::from(k) + 0.37) / f64::from(COMPARED);
            run.error = run.error.max((orbit.at(t).q - all.at(t).q).abs());
        }
        run
    }
}

/// All runs of a case.
pub(crate) fn measure(case: &str, folder: &Path) -> Result<(Vec<Run>, Stages), Box<dyn Error>> {
    let known: toml::Table = std::fs::read_to_string(folder.join("case.toml"))?.parse()?;
    let period = known["free_motion"]["period_s"].as_str();
    let period: f64 = period.ok_or("no period")?.parse()?;
    let file = folder.join("scene.toml");
    let name = file.display().to_string();
    let text = std::fs::read_to_string(&file)?;
    let read = || Scene::parse(&name, &text);
    let scene = read()?;
    let motion = scene.motion.as_ref().ok_or("no motion")?;
    let start = State {
        t: 0.0,
        q: motion.start[0],
        q_dot: motion.speed[0],
    };
    let motion = Motion {
        case: case.to_owned(),
        start,
        end: PERIODS * period,
    };
    let exact = compiled(&scene)?;

    let mut runs = integrators(&motion, &exact);
    let all = Orbit::new(&exact, start)?;
    let mut points = 0;
    for accuracy in RULES {
        let measured = least(|| motion.quadrature(&exact, accuracy))?;
        let orbit = &measured.1.1;
        if orbit.points == points {
            continue;
        }
        points = orbit.points;
        runs.push(motion.by_rule(QUADRATURE, measured, &all));
        let whole = || -> Result<_, Box<dyn Error>> {
            Ok(motion.quadrature(&compiled(&read()?)?, accuracy)?)
        };
        runs.push(motion.by_rule(FROM_TEXT, least(whole)?, &all));
    }

    let stages = Stages {
        case: case.to_owned(),
        read: least(read)?.0,
        built: least(|| compiled(&scene))?.0,
        table: least(|| Table::new(&exact, 1e-11, Extent::Whole))?.0,
    };
    Ok((runs, stages))
}

/// Every method on exact evaluation, and on a table that is built in the same time.
fn integrators(motion: &Motion, exact: &Exact) -> Vec<Run> {
    let mut runs = Vec::new();
    for method in Method::ALL {
        let exactly = |options: &Options| motion.integrate(exact, options).ok();
        runs.extend(tolerances(motion, EXACT, method, &exactly));
        let tabulated = |options: &Options| {
            let accuracy = (PART * options.relative).max(FINEST);
            let table = Table::new(exact, accuracy, Extent::Whole).ok()?;
            motion.integrate(&table, options).ok()
        };
        runs.extend(tolerances(motion, TABLE, method, &tabulated));
    }
    runs
}

/// The reduced model without reactions: the motion needs none.
fn compiled(scene: &Scene) -> Result<Exact, Box<dyn Error>> {
    let start = scene.assembly.to_start();
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &[])?;
    Exact::new(model).ok_or_else(|| "not one actuator".into())
}

/// A method from tolerance to tolerance.
fn tolerances(
    motion: &Motion,
    tool: &str,
    method: Method,
    run: &dyn Fn(&Options) -> Option<f64>,
) -> Vec<Run> {
    let mut runs = Vec::new();
    for digits in 4..=13 {
        let options = Options::new(method, 10_f64.powi(-digits));
        // A tolerance that cannot be kept ends a method's row.
        let Ok(measured) = least(|| run(&options).ok_or("refused")) else {
            break;
        };
        runs.push(motion.run(tool, format!("{}, 1e-{digits}", method.name()), measured));
        if measured.0 > LONG {
            break;
        }
    }
    runs
}

/// The least time of several runs, s, and what the last gave.
fn least<T, E>(mut run: impl FnMut() -> Result<T, E>) -> Result<(f64, T), E> {
    let (mut best, mut times, first) = (f64::INFINITY, 0, Instant::now());
    loop {
        let start = Instant::now();
        let value = run()?;
        best = best.min(start.elapsed().as_secs_f64());
        times += 1;
        if times >= MOST || (times >= FEWEST && first.elapsed() > SPENT) {
            return Ok((best, value));
        }
    }
}
